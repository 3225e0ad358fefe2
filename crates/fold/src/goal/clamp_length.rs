//! An elastic band between two points of the sheet.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, outer};
use crate::SheetPoint;
use glam::{DMat3, DVec3};

/// `E = ½ k max(0, L − L₀)²`, N·mm: a band that pulls when longer than L₀ and hangs slack when shorter;
/// Kangaroo's *ClampLength* with an upper bound.
#[derive(Clone, Debug, PartialEq)]
pub struct ClampLength {
    /// Name for the report.
    pub name: String,
    /// The two points of the sheet.
    pub ends: [SheetPoint; 2],
    /// Length up to which it is slack, mm.
    pub rest_mm: f64,
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

impl ClampLength {
    fn vector(&self, x: &[DVec3]) -> DVec3 {
        self.ends[1].position(x) - self.ends[0].position(x)
    }

    fn stretch_mm(&self, x: &[DVec3]) -> f64 {
        (self.vector(x).length() - self.rest_mm).max(0.0)
    }

    /// Vertices with the share of the band's vector that each makes: − at the start, + at the end.
    fn shares(&self) -> Vec<(u32, f64)> {
        self.ends[0].corners().map(|(v, w)| (v, -w)).chain(self.ends[1].corners()).collect()
    }
}

impl Goal for ClampLength {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "ClampLengths"
    }

    fn part(&self) -> Part {
        Part::Hold
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        vec![self.shares().into_iter().map(|s| s.0).collect()]
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        0.5 * self.stiffness * self.stretch_mm(x).powi(2)
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        let pull = self.stiffness * self.stretch_mm(x) * self.vector(x).normalize_or_zero();
        self.shares().into_iter().for_each(|(v, w)| out.add(v, w * pull));
    }

    fn add_hessian(&self, x: &[DVec3], _: Curvature, out: &mut HessianSink<'_>) {
        let stretch = self.stretch_mm(x);
        if stretch == 0.0 {
            return;
        }
        let d = self.vector(x);
        let along = outer(d, d) / d.length_squared();
        // Taut: the transverse stiffness is positive, the exact Hessian is convex.
        let block = self.stiffness * (along + stretch / d.length() * (DMat3::IDENTITY - along));
        let shares = self.shares();
        for (n, &(i, wi)) in shares.iter().enumerate() {
            for (m, &(j, wj)) in shares.iter().enumerate() {
                if i > j || (i == j && n >= m) {
                    // Both orders of a pair that shares a vertex count.
                    let twice = if i == j && n != m { 2.0 } else { 1.0 };
                    out.add(i, j, twice * wi * wj * block);
                }
            }
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        let shares = self.shares();
        let step = self.stretch_mm(x) * self.vector(x).normalize_or_zero();
        let sum: f64 = shares.iter().map(|s| s.1.abs()).sum();
        for (v, w) in shares {
            out.add(v, sum * w.abs() * self.stiffness, -w.signum() * step / sum);
        }
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.stretch_mm(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn band(rest_mm: f64) -> ClampLength {
        let ends = [SheetPoint::new([3, 0, 1], [0.2, 0.5, 0.3]), SheetPoint::new([1, 2, 4], [0.3, 0.1, 0.6])];
        ClampLength { name: "band".into(), ends, rest_mm, stiffness: 2.0 }
    }

    fn points() -> [DVec3; 5] {
        [(1., 0., 2.), (0., 3., 1.), (-2., 1., 0.), (0.5, 0.5, 0.5), (9., 7., -8.)].map(DVec3::from)
    }

    #[test]
    fn derivatives_when_taut_with_a_shared_vertex() {
        super::super::testing::prove(Box::new(band(2.0)), &points(), 1e-6);
    }

    #[test]
    fn slack_when_short() {
        let long = band(100.0);
        assert_eq!((long.energy(&points()), long.residual(&points())), (0.0, 0.0));
        super::super::testing::prove(Box::new(long), &points(), 1e-6);
    }
}
