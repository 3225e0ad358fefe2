//! Points of the sheet pulled to the nearest place of something in space: what rails and scans share.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part};
use crate::SheetPoint;
use glam::{DMat3, DVec3};

/// The place of a target that is nearest to a point, with what half the squared distance to it does around there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The place.
    pub place: DVec3,
    /// `I − ∂q/∂p` with q the nearest place: second derivative of half the squared distance.
    pub hessian: DMat3,
    /// The same with the target's curvature towards the point left out: positive semidefinite.
    pub convex: DMat3,
}

/// Something in space that has a nearest place.
pub trait Target: Send + Sync {
    /// Kind of the goal for the report.
    const KIND: &'static str;

    /// The place nearest to `point`. Of several, any; of a point that is not finite, one that is not either.
    fn nearest(&self, point: DVec3) -> Nearest;
}

/// A target that has no nearest place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TargetError {
    /// Nothing to pull to.
    #[error("there is nothing to pull to: give at least {least} {what}")]
    Empty {
        /// How many it takes.
        least: usize,
        /// Of what.
        what: &'static str,
    },
    /// A coordinate is no number.
    #[error("point {0} is not finite; give its coordinates in mm")]
    NotFinite(usize),
    /// A triangle names a corner that there is not.
    #[error("triangle {triangle} has the corner {corner}, but there are {points} points; mend or drop it")]
    Corner {
        /// Number of the triangle.
        triangle: usize,
        /// The corner that it names.
        corner: u32,
        /// How many points there are.
        points: usize,
    },
}

/// `E = ½ k Σ |p − q(p)|²`, N·mm, over points p of the sheet with q(p) the nearest place of the target. The gradient
/// `k (p − q)` is exact where the nearest place is only one; where it jumps, the energy has a ridge.
#[derive(Clone, Debug, PartialEq)]
pub struct Attract<T> {
    /// Name for the report.
    pub name: String,
    /// The points of the sheet.
    pub points: Vec<SheetPoint>,
    /// What they are pulled to.
    pub target: T,
    /// Stiffness per point, N/mm.
    pub stiffness: f64,
}

impl<T: Target> Attract<T> {
    /// Each point with its way from the nearest place.
    fn errors<'a>(&'a self, x: &'a [DVec3]) -> impl Iterator<Item = (&'a SheetPoint, DVec3)> {
        let error = move |p: &SheetPoint| p.position(x) - self.target.nearest(p.position(x)).place;
        self.points.iter().map(move |p| (p, error(p)))
    }
}

impl<T: Target> Goal for Attract<T> {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        T::KIND
    }

    fn part(&self) -> Part {
        Part::Hold
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.points.iter().map(|p| p.vertices().to_vec()).collect()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        self.errors(x).map(|(_, e)| 0.5 * self.stiffness * e.length_squared()).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        for (point, error) in self.errors(x) {
            point.corners().for_each(|(v, w)| out.add(v, w * self.stiffness * error));
        }
    }

    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>) {
        for point in &self.points {
            let nearest = self.target.nearest(point.position(x));
            let block = match curvature {
                Curvature::Exact => nearest.hessian,
                Curvature::Convex => nearest.convex,
            };
            point.add_pairs(|i, j, w| out.add(i, j, w * self.stiffness * block));
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        // The weights add up to 1, so that the corners' moves bring the point at most to its place.
        for (point, error) in self.errors(x) {
            point.corners().for_each(|(v, w)| out.add(v, w * self.stiffness, -error));
        }
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.errors(x).map(|(_, e)| e.length()).fold(0.0, f64::max)
    }
}
