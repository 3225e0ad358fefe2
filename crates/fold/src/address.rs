//! Points of the sheet by (u, v) or by place on the outline, never by vertex number.

use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, LoopId, Site, TriangleId, VertexId, polygon};

/// A point of the sheet: corners of a triangle with barycentric weights that add up to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetPoint {
    vertices: [u32; 3],
    weights: [f64; 3],
}

/// An address that is not on the sheet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AddressError {
    /// The point lies outside.
    #[error("the point ({:.3}, {:.3}) mm is not on the sheet: it is {distance_mm:.3} mm off; move it inside the outline", at.x, at.y)]
    Outside {
        /// The point, (u, v).
        at: DVec2,
        /// Its distance from the nearest triangle, mm.
        distance_mm: f64,
    },
}

impl SheetPoint {
    /// A point from its corners and weights.
    pub fn new(vertices: [u32; 3], weights: [f64; 3]) -> Self {
        Self { vertices, weights }
    }

    /// A vertex.
    pub fn vertex(vertex: VertexId) -> Self {
        Self::new([vertex.0; 3], [1.0, 0.0, 0.0])
    }

    /// The corners.
    pub fn vertices(&self) -> [u32; 3] {
        self.vertices
    }

    /// Corners with their weights, those without weight left out.
    pub fn corners(self) -> impl Iterator<Item = (u32, f64)> {
        self.vertices.into_iter().zip(self.weights).filter(|c| c.1 != 0.0)
    }

    /// Its place in space.
    pub fn position(&self, x: &[DVec3]) -> DVec3 {
        self.corners().map(|(v, w)| w * x[v as usize]).sum()
    }

    /// Calls `f(i, j, wᵢ wⱼ)` for each pair of corners with i ≥ j.
    pub(crate) fn add_pairs(&self, mut f: impl FnMut(u32, u32, f64)) {
        for (i, wi) in self.corners() {
            self.corners().filter(|&(j, _)| j <= i).for_each(|(j, wj)| f(i, j, wi * wj));
        }
    }
}

/// How far outside its triangle a point may fall to count as on it: points on a curved outline lie
/// outside the chords that stand for it. Share of the sheet's size.
const REACH: f64 = 2e-3;

/// The point of the sheet at (u, v).
///
/// # Errors
/// [`AddressError::Outside`] if it is off the sheet.
pub fn locate(mesh: &FlatMesh, at: DVec2) -> Result<SheetPoint, AddressError> {
    let (lo, hi) = polygon::bounds(&mesh.vertices);
    let outside = |t: usize| {
        let [a, b, c] = mesh.corners(TriangleId::new(t));
        if polygon::contains(&[a, b, c], at) {
            return 0.0;
        }
        [(a, b), (b, c), (c, a)]
            .map(|(p, q)| polygon::segment_distance(at, p, q))
            .into_iter()
            .fold(f64::MAX, f64::min)
    };
    let nearest = (0..mesh.triangles.len()).map(|t| (t, outside(t))).min_by(|a, b| a.1.total_cmp(&b.1));
    match nearest {
        Some((t, distance)) if distance <= REACH * (hi - lo).max_element() => Ok(clamped_point(mesh, t, at)),
        other => Err(AddressError::Outside { at, distance_mm: other.map_or(f64::INFINITY, |n| n.1) }),
    }
}

fn clamped_point(mesh: &FlatMesh, triangle: usize, at: DVec2) -> SheetPoint {
    let [a, b, c] = mesh.corners(TriangleId::new(triangle));
    let whole = (b - a).perp_dot(c - a);
    let raw = [(b - at).perp_dot(c - at), (c - at).perp_dot(a - at), (a - at).perp_dot(b - at)];
    let weights = raw.map(|w| (w / whole).max(0.0));
    let sum: f64 = weights.iter().sum();
    SheetPoint::new(mesh.triangles[triangle].map(|v| v.0), weights.map(|w| w / sum))
}

/// Vertices of a boundary curve between two fractions of its length, running forward and
/// wrapping at 1.
pub fn boundary_vertices(mesh: &FlatMesh, loop_id: LoopId, length_mm: f64, range: [f64; 2]) -> Vec<u32> {
    let span = (range[1] - range[0]).rem_euclid(1.0);
    let inside = |v: &VertexId| (arc_length(mesh, *v) / length_mm - range[0]).rem_euclid(1.0) <= span;
    mesh.loop_vertices(loop_id).into_iter().filter(inside).map(|v| v.0).collect()
}

fn arc_length(mesh: &FlatMesh, v: VertexId) -> f64 {
    match mesh.sites[v.index()] {
        Site::Boundary { s_mm, .. } => s_mm,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;

    #[test]
    fn a_located_point_reproduces_its_place() {
        let mesh = strip(5, 4, 10.0);
        let x: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        for at in [DVec2::new(13.7, 22.2), DVec2::new(0.0, 0.0), DVec2::new(50.0, 40.0)] {
            assert!(locate(&mesh, at).unwrap().position(&x).truncate().distance(at) < 1e-9);
        }
        assert!(matches!(locate(&mesh, DVec2::new(80.0, 0.0)), Err(AddressError::Outside { .. })));
    }

    #[test]
    fn a_range_of_the_outline_wraps_at_its_start() {
        let mesh = strip(5, 4, 10.0);
        let range = [170.0 / 180.0, 10.0 / 180.0];
        assert_eq!(boundary_vertices(&mesh, LoopId(0), 180.0, range).len(), 3);
        assert!(boundary_vertices(&mesh, LoopId(3), 180.0, range).is_empty());
    }
}
