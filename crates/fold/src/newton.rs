//! Newton's method with a softened start: the default solver.
//!
//! The membrane's stiffness is ramped up (a stiff sheet locks near its flat start, a soft one finds the
//! folded shape). Each step solves `H d = −∇E` by a supernodal LLᵀ whose symbolic part is made once: the true
//! Hessian where it is positive definite, else the Gauss-Newton one with a small shift; Armijo's rule on the energy.

use crate::goal::Curvature;
use crate::hessian::Hessian;
use crate::objective::Objective;
use crate::{FoldError, Iteration};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::{Col, Side};
use glam::DVec3;
use softfold_geometry::SolveRecord;

/// Options of the Newton solver.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Membrane scales from the start to the end; the last should be 1.
    pub membrane_ramp: Vec<f64>,
    /// Stop when the relative gradient is below this.
    pub relative_gradient: f64,
    /// Relative gradient that ends a softened stage.
    pub softened_gradient: f64,
    /// Most iterations in all.
    pub max_iterations: u32,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            membrane_ramp: vec![1e-2, 1e-1, 1.0],
            relative_gradient: 1e-7,
            softened_gradient: 1e-2,
            max_iterations: 400,
        }
    }
}

/// Share of the predicted decrease that a step must achieve (Armijo).
const ARMIJO: f64 = 1e-4;
/// Halvings of a step before it is given up: 2⁻³⁰ of a step moves nothing.
const MAX_HALVINGS: u32 = 30;
/// First shift, relative to the mean diagonal: keeps rigid motions of a free sheet solvable.
const FIRST_SHIFT: f64 = 1e-9;
/// Growth of the shift after a failed factorisation.
const SHIFT_GROWTH: f64 = 100.0;
/// Shift beyond which the step is a gradient step: giving up is honest.
const LARGEST_SHIFT: f64 = 1e3;

struct Newton<'a> {
    objective: &'a Objective<'a>,
    symbolic: SymbolicLlt<usize>,
    hessian: Hessian,
    x: Vec<DVec3>,
    iterations: u32,
}

/// How a stage ended.
enum Stop {
    Converged,
    Budget,
    NoDescent,
}

/// Minimises the objective from `start`.
///
/// # Errors
/// [`FoldError::Factorisation`] if no shift makes the matrix definite.
pub fn minimise(
    objective: &Objective<'_>,
    start: &[DVec3],
    options: &NewtonOptions,
    watch: &mut dyn FnMut(Iteration),
) -> Result<(Vec<DVec3>, SolveRecord), FoldError> {
    let hessian = objective.empty_hessian();
    let symbolic = SymbolicLlt::try_new(hessian.symbolic(), Side::Lower).map_err(factorisation)?;
    let mut newton = Newton { objective, symbolic, hessian, x: start.to_vec(), iterations: 0 };
    let mut stop = Stop::Converged;
    for (i, &membrane) in options.membrane_ramp.iter().enumerate() {
        let last = i + 1 == options.membrane_ramp.len();
        let target = if last { options.relative_gradient } else { options.softened_gradient };
        stop = newton.stage(membrane, target, options.max_iterations, watch)?;
    }
    Ok(newton.finish(&stop, options))
}

impl Newton<'_> {
    fn stage(
        &mut self,
        membrane: f64,
        target: f64,
        budget: u32,
        watch: &mut dyn FnMut(Iteration),
    ) -> Result<Stop, FoldError> {
        let mut gradient = self.objective.gradient(&self.x, membrane);
        while gradient.relative() > target {
            if self.iterations >= budget {
                return Ok(Stop::Budget);
            }
            if !self.step(&gradient.sum, membrane)? {
                return Ok(Stop::NoDescent);
            }
            self.iterations += 1;
            gradient = self.objective.gradient(&self.x, membrane);
            let energy = self.objective.energy(&self.x, membrane);
            watch(Iteration { number: self.iterations, energy, relative_gradient: gradient.relative() });
        }
        Ok(Stop::Converged)
    }

    /// One step; false if no decrease was found along it.
    fn step(&mut self, gradient: &[DVec3], membrane: f64) -> Result<bool, FoldError> {
        self.objective.fill_hessian(&self.x, Curvature::Exact, membrane, &mut self.hessian);
        if let Ok(direction) = self.solve(gradient)
            && self.search(&direction, gradient, membrane)
        {
            return Ok(true);
        }
        let direction = self.convex_direction(gradient, membrane)?;
        Ok(self.search(&direction, gradient, membrane))
    }

    fn convex_direction(&mut self, gradient: &[DVec3], membrane: f64) -> Result<Vec<DVec3>, FoldError> {
        self.objective.fill_hessian(&self.x, Curvature::Convex, membrane, &mut self.hessian);
        let scale = self.hessian.mean_diagonal();
        let mut shift = FIRST_SHIFT;
        loop {
            self.hessian.shift(shift * scale);
            match self.solve(gradient) {
                Ok(direction) => return Ok(direction),
                Err(e) if shift > LARGEST_SHIFT => return Err(e),
                Err(_) => shift *= SHIFT_GROWTH,
            }
        }
    }

    fn solve(&self, gradient: &[DVec3]) -> Result<Vec<DVec3>, FoldError> {
        let llt = Llt::try_new_with_symbolic(self.symbolic.clone(), self.hessian.matrix(), Side::Lower)
            .map_err(factorisation)?;
        let rhs = Col::from_fn(3 * gradient.len(), |i| -gradient[i / 3][i % 3]);
        let d = llt.solve(&rhs);
        Ok((0..gradient.len()).map(|i| DVec3::new(d[3 * i], d[3 * i + 1], d[3 * i + 2])).collect())
    }

    /// Moves along `direction` by Armijo's rule; false if it leads nowhere down.
    fn search(&mut self, direction: &[DVec3], gradient: &[DVec3], membrane: f64) -> bool {
        let slope: f64 = direction.iter().zip(gradient).map(|(d, g)| d.dot(*g)).sum();
        if slope.is_nan() || slope >= 0.0 {
            return false;
        }
        let before = self.objective.energy(&self.x, membrane);
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let trial: Vec<DVec3> = self.x.iter().zip(direction).map(|(x, d)| *x + length * *d).collect();
            let after = self.objective.energy(&trial, membrane);
            // Near the solution the decrease drowns in the energy's rounding.
            let rounding = 4.0 * f64::EPSILON * before.abs();
            if after <= before + ARMIJO * length * slope + rounding {
                self.x = trial;
                return true;
            }
            length *= 0.5;
        }
        false
    }

    fn finish(self, stop: &Stop, options: &NewtonOptions) -> (Vec<DVec3>, SolveRecord) {
        let membrane = options.membrane_ramp.last().copied().unwrap_or(1.0);
        let relative_gradient = self.objective.gradient(&self.x, membrane).relative();
        let why = match stop {
            Stop::Converged => format!("relative gradient below {:e}", options.relative_gradient),
            Stop::Budget => format!("budget of {} iterations spent", options.max_iterations),
            Stop::NoDescent => "no step lowers the energy any more".to_owned(),
        };
        let record = SolveRecord {
            solver: "newton".into(),
            iterations: self.iterations,
            energy: self.objective.energy(&self.x, membrane),
            relative_gradient,
            converged: relative_gradient <= options.relative_gradient,
            stop: why,
        };
        (self.x, record)
    }
}

fn factorisation(e: impl std::fmt::Debug) -> FoldError {
    FoldError::Factorisation(format!("{e:?}"))
}
