//! What the pattern itself makes sharp: corners between two curves, and curves that all but touch. No mesh has larger
//! angles there; all other small angles are the mesher's own.

use crate::cdt::Constraint;
use crate::net::{NONE, Net};
use crate::planar::Planar;
use crate::tracks::Curve;
use glam::DVec2;
use rstar::RTree;
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
    /// The two constraints, and which of their ends are here.
    ends: [(u32, usize); 2],
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
    /// Vertices that two tracks share, by the tracks, lower first.
    meetings: Vec<([u32; 2], VertexId)>,
    /// The points that the pattern itself has on its curves.
    pinned: RTree<[f64; 2]>,
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
        let near_mm = NEAR * target_mm;
        let pinned = RTree::new();
        let mut sharp =
            Self { starts, ties, acute: vec![], by_tracks: vec![], meetings: vec![], pinned, near_mm };
        let mut ends = Vec::new();
        for v in (0..planar.graph.points.len()).map(VertexId::new) {
            sharp.corners(planar, v, &mut ends);
            sharp.meet(planar, v);
        }
        let tracks = |(i, c): (usize, &Corner)| (sorted(c.tracks), i as u32);
        sharp.by_tracks = sharp.acute.iter().enumerate().map(tracks).collect();
        sharp.by_tracks.sort_unstable();
        sharp.meetings.sort_unstable();
        sharp.meetings.dedup();
        let points = planar.graph.points.iter().enumerate();
        let pinned =
            points.filter(|(v, _)| sharp.is_pinned(planar, VertexId::new(*v))).map(|(_, p)| p.to_array());
        sharp.pinned = RTree::bulk_load(pinned.collect());
        sharp
    }

    /// Takes note of a new vertex inside.
    pub(crate) fn add_free(&mut self) {
        self.starts.push(self.ties.len() as u32);
    }

    /// Takes note of the vertex, the last one, at which a constraint was split; the other part leads to `end`.
    pub(crate) fn add_split(&mut self, [part, other]: [u32; 2], end: VertexId) {
        let range = self.starts[end.index()] as usize..self.starts[end.index() + 1] as usize;
        self.ties[range].iter_mut().filter(|c| **c == part).for_each(|c| *c = other);
        let first = self.acute.partition_point(|c| c.vertex < end);
        for corner in self.acute[first..].iter_mut().take_while(|c| c.vertex == end) {
            corner.ends.iter_mut().filter(|e| **e == (part, 1)).for_each(|e| e.0 = other);
        }
        self.ties.extend([part, other]);
        self.starts.push(self.ties.len() as u32);
    }

    /// Constraints at a vertex.
    pub(crate) fn at(&self, v: VertexId) -> &[u32] {
        &self.ties[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }

    /// Notes which tracks meet at a vertex.
    fn meet(&mut self, planar: &Planar<'_>, v: VertexId) {
        let here = self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize;
        let track = |i: usize| planar.spans[self.ties[i] as usize].track;
        for i in here.clone() {
            for j in here.clone().skip_while(|j| *j <= i).filter(|j| track(*j) != track(i)) {
                self.meetings.push((sorted([track(i), track(j)]), v));
            }
        }
    }

    /// Finds the corners at a vertex; `ends` is room to work in.
    fn corners(&mut self, planar: &Planar<'_>, vertex: VertexId, ends: &mut Vec<(f64, u32, usize)>) {
        ends.clear();
        if let [a, b] = self.at(vertex)
            && away(planar, vertex, *a).1.dot(away(planar, vertex, *b).1) <= 0.0
        {
            return;
        }
        for &c in self.at(vertex) {
            let (end, away) = away(planar, vertex, c);
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
                let tracks = [first.1, second.1].map(|c| planar.spans[c as usize].track);
                let ends = [first, second].map(|(_, c, end)| (c, end));
                self.acute.push(Corner { vertex, angle_rad, tracks, ends });
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
        let pair = sorted([a, b]);
        let first = self.by_tracks.partition_point(|(tracks, _)| *tracks < pair);
        self.by_tracks[first..]
            .iter()
            .take_while(move |(t, _)| *t == pair)
            .map(|(_, i)| &self.acute[*i as usize])
    }

    /// Whether the pattern keeps a triangle from having larger angles.
    pub(crate) fn excuse(&self, planar: &Planar<'_>, net: &Net, t: usize) -> Option<Excuse> {
        let corners = net.corners[t].map(VertexId);
        if corners.iter().all(|v| self.at(*v).is_empty()) {
            return None;
        }
        (0..3).find_map(|k| self.corner(planar, corners, k)).or_else(|| self.gap(planar, net, t))
    }

    fn corner(&self, planar: &Planar<'_>, triangle: [VertexId; 3], k: usize) -> Option<Excuse> {
        let p = triangle.map(|v| planar.graph.points[v.index()]);
        let inner = [p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]];
        let fills = |c: &Corner| {
            let slack = |a: DVec2, b: DVec2| a.perp_dot(b) > -1e-9 * a.length() * b.length();
            let sides =
                c.ends.map(|(constraint, _)| away(planar, c.vertex, constraint).1.normalize_or_zero());
            slack(sides[0], inner[0]) && slack(inner[1], sides[1]) && inner[0].dot(sides[0]) > 0.0
        };
        self.acute_at(triangle[k])
            .find(|(_, c)| c.angle_rad < SHARP_DEG.to_radians() && fills(c))
            .map(|(i, _)| Excuse::Corner(i))
    }

    /// Whether two curves that pass each other, or the ends of a short piece of one, are too near.
    fn gap(&self, planar: &Planar<'_>, net: &Net, t: usize) -> Option<Excuse> {
        let p = net.places(&planar.graph.points, t);
        let track = |c: u32| planar.spans[c as usize].track;
        let is_near = |k: usize| p[k].distance_squared(p[(k + 1) % 3]) < self.near_mm * self.near_mm;
        for k in 0..3 {
            let [u, v, w] = [0, 1, 2].map(|i| VertexId(net.corners[t][(k + i) % 3]));
            let [a, b, c] = [0, 1, 2].map(|i| p[(k + i) % 3]);
            let wall = net.walls[t][k];
            if is_near(k) {
                let curves = if wall == NONE {
                    self.strangers(planar, u, v)
                } else if self.is_pinned(planar, u) && self.is_pinned(planar, v) {
                    Some([planar.tracks[track(wall) as usize].curve; 2])
                } else {
                    None
                };
                if let Some(curves) = curves {
                    return Some(Excuse::Gap { curves, gap_mm: a.distance(b), at: 0.5 * (a + b) });
                }
            }
            if wall == NONE || self.at(w).is_empty() {
                continue;
            }
            let height = polygon::segment_distance(c, a, b);
            if height < self.near_mm && !self.shares(planar, w, track(wall)) {
                let mut others = self.at(w).iter().map(|&o| track(o));
                let passes = |o: &u32| {
                    is_strange(planar, *o, track(wall)) && !self.parts(planar, [*o, track(wall)], c, height)
                };
                if let Some(other) = others.find(passes) {
                    let curves = [track(wall), other].map(|t| planar.tracks[t as usize].curve);
                    return Some(Excuse::Gap { curves, gap_mm: height, at: c });
                }
            }
        }
        None
    }

    /// Two curves of different bands on which two vertices lie, if they pass each other there.
    fn strangers(&self, planar: &Planar<'_>, u: VertexId, v: VertexId) -> Option<[Curve; 2]> {
        let track = |c: &u32| planar.spans[*c as usize].track;
        let (mine, others) = (self.at(u), self.at(v));
        let (&a, &b) = (mine.first()?, others.first()?);
        let [p, q] = [u, v].map(|v| planar.graph.points[v.index()]);
        let passes = |m: u32, o: u32| {
            is_strange(planar, m, o) && !self.parts(planar, [m, o], 0.5 * (p + q), p.distance(q))
        };
        let strange = mine.iter().all(|m| others.iter().all(|o| passes(track(m), track(o))));
        strange.then(|| [a, b].map(|c| planar.tracks[track(&c) as usize].curve))
    }

    /// Whether two tracks that are so near to each other at a place merely part from a point nearby, at an angle that
    /// leaves room for a mesh: at a distance `r` from a corner of angle φ its sides are `r sin φ` apart. Where the pattern
    /// has another point that near, there is no such room.
    fn parts(&self, planar: &Planar<'_>, tracks: [u32; 2], at: DVec2, gap_mm: f64) -> bool {
        let reach_mm = gap_mm / SHARP_DEG.to_radians().sin();
        let pair = sorted(tracks);
        let first = self.meetings.partition_point(|(tracks, _)| *tracks < pair);
        let mut shared = self.meetings[first..].iter().take_while(|(t, _)| *t == pair);
        let around = || self.pinned.locate_within_distance(at.to_array(), self.near_mm * self.near_mm);
        shared.any(|(_, v)| planar.graph.points[v.index()].distance(at) <= reach_mm)
            && around().nth(1).is_none()
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

/// Which end of a constraint a vertex is, and the way to the other end.
fn away(planar: &Planar<'_>, v: VertexId, constraint: u32) -> (usize, DVec2) {
    let edge = planar.graph.constraints[constraint as usize].0;
    let end = usize::from(edge[1] == v);
    (end, planar.graph.points[edge[1 - end].index()] - planar.graph.points[v.index()])
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshOptions;
    use crate::cdt::PlanarGraph;
    use crate::draft::Draft;
    use crate::tracks::{Span, Track};
    use softfold_geometry::{LoopId, Site};

    const SIDE_MM: f64 = 128.0;
    /// Curves nearer than 1 mm all but touch.
    const TARGET_MM: f64 = 64.0;

    /// A square, given by its sides with all points on them, and straight lines inside.
    fn draft(sides: [&[(f64, f64)]; 4], lines: &[&[(f64, f64)]]) -> Draft<'static> {
        let mut graph = PlanarGraph { points: vec![], constraints: vec![] };
        let (mut spans, mut tracks) = (vec![], vec![]);
        for (number, chain) in sides.iter().chain(lines).enumerate() {
            let what = match number < 4 {
                true => Constraint::Boundary { loop_id: LoopId(0) },
                false => Constraint::Junction { junction: 0 },
            };
            let places: Vec<DVec2> = chain.iter().map(|p| DVec2::from(*p)).collect();
            for w in places.windows(2) {
                let ends = [w[0], w[1]].map(|p| {
                    let known = graph.points.iter().position(|q| *q == p);
                    VertexId::new(known.unwrap_or_else(|| {
                        graph.points.push(p);
                        graph.points.len() - 1
                    }))
                });
                graph.constraints.push((ends, what));
                let [from_mm, to_mm] = [w[0], w[1]].map(|p| p.distance(places[0]));
                spans.push(Span { track: number as u32, from_mm, to_mm });
            }
            tracks.push(Track::side(0, places[0], places[places.len() - 1]));
        }
        let sites = vec![Site::Interior; graph.points.len()];
        let options = MeshOptions { target_edge_mm: TARGET_MM, ..MeshOptions::default() };
        Draft::new(crate::planar::Planar { graph, sites, spans, tracks }, &options).unwrap()
    }

    /// What excuses the triangle beside an edge that has its other corner farther from the origin.
    fn beside(draft: &Draft<'_>, edge: [(f64, f64); 2]) -> Option<Excuse> {
        let ends = edge.map(DVec2::from);
        let far = |t: &usize| {
            let p = draft.places(*t);
            let other = p.iter().find(|q| !ends.contains(q));
            ends.iter().all(|e| p.contains(e)) && other.is_some_and(|o| o.length() > 1.0)
        };
        let t = (0..draft.net.corners.len()).find(far).unwrap();
        draft.sharp.excuse(&draft.planar, &draft.net, t)
    }

    const S: f64 = SIDE_MM;
    const RIGHT: &[(f64, f64)] = &[(S, 0.0), (S, S)];
    const TOP: &[(f64, f64)] = &[(S, S), (0.0, S)];

    #[test]
    fn a_short_edge_beside_a_wide_corner_is_no_fault_of_the_pattern() {
        let bottom: &[(f64, f64)] = &[(0.0, 0.0), (0.3, 0.0), (S, 0.0)];
        let left: &[(f64, f64)] = &[(0.0, S), (0.0, 0.3), (0.0, 0.0)];
        let plain = draft([bottom, RIGHT, TOP, left], &[]);
        assert!(beside(&plain, [(0.3, 0.0), (0.0, 0.3)]).is_none());
        // The pattern has a point of its own there: a line that ends beside the corner.
        let line: &[(f64, f64)] = &[(0.3, 0.0), (100.0, 40.0)];
        let cramped = draft([bottom, RIGHT, TOP, left], &[line]);
        assert!(beside(&cramped, [(0.3, 0.0), (0.0, 0.3)]).is_some());
    }

    #[test]
    fn curves_that_pass_each_other_are_the_patterns() {
        let bottom: &[(f64, f64)] = &[(0.0, 0.0), (S, 0.0)];
        let left: &[(f64, f64)] = &[(0.0, S), (0.0, 0.0)];
        let [below, above]: [&[(f64, f64)]; 2] =
            [&[(20.0, 60.0), (60.0, 60.0), (100.0, 60.0)], &[(20.0, 60.5), (60.0, 60.5), (100.0, 60.5)]];
        let draft = draft([bottom, RIGHT, TOP, left], &[below, above]);
        assert!(matches!(
            beside(&draft, [(60.0, 60.0), (60.0, 60.5)]),
            Some(Excuse::Gap { gap_mm, .. }) if (gap_mm - 0.5).abs() < 1e-9
        ));
    }

    #[test]
    fn what_is_known_of_corners_goes_along_with_splits() {
        let bottom: &[(f64, f64)] = &[(0.0, 0.0), (S, 0.0)];
        let left: &[(f64, f64)] = &[(0.0, S), (0.0, 0.0)];
        let line: &[(f64, f64)] = &[(0.0, 0.0), (S, 20.0)];
        let right: &[(f64, f64)] = &[(S, 0.0), (S, 20.0), (S, S)];
        let mut draft = draft([bottom, right, TOP, left], &[line]);
        for _ in 0..40 {
            let sides = (0..draft.net.corners.len()).flat_map(|t| [0, 1, 2].map(|k| [t, k]));
            let length = |[t, k]: [usize; 2]| {
                let p = draft.places(t);
                p[k].distance(p[(k + 1) % 3])
            };
            let walls = sides.filter(|[t, k]| draft.net.walls[*t][*k] != NONE);
            let longest = walls.max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap();
            let span = draft.planar.spans[draft.net.walls[longest[0]][longest[1]] as usize];
            draft.split(longest, 0.5 * (span.from_mm + span.to_mm), &mut vec![]);
        }
        let fresh = Sharp::new(&draft.planar, TARGET_MM);
        let told = |sharp: &Sharp, t: usize| {
            format!("{:?}", sharp.excuse(&draft.planar, &draft.net, t).map(|e| std::mem::discriminant(&e)))
        };
        for t in 0..draft.net.corners.len() {
            assert_eq!(told(&draft.sharp, t), told(&fresh, t));
        }
        for v in (0..draft.points().len()).map(VertexId::new) {
            let sorted = |sharp: &Sharp| {
                let mut ties = sharp.at(v).to_vec();
                ties.sort_unstable();
                ties
            };
            assert_eq!(sorted(&draft.sharp), sorted(&fresh));
        }
        assert!(!fresh.acute.is_empty() && (0..draft.net.corners.len()).any(|t| draft.is_excused(t)));
    }
}
