//! Cuts: both lips are boundary, and the sheet stays a manifold.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{
    Straight, assert_good, euler, on_rectangle, pattern, polyline, rectangle, sound, with_backends,
};
use glam::DVec2;
use softfold_geometry::{FlatMesh, LineEnd, LoopId, OutlinePoint, PlanarCurve, Site, SoftPattern};

fn cut(slits: Vec<PlanarCurve>) -> SoftPattern {
    let mut soft = pattern(vec![rectangle(200.0, 160.0)], vec![]);
    soft.slits = slits;
    soft
}

/// Vertices at a point.
fn at(m: &FlatMesh, x: f64, y: f64) -> usize {
    m.vertices.iter().filter(|v| v.distance(DVec2::new(x, y)) < 1e-6).count()
}

#[test]
fn a_slit_inside_opens_but_for_its_tips() {
    let soft = cut(vec![polyline(&[(50., 80.), (100., 70.), (150., 80.)])]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        assert_eq!([at(&m, 50., 80.), at(&m, 100., 70.), at(&m, 150., 80.)], [1, 2, 1]);
        assert_eq!(euler(&m), 0, "a disk with a hole");
        let slit = m.loop_vertices(LoopId(1));
        assert_eq!(slit.len() % 2, 0);
        for v in slit {
            let Site::Boundary { s_mm, .. } = m.sites[v.index()] else { panic!() };
            assert!(soft.slits[0].point(s_mm).distance(m.vertices[v.index()]) < 1e-9);
        }
        assert_good(&m, &[]);
    });
}

#[test]
fn a_short_slit_still_opens() {
    let soft = cut(vec![polyline(&[(100., 80.), (104., 80.)])]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        let inside = |p: &&DVec2| (p.y - 80.0).abs() < 1e-9 && p.x > 100.01 && p.x < 103.99;
        let lips = m.vertices.iter().filter(inside).count();
        assert!(lips >= 2 && lips % 2 == 0 && euler(&m) == 0, "{lips}");
        assert_good(&m, &[]);
    });
}

#[test]
fn a_slit_from_the_outline_opens_it_in_order() {
    let soft = cut(vec![polyline(&[(100., 0.), (100., 60.)])]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        assert_eq!((at(&m, 100., 0.), at(&m, 100., 60.), euler(&m)), (2, 1, 1));
        // Along the outline the left lip's corner comes before the right one's.
        let outline = m.loop_vertices(LoopId(0));
        for pair in outline.windows(2) {
            let joined = m.edges.iter().any(|e| pair.iter().all(|v| e.vertices.contains(v)));
            let same_place = m.vertices[pair[0].index()] == m.vertices[pair[1].index()];
            assert!(joined != same_place, "{pair:?}");
        }
    });
}

#[test]
fn a_slit_across_makes_two_sheets() {
    let soft = cut(vec![polyline(&[(90., 0.), (110., 160.)])]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        assert_eq!((at(&m, 90., 0.), at(&m, 110., 160.), euler(&m)), (2, 2, 2));
    });
}

#[test]
fn slits_that_cross_open_in_four() {
    let soft = cut(vec![polyline(&[(50., 80.), (150., 80.)]), polyline(&[(100., 40.), (101., 120.)])]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        assert_eq!((at(&m, 100.5, 80.), euler(&m)), (4, 0));
        assert_good(&m, &[]);
    });
}

#[test]
fn four_slits_that_end_in_one_point_open_in_four() {
    let arm = |x: f64, y: f64| polyline(&[(x, y), (100., 80.)]);
    let soft = cut(vec![arm(50., 80.), arm(150., 80.), arm(100., 30.), arm(100., 130.)]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        assert_eq!((at(&m, 100., 80.), euler(&m)), (4, 0));
    });
}

#[test]
fn a_slit_that_ends_on_another_opens_it_in_three() {
    for flip in [false, true] {
        let mut slits = vec![polyline(&[(50., 80.), (150., 80.)]), polyline(&[(90., 80.), (90., 120.)])];
        if flip {
            slits.reverse();
        }
        let soft = cut(slits);
        with_backends(|options| {
            let m = sound(&soft, &options);
            assert_eq!((at(&m, 90., 80.), euler(&m)), (3, 0));
            assert_good(&m, &[]);
        });
    }
}

#[test]
fn creases_end_on_slits_and_on_their_tips() {
    let mut soft = cut(vec![polyline(&[(100., 40.), (100., 120.)])]);
    let mut add = |from: (f64, f64), to: (f64, f64), s_mm: f64| {
        let (from, to) = (DVec2::from(from), DVec2::from(to));
        let crease = Straight::new(from, to - from, 0.0, 0.5);
        let on_slit = LineEnd::Boundary(OutlinePoint { loop_id: LoopId(1), s_mm });
        let ends = [on_rectangle(from, 200.0, 160.0), on_slit];
        let mut band = crease.band(soft.bands.len() as u32);
        let mut line = crease.line(None, &[0.0, from.distance(to)], ends);
        line.points[1] = to;
        band.fold_lines.push(line);
        soft.bands.push(band);
    };
    add((0., 80.), (100., 80.), 40.0);
    add((200., 80.), (100., 80.), 40.0);
    add((100., 0.), (100., 40.), 0.0);
    with_backends(|options| {
        let m = sound(&soft, &options);
        assert_eq!((at(&m, 100., 80.), at(&m, 100., 40.), euler(&m)), (2, 1, 0));
        assert_good(&m, &[]);
    });
}

#[test]
fn a_slit_that_leaves_the_sheet_is_named() {
    let soft = cut(vec![polyline(&[(100., 80.), (100., 180.)])]);
    let error = softfold_mesh::mesh(&soft, &softfold_mesh::MeshOptions::default()).unwrap_err().to_string();
    assert!(error.contains("slit 0") && error.contains("the outline"), "{error}");
}
