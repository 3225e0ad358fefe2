//! Newton's method with a softened start: the default solver, on one mesh.
//!
//! The membrane's stiffness is ramped up (a stiff sheet locks near its flat start, a soft one finds the
//! folded shape), and so is the pull of anchors, bands and planes (at full strength they would crush the soft sheet).
//! The steps are `descent.rs`'s. [`multilevel`](crate::multilevel) does the ramp on a coarse mesh, which is much faster.

use crate::descent::{Descent, System, Target};
use crate::goal::{Curvature, Scales};
use crate::objective::Objective;
use crate::stop::{Halt, Stop, record};
use crate::{FoldError, Iteration};
use glam::{DVec2, DVec3};
use softfold_geometry::{LevelRecord, SolveRecord};

/// Options of the Newton solver.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Scales from the start to the end; the last should be [`Scales::FULL`].
    pub ramp: Vec<Scales>,
    /// Stop when the relative gradient is below this.
    pub relative_gradient: f64,
    /// Stop when a whole step moves no vertex by this much, mm.
    pub motion_mm: f64,
    /// Relative gradient that ends a softened stage.
    pub softened_gradient: f64,
    /// Most iterations in all, those on coarser meshes too.
    pub max_iterations: u32,
    /// Ends it from outside.
    pub halt: Halt,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            ramp: [(1e-2, 1e-5), (1e-1, 1e-4), (1.0, 1e-3), (1.0, 1e-2), (1.0, 1e-1), (1.0, 1.0)]
                .map(|(membrane, hold)| Scales { membrane, hold })
                .to_vec(),
            relative_gradient: 1e-7,
            motion_mm: 1e-4,
            softened_gradient: 1e-2,
            max_iterations: 400,
            halt: Halt::default(),
        }
    }
}

impl NewtonOptions {
    /// Scales at the end.
    pub(crate) fn last_scales(&self) -> Scales {
        self.ramp.last().copied().unwrap_or(Scales::FULL)
    }

    /// What ends the whole.
    pub(crate) fn target(&self) -> Target {
        Target { relative_gradient: self.relative_gradient, motion_mm: self.motion_mm, by_any_step: false }
    }
}

/// Minimises the objective from `start`; `places` are the vertices' flat coordinates, by which they are ordered.
///
/// # Errors
/// [`FoldError::Factorisation`] if no shift makes the matrix definite.
pub fn minimise(
    objective: &Objective<'_>,
    places: &[DVec2],
    start: &[DVec3],
    options: &NewtonOptions,
    watch: &mut dyn FnMut(Iteration<'_>),
) -> Result<(Vec<DVec3>, SolveRecord), FoldError> {
    let system = System::new(objective, places, start)?;
    let floor = objective.force_floor(start);
    let mut descent = Descent::new(objective, system, options, start.to_vec(), floor);
    let stop = ramped(&mut descent, options.target(), watch)?;
    let (x, record, _) = finish(descent, start, stop, Vec::new());
    Ok((x, record))
}

/// Descends through the ramp.
pub(crate) fn ramped(
    descent: &mut Descent<'_>,
    target: Target,
    watch: &mut dyn FnMut(Iteration<'_>),
) -> Result<Stop, FoldError> {
    let options = descent.options;
    let softened =
        Target { relative_gradient: options.softened_gradient, motion_mm: 0.0, by_any_step: false };
    let last = options.ramp.len().saturating_sub(1);
    for &scales in &options.ramp[..last] {
        let stop = descent.stage(scales, softened, Curvature::Exact, watch)?;
        if stop.is_budget() {
            return Ok(stop);
        }
    }
    descent.stage(options.last_scales(), target, Curvature::Exact, watch)
}

/// What a descent has found, with its record and its matrix; its start if a spent budget left it higher than that.
pub(crate) fn finish(
    descent: Descent<'_>,
    start: &[DVec3],
    stop: Stop,
    coarse: Vec<LevelRecord>,
) -> (Vec<DVec3>, SolveRecord, System) {
    let scales = descent.options.last_scales();
    let own = level_record(&descent, &coarse);
    let Descent { objective, system, options, mut x, iterations, floor, .. } = descent;
    if stop.is_budget() && objective.energy(start, scales) < objective.energy(&x, scales) {
        x = start.to_vec();
    }
    let mut record = record("newton", objective, &x, (stop, iterations), (scales, floor));
    record.converged |= record.relative_gradient <= options.relative_gradient;
    record.factorisations = own.factorisations;
    record.levels = coarse;
    record.levels.push(own);
    (x, record, system)
}

/// What a mesh took, after the coarser ones.
pub(crate) fn level_record(descent: &Descent<'_>, coarser: &[LevelRecord]) -> LevelRecord {
    LevelRecord {
        vertices: descent.x.len() as u32,
        iterations: descent.iterations - coarser.iter().map(|l| l.iterations).sum::<u32>(),
        factorisations: descent.system.factorisations(),
        energy: descent.objective.energy(&descent.x, descent.options.last_scales()),
    }
}
