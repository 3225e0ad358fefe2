//! The goals: each one file with energy, gradient, Hessian and the moves of eq. 4.

mod anchor;
mod clamp_length;
mod edge_lengths;
mod hinge;
mod on_plane;

pub use anchor::Anchor;
pub use clamp_length::ClampLength;
pub use edge_lengths::EdgeLengths;
pub use hinge::{Hinge, Hinges};
pub use on_plane::OnPlane;

use crate::hessian::Hessian;
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
}

/// Factors on the goals' energies, by part; bending is never scaled.
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
            Part::Bending => 1.0,
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

    /// Groups of vertices that the Hessian couples.
    fn couplings(&self) -> Vec<Vec<u32>>;

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
    pub(crate) matrix: &'a mut Hessian,
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

#[cfg(test)]
pub(crate) mod testing {
    //! One page of finite differences that proves any goal.
    use super::*;
    use crate::Objective;

    /// Gradient against energy, Hessian against gradient, moves against gradient, at `x`.
    pub(crate) fn prove(goal: Box<dyn Goal>, x: &[DVec3], tolerance: f64) {
        let goals = [goal];
        let objective = Objective::new(x.len(), &goals);
        let gradient = objective.gradient(x, Scales::FULL).sum;
        let hessian = objective.hessian(x, Curvature::Exact, Scales::FULL).to_dense();
        let scale = 1e-9 + gradient.iter().map(|g| g.length()).fold(0.0, f64::max);
        let stiffness = 1e-9 + hessian.iter().flatten().fold(0.0_f64, |m, h| m.max(h.abs()));
        let e = 1e-4;
        for i in 0..3 * x.len() {
            let moved = |d: f64| {
                let mut y = x.to_vec();
                y[i / 3][i % 3] += d;
                y
            };
            let (p, m) = (moved(e), moved(-e));
            let slope = (objective.energy(&p, Scales::FULL) - objective.energy(&m, Scales::FULL)) / (2.0 * e);
            assert!(
                (slope - gradient[i / 3][i % 3]).abs() < tolerance * (scale + stiffness * e),
                "gradient {i}: {slope} {}",
                gradient[i / 3][i % 3]
            );
            let (gp, gm) =
                (objective.gradient(&p, Scales::FULL).sum, objective.gradient(&m, Scales::FULL).sum);
            for j in 0..3 * x.len() {
                let d = (gp[j / 3][j % 3] - gm[j / 3][j % 3]) / (2.0 * e);
                assert!(
                    (d - hessian[i][j]).abs() < tolerance * stiffness,
                    "hessian {i} {j}: {d} {}",
                    hessian[i][j]
                );
            }
        }
        prove_moves(&objective, x, &gradient, tolerance * scale);
    }

    fn prove_moves(objective: &Objective<'_>, x: &[DVec3], gradient: &[DVec3], tolerance: f64) {
        let (weighted, _) = objective.moves(x);
        for (w, g) in weighted.iter().zip(gradient) {
            assert!((*w + *g).length() < tolerance, "moves are not the negative gradient: {w} {g}");
        }
    }

    #[test]
    fn cross_matrix_is_the_cross_product() {
        let (a, b) = (DVec3::new(1., -2., 3.), DVec3::new(0.5, 4., -1.));
        assert!((cross_matrix(a) * b - a.cross(b)).length() < 1e-15);
        assert!((outer(a, b) * DVec3::ONE - a * b.element_sum()).length() < 1e-15);
    }
}
