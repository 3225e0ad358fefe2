//! Dense polylines to smooth curves: what a drawing program exported as many short lines becomes few cubics again.
//!
//! A band follows its crease's curvature, and a polyline has none: its parallels kink at every vertex. A run of
//! lines that turns little and steadily is taken as samples of a smooth curve: an interpolating C2 cubic spline
//! goes through its vertices, and kurbo's fitter (Levien, "Simplifying Bézier paths", area and moment matched
//! cubics) follows the spline with few G1 cubics.

use crate::fair::faired;
use kurbo::{CurveFitSample, ParamCurve, ParamCurveFit, ParamCurveNearest, PathEl, PathSeg, Point, Vec2};
use softfold_geometry::{DVec2, Segment, polygon};
use std::ops::Range;

/// Fewest lines that are taken as samples of a curve: four vertices between the ends.
const LEAST_LINES: usize = 5;
/// Sharpest turn at a vertex of such a run, rad (20°): an 18-gon is a circle, a 16-gon is drawn as one.
const SHARPEST_TURN_RAD: f64 = 0.35;
/// Two turns that follow each other to opposite sides are noise or an inflection only if both are below this,
/// rad (6°); larger ones are a zigzag that is meant.
const SHARPEST_WIGGLE_RAD: f64 = 0.105;
/// Neighbouring lines of sampled curves differ in length by at most this factor.
const MOST_UNEVEN: f64 = 12.0;
/// Ways to share the tolerance: how far vertices may move against the noise of their rounding, and what the fit may
/// use. The rest is for the fitter's own estimate of its error.
const SHARES: [[f64; 2]; 4] = [[0.0, 0.7], [0.4, 0.4], [0.75, 0.2], [0.9, 0.1]];
/// A refitted run has fewer segments than this share of its lines, or it stays as it was drawn.
const MOST_KEPT: f64 = 0.7;

/// A curve with its dense runs refitted.
#[derive(Clone, Debug)]
pub(crate) struct Refit {
    /// All segments; the ends are those of the input to the last bit.
    pub(crate) segments: Vec<Segment>,
    /// Vertices that were replaced.
    pub(crate) vertices: usize,
    /// Largest distance of a replaced vertex from the new curve, mm.
    pub(crate) largest_mm: f64,
    /// Largest distance of the new curve from a replaced line, mm: how far the polyline was from its curve.
    pub(crate) bulge_mm: f64,
}

/// Refits the dense runs of lines of a curve within `tolerance_mm` of their vertices, and makes straight runs one
/// line; none if there is nothing to refit. `closed` curves may turn through their start smoothly.
pub(crate) fn refit(segments: &[Segment], closed: bool, tolerance_mm: f64) -> Option<Refit> {
    if tolerance_mm <= 0.0 || segments.len() < 2 {
        return None;
    }
    let mut out = Refit { segments: Vec::new(), vertices: 0, largest_mm: 0.0, bulge_mm: 0.0 };
    if closed && is_smooth_ring(segments) {
        let ring: Vec<DVec2> = segments.iter().map(Segment::from).collect();
        if out.take(&ring, true, tolerance_mm) {
            return Some(out);
        }
        return None;
    }
    let mut at = 0;
    while at < segments.len() {
        let end = run_end(segments, at);
        let points: Vec<DVec2> =
            std::iter::once(segments[at].from()).chain(segments[at..end].iter().map(Segment::to)).collect();
        if !(out.straighten(&points, tolerance_mm) || out.take(&points, false, tolerance_mm)) {
            out.segments.extend_from_slice(&segments[at..end]);
        }
        at = end;
    }
    (out.vertices > 0).then_some(out)
}

impl Refit {
    /// Takes a run whose vertices all lie on its chord as one line.
    fn straighten(&mut self, points: &[DVec2], tolerance_mm: f64) -> bool {
        let (from, to) = (points[0], points[points.len() - 1]);
        let inner = &points[1..points.len() - 1];
        let off = inner.iter().map(|&p| polygon::segment_distance(p, from, to)).fold(0.0, f64::max);
        let forward = points.windows(2).all(|w| (w[1] - w[0]).dot(to - from) > 0.0);
        // A tenth: a shallow arc must not become its chord.
        if inner.is_empty() || !forward || off > 0.1 * tolerance_mm {
            return false;
        }
        self.segments.push(Segment::Line { from, to });
        self.vertices += inner.len();
        self.largest_mm = self.largest_mm.max(off);
        true
    }

    /// Takes a run of vertices as a smooth curve; false if it is too short or the fit is no good.
    fn take(&mut self, points: &[DVec2], ring: bool, tolerance_mm: f64) -> bool {
        let lines = if ring { points.len() } else { points.len() - 1 };
        if lines < LEAST_LINES {
            return false;
        }
        let mut fits = SHARES.map(|shares| fit(points, ring, shares.map(|s| s * tolerance_mm)));
        // The fewest pieces; of as few, those that move the vertices least.
        fits.sort_by_key(Vec::len);
        let few = |f: &&Vec<Segment>| !f.is_empty() && f.len() as f64 <= MOST_KEPT * lines as f64;
        let good = fits.iter().filter(few).find_map(|f| {
            let pieces = Pieces::new(f);
            let largest = pieces.worst(points.iter().copied());
            (largest <= tolerance_mm).then_some((f, pieces, largest))
        });
        let Some((fitted, pieces, largest)) = good else { return false };
        let middles = points.windows(2).map(|w| 0.5 * (w[0] + w[1]));
        self.bulge_mm = self.bulge_mm.max(pieces.worst(middles));
        self.largest_mm = self.largest_mm.max(largest);
        self.vertices += if ring { lines } else { lines - 1 };
        self.segments.extend_from_slice(fitted);
        true
    }
}

/// Index after the last line of the run that begins at `start`; `start + 1` for a cubic.
fn run_end(segments: &[Segment], start: usize) -> usize {
    let mut end = start + 1;
    let mut before = None;
    while end < segments.len() {
        let (Some(a), Some(b)) = (line(&segments[end - 1]), line(&segments[end])) else { break };
        let turn = a.angle_to(b);
        if !continues(a, b, turn, before) {
            break;
        }
        before = Some(turn);
        end += 1;
    }
    end
}

fn is_smooth_ring(segments: &[Segment]) -> bool {
    let n = segments.len();
    let turn = |i: usize| Some(line(&segments[i])?.angle_to(line(&segments[(i + 1) % n])?));
    (0..n).all(|i| {
        let (Some(a), Some(b)) = (line(&segments[i]), line(&segments[(i + 1) % n])) else { return false };
        continues(a, b, a.angle_to(b), turn((i + n - 1) % n))
    })
}

/// Whether line `b` continues line `a` as samples of a curve do.
fn continues(a: DVec2, b: DVec2, turn: f64, before: Option<f64>) -> bool {
    let wiggle = before.is_some_and(|t| t * turn < 0.0 && t.abs().max(turn.abs()) > SHARPEST_WIGGLE_RAD);
    let even = a.length() < MOST_UNEVEN * b.length() && b.length() < MOST_UNEVEN * a.length();
    turn.abs() <= SHARPEST_TURN_RAD && !wiggle && even
}

/// The vector of a straight segment.
fn line(segment: &Segment) -> Option<DVec2> {
    match segment {
        Segment::Line { from, to } => Some(*to - *from),
        Segment::Cubic { .. } => None,
    }
}

/// A C2 cubic spline through points, by its derivatives at them, over chord length.
struct Spline {
    points: Vec<DVec2>,
    slopes: Vec<DVec2>,
    /// Parameter of each point, from 0 to 1.
    knots: Vec<f64>,
}

impl Spline {
    /// Through the points; a ring goes on from the last to the first with the same slope there.
    fn through(points: &[DVec2], ring: bool) -> Self {
        let mut points = points.to_vec();
        if ring {
            points.push(points[0]);
        }
        let mut knots = vec![0.0];
        for w in points.windows(2) {
            knots.push(knots[knots.len() - 1] + w[0].distance(w[1]));
        }
        let whole = knots[knots.len() - 1];
        knots.iter_mut().for_each(|k| *k /= whole);
        let last = points.len() - 1;
        let ends = match ring {
            true => {
                let (h0, h1) = (knots[1], 1.0 - knots[last - 1]);
                [parabola([points[last - 1], points[0], points[1]], [h1, h0], 0.5); 2]
            }
            false => {
                let h = |i: usize| knots[i + 1] - knots[i];
                let start = parabola([points[0], points[1], points[2]], [h(0), h(1)], 0.0);
                let tail = [points[last - 2], points[last - 1], points[last]];
                [start, parabola(tail, [h(last - 2), h(last - 1)], 1.0)]
            }
        };
        let slopes = clamped_slopes(&points, &knots, ends);
        Self { points, slopes, knots }
    }

    /// Point and derivative at a parameter from 0 to 1.
    fn at(&self, t: f64) -> (DVec2, DVec2) {
        let i = self.knots.partition_point(|&k| k <= t).clamp(1, self.points.len() - 1) - 1;
        let h = self.knots[i + 1] - self.knots[i];
        let (u, [p, q], [d, e]) = (
            (t - self.knots[i]) / h,
            [self.points[i], self.points[i + 1]],
            [self.slopes[i] * h, self.slopes[i + 1] * h],
        );
        let v = 1.0 - u;
        let point =
            p * (v * v * (1.0 + 2.0 * u)) + q * (u * u * (1.0 + 2.0 * v)) + d * (u * v * v) - e * (v * u * u);
        let slope = (q - p) * (6.0 * u * v) + d * (v * (1.0 - 3.0 * u)) + e * (u * (1.0 - 3.0 * v));
        (point, slope / h)
    }
}

/// Slope of the parabola through three points with steps `h` between them: at the first (`place` 0), the middle
/// (0.5) or the last (1).
fn parabola([a, b, c]: [DVec2; 3], [h0, h1]: [f64; 2], place: f64) -> DVec2 {
    let (before, after) = ((b - a) / h0, (c - b) / h1);
    let second = (after - before) / (h0 + h1);
    match place {
        p if p < 0.25 => before - h0 * second,
        p if p > 0.75 => after + h1 * second,
        _ => before + h0 * second,
    }
}

/// Slopes at the knots of the C2 spline with given slopes at its ends (Thomas' algorithm).
fn clamped_slopes(points: &[DVec2], knots: &[f64], ends: [DVec2; 2]) -> Vec<DVec2> {
    let last = points.len() - 1;
    let h = |i: usize| knots[i + 1] - knots[i];
    let chord = |i: usize| (points[i + 1] - points[i]) / h(i);
    let (mut factor, mut rest) = (vec![0.0; last + 1], vec![ends[0]; last + 1]);
    for i in 1..last {
        let (lower, upper) = (h(i), h(i - 1));
        let right = 3.0 * (h(i) * chord(i - 1) + h(i - 1) * chord(i));
        let pivot = 2.0 * (h(i - 1) + h(i)) - lower * factor[i - 1];
        factor[i] = upper / pivot;
        rest[i] = (right - lower * rest[i - 1]) / pivot;
    }
    let mut slopes = vec![ends[1]; last + 1];
    for i in (0..last).rev() {
        slopes[i] = rest[i] - factor[i] * slopes[i + 1];
    }
    slopes[0] = ends[0];
    slopes
}

impl ParamCurveFit for Spline {
    fn sample_pt_tangent(&self, t: f64, _: f64) -> CurveFitSample {
        let (p, tangent) = self.sample_pt_deriv(t);
        CurveFitSample { p, tangent }
    }

    fn sample_pt_deriv(&self, t: f64) -> (Point, Vec2) {
        let (p, d) = self.at(t);
        (Point::new(p.x, p.y), Vec2::new(d.x, d.y))
    }

    fn break_cusp(&self, _: Range<f64>) -> Option<f64> {
        None
    }
}

/// The cubics along the vertices, which may move by `fair_mm` first; a ring's first as well.
fn fit(points: &[DVec2], ring: bool, [fair_mm, accuracy_mm]: [f64; 2]) -> Vec<Segment> {
    // Far from the origin the areas and moments that the fitter matches would lose their digits.
    let origin = points[0];
    let mut local: Vec<DVec2> = points.iter().map(|p| *p - origin).collect();
    if fair_mm > 0.0 {
        local = faired(&local, ring, fair_mm);
    }
    let fitted = cubics(&Spline::through(&local, ring), &local, ring, accuracy_mm);
    let mut segments: Vec<Segment> = fitted.iter().map(|s| moved(s, origin)).collect();
    if let (false, Some(Segment::Line { to, .. } | Segment::Cubic { to, .. })) = (ring, segments.last_mut()) {
        *to = points[points.len() - 1];
    }
    segments
}

fn moved(segment: &Segment, by: DVec2) -> Segment {
    match *segment {
        Segment::Line { from, to } => Segment::Line { from: from + by, to: to + by },
        Segment::Cubic { from, c1, c2, to } => {
            Segment::Cubic { from: from + by, c1: c1 + by, c2: c2 + by, to: to + by }
        }
    }
}

/// The fitted cubics with their ends set to the points exactly.
fn cubics(spline: &Spline, points: &[DVec2], ring: bool, accuracy_mm: f64) -> Vec<Segment> {
    let vector = |p: Point| DVec2::new(p.x, p.y);
    let mut segments: Vec<Segment> = Vec::new();
    let mut from = points[0];
    for element in kurbo::fit_to_bezpath(spline, accuracy_mm).elements() {
        let segment = match *element {
            PathEl::CurveTo(a, b, p) => Segment::Cubic { from, c1: vector(a), c2: vector(b), to: vector(p) },
            PathEl::LineTo(p) => Segment::Line { from, to: vector(p) },
            _ => continue,
        };
        from = segment.to();
        segments.push(segment);
    }
    let end = if ring { points[0] } else { points[points.len() - 1] };
    match segments.last_mut() {
        Some(Segment::Line { to, .. } | Segment::Cubic { to, .. }) => *to = end,
        None => {}
    }
    let finite = |s: &Segment| s.control_points().iter().all(|p| p.is_finite());
    if segments.iter().all(finite) { segments } else { Vec::new() }
}

/// A chain of segments with the boxes of their control points, to measure distances from.
struct Pieces<'a>(Vec<(&'a Segment, DVec2, DVec2)>);

impl<'a> Pieces<'a> {
    fn new(segments: &'a [Segment]) -> Self {
        let boxed = |s: &'a Segment| {
            let (low, high) = polygon::bounds(&s.control_points());
            (s, low, high)
        };
        Self(segments.iter().map(boxed).collect())
    }

    /// Largest distance of points from the chain.
    fn worst(&self, points: impl Iterator<Item = DVec2>) -> f64 {
        points.map(|p| self.distance(p)).fold(0.0, f64::max)
    }

    /// Distance of a point from the chain.
    fn distance(&self, p: DVec2) -> f64 {
        self.0.iter().fold(f64::INFINITY, |nearest, &(segment, low, high)| {
            let outside = p.distance(p.clamp(low, high));
            if outside < nearest { nearest.min(distance(segment, p)) } else { nearest }
        })
    }
}

/// Distance of a point from a segment.
fn distance(segment: &Segment, p: DVec2) -> f64 {
    /// Share of a mm to which the nearest point is found.
    const ACCURACY: f64 = 1e-9;
    let point = |q: DVec2| Point::new(q.x, q.y);
    match *segment {
        Segment::Line { from, to } => polygon::segment_distance(p, from, to),
        Segment::Cubic { from, c1, c2, to } => {
            let cubic = PathSeg::Cubic(kurbo::CubicBez::new(point(from), point(c1), point(c2), point(to)));
            // The nearest point by the polynomial's roots; the ends in case that these are missed.
            let found = cubic.nearest(point(p), ACCURACY).distance_sq.sqrt();
            found.min(cubic.start().distance(point(p))).min(cubic.end().distance(point(p)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use softfold_geometry::PlanarCurve;

    fn lines(points: &[DVec2]) -> Vec<Segment> {
        points.windows(2).map(|w| Segment::Line { from: w[0], to: w[1] }).collect()
    }

    fn arc(radius: f64, from: f64, to: f64, n: usize) -> Vec<DVec2> {
        (0..=n).map(|k| radius * DVec2::from_angle(from + (to - from) * k as f64 / n as f64)).collect()
    }

    #[test]
    fn a_sampled_arc_has_its_curvature_again_with_few_cubics() {
        let points = arc(500.0, 0.2, 1.7, 30);
        let r = refit(&lines(&points), false, 0.05).unwrap();
        assert!(r.segments.len() <= 4, "{}", r.segments.len());
        assert!(r.largest_mm <= 0.05);
        let curve = PlanarCurve::new(r.segments).unwrap();
        assert_eq!([curve.end(0), curve.end(1)], [points[0], points[30]]);
        for k in 0..=100 {
            let s = curve.length_mm() * k as f64 / 100.0;
            assert!((curve.point(s).length() - 500.0).abs() < 0.05, "{}", curve.point(s).length());
            assert!((curve.curvature(s) * 500.0 - 1.0).abs() < 0.05, "{}", curve.curvature(s) * 500.0);
        }
        // Sagitta of the chords that were drawn.
        let sagitta = 500.0 * (1.0 - (0.025_f64).cos());
        assert!((r.bulge_mm - sagitta).abs() < 0.02, "{} {sagitta}", r.bulge_mm);
    }

    #[test]
    fn far_from_the_origin_the_fit_is_the_same() {
        let points: Vec<DVec2> =
            arc(50.0, 0.2, 2.7, 120).iter().map(|p| (*p * 100.0).round() / 100.0).collect();
        let far: Vec<DVec2> = points.iter().map(|p| *p + DVec2::new(1e6, -2e6)).collect();
        let [near, far] = [points, far].map(|p| refit(&lines(&p), false, 0.01).unwrap().segments);
        assert_eq!(near.len(), far.len());
        for (a, b) in near.iter().zip(&far) {
            assert!(moved(a, DVec2::new(1e6, -2e6)).to().distance(b.to()) < 1e-4);
        }
    }

    #[test]
    fn a_sampled_ring_closes_without_a_corner() {
        let points = arc(200.0, 0.0, std::f64::consts::TAU, 64);
        let mut segments = lines(&points);
        segments[63] = Segment::Line { from: points[63], to: points[0] };
        let r = refit(&segments, true, 0.02).unwrap();
        let curve = PlanarCurve::new(r.segments).unwrap();
        assert!(curve.is_closed());
        assert!(curve.leaving(0).dot(-curve.leaving(1)) > 1.0 - 1e-6);
        assert!((curve.signed_area_mm2() - std::f64::consts::PI * 4e4).abs() < 10.0);
    }

    #[test]
    fn an_s_curve_keeps_its_inflection() {
        let points: Vec<DVec2> =
            (0..=40).map(|k| f64::from(k) * 10.0).map(|x| DVec2::new(x, 40.0 * (x / 60.0).sin())).collect();
        let r = refit(&lines(&points), false, 0.1).unwrap();
        let curve = PlanarCurve::new(r.segments).unwrap();
        for k in 0..=200 {
            let p = curve.point(curve.length_mm() * f64::from(k) / 200.0);
            assert!((p.y - 40.0 * (p.x / 60.0).sin()).abs() < 0.25, "{p}");
        }
    }

    #[test]
    fn corners_zigzags_polygons_and_few_lines_stay_as_drawn() {
        let zigzag: Vec<DVec2> = (0..20).map(|k| DVec2::new(f64::from(k) * 10.0, f64::from(k % 2))).collect();
        assert!(refit(&lines(&zigzag), false, 0.1).is_none());
        assert!(refit(&lines(&arc(100.0, 0.0, 6.0, 12)), false, 0.1).is_none(), "turns of 29°");
        assert!(refit(&lines(&arc(100.0, 0.0, 0.5, 4)), false, 0.1).is_none(), "four lines");
        assert!(refit(&lines(&arc(100.0, 0.0, 1.0, 20)), false, 0.0).is_none(), "switched off");
        let mut corner = arc(100.0, 0.0, 1.0, 20);
        let shift = corner[20] - corner[0];
        corner.extend(arc(100.0, 0.0, 1.0, 20).iter().skip(1).map(|p| *p + shift));
        let r = refit(&lines(&corner), false, 0.05).unwrap();
        assert!(r.segments.iter().any(|s| s.to() == corner[20]), "the corner stays a vertex");
    }

    #[test]
    fn a_straight_run_is_one_line_and_a_curve_between_lines_keeps_its_ends() {
        let row: Vec<DVec2> = (0..=9).map(|k| DVec2::new(f64::from(k), 2.0 * f64::from(k))).collect();
        let r = refit(&lines(&row), false, 0.01).unwrap();
        assert_eq!(r.segments, [Segment::Line { from: row[0], to: row[9] }]);
        assert_eq!(r.vertices, 8);
        let cubic =
            Segment::Cubic { from: DVec2::ZERO, c1: DVec2::X, c2: DVec2::ONE, to: DVec2::new(2.0, 1.0) };
        assert!(
            refit(&[cubic, Segment::Line { from: cubic.to(), to: DVec2::new(3.0, 1.0) }], false, 0.01)
                .is_none()
        );
    }
}
