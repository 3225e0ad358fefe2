//! Newton's descent on one mesh: the part that one-level, multilevel and warm solves share.
//!
//! Each step solves `H d = −∇E` by a supernodal LLᵀ whose symbolic part is made once: the true Hessian where it is
//! positive definite, else the Gauss-Newton one with a small shift; Armijo's rule on the energy. A factor is used again
//! (Shamanskii 1967) as long as the steps that it gives shrink: a solve costs a tenth of a factorisation.

use crate::factor::Factor;
use crate::goal::{Curvature, Scales};
use crate::hessian::{Hessian, coupled_rows};
use crate::motion::Motion;
use crate::newton::NewtonOptions;
use crate::objective::{GradientSum, Objective};
use crate::order::nested_dissection;
use crate::stop::Stop;
use crate::{FoldError, Iteration};
use glam::{DVec2, DVec3};

/// Share of the predicted decrease that a step must achieve (Armijo).
const ARMIJO: f64 = 1e-4;
/// Halvings of a step before it is given up: 2⁻³⁰ of a step moves nothing.
const MAX_HALVINGS: u32 = 30;
/// First shift, relative to the mean diagonal: keeps rigid motions of a free sheet solvable.
const FIRST_SHIFT: f64 = 1e-9;
/// Growth of the shift after a failed factorisation.
const SHIFT_GROWTH: f64 = 30.0;
/// Decay of the shift after a successful one.
const SHIFT_DECAY: f64 = 10.0;
/// Factorisations of the true Hessian before the Gauss-Newton one is taken.
const EXACT_TRIES: u32 = 4;
/// Shift beyond which the step is a gradient step: giving up is honest.
const LARGEST_SHIFT: f64 = 1e3;
/// Room in the matrix for contacts that are not yet, as share of the contact distance: its symbolic part, which costs
/// as much as a few steps, is made anew only when vertices have come that much nearer.
const CONTACT_MARGIN: f64 = 0.25;
/// Gauss-Newton steps go on as long as each leaves less than this share of the energy.
const LITTLE_LEFT: f64 = 0.8;
/// Relative gradient above which an indefinite true Hessian is not shifted but left for the Gauss-Newton one.
const FAR: f64 = 1e-3;
/// Steps by one factor at most.
const STEPS_PER_FACTOR: u32 = 6;
/// A factor is used again as long as its step is no longer than this share of the one before.
const SHRINKS: f64 = 0.5;

/// The linear side of a mesh: matrix, factor, and the order of elimination.
pub(crate) struct System {
    places: Vec<DVec2>,
    hessian: Hessian,
    factor: Factor,
    /// Factorisations of matrices that had other contacts.
    earlier: u32,
}

impl System {
    /// Room for the goals' Hessian and the contacts at `x` or nearly there; `places` are the flat coordinates.
    pub(crate) fn new(objective: &Objective<'_>, places: &[DVec2], x: &[DVec3]) -> Result<Self, FoldError> {
        let rows = coupled_rows(places.len(), &objective.couplings_at(x, CONTACT_MARGIN));
        let order = nested_dissection(places, &rows);
        let hessian = Hessian::new(&rows, order);
        let factor = Factor::new(&hessian)?;
        Ok(Self { places: places.to_vec(), hessian, factor, earlier: 0 })
    }

    /// Makes the matrix anew when vertices have met that it does not couple.
    pub(crate) fn make_room(&mut self, objective: &Objective<'_>, x: &[DVec3]) -> Result<(), FoldError> {
        if !self.hessian.holds(&objective.contacts(x, 0.0)) {
            let earlier = self.factorisations();
            *self = Self { earlier, ..Self::new(objective, &self.places, x)? };
        }
        Ok(())
    }

    /// Whether the goals couple only what the matrix couples.
    pub(crate) fn fits(&self, objective: &Objective<'_>) -> bool {
        let pairs = |group: Vec<u32>| -> Vec<[u32; 2]> {
            group.iter().flat_map(|&i| group.iter().map(move |&j| [i, j])).collect()
        };
        objective.vertices() == self.places.len()
            && objective.couplings().all(|group| self.hessian.holds(&pairs(group)))
    }

    /// Counts factorisations from 0 again.
    pub(crate) fn begin_count(&mut self) {
        (self.earlier, self.factor.factorisations) = (0, 0);
    }

    /// Numeric factorisations so far.
    pub(crate) fn factorisations(&self) -> u32 {
        self.earlier + self.factor.factorisations
    }

    /// `H⁻¹ (−gradient)` by the last factor.
    fn direction(&mut self, gradient: &[DVec3]) -> Vec<DVec3> {
        let mut d = self.factor.solve(&self.hessian, gradient);
        d.iter_mut().for_each(|d| *d = -*d);
        d
    }
}

/// When a stage is done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// Relative gradient below which it is.
    pub(crate) relative_gradient: f64,
    /// It is when a whole step moves no vertex by so much, mm.
    pub(crate) motion_mm: f64,
    /// Whether such a step may be a Gauss-Newton one, which says less of how far rest is.
    pub(crate) by_any_step: bool,
}

/// Newton's method on one mesh.
pub(crate) struct Descent<'a> {
    pub(crate) objective: &'a Objective<'a>,
    pub(crate) system: System,
    pub(crate) options: &'a NewtonOptions,
    pub(crate) x: Vec<DVec3>,
    /// Iterations so far, those on coarser meshes too.
    pub(crate) iterations: u32,
    /// Number of the mesh: 0 for the one asked for.
    pub(crate) level: u32,
    /// Forces below this are none, N.
    pub(crate) floor: f64,
    /// Shift of the true Hessian, relative to its mean diagonal.
    shift: f64,
}

/// A step that something is in the way of is shortened to no less than this share at a time.
const LEAST_FREE: f64 = 0.1;

/// A step that was made.
struct Step {
    /// Largest motion of a vertex by the whole direction, mm.
    motion_mm: f64,
    /// Share of the direction that was gone.
    length: f64,
    energy: f64,
}

impl<'a> Descent<'a> {
    pub(crate) fn new(
        objective: &'a Objective<'a>,
        system: System,
        options: &'a NewtonOptions,
        x: Vec<DVec3>,
        floor: f64,
    ) -> Self {
        Self { objective, system, options, x, iterations: 0, level: 0, floor, shift: 0.0 }
    }

    /// Descends until the target is met or a budget is spent, with Gauss-Newton steps at first if `curvature` says so.
    pub(crate) fn stage(
        &mut self,
        scales: Scales,
        target: Target,
        mut curvature: Curvature,
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Result<Stop, FoldError> {
        let mut gradient = self.objective.gradient(&self.x, scales);
        let mut energy = self.objective.energy(&self.x, scales);
        loop {
            if let Some(stop) = self.stopped(&gradient, target) {
                return Ok(stop);
            }
            self.system.make_room(self.objective, &self.x)?;
            let Some((step, exact)) = self.step(&gradient, scales, curvature)? else {
                return Ok(Stop::NoDescent);
            };
            gradient = self.told(&step, scales, watch);
            let last = self.again(step, &mut gradient, (scales, target), watch);
            if (exact || target.by_any_step) && last.length == 1.0 && last.motion_mm <= target.motion_mm {
                return Ok(Stop::Motion(target.motion_mm));
            }
            if last.energy > LITTLE_LEFT * energy {
                curvature = Curvature::Exact;
            }
            energy = last.energy;
        }
    }

    /// Leaves the system with a factor at the present positions.
    pub(crate) fn prepare(&mut self) -> Result<(), FoldError> {
        let (rest, scales) = (vec![DVec3::ZERO; self.x.len()], self.options.last_scales());
        match self.exact_direction(&rest, scales, EXACT_TRIES) {
            Some(_) => Ok(()),
            None => self.convex_direction(&rest, scales).map(|_| ()),
        }
    }

    /// Steps by the factor that the system was left with, before there is a new one: a prediction at no cost where the
    /// goals changed little.
    pub(crate) fn predict(&mut self, watch: &mut dyn FnMut(Iteration<'_>)) {
        let (scales, target) = (self.options.last_scales(), self.options.target());
        let mut gradient = self.objective.gradient(&self.x, scales);
        let first = Step { motion_mm: f64::INFINITY, length: 1.0, energy: f64::INFINITY };
        self.again(first, &mut gradient, (scales, target), watch);
    }

    fn stopped(&self, gradient: &GradientSum, target: Target) -> Option<Stop> {
        if gradient.relative(self.floor) <= target.relative_gradient {
            return Some(Stop::Gradient(target.relative_gradient));
        }
        if self.iterations >= self.options.max_iterations {
            return Some(Stop::Iterations(self.options.max_iterations));
        }
        self.options.halt.is_set().then_some(Stop::Halted)
    }

    /// Counts a step and tells it; the gradient after it.
    fn told(&mut self, step: &Step, scales: Scales, watch: &mut dyn FnMut(Iteration<'_>)) -> GradientSum {
        self.iterations += 1;
        let gradient = self.objective.gradient(&self.x, scales);
        watch(Iteration {
            number: self.iterations,
            level: self.level,
            energy: step.energy,
            relative_gradient: gradient.relative(self.floor),
            positions: &self.x,
        });
        gradient
    }

    /// One step with a new factor, and whether it is the true Hessian's, hardly shifted; none if no decrease was found.
    fn step(
        &mut self,
        gradient: &GradientSum,
        scales: Scales,
        curvature: Curvature,
    ) -> Result<Option<(Step, bool)>, FoldError> {
        let tries = if gradient.relative(self.floor) > FAR { 1 } else { EXACT_TRIES };
        let gradient = &gradient.sum;
        if curvature == Curvature::Exact
            && let Some((direction, shift)) = self.exact_direction(gradient, scales, tries)
            && let Some(step) = self.search(&direction, gradient, scales)
        {
            return Ok(Some((step, shift <= FIRST_SHIFT)));
        }
        let direction = self.convex_direction(gradient, scales)?;
        Ok(self.search(&direction, gradient, scales).map(|step| (step, false)))
    }

    /// Goes on with the same factor while that pays; the last step made.
    fn again(
        &mut self,
        mut last: Step,
        gradient: &mut GradientSum,
        (scales, target): (Scales, Target),
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Step {
        for _ in 1..STEPS_PER_FACTOR {
            if last.length < 1.0
                || last.motion_mm <= target.motion_mm
                || self.stopped(gradient, target).is_some()
            {
                break;
            }
            let direction = self.system.direction(&gradient.sum);
            if largest(&direction) > SHRINKS * last.motion_mm {
                break;
            }
            let Some(step) = self.search(&direction, &gradient.sum, scales) else { break };
            *gradient = self.told(&step, scales, watch);
            last = step;
        }
        last
    }

    /// The true Hessian's step, with the least shift of a few that makes it definite, and that shift: a sheet that can
    /// still swing has slightly negative directions, and only the true Hessian sees them.
    fn exact_direction(
        &mut self,
        gradient: &[DVec3],
        scales: Scales,
        tries: u32,
    ) -> Option<(Vec<DVec3>, f64)> {
        let System { hessian, factor, .. } = &mut self.system;
        self.objective.fill_hessian(&self.x, Curvature::Exact, scales, hessian);
        let unit = hessian.mean_diagonal();
        let mut applied = 0.0;
        for _ in 0..tries {
            hessian.shift((self.shift - applied) * unit);
            applied = self.shift;
            if factor.factorise(hessian) {
                self.shift = if self.shift > FIRST_SHIFT { self.shift / SHIFT_DECAY } else { 0.0 };
                return Some((self.system.direction(gradient), applied));
            }
            self.shift = (self.shift * SHIFT_GROWTH).max(FIRST_SHIFT);
        }
        self.shift /= SHIFT_GROWTH;
        None
    }

    /// The Gauss-Newton step with the least shift that makes it solvable.
    fn convex_direction(&mut self, gradient: &[DVec3], scales: Scales) -> Result<Vec<DVec3>, FoldError> {
        let System { hessian, factor, .. } = &mut self.system;
        self.objective.fill_hessian(&self.x, Curvature::Convex, scales, hessian);
        let unit = hessian.mean_diagonal();
        let mut shift = FIRST_SHIFT;
        loop {
            hessian.shift(shift * unit);
            if factor.factorise(hessian) {
                return Ok(self.system.direction(gradient));
            }
            if shift > LARGEST_SHIFT {
                return Err(FoldError::Factorisation(format!("still indefinite with a shift of {shift:e}")));
            }
            shift *= SHIFT_GROWTH;
        }
    }

    /// Moves along `direction` by Armijo's rule; none if it leads nowhere down.
    fn search(&mut self, direction: &[DVec3], gradient: &[DVec3], scales: Scales) -> Option<Step> {
        let slope: f64 = direction.iter().zip(gradient).map(|(d, g)| d.dot(*g)).sum();
        if slope.is_nan() || slope >= 0.0 {
            return None;
        }
        let before = self.objective.energy(&self.x, scales);
        let motion = Motion::new(&self.x, direction);
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let trial = motion.at(length);
            // The way there may be curved; what counts is that the sheet can go there straight without passing through.
            let way: Vec<DVec3> = trial.iter().zip(&self.x).map(|(to, from)| *to - *from).collect();
            let free = self.objective.largest_step(&self.x, &way);
            if free < 1.0 {
                length *= free.max(LEAST_FREE);
                continue;
            }
            let energy = self.objective.energy(&trial, scales);
            // Near the solution the decrease drowns in the energy's rounding.
            let rounding = 4.0 * f64::EPSILON * before.abs();
            if energy <= before + ARMIJO * length * slope + rounding {
                self.x = trial;
                return Some(Step { motion_mm: largest(direction), length, energy });
            }
            length *= 0.5;
        }
        None
    }
}

/// Length of the longest vector.
fn largest(v: &[DVec3]) -> f64 {
    v.iter().map(|p| p.length_squared()).fold(0.0, f64::max).sqrt()
}
