//! Vertices not below a plane.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, outer};
use glam::DVec3;

/// `E = ½ k Σ min(0, (x − o)·n)²`, N·mm, over the vertices: nothing above the plane, a spring below it (C¹); Kangaroo's
/// *Floor*. Strength k in N/mm per vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// Name for the report.
    pub name: String,
    /// The vertices.
    pub vertices: Vec<u32>,
    /// A point of the floor, mm.
    pub origin: DVec3,
    /// Its unit normal, to the side where the sheet may be.
    pub normal: DVec3,
    /// Stiffness per vertex, N/mm.
    pub stiffness: f64,
}

impl Floor {
    /// The vertices below the floor with their heights (negative), mm.
    fn below<'a>(&'a self, x: &'a [DVec3]) -> impl Iterator<Item = (u32, f64)> {
        let height = |v: u32| (x[v as usize] - self.origin).dot(self.normal);
        // A height that is no number counts too: the energy must not hide it.
        self.vertices.iter().map(move |&v| (v, height(v))).filter(|(_, h)| *h < 0.0 || h.is_nan())
    }
}

impl Goal for Floor {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "Floor"
    }

    fn part(&self) -> Part {
        Part::Contact
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.vertices.iter().map(|&v| vec![v]).collect()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        self.below(x).map(|(_, h)| 0.5 * self.stiffness * h * h).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        self.below(x).for_each(|(v, h)| out.add(v, self.stiffness * h * self.normal));
    }

    fn add_hessian(&self, x: &[DVec3], _: Curvature, out: &mut HessianSink<'_>) {
        let block = self.stiffness * outer(self.normal, self.normal);
        self.below(x).for_each(|(v, _)| out.add(v, v, block));
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        self.below(x).for_each(|(v, h)| out.add(v, self.stiffness, -h * self.normal));
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.below(x).map(|(_, h)| h.abs()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor() -> Floor {
        Floor { name: "floor".into(), vertices: vec![0], origin: DVec3::Z, normal: DVec3::Z, stiffness: 2.0 }
    }

    #[test]
    fn the_energy_is_a_parabola_below_and_nothing_above() {
        for (z, energy) in [(0.0, 1.0), (0.5, 0.25), (1.0, 0.0), (1.0 + 1e-9, 0.0), (1.05, 0.0), (4.0, 0.0)] {
            assert_eq!(floor().energy(&[DVec3::new(5.0, 0.0, z)]), energy);
        }
        assert_eq!(floor().residual(&[DVec3::ZERO]), 1.0);
    }

    #[test]
    fn the_force_begins_without_a_jump() {
        let goals: [Box<dyn Goal>; 1] = [Box::new(floor())];
        let force =
            |z: f64| crate::Objective::new(1, &goals).gradient(&[z * DVec3::Z], crate::Scales::FULL).sum[0];
        assert!(force(1.0 - 1e-9).length() < 3e-9 && force(1.0 + 1e-9) == DVec3::ZERO);
    }
}
