//! softfold's own keys, which keep what FOLD's straight edges lose.
//!
//! | key | value |
//! |---|---|
//! | `softfold:curves` | for each curve `{"foldAngle": degrees or null, "segments": […]}`; a segment is a list of 4 numbers (line) or 8 (cubic: start, two control points, end) in the frame's unit |
//! | `softfold:edges_curve` | for each edge `[curve, t0, t1]` or null: the edge stands for the curve from t0 to t1; the whole part of t counts segments, the rest is the segment's parameter |
//! | `softfold:edges_crease` | for each edge the crease's name or null |
//!
//! Other programs may move, split or delete edges and keep the keys. So a curve is used only where its edges, of
//! one assignment, cover it from end to end and still lie on it; else the edges are read, and that is told.

use super::develop::Placed;
use super::frames::Frame;
use super::graph::{Assignment, Graph};
use super::json;
use crate::PatternError;
use serde_json::Value;
use softfold_geometry::{DVec2, Role, Segment};
use std::collections::BTreeMap;

/// Key of the curves.
pub(crate) const CURVES: &str = "softfold:curves";
/// Key of the edges' places on them.
pub(crate) const EDGES_CURVE: &str = "softfold:edges_curve";
/// Key of the edges' crease names.
pub(crate) const EDGES_CREASE: &str = "softfold:edges_crease";
/// Distance between an edge's end and its place on the curve, as a share of the sheet's size, that is rounding:
/// twice what ends are led over when a pattern is read.
const ON_CURVE: f64 = 2e-5;
/// Difference of the parameters of neighbouring edges, and of fold angles in degrees, that is rounding.
const ROUNDING: f64 = 1e-9;

/// A curve of the file that its edges still stand for.
pub(super) struct Curve {
    /// In file units.
    pub(super) segments: Vec<Segment>,
    /// Its edges along the curve.
    pub(super) edges: Vec<usize>,
    pub(super) role: Role,
    pub(super) angle_deg: Option<f64>,
}

/// Where an edge lies on its curve.
struct Span {
    edge: usize,
    from: f64,
    to: f64,
}

/// The fold angle that is written for a crease whose own angle is `angle_deg`: FOLD wants a number for every
/// edge, ±180 where a mountain or valley has none of its own and 0 for all others.
pub(crate) fn written_angle_deg(role: Role, angle_deg: Option<f64>) -> f64 {
    match role {
        Role::Mountain | Role::Valley => angle_deg.unwrap_or(180.0 * role.sign()),
        _ => 0.0,
    }
}

/// The names of the edges' creases.
///
/// # Errors
/// The list has the wrong type or length.
pub(super) fn names<'a>(frame: Frame<'a>, edges: usize) -> Result<Vec<Option<&'a str>>, PatternError> {
    let Some(list) = frame.list(EDGES_CREASE)? else { return Ok(vec![None; edges]) };
    if list.len() != edges {
        return Err(length_fault(frame, EDGES_CREASE, list.len(), edges));
    }
    Ok(list.iter().map(|v| v.as_str().filter(|s| !s.trim().is_empty())).collect())
}

fn length_fault(frame: Frame<'_>, key: &str, entries: usize, edges: usize) -> PatternError {
    json::malformed(&frame.entry(key), format!("it has {entries} entries for {edges} edges"))
}

/// The curves that still hold, and the number and first edge of those that do not.
///
/// # Errors
/// Wrong types, lengths or indices in softfold's keys.
pub(super) fn read(
    frame: Frame<'_>,
    graph: &Graph,
    placed: &[Placed],
) -> Result<(Vec<Curve>, Vec<usize>), PatternError> {
    let (Some(curves), Some(edges)) = (frame.list(CURVES)?, frame.list(EDGES_CURVE)?) else {
        return Ok((Vec::new(), Vec::new()));
    };
    if edges.len() != graph.edges.len() {
        return Err(length_fault(frame, EDGES_CURVE, edges.len(), graph.edges.len()));
    }
    let mut spans: BTreeMap<usize, Vec<Span>> = BTreeMap::new();
    for (edge, value) in edges.iter().enumerate().filter(|(_, v)| !v.is_null()) {
        let (curve, span) = span(frame, edge, value, curves.len())?;
        spans.entry(curve).or_default().push(span);
    }
    let at: BTreeMap<usize, [DVec2; 2]> = placed.iter().map(|p| (p.edge, p.ends)).collect();
    let reach_mm = ON_CURVE * size(placed);
    let (mut kept, mut stale) = (Vec::new(), Vec::new());
    for (curve, spans) in spans {
        let first = spans[0].edge;
        match fit(frame, graph, curve, &curves[curve], spans, &at, reach_mm)? {
            Some(curve) => kept.push(curve),
            None => stale.push(first),
        }
    }
    Ok((kept, stale))
}

fn size(placed: &[Placed]) -> f64 {
    let points: Vec<DVec2> = placed.iter().flat_map(|p| p.ends).collect();
    let (low, high) = softfold_geometry::polygon::bounds(&points);
    (high - low).max_element()
}

fn span(frame: Frame<'_>, edge: usize, value: &Value, curves: usize) -> Result<(usize, Span), PatternError> {
    let entry = || frame.item(EDGES_CURVE, edge);
    let [curve, from, to] = json::list(value, entry)? else {
        return Err(json::malformed(&entry(), "it is not [curve, t0, t1]"));
    };
    let curve = json::index(curve, curves, "curve", entry)?;
    Ok((curve, Span { edge, from: json::number(from, entry)?, to: json::number(to, entry)? }))
}

/// The curve, if its edges stand for all of it.
fn fit(
    frame: Frame<'_>,
    graph: &Graph,
    number: usize,
    value: &Value,
    mut spans: Vec<Span>,
    at: &BTreeMap<usize, [DVec2; 2]>,
    reach: f64,
) -> Result<Option<Curve>, PatternError> {
    let segments = segments(frame, number, value)?;
    spans.sort_by(|a, b| a.from.total_cmp(&b.from));
    let first = graph.edges[spans[0].edge];
    let Assignment::Role(role) = first.assignment else { return Ok(None) };
    let ends = [0.0].into_iter().chain(spans.iter().map(|s| s.to));
    let starts = spans.iter().map(|s| s.from).chain([segments.len() as f64]);
    let covered = ends.zip(starts).all(|(a, b)| (a - b).abs() <= ROUNDING);
    let near = |p: DVec2, t: f64| eval(&segments, t).is_some_and(|q| p.distance(q) <= reach);
    let lies = |s: &Span| {
        let ends = at.get(&s.edge).filter(|_| graph.edges[s.edge].assignment == first.assignment);
        ends.is_some_and(|[a, b]| {
            (near(*a, s.from) && near(*b, s.to)) || (near(*b, s.from) && near(*a, s.to))
        })
    };
    if !covered || !spans.iter().all(lies) {
        return Ok(None);
    }
    let own = value.get("foldAngle").and_then(Value::as_f64).filter(|a| a.abs() <= 180.0);
    let written = written_angle_deg(role, own);
    let kept = |s: &Span| graph.edges[s.edge].angle_deg.is_none_or(|a| (a - written).abs() <= ROUNDING);
    let edges = spans.iter().map(|s| s.edge).collect();
    if spans.iter().all(kept) {
        return Ok(Some(Curve { segments, edges, role, angle_deg: own }));
    }
    let same = spans.iter().all(|s| graph.edges[s.edge].angle_deg == first.angle_deg);
    Ok(same.then_some(Curve { segments, edges, role, angle_deg: first.angle_deg }))
}

fn segments(frame: Frame<'_>, curve: usize, value: &Value) -> Result<Vec<Segment>, PatternError> {
    let entry = || frame.item(CURVES, curve);
    let Some(list) = value.get("segments").and_then(Value::as_array).filter(|l| !l.is_empty()) else {
        return Err(json::malformed(&entry(), "it has no list \"segments\""));
    };
    let segment = |value: &Value| {
        let numbers = json::list(value, entry)?.iter().map(|v| json::number(v, entry));
        match numbers.collect::<Result<Vec<f64>, _>>()?[..] {
            [a, b, c, d] => Ok(Segment::Line { from: DVec2::new(a, b), to: DVec2::new(c, d) }),
            [a, b, c, d, e, f, g, h] => Ok(Segment::Cubic {
                from: DVec2::new(a, b),
                c1: DVec2::new(c, d),
                c2: DVec2::new(e, f),
                to: DVec2::new(g, h),
            }),
            ref other => {
                let what = format!("a segment has {} numbers, not 4 (line) or 8 (cubic)", other.len());
                Err(json::malformed(&entry(), what))
            }
        }
    };
    list.iter().map(segment).collect()
}

/// The point of a chain of segments at a parameter that counts segments.
fn eval(segments: &[Segment], t: f64) -> Option<DVec2> {
    let last = segments.len() - 1;
    let i = (t.floor().max(0.0) as usize).min(last);
    let t = t - i as f64;
    (0.0..=1.0).contains(&t).then(|| match segments[i] {
        Segment::Line { from, to } => from.lerp(to, t),
        Segment::Cubic { from, c1, c2, to } => {
            let s = 1.0 - t;
            s * s * s * from + 3.0 * s * s * t * c1 + 3.0 * s * t * t * c2 + t * t * t * to
        }
    })
}
