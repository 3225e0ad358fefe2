//! Folding: flat mesh and goals in, equilibrium positions out.
//!
//! A goal is an energy `E = ½ w Σ |G|²` whose moves `G` bring its vertices to the nearest
//! admissible place; the folded sheet minimises the sum. Solvers share it: [`relax`] is the
//! paper's eq. 4 as printed, [`newton`] (the default) is what one uses, through a pyramid of coarser meshes by
//! [`multilevel`], [`lbfgs`] is for where memory is short.
//!
//! Source: Koschitz, Foschi, Maleczek, *Algorithmic Design and Fabrication of Soft Curved-Folding*.

pub mod address;
pub mod analyse;
#[cfg(test)]
mod collide_tests;
mod descent;
mod factor;
pub mod goal;
mod hessian;
mod laplacian;
pub mod lbfgs;
mod material;
mod motion;
pub mod multilevel;
#[cfg(test)]
mod multilevel_tests;
pub mod newton;
mod objective;
mod order;
mod patch;
#[cfg(test)]
mod plate_tests;
pub mod pyramid;
pub mod relax;
#[cfg(test)]
mod relax_tests;
#[cfg(test)]
mod rest_tests;
pub mod schedule;
pub mod session;
#[cfg(test)]
mod solver_tests;
mod stop;
pub mod strength;
#[cfg(test)]
mod testing;

pub use address::{
    AddressError, AlongCurve, SheetPoint, boundary_vertices, in_region, locate, on_crease, on_outline,
};
pub use analyse::{Verdict, analyse};
pub use goal::{
    Anchor, Area, ClampLength, Clearance, CoPlanar, EARTH_GRAVITY, EdgeLengths, Floor, Glue, Goal, Hinges,
    Load, OnCurve, OnMesh, OnPlane, Part, Plate, Scales, SelfCollide, SelfCollideOptions, SpaceCurve,
    SphereCollide, TargetError, TriangleMesh, self_clearance,
};
pub use lbfgs::LbfgsOptions;
pub use material::{FREE_FACTOR, FaceBending, SheetMaterial};
pub use multilevel::fold_multilevel;
pub use newton::NewtonOptions;
pub use objective::Objective;
pub use pyramid::{Between, Carry, Level, Pyramid};
pub use relax::{Momentum, RelaxOptions};
pub use session::Session;
pub use stop::Halt;
pub use strength::Weights;

use glam::DVec3;
use softfold_geometry::{FlatMesh, FoldedSheet};

/// Which solver, with its options.
#[derive(Clone, Debug, PartialEq)]
pub enum Solver {
    /// Newton's method with a softened start.
    Newton(NewtonOptions),
    /// L-BFGS on a prefactored Laplacian.
    Lbfgs(LbfgsOptions),
    /// The paper's eq. 4.
    Relax(RelaxOptions),
}

impl Default for Solver {
    fn default() -> Self {
        Solver::Newton(NewtonOptions::default())
    }
}

/// One iteration, told to whoever watches; and what a mesh begins with that takes over from a coarser one, by the number of
/// the iteration before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration<'a> {
    /// Number of the iteration, from 1.
    pub number: u32,
    /// How many meshes are still to come: 0 on the mesh asked for.
    pub level: u32,
    /// Energy after it.
    pub energy: f64,
    /// Relative gradient after it.
    pub relative_gradient: f64,
    /// Positions after it, on the mesh of its level.
    pub positions: &'a [DVec3],
}

/// Why folding could not begin or go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FoldError {
    /// A start position is not finite, or their number is not the mesh's.
    #[error("{0} start positions for {1} vertices, or one that is not finite")]
    Start(usize, usize),
    /// The energy is not finite at the start.
    #[error(
        "the energy is not finite at the start; goal `{goal}` gives {energy}: look at its strength and target"
    )]
    NotFinite {
        /// Name of the goal.
        goal: String,
        /// Its energy.
        energy: f64,
    },
    /// The linear solver gave up.
    #[error("the linear system of the Newton step cannot be factorised even with a shift: {0}")]
    Factorisation(String),
}

/// The flat sheet standing upright: `(u, v) ↦ (u − u₀, 0, v − v₀)` with the middle of its foot at the
/// origin; its front looks towards −y.
pub fn upright(mesh: &FlatMesh) -> Vec<DVec3> {
    let (lo, hi) = softfold_geometry::polygon::bounds(&mesh.vertices);
    let middle = 0.5 * (lo.x + hi.x);
    mesh.vertices.iter().map(|p| DVec3::new(p.x - middle, 0.0, p.y - lo.y)).collect()
}

/// Folds a mesh: minimises the goals' energy from `start`.
///
/// # Errors
/// [`FoldError`]; not reaching the tolerance is none: the record says `converged = false`.
pub fn fold(
    mesh: &FlatMesh,
    goals: &[Box<dyn Goal>],
    start: &[DVec3],
    solver: &Solver,
    watch: &mut dyn FnMut(Iteration<'_>),
) -> Result<FoldedSheet, FoldError> {
    let objective = Objective::new(mesh.vertices.len(), goals);
    check_start(&objective, mesh, start)?;
    let (positions, solve) = match solver {
        Solver::Newton(options) => newton::minimise(&objective, &mesh.vertices, start, options, watch)?,
        Solver::Lbfgs(options) => lbfgs::minimise(&objective, start, options, watch)?,
        Solver::Relax(options) => relax::minimise(&objective, start, options, watch),
    };
    Ok(FoldedSheet { mesh: mesh.clone(), positions, solve })
}

fn check_start(objective: &Objective<'_>, mesh: &FlatMesh, start: &[DVec3]) -> Result<(), FoldError> {
    if start.len() != mesh.vertices.len() || start.iter().any(|p| !p.is_finite()) {
        return Err(FoldError::Start(start.len(), mesh.vertices.len()));
    }
    for (goal, energy) in objective.energies(start) {
        if !energy.is_finite() {
            return Err(FoldError::NotFinite { goal, energy });
        }
    }
    Ok(())
}
