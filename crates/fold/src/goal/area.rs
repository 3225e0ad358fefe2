//! Triangles keep their flat areas.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, cross_matrix, outer};
use glam::{DMat3, DVec3};
use softfold_geometry::{FlatMesh, TriangleId};

/// `E = Σ ½ k A₀ (A/A₀ − 1)²`, N·mm, over triangles with flat area A₀. Strength k in N/mm, like the area modulus
/// `E t / 2(1 − ν)` of a sheet, so that it does not depend on the mesh; Kangaroo's *PolygonArea* in space. The area is
/// unsigned: a collapsed triangle feels no force.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    patches: Vec<Patch>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Patch {
    corners: [u32; 3],
    rest_mm2: f64,
    /// Stiffness over the rest area, N/mm³: the energy is half of it times the squared area error.
    stiffness: f64,
}

/// A triangle in space: twice its area, its unit normal, and of each corner the edge across from it.
struct Shape {
    double_area: f64,
    normal: DVec3,
    edges: [DVec3; 3],
}

impl Area {
    /// All triangles of a mesh at their flat areas; stiffness in N/mm.
    pub fn of_mesh(mesh: &FlatMesh, stiffness: f64) -> Self {
        let patch = |t: usize| {
            let rest_mm2 = mesh.triangle_area_mm2(TriangleId::new(t));
            let corners = mesh.triangles[t].map(|v| v.0);
            Patch { corners, rest_mm2, stiffness: stiffness / rest_mm2.max(f64::MIN_POSITIVE) }
        };
        Self { patches: (0..mesh.triangles.len()).map(patch).collect() }
    }
}

impl Patch {
    fn shape(&self, x: &[DVec3]) -> Shape {
        let [a, b, c] = self.corners.map(|v| x[v as usize]);
        let normal = (b - a).cross(c - a);
        Shape {
            double_area: normal.length(),
            normal: normal.normalize_or_zero(),
            edges: [c - b, a - c, b - a],
        }
    }

    /// Area error, mm².
    fn error(&self, shape: &Shape) -> f64 {
        0.5 * shape.double_area - self.rest_mm2
    }
}

impl Shape {
    /// ∂A/∂ corner.
    fn gradient(&self) -> [DVec3; 3] {
        self.edges.map(|e| 0.5 * self.normal.cross(e))
    }

    /// ∂²A/∂ corner i ∂ corner j: the normal turns, and the edge across from i has its end at j.
    fn hessian(&self, i: usize, j: usize) -> DMat3 {
        // Of a collapsed triangle the area has a kink and no second derivative: 0 stands for it.
        let turn = match self.double_area {
            0.0 => DMat3::ZERO,
            double => (DMat3::IDENTITY - outer(self.normal, self.normal)) / double,
        };
        let turning = cross_matrix(self.edges[i]) * turn * cross_matrix(self.edges[j]);
        let ends = match (j + 3 - i) % 3 {
            0 => DMat3::ZERO,
            1 => -cross_matrix(self.normal),
            _ => cross_matrix(self.normal),
        };
        0.5 * (ends - turning)
    }
}

impl Goal for Area {
    fn name(&self) -> &str {
        "area"
    }

    fn kind(&self) -> &'static str {
        "Area"
    }

    fn part(&self) -> Part {
        Part::Membrane
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.patches.iter().map(|p| p.corners.to_vec()).collect()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        self.patches.iter().map(|p| 0.5 * p.stiffness * p.error(&p.shape(x)).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        for p in &self.patches {
            let shape = p.shape(x);
            let pull = p.stiffness * p.error(&shape);
            p.corners.iter().zip(shape.gradient()).for_each(|(&v, g)| out.add(v, pull * g));
        }
    }

    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>) {
        for p in &self.patches {
            let shape = p.shape(x);
            let gradient = shape.gradient();
            let pull = p.stiffness * p.error(&shape);
            for i in 0..3 {
                for j in (0..3).filter(|&j| p.corners[j] <= p.corners[i]) {
                    let mut block = p.stiffness * outer(gradient[i], gradient[j]);
                    if curvature == Curvature::Exact {
                        block += pull * shape.hessian(i, j);
                    }
                    out.add(p.corners[i], p.corners[j], block);
                }
            }
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        for p in &self.patches {
            let shape = p.shape(x);
            let gradient = shape.gradient();
            let steepness: f64 = gradient.iter().map(|g| g.length_squared()).sum();
            if steepness == 0.0 {
                continue; // collapsed: no motion changes the area at first order
            }
            // The shortest motion that, to first order, gives the rest area.
            let reach = p.error(&shape) / steepness;
            let weight = p.stiffness * steepness;
            p.corners.iter().zip(gradient).for_each(|(&v, g)| out.add(v, weight, -reach * g));
        }
    }

    /// The largest area error over the side of a square of the flat area, mm.
    fn residual(&self, x: &[DVec3]) -> f64 {
        let side = |p: &Patch| p.rest_mm2.max(f64::MIN_POSITIVE).sqrt();
        self.patches.iter().map(|p| p.error(&p.shape(x)).abs() / side(p)).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;

    #[test]
    fn a_stretched_sheet_has_the_energy_of_its_area_strain() {
        let mesh = strip(5, 4, 10.0);
        let goal = Area::of_mesh(&mesh, 6.0);
        let stretched: Vec<DVec3> = mesh.vertices.iter().map(|p| DVec3::new(1.1 * p.x, 0.0, p.y)).collect();
        assert!((goal.energy(&stretched) - 0.5 * 6.0 * 2000.0 * 0.01).abs() < 1e-9);
        assert!((goal.residual(&stretched) - 5.0 / 50f64.sqrt()).abs() < 1e-12);
        let sheared: Vec<DVec3> =
            mesh.vertices.iter().map(|p| DVec3::new(p.x + 0.7 * p.y, p.y, 2.0)).collect();
        assert!(goal.energy(&sheared) < 1e-20);
    }

    #[test]
    fn a_collapsed_triangle_has_finite_derivatives() {
        let mesh = strip(1, 1, 10.0);
        let goals: [Box<dyn Goal>; 1] = [Box::new(Area::of_mesh(&mesh, 6.0))];
        let objective = crate::Objective::new(4, &goals);
        for x in [[DVec3::ZERO; 4], [0.0, 1.0, 2.0, 3.0].map(|s| s * DVec3::X)] {
            assert!(objective.gradient(&x, crate::Scales::FULL).sum.iter().all(|g| g.is_finite()));
            let hessian = objective.hessian(&x, Curvature::Exact, crate::Scales::FULL).to_dense();
            assert!(hessian.iter().flatten().all(|h| h.is_finite()));
        }
    }
}
