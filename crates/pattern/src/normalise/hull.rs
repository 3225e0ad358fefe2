//! The convex hull of all lines.

use super::clean::order;
use super::model::{Edge, Graph, Half};
use super::{segment, split};
use softfold_geometry::{DVec2, Role, Segment, Tolerance, polygon};

/// The hull's corners, counter-clockwise, by Andrew's monotone chain (Inform. Process. Lett. 9, 1979); curves count
/// as their chords.
pub(super) fn of(graph: &Graph, tolerance: &Tolerance) -> Vec<DVec2> {
    let chords = graph.edges.iter().flat_map(|e| segment::chords(&e.segment, tolerance.join_mm));
    let mut points: Vec<DVec2> = chords.flat_map(|c| c.ends).collect();
    points.sort_by(|a, b| order(*a, *b));
    points.dedup();
    let mut lower = half(points.iter().copied());
    let mut upper = half(points.iter().rev().copied());
    // Each half ends where the other begins.
    lower.pop();
    upper.pop();
    lower.append(&mut upper);
    lower
}

/// The points of a sorted row that turn left.
fn half(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = Vec::new();
    for p in points {
        while let [.., a, b] = kept[..]
            && (b - a).perp_dot(p - b) <= 0.0
        {
            kept.pop();
        }
        kept.push(p);
    }
    kept
}

/// The sides of the hull as boundary that nobody drew.
pub(super) fn edges(hull: &[DVec2]) -> impl Iterator<Item = Edge> + '_ {
    polygon::edges(hull).map(|(from, to)| Edge {
        segment: Segment::Line { from, to },
        nodes: [0; 2],
        role: Role::Boundary,
        fold_angle_rad: None,
        sources: Vec::new(),
        rim: true,
    })
}

/// Whether a contour is nowhere farther than the refuse tolerance from the hull.
pub(super) fn is_near(graph: &Graph, contour: &[Half], hull: &[DVec2], tolerance: &Tolerance) -> bool {
    let tree = split::tree(&edges(hull).collect::<Vec<_>>(), tolerance);
    let reach = tolerance.refuse_mm.powi(2);
    let near =
        |p: DVec2| tree.nearest_neighbor_with_distance_2(p.to_array()).is_some_and(|(_, d)| d <= reach);
    contour.iter().all(|h| {
        let s = &graph.edges[h.edge()].segment;
        segment::chords(s, tolerance.refuse_mm)
            .all(|c| near(c.ends[0]) && near(0.5 * (c.ends[0] + c.ends[1])))
    })
}
