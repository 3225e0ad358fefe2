//! Small angles are refined away: a point in the middle of the free space beside a bad triangle, or, where a constraint
//! is in the way, a point on the constraint's own curve.
//!
//! J. Ruppert, *A Delaunay refinement algorithm for quality 2-dimensional mesh generation* (1995), with the off-centres
//! of A. Üngör (2004). Constraints at acute corners are split at powers of two from the corner, and triangles between
//! such points are left (Miller, Pav, Walkington 2003). Unlike there, splits follow curves instead of chords, and points
//! move first: most angles mend without a new point.

use crate::draft::Draft;
use crate::grow::left_of_line;
use crate::net::NONE;
use crate::quality::median;
use crate::settle::{Aim, Settling};
use crate::triangle::{least_tangent, shortest};
use glam::DVec2;
use softfold_geometry::VertexId;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Every triangle shall have this angle, degrees: a little more than is promised, so that a bad one does not stop at it.
const GOAL_DEG: f64 = 22.0;
/// This much is held also between equally distant points beside an acute corner.
pub(crate) const BAR_DEG: f64 = 20.0;
/// New points ask for more moves, and moves for more points: so often.
const PASSES: usize = 4;
/// Moves for the sake of the least angle: at angles below this, degrees, and how often at a time.
const SETTLE_DEG: f64 = 30.0;
const SETTLINGS: usize = 3;
/// Moves for the sake of the many triangles: at angles below this, degrees, so often as long as it helps.
const POLISH_DEG: f64 = 55.0;
const POLISHES: usize = 12;
/// No angle gets smaller than this by them, degrees. A mesh of the median beside it needs none, and one that ends below the
/// second median may have angles a little less kept for its sake.
const KEPT_DEG: [f64; 2] = [32.0, 24.0];
const MEDIAN_DEG: [f64; 2] = [50.0, 45.1];
/// No edge is split, and no point set, nearer than this share of the distance at which curves all but touch, or of the
/// narrowest row.
const FLOOR: f64 = 0.25;
/// A wall is split nearer to its middle than this share of its length from the ends.
const MARGIN: f64 = 0.2;
/// What is added for the sake of a triangle may leave it as it is: so often it is seen to again.
const MOST_TRIES: u32 = 6;
/// Points beyond those that came, as a share of them, and some more: a defect would add points for ever.
const MOST_NEW: f64 = 3.0;
const SOME_NEW: usize = 4000;

/// Moves points and adds some until no triangle has an angle below 20° that the pattern does not have itself.
pub(crate) fn refine(draft: &mut Draft<'_>, shortest_row_mm: f64) {
    let most = draft.points().len() + (MOST_NEW * draft.points().len() as f64) as usize + SOME_NEW;
    let floor_mm = FLOOR * draft.sharp.near_mm.min(shortest_row_mm);
    let mut refiner = Refiner { draft, floor_mm, bad: BinaryHeap::new(), changed: vec![] };
    let mut settling = Settling::default();
    for _ in 0..PASSES {
        refiner.polish(&mut settling, KEPT_DEG[0], MEDIAN_DEG[0]);
        for _ in 0..SETTLINGS {
            if settling.round(refiner.draft, SETTLE_DEG, Aim::Least) == 0 {
                break;
            }
        }
        if refiner.insert(most) == 0 {
            break;
        }
    }
    refiner.polish(&mut settling, KEPT_DEG[1], MEDIAN_DEG[1]);
}

/// A triangle by its tangent, as bits that order like it, and its corners: it is out of date once these have changed. Last
/// how often it has been seen to.
type Bad = (Reverse<u64>, u32, [u32; 3], u32);

struct Refiner<'d, 'a> {
    draft: &'d mut Draft<'a>,
    floor_mm: f64,
    /// Worst on top.
    bad: BinaryHeap<Bad>,
    /// Triangles that changed since they were looked at.
    changed: Vec<u32>,
}

impl Refiner<'_, '_> {
    /// Moves points for the sake of the many triangles until the median is good, or nothing moves.
    fn polish(&mut self, settling: &mut Settling, kept_deg: f64, median_deg: f64) {
        for _ in 0..POLISHES {
            let is_good = self.median_tangent() >= median_deg.to_radians().tan();
            if is_good || settling.round(self.draft, POLISH_DEG, Aim::Mean { kept_deg }) == 0 {
                break;
            }
        }
    }

    /// Median over the triangles of the tangent of their smallest angle.
    fn median_tangent(&self) -> f64 {
        let count = self.draft.net.corners.len();
        let mut all: Vec<f64> = (0..count).map(|t| least_tangent(self.draft.places(t))).collect();
        median(&mut all).unwrap_or(0.0)
    }

    /// Adds points until no triangle asks for more, or `most` points are there; how many were added.
    fn insert(&mut self, most: usize) -> usize {
        let before = self.draft.points().len();
        self.straighten(most);
        self.changed.clear();
        (0..self.draft.net.corners.len() as u32).for_each(|t| self.note(t));
        while let Some((Reverse(bits), number, corners, tries)) = self.bad.pop() {
            let t = number as usize;
            let tangent = least_tangent(self.draft.places(t));
            if self.draft.net.corners[t] != corners || tangent.to_bits() != bits {
                continue;
            }
            if self.draft.points().len() > most {
                break;
            }
            if !self.is_left(t, tangent) {
                self.cure(t);
                // What was added may lie beyond a neighbour, and the triangle be as it was.
                if !self.changed.is_empty() && self.draft.net.corners[t] == corners && tries < MOST_TRIES {
                    self.bad.push((Reverse(bits), number, corners, tries + 1));
                }
                self.look();
            }
        }
        self.bad.clear();
        self.draft.points().len() - before
    }

    /// Notes the bad ones among the triangles that changed.
    fn look(&mut self) {
        while let Some(t) = self.changed.pop() {
            self.note(t);
        }
    }

    /// Notes a triangle if it is bad.
    fn note(&mut self, t: u32) {
        let tangent = least_tangent(self.draft.places(t as usize));
        if tangent < GOAL_DEG.to_radians().tan() {
            self.bad.push((Reverse(tangent.max(0.0).to_bits()), t, self.draft.net.corners[t as usize], 0));
        }
    }

    /// Splits constraints that are too far from their curves.
    fn straighten(&mut self, most: usize) {
        let sides = |t: u32| [0, 1, 2].map(|k| (t, k));
        let is_wall = |&(t, k): &(u32, usize)| self.draft.net.walls[t as usize][k] != NONE;
        let all = (0..self.draft.net.corners.len() as u32).flat_map(sides);
        let mut open: Vec<(u32, usize)> = all.filter(is_wall).collect();
        while let Some((t, k)) = open.pop() {
            let (t, wall) = (t as usize, self.draft.net.walls[t as usize][k]);
            if wall == NONE || self.draft.points().len() > most {
                continue;
            }
            let planar = &self.draft.planar;
            let (edge, span) = (planar.graph.constraints[wall as usize].0, planar.spans[wall as usize]);
            let ends = edge.map(|v| planar.graph.points[v.index()]);
            let (error, at) = planar.tracks[span.track as usize].chord_error_mm(&span, ends);
            if error > self.draft.chord_mm {
                let margin = MARGIN * span.length_mm();
                let at = at.clamp(span.from_mm + margin, span.to_mm - margin);
                let first = self.changed.len();
                self.split_at([t, k], at);
                open.extend(self.changed[first..].iter().flat_map(|&t| sides(t)));
            }
        }
    }

    /// Whether a triangle stays as it is.
    fn is_left(&self, t: usize, tangent: f64) -> bool {
        self.draft.is_excused(t) || (tangent >= BAR_DEG.to_radians().tan() && self.is_seditious(t))
    }

    /// Whether the shortest side joins points on both sides of an acute corner, equally far from it.
    fn is_seditious(&self, t: usize) -> bool {
        let (p, draft) = (self.draft.places(t), &self.draft);
        let k = shortest(p);
        let [u, v] = [0, 1].map(|i| VertexId(draft.net.corners[t][(k + i) % 3]));
        let track = |v: VertexId| Some(draft.planar.spans[*draft.sharp.at(v).first()? as usize].track);
        let (Some(a), Some(b)) = (track(u), track(v)) else { return false };
        let alike = |at: DVec2| {
            let [r, s] = [p[k].distance(at), p[(k + 1) % 3].distance(at)];
            (r - s).abs() < 0.1 * r
        };
        draft.sharp.acute_between([a, b]).any(|c| alike(draft.points()[c.vertex.index()]))
    }

    fn cure(&mut self, t: usize) {
        let p = self.draft.places(t);
        let Some(wanted) = off_centre(p) else { return };
        let (mut here, from, mut entered) = (t, (p[0] + p[1] + p[2]) / 3.0, NONE);
        // A walk through a triangulation visits no triangle twice.
        for _ in 0..self.draft.net.corners.len() {
            let Some(k) = self.way_out(here, entered, from, wanted) else { break };
            let (next, wall) = self.draft.net.side(here, k);
            if wall != NONE {
                return self.split([here, k]);
            }
            if next == NONE {
                return;
            }
            entered = here as u32;
            here = next as usize;
        }
        match self.encroached(here, wanted) {
            Some(side) => self.split(side),
            None => self.set(here, wanted),
        }
    }

    /// The side through which the line towards a point leaves a triangle; none if the point is in it.
    fn way_out(&self, t: usize, entered: u32, from: DVec2, to: DVec2) -> Option<usize> {
        let p = self.draft.places(t);
        (0..3).find(|&k| {
            let (a, b) = (p[k], p[(k + 1) % 3]);
            let came = entered != NONE && self.draft.net.across[t][k] == entered;
            let beyond = (b - a).perp_dot(to - a) < 0.0;
            let through = (to - from).perp_dot(a - from) <= 0.0 && (to - from).perp_dot(b - from) >= 0.0;
            !came && beyond && through
        })
    }

    /// A wall around a place in whose circle it is.
    fn encroached(&self, t: usize, at: DVec2) -> Option<[usize; 2]> {
        let net = &self.draft.net;
        let around = net.across[t].into_iter().filter(|n| *n != NONE).map(|n| n as usize);
        let walls = std::iter::once(t).chain(around).flat_map(|t| [0, 1, 2].map(|k| [t, k]));
        let depth = |&[t, k]: &[usize; 2]| {
            let p = self.draft.places(t);
            let (a, b) = (p[k] - at, p[(k + 1) % 3] - at);
            a.dot(b) / (a.length() * b.length())
        };
        let walls = walls.filter(|&[t, k]| net.walls[t][k] != NONE);
        let (wall, depth) = walls.map(|w| (w, depth(&w))).min_by(|a, b| a.1.total_cmp(&b.1))?;
        (depth < 0.0).then_some(wall)
    }

    fn set(&mut self, t: usize, at: DVec2) {
        let p = self.draft.places(t);
        if !self.draft.is_excused(t) && p.iter().all(|q| q.distance(at) >= self.floor_mm) {
            self.draft.put(t, at, &mut self.changed);
        }
    }

    /// Splits a wall: in the middle, or beside an acute corner at a power of two from it.
    fn split(&mut self, side: [usize; 2]) {
        let (planar, sharp) = (&self.draft.planar, &self.draft.sharp);
        let wall = self.draft.net.walls[side[0]][side[1]] as usize;
        let (edge, span) = (planar.graph.constraints[wall].0, planar.spans[wall]);
        let [a, b] = edge.map(|v| planar.graph.points[v.index()]);
        let is_acute = edge.map(|v| sharp.acute_at(v).any(|(_, c)| c.tracks.contains(&span.track)));
        let length = a.distance(b);
        let shell = 2.0_f64.powf((0.5 * length).log2().round()) / length * span.length_mm();
        let at = match is_acute {
            [true, false] => span.from_mm + shell,
            [false, true] => span.to_mm - shell,
            _ => 0.5 * (span.from_mm + span.to_mm),
        };
        self.split_at(side, at);
    }

    /// Splits a wall at an arc length, unless its ends are near or a triangle beside it would turn over.
    fn split_at(&mut self, [t, k]: [usize; 2], at_mm: f64) {
        let (planar, net) = (&self.draft.planar, &self.draft.net);
        let constraint = net.walls[t][k];
        let new = planar.tracks[planar.spans[constraint as usize].track as usize].point(at_mm);
        let ends = [k, (k + 1) % 3].map(|k| self.draft.places(t)[k]);
        if ends.iter().any(|e| e.distance(new) < self.floor_mm) {
            return;
        }
        let beside = [t as u32, net.across[t][k]].into_iter().filter(|n| *n != NONE).map(|n| n as usize);
        let stays = |t: usize| {
            let p = self.draft.places(t);
            let mut others = (0..3).filter(|&i| net.walls[t][i] != constraint);
            others.all(|i| left_of_line(p[i], p[(i + 1) % 3], new) > 0.0)
        };
        if beside.into_iter().all(stays) {
            self.draft.split([t, k], at_mm, &mut self.changed);
        }
    }
}

/// The circumcentre, or, where that is far, the place on the way to it that makes a triangle of the wished angle with the
/// shortest side.
fn off_centre(p: [DVec2; 3]) -> Option<DVec2> {
    let k = shortest(p);
    let (a, b, c) = (p[k], p[(k + 1) % 3], p[(k + 2) % 3]);
    let (u, v) = (b - a, c - a);
    let twice = 2.0 * u.perp_dot(v);
    let (uu, vv) = (u.length_squared(), v.length_squared());
    let centre = DVec2::new(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / twice;
    let middle = 0.5 * u;
    let far = 0.5 * u.length() / (0.5 * GOAL_DEG.to_radians()).tan();
    let way = centre - middle;
    let place = if way.length() > far { middle + way * (far / way.length()) } else { centre };
    place.is_finite().then_some(a + place)
}
