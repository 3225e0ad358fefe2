//! Where the sheet is not smooth: the sharp stretches of its creases, and its slits.

use softfold_geometry::{CreaseId, CreasePattern, CurveError, FoldLine, LineEnd, PlanarCurve, SoftPattern};
use softfold_surface::{Cut, CutKind};

/// A crease turns a corner where its direction jumps by more than this, rad: drawings have no less on purpose.
const CORNER_RAD: f64 = 5e-3;
/// Change of curvature at a joint, times the length of a piece of the spline that would take its place, above which the
/// faces could not meet to 1e-6 mm: a spline surface has continuous curvature on both sides of its crease.
const JUMP: f64 = 1e-6;
/// The longest pieces of a spline that are tried, in steps of the mesh: the longer, the more softly its curvature changes.
const LONGEST: f64 = 4.0;
/// Pieces of a spline are halved as often as this until it is near enough.
const MOST_HALVINGS: u32 = 5;
/// Places per piece at which the distance is looked at.
const PLACES: u32 = 4;

/// The curves along which a surface needs several faces: parts of the creases where their bands are sharp lines, then
/// slits.
///
/// Creases that turn corners are cut there. One whose curvature jumps, as where a line goes over into an arc, is replaced by the
/// spline through its points every four `step_mm`, or less, that stays within `off_mm` of it.
///
/// # Errors
/// A sharp stretch of no length: against the contract of the bands.
pub(crate) fn cuts(
    pattern: &CreasePattern,
    soft: &SoftPattern,
    step_mm: f64,
    off_mm: f64,
) -> Result<Vec<Cut>, CurveError> {
    let mut cuts = Vec::new();
    for band in &soft.bands {
        for (number, line) in band.fold_lines.iter().enumerate().filter(|(_, l)| l.rank.is_none()) {
            let kind = CutKind::Crease { crease: band.crease, line: number as u32 };
            for part in between_corners(&sharp_part(pattern, band.crease, line)?)? {
                cuts.push(Cut { curve: smoothed(part, step_mm, off_mm)?, kind });
            }
        }
    }
    cuts.extend(soft.slits.iter().map(|curve| Cut { curve: curve.clone(), kind: CutKind::Slit }));
    Ok(cuts)
}

fn sharp_part(pattern: &CreasePattern, crease: CreaseId, line: &FoldLine) -> Result<PlanarCurve, CurveError> {
    let curve = &pattern.creases[crease.index()].curve;
    let ends = [line.s_mm.first(), line.s_mm.last()].map(|s| s.copied().unwrap_or_default());
    let whole = line.ends[0] == LineEnd::Closed || (ends[0] <= 0.0 && ends[1] >= curve.length_mm());
    if whole { Ok(curve.clone()) } else { curve.part(ends[0], ends[1]) }
}

/// The smooth parts of a curve.
fn between_corners(curve: &PlanarCurve) -> Result<Vec<PlanarCurve>, CurveError> {
    let segments = curve.segments();
    let mut parts = vec![Vec::new()];
    for (k, segment) in segments.iter().enumerate() {
        let corner = k > 0 && directions_at(curve, k).is_some_and(|[a, b]| a.angle_to(b).abs() > CORNER_RAD);
        if corner {
            parts.push(Vec::new());
        }
        if let Some(part) = parts.last_mut() {
            part.push(*segment);
        }
    }
    parts.into_iter().map(PlanarCurve::new).collect()
}

/// Directions before and after the start of a segment.
fn directions_at(curve: &PlanarCurve, segment: usize) -> Option<[softfold_geometry::DVec2; 2]> {
    let alone = |k: usize| PlanarCurve::new(vec![curve.segments()[k]]).ok();
    Some([-alone(segment - 1)?.leaving(1), alone(segment)?.leaving(0)])
}

fn smoothed(curve: PlanarCurve, step_mm: f64, off_mm: f64) -> Result<PlanarCurve, CurveError> {
    if curve.segments().len() < 2 || largest_jump(&curve) * step_mm < JUMP {
        return Ok(curve);
    }
    let total = curve.length_mm();
    let mut pieces = (total / (LONGEST * step_mm)).ceil().max(4.0);
    for _ in 0..=MOST_HALVINGS {
        let points: Vec<_> = (0..=pieces as u32).map(|k| place(&curve, f64::from(k) / pieces)).collect();
        let spline = PlanarCurve::spline(&points, [curve.leaving(0), -curve.leaving(1)])?;
        if farthest_mm(&spline, &curve, pieces as u32 * PLACES) <= off_mm {
            return Ok(spline);
        }
        pieces *= 2.0;
    }
    Ok(curve)
}

/// The point at a share of a curve's length; the ends exactly.
fn place(curve: &PlanarCurve, share: f64) -> softfold_geometry::DVec2 {
    match share {
        0.0 => curve.end(0),
        1.0 => curve.end(1),
        _ => curve.point(share * curve.length_mm()),
    }
}

/// Largest change of curvature at a joint, 1/mm.
fn largest_jump(curve: &PlanarCurve) -> f64 {
    let joints = curve.joints_mm();
    let near = 1e-6 * curve.length_mm();
    let jump = |s: &f64| (curve.curvature(s + near) - curve.curvature(s - near)).abs();
    joints[1..joints.len() - 1].iter().map(jump).fold(0.0, f64::max)
}

fn farthest_mm(curve: &PlanarCurve, from: &PlanarCurve, places: u32) -> f64 {
    let off = |k: u32| from.nearest(curve.point(curve.length_mm() * f64::from(k) / f64::from(places))).1;
    (0..=places).map(off).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use softfold_geometry::{DVec2, Segment};

    #[test]
    fn a_line_that_goes_over_into_an_arc_becomes_a_spline_near_by() {
        let k = 0.5522847498 * 100.0;
        let line = Segment::Line { from: DVec2::new(100.0, -150.0), to: DVec2::new(100.0, 0.0) };
        let arc = Segment::Cubic {
            from: DVec2::new(100.0, 0.0),
            c1: DVec2::new(100.0, k),
            c2: DVec2::new(k, 100.0),
            to: DVec2::new(0.0, 100.0),
        };
        let curve = PlanarCurve::new(vec![line, arc]).unwrap();
        let smooth = smoothed(curve.clone(), 10.0, 0.02).unwrap();
        assert!(farthest_mm(&smooth, &curve, 500) <= 0.02 && largest_jump(&smooth) < 1e-6);
        assert_eq!([smooth.end(0), smooth.end(1)], [curve.end(0), curve.end(1)]);
        let straight = PlanarCurve::polyline(&[DVec2::ZERO, DVec2::X, 2.0 * DVec2::X]).unwrap();
        assert_eq!(smoothed(straight.clone(), 10.0, 0.02).unwrap(), straight, "nothing jumps");
    }

    #[test]
    fn a_crease_is_cut_at_its_corners() {
        let bent = PlanarCurve::polyline(&[DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::new(1.0, 3.0)]).unwrap();
        let parts = between_corners(&bent).unwrap();
        assert_eq!(parts.iter().map(PlanarCurve::length_mm).collect::<Vec<_>>(), [1.0, 3.0]);
    }
}
