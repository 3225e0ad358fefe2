//! A point of the sheet held at a place in space.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part};
use crate::SheetPoint;
use glam::{DMat3, DVec3};

/// `E = ½ Σₐ kₐ (p − q)ₐ²` with p the point of the sheet, q its target and kₐ the stiffness along axis
/// a in N/mm (0: free along that axis); Kangaroo's *Anchor*.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// Name for the report.
    pub name: String,
    /// The point of the sheet.
    pub point: SheetPoint,
    /// Where it should be, mm.
    pub target: DVec3,
    /// Stiffness along x, y, z, N/mm.
    pub stiffness: DVec3,
}

impl Anchor {
    fn error(&self, x: &[DVec3]) -> DVec3 {
        self.point.position(x) - self.target
    }
}

impl Goal for Anchor {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "Anchor"
    }

    fn part(&self) -> Part {
        Part::Hold
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        vec![self.point.vertices().to_vec()]
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        let e = self.error(x);
        0.5 * (self.stiffness * e).dot(e)
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        let force = self.stiffness * self.error(x);
        self.point.corners().for_each(|(v, w)| out.add(v, w * force));
    }

    fn add_hessian(&self, _: &[DVec3], _: Curvature, out: &mut HessianSink<'_>) {
        let block = DMat3::from_diagonal(self.stiffness);
        self.point.add_pairs(|i, j, w| out.add(i, j, w * block));
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        let force = self.stiffness * self.error(x);
        // Majorises Σ w_i w_j k: Σ_j w_j = 1.
        let k = self.stiffness.max_element();
        self.point.corners().for_each(|(v, w)| out.add(v, w * k, -force / k.max(f64::MIN_POSITIVE)));
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        let held = self.stiffness.cmpgt(DVec3::ZERO);
        DVec3::select(held, self.error(x), DVec3::ZERO).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_inside_a_triangle_and_with_a_free_axis() {
        let x = [DVec3::new(1., 0., 2.), DVec3::new(0., 3., 1.), DVec3::new(-2., 1., 0.)];
        for stiffness in [DVec3::splat(5.0), DVec3::new(5.0, 0.0, 2.0)] {
            let point = SheetPoint::new([2, 0, 1], [0.2, 0.5, 0.3]);
            let target = DVec3::new(4., 5., 6.);
            super::super::testing::prove(
                Box::new(Anchor { name: "A".into(), point, target, stiffness }),
                &x,
                1e-6,
            );
        }
    }
}
