//! Truths about fitted surfaces.

use crate::testing::{BandSheet, rectangle, scatter, scattered};
use crate::{Fitted, SurfaceError, SurfaceOptions, analyse, fit};
use glam::{DVec2, DVec3};
use softfold_geometry::{FoldedSheet, PlanarCurve};

const SIZE: DVec2 = DVec2::new(210.0, 130.0);

fn at_spacing(spacing_mm: f64) -> SurfaceOptions {
    SurfaceOptions { spacing_mm: Some(spacing_mm), ..SurfaceOptions::default() }
}

fn plane(p: DVec2) -> DVec3 {
    DVec3::new(5.0, -3.0, 100.0) + p.x * DVec3::new(0.6, 0.0, 0.8) + p.y * DVec3::Y
}

fn cylinder(p: DVec2) -> DVec3 {
    DVec3::new(100.0 * (p.x / 100.0).sin(), p.y, 100.0 * (1.0 - (p.x / 100.0).cos()))
}

/// A cone about z of 52° from its axis to its side, its apex 150 mm to the left of the sheet.
fn cone(p: DVec2) -> DVec3 {
    let (sin, cos) = 0.9_f64.sin_cos();
    let q = p + DVec2::new(150.0, -0.5 * SIZE.y);
    let around = DVec2::from_angle(q.to_angle() / sin);
    q.length() * (sin * around).extend(cos)
}

fn probes(count: usize) -> impl Iterator<Item = DVec2> {
    (0..count).map(|k| SIZE * scatter(k))
}

#[test]
fn a_plane_is_reproduced_exactly() {
    let fitted = fit(&scattered(SIZE, 12.0, plane), &rectangle(SIZE), &SurfaceOptions::default()).unwrap();
    assert!(fitted.tolerance_met, "{}", fitted.why);
    assert!(fitted.surface.deviation.max_mm < 1e-9, "{:?}", fitted.surface.deviation);
    let s = &fitted.surface.spline;
    for (k, pole) in s.poles.iter().enumerate() {
        let flat = s.origin + s.spacing_mm * DVec2::new((k / s.count[1]) as f64, (k % s.count[1]) as f64);
        assert!(pole.distance(plane(flat)) < 1e-8, "pole {k}, past the outline too");
    }
}

/// Largest distance of a fitted surface from the closed form that it was fitted to, mm.
fn off_mm(fitted: &Fitted, shape: impl Fn(DVec2) -> DVec3) -> f64 {
    let spline = &fitted.surface.spline;
    probes(2000).map(|p| spline.at(p).position.distance(shape(p))).fold(0.0, f64::max)
}

#[test]
fn on_a_cylinder_and_a_cone_the_error_falls_with_the_fourth_power() {
    for shape in [cylinder, cone] {
        let sheet = scattered(SIZE, 5.0, shape);
        let error = |spacing_mm| {
            let options = SurfaceOptions { bending_weight: 1e-8, ..at_spacing(spacing_mm) };
            off_mm(&fit(&sheet, &rectangle(SIZE), &options).unwrap(), shape)
        };
        let (coarse, fine) = (error(40.0), error(20.0));
        assert!((coarse / fine).log2() > 3.5, "{coarse} {fine}");
        assert!(fine < 4e-3, "{fine}");
    }
}

#[test]
fn cylinder_and_cone_are_met_between_the_vertices() {
    for shape in [cylinder, cone] {
        let options = SurfaceOptions { tolerance_mm: 0.01, ..SurfaceOptions::default() };
        let fitted = fit(&scattered(SIZE, 5.0, shape), &rectangle(SIZE), &options).unwrap();
        assert!(off_mm(&fitted, shape) < 0.02, "{} {}", off_mm(&fitted, shape), fitted.why);
    }
}

#[test]
fn beside_a_soft_band_and_along_its_middle_the_surface_is_the_bend() {
    for (strips, tilt_rad) in [(6, 0.0), (6, 0.4)] {
        let band = BandSheet::right_angle(30.0, strips, tilt_rad);
        let fitted = fit(&band.sheet(8.0), &band.trim(), &SurfaceOptions::default()).unwrap();
        let off = |across: f64, k: usize| {
            let p = DVec2::new(across, scatter(k).y * band.length_mm);
            let uv = DVec2::from_angle(band.tilt_rad).rotate(p);
            band.distance_to_bend(fitted.surface.spline.at(uv).position)
        };
        let beside = (0..500).map(|k| {
            let across = band.half_width_mm() + band.flank_mm * (0.35 + 0.65 * scatter(k).x);
            off(if k % 2 == 0 { across } else { -across }, k)
        });
        let beside = beside.fold(0.0, f64::max);
        let middle =
            (0..500).map(|k| off(band.half_width_mm() * (scatter(k).x - 0.5), k)).fold(0.0, f64::max);
        assert!(beside < 0.02, "{beside}");
        assert!(middle < 0.05, "{middle}");
    }
}

#[test]
fn a_soft_band_keeps_its_vertices_and_its_radius() {
    for (strips, tilt_rad) in [(5, 0.0), (5, 0.5), (4, 0.3), (3, 0.2)] {
        let band = BandSheet::right_angle(30.0, strips, tilt_rad);
        let fitted = fit(&band.sheet(13.0), &band.trim(), &SurfaceOptions::default()).unwrap();
        let case = format!("{strips} strips at {tilt_rad}: {}", fitted.why);
        assert!(fitted.tolerance_met && fitted.surface.deviation.max_mm <= 0.05, "{case}");
        let radius_mm = analyse(&fitted.surface, 1.0).unwrap().min_radius_mm;
        assert!((radius_mm.value / 30.0 - 1.0).abs() < 0.15, "{case}: {radius_mm:?}");
        assert!(between(&band, &fitted) < 0.2, "{case}: {}", between(&band, &fitted));
    }
}

/// Largest distance of the surface to the smooth bend, mm, on the band and 50 mm beside it.
fn between(band: &BandSheet, fitted: &Fitted) -> f64 {
    let reach = DVec2::new(band.half_width_mm() + 50.0, band.length_mm);
    let place = |k| (scatter(k) * DVec2::new(2.0, 1.0) - DVec2::X) * reach;
    let off = |p: DVec2| {
        let uv = DVec2::from_angle(band.tilt_rad).rotate(p);
        band.distance_to_bend(fitted.surface.spline.at(uv).position)
    };
    (0..2000).map(place).map(off).fold(0.0, f64::max)
}

#[test]
fn a_heavier_plate_bends_less_and_strays_more() {
    let band = BandSheet::right_angle(30.0, 5, 0.5);
    let fits = [1e-4, 1e-2].map(|bending_weight| {
        let options = SurfaceOptions { bending_weight, ..at_spacing(8.0) };
        fit(&band.sheet(13.0), &band.trim(), &options).unwrap().surface
    });
    let [light, heavy] = fits.each_ref().map(|s| analyse(s, 1.0).unwrap().min_radius_mm.value);
    assert!(light < heavy && fits[0].deviation.max_mm < fits[1].deviation.max_mm, "{light} {heavy}");
}

#[test]
fn past_the_outline_the_surface_is_calm() {
    let band = BandSheet::right_angle(30.0, 5, 0.0);
    let sheets = [(scattered(SIZE, 9.0, cylinder), rectangle(SIZE)), (band.sheet(13.0), band.trim())];
    for (sheet, trim) in sheets {
        let options = SurfaceOptions { margin_cells: 6, ..SurfaceOptions::default() };
        let [inside, outside] = largest_second_differences(&fit(&sheet, &trim, &options).unwrap(), &sheet);
        assert!(outside <= inside * (1.0 + 1e-9), "{outside} {inside}");
    }
}

/// The largest second difference of poles with its middle in the sheet's box, and with it more than a cell outside.
fn largest_second_differences(fitted: &Fitted, sheet: &FoldedSheet) -> [f64; 2] {
    let s = &fitted.surface.spline;
    let (lo, hi) = softfold_geometry::polygon::bounds(&sheet.mesh.vertices);
    let mut largest = [0.0_f64; 2];
    for k in 0..s.poles.len() {
        let (i, j) = (k / s.count[1], k % s.count[1]);
        let flat = s.origin + s.spacing_mm * DVec2::new(i as f64, j as f64);
        let past = (lo - flat).max(flat - hi).max_element() / s.spacing_mm;
        if (0.0..=1.0).contains(&past) {
            continue;
        }
        let side = usize::from(past > 0.0);
        let steps = [(s.count[1], i, s.count[0]), (1, j, s.count[1])];
        for (step, ..) in steps.into_iter().filter(|&(_, place, count)| (1..count - 1).contains(&place)) {
            let difference = s.poles[k - step] - 2.0 * s.poles[k] + s.poles[k + step];
            largest[side] = largest[side].max(difference.length());
        }
    }
    largest
}

#[test]
fn the_deviation_is_where_a_vertex_was_moved() {
    let mut sheet = scattered(SIZE, 10.0, plane);
    let moved = sheet.positions.len() / 2 + 4;
    sheet.positions[moved] += DVec3::new(0.0, 3.0, 4.0);
    let fitted = fit(&sheet, &rectangle(SIZE), &at_spacing(30.0)).unwrap();
    assert_eq!(fitted.surface.deviation.at, sheet.mesh.vertices[moved]);
    assert!((3.0..5.0).contains(&fitted.surface.deviation.max_mm));
    assert!(fitted.surface.deviation.rms_mm < 0.5);
    assert!(!fitted.tolerance_met && fitted.why.contains("surface.tolerance_mm"), "{}", fitted.why);
}

#[test]
fn the_cage_carries_the_poles_and_the_surface_the_trim() {
    let trim = rectangle(SIZE);
    let fitted = fit(&scattered(SIZE, 10.0, cylinder), &trim, &at_spacing(15.0)).unwrap();
    let spline = &fitted.surface.spline;
    spline.check().unwrap();
    assert_eq!((fitted.spacing_mm, spline.spacing_mm), (15.0, 15.0));
    assert_eq!(fitted.cage.positions, spline.poles);
    assert_eq!(fitted.cage.quads.len(), (spline.count[0] - 1) * (spline.count[1] - 1));
    let (lo, hi) = spline.domain();
    assert!(lo.cmplt(DVec2::ZERO).all() && hi.cmpgt(SIZE).all());
    assert_eq!(fitted.surface.trim, trim);
}

#[test]
fn same_input_same_poles() {
    let band = BandSheet::right_angle(30.0, 5, 0.3);
    let poles =
        || fit(&band.sheet(13.0), &band.trim(), &SurfaceOptions::default()).unwrap().surface.spline.poles;
    assert_eq!(poles(), poles());
}

/// A plane whose vertices are off by up to 1 mm at random.
fn rough() -> FoldedSheet {
    let mut sheet = scattered(SIZE, 10.0, plane);
    let noise = |k: usize| 2.0 * scatter(7 * k).x - 1.0;
    sheet.positions.iter_mut().enumerate().for_each(|(k, p)| p.z += noise(k));
    sheet
}

#[test]
fn a_tolerance_out_of_reach_is_told_and_a_finer_lattice_reaches_it() {
    let coarse = SurfaceOptions { min_spacing_mm: Some(25.0), ..SurfaceOptions::default() };
    let fitted = fit(&rough(), &rectangle(SIZE), &coarse).unwrap();
    assert!(!fitted.tolerance_met && fitted.spacing_mm == 25.0);
    assert!(fitted.why.contains("min_spacing_mm") && fitted.why.contains("tolerance_mm"), "{}", fitted.why);
    let fitted = fit(&rough(), &rectangle(SIZE), &SurfaceOptions::default()).unwrap();
    assert!(fitted.tolerance_met && fitted.spacing_mm < 10.0, "{}", fitted.why);
    let strict = SurfaceOptions { tolerance_mm: 0.002, ..SurfaceOptions::default() };
    let fitted = fit(&rough(), &rectangle(SIZE), &strict).unwrap();
    assert!(fitted.tolerance_met && fitted.bending_weight < strict.bending_weight, "{}", fitted.why);
}

#[test]
fn bad_options_are_named_by_their_keys() {
    let refused = |options: SurfaceOptions| {
        fit(&scattered(SIZE, 30.0, plane), &rectangle(SIZE), &options).unwrap_err().to_string()
    };
    let good = SurfaceOptions::default;
    let bad = [
        ("surface.spacing_mm", at_spacing(0.0)),
        ("surface.spacing_mm", at_spacing(1e-300)),
        ("surface.tolerance_mm", SurfaceOptions { tolerance_mm: -0.1, ..good() }),
        ("surface.min_spacing_mm", SurfaceOptions { min_spacing_mm: Some(f64::NAN), ..good() }),
        ("surface.bending_weight", SurfaceOptions { bending_weight: 0.0, ..good() }),
        ("surface.margin_cells", SurfaceOptions { margin_cells: 0, ..good() }),
        ("surface.margin_cells", SurfaceOptions { margin_cells: 101, ..good() }),
    ];
    for (key, options) in bad {
        let message = refused(options);
        assert!(message.starts_with(key) && message.contains("give"), "{message}");
    }
}

#[test]
fn the_least_spacing_that_is_offered_is_taken() {
    let sheet = scattered(SIZE, 30.0, plane);
    let Err(SurfaceError::TooManyPoles { least_mm, limit, .. }) =
        fit(&sheet, &rectangle(SIZE), &at_spacing(0.1))
    else {
        unreachable!("2 million poles are too many");
    };
    let lattice = |h| crate::lattice::Lattice::over((DVec2::ZERO, SIZE), h, 3).vertices();
    assert!(lattice(least_mm) <= limit && lattice(0.98 * least_mm) > limit);
}

#[test]
fn bad_sheets_and_trims_are_refused() {
    let sheet = scattered(SIZE, 30.0, plane);
    let options = SurfaceOptions::default();
    assert_eq!(fit(&sheet, &[], &options), Err(SurfaceError::NoTrim));
    let open = [PlanarCurve::polyline(&[DVec2::ZERO, SIZE]).unwrap()];
    assert_eq!(fit(&sheet, &open, &options), Err(SurfaceError::OpenTrim { number: 0, at: SIZE }));
    let mut broken = sheet.clone();
    broken.positions[3].z = f64::NAN;
    assert!(matches!(fit(&broken, &rectangle(SIZE), &options), Err(SurfaceError::Sheet(_))));
    let mut empty = sheet;
    (empty.mesh.triangles, empty.mesh.edges) = Default::default();
    assert_eq!(fit(&empty, &rectangle(SIZE), &options), Err(SurfaceError::Empty));
}
