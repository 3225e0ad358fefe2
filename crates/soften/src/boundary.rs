//! The outline and the holes, to be crossed by fold lines.

use crate::spine::{Cubic, Spine};
use softfold_geometry::{CreasePattern, DVec2, LoopId, OutlinePoint, PlanarCurve, Segment, polygon};

/// Pieces into which a segment is cut at most.
const MOST_PIECES: usize = 4096;
/// Steps of Newton's method; it doubles the digits at each, and starts with three or more.
const NEWTON_STEPS: usize = 20;
/// Step of the difference quotients, in shares of a piece: the root of the rounding error.
const DIFFERENCE: f64 = 1e-7;
/// A crossing is found when it moves by less than this share of the sheet.
const CONVERGED: f64 = 1e-14;

/// A straight piece that stands for part of the boundary.
#[derive(Clone, Copy, Debug)]
struct Side {
    ends: [DVec2; 2],
    loop_id: LoopId,
    segment: Segment,
    /// Parameters of the ends on the segment.
    t: [f64; 2],
}

/// The boundary of a sheet.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    loops: Vec<PlanarCurve>,
    polygons: Vec<Vec<DVec2>>,
    sides: Vec<Side>,
    size_mm: f64,
}

/// A fold line's crossing with the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Piece of the spine plus share of the piece.
    pub(crate) place: f64,
    side: usize,
}

impl Boundary {
    /// The boundary, with sides within `chord_mm` of it.
    pub(crate) fn new(pattern: &CreasePattern, chord_mm: f64) -> Self {
        let loops: Vec<PlanarCurve> = pattern.loops().map(|(_, c)| c.clone()).collect();
        let sides: Vec<Side> =
            loops.iter().enumerate().flat_map(|(i, c)| sides_of(LoopId::new(i), c, chord_mm)).collect();
        let corners =
            |i: usize| sides.iter().filter(|s| s.loop_id.index() == i).map(|s| s.ends[0]).collect::<Vec<_>>();
        let polygons = (0..loops.len()).map(corners).collect();
        Self { loops, polygons, sides, size_mm: pattern.size_mm() }
    }

    /// Larger side of the sheet's box, mm.
    pub(crate) fn size_mm(&self) -> f64 {
        self.size_mm
    }

    /// Whether a point is on the sheet.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        polygon::contains(&self.polygons[0], p)
            && !self.polygons[1..].iter().any(|hole| polygon::contains(hole, p))
    }

    /// Corners of the sides, with the curve that they are on.
    pub(crate) fn corners(&self) -> impl Iterator<Item = (LoopId, DVec2)> + '_ {
        self.sides.iter().map(|s| (s.loop_id, s.ends[0]))
    }

    /// Length of a boundary curve, mm.
    pub(crate) fn length_mm(&self, id: LoopId) -> f64 {
        self.loops[id.index()].length_mm()
    }

    /// The nearest point of the boundary, and its distance.
    pub(crate) fn nearest(&self, p: DVec2) -> (OutlinePoint, f64) {
        let mut best = (OutlinePoint { loop_id: LoopId(0), s_mm: 0.0 }, f64::INFINITY);
        for (i, curve) in self.loops.iter().enumerate() {
            let (s_mm, d) = curve.nearest(p);
            if d < best.1 {
                best = (OutlinePoint { loop_id: LoopId::new(i), s_mm }, d);
            }
        }
        best
    }

    /// Arc length of a point on a boundary curve.
    pub(crate) fn arc_length(&self, id: LoopId, p: DVec2) -> f64 {
        self.loops[id.index()].nearest(p).0
    }

    /// Crossings of a polyline with the boundary, in order along it.
    pub(crate) fn crossings(&self, points: &[DVec2]) -> Vec<Crossing> {
        let mut found = Vec::new();
        for (k, w) in points.windows(2).enumerate() {
            let (low, high) = (w[0].min(w[1]), w[0].max(w[1]));
            for (i, side) in self.sides.iter().enumerate() {
                let [a, b] = side.ends;
                let apart = a.max(b).cmplt(low).any() || a.min(b).cmpgt(high).any();
                if apart {
                    continue;
                }
                if let Some((t, _)) = polygon::segment_crossing(w[0], w[1], a, b) {
                    found.push(Crossing { place: k as f64 + t, side: i });
                }
            }
        }
        found.sort_by(|a, b| a.place.total_cmp(&b.place));
        found
    }

    /// The exact point where a parallel of the spine meets the boundary near a crossing of their
    /// polylines, by Newton's method on both curves; the polylines' own crossing where it fails.
    pub(crate) fn meet(&self, spine: &Spine, offset_mm: f64, crossing: Crossing) -> (DVec2, OutlinePoint) {
        let side = &self.sides[crossing.side];
        let k = (crossing.place as usize).min(spine.pieces() - 1);
        let start = spine.parallel(k, crossing.place - k as f64, offset_mm);
        let [a, b] = side.ends;
        let share = ((start - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        let mut at = [crossing.place - k as f64, side.t[0] + share * (side.t[1] - side.t[0])];
        for _ in 0..NEWTON_STEPS {
            let step = newton_step(|t| spine.parallel(k, t, offset_mm), |t| point_on(&side.segment, t), at);
            let Some([dt, du]) = step else { break };
            at = [at[0] - dt, at[1] - du];
            let moved = (b - a).length() * (du / (side.t[1] - side.t[0])).abs();
            if moved < CONVERGED * self.size_mm {
                break;
            }
        }
        let exact = point_on(&side.segment, at[1].clamp(0.0, 1.0));
        // Newton may run away where the curves are almost parallel: then the polylines decide.
        let point = if exact.distance(start) <= (b - a).length() { exact } else { a.lerp(b, share) };
        let s_mm = self.arc_length(side.loop_id, point);
        (point, OutlinePoint { loop_id: side.loop_id, s_mm })
    }

    /// Whether an arc from `a` to `b` over `through` on one curve has the point at `s_mm` on it,
    /// within `slack_mm`.
    pub(crate) fn arc_has(&self, id: LoopId, [a, through, b]: [f64; 3], s_mm: f64, slack_mm: f64) -> bool {
        let whole = self.length_mm(id);
        let way = |from: f64, to: f64| (to - from).rem_euclid(whole);
        let (from, length) = if way(a, through) <= way(a, b) { (a, way(a, b)) } else { (b, way(b, a)) };
        way(from - slack_mm, s_mm) <= length + 2.0 * slack_mm
    }
}

fn sides_of(loop_id: LoopId, curve: &PlanarCurve, chord_mm: f64) -> Vec<Side> {
    let mut sides = Vec::new();
    for &segment in curve.segments() {
        let n = pieces(&segment, chord_mm);
        for k in 0..n {
            let t = [k as f64 / n as f64, (k + 1) as f64 / n as f64];
            sides.push(Side { ends: t.map(|t| point_on(&segment, t)), loop_id, segment, t });
        }
    }
    sides
}

/// Pieces that keep the chord error of linear interpolation, `|B''|/(8 n²)`.
fn pieces(segment: &Segment, chord_mm: f64) -> usize {
    match *segment {
        Segment::Line { .. } => 1,
        Segment::Cubic { from, c1, c2, to } => {
            let second = 6.0 * (from - 2.0 * c1 + c2).length().max((c1 - 2.0 * c2 + to).length());
            ((second / (8.0 * chord_mm)).sqrt().ceil() as usize).clamp(1, MOST_PIECES)
        }
    }
}

fn point_on(segment: &Segment, t: f64) -> DVec2 {
    match *segment {
        Segment::Line { from, to } => from.lerp(to, t),
        Segment::Cubic { from, c1, c2, to } => Cubic([from, c1, c2, to]).point(t),
    }
}

/// One step towards `f(t) = g(u)`; none where the curves are parallel.
fn newton_step(f: impl Fn(f64) -> DVec2, g: impl Fn(f64) -> DVec2, [t, u]: [f64; 2]) -> Option<[f64; 2]> {
    let e = DIFFERENCE;
    let df = (f(t + e) - f(t - e)) / (2.0 * e);
    let dg = (g(u + e) - g(u - e)) / (2.0 * e);
    let rest = f(t) - g(u);
    let det = df.perp_dot(-dg);
    let step = [rest.perp_dot(-dg) / det, df.perp_dot(rest) / det];
    step.iter().all(|x| x.is_finite()).then_some(step)
}
