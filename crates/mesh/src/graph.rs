//! Points and constraints on the curves: outline, holes and fold lines.

use crate::MeshOptions;
use crate::cdt::Constraint;
use crate::size::{SizeField, band_edge_mm};
use glam::DVec2;
use softfold_geometry::{
    Band, FoldLine, LoopId, OutlinePoint, PlanarCurve, Site, SoftPattern, VertexId, polygon,
};

/// Collects points with their sites and the constraints between them.
pub(crate) struct GraphBuilder<'a> {
    soft: &'a SoftPattern,
    options: &'a MeshOptions,
    sizes: &'a SizeField,
    points: Vec<DVec2>,
    sites: Vec<Site>,
    constraints: Vec<([VertexId; 2], Constraint)>,
    /// Per loop: arc length and vertex of each point on it.
    on_loops: Vec<Vec<(f64, VertexId)>>,
}

/// Points, constraints between them, and where they sit.
pub(crate) type Graph = (Vec<DVec2>, Vec<([VertexId; 2], Constraint)>, Vec<Site>);

/// Corners of the outline sharper than this keep a vertex, rad.
const CORNER_RAD: f64 = 0.05;
/// Pieces of a fold line: fewer would close a ring on itself.
const LEAST_PIECES: f64 = 3.0;
/// Arc lengths closer than this share of the local size are one point.
const SAME_PLACE: f64 = 1e-3;

impl<'a> GraphBuilder<'a> {
    pub(crate) fn new(soft: &'a SoftPattern, options: &'a MeshOptions, sizes: &'a SizeField) -> Self {
        let on_loops = vec![Vec::new(); soft.loops.len()];
        Self { soft, options, sizes, points: vec![], sites: vec![], constraints: vec![], on_loops }
    }

    pub(crate) fn build(mut self) -> Graph {
        for i in 0..self.soft.loops.len() {
            self.boundary(LoopId::new(i));
        }
        let soft = self.soft;
        soft.bands.iter().for_each(|b| self.band(b));
        (self.points, self.constraints, self.sites)
    }

    fn vertex(&mut self, point: DVec2, site: Site) -> VertexId {
        self.points.push(point);
        self.sites.push(site);
        VertexId::new(self.points.len() - 1)
    }

    fn boundary(&mut self, loop_id: LoopId) {
        let curve = &self.soft.loops[loop_id.index()];
        let places = places_on_loop(curve, &self.required_places(loop_id), self.sizes);
        let vertices: Vec<VertexId> = places
            .iter()
            .map(|&s_mm| self.vertex(curve.point(s_mm), Site::Boundary { loop_id, s_mm }))
            .collect();
        for (i, &v) in vertices.iter().enumerate() {
            self.constraints
                .push(([v, vertices[(i + 1) % vertices.len()]], Constraint::Boundary { loop_id }));
        }
        self.on_loops[loop_id.index()] = places.into_iter().zip(vertices).collect();
    }

    /// Arc lengths that must have a vertex: ends of fold lines, and corners.
    fn required_places(&self, loop_id: LoopId) -> Vec<f64> {
        let curve = &self.soft.loops[loop_id.index()];
        let ends = self.soft.bands.iter().flat_map(|b| &b.fold_lines).flat_map(|l| l.ends).flatten();
        let mut places: Vec<f64> = ends.filter(|e| e.loop_id == loop_id).map(|e| e.s_mm).collect();
        places.extend(corners(curve));
        places.sort_by(f64::total_cmp);
        let same = SAME_PLACE * self.options.target_edge_mm;
        places.dedup_by(|a, b| (*a - *b).abs() < same);
        // The curve closes: a place just before its end is its start.
        let wraps = |p: &[f64]| p.len() > 1 && p[0] + curve.length_mm() - p[p.len() - 1] < same;
        if wraps(&places) {
            places.pop();
        }
        places
    }

    /// All lines of a band get the same number of points: rows across the strips.
    fn band(&mut self, band: &Band) {
        let edge_mm = band_edge_mm(band, self.options);
        let longest = band.fold_lines.iter().map(|l| polygon::length_mm(&l.points)).fold(0.0, f64::max);
        let pieces = (longest / edge_mm).round().max(LEAST_PIECES) as usize;
        for (line, fold_line) in band.fold_lines.iter().enumerate() {
            self.fold_line(band, line as u32, fold_line, pieces);
        }
    }

    fn fold_line(&mut self, band: &Band, line: u32, fold_line: &FoldLine, pieces: usize) {
        let crease = band.crease;
        let samples = resampled(fold_line, pieces);
        let closed = fold_line.points.first() == fold_line.points.last();
        let mut vertices: Vec<VertexId> = Vec::with_capacity(pieces + 1);
        for (i, sample) in samples.iter().enumerate() {
            let end = match i {
                0 => fold_line.ends[0],
                i if i == pieces => fold_line.ends[1],
                _ => None,
            };
            let first = vertices.first().copied().filter(|_| closed && i == pieces);
            let known = first.or_else(|| end.and_then(|e| self.loop_vertex(e)));
            vertices.push(known.unwrap_or_else(|| self.vertex(sample.0, Site::FoldLine { crease, line })));
        }
        for (i, w) in vertices.windows(2).enumerate() {
            let turn_rad = 0.5 * (samples[i].1 + samples[i + 1].1);
            self.constraints.push(([w[0], w[1]], Constraint::Fold { crease, line, turn_rad }));
        }
    }

    fn loop_vertex(&self, end: OutlinePoint) -> Option<VertexId> {
        let total = self.soft.loops[end.loop_id.index()].length_mm();
        let apart = |s: f64| {
            let d = (s - end.s_mm).rem_euclid(total);
            d.min(total - d)
        };
        let places = &self.on_loops[end.loop_id.index()];
        places.iter().min_by(|a, b| apart(a.0).total_cmp(&apart(b.0))).map(|p| p.1)
    }
}

/// Vertices that a band asks for: rows along it times its lines, and as many again where the mesh grows coarser.
pub(crate) fn band_vertices(band: &Band, options: &MeshOptions) -> f64 {
    let longest = band.fold_lines.iter().map(|l| polygon::length_mm(&l.points)).fold(0.0, f64::max);
    let rows = longest / band_edge_mm(band, options);
    rows * (2 * band.fold_lines.len()) as f64
}

/// Points and turns at equal arc lengths of the fold line's polyline.
fn resampled(line: &FoldLine, pieces: usize) -> Vec<(DVec2, f64)> {
    let mut along = vec![0.0];
    for w in line.points.windows(2) {
        along.push(along[along.len() - 1] + w[0].distance(w[1]));
    }
    let total = along[along.len() - 1];
    let sample = |k: usize| {
        let s = total * k as f64 / pieces as f64;
        let i = along.partition_point(|&a| a <= s).clamp(1, along.len() - 1);
        let t = ((s - along[i - 1]) / (along[i] - along[i - 1])).clamp(0.0, 1.0);
        let turn = line.turns_rad[i - 1] * (1.0 - t) + line.turns_rad[i] * t;
        (line.points[i - 1].lerp(line.points[i], t), turn)
    };
    (0..=pieces).map(sample).collect()
}

fn corners(curve: &PlanarCurve) -> Vec<f64> {
    let joints = curve.joints_mm();
    let segments = curve.segments();
    let count = segments.len();
    let turn_at = |i: usize| {
        let step = 1e-6 * curve.length_mm();
        let before = curve.tangent(joints[i] - step);
        before.angle_to(curve.tangent(joints[i] + step)).abs()
    };
    (0..count).filter(|&i| turn_at(i) > CORNER_RAD).map(|i| joints[i]).collect()
}

/// Required places and enough between them to follow the sizing field.
fn places_on_loop(curve: &PlanarCurve, required: &[f64], sizes: &SizeField) -> Vec<f64> {
    let total = curve.length_mm();
    let anchors = if required.is_empty() { vec![0.0] } else { required.to_vec() };
    let mut places = Vec::new();
    for (i, &from) in anchors.iter().enumerate() {
        let to = if i + 1 < anchors.len() { anchors[i + 1] } else { anchors[0] + total };
        places.push(from);
        places.extend(graded_places(curve, from, to, sizes));
    }
    for s in &mut places {
        *s = s.rem_euclid(total);
    }
    places.sort_by(f64::total_cmp);
    places
}

/// Steps of the numerical integral of 1/size over one gap.
const INTEGRAL_STEPS: usize = 256;
/// A closed curve without corners needs three points or more.
const LEAST_PIECES_OF_A_LOOP: usize = 8;

/// Places strictly between `from` and `to` at equal shares of ∫ ds/size.
fn graded_places(curve: &PlanarCurve, from: f64, to: f64, sizes: &SizeField) -> Vec<f64> {
    let step = (to - from) / INTEGRAL_STEPS as f64;
    let mut integral = vec![0.0];
    for k in 0..INTEGRAL_STEPS {
        let s = from + (k as f64 + 0.5) * step;
        integral.push(integral[k] + step / sizes.at(curve.point(s)));
    }
    let whole = integral[INTEGRAL_STEPS];
    let least = if to - from >= curve.length_mm() { LEAST_PIECES_OF_A_LOOP } else { 1 };
    let pieces = (whole.round() as usize).max(least);
    let place = |k: usize| {
        let wanted = whole * k as f64 / pieces as f64;
        let i = integral.partition_point(|&v| v <= wanted).clamp(1, INTEGRAL_STEPS);
        let t = (wanted - integral[i - 1]) / (integral[i] - integral[i - 1]);
        from + (i as f64 - 1.0 + t) * step
    };
    (1..pieces).map(place).collect()
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
