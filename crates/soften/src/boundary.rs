//! The outline, the holes and the slits, to be crossed by fold lines.

use crate::path::Path;
use crate::spine::Spine;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use softfold_geometry::{CreasePattern, DVec2, LoopId, OutlinePoint, PlanarCurve, polygon};

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
pub(crate) struct Side {
    pub(crate) ends: [DVec2; 2],
    pub(crate) loop_id: LoopId,
    segment: usize,
    /// Parameters of the ends on the segment.
    t: [f64; 2],
}

/// The boundary of a sheet.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    curves: Vec<PlanarCurve>,
    /// Outline and holes come first.
    loops: usize,
    sides: RTree<Side>,
    high_x: f64,
    size_mm: f64,
}

/// A fold line's crossing with the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Piece of the polyline plus share of the piece.
    pub(crate) place: f64,
    side: Side,
}

/// Where a fold line meets the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    pub(crate) point: DVec2,
    /// Arc length of the foot on the crease, mm.
    pub(crate) s_mm: f64,
    pub(crate) on: OutlinePoint,
}

impl RTreeObject for Side {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.ends[0].to_array(), self.ends[1].to_array())
    }
}

impl PointDistance for Side {
    fn distance_2(&self, p: &[f64; 2]) -> f64 {
        polygon::segment_distance(DVec2::from_array(*p), self.ends[0], self.ends[1]).powi(2)
    }
}

impl Boundary {
    /// The boundary, with sides within `chord_mm` of it.
    pub(crate) fn new(pattern: &CreasePattern, chord_mm: f64) -> Self {
        let curves: Vec<PlanarCurve> = pattern.boundaries().map(|(_, c)| c.clone()).collect();
        let sides: Vec<Side> =
            curves.iter().enumerate().flat_map(|(i, c)| sides_of(LoopId::new(i), c, chord_mm)).collect();
        let high_x = sides.iter().map(|s| s.ends[0].x.max(s.ends[1].x)).fold(f64::MIN, f64::max);
        let loops = 1 + pattern.holes.len();
        Self { curves, loops, sides: RTree::bulk_load(sides), high_x, size_mm: pattern.size_mm() }
    }

    /// Larger side of the sheet's box, mm.
    pub(crate) fn size_mm(&self) -> f64 {
        self.size_mm
    }

    /// A boundary curve.
    pub(crate) fn curve(&self, id: LoopId) -> &PlanarCurve {
        &self.curves[id.index()]
    }

    /// Whether a point is on the sheet: a ray to the right crosses outline and holes an odd number of times.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        let ray = AABB::from_corners(p.to_array(), [self.high_x.max(p.x) + 1.0, p.y]);
        let crosses = |s: &&Side| {
            let [a, b] = s.ends;
            let level = (a.y > p.y) != (b.y > p.y);
            s.loop_id.index() < self.loops && level && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.sides.locate_in_envelope_intersecting(ray).filter(crosses).count() % 2 == 1
    }

    /// Sides whose box meets that of some points.
    pub(crate) fn sides_near(&self, points: &[DVec2]) -> impl Iterator<Item = &Side> + '_ {
        let (low, high) = polygon::bounds(points);
        self.sides.locate_in_envelope_intersecting(AABB::from_corners(low.to_array(), high.to_array()))
    }

    /// The curves that pass within a distance of a point.
    pub(crate) fn curves_at(&self, p: DVec2, within_mm: f64) -> Vec<LoopId> {
        let near = self.sides.locate_within_distance(p.to_array(), within_mm * within_mm);
        let mut ids: Vec<LoopId> = near.map(|s| s.loop_id).collect();
        ids.sort();
        ids.dedup();
        ids
    }

    /// The nearest point of the boundary, and its distance.
    pub(crate) fn nearest(&self, p: DVec2) -> (OutlinePoint, f64) {
        let Some(side) = self.sides.nearest_neighbor(p.to_array()) else {
            return (OutlinePoint { loop_id: LoopId(0), s_mm: 0.0 }, f64::INFINITY);
        };
        let (t, distance) = self.path(side).nearest(p);
        (self.outline_point(side, t), distance)
    }

    /// Crossings of a polyline with the boundary, in order along it.
    pub(crate) fn crossings(&self, points: &[DVec2]) -> Vec<Crossing> {
        let mut found = Vec::new();
        for (k, w) in points.windows(2).enumerate() {
            for side in self.sides_near(w) {
                if let Some((t, _)) = polygon::segment_crossing(w[0], w[1], side.ends[0], side.ends[1]) {
                    found.push(Crossing { place: k as f64 + t, side: *side });
                }
            }
        }
        let key = |c: &Crossing| (c.side.loop_id, c.side.segment);
        found.sort_by(|a, b| a.place.total_cmp(&b.place).then(key(a).cmp(&key(b))));
        found
    }

    /// The exact point where a fold line meets the boundary near a crossing of their polylines, by
    /// Newton's method on both curves; the polylines' own crossing where it fails. `first` is the
    /// spine's piece at which the polyline begins.
    pub(crate) fn meet(&self, spine: &Spine<'_>, share: f64, crossing: &Crossing, first: usize) -> Meeting {
        let side = &crossing.side;
        let path = self.path(side);
        let k = (crossing.place as usize + first).min(spine.stations.len() - 2);
        let t = crossing.place + first as f64 - k as f64;
        let (start, start_s) = spine.exact(k, t, share);
        let [a, b] = side.ends;
        let on_side = ((start - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        let mut at = [t, side.t[0] + on_side * (side.t[1] - side.t[0])];
        for _ in 0..NEWTON_STEPS {
            let step = newton_step(|t| spine.exact(k, t, share).0, |t| path.point(t), at);
            let Some([dt, du]) = step else { break };
            at = [at[0] - dt, at[1] - du];
            let moved = (b - a).length() * (du / (side.t[1] - side.t[0])).abs();
            if moved < CONVERGED * self.size_mm {
                break;
            }
        }
        let u = at[1].clamp(0.0, 1.0);
        let exact = path.point(u);
        // Newton may run away where the curves are almost parallel: then the polylines decide.
        match exact.distance(start) <= (b - a).length() {
            true => Meeting {
                point: exact,
                s_mm: spine.exact(k, at[0], share).1,
                on: self.outline_point(side, u),
            },
            false => {
                let point = a.lerp(b, on_side);
                Meeting { point, s_mm: start_s, on: self.outline_point(side, path.nearest(point).0) }
            }
        }
    }

    fn path(&self, side: &Side) -> Path {
        Path::from(&self.curves[side.loop_id.index()].segments()[side.segment])
    }

    fn outline_point(&self, side: &Side, t: f64) -> OutlinePoint {
        let start = self.curve(side.loop_id).joints_mm()[side.segment];
        OutlinePoint { loop_id: side.loop_id, s_mm: start + self.path(side).arc_mm([0.0, t]) }
    }
}

fn sides_of(loop_id: LoopId, curve: &PlanarCurve, chord_mm: f64) -> Vec<Side> {
    let mut sides = Vec::new();
    for (segment, path) in curve.segments().iter().map(Path::from).enumerate() {
        let n = path.pieces(chord_mm, MOST_PIECES);
        for k in 0..n {
            let t = [k as f64 / n as f64, (k + 1) as f64 / n as f64];
            sides.push(Side { ends: t.map(|t| path.point(t)), loop_id, segment, t });
        }
    }
    sides
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
