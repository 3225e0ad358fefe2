//! Folding again and again with goals that change a little: a slider.

use crate::descent::{Descent, System};
use crate::goal::{Curvature, Goal};
use crate::newton::{NewtonOptions, finish};
use crate::objective::Objective;
use crate::{FoldError, Iteration, check_start};
use glam::DVec3;
use softfold_geometry::{FlatMesh, FoldedSheet};

/// A folded sheet that follows its goals: each update starts where the last one ended, without the softened start, and keeps the
/// order of elimination and the symbolic factor as long as the goals couple the same vertices.
pub struct Session {
    mesh: FlatMesh,
    options: NewtonOptions,
    positions: Vec<DVec3>,
    system: Option<System>,
}

impl Session {
    /// A session that goes on from a sheet that was folded with these goals. Costs a factorisation or a few, from which the
    /// first update is predicted.
    ///
    /// # Errors
    /// [`FoldError`]: goals that give no finite energy there, no memory for the factor.
    pub fn new(
        sheet: &FoldedSheet,
        goals: &[Box<dyn Goal>],
        options: NewtonOptions,
    ) -> Result<Self, FoldError> {
        let FoldedSheet { mesh, positions, .. } = sheet.clone();
        let objective = Objective::new(mesh.vertices.len(), goals);
        check_start(&objective, &mesh, &positions)?;
        let system = System::new(&objective, &mesh.vertices, &positions)?;
        let mut descent = Descent::new(&objective, system, &options, positions, 0.0);
        descent.prepare()?;
        let Descent { system, x: positions, .. } = descent;
        Ok(Self { mesh, options, positions, system: Some(system) })
    }

    /// Folds to the equilibrium of these goals: other angles, other weights, other targets.
    ///
    /// # Errors
    /// [`FoldError`]; not reaching the tolerance is none: the record says `converged = false`. After an error the session
    /// stands where it stood.
    pub fn update(
        &mut self,
        goals: &[Box<dyn Goal>],
        watch: &mut dyn FnMut(Iteration<'_>),
    ) -> Result<FoldedSheet, FoldError> {
        let objective = Objective::new(self.mesh.vertices.len(), goals);
        check_start(&objective, &self.mesh, &self.positions)?;
        let kept = self.system.take().filter(|s| s.fits(&objective));
        let has_factor = kept.is_some();
        let mut system = match kept {
            Some(system) => system,
            None => System::new(&objective, &self.mesh.vertices, &self.positions)?,
        };
        system.begin_count();
        let floor = objective.force_floor(&self.positions);
        let mut descent = Descent::new(&objective, system, &self.options, self.positions.clone(), floor);
        let scales = self.options.last_scales();
        if has_factor {
            descent.predict(watch);
        }
        let stop = descent.stage(scales, self.options.target(), Curvature::Convex, watch)?;
        let (positions, solve, system) = finish(descent, &self.positions, stop, Vec::new());
        (self.positions, self.system) = (positions.clone(), Some(system));
        Ok(FoldedSheet { mesh: self.mesh.clone(), positions, solve })
    }
}
