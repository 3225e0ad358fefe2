//! spade against CGAL on the same graph.

use crate::cdt::{Backend, PlanarGraph, triangulate};
use crate::{MeshError, Triangulated};
use glam::DVec2;
use softfold_geometry::VertexId;
use std::collections::{BTreeMap, BTreeSet};

/// What the comparison found.
#[derive(Clone, Debug, PartialEq)]
pub struct Crosscheck {
    /// Whether both kept every constraint.
    pub constraints_held: bool,
    /// |area of spade's − area of CGAL's| over the area.
    pub area_relative_difference: f64,
    /// Edges that only one has and whose four points lie on a circle (both are Delaunay): their middles.
    pub cocircular_differences: Vec<DVec2>,
    /// Any other edge that only one has: a fault of one of them.
    pub other_differences: Vec<DVec2>,
}

/// In-circle determinant over the fourth power of the size, below which four points are cocircular.
const COCIRCULAR: f64 = 1e-9;
/// Areas may differ by the rounding of their sums.
const AREA: f64 = 1e-9;

impl Crosscheck {
    /// Whether the two agree.
    pub fn agrees(&self) -> bool {
        self.constraints_held && self.other_differences.is_empty() && self.area_relative_difference <= AREA
    }
}

/// Triangulates with both backends and compares.
///
/// # Errors
/// If one of them refuses the graph.
pub fn crosscheck(graph: &PlanarGraph) -> Result<Crosscheck, MeshError> {
    let ours = triangulate(graph, Backend::Spade)?;
    let theirs = triangulate(graph, Backend::Cgal)?;
    let (mine, other) = (edges(&ours), edges(&theirs));
    let held = |e: &BTreeMap<[VertexId; 2], Vec<VertexId>>| {
        graph.constraints.iter().all(|(c, _)| e.contains_key(&sorted(*c)))
    };
    let (mut cocircular, mut different) = (Vec::new(), Vec::new());
    for (edge, tips) in mine
        .iter()
        .filter(|(e, _)| !other.contains_key(*e))
        .chain(other.iter().filter(|(e, _)| !mine.contains_key(*e)))
    {
        let middle = 0.5 * (graph.points[edge[0].index()] + graph.points[edge[1].index()]);
        if is_cocircular(graph, edge, tips) { cocircular.push(middle) } else { different.push(middle) }
    }
    let (a, b) = (area(graph, &ours), area(graph, &theirs));
    Ok(Crosscheck {
        constraints_held: held(&mine) && held(&other),
        area_relative_difference: (a - b).abs() / a.abs().max(f64::MIN_POSITIVE),
        cocircular_differences: cocircular,
        other_differences: different,
    })
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

/// Edges with the tips of their triangles.
fn edges(t: &Triangulated) -> BTreeMap<[VertexId; 2], Vec<VertexId>> {
    let mut edges: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for corners in &t.triangles {
        for k in 0..3 {
            edges.entry(sorted([corners[k], corners[(k + 1) % 3]])).or_default().push(corners[(k + 2) % 3]);
        }
    }
    edges
}

fn is_cocircular(graph: &PlanarGraph, edge: &[VertexId; 2], tips: &[VertexId]) -> bool {
    let points: BTreeSet<VertexId> = edge.iter().chain(tips).copied().collect();
    let points: Vec<DVec2> = points.into_iter().map(|v| graph.points[v.index()]).collect();
    let &[a, b, c, d] = points.as_slice() else { return false };
    let size = [b, c, d].map(|p| p.distance(a)).into_iter().fold(0.0, f64::max);
    let [a, b, c] = [a, b, c].map(|p| (p - d) / size);
    let lift = |p: DVec2| p.length_squared();
    let det = lift(a) * b.perp_dot(c) + lift(b) * c.perp_dot(a) + lift(c) * a.perp_dot(b);
    det.abs() < COCIRCULAR
}

fn area(graph: &PlanarGraph, t: &Triangulated) -> f64 {
    let triangle = |c: &[VertexId; 3]| {
        let [p, q, r] = c.map(|v| graph.points[v.index()]);
        0.5 * (q - p).perp_dot(r - p)
    };
    t.triangles.iter().map(triangle).sum()
}
