//! Newton's method with a softened start: the default solver.
//!
//! The membrane's stiffness is ramped up (a stiff sheet locks near its flat start, a soft one finds the
//! folded shape), and so is the pull of anchors, bands and planes (at full strength they would crush the soft sheet). Each step solves `H d = −∇E` by a supernodal LLᵀ whose symbolic part is made once: the true
//! Hessian where it is positive definite, else the Gauss-Newton one with a small shift; Armijo's rule on the energy.

use crate::goal::{Curvature, Scales};
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
    /// Scales from the start to the end; the last should be [`Scales::FULL`].
    pub ramp: Vec<Scales>,
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
            ramp: [(1e-2, 1e-5), (1e-1, 1e-4), (1.0, 1e-3), (1.0, 1e-2), (1.0, 1e-1), (1.0, 1.0)]
                .map(|(membrane, hold)| Scales { membrane, hold })
                .to_vec(),
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
const SHIFT_GROWTH: f64 = 30.0;
/// Decay of the shift after a successful one.
const SHIFT_DECAY: f64 = 10.0;
/// Factorisations of the true Hessian before the Gauss-Newton one is taken.
const EXACT_TRIES: u32 = 4;
/// Room in the matrix for contacts that are not yet, as share of the contact distance: its symbolic part, which costs
/// as much as a few steps, is made anew only when vertices have come that much nearer.
const CONTACT_MARGIN: f64 = 0.25;
/// Shift beyond which the step is a gradient step: giving up is honest.
const LARGEST_SHIFT: f64 = 1e3;

struct Newton<'a> {
    objective: &'a Objective<'a>,
    symbolic: SymbolicLlt<usize>,
    hessian: Hessian,
    x: Vec<DVec3>,
    iterations: u32,
    /// Shift of the true Hessian, relative to its mean diagonal.
    shift: f64,
    /// Forces below this are none, N.
    floor: f64,
}

/// How a stage ended.
pub(crate) enum Stop {
    /// The relative gradient is below its target.
    Converged,
    /// The iterations are spent.
    Budget,
    /// No step lowers the energy.
    NoDescent,
}

impl Stop {
    /// For the record.
    pub(crate) fn words(&self, relative_gradient: f64, max_iterations: u32) -> String {
        match self {
            Stop::Converged => format!("relative gradient below {relative_gradient:e}"),
            Stop::Budget => format!("budget of {max_iterations} iterations spent"),
            Stop::NoDescent => "no step lowers the energy any more".to_owned(),
        }
    }
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
    let hessian = objective.hessian_at(start, CONTACT_MARGIN);
    let symbolic = SymbolicLlt::try_new(hessian.symbolic(), Side::Lower).map_err(factorisation)?;
    let mut newton = Newton {
        objective,
        symbolic,
        hessian,
        x: start.to_vec(),
        iterations: 0,
        shift: 0.0,
        floor: objective.force_floor(start),
    };
    let mut stop = Stop::Converged;
    for (i, &scales) in options.ramp.iter().enumerate() {
        let last = i + 1 == options.ramp.len();
        let target = if last { options.relative_gradient } else { options.softened_gradient };
        stop = newton.stage(scales, target, options.max_iterations, watch)?;
    }
    Ok(newton.finish(&stop, options))
}

impl Newton<'_> {
    fn stage(
        &mut self,
        scales: Scales,
        target: f64,
        budget: u32,
        watch: &mut dyn FnMut(Iteration),
    ) -> Result<Stop, FoldError> {
        let mut gradient = self.objective.gradient(&self.x, scales);
        while gradient.relative(self.floor) > target {
            if self.iterations >= budget {
                return Ok(Stop::Budget);
            }
            if !self.step(&gradient.sum, scales)? {
                return Ok(Stop::NoDescent);
            }
            self.iterations += 1;
            gradient = self.objective.gradient(&self.x, scales);
            let energy = self.objective.energy(&self.x, scales);
            watch(Iteration {
                number: self.iterations,
                energy,
                relative_gradient: gradient.relative(self.floor),
            });
        }
        Ok(Stop::Converged)
    }

    /// One step; false if no decrease was found along it.
    fn step(&mut self, gradient: &[DVec3], scales: Scales) -> Result<bool, FoldError> {
        self.make_room_for_contacts()?;
        if let Some(direction) = self.exact_direction(gradient, scales)
            && self.search(&direction, gradient, scales)
        {
            return Ok(true);
        }
        let direction = self.convex_direction(gradient, scales)?;
        Ok(self.search(&direction, gradient, scales))
    }

    /// Makes the matrix anew when vertices have met that it does not couple.
    fn make_room_for_contacts(&mut self) -> Result<(), FoldError> {
        if !self.hessian.holds(&self.objective.contacts(&self.x, 0.0)) {
            self.hessian = self.objective.hessian_at(&self.x, CONTACT_MARGIN);
            self.symbolic =
                SymbolicLlt::try_new(self.hessian.symbolic(), Side::Lower).map_err(factorisation)?;
        }
        Ok(())
    }

    /// The true Hessian's step, with the least shift of a few that makes it definite: a sheet that can
    /// still swing has slightly negative directions, and only the true Hessian sees them.
    fn exact_direction(&mut self, gradient: &[DVec3], scales: Scales) -> Option<Vec<DVec3>> {
        self.objective.fill_hessian(&self.x, Curvature::Exact, scales, &mut self.hessian);
        let unit = self.hessian.mean_diagonal();
        let mut applied = 0.0;
        for _ in 0..EXACT_TRIES {
            self.hessian.shift((self.shift - applied) * unit);
            applied = self.shift;
            if let Ok(direction) = self.solve(gradient) {
                self.shift = if self.shift > FIRST_SHIFT { self.shift / SHIFT_DECAY } else { 0.0 };
                return Some(direction);
            }
            self.shift = (self.shift * SHIFT_GROWTH).max(FIRST_SHIFT);
        }
        self.shift /= SHIFT_GROWTH;
        None
    }

    /// The Gauss-Newton step with the least shift that makes it solvable.
    fn convex_direction(&mut self, gradient: &[DVec3], scales: Scales) -> Result<Vec<DVec3>, FoldError> {
        self.objective.fill_hessian(&self.x, Curvature::Convex, scales, &mut self.hessian);
        let unit = self.hessian.mean_diagonal();
        let mut shift = FIRST_SHIFT;
        loop {
            self.hessian.shift(shift * unit);
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
    fn search(&mut self, direction: &[DVec3], gradient: &[DVec3], scales: Scales) -> bool {
        let slope: f64 = direction.iter().zip(gradient).map(|(d, g)| d.dot(*g)).sum();
        if slope.is_nan() || slope >= 0.0 {
            return false;
        }
        let before = self.objective.energy(&self.x, scales);
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let trial: Vec<DVec3> = self.x.iter().zip(direction).map(|(x, d)| *x + length * *d).collect();
            let after = self.objective.energy(&trial, scales);
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
        let scales = options.ramp.last().copied().unwrap_or(Scales::FULL);
        let relative_gradient = self.objective.gradient(&self.x, scales).relative(self.floor);
        let record = SolveRecord {
            solver: "newton".into(),
            iterations: self.iterations,
            energy: self.objective.energy(&self.x, scales),
            relative_gradient,
            converged: relative_gradient <= options.relative_gradient,
            stop: stop.words(options.relative_gradient, options.max_iterations),
        };
        (self.x, record)
    }
}

pub(crate) fn factorisation(e: impl std::fmt::Debug) -> FoldError {
    FoldError::Factorisation(format!("{e:?}"))
}
