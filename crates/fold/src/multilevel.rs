//! Multilevel Newton: the softened start on a coarse mesh of the sheet, then from mesh to finer mesh.
//!
//! The flat sheet (u, v) carries positions from one mesh to the next. On a coarse mesh the folded shape is found where
//! steps are cheap, only as far as the next mesh needs; a mesh between is folded where the next one would else begin too far
//! from its shape ([`Between`](crate::Between)). On each finer mesh a few moves of eq. 4 take out the wrinkles that carrying made,
//! Gauss-Newton steps go on, and the true Hessian ends it in a few.

use crate::descent::{Descent, System, Target};
use crate::goal::{Curvature, Goal};
use crate::newton::{NewtonOptions, finish, level_record, minimise, ramped};
use crate::objective::Objective;
use crate::pyramid::{Correction, Level, Pyramid, mean_edge_mm};
use crate::relax::{Momentum, smoothed};
use crate::stop::Stop;
use crate::{FoldError, Iteration, check_start};
use glam::DVec3;
use softfold_geometry::{FlatMesh, FoldedSheet, LevelRecord};

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
    let mut descending =
        Descending { pyramid: *pyramid, mesh, options, done: Vec::new(), stop: None, floor: 0.0 };
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
struct Descending<'p, 'a> {
    pyramid: Pyramid<'p>,
    mesh: &'a FlatMesh,
    options: &'a NewtonOptions,
    /// What the meshes so far took.
    done: Vec<LevelRecord>,
    /// The budget that was spent before the mesh asked for was reached.
    stop: Option<Stop>,
    /// Forces below this are none on the coarse meshes, N.
    floor: f64,
}

/// A coarse mesh that is folded.
struct Reached<'a> {
    mesh: &'a FlatMesh,
    positions: Vec<DVec3>,
    /// None on the coarsest.
    correction: Option<Correction>,
}

impl<'p> Descending<'p, '_> {
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
        let levels = self.pyramid.levels;
        let mut reached: Option<Reached<'p>> = None;
        for k in 0..=levels.len() {
            let (next, number) = (levels.get(k), (levels.len() - k) as u32);
            let between =
                reached.as_ref().and_then(|r| self.between(r, k, next.map_or(self.mesh, |l| &l.mesh)));
            let ways = [between.map(|l| (l, number + 1)), next.map(|l| (l, number))];
            for (level, number) in ways.into_iter().flatten() {
                reached = self.fold_level(level, number, (reached, start), watch)?;
                if reached.is_none() || self.stop.is_some() {
                    return Ok(self.carried(reached));
                }
            }
        }
        Ok(self.carried(reached))
    }

    fn carried(&self, reached: Option<Reached<'_>>) -> Option<Vec<DVec3>> {
        reached.map(|r| (self.pyramid.carry)(r.mesh, &r.positions, self.mesh))
    }

    /// The mesh to fold before mesh `k`, which is `next`, if what is carried there would be too far off.
    fn between(&self, reached: &Reached<'_>, k: usize, next: &FlatMesh) -> Option<&'p Level> {
        let between = self.pyramid.between?;
        let off_mm = reached.correction?.predicted_mm(mean_edge_mm(next));
        if off_mm > between.near_mm { (between.mesh)(k) } else { None }
    }

    /// Folds a coarse mesh, from the one before or else from the start; none if what was carried touches itself there.
    fn fold_level(
        &mut self,
        level: &'p Level,
        number: u32,
        (before, start): (Option<Reached<'p>>, &[DVec3]),
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Result<Option<Reached<'p>>, FoldError> {
        let (mesh, carry) = (&level.mesh, self.pyramid.carry);
        let objective = Objective::new(mesh.vertices.len(), &level.goals);
        let from = match &before {
            Some(before) => {
                let carried = carry(before.mesh, &before.positions, mesh);
                let Some(x) = self.arrived(&objective, carried, (number, self.floor), watch) else {
                    return Ok(None);
                };
                x
            }
            None => {
                let flat = carry(self.mesh, start, mesh);
                self.floor = objective.force_floor(&flat);
                flat
            }
        };
        check_start(&objective, mesh, &from)?;
        let positions = self.descend(&objective, level, (&from, number), before.is_none(), watch)?;
        let correction = before.map(|b| Correction::new(mean_edge_mm(b.mesh), mesh, &from, &positions));
        Ok(Some(Reached { mesh, positions, correction }))
    }

    /// Newton's descent on a coarse mesh, as far as the next one needs; with the softened start if asked for.
    fn descend(
        &mut self,
        objective: &Objective<'_>,
        level: &Level,
        (from, number): (&[DVec3], u32),
        softened: bool,
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Result<Vec<DVec3>, FoldError> {
        let system = System::new(objective, &level.mesh.vertices, from)?;
        let mut descent = Descent::new(objective, system, self.options, from.to_vec(), self.floor);
        (descent.iterations, descent.level) = (self.iterations(), number);
        let target = Target {
            relative_gradient: self.options.relative_gradient,
            motion_mm: COARSE_MOTION * mean_edge_mm(&level.mesh),
            by_any_step: true,
        };
        let stop = if softened {
            ramped(&mut descent, target, watch)?
        } else {
            descent.stage(self.options.last_scales(), target, Curvature::Convex, watch)?
        };
        self.done.push(level_record(&descent, &self.done));
        self.stop = stop.is_budget().then_some(stop);
        Ok(descent.x)
    }
}
