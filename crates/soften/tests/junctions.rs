//! Where creases meet: regions, cuts, and refusals that are true.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

mod common;

use common::*;
use proptest::prelude::*;
use softfold_geometry::{CreasePattern, DVec2, LineEnd, PlanarCurve, SoftPattern, polygon as poly};
use softfold_soften::{Along, CreaseSoftness, Fault, Misfit, RegionKind, SoftenError, regions, soften};
use std::f64::consts::TAU;

const CENTER: DVec2 = DVec2::new(500.0, 300.0);

fn end_points(s: &SoftPattern, junction: usize) -> Vec<DVec2> {
    let lines = s.bands.iter().flat_map(|b| &b.fold_lines);
    let ends = lines.flat_map(|l| [(l.ends[0], l.points[0]), (l.ends[1], l.points[l.points.len() - 1])]);
    ends.filter(|(e, _)| *e == LineEnd::Junction(junction)).map(|(_, p)| p).collect()
}

/// Simple, counter-clockwise, around its point: every corner is seen from it further round than the last.
fn assert_star_shaped(corners: &[DVec2], point: DVec2) {
    assert!(corners.len() >= 3, "{corners:?}");
    let turn = |(a, b): (DVec2, DVec2)| (a - point).angle_to(b - point);
    let seen: Vec<f64> = poly::edges(corners).filter(|(a, b)| *a != point && *b != point).map(turn).collect();
    assert!(seen.iter().all(|t| *t > 0.0), "{seen:?}");
    assert!(seen.iter().sum::<f64>() <= TAU + 1e-9);
    assert!(poly::signed_area_mm2(corners) > 0.0);
}

#[test]
fn sharp_creases_meet_in_the_point_itself() {
    let p = pattern(sheet(), vec![], star(CENTER, 200.0, &[0.0, 80.0, 200.0, 300.0]));
    let s = soften(&p, &[soft(0.0, 90.0, 4), soft(0.0, 60.0, 4), soft(0.0, -60.0, 4), soft(0.0, 30.0, 4)])
        .unwrap();
    s.check().unwrap();
    assert_eq!(s.junctions.len(), 1);
    assert!(s.junctions[0].polygon.is_empty());
    assert_eq!(end_points(&s, 0), vec![CENTER; 4]);
}

#[test]
fn soft_creases_leave_a_region_through_the_ends_of_their_lines() {
    let p = pattern(sheet(), vec![], star(CENTER, 200.0, &[0.0, 90.0, 180.0, 270.0]));
    let s = soften(&p, &vec![soft(20.0, 90.0, 4); 4]).unwrap();
    s.check().unwrap();
    let region = &s.junctions[0];
    assert_star_shaped(&region.polygon, CENTER);
    assert_eq!(region.polygon.len(), 4 * 5);
    assert!(poly::contains(&region.polygon, CENTER));
    for p in end_points(&s, 0) {
        assert!(region.polygon.contains(&p));
    }
    // Corners of neighbouring bands fill nine tenths of the right angle between them.
    let half = s.bands[0].half_width_mm();
    let cut = half / 40.5_f64.to_radians().tan();
    assert!((s.bands[0].fold_lines[2].points[0].distance(CENTER) - cut).abs() < 1e-9);
}

#[test]
fn a_sharp_crease_ends_on_the_region_of_soft_ones() {
    let p = pattern(sheet(), vec![], star(CENTER, 200.0, &[0.0, 130.0, 250.0]));
    let s = soften(&p, &[soft(20.0, 90.0, 4), soft(0.0, 60.0, 4), soft(10.0, -60.0, 3)]).unwrap();
    s.check().unwrap();
    let region = &s.junctions[0].polygon;
    assert_star_shaped(region, CENTER);
    assert_eq!(region.len(), 5 + 1 + 4);
    assert!(region.contains(&s.bands[1].fold_lines[0].points[0]));
}

#[test]
fn two_creases_at_a_corner_leave_a_region_around_the_point() {
    let p = pattern(sheet(), vec![], star(CENTER, 200.0, &[0.0, 70.0]));
    let s = soften(&p, &vec![soft(20.0, 90.0, 4); 2]).unwrap();
    s.check().unwrap();
    assert_star_shaped(&s.junctions[0].polygon, CENTER);
    assert!(poly::contains(&s.junctions[0].polygon, CENTER));
    assert_eq!(s.junctions[0].polygon.len(), 2 * 5 + 1);
}

#[test]
fn creases_that_meet_in_a_corner_of_the_sheet_leave_a_region_with_that_corner() {
    let p = pattern(sheet(), vec![], star(v(0.0, 0.0), 300.0, &[20.0, 60.0]));
    let s = soften(&p, &vec![soft(10.0, 90.0, 4); 2]).unwrap();
    s.check().unwrap();
    let region = &s.junctions[0].polygon;
    assert!(region.contains(&v(0.0, 0.0)));
    assert_star_shaped(region, v(0.0, 0.0));
    assert!(region.iter().all(|q| q.x >= 0.0 && q.y >= 0.0));
}

#[test]
fn creases_from_both_sides_of_a_slit_do_not_meet() {
    let mut p = pattern(
        sheet(),
        vec![],
        vec![line((0.0, 300.0), (500.0, 300.0)), line((500.0, 300.0), (1000.0, 300.0))],
    );
    p.slits = vec![line((500.0, 150.0), (500.0, 450.0))];
    let s = soften(&p, &vec![soft(20.0, 90.0, 4); 2]).unwrap();
    s.check().unwrap();
    assert!(s.junctions.is_empty());
    for (b, side) in [(0, 1), (1, 0)] {
        for l in &s.bands[b].fold_lines {
            let on = l.ends[side].on_boundary().unwrap();
            assert_eq!(on.loop_id.0, 1);
            let p = if side == 0 { l.points[0] } else { l.points[l.points.len() - 1] };
            assert!((p.x - 500.0).abs() < 1e-9);
            assert!((on.s_mm - (p.y - 150.0)).abs() < 1e-9);
        }
    }
}

#[test]
fn a_crease_that_goes_on_from_the_end_of_a_slit_ends_square_beside_it() {
    let mut p = pattern(sheet(), vec![], vec![line((0.0, 300.0), (500.0, 300.0))]);
    p.slits = vec![line((500.0, 300.0), (900.0, 300.0))];
    let s = soften(&p, &[soft(20.0, 90.0, 4)]).unwrap();
    s.check().unwrap();
    for (k, l) in s.bands[0].fold_lines.iter().enumerate() {
        assert!((l.points[l.points.len() - 1].x - 500.0).abs() < 1e-9);
        assert_eq!(l.ends[1].on_boundary().is_some(), k == 2);
        assert_eq!(l.ends[1] == LineEnd::Free, k != 2);
    }
}

/// The regions of a pattern fill it, and the junction's polygon lies on the sheet.
fn softened(p: &CreasePattern, softness: &[CreaseSoftness]) -> SoftPattern {
    p.check().unwrap();
    let s = soften(p, softness).unwrap_or_else(|e| panic!("{e}"));
    s.check().unwrap();
    assert_nothing_crosses(&s);
    let all = regions(&s).unwrap();
    assert!(all.iter().all(|r| r.area_mm2 > 0.0), "{all:?}");
    assert!((all.iter().map(|r| r.area_mm2).sum::<f64>() / p.area_mm2() - 1.0).abs() < 1e-9);
    s
}

#[test]
fn creases_that_meet_on_the_outline_a_hole_or_a_reflex_corner_leave_regions_on_it() {
    let hole = polygon(&[(400., 250.), (400., 350.), (600., 350.), (600., 250.)]);
    let notched = polygon(&[(0., 0.), (1000., 0.), (1000., 600.), (500., 600.), (500., 400.), (0., 400.)]);
    for (outline, holes, point, directions) in [
        (sheet(), vec![], v(500.0, 0.0), vec![30.0, 75.0, 140.0]),
        (sheet(), vec![hole.clone()], v(600.0, 300.0), vec![-50.0, 0.0, 60.0]),
        (sheet(), vec![hole], v(600.0, 350.0), vec![-30.0, 45.0, 120.0]),
        (notched, vec![], v(500.0, 400.0), vec![-100.0, -10.0, 70.0]),
    ] {
        let p = pattern(outline, holes, star(point, 180.0, &directions));
        for radii in [[12.0, 0.0, 8.0], [0.0; 3], [10.0; 3], [0.0, 0.0, 9.0]] {
            let s = softened(&p, &radii.map(|r| soft(r, 80.0, 3)));
            assert_eq!(s.junctions.len(), 1);
            assert_eq!(s.junctions[0].polygon.contains(&point), radii != [0.0; 3]);
            assert!(s.on_boundary(point).is_some());
        }
    }
}

#[test]
fn creases_that_meet_at_the_end_of_a_slit_leave_a_region_around_it() {
    let point = v(500.0, 300.0);
    let mut p = pattern(sheet(), vec![], star(point, 180.0, &[-100.0, 60.0, 100.0]));
    p.slits = vec![line((500.0, 300.0), (300.0, 300.0))];
    for radii in [[12.0, 0.0, 8.0], [10.0; 3], [0.0; 3]] {
        let s = softened(&p, &radii.map(|r| soft(r, -80.0, 2)));
        assert_eq!(s.junctions.len(), 1);
        if radii != [0.0; 3] {
            assert_star_shaped(&s.junctions[0].polygon, point);
        }
    }
}

#[test]
fn three_creases_on_both_sides_of_a_slit_make_one_region_on_the_side_of_two() {
    let point = v(500.0, 300.0);
    let mut p = pattern(sheet(), vec![], star(point, 180.0, &[-90.0, 60.0, 120.0]));
    p.slits = vec![line((400.0, 300.0), (600.0, 300.0))];
    let s = softened(&p, &vec![soft(10.0, 80.0, 3); 3]);
    assert_eq!(s.junctions.len(), 1);
    assert_eq!(s.junctions[0].creases.len(), 2);
    assert!(s.junctions[0].polygon.iter().all(|q| q.y >= 300.0));
    assert!(s.bands[0].fold_lines.iter().all(|l| l.ends[0].on_boundary().is_some()));
}

#[test]
fn bands_that_taper_to_nothing_meet_in_the_point() {
    let taper = |r: f64| tapered(&[(0.0, 0.0), (100.0, r)], 80.0, 3);
    let p = pattern(sheet(), vec![], star(CENTER, 200.0, &[0.0, 120.0, 240.0]));
    let s = softened(&p, &[taper(20.0), taper(30.0), soft(0.0, 80.0, 3)]);
    assert!(s.junctions[0].polygon.is_empty());
    assert_eq!(end_points(&s, 0), vec![CENTER; 4 + 4 + 1]);
    // With one that stays wide all end on the polygon.
    let s = softened(&p, &[taper(20.0), soft(25.0, 80.0, 3), soft(0.0, 80.0, 3)]);
    assert_star_shaped(&s.junctions[0].polygon, CENTER);
    assert_eq!(s.junctions[0].polygon.len(), 4 + 4 + 1);
}

/// What a refusal of a junction says, checked for its truth.
fn junction_refusal(creases: Vec<PlanarCurve>, softness: &[CreaseSoftness]) -> (f64, f64) {
    let p = pattern(sheet(), vec![], creases);
    let error = soften(&p, softness).unwrap_err();
    let SoftenError::Crease { id, fault: Fault::Misfit { why, largest_radius_mm, .. }, .. } = &error else {
        panic!("{error}")
    };
    let Misfit::Junction { largest_share: Some(share), creases } = &**why else { panic!("{error}") };
    assert!(creases.len() > 1);
    let all = |f: f64| softness.iter().map(|s| s.scaled(f)).collect::<Vec<_>>();
    assert!(soften(&p, &all(*share)).is_ok());
    assert!(soften(&p, &all(share * 1.001)).is_err());
    let radius = largest_radius_mm.unwrap_or(0.0);
    if radius > 0.0 {
        let one = |r: f64| {
            let mut s = softness.to_vec();
            s[id.index()].radius_mm = Along::Constant(r);
            s
        };
        assert!(soften(&p, &one(radius)).is_ok(), "{error}");
        assert!(soften(&p, &one(radius * 1.001)).is_err());
    }
    (radius, *share)
}

#[test]
fn a_crease_that_is_shorter_than_its_cut_is_refused_with_the_share_that_fits() {
    let mut creases = star(CENTER, 200.0, &[90.0, 180.0, 270.0]);
    creases.extend(star(CENTER, 30.0, &[0.0]));
    let (radius, share) = junction_refusal(creases, &vec![soft(60.0, 90.0, 4); 4]);
    let half = 60.0 * 4.0 * (90f64.to_radians() / 8.0).sin();
    let cut = |f: f64| f * half / 40.5_f64.to_radians().tan();
    assert!((cut(share) - 0.98 * 30.0).abs() < 1e-3, "{share}");
    assert!(radius < 60.0);
}

#[test]
fn three_thousand_sharp_creases_soften_quickly() {
    // A lattice of quads: 31 × 49 points, so about 3,000 creases and 1,500 junctions.
    let (nx, ny) = (49, 31);
    let at = |i: usize, j: usize| v(20.0 * i as f64 + 20.0, 18.0 * j as f64 + 20.0);
    let mut creases = Vec::new();
    for i in 0..nx {
        for j in 0..ny {
            for (a, b) in [(i + 1, j), (i, j + 1)] {
                if a < nx && b < ny {
                    creases.push(PlanarCurve::polyline(&[at(i, j), at(a, b)]).unwrap());
                }
            }
        }
    }
    let n = creases.len();
    assert!(n > 2900);
    let p = pattern(sheet(), vec![], creases);
    let start = std::time::Instant::now();
    let s = soften(&p, &vec![soft(0.0, 90.0, 4); n]).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    s.check().unwrap();
    assert_eq!(s.junctions.len(), nx * ny);
    assert!(seconds < 5.0, "{seconds} s; about a second is expected");
    eprintln!("{seconds}");
}

/// Creases between jittered points of a grid and from there to the outline, bent by up to `bend` of their length.
fn network(jitter: &[f64], bend: f64) -> Vec<PlanarCurve> {
    let (nx, ny) = (4, 3);
    let j = |k: usize| jitter[k % jitter.len()];
    let at = |i: usize, k: usize| {
        let inside = i > 0 && i <= nx && k > 0 && k <= ny;
        let shift =
            if inside { v(40.0 * j(3 * i + 7 * k), 30.0 * j(5 * i + 2 * k + 1)) } else { v(0.0, 0.0) };
        v(200.0 * i as f64, 150.0 * k as f64) + shift
    };
    let mut creases = Vec::new();
    for i in 0..=nx {
        for k in 0..=ny {
            for (a, b, vertical) in [(i + 1, k, false), (i, k + 1, true)] {
                let along_edge = if vertical { i == 0 || i > nx } else { k == 0 || k > ny };
                if !along_edge {
                    let (from, to) = (at(i, k), at(a, b));
                    creases.push(bent(from, to, bend * j(i + 2 * k) * from.distance(to)));
                }
            }
        }
    }
    creases
}

#[test]
fn a_network_of_bent_creases_softens_at_a_radius_that_it_has_room_for() {
    let creases = network(&[0.3, -0.8, 0.5, 0.9, -0.4, -0.7, 0.1], 0.1);
    let p = pattern(sheet(), vec![], creases);
    let softness: Vec<_> =
        (0..p.creases.len()).map(|i| soft([12.0, 6.0, 0.0][i % 3], [80.0, -100.0][i % 2], 4)).collect();
    let s = soften(&p, &softness).unwrap_or_else(|e| panic!("{e}"));
    s.check().unwrap();
    assert_eq!(s.junctions.len(), 12);
    let all = regions(&s).unwrap();
    assert!(all.iter().all(|r| r.area_mm2 > 0.0));
    assert!((all.iter().map(|r| r.area_mm2).sum::<f64>() / p.area_mm2() - 1.0).abs() < 1e-9);
    assert_eq!(all.iter().filter(|r| r.kind == RegionKind::Face).count(), 20);
}

#[test]
fn mending_a_pattern_as_each_refusal_says_ends() {
    let p = pattern(sheet(), vec![], network(&[0.3, -0.8, 0.5, 0.9, -0.4, -0.7, 0.1], 0.15));
    let n = p.creases.len();
    let mut softness = vec![soft(60.0, 90.0, 4); n];
    for _ in 0..3 * n {
        match soften(&p, &softness) {
            Ok(s) => return s.check().unwrap(),
            Err(SoftenError::Crease { id, fault: Fault::Misfit { why, largest_radius_mm, .. }, .. }) => {
                match *why {
                    Misfit::Junction { largest_share: Some(share), creases } => {
                        for c in p.creases.iter().filter(|c| creases.contains(&c.name)) {
                            softness[c.id.index()] = softness[c.id.index()].scaled(share);
                        }
                    }
                    _ => softness[id.index()].radius_mm = Along::Constant(largest_radius_mm.unwrap_or(0.0)),
                }
            }
            Err(other) => panic!("{other}"),
        }
    }
    panic!("still refused");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Networks soften into regions that fill the sheet, or are refused for a reason that is true.
    #[test]
    fn networks_soften_or_say_what_fits(
        jitter in proptest::collection::vec(-1.0..1.0f64, 11), bend in 0.0..0.2f64, radii in proptest::collection::vec(0.0..30.0f64, 5), n in 1u32..5,
    ) {
        let p = pattern(sheet(), vec![], network(&jitter, bend));
        let radius = |i: usize| if radii[i % 5] < 5.0 { 0.0 } else { radii[i % 5] };
        let softness: Vec<_> = (0..p.creases.len()).map(|i| soft(radius(i), [80.0, -100.0][i % 2], n)).collect();
        match soften(&p, &softness) {
            Ok(s) => {
                s.check().unwrap();
                assert_nothing_crosses(&s);
                let all = regions(&s).unwrap();
                prop_assert!(all.iter().all(|r| r.area_mm2 > 0.0));
                prop_assert!((all.iter().map(|r| r.area_mm2).sum::<f64>() / p.area_mm2() - 1.0).abs() < 1e-9);
            }
            Err(SoftenError::Crease { id, fault: Fault::Misfit { largest_radius_mm, radius_mm, .. }, .. }) => {
                // Another crease may not fit either: then the refusal is of that one.
                let with = |factor: f64| {
                    let mut all = softness.clone();
                    all[id.index()] = all[id.index()].scaled(factor);
                    soften(&p, &all)
                };
                if let Some(r) = largest_radius_mm {
                    prop_assert!(r < radius_mm);
                    // Radius 0 is an answer too: sharp it fits, and not even slightly soft.
                    prop_assert!(with((1.001 * r + 1e-6) / radius_mm).is_err());
                }
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Stars of any directions, radii and lengths soften into a region, or say a share that fits.
    #[test]
    fn stars_soften_or_say_what_fits(
        arms in proptest::collection::vec((5.0..120.0f64, 0.0..25.0f64, -120.0..120.0f64, 1u32..6), 2..7), length in 60.0..220.0f64,
    ) {
        let whole: f64 = arms.iter().map(|a| a.0).sum();
        let mut direction = 0.0;
        let directions: Vec<f64> = arms.iter().map(|a| { direction += 360.0 * a.0 / whole; direction }).collect();
        prop_assume!(arms.iter().all(|a| a.2.abs() > 1.0));
        let softness: Vec<_> = arms.iter().map(|a| soft(if a.1 < 4.0 { 0.0 } else { a.1 }, a.2, a.3)).collect();
        let p = pattern(sheet(), vec![], star(CENTER, length, &directions));
        match soften(&p, &softness) {
            Ok(s) => {
                s.check().unwrap();
                assert_nothing_crosses(&s);
                for j in s.junctions.iter().filter(|j| !j.polygon.is_empty()) {
                    assert_star_shaped(&j.polygon, CENTER);
                    prop_assert!(poly::contains(&j.polygon, CENTER));
                }
            }
            Err(_) => { junction_refusal(star(CENTER, length, &directions), &softness); }
        }
    }
}
