//! What runs a crease on past its end, so that the parallels of its band reach the boundary.

use softfold_geometry::{DVec2, PlanarCurve, Segment};

/// A crease is run on with its curvature only if its band keeps this far from the centre of curvature: half
/// width by radius. The ends of drawn curves can have any curvature.
const TIGHTEST: f64 = 0.5;
/// Most by which the arc that runs a crease on turns, rad.
const WIDEST_RAD: f64 = 1.0;
/// Longest cubic of such an arc, rad: radial error below 1e-9 of the radius.
const ARC_PIECE_RAD: f64 = 0.15;

/// What runs a crease on past one end: an arc of the curvature that it ends with, so that parallels of
/// a circle stay circles, then a straight piece; in the direction of the crease.
pub(crate) fn run_on(curve: &PlanarCurve, side: usize, half_width_mm: f64, length_mm: f64) -> Vec<Segment> {
    if length_mm <= 0.0 {
        return Vec::new();
    }
    // Seen from the end, outwards: running backwards turns direction and curvature round.
    let (s_mm, sign) = if side == 0 { (0.0, -1.0) } else { (curve.length_mm(), 1.0) };
    let (mut at, mut direction) = (curve.end(side), -curve.leaving(side));
    let mut curvature = sign * curve.curvature(s_mm);
    let reach = curvature.abs() * half_width_mm;
    if !reach.is_finite() || reach > TIGHTEST {
        curvature = 0.0;
    }
    let mut segments = Vec::new();
    let arc_mm = length_mm.min(WIDEST_RAD / curvature.abs());
    if curvature != 0.0 {
        let pieces = (arc_mm * curvature.abs() / ARC_PIECE_RAD).ceil();
        for _ in 0..pieces as usize {
            let segment = circular(at, direction, curvature, arc_mm / pieces);
            direction = direction.rotate(DVec2::from_angle(curvature * arc_mm / pieces));
            at = segment.to();
            segments.push(segment);
        }
    }
    if length_mm > arc_mm || curvature == 0.0 {
        let rest = if curvature == 0.0 { length_mm } else { length_mm - arc_mm };
        segments.push(Segment::Line { from: at, to: at + rest * direction });
    }
    match side {
        0 => segments.iter().rev().map(Segment::reversed).collect(),
        _ => segments,
    }
}

/// A short arc as a cubic: control points a third of the way, `4/3 tan(φ/4)` of the radius.
fn circular(from: DVec2, direction: DVec2, curvature: f64, length_mm: f64) -> Segment {
    let angle = curvature * length_mm;
    let out = direction.rotate(DVec2::from_angle(angle));
    // Chord of an arc: 2 sin(φ/2)/κ towards half the angle.
    let to =
        from + direction.rotate(DVec2::from_angle(0.5 * angle)) * (2.0 * (0.5 * angle).sin() / curvature);
    let control = 4.0 / 3.0 * (0.25 * angle).tan() / curvature;
    Segment::Cubic { from, c1: from + control * direction, c2: to - control * out, to }
}
