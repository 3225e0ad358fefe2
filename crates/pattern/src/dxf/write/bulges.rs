//! Curves as vertices with bulges: arcs where there are arcs, else chords.

use super::DECIMALS;
use glam::DVec2;
use kurbo::{CubicBez, ParamCurve, Point};
use softfold_geometry::{PlanarCurve, Segment, polygon};

/// Points of each cubic that are held against an arc.
const CHECKED: usize = 8;
/// Share of the tolerance that the checked points may use up: between them a curve may be farther off, by 2 % if
/// its distance swings like a sine with one swing a cubic.
const CHECKED_SHARE: f64 = 0.95;
/// Cubics that may become one arc: a half circle of the reader's own pieces has 11.
const MAX_RUN: usize = 64;
/// Arcs go up to a half circle, and rounding.
const MAX_BULGE: f64 = 1.0 + 1e-6;
/// Below this bulge an arc is a straight line: it rises by less than a millionth of its chord.
const STRAIGHT: f64 = 1e-6;
/// A closed curve keeps its shape at chords of this share of its length.
const CLOSED_SHARE: f64 = 1.0 / 16.0;

/// x, y and the bulge of the piece that starts there, within `chord_mm` of the curve; a closed curve's first vertex
/// is not repeated. At least two vertices.
pub(super) fn vertices(curve: &PlanarCurve, chord_mm: f64) -> Vec<[f64; 3]> {
    let last_digit_mm = 10_f64.powi(-(DECIMALS as i32));
    let coarsest = if curve.is_closed() { CLOSED_SHARE * curve.length_mm() } else { f64::INFINITY };
    let chord_mm = chord_mm.max(last_digit_mm).min(coarsest);
    let mut vertices = Vec::new();
    let mut rest = curve.segments();
    while let [segment, after @ ..] = rest {
        let from = segment.from();
        match longest_arc(rest, chord_mm) {
            Some((count, bulge)) => {
                vertices.push([from.x, from.y, bulge]);
                rest = &rest[count..];
            }
            None => {
                vertices.extend(chords(segment, chord_mm).iter().map(|p| [p.x, p.y, 0.0]));
                rest = after;
            }
        }
    }
    if !curve.is_closed() {
        let end = curve.end(1);
        vertices.push([end.x, end.y, 0.0]);
    }
    vertices
}

/// Points of a segment but its end.
fn chords(segment: &Segment, chord_mm: f64) -> Vec<DVec2> {
    let Segment::Cubic { .. } = segment else { return vec![segment.from()] };
    // Segments of curves are finite and have a length.
    let Ok(curve) = PlanarCurve::new(vec![*segment]) else { return vec![segment.from()] };
    let mut points = curve.flatten(chord_mm);
    if !curve.is_closed() {
        points.pop();
    }
    points
}

/// How many of the first cubics are one arc, and its bulge; none if not even the first is.
fn longest_arc(segments: &[Segment], chord_mm: f64) -> Option<(usize, f64)> {
    let mut points = vec![segments.first()?.from()];
    let mut found = None;
    for (count, segment) in (1..=MAX_RUN).zip(segments) {
        let Segment::Cubic { from, c1, c2, to } = *segment else { break };
        let [a, b, c, d] = [from, c1, c2, to].map(|p| Point::new(p.x, p.y));
        let cubic = CubicBez::new(a, b, c, d);
        points.extend((1..=CHECKED).map(|k| {
            let p = cubic.eval(k as f64 / CHECKED as f64);
            DVec2::new(p.x, p.y)
        }));
        let Some(bulge) = arc(&points, CHECKED_SHARE * chord_mm) else { break };
        found = Some((count, bulge));
    }
    found
}

/// The bulge of the arc through the first, the middle and the last point, if all points lie on it, in order.
fn arc(points: &[DVec2], chord_mm: f64) -> Option<f64> {
    let [from, .., to] = *points else { return None };
    let middle = points[points.len() / 2];
    // The chords at a point of an arc turn by half of the arc's angle.
    let bulge = (0.5 * (middle - from).angle_to(to - middle)).tan();
    let chord = to - from;
    if bulge.abs() < STRAIGHT {
        let along = points.windows(2).all(|w| (w[1] - w[0]).dot(chord) > 0.0);
        let near = points.iter().all(|p| polygon::segment_distance(*p, from, to) <= chord_mm);
        return (along && near).then_some(0.0);
    }
    if bulge.is_nan() || bulge.abs() > MAX_BULGE {
        return None;
    }
    let centre = 0.5 * (from + to) + chord.perp() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let radius = centre.distance(from);
    let on = |p: &DVec2| (p.distance(centre) - radius).abs() <= chord_mm;
    let onward = |w: &[DVec2]| (w[0] - centre).perp_dot(w[1] - centre) * bulge > 0.0;
    (points.iter().all(on) && points.windows(2).all(onward)).then_some(bulge)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(points: [[f64; 2]; 4]) -> Segment {
        let [from, c1, c2, to] = points.map(DVec2::from);
        Segment::Cubic { from, c1, c2, to }
    }

    /// A circle of four cubics (radial error 2.7e-4 of the radius).
    fn circle(radius: f64) -> PlanarCurve {
        let k = 0.552_284_749_8;
        let quarter = cubic([[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]]);
        let turned = |n: usize| {
            let turn = |p: DVec2| radius * (0..n).fold(p, |p, _| p.perp());
            let Segment::Cubic { from, c1, c2, to } = quarter else { panic!("cubic") };
            Segment::Cubic { from: turn(from), c1: turn(c1), c2: turn(c2), to: turn(to) }
        };
        PlanarCurve::new((0..4).map(turned).collect()).unwrap()
    }

    #[test]
    fn a_circle_is_two_half_arcs() {
        let got = vertices(&circle(50.0), 0.02);
        assert_eq!(got.len(), 2, "{got:?}");
        for ([x, y, bulge], (u, v)) in got.iter().zip([(50.0, 0.0), (-50.0, 0.0)]) {
            assert!((x - u).abs() < 1e-9 && (y - v).abs() < 1e-9 && (bulge - 1.0).abs() < 1e-6);
        }
        let backwards = vertices(&circle(50.0).reversed(), 0.02);
        assert!(backwards.iter().all(|v| (v[2] + 1.0).abs() < 1e-6));
    }

    #[test]
    fn what_is_no_arc_within_the_tolerance_becomes_chords() {
        // 2.7e-4 of 1000 mm is 0.27 mm: too far from a circle.
        let rough = circle(1000.0);
        let got = vertices(&rough, 0.02);
        assert!(got.len() > 40 && got.iter().all(|v| v[2] == 0.0));
        assert_eq!(vertices(&rough, 0.5).len(), 2);
        assert!(vertices(&circle(150.0), 0.02).iter().all(|v| v[2] == 0.0), "twice too far");
    }

    #[test]
    fn an_s_is_never_one_arc() {
        let s = cubic([[0.0, 0.0], [40.0, 1.0], [60.0, -1.0], [100.0, 0.0]]);
        let got = vertices(&PlanarCurve::new(vec![s]).unwrap(), 1e-3);
        assert!(got.len() > 4, "{got:?}");
        let straight = cubic([[0.0, 0.0], [40.0, 0.0], [60.0, 0.0], [100.0, 0.0]]);
        let got = vertices(&PlanarCurve::new(vec![straight]).unwrap(), 0.02);
        assert_eq!(got, [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]);
        let there_and_back = cubic([[0.0, 0.0], [150.0, 0.0], [150.0, 0.0], [50.0, 0.0]]);
        let got = vertices(&PlanarCurve::new(vec![there_and_back]).unwrap(), 0.02);
        assert!(got.iter().any(|v| v[0] > 100.0), "{got:?}");
    }

    #[test]
    fn a_small_loop_keeps_its_inside() {
        let drop = cubic([[0.0, 0.0], [0.01, 0.01], [-0.01, 0.01], [0.0, 0.0]]);
        assert!(vertices(&PlanarCurve::new(vec![drop]).unwrap(), 0.02).len() >= 2);
    }
}
