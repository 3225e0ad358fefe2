//! A band on the sheet: its fold lines clipped at the boundary, and whether it fits.

use crate::boundary::{Boundary, Crossing};
use crate::spine::{Sampling, Spine};
use crate::{BandFigures, CreaseSoftness, Fault, Misfit};
use softfold_geometry::{Crease, DVec2, FoldLine, OutlinePoint, PlanarCurve, Tolerance, polygon};

/// A fold line may end this many half widths before or after the crease does: a crease that meets the
/// outline at less than 9.5° runs along it rather than ending on it.
const MOST_SHIFT: f64 = 6.0;
/// Creases are run on past the outline by so many half widths, enough for [`MOST_SHIFT`].
const RUN_ON: f64 = 1.0 + MOST_SHIFT;
/// Shortest run past the outline, as a share of the sheet.
const LEAST_RUN_ON: f64 = 1e-3;

/// Fold lines keep this to their parallel curve unless the sheet is so small that its tolerances are finer:
/// half of the 0.01 mm that a band is held to.
const FINEST_CHORD_MM: f64 = 0.005;

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

/// A band on the sheet.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) figures: BandFigures,
    /// From right to left.
    pub(crate) lines: Vec<FoldLine>,
    closed: bool,
}

impl Shape {
    /// The band of a crease.
    ///
    /// # Errors
    /// A softness that is none, or a band that does not fit.
    pub(crate) fn new(sheet: &Sheet, crease: &Crease, softness: &CreaseSoftness) -> Result<Self, Problem> {
        let figures = BandFigures::new(softness)?;
        let half_width_mm = 0.5 * figures.band_width_mm;
        let runs = ends_on_boundary(sheet, &crease.curve);
        let run_on = (RUN_ON * half_width_mm).max(LEAST_RUN_ON * sheet.boundary.size_mm());
        let sampling = Sampling {
            half_width_mm,
            chord_mm: FINEST_CHORD_MM.min(sheet.tolerance.join_mm).max(sheet.tolerance.chord_mm),
            run_on_mm: runs.map(|r| if r { run_on } else { 0.0 }),
        };
        let spine = Spine::new(&crease.curve, &sampling)?;
        refuse_tight(&spine, half_width_mm)?;
        let clip = Clip { sheet, spine: &spine, runs, half_width_mm };
        let lines = figures.lines(softness.fold_angle_rad);
        let lines = lines.into_iter().map(|(o, turn)| clip.line(o, turn)).collect::<Result<Vec<_>, _>>()?;
        let shape = Self { figures, lines, closed: spine.closed };
        shape.refuse_boundary_inside(sheet, &crease.curve)?;
        shape.refuse_self_overlap()?;
        Ok(shape)
    }

    /// Where this band reaches another.
    pub(crate) fn meets(&self, other: &Self, slack_mm: f64) -> Option<DVec2> {
        let sharp = self.lines.len() == 1 && other.lines.len() == 1;
        for a in self.edges() {
            for b in other.edges() {
                // Sharp creases may share an end on the outline.
                let shared = |p: DVec2| sharp && is_end(a, p, slack_mm) && is_end(b, p, slack_mm);
                if let Some(p) = crossings(a, b).find(|&p| !shared(p)) {
                    return Some(p);
                }
            }
        }
        let middle = |s: &Self| middle_of(&s.lines[0].points);
        let (mine, others) = (middle(self), middle(other));
        [(self, others), (other, mine)].into_iter().find(|(s, p)| s.contains(*p)).map(|(_, p)| p)
    }

    /// The outer fold lines; one of a sharp crease.
    fn edges(&self) -> impl Iterator<Item = &[DVec2]> {
        let last = self.lines.len() - 1;
        let outer = if last == 0 { vec![0] } else { vec![0, last] };
        outer.into_iter().map(|i| self.lines[i].points.as_slice())
    }

    /// Whether a point is inside the band.
    fn contains(&self, p: DVec2) -> bool {
        if self.lines.len() == 1 {
            return false;
        }
        let (right, left) = (&self.lines[0].points, &self.lines[self.lines.len() - 1].points);
        if self.closed {
            return polygon::contains(right, p) != polygon::contains(left, p);
        }
        let around: Vec<DVec2> = right.iter().chain(left.iter().rev()).copied().collect();
        polygon::contains(&around, p)
    }

    /// Refuses a band with a piece of the boundary in it, other than where it ends.
    fn refuse_boundary_inside(&self, sheet: &Sheet, crease: &PlanarCurve) -> Result<(), Problem> {
        if self.lines.len() == 1 {
            return Ok(());
        }
        let ends = self.end_arcs(sheet, crease)?;
        for (id, p) in sheet.boundary.corners() {
            if !self.near(p) || !self.contains(p) {
                continue;
            }
            let s_mm = sheet.boundary.arc_length(id, p);
            let at_an_end = ends
                .iter()
                .any(|(l, arc)| *l == id && sheet.boundary.arc_has(id, *arc, s_mm, sheet.tolerance.join_mm));
            if !at_an_end {
                return Err(Problem::Misfit(Misfit::Boundary, p));
            }
        }
        Ok(())
    }

    /// The stretches of the boundary at which the band ends: right edge, crease, left edge.
    fn end_arcs(
        &self,
        sheet: &Sheet,
        crease: &PlanarCurve,
    ) -> Result<Vec<(softfold_geometry::LoopId, [f64; 3])>, Problem> {
        let (right, left) = (&self.lines[0], &self.lines[self.lines.len() - 1]);
        let mut arcs = Vec::new();
        for (side, s_mm) in [(0, 0.0), (1, crease.length_mm())] {
            let (Some(a), Some(b)) = (right.ends[side], left.ends[side]) else { continue };
            let end = crease.point(s_mm);
            let (middle, _) = sheet.boundary.nearest(end);
            if a.loop_id != middle.loop_id || b.loop_id != middle.loop_id {
                return Err(Problem::Misfit(Misfit::Boundary, end));
            }
            arcs.push((a.loop_id, [a.s_mm, middle.s_mm, b.s_mm]));
        }
        Ok(arcs)
    }

    /// Whether a point is in the band's box.
    fn near(&self, p: DVec2) -> bool {
        let inside = |(low, high): (DVec2, DVec2)| p.cmpge(low).all() && p.cmple(high).all();
        let boxes: Vec<_> = self.edges().map(polygon::bounds).collect();
        let all = boxes.iter().fold(boxes[0], |a, b| (a.0.min(b.0), a.1.max(b.1)));
        inside(all)
    }

    fn refuse_self_overlap(&self) -> Result<(), Problem> {
        let misfit = |at| Err(Problem::Misfit(Misfit::Itself, at));
        let edges: Vec<&[DVec2]> = self.edges().collect();
        if let [right, left] = edges[..] {
            for edge in [right, left] {
                if let Some(at) = self_crossing(edge, self.closed) {
                    return misfit(at);
                }
            }
            if let Some(at) = crossings(right, left).next() {
                return misfit(at);
            }
        }
        Ok(())
    }
}

/// Which ends of a crease are on the boundary.
fn ends_on_boundary(sheet: &Sheet, curve: &PlanarCurve) -> [bool; 2] {
    let on = |s: f64| sheet.boundary.nearest(curve.point(s)).1 <= sheet.tolerance.join_mm;
    if curve.is_closed() { [false; 2] } else { [on(0.0), on(curve.length_mm())] }
}

/// Refuses an edge that reaches the centre of curvature, where the parallel turns back.
fn refuse_tight(spine: &Spine, half_width_mm: f64) -> Result<(), Problem> {
    let tight = |at| Err(Problem::Misfit(Misfit::Curvature, at));
    for offset_mm in [-half_width_mm, half_width_mm] {
        if let Some(s) = spine.stations.iter().find(|s| s.curvature * offset_mm >= 1.0) {
            return tight(s.point);
        }
        let parallel = spine.offset_points(offset_mm);
        for (s, q) in spine.stations.windows(2).zip(parallel.windows(2)) {
            if (s[1].point - s[0].point).dot(q[1] - q[0]) <= 0.0 {
                return tight(s[0].point);
            }
        }
    }
    Ok(())
}

/// The clipping of a band's fold lines.
struct Clip<'a> {
    sheet: &'a Sheet,
    spine: &'a Spine,
    /// Which ends are on the boundary.
    runs: [bool; 2],
    half_width_mm: f64,
}

impl Clip<'_> {
    /// The parallel at `offset_mm` from where it enters the sheet to where it leaves it.
    fn line(&self, offset_mm: f64, turn_rad: f64) -> Result<FoldLine, Problem> {
        let points = self.spine.offset_points(offset_mm);
        let middle = self.spine.middle();
        let at_middle = along(&points, middle);
        if offset_mm != 0.0 && !self.sheet.boundary.contains(at_middle) {
            return Err(Problem::Misfit(Misfit::Boundary, at_middle));
        }
        let mut crossings = self.sheet.boundary.crossings(&points);
        let after = crossings.split_off(crossings.partition_point(|c| c.place <= middle));
        crossings.reverse();
        let start = self.end(0, &crossings, &points)?;
        let end = self.end(1, &after, &points)?;
        Ok(self.cut(offset_mm, turn_rad, &points, [start, end]))
    }

    /// The crossing at which a line ends, from those between the middle and beyond the end.
    fn end(&self, side: usize, outward: &[Crossing], points: &[DVec2]) -> Result<Option<Crossing>, Problem> {
        let join_mm = self.sheet.tolerance.join_mm;
        let at = |c: &Crossing| along(points, c.place);
        let misfit = |p| Err(Problem::Misfit(Misfit::Boundary, p));
        // Length from the crease's end to the crossing, positive towards the middle.
        let inward = |c: &Crossing| match side {
            0 => self.spine.s_mm(c.place),
            _ => self.spine.length_mm - self.spine.s_mm(c.place),
        };
        match (outward.first(), self.runs[side]) {
            (None, false) => Ok(None),
            (Some(first), false) => misfit(at(first)),
            (None, true) => misfit(if side == 0 { points[0] } else { points[points.len() - 1] }),
            (Some(first), true) => {
                let shift = inward(first);
                let returns = |c: &&Crossing| inward(c) > join_mm && shift - inward(c) > join_mm;
                match outward[1..].iter().find(returns) {
                    Some(c) => misfit(at(c)),
                    None if shift.abs() > MOST_SHIFT * self.half_width_mm + join_mm => misfit(at(first)),
                    None => Ok(Some(*first)),
                }
            }
        }
    }

    fn cut(&self, offset_mm: f64, turn_rad: f64, points: &[DVec2], ends: [Option<Crossing>; 2]) -> FoldLine {
        let [start, end] = ends.map(|c| c.map(|c| self.sheet.boundary.meet(self.spine, offset_mm, c)));
        let first = ends[0].map_or(0, |c| c.place as usize + 1);
        let last = ends[1].map_or(points.len(), |c| c.place.ceil() as usize);
        // Stations that almost coincide with the exact ends would make slivers.
        let apart = |p: &DVec2| {
            [start, end].iter().flatten().all(|(e, _)| e.distance(*p) > self.sheet.tolerance.chord_mm)
        };
        let inner = points.get(first..last).unwrap_or_default().iter().copied().filter(apart);
        let point = |e: Option<(DVec2, OutlinePoint)>| e.map(|e| e.0);
        let points: Vec<DVec2> = point(start).into_iter().chain(inner).chain(point(end)).collect();
        let turns_rad = vec![turn_rad; points.len()];
        FoldLine { offset_mm, points, turns_rad, ends: [start, end].map(|e| e.map(|e| e.1)) }
    }
}

/// A point near the middle of a polyline, never an end.
fn middle_of(points: &[DVec2]) -> DVec2 {
    0.5 * (points[(points.len() - 1) / 2] + points[points.len() / 2])
}

/// The point of a polyline at a place: piece number plus share of the piece.
fn along(points: &[DVec2], place: f64) -> DVec2 {
    let k = (place as usize).min(points.len() - 2);
    points[k].lerp(points[k + 1], place - k as f64)
}

/// Where two polylines cross.
fn crossings<'a>(a: &'a [DVec2], b: &'a [DVec2]) -> impl Iterator<Item = DVec2> + 'a {
    let (low, high) = polygon::bounds(b);
    let near = move |w: &&[DVec2]| w[0].max(w[1]).cmpge(low).all() && w[0].min(w[1]).cmple(high).all();
    a.windows(2).filter(near).flat_map(move |w| {
        b.windows(2).filter_map(move |v| {
            let apart =
                w[0].max(w[1]).cmplt(v[0].min(v[1])).any() || w[0].min(w[1]).cmpgt(v[0].max(v[1])).any();
            if apart {
                return None;
            }
            polygon::segment_crossing(w[0], w[1], v[0], v[1]).map(|(t, _)| w[0].lerp(w[1], t))
        })
    })
}

/// Where a polyline crosses itself.
fn self_crossing(points: &[DVec2], closed: bool) -> Option<DVec2> {
    let n = points.len() - 1;
    (0..n).find_map(|i| {
        let last = if closed && i == 0 { n - 1 } else { n };
        let rest = points.get(i + 2..=last).unwrap_or_default();
        crossings(&points[i..=i + 1], rest).next()
    })
}

fn is_end(line: &[DVec2], p: DVec2, slack_mm: f64) -> bool {
    [line[0], line[line.len() - 1]].iter().any(|e| e.distance(p) <= slack_mm)
}
