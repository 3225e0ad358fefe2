//! What the planar graph needs of single segments: points, parts, nearest points, chords.

use kurbo::{
    CubicBez, Line, ParamCurve, ParamCurveArclen, ParamCurveArea, ParamCurveCurvature, ParamCurveDeriv,
    PathSeg, Point,
};
use softfold_geometry::{DVec2, Segment, polygon};

/// Most chords of one segment: at the usual join tolerance a quarter of a circle needs some 130.
const MAX_CHORDS: usize = 512;
/// Accuracy of lengths, as a share of the size of the segment's control polygon.
const LENGTH_ACCURACY: f64 = 1e-9;
/// Share of the control polygon's extent below which a derivative counts as none.
const NO_DERIVATIVE: f64 = 1e-12;
/// Chord error, as a share of its size, with which a cubic is searched for a loop of its own.
const LOOP_CHORD: f64 = 1e-3;
/// Newton steps towards a nearest point from a chord that is already near.
const NEAREST_STEPS: usize = 6;

/// A straight part of a segment, between two of its parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    pub(crate) range: [f64; 2],
    pub(crate) ends: [DVec2; 2],
}

pub(crate) fn path(s: &Segment) -> PathSeg {
    match *s {
        Segment::Line { from, to } => PathSeg::Line(Line::new(point(from), point(to))),
        Segment::Cubic { from, c1, c2, to } => {
            PathSeg::Cubic(CubicBez::new(point(from), point(c1), point(c2), point(to)))
        }
    }
}

fn point(p: DVec2) -> Point {
    Point::new(p.x, p.y)
}

fn vector(p: Point) -> DVec2 {
    DVec2::new(p.x, p.y)
}

/// Point at a parameter; 0 and 1 are the ends to the last bit.
pub(crate) fn at(s: &Segment, t: f64) -> DVec2 {
    match t {
        t if t <= 0.0 => s.from(),
        t if t >= 1.0 => s.to(),
        t => vector(path(s).eval(t)),
    }
}

/// First derivative by the parameter.
pub(crate) fn derivative(s: &Segment, t: f64) -> DVec2 {
    match path(s) {
        PathSeg::Cubic(c) => vector(c.deriv().eval(t)),
        _ => s.to() - s.from(),
    }
}

fn second_derivative(s: &Segment, t: f64) -> DVec2 {
    match path(s) {
        PathSeg::Cubic(c) => vector(c.deriv().deriv().eval(t)),
        _ => DVec2::ZERO,
    }
}

/// The part between two parameters, exactly on the same curve.
pub(crate) fn part(s: &Segment, [from, to]: [f64; 2]) -> Segment {
    if from <= 0.0 && to >= 1.0 {
        return *s;
    }
    match path(s).subsegment(from..to) {
        PathSeg::Cubic(c) => {
            Segment::Cubic { from: at(s, from), c1: vector(c.p1), c2: vector(c.p2), to: at(s, to) }
        }
        _ => Segment::Line { from: at(s, from), to: at(s, to) },
    }
}

/// The segment with its ends moved, its directions there kept.
pub(crate) fn with_ends(s: Segment, [start, end]: [DVec2; 2]) -> Segment {
    match s {
        Segment::Line { .. } => Segment::Line { from: start, to: end },
        Segment::Cubic { from, c1, c2, to } => {
            let moved = |c: DVec2, old: DVec2, new: DVec2| if old == new { c } else { c + (new - old) };
            Segment::Cubic { from: start, c1: moved(c1, from, start), c2: moved(c2, to, end), to: end }
        }
    }
}

/// Arc length, mm.
pub(crate) fn length(s: &Segment) -> f64 {
    match s {
        Segment::Line { from, to } => from.distance(*to),
        Segment::Cubic { .. } => path(s).arclen(LENGTH_ACCURACY * reach(s).max(f64::MIN_POSITIVE)),
    }
}

/// Signed area under the segment, seen from `origin`; adds up to the area of a closed chain.
pub(crate) fn area(s: &Segment, origin: DVec2) -> f64 {
    let shifted = match *s {
        Segment::Line { from, to } => Segment::Line { from: from - origin, to: to - origin },
        Segment::Cubic { from, c1, c2, to } => {
            Segment::Cubic { from: from - origin, c1: c1 - origin, c2: c2 - origin, to: to - origin }
        }
    };
    path(&shifted).signed_area()
}

/// Largest distance of a control point from the start.
pub(crate) fn reach(s: &Segment) -> f64 {
    s.control_points().iter().map(|c| c.distance(s.from())).fold(0.0, f64::max)
}

/// Unit direction in which the segment leaves its start (side 0) or, backwards, its end (side 1).
pub(crate) fn leaving(s: &Segment, side: usize) -> DVec2 {
    let controls = s.control_points();
    let none = NO_DERIVATIVE * reach(s);
    let away = |c: &DVec2, end: DVec2| Some(*c - end).filter(|d| d.length() > none);
    let direction = match side {
        0 => controls.iter().find_map(|c| away(c, s.from())),
        _ => controls.iter().rev().find_map(|c| away(c, s.to())),
    };
    direction.unwrap_or_default().normalize_or_zero()
}

/// Signed curvature where the segment leaves one of its ends, positive if it then turns left.
pub(crate) fn leaving_curvature(s: &Segment, side: usize) -> f64 {
    let s = if side == 0 { *s } else { s.reversed() };
    match path(&s) {
        // kurbo counts turning right as positive.
        PathSeg::Cubic(c) if derivative(&s, 0.0).length() > NO_DERIVATIVE * reach(&s) => -c.curvature(0.0),
        _ => 0.0,
    }
}

/// Chords that stay within `chord_mm` of the segment (up to [`MAX_CHORDS`]).
pub(crate) fn chords(s: &Segment, chord_mm: f64) -> impl Iterator<Item = Chord> + '_ {
    let n = match *s {
        Segment::Line { .. } => 1,
        // The bound of linear interpolation: the largest second derivative over 8 n².
        Segment::Cubic { from, c1, c2, to } => {
            let second = 6.0 * (from - 2.0 * c1 + c2).length().max((c1 - 2.0 * c2 + to).length());
            ((second / (8.0 * chord_mm)).sqrt().ceil() as usize).clamp(1, MAX_CHORDS)
        }
    };
    (0..n).map(move |k| {
        let range = [k as f64 / n as f64, (k + 1) as f64 / n as f64];
        Chord { range, ends: range.map(|t| at(s, t)) }
    })
}

/// Parameter of the point of the segment nearest to `p`, searched from a chord near it.
pub(crate) fn nearest_from(s: &Segment, chord: &Chord, p: DVec2) -> f64 {
    let [a, b] = chord.ends;
    let d = b - a;
    let share = if d == DVec2::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
    let mut t = chord.range[0] + share * (chord.range[1] - chord.range[0]);
    if matches!(s, Segment::Line { .. }) {
        return t;
    }
    for _ in 0..NEAREST_STEPS {
        let (off, first) = (at(s, t) - p, derivative(s, t));
        let slope = first.length_squared() + off.dot(second_derivative(s, t));
        if slope <= 0.0 {
            break;
        }
        t = (t - off.dot(first) / slope).clamp(0.0, 1.0);
    }
    t
}

/// Distance of `p` from the segment.
pub(crate) fn distance(s: &Segment, p: DVec2, chord_mm: f64) -> f64 {
    let to = |c: &Chord| polygon::segment_distance(p, c.ends[0], c.ends[1]);
    let near = chords(s, chord_mm).min_by(|a, b| to(a).total_cmp(&to(b)));
    near.map_or(f64::INFINITY, |c| at(s, nearest_from(s, &c, p)).distance(p))
}

/// Parameter at which a cubic should be cut so that no part crosses itself; none if it does not.
pub(crate) fn self_crossing_cut(s: &Segment) -> Option<f64> {
    let Segment::Cubic { from, c1, c2, to } = *s else { return None };
    // A loop turns by more than half a turn, so its outer control legs must cross.
    let turn = |a: DVec2, b: DVec2| a.angle_to(b);
    let turned = turn(c1 - from, c2 - c1) + turn(c2 - c1, to - c2);
    // Not a number where a leg has no length.
    if turned.is_nan() || turned.abs() <= std::f64::consts::PI {
        return None;
    }
    let chords: Vec<Chord> = chords(s, LOOP_CHORD * reach(s)).collect();
    for (i, a) in chords.iter().enumerate() {
        for b in chords.iter().skip(i + 2) {
            let [[a0, a1], [b0, b1]] = [a.ends, b.ends];
            let crossing = polygon::segment_crossing(a0, a1, b0, b1);
            // A closed segment meets itself at its ends: that is no loop inside.
            if crossing.is_some() && !(i == 0 && b.range[1] == 1.0 && a0 == b1) {
                return Some(0.5 * (a.range[1] + b.range[0]));
            }
        }
    }
    None
}

/// A cubic that is straight, as a line.
pub(crate) fn straightened(s: Segment, within_mm: f64) -> Segment {
    let Segment::Cubic { from, c1, c2, to } = s else { return s };
    let chord = to - from;
    let along = |c: DVec2| (c - from).dot(chord) / chord.length_squared();
    let off = |c: DVec2| ((c - from).perp_dot(chord) / chord.length()).abs();
    let monotone = 0.0 <= along(c1) && along(c1) <= along(c2) && along(c2) <= 1.0;
    if chord != DVec2::ZERO && monotone && off(c1) <= within_mm && off(c2) <= within_mm {
        return Segment::Line { from, to };
    }
    s
}
