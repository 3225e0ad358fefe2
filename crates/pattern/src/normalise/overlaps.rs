//! What is said of lines that lie on each other.

use super::model::{Drawing, Edge, Graph, Source, folds};
use super::segment;
use super::told::Told;
use crate::error::{Origin, Place, issue};
use softfold_geometry::{DVec2, Issue, Role, Severity, Tolerance};
use std::collections::BTreeMap;

/// Lines on one edge that are compared with each other; more on one place are hatching.
const MAX_COMPARED: usize = 4;
/// Share of its length by which a line may be longer than what it shares with its twin, beside the tolerance.
const SAME_LENGTH: f64 = 1e-3;

/// Stretches that two subpaths share.
struct Shared {
    length_mm: f64,
    at: DVec2,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Mountain and valley, or different fold angles.
    Conflict,
    /// Lines of one kind.
    Same,
    /// The first line's role wins.
    First,
    /// The second line's role wins.
    Second,
}

/// Says which lines lie on each other, and what was made of them.
pub(super) fn tell(drawing: &Drawing<'_>, graph: &Graph, tolerance: &Tolerance, told: &mut Told<'_>) {
    let mut shared: BTreeMap<(u32, u32, Kind), Shared> = BTreeMap::new();
    for edge in graph.edges.iter().filter(|e| e.sources.len() > 1) {
        let length_mm = segment::length(&edge.segment);
        for (a, b) in pairs(edge) {
            let kind = kind(drawing, &a, &b);
            let at = segment::at(&edge.segment, 0.5);
            let entry = shared.entry((a.subpath, b.subpath, kind));
            entry.or_insert(Shared { length_mm: 0.0, at, kind }).length_mm += length_mm;
        }
    }
    let (mut conflicts, mut partial, mut whole) = (Vec::new(), Vec::new(), Vec::new());
    for ((a, b, _), s) in &shared {
        let found = describe(drawing, [*a, *b], s, tolerance);
        match (s.kind, found.severity) {
            (Kind::Conflict, _) => conflicts.push(found),
            (_, Severity::Warning) => partial.push(found),
            _ => whole.push(found),
        }
    }
    [conflicts, partial, whole].into_iter().for_each(|issues| told.push_all(issues));
}

/// The stretches of an edge in pairs, in the order of the file.
fn pairs(edge: &Edge) -> Vec<(Source, Source)> {
    let mut sources: Vec<Source> = edge.sources.clone();
    sources.truncate(MAX_COMPARED);
    let each = |i: usize| sources[i + 1..].iter().map(move |b| (i, *b)).collect::<Vec<_>>();
    (0..sources.len()).flat_map(each).map(|(i, b)| (sources[i], b)).collect()
}

fn kind(drawing: &Drawing<'_>, a: &Source, b: &Source) -> Kind {
    let roles = [a, b].map(|s| drawing.stroke(s).role);
    let (role, _, conflict) = drawing.resolve(&[*a, *b]);
    match roles {
        _ if conflict => Kind::Conflict,
        [a, b] if a == b => Kind::Same,
        [a, _] if a == role => Kind::First,
        _ => Kind::Second,
    }
}

fn describe(drawing: &Drawing<'_>, [a, b]: [u32; 2], shared: &Shared, tolerance: &Tolerance) -> Issue {
    let origin = |s: u32| -> &Origin { &drawing.strokes[drawing.subpaths[s as usize].stroke].origin };
    let role = |s: u32| drawing.strokes[drawing.subpaths[s as usize].stroke].role;
    let slack = |length: f64| SAME_LENGTH * length + 4.0 * tolerance.join_mm;
    let whole = [a, b].iter().all(|s| {
        let length = drawing.subpaths[*s as usize].length_mm;
        length - shared.length_mm <= slack(length)
    });
    let [first, length] = [origin(a).to_string(), format!("{:.3} mm", shared.length_mm)];
    let (severity, what, mend) = match shared.kind {
        Kind::Conflict => {
            let what = format!(
                "over {length} it lies on {first}, which says another fold; the crease there is left undecided"
            );
            (Severity::Warning, what, "delete one of them")
        }
        Kind::Same if a == b => (
            Severity::Warning,
            format!("it runs over itself for {length}; that counts once"),
            "draw the line once",
        ),
        Kind::Same if whole => (
            Severity::Note,
            format!("it is drawn twice, first as {first}; they are one"),
            "delete one of them",
        ),
        Kind::Same => {
            let what = format!("over {length} it lies on {first}; they are one there");
            (Severity::Warning, what, "let each line be drawn once")
        }
        Kind::First => {
            let what = format!("over {length} it lies on {first}; {} wins there", name(role(a)));
            (Severity::Note, what, "")
        }
        Kind::Second => {
            let what = format!("over {length} it lies on {first}; as {} it wins there", name(role(b)));
            (Severity::Note, what, "")
        }
    };
    issue(severity, what, mend).of(origin(b)).at(shared.at)
}

fn name(role: Role) -> &'static str {
    match role {
        Role::Boundary => "the boundary",
        Role::Cut => "the cut",
        Role::Flat => "the flat line",
        _ if folds(role) => "the folded crease",
        _ => "the line",
    }
}
