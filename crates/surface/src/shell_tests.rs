//! Truths about surfaces of several faces.

use crate::testing::{grid, rectangle, scatter};
use crate::{Cut, CutKind, FittedShell, SurfaceOptions, fit_shell};
use glam::{DVec2, DVec3};
use softfold_geometry::{CreaseId, FoldedSheet, PlanarCurve, Segment, ShellEdgeKind, ShellFace};

/// A cylinder of radius [`R`] about z, cut by the plane z = [`M`]·x and reflected above it: a sharp crease along
/// y = M R cos(x/R) in the sheet (Fuchs and Tabachnikov 1999).
const R: f64 = 100.0;
const M: f64 = 1.2;
/// Half the sheet's width along x.
const HALF_MM: f64 = 100.0;
/// How far it reaches below and above the crease.
const REACH_MM: f64 = 80.0;

fn crease_at(x: f64) -> f64 {
    M * R * (x / R).cos()
}

/// The exact folded state; `above` tells the side of the crease.
fn folded(p: DVec2, above: bool) -> DVec3 {
    let on_cylinder = DVec3::new(R * (p.x / R).cos(), R * (p.x / R).sin(), p.y);
    if !above {
        return on_cylinder;
    }
    let normal = DVec3::new(M, 0.0, -1.0).normalize();
    on_cylinder - 2.0 * on_cylinder.dot(normal) * normal
}

fn flat(across: f64, x: f64) -> DVec2 {
    DVec2::new(x, crease_at(x) + across)
}

/// The sheet with vertices on its rulings, every `step_mm`.
fn creased_cylinder(step_mm: f64) -> FoldedSheet {
    let even = |half: f64| -> Vec<f64> {
        let n = (half / step_mm).round() as i32;
        (-n..=n).map(|k| half * f64::from(k) / f64::from(n)).collect()
    };
    let (across, along) = (even(REACH_MM), even(HALF_MM));
    let middle = across.len() / 2;
    let place = |p: DVec2| flat(p.x, -p.y);
    let turn = |column: usize| if column == middle { 1.0 } else { 0.0 };
    grid(&across, &along, place, |p| folded(place(p), p.x > 0.0), turn)
}

/// A curve `across` from the crease, from x = `from` to `to`, by cubics through its points and tangents.
fn parallel(across: f64, from: f64, to: f64) -> PlanarCurve {
    let pieces = 20;
    let cubic = |k: usize| {
        let at = |k: usize| from + (to - from) * k as f64 / f64::from(pieces);
        let (a, b) = (at(k), at(k + 1));
        let slope = |x: f64| DVec2::new(1.0, -M * (x / R).sin()) * (b - a) / 3.0;
        let (p, q) = (flat(across, a), flat(across, b));
        Segment::Cubic { from: p, c1: p + slope(a), c2: q - slope(b), to: q }
    };
    PlanarCurve::new((0..pieces as usize).map(cubic).collect()).unwrap()
}

fn trim() -> Vec<PlanarCurve> {
    let mut segments = parallel(-REACH_MM, -HALF_MM, HALF_MM).segments().to_vec();
    segments.push(Segment::Line { from: flat(-REACH_MM, HALF_MM), to: flat(REACH_MM, HALF_MM) });
    segments.extend(parallel(REACH_MM, HALF_MM, -HALF_MM).segments());
    segments.push(Segment::Line { from: flat(REACH_MM, -HALF_MM), to: flat(-REACH_MM, -HALF_MM) });
    vec![PlanarCurve::new(segments).unwrap()]
}

/// The grid numbers the fold lines by their columns.
fn crease(curve: PlanarCurve, step_mm: f64) -> Cut {
    let line = (REACH_MM / step_mm).round() as u32;
    Cut { curve, kind: CutKind::Crease { crease: CreaseId(0), line } }
}

fn face_at(fitted: &FittedShell, p: DVec2) -> &ShellFace {
    let inside = |f: &usize| {
        let trim = &fitted.shell.face_surface(*f).unwrap().trim[0];
        softfold_geometry::polygon::contains(&trim.flatten(1e-3), p)
    };
    &fitted.shell.faces[(0..fitted.shell.faces.len()).find(inside).unwrap()]
}

/// Largest distance from the closed form, mm.
fn error_mm(fitted: &FittedShell) -> f64 {
    let probe = |k: usize| {
        let s = 0.999 * (2.0 * scatter(k) - 1.0);
        let p = flat(REACH_MM * s.y, HALF_MM * s.x);
        face_at(fitted, p).spline.at(p).position.distance(folded(p, s.y > 0.0))
    };
    (0..500).map(probe).fold(0.0, f64::max)
}

fn at_spacing(spacing_mm: f64) -> SurfaceOptions {
    SurfaceOptions { spacing_mm: Some(spacing_mm), bending_weight: 1e-8, ..SurfaceOptions::default() }
}

#[test]
fn a_creased_cylinder_is_two_faces_that_share_the_crease() {
    let cut = crease(parallel(0.0, -HALF_MM, HALF_MM), 5.0);
    let fitted = fit_shell(&creased_cylinder(5.0), &trim(), &[cut], &SurfaceOptions::default()).unwrap();
    assert!(fitted.tolerance_met && fitted.watertight, "{} {:?}", fitted.why, fitted.shell.gap_mm);
    assert_eq!(fitted.shell.faces.len(), 2);
    assert!(error_mm(&fitted) < 0.02, "{}", error_mm(&fitted));
    for x in [-90.0, -31.0, 7.0, 88.0] {
        let [a, b] = [-1.0, 1.0].map(|d| face_at(&fitted, flat(d, x)).spline.at(flat(0.0, x)).normal());
        let wanted = 2.0 * (M * (x / R).cos() / M.hypot(1.0)).acos();
        let found = a.angle_between(b);
        assert!((found - wanted).abs() < 0.01, "at {x}: {found} {wanted}");
    }
}

#[test]
fn on_both_faces_the_error_falls_with_the_fourth_power() {
    let sheet = creased_cylinder(2.5);
    let error = |h: f64| {
        let cut = crease(parallel(0.0, -HALF_MM, HALF_MM), 2.5);
        let fitted = fit_shell(&sheet, &trim(), &[cut], &at_spacing(h)).unwrap();
        error_mm(&fitted)
    };
    let (coarse, fine) = (error(20.0), error(10.0));
    assert!((coarse / fine).log2() > 3.5, "{coarse} {fine}");
}

#[test]
fn a_crease_that_ends_inside_goes_over_into_one_smooth_surface() {
    // Sharp for x < 0; above that the two sides open by less and less until the sheet is a plane.
    let size = 100.0;
    let even: Vec<f64> = (-25..=25).map(|k| 4.0 * f64::from(k)).collect();
    let lift = |x: f64, across: f64| across.abs() * (1.0 - x / size).powi(3).max(0.0) * 0.05;
    let fold = |p: DVec2| p.extend(lift(p.y, p.x));
    let mut sheet = grid(&even, &even, |p| p, fold, |column| if column == 25 { 1.0 } else { 0.0 });
    for e in &mut sheet.mesh.edges {
        if e.vertices.iter().any(|v| sheet.mesh.vertices[v.index()].y > 60.0)
            && matches!(e.class, softfold_geometry::EdgeClass::Fold { .. })
        {
            e.class = softfold_geometry::EdgeClass::Facet;
        }
    }
    let square: Vec<PlanarCurve> =
        rectangle(DVec2::splat(200.0)).iter().map(|c| c.mapped(|p| p - 100.0).unwrap()).collect();
    let curve = PlanarCurve::polyline(&[DVec2::new(0.0, -100.0), DVec2::new(0.0, 60.0)]).unwrap();
    let cut = Cut { curve, kind: CutKind::Crease { crease: CreaseId(0), line: 25 } };
    let fitted = fit_shell(&sheet, &square, &[cut], &SurfaceOptions::default()).unwrap();
    assert_eq!(fitted.shell.count(ShellEdgeKind::Smooth), 1);
    assert!(fitted.watertight && fitted.tolerance_met, "{} {:?}", fitted.why, fitted.shell.gap_mm);
    let [a, b] = [0, 1].map(|f| &fitted.shell.faces[f].spline);
    for v in [60.5, 71.3, 99.0] {
        let [p, q] = [a, b].map(|s| s.at(DVec2::new(0.0, v)));
        assert_eq!(p, q, "one surface along the smooth edge");
    }
    let [p, q] = [a, b].map(|s| s.at(DVec2::new(0.0, -50.0)).normal());
    let wanted = 2.0 * (0.05 * 1.5_f64.powi(3)).atan();
    assert!((p.angle_between(q) - wanted).abs() < 0.01, "{} {wanted}", p.angle_between(q));
}

#[test]
fn a_slit_opens() {
    // The part above y = 0 lies higher, the more so the farther to the left.
    let size = DVec2::new(200.0, 100.0);
    let us: Vec<f64> = (0..=40).map(|k| 5.0 * f64::from(k)).collect();
    let vs: Vec<f64> = (0..=20).map(|k| 5.0 * f64::from(k)).collect();
    let lift = |p: DVec2| if p.x < 100.0 { (1.0 - p.x / 100.0).powi(4) * 10.0 } else { 0.0 };
    let closed = grid(&us, &vs, |p| p, |p| p.extend(0.0), |_| 0.0);
    let mut open = slit_open(&closed);
    let low = |p: DVec2| p.y < 50.0;
    for t in open.mesh.triangles.clone() {
        let middle = t.iter().map(|v| open.mesh.vertices[v.index()]).sum::<DVec2>() / 3.0;
        for v in t {
            let p = open.mesh.vertices[v.index()];
            let z = if low(middle) { 0.0 } else { lift(p) };
            open.positions[v.index()] = p.extend(z);
        }
    }
    let curve = PlanarCurve::polyline(&[DVec2::new(0.0, 50.0), DVec2::new(100.0, 50.0)]).unwrap();
    let cuts = [Cut { curve, kind: CutKind::Slit }];
    let options = SurfaceOptions { tolerance_mm: 0.1, ..SurfaceOptions::default() };
    let fitted = fit_shell(&open, &rectangle(size), &cuts, &options).unwrap();
    assert_eq!(fitted.shell.count(ShellEdgeKind::Slit), 2);
    let at = DVec2::new(0.0, 50.0);
    let mut z: Vec<f64> = fitted.shell.faces.iter().map(|f| f.spline.at(at).position.z).collect();
    z.sort_by(f64::total_cmp);
    assert!(z[0].abs() < 0.1 && (z[1] - 10.0).abs() < 0.1, "{z:?} {}", fitted.why);
}

/// The mesh opened along v = 50 up to u = 100.
fn slit_open(sheet: &FoldedSheet) -> FoldedSheet {
    let mut marked = sheet.clone();
    for e in &mut marked.mesh.edges {
        let on = |v: &softfold_geometry::VertexId| {
            let p = sheet.mesh.vertices[v.index()];
            p.y == 50.0 && p.x <= 100.0
        };
        if e.vertices.iter().all(on) {
            e.class = softfold_geometry::EdgeClass::Fold { crease: CreaseId(9), line: 0, turn_rad: 1.0 };
        }
    }
    let curve = PlanarCurve::polyline(&[DVec2::ZERO, DVec2::X]).unwrap();
    let kind = CutKind::Crease { crease: CreaseId(9), line: 0 };
    crate::open::opened(&marked, &[Cut { curve, kind }])
}
