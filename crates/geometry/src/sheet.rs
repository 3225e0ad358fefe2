//! The folded sheet: the flat mesh with its positions in space.

use crate::{CheckError, Edge, FlatMesh, TriangleId, VertexId};
use glam::{DVec2, DVec3};

/// A figure, in the unit of the field that holds it, and the place on the sheet where it was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extreme {
    /// The figure.
    pub value: f64,
    /// Where, (u, v) in mm.
    pub at: DVec2,
}

/// What one mesh of a solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelRecord {
    /// Vertices of the mesh.
    pub vertices: u32,
    /// Iterations on it.
    pub iterations: u32,
    /// Numeric factorisations of its matrix.
    pub factorisations: u32,
    /// Energy when it was left (N·mm up to the scale of the weights).
    pub energy: f64,
}

/// How a solver ended; no clock here, the pipeline measures time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolveRecord {
    /// Name of the solver.
    pub solver: String,
    /// Iterations in all.
    pub iterations: u32,
    /// Numeric factorisations of the mesh's own matrix; 0 for solvers that have none.
    pub factorisations: u32,
    /// The meshes of a multilevel solve from the coarsest to the sheet's own; empty for solvers that know one mesh only.
    pub levels: Vec<LevelRecord>,
    /// Energy at the end (N·mm up to the scale of the weights).
    pub energy: f64,
    /// Gradient norm over the norm of the sum of its terms' magnitudes.
    pub relative_gradient: f64,
    /// Whether the stop criterion was met.
    pub converged: bool,
    /// Why it stopped, in words.
    pub stop: String,
}

/// Equilibrium positions of the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldedSheet {
    /// The flat mesh.
    pub mesh: FlatMesh,
    /// A position per vertex, mm; z is up.
    pub positions: Vec<DVec3>,
    /// How it was found.
    pub solve: SolveRecord,
}

impl FoldedSheet {
    /// Position of a vertex.
    pub fn position(&self, vertex: VertexId) -> DVec3 {
        self.positions[vertex.index()]
    }

    /// Corner positions of a triangle.
    pub fn corners(&self, triangle: TriangleId) -> [DVec3; 3] {
        self.mesh.triangles[triangle.index()].map(|v| self.position(v))
    }

    /// Unit normal of a triangle, on the side that the flat sheet shows to the onlooker.
    pub fn normal(&self, triangle: TriangleId) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// Turn at an interior edge, rad in (−π, π], + valley (both sides rise towards the onlooker);
    /// none on the boundary.
    pub fn turn_rad(&self, edge: &Edge) -> Option<f64> {
        let [left, right] = [self.normal(edge.triangles[0]?), self.normal(edge.triangles[1]?)];
        let direction =
            (self.position(edge.vertices[1]) - self.position(edge.vertices[0])).normalize_or_zero();
        Some(right.cross(left).dot(direction).atan2(left.dot(right)))
    }

    /// The contract of this type.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), CheckError> {
        if self.positions.len() != self.mesh.vertices.len() {
            return Err(CheckError::new("FoldedSheet", "positions and vertices differ in number"));
        }
        match self.positions.iter().position(|p| !p.is_finite()) {
            Some(i) => Err(CheckError::new("FoldedSheet", format!("vertex {i} is not finite"))),
            None => self.mesh.check(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EdgeClass, LoopId, Site};

    /// Two triangles on the line u = 0, the left one at (-1, 0).
    fn folded(lift: f64) -> FoldedSheet {
        let vertices = [(0., -1.), (0., 1.), (-1., 0.), (1., 0.)].map(DVec2::from).to_vec();
        let triangles =
            vec![[VertexId(0), VertexId(1), VertexId(2)], [VertexId(1), VertexId(0), VertexId(3)]];
        let sites = vec![Site::Interior; 4];
        let mesh = FlatMesh::new(vertices, sites, triangles, |_, boundary| match boundary {
            true => EdgeClass::Boundary { loop_id: LoopId(0) },
            false => EdgeClass::Facet,
        });
        let z = [0.0, 0.0, lift, lift];
        let positions = mesh.vertices.iter().zip(z).map(|(p, z)| p.extend(z)).collect();
        FoldedSheet { mesh, positions, solve: SolveRecord::default() }
    }

    #[test]
    fn valley_is_positive_and_mountain_negative() {
        for (lift, turn) in [(1.0, 90f64), (-1.0, -90.0), (0.0, 0.0)] {
            let sheet = folded(lift);
            sheet.check().unwrap();
            let inner = sheet.mesh.edges.iter().find_map(|e| sheet.turn_rad(e)).unwrap();
            assert!((inner.to_degrees() - turn).abs() < 1e-9, "{lift} {inner}");
        }
    }
}
