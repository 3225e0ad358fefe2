//! One band on the sheet: its fold lines, and whether they fit the crease and the boundary.

use crate::boundary::{Boundary, Side};
use crate::layout::EndKind;
use crate::lines::{Clip, MOST_SHIFT, Stop};
use crate::profile::{Profile, Stretch};
use crate::spine::{Sampling, Spine};
use crate::{Fault, Misfit};
use softfold_geometry::{Band, Crease, DVec2, FoldLine, LineEnd, LoopId, Tolerance, polygon};
use std::ops::Range;

/// Creases are run on past the outline by so many half widths, enough for [`MOST_SHIFT`].
const RUN_ON: f64 = 1.0 + MOST_SHIFT;
/// Shortest run past the outline, as a share of the sheet.
const LEAST_RUN_ON: f64 = 1e-3;
/// Fold lines keep this to their curve unless the sheet is so small that its tolerances are finer:
/// half of the 0.01 mm that a band is held to.
const FINEST_CHORD_MM: f64 = 0.005;
/// Most points of a band's fold lines: a hundred megabytes.
const MOST_POINTS: usize = 2_000_000;
/// Stretches shorter than this share of their crease are rounding.
const SHORTEST: f64 = 1e-9;

/// What every band needs to know of the sheet.
pub(crate) struct Sheet {
    pub(crate) boundary: Boundary,
    pub(crate) tolerance: Tolerance,
}

/// Why there is no band.
#[derive(Clone, Debug)]
pub(crate) enum Problem {
    /// The request is at fault.
    Fault(Fault),
    /// The band is too wide for the sheet, here.
    Misfit(Misfit, DVec2),
}

impl From<Fault> for Problem {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// How a crease ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends {
    pub(crate) kinds: [EndKind; 2],
    /// By how much the band is cut back for a junction region, mm.
    pub(crate) cuts_mm: [f64; 2],
}

/// The fold lines of one stretch, by their numbers in the band.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) lines: Range<usize>,
    pub(crate) soft: bool,
}

/// A band on the sheet.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) band: Band,
    pub(crate) parts: Vec<Part>,
}

impl Shape {
    /// The band of a crease.
    ///
    /// # Errors
    /// A softness that is none, or a band that does not fit.
    pub(crate) fn new(
        sheet: &Sheet,
        crease: &Crease,
        profile: &Profile,
        ends: &Ends,
    ) -> Result<Self, Problem> {
        let plan = Plan { sheet, crease, profile, ends };
        plan.refuse_wider_than_sheet()?;
        let stretches = plan.stretches()?;
        let sampling = plan.sampling(&stretches);
        let spine = Spine::new(&crease.curve, profile, &sampling)?;
        let points = spine.stations.len() * (profile.band.segments as usize + 1);
        if points > MOST_POINTS {
            return Err(Fault::TooFine { points }.into());
        }
        let mut shape = Self { band: profile.band.clone(), parts: Vec::new() };
        for stretch in &stretches {
            if stretch.soft {
                refuse_tight(&spine, profile, stretch)?;
            }
            let clip = Clip { sheet, profile, spine: &spine, s_mm: stretch.s_mm, stops: plan.stops(stretch) };
            let start = shape.band.fold_lines.len();
            let ranks: Vec<Option<u32>> =
                if stretch.soft { (0..=profile.band.segments).map(Some).collect() } else { vec![None] };
            for rank in ranks {
                shape.band.fold_lines.push(clip.line(rank)?);
            }
            let part = Part { lines: start..shape.band.fold_lines.len(), soft: stretch.soft };
            shape.refuse_boundary_inside(sheet, &part)?;
            shape.parts.push(part);
        }
        Ok(shape)
    }

    pub(crate) fn lines(&self, part: &Part) -> &[FoldLine] {
        &self.band.fold_lines[part.lines.clone()]
    }

    /// The fold lines that reach an end of the crease, from right to left.
    pub(crate) fn lines_at(&self, side: usize, meeting: usize) -> Vec<FoldLine> {
        let part = if side == 0 { self.parts.first() } else { self.parts.last() };
        let ends_here = |l: &&FoldLine| l.ends[side] == LineEnd::Junction(meeting);
        part.map_or(Vec::new(), |p| self.lines(p).iter().filter(ends_here).cloned().collect())
    }

    /// Whether a point is inside the strips of a part.
    pub(crate) fn contains(&self, part: &Part, p: DVec2) -> bool {
        let lines = self.lines(part);
        let (Some(right), Some(left)) = (lines.first(), lines.last()) else { return false };
        if !part.soft {
            return false;
        }
        if right.ends[0] == LineEnd::Closed {
            return polygon::contains(&right.points, p) != polygon::contains(&left.points, p);
        }
        let end = |side: usize| {
            let point =
                move |l: &FoldLine| if side == 0 { l.points[0] } else { l.points[l.points.len() - 1] };
            lines.iter().map(point)
        };
        let middle = 1..lines.len() - 1;
        let mut around = right.points.clone();
        around.extend(end(1).skip(1).take(middle.len()));
        around.extend(left.points.iter().rev());
        around.extend(end(0).rev().skip(1).take(middle.len()));
        polygon::contains(&around, p)
    }

    /// Refuses a band with a hole or a slit in it.
    fn refuse_boundary_inside(&self, sheet: &Sheet, part: &Part) -> Result<(), Problem> {
        let lines = self.lines(part);
        if !part.soft {
            return Ok(());
        }
        let carrying: Vec<LoopId> =
            lines.iter().flat_map(|l| l.ends).filter_map(|e| e.on_boundary().map(|p| p.loop_id)).collect();
        if let Some(p) = cap_crossing(sheet, lines, &carrying) {
            return Err(Problem::Misfit(Misfit::Boundary, p));
        }
        let edges: Vec<DVec2> =
            [&lines[0], &lines[lines.len() - 1]].iter().flat_map(|l| l.points.iter().copied()).collect();
        let inside = sheet
            .boundary
            .sides_near(&edges)
            .filter(|s| !carrying.contains(&s.loop_id))
            .flat_map(|s| s.ends)
            .find(|p| self.contains(part, *p));
        inside.map_or(Ok(()), |p| Err(Problem::Misfit(Misfit::Boundary, p)))
    }
}

/// Where a boundary curve that carries none of the lines crosses a free end of a band.
fn cap_crossing(sheet: &Sheet, lines: &[FoldLine], carrying: &[LoopId]) -> Option<DVec2> {
    for side in 0..2 {
        let end = |l: &FoldLine| if side == 0 { l.points[0] } else { l.points[l.points.len() - 1] };
        for pair in lines.windows(2).filter(|p| p.iter().any(|l| l.ends[side] == LineEnd::Free)) {
            let cap = [end(&pair[0]), end(&pair[1])];
            let others = sheet.boundary.sides_near(&cap).filter(|s| !carrying.contains(&s.loop_id));
            let crossing =
                |s: &Side| polygon::segment_crossing(cap[0], cap[1], s.ends[0], s.ends[1]).map(|c| c.0);
            if let Some(t) = others.filter_map(crossing).reduce(f64::min) {
                return Some(cap[0].lerp(cap[1], t));
            }
        }
    }
    None
}

/// What a band is made from.
struct Plan<'a> {
    sheet: &'a Sheet,
    crease: &'a Crease,
    profile: &'a Profile,
    ends: &'a Ends,
}

impl Plan<'_> {
    /// Where the band begins and ends along the crease, mm.
    fn range_mm(&self) -> [f64; 2] {
        let [a, b] = self.profile.range_mm;
        [a + self.ends.cuts_mm[0], b - self.ends.cuts_mm[1]]
    }

    /// No band is wider than the sheet: refused before it is sampled.
    fn refuse_wider_than_sheet(&self) -> Result<(), Problem> {
        let curve = &self.crease.curve;
        let wide = |s: &f64| self.profile.half_width_mm(*s) > self.sheet.boundary.size_mm();
        match self.profile.places().chain(self.profile.range_mm).find(wide) {
            Some(s) => Err(Problem::Misfit(Misfit::Boundary, curve.point(s))),
            None => Ok(()),
        }
    }

    /// The stretches between the junction regions.
    fn stretches(&self) -> Result<Vec<Stretch>, Problem> {
        let [a, b] = self.range_mm();
        let length = self.crease.curve.length_mm();
        if b - a <= SHORTEST * length {
            let middle = self.crease.curve.point(0.5 * length);
            return Err(Problem::Misfit(Misfit::Short, middle));
        }
        let clipped = self
            .profile
            .stretches
            .iter()
            .map(|s| Stretch { s_mm: [s.s_mm[0].max(a), s.s_mm[1].min(b)], ..*s });
        Ok(clipped.filter(|s| s.s_mm[1] - s.s_mm[0] > SHORTEST * length).collect())
    }

    fn stops(&self, stretch: &Stretch) -> [Stop; 2] {
        let range = self.range_mm();
        [0, 1].map(|side| match stretch.s_mm[side] == range[side] {
            true => self.stop(stretch, side),
            false => Stop::Point(LineEnd::Tip),
        })
    }

    /// How a stretch ends at an end of the crease.
    fn stop(&self, stretch: &Stretch, side: usize) -> Stop {
        let tip = stretch.soft && self.profile.is_tip(stretch.s_mm[side], true);
        match self.ends.kinds[side] {
            EndKind::Meeting(j) if self.ends.cuts_mm[side] > 0.0 => Stop::Square(LineEnd::Junction(j)),
            EndKind::Meeting(j) => Stop::Point(LineEnd::Junction(j)),
            EndKind::Boundary if tip => {
                let end = self.crease.curve.end(side);
                Stop::Point(LineEnd::Boundary(self.sheet.boundary.nearest(end).0))
            }
            EndKind::Boundary => Stop::Boundary,
            EndKind::Free if self.profile.ring => Stop::Square(LineEnd::Closed),
            EndKind::Free if tip || self.crease.curve.is_closed() => Stop::Point(LineEnd::Tip),
            EndKind::Free => Stop::Square(LineEnd::Free),
        }
    }

    fn sampling(&self, stretches: &[Stretch]) -> Sampling {
        let [a, b] = self.range_mm();
        let tolerance = self.sheet.tolerance;
        let slack = SHORTEST * self.crease.curve.length_mm();
        let inner = stretches.iter().flat_map(|s| s.s_mm).chain(self.profile.places());
        let mut places_mm: Vec<f64> = inner.filter(|s| *s > a + slack && *s < b - slack).collect();
        places_mm.extend([a, b]);
        places_mm.sort_by(f64::total_cmp);
        places_mm.dedup();
        let run_on_mm = [0, 1].map(|side| {
            let runs = stretches.iter().any(|s| self.stops(s)[side] == Stop::Boundary);
            let half_width = self.profile.half_width_mm(self.range_mm()[side]);
            let length = (RUN_ON * half_width).max(LEAST_RUN_ON * self.sheet.boundary.size_mm());
            if runs { length } else { 0.0 }
        });
        let chord_mm = FINEST_CHORD_MM.min(tolerance.join_mm).max(tolerance.chord_mm);
        Sampling { places_mm, chord_mm, run_on_mm }
    }
}

/// Refuses a stretch whose edge reaches the centre of curvature, where the map from the band to the sheet
/// folds over: `1 − κ o = 0`, however the offset `o` changes along the crease.
fn refuse_tight(spine: &Spine<'_>, profile: &Profile, stretch: &Stretch) -> Result<(), Problem> {
    let half = 0.5 * f64::from(profile.band.segments);
    let length = profile.range_mm;
    // What is run on belongs to the stretch that it runs on.
    let low = if stretch.s_mm[0] == length[0] { f64::MIN } else { stretch.s_mm[0] };
    let high = if stretch.s_mm[1] == length[1] { f64::MAX } else { stretch.s_mm[1] };
    let first = spine.stations.partition_point(|s| s.s_mm < low);
    let last = spine.stations.partition_point(|s| s.s_mm <= high);
    let stations = &spine.stations[first..last];
    let tight = |at| Err(Problem::Misfit(Misfit::Curvature, at));
    for share in [-half, half] {
        if let Some(s) = stations.iter().find(|s| s.curvature * share * s.strip_mm >= 1.0) {
            return tight(s.point);
        }
        for s in stations.windows(2) {
            if (s[1].point - s[0].point).dot(s[1].at(share) - s[0].at(share)) <= 0.0 {
                return tight(s[0].point);
            }
        }
    }
    Ok(())
}
