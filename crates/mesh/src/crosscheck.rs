//! spade against CGAL on the same input.
//!
//! Both decide by exact predicates, so on the same points their triangles may differ only where four points lie on one
//! circle, and both ways are Delaunay. Where constraints cross the two cut them differently: CGAL exactly, spade's side
//! on a fine grid. There the cut is compared first, with CGAL's exact one as the referee, and then the triangles of both on the
//! grid's points.

use crate::backend::{Arranged, graph_of};
use crate::cdt::{Backend, PlanarGraph, triangulate};
use crate::noding::{Noded, OFF_LINE, noded};
use crate::{MeshError, Triangulated};
use glam::DVec2;
use softfold_geometry::{VertexId, polygon};
use std::collections::{BTreeMap, BTreeSet};

/// What the comparison found.
#[derive(Clone, Debug, PartialEq)]
pub struct Crosscheck {
    /// Whether both kept every constraint.
    pub constraints_held: bool,
    /// |area of spade's − area of CGAL's| over the area, as far as rounding of the sums does not explain it.
    pub area_relative_difference: f64,
    /// Edges that only one has and whose four points lie on a circle (both are Delaunay): their middles.
    pub cocircular_differences: Vec<DVec2>,
    /// Any other edge that only one has: a fault of one of them. Also where one sees a crossing that the other does not.
    pub other_differences: Vec<DVec2>,
    /// What one said that refused what the other took.
    pub refusal: Option<String>,
}

/// Share of the sum of its terms' sizes below which an in-circle determinant cannot be told from 0 in `f64`: (10 + 96 ε) ε with
/// ε = 2⁻⁵³, of J. Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates* (1997).
/// Both libraries decide exactly, so nothing beyond our own rounding needs pardon.
const COCIRCULAR: f64 = (10.0 + 96.0 * 0.5 * f64::EPSILON) * 0.5 * f64::EPSILON;
/// Areas may differ by this share beside the rounding of their products: that of sums of a million of them.
const AREA: f64 = 1e-9;

impl Crosscheck {
    /// Whether the two agree.
    pub fn agrees(&self) -> bool {
        self.refusal.is_none()
            && self.constraints_held
            && self.other_differences.is_empty()
            && self.area_relative_difference <= AREA
    }

    /// One of the two refused.
    fn one_sided(name: &str, error: &MeshError) -> Self {
        let place = match error {
            MeshError::Crossing { at, .. } => vec![*at],
            _ => Vec::new(),
        };
        Self {
            constraints_held: false,
            area_relative_difference: 1.0,
            cocircular_differences: Vec::new(),
            other_differences: place,
            refusal: Some(format!("{name} alone refuses it: {error}")),
        }
    }
}

/// Triangulates with both backends and compares.
///
/// # Errors
/// If both refuse the graph; if one alone does, that is a difference.
pub fn crosscheck(graph: &PlanarGraph) -> Result<Crosscheck, MeshError> {
    match (triangulate(graph, Backend::Spade), triangulate(graph, Backend::Cgal)) {
        (Ok(ours), Ok(theirs)) => Ok(compared(graph, &ours, &theirs)),
        (Ok(_), Err(error)) => Ok(Crosscheck::one_sided(Backend::Cgal.name(), &error)),
        (Err(error), Ok(_)) => Ok(Crosscheck::one_sided(Backend::Spade.name(), &error)),
        (Err(error), Err(_)) => Err(error),
    }
}

fn compared(graph: &PlanarGraph, ours: &Triangulated, theirs: &Triangulated) -> Crosscheck {
    let (mine, other) = (edges(ours), edges(theirs));
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
    let (a, b) = (area(&graph.points, &ours.triangles), area(&graph.points, &theirs.triangles));
    let rounding =
        area_rounding(&graph.points, &ours.triangles) + area_rounding(&graph.points, &theirs.triangles);
    Crosscheck {
        constraints_held: held(&mine) && held(&other),
        area_relative_difference: ((a - b).abs() - rounding).max(0.0) / a.abs().max(f64::MIN_POSITIVE),
        cocircular_differences: cocircular,
        other_differences: different,
        refusal: None,
    }
}

/// What the comparison of constraints that cross found.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossingCheck {
    /// Both libraries on the pieces that spade's side cut.
    pub pieces: Crosscheck,
    /// How many meetings of two constraints there are exactly, by CGAL.
    pub meetings: usize,
    /// Meetings so near to an end that the tolerance decides whether they are: these may be absent on the grid.
    pub marginal: usize,
    /// Other exact meetings that the grid's pieces do not have: faults.
    pub missed: Vec<DVec2>,
    /// Points of pieces that lie farther from their constraint than the tolerance: faults.
    pub astray: Vec<DVec2>,
    /// |area of the hull on the grid − exactly|, over what the tolerance allows.
    pub area_over_allowance: f64,
    /// Distance within which a piece and its constraint, or a point and a constraint, are one, mm.
    pub tolerance_mm: f64,
}

impl CrossingCheck {
    /// Whether the two agree.
    pub fn agrees(&self) -> bool {
        self.pieces.agrees()
            && self.missed.is_empty()
            && self.astray.is_empty()
            && self.area_over_allowance <= 1.0
    }

    /// Places of all faults, mm.
    pub fn faults(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.pieces.other_differences.iter().chain(&self.missed).chain(&self.astray).copied()
    }
}

/// Cuts and triangulates constraints that may cross, overlap and touch with both backends, and compares.
///
/// CGAL's exact arrangement of the input is the referee of the cut: wherever two constraints meet exactly, their pieces
/// must share a point, at most `2 tolerance / sin` of their angle away; no piece may stray from its constraint by
/// more than the tolerance. On the pieces both libraries must then agree as [`crosscheck`] demands.
///
/// # Errors
/// Points that are not finite or all lie on one line.
pub fn crosscheck_crossing(
    points: &[DVec2],
    constraints: &[[VertexId; 2]],
) -> Result<CrossingCheck, MeshError> {
    let noded = noded(points, constraints)?;
    let graph = graph_of(&noded);
    let by = |b: Backend| Ok::<_, MeshError>(Triangulated { triangles: b.library().planar(&graph)? });
    let (ours, theirs) = (by(Backend::Spade)?, by(Backend::Cgal)?);
    let exact = Backend::Cgal.library().crossing(points, constraints)?;
    let tolerance_mm = OFF_LINE * noded.pitch_mm + exact.tolerance_mm;
    let cut = Cut { points, constraints, noded: &noded, exact: &exact, tolerance_mm };
    let (meetings, marginal, missed) = cut.meetings();
    let difference = area(&noded.points, &ours.triangles) - area(&exact.points, &exact.triangles);
    Ok(CrossingCheck {
        pieces: compared(&graph, &ours, &theirs),
        meetings,
        marginal,
        missed,
        astray: cut.astray(),
        area_over_allowance: difference.abs() / cut.area_allowance(),
        tolerance_mm,
    })
}

/// A meeting is marginal where an end of one constraint lies within so many tolerances of the other.
const MARGINAL: f64 = 3.0;

/// One cut by the grid, and the exact one.
struct Cut<'a> {
    points: &'a [DVec2],
    constraints: &'a [[VertexId; 2]],
    noded: &'a Noded,
    exact: &'a Arranged,
    tolerance_mm: f64,
}

impl Cut<'_> {
    fn ends(&self, constraint: usize) -> [DVec2; 2] {
        self.constraints[constraint].map(|v| self.points[v.index()])
    }

    /// How many exact meetings there are, how many of the missing ones are marginal, and the places of the others.
    fn meetings(&self) -> (usize, usize, Vec<DVec2>) {
        let mut through: BTreeMap<VertexId, BTreeSet<usize>> = BTreeMap::new();
        for (i, chain) in self.exact.chains.iter().enumerate() {
            for v in chain {
                through.entry(*v).or_default().insert(i);
            }
        }
        let (mut all, mut marginal, mut missed) = (0, 0, Vec::new());
        for (vertex, constraints) in &through {
            let at = self.exact.points[vertex.index()];
            let list: Vec<usize> = constraints.iter().copied().collect();
            for (k, &i) in list.iter().enumerate() {
                for &j in &list[k + 1..] {
                    all += 1;
                    match () {
                        () if self.share_a_point(i, j, at) => {}
                        () if self.is_marginal(i, j) => marginal += 1,
                        () => missed.push(at),
                    }
                }
            }
        }
        (all, marginal, missed)
    }

    fn share_a_point(&self, i: usize, j: usize, at: DVec2) -> bool {
        let [[a, b], [c, d]] = [i, j].map(|k| self.ends(k));
        let sine = (b - a).perp_dot(d - c).abs() / ((b - a).length() * (d - c).length());
        let reach_mm = 2.0 * self.tolerance_mm / sine.max(f64::EPSILON);
        let other = &self.noded.chains[j];
        let near = |v: &&VertexId| self.noded.points[v.index()].distance(at) <= reach_mm;
        self.noded.chains[i].iter().filter(near).any(|v| other.contains(v))
    }

    fn is_marginal(&self, i: usize, j: usize) -> bool {
        let near = |of: usize, to: usize| {
            let [a, b] = self.ends(to);
            let reach_mm = MARGINAL * self.tolerance_mm;
            self.ends(of).into_iter().any(|p| polygon::segment_distance(p, a, b) <= reach_mm)
        };
        near(i, j) || near(j, i)
    }

    /// Points of pieces that lie off their constraints.
    fn astray(&self) -> Vec<DVec2> {
        let mut astray = Vec::new();
        for (i, chain) in self.noded.chains.iter().enumerate() {
            let [a, b] = self.ends(i);
            let points = chain.iter().map(|v| self.noded.points[v.index()]);
            astray.extend(points.filter(|p| polygon::segment_distance(*p, a, b) > self.tolerance_mm));
        }
        astray
    }

    /// Area between two hulls whose corners lie within the tolerance of each other.
    fn area_allowance(&self) -> f64 {
        let (lo, hi) = polygon::bounds(self.points);
        let perimeter_mm = 2.0 * (hi - lo).element_sum();
        perimeter_mm * self.tolerance_mm
    }
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
    // Over a power of two near the size: exact, and fourth powers stay in range.
    let size = [b, c, d].map(|p| p.distance(a)).into_iter().fold(0.0, f64::max).log2().floor().exp2();
    let [a, b, c] = [a, b, c].map(|p| (p - d) / size);
    let lift = |p: DVec2| p.length_squared();
    let det = lift(a) * b.perp_dot(c) + lift(b) * c.perp_dot(a) + lift(c) * a.perp_dot(b);
    let sizes = |p: DVec2, q: DVec2| (p.x * q.y).abs() + (p.y * q.x).abs();
    let permanent = lift(a) * sizes(b, c) + lift(b) * sizes(c, a) + lift(c) * sizes(a, b);
    det.abs() <= COCIRCULAR * permanent
}

fn area(points: &[DVec2], triangles: &[[VertexId; 3]]) -> f64 {
    let triangle = |c: &[VertexId; 3]| {
        let [p, q, r] = c.map(|v| points[v.index()]);
        0.5 * (q - p).perp_dot(r - p)
    };
    triangles.iter().map(triangle).sum()
}

/// By how much rounding can change the sum of areas: a few units of the last place of every product.
fn area_rounding(points: &[DVec2], triangles: &[[VertexId; 3]]) -> f64 {
    let products = |c: &[VertexId; 3]| {
        let [p, q, r] = c.map(|v| points[v.index()]);
        q.distance(p) * r.distance(p)
    };
    4.0 * f64::EPSILON * triangles.iter().map(products).sum::<f64>()
}
