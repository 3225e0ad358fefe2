//! The softened pattern: every crease a band of fold lines.

use crate::{CheckError, CreaseId, LoopId, PlanarCurve, Tolerance};
use glam::DVec2;

/// A point on the outline, a hole or a slit, by arc length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlinePoint {
    /// Which curve: the outline, then the holes, then the slits.
    pub loop_id: LoopId,
    /// Arc length along it, mm.
    pub s_mm: f64,
}

/// Where a fold line ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LineEnd {
    /// Inside the sheet, where its crease ends freely.
    Free,
    /// On the outline, a hole or a slit.
    Boundary(OutlinePoint),
    /// At the junction with this number in [`SoftPattern::junctions`]: on its polygon, or at its point.
    Junction(usize),
    /// Where all lines of the band come together in one point: soft becomes sharp, or the fold angle vanishes.
    Tip,
    /// A closed line: it ends at its start.
    Closed,
}

impl LineEnd {
    /// The point of the boundary, if it ends there.
    pub fn on_boundary(self) -> Option<OutlinePoint> {
        match self {
            LineEnd::Boundary(p) => Some(p),
            _ => None,
        }
    }
}

/// One polyline of a band along which the strips turn against each other.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldLine {
    /// Its number among the `n + 1` lines of a soft stretch, from right to left; none on a sharp stretch.
    pub rank: Option<u32>,
    /// Points in (u, v), along the crease, dense enough for the chord tolerance. A closed line repeats its
    /// first point; ends that meet other lines are equal to them to the last bit.
    pub points: Vec<DVec2>,
    /// Arc length on the crease of the foot of each point, mm; below 0 or above the crease's length where a
    /// line outlasts its crease at the boundary.
    pub s_mm: Vec<f64>,
    /// Signed distance of each point from the crease, mm; positive to the left of its direction.
    pub offsets_mm: Vec<f64>,
    /// Turn at each point, rad, + valley.
    pub turns_rad: Vec<f64>,
    /// Start and end.
    pub ends: [LineEnd; 2],
}

/// Radius and fold angle at one place along a crease; linear in arc length between two of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softness {
    /// Arc length along the crease, mm.
    pub s_mm: f64,
    /// Radius of the soft fold, mm (paper eq. 1); 0 for a sharp fold.
    pub radius_mm: f64,
    /// Signed fold angle π − ρ, rad, + valley, − mountain.
    pub fold_angle_rad: f64,
}

/// The softened strip of one crease: on soft stretches `n` strips between `n + 1` fold lines, on sharp ones a
/// single fold line, and none where the fold angle is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// The crease it replaces.
    pub crease: CreaseId,
    /// Strips `n`.
    pub segments: u32,
    /// Radius and fold angle along the crease: one entry or more, arc lengths ascending. Before the first
    /// and after the last they stay what they are there. Empty for a crease that stays flat.
    pub profile: Vec<Softness>,
    /// The fold lines: stretch after stretch along the crease, from right to left within a stretch.
    pub fold_lines: Vec<FoldLine>,
}

/// The region around a junction that the bands leave free.
#[derive(Clone, Debug, PartialEq)]
pub struct JunctionRegion {
    /// Where the creases meet.
    pub point: DVec2,
    /// Counter-clockwise, through the ends of the fold lines that lead to it; empty if all creases are
    /// sharp there, so that they meet in the point itself.
    pub polygon: Vec<DVec2>,
    /// The creases that meet.
    pub creases: Vec<CreaseId>,
}

/// The flat sheet with its bands.
#[derive(Clone, Debug, PartialEq)]
pub struct SoftPattern {
    /// Outline (counter-clockwise) and holes (clockwise), by [`LoopId`].
    pub loops: Vec<PlanarCurve>,
    /// Slits; their [`LoopId`]s follow those of the loops.
    pub slits: Vec<PlanarCurve>,
    /// One band a crease, in crease order.
    pub bands: Vec<Band>,
    /// Where creases meet.
    pub junctions: Vec<JunctionRegion>,
    /// Tolerances of the sheet.
    pub tolerance: Tolerance,
}

impl Softness {
    /// Chord `x = 2 r sin(|π−ρ|/(2n))`: the width of one strip of `n`, mm.
    pub fn strip_width_mm(&self, segments: u32) -> f64 {
        2.0 * self.radius_mm * (self.fold_angle_rad.abs() / (2.0 * f64::from(segments))).sin()
    }
}

impl Band {
    /// Radius and fold angle at an arc length of the crease; none for a crease that stays flat.
    pub fn at(&self, s_mm: f64) -> Option<Softness> {
        let i = self.profile.partition_point(|p| p.s_mm <= s_mm);
        let (before, after) = (i.checked_sub(1).map(|i| self.profile[i]), self.profile.get(i).copied());
        let (Some(a), Some(b)) = (before, after) else {
            return before.or(after).map(|p| Softness { s_mm, ..p });
        };
        let t = (s_mm - a.s_mm) / (b.s_mm - a.s_mm);
        let between = |x: f64, y: f64| x + t * (y - x);
        Some(Softness {
            s_mm,
            radius_mm: between(a.radius_mm, b.radius_mm),
            fold_angle_rad: between(a.fold_angle_rad, b.fold_angle_rad),
        })
    }

    /// Half the band's width where it is widest, mm.
    pub fn half_width_mm(&self) -> f64 {
        self.fold_lines.iter().flat_map(|l| &l.offsets_mm).map(|o| o.abs()).fold(0.0, f64::max)
    }

    /// Width of a strip where the band is widest, mm; 0 if it is sharp all along.
    pub fn strip_width_mm(&self) -> f64 {
        2.0 * self.half_width_mm() / f64::from(self.segments.max(1))
    }

    /// The entry of the profile with the largest radius; none for a crease that stays flat.
    pub fn softest(&self) -> Option<Softness> {
        self.profile.iter().copied().reduce(|a, b| if b.radius_mm > a.radius_mm { b } else { a })
    }

    /// The entry of the profile with the largest fold angle; none for a crease that stays flat.
    pub fn steepest(&self) -> Option<Softness> {
        let size = |p: &Softness| p.fold_angle_rad.abs();
        self.profile.iter().copied().reduce(|a, b| if size(&b) > size(&a) { b } else { a })
    }
}

impl SoftPattern {
    /// Exact area of the sheet, mm².
    pub fn area_mm2(&self) -> f64 {
        self.loops.iter().map(PlanarCurve::signed_area_mm2).sum()
    }

    /// The boundary curve through a point and the place on it, if there is one within the join tolerance: that of
    /// a junction on the boundary, for example.
    pub fn on_boundary(&self, p: DVec2) -> Option<OutlinePoint> {
        let curves = self.loops.iter().chain(&self.slits).enumerate();
        let near = curves.map(|(i, c)| (LoopId::new(i), c.nearest(p)));
        let (loop_id, (s_mm, distance)) = near.min_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
        (distance <= self.tolerance.join_mm).then_some(OutlinePoint { loop_id, s_mm })
    }

    /// The contract of this type: every point of every fold line has the offset `(k − n/2) x` and the turn of
    /// its rank at its place, so that the turns across a band add up to its fold angle; line ends that
    /// name a junction are on it.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), CheckError> {
        self.bands.iter().try_for_each(Band::check)?;
        let corner = |j: usize, p: DVec2| {
            self.junctions
                .get(j)
                .is_some_and(|j| j.polygon.contains(&p) || (j.polygon.is_empty() && j.point == p))
        };
        for band in &self.bands {
            for line in &band.fold_lines {
                let ends = [line.points.first(), line.points.last()];
                for (end, p) in line.ends.iter().zip(ends.into_iter().flatten()) {
                    if matches!(end, LineEnd::Junction(j) if !corner(*j, *p)) {
                        let what = format!("a fold line of crease {} misses its junction", band.crease);
                        return Err(CheckError::new("SoftPattern", what));
                    }
                }
            }
        }
        Ok(())
    }
}

impl Band {
    /// Turns must add up to the fold angle within this, rad: rounding of a sum of a few terms.
    const TURN_SUM_RAD: f64 = 1e-12;
    /// Offsets are exact to this share of the band's width: rounding.
    const OFFSET: f64 = 1e-12;

    /// Offset over strip width, and turn over fold angle, of a line.
    fn shares(&self, rank: Option<u32>) -> [f64; 2] {
        let n = f64::from(self.segments);
        match rank {
            None => [0.0, 1.0],
            Some(k) => {
                let outer = k == 0 || k == self.segments;
                [f64::from(k) - 0.5 * n, if outer { 0.5 / n } else { 1.0 / n }]
            }
        }
    }

    fn check(&self) -> Result<(), CheckError> {
        let fault = |f: &str| Err(CheckError::new("Band", format!("crease {}: {f}", self.crease)));
        if self.profile.windows(2).any(|w| w[0].s_mm >= w[1].s_mm) {
            return fault("the profile does not ascend");
        }
        for line in &self.fold_lines {
            let n = line.points.len();
            if n < 2 || [line.s_mm.len(), line.offsets_mm.len(), line.turns_rad.len()] != [n; 3] {
                return fault(
                    "a fold line needs two points or more, and a place, an offset and a turn for each",
                );
            }
            if line.rank.is_some_and(|k| k > self.segments) {
                return fault("a fold line has a rank beyond the band's strips");
            }
            let [offset, turn] = self.shares(line.rank);
            for i in 0..n {
                let Some(soft) = self.at(line.s_mm[i]) else {
                    return fault("a crease that stays flat has fold lines");
                };
                let width = soft.strip_width_mm(self.segments);
                if (line.offsets_mm[i] - offset * width).abs() > Self::OFFSET * (1.0 + width) {
                    return fault("a fold line is not where its radius and angle put it");
                }
                if (line.turns_rad[i] - turn * soft.fold_angle_rad).abs() > Self::TURN_SUM_RAD {
                    return fault("turns do not add up to the fold angle");
                }
            }
        }
        Ok(())
    }
}
