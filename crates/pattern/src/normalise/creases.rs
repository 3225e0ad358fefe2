//! The creases: edges on the sheet run together through nodes where nothing ends a crease.

use super::model::{Drawing, Edge, Graph, Half, Source, folds};
use super::segment;
use super::sheet::{Sheet, Where, oriented};
use super::stretch;
use super::told::Told;
use crate::PatternError;
use crate::error::{Origin, Place, issue, list};
use softfold_geometry::{
    Crease, CreaseId, DVec2, Issue, PlanarCurve, Role, Segment, Severity, Source as From, Tolerance,
};
use std::collections::BTreeSet;

/// Where two edges seem to make a corner, their directions are taken over this share of the refuse tolerance: a tiny
/// jog is no corner.
const JOG: f64 = 0.1;

/// A finished run of edges.
struct Run {
    halves: Vec<Half>,
    closed: bool,
}

/// All creases on the sheet, in the order of the file.
///
/// # Errors
/// A crease that is no curve.
pub(super) fn find(
    drawing: &Drawing<'_>,
    graph: &Graph,
    sheet: &Sheet,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Vec<Crease>, PatternError> {
    let walk = Walk::new(graph, sheet, tolerance);
    let mut runs: Vec<(Source, Run)> = Vec::new();
    for run in walk.runs() {
        let run = Run { halves: started(drawing, graph, run.halves, run.closed), ..run };
        let first = run.halves.iter().filter_map(|h| drawing.primary(&graph.edges[h.edge()]));
        if let Some(key) = first.min_by(|a, b| a.order(b)) {
            runs.push((*key, run));
        }
    }
    runs.sort_by(|a, b| a.0.order(&b.0));
    let mut free = Vec::new();
    let mut joined = Vec::new();
    let mut creases = Vec::new();
    for (_, run) in &runs {
        let origin = named(drawing, graph, run, &mut joined);
        free.extend(walk.free_ends(run).into_iter().map(|p| ends_inside(&origin, p)));
        let segments = stretch::segments(drawing, graph, &run.halves, tolerance);
        let edge = &graph.edges[run.halves[0].edge()];
        // A run that comes back to a corner or junction is two creases: a closed curve has no ends to meet there.
        for part in if run.closed { vec![segments] } else { stretch::open(segments) } {
            creases.push(crease(edge, part, &origin)?);
        }
    }
    told.push_all(joined);
    told.push_all(free);
    warn_of_short(&creases, tolerance, told);
    number(&mut creases);
    Ok(creases)
}

/// Creases shorter than the gaps that are closed mostly come from lines that should meet in one point.
fn warn_of_short(creases: &[Crease], tolerance: &Tolerance, told: &mut Told<'_>) {
    let short = creases.iter().filter(|c| folds(c.role) && c.curve.length_mm() < tolerance.refuse_mm);
    let lengths: Vec<(f64, &Crease)> = short.map(|c| (c.curve.length_mm(), c)).collect();
    let Some((longest, _)) = lengths.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else { return };
    let Some((shortest, least)) = lengths.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { return };
    let what = format!(
        "{} creases are only {shortest:.4} to {longest:.4} mm long, the shortest here",
        lengths.len()
    );
    let mend = "where lines should meet in one point, draw them so, or join wider gaps (join_mm)";
    let found = issue(Severity::Warning, what, mend).at(least.curve.end(0));
    told.push(Issue { element: Some(least.source.element.clone()), line: least.source.line, ..found });
}

fn ends_inside(origin: &Origin, at: DVec2) -> Issue {
    let what = "the crease ends inside the sheet";
    issue(Severity::Warning, what, "lead it to the outline unless this is meant").of(origin).at(at)
}

/// Edges on the sheet by node.
struct Walk<'g> {
    graph: &'g Graph,
    inside: Vec<bool>,
    /// All halves on the sheet or its rim that leave each node.
    leaving: Vec<Vec<Half>>,
    /// The half that continues each half beyond its end, whatever the turn.
    next: Vec<Option<Half>>,
    reach_mm: f64,
}

impl<'g> Walk<'g> {
    fn new(graph: &'g Graph, sheet: &Sheet, tolerance: &Tolerance) -> Self {
        let inside: Vec<bool> = sheet.places.iter().map(|p| *p == Where::Inside).collect();
        let mut leaving = graph.leaving();
        let there = |h: &Half| inside[h.edge()] || sheet.places[h.edge()] == Where::Rim;
        leaving.iter_mut().for_each(|l| l.retain(there));
        let mut next = vec![None; 2 * graph.edges.len()];
        for halves in &leaving {
            if let Some((a, b)) = continued(graph, halves) {
                next[a.twin().index()] = Some(b);
                next[b.twin().index()] = Some(a);
            }
        }
        Self { graph, inside, leaving, next, reach_mm: JOG * tolerance.refuse_mm }
    }

    /// All runs, open ones first.
    fn runs(&self) -> Vec<Run> {
        let count = self.graph.edges.len();
        let smooth: Vec<Option<Half>> =
            (0..2 * count).map(|i| self.smooth(Half::new(i / 2, i % 2))).collect();
        let mut used: Vec<bool> = self.inside.iter().map(|i| !i).collect();
        let mut runs = Vec::new();
        // Open runs start where nothing comes before; what is left are closed ones.
        let starts = |h: &Half| smooth[h.twin().index()].is_none();
        let all = || (0..2 * count).map(|i| Half::new(i / 2, i % 2));
        for start in all().filter(starts).chain(all()) {
            if used[start.edge()] {
                continue;
            }
            let mut halves = Vec::new();
            let mut at = Some(start);
            while let Some(half) = at.filter(|h| !used[h.edge()]) {
                used[half.edge()] = true;
                halves.push(half);
                at = smooth[half.index()];
            }
            runs.push(Run { halves, closed: at == Some(start) });
        }
        runs
    }

    /// What continues a half, if not round a corner.
    fn smooth(&self, half: Half) -> Option<Half> {
        let next = self.next[half.index()]?;
        let directions =
            [half.twin(), next].map(|h| segment::leaving(&self.graph.edges[h.edge()].segment, h.side()));
        let turn = |[back, on]: [DVec2; 2]| (-back).angle_to(on).abs();
        if turn(directions) < stretch::CORNER_RAD {
            return Some(next);
        }
        let corner = self.graph.point(next);
        let far = [half.twin(), next].map(|h| self.ahead(h, corner) - corner);
        (turn(far) < stretch::CORNER_RAD && far.iter().all(|d| *d != DVec2::ZERO)).then_some(next)
    }

    /// A point along a run, beyond the reach of a jog if the run goes that far.
    fn ahead(&self, start: Half, from: DVec2) -> DVec2 {
        let mut half = start;
        loop {
            let to = self.graph.point(half.twin());
            match self.next[half.index()] {
                Some(on) if to.distance(from) < self.reach_mm && on.edge() != start.edge() && to != from => {
                    half = on
                }
                _ if to.distance(from) < self.reach_mm => return to,
                _ => break,
            }
        }
        // The first point of the edge that is far enough.
        let run = self.graph.run(half);
        let chords = segment::chords(&run, self.reach_mm);
        let mut ends = chords.map(|c| c.ends[1]);
        ends.find(|p| p.distance(from) >= self.reach_mm).unwrap_or(run.to())
    }

    /// Ends of a folding crease where nothing else is.
    fn free_ends(&self, run: &Run) -> Vec<DVec2> {
        let (Some(first), Some(last)) = (run.halves.first(), run.halves.last()) else { return Vec::new() };
        if run.closed || !folds(self.graph.edges[first.edge()].role) {
            return Vec::new();
        }
        let counts = |h: &&Half| self.graph.edges[h.edge()].role != Role::Flat;
        let free = |h: &Half| self.leaving[self.graph.node(*h)].iter().filter(counts).count() == 1;
        [*first, last.twin()].iter().filter(|h| free(h)).map(|h| self.graph.point(*h)).collect()
    }
}

/// Pairs of halves at a node that continue each other: two creases of one kind that meet alone, and flat lines where
/// nothing else is.
fn continued(graph: &Graph, halves: &[Half]) -> Option<(Half, Half)> {
    let edge = |h: &Half| &graph.edges[h.edge()];
    if halves.iter().any(|h| edge(h).is_rim()) {
        return None;
    }
    let folding: Vec<Half> = halves.iter().copied().filter(|h| folds(edge(h).role)).collect();
    let pair = if folding.is_empty() { halves } else { &folding };
    let [a, b] = *pair else { return None };
    let same = |a: &Edge, b: &Edge| a.role == b.role && a.fold_angle_rad == b.fold_angle_rad;
    same(edge(&a), edge(&b)).then_some((a, b))
}

/// The run in the direction of its first element; a closed one starts where that starts.
fn started(drawing: &Drawing<'_>, graph: &Graph, halves: Vec<Half>, closed: bool) -> Vec<Half> {
    let mut halves = oriented(graph, halves);
    let key = |h: &Half| drawing.primary(&graph.edges[h.edge()]).map(|s| (s.subpath, s.begin()));
    let first = (0..halves.len())
        .min_by(|a, b| key(&halves[*a]).partial_cmp(&key(&halves[*b])).unwrap_or(std::cmp::Ordering::Equal));
    if closed {
        halves.rotate_left(first.unwrap_or_default());
    }
    halves
}

/// The element that a crease goes by: the first with an id, else the first; the others are told.
fn named(drawing: &Drawing<'_>, graph: &Graph, run: &Run, joined: &mut Vec<Issue>) -> Origin {
    let mut origins: Vec<Origin> = Vec::new();
    let mut seen = BTreeSet::new();
    for half in &run.halves {
        let Some(drawn) = drawing.primary(&graph.edges[half.edge()]) else { continue };
        let stroke = drawing.subpaths[drawn.subpath as usize].stroke;
        if seen.insert(stroke) {
            origins.push(drawing.strokes[stroke].origin.clone());
        }
    }
    let with_id = origins.iter().position(|o| o.id.is_some()).unwrap_or_default();
    if origins.is_empty() {
        return Origin::default();
    }
    let origin = origins.remove(with_id);
    if !origins.is_empty() {
        let message = format!("joined with what continues it: {}", list(&origins));
        joined.push(issue(Severity::Note, message, "").of(&origin));
    }
    origin
}

fn crease(edge: &Edge, segments: Vec<Segment>, origin: &Origin) -> Result<Crease, PatternError> {
    let curve = PlanarCurve::new(segments).map_err(|e| {
        PatternError::Crease(issue(Severity::Error, e.to_string(), "redraw the element").of(origin))
    })?;
    Ok(Crease {
        id: CreaseId::new(0),
        name: origin.id.clone().unwrap_or_default(),
        role: edge.role,
        curve,
        fold_angle_rad: edge.fold_angle_rad,
        source: From { element: origin.label.clone(), line: origin.line },
    })
}

/// Numbers the creases; each has a name of its own.
fn number(creases: &mut [Crease]) {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut counts: std::collections::BTreeMap<String, usize> = std::collections::BTreeMap::new();
    for (i, c) in creases.iter_mut().enumerate() {
        let wanted = if c.name.is_empty() { format!("crease-{}", i + 1) } else { c.name.clone() };
        let count = counts.entry(wanted.clone()).or_insert(0);
        loop {
            *count += 1;
            c.name = if *count == 1 { wanted.clone() } else { format!("{wanted}-{count}") };
            if taken.insert(c.name.clone()) {
                break;
            }
        }
        c.id = CreaseId::new(i);
    }
}
