//! Two points of the sheet held together.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part};
use crate::SheetPoint;
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;

/// `E = ½ k |p − q|²`, N·mm, with p and q two points of the sheet; Kangaroo's *Coincident*. Strength k in N/mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Glue {
    /// Name for the report.
    pub name: String,
    /// The two points of the sheet.
    pub points: [SheetPoint; 2],
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

impl Glue {
    fn gap(&self, x: &[DVec3]) -> DVec3 {
        self.points[1].position(x) - self.points[0].position(x)
    }

    /// Vertices with their shares of the gap: − at the first point, + at the second, summed where they share one.
    fn shares(&self) -> BTreeMap<u32, f64> {
        let mut shares = BTreeMap::new();
        for (point, sign) in self.points.iter().zip([-1.0, 1.0]) {
            point.corners().for_each(|(v, w)| *shares.entry(v).or_insert(0.0) += sign * w);
        }
        shares
    }
}

impl Goal for Glue {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "Glue"
    }

    fn part(&self) -> Part {
        Part::Hold
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        vec![self.shares().into_keys().collect()]
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        0.5 * self.stiffness * self.gap(x).length_squared()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        let pull = self.stiffness * self.gap(x);
        self.shares().into_iter().for_each(|(v, w)| out.add(v, w * pull));
    }

    fn add_hessian(&self, _: &[DVec3], _: Curvature, out: &mut HessianSink<'_>) {
        let shares = self.shares();
        for (&i, wi) in &shares {
            for (&j, wj) in shares.range(..=i) {
                out.add(i, j, DMat3::from_diagonal(DVec3::splat(wi * wj * self.stiffness)));
            }
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        let shares = self.shares();
        // The points meet half the way (the shares' magnitudes add up to 2 at most).
        let sum: f64 = shares.values().map(|w| w.abs()).sum();
        let step = self.gap(x) / sum.max(f64::MIN_POSITIVE);
        for (v, w) in shares {
            out.add(v, sum * w.abs() * self.stiffness, -w.signum() * step);
        }
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.gap(x).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_move_of_two_vertices_brings_them_together() {
        let at = |v| SheetPoint::new([v; 3], [1.0, 0.0, 0.0]);
        let glue = Glue { name: "seam".into(), points: [at(0), at(1)], stiffness: 3.0 };
        let x = [DVec3::ZERO, DVec3::new(2.0, 4.0, -6.0)];
        let (mut weighted, mut weights) = ([DVec3::ZERO; 2], [0.0; 2]);
        glue.add_moves(&x, &mut Moves { weighted: &mut weighted, weights: &mut weights });
        let moved = [0, 1].map(|v| x[v] + weighted[v] / weights[v]);
        assert_eq!(moved, [DVec3::new(1.0, 2.0, -3.0); 2]);
        assert_eq!(glue.energy(&x), 0.5 * 3.0 * 56.0);
    }

    #[test]
    fn a_point_glued_to_itself_pulls_nothing() {
        let p = SheetPoint::new([0, 1, 2], [0.2, 0.3, 0.5]);
        let glue = Glue { name: "seam".into(), points: [p, p], stiffness: 3.0 };
        let x = [DVec3::X, DVec3::Y, DVec3::Z];
        let (mut weighted, mut weights) = ([DVec3::ZERO; 3], [0.0; 3]);
        glue.add_moves(&x, &mut Moves { weighted: &mut weighted, weights: &mut weights });
        assert!(weighted.iter().all(|w| *w == DVec3::ZERO));
    }
}
