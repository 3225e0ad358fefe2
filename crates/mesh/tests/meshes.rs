//! Meshes of small soft patterns; every test runs both triangulations.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{hole, pattern, rectangle, with_backends};
use glam::DVec2;
use softfold_geometry::{
    Band, CreaseId, EdgeClass, FoldLine, LineEnd, LoopId, Softness, TriangleId, polygon,
};
use softfold_mesh::{Backend, MeshError, MeshOptions, crosscheck, mesh, quality};

const TURN_RAD: f64 = 0.2;
const STRIP_MM: f64 = 6.0;

/// A vertical band of four strips around u = `u` on a rectangle.
fn straight_band(id: u32, u: f64, width: f64, height: f64) -> Band {
    common::straight_band(id, u, width, height, 0.5 * STRIP_MM / (0.5 * TURN_RAD).sin())
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
    let line = FoldLine {
        rank: None,
        points: closed,
        s_mm: (0..=200).map(|k| circle.length_mm() * f64::from(k) / 200.0).collect(),
        offsets_mm: vec![0.0; 201],
        turns_rad,
        ends: [LineEnd::Closed; 2],
    };
    let soft_nowhere = Softness { s_mm: 0.0, radius_mm: 0.0, fold_angle_rad: 0.3 };
    let band = Band { crease: CreaseId(0), segments: 4, profile: vec![soft_nowhere], fold_lines: vec![line] };
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
fn both_triangulations_give_the_same_mesh() {
    let hole = hole(DVec2::new(80.0, 100.0), 40.0);
    let soft = pattern(vec![rectangle(300.0, 200.0), hole], vec![straight_band(0, 200.0, 300.0, 200.0)]);
    let with = |backend| mesh(&soft, &common::options(8.0, backend)).unwrap().mesh;
    assert_eq!(with(Backend::Spade), with(Backend::Cgal));
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
        let y = 100.0 + line.offsets_mm[0];
        line.points = vec![DVec2::new(0.0, y), DVec2::new(300.0, y)];
        line.ends = [LineEnd::Free; 2];
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

#[test]
fn a_constraint_through_a_point_of_another_is_named() {
    let points = [(0., 0.), (4., 0.), (4., 4.), (2., 4.), (0., 4.), (2., 2.), (2., 6.)].map(DVec2::from);
    let id = softfold_geometry::VertexId;
    let side =
        |k: u32| ([id(k), id((k + 1) % 5)], softfold_mesh::Constraint::Boundary { loop_id: LoopId(0) });
    let mut constraints: Vec<_> = (0..5).map(side).collect();
    constraints.push(([id(5), id(6)], softfold_mesh::Constraint::Slit { slit: 7 }));
    let graph = softfold_mesh::PlanarGraph { points: points.to_vec(), constraints };
    with_backends(|options| {
        let error = softfold_mesh::triangulate(&graph, options.backend).unwrap_err().to_string();
        assert!(options.backend == softfold_mesh::Backend::Cgal || error.contains("slit 7"), "{error}");
    });
}
