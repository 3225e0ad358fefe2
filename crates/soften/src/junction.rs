//! The regions where creases meet: how far the bands are cut back, and the polygon between their ends.
//!
//! Each band ends on a straight cut square to its crease. Seen from the meeting point the ends of
//! neighbouring bands must lie side by side; the polygon through them is then star-shaped about the point, and
//! the bands beyond their cuts do not reach each other. A wedge of angle α between two creases whose bands
//! have the half widths `h` and `h'` is shared as `h : h'`: for narrow wedges that puts both cuts just behind
//! the point where the edges of the bands cross.

use crate::layout::{Meeting, turn_ccw};
use crate::profile::Profile;
use softfold_geometry::{CreaseEnd, CreasePattern, DVec2, FoldLine};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Share of a wedge that the bands may take: a tenth stays free between them, so that the polygon's
/// sides there can be meshed.
const FILL: f64 = 0.9;
/// Widest half angle that a band may take, rad (60°): nearer cuts would make the region flat.
const WIDEST_SHARE_RAD: f64 = 1.047;
/// Narrowest wedge that straight creases are laid out for, rad; below it only the scan finds room.
const NARROWEST_WEDGE_RAD: f64 = 0.02;
/// No cut is nearer than this share of the widest half width.
const NEAREST_CUT: f64 = 0.577;
/// Growth of all cuts from one try to the next, where bent creases need more room than straight ones.
const GROWTH: f64 = 1.08;
/// Tries: up to a hundred times the first.
const TRIES: u32 = 60;
/// A cut leaves at least this share of its crease.
const LEAST_REST: f64 = 0.02;
/// Gap between neighbouring ends that the scan asks for at least, rad.
const LEAST_GAP_RAD: f64 = 0.005;
/// In wider gaps the polygon gets a corner of its own, so that it goes round the point, rad (166°).
const OPEN_GAP_RAD: f64 = 2.9;

/// Why a meeting has no region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoRoom {
    /// The end whose crease is too short for its cut.
    pub(crate) end: CreaseEnd,
}

/// One end at a meeting with what is needed to lay it out.
struct Arm<'a> {
    end: CreaseEnd,
    curve: &'a softfold_geometry::PlanarCurve,
    profile: &'a Profile,
}

impl Arm<'_> {
    fn s_mm(&self, cut_mm: f64) -> f64 {
        if self.end.side == 0 { cut_mm } else { self.curve.length_mm() - cut_mm }
    }

    fn half_width_mm(&self, cut_mm: f64) -> f64 {
        self.profile.half_width_mm(self.s_mm(cut_mm))
    }

    fn leaving(&self) -> DVec2 {
        self.curve.leaving(self.end.side)
    }

    fn most_mm(&self) -> f64 {
        (1.0 - LEAST_REST) * self.curve.length_mm()
    }

    /// Right and left corner of the cut, seen from the point.
    fn corners(&self, cut_mm: f64) -> [DVec2; 2] {
        let s = self.s_mm(cut_mm);
        let (foot, tangent) = (self.curve.point(s), self.curve.tangent(s));
        let leaving = if self.end.side == 0 { tangent } else { -tangent };
        let out = self.half_width_mm(cut_mm) * leaving.perp();
        [foot - out, foot + out]
    }
}

/// How far each band is cut back, mm along its crease, by end of the meeting; all 0 if all are sharp there.
///
/// # Errors
/// A crease that is too short.
pub(crate) fn cuts<'a>(
    meeting: &Meeting,
    pattern: &'a CreasePattern,
    profiles: &dyn Fn(usize) -> Option<&'a Profile>,
) -> Result<Vec<f64>, NoRoom> {
    let arm = |e: &CreaseEnd| {
        let i = e.crease.index();
        Some(Arm { end: *e, curve: &pattern.creases[i].curve, profile: profiles(i)? })
    };
    let arms: Vec<Arm<'_>> = meeting.ends.iter().filter_map(arm).collect();
    if arms.len() < meeting.ends.len() || arms.iter().all(|a| a.half_width_mm(0.0) == 0.0) {
        return Ok(vec![0.0; meeting.ends.len()]);
    }
    let first = straight_cuts(meeting, &arms);
    let mut growth = 1.0;
    for _ in 0..TRIES {
        let cuts: Vec<f64> = first.iter().map(|c| growth * c).collect();
        if let Some((arm, _)) = arms.iter().zip(&cuts).find(|(a, c)| **c > a.most_mm()) {
            return Err(NoRoom { end: arm.end });
        }
        if side_by_side(meeting, &arms, &cuts) {
            return Ok(cuts);
        }
        growth *= GROWTH;
    }
    Err(NoRoom { end: arms[0].end })
}

/// The cuts of straight creases with the half widths that they have at the point.
fn straight_cuts(meeting: &Meeting, arms: &[Arm<'_>]) -> Vec<f64> {
    let n = arms.len();
    let halves: Vec<f64> = arms.iter().map(|a| a.half_width_mm(0.0)).collect();
    let wedges = wedges(meeting, arms);
    let widest = halves.iter().copied().fold(0.0, f64::max);
    let share = |wedge: f64, mine: f64, others: f64| {
        let whole = mine + others;
        if whole > 0.0 { FILL * wedge * mine / whole } else { FRAC_PI_2 }
    };
    let wall = |i: usize| meeting.walls.is_some() && i == n;
    let mut cuts: Vec<f64> = (0..n)
        .map(|i| {
            let right = if wall(if i == 0 { n } else { i }) { 0.0 } else { halves[(i + n - 1) % n] };
            let left = if wall(i + 1) { 0.0 } else { halves[(i + 1) % n] };
            let angle = share(wedges[i], halves[i], right).min(share(wedges[i + 1], halves[i], left));
            let least = NEAREST_CUT * widest;
            if halves[i] == 0.0 { least } else { least.max(halves[i] / angle.min(WIDEST_SHARE_RAD).tan()) }
        })
        .collect();
    // No spikes: in a narrow wedge the cut of one band is not far behind that of the other.
    for _ in 0..2 {
        for i in 0..n {
            let next = (i + 1) % n;
            if n > 1 && !wall(i + 1) {
                let along = wedges[i + 1].cos();
                (cuts[i], cuts[next]) = (cuts[i].max(along * cuts[next]), cuts[next].max(along * cuts[i]));
            }
        }
    }
    cuts
}

/// The angle before each arm, and after the last one.
fn wedges(meeting: &Meeting, arms: &[Arm<'_>]) -> Vec<f64> {
    let n = arms.len();
    let wide = |from: DVec2, to: DVec2| match turn_ccw(from, to) {
        angle if n == 1 || angle < NARROWEST_WEDGE_RAD => NARROWEST_WEDGE_RAD,
        angle => angle,
    };
    let between = |i: usize| wide(arms[i].leaving(), arms[(i + 1) % n].leaving());
    let [before, after] = match meeting.walls {
        None => [between(n - 1); 2],
        Some([right, left]) => [wide(right, arms[0].leaving()), wide(arms[n - 1].leaving(), left)],
    };
    let mut wedges = vec![before];
    wedges.extend((0..n - 1).map(between));
    wedges.push(after);
    wedges
}

/// Whether the cuts' corners follow each other counter-clockwise around the point.
fn side_by_side(meeting: &Meeting, arms: &[Arm<'_>], cuts: &[f64]) -> bool {
    let seen: Vec<[DVec2; 2]> =
        arms.iter().zip(cuts).map(|(a, c)| a.corners(*c).map(|p| p - meeting.point)).collect();
    let spans_face_outwards =
        seen.iter().all(|[r, l]| r.perp_dot(*l) >= 0.0 && r.dot(*l) > -r.length() * l.length());
    let spans: f64 = seen.iter().map(|[r, l]| if r == l { 0.0 } else { turn_ccw(*r, *l) }).sum();
    let n = seen.len();
    let mut gaps: Vec<f64> = (1..n).map(|i| turn_ccw(seen[i - 1][1], seen[i][0])).collect();
    let whole = match meeting.walls {
        None => {
            gaps.push(turn_ccw(seen[n - 1][1], seen[0][0]));
            TAU
        }
        Some([right, left]) => {
            gaps.extend([turn_ccw(right, seen[0][0]), turn_ccw(seen[n - 1][1], left)]);
            if right == left { TAU } else { turn_ccw(right, left) }
        }
    };
    let sum = spans + gaps.iter().sum::<f64>();
    spans_face_outwards && gaps.iter().all(|g| *g > LEAST_GAP_RAD) && (sum - whole).abs() < LEAST_GAP_RAD
}

/// The polygon through the line ends at a meeting: `lines_at` gives the fold lines that reach an end, from
/// right to left of their crease. Empty if all lines meet in the point itself.
pub(crate) fn polygon(meeting: &Meeting, lines_at: &dyn Fn(CreaseEnd) -> Vec<FoldLine>) -> Vec<DVec2> {
    let cut = |e: &CreaseEnd| {
        let mut ends: Vec<DVec2> = lines_at(*e)
            .iter()
            .filter_map(|l| if e.side == 0 { l.points.first() } else { l.points.last() }.copied())
            .collect();
        if e.side == 1 {
            ends.reverse();
        }
        ends
    };
    let cuts: Vec<Vec<DVec2>> = meeting.ends.iter().map(cut).filter(|c| !c.is_empty()).collect();
    if cuts.iter().flatten().all(|p| *p == meeting.point) {
        return Vec::new();
    }
    let half = |c: &Vec<DVec2>| 0.5 * c[0].distance(c[c.len() - 1]);
    let reach = cuts.iter().map(half).fold(0.0, f64::max);
    let mut corners = Vec::new();
    for (i, cut) in cuts.iter().enumerate() {
        corners.extend(cut);
        let last = i + 1 == cuts.len();
        let seen = [cut[cut.len() - 1], cuts[(i + 1) % cuts.len()][0]].map(|p| p - meeting.point);
        match last && meeting.walls.is_some() {
            true => corners.push(meeting.point),
            false => {
                let gap = turn_ccw(seen[0], seen[1]);
                if gap > OPEN_GAP_RAD {
                    let middle = DVec2::from_angle(0.5 * gap).rotate(seen[0].normalize_or_zero());
                    corners.push(meeting.point + reach * middle);
                }
            }
        }
    }
    corners
}
