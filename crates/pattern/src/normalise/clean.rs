//! Strokes to edges: what has no length is dropped, tiny segments are bridged, looping cubics cut.

use super::model::{Drawing, Edge, Source, Subpath};
use super::segment;
use super::told::Told;
use crate::PatternError;
use crate::drawing::Stroke;
use crate::error::{Place, issue, list};
use softfold_geometry::{DVec2, Segment, Severity, Tolerance, polygon};

/// Most segments of a file: the densest patterns of the field have some ten thousand.
const MAX_SEGMENTS: usize = 200_000;
/// Coordinates beyond are no sheet (1000 km), and rounding would eat the tolerances.
const MAX_COORDINATE_MM: f64 = 1e9;

/// The strokes of a file as subpaths; those without length are told.
///
/// # Errors
/// Coordinates that are not finite or beyond all measure, too many segments.
pub(super) fn drawing<'a>(
    strokes: &'a [Stroke],
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Drawing<'a>, PatternError> {
    let mut subpaths = Vec::new();
    let mut empty = Vec::new();
    for (stroke, s) in strokes.iter().enumerate() {
        let before = subpaths.len();
        let drawn = s.pieces.iter().map(|p| cleaned(p, tolerance));
        subpaths.extend(drawn.filter(|segments| !segments.is_empty()).map(|segments| {
            let length_mm = segments.iter().map(segment::length).sum();
            let gap = segments[0].from().distance(segments[segments.len() - 1].to());
            Subpath { stroke, length_mm, closed: gap <= tolerance.join_mm, segments }
        }));
        if subpaths.len() - before < s.pieces.len() {
            empty.push(s.origin.clone());
        }
    }
    if !empty.is_empty() {
        let what = format!("lines without length are left out: {}", list(&empty));
        told.push(issue(Severity::Note, what, "").of(&empty[0]));
    }
    Ok(Drawing { strokes, subpaths })
}

/// Refuses what cannot be computed with.
///
/// # Errors
/// Coordinates that are not finite or beyond all measure, too many segments.
pub(super) fn refuse(strokes: &[Stroke]) -> Result<(), PatternError> {
    let count: usize = strokes.iter().flat_map(|s| &s.pieces).map(Vec::len).sum();
    if count > MAX_SEGMENTS {
        let what = format!("the drawing has {count} segments, more than {MAX_SEGMENTS}");
        let mend = "simplify its curves, or leave out what is no crease";
        return Err(PatternError::TooMuch(issue(Severity::Error, what, mend)));
    }
    let far = |p: &DVec2| !p.is_finite() || p.abs().max_element() > MAX_COORDINATE_MM;
    let faulty = |s: &&Stroke| s.pieces.iter().flatten().flat_map(Segment::control_points).any(|p| far(&p));
    match strokes.iter().find(faulty) {
        None => Ok(()),
        Some(s) => {
            let what = format!("a coordinate is no number up to {MAX_COORDINATE_MM:e} mm");
            let found = issue(Severity::Error, what, "check the element's coordinates and the unit");
            Err(PatternError::Number(found.of(&s.origin)))
        }
    }
}

/// A subpath whose segments are all longer than the join tolerance: shorter ones are bridged by their neighbours.
fn cleaned(segments: &[Segment], tolerance: &Tolerance) -> Vec<Segment> {
    let mut kept: Vec<Segment> = Vec::new();
    let Some(mut at) = segments.first().map(Segment::from) else { return kept };
    for s in segments {
        let s = segment::with_ends(*s, [at, s.to()]);
        if segment::reach(&s) <= tolerance.join_mm {
            continue;
        }
        at = s.to();
        match segment::self_crossing_cut(&s) {
            None => kept.push(segment::straightened(s, tolerance.point_mm)),
            Some(t) => kept.extend([[0.0, t], [t, 1.0]].map(|range| segment::part(&s, range))),
        }
    }
    if let (Some(last), Some(end)) = (kept.last_mut(), segments.last()) {
        *last = segment::with_ends(*last, [last.from(), end.to()]);
    }
    kept
}

/// One edge for each segment, sorted by geometry: what is made of them does not depend on the order of the file.
pub(super) fn edges(drawing: &Drawing<'_>) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (i, subpath) in drawing.subpaths.iter().enumerate() {
        for (k, s) in subpath.segments.iter().enumerate() {
            let sources = vec![Source { subpath: i as u32, range: [k as f64, (k + 1) as f64] }];
            let (role, fold_angle_rad, _) = drawing.resolve(&sources);
            let segment = segment::with_ends(*s, [s.from() + DVec2::ZERO, s.to() + DVec2::ZERO]);
            edges.push(Edge { segment, nodes: [0; 2], role, fold_angle_rad, sources, rim: false });
        }
    }
    edges.sort_by_cached_key(|e| Key(e.segment.control_points()));
    edges
}

/// Control points in a total order.
#[derive(PartialEq)]
struct Key(Vec<DVec2>);

impl Eq for Key {}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let each = self.0.iter().zip(&other.0).map(|(a, b)| order(*a, *b));
        each.fold(self.0.len().cmp(&other.0.len()), std::cmp::Ordering::then)
    }
}

/// Points by u, then v.
pub(super) fn order(a: DVec2, b: DVec2) -> std::cmp::Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
}

/// The larger side of the box around the strokes that make the sheet: boundaries, else cuts, else all.
pub(super) fn size_mm(strokes: &[Stroke]) -> f64 {
    use softfold_geometry::Role::{Boundary, Cut};
    for role in [Some(Boundary), Some(Cut), None] {
        let of_role = strokes.iter().filter(|s| role.is_none_or(|r| s.role == r));
        let points: Vec<DVec2> =
            of_role.flat_map(|s| s.pieces.iter().flatten()).flat_map(Segment::control_points).collect();
        let (low, high) = polygon::bounds(&points);
        let size = (high - low).max_element();
        if size > 0.0 {
            return size;
        }
    }
    0.0
}
