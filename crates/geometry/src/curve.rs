//! Planar curves of the pattern: chains of lines and cubic Béziers, addressed by arc length.

use glam::DVec2;
use kurbo::{
    CubicBez, Line, ParamCurve, ParamCurveArclen, ParamCurveCurvature, ParamCurveDeriv, PathSeg, Point,
};

/// Accuracy of arc lengths, mm: far below every tolerance of a sheet.
const ARC_LENGTH_ACCURACY_MM: f64 = 1e-9;
/// Most points a flattened segment is cut into; at 1e-3 mm chord error that is a curve of many metres.
const MAX_FLATTEN_PIECES: usize = 4096;
/// Share of the curve's size by which the ends of neighbouring segments may differ.
const CONTINUITY: f64 = 1e-9;

/// One piece of a [`PlanarCurve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// A straight piece.
    Line {
        /// Start.
        from: DVec2,
        /// End.
        to: DVec2,
    },
    /// A cubic Bézier.
    Cubic {
        /// Start.
        from: DVec2,
        /// First control point.
        c1: DVec2,
        /// Second control point.
        c2: DVec2,
        /// End.
        to: DVec2,
    },
}

/// Why a curve cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// No segment of positive length.
    #[error("the curve has no length")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("segment {segment} has a coordinate that is no finite number")]
    NotFinite {
        /// Number of the segment, from 0.
        segment: usize,
    },
    /// Neighbouring segments do not meet.
    #[error("segment {segment} does not start where the one before it ends, at ({:.3}, {:.3})", at.x, at.y)]
    Gap {
        /// Number of the segment, from 0.
        segment: usize,
        /// Its start.
        at: DVec2,
    },
}

/// A chain of [`Segment`]s, each starting where the one before it ends; closed if the last ends at
/// the first's start. Positions on it are arc lengths in mm from its start.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarCurve {
    segments: Vec<Segment>,
    /// Arc length at the start of each segment, and the whole length last.
    lengths_mm: Vec<f64>,
    closed: bool,
}

impl Segment {
    /// Start point.
    pub fn from(&self) -> DVec2 {
        match *self {
            Segment::Line { from, .. } | Segment::Cubic { from, .. } => from,
        }
    }

    /// End point.
    pub fn to(&self) -> DVec2 {
        match *self {
            Segment::Line { to, .. } | Segment::Cubic { to, .. } => to,
        }
    }

    /// The same piece, run through backwards.
    pub fn reversed(&self) -> Self {
        match *self {
            Segment::Line { from, to } => Segment::Line { from: to, to: from },
            Segment::Cubic { from, c1, c2, to } => Segment::Cubic { from: to, c1: c2, c2: c1, to: from },
        }
    }

    /// The same piece with its ends moved by a little.
    pub fn with_ends(&self, from: DVec2, to: DVec2) -> Self {
        match *self {
            Segment::Line { .. } => Segment::Line { from, to },
            Segment::Cubic { from: a, c1, c2, to: b } => {
                Segment::Cubic { from, c1: c1 + (from - a), c2: c2 + (to - b), to }
            }
        }
    }

    /// Point at a share of the segment's parameter, 0 to 1.
    pub fn at(&self, t: f64) -> DVec2 {
        vector(self.path().eval(t))
    }

    /// Start, control points and end.
    pub fn control_points(&self) -> Vec<DVec2> {
        match *self {
            Segment::Line { from, to } => vec![from, to],
            Segment::Cubic { from, c1, c2, to } => vec![from, c1, c2, to],
        }
    }

    fn path(&self) -> PathSeg {
        match *self {
            Segment::Line { from, to } => PathSeg::Line(Line::new(point(from), point(to))),
            Segment::Cubic { from, c1, c2, to } => {
                PathSeg::Cubic(CubicBez::new(point(from), point(c1), point(c2), point(to)))
            }
        }
    }

    /// Arc length, mm.
    pub fn length_mm(&self) -> f64 {
        self.path().arclen(ARC_LENGTH_ACCURACY_MM)
    }

    fn mapped(&self, f: impl Fn(DVec2) -> DVec2) -> Self {
        match *self {
            Segment::Line { from, to } => Segment::Line { from: f(from), to: f(to) },
            Segment::Cubic { from, c1, c2, to } => {
                Segment::Cubic { from: f(from), c1: f(c1), c2: f(c2), to: f(to) }
            }
        }
    }

    /// Pieces of equal parameter that keep the chord error: `n = sqrt(L''/(8 ε))` with the largest
    /// second derivative, the bound of the linear interpolation error.
    fn flatten_pieces(&self, chord_mm: f64) -> usize {
        match *self {
            Segment::Line { .. } => 1,
            Segment::Cubic { from, c1, c2, to } => {
                let second = 6.0 * (from - 2.0 * c1 + c2).length().max((c1 - 2.0 * c2 + to).length());
                ((second / (8.0 * chord_mm)).sqrt().ceil() as usize).clamp(1, MAX_FLATTEN_PIECES)
            }
        }
    }
}

impl PlanarCurve {
    /// A curve from its segments; those of no length are dropped.
    ///
    /// # Errors
    /// No segment left, coordinates that are not finite, or neighbours that do not meet.
    pub fn new(segments: Vec<Segment>) -> Result<Self, CurveError> {
        for (segment, s) in segments.iter().enumerate() {
            if !s.control_points().iter().all(|p| p.is_finite()) {
                return Err(CurveError::NotFinite { segment });
            }
        }
        let segments: Vec<_> =
            segments.into_iter().filter(|s| s.length_mm() > ARC_LENGTH_ACCURACY_MM).collect();
        let (Some(first), Some(last)) = (segments.first(), segments.last()) else {
            return Err(CurveError::Empty);
        };
        let reach = segments.iter().flat_map(|s| s.control_points()).map(|p| p.abs().max_element());
        let gap_mm = CONTINUITY * reach.fold(1.0, f64::max);
        let closed = first.from().distance(last.to()) <= gap_mm;
        if let Some(i) =
            (1..segments.len()).find(|&i| segments[i - 1].to().distance(segments[i].from()) > gap_mm)
        {
            return Err(CurveError::Gap { segment: i, at: segments[i].from() });
        }
        let mut lengths_mm = vec![0.0];
        for s in &segments {
            lengths_mm.push(lengths_mm[lengths_mm.len() - 1] + s.length_mm());
        }
        Ok(Self { segments, lengths_mm, closed })
    }

    /// A chain of straight pieces through the points.
    ///
    /// # Errors
    /// As [`PlanarCurve::new`].
    pub fn polyline(points: &[DVec2]) -> Result<Self, CurveError> {
        Self::new(points.windows(2).map(|w| Segment::Line { from: w[0], to: w[1] }).collect())
    }

    /// The cubic spline through points, of continuous curvature and nearly arc length in its parameter: closed where the last
    /// point is the first, and with these directions at its ends where it is open.
    ///
    /// # Errors
    /// As [`PlanarCurve::new`].
    pub fn spline(points: &[DVec2], ends: [DVec2; 2]) -> Result<Self, CurveError> {
        let slopes = spline_slopes(points, ends);
        let piece = |k: usize| {
            let (from, to) = (points[k], points[k + 1]);
            let third = from.distance(to) / 3.0;
            Segment::Cubic { from, c1: from + third * slopes[k], c2: to - third * slopes[k + 1], to }
        };
        Self::new((0..points.len().saturating_sub(1)).map(piece).collect())
    }

    /// The pieces, in order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Whether the curve ends where it starts.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Whole arc length, mm.
    pub fn length_mm(&self) -> f64 {
        self.lengths_mm[self.lengths_mm.len() - 1]
    }

    /// Arc lengths at which segments meet, with 0 and the whole length.
    pub fn joints_mm(&self) -> &[f64] {
        &self.lengths_mm
    }

    /// Point at arc length `s_mm`; wraps on closed curves, is clamped on open ones.
    pub fn point(&self, s_mm: f64) -> DVec2 {
        let (i, t) = self.locate(s_mm);
        vector(self.segments[i].path().eval(t))
    }

    /// Unit tangent at arc length `s_mm`.
    pub fn tangent(&self, s_mm: f64) -> DVec2 {
        let (i, t) = self.locate(s_mm);
        tangent_of(&self.segments[i], t)
    }

    /// Signed curvature at arc length `s_mm`, 1/mm; positive where the curve turns left.
    pub fn curvature(&self, s_mm: f64) -> f64 {
        let (i, t) = self.locate(s_mm);
        match self.segments[i].path() {
            PathSeg::Cubic(c) => -c.curvature(t), // kurbo counts turning right as positive
            _ => 0.0,
        }
    }

    /// Start (side 0) or end (side 1), exactly.
    pub fn end(&self, side: usize) -> DVec2 {
        match side {
            0 => self.segments[0].from(),
            _ => self.segments[self.segments.len() - 1].to(),
        }
    }

    /// Unit direction in which the curve leaves its start (side 0) or, backwards, its end (side 1).
    pub fn leaving(&self, side: usize) -> DVec2 {
        match side {
            0 => tangent_of(&self.segments[0], 0.0),
            _ => -tangent_of(&self.segments[self.segments.len() - 1], 1.0),
        }
    }

    /// The same curve, run through backwards.
    pub fn reversed(&self) -> Self {
        let total = self.length_mm();
        Self {
            segments: self.segments.iter().rev().map(Segment::reversed).collect(),
            lengths_mm: self.lengths_mm.iter().rev().map(|l| total - l).collect(),
            closed: self.closed,
        }
    }

    /// The part between two arc lengths, mm, its segments cut exactly. On a closed curve `to_mm` may lie before `from_mm`,
    /// or both may be the same: then it runs on past the start.
    ///
    /// # Errors
    /// A part of no length.
    pub fn part(&self, from_mm: f64, to_mm: f64) -> Result<Self, CurveError> {
        let total = self.length_mm();
        let runs = match self.closed && to_mm <= from_mm {
            true => vec![(from_mm, total), (0.0, to_mm)],
            false => vec![(from_mm.max(0.0), to_mm.min(total))],
        };
        let cut = |&(from, to): &(f64, f64)| {
            let within = |i: usize| (self.lengths_mm[i].max(from), self.lengths_mm[i + 1].min(to));
            let pieces = (0..self.segments.len()).map(move |i| (i, within(i)));
            pieces.filter(|(_, (a, b))| b - a > ARC_LENGTH_ACCURACY_MM).collect::<Vec<_>>()
        };
        let piece = |(i, (a, b)): (usize, (f64, f64))| self.piece(i, a, b);
        Self::new(runs.iter().flat_map(cut).map(piece).collect())
    }

    /// The part of one segment between two arc lengths of the curve; whole segments stay what they are to the last bit.
    fn piece(&self, i: usize, from_mm: f64, to_mm: f64) -> Segment {
        let path = self.segments[i].path();
        let (start, end) = (self.lengths_mm[i], self.lengths_mm[i + 1]);
        let parameter = |s: f64| path.inv_arclen(s - start, ARC_LENGTH_ACCURACY_MM);
        let t0 = if from_mm <= start { 0.0 } else { parameter(from_mm) };
        let t1 = if to_mm >= end { 1.0 } else { parameter(to_mm) };
        if (t0, t1) == (0.0, 1.0) {
            return self.segments[i];
        }
        match path.subsegment(t0..t1) {
            PathSeg::Cubic(c) => {
                Segment::Cubic { from: vector(c.p0), c1: vector(c.p1), c2: vector(c.p2), to: vector(c.p3) }
            }
            part => Segment::Line { from: vector(part.start()), to: vector(part.end()) },
        }
    }

    /// The curve with `f` applied to all its control points (exact for affine maps).
    ///
    /// # Errors
    /// As [`PlanarCurve::new`].
    pub fn mapped(&self, f: impl Fn(DVec2) -> DVec2) -> Result<Self, CurveError> {
        Self::new(self.segments.iter().map(|s| s.mapped(&f)).collect())
    }

    /// Points on the curve whose polyline is nowhere farther than `chord_mm` from it, joints
    /// included. A closed curve's first point is not repeated.
    pub fn flatten(&self, chord_mm: f64) -> Vec<DVec2> {
        let mut points = vec![self.segments[0].from()];
        for s in &self.segments {
            let n = s.flatten_pieces(chord_mm);
            let path = s.path();
            points.extend(
                (1..=n).map(|k| if k == n { s.to() } else { vector(path.eval(k as f64 / n as f64)) }),
            );
        }
        if self.closed {
            points.pop();
        }
        points
    }

    /// Signed area of a closed curve, mm²; positive if it runs counter-clockwise.
    pub fn signed_area_mm2(&self) -> f64 {
        use kurbo::ParamCurveArea;
        self.segments.iter().map(|s| s.path().signed_area()).sum()
    }

    /// Arc length of the point of the curve nearest to `p`, and its distance.
    pub fn nearest(&self, p: DVec2) -> (f64, f64) {
        use kurbo::ParamCurveNearest;
        let mut best = (0.0, f64::INFINITY);
        for (i, s) in self.segments.iter().enumerate() {
            let near = s.path().nearest(point(p), ARC_LENGTH_ACCURACY_MM);
            if near.distance_sq < best.1 {
                let part = s.path().subsegment(0.0..near.t).arclen(ARC_LENGTH_ACCURACY_MM);
                best = (self.lengths_mm[i] + part, near.distance_sq);
            }
        }
        (best.0, best.1.sqrt())
    }

    /// Segment and its parameter at an arc length.
    fn locate(&self, s_mm: f64) -> (usize, f64) {
        let total = self.length_mm();
        let s = if self.closed { s_mm.rem_euclid(total) } else { s_mm.clamp(0.0, total) };
        let i = self.lengths_mm.partition_point(|&l| l <= s).clamp(1, self.segments.len()) - 1;
        let local = s - self.lengths_mm[i];
        let whole = self.lengths_mm[i + 1] - self.lengths_mm[i];
        if local >= whole {
            return (i, 1.0);
        }
        (i, self.segments[i].path().inv_arclen(local, ARC_LENGTH_ACCURACY_MM))
    }
}

/// Derivatives by chord length that make a cubic spline's second derivative continuous: `h₁ m₀ + 2 (h₀ + h₁) m₁ + h₀ m₂ =
/// 3 (h₁ d₀ + h₀ d₁)` at every inner point, d the slope of the chord. Diagonally dominant: a sweep of Gauss and Seidel leaves a
/// quarter of the error or less.
fn spline_slopes(points: &[DVec2], ends: [DVec2; 2]) -> Vec<DVec2> {
    const SWEEPS: usize = 40;
    let last = points.len().saturating_sub(1);
    let closed = last > 1 && points[0] == points[last];
    let chord = |k: usize| points[(k + 1).min(last)] - points[k.min(last)];
    let mut slopes = vec![DVec2::ZERO; points.len()];
    if let [first, .., end] = slopes.as_mut_slice() {
        (*first, *end) = (ends[0].normalize_or_zero(), ends[1].normalize_or_zero());
    }
    for _ in 0..SWEEPS {
        for k in usize::from(!closed)..last {
            let before = if k == 0 { last - 1 } else { k - 1 };
            let (a, b) = (chord(before), chord(k));
            let (p, q) = (a.length(), b.length());
            let wanted = 3.0 * (q * (a / p) + p * (b / q)) - q * slopes[before] - p * slopes[k + 1];
            slopes[k] = wanted / (2.0 * (p + q));
            if closed && k == 0 {
                slopes[last] = slopes[0];
            }
        }
    }
    slopes
}

fn tangent_of(segment: &Segment, t: f64) -> DVec2 {
    match segment.path() {
        PathSeg::Cubic(c) => {
            let d = vector(c.deriv().eval(t));
            // A control point on its end leaves no derivative there: the chord's direction is the limit.
            d.try_normalize().unwrap_or_else(|| {
                let step = 1e-4;
                (vector(c.eval((t + step).min(1.0))) - vector(c.eval((t - step).max(0.0))))
                    .normalize_or_zero()
            })
        }
        _ => (segment.to() - segment.from()).normalize_or_zero(),
    }
}

fn point(p: DVec2) -> Point {
    Point::new(p.x, p.y)
}

fn vector(p: Point) -> DVec2 {
    DVec2::new(p.x, p.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quarter circle of radius 100 by the usual cubic (radial error 2.7e-4 of the radius).
    fn quarter() -> PlanarCurve {
        let k = 0.5522847498 * 100.0;
        let (a, b) = (DVec2::new(100.0, 0.0), DVec2::new(0.0, 100.0));
        PlanarCurve::new(vec![Segment::Cubic {
            from: a,
            c1: DVec2::new(100.0, k),
            c2: DVec2::new(k, 100.0),
            to: b,
        }])
        .unwrap()
    }

    #[test]
    fn quarter_circle_has_its_length_curvature_and_tangent() {
        let c = quarter();
        let arc = std::f64::consts::FRAC_PI_2 * 100.0;
        assert!((c.length_mm() - arc).abs() < 0.03);
        // The usual cubic quarter is off by up to 1.9 % in curvature.
        assert!((c.curvature(0.3 * arc) - 0.01).abs() < 2e-4);
        let t = c.tangent(0.5 * c.length_mm());
        assert!((t - DVec2::new(-1.0, 1.0).normalize()).length() < 1e-9);
    }

    #[test]
    fn flattening_keeps_the_chord_error() {
        let c = quarter();
        let chord = 0.01;
        let points = c.flatten(chord);
        for w in points.windows(2) {
            let (_, d) = c.nearest((w[0] + w[1]) * 0.5);
            assert!(d <= chord, "{d}");
        }
        assert!(points.len() < 80, "no more points than the bound asks for");
    }

    #[test]
    fn points_by_arc_length_are_evenly_spaced() {
        let c = quarter();
        let n = 50;
        let p: Vec<_> = (0..=n).map(|k| c.point(c.length_mm() * k as f64 / n as f64)).collect();
        let steps: Vec<_> = p.windows(2).map(|w| w[0].distance(w[1])).collect();
        let (lo, hi) = steps.iter().fold((f64::MAX, 0.0_f64), |(l, h), &s| (l.min(s), h.max(s)));
        assert!(hi - lo < 1e-4 * hi);
    }

    #[test]
    fn nearest_returns_the_arc_length_it_was_made_from() {
        let c = quarter();
        let s = 61.5;
        let normal = c.tangent(s).perp();
        let (found, d) = c.nearest(c.point(s) + 7.0 * normal);
        assert!((found - s).abs() < 1e-3 && (d - 7.0).abs() < 1e-6);
    }

    #[test]
    fn parts_add_up_and_lie_on_the_curve() {
        let ring = PlanarCurve::new(vec![
            quarter().segments()[0],
            Segment::Line { from: DVec2::new(0.0, 100.0), to: DVec2::new(100.0, 0.0) },
        ])
        .unwrap();
        let total = ring.length_mm();
        for (from, to) in [(10.0, 90.0), (120.0, 250.0), (200.0, 30.0), (40.0, 40.0)] {
            let part = ring.part(from, to).unwrap();
            let length = if to > from { to - from } else { total - from + to };
            assert!((part.length_mm() - length).abs() < 1e-6, "{from} {to}: {}", part.length_mm());
            for k in 0..=10 {
                let s = 0.1 * f64::from(k) * length;
                assert!(part.point(s).distance(ring.point(from + s)) < 1e-6, "{from} {to} at {s}");
            }
        }
        assert_eq!(ring.part(0.0, total).unwrap(), ring, "whole segments stay what they are");
        assert_eq!(quarter().part(50.0, 50.0), Err(CurveError::Empty));
    }

    #[test]
    fn a_spline_has_continuous_curvature_and_tends_to_its_curve_with_the_fourth_power() {
        let at = |t: f64| DVec2::new(100.0 * t, 30.0 * (2.0 * t).sin());
        let along = |t: f64| DVec2::new(100.0, 60.0 * (2.0 * t).cos());
        let error = |n: usize| {
            let points: Vec<_> = (0..=n).map(|k| at(3.0 * k as f64 / n as f64)).collect();
            let spline = PlanarCurve::spline(&points, [along(0.0), along(3.0)]).unwrap();
            for joint in &spline.joints_mm()[1..n] {
                let jump = spline.curvature(joint + 1e-6) - spline.curvature(joint - 1e-6);
                assert!(jump.abs() < 1e-6, "{jump}");
            }
            let off = |k: i32| spline.nearest(at(3.0 * f64::from(k) / 997.0)).1;
            (0..997).map(off).fold(0.0, f64::max)
        };
        assert!((error(20) / error(40)).log2() > 3.5, "{} {}", error(20), error(40));
    }

    #[test]
    fn a_closed_spline_is_smooth_where_it_begins() {
        let mut ring: Vec<_> =
            (0..24).map(|k| 80.0 * DVec2::from_angle(f64::from(k) * 0.261_799_387_8)).collect();
        ring.push(ring[0]);
        let spline = PlanarCurve::spline(&ring, [DVec2::ZERO; 2]).unwrap();
        assert!(spline.is_closed() && (spline.length_mm() - 160.0 * std::f64::consts::PI).abs() < 0.01);
        let total = spline.length_mm();
        assert!((spline.curvature(1e-6) - spline.curvature(total - 1e-6)).abs() < 1e-6);
    }

    #[test]
    fn a_square_is_closed_and_has_its_signed_area() {
        let p = [(0., 0.), (10., 0.), (10., 10.), (0., 10.), (0., 0.)].map(|(x, y)| DVec2::new(x, y));
        let c = PlanarCurve::polyline(&p).unwrap();
        assert!(c.is_closed());
        assert_eq!(c.signed_area_mm2(), 100.0);
        assert_eq!(c.reversed().signed_area_mm2(), -100.0);
        assert!((c.point(45.0) - DVec2::new(5.0, 0.0)).length() < 1e-9, "wraps");
    }

    #[test]
    fn bad_curves_are_refused() {
        let nan = PlanarCurve::polyline(&[DVec2::ZERO, DVec2::new(f64::NAN, 0.0)]);
        assert_eq!(nan, Err(CurveError::NotFinite { segment: 0 }));
        assert_eq!(PlanarCurve::polyline(&[DVec2::ONE, DVec2::ONE]), Err(CurveError::Empty));
        let gap = vec![
            Segment::Line { from: DVec2::ZERO, to: DVec2::X },
            Segment::Line { from: DVec2::Y, to: DVec2::ONE },
        ];
        assert_eq!(PlanarCurve::new(gap), Err(CurveError::Gap { segment: 1, at: DVec2::Y }));
    }
}
