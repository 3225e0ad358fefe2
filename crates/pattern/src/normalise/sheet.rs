//! The sheet within its outline: holes and slits, and what is on it.

use super::cluster::Groups;
use super::contour::{area, contours, simple_loops};
use super::model::{Drawing, Graph, Half};
use super::outline::{Found, contour_origin};
use super::region::{Region, by_area, depths};
use super::segment;
use super::told::Told;
use crate::PatternError;
use crate::error::{Origin, Place, issue, list};
use softfold_geometry::{Issue, Role, Severity, Tolerance};
use std::collections::{BTreeMap, BTreeSet};

/// Where an edge is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Where {
    /// On outline, hole or slit.
    Rim,
    /// On the sheet.
    Inside,
    /// Beyond the outline.
    Outside,
    /// Where a hole is.
    Hole,
    /// On another sheet.
    Elsewhere,
    /// Left out.
    Gone,
}

/// The sheet.
pub(super) struct Sheet {
    /// The outline, counter-clockwise.
    pub(super) outline: Vec<Half>,
    /// The holes, clockwise.
    pub(super) holes: Vec<Vec<Half>>,
    /// The slits.
    pub(super) slits: Vec<Vec<Half>>,
    /// Where each edge is.
    pub(super) places: Vec<Where>,
    /// Outline and holes.
    pub(super) region: Region,
}

/// Finds holes and slits, and where everything else is.
pub(super) fn find(
    drawing: &Drawing<'_>,
    graph: &Graph,
    found: Found,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Sheet {
    let mut places = around(graph, &found, tolerance);
    if found.drawn {
        refuse_crossings(drawing, graph, &mut places, told);
    }
    let rims: Vec<bool> =
        graph.edges.iter().zip(&places).map(|(e, p)| e.is_rim() && *p == Where::Inside).collect();
    let closed = contours(graph, &rims);
    let mut holes = holes(drawing, graph, &found.outline, closed.outer, tolerance, told);
    mark_holes(graph, &holes, tolerance, &mut places);
    let is_slit = |e: &usize| rims[*e] && places[*e] == Where::Inside;
    let slit_edges: Vec<usize> = (0..places.len()).filter(is_slit).collect();
    slit_edges.iter().for_each(|&e| places[e] = Where::Rim);
    let slits = slits(graph, &slit_edges, &found.outline, &mut holes);
    tell_slits(drawing, graph, &slits, told);
    warn_of_splits(drawing, graph, &slits, &found.outline, &holes, told);
    let region = Region::new(graph, std::iter::once(&found.outline).chain(&holes), tolerance);
    let turned = |l: Vec<Half>| l.iter().rev().map(|h| h.twin()).collect();
    Sheet { outline: found.outline, holes: holes.into_iter().map(turned).collect(), slits, places, region }
}

/// Where edges are before holes are known.
fn around(graph: &Graph, found: &Found, tolerance: &Tolerance) -> Vec<Where> {
    let outer = Region::new(graph, [&found.outline], tolerance);
    let others = Region::new(graph, &found.others, tolerance);
    let middle = |e: usize| segment::at(&graph.edges[e].segment, 0.5);
    let place = |e: usize| match middle(e) {
        p if outer.contains(p) => Where::Inside,
        p if others.contains(p) => Where::Elsewhere,
        _ => Where::Outside,
    };
    let mut places: Vec<Where> = (0..graph.edges.len()).map(place).collect();
    found.others.iter().flatten().for_each(|h| places[h.edge()] = Where::Elsewhere);
    found.outline.iter().for_each(|h| places[h.edge()] = Where::Rim);
    places
}

/// Closed boundary elements of which a part is on the outline and a part alone inside cross it: two such elements
/// cross each other, which is refused; one crosses itself, and what is inside falls away.
fn refuse_crossings(drawing: &Drawing<'_>, graph: &Graph, places: &mut [Where], told: &mut Told<'_>) {
    let of_outline = |(e, p): (&super::model::Edge, &Where)| {
        let sources = if *p == Where::Rim { e.sources.as_slice() } else { &[] };
        sources.iter().map(|s| s.subpath).collect::<Vec<_>>()
    };
    let on: BTreeSet<u32> = graph.edges.iter().zip(places.iter()).flat_map(of_outline).collect();
    let crosses = |e: usize| match &graph.edges[e].sources[..] {
        [s] => {
            graph.edges[e].role == Role::Boundary
                && on.contains(&s.subpath)
                && drawing.subpaths[s.subpath as usize].closed
        }
        _ => false,
    };
    let inner: Vec<usize> =
        (0..graph.edges.len()).filter(|&e| places[e] == Where::Inside && crosses(e)).collect();
    let subpaths: BTreeSet<u32> =
        inner.iter().flat_map(|&e| &graph.edges[e].sources).map(|s| s.subpath).collect();
    let (Some(first), Some(last)) = (subpaths.first(), subpaths.last()) else { return };
    let rim: BTreeSet<u32> =
        (0..places.len()).filter(|&e| places[e] == Where::Rim).flat_map(|e| graph.edges[e].nodes).collect();
    let origin = |s: &u32| &drawing.strokes[drawing.subpaths[*s as usize].stroke].origin;
    let met = inner.iter().flat_map(|&e| graph.edges[e].nodes).find(|n| rim.contains(n));
    let at = graph.points[met.unwrap_or_default() as usize];
    inner.iter().for_each(|&e| places[e] = Where::Gone);
    if first == last {
        let what = "the boundary crosses itself; its outer contour is the outline";
        let found = issue(Severity::Warning, what, "redraw it without the crossing");
        told.push(found.of(origin(first)).at(at));
        return;
    }
    let what = format!("it crosses the boundary {}", origin(first));
    let mend = "keep outline and holes apart; if one outline is drawn twice, delete one or join wider gaps (join_mm)";
    let found = issue(Severity::Error, what, mend).of(origin(last)).at(at);
    told.refuse(PatternError::Outline(found));
}

/// The outermost closed contours inside the outline, counter-clockwise; those inside others are told. Contours that
/// hang on the outline in several nodes are none: they divide the sheet.
fn holes(
    drawing: &Drawing<'_>,
    graph: &Graph,
    outline: &[Half],
    closed: Vec<Vec<Half>>,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Vec<Vec<Half>> {
    let on: BTreeSet<usize> = outline.iter().map(|h| graph.node(*h)).collect();
    let touches = |l: &Vec<Half>| l.iter().filter(|h| on.contains(&graph.node(**h))).count();
    let loops = closed.iter().flat_map(|c| simple_loops(graph, c)).filter(|l| touches(l) < 2);
    let mut holes = by_area(graph, loops.collect());
    let depths = depths(graph, &holes, tolerance);
    let mut depth = depths.iter();
    let inner: Vec<Issue> = holes
        .iter()
        .zip(&depths)
        .filter(|(_, d)| **d > 0)
        .map(|(l, _)| {
            let what = "a closed boundary inside a hole is ignored";
            let found = issue(Severity::Warning, what, "delete it if it is not meant");
            found.of(&contour_origin(drawing, graph, l)).at(graph.point(l[0]))
        })
        .collect();
    told.push_all(inner);
    holes.retain(|_| depth.next() == Some(&0));
    // In the order of the file.
    let first = |l: &Vec<Half>| {
        let sources = l.iter().flat_map(|h| &graph.edges[h.edge()].sources);
        sources.min_by(|a, b| a.order(b)).map(|s| (s.subpath, s.begin()))
    };
    holes.sort_by(|a, b| first(a).partial_cmp(&first(b)).unwrap_or(std::cmp::Ordering::Equal));
    holes
}

fn mark_holes(graph: &Graph, holes: &[Vec<Half>], tolerance: &Tolerance, places: &mut [Where]) {
    holes.iter().flatten().for_each(|h| places[h.edge()] = Where::Rim);
    let region = Region::new(graph, holes, tolerance);
    for (e, place) in places.iter_mut().enumerate() {
        if *place == Where::Inside && region.contains(segment::at(&graph.edges[e].segment, 0.5)) {
            *place = Where::Hole;
        }
    }
}

/// Slits as runs of edges through nodes where nothing else of the boundary is; in the order of the file. Runs that
/// close are holes.
fn slits(graph: &Graph, edges: &[usize], outline: &[Half], holes: &mut Vec<Vec<Half>>) -> Vec<Vec<Half>> {
    let closed: BTreeSet<usize> =
        outline.iter().chain(holes.iter().flatten()).map(|h| graph.node(*h)).collect();
    let mut at: BTreeMap<usize, Vec<Half>> = BTreeMap::new();
    for half in edges.iter().flat_map(|&e| [Half::new(e, 0), Half::new(e, 1)]) {
        at.entry(graph.node(half)).or_default().push(half);
    }
    let ends = |node: &usize| at[node].len() != 2 || closed.contains(node);
    let mut used = BTreeSet::new();
    let mut slits = Vec::new();
    for &start in at.iter().filter(|(n, _)| ends(n)).flat_map(|(_, halves)| halves) {
        let mut run = Vec::new();
        let mut half = start;
        while used.insert(half.edge()) {
            run.push(half);
            let node = graph.node(half.twin());
            match at[&node].iter().find(|h| **h != half.twin()) {
                Some(next) if !ends(&node) => half = *next,
                _ => break,
            }
        }
        match (run.first(), run.last()) {
            (Some(first), Some(last)) if graph.node(*first) == graph.node(last.twin()) => {
                let turned = area(graph, &run) < 0.0;
                let ring = |run: Vec<Half>| run.iter().rev().map(|h| h.twin()).collect();
                holes.push(if turned { ring(run) } else { run });
            }
            (Some(_), _) => slits.push(oriented(graph, run)),
            _ => {}
        }
    }
    let first = |run: &Vec<Half>| {
        let sources = run.iter().flat_map(|h| &graph.edges[h.edge()].sources);
        sources.min_by(|a, b| a.order(b)).map(|s| (s.subpath, s.begin()))
    };
    slits.sort_by(|a, b| first(a).partial_cmp(&first(b)).unwrap_or(std::cmp::Ordering::Equal));
    slits
}

/// A run in the direction in which its first element was drawn.
pub(super) fn oriented(graph: &Graph, run: Vec<Half>) -> Vec<Half> {
    let source = |h: &Half| {
        let least = graph.edges[h.edge()].sources.iter().min_by(|a, b| a.order(b));
        least.map(|s| if h.side() == 0 { *s } else { s.reversed() })
    };
    let first = run.iter().filter_map(source).min_by(|a, b| a.order(b));
    match first {
        Some(s) if s.range[0] > s.range[1] => run.iter().rev().map(|h| h.twin()).collect(),
        _ => run,
    }
}

fn run_origin(drawing: &Drawing<'_>, graph: &Graph, run: &[Half]) -> Origin {
    run.first().map(|h| drawing.origin(&graph.edges[h.edge()])).unwrap_or_default()
}

/// Cuts are told in one note, open boundaries one by one.
fn tell_slits(drawing: &Drawing<'_>, graph: &Graph, slits: &[Vec<Half>], told: &mut Told<'_>) {
    let is_cut = |run: &&Vec<Half>| run.iter().all(|h| graph.edges[h.edge()].role == Role::Cut);
    let cuts: Vec<Origin> = slits.iter().filter(is_cut).map(|run| run_origin(drawing, graph, run)).collect();
    if let Some(first) = cuts.first() {
        let are = if cuts.len() == 1 { "open cut is a slit" } else { "open cuts are slits" };
        let what = format!("{} {are}: {}", cuts.len(), list(&cuts));
        told.push(issue(Severity::Note, what, "").of(first));
    }
    let open = slits.iter().filter(|s| !is_cut(s)).map(|run| {
        let what = "a boundary line that closes no loop is a slit";
        let found = issue(Severity::Warning, what, "close it to make a hole, or draw it as a cut");
        found.of(&run_origin(drawing, graph, run)).at(graph.point(run[0]))
    });
    told.push_all(open.collect());
}

/// Warns of slits that, with the boundary and those before, close a line around a part of the sheet.
fn warn_of_splits(
    drawing: &Drawing<'_>,
    graph: &Graph,
    slits: &[Vec<Half>],
    outline: &[Half],
    holes: &[Vec<Half>],
    told: &mut Told<'_>,
) {
    let mut groups = Groups::new(graph.points.len());
    for l in std::iter::once(outline).chain(holes.iter().map(Vec::as_slice)) {
        l.iter().for_each(|h| {
            groups.unite(graph.node(l[0]), graph.node(*h));
        });
    }
    let mut splits = Vec::new();
    for run in slits {
        let [from, to] = [graph.node(run[0]), graph.node(run[run.len() - 1].twin())];
        if !groups.unite(from, to) {
            let what = "the slit splits the sheet in two";
            let mend =
                "leave a bridge, make each part a sheet of its own, or draw a notch as part of the outline";
            let found = issue(Severity::Warning, what, mend);
            splits.push(found.of(&run_origin(drawing, graph, run)).at(graph.points[from]));
        }
    }
    told.push_all(splits);
}
