//! What the pattern itself makes sharp: corners between two curves, and curves that all but touch. No mesh has larger
//! angles there; all other small angles are the mesher's own.

use crate::cdt::Constraint;
use crate::refine::Planar;
use crate::topology::{NONE, Topology};
use crate::tracks::Curve;
use glam::DVec2;
use softfold_geometry::{VertexId, polygon};

/// Corners below this have no mesh of 20° around them: next to a corner of angle φ the best that refinement promises is
/// `atan(sin φ / (2 − cos φ))` (G. Miller, S. Pav, N. Walkington, *When and why Ruppert's algorithm works*, 2003).
const SHARP_DEG: f64 = 23.5;
/// Corners below this make edges on one side split those on the other, ever shorter, unless both are split at like
/// distances (Ruppert 1995).
const ACUTE_DEG: f64 = 60.0;
/// Curves nearer to each other than this share of the target all but touch: edges as short as their distance would be
/// too many.
const NEAR: f64 = 1.0 / 64.0;

/// A corner between two constraints that follow each other around a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub(crate) vertex: VertexId,
    /// Between the curves themselves, rad.
    pub(crate) angle_rad: f64,
    /// Tracks of the two, counter-clockwise.
    pub(crate) tracks: [u32; 2],
    /// Directions of the two edges.
    sides: [DVec2; 2],
}

/// Corners and gaps of a graph.
pub(crate) struct Sharp {
    /// Constraints at each vertex, in one flat array.
    starts: Vec<u32>,
    ties: Vec<u32>,
    /// Below 60°, by vertex.
    pub(crate) acute: Vec<Corner>,
    /// Their tracks, lower first, and numbers.
    by_tracks: Vec<([u32; 2], u32)>,
    pub(crate) near_mm: f64,
}

/// What excuses a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Excuse {
    /// It fills a corner: number among the acute ones.
    Corner(usize),
    /// It lies between two curves, or on a piece of a curve, so near or so short, mm.
    Gap { curves: [Curve; 2], gap_mm: f64, at: DVec2 },
}

impl Sharp {
    pub(crate) fn new(planar: &Planar<'_>, target_mm: f64) -> Self {
        let (starts, ties) = ties(planar);
        let mut sharp = Self { starts, ties, acute: vec![], by_tracks: vec![], near_mm: NEAR * target_mm };
        for v in 0..planar.graph.points.len() {
            sharp.corners(planar, VertexId::new(v));
        }
        let tracks = |(i, c): (usize, &Corner)| {
            ([c.tracks[0].min(c.tracks[1]), c.tracks[0].max(c.tracks[1])], i as u32)
        };
        sharp.by_tracks = sharp.acute.iter().enumerate().map(tracks).collect();
        sharp.by_tracks.sort_unstable();
        sharp
    }

    /// Constraints at a vertex.
    pub(crate) fn at(&self, v: VertexId) -> &[u32] {
        &self.ties[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }

    fn corners(&mut self, planar: &Planar<'_>, vertex: VertexId) {
        let mut ends: Vec<(f64, u32, usize)> = Vec::new();
        let here = planar.graph.points[vertex.index()];
        for &c in self.at(vertex) {
            let edge = planar.graph.constraints[c as usize].0;
            let end = usize::from(edge[1] == vertex);
            let away = planar.graph.points[edge[1 - end].index()] - here;
            ends.push((away.to_angle(), c, end));
        }
        ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for i in 0..if ends.len() < 2 { 0 } else { ends.len() } {
            let [first, second] = [ends[i], ends[(i + 1) % ends.len()]];
            let is_boundary =
                |c: u32| matches!(planar.graph.constraints[c as usize].1, Constraint::Boundary { .. });
            let outside = (is_boundary(first.1) && first.2 == 1) || (is_boundary(second.1) && second.2 == 0);
            let drawn = (second.0 - first.0).rem_euclid(std::f64::consts::TAU);
            if outside || drawn > std::f64::consts::FRAC_PI_2 {
                continue;
            }
            let leaving = |(_, c, end): (f64, u32, usize)| {
                let span = &planar.spans[c as usize];
                planar.tracks[span.track as usize].leaving(span, end)
            };
            let angle_rad = leaving(first).angle_to(leaving(second)).max(0.0);
            if angle_rad < ACUTE_DEG.to_radians() {
                self.acute.push(Corner {
                    vertex,
                    angle_rad,
                    tracks: [first.1, second.1].map(|c| planar.spans[c as usize].track),
                    sides: [first.0, second.0].map(DVec2::from_angle),
                });
            }
        }
    }

    /// The acute corners at a vertex.
    pub(crate) fn acute_at(&self, v: VertexId) -> impl Iterator<Item = (usize, &Corner)> {
        let first = self.acute.partition_point(|c| c.vertex < v);
        self.acute.iter().enumerate().skip(first).take_while(move |(_, c)| c.vertex == v)
    }

    /// The acute corners between two tracks.
    pub(crate) fn acute_between(&self, [a, b]: [u32; 2]) -> impl Iterator<Item = &Corner> {
        let pair = [a.min(b), a.max(b)];
        let first = self.by_tracks.partition_point(|(tracks, _)| *tracks < pair);
        self.by_tracks[first..]
            .iter()
            .take_while(move |(t, _)| *t == pair)
            .map(|(_, i)| &self.acute[*i as usize])
    }

    /// Whether the pattern keeps a triangle from having larger angles.
    pub(crate) fn excuse(&self, planar: &Planar<'_>, topology: &Topology, t: usize) -> Option<Excuse> {
        (0..3)
            .find_map(|k| self.corner(planar, topology.triangles[t], k))
            .or_else(|| self.gap(planar, topology, t))
    }

    fn corner(&self, planar: &Planar<'_>, triangle: [VertexId; 3], k: usize) -> Option<Excuse> {
        let p = triangle.map(|v| planar.graph.points[v.index()]);
        let sides = [p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]];
        let fills = |c: &Corner| {
            let slack = |a: DVec2, b: DVec2| a.perp_dot(b) > -1e-9 * a.length() * b.length();
            slack(c.sides[0], sides[0]) && slack(sides[1], c.sides[1]) && sides[0].dot(c.sides[0]) > 0.0
        };
        self.acute_at(triangle[k])
            .find(|(_, c)| c.angle_rad < SHARP_DEG.to_radians() && fills(c))
            .map(|(i, _)| Excuse::Corner(i))
    }

    /// Whether two curves that pass each other, or the ends of a short piece of one, are too near.
    fn gap(&self, planar: &Planar<'_>, topology: &Topology, t: usize) -> Option<Excuse> {
        let (corners, p) = (topology.triangles[t], topology.corners(&planar.graph.points, t));
        let track = |c: u32| planar.spans[c as usize].track;
        for k in 0..3 {
            let [u, v, w] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let [a, b, c] = [0, 1, 2].map(|i| p[(k + i) % 3]);
            let wall = topology.walls[t][k];
            let at = 0.5 * (a + b);
            if a.distance(b) < self.near_mm {
                let curves = if wall == NONE {
                    self.strangers(planar, u, v)
                } else if self.is_pinned(planar, u) && self.is_pinned(planar, v) {
                    Some([planar.tracks[track(wall) as usize].curve; 2])
                } else {
                    None
                };
                if let Some(curves) = curves {
                    return Some(Excuse::Gap { curves, gap_mm: a.distance(b), at });
                }
            }
            let height = polygon::segment_distance(c, a, b);
            if wall != NONE && height < self.near_mm {
                let other =
                    self.at(w).iter().map(|&o| track(o)).find(|o| is_strange(planar, *o, track(wall)));
                if let (Some(other), true) = (other, !self.shares(planar, w, track(wall))) {
                    let curves = [track(wall), other].map(|t| planar.tracks[t as usize].curve);
                    return Some(Excuse::Gap { curves, gap_mm: height, at: c });
                }
            }
        }
        None
    }

    /// Two curves of different bands on which two vertices lie, if they have none in common.
    fn strangers(&self, planar: &Planar<'_>, u: VertexId, v: VertexId) -> Option<[Curve; 2]> {
        let track = |c: &u32| planar.spans[*c as usize].track;
        let (mine, others) = (self.at(u), self.at(v));
        let (&a, &b) = (mine.first()?, others.first()?);
        let strange = mine.iter().all(|m| others.iter().all(|o| is_strange(planar, track(m), track(o))));
        strange.then(|| [a, b].map(|c| planar.tracks[track(&c) as usize].curve))
    }

    fn shares(&self, planar: &Planar<'_>, v: VertexId, track: u32) -> bool {
        self.at(v).iter().any(|&c| !is_strange(planar, planar.spans[c as usize].track, track))
    }

    /// The two constraints of a vertex that may slide along its curve, in the curve's direction; none where the pattern
    /// itself has a point, or inside.
    pub(crate) fn slide(&self, planar: &Planar<'_>, v: VertexId) -> Option<[u32; 2]> {
        let &[a, b] = self.at(v) else { return None };
        let arrives = |c: u32| planar.graph.constraints[c as usize].0[1] == v;
        let pair = match (arrives(a), arrives(b)) {
            (true, false) => [a, b],
            (false, true) => [b, a],
            _ => return None,
        };
        let [before, after] = pair.map(|c| planar.spans[c as usize]);
        let track = &planar.tracks[before.track as usize];
        let goes_on = before.track == after.track && before.to_mm == after.from_mm;
        (goes_on && !track.is_anchor(before.to_mm)).then_some(pair)
    }

    fn is_pinned(&self, planar: &Planar<'_>, v: VertexId) -> bool {
        !self.at(v).is_empty() && self.slide(planar, v).is_none()
    }
}

/// Whether two tracks keep no rows together.
fn is_strange(planar: &Planar<'_>, a: u32, b: u32) -> bool {
    let stretch = |t: u32| planar.tracks[t as usize].stretch;
    a != b && (stretch(a).is_none() || stretch(a) != stretch(b))
}

fn ties(planar: &Planar<'_>) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; planar.graph.points.len() + 1];
    let edges = || planar.graph.constraints.iter().map(|(e, _)| e);
    edges().flatten().for_each(|v| starts[v.index() + 1] += 1);
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut ties = vec![0; 2 * planar.graph.constraints.len()];
    for (c, edge) in edges().enumerate() {
        for v in edge {
            ties[next[v.index()] as usize] = c as u32;
            next[v.index()] += 1;
        }
    }
    (starts, ties)
}
