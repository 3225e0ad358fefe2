//! Faces resist bending as a plate does: a bending energy that converges on any mesh.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part};
use crate::patch::{Patch, patches};
use glam::{DMat3, DVec3};
use softfold_geometry::FlatMesh;

/// `E = ∫ ½ D ((1 − ν) |∇²x|² + ν |Δx|²) dA`, N·mm, over the flat sheet: Kirchhoff's plate. On an isometric sheet the second
/// derivatives `∇²x` by (u, v) are the curvatures times the normal, so this is its bending energy exactly, and it is
/// quadratic (Bergou, Wardetzky, Harmon, Zorin & Grinspun, *A quadratic bending model for inextensible surfaces*, 2006).
///
/// ∇²x is constant on a triangle, from the triangle's points and those around it on the same face (`patch.rs`): on any mesh the energy
/// converges, which sums over hinges do not (Grinspun, Gingold, Reisman & Zorin 2006). Across fold lines, junctions and slits
/// nothing bends: there hinges are at work.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    patches: Vec<Patch>,
    /// D (1 + ν), D (1 − ν) and D (1 − ν), N·mm: of the second derivatives as [`Patch`] has them.
    stiffness: [f64; 3],
}

impl Plate {
    /// All faces of a mesh with bending stiffness D, N·mm, and Poisson's ratio ν, from 0 to below 1.
    pub fn of_mesh(mesh: &FlatMesh, bending_n_mm: f64, poisson_ratio: f64) -> Self {
        let stiffness =
            [1.0 + poisson_ratio, 1.0 - poisson_ratio, 1.0 - poisson_ratio].map(|s| s * bending_n_mm);
        Self { patches: patches(mesh), stiffness }
    }
}

/// The second derivatives, 1/mm.
fn second_derivatives(patch: &Patch, x: &[DVec3]) -> [DVec3; 3] {
    // Weights add up to nothing: from one of the points on there is less to cancel.
    let origin = patch.vertices.first().map_or(DVec3::ZERO, |&v| x[v as usize]);
    let mut sums = [DVec3::ZERO; 3];
    for (&v, weights) in patch.vertices.iter().zip(&patch.weights) {
        let p = x[v as usize] - origin;
        sums.iter_mut().zip(weights).for_each(|(sum, w)| *sum += *w * p);
    }
    sums
}

impl Goal for Plate {
    fn name(&self) -> &str {
        "faces stay flat"
    }

    fn kind(&self) -> &'static str {
        "Plate"
    }

    fn part(&self) -> Part {
        Part::Bending
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.patches.iter().map(|p| p.vertices.clone()).collect()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        let density = |p: &Patch| {
            let squares = second_derivatives(p, x).map(|s| s.length_squared());
            (0..3).map(|m| 0.5 * self.stiffness[m] * squares[m]).sum::<f64>()
        };
        self.patches.iter().map(|p| p.area_mm2 * density(p)).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        for patch in &self.patches {
            let second = second_derivatives(patch, x);
            for (&v, weights) in patch.vertices.iter().zip(&patch.weights) {
                let force: DVec3 = (0..3).map(|m| self.stiffness[m] * weights[m] * second[m]).sum();
                out.add(v, patch.area_mm2 * force);
            }
        }
    }

    /// Constant and positive semidefinite: both curvatures are the same.
    fn add_hessian(&self, _: &[DVec3], _: Curvature, out: &mut HessianSink<'_>) {
        for patch in &self.patches {
            for (i, (&row, of_row)) in patch.vertices.iter().zip(&patch.weights).enumerate() {
                for (&column, of_column) in patch.vertices.iter().zip(&patch.weights).take(i + 1) {
                    let entry: f64 = (0..3).map(|m| self.stiffness[m] * of_row[m] * of_column[m]).sum();
                    out.add(row, column, DMat3::from_diagonal(DVec3::splat(patch.area_mm2 * entry)));
                }
            }
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        for patch in &self.patches {
            let second = second_derivatives(patch, x);
            for m in 0..3 {
                let steepness: f64 = patch.weights.iter().map(|w| w[m] * w[m]).sum();
                if steepness == 0.0 {
                    continue; // not determined here
                }
                // The shortest motion that takes the second derivative to 0.
                let reach = second[m] / steepness;
                let weight = patch.area_mm2 * self.stiffness[m] * steepness;
                for (&v, weights) in patch.vertices.iter().zip(&patch.weights) {
                    out.add(v, weight, -weights[m] * reach);
                }
            }
        }
    }

    /// The largest turn across a triangle, rad: its curvature times the square root of its area.
    fn residual(&self, x: &[DVec3]) -> f64 {
        let turn = |p: &Patch| {
            let squares = second_derivatives(p, x).map(|s| s.length_squared());
            (p.area_mm2 * squares.iter().sum::<f64>()).sqrt()
        };
        self.patches.iter().map(turn).fold(0.0, f64::max)
    }
}
