//! Inputs that leave hardly any room: near-coincident creases, tangents, holes in bands, needles.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{Straight, hole, on_rectangle, pattern, polyline, rectangle, straight_band, with_backends};
use glam::DVec2;
use softfold_geometry::{Band, LineEnd, LoopId, OutlinePoint, SoftPattern};
use softfold_mesh::{Inspection, MeshOptions, Sharpness, mesh};

const WIDTH: f64 = 300.0;
const HEIGHT: f64 = 200.0;

/// The mesh keeps the bar away from what is listed, its area and its chords.
fn held(soft: &SoftPattern, options: &MeshOptions) -> Inspection {
    let meshed = mesh(soft, options).unwrap();
    meshed.mesh.check().unwrap();
    let i = meshed.inspection;
    assert!(i.small == 0 && i.free.min_angle_deg >= 20.0, "{:?} {:?}", i.free, i.worst);
    assert!(i.free.median_min_angle_deg >= 45.0, "{:?}", i.free);
    assert!(i.fold_chord_mm.max(i.boundary_chord_mm) <= options.chord * options.target_edge_mm);
    i
}

fn vertical(id: u32, u: f64) -> Band {
    let crease = Straight::new(DVec2::new(u, 0.0), DVec2::Y, 0.0, 0.8);
    let ends = [0.0, HEIGHT].map(|s| on_rectangle(crease.at(None, s), WIDTH, HEIGHT));
    let mut band = crease.band(id);
    band.fold_lines.push(crease.line(None, &[0.0, HEIGHT], ends));
    band
}

#[test]
fn two_creases_a_hundredth_of_a_millimetre_apart_are_listed() {
    let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![vertical(0, 150.0), vertical(1, 150.01)]);
    with_backends(|options| {
        let places = held(&soft, &options).places;
        let is_gap = |k: &Sharpness| matches!(k, Sharpness::Gap { gap_mm } if (gap_mm - 0.01).abs() < 1e-3);
        assert!(places.iter().any(|p| is_gap(&p.kind)), "{places:?}");
    });
}

#[test]
fn two_creases_a_millimetre_apart_are_not() {
    let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![vertical(0, 150.0), vertical(1, 151.0)]);
    with_backends(|options| assert_eq!(held(&soft, &options).places, []));
}

#[test]
fn a_needle_is_listed_with_its_angle() {
    let needle = polyline(&[(0., 0.), (300., 0.), (300., 30.), (0., 0.)]);
    with_backends(|options| {
        let i = held(&pattern(vec![needle.clone()], vec![]), &options);
        let Sharpness::Corner { angle_deg } = i.places[0].kind else { panic!("{:?}", i.places) };
        assert!((angle_deg - 0.1_f64.atan().to_degrees()).abs() < 1e-6, "{angle_deg}");
        assert_eq!(i.places[0].at, DVec2::ZERO);
    });
}

#[test]
fn a_hole_inside_a_strip_keeps_the_bar() {
    let loops = vec![rectangle(WIDTH, HEIGHT), hole(DVec2::new(155.0, 100.0), 2.0)];
    let soft = pattern(loops, vec![straight_band(0, 150.0, WIDTH, HEIGHT, 60.0)]);
    with_backends(|options| assert_eq!(held(&soft, &options).places, []));
}

#[test]
fn a_crease_tangent_to_a_hole_is_listed() {
    let round = hole(DVec2::new(150.0, 100.0), 40.0);
    let (s_mm, _) = round.nearest(DVec2::new(150.0, 140.0));
    let crease = Straight::new(DVec2::new(0.0, 140.0), DVec2::X, 0.0, 0.5);
    let touch = LineEnd::Boundary(OutlinePoint { loop_id: LoopId(1), s_mm });
    let mut band = crease.band(0);
    let start = on_rectangle(crease.at(None, 0.0), WIDTH, HEIGHT);
    band.fold_lines.push(crease.line(None, &[0.0, 150.0], [start, touch]));
    let soft = pattern(vec![rectangle(WIDTH, HEIGHT), round], vec![band]);
    with_backends(|options| {
        let places = held(&soft, &options).places;
        assert!(places.iter().any(|p| matches!(p.kind, Sharpness::Corner { angle_deg } if angle_deg < 1.0)));
    });
}
