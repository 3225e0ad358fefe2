//! Small angles are refined away: a point in the middle of the free space beside a bad triangle, or, where a constraint
//! is in the way, a point on the constraint's own curve.
//!
//! J. Ruppert, *A Delaunay refinement algorithm for quality 2-dimensional mesh generation* (1995), with the off-centres
//! of A. Üngör (2004). Constraints at acute corners are split at powers of two from the corner, and triangles between
//! such points are left (Miller, Pav, Walkington 2003). Unlike there, points go in by rounds of far-apart ones, each
//! followed by a whole triangulation, and splits follow curves instead of chords.

use crate::cdt::{Backend, Constraint, PlanarGraph, triangulate};
use crate::settle::{self, Aim};
use crate::sharp::Sharp;
use crate::topology::{NONE, Topology, least_angle_rad, shortest};
use crate::tracks::{Span, Track};
use crate::{MeshError, MeshOptions};
use glam::DVec2;
use softfold_geometry::{LoopId, Site, VertexId};

/// A graph whose constraints know the parts of curves that they stand for.
pub(crate) struct Planar<'a> {
    pub(crate) graph: PlanarGraph,
    pub(crate) sites: Vec<Site>,
    /// One a constraint.
    pub(crate) spans: Vec<Span>,
    pub(crate) tracks: Vec<Track<'a>>,
}

/// Every triangle shall have this angle, degrees: a little more than is promised, so that a bad one does not stop at it.
const GOAL_DEG: f64 = 22.0;
/// This much is held also between equally distant points beside an acute corner.
pub(crate) const BAR_DEG: f64 = 20.0;
/// Rounds of points; ten are enough for most sheets.
const ROUNDS: usize = 60;
/// Rounds after which points at angles below this are moved, degrees.
const SETTLE_EVERY: usize = 4;
const SETTLE_DEG: f64 = 30.0;
/// Moves before that, which see to the many triangles: at angles below this, degrees. New points ask for a second pass.
const PASSES: usize = 2;
const POLISHES: usize = 3;
const POLISH_DEG: f64 = 55.0;
/// No edge is split, and no point set, nearer than this share of the distance at which curves all but touch, or of the
/// narrowest row.
const FLOOR: f64 = 0.25;
/// A wall is split nearer to its middle than this share of its length from the ends.
const MARGIN: f64 = 0.2;
/// Points beyond those that came, as a share of them, and some more: a defect would add points for ever.
const MOST_NEW: f64 = 3.0;
const SOME_NEW: usize = 4000;

/// What makes a bad triangle better.
enum Cure {
    Point(DVec2),
    Split { constraint: u32, at_mm: f64 },
}

struct Round<'p, 'a> {
    planar: &'p Planar<'a>,
    topology: &'p Topology,
    sharp: &'p Sharp,
    floor_mm: f64,
    chord_mm: f64,
    /// Vertices around new points of this round.
    locked: Vec<bool>,
}

/// Adds points until no triangle has an angle below 20° that the pattern does not have itself.
pub(crate) fn refine(
    planar: &mut Planar<'_>,
    options: &MeshOptions,
    shortest_row_mm: f64,
) -> Result<(), MeshError> {
    let most = planar.graph.points.len() + (MOST_NEW * planar.graph.points.len() as f64) as usize + SOME_NEW;
    let chord_mm = options.chord * options.target_edge_mm;
    for _ in 0..PASSES {
        for _ in 0..POLISHES {
            settle::round(planar, options, chord_mm, (POLISH_DEG, Aim::Mean))?;
        }
        insert(planar, options, shortest_row_mm, most)?;
    }
    Ok(())
}

/// Rounds of points until no triangle asks for more, or `most` points are there.
fn insert(
    planar: &mut Planar<'_>,
    options: &MeshOptions,
    shortest_row_mm: f64,
    most: usize,
) -> Result<(), MeshError> {
    let chord_mm = options.chord * options.target_edge_mm;
    for number in 0..ROUNDS {
        let sharp = Sharp::new(planar, options.target_edge_mm);
        let topology = topology(planar, options.backend)?;
        let floor_mm = FLOOR * sharp.near_mm.min(shortest_row_mm);
        let locked = vec![false; planar.graph.points.len()];
        let cures = Round { planar, topology: &topology, sharp: &sharp, floor_mm, chord_mm, locked }.cures();
        if cures.is_empty() || planar.graph.points.len() > most {
            break;
        }
        cures.into_iter().for_each(|c| planar.apply(c));
        if number % SETTLE_EVERY == SETTLE_EVERY - 1 {
            settle::round(planar, options, chord_mm, (SETTLE_DEG, Aim::Least))?;
        }
    }
    Ok(())
}

pub(crate) fn topology(planar: &Planar<'_>, backend: Backend) -> Result<Topology, MeshError> {
    let triangles = triangulate(&planar.graph, backend)?.triangles;
    Ok(Topology::new(triangles, &planar.graph.constraints))
}

impl Round<'_, '_> {
    /// Points of this round, far enough apart not to know of each other: worst triangles first.
    fn cures(mut self) -> Vec<Cure> {
        let mut cures = self.bent();
        let goal = GOAL_DEG.to_radians();
        let points = &self.planar.graph.points;
        let angle = |t: usize| least_angle_rad(self.topology.corners(points, t));
        let mut bad: Vec<(f64, usize)> =
            (0..self.topology.triangles.len()).map(|t| (angle(t), t)).filter(|b| b.0 < goal).collect();
        bad.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (angle, t) in bad {
            if self.is_locked(t) || self.is_left(t, angle) {
                continue;
            }
            cures.extend(self.cure(t));
        }
        cures
    }

    /// Splits of constraints that are too far from their curves.
    fn bent(&mut self) -> Vec<Cure> {
        let mut cures = Vec::new();
        for t in 0..self.topology.triangles.len() {
            for k in 0..3 {
                let wall = self.topology.walls[t][k];
                if wall == NONE || self.is_locked(t) {
                    continue;
                }
                let (edge, span) =
                    (self.planar.graph.constraints[wall as usize].0, self.planar.spans[wall as usize]);
                let ends = edge.map(|v| self.planar.graph.points[v.index()]);
                let (error, at) = self.planar.tracks[span.track as usize].chord_error_mm(&span, ends);
                if error > self.chord_mm {
                    let margin = MARGIN * span.length_mm();
                    let at = at.clamp(span.from_mm + margin, span.to_mm - margin);
                    cures.extend(self.split_at(t, k, at));
                }
            }
        }
        cures
    }

    fn is_locked(&self, t: usize) -> bool {
        self.topology.triangles[t].iter().any(|v| self.locked[v.index()])
    }

    /// Whether a triangle stays as it is.
    fn is_left(&self, t: usize, angle_rad: f64) -> bool {
        self.sharp.excuse(self.planar, self.topology, t).is_some()
            || (angle_rad >= BAR_DEG.to_radians() && self.is_seditious(t))
    }

    /// Whether the shortest side joins points on both sides of an acute corner, equally far from it.
    fn is_seditious(&self, t: usize) -> bool {
        let p = self.topology.corners(&self.planar.graph.points, t);
        let k = shortest(p);
        let [u, v] = [0, 1].map(|i| self.topology.triangles[t][(k + i) % 3]);
        let track = |v: VertexId| match self.sharp.at(v) {
            [a, ..] => Some(self.planar.spans[*a as usize].track),
            [] => None,
        };
        let (Some(a), Some(b)) = (track(u), track(v)) else { return false };
        let alike = |at: DVec2| {
            let [r, s] = [p[k].distance(at), p[(k + 1) % 3].distance(at)];
            (r - s).abs() < 0.1 * r
        };
        self.sharp.acute_between([a, b]).any(|c| alike(self.planar.graph.points[c.vertex.index()]))
    }

    fn cure(&mut self, t: usize) -> Option<Cure> {
        let p = self.topology.corners(&self.planar.graph.points, t);
        let wanted = off_centre(p)?;
        let (mut here, from, mut entered) = (t, (p[0] + p[1] + p[2]) / 3.0, NONE);
        // A walk through a triangulation visits no triangle twice.
        for _ in 0..self.topology.triangles.len() {
            let Some(k) = self.way_out(here, entered, from, wanted) else { break };
            if self.topology.walls[here][k] != NONE {
                return self.split(here, k);
            }
            let next = self.topology.neighbours[here][k];
            if next == NONE {
                return None;
            }
            entered = here as u32;
            here = next as usize;
        }
        match self.encroached(here, wanted) {
            Some((t, k)) => self.split(t, k),
            None => self.set(here, wanted),
        }
    }

    /// The side through which the line towards a point leaves a triangle; none if the point is in it.
    fn way_out(&self, t: usize, entered: u32, from: DVec2, to: DVec2) -> Option<usize> {
        let p = self.topology.corners(&self.planar.graph.points, t);
        (0..3).find(|&k| {
            let (a, b) = (p[k], p[(k + 1) % 3]);
            let came = entered != NONE && self.topology.neighbours[t][k] == entered;
            let beyond = (b - a).perp_dot(to - a) < 0.0;
            let through = (to - from).perp_dot(a - from) <= 0.0 && (to - from).perp_dot(b - from) >= 0.0;
            !came && beyond && through
        })
    }

    /// A wall around a place in whose circle it is.
    fn encroached(&self, t: usize, at: DVec2) -> Option<(usize, usize)> {
        let around = self.topology.neighbours[t].into_iter().filter(|n| *n != NONE).map(|n| n as usize);
        let walls = std::iter::once(t).chain(around).flat_map(|t| [0, 1, 2].map(|k| (t, k)));
        let depth = |&(t, k): &(usize, usize)| {
            let p = self.topology.corners(&self.planar.graph.points, t);
            let (a, b) = (p[k] - at, p[(k + 1) % 3] - at);
            a.dot(b) / (a.length() * b.length())
        };
        let walls = walls.filter(|&(t, k)| self.topology.walls[t][k] != NONE);
        let (wall, depth) = walls.map(|w| (w, depth(&w))).min_by(|a, b| a.1.total_cmp(&b.1))?;
        (depth < 0.0).then_some(wall)
    }

    fn set(&mut self, t: usize, at: DVec2) -> Option<Cure> {
        let p = self.topology.corners(&self.planar.graph.points, t);
        let is_narrow = self.sharp.excuse(self.planar, self.topology, t).is_some();
        if is_narrow || self.is_locked(t) || p.iter().any(|q| q.distance(at) < self.floor_mm) {
            return None;
        }
        self.lock(t);
        for n in self.topology.neighbours[t] {
            if n != NONE {
                self.lock(n as usize);
            }
        }
        Some(Cure::Point(at))
    }

    fn lock(&mut self, t: usize) {
        self.topology.triangles[t].iter().for_each(|v| self.locked[v.index()] = true);
    }

    /// Splits a wall: in the middle, or beside an acute corner at a power of two from it.
    fn split(&mut self, t: usize, k: usize) -> Option<Cure> {
        let wall = self.topology.walls[t][k] as usize;
        let (edge, span) = (self.planar.graph.constraints[wall].0, self.planar.spans[wall]);
        let [a, b] = edge.map(|v| self.planar.graph.points[v.index()]);
        let is_acute = edge.map(|v| self.sharp.acute_at(v).any(|(_, c)| c.tracks.contains(&span.track)));
        let length = a.distance(b);
        let shell = 2.0_f64.powf((0.5 * length).log2().round()) / length * span.length_mm();
        let at = match is_acute {
            [true, false] => span.from_mm + shell,
            [false, true] => span.to_mm - shell,
            _ => 0.5 * (span.from_mm + span.to_mm),
        };
        self.split_at(t, k, at)
    }

    fn split_at(&mut self, t: usize, k: usize, at_mm: f64) -> Option<Cure> {
        let constraint = self.topology.walls[t][k];
        let span = self.planar.spans[constraint as usize];
        let points = &self.planar.graph.points;
        let new = self.planar.tracks[span.track as usize].point(at_mm);
        let ends = [k, (k + 1) % 3].map(|k| points[self.topology.triangles[t][k].index()]);
        if ends.iter().any(|e| e.distance(new) < self.floor_mm) {
            return None;
        }
        let beside: Vec<usize> = [t as u32, self.topology.neighbours[t][k]]
            .into_iter()
            .filter(|n| *n != NONE)
            .map(|n| n as usize)
            .collect();
        let stays = |&t: &usize| {
            let p = self.topology.corners(points, t);
            (0..3).filter(|&i| self.topology.walls[t][i] != constraint).all(|i| {
                let (a, b) = (p[i], p[(i + 1) % 3]);
                (b - a).perp_dot(new - a) > 0.0
            })
        };
        if beside.iter().any(|&t| self.is_locked(t)) || !beside.iter().all(stays) {
            return None;
        }
        beside.into_iter().for_each(|t| self.lock(t));
        Some(Cure::Split { constraint, at_mm })
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

impl Planar<'_> {
    fn apply(&mut self, cure: Cure) {
        match cure {
            Cure::Point(at) => {
                self.graph.points.push(at);
                self.sites.push(Site::Interior);
            }
            Cure::Split { constraint, at_mm } => self.split(constraint as usize, at_mm),
        }
    }

    fn split(&mut self, constraint: usize, at_mm: f64) {
        let [before, after] = self.spans[constraint].split(at_mm);
        let track = &self.tracks[before.track as usize];
        let new = VertexId::new(self.graph.points.len());
        self.graph.points.push(track.point(at_mm));
        let (edge, what) = self.graph.constraints[constraint];
        self.sites.push(self.site(before.track, at_mm, &what));
        self.graph.constraints[constraint].0 = [edge[0], new];
        self.graph.constraints.push(([new, edge[1]], what));
        self.spans[constraint] = before;
        self.spans.push(after);
        self.turn(constraint);
        self.turn(self.spans.len() - 1);
    }

    /// Where a vertex on a track sits.
    pub(crate) fn site(&self, track: u32, s_mm: f64, constraint: &Constraint) -> Site {
        let on_boundary = self.tracks[track as usize].on_boundary_mm(s_mm);
        match (*constraint, on_boundary) {
            (Constraint::Fold { crease, line, .. }, _) => Site::FoldLine { crease, line },
            (_, Some(s_mm)) => Site::Boundary { loop_id: LoopId(track), s_mm },
            _ => Site::Interior,
        }
    }

    /// A piece of a fold line turns by the mean of what its ends do.
    pub(crate) fn turn(&mut self, constraint: usize) {
        let span = self.spans[constraint];
        let track = &self.tracks[span.track as usize];
        let turns = [span.from_mm, span.to_mm].map(|s| track.turn_rad(s));
        if let (Constraint::Fold { turn_rad, .. }, [Some(a), Some(b)]) =
            (&mut self.graph.constraints[constraint].1, turns)
        {
            *turn_rad = 0.5 * (a + b);
        }
    }
}
