//! Soft patterns built by hand, and what every mesh of one must fulfil.

#![allow(dead_code, reason = "each test file uses its share")]

use glam::DVec2;
use softfold_geometry::{
    Band, CreaseId, EdgeClass, FlatMesh, FoldLine, JunctionRegion, LineEnd, LoopId, OutlinePoint,
    PlanarCurve, Segment, SoftPattern, Softness, Tolerance, TriangleId, polygon,
};
use softfold_mesh::{Backend, MeshOptions, Meshed, crosscheck, mesh};
use std::collections::BTreeMap;

pub(crate) const SIZE_MM: f64 = 300.0;

pub(crate) fn rectangle(width: f64, height: f64) -> PlanarCurve {
    polyline(&[(0., 0.), (width, 0.), (width, height), (0., height), (0., 0.)])
}

pub(crate) fn polyline(points: &[(f64, f64)]) -> PlanarCurve {
    PlanarCurve::polyline(&points.iter().map(|&p| DVec2::from(p)).collect::<Vec<_>>()).unwrap()
}

/// A clockwise circle of four cubics.
pub(crate) fn hole(center: DVec2, radius: f64) -> PlanarCurve {
    let k = 0.5522847498;
    let at = |x: f64, y: f64| center + radius * DVec2::new(x, y);
    let quarter = |a: DVec2| {
        let b = DVec2::new(a.y, -a.x);
        Segment::Cubic {
            from: at(a.x, a.y),
            c1: at(a.x + k * b.x, a.y + k * b.y),
            c2: at(b.x + k * a.x, b.y + k * a.y),
            to: at(b.x, b.y),
        }
    };
    PlanarCurve::new([DVec2::X, -DVec2::Y, -DVec2::X, DVec2::Y].map(quarter).to_vec()).unwrap()
}

pub(crate) fn pattern(loops: Vec<PlanarCurve>, bands: Vec<Band>) -> SoftPattern {
    let tolerance = Tolerance::for_size(SIZE_MM);
    let soft = SoftPattern { loops, slits: vec![], bands, junctions: vec![], tolerance };
    soft.check().unwrap();
    soft
}

pub(crate) fn options(target_edge_mm: f64, backend: Backend) -> MeshOptions {
    MeshOptions { target_edge_mm, backend, ..MeshOptions::default() }
}

pub(crate) fn with_backends(test: impl Fn(MeshOptions)) {
    for backend in [Backend::Spade, Backend::Cgal] {
        test(options(15.0, backend));
    }
}

/// A straight crease, and how its band is cut into stretches.
#[derive(Clone, Debug)]
pub(crate) struct Straight {
    pub(crate) from: DVec2,
    pub(crate) direction: DVec2,
    pub(crate) segments: u32,
    pub(crate) profile: Vec<Softness>,
}

impl Straight {
    pub(crate) fn new(from: DVec2, direction: DVec2, radius_mm: f64, fold_angle_rad: f64) -> Self {
        let profile = vec![Softness { s_mm: 0.0, radius_mm, fold_angle_rad }];
        Self { from, direction: direction.normalize(), segments: 4, profile }
    }

    pub(crate) fn band(&self, id: u32) -> Band {
        let Self { segments, profile, .. } = self.clone();
        Band { crease: CreaseId(id), segments, profile, fold_lines: vec![] }
    }

    pub(crate) fn width_mm(&self, s_mm: f64) -> f64 {
        self.band(0).at(s_mm).unwrap().strip_width_mm(self.segments)
    }

    /// The point at an arc length with the offset of a rank.
    pub(crate) fn at(&self, rank: Option<u32>, s_mm: f64) -> DVec2 {
        self.from + s_mm * self.direction + self.offset_mm(rank, s_mm) * self.direction.perp()
    }

    fn offset_mm(&self, rank: Option<u32>, s_mm: f64) -> f64 {
        rank.map_or(0.0, |k| (f64::from(k) - 0.5 * f64::from(self.segments)) * self.width_mm(s_mm))
    }

    pub(crate) fn line(&self, rank: Option<u32>, s_mm: &[f64], ends: [LineEnd; 2]) -> FoldLine {
        let n = f64::from(self.segments);
        let share = match rank {
            None => 1.0,
            Some(k) if k == 0 || k == self.segments => 0.5 / n,
            Some(_) => 1.0 / n,
        };
        let turn = |s: &f64| share * self.band(0).at(*s).unwrap().fold_angle_rad;
        FoldLine {
            rank,
            points: s_mm.iter().map(|&s| self.at(rank, s)).collect(),
            s_mm: s_mm.to_vec(),
            offsets_mm: s_mm.iter().map(|&s| self.offset_mm(rank, s)).collect(),
            turns_rad: s_mm.iter().map(turn).collect(),
            ends,
        }
    }

    /// Where a line of constant offset leaves the rectangle: its arc length, and the place on the outline.
    pub(crate) fn exit(&self, rank: Option<u32>, width: f64, height: f64) -> (f64, LineEnd) {
        let (p, d) = (self.at(rank, 0.0), self.direction);
        let wall = |p: f64, d: f64, size: f64| {
            if d == 0.0 { f64::MAX } else { if d > 0.0 { (size - p) / d } else { -p / d } }
        };
        let t = wall(p.x, d.x, width).min(wall(p.y, d.y, height));
        (t, on_rectangle(p + t * d, width, height))
    }
}

/// The place on the outline of a rectangle.
pub(crate) fn on_rectangle(p: DVec2, width: f64, height: f64) -> LineEnd {
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    let s_mm = match p {
        p if near(p.y, 0.0) => p.x,
        p if near(p.x, width) => width + p.y,
        p if near(p.y, height) => 2.0 * width + height - p.x,
        p => 2.0 * (width + height) - p.y,
    };
    LineEnd::Boundary(OutlinePoint { loop_id: LoopId(0), s_mm })
}

/// A vertical band of four strips around u = `u` on a rectangle.
pub(crate) fn straight_band(id: u32, u: f64, width: f64, height: f64, radius_mm: f64) -> Band {
    let crease = Straight::new(DVec2::new(u, 0.0), DVec2::Y, radius_mm, 0.8);
    let mut band = crease.band(id);
    for k in 0..=crease.segments {
        let ends = [0.0, height].map(|s| on_rectangle(crease.at(Some(k), s), width, height));
        band.fold_lines.push(crease.line(Some(k), &[0.0, height], ends));
    }
    band
}

/// Creases from the middle of a square to its border: (direction in degrees, radius), each folded by 0.8 rad.
pub(crate) fn star(size_mm: f64, arms: &[(f64, f64)]) -> SoftPattern {
    let center = DVec2::splat(0.5 * size_mm);
    let mut arms = arms.to_vec();
    arms.sort_by(|a, b| a.0.total_cmp(&b.0));
    let creases: Vec<Straight> = arms
        .iter()
        .map(|&(deg, radius)| Straight::new(center, DVec2::from_angle(deg.to_radians()), radius, 0.8))
        .collect();
    let cut_mm = cut_mm(&creases);
    let mut junction = JunctionRegion { point: center, polygon: vec![], creases: vec![] };
    let mut bands = Vec::new();
    for (id, crease) in creases.iter().enumerate() {
        let mut band = crease.band(id as u32);
        let ranks: Vec<Option<u32>> = match crease.profile[0].radius_mm {
            0.0 => vec![None],
            _ => (0..=crease.segments).map(Some).collect(),
        };
        for rank in ranks {
            let (out, end) = crease.exit(rank, size_mm, size_mm);
            let line = crease.line(rank, &[cut_mm, out], [LineEnd::Junction(0), end]);
            if cut_mm > 0.0 {
                junction.polygon.push(line.points[0]);
            }
            band.fold_lines.push(line);
        }
        junction.creases.push(band.crease);
        bands.push(band);
    }
    let mut soft = pattern(vec![rectangle(size_mm, size_mm)], vec![]);
    (soft.bands, soft.junctions) = (bands, vec![junction]);
    soft.check().unwrap();
    soft
}

/// How far from the middle neighbouring bands are clear of each other; 0 if all are sharp.
fn cut_mm(creases: &[Straight]) -> f64 {
    let half = |c: &Straight| 2.0 * c.width_mm(0.0);
    if creases.iter().all(|c| half(c) == 0.0) {
        return 0.0;
    }
    let clear = |r: f64| {
        (0..creases.len()).all(|i| {
            let (a, b) = (&creases[i], &creases[(i + 1) % creases.len()]);
            let gap = a.direction.angle_to(b.direction).rem_euclid(std::f64::consts::TAU);
            (half(a) / r).atan() + (half(b) / r).atan() < 0.8 * gap
        })
    };
    (0..200).map(|k| 2.0 * 1.1_f64.powi(k)).find(|r| clear(*r)).unwrap()
}

/// What holds for each mesh of straight lines on straight-sided sheets; the mesh comes back.
pub(crate) fn sound(soft: &SoftPattern, options: &MeshOptions) -> FlatMesh {
    let meshed = mesh(soft, options).unwrap();
    let m = &meshed.mesh;
    m.check().unwrap();
    assert!((m.area_mm2() / soft.area_mm2() - 1.0).abs() < 1e-9, "area");
    fold_lines_are_whole(soft, m);
    free_edges_are_those_of_regions(soft, m);
    slits_are_open(soft, m);
    let Meshed { mesh, graph, .. } = meshed;
    let check = crosscheck(&graph).unwrap();
    assert!(check.agrees(), "{check:?}");
    mesh
}

/// Edges of every fold line add up to its length, so that no triangle crosses it; their turns are between its own.
fn fold_lines_are_whole(soft: &SoftPattern, m: &FlatMesh) {
    let mut lengths: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    for (i, e) in m.edges.iter().enumerate() {
        if let EdgeClass::Fold { crease, line, turn_rad } = e.class {
            *lengths.entry((crease.0, line)).or_default() +=
                m.edge_length_mm(softfold_geometry::EdgeId::new(i));
            let turns = &soft.bands[crease.index()].fold_lines[line as usize].turns_rad;
            let (lo, hi) = turns.iter().fold((f64::MAX, f64::MIN), |(l, h), &t| (l.min(t), h.max(t)));
            assert!(turn_rad >= lo - 1e-12 && turn_rad <= hi + 1e-12);
        }
    }
    for band in &soft.bands {
        for (line, l) in band.fold_lines.iter().enumerate() {
            let found = lengths.remove(&(band.crease.0, line as u32)).unwrap_or(0.0);
            let wanted = polygon::length_mm(&l.points);
            assert!((found / wanted - 1.0).abs() < 1e-9, "line {line} of {}: {found} {wanted}", band.crease);
        }
    }
    assert!(lengths.is_empty(), "{lengths:?}");
}

fn free_edges_are_those_of_regions(soft: &SoftPattern, m: &FlatMesh) {
    let mut borders = 0.0;
    for e in &m.edges {
        let [a, b] = e.vertices.map(|v| m.vertices[v.index()]);
        let middle = 0.5 * (a + b);
        let on_border = |p: &[DVec2]| {
            polygon::edges(p).any(|(c, d)| polygon::segment_distance(middle, c, d) < 1e-9 * SIZE_MM)
        };
        let border = soft.junctions.iter().any(|j| on_border(&j.polygon));
        let inside = soft.junctions.iter().any(|j| polygon::contains(&j.polygon, middle));
        if border {
            borders += a.distance(b);
        }
        assert_eq!(e.class == EdgeClass::Free, border || inside, "{a} {b} {:?}", e.class);
    }
    let wanted: f64 =
        soft.junctions.iter().flat_map(|j| polygon::edges(&j.polygon)).map(|(a, b)| a.distance(b)).sum();
    assert!((borders - wanted).abs() < 1e-9 * SIZE_MM, "{borders} {wanted}");
}

/// Both lips of each slit are as long as the slit.
fn slits_are_open(soft: &SoftPattern, m: &FlatMesh) {
    for (i, slit) in soft.slits.iter().enumerate() {
        let wanted = EdgeClass::Boundary { loop_id: LoopId::new(soft.loops.len() + i) };
        let edges = m.edges.iter().filter(|e| e.class == wanted);
        let lips: f64 = edges
            .map(|e| m.vertices[e.vertices[0].index()].distance(m.vertices[e.vertices[1].index()]))
            .sum();
        assert!((lips / (2.0 * slit.length_mm()) - 1.0).abs() < 1e-9, "slit {i}: {lips}");
    }
}

/// Components minus holes.
pub(crate) fn euler(m: &FlatMesh) -> i64 {
    m.vertices.len() as i64 - m.edges.len() as i64 + m.triangles.len() as i64
}

/// Smallest angle of each triangle whose corners all keep a distance from the given places, degrees, ascending.
pub(crate) fn angles_away_from(m: &FlatMesh, places: &[(DVec2, f64)]) -> Vec<f64> {
    let away = |t: &usize| {
        let corners = m.corners(TriangleId::new(*t));
        places.iter().all(|(p, r)| corners.iter().all(|c| c.distance(*p) > *r))
    };
    let smallest =
        |t: usize| m.angles_rad(TriangleId::new(t)).into_iter().fold(f64::MAX, f64::min).to_degrees();
    let mut angles: Vec<f64> = (0..m.triangles.len()).filter(away).map(smallest).collect();
    angles.sort_by(f64::total_cmp);
    angles
}

/// The quality that meshes shall have: 20° at least, and 45° in the median.
pub(crate) fn assert_good(m: &FlatMesh, but_at: &[(DVec2, f64)]) {
    let angles = angles_away_from(m, but_at);
    let (least, median) = (angles[0], angles[angles.len() / 2]);
    assert!(least >= 20.0 && median >= 45.0, "least {least:.1}°, median {median:.1}°");
}
