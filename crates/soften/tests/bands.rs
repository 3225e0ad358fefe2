//! Bands against closed forms: concentric circles, chords, sums of turns, clipped ends, and the
//! largest radius of bands that do not fit.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

mod common;

use common::*;
use proptest::prelude::*;
use softfold_geometry::{CreasePattern, DVec2, LineEnd, PlanarCurve, Role, Segment, Softness};
use softfold_soften::{BandFigures, CreaseSoftness, Fault, Misfit, Segments, SoftenError, soften, write_svg};
use std::f64::consts::PI;

#[test]
fn parallels_of_an_arc_are_concentric_circles_clipped_at_the_outline() {
    let p = pattern(sheet(), vec![], vec![arc_crease()]);
    let s = soften(&p, &[soft(50.0, 90.0, 6)]).unwrap();
    s.check().unwrap();
    let band = &s.bands[0];
    assert_eq!(band.fold_lines.len(), 7);
    for l in &band.fold_lines {
        // The crease runs left to right over the top of its circle: its left is outside.
        let radius = 700.0 + l.offsets_mm[0];
        for q in &l.points {
            assert!((q.distance(v(500.0, -300.0)) - radius).abs() < 1e-5, "{q}");
        }
        for w in l.points.windows(2) {
            let middle = (w[0] + w[1]) * 0.5;
            assert!((middle.distance(v(500.0, -300.0)) - radius).abs() < 0.005);
        }
        let height = (radius * radius - 500.0_f64.powi(2)).sqrt() - 300.0;
        for (end, x) in [(l.points[0], 0.0), (l.points[l.points.len() - 1], 1000.0)] {
            assert!(end.distance(v(x, height)) < 1e-5, "{end} {height}");
        }
        for (side, i) in [(0, 0), (1, l.points.len() - 1)] {
            let end = l.ends[side].on_boundary().unwrap();
            assert_eq!(end.loop_id.0, 0);
            assert!(p.outline.point(end.s_mm).distance(l.points[i]) < 1e-6);
        }
    }
}

#[test]
fn a_band_that_ends_on_a_round_outline_ends_exactly_on_it() {
    let outline = arc(v(0.0, 0.0), 400.0, 0.0, 2.0 * PI);
    let crease = line((-240.0, -320.0), (-240.0, 320.0));
    let p = pattern(outline, vec![], vec![crease]);
    let s = soften(&p, &[soft(40.0, -70.0, 5)]).unwrap();
    for l in &s.bands[0].fold_lines {
        // Left of an upward line is -x.
        let x: f64 = -240.0 - l.offsets_mm[0];
        let y = (400.0_f64.powi(2) - x * x).sqrt();
        assert!(l.points[0].distance(v(x, -y)) < 1e-6, "{:?}", l.points[0]);
        let last = l.points[l.points.len() - 1];
        assert!(last.distance(v(x, y)) < 1e-6);
        let end = l.ends[1].on_boundary().unwrap();
        assert!(p.outline.point(end.s_mm).distance(last) < 1e-6);
    }
}

#[test]
fn an_oblique_end_is_run_on_past_the_crease() {
    // 45° across the corner of the sheet's lower side: offsets end at x shifted by o·√2.
    let p = pattern(sheet(), vec![], vec![line((200.0, 0.0), (800.0, 600.0))]);
    let s = soften(&p, &[soft(30.0, 60.0, 4)]).unwrap();
    for l in &s.bands[0].fold_lines {
        let start = v(200.0 - l.offsets_mm[0] * 2.0_f64.sqrt(), 0.0);
        assert!(l.points[0].distance(start) < 1e-9, "{}", l.points[0]);
        assert!((l.ends[0].on_boundary().unwrap().s_mm - start.x).abs() < 1e-6);
    }
}

fn figures(radius_mm: f64, degrees: f64, n: u32) -> BandFigures {
    BandFigures::of(&Softness { s_mm: 0.0, radius_mm, fold_angle_rad: degrees.to_radians() }, n)
}

#[test]
fn figures_follow_the_paper() {
    let f = figures(50.0, 90.0, 6);
    let x = 2.0 * 50.0 * (PI / 24.0).sin();
    assert!((f.chord_mm - x).abs() < 1e-12);
    assert!((f.band_width_mm - 6.0 * x).abs() < 1e-12);
    assert!((f.tangent_length_mm - 50.0).abs() < 1e-12, "r cot 45°");
    assert!((f.arc_length_mm - 25.0 * PI).abs() < 1e-12);
    assert!(f.band_width_mm < f.arc_length_mm);
}

#[test]
fn a_chord_tolerance_gives_the_fewest_strips_that_keep_it() {
    for tolerance_mm in [0.001, 0.05, 0.3, 5.0, 100.0] {
        let softness = CreaseSoftness { segments: Segments::Chord { tolerance_mm }, ..soft(50.0, 120.0, 1) };
        let p = pattern(sheet(), vec![], vec![line((500.0, 0.0), (500.0, 600.0))]);
        let n = soften(&p, &[softness]).unwrap().bands[0].segments;
        let sagitta = |n: u32| 50.0 * (1.0 - (120f64.to_radians() / f64::from(2 * n)).cos());
        assert!(sagitta(n) <= tolerance_mm * (1.0 + 1e-9), "{n}");
        assert!(n == 1 || sagitta(n - 1) > tolerance_mm, "{n}");
    }
}

#[test]
fn offsets_and_turns_are_symmetric_and_add_up() {
    let p = pattern(sheet(), vec![], vec![line((500.0, 0.0), (500.0, 600.0))]);
    for (n, degrees) in [(1, 80.0), (2, -45.0), (7, 179.0), (12, -1.0)] {
        let s = soften(&p, &[soft(20.0, degrees, n)]).unwrap();
        s.check().unwrap();
        let lines = &s.bands[0].fold_lines;
        assert_eq!(lines.len(), n as usize + 1);
        let turns: Vec<f64> = lines.iter().map(|l| l.turns_rad[0]).collect();
        assert!((turns.iter().sum::<f64>() - degrees.to_radians()).abs() < 1e-14);
        assert!((turns[0] - degrees.to_radians() / f64::from(2 * n)).abs() < 1e-15);
        let width = lines[n as usize].offsets_mm[0] - lines[0].offsets_mm[0];
        assert!((width - f64::from(n) * s.bands[0].strip_width_mm()).abs() < 1e-12);
        assert!((lines[0].offsets_mm[0] + lines[n as usize].offsets_mm[0]).abs() < 1e-12);
    }
}

#[test]
fn radius_zero_is_a_single_line_with_the_whole_turn() {
    let p = pattern(sheet(), vec![], vec![arc_crease()]);
    let s = soften(&p, &[soft(0.0, -75.0, 6)]).unwrap();
    let lines = &s.bands[0].fold_lines;
    assert_eq!(lines.len(), 1);
    assert!(lines[0].turns_rad.iter().all(|t| (t + 75f64.to_radians()).abs() < 1e-15));
    assert!(lines[0].points[0].distance(p.creases[0].curve.point(0.0)) < 1e-6);
}

#[test]
fn parallels_of_an_s_curve_keep_their_distance() {
    let s_curve = PlanarCurve::new(vec![Segment::Cubic {
        from: v(0.0, 200.0),
        c1: v(400.0, 700.0),
        c2: v(600.0, -100.0),
        to: v(1000.0, 400.0),
    }])
    .unwrap();
    let p = pattern(sheet(), vec![], vec![s_curve.clone()]);
    let s = soften(&p, &[soft(60.0, 70.0, 6)]).unwrap();
    for l in &s.bands[0].fold_lines {
        let inner = l.points.iter().filter(|q| (60.0..940.0).contains(&q.x));
        for q in inner {
            assert!((s_curve.nearest(*q).1 - l.offsets_mm[0].abs()).abs() < 1e-4, "{q} {}", l.offsets_mm[0]);
        }
    }
}

#[test]
fn a_dense_polyline_is_offset_like_its_curve() {
    let points: Vec<DVec2> =
        (0..=200).map(|i| arc_crease().point(arc_crease().length_mm() * i as f64 / 200.0)).collect();
    let p = pattern(sheet(), vec![], vec![PlanarCurve::polyline(&points).unwrap()]);
    let s = soften(&p, &[soft(50.0, 90.0, 6)]).unwrap();
    for l in &s.bands[0].fold_lines {
        // At its ends a polyline is run on straight.
        for q in l.points.iter().filter(|q| (60.0..940.0).contains(&q.x)) {
            let d = q.distance(v(500.0, -300.0)) - 700.0;
            assert!((d - l.offsets_mm[0]).abs() < 0.01, "{d} {}", l.offsets_mm[0]);
        }
    }
}

#[test]
fn a_closed_crease_has_closed_fold_lines() {
    let p = pattern(sheet(), vec![], vec![arc(v(500.0, 300.0), 150.0, 0.0, 2.0 * PI)]);
    let s = soften(&p, &[soft(40.0, 90.0, 4)]).unwrap();
    for l in &s.bands[0].fold_lines {
        assert_eq!(l.ends, [LineEnd::Closed; 2]);
        assert!(l.points[0].distance(l.points[l.points.len() - 1]) < 1e-9);
        // Counter-clockwise: left is inside.
        assert!(
            l.points.iter().all(|q| (q.distance(v(500.0, 300.0)) - 150.0 + l.offsets_mm[0]).abs() < 1e-5)
        );
    }
}

#[test]
fn a_free_end_has_no_outline_point_and_is_square() {
    let p = pattern(sheet(), vec![], vec![line((0.0, 300.0), (500.0, 300.0))]);
    let s = soften(&p, &[soft(40.0, 90.0, 4)]).unwrap();
    for l in &s.bands[0].fold_lines {
        assert!(l.ends[0].on_boundary().is_some() && l.ends[1] == LineEnd::Free);
        assert!(l.points[l.points.len() - 1].distance(v(500.0, 300.0 + l.offsets_mm[0])) < 1e-9);
    }
}

#[test]
fn flat_creases_have_empty_bands() {
    let mut p = pattern(sheet(), vec![], vec![line((0.0, 300.0), (1000.0, 300.0))]);
    p.creases[0].role = Role::Flat;
    let s = soften(&p, &[soft(40.0, 0.0, 4)]).unwrap();
    s.check().unwrap();
    assert!(s.bands[0].fold_lines.is_empty());
}

/// The largest radius that an error names, after checking crease, reason and that it is true:
/// just below fits, just above does not.
fn largest(p: &CreasePattern, softness: &[CreaseSoftness], crease: usize, expected: &Misfit) -> f64 {
    let error = soften(p, softness).unwrap_err();
    let SoftenError::Crease { id, line, fault, .. } = &error else { panic!("{error}") };
    assert_eq!((id.index(), *line), (crease, Some(10 + crease as u32)), "{error}");
    let Fault::Misfit { why, largest_radius_mm, .. } = fault else { panic!("{error}") };
    match (&**why, expected) {
        (Misfit::Band { other, .. }, Misfit::Band { other: wanted, .. }) => assert_eq!(other, wanted),
        _ => assert_eq!(**why, *expected, "{error}"),
    }
    let r = largest_radius_mm.unwrap_or_else(|| panic!("{error}"));
    assert!(
        error.to_string().contains(&format!("c{crease}"))
            && error.to_string().contains(&format!("{:.3} mm", (1e3 * r).floor() / 1e3))
    );
    let with = |radius_mm: f64| {
        let mut all = softness.to_vec();
        all[crease].radius_mm = radius_mm.into();
        soften(p, &all)
    };
    assert!(with(0.999 * r).is_ok(), "{:?}", with(0.999 * r).err());
    assert!(with(1.001 * r).is_err());
    r
}

#[test]
fn a_band_stops_at_the_centre_of_curvature() {
    let p = pattern(sheet(), vec![], vec![arc(v(500.0, 0.0), 60.0, PI, 0.0)]);
    let r = largest(&p, &[soft(200.0, 90.0, 6)], 0, &Misfit::Curvature);
    assert!((r / radius_of(60.0, 90.0, 6) - 1.0).abs() < 1e-3, "{r}");
}

#[test]
fn parallel_bands_share_the_strip_between_them() {
    let creases = vec![line((0.0, 200.0), (1000.0, 200.0)), line((0.0, 300.0), (1000.0, 300.0))];
    let p = pattern(sheet(), vec![], creases);
    let other = Misfit::Band { other: "c1".into(), other_largest_radius_mm: None };
    let softness = [soft(120.0, 90.0, 4), soft(40.0, 60.0, 3)];
    let r = largest(&p, &softness, 0, &other);
    let half = 0.5 * figures(40.0, 60.0, 3).band_width_mm;
    assert!((r / radius_of(100.0 - half, 90.0, 4) - 1.0).abs() < 1e-4, "{r}");
}

#[test]
fn a_sharp_crease_bounds_a_band_too() {
    let creases = vec![line((0.0, 200.0), (1000.0, 200.0)), line((0.0, 230.0), (1000.0, 230.0))];
    let p = pattern(sheet(), vec![], creases);
    let other = Misfit::Band { other: "c1".into(), other_largest_radius_mm: None };
    let r = largest(&p, &[soft(90.0, 90.0, 4), soft(0.0, 60.0, 3)], 0, &other);
    assert!((r / radius_of(30.0, 90.0, 4) - 1.0).abs() < 1e-4, "{r}");
}

#[test]
fn a_hole_beside_the_crease_bounds_the_band() {
    let hole = arc(v(400.0, 380.0), 30.0, 2.0 * PI, 0.0);
    let p = pattern(sheet(), vec![hole], vec![line((0.0, 300.0), (1000.0, 300.0))]);
    let r = largest(&p, &[soft(150.0, 90.0, 4)], 0, &Misfit::Boundary);
    assert!((r / radius_of(50.0, 90.0, 4) - 1.0).abs() < 1e-3, "{r}");
}

#[test]
fn a_small_hole_inside_the_band_is_seen() {
    // Between two fold lines, where no line crosses it.
    let hole = polygon(&[(400., 310.), (400., 312.), (402., 312.), (402., 310.)]);
    let p = pattern(sheet(), vec![hole], vec![line((0.0, 300.0), (1000.0, 300.0))]);
    let r = largest(&p, &[soft(150.0, 90.0, 1)], 0, &Misfit::Boundary);
    assert!((r / radius_of(10.0, 90.0, 1) - 1.0).abs() < 1e-3, "{r}");
}

#[test]
fn the_outline_beside_the_crease_bounds_the_band() {
    let p = pattern(sheet(), vec![], vec![line((0.0, 45.0), (1000.0, 45.0))]);
    let r = largest(&p, &[soft(150.0, 90.0, 4)], 0, &Misfit::Boundary);
    assert!((r / radius_of(45.0, 90.0, 4) - 1.0).abs() < 1e-3, "{r}");
}

#[test]
fn a_notch_in_the_outline_bounds_the_band() {
    let outline =
        polygon(&[(0., 0.), (600., 0.), (650., 250.), (700., 0.), (1000., 0.), (1000., 600.), (0., 600.)]);
    let p = pattern(outline, vec![], vec![line((0.0, 300.0), (1000.0, 300.0))]);
    let r = largest(&p, &[soft(150.0, 90.0, 4)], 0, &Misfit::Boundary);
    assert!((r / radius_of(50.0, 90.0, 4) - 1.0).abs() < 1e-3, "{r}");
}

#[test]
fn the_arms_of_a_hairpin_bound_its_band() {
    // Two arms that come close at a neck, joined by a loop of radius 150, symmetric about v = 300.
    let bulb = arc(v(600.0, 300.0), 150.0, -2.0 * PI / 3.0, 2.0 * PI / 3.0);
    let low = bulb.point(0.0);
    let arm = Segment::Cubic {
        from: v(0.0, 270.0),
        c1: v(250.0, 270.0),
        c2: low - 250.0 * bulb.tangent(0.0),
        to: low,
    };
    let mirror = |p: DVec2| v(p.x, 600.0 - p.y);
    let other = PlanarCurve::new(vec![arm]).unwrap().mapped(mirror).unwrap().reversed();
    let segments = [&[arm], bulb.segments(), other.segments()].concat();
    let crease = PlanarCurve::new(segments).unwrap();
    let neck = crease
        .flatten(1e-4)
        .iter()
        .filter(|p| p.x < 500.0)
        .map(|p| (300.0 - p.y).abs())
        .fold(300.0, f64::min);
    let p = pattern(sheet(), vec![], vec![crease]);
    let r = largest(&p, &[soft(1.2 * radius_of(neck, 90.0, 4), 90.0, 4)], 0, &Misfit::Itself);
    assert!((r / radius_of(neck, 90.0, 4) - 1.0).abs() < 1e-3, "{r} {neck}");
}

#[test]
fn crossing_creases_fit_no_radius() {
    let creases = vec![line((0.0, 200.0), (1000.0, 400.0)), line((0.0, 400.0), (1000.0, 200.0))];
    let p = pattern(sheet(), vec![], creases);
    let error = soften(&p, &[soft(20.0, 90.0, 4), soft(20.0, 90.0, 4)]).unwrap_err();
    assert!(error.to_string().contains("no radius fits 'c0'"), "{error}");
    let error = soften(&p, &[soft(0.0, 90.0, 4), soft(0.0, 90.0, 4)]).unwrap_err();
    assert!(error.to_string().contains("the sharp crease reaches the band of crease 'c1'"), "{error}");
}

#[test]
fn requests_that_are_no_softness_are_refused_with_the_mend() {
    let p = pattern(sheet(), vec![], vec![line((0.0, 300.0), (1000.0, 300.0))]);
    let chord =
        |tolerance_mm| CreaseSoftness { segments: Segments::Chord { tolerance_mm }, ..soft(20.0, 90.0, 1) };
    for (softness, parts) in [
        (soft(-1.0, 90.0, 4), ["radius -1", "give 0"]),
        (soft(f64::NAN, 90.0, 4), ["radius NaN", "give 0"]),
        (soft(f64::INFINITY, 90.0, 4), ["radius inf", "give 0"]),
        (soft(20.0, 0.0, 4), ["fold angle 0.000°", "yellow"]),
        (soft(20.0, 180.0, 4), ["fold angle 180.000°", "between"]),
        (soft(20.0, -200.0, 4), ["fold angle -200.000°", "between"]),
        (soft(20.0, f64::NAN, 4), ["fold angle NaN", "between"]),
        (soft(20.0, 90.0, 0), ["0 strips", "1 to 1000"]),
        (soft(20.0, 90.0, 5000), ["5000 strips", "1 to 1000"]),
        (chord(0.0), ["chord tolerance 0 mm", "positive"]),
        (chord(f64::NAN), ["chord tolerance NaN", "positive"]),
        (chord(1e-12), ["strips", "1 to 1000"]),
    ] {
        let said = soften(&p, &[softness]).unwrap_err().to_string();
        assert!(said.starts_with("line 10: crease 'c0': "), "{said}");
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
    let said = soften(&p, &[]).unwrap_err().to_string();
    assert!(said.contains("0 softnesses for 1 creases"), "{said}");
}

#[test]
fn a_corner_in_a_soft_crease_is_refused_where_it_is() {
    let bent = PlanarCurve::polyline(&[v(0.0, 300.0), v(500.0, 300.0), v(500.0, 600.0)]).unwrap();
    let p = pattern(sheet(), vec![], vec![bent]);
    let said = soften(&p, &[soft(20.0, 90.0, 4)]).unwrap_err().to_string();
    assert!(said.contains("corner of 90.0°") && said.contains("(500.000, 300.000)"), "{said}");
    assert!(soften(&p, &[soft(0.0, 90.0, 4)]).is_ok(), "a sharp crease may have it");
}

#[test]
fn the_picture_names_bands_radii_and_turns() {
    let p = pattern(sheet(), vec![], vec![arc_crease()]);
    let s = soften(&p, &[soft(50.0, 90.0, 6)]).unwrap();
    let picture = write_svg(&p, &s);
    for part in
        ["width=\"1040mm\"", "c0: r 50 mm, 90°", "6 strips, turns 15°, outer 7.5°", "turn 15°", "turn 7.5°"]
    {
        assert!(picture.contains(part), "{part}");
    }
    assert_eq!(picture, write_svg(&p, &s));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Any straight crease across the sheet: lines lie on the parallels, end on the outline, and the
    /// turns add up; or the band is refused with a radius that fits.
    #[test]
    fn straight_creases_soften_or_say_what_fits(
        x in 150.0..850.0f64, y in 150.0..850.0f64, r in 0.5..120.0f64, degrees in -170.0..170.0f64, n in 1u32..9,
    ) {
        prop_assume!(degrees.abs() > 0.5);
        let (a, b) = ((x, 0.0), (y, 600.0));
        let p = pattern(sheet(), vec![], vec![line(a, b)]);
        match soften(&p, &[soft(r, degrees, n)]) {
            Ok(s) => {
                s.check().unwrap();
                let normal = (v(b.0, b.1) - v(a.0, a.1)).normalize().perp();
                for l in &s.bands[0].fold_lines {
                    for q in &l.points {
                        prop_assert!(((*q - v(a.0, a.1)).dot(normal) - l.offsets_mm[0]).abs() < 1e-9);
                    }
                    for (end, q) in l.ends.iter().zip([l.points[0], l.points[l.points.len() - 1]]) {
                        prop_assert!(p.outline.point(end.on_boundary().unwrap().s_mm).distance(q) < 1e-6);
                    }
                }
            }
            Err(SoftenError::Crease { fault: Fault::Misfit { largest_radius_mm: Some(fits), .. }, .. }) => {
                prop_assert!(fits < r);
                prop_assert!(soften(&p, &[soft(0.999 * fits, degrees, n)]).is_ok());
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }
}
