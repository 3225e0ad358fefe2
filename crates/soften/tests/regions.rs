//! Areas of the softened sheet's regions: closed forms, and sums that come out at the sheet's area.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

mod common;

use common::*;
use proptest::prelude::*;
use softfold_geometry::{CreasePattern, DVec2, SoftPattern};
use softfold_soften::{Along, CreaseSoftness, RegionKind, SheetRegion, regions, soften};
use std::f64::consts::PI;

fn checked(p: &CreasePattern, s: &SoftPattern) -> Vec<SheetRegion> {
    let all = regions(s).unwrap();
    let sum: f64 = all.iter().map(|r| r.area_mm2).sum();
    assert!((sum / p.area_mm2() - 1.0).abs() < 1e-9, "{sum} of {}", p.area_mm2());
    assert!(all.iter().all(|r| r.area_mm2 > 0.0), "{all:?}");
    all
}

fn strips(all: &[SheetRegion]) -> Vec<f64> {
    all.iter().filter(|r| matches!(r.kind, RegionKind::Strip { .. })).map(|r| r.area_mm2).collect()
}

fn count(all: &[SheetRegion], kind: RegionKind) -> usize {
    all.iter().filter(|r| r.kind == kind).count()
}

#[test]
fn strips_of_a_straight_crease_are_rectangles() {
    let p = pattern(sheet(), vec![], vec![line((400.0, 0.0), (400.0, 600.0))]);
    let s = soften(&p, &[soft(30.0, 80.0, 5)]).unwrap();
    let all = checked(&p, &s);
    assert_eq!((strips(&all).len(), count(&all, RegionKind::Face)), (5, 2));
    let x = s.bands[0].strip_width_mm();
    assert!(strips(&all).iter().all(|a| (a - 600.0 * x).abs() < 1e-6));
    assert!((all[0].area_mm2 + all[1].area_mm2 - 600.0 * (1000.0 - 5.0 * x)).abs() < 1e-6);
}

#[test]
fn strips_of_a_ring_are_annuli() {
    let p = pattern(sheet(), vec![], vec![arc(v(500.0, 300.0), 150.0, 0.0, 2.0 * PI)]);
    let s = soften(&p, &[soft(40.0, 90.0, 4)]).unwrap();
    let all = checked(&p, &s);
    assert_eq!((strips(&all).len(), count(&all, RegionKind::Face)), (4, 2));
    let x = s.bands[0].strip_width_mm();
    for (k, area) in strips(&all).into_iter().enumerate() {
        let [outer, inner] = [k, k + 1].map(|k| 150.0 - (k as f64 - 2.0) * x);
        // Fold lines are polylines within 0.005 mm.
        assert!((area - PI * (outer * outer - inner * inner)).abs() < 0.005 * 2.0 * PI * 300.0, "{area}");
    }
}

#[test]
fn holes_and_slits_are_no_regions() {
    let hole = arc(v(300.0, 450.0), 50.0, 2.0 * PI, 0.0);
    let mut p = pattern(
        sheet(),
        vec![hole],
        vec![line((0.0, 300.0), (500.0, 300.0)), line((0.0, 100.0), (1000.0, 100.0))],
    );
    p.slits = vec![line((500.0, 200.0), (500.0, 600.0)), line((700.0, 300.0), (800.0, 400.0))];
    let s = soften(&p, &[soft(20.0, 90.0, 3), soft(0.0, 90.0, 3)]).unwrap();
    let all = checked(&p, &s);
    // Below the sharp crease; between it and the band; above the band, left of the slit.
    assert_eq!((strips(&all).len(), count(&all, RegionKind::Face)), (3, 3));
}

#[test]
fn free_ends_are_closed_square() {
    let p = pattern(sheet(), vec![], vec![line((300.0, 300.0), (600.0, 300.0))]);
    let s = soften(&p, &[soft(20.0, 90.0, 4)]).unwrap();
    let all = checked(&p, &s);
    assert_eq!((strips(&all).len(), count(&all, RegionKind::Face)), (4, 1));
    assert!(strips(&all).iter().all(|a| (a - 300.0 * s.bands[0].strip_width_mm()).abs() < 1e-6));
}

#[test]
fn a_taper_is_a_fan_of_triangles() {
    let p = pattern(sheet(), vec![], vec![line((500.0, 0.0), (500.0, 600.0))]);
    let s = soften(&p, &[tapered(&[(200.0, 0.0), (400.0, 30.0)], 90.0, 4)]).unwrap();
    let all = checked(&p, &s);
    assert_eq!((strips(&all).len(), count(&all, RegionKind::Face)), (4, 2));
    let x = s.bands[0].strip_width_mm();
    assert!(strips(&all).iter().all(|a| (a - x * (100.0 + 200.0)).abs() < 1e-6));
}

#[test]
fn junction_regions_have_the_area_of_their_polygon() {
    let p = pattern(sheet(), vec![], star(v(500.0, 300.0), 200.0, &[0.0, 80.0, 170.0, 260.0]));
    let s = soften(&p, &vec![soft(15.0, 90.0, 3); 4]).unwrap();
    let all = checked(&p, &s);
    assert_eq!((strips(&all).len(), count(&all, RegionKind::Face)), (12, 1));
    let region = all.iter().find(|r| r.kind == RegionKind::Junction(0)).unwrap();
    let polygon = softfold_geometry::polygon::signed_area_mm2(&s.junctions[0].polygon);
    assert!((region.area_mm2 - polygon).abs() < 1e-9);
}

#[test]
fn regions_at_a_corner_of_the_sheet_touch_its_boundary() {
    let p = pattern(sheet(), vec![], star(v(0.0, 0.0), 300.0, &[20.0, 60.0]));
    for r in [10.0, 0.0] {
        let s = soften(&p, &[soft(r, 90.0, 4), soft(0.0, 45.0, 4)]).unwrap();
        let all = checked(&p, &s);
        assert_eq!(count(&all, RegionKind::Face), 1);
        assert_eq!(count(&all, RegionKind::Junction(0)), usize::from(r > 0.0));
    }
}

#[test]
fn a_frame_of_sharp_creases_is_in_the_face_around_it() {
    // Every corner of the frame is on the edge of its own faces too.
    for turn in 0..12 {
        let at = |x: f64, y: f64| v(500.0, 300.0) + DVec2::from_angle(0.3 * f64::from(turn)).rotate(v(x, y));
        let [a, b, c, d] = [at(-100., -80.), at(100., -80.), at(100., 80.), at(-100., 80.)];
        let sides = [(a, b), (b, c), (c, d), (d, a), (a, c)];
        let p = pattern(sheet(), vec![], sides.map(|(a, b)| line(a.into(), b.into())).to_vec());
        let s = soften(&p, &vec![soft(0.0, 90.0, 1); 5]).unwrap();
        let mut areas: Vec<f64> = checked(&p, &s).iter().map(|r| r.area_mm2).collect();
        areas.sort_by(f64::total_cmp);
        assert!(areas.iter().zip([16e3, 16e3, 568e3]).all(|(a, b)| (a - b).abs() < 1e-6), "{areas:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Areas add up on any pattern that softens: a round sheet with a hole, tapered bands that bend,
    /// creases that end freely, on the boundary and at junctions.
    #[test]
    fn areas_add_up_on_random_patterns(
        radii in proptest::collection::vec(0.0..14.0f64, 8), degrees in proptest::collection::vec(20.0..120.0f64, 4),
        n in 1u32..6, bend in -120.0..120.0f64, turn in -PI..PI,
    ) {
        let outline = arc(v(500.0, 300.0), 400.0, 0.0, 2.0 * PI);
        let hole = arc(v(500.0, 600.0), 40.0, 2.0 * PI, 0.0);
        let rotated = |p: DVec2| v(500.0, 300.0) + DVec2::from_angle(turn).rotate(p - v(500.0, 300.0));
        let mut creases = star(v(500.0, 280.0), 150.0, &[-90.0, 20.0, 150.0]);
        let across = (400f64.powi(2) - 174f64.powi(2)).sqrt();
        creases.push(bent(v(500.0 - across, 474.0), v(500.0 + across, 474.0), bend.abs().min(60.0) * bend.signum()));
        let turned = |c: &softfold_geometry::PlanarCurve| c.mapped(rotated).unwrap();
        let p = pattern(turned(&outline), vec![turned(&hole)], creases.iter().map(turned).collect());
        let softness: Vec<CreaseSoftness> = (0..4).map(|i| {
            let length = p.creases[i].curve.length_mm();
            let radius = |r: f64| if r < 2.0 { 0.0 } else { r };
            CreaseSoftness {
                radius_mm: Along::Places(vec![(0.2 * length, radius(radii[2 * i])), (0.7 * length, radius(radii[2 * i + 1]))]),
                ..soft(0.0, degrees[i], n)
            }
        }).collect();
        if let Ok(s) = soften(&p, &softness) {
            s.check().unwrap();
            assert_nothing_crosses(&s);
            checked(&p, &s);
        }
    }
}
