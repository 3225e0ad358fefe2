//! Multilevel Newton: the softened start on a coarse mesh of the sheet, then from mesh to finer mesh.
//!
//! The flat sheet (u, v) carries positions from one mesh to the next. On a coarse mesh the folded shape is found where
//! steps are cheap, only as far as the next mesh needs; there a few moves of eq. 4 take out the wrinkles that carrying made,
//! Gauss-Newton steps go on, and the true Hessian ends it in a few.

use crate::descent::{Descent, System, Target};
use crate::goal::{Curvature, Goal};
use crate::newton::{NewtonOptions, finish, level_record, minimise, ramped};
use crate::objective::Objective;
use crate::relax::{Momentum, smoothed};
use crate::stop::Stop;
use crate::{FoldError, Iteration, check_start};
use glam::DVec3;
use softfold_geometry::{EdgeId, FlatMesh, FoldedSheet, LevelRecord};

/// A coarse mesh of the same sheet, with the goals on it.
pub struct Level {
    /// The mesh.
    pub mesh: FlatMesh,
    /// Its goals: the same physics as on the mesh asked for.
    pub goals: Vec<Box<dyn Goal>>,
}

/// Positions at the vertices of one mesh carried to those of another mesh of the same sheet: `carry(from, positions,
/// to)`. Exact for linear fields is enough: it does not round creases, and wrinkles are taken out first thing.
pub type Carry<'a> = dyn Fn(&FlatMesh, &[DVec3], &FlatMesh) -> Vec<DVec3> + 'a;

/// Coarse meshes of a sheet, the coarsest first.
pub struct Pyramid<'a> {
    /// The meshes.
    pub levels: &'a [Level],
    /// How positions go from mesh to mesh.
    pub carry: &'a Carry<'a>,
}

/// A coarse mesh is done when a whole step moves no vertex by this share of its mean edge: less than what the next mesh
/// differs from it anyway.
const COARSE_MOTION: f64 = 0.1;
/// Moves of eq. 4 on what was carried, each as cheap as a gradient: they take out the wrinkles that would throw the first
/// Newton step off.
const MOVES: u32 = 5;
/// Share of each move that goes on into the next.
const MOMENTUM: Momentum = Momentum::Share(0.8);

/// Folds a mesh through a pyramid of coarser ones; as [`fold`](crate::fold) with an empty one.
///
/// Where the mesh asked for cannot be brought to rest from what the coarser ones found, it is folded alone, and the state
/// of the lower energy is kept.
///
/// # Errors
/// [`FoldError`]; not reaching the tolerance is none: the record says `converged = false`.
pub fn fold_multilevel(
    pyramid: &Pyramid<'_>,
    mesh: &FlatMesh,
    goals: &[Box<dyn Goal>],
    start: &[DVec3],
    options: &NewtonOptions,
    watch: &mut dyn FnMut(Iteration<'_>),
) -> Result<FoldedSheet, FoldError> {
    let objective = Objective::new(mesh.vertices.len(), goals);
    check_start(&objective, mesh, start)?;
    let mut descending = Descending { pyramid, mesh, options, done: Vec::new(), stop: None };
    let floor = objective.force_floor(start);
    let carried = descending.coarse(start, watch)?;
    let folded = carried.and_then(|x| descending.arrived(&objective, x, (0, floor), watch));
    let Some(folded) = folded else {
        let (positions, solve) = minimise(&objective, &mesh.vertices, start, options, watch)?;
        return Ok(FoldedSheet { mesh: mesh.clone(), positions, solve });
    };
    let system = System::new(&objective, &mesh.vertices, &folded)?;
    let mut descent = Descent::new(&objective, system, options, folded, floor);
    descent.iterations = descending.iterations();
    let stop = match descending.stop {
        Some(stop) => stop,
        None => descent.stage(options.last_scales(), options.target(), Curvature::Convex, watch)?,
    };
    let (mut positions, mut solve, _) = finish(descent, start, stop, descending.done);
    if !solve.converged && !stop.is_budget() {
        let (alone, record) = minimise(&objective, &mesh.vertices, start, options, watch)?;
        if record.energy < solve.energy {
            (positions, solve) = (alone, record);
        }
    }
    Ok(FoldedSheet { mesh: mesh.clone(), positions, solve })
}

/// The way down to the mesh asked for.
struct Descending<'a> {
    pyramid: &'a Pyramid<'a>,
    mesh: &'a FlatMesh,
    options: &'a NewtonOptions,
    /// What the meshes so far took.
    done: Vec<LevelRecord>,
    /// The budget that was spent before the mesh asked for was reached.
    stop: Option<Stop>,
}

impl Descending<'_> {
    fn iterations(&self) -> u32 {
        self.done.iter().map(|l| l.iterations).sum()
    }

    /// What was carried to a mesh, evened out, and told; none if it touches itself there, where nothing touched.
    fn arrived(
        &self,
        objective: &Objective<'_>,
        carried: Vec<DVec3>,
        (level, floor): (u32, f64),
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Option<Vec<DVec3>> {
        let scales = self.options.last_scales();
        let before = objective.energy(&carried, scales);
        if !before.is_finite() {
            return None;
        }
        let smooth = smoothed(objective, &carried, MOVES, MOMENTUM);
        let after = objective.energy(&smooth, scales);
        let (positions, energy) = if after < before { (smooth, after) } else { (carried, before) };
        watch(Iteration {
            number: self.iterations(),
            level,
            energy,
            relative_gradient: objective.gradient(&positions, scales).relative(floor),
            positions: &positions,
        });
        Some(positions)
    }

    /// Positions on the mesh asked for, carried from the coarse ones; none if there are none.
    fn coarse(
        &mut self,
        start: &[DVec3],
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Result<Option<Vec<DVec3>>, FoldError> {
        let Pyramid { levels, carry } = *self.pyramid;
        let (mut folded, mut floor): (Option<Vec<DVec3>>, f64) = (None, 0.0);
        for (k, level) in levels.iter().enumerate() {
            let objective = Objective::new(level.mesh.vertices.len(), &level.goals);
            let number = (levels.len() - k) as u32;
            let from = match folded {
                Some(x) => {
                    let carried = carry(&levels[k - 1].mesh, &x, &level.mesh);
                    let Some(x) = self.arrived(&objective, carried, (number, floor), watch) else {
                        return Ok(None);
                    };
                    x
                }
                None => {
                    let flat = carry(self.mesh, start, &level.mesh);
                    floor = objective.force_floor(&flat);
                    flat
                }
            };
            check_start(&objective, &level.mesh, &from)?;
            let system = System::new(&objective, &level.mesh.vertices, &from)?;
            let mut descent = Descent::new(&objective, system, self.options, from, floor);
            (descent.iterations, descent.level) = (self.iterations(), number);
            let target = Target {
                relative_gradient: self.options.relative_gradient,
                motion_mm: COARSE_MOTION * mean_edge_mm(&level.mesh),
                by_any_step: true,
            };
            let stop = match k {
                0 => ramped(&mut descent, target, watch)?,
                _ => descent.stage(self.options.last_scales(), target, Curvature::Convex, watch)?,
            };
            self.done.push(level_record(&descent, &self.done));
            folded = Some(descent.x);
            if stop.is_budget() {
                self.stop = Some(stop);
                break;
            }
        }
        let last = self.done.len().saturating_sub(1);
        Ok(folded.map(|x| carry(&levels[last].mesh, &x, self.mesh)))
    }
}

fn mean_edge_mm(mesh: &FlatMesh) -> f64 {
    let sum: f64 = (0..mesh.edges.len()).map(|e| mesh.edge_length_mm(EdgeId::new(e))).sum();
    sum / mesh.edges.len().max(1) as f64
}
