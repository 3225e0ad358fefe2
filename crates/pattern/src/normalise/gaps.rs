//! Ends that miss their aim by little: gaps are closed, overshoots trimmed; every one is told.

use super::model::{Drawing, Edge, Graph, Half, folds};
use super::segment::{self, Chord};
use super::split::{self, EdgeChord};
use super::told::Told;
use crate::PatternError;
use crate::error::{Origin, Place, issue};
use rstar::RTree;
use softfold_geometry::{DVec2, Issue, Role, Segment, Severity, Tolerance};
use std::collections::{BTreeMap, BTreeSet};

/// Gaps wider than this share of the line's own length are meant: short ticks and dots are not pulled about.
const GAP_SHARE: f64 = 0.25;
/// An end is led on along its own direction if that takes no more than so many times the shortest way.
const DETOUR: f64 = 4.0;
/// An end goes to a node rather than to a line that is nearer by less than this factor.
const NODE_PREFERENCE: f64 = 1.5;
/// Within this angle of its direction an end is led straight to its aim, rad (30°): that makes no corner.
const AHEAD_RAD: f64 = 0.52;
/// An end that is pulled aside takes at least so many gaps of its line with it: no corner either.
const PULLED_GAPS: f64 = 2.0;
/// Nodes where more lines meet hold no free end, whatever they are.
const MAX_CROWD: usize = 64;
/// Chords that are looked at for an end, the nearest first, and how many of them that are not its own line.
const MAX_LOOKED_AT: usize = 400;
const MAX_NEAR: usize = 40;
/// Rounds: what is mended may bring other ends near.
const MAX_ROUNDS: usize = 3;

/// An end where a line stops.
struct End {
    half: Half,
    at: DVec2,
    /// Direction in which the line would go on.
    ahead: DVec2,
    /// Widest gap that is closed here.
    limit_mm: f64,
    origin: Origin,
    role: Role,
    /// Subpath, to keep the order of the file.
    subpath: u32,
}

/// Where an end should go.
#[derive(Clone, Copy)]
struct Aim {
    at: DVec2,
    gap_mm: f64,
    /// The edge that is there.
    edge: usize,
    /// The other free end, if it is one.
    other: Option<usize>,
    /// Reached straight on along its own direction.
    on_ray: bool,
}

/// Mends the gaps and overshoots of a graph.
///
/// # Errors
/// More crossings than any pattern has.
pub(super) fn mend(
    drawing: &Drawing<'_>,
    graph: &mut Graph,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<(), PatternError> {
    let mut found = trim(drawing, graph, tolerance);
    let mut changed = !found.is_empty();
    for _ in 0..MAX_ROUNDS {
        if changed {
            let edges = std::mem::take(&mut graph.edges);
            *graph = split::once(drawing, edges, tolerance)?.graph;
        }
        let joined = join(drawing, graph, tolerance);
        changed = !joined.is_empty();
        if !changed {
            break;
        }
        found.extend(joined);
    }
    if !found.is_empty() {
        let edges = std::mem::take(&mut graph.edges);
        *graph = split::split(drawing, edges, tolerance)?.0;
    }
    found.sort_by_key(|(subpath, _)| *subpath);
    told.push_all(found.into_iter().map(|(_, issue)| issue).collect());
    Ok(())
}

/// Free ends: no other line that counts is there. Cuts end freely by nature, unless they stand for the boundary.
fn free_ends(drawing: &Drawing<'_>, graph: &Graph, leaving: &[Vec<Half>], tolerance: &Tolerance) -> Vec<End> {
    let boundary = graph.edges.iter().any(|e| e.role == Role::Boundary);
    let mut ends = Vec::new();
    for halves in leaving {
        if halves.len() > MAX_CROWD {
            continue;
        }
        for &half in halves {
            let edge = &graph.edges[half.edge()];
            let counts = |o: &&Half| **o != half && counts(edge.role, graph.edges[o.edge()].role);
            if halves.iter().any(|o| counts(&o)) || (edge.role == Role::Cut && boundary) {
                continue;
            }
            ends.extend(end(drawing, graph, half, tolerance));
        }
    }
    ends
}

/// Whether a line of one role ends at one of the other: the boundary only at the boundary, flat lines at all.
fn counts(role: Role, other: Role) -> bool {
    match role {
        Role::Boundary => matches!(other, Role::Boundary | Role::Cut),
        Role::Flat => true,
        _ => other != Role::Flat,
    }
}

fn end(drawing: &Drawing<'_>, graph: &Graph, half: Half, tolerance: &Tolerance) -> Option<End> {
    let edge = &graph.edges[half.edge()];
    let length = |s: &super::model::Source| drawing.subpaths[s.subpath as usize].length_mm;
    let longest = edge.sources.iter().map(length).fold(0.0, f64::max);
    Some(End {
        half,
        at: graph.point(half),
        ahead: -segment::leaving(&edge.segment, half.side()),
        limit_mm: tolerance.refuse_mm.min(GAP_SHARE * longest),
        origin: drawing.origin(edge),
        role: edge.role,
        subpath: drawing.primary(edge)?.subpath,
    })
}

/// The edges from an end up to the first node where other lines are, or until they are longer than `reach_mm`; and
/// the halves that leave that node, if it was reached.
fn tail<'l>(
    graph: &Graph,
    leaving: &'l [Vec<Half>],
    end: &End,
    reach_mm: f64,
) -> (Vec<Half>, f64, Option<&'l [Half]>) {
    let (mut half, mut length, mut run) = (end.half, 0.0, Vec::new());
    loop {
        run.push(half);
        length += segment::length(&graph.edges[half.edge()].segment);
        if length > reach_mm {
            return (run, length, None);
        }
        let there = &leaving[graph.node(half.twin())];
        let mut counting = there.iter().filter(|h| counts(end.role, graph.edges[h.edge()].role));
        let on = match (counting.next(), counting.next(), counting.next()) {
            (Some(a), Some(b), None) => *if *a == half.twin() { b } else { a },
            _ => return (run, length, Some(there)),
        };
        if on.edge() == end.half.edge() || on.edge() == half.edge() {
            return (run, length, Some(there));
        }
        half = on;
    }
}

/// Removes short tails beyond the last line that they cross.
fn trim(drawing: &Drawing<'_>, graph: &mut Graph, tolerance: &Tolerance) -> Vec<(u32, Issue)> {
    let leaving = graph.leaving();
    let mut gone = BTreeSet::new();
    let mut told = Vec::new();
    for end in free_ends(drawing, graph, &leaving, tolerance) {
        let (run, _, Some(there)) = tail(graph, &leaving, &end, end.limit_mm) else { continue };
        let counting = there.iter().filter(|h| counts(end.role, graph.edges[h.edge()].role));
        let others: Vec<&Half> = counting.filter(|h| run.iter().all(|r| r.edge != h.edge)).collect();
        if others.len() < 2 {
            continue;
        }
        let past = others.iter().min_by_key(|h| graph.edges[h.edge()].role);
        let past = past.map_or(String::new(), |h| place(drawing, graph, h.edge()));
        let off = |h: &&Half| segment::distance(&graph.edges[h.edge()].segment, end.at, tolerance.join_mm);
        let far = others.iter().map(off).fold(f64::INFINITY, f64::min);
        let what = format!("the {} ran {far:.3} mm past {past}; it was trimmed", noun(end.role));
        let found = issue(Severity::Warning, what, "end it there").of(&end.origin).at(end.at);
        told.push((end.subpath, found));
        gone.extend(run.iter().map(|h| h.edge()));
    }
    let mut number = 0..;
    graph.edges.retain(|_| number.next().is_some_and(|i| !gone.contains(&i)));
    told
}

fn noun(role: Role) -> &'static str {
    match role {
        Role::Boundary => "outline",
        Role::Cut => "cut",
        Role::Flat => "flat line",
        _ => "crease",
    }
}

/// What an edge is called in a sentence.
fn place(drawing: &Drawing<'_>, graph: &Graph, edge: usize) -> String {
    match graph.edges[edge].role {
        Role::Boundary => "the boundary".to_owned(),
        _ => drawing.origin(&graph.edges[edge]).to_string(),
    }
}

/// Leads free ends to what is near, the nearest first; each end once.
fn join(drawing: &Drawing<'_>, graph: &mut Graph, tolerance: &Tolerance) -> Vec<(u32, Issue)> {
    let leaving = graph.leaving();
    let ends = free_ends(drawing, graph, &leaving, tolerance);
    if ends.is_empty() {
        return Vec::new();
    }
    let search = Search::new(graph, &leaving, &ends, tolerance);
    let mut aims: Vec<(usize, Aim)> =
        (0..ends.len()).filter_map(|i| search.aim(i).map(|aim| (i, aim))).collect();
    aims.sort_by(|(i, a), (k, b)| {
        // The outline first, so that creases find it.
        let inner = |i: usize| ends[i].role != Role::Boundary;
        let place = super::clean::order(ends[*i].at, ends[*k].at);
        inner(*i).cmp(&inner(*k)).then(a.gap_mm.total_cmp(&b.gap_mm)).then(place)
    });
    let mut moves = Moves::default();
    let mut used = BTreeSet::new();
    let mut told = Vec::new();
    for (i, aim) in aims {
        let mates = [Some(i), aim.other];
        if mates.iter().flatten().any(|m| used.contains(m)) || !moves.lead(graph, &leaving, &ends, i, &aim) {
            continue;
        }
        used.extend(mates.into_iter().flatten());
        told.push(describe(drawing, graph, &ends, i, &aim));
    }
    moves.apply(graph);
    told
}

fn describe(drawing: &Drawing<'_>, graph: &Graph, ends: &[End], i: usize, aim: &Aim) -> (u32, Issue) {
    let end = &ends[i];
    let gap = aim.gap_mm;
    let Some(other) = aim.other.map(|o| &ends[o]) else {
        let place = place(drawing, graph, aim.edge);
        let what = format!("the {} ended {gap:.3} mm before {place}; it was led there", noun(end.role));
        let found = issue(Severity::Warning, what, "end it there").of(&end.origin).at(end.at);
        return (end.subpath, found);
    };
    let (first, second) = if other.subpath < end.subpath { (other, end) } else { (end, other) };
    let what = format!(
        "the {} has a gap of {gap:.3} mm between {} and {}; it was closed",
        noun(first.role),
        first.origin,
        second.origin
    );
    let found = issue(Severity::Warning, what, "make the ends meet").of(&first.origin).at(first.at);
    (first.subpath, found)
}

/// Where two straight lines would meet that both stop short of their corner.
fn corner(graph: &Graph, a: &End, b: &End, gap_mm: f64) -> Option<DVec2> {
    let line = |e: &End| matches!(graph.edges[e.half.edge()].segment, Segment::Line { .. });
    let turns = a.ahead.angle_to(-b.ahead).abs() > AHEAD_RAD;
    if !turns || !line(a) || !line(b) || a.half.edge() == b.half.edge() {
        return None;
    }
    let (gap, sine) = (b.at - a.at, a.ahead.perp_dot(b.ahead));
    let legs = [gap.perp_dot(b.ahead) / sine, gap.perp_dot(a.ahead) / sine];
    legs.iter().all(|leg| (0.0..=gap_mm).contains(leg)).then(|| a.at + legs[0] * a.ahead)
}

/// Looks for what is near an end.
struct Search<'a> {
    graph: &'a Graph,
    leaving: &'a [Vec<Half>],
    ends: &'a [End],
    tree: RTree<EdgeChord>,
    /// Number of the free end at a node.
    free: BTreeMap<usize, usize>,
    tolerance: &'a Tolerance,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph, leaving: &'a [Vec<Half>], ends: &'a [End], tolerance: &'a Tolerance) -> Self {
        let tree = split::tree(&graph.edges, tolerance);
        let free = ends.iter().enumerate().map(|(i, e)| (graph.node(e.half), i)).collect();
        Self { graph, leaving, ends, tree, free, tolerance }
    }

    /// Where an end should go, if anything is near: boundaries go to boundaries first.
    fn aim(&self, i: usize) -> Option<Aim> {
        let end = &self.ends[i];
        if end.limit_mm <= self.tolerance.join_mm {
            return None;
        }
        let own = self.own(end);
        let reach = end.limit_mm.powi(2);
        let near = self.tree.nearest_neighbor_iter_with_distance_2(end.at.to_array());
        let near = near.take_while(|(_, d)| *d <= reach).map(|(c, _)| c).take(MAX_LOOKED_AT);
        let near: Vec<&EdgeChord> = near.filter(|c| !own.contains(&c.edge)).take(MAX_NEAR).collect();
        let aim = self.among(i, &near, |role| counts(end.role, role));
        // A boundary that is open otherwise may end at creases.
        let at_crease =
            || self.leaving[self.graph.node(end.half)].iter().any(|h| folds(self.graph.edges[h.edge()].role));
        if aim.is_none() && end.role == Role::Boundary && !at_crease() {
            return self.among(i, &near, |role| role != Role::Flat);
        }
        aim
    }

    /// The edges of an end's own line near it, and those that leave the node where it begins.
    fn own(&self, end: &End) -> BTreeSet<usize> {
        let (run, _, there) = tail(self.graph, self.leaving, end, DETOUR * end.limit_mm);
        let mut own: BTreeSet<usize> = run.iter().map(|h| h.edge()).collect();
        own.extend(there.unwrap_or_default().iter().map(|h| h.edge()));
        own
    }

    fn among(&self, i: usize, near: &[&EdgeChord], counts: impl Fn(Role) -> bool) -> Option<Aim> {
        let end = &self.ends[i];
        let near: Vec<&EdgeChord> =
            near.iter().copied().filter(|c| counts(self.graph.edges[c.edge].role)).collect();
        let node = near.iter().flat_map(|c| [0, 1].map(|side| Half::new(c.edge, side))).map(|half| Aim {
            at: self.graph.point(half),
            gap_mm: self.graph.point(half).distance(end.at),
            edge: half.edge(),
            other: self.free.get(&self.graph.node(half)).copied().filter(|o| *o != i),
            on_ray: false,
        });
        let line = near.iter().map(|c| self.foot(end, c));
        let order = |a: &Aim, b: &Aim| {
            a.gap_mm.total_cmp(&b.gap_mm).then(super::clean::order(a.at, b.at)).then(a.edge.cmp(&b.edge))
        };
        let node = node.filter(|n| n.at != end.at).min_by(order).filter(|n| n.gap_mm <= end.limit_mm);
        let line = line.min_by(order)?;
        match node {
            Some(node) if node.gap_mm <= NODE_PREFERENCE * line.gap_mm => Some(node),
            _ => Some(self.ray(end, &near, line.gap_mm).unwrap_or(line))
                .filter(|a| a.gap_mm <= DETOUR * end.limit_mm),
        }
    }

    /// The point of an edge nearest to an end.
    fn foot(&self, end: &End, c: &EdgeChord) -> Aim {
        let s = &self.graph.edges[c.edge].segment;
        let at = segment::at(s, segment::nearest_from(s, &c.chord, end.at));
        Aim { at, gap_mm: at.distance(end.at), edge: c.edge, other: None, on_ray: false }
    }

    /// Where an end first meets a line straight on.
    fn ray(&self, end: &End, near: &[&EdgeChord], shortest_mm: f64) -> Option<Aim> {
        let to = end.at + DETOUR * shortest_mm * end.ahead;
        let ray = Segment::Line { from: end.at, to };
        let chord = Chord { range: [0.0, 1.0], ends: [end.at, to] };
        let hits = near.iter().filter_map(|c| {
            let s = &self.graph.edges[c.edge].segment;
            let [t, u] = split::crossing(&ray, s, &chord, &c.chord, self.tolerance)?;
            Some((
                t,
                Aim { at: segment::at(s, u), gap_mm: shortest_mm, edge: c.edge, other: None, on_ray: true },
            ))
        });
        hits.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.edge.cmp(&b.1.edge))).map(|h| h.1)
    }
}

/// Changes of a graph, made at once.
#[derive(Default)]
struct Moves {
    /// Edges that ends are led to: they must stay where they are.
    aims: BTreeSet<usize>,
    gone: BTreeSet<usize>,
    moved: BTreeMap<usize, Segment>,
    added: Vec<Edge>,
}

impl Moves {
    /// Leads an end to its aim: straight on if the aim is ahead of it, or of the other end; else by pulling the end
    /// aside. False if that needs an edge that has been changed, or changes one that is an aim.
    fn lead(&mut self, graph: &Graph, leaving: &[Vec<Half>], ends: &[End], i: usize, aim: &Aim) -> bool {
        let led = self.try_lead(graph, leaving, ends, i, aim);
        if led && aim.other.is_none() {
            self.aims.insert(aim.edge);
        }
        led
    }

    fn try_lead(&mut self, graph: &Graph, leaving: &[Vec<Half>], ends: &[End], i: usize, aim: &Aim) -> bool {
        if self.gone.contains(&aim.edge) || self.moved.contains_key(&aim.edge) {
            return false;
        }
        let end = &ends[i];
        let ahead = |e: &End, p: DVec2| e.ahead.angle_to(p - e.at).abs() <= AHEAD_RAD;
        let other = aim.other.map(|o| &ends[o]);
        if let Some((o, at)) = other.and_then(|o| Some((o, corner(graph, end, o, aim.gap_mm)?))) {
            return self.is_free(o.half.edge()) && self.extend(graph, end, at) && self.extend(graph, o, at);
        }
        if aim.on_ray || ahead(end, aim.at) {
            return self.extend(graph, end, aim.at);
        }
        match other {
            Some(o) if ahead(o, end.at) => self.extend(graph, o, end.at),
            // The longer line bends less.
            Some(o) if o.limit_mm > end.limit_mm => self.pull(graph, leaving, o, end.at, aim.gap_mm),
            _ => self.pull(graph, leaving, end, aim.at, aim.gap_mm),
        }
    }

    fn is_free(&self, edge: usize) -> bool {
        !self.gone.contains(&edge) && !self.moved.contains_key(&edge) && !self.aims.contains(&edge)
    }

    fn extend(&mut self, graph: &Graph, end: &End, to: DVec2) -> bool {
        let edge = &graph.edges[end.half.edge()];
        if !self.is_free(end.half.edge()) {
            return false;
        }
        match edge.segment {
            Segment::Line { .. } => self.set_end(end.half, graph, to),
            Segment::Cubic { .. } => {
                let at = end.half.side() as f64;
                let sources = edge.sources.iter().map(|s| s.part([at, at])).collect();
                let segment = Segment::Line { from: end.at, to };
                self.added.push(Edge { segment, sources, ..edge.clone() });
            }
        }
        true
    }

    fn set_end(&mut self, half: Half, graph: &Graph, to: DVec2) {
        let s = graph.edges[half.edge()].segment;
        let ends = if half.side() == 0 { [to, s.to()] } else { [s.from(), to] };
        self.moved.insert(half.edge(), segment::with_ends(s, ends));
    }

    fn pull(&mut self, graph: &Graph, leaving: &[Vec<Half>], end: &End, to: DVec2, gap_mm: f64) -> bool {
        let (run, ..) = tail(graph, leaving, end, PULLED_GAPS * gap_mm);
        let (Some(last), true) = (run.last(), run.iter().all(|h| self.is_free(h.edge()))) else {
            return false;
        };
        let alone = |h: &Half| leaving[graph.node(h.twin())].len() == 2;
        // Only what nothing else hangs on is taken along.
        let last = run.iter().find(|h| !alone(h)).unwrap_or(last);
        for half in run.iter().take_while(|h| h != &last) {
            self.gone.insert(half.edge());
        }
        self.set_end(*last, graph, to);
        true
    }

    fn apply(self, graph: &mut Graph) {
        for (edge, segment) in self.moved {
            graph.edges[edge].segment = segment;
        }
        let mut number = 0..;
        graph.edges.retain(|_| number.next().is_some_and(|i| !self.gone.contains(&i)));
        graph.edges.extend(self.added);
    }
}
