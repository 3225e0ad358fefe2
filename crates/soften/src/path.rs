//! One straight or cubic piece of a crease by its parameter: point, normal, curvature, arc length.

use kurbo::{
    CubicBez, Line, ParamCurve, ParamCurveArclen, ParamCurveArea, ParamCurveNearest, PathSeg, Point,
};
use softfold_geometry::{DVec2, Segment};

/// Accuracy of arc lengths, mm: that of [`softfold_geometry::PlanarCurve`].
const ARC_LENGTH_ACCURACY_MM: f64 = 1e-9;

/// A straight piece or a cubic Bézier, by a parameter from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Path {
    Line([DVec2; 2]),
    Cubic([DVec2; 4]),
}

impl From<&Segment> for Path {
    fn from(segment: &Segment) -> Self {
        match *segment {
            Segment::Line { from, to } => Self::Line([from, to]),
            Segment::Cubic { from, c1, c2, to } => Self::Cubic([from, c1, c2, to]),
        }
    }
}

impl Path {
    /// The point at a parameter; the ends exactly.
    pub(crate) fn point(&self, t: f64) -> DVec2 {
        match *self {
            Self::Line([a, _]) | Self::Cubic([a, ..]) if t == 0.0 => a,
            Self::Line([_, b]) | Self::Cubic([.., b]) if t == 1.0 => b,
            Self::Line([a, b]) => a.lerp(b, t),
            Self::Cubic([a, b, c, d]) => {
                let u = 1.0 - t;
                u * u * u * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * d
            }
        }
    }

    /// Left unit normal; where a control point lies on its end, the limit from inside.
    pub(crate) fn normal(&self, t: f64) -> DVec2 {
        let towards_middle = if t < 0.5 { 1.0 } else { -1.0 };
        let limit = || (self.second(t) * towards_middle).normalize_or_zero();
        self.first(t).try_normalize().unwrap_or_else(limit).perp()
    }

    /// Signed curvature, 1/mm, positive to the left.
    pub(crate) fn curvature(&self, t: f64) -> f64 {
        let (d, dd) = (self.first(t), self.second(t));
        let speed = d.length();
        if speed > 0.0 { d.perp_dot(dd) / (speed * speed * speed) } else { 0.0 }
    }

    pub(crate) fn is_line(&self) -> bool {
        matches!(self, Self::Line(_))
    }

    /// Arc length from one parameter to another, mm; negative if the second comes first.
    pub(crate) fn arc_mm(&self, [t0, t1]: [f64; 2]) -> f64 {
        match *self {
            Self::Cubic(_) if t1 < t0 => -self.arc_mm([t1, t0]),
            Self::Line([a, b]) => (t1 - t0) * a.distance(b),
            Self::Cubic(_) => self.kurbo().subsegment(t0..t1).arclen(ARC_LENGTH_ACCURACY_MM),
        }
    }

    /// The parameter at an arc length from the start, mm.
    pub(crate) fn parameter(&self, arc_mm: f64) -> f64 {
        self.kurbo().inv_arclen(arc_mm, ARC_LENGTH_ACCURACY_MM)
    }

    /// Parameter and distance of the nearest point.
    pub(crate) fn nearest(&self, p: DVec2) -> (f64, f64) {
        let near = self.kurbo().nearest(Point::new(p.x, p.y), ARC_LENGTH_ACCURACY_MM);
        (near.t, near.distance_sq.sqrt())
    }

    /// Area that the piece from one parameter to another sweeps as seen from a point, mm²:
    /// `½∫(p − origin) × dp`.
    pub(crate) fn swept_mm2(&self, [t0, t1]: [f64; 2], origin: DVec2) -> f64 {
        let moved = match *self {
            Self::Line(p) => Self::Line(p.map(|p| p - origin)),
            Self::Cubic(p) => Self::Cubic(p.map(|p| p - origin)),
        };
        moved.kurbo().subsegment(t0..t1).signed_area()
    }

    /// Pieces of equal parameter that keep the chord error of linear interpolation, `|B''|/(8 n²)`.
    pub(crate) fn pieces(&self, chord_mm: f64, most: usize) -> usize {
        match *self {
            Self::Line(_) => 1,
            Self::Cubic([a, b, c, d]) => {
                let second = 6.0 * (a - 2.0 * b + c).length().max((b - 2.0 * c + d).length());
                ((second / (8.0 * chord_mm)).sqrt().ceil() as usize).clamp(1, most)
            }
        }
    }

    fn first(&self, t: f64) -> DVec2 {
        match *self {
            Self::Line([a, b]) => b - a,
            Self::Cubic([a, b, c, d]) => {
                let u = 1.0 - t;
                3.0 * (u * u * (b - a) + 2.0 * u * t * (c - b) + t * t * (d - c))
            }
        }
    }

    fn second(&self, t: f64) -> DVec2 {
        match *self {
            Self::Line(_) => DVec2::ZERO,
            Self::Cubic([a, b, c, d]) => 6.0 * ((1.0 - t) * (a - 2.0 * b + c) + t * (b - 2.0 * c + d)),
        }
    }

    fn kurbo(&self) -> PathSeg {
        let p = |v: DVec2| Point::new(v.x, v.y);
        match *self {
            Self::Line([a, b]) => PathSeg::Line(Line::new(p(a), p(b))),
            Self::Cubic([a, b, c, d]) => PathSeg::Cubic(CubicBez::new(p(a), p(b), p(c), p(d))),
        }
    }
}
