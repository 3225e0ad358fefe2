//! The fold lines of one stretch, clipped where they end.

use crate::boundary::{Boundary, Crossing};
use crate::shape::{Problem, Sheet};
use crate::spine::{Spine, Station};
use crate::{Misfit, profile::Profile};
use softfold_geometry::{DVec2, FoldLine, LineEnd};

/// A fold line may end this many half widths before or after the crease does: a crease that meets the
/// outline at less than 9.5° runs along it rather than ending on it.
pub(crate) const MOST_SHIFT: f64 = 6.0;
/// The line in the middle of a band ends where its crease does, within so many join tolerances.
const MIDDLE_JOINS: f64 = 20.0;

/// How the fold lines of a stretch end on one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stop {
    /// All in the point of the crease.
    Point(LineEnd),
    /// Square to the crease.
    Square(LineEnd),
    /// On the boundary.
    Boundary,
}

/// One stretch, ready to be cut into fold lines.
pub(crate) struct Clip<'a> {
    pub(crate) sheet: &'a Sheet,
    pub(crate) profile: &'a Profile,
    pub(crate) spine: &'a Spine<'a>,
    /// The stretch's ends, which are stations.
    pub(crate) s_mm: [f64; 2],
    pub(crate) stops: [Stop; 2],
}

/// An end of a fold line.
#[derive(Clone, Copy, Debug)]
struct Cut {
    point: DVec2,
    s_mm: f64,
    end: LineEnd,
}

impl Clip<'_> {
    /// The fold line of a rank, or that of a sharp stretch.
    ///
    /// # Errors
    /// A line that the boundary is in the way of.
    pub(crate) fn line(&self, rank: Option<u32>) -> Result<FoldLine, Problem> {
        let n = f64::from(self.profile.band.segments);
        let share = rank.map_or(0.0, |k| f64::from(k) - 0.5 * n);
        let range = self.stations();
        let points = self.spine.points(share, range.clone());
        let middle = self.middle(*range.start());
        let at_middle = along(&points, middle);
        if share != 0.0 && !self.sheet.boundary.contains(at_middle) {
            return Err(Problem::Misfit(Misfit::Boundary, at_middle));
        }
        let mut crossings = self.sheet.boundary.crossings(&points);
        crossings.retain(|c| !self.is_own_end(along(&points, c.place)));
        let after = crossings.split_off(crossings.partition_point(|c| c.place <= middle));
        crossings.reverse();
        let run = Run { clip: self, share, points: &points, first: *range.start() };
        let cuts = [run.cut(0, &crossings)?, run.cut(1, &after)?];
        self.assembled(rank, share, cuts)
    }

    /// Stations of the stretch, run on where it ends on the boundary.
    fn stations(&self) -> std::ops::RangeInclusive<usize> {
        let run_on = |side: usize| self.stops[side] == Stop::Boundary;
        let first = if run_on(0) { 0 } else { self.spine.index_of(self.s_mm[0]) };
        let last = if run_on(1) { self.spine.stations.len() - 1 } else { self.spine.index_of(self.s_mm[1]) };
        first..=last
    }

    fn station(&self, side: usize) -> &Station {
        &self.spine.stations[self.spine.index_of(self.s_mm[side])]
    }

    /// The middle of the stretch: piece after station `first`, plus share of the piece.
    fn middle(&self, first: usize) -> f64 {
        let stations = &self.spine.stations;
        let half = 0.5 * (self.s_mm[0] + self.s_mm[1]);
        let k = stations.partition_point(|s| s.s_mm <= half).clamp(first + 1, stations.len() - 1) - 1;
        let [a, b] = [stations[k].s_mm, stations[k + 1].s_mm];
        (k - first) as f64 + ((half - a) / (b - a)).clamp(0.0, 1.0)
    }

    /// Whether a point of the boundary is where the whole stretch ends.
    fn is_own_end(&self, p: DVec2) -> bool {
        let slack = 2.0 * self.sheet.tolerance.join_mm;
        let at = |side: usize| {
            matches!(self.stops[side], Stop::Point(_)) && self.station(side).point.distance(p) <= slack
        };
        at(0) || at(1)
    }

    fn assembled(&self, rank: Option<u32>, share: f64, [a, b]: [Cut; 2]) -> Result<FoldLine, Problem> {
        if a.s_mm >= b.s_mm {
            return Err(Problem::Misfit(Misfit::Boundary, a.point));
        }
        // Stations that almost coincide with the ends would make slivers.
        let apart = |p: DVec2| a.point.distance(p).min(b.point.distance(p)) > self.sheet.tolerance.chord_mm;
        let inner = self.spine.stations.iter().filter(|s| s.s_mm > a.s_mm && s.s_mm < b.s_mm);
        let inner = inner.map(|s| (s.at(share), s.s_mm)).filter(|(p, _)| apart(*p));
        let (points, s_mm): (Vec<DVec2>, Vec<f64>) =
            [(a.point, a.s_mm)].into_iter().chain(inner).chain([(b.point, b.s_mm)]).unzip();
        let n = self.profile.band.segments;
        let turn_share = match rank {
            None => 1.0,
            Some(k) if k == 0 || k == n => 0.5 / f64::from(n),
            Some(_) => 1.0 / f64::from(n),
        };
        let angle = |s: &f64| self.profile.band.at(*s).map_or(0.0, |e| e.fold_angle_rad);
        let offset = |s: &f64| share * self.profile.strip_width_mm(*s);
        Ok(FoldLine {
            rank,
            offsets_mm: s_mm.iter().map(|s| if share == 0.0 { 0.0 } else { offset(s) }).collect(),
            turns_rad: s_mm.iter().map(|s| turn_share * angle(s)).collect(),
            points,
            s_mm,
            ends: [a.end, b.end],
        })
    }
}

/// One fold line of a stretch before it is cut.
struct Run<'a> {
    clip: &'a Clip<'a>,
    share: f64,
    points: &'a [DVec2],
    /// Station of the first point.
    first: usize,
}

impl Run<'_> {
    /// The end on one side, from the crossings between the stretch's middle and beyond its end.
    fn cut(&self, side: usize, outward: &[Crossing]) -> Result<Cut, Problem> {
        let station = self.clip.station(side);
        let fixed = |point, end| Ok(Cut { point, s_mm: self.clip.s_mm[side], end });
        match (self.clip.stops[side], outward.first()) {
            (Stop::Boundary, _) if self.share == 0.0 => self.middle_cut(side, outward),
            (Stop::Boundary, Some(first)) if self.inward_mm(side, first) >= -self.most_shift_mm(side) => {
                self.boundary_cut(side, first, outward)
            }
            // Where the boundary is shorter than the band is wide, as at the end of a slit.
            (Stop::Boundary, _) => match self.boundary().contains(station.at(self.share)) {
                true => fixed(station.at(self.share), LineEnd::Free),
                false => Err(Problem::Misfit(Misfit::Boundary, station.at(self.share))),
            },
            (_, Some(first)) => Err(Problem::Misfit(Misfit::Boundary, self.at(first))),
            (Stop::Point(end), None) => fixed(station.point, end),
            (Stop::Square(end), None) => fixed(station.at(self.share), end),
        }
    }

    fn boundary_cut(&self, side: usize, first: &Crossing, outward: &[Crossing]) -> Result<Cut, Problem> {
        let join_mm = self.clip.sheet.tolerance.join_mm;
        let shift = self.inward_mm(side, first);
        let returns =
            |c: &&Crossing| self.inward_mm(side, c) > join_mm && shift - self.inward_mm(side, c) > join_mm;
        match outward[1..].iter().find(returns) {
            Some(c) => Err(Problem::Misfit(Misfit::Boundary, self.at(c))),
            None if shift > self.most_shift_mm(side) => {
                Err(Problem::Misfit(Misfit::Boundary, self.at(first)))
            }
            None => Ok(self.met(first)),
        }
    }

    fn most_shift_mm(&self, side: usize) -> f64 {
        let half_width_mm = self.clip.profile.half_width_mm(self.clip.s_mm[side]);
        MOST_SHIFT * half_width_mm + self.clip.sheet.tolerance.join_mm
    }

    /// The end of the crease itself, which is known to lie on the boundary within the join tolerance.
    fn middle_cut(&self, side: usize, outward: &[Crossing]) -> Result<Cut, Problem> {
        let tolerance = self.clip.sheet.tolerance;
        let reach = MIDDLE_JOINS * tolerance.join_mm;
        if let Some(c) = outward.iter().find(|c| self.inward_mm(side, c) > reach) {
            return Err(Problem::Misfit(Misfit::Boundary, self.at(c)));
        }
        let s_mm = self.clip.s_mm[side];
        let end = self.clip.station(side).point;
        let met = outward.iter().find(|c| self.inward_mm(side, c).abs() <= reach).map(|c| self.met(c));
        match met.filter(|m| m.point.distance(end) > tolerance.point_mm && m.point.distance(end) <= reach) {
            Some(met) => Ok(met),
            None => Ok(Cut { point: end, s_mm, end: LineEnd::Boundary(self.boundary().nearest(end).0) }),
        }
    }

    fn met(&self, crossing: &Crossing) -> Cut {
        let m = self.boundary().meet(self.clip.spine, self.share, crossing, self.first);
        Cut { point: m.point, s_mm: m.s_mm, end: LineEnd::Boundary(m.on) }
    }

    /// Length from the stretch's end to a crossing, positive towards its middle, mm.
    fn inward_mm(&self, side: usize, c: &Crossing) -> f64 {
        let stations = &self.clip.spine.stations;
        let k = (c.place as usize + self.first).min(stations.len() - 2);
        let [a, b] = [stations[k].s_mm, stations[k + 1].s_mm];
        let s = a + (c.place + self.first as f64 - k as f64) * (b - a);
        if side == 0 { s - self.clip.s_mm[0] } else { self.clip.s_mm[1] - s }
    }

    fn at(&self, c: &Crossing) -> DVec2 {
        along(self.points, c.place)
    }

    fn boundary(&self) -> &Boundary {
        &self.clip.sheet.boundary
    }
}

/// The point of a polyline at a place: piece number plus share of the piece.
fn along(points: &[DVec2], place: f64) -> DVec2 {
    let k = (place as usize).min(points.len() - 2);
    points[k].lerp(points[k + 1], place - k as f64)
}
