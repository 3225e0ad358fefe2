//! The goals: each one file with energy, gradient, Hessian and the moves of eq. 4.

mod anchor;
mod area;
mod attract;
mod bend;
mod clamp_length;
mod co_planar;
mod edge_lengths;
mod floor;
mod glue;
mod hinge;
mod load;
mod on_curve;
mod on_mesh;
mod on_plane;
mod self_collide;
mod sphere_collide;
#[cfg(test)]
mod sweep_tests;
#[cfg(test)]
pub(crate) mod testing;

pub use anchor::Anchor;
pub use area::Area;
pub use attract::{Attract, Nearest, Target, TargetError};
pub use bend::Plate;
pub use clamp_length::ClampLength;
pub use co_planar::{COUPLED_POINTS, CoPlanar};
pub use edge_lengths::EdgeLengths;
pub use floor::Floor;
pub use glue::Glue;
pub use hinge::{Hinge, Hinges};
pub use load::{EARTH_GRAVITY, Load};
pub use on_curve::{OnCurve, SpaceCurve};
pub use on_mesh::{OnMesh, TriangleMesh};
pub use on_plane::OnPlane;
pub use self_collide::{Clearance, SelfCollide, SelfCollideOptions, self_clearance};
pub use sphere_collide::SphereCollide;

use crate::hessian::BlockSink;
use glam::{DMat3, DVec3};

/// The part a goal plays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Keeps the sheet from stretching.
    Membrane,
    /// Bends and folds it.
    Bending,
    /// Holds or pulls it from outside.
    Hold,
    /// Keeps it out of itself and of what it lies on. Never softened: what has gone through does not come back.
    Contact,
}

/// Factors on the goals' energies, by part; bending and contacts are never scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Factor on the membrane.
    pub membrane: f64,
    /// Factor on what holds the sheet.
    pub hold: f64,
}

impl Scales {
    /// The energy as it is.
    pub const FULL: Self = Self { membrane: 1.0, hold: 1.0 };

    /// Factor for a part.
    pub fn of(self, part: Part) -> f64 {
        match part {
            Part::Membrane => self.membrane,
            Part::Bending | Part::Contact => 1.0,
            Part::Hold => self.hold,
        }
    }
}

/// Which Hessian is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// The true second derivative, possibly indefinite.
    Exact,
    /// A positive semidefinite stand-in (Gauss-Newton), for steps far from the solution.
    Convex,
}

/// An energy over the vertices' positions.
pub trait Goal: Send + Sync {
    /// Name for the report.
    fn name(&self) -> &str;

    /// Kind for the report: the type's name.
    fn kind(&self) -> &'static str;

    /// Which part it plays, by which the softened start scales it.
    fn part(&self) -> Part;

    /// Groups of vertices that the Hessian couples wherever they are.
    fn couplings(&self) -> Vec<Vec<u32>>;

    /// Pairs of vertices that the Hessian couples at `x` besides: contacts, which come and go. With a `margin`
    /// also those that are apart by up to that share of the contact distance more.
    fn contacts(&self, _x: &[DVec3], _margin: f64) -> Vec<[u32; 2]> {
        Vec::new()
    }

    /// The largest share of a step from `x`, at most 1, on all of which the energy surely stays finite: barriers must
    /// not be leapt over. 1 for energies without barriers.
    fn largest_step(&self, _x: &[DVec3], _step: &[DVec3]) -> f64 {
        1.0
    }

    /// The energy.
    fn energy(&self, x: &[DVec3]) -> f64;

    /// Adds the gradient.
    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>);

    /// Adds the Hessian.
    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>);

    /// Adds the moves of eq. 4, weighted so that `Σ w G = −∇E`.
    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>);

    /// How far from its aim the goal is, in mm or rad as its kind says: the largest |G|.
    fn residual(&self, x: &[DVec3]) -> f64;
}

/// Where goals add their gradients.
pub struct Gradient<'a> {
    /// Sum of the terms, per vertex.
    pub sum: &'a mut [DVec3],
    /// Sum of the terms' magnitudes, per vertex: the scale that makes a residual relative.
    pub magnitude: &'a mut [f64],
    pub(crate) scale: f64,
}

impl Gradient<'_> {
    /// Adds one term.
    pub fn add(&mut self, vertex: u32, term: DVec3) {
        let term = self.scale * term;
        self.sum[vertex as usize] += term;
        self.magnitude[vertex as usize] += term.length();
    }
}

/// Where goals add their Hessians.
pub struct HessianSink<'a> {
    pub(crate) matrix: &'a mut dyn BlockSink,
    pub(crate) scale: f64,
}

impl HessianSink<'_> {
    /// Adds the block ∂²E/∂xᵢ∂xⱼ. Of each pair i ≠ j both blocks may be given; one is enough and only
    /// the one with i > j is kept.
    pub fn add(&mut self, i: u32, j: u32, block: DMat3) {
        self.matrix.add(i, j, self.scale * block);
    }
}

/// Where goals add the moves of eq. 4.
pub struct Moves<'a> {
    pub(crate) weighted: &'a mut [DVec3],
    pub(crate) weights: &'a mut [f64],
}

impl Moves<'_> {
    /// Adds a vertex's move `step` (mm) with weight `weight` (N/mm).
    pub fn add(&mut self, vertex: u32, weight: f64, step: DVec3) {
        self.weighted[vertex as usize] += weight * step;
        self.weights[vertex as usize] += weight;
    }
}

/// `a bᵀ`.
pub(crate) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The matrix of `a ×`.
pub(crate) fn cross_matrix(a: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, a.z, -a.y), DVec3::new(-a.z, 0.0, a.x), DVec3::new(a.y, -a.x, 0.0))
}
