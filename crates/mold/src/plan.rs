//! Polygons of the plan: the mold seen from above.

use crate::samples::border_of;
use crate::split::Axis;
use glam::{DVec2, DVec3};
use softfold_geometry::{PlanarCurve, SheetSurface};

/// The trim in plan: outline, then holes, looked at every `step_mm`.
pub(crate) fn loops(sheet: &SheetSurface, step_mm: f64) -> Vec<Vec<DVec2>> {
    let seen = |uv: DVec2| sheet.spline.at(uv).position.truncate();
    sheet.trim.iter().map(|curve| border_of(curve, step_mm).into_iter().map(seen).collect()).collect()
}

/// Nodes and weights of Gauss and Legendre on −1..1: exact to degree 9.
pub(crate) const GAUSS: [(f64, f64); 5] = [
    (0.0, 128.0 / 225.0),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Area of the trimmed surface in plan, mm²: `∮ x dy` along the trim, by quadrature on pieces no longer than half a
/// lattice cell. A prism over it has this area times its height for volume.
pub(crate) fn area_mm2(sheet: &SheetSurface) -> f64 {
    along_trim(&sheet.trim, 0.5 * sheet.spline.spacing_mm, |uv, tangent| {
        let p = sheet.spline.at(uv);
        p.position.x * (p.first[0] * tangent.x + p.first[1] * tangent.y).y
    })
}

/// Integral by arc length, along closed curves, of what has a value at a point and a unit tangent, by quadrature on
/// pieces no longer than `piece_mm`.
pub(crate) fn along_trim(trim: &[PlanarCurve], piece_mm: f64, value: impl Fn(DVec2, DVec2) -> f64) -> f64 {
    let piece = |curve: &PlanarCurve, from: f64, to: f64| -> f64 {
        let half = 0.5 * (to - from);
        let term = |(node, weight): (f64, f64)| {
            let s = from + half * (1.0 + node);
            weight * half * value(curve.point(s), curve.tangent(s))
        };
        GAUSS.into_iter().map(term).sum()
    };
    let mut sum = 0.0;
    for curve in trim {
        for joint in curve.joints_mm().windows(2) {
            let n = ((joint[1] - joint[0]) / piece_mm).ceil().max(1.0);
            let at = |k: usize| joint[0] + (joint[1] - joint[0]) * k as f64 / n;
            sum += (0..n as usize).map(|k| piece(curve, at(k), at(k + 1))).sum::<f64>();
        }
    }
    sum
}

/// A point that can be seen from above.
pub(crate) trait InPlan: Copy {
    /// Where it is seen.
    fn plan(self) -> DVec2;
    /// The point at a share of the way to another.
    fn between(self, other: Self, share: f64) -> Self;
}

impl InPlan for DVec2 {
    fn plan(self) -> DVec2 {
        self
    }

    fn between(self, other: Self, share: f64) -> Self {
        self.lerp(other, share)
    }
}

impl InPlan for DVec3 {
    fn plan(self) -> DVec2 {
        self.truncate()
    }

    fn between(self, other: Self, share: f64) -> Self {
        self.lerp(other, share)
    }
}

/// The part of a polygon where `axis` is between two values (Sutherland and Hodgman, 1974). Pieces that the strip takes
/// apart stay joined along its sides: areas and boxes are right, the outline is not simple.
pub(crate) fn strip<P: InPlan>(polygon: &[P], axis: Axis, [from, to]: [f64; 2]) -> Vec<P> {
    half(&half(polygon, axis, from, 1.0), axis, to, -1.0)
}

/// The part where `(axis − value)·side` is not negative.
fn half<P: InPlan>(polygon: &[P], axis: Axis, value: f64, side: f64) -> Vec<P> {
    let depth = |p: P| (axis.of2(p.plan()) - value) * side;
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (i, &b) in polygon.iter().enumerate() {
        let a = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (da, db) = (depth(a), depth(b));
        if (da < 0.0) != (db < 0.0) {
            kept.push(a.between(b, da / (da - db)));
        }
        if db >= 0.0 {
            kept.push(b);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use softfold_geometry::polygon::signed_area_mm2;

    #[test]
    fn a_cylinder_has_the_area_of_its_shadow() {
        let sheet = shapes::cylinder(shapes::rectangle(200.0, 80.0));
        let r = shapes::CYLINDER_RADIUS_MM;
        assert!((area_mm2(&sheet) / (2.0 * r * (100.0 / r).sin() * 80.0) - 1.0).abs() < 1e-5);
        let ellipse = shapes::flat(shapes::ellipse(150.0, 90.0));
        assert!((area_mm2(&ellipse) / ellipse.trim[0].signed_area_mm2() - 1.0).abs() < 1e-10);
    }

    #[test]
    fn strips_add_up_to_the_polygon() {
        let star: Vec<_> = (0..20)
            .map(|k| DVec2::from_angle(k as f64 * 0.314159265358979) * if k % 2 == 0 { 100.0 } else { 45.0 })
            .collect();
        let lines: Vec<f64> = (-4..=4).map(|k| 26.0 * k as f64).collect();
        let area =
            |axis| lines.windows(2).map(|w| signed_area_mm2(&strip(&star, axis, [w[0], w[1]]))).sum::<f64>();
        assert!((area(Axis::X) - signed_area_mm2(&star)).abs() < 1e-9);
        assert!((area(Axis::Y) - signed_area_mm2(&star)).abs() < 1e-9);
    }
}
