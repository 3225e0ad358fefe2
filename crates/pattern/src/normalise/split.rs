//! The arrangement: edges are split where they cross or where an end touches, ends that meet become one node, and
//! edges that lie on each other become one edge.

use super::cluster::{Candidate, Nodes, cluster};
use super::merge;
use super::model::{Drawing, Edge, Graph};
use super::segment::{self, Chord};
use crate::PatternError;
use crate::error::issue;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use softfold_geometry::{DVec2, Role, Segment, Severity, Tolerance, polygon};

/// Most places where edges are cut: far above any pattern, and still a second of work.
const MAX_CUTS: usize = 400_000;
/// Most pairs of chords with overlapping boxes: a second or two of work.
const MAX_PAIRS: usize = 50_000_000;
/// Passes until nothing moves any more: moving ends to their nodes may bring them onto other edges, which the second
/// pass sees; more than three were never needed.
const MAX_PASSES: usize = 6;
/// Share of the join tolerance by which a curve may move without meeting anything new.
const STILL: f64 = 1e-3;
/// Parts of an edge that are shorter than so many join tolerances after it was cut vanish: where lines should meet in
/// one point and miss it by the rounding of the file, every pair of them crosses somewhere else.
const SLIVER: f64 = 4.0;
/// Newton steps to a crossing from that of the chords; each doubles the digits.
const CROSSING_STEPS: usize = 8;
/// Halvings of two chords that cross: as many as a number has digits.
const BISECTIONS: usize = 50;
/// Angle below which two lines run the same way, rad: rounding makes more of it, and over the whole sheet they part by
/// less than a tenth of a thousandth of the join tolerance. Their ends tell where they touch.
const PARALLEL: f64 = 1e-9;

/// A chord of an edge, in the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgeChord {
    pub(super) edge: usize,
    pub(super) chord: Chord,
    /// Its box, which the tree asks for again and again.
    envelope: AABB<[f64; 2]>,
}

/// A place where an edge is cut.
struct Cut {
    edge: usize,
    t: f64,
    at: DVec2,
}

impl RTreeObject for EdgeChord {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        self.envelope
    }
}

impl PointDistance for EdgeChord {
    fn distance_2(&self, p: &[f64; 2]) -> f64 {
        let [a, b] = self.chord.ends;
        polygon::segment_distance(DVec2::from_array(*p), a, b).powi(2)
    }
}

/// The box of all points within `reach` of `p`.
pub(super) fn around(p: DVec2, reach: f64) -> AABB<[f64; 2]> {
    AABB::from_corners((p - reach).to_array(), (p + reach).to_array())
}

/// All edges as chords within the join tolerance.
pub(super) fn tree(edges: &[Edge], tolerance: &Tolerance) -> RTree<EdgeChord> {
    let chords = edges.iter().enumerate().flat_map(|(edge, e)| {
        segment::chords(&e.segment, tolerance.join_mm).map(move |chord| {
            let envelope = AABB::from_corners(chord.ends[0].to_array(), chord.ends[1].to_array());
            EdgeChord { edge, chord, envelope }
        })
    });
    RTree::bulk_load(chords.collect())
}

/// The planar graph of edges, and how many ends were moved to their nodes.
///
/// # Errors
/// More crossings than any pattern has.
pub(super) fn split(
    drawing: &Drawing<'_>,
    edges: Vec<Edge>,
    tolerance: &Tolerance,
) -> Result<(Graph, usize), PatternError> {
    let mut pass = once(drawing, edges, tolerance)?;
    let moved = pass.moved;
    for _ in 1..MAX_PASSES {
        if pass.drift_mm <= STILL * tolerance.join_mm {
            break;
        }
        pass = once(drawing, pass.graph.edges, tolerance)?;
    }
    Ok((pass.graph, moved))
}

/// What one pass over the edges makes of them.
pub(super) struct Pass {
    pub(super) graph: Graph,
    /// How many ends were moved to their nodes.
    moved: usize,
    /// How far curves were moved at most: beyond rounding, what was moved may meet other edges now.
    drift_mm: f64,
}

/// One pass: cuts what crosses, touches or lies on each other.
///
/// # Errors
/// More crossings than any pattern has.
pub(super) fn once(
    drawing: &Drawing<'_>,
    edges: Vec<Edge>,
    tolerance: &Tolerance,
) -> Result<Pass, PatternError> {
    let mut cuts = find_cuts(&edges, tolerance)?;
    cuts.sort_by(|a, b| a.edge.cmp(&b.edge).then(a.t.total_cmp(&b.t)));
    let candidates = candidates(&edges, &cuts);
    let ties = slivers(&edges, &cuts, &candidates, tolerance);
    let nodes = cluster(&candidates, &ties, tolerance.join_mm);
    let ends = 2 * edges.len();
    let off = |(i, c): (usize, &Candidate)| nodes.points[nodes.of[i] as usize].distance(c.at);
    let moved = candidates[..ends].iter().enumerate().filter(|c| off(*c) > 0.0).count();
    let drift_mm = candidates.iter().enumerate().map(off).fold(0.0, f64::max);
    let pieces = pieces(&edges, &cuts, &nodes, tolerance);
    let count = pieces.len();
    let edges = merge::merged(drawing, pieces, tolerance);
    // Curves on each other are not the same to the last bit.
    let merged = edges.len() < count && edges.iter().any(|e| matches!(e.segment, Segment::Cubic { .. }));
    let drift_mm = if merged { drift_mm.max(tolerance.join_mm) } else { drift_mm };
    Ok(Pass { graph: compact(Graph { points: nodes.points, edges }), moved, drift_mm })
}

fn pieces(edges: &[Edge], cuts: &[Cut], nodes: &Nodes, tolerance: &Tolerance) -> Vec<Edge> {
    let ends = 2 * edges.len();
    let mut pieces = Vec::with_capacity(edges.len());
    let mut first = 0;
    for (i, edge) in edges.iter().enumerate() {
        let count = cuts[first..].partition_point(|c| c.edge == i);
        let inner = (first..first + count).map(|k| (cuts[k].t, nodes.of[ends + k]));
        let stops = std::iter::once((0.0, nodes.of[2 * i])).chain(inner);
        let stops: Vec<(f64, u32)> = stops.chain([(1.0, nodes.of[2 * i + 1])]).collect();
        cut(edge, &stops, &nodes.points, tolerance, &mut pieces);
        first += count;
    }
    pieces
}

/// The parts of an edge between its stops; parts that shrink to a node vanish.
fn cut(edge: &Edge, stops: &[(f64, u32)], points: &[DVec2], tolerance: &Tolerance, pieces: &mut Vec<Edge>) {
    for w in stops.windows(2) {
        let [(from, start), (to, end)] = [w[0], w[1]];
        let ends = [start, end].map(|n| points[n as usize]);
        let segment = segment::with_ends(segment::part(&edge.segment, [from, to]), ends);
        // What leaves its node and comes back is a loop only if it goes away from it.
        if start == end && segment::reach(&segment) <= 2.0 * tolerance.join_mm {
            continue;
        }
        let sources = edge.sources.iter().map(|s| s.part([from, to])).collect();
        pieces.push(Edge { segment, nodes: [start, end], sources, ..edge.clone() });
    }
}

/// Drops nodes without edges.
fn compact(mut graph: Graph) -> Graph {
    let mut used = vec![false; graph.points.len()];
    graph.edges.iter().flat_map(|e| e.nodes).for_each(|n| used[n as usize] = true);
    let mut number = vec![0; graph.points.len()];
    let mut count = 0;
    for (n, used) in used.iter().enumerate() {
        number[n] = count;
        count += u32::from(*used);
    }
    graph.edges.iter_mut().flat_map(|e| &mut e.nodes).for_each(|n| *n = number[*n as usize]);
    let mut keep = used.iter();
    graph.points.retain(|_| keep.next().is_some_and(|u| *u));
    graph
}

/// How much the ends and insides of a line may claim the place of a node: boundaries stay where they are, curves
/// that pass through stay where they are, ends move to them; flat lines move to all others.
fn rank(role: Role, end: bool) -> u8 {
    match (role, end) {
        (Role::Boundary, true) => 0,
        (Role::Boundary, false) => 1,
        (Role::Flat, true) => 5,
        (Role::Flat, false) => 4,
        (_, false) => 2,
        (_, true) => 3,
    }
}

/// The ends of all edges, two for each, and the cuts.
fn candidates(edges: &[Edge], cuts: &[Cut]) -> Vec<Candidate> {
    let ends = edges.iter().flat_map(|e| {
        [e.segment.from(), e.segment.to()].map(|at| Candidate { at, rank: rank(e.role, true) })
    });
    let inner = cuts.iter().map(|c| Candidate { at: c.at, rank: rank(edges[c.edge].role, false) });
    ends.chain(inner).collect()
}

/// Neighbouring stops along an edge, at least one of them a cut, that are too near each other to be two.
fn slivers(edges: &[Edge], cuts: &[Cut], candidates: &[Candidate], tolerance: &Tolerance) -> Vec<[usize; 2]> {
    let ends = 2 * edges.len();
    let near = |a: usize, b: usize| candidates[a].at.distance(candidates[b].at) <= SLIVER * tolerance.join_mm;
    let mut ties = Vec::new();
    for (k, cut) in cuts.iter().enumerate() {
        let first = k == 0 || cuts[k - 1].edge != cut.edge;
        let before = if first { 2 * cut.edge } else { ends + k - 1 };
        ties.push([before, ends + k]);
        if cuts.get(k + 1).is_none_or(|n| n.edge != cut.edge) {
            ties.push([ends + k, 2 * cut.edge + 1]);
        }
    }
    ties.retain(|[a, b]| near(*a, *b));
    ties
}

/// A refusal if there are too many places to cut, or to look at.
fn refuse_excess(count: usize, most: usize) -> Result<(), PatternError> {
    if count <= most {
        return Ok(());
    }
    let what = "more lines meet, or run side by side, than in any pattern";
    let mend = "leave out hatchings and what else is no crease";
    Err(PatternError::TooMuch(issue(Severity::Error, what, mend)))
}

fn find_cuts(edges: &[Edge], tolerance: &Tolerance) -> Result<Vec<Cut>, PatternError> {
    let tree = tree(edges, tolerance);
    let mut cuts = Vec::new();
    let mut looked = 0;
    for (a, b) in tree.intersection_candidates_with_other_tree(&tree) {
        looked += 1;
        refuse_excess(looked, MAX_PAIRS)?;
        if a.edge < b.edge {
            cuts.extend(crossing_cuts(edges, [a, b], tolerance).into_iter().flatten());
            refuse_excess(cuts.len(), MAX_CUTS)?;
        }
    }
    let mut ends: Vec<DVec2> = edges.iter().flat_map(|e| [e.segment.from(), e.segment.to()]).collect();
    ends.sort_by(|a, b| super::clean::order(*a, *b));
    ends.dedup();
    for p in ends {
        // The chords are within the tolerance of their curves.
        for c in tree.locate_in_envelope_intersecting(around(p, 2.0 * tolerance.join_mm)) {
            looked += 1;
            refuse_excess(looked, MAX_PAIRS)?;
            cuts.extend(touch(edges, c, p, tolerance));
        }
        refuse_excess(cuts.len(), MAX_CUTS)?;
    }
    Ok(cuts)
}

/// The cuts of two edges where two of their chords cross.
fn crossing_cuts(edges: &[Edge], [a, b]: [&EdgeChord; 2], tolerance: &Tolerance) -> Option<[Cut; 2]> {
    let [sa, sb] = [a, b].map(|c| &edges[c.edge].segment);
    let [ta, tb] = crossing(sa, sb, &a.chord, &b.chord, tolerance)?;
    let at = segment::at(sa, ta);
    // Ends that meet anyway are one node already.
    let end = |s: &Segment| [s.from(), s.to()].into_iter().find(|e| e.distance(at) <= tolerance.join_mm);
    if let (Some(p), Some(q)) = (end(sa), end(sb))
        && p.distance(q) <= tolerance.join_mm
    {
        return None;
    }
    Some([Cut { edge: a.edge, t: ta, at }, Cut { edge: b.edge, t: tb, at }])
}

/// The cut of an edge where an end of another lies on it.
fn touch(edges: &[Edge], c: &EdgeChord, p: DVec2, tolerance: &Tolerance) -> Option<Cut> {
    let s = &edges[c.edge].segment;
    if s.from() == p || s.to() == p {
        return None;
    }
    let t = segment::nearest_from(s, &c.chord, p);
    let at = segment::at(s, t);
    let touches = 0.0 < t && t < 1.0 && at.distance(p) <= tolerance.join_mm;
    touches.then_some(Cut { edge: c.edge, t, at })
}

/// Parameters of the crossing of two curves near that of two of their chords.
pub(super) fn crossing(
    a: &Segment,
    b: &Segment,
    ca: &Chord,
    cb: &Chord,
    tolerance: &Tolerance,
) -> Option<[f64; 2]> {
    let [da, db] = [ca, cb].map(|c| c.ends[1] - c.ends[0]);
    if da.perp_dot(db).abs() <= PARALLEL * da.length() * db.length() {
        return None;
    }
    let (t, s) = polygon::segment_crossing(ca.ends[0], ca.ends[1], cb.ends[0], cb.ends[1])?;
    let along = |c: &Chord, share: f64| c.range[0] + share * (c.range[1] - c.range[0]);
    let guess = [along(ca, t), along(cb, s)];
    if let (Segment::Line { .. }, Segment::Line { .. }) = (a, b) {
        return Some(guess);
    }
    // Newton may run to another crossing: then only the chords' own one is sure.
    let width = |c: &Chord| c.range[1] - c.range[0];
    let near = |found: [f64; 2]| {
        (found[0] - guess[0]).abs() <= width(ca) && (found[1] - guess[1]).abs() <= width(cb)
    };
    let found =
        Some(newton(a, b, guess)).filter(|f| near(*f)).unwrap_or_else(|| bisection(a, b, *ca, *cb, guess));
    let met = segment::at(a, found[0]).distance(segment::at(b, found[1])) <= tolerance.join_mm;
    met.then_some(found)
}

/// A crossing of two curves from a guess.
fn newton(a: &Segment, b: &Segment, [mut ta, mut tb]: [f64; 2]) -> [f64; 2] {
    for _ in 0..CROSSING_STEPS {
        let off = segment::at(a, ta) - segment::at(b, tb);
        let [da, db] = [segment::derivative(a, ta), segment::derivative(b, tb)];
        let det = da.perp_dot(db);
        if det.abs() <= PARALLEL * da.length() * db.length() {
            break;
        }
        ta = (ta - off.perp_dot(db) / det).clamp(0.0, 1.0);
        tb = (tb - off.perp_dot(da) / det).clamp(0.0, 1.0);
    }
    [ta, tb]
}

/// The crossing of two chords, narrowed down by halves as long as the halves' chords cross.
fn bisection(a: &Segment, b: &Segment, mut ca: Chord, mut cb: Chord, mut guess: [f64; 2]) -> [f64; 2] {
    for _ in 0..BISECTIONS {
        let [as_, bs] = [halves(a, &ca), halves(b, &cb)];
        let pairs = as_.into_iter().flat_map(|p| bs.map(|q| (p, q)));
        let found = pairs.into_iter().find_map(|(p, q)| {
            let (t, s) = polygon::segment_crossing(p.ends[0], p.ends[1], q.ends[0], q.ends[1])?;
            Some((p, q, t, s))
        });
        let Some((p, q, t, s)) = found else { break };
        let along = |c: &Chord, share: f64| c.range[0] + share * (c.range[1] - c.range[0]);
        (ca, cb, guess) = (p, q, [along(&p, t), along(&q, s)]);
    }
    guess
}

fn halves(s: &Segment, chord: &Chord) -> [Chord; 2] {
    let [from, to] = chord.range;
    let middle = 0.5 * (from + to);
    let at = segment::at(s, middle);
    [
        Chord { range: [from, middle], ends: [chord.ends[0], at] },
        Chord { range: [middle, to], ends: [at, chord.ends[1]] },
    ]
}
