//! L-BFGS on a prefactored Laplacian: the low-memory solver.
//!
//! The metric is the Laplacian of the goals (`laplacian.rs`) where a stage begins, factorised once per stage: a matrix
//! of one number per pair of vertices where Newton's has nine, and a factor a ninth the size. What it misses is learnt
//! from the last few steps (Nocedal & Wright, *Numerical Optimization*, algorithm 7.4; as metric for elastic energies:
//! Liu, Bouaziz & Kavan, *Quasi-Newton Methods for Real-time Simulation*, 2017). Stages, softened start and stop rules
//! are [`newton`](crate::newton)'s.

use crate::goal::{Curvature, Scales};
use crate::laplacian::{Laplacian, Prefactored};
use crate::newton::NewtonOptions;
use crate::objective::{GradientSum, Objective};
use crate::stop::{Halt, Stop, record};
use crate::{FoldError, Iteration};
use glam::DVec3;
use softfold_geometry::SolveRecord;
use std::collections::VecDeque;

/// Options of L-BFGS: those of [`NewtonOptions`] and the number of steps remembered.
#[derive(Clone, Debug, PartialEq)]
pub struct LbfgsOptions {
    /// Scales from the start to the end; the last should be [`Scales::FULL`].
    pub ramp: Vec<Scales>,
    /// Stop when the relative gradient is below this.
    pub relative_gradient: f64,
    /// Relative gradient that ends a softened stage.
    pub softened_gradient: f64,
    /// Most iterations in all.
    pub max_iterations: u32,
    /// Steps from which the curvature is learnt; each costs two vectors of the positions' size.
    pub memory: usize,
    /// Ends it from outside.
    pub halt: Halt,
}

impl Default for LbfgsOptions {
    fn default() -> Self {
        let NewtonOptions { ramp, softened_gradient, .. } = NewtonOptions::default();
        let halt = Halt::default();
        Self { ramp, relative_gradient: 1e-6, softened_gradient, max_iterations: 20_000, memory: 12, halt }
    }
}

/// Share of the predicted decrease that a step must achieve (Armijo).
const ARMIJO: f64 = 1e-4;
/// Share of the slope that may be left after a step (Wolfe): what makes the learnt curvature positive.
const WOLFE: f64 = 0.9;
/// Trials of a step length before it is given up.
const MAX_TRIALS: u32 = 40;
/// Shift of the Laplacian, relative to its mean diagonal: a free sheet may move as a whole.
const SHIFT: f64 = 1e-9;
/// Growth of the shift after a failed factorisation.
const SHIFT_GROWTH: f64 = 30.0;
/// Shift beyond which the metric is no longer the sheet's: giving up is honest.
const LARGEST_SHIFT: f64 = 1e3;
/// Curvature along a step, relative to its size in the metric, below which nothing is learnt from it.
const LEAST_CURVATURE: f64 = 1e-12;

/// What a step taught: its motion, the gradient's change, and the inverse of their product.
struct Lesson {
    motion: Vec<DVec3>,
    change: Vec<DVec3>,
    inverse: f64,
}

struct Lbfgs<'a> {
    objective: &'a Objective<'a>,
    options: &'a LbfgsOptions,
    x: Vec<DVec3>,
    iterations: u32,
    /// Forces below this are none, N.
    floor: f64,
}

/// One stage: an energy with its metric and what was learnt of it.
struct Stage<'a> {
    objective: &'a Objective<'a>,
    scales: Scales,
    metric: Prefactored,
    lessons: VecDeque<Lesson>,
    memory: usize,
    /// Factor on the metric's inverse that fits the last step.
    fit: f64,
}

/// A place that a step reached.
struct Reached {
    x: Vec<DVec3>,
    gradient: GradientSum,
    energy: f64,
}

/// Minimises the objective from `start`.
///
/// # Errors
/// [`FoldError::Factorisation`] if no shift makes the Laplacian definite.
pub fn minimise(
    objective: &Objective<'_>,
    start: &[DVec3],
    options: &LbfgsOptions,
    watch: &mut dyn FnMut(Iteration<'_>),
) -> Result<(Vec<DVec3>, SolveRecord), FoldError> {
    let floor = objective.force_floor(start);
    let mut lbfgs = Lbfgs { objective, options, x: start.to_vec(), iterations: 0, floor };
    let mut stop = Stop::Gradient(options.relative_gradient);
    for (i, &scales) in options.ramp.iter().enumerate() {
        let last = i + 1 == options.ramp.len();
        let target = if last { options.relative_gradient } else { options.softened_gradient };
        stop = lbfgs.stage(scales, target, watch)?;
        if stop.is_budget() {
            break;
        }
    }
    Ok(lbfgs.finish(start, stop))
}

impl<'a> Lbfgs<'a> {
    fn stage(
        &mut self,
        scales: Scales,
        target: f64,
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Result<Stop, FoldError> {
        let mut gradient = self.objective.gradient(&self.x, scales);
        if gradient.relative(self.floor) <= target {
            return Ok(Stop::Gradient(target));
        }
        let mut stage = Stage::new(self.objective, scales, &self.x, self.options.memory)?;
        while gradient.relative(self.floor) > target {
            if self.iterations >= self.options.max_iterations {
                return Ok(Stop::Iterations(self.options.max_iterations));
            }
            if self.options.halt.is_set() {
                return Ok(Stop::Halted);
            }
            let Some(reached) = stage.step(&self.x, &gradient.sum) else {
                return Ok(Stop::NoDescent);
            };
            self.iterations += 1;
            (self.x, gradient) = (reached.x, reached.gradient);
            watch(Iteration {
                number: self.iterations,
                level: 0,
                energy: reached.energy,
                relative_gradient: gradient.relative(self.floor),
                positions: &self.x,
            });
        }
        Ok(Stop::Gradient(target))
    }

    /// What was found, with its record; the start if a spent budget left it higher than that.
    fn finish(self, start: &[DVec3], stop: Stop) -> (Vec<DVec3>, SolveRecord) {
        let scales = self.options.ramp.last().copied().unwrap_or(Scales::FULL);
        let Self { objective, x, .. } = self;
        let spent = stop.is_budget() && objective.energy(start, scales) < objective.energy(&x, scales);
        let x = if spent { start.to_vec() } else { x };
        let record = record("lbfgs", objective, &x, (stop, self.iterations), (scales, self.floor));
        (x, record)
    }
}

impl<'a> Stage<'a> {
    fn new(
        objective: &'a Objective<'a>,
        scales: Scales,
        x: &[DVec3],
        memory: usize,
    ) -> Result<Self, FoldError> {
        let metric = metric(objective, scales, x)?;
        Ok(Self { objective, scales, metric, lessons: VecDeque::new(), memory, fit: 1.0 })
    }

    /// One step along what was learnt, or, where that leads nowhere down, along the metric's own gradient; none if that
    /// does not either.
    fn step(&mut self, x: &[DVec3], gradient: &[DVec3]) -> Option<Reached> {
        let mut reached = self.search(x, gradient, &self.direction(gradient));
        if reached.is_none() && !self.lessons.is_empty() {
            self.lessons.clear();
            self.fit = 1.0;
            reached = self.search(x, gradient, &self.direction(gradient));
        }
        let reached = reached?;
        self.learn(x, gradient, &reached);
        Some(reached)
    }

    /// `−B⁻¹ ∇E` by the two-loop recursion.
    fn direction(&self, gradient: &[DVec3]) -> Vec<DVec3> {
        let mut q: Vec<DVec3> = gradient.iter().map(|g| -*g).collect();
        let mut shares = Vec::with_capacity(self.lessons.len());
        for l in self.lessons.iter().rev() {
            let share = l.inverse * dot(&l.motion, &q);
            add_scaled(&mut q, -share, &l.change);
            shares.push(share);
        }
        let mut d = self.metric.solve(&q);
        d.iter_mut().for_each(|d| *d *= self.fit);
        for (l, share) in self.lessons.iter().zip(shares.into_iter().rev()) {
            let back = l.inverse * dot(&l.change, &d);
            add_scaled(&mut d, share - back, &l.motion);
        }
        d
    }

    /// The first step length found, by bisection, that lowers the energy enough (Armijo) and leaves the slope flatter
    /// (weak Wolfe); the best that Armijo allows if the trials run out (Lewis & Overton 2013).
    fn search(&self, x: &[DVec3], gradient: &[DVec3], direction: &[DVec3]) -> Option<Reached> {
        let slope = dot(direction, gradient);
        if slope.is_nan() || slope >= 0.0 {
            return None;
        }
        let before = self.objective.energy(x, self.scales);
        // Near the solution the decrease drowns in the energy's rounding.
        let rounding = 4.0 * f64::EPSILON * before.abs();
        let (mut low, mut high, mut length) = (0.0, f64::INFINITY, self.admissible(x, direction, 1.0));
        let mut best = None;
        for _ in 0..MAX_TRIALS {
            let trial: Vec<DVec3> = x.iter().zip(direction).map(|(x, d)| *x + length * *d).collect();
            let energy = self.objective.energy(&trial, self.scales);
            if energy <= before + ARMIJO * length * slope + rounding {
                let gradient = self.objective.gradient(&trial, self.scales);
                let flat_enough = dot(direction, &gradient.sum) >= WOLFE * slope;
                best = Some(Reached { x: trial, gradient, energy });
                if flat_enough {
                    break;
                }
                low = length;
            } else {
                high = length;
            }
            let wanted = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * length };
            length = if high.is_finite() { wanted } else { self.admissible(x, direction, wanted) };
            if length < wanted {
                break; // a barrier is on the way, and what is before it will do
            }
        }
        best
    }

    /// The step length that is wanted, or the largest below it that no barrier forbids.
    fn admissible(&self, x: &[DVec3], direction: &[DVec3], wanted: f64) -> f64 {
        let step: Vec<DVec3> = direction.iter().map(|d| wanted * *d).collect();
        wanted * self.objective.largest_step(x, &step)
    }

    fn learn(&mut self, x: &[DVec3], gradient: &[DVec3], reached: &Reached) {
        let motion: Vec<DVec3> = reached.x.iter().zip(x).map(|(a, b)| *a - *b).collect();
        let change: Vec<DVec3> = reached.gradient.sum.iter().zip(gradient).map(|(a, b)| *a - *b).collect();
        let curvature = dot(&motion, &change);
        let in_metric = dot(&change, &self.metric.solve(&change));
        if curvature > LEAST_CURVATURE * in_metric && in_metric > 0.0 {
            self.fit = curvature / in_metric;
            self.lessons.push_back(Lesson { motion, change, inverse: 1.0 / curvature });
            if self.lessons.len() > self.memory {
                self.lessons.pop_front();
            }
        }
    }
}

fn metric(objective: &Objective<'_>, scales: Scales, x: &[DVec3]) -> Result<Prefactored, FoldError> {
    let mut shift = SHIFT;
    loop {
        let mut laplacian = Laplacian::new(objective.vertices(), &objective.couplings_at(x, 0.0));
        objective.add_blocks(x, Curvature::Convex, scales, &mut laplacian);
        match laplacian.prefactored(shift) {
            Ok(metric) => return Ok(metric),
            Err(e) if shift > LARGEST_SHIFT => return Err(FoldError::Factorisation(format!("{e:?}"))),
            Err(_) => shift *= SHIFT_GROWTH,
        }
    }
}

fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

fn add_scaled(a: &mut [DVec3], factor: f64, b: &[DVec3]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * *b);
}
