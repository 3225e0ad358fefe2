//! Where the ends of creases are: inside the sheet, on its boundary, or where creases meet.

use crate::boundary::Boundary;
use softfold_geometry::{Crease, CreaseEnd, CreasePattern, DVec2, Junction, LoopId};
use std::f64::consts::TAU;

/// The direction of a boundary curve at a point is that of its chord over so many join tolerances: the
/// tangent, but for corners that rounding makes.
const RAY_JOINS: f64 = 10.0;

/// What a crease ends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EndKind {
    /// Nothing.
    Free,
    /// Outline, hole or slit.
    Boundary,
    /// The meeting with this number.
    Meeting(usize),
}

/// Ends of creases that meet with no boundary between them.
#[derive(Clone, Debug)]
pub(crate) struct Meeting {
    pub(crate) point: DVec2,
    /// Counter-clockwise; on the boundary from the first one inside the sheet on.
    pub(crate) ends: Vec<CreaseEnd>,
    /// If the point is on the boundary: the directions of the boundary clockwise and counter-clockwise of
    /// the ends.
    pub(crate) walls: Option<[DVec2; 2]>,
}

/// The ends of all creases.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// By crease: start and end.
    pub(crate) ends: Vec<[EndKind; 2]>,
    pub(crate) meetings: Vec<Meeting>,
}

impl Layout {
    pub(crate) fn new(pattern: &CreasePattern, boundary: &Boundary, join_mm: f64) -> Self {
        let on_boundary = |p: DVec2| boundary.nearest(p).1 <= join_mm;
        let kind = |p: DVec2| if on_boundary(p) { EndKind::Boundary } else { EndKind::Free };
        let ends = pattern.creases.iter().map(|c| match c.curve.is_closed() {
            true => [EndKind::Free; 2],
            false => [0, 1].map(|side| kind(c.curve.end(side))),
        });
        let mut layout = Self { ends: ends.collect(), meetings: Vec::new() };
        for junction in pattern.junctions() {
            let rays = boundary_rays(boundary, junction.point, join_mm);
            for meeting in meetings_of(pattern, junction, &rays) {
                let number = layout.meetings.len();
                for end in &meeting.ends {
                    layout.ends[end.crease.index()][end.side] = EndKind::Meeting(number);
                }
                layout.meetings.push(meeting);
            }
        }
        layout
    }

    /// Whether a crease ends at its start, where it meets no other.
    pub(crate) fn is_ring(&self, crease: &Crease) -> bool {
        crease.curve.is_closed() && self.ends[crease.id.index()] == [EndKind::Free; 2]
    }
}

/// Directions in which boundary curves leave a point, counter-clockwise.
fn boundary_rays(boundary: &Boundary, point: DVec2, join_mm: f64) -> Vec<DVec2> {
    let step = RAY_JOINS * join_mm;
    let mut rays: Vec<DVec2> = Vec::new();
    for id in boundary.curves_at(point, join_mm) {
        rays.extend(rays_of(boundary, id, point, step));
    }
    rays.sort_by(|a, b| a.to_angle().total_cmp(&b.to_angle()));
    rays
}

fn rays_of(boundary: &Boundary, id: LoopId, point: DVec2, step: f64) -> Vec<DVec2> {
    let curve = boundary.curve(id);
    let s = curve.nearest(point).0;
    let places = [s - step, s + step];
    let on = |p: &f64| curve.is_closed() || (*p >= 0.0 && *p <= curve.length_mm());
    places.into_iter().filter(on).map(|p| (curve.point(p) - point).normalize_or_zero()).collect()
}

/// The parts of a junction between neighbouring boundary curves, as far as two ends or more meet there.
fn meetings_of(pattern: &CreasePattern, junction: Junction, rays: &[DVec2]) -> Vec<Meeting> {
    let point = junction.point;
    if rays.is_empty() {
        return vec![Meeting { point, ends: junction.ends, walls: None }];
    }
    let leaving = |e: &CreaseEnd| pattern.creases[e.crease.index()].curve.leaving(e.side);
    let sector = |i: usize| {
        let walls = [rays[i], rays[(i + 1) % rays.len()]];
        let whole = if rays.len() == 1 { TAU } else { turn_ccw(walls[0], walls[1]) };
        let mut inside: Vec<(f64, CreaseEnd)> =
            junction.ends.iter().map(|e| (turn_ccw(walls[0], leaving(e)), *e)).collect();
        inside.retain(|(angle, _)| *angle < whole);
        inside.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Meeting { point, ends: inside.into_iter().map(|(_, e)| e).collect(), walls: Some(walls) }
    };
    (0..rays.len()).map(sector).filter(|m| m.ends.len() > 1).collect()
}

/// The counter-clockwise turn from one direction to another, rad, from 0 to 2π.
pub(crate) fn turn_ccw(from: DVec2, to: DVec2) -> f64 {
    from.angle_to(to).rem_euclid(TAU)
}
