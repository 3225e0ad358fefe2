//! Radii and fold angles that change along the crease, against closed forms and another implementation.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

mod common;

use common::*;
use kurbo::{BezPath, CubicBez, ParamCurveNearest, Point};
use proptest::prelude::*;
use softfold_geometry::{Band, DVec2, FoldLine, LineEnd, PlanarCurve, Segment};
use softfold_soften::{Along, CreaseSoftness, Fault, Misfit, Segments, SoftenError, regions, soften};
use std::f64::consts::PI;

/// A straight crease up the middle of the sheet, 600 mm.
fn straight() -> PlanarCurve {
    line((500.0, 0.0), (500.0, 600.0))
}

fn band(curve: PlanarCurve, softness: CreaseSoftness) -> Band {
    let p = pattern(sheet(), vec![], vec![curve]);
    let s = soften(&p, &[softness]).unwrap();
    s.check().unwrap();
    assert_turns_and_widths(&s.bands[0]);
    s.bands[0].clone()
}

fn angled(angles: &[(f64, f64)], radius: f64, n: u32) -> CreaseSoftness {
    let angles = angles.iter().map(|(s, d)| (*s, d.to_radians())).collect();
    CreaseSoftness { fold_angle_rad: Along::Places(angles), ..soft(radius, 0.0, n) }
}

/// Every point is where its place and offset put it, exactly.
fn assert_on_offsets(curve: &PlanarCurve, band: &Band) {
    for l in &band.fold_lines {
        for (i, &s) in l.s_mm.iter().enumerate().filter(|(_, s)| **s > 0.0 && **s < curve.length_mm()) {
            let exact = curve.point(s) + l.offsets_mm[i] * curve.tangent(s).perp();
            assert!(exact.distance(l.points[i]) < 1e-6, "{} at {s}", exact.distance(l.points[i]));
        }
    }
}

fn first(l: &FoldLine) -> DVec2 {
    l.points[0]
}

fn last(l: &FoldLine) -> DVec2 {
    l.points[l.points.len() - 1]
}

#[test]
fn a_linear_taper_of_a_straight_crease_has_straight_lines_through_its_tip() {
    let b = band(straight(), tapered(&[(0.0, 40.0), (450.0, 0.0)], 90.0, 6));
    assert_eq!(b.fold_lines.len(), 7 + 1);
    for l in &b.fold_lines[..7] {
        assert_eq!(l.ends[1], LineEnd::Tip);
        assert_eq!(last(l), v(500.0, 450.0), "to the last bit");
        assert_eq!(l.points.len(), 2, "nothing to follow");
        let k = f64::from(l.rank.unwrap());
        let x = 80.0 * (PI / 24.0).sin();
        assert!(first(l).distance(v(500.0 - (k - 3.0) * x, 0.0)) < 1e-9);
    }
    let sharp = &b.fold_lines[7];
    assert_eq!((sharp.rank, first(sharp), sharp.ends[0]), (None, v(500.0, 450.0), LineEnd::Tip));
    assert!(sharp.ends[1].on_boundary().is_some());
    assert!(sharp.turns_rad.iter().all(|t| (t - PI / 2.0).abs() < 1e-15));
}

#[test]
fn soft_becomes_sharp_and_soft_again_along_an_arc() {
    let length = arc_crease().length_mm();
    let radii = [(0.2 * length, 30.0), (0.4 * length, 0.0), (0.6 * length, 0.0), (length, 50.0)];
    let b = band(arc_crease(), tapered(&radii, -80.0, 4));
    assert_eq!(b.fold_lines.iter().filter(|l| l.rank.is_none()).count(), 1);
    assert_eq!(b.fold_lines.len(), 5 + 1 + 5);
    let sharp = &b.fold_lines[5];
    assert!(b.fold_lines[..5].iter().all(|l| last(l) == first(sharp) && l.ends[1] == LineEnd::Tip));
    assert!(b.fold_lines[6..].iter().all(|l| first(l) == last(sharp) && l.ends[0] == LineEnd::Tip));
    for l in &b.fold_lines {
        // Every point is on its own parallel of the circle, every chord within 0.005 mm.
        let height = |p: DVec2| p.distance(v(500.0, -300.0)) - 700.0;
        for (p, o) in l.points.iter().zip(&l.offsets_mm) {
            assert!((height(*p) - o).abs() < 1e-5);
        }
        for (w, o) in l.points.windows(2).zip(l.offsets_mm.windows(2)) {
            assert!((height(0.5 * (w[0] + w[1])) - 0.5 * (o[0] + o[1])).abs() < 0.01);
        }
    }
}

#[test]
fn a_fold_angle_that_grows_from_zero_opens_like_a_cone() {
    let b = band(straight(), angled(&[(0.0, 0.0), (600.0, 120.0)], 50.0, 4));
    for l in &b.fold_lines {
        assert_eq!(first(l), v(500.0, 0.0));
        assert!(l.ends[0].on_boundary().is_some(), "the crease starts on the outline");
        let k = f64::from(l.rank.unwrap());
        // The curve itself, between its stations too.
        let exact = |y: f64| 500.0 - (k - 2.0) * 100.0 * ((120.0 * y / 600.0).to_radians() / 8.0).sin();
        for w in l.points.windows(2) {
            let middle = 0.5 * (w[0] + w[1]);
            assert!((w[1].x - exact(w[1].y)).abs() < 1e-9);
            assert!((middle.x - exact(middle.y)).abs() < 0.01);
        }
    }
}

#[test]
fn a_fold_angle_changes_its_sign_in_a_tip() {
    let b = band(straight(), angled(&[(100.0, 60.0), (400.0, -30.0)], 40.0, 3));
    assert_eq!(b.fold_lines.len(), 8);
    let tip = v(500.0, 300.0);
    for (a, z) in b.fold_lines[..4].iter().zip(&b.fold_lines[4..]) {
        assert_eq!((last(a), first(z)), (last(&b.fold_lines[0]), last(&b.fold_lines[0])));
        assert!(last(a).distance(tip) < 1e-9);
        assert!(a.turns_rad.iter().all(|t| *t >= 0.0) && z.turns_rad.iter().all(|t| *t <= 0.0));
    }
}

#[test]
fn a_sharp_fold_changes_its_sign_where_two_lines_meet() {
    let b = band(straight(), angled(&[(0.0, 60.0), (600.0, -60.0)], 0.0, 3));
    assert_eq!(b.fold_lines.len(), 2);
    assert_eq!(last(&b.fold_lines[0]), first(&b.fold_lines[1]));
    assert_eq!(*b.fold_lines[0].turns_rad.last().unwrap(), 0.0);
}

#[test]
fn a_stretch_without_fold_angle_has_no_lines() {
    let b = band(straight(), angled(&[(100.0, 60.0), (200.0, 0.0), (400.0, 0.0), (500.0, 60.0)], 30.0, 3));
    assert_eq!(b.fold_lines.len(), 8);
    assert!(last(&b.fold_lines[0]).distance(v(500.0, 200.0)) < 1e-9);
    assert!(first(&b.fold_lines[4]).distance(v(500.0, 400.0)) < 1e-9);
}

#[test]
fn a_closed_crease_that_changes_its_sign_twice_has_two_tips() {
    let circle = arc(v(500.0, 300.0), 150.0, 0.0, 2.0 * PI);
    let l = circle.length_mm();
    let b = band(circle.clone(), angled(&[(0.2 * l, 60.0), (0.7 * l, -60.0)], 40.0, 4));
    assert_eq!(b.fold_lines.len(), 10);
    assert_eq!(last(&b.fold_lines[0]), first(&b.fold_lines[5]));
    assert!(last(&b.fold_lines[5]).distance(first(&b.fold_lines[0])) < 1e-9);
    for line in &b.fold_lines {
        assert!(line.s_mm.windows(2).all(|w| w[0] < w[1]));
        for (s, (p, o)) in line.s_mm.iter().zip(line.points.iter().zip(&line.offsets_mm)) {
            // Closed curves take arc lengths beyond their length.
            assert!((circle.point(*s) + *o * circle.tangent(*s).perp()).distance(*p) < 1e-6);
        }
    }
}

#[test]
fn offsets_of_an_ellipse_are_those_of_its_parametric_form() {
    let (a, b) = (300.0, 180.0);
    let at = |t: f64| v(500.0 + a * t.cos(), 300.0 + b * t.sin());
    let d = |t: f64| v(-a * t.sin(), b * t.cos());
    let n = 96;
    let step = 2.0 * PI / f64::from(n);
    let piece = |k: u32| {
        let (t, u) = (step * f64::from(k), step * f64::from(k + 1));
        Segment::Cubic {
            from: at(t),
            c1: at(t) + step / 3.0 * d(t),
            c2: at(u) - step / 3.0 * d(u),
            to: if k + 1 == n { at(0.0) } else { at(u) },
        }
    };
    let ellipse = PlanarCurve::new((0..n).map(piece).collect()).unwrap();
    let result = band(ellipse, soft(45.0, 100.0, 5));
    for l in &result.fold_lines {
        let o = l.offsets_mm[0];
        let exact = |t: f64| at(t) + o * d(t).normalize().perp();
        // The parameter of the exact parallel's nearest point, by Newton from the polar angle.
        let miss = |p: DVec2| {
            let mut t = ((p.y - 300.0) / b).atan2((p.x - 500.0) / a);
            for _ in 0..50 {
                let speed = (exact(t + 1e-5) - exact(t - 1e-5)) / 2e-5;
                t -= (exact(t) - p).dot(speed) / speed.length_squared();
            }
            exact(t).distance(p)
        };
        for w in l.points.windows(2) {
            assert!(miss(w[0]) < 1e-4, "{}", miss(w[0]));
            assert!(miss(0.5 * (w[0] + w[1])) < 0.01, "{}", miss(0.5 * (w[0] + w[1])));
        }
    }
}

#[test]
fn offsets_of_a_spline_agree_with_kurbos_within_a_hundredth_of_a_millimetre() {
    let c = [v(0.0, 200.0), v(400.0, 700.0), v(600.0, -100.0), v(1000.0, 400.0)];
    let curve = PlanarCurve::new(vec![Segment::Cubic { from: c[0], c1: c[1], c2: c[2], to: c[3] }]).unwrap();
    let result = band(curve, soft(60.0, 70.0, 6));
    let p = |v: DVec2| Point::new(v.x, v.y);
    let cubic = CubicBez::new(p(c[0]), p(c[1]), p(c[2]), p(c[3]));
    for l in &result.fold_lines {
        let mut path = BezPath::new();
        kurbo::offset::offset_cubic(cubic, l.offsets_mm[0], 1e-4, &mut path);
        let miss = |q: DVec2| {
            let near = path.segments().map(|s| s.nearest(p(q), 1e-9).distance_sq);
            near.fold(f64::MAX, f64::min).sqrt()
        };
        for w in l.points.windows(2).filter(|w| w[0].x > 60.0 && w[1].x < 940.0) {
            assert!(miss(w[0]) < 1e-3, "{} {}", miss(w[0]), l.offsets_mm[0]);
            assert!(miss(0.5 * (w[0] + w[1])) < 0.01);
        }
    }
}

#[test]
fn a_chord_tolerance_holds_where_the_sagitta_is_largest() {
    // Radius falls while the angle grows: the worst place is between the ends.
    let tolerance_mm = 0.4;
    let softness = CreaseSoftness {
        radius_mm: Along::Places(vec![(0.0, 60.0), (600.0, 5.0)]),
        fold_angle_rad: Along::Places(vec![(0.0, 0.3), (600.0, 2.8)]),
        segments: Segments::Chord { tolerance_mm },
    };
    let b = band(straight(), softness);
    let worst = |n: u32| {
        (0..=1000)
            .map(|i| b.at(0.6 * f64::from(i)).unwrap())
            .map(|e| e.radius_mm * (1.0 - (e.fold_angle_rad / f64::from(2 * n)).cos()))
            .fold(0.0, f64::max)
    };
    assert!(worst(b.segments) <= tolerance_mm && worst(b.segments - 1) > tolerance_mm);
}

#[test]
fn lists_that_are_none_are_refused_with_the_mend() {
    let p = pattern(sheet(), vec![], vec![straight()]);
    let places = |list: &[(f64, f64)]| Along::Places(list.to_vec());
    for (list, part) in [
        (vec![], "is empty"),
        (vec![(300.0, 1.0), (200.0, 1.0)], "not sorted"),
        (vec![(200.0, 1.0), (200.0, 2.0)], "200 mm twice"),
        (vec![(-1.0, 1.0)], "place -1 mm, but the crease is 600.000 mm long"),
        (vec![(0.0, 1.0), (600.1, 1.0)], "600.1"),
        (vec![(f64::NAN, 1.0)], "no finite number"),
        (vec![(0.0, 1.0); 20_000], "20000 entries"),
    ] {
        let radius = CreaseSoftness { radius_mm: places(&list), ..soft(1.0, 60.0, 3) };
        let angle = CreaseSoftness { fold_angle_rad: places(&list), ..soft(1.0, 60.0, 3) };
        for (softness, what) in [(radius, "its radius"), (angle, "its fold angle")] {
            let said = soften(&p, &[softness]).unwrap_err().to_string();
            assert!(said.contains(part) && said.contains(what) && said.contains("ascending"), "{said}");
        }
    }
    let said = |s: CreaseSoftness| soften(&p, &[s]).unwrap_err().to_string();
    let radius = said(tapered(&[(0.0, 10.0), (100.0, f64::NAN)], 60.0, 3));
    assert!(radius.contains("radius NaN mm at 100.000 mm along it"), "{radius}");
    let angle = said(angled(&[(0.0, 10.0), (250.0, 181.0)], 10.0, 3));
    assert!(angle.contains("181.000° at 250.000 mm along it"), "{angle}");
    assert!(said(angled(&[(0.0, 0.0), (250.0, 0.0)], 10.0, 3)).contains("not 0 everywhere"));
}

#[test]
fn a_bulge_of_the_radius_stops_at_the_centre_of_curvature() {
    // Half a circle of radius 60; the radius is largest in its middle.
    let p = pattern(sheet(), vec![], vec![arc(v(500.0, 0.0), 60.0, PI, 0.0)]);
    let l = p.creases[0].curve.length_mm();
    let softness = tapered(&[(0.3 * l, 10.0), (0.5 * l, 200.0), (0.7 * l, 10.0)], 90.0, 6);
    let error = soften(&p, std::slice::from_ref(&softness)).unwrap_err();
    let SoftenError::Crease { fault: Fault::Misfit { why, largest_radius_mm: Some(r), .. }, .. } = &error
    else {
        panic!("{error}")
    };
    assert_eq!(**why, Misfit::Curvature);
    assert!((r / radius_of(60.0, 90.0, 6) - 1.0).abs() < 1e-3, "{r}");
    assert!(soften(&p, &[softness.scaled(r / 200.0)]).is_ok());
    assert!(soften(&p, &[softness.scaled(1.001 * r / 200.0)]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Two bent creases with random radii and angles along them: the bands keep their contract, or the
    /// refusal names a radius that fits and above which nothing does.
    #[test]
    fn bent_tapered_bands_soften_or_are_refused_for_a_true_reason(
        bends in proptest::collection::vec(-100.0..100.0f64, 2), heights in proptest::collection::vec(320.0..460.0f64, 4),
        radii in proptest::collection::vec(0.0..90.0f64, 6), angles in proptest::collection::vec(-120.0..120.0f64, 6), n in 1u32..7,
    ) {
        let low = |i: usize| [180.0, 0.0][i];
        let curves: Vec<PlanarCurve> =
            (0..2).map(|i| bent(v(0.0, heights[2 * i] - low(i)), v(1000.0, heights[2 * i + 1] - low(i)), bends[i])).collect();
        let p = pattern(sheet(), vec![], curves);
        let list = |values: &[f64], i: usize, l: f64| Along::Places(vec![(0.1 * l, values[3 * i]), (0.5 * l, values[3 * i + 1]), (0.8 * l, values[3 * i + 2])]);
        let softness: Vec<CreaseSoftness> = p.creases.iter().enumerate().map(|(i, c)| {
            let l = c.curve.length_mm();
            let radius = radii.iter().map(|r| if *r < 15.0 { 0.0 } else { *r }).collect::<Vec<_>>();
            let angle = angles.iter().map(|a| a.to_radians()).collect::<Vec<_>>();
            CreaseSoftness { radius_mm: list(&radius, i, l), fold_angle_rad: list(&angle, i, l), segments: Segments::Count(n) }
        }).collect();
        match soften(&p, &softness) {
            Ok(s) => {
                s.check().unwrap();
                assert_nothing_crosses(&s);
                let areas: Vec<f64> = regions(&s).unwrap().iter().map(|r| r.area_mm2).collect();
                prop_assert!(areas.iter().all(|a| *a > 0.0));
                prop_assert!((areas.iter().sum::<f64>() / p.area_mm2() - 1.0).abs() < 1e-9);
                for (crease, band) in p.creases.iter().zip(&s.bands) {
                    assert_turns_and_widths(band);
                    assert_on_offsets(&crease.curve, band);
                    for l in &band.fold_lines {
                        for (end, q) in l.ends.iter().zip([first(l), last(l)]) {
                            let on = end.on_boundary().map(|on| p.outline.point(on.s_mm).distance(q));
                            prop_assert!(on.is_none_or(|d| d < 1e-6));
                        }
                    }
                }
            }
            Err(SoftenError::Crease { id, fault: Fault::Misfit { largest_radius_mm, radius_mm, why, .. }, .. }) => {
                let with = |factor: f64| {
                    let mut all = softness.clone();
                    all[id.index()] = all[id.index()].scaled(factor);
                    soften(&p, &all)
                };
                match largest_radius_mm {
                    Some(r) => {
                        prop_assert!(r < radius_mm);
                        prop_assert!(with(r / radius_mm).is_ok(), "{:?}", why);
                        prop_assert!(with(1.001 * r / radius_mm).is_err(), "{:?}", why);
                    }
                    None => prop_assert!(with(0.0).is_err(), "{:?}", why),
                }
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }
}
