//! Points and constraints on the curves: outline, holes, slits, fold lines and the sides of junctions.

use crate::boundary::Boundaries;
use crate::cdt::{Constraint, PlanarGraph};
use crate::gaps::Piece;
use crate::planar::Planar;
use crate::rows::{Sample, rows};
use crate::shared::SharedPoints;
use crate::size::SizeField;
use crate::stretch::{Stretch, stretches};
use crate::tracks::{Span, Track};
use crate::{MeshOptions, overlap, places};
use glam::DVec2;
use softfold_geometry::{LineEnd, LoopId, OutlinePoint, Site, SoftPattern, VertexId, polygon};
use std::collections::BTreeSet;

/// Lines that pass a point of a slit within this share of the distance below which places are one go through it.
const TOUCH: f64 = 1e-6;

/// Collects points with their sites and the constraints between them.
pub(crate) struct GraphBuilder<'a> {
    soft: &'a SoftPattern,
    options: &'a MeshOptions,
    sizes: &'a SizeField,
    boundaries: &'a Boundaries<'a>,
    points: Vec<DVec2>,
    sites: Vec<Site>,
    constraints: Vec<([VertexId; 2], Constraint)>,
    /// The parts of tracks that constraints stand for.
    spans: Vec<Span>,
    tracks: Vec<Track<'a>>,
    /// Edges that have a constraint, lower vertex first.
    constrained: BTreeSet<[VertexId; 2]>,
    /// Per boundary curve: arc length and vertex of each point on it, ascending.
    on_curves: Vec<Vec<(f64, VertexId)>>,
    /// Vertices of the points in which lines meet.
    at_points: SharedPoints,
    /// Vertices of the meetings of boundary curves.
    at_meetings: Vec<Option<VertexId>>,
}

/// A line that leaves the chord between its ends by less than this share of it is straight.
const LEAST_BEND: f64 = 1e-3;

impl<'a> GraphBuilder<'a> {
    pub(crate) fn new(
        soft: &'a SoftPattern,
        options: &'a MeshOptions,
        boundaries: &'a Boundaries<'a>,
        sizes: &'a SizeField,
    ) -> Self {
        Self {
            soft,
            options,
            sizes,
            boundaries,
            points: vec![],
            sites: vec![],
            constraints: vec![],
            spans: vec![],
            tracks: vec![],
            constrained: BTreeSet::new(),
            on_curves: vec![Vec::new(); boundaries.curves.len()],
            // A line may end off its mark by as much as it may be off its curve.
            at_points: SharedPoints::new(soft.tolerance.chord_mm.min(boundaries.same_mm)),
            at_meetings: vec![None; boundaries.meetings.len()],
        }
    }

    pub(crate) fn build(mut self) -> Planar<'a> {
        (0..self.boundaries.curves.len()).for_each(|curve| self.boundary(curve));
        self.points.iter().enumerate().for_each(|(v, p)| self.at_points.insert(*p, VertexId::new(v)));
        for (meeting, vertex) in self.boundaries.meetings.iter().zip(&self.at_meetings) {
            if let Some(v) = vertex {
                self.at_points.insert(meeting.point, *v);
            }
        }
        let soft = self.soft;
        for (number, stretch) in soft.bands.iter().flat_map(stretches).enumerate() {
            self.stretch(&stretch, number as u32);
        }
        (0..soft.junctions.len()).for_each(|j| self.junction(j));
        let first_slit = soft.loops.len().min(self.on_curves.len());
        let on_slits = self.on_curves[first_slit..].iter().flatten().map(|p| p.1).collect();
        let graph = PlanarGraph { points: self.points, constraints: self.constraints };
        let mut planar = Planar { graph, sites: self.sites, spans: self.spans, tracks: self.tracks };
        overlap::cut_at(&mut planar, &on_slits, TOUCH * self.boundaries.same_mm);
        planar
    }

    fn vertex(&mut self, point: DVec2, site: Site) -> VertexId {
        self.points.push(point);
        self.sites.push(site);
        VertexId::new(self.points.len() - 1)
    }

    /// The vertex of a point that lines may share.
    fn shared_vertex(&mut self, point: DVec2, site: Site) -> VertexId {
        match self.at_points.find(point) {
            Some(known) => known,
            None => {
                let new = self.vertex(point, site);
                self.at_points.insert(point, new);
                new
            }
        }
    }

    /// Where two constraints would make one edge, the first one stays; ends that are one make none.
    fn constrain(&mut self, edge: [VertexId; 2], constraint: Constraint, places_mm: [f64; 2]) {
        if edge[0] != edge[1] && self.constrained.insert(sorted(edge)) {
            self.constraints.push((edge, constraint));
            // Edges are made track by track.
            let track = self.tracks.len() as u32 - 1;
            self.spans.push(Span { track, from_mm: places_mm[0], to_mm: places_mm[1] });
        }
    }

    fn boundary(&mut self, curve: usize) {
        let loop_id = LoopId::new(curve);
        let closed = self.boundaries.curves[curve].is_closed();
        let places = self.places_on(curve);
        self.tracks.push(Track::boundary(self.boundaries, curve));
        let mut vertices = Vec::with_capacity(places.len());
        for &s_mm in &places {
            let known = if closed { None } else { self.met(curve, s_mm) };
            let point = self.boundaries.curves[curve].point(s_mm);
            vertices.push(known.unwrap_or_else(|| self.vertex(point, Site::Boundary { loop_id, s_mm })));
        }
        let constraint = match curve.checked_sub(self.soft.loops.len()) {
            None => Constraint::Boundary { loop_id },
            Some(slit) => Constraint::Slit { slit: slit as u32 },
        };
        let edges = if closed { vertices.len() } else { vertices.len() - 1 };
        for i in 0..edges {
            let next = (i + 1) % vertices.len();
            let round = if next == 0 { self.boundaries.curves[curve].length_mm() } else { 0.0 };
            self.constrain([vertices[i], vertices[next]], constraint, [places[i], places[next] + round]);
        }
        self.on_curves[curve] = places.into_iter().zip(vertices).collect();
        self.meet(curve);
    }

    /// Arc lengths of the points on a boundary curve: its anchors, and enough between them.
    fn places_on(&self, curve: usize) -> Vec<f64> {
        let (line, anchors) = (self.boundaries.curves[curve], &self.boundaries.anchors[curve]);
        let total = line.length_mm();
        let closed = line.is_closed();
        let anchors = if anchors.is_empty() { &vec![0.0] } else { anchors };
        let mut places = Vec::new();
        for (i, &from) in anchors.iter().enumerate() {
            let to = match anchors.get(i + 1) {
                Some(&next) => next,
                None if closed => anchors[0] + total,
                None => from,
            };
            places.push(from);
            if to > from {
                let least = self.boundaries.least_pieces(curve);
                places.extend(places::graded(|s| line.point(s), from, to, least, self.sizes));
            }
        }
        if closed {
            places.iter_mut().for_each(|s| *s = s.rem_euclid(total));
            places.sort_by(f64::total_cmp);
        }
        places
    }

    /// The vertex that a curve made before has at a place of this one.
    fn met(&self, curve: usize, s_mm: f64) -> Option<VertexId> {
        let here = |&&(s, _): &&(f64, usize)| (s - s_mm).abs() < self.boundaries.same_mm;
        self.boundaries.met[curve].iter().filter(here).find_map(|&(_, meeting)| self.at_meetings[meeting])
    }

    /// Notes the vertices that a curve has at meetings.
    fn meet(&mut self, curve: usize) {
        for &(s_mm, meeting) in &self.boundaries.met[curve] {
            if self.at_meetings[meeting].is_none() {
                let place = OutlinePoint { loop_id: LoopId::new(curve), s_mm };
                self.at_meetings[meeting] = self.boundary_vertex(place);
            }
        }
    }

    /// All lines of a stretch get the same number of points: rows across the strips.
    fn stretch(&mut self, stretch: &Stretch<'a>, number: u32) {
        let mut lines = rows(stretch, self.options, self.sizes, 1);
        if stretch.is_sharp() && lines.iter().any(|samples| self.is_taken(stretch, samples)) {
            // Where ends became one and both are straight, the edge stands for both.
            let apart = rows(stretch, self.options, self.sizes, 2);
            if apart.iter().all(|samples| self.is_bent(stretch, samples)) {
                lines = apart;
            }
        }
        for (i, samples) in lines.iter().enumerate() {
            let line = stretch.first + i as u32;
            let rows = (!stretch.is_sharp()).then_some(number);
            self.tracks.push(Track::fold(stretch.band.crease, line, rows, &stretch.lines[i]));
            self.fold_line(stretch, i, samples);
        }
    }

    /// Whether a line of one piece would be an edge that another has.
    fn is_taken(&self, stretch: &Stretch<'_>, samples: &[Sample]) -> bool {
        let ends = stretch.lines[0].ends.iter().zip([samples.first(), samples.last()]);
        let mut known = ends.filter_map(|(end, sample)| self.known_end(*end, sample?.0));
        match (known.next(), known.next()) {
            (Some(a), Some(b)) => samples.len() == 2 && self.constrained.contains(&sorted([a, b])),
            _ => false,
        }
    }

    /// Whether a line of more than one piece leaves the edge between its ends' vertices.
    fn is_bent(&self, stretch: &Stretch<'_>, samples: &[Sample]) -> bool {
        let ends = stretch.lines[0].ends.iter().zip([samples.first(), samples.last()]);
        let mut known = ends.filter_map(|(end, sample)| self.known_end(*end, sample?.0));
        let (Some(a), Some(b)) = (known.next(), known.next()) else { return true };
        let [a, b] = [a, b].map(|v| self.points[v.index()]);
        let off = |s: &Sample| polygon::segment_distance(s.0, a, b);
        let least_mm = LEAST_BEND * a.distance(b);
        samples[1..samples.len() - 1].iter().any(|s| off(s) > least_mm)
    }

    fn known_end(&self, end: LineEnd, point: DVec2) -> Option<VertexId> {
        match end {
            LineEnd::Boundary(place) => self.boundary_vertex(place),
            _ => self.at_points.find(point),
        }
    }

    fn fold_line(&mut self, stretch: &Stretch<'_>, number: usize, samples: &[Sample]) {
        let (crease, line) = (stretch.band.crease, stretch.first + number as u32);
        let (site, ends) = (Site::FoldLine { crease, line }, stretch.lines[number].ends);
        let last = samples.len() - 1;
        let closed = samples[0].0 == samples[last].0;
        let mut vertices: Vec<VertexId> = Vec::with_capacity(samples.len());
        for (i, &(point, ..)) in samples.iter().enumerate() {
            let end = match i {
                0 => Some(ends[0]),
                i if i == last => Some(ends[1]),
                _ => None,
            };
            let vertex = match end {
                Some(LineEnd::Boundary(place)) => self.boundary_vertex(place),
                Some(_) if closed && i == last => vertices.first().copied(),
                Some(_) => Some(self.shared_vertex(point, site)),
                None => None,
            };
            vertices.push(vertex.unwrap_or_else(|| self.vertex(point, site)));
        }
        for (i, w) in vertices.windows(2).enumerate() {
            let turn_rad = 0.5 * (samples[i].1 + samples[i + 1].1);
            let places_mm = [samples[i].2, samples[i + 1].2];
            self.constrain([w[0], w[1]], Constraint::Fold { crease, line, turn_rad }, places_mm);
        }
    }

    /// The vertex of a boundary curve nearest to a place.
    fn boundary_vertex(&self, end: OutlinePoint) -> Option<VertexId> {
        let curve = end.loop_id.index();
        let places = self.on_curves.get(curve).filter(|p| !p.is_empty())?;
        let total = self.boundaries.curves[curve].length_mm();
        let closed = self.boundaries.curves[curve].is_closed();
        let apart = |s: f64| {
            let d = (s - end.s_mm).abs();
            if closed { d.min(total - d).abs() } else { d }
        };
        let after = places.partition_point(|p| p.0 < end.s_mm);
        let near = [after.checked_sub(1).unwrap_or(places.len() - 1), after % places.len()];
        near.into_iter()
            .min_by(|&a, &b| apart(places[a].0).total_cmp(&apart(places[b].0)))
            .map(|i| places[i].1)
    }

    /// The sides of a junction's region, but for those that lie on the boundary.
    fn junction(&mut self, number: usize) {
        let constraint = Constraint::Junction { junction: number as u32 };
        for (a, b) in polygon::edges(&self.soft.junctions[number].polygon) {
            let ends = [a, b].map(|p| self.shared_vertex(p, Site::Interior));
            if ends[0] == ends[1] || self.constrained.contains(&sorted(ends)) || self.on_boundary(ends) {
                continue;
            }
            let length = a.distance(b);
            let along = |s: f64| a.lerp(b, s / length);
            let inner = places::graded(along, 0.0, length, 1, self.sizes);
            self.tracks.push(Track::side(number as u32, a, b));
            let mut from = (ends[0], 0.0);
            for s in inner {
                let to = self.vertex(along(s), Site::Interior);
                self.constrain([from.0, to], constraint, [from.1, s]);
                from = (to, s);
            }
            self.constrain([from.0, ends[1]], constraint, [from.1, length]);
        }
    }

    /// Whether a straight line between two vertices runs along the boundary.
    fn on_boundary(&self, ends: [VertexId; 2]) -> bool {
        let [Site::Boundary { loop_id, s_mm: a }, Site::Boundary { loop_id: other, s_mm: b }] =
            ends.map(|v| self.sites[v.index()])
        else {
            return false;
        };
        let curve = self.boundaries.curves[loop_id.index()];
        let [p, q] = ends.map(|v| self.points[v.index()]);
        let way = (b - a).abs();
        let total = curve.length_mm();
        let middle = if 2.0 * way <= total { 0.5 * (a + b) } else { 0.5 * (a + b + total) };
        loop_id == other
            && polygon::segment_distance(curve.point(middle), p, q) <= self.soft.tolerance.join_mm
    }
}

/// The pieces of all curves that keep their distance by the sizing field: boundaries, outer fold lines, and sides
/// of junctions.
pub(crate) fn pieces(soft: &SoftPattern, boundaries: &Boundaries<'_>) -> Vec<Piece> {
    let mut pieces = boundaries.pieces();
    let mut group = pieces.len();
    for stretch in soft.bands.iter().flat_map(stretches) {
        for line in stretch.outer_lines() {
            pieces.push(Piece { points: line.points.clone(), group, least_edges: 1.0 });
        }
        group += 1;
    }
    for (a, b) in soft.junctions.iter().flat_map(|j| polygon::edges(&j.polygon)).filter(|(a, b)| a != b) {
        pieces.push(Piece { points: vec![a, b], group, least_edges: 1.0 });
        group += 1;
    }
    pieces
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

/// The boundary polygons of a graph, by loop.
pub(crate) fn boundary_polygons(
    points: &[DVec2],
    constraints: &[([VertexId; 2], Constraint)],
    loops: usize,
) -> Vec<Vec<DVec2>> {
    let mut polygons = vec![Vec::new(); loops];
    for (edge, constraint) in constraints {
        if let Constraint::Boundary { loop_id } = constraint {
            polygons[loop_id.index()].push(points[edge[0].index()]);
        }
    }
    polygons
}
