//! Surfaces of known shape for the tests of this crate.

use glam::{DVec2, DVec3};
use softfold_geometry::{Deviation, PlanarCurve, Segment, SheetSurface, UniformBicubic, polygon};

/// Radius of [`cylinder`], mm.
pub(crate) const CYLINDER_RADIUS_MM: f64 = 150.0;
/// Lattice spacing of the test surfaces, mm.
const SPACING_MM: f64 = 10.0;
/// Cells of the lattice outside the trim.
const MARGIN: f64 = 3.0;

/// The surface through `f` over a lattice around the outline.
pub(crate) fn sheet(outline: PlanarCurve, f: impl Fn(DVec2) -> DVec3) -> SheetSurface {
    sheet_of_spacing(outline, SPACING_MM, f)
}

/// The same over a lattice of another spacing.
pub(crate) fn sheet_of_spacing(
    outline: PlanarCurve,
    spacing_mm: f64,
    f: impl Fn(DVec2) -> DVec3,
) -> SheetSurface {
    let (lower, upper) = polygon::bounds(&outline.flatten(0.1));
    let first = (lower / spacing_mm).floor() - MARGIN;
    let last = (upper / spacing_mm).ceil() + MARGIN;
    let inner = [(last.x - first.x) as usize + 1, (last.y - first.y) as usize + 1];
    let knot = |k: usize| spacing_mm * (first + DVec2::new((k / inner[1]) as f64, (k % inner[1]) as f64));
    let values: Vec<_> = (0..inner[0] * inner[1]).map(|k| f(knot(k))).collect();
    let origin = spacing_mm * (first - 1.0);
    let spline = UniformBicubic::interpolating(origin, spacing_mm, inner.map(|n| n + 2), &values).unwrap();
    SheetSurface { spline, trim: vec![outline], deviation: Deviation::default() }
}

/// z = 0.
pub(crate) fn flat(outline: PlanarCurve) -> SheetSurface {
    sheet(outline, |p| p.extend(0.0))
}

/// Rolled about the v axis to a valley of [`CYLINDER_RADIUS_MM`], isometrically.
pub(crate) fn cylinder(outline: PlanarCurve) -> SheetSurface {
    let r = CYLINDER_RADIUS_MM;
    sheet(outline, |p| DVec3::new(r * (p.x / r).sin(), p.y, r * (1.0 - (p.x / r).cos())))
}

/// Waves of 300 mm along u, 25 mm up and down, slightly askew: slopes up to 28°.
pub(crate) fn corrugation(outline: PlanarCurve) -> SheetSurface {
    let wave = std::f64::consts::TAU / 300.0;
    sheet(outline, |p| DVec3::new(p.x, p.y, 25.0 * (wave * (p.x + 0.2 * p.y)).sin()))
}

/// Counter-clockwise rectangle about the origin.
pub(crate) fn rectangle(width: f64, height: f64) -> PlanarCurve {
    let c = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.), (-1., -1.)];
    PlanarCurve::polyline(&c.map(|(x, y)| 0.5 * DVec2::new(x * width, y * height))).unwrap()
}

/// Counter-clockwise ellipse about the origin from its semi-axes, by four cubics.
pub(crate) fn ellipse(a: f64, b: f64) -> PlanarCurve {
    let k = 0.5522847498;
    let axes = DVec2::new(a, b);
    let quarter = |i: usize| {
        let turn = |p: DVec2| (0..i).fold(p, |p, _| p.perp());
        let at = |x: f64, y: f64| turn(DVec2::new(x, y)) * axes;
        Segment::Cubic { from: at(1., 0.), c1: at(1., k), c2: at(k, 1.), to: at(0., 1.) }
    };
    PlanarCurve::new((0..4).map(quarter).collect()).unwrap()
}
