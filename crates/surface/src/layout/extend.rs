//! Ends of cuts inside a face go straight on to the next curve.

use super::Line;
use glam::DVec2;
use softfold_geometry::{PlanarCurve, ShellEdgeKind, Tolerance, polygon};

/// Newton's steps from the polygon's crossing onto the curve; they converge quadratically from within the chord error.
const STEPS: usize = 8;

/// Adds a straight smooth line at every end of a cut that meets no other curve.
pub(super) fn lengthen(lines: &mut Vec<Line>, tolerance: &Tolerance) {
    let mut polygons: Vec<Vec<DVec2>> = lines.iter().map(|l| flattened(&l.curve, tolerance)).collect();
    for i in 0..lines.len() {
        if lines[i].curve.is_closed() {
            continue;
        }
        for side in 0..2 {
            let from = lines[i].curve.end(side);
            if meets(lines, &polygons, i, from, tolerance) {
                continue;
            }
            let along = -lines[i].curve.leaving(side);
            let Some(to) = next_on(lines, &polygons, from, along, tolerance) else { continue };
            if let Ok(curve) = PlanarCurve::polyline(&[from, to]) {
                polygons.push(flattened(&curve, tolerance));
                lines.push(Line { curve, kind: ShellEdgeKind::Smooth, cut: None });
            }
        }
    }
}

fn flattened(curve: &PlanarCurve, tolerance: &Tolerance) -> Vec<DVec2> {
    let mut points = curve.flatten(tolerance.chord_mm);
    if curve.is_closed() {
        points.push(points[0]);
    }
    points
}

/// Whether another line passes an end of line `own`.
fn meets(lines: &[Line], polygons: &[Vec<DVec2>], own: usize, end: DVec2, tolerance: &Tolerance) -> bool {
    let near = tolerance.join_mm + tolerance.chord_mm;
    (0..lines.len())
        .filter(|&k| k != own)
        .any(|k| polygons[k].windows(2).any(|w| polygon::segment_distance(end, w[0], w[1]) <= near))
}

/// Where a ray first meets a line, exactly on its curve.
fn next_on(
    lines: &[Line],
    polygons: &[Vec<DVec2>],
    from: DVec2,
    along: DVec2,
    tolerance: &Tolerance,
) -> Option<DVec2> {
    let reach = polygons.iter().flatten().map(|p| p.distance(from)).fold(0.0, f64::max);
    let far = from + 2.0 * reach * along;
    let mut nearest: Option<(f64, DVec2, usize)> = None;
    for (k, points) in polygons.iter().enumerate() {
        for w in points.windows(2) {
            let Some((t, _)) = polygon::segment_crossing(from, far, w[0], w[1]) else { continue };
            let distance = 2.0 * reach * t;
            if distance > tolerance.join_mm && nearest.is_none_or(|n| distance < n.0) {
                nearest = Some((distance, from + distance * along, k));
            }
        }
    }
    nearest.map(|(_, at, k)| onto(&lines[k].curve, at, from, along))
}

/// The crossing of a ray with a curve, near `at`.
fn onto(curve: &PlanarCurve, at: DVec2, from: DVec2, along: DVec2) -> DVec2 {
    let mut s = curve.nearest(at).0;
    for _ in 0..STEPS {
        let slope = along.perp_dot(curve.tangent(s));
        if slope == 0.0 {
            break;
        }
        s -= along.perp_dot(curve.point(s) - from) / slope;
    }
    curve.point(s)
}
