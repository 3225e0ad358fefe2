//! Coarse meshes of a sheet, and which of them folding goes through.
//!
//! Some are folded in any case. Between two of them, or between the last of them and the mesh asked for, there may be one more,
//! which is asked for only where what is carried on would else be too far off. How far it will be is told by the mesh before:
//! how far its own folded shape was from what was carried to it.

use crate::goal::Goal;
use crate::motion::Motion;
use glam::DVec3;
use softfold_geometry::{EdgeId, FlatMesh};

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
#[derive(Clone, Copy)]
pub struct Pyramid<'a> {
    /// The meshes that are folded in any case.
    pub levels: &'a [Level],
    /// Meshes that are folded where it is needed.
    pub between: Option<Between<'a>>,
    /// How positions go from mesh to mesh.
    pub carry: &'a Carry<'a>,
}

/// Meshes that a pyramid makes when it needs them.
#[derive(Clone, Copy)]
pub struct Between<'a> {
    /// `mesh(k)` lies between mesh `k − 1` of the pyramid and mesh `k`, which after the last one is the mesh asked for.
    /// None where there is none worth having. Asked for at most once each, and never for `k = 0`.
    pub mesh: &'a dyn Fn(usize) -> Option<&'a Level>,
    /// One is folded where what is carried past it is predicted to be further off than this, mm rms: what counts as the
    /// same shape.
    pub near_mm: f64,
}

/// Predictions are taken times this. Measured on sheets with bands, whose strips do not get finer in step with the mesh and
/// whose coarse shapes are not folded to the end, the truth was 0.9 to 2.2 times what the first order says.
const SAFETY: f64 = 2.0;

/// How the folded shape moved from one mesh to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Correction {
    /// Mean edge of both meshes, the coarser first, mm.
    edges_mm: [f64; 2],
    /// How far the shape on the finer mesh is from what was carried to it, mm rms, apart from a rigid motion.
    off_mm: f64,
}

impl Correction {
    /// What was carried to `mesh` from one of mean edge `coarser_mm`, and what it folded to.
    pub(crate) fn new(coarser_mm: f64, mesh: &FlatMesh, carried: &[DVec3], folded: &[DVec3]) -> Self {
        let way: Vec<DVec3> = folded.iter().zip(carried).map(|(to, from)| *to - *from).collect();
        let off_mm = Motion::new(carried, &way).rest_rms_mm();
        Self { edges_mm: [coarser_mm, mean_edge_mm(mesh)], off_mm }
    }

    /// How far off what is carried from the finer of its meshes to one with this mean edge will be, mm rms.
    ///
    /// The shapes of ever finer meshes converge at least with the first power of the edge: on sheets with bands of straight
    /// strips second order is not seen before the bands have many.
    pub(crate) fn predicted_mm(&self, edge_mm: f64) -> f64 {
        let [coarse, fine] = self.edges_mm;
        if coarse <= fine {
            return 0.0; // no refinement: it tells nothing
        }
        SAFETY * self.off_mm * (fine - edge_mm).max(0.0) / (coarse - fine)
    }
}

/// Mean length of the edges; 0 without any.
pub(crate) fn mean_edge_mm(mesh: &FlatMesh) -> f64 {
    let sum: f64 = (0..mesh.edges.len()).map(|e| mesh.edge_length_mm(EdgeId::new(e))).sum();
    sum / mesh.edges.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;

    fn lifted(mesh: &FlatMesh, by: impl Fn(f64) -> f64) -> Vec<DVec3> {
        mesh.vertices.iter().map(|p| p.extend(by(p.x))).collect()
    }

    #[test]
    fn half_the_edge_leaves_half_the_correction() {
        let mesh = strip(20, 4, 5.0);
        let (flat, wavy) = (lifted(&mesh, |_| 0.0), lifted(&mesh, |x| (0.3 * x).cos()));
        let edge_mm = mean_edge_mm(&mesh);
        let correction = Correction::new(2.0 * edge_mm, &mesh, &flat, &wavy);
        assert!(correction.off_mm > 0.6 && correction.off_mm < 0.75, "{correction:?}");
        let half = correction.predicted_mm(0.5 * edge_mm);
        assert!((half - 0.5 * SAFETY * correction.off_mm).abs() < 1e-12, "{half}");
        assert_eq!(correction.predicted_mm(edge_mm), 0.0);
        assert_eq!(correction.predicted_mm(3.0 * edge_mm), 0.0);
    }

    #[test]
    fn rigid_motions_are_no_correction() {
        let mesh = strip(20, 4, 5.0);
        let x = lifted(&mesh, |x| 0.01 * x * x);
        let moved: Vec<DVec3> =
            x.iter().map(|p| *p + DVec3::new(1e-4 * p.y, 3.0 - 1e-4 * p.x, -7.0)).collect();
        assert!(Correction::new(10.0, &mesh, &x, &moved).off_mm < 1e-12);
    }

    #[test]
    fn a_mesh_that_is_no_finer_tells_nothing() {
        let mesh = strip(4, 4, 5.0);
        let (flat, up) = (lifted(&mesh, |_| 0.0), lifted(&mesh, |x| x.sin()));
        assert_eq!(Correction::new(mean_edge_mm(&mesh), &mesh, &flat, &up).predicted_mm(0.1), 0.0);
    }
}
