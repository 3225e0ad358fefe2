//! Outline, holes and slits: the places on them that need a vertex, and where they meet each other and junctions.

use crate::MeshOptions;
use crate::gaps::Piece;
use glam::DVec2;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};
use softfold_geometry::{LineEnd, PlanarCurve, SoftPattern, polygon};

/// The boundary curves of a pattern, by [`softfold_geometry::LoopId`].
pub(crate) struct Boundaries<'a> {
    pub(crate) curves: Vec<&'a PlanarCurve>,
    /// Per curve: ascending arc lengths that must have a vertex.
    pub(crate) anchors: Vec<Vec<f64>>,
    /// Points that several curves share.
    pub(crate) meetings: Vec<Meeting>,
    /// Per curve: arc length and number of each meeting on it.
    pub(crate) met: Vec<Vec<(f64, usize)>>,
    /// How near on a curve two places are one, mm.
    pub(crate) same_mm: f64,
    pub(crate) flat: Vec<Flat>,
}

/// A point that is on two curves, or on a curve and a junction.
pub(crate) struct Meeting {
    /// The point, as the junction or the slit that ends there has it.
    pub(crate) point: DVec2,
    /// Curves and arc lengths on them.
    pub(crate) places: Vec<(usize, f64)>,
}

/// A curve as a polyline with arc lengths; a closed one repeats its first point.
pub(crate) struct Flat {
    pub(crate) points: Vec<DVec2>,
    pub(crate) s_mm: Vec<f64>,
}

/// Corners sharper than this keep a vertex, rad.
const CORNER_RAD: f64 = 0.05;
/// Places on a curve closer than this share of the target, or of the narrowest row where that is less, are one.
const SAME_PLACE: f64 = 1e-3;
/// Ends of fold lines closer than this, in the same measure, to a corner, to where curves meet or to each other are
/// moved there: the sliver between them would have an angle of no degree.
const NEAR_CORNER: f64 = 1e-2;
/// A closed curve without corners needs so many edges.
const LEAST_PIECES_OF_A_LOOP: usize = 8;
/// A slit between two free tips opens only if there is a vertex between them.
const LEAST_PIECES_OF_A_SLIT: usize = 2;

type Side = GeomWithData<Line<[f64; 2]>, (usize, usize)>;

impl<'a> Boundaries<'a> {
    /// `narrowest_mm` is the length of the shortest rows.
    pub(crate) fn new(soft: &'a SoftPattern, options: &MeshOptions, narrowest_mm: f64) -> Self {
        let curves: Vec<&PlanarCurve> = soft.loops.iter().chain(&soft.slits).collect();
        let flat = curves.iter().map(|c| Flat::new(c, soft.tolerance.chord_mm)).collect();
        let same_mm = SAME_PLACE * options.target_edge_mm.min(narrowest_mm);
        let anchors = curves.iter().map(|c| corners(c)).collect();
        let met = vec![Vec::new(); curves.len()];
        let mut boundaries = Self { curves, anchors, meetings: vec![], met, same_mm, flat };
        boundaries.find_meetings(soft);
        let mut meetings = vec![Vec::new(); boundaries.curves.len()];
        for (i, meeting) in boundaries.meetings.iter().enumerate() {
            for &(curve, s_mm) in &meeting.places {
                meetings[curve].push(s_mm);
                boundaries.met[curve].push((s_mm, i));
            }
        }
        let mut ends = vec![Vec::new(); boundaries.curves.len()];
        let lines = soft.bands.iter().flat_map(|b| &b.fold_lines).flat_map(|l| l.ends);
        for end in lines.filter_map(LineEnd::on_boundary) {
            if let Some(ends) = ends.get_mut(end.loop_id.index()) {
                ends.push(end.s_mm);
            }
        }
        let near_mm = same_mm * NEAR_CORNER / SAME_PLACE;
        for (curve, (meetings, ends)) in meetings.into_iter().zip(ends).enumerate() {
            boundaries.anchor(curve, meetings, same_mm);
            boundaries.anchor(curve, ends, near_mm);
            boundaries.tidy_anchors(curve);
        }
        boundaries
    }

    /// Adds the places that are not as near as that to each other or to places known before.
    fn anchor(&mut self, curve: usize, mut places: Vec<f64>, near_mm: f64) {
        let (line, known) = (self.curves[curve], &mut self.anchors[curve]);
        let total = line.length_mm();
        let round = |s: f64| if line.is_closed() { [s - total, s, s + total] } else { [s; 3] };
        known.sort_by(f64::total_cmp);
        let is_known = |s: f64| {
            let next = known.partition_point(|k| *k < s - near_mm);
            known.get(next).is_some_and(|k| *k <= s + near_mm)
        };
        places.retain(|s| !round(*s).into_iter().any(is_known));
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| *a - *b < near_mm);
        known.extend(places);
    }

    /// Sorted, and places that are one only once.
    fn tidy_anchors(&mut self, curve: usize) {
        let (length_mm, closed) = (self.curves[curve].length_mm(), self.curves[curve].is_closed());
        let (same, places) = (self.same_mm, &mut self.anchors[curve]);
        if !closed {
            // The ends of a slit come exactly, whatever lies close to them.
            places.retain(|s| (same..=length_mm - same).contains(s));
            places.extend([0.0, length_mm]);
        }
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() < same);
        // The curve closes: a place just before its end is its start.
        let wraps = |p: &[f64]| p.len() > 1 && p[0] + length_mm - p[p.len() - 1] < same;
        if closed && wraps(places) {
            places.pop();
        }
    }

    /// Ends of slits and corners of junctions on boundaries, and slits that cross.
    fn find_meetings(&mut self, soft: &SoftPattern) {
        let (loops, join_mm) = (soft.loops.len(), soft.tolerance.join_mm);
        let sides = RTree::bulk_load(self.flat.iter().enumerate().flat_map(|(c, f)| f.sides(c)).collect());
        let mut meetings = Vec::new();
        for (i, slit) in soft.slits.iter().enumerate() {
            for (side, s_mm) in [(0, 0.0), (1, slit.length_mm())] {
                let mut places = self.on_curves(&sides, slit.end(side), join_mm, Some(loops + i));
                if !places.is_empty() {
                    places.push((loops + i, s_mm));
                    meetings.push(Meeting { point: slit.end(side), places });
                }
            }
            meetings.extend(self.crossings(&sides, loops, loops + i));
        }
        for junction in &soft.junctions {
            for &point in junction.polygon.iter().chain([&junction.point]) {
                let places = self.on_curves(&sides, point, join_mm, None);
                if !places.is_empty() {
                    meetings.push(Meeting { point, places });
                }
            }
        }
        self.meetings = meetings;
    }

    /// Where a point lies on curves, except for one.
    fn on_curves(
        &self,
        sides: &RTree<Side>,
        p: DVec2,
        join_mm: f64,
        not: Option<usize>,
    ) -> Vec<(usize, f64)> {
        let near = sides.locate_within_distance([p.x, p.y], 4.0 * join_mm * join_mm);
        let mut curves: Vec<usize> = near.map(|s| s.data.0).filter(|c| Some(*c) != not).collect();
        curves.sort_unstable();
        curves.dedup();
        let place = |curve: usize| {
            let (s_mm, distance) = self.curves[curve].nearest(p);
            (distance <= join_mm).then_some((curve, s_mm))
        };
        curves.into_iter().filter_map(place).collect()
    }

    /// Where a slit crosses slits of higher number, away from its ends and theirs.
    fn crossings(&self, sides: &RTree<Side>, loops: usize, slit: usize) -> Vec<Meeting> {
        let mut found = Vec::new();
        for (i, w) in self.flat[slit].points.windows(2).enumerate() {
            let envelope = AABB::from_corners(w[0].to_array(), w[1].to_array());
            let mut others: Vec<(usize, usize)> = sides
                .locate_in_envelope_intersecting(envelope)
                .map(|s| s.data)
                .filter(|(c, _)| *c >= loops && *c > slit)
                .collect();
            others.sort_unstable();
            for (other, k) in others {
                let with = &self.flat[other].points[k..k + 2];
                let Some((t, u)) = polygon::segment_crossing(w[0], w[1], with[0], with[1]) else { continue };
                let places = vec![(slit, self.flat[slit].at(i, t)), (other, self.flat[other].at(k, u))];
                if places
                    .iter()
                    .all(|&(c, s)| (self.same_mm..=self.curves[c].length_mm() - self.same_mm).contains(&s))
                {
                    found.push(Meeting { point: w[0].lerp(w[1], t), places });
                }
            }
        }
        found
    }

    /// Edges that each piece of a curve between anchors needs.
    pub(crate) fn least_pieces(&self, curve: usize) -> usize {
        match (self.curves[curve].is_closed(), self.anchors[curve].len()) {
            (true, 0 | 1) => LEAST_PIECES_OF_A_LOOP,
            (false, 0..=2) => LEAST_PIECES_OF_A_SLIT,
            _ => 1,
        }
    }

    /// The curves cut at their anchors.
    pub(crate) fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (c, anchors) in self.anchors.iter().enumerate() {
            let flat = &self.flat[c];
            let total = self.curves[c].length_mm();
            let mut cuts = anchors.clone();
            match (anchors.first(), self.curves[c].is_closed()) {
                (Some(first), true) => cuts.push(first + total),
                (None, _) => cuts.extend([0.0, total]),
                _ => {}
            }
            let least_edges = self.least_pieces(c) as f64;
            for cut in cuts.windows(2) {
                let points = flat.between(cut[0], cut[1], total);
                pieces.push(Piece { points, group: pieces.len(), least_edges });
            }
        }
        pieces
    }
}

impl Flat {
    fn new(curve: &PlanarCurve, chord_mm: f64) -> Self {
        let mut points = curve.flatten(chord_mm);
        if curve.is_closed() {
            points.extend(points.first().copied());
        }
        let mut s_mm = vec![0.0];
        for w in points.windows(2) {
            s_mm.push(s_mm[s_mm.len() - 1] + w[0].distance(w[1]));
        }
        // Chords are a little shorter than the curve.
        let scale = curve.length_mm() / s_mm[s_mm.len() - 1];
        s_mm.iter_mut().for_each(|s| *s *= scale);
        Self { points, s_mm }
    }

    fn sides(&self, curve: usize) -> Vec<Side> {
        let side = |(i, w): (usize, &[DVec2])| {
            GeomWithData::new(Line::new(w[0].to_array(), w[1].to_array()), (curve, i))
        };
        self.points.windows(2).enumerate().map(side).collect()
    }

    /// Arc length at a share of a side.
    fn at(&self, side: usize, t: f64) -> f64 {
        self.s_mm[side] + t * (self.s_mm[side + 1] - self.s_mm[side])
    }

    /// The point at an arc length up to twice the curve's.
    pub(crate) fn point(&self, s_mm: f64, total_mm: f64) -> DVec2 {
        let s = if s_mm > total_mm { s_mm - total_mm } else { s_mm };
        let i = self.s_mm.partition_point(|&v| v <= s).clamp(1, self.s_mm.len() - 1);
        let t = (s - self.s_mm[i - 1]) / (self.s_mm[i] - self.s_mm[i - 1]);
        self.points[i - 1].lerp(self.points[i], t.clamp(0.0, 1.0))
    }

    /// Points from one arc length to another, which may be past the end of a closed curve.
    fn between(&self, from: f64, to: f64, total_mm: f64) -> Vec<DVec2> {
        let inside = |s: f64| s > from && s < to;
        let rounds = [0.0, total_mm];
        let mut points = vec![self.point(from, total_mm)];
        for round in rounds {
            let here = self.points.iter().zip(&self.s_mm).filter(|(_, s)| inside(**s + round));
            points.extend(here.map(|(p, _)| *p));
        }
        points.push(self.point(to, total_mm));
        points.dedup();
        points
    }
}

/// Corners of a curve; of an open one those inside.
fn corners(curve: &PlanarCurve) -> Vec<f64> {
    let joints = curve.joints_mm();
    let count = curve.segments().len();
    let turn_at = |i: usize| {
        let step = 1e-6 * curve.length_mm();
        let before = curve.tangent(joints[i] - step);
        before.angle_to(curve.tangent(joints[i] + step)).abs()
    };
    let first = usize::from(!curve.is_closed());
    (first..count).filter(|&i| turn_at(i) > CORNER_RAD).map(|i| joints[i]).collect()
}
