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
    /// No such boundary curve.
    #[error("the sheet has no boundary curve {0}")]
    NoLoop(LoopId),
}

impl SheetPoint {
    /// A point from its corners and weights.
    pub fn new(vertices: [u32; 3], weights: [f64; 3]) -> Self {
        Self { vertices, weights }
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

/// The point of a boundary curve at `fraction` of its length, 0 to 1.
///
/// # Errors
/// [`AddressError::NoLoop`] if the mesh has no such loop.
pub fn on_loop(
    mesh: &FlatMesh,
    loop_id: LoopId,
    length_mm: f64,
    fraction: f64,
) -> Result<SheetPoint, AddressError> {
    let order = mesh.loop_vertices(loop_id);
    let (Some(&first), Some(&last)) = (order.first(), order.last()) else {
        return Err(AddressError::NoLoop(loop_id));
    };
    let s = fraction.rem_euclid(1.0) * length_mm;
    let next = order.partition_point(|&v| arc_length(mesh, v) <= s);
    let before = if next == 0 { last } else { order[next - 1] };
    let after = if next == order.len() { first } else { order[next] };
    let span = (arc_length(mesh, after) - arc_length(mesh, before)).rem_euclid(length_mm);
    let share = if span > 0.0 { (s - arc_length(mesh, before)).rem_euclid(length_mm) / span } else { 0.0 };
    Ok(SheetPoint::new([before.0, after.0, before.0], [1.0 - share, share, 0.0]))
}

/// Vertices of a boundary curve between two fractions of its length, running forward and
/// wrapping at 1.
pub fn nearest_boundary_vertices(
    mesh: &FlatMesh,
    loop_id: LoopId,
    length_mm: f64,
    range: [f64; 2],
) -> Vec<u32> {
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
    fn a_place_on_the_outline_lies_between_its_neighbours() {
        let mesh = strip(5, 4, 10.0);
        let x: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        let p = on_loop(&mesh, LoopId(0), 180.0, 13.0 / 180.0).unwrap().position(&x);
        assert!(p.distance(DVec3::new(13.0, 0.0, 0.0)) < 1e-9);
        let wrapped = on_loop(&mesh, LoopId(0), 180.0, 179.0 / 180.0).unwrap().position(&x);
        assert!(wrapped.distance(DVec3::new(0.0, 1.0, 0.0)) < 1e-9);
        assert_eq!(
            nearest_boundary_vertices(&mesh, LoopId(0), 180.0, [170.0 / 180.0, 10.0 / 180.0]).len(),
            3
        );
        assert_eq!(on_loop(&mesh, LoopId(3), 1.0, 0.0), Err(AddressError::NoLoop(LoopId(3))));
    }
}
