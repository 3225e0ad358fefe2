//! What is not on the sheet: elements beyond it, and lines that leave it.

use super::model::{Drawing, Edge, Graph, Source, folds};
use super::segment;
use super::sheet::{Sheet, Where};
use super::told::Told;
use crate::PatternError;
use crate::drawing::Stroke;
use crate::error::{Origin, Place, issue, list};
use softfold_geometry::{DVec2, Issue, Role, Severity, Tolerance};
use std::collections::{BTreeMap, BTreeSet};

/// A stretch of a line beyond the sheet.
struct Run {
    edges: Vec<usize>,
    /// Where it leaves the sheet.
    at: DVec2,
}

/// What is looked at.
struct Look<'a> {
    graph: &'a Graph,
    sheet: &'a Sheet,
    tolerance: &'a Tolerance,
}

/// Tells what lies beyond the sheet or in a hole, and refuses creases that leave it too far.
pub(super) fn tell(
    drawing: &Drawing<'_>,
    graph: &Graph,
    sheet: &Sheet,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) {
    let look = Look { graph, sheet, tolerance };
    let (mut beyond, mut in_holes) = (BTreeSet::new(), BTreeSet::new());
    let mut trimmed = Vec::new();
    for (subpath, edges) in subpaths(graph) {
        let stroke = drawing.subpaths[subpath as usize].stroke;
        let any = |places: &[Where]| edges.iter().any(|e| places.contains(&sheet.places[*e]));
        if any(&[Where::Inside, Where::Rim, Where::Gone]) {
            for run in runs(graph, sheet, &edges) {
                leaves(&look, &drawing.strokes[stroke], &run, told, &mut trimmed);
            }
        } else if any(&[Where::Hole]) {
            in_holes.insert(stroke);
        } else if !any(&[Where::Elsewhere]) {
            beyond.insert(stroke);
        }
    }
    told.push_all(trimmed);
    let mend = "delete it, or draw it on the sheet";
    ignored(drawing, &beyond, "outside the sheet", mend, told);
    let creased = |(e, place): (&Edge, &Where)| *place == Where::Inside && folds(e.role);
    let frame = !graph.edges.iter().zip(&sheet.places).any(creased);
    let mend = if frame { "if the outermost contour is a frame around the sheet, delete it" } else { mend };
    ignored(drawing, &in_holes, "inside a hole", mend, told);
}

/// The edges of each subpath, in their order along it.
fn subpaths(graph: &Graph) -> BTreeMap<u32, Vec<usize>> {
    let mut sources: Vec<(Source, usize)> = Vec::new();
    for (i, e) in graph.edges.iter().enumerate() {
        sources.extend(e.sources.iter().map(|s| (*s, i)));
    }
    sources.sort_by(|a, b| a.0.order(&b.0).then(a.1.cmp(&b.1)));
    let mut subpaths: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (s, edge) in sources {
        subpaths.entry(s.subpath).or_default().push(edge);
    }
    subpaths
}

fn ignored(drawing: &Drawing<'_>, strokes: &BTreeSet<usize>, place: &str, mend: &str, told: &mut Told<'_>) {
    let origins: Vec<Origin> = strokes.iter().map(|s| drawing.strokes[*s].origin.clone()).collect();
    if let Some(first) = origins.first() {
        let what = format!("what lies {place} is ignored: {}", list(&origins));
        told.push(issue(Severity::Warning, what, mend).of(first));
    }
}

fn is_off(place: Where) -> bool {
    matches!(place, Where::Outside | Where::Hole | Where::Elsewhere)
}

/// The stretches of a subpath off the sheet.
fn runs(graph: &Graph, sheet: &Sheet, edges: &[usize]) -> Vec<Run> {
    let off = |e: usize| is_off(sheet.places[e]);
    let mut runs = Vec::new();
    for run in edges.chunk_by(|a, b| off(*a) == off(*b)).filter(|r| off(r[0])) {
        let inner: BTreeSet<u32> =
            edges.iter().filter(|e| !off(**e)).flat_map(|e| graph.edges[*e].nodes).collect();
        let nodes = run.iter().flat_map(|e| graph.edges[*e].nodes);
        let left = nodes.clone().find(|n| inner.contains(n)).or(nodes.clone().next());
        let at = left.map(|n| graph.points[n as usize]).unwrap_or_default();
        runs.push(Run { edges: run.to_vec(), at });
    }
    runs
}

/// Says that a line leaves the sheet; refuses it if it is a crease that goes farther than a drawing error.
fn leaves(look: &Look<'_>, stroke: &Stroke, run: &Run, told: &mut Told<'_>, trimmed: &mut Vec<Issue>) {
    let (sheet, tolerance) = (look.sheet, look.tolerance);
    let far = run.edges.iter().map(|e| overhang(&look.graph.edges[*e], sheet, tolerance)).fold(0.0, f64::max);
    // The boundary has been told of where the sheets and holes were found.
    if far <= tolerance.join_mm || matches!(stroke.role, Role::Boundary | Role::Cut) {
        return;
    }
    let (what, folds) = if folds(stroke.role) { ("crease", true) } else { ("flat line", false) };
    if run.edges.iter().any(|e| sheet.places[*e] == Where::Hole) {
        let what = format!("the {what} runs across a hole; what lies in the hole is left out");
        let found = issue(Severity::Warning, what, "end it on the hole");
        trimmed.push(found.of(&stroke.origin).at(run.at));
    } else if folds && far > tolerance.refuse_mm {
        let what = format!("the crease leaves the sheet by {far:.3} mm");
        let mend = "end the crease on the outline, or enlarge the outline";
        let found = issue(Severity::Error, what, mend).of(&stroke.origin).at(run.at);
        told.refuse(PatternError::Crease(found));
    } else {
        let what = format!("the {what} leaves the sheet by {far:.3} mm; it was trimmed");
        let found = issue(Severity::Warning, what, "end it on the outline");
        trimmed.push(found.of(&stroke.origin).at(run.at));
    }
}

/// How far an edge goes off the sheet.
fn overhang(edge: &Edge, sheet: &Sheet, tolerance: &Tolerance) -> f64 {
    let chords = segment::chords(&edge.segment, tolerance.join_mm);
    let middle = |c: &segment::Chord| segment::at(&edge.segment, 0.5 * (c.range[0] + c.range[1]));
    chords
        .flat_map(|c| [c.ends[0], middle(&c), c.ends[1]])
        .map(|p| sheet.region.distance(p))
        .fold(0.0, f64::max)
}
