//! Edges keep their flat lengths: the membrane.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, outer};
use glam::{DMat3, DVec3};
use softfold_geometry::{EdgeId, FlatMesh};

/// `E = Σ ½ k (L − L₀)²` over edges, N·mm; Kangaroo's *EdgeLengths*. Stiffness in N/mm.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeLengths {
    springs: Vec<Spring>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Spring {
    ends: [u32; 2],
    rest_mm: f64,
    stiffness: f64,
}

impl EdgeLengths {
    /// Springs on all edges of a mesh at their flat lengths; `stiffness` in N/mm per edge.
    pub fn of_mesh(mesh: &FlatMesh, stiffness: impl Fn(EdgeId) -> f64) -> Self {
        let spring = |i: usize| {
            let id = EdgeId::new(i);
            let ends = mesh.edges[i].vertices.map(|v| v.0);
            Spring { ends, rest_mm: mesh.edge_length_mm(id), stiffness: stiffness(id) }
        };
        Self { springs: (0..mesh.edges.len()).map(spring).collect() }
    }
}

impl Spring {
    fn vector(&self, x: &[DVec3]) -> DVec3 {
        x[self.ends[1] as usize] - x[self.ends[0] as usize]
    }

    fn stretch_mm(&self, x: &[DVec3]) -> f64 {
        self.vector(x).length() - self.rest_mm
    }
}

impl Goal for EdgeLengths {
    fn name(&self) -> &str {
        "membrane"
    }

    fn kind(&self) -> &'static str {
        "EdgeLengths"
    }

    fn part(&self) -> Part {
        Part::Membrane
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.springs.iter().map(|s| s.ends.to_vec()).collect()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        self.springs.iter().map(|s| 0.5 * s.stiffness * s.stretch_mm(x).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        for s in &self.springs {
            let pull = s.stiffness * s.stretch_mm(x) * s.vector(x).normalize_or_zero();
            out.add(s.ends[0], -pull);
            out.add(s.ends[1], pull);
        }
    }

    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>) {
        for s in &self.springs {
            let d = s.vector(x);
            let along = outer(d, d) / d.length_squared().max(f64::MIN_POSITIVE);
            // A compressed spring buckles sideways: its transverse stiffness is negative.
            let transverse = match curvature {
                Curvature::Exact => 1.0 - s.rest_mm / d.length(),
                Curvature::Convex => (1.0 - s.rest_mm / d.length()).max(0.0),
            };
            let block = s.stiffness * (along + transverse * (DMat3::IDENTITY - along));
            let [a, b] = s.ends;
            out.add(a, a, block);
            out.add(b, b, block);
            out.add(a.max(b), a.min(b), -block);
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        for s in &self.springs {
            // Each end goes half the way; twice the stiffness makes Σ w G the force.
            let step = 0.5 * s.stretch_mm(x) * s.vector(x).normalize_or_zero();
            out.add(s.ends[0], 2.0 * s.stiffness, step);
            out.add(s.ends[1], 2.0 * s.stiffness, -step);
        }
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.springs.iter().map(|s| s.stretch_mm(x).abs()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goal(rest_mm: f64) -> Box<dyn Goal> {
        Box::new(EdgeLengths { springs: vec![Spring { ends: [1, 0], rest_mm, stiffness: 7.0 }] })
    }

    #[test]
    fn derivatives_stretched_and_compressed() {
        let x = [DVec3::new(1., 2., 3.), DVec3::new(-2., 0.5, 4.)];
        for rest in [0.5, 3.0, 3.4985, 8.0] {
            super::super::testing::prove(goal(rest), &x, 1e-6);
        }
    }

    #[test]
    fn energy_is_half_k_stretch_squared() {
        let x = [DVec3::ZERO, DVec3::new(3.0, 4.0, 0.0)];
        assert_eq!(goal(3.0).energy(&x), 0.5 * 7.0 * 4.0);
        assert_eq!(goal(3.0).residual(&x), 2.0);
    }
}
