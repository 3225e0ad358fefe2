//! Meshes of small soft patterns; every test runs both triangulations.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

use glam::DVec2;
use softfold_geometry::{
    Band, CreaseId, EdgeClass, FoldLine, LoopId, OutlinePoint, PlanarCurve, Segment, SoftPattern, Tolerance,
    TriangleId, polygon,
};
use softfold_mesh::{Backend, MeshError, MeshOptions, crosscheck, mesh, quality};

const TURN_RAD: f64 = 0.2;
const STRIP_MM: f64 = 6.0;

fn rectangle(width: f64, height: f64) -> PlanarCurve {
    let corners = [(0., 0.), (width, 0.), (width, height), (0., height), (0., 0.)].map(DVec2::from);
    PlanarCurve::polyline(&corners).unwrap()
}

/// A clockwise circle of four cubics.
fn hole(center: DVec2, radius: f64) -> PlanarCurve {
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

/// A vertical band of four strips around u = `u` on a rectangle.
fn straight_band(id: u32, u: f64, width: f64, height: f64) -> Band {
    let line = |k: u32| {
        let offset_mm = (f64::from(k) - 2.0) * STRIP_MM;
        let x = u - offset_mm; // left of a line that runs up
        let points = vec![DVec2::new(x, 0.0), DVec2::new(x, height)];
        let end = |s_mm: f64| Some(OutlinePoint { loop_id: LoopId(0), s_mm });
        let ends = [end(x), end(width + height + (width - x))];
        let turn = if k == 0 || k == 4 { 0.5 * TURN_RAD } else { TURN_RAD };
        FoldLine { offset_mm, points, turns_rad: vec![turn; 2], ends }
    };
    Band {
        crease: CreaseId(id),
        radius_mm: 30.0,
        fold_angle_rad: 4.0 * TURN_RAD,
        strip_width_mm: STRIP_MM,
        fold_lines: (0..=4).map(line).collect(),
    }
}

fn pattern(loops: Vec<PlanarCurve>, bands: Vec<Band>) -> SoftPattern {
    let soft = SoftPattern { loops, bands, tolerance: Tolerance::for_size(300.0) };
    soft.check().unwrap();
    soft
}

fn with_backends(test: impl Fn(MeshOptions)) {
    for backend in [Backend::Spade, Backend::Cgal] {
        test(MeshOptions { target_edge_mm: 15.0, backend, ..MeshOptions::default() });
    }
}

#[test]
fn a_band_is_meshed_in_strips_and_keeps_its_turns() {
    let soft = pattern(vec![rectangle(300.0, 200.0)], vec![straight_band(0, 150.0, 300.0, 200.0)]);
    with_backends(|options| {
        let meshed = mesh(&soft, &options).unwrap();
        let m = &meshed.mesh;
        m.check().unwrap();
        assert!((m.area_mm2() / 60_000.0 - 1.0).abs() < 1e-12);
        let lines: Vec<f64> = (0..=4).map(|k| 150.0 - (f64::from(k) - 2.0) * STRIP_MM).collect();
        for t in 0..m.triangles.len() {
            let u = m.corners(TriangleId::new(t)).map(|p| p.x);
            let (lo, hi) = u.iter().fold((f64::MAX, f64::MIN), |(l, h), &x| (l.min(x), h.max(x)));
            assert!(lines.iter().all(|x| lo > x - 1e-9 || hi < x + 1e-9), "triangle {t} crosses a fold line");
        }
        let mut length = [0.0; 5];
        for e in &m.edges {
            if let EdgeClass::Fold { crease, line, turn_rad } = e.class {
                let [a, b] = e.vertices.map(|v| m.vertices[v.index()]);
                assert_eq!(crease, CreaseId(0));
                assert!((a.x - lines[line as usize]).abs() < 1e-9 && (b.x - a.x).abs() < 1e-9);
                assert_eq!(turn_rad, if line == 0 || line == 4 { 0.5 * TURN_RAD } else { TURN_RAD });
                length[line as usize] += a.distance(b);
            }
        }
        assert!(length.iter().all(|l| (l - 200.0).abs() < 1e-9), "{length:?}");
        let q = quality(m);
        assert!(q.min_angle_deg > 20.0 && q.median_min_angle_deg > 45.0, "{q:?}");
    });
}

#[test]
fn holes_stay_open_and_their_polygon_is_the_region() {
    let hole = hole(DVec2::new(80.0, 100.0), 40.0);
    let soft = pattern(vec![rectangle(300.0, 200.0), hole], vec![straight_band(0, 200.0, 300.0, 200.0)]);
    with_backends(|options| {
        let m = mesh(&soft, &options).unwrap().mesh;
        let ring =
            |id: u32| m.loop_vertices(LoopId(id)).iter().map(|v| m.vertices[v.index()]).collect::<Vec<_>>();
        let region = polygon::signed_area_mm2(&ring(0)) + polygon::signed_area_mm2(&ring(1));
        assert!((m.area_mm2() / region - 1.0).abs() < 1e-12);
        assert!(polygon::signed_area_mm2(&ring(1)) < 0.0);
        let inside = |t: usize| m.corners(TriangleId::new(t)).into_iter().sum::<DVec2>() / 3.0;
        assert!((0..m.triangles.len()).all(|t| !polygon::contains(&ring(1), inside(t))));
    });
}

#[test]
fn a_ring_of_fold_lines_closes() {
    let circle = hole(DVec2::new(150.0, 100.0), 60.0).reversed();
    let points: Vec<DVec2> =
        (0..=200).map(|k| circle.point(circle.length_mm() * f64::from(k) / 200.0)).collect();
    let mut closed = points.clone();
    closed[200] = points[0];
    let turns_rad = vec![0.3; 201];
    let line = FoldLine { offset_mm: 0.0, points: closed, turns_rad, ends: [None, None] };
    let band = Band {
        crease: CreaseId(0),
        radius_mm: 0.0,
        fold_angle_rad: 0.3,
        strip_width_mm: 0.0,
        fold_lines: vec![line],
    };
    let soft = pattern(vec![rectangle(300.0, 200.0)], vec![band]);
    with_backends(|options| {
        let m = mesh(&soft, &options).unwrap().mesh;
        let mut ends = std::collections::BTreeMap::new();
        for e in m.edges.iter().filter(|e| matches!(e.class, EdgeClass::Fold { .. })) {
            e.vertices.iter().for_each(|v| *ends.entry(*v).or_insert(0) += 1);
        }
        assert!(
            ends.len() > 15 && ends.values().all(|&n| n == 2),
            "every vertex of the ring has two fold edges"
        );
    });
}

#[test]
fn the_same_seed_gives_the_same_mesh_and_another_does_not() {
    let soft = pattern(vec![rectangle(300.0, 200.0)], vec![straight_band(0, 150.0, 300.0, 200.0)]);
    let with = |seed: u64| mesh(&soft, &MeshOptions { seed, ..MeshOptions::default() }).unwrap().mesh;
    assert_eq!(with(1), with(1));
    assert_ne!(with(1), with(2));
}

#[test]
fn spade_and_cgal_agree() {
    let hole = hole(DVec2::new(80.0, 100.0), 40.0);
    let soft = pattern(vec![rectangle(300.0, 200.0), hole], vec![straight_band(0, 200.0, 300.0, 200.0)]);
    let meshed = mesh(&soft, &MeshOptions { target_edge_mm: 8.0, ..MeshOptions::default() }).unwrap();
    let check = crosscheck(&meshed.graph).unwrap();
    assert!(check.agrees(), "{check:?}");
}

#[test]
fn cocircular_points_are_told_apart_from_faults() {
    // A grid of squares: every diagonal is free.
    let at = |i: usize| DVec2::new((i % 5) as f64, (i / 5) as f64);
    let points: Vec<DVec2> = (0..25).map(at).collect();
    let ring = [0, 1, 2, 3, 4, 9, 14, 19, 24, 23, 22, 21, 20, 15, 10, 5];
    let id = softfold_geometry::VertexId;
    let side = |k: usize| {
        ([id(ring[k]), id(ring[(k + 1) % 16])], softfold_mesh::Constraint::Boundary { loop_id: LoopId(0) })
    };
    let graph = softfold_mesh::PlanarGraph { points, constraints: (0..16).map(side).collect() };
    let check = crosscheck(&graph).unwrap();
    assert!(check.constraints_held && check.other_differences.is_empty(), "{check:?}");
}

#[test]
fn bands_that_cross_are_named() {
    let mut other = straight_band(1, 150.0, 300.0, 200.0);
    for line in &mut other.fold_lines {
        let y = 100.0 + line.offset_mm;
        line.points = vec![DVec2::new(0.0, y), DVec2::new(300.0, y)];
        line.ends = [None, None];
        line.points[0].x = 5.0;
        line.points[1].x = 295.0;
    }
    let soft = pattern(vec![rectangle(300.0, 200.0)], vec![straight_band(0, 150.0, 300.0, 200.0), other]);
    let error = mesh(&soft, &MeshOptions::default()).unwrap_err();
    assert!(matches!(error, MeshError::Crossing { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("crease 0") && text.contains("crease 1") && text.contains("mm"), "{text}");
}

#[test]
fn options_out_of_range_are_named() {
    let soft = pattern(vec![rectangle(300.0, 200.0)], vec![]);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = mesh(&soft, &MeshOptions { target_edge_mm: bad, ..MeshOptions::default() }).unwrap_err();
        assert!(error.to_string().contains("mesh.target_edge_mm"), "{error}");
    }
    let error = mesh(&soft, &MeshOptions { target_edge_mm: 0.01, ..MeshOptions::default() }).unwrap_err();
    assert!(matches!(error, MeshError::TooMany { .. }), "{error}");
}
