//! The creases: joined where one continues the other, led onto the outline, and checked.

use crate::PatternError;
use crate::chain::{self, Chain, Piece};
use crate::error::{Origin, Place, issue, list};
use crate::outline::Sheet;
use crate::polyline::{CHECK_SLACK, Polyline};
use crate::strokes::Stroke;
use kurbo::{CubicBez, ParamCurve, ParamCurveArclen, PathSeg};
use softfold_geometry::{
    Crease, CreaseId, DVec2, Issue, PlanarCurve, Role, Segment, Severity, Source, polygon,
};
use std::collections::BTreeSet;

/// Two creases of one kind that meet alone, with less than this corner, are one crease, rad (45°): curves
/// are often drawn as rows of short lines.
const SAME_CREASE_RAD: f64 = 0.785;
/// An end is led onto the boundary along its own direction if that takes no more than so many times
/// the shortest way.
const DETOUR: f64 = 4.0;
/// Accuracy of arc lengths where a crease is cut, mm.
const CUT_ACCURACY_MM: f64 = 1e-9;

/// A crease on its way into the pattern.
struct Candidate {
    role: Role,
    fold_angle_rad: Option<f64>,
    origin: Origin,
    curve: PlanarCurve,
}

/// All creases, in the order of the file.
///
/// # Errors
/// A crease that leaves the sheet or is no curve; two that meet.
pub(crate) fn find(
    strokes: &[Stroke],
    sheet: &Sheet,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Crease>, PatternError> {
    let mut candidates = Vec::new();
    for candidate in joined(strokes, sheet, issues)? {
        candidates.extend(fit(candidate, sheet, issues)?);
    }
    let kept = without_duplicates(candidates, sheet, issues);
    refuse_junctions(&kept, sheet)?;
    Ok(named(kept))
}

fn is_crease(role: Role) -> bool {
    !matches!(role, Role::Boundary | Role::Cut)
}

/// The creases with pieces that continue each other joined.
fn joined(
    strokes: &[Stroke],
    sheet: &Sheet,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Candidate>, PatternError> {
    let creases: Vec<&Stroke> = strokes.iter().filter(|s| is_crease(s.role)).collect();
    let (mut pieces, mut owners) = (Vec::new(), Vec::new());
    for stroke in &creases {
        for segments in &stroke.pieces {
            pieces.push(Piece { segments: segments.clone(), origin: stroke.origin.clone() });
            owners.push(*stroke);
        }
    }
    let join_mm = sheet.tolerance.join_mm;
    let mates = continuations(&pieces, &owners, join_mm);
    let chains = chain::run(&pieces, &mates, join_mm, "crease", issues);
    let mut candidates: Vec<(usize, Candidate)> = Vec::new();
    for chain in chains {
        let order = pieces.iter().position(|p| p.origin == chain.origins[0]).unwrap_or_default();
        candidates.push((order, candidate(chain, owners[order], issues)?));
    }
    candidates.sort_by_key(|c| c.0);
    Ok(candidates.into_iter().map(|c| c.1).collect())
}

fn candidate(chain: Chain, owner: &Stroke, issues: &mut Vec<Issue>) -> Result<Candidate, PatternError> {
    let named = chain.origins.iter().find(|o| o.id.is_some());
    let origin = named.unwrap_or(&chain.origins[0]).clone();
    let others: Vec<Origin> = chain.origins.iter().filter(|o| **o != origin).cloned().collect();
    if !others.is_empty() {
        let message = format!("joined with what continues it: {}", list(&others));
        issues.push(issue(Severity::Note, message, "").of(&origin));
    }
    let curve = PlanarCurve::new(chain.segments).map_err(|e| {
        let mend = "redraw the element";
        PatternError::Crease(issue(Severity::Error, e.to_string(), mend).of(&origin))
    })?;
    Ok(Candidate { role: owner.role, fold_angle_rad: owner.fold_angle_rad, origin, curve })
}

/// Mates of the ends where exactly two creases of one kind meet without a sharp corner, or where a
/// crease closes.
fn continuations(pieces: &[Piece], owners: &[&Stroke], join_mm: f64) -> Vec<Option<usize>> {
    let ends: Vec<DVec2> = pieces.iter().flat_map(|p| [p.end(0), p.end(1)]).collect();
    let folds = |e: usize| owners[e / 2].role != Role::Flat;
    let near = |e: usize| -> Vec<usize> {
        (0..ends.len()).filter(|&o| o != e && folds(o) && ends[o].distance(ends[e]) <= join_mm).collect()
    };
    let mut mates = vec![None; ends.len()];
    for e in (0..ends.len()).filter(|&e| folds(e)) {
        let [other] = near(e)[..] else { continue };
        let same = |s: &Stroke, o: &Stroke| s.role == o.role && s.fold_angle_rad == o.fold_angle_rad;
        let smooth = outward(&pieces[e / 2], e % 2).angle_to(-outward(&pieces[other / 2], other % 2)).abs()
            < SAME_CREASE_RAD;
        if e / 2 == other / 2 || (same(owners[e / 2], owners[other / 2]) && smooth) {
            mates[e] = Some(other);
        }
    }
    // A mate must be mutual; ends near each other may see different thirds.
    (0..mates.len()).map(|e| mates[e].filter(|&m| mates[m] == Some(e))).collect()
}

/// Direction in which a piece leaves at one of its ends.
fn outward(piece: &Piece, side: usize) -> DVec2 {
    let mut controls: Vec<DVec2> = piece.segments.iter().flat_map(Segment::control_points).collect();
    if side == 1 {
        controls.reverse();
    }
    let end = controls[0];
    controls
        .iter()
        .map(|&c| end - c)
        .find(|d| d.length_squared() > 0.0)
        .unwrap_or_default()
        .normalize_or_zero()
}

/// Leads the ends onto the boundary and checks that the rest is on the sheet; none if all of it is
/// outside, or a part of a flat line, which folds nothing.
fn fit(
    mut candidate: Candidate,
    sheet: &Sheet,
    issues: &mut Vec<Issue>,
) -> Result<Option<Candidate>, PatternError> {
    if !candidate.curve.is_closed() {
        for _ in 0..2 {
            candidate.curve = lead_start(&candidate, sheet, issues)?.reversed();
        }
    }
    if let Some(off) = off_sheet(&candidate.curve, sheet) {
        if off.whole || candidate.role == Role::Flat {
            let part = if off.whole { "lies outside" } else { "leaves" };
            let what = format!("the crease {part} the sheet; it is ignored");
            let found = issue(Severity::Warning, what, "delete it, or draw it on the sheet");
            issues.push(found.of(&candidate.origin).at(off.leaves_at));
            return Ok(None);
        }
        let what = format!("the crease leaves the sheet by {:.3} mm", off.distance_mm);
        let mend = "end the crease on the outline, or enlarge the outline";
        let found = issue(Severity::Error, what, mend).of(&candidate.origin).at(off.leaves_at);
        return Err(PatternError::Crease(found));
    }
    warn_of_free_ends(&candidate, sheet, issues);
    Ok(Some(candidate))
}

/// The nearest point of the boundary, and its distance.
fn nearest_boundary(sheet: &Sheet, p: DVec2) -> (DVec2, f64) {
    sheet.loops().fold((p, f64::INFINITY), |best, l| {
        let (s, d) = l.nearest(p);
        if d < best.1 { (l.point(s), d) } else { best }
    })
}

/// The curve with its start on the boundary, if that is near.
fn lead_start(c: &Candidate, sheet: &Sheet, issues: &mut Vec<Issue>) -> Result<PlanarCurve, PatternError> {
    let (start, tolerance) = (c.curve.point(0.0), &sheet.tolerance);
    let (foot, d) = nearest_boundary(sheet, start);
    let mut segments = c.curve.segments().to_vec();
    if d > tolerance.refuse_mm {
        return Ok(c.curve.clone());
    }
    if d <= tolerance.join_mm {
        segments[0] = chain::with_start(segments[0], foot);
    } else if sheet.contains(start) {
        let hit = ray_hit(sheet, start, -c.curve.tangent(0.0), DETOUR * d).unwrap_or(foot);
        segments.insert(0, Segment::Line { from: hit, to: start });
        told(c, start, format!("the crease ended {d:.3} mm before the boundary; it was extended"), issues);
    } else {
        let mut foot = foot;
        if let Some(s) = first_crossing(&c.curve, sheet, DETOUR * d) {
            segments = cut_before(&c.curve, s);
            foot = nearest_boundary(sheet, segments[0].from()).0;
        }
        segments[0] = chain::with_start(segments[0], foot);
        told(c, start, format!("the crease ran {d:.3} mm past the boundary; it was trimmed"), issues);
    }
    PlanarCurve::new(segments).map_err(|e| {
        let mend = "draw the crease longer than the gap to the outline";
        PatternError::Crease(issue(Severity::Error, e.to_string(), mend).of(&c.origin).at(start))
    })
}

fn told(c: &Candidate, at: DVec2, message: String, issues: &mut Vec<Issue>) {
    issues.push(issue(Severity::Warning, message, "end the crease on the outline").of(&c.origin).at(at));
}

/// Where a ray first meets the boundary, exactly on it.
fn ray_hit(sheet: &Sheet, from: DVec2, direction: DVec2, reach_mm: f64) -> Option<DVec2> {
    let to = from + direction * reach_mm;
    let sides = sheet.polylines.iter().flat_map(|l| l.points.windows(2));
    let t = sides
        .filter_map(|w| polygon::segment_crossing(from, to, w[0], w[1]))
        .map(|(t, _)| t)
        .fold(f64::INFINITY, f64::min);
    (t <= 1.0).then(|| nearest_boundary(sheet, from.lerp(to, t)).0)
}

/// Arc length at which the crease first crosses the boundary, if within `reach_mm` of its start.
fn first_crossing(curve: &PlanarCurve, sheet: &Sheet, reach_mm: f64) -> Option<f64> {
    let polyline = Polyline::new(curve, sheet.tolerance.join_mm);
    let first = |l: &Polyline| polyline.crossings(l).first().copied();
    let crossing = sheet.polylines.iter().filter_map(first).min_by(|a, b| a.along.total_cmp(&b.along))?;
    let s = curve.nearest(crossing.at).0;
    (s <= reach_mm).then_some(s)
}

/// The curve from arc length `s_mm` on.
fn cut_before(curve: &PlanarCurve, s_mm: f64) -> Vec<Segment> {
    let joints = curve.joints_mm();
    let i = joints.partition_point(|&l| l <= s_mm).clamp(1, curve.segments().len()) - 1;
    let mut rest = curve.segments()[i..].to_vec();
    rest[0] = cut_segment(rest[0], s_mm - joints[i]);
    rest
}

fn cut_segment(segment: Segment, s_mm: f64) -> Segment {
    let point = |p: DVec2| kurbo::Point::new(p.x, p.y);
    let vector = |p: kurbo::Point| DVec2::new(p.x, p.y);
    match segment {
        Segment::Line { from, to } => {
            Segment::Line { from: from + (to - from).normalize_or_zero() * s_mm, to }
        }
        Segment::Cubic { from, c1, c2, to } => {
            let whole = PathSeg::Cubic(CubicBez::new(point(from), point(c1), point(c2), point(to)));
            let t = whole.inv_arclen(s_mm, CUT_ACCURACY_MM);
            let PathSeg::Cubic(c) = whole.subsegment(t..1.0) else { return segment };
            Segment::Cubic { from: vector(c.p0), c1: vector(c.p1), c2: vector(c.p2), to }
        }
    }
}

/// A part of a crease outside the sheet.
struct OffSheet {
    /// Where it leaves.
    leaves_at: DVec2,
    /// How far it goes.
    distance_mm: f64,
    /// Nothing of the crease is on the sheet.
    whole: bool,
}

/// The first part of a crease that is farther outside than the tolerance.
fn off_sheet(curve: &PlanarCurve, sheet: &Sheet) -> Option<OffSheet> {
    let polyline = Polyline::new(curve, sheet.tolerance.join_mm);
    let last = (polyline.points.len() - 1) as f64;
    let mut cuts: Vec<f64> =
        sheet.polylines.iter().flat_map(|l| polyline.crossings(l)).map(|c| c.along).collect();
    cuts.extend([0.0, last]);
    cuts.sort_by(f64::total_cmp);
    let parts = cuts.windows(2).filter(|w| w[0] < w[1]);
    let mut outside = parts
        .filter_map(|w| Some((w, overhang(&polyline, [w[0], w[1]], sheet)?)))
        .collect::<Vec<_>>()
        .into_iter();
    let (part, distance_mm) = outside.next()?;
    let whole = part[0] == 0.0 && part[1] == last;
    // A part that begins the crease leaves at its far end, seen from the sheet.
    let leaves_at = polyline.point(if part[0] > 0.0 { part[0] } else { part[1] });
    Some(OffSheet { leaves_at, distance_mm, whole })
}

/// How far a part between two crossings goes off the sheet; none within the tolerance.
fn overhang(polyline: &Polyline, [from, to]: [f64; 2], sheet: &Sheet) -> Option<f64> {
    let middle = polyline.point(0.5 * (from + to));
    if sheet.contains(middle) {
        return None;
    }
    let inner = (from.ceil() as usize..=to.floor() as usize).map(|i| polyline.points[i]);
    let far = inner.chain([middle]).map(|p| sheet.boundary_distance(p)).fold(0.0, f64::max);
    (far > CHECK_SLACK * sheet.tolerance.join_mm).then_some(far)
}

fn warn_of_free_ends(c: &Candidate, sheet: &Sheet, issues: &mut Vec<Issue>) {
    if c.curve.is_closed() || c.role == Role::Flat {
        return;
    }
    for p in [c.curve.point(0.0), c.curve.point(c.curve.length_mm())] {
        if nearest_boundary(sheet, p).1 > sheet.tolerance.join_mm {
            let what = "the crease ends inside the sheet";
            let mend = "lead it to the outline unless this is meant";
            issues.push(issue(Severity::Warning, what, mend).of(&c.origin).at(p));
        }
    }
}

/// Drops creases that are drawn twice.
fn without_duplicates(
    candidates: Vec<Candidate>,
    sheet: &Sheet,
    issues: &mut Vec<Issue>,
) -> Vec<(Candidate, Polyline)> {
    let mut kept: Vec<(Candidate, Polyline)> = Vec::new();
    for c in candidates {
        let polyline = Polyline::new(&c.curve, sheet.tolerance.join_mm);
        let twin = kept.iter().find(|(k, p)| is_twin((&c, &polyline), (k, p), sheet));
        if let Some((twin, _)) = twin {
            let what = format!("the crease is drawn twice, first as {}; it is ignored", twin.origin);
            issues.push(issue(Severity::Warning, what, "delete one of them").of(&c.origin));
            continue;
        }
        kept.push((c, polyline));
    }
    kept
}

fn is_twin((a, pa): (&Candidate, &Polyline), (b, pb): (&Candidate, &Polyline), sheet: &Sheet) -> bool {
    let slack = CHECK_SLACK * sheet.tolerance.join_mm;
    a.role == b.role
        && (a.curve.length_mm() - b.curve.length_mm()).abs() <= 2.0 * slack
        && pa.near(pb, slack)
        && pa.points.iter().all(|&p| pb.distance(p) <= slack)
}

/// Refuses creases that cross or touch inside the sheet. Flat ones fold nothing and may.
fn refuse_junctions(creases: &[(Candidate, Polyline)], sheet: &Sheet) -> Result<(), PatternError> {
    let folding: Vec<_> = creases.iter().filter(|(c, _)| c.role != Role::Flat).collect();
    for (i, (a, pa)) in folding.iter().enumerate() {
        for (b, pb) in &folding[i + 1..] {
            if let Some(at) = meeting(pa, pb, sheet) {
                let what = format!("the crease meets {}", b.origin);
                let mend = "junctions cannot be folded yet: keep the creases apart";
                let found = issue(Severity::Error, what, mend).of(&a.origin).at(at);
                return Err(PatternError::Junction(found));
            }
        }
    }
    Ok(())
}

/// Where two creases meet, other than with their ends on the boundary.
fn meeting(a: &Polyline, b: &Polyline, sheet: &Sheet) -> Option<DVec2> {
    let slack = CHECK_SLACK * sheet.tolerance.join_mm;
    if !a.near(b, slack) {
        return None;
    }
    let is_end = |l: &Polyline, p: DVec2| l.ends().iter().any(|e| e.distance(p) <= 2.0 * slack);
    let on_boundary = |p: DVec2| is_end(a, p) && is_end(b, p) && sheet.boundary_distance(p) <= slack;
    let touches = |l: &Polyline, o: &Polyline| {
        l.ends().into_iter().find(|&p| o.distance(p) <= slack && !on_boundary(p))
    };
    let crossing = a.crossings(b).into_iter().map(|c| c.at).find(|&p| !on_boundary(p));
    // Creases on top of each other cross nowhere and end together, but share their middles.
    let middle = Some(a.point(0.5 * (a.points.len() - 1) as f64)).filter(|&p| b.distance(p) <= slack);
    crossing.or_else(|| touches(a, b)).or_else(|| touches(b, a)).or(middle)
}

/// Numbers the creases; each has a name of its own.
fn named(creases: Vec<(Candidate, Polyline)>) -> Vec<Crease> {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut crease = |(i, (c, _)): (usize, (Candidate, Polyline))| {
        let wanted = c.origin.id.clone().unwrap_or_else(|| format!("crease-{}", i + 1));
        let variants = std::iter::once(wanted.clone()).chain((2..).map(|k| format!("{wanted}-{k}")));
        let name = variants.into_iter().find(|n| !taken.contains(n)).unwrap_or(wanted);
        taken.insert(name.clone());
        Crease {
            id: CreaseId::new(i),
            name,
            role: c.role,
            curve: c.curve,
            fold_angle_rad: c.fold_angle_rad,
            source: Source { element: c.origin.label, line: Some(c.origin.line) },
        }
    };
    creases.into_iter().enumerate().map(&mut crease).collect()
}
