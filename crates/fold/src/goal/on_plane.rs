//! Vertices kept in a plane.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, outer};
use glam::DVec3;

/// `E = ½ Σ k ((x − o)·n)²`, N·mm, over the vertices; Kangaroo's *OnPlane*.
#[derive(Clone, Debug, PartialEq)]
pub struct OnPlane {
    /// Name for the report.
    pub name: String,
    /// The vertices.
    pub vertices: Vec<u32>,
    /// A point of the plane, mm.
    pub origin: DVec3,
    /// Its unit normal.
    pub normal: DVec3,
    /// Stiffness per vertex, N/mm.
    pub stiffness: f64,
}

impl OnPlane {
    fn height_mm(&self, x: &[DVec3], vertex: u32) -> f64 {
        (x[vertex as usize] - self.origin).dot(self.normal)
    }
}

impl Goal for OnPlane {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "OnPlane"
    }

    fn part(&self) -> Part {
        Part::Hold
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.vertices.iter().map(|&v| vec![v]).collect()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        self.vertices.iter().map(|&v| 0.5 * self.stiffness * self.height_mm(x, v).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        self.vertices.iter().for_each(|&v| out.add(v, self.stiffness * self.height_mm(x, v) * self.normal));
    }

    fn add_hessian(&self, _: &[DVec3], _: Curvature, out: &mut HessianSink<'_>) {
        let block = self.stiffness * outer(self.normal, self.normal);
        self.vertices.iter().for_each(|&v| out.add(v, v, block));
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        self.vertices.iter().for_each(|&v| out.add(v, self.stiffness, -self.height_mm(x, v) * self.normal));
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.vertices.iter().map(|&v| self.height_mm(x, v).abs()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives() {
        let x = [DVec3::new(1., 0., 2.), DVec3::new(0., 3., 1.), DVec3::new(-2., 1., 0.)];
        let normal = DVec3::new(1., 2., -2.) / 3.0;
        let goal =
            OnPlane { name: "foot".into(), vertices: vec![2, 0], origin: DVec3::ONE, normal, stiffness: 4.0 };
        super::super::testing::prove(Box::new(goal), &x, 1e-6);
    }
}
