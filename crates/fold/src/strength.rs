//! Weights as Kangaroo takes them, against weights from a material.
//!
//! The authors' definition in Grasshopper has one number per kind of goal, the same for every edge whatever its length:
//! stretching 5000, bending 1000, folding 200. A [`SheetMaterial`] has E, ν and t, and gives every edge its own stiffness.
//! Both are the same energies, so each can be said in terms of the other.
//!
//! | goal | Kangaroo | material |
//! |---|---|---|
//! | membrane, per edge | `k = stretching`, N/mm | `k = E t (A₁ + A₂)/L²`, N/mm |
//! | bending, per edge | `κ = bending L²/8`, N·mm/rad² | `κ = D L²/(A₁ + A₂)`, N·mm/rad² |
//!
//! `L²/8` is from Kangaroo's own *Hinge* (K2Goals, `Hinge.cs`): its move at a wing's tip is `L² Δθ / 4(h₁ + h₂)` with h the
//! wings' heights, its weight is the strength; for `h₁ = h₂ = h` the force is `strength L² Δθ / 8h`, and a hinge of
//! stiffness κ pushes with `κ Δθ/h`. (For unequal wings Kangaroo's forces are those of no energy.)
//!
//! On a mesh of equilateral triangles of side L, `A₁ + A₂ = (√3/2) L²`, hence
//! `E t = (2/√3) stretching`, `D = (√3/16) bending L²` and `t = √(12 (1 − ν²) D / E t)`.
//! The in-plane stiffness does not depend on the mesh, the bending stiffness does: the same weights on a mesh twice as
//! fine are a sheet half as thick. The authors' weights with ν = 0.3 and L = 20 mm are E t = 5774 N/mm and
//! D = 43,301 N·mm: a sheet of 9.05 mm with E = 638 MPa whose fold lines are a fifth as stiff as its faces.
//!
//! Both are hinges, and on other meshes than equilateral ones a sum over hinges is not the bending energy of a plate, however fine
//! the mesh. Where D must be right, take the material with [`FaceBending::Plate`](crate::FaceBending::Plate), which weights do not
//! have. In a project file `[fold.weights]` takes the place of `[material]`'s strengths, and `material.bending = "plate"` is the other
//! choice.

use crate::SheetMaterial;
use crate::goal::{EdgeLengths, Goal, Hinges};
use crate::material::junctions;
use softfold_geometry::{EdgeClass, EdgeId, FlatMesh};

/// Strengths as in Kangaroo: one number per kind of goal, whatever the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of edges keeping their lengths, N/mm.
    pub stretching: f64,
    /// Of faces staying flat, N/mm per rad (× L²/8: N·mm/rad²).
    pub bending: f64,
    /// Of fold lines holding their turns, N/mm per rad.
    pub folding: f64,
}

/// `(A₁ + A₂)/L²` at an edge between two equilateral triangles: √3/2.
const EQUILATERAL: f64 = 0.866_025_403_784_438_6;

/// κ over strength · L² in Kangaroo's hinge; see the top of this file.
const HINGE_SHARE: f64 = 1.0 / 8.0;

impl Weights {
    /// The defaults of the authors' definition in Grasshopper.
    pub const AUTHORS: Self = Self { stretching: 5000.0, bending: 1000.0, folding: 200.0 };

    /// In-plane stiffness `E t` of a sheet meshed with equilateral triangles, N/mm.
    pub fn in_plane_n_per_mm(&self) -> f64 {
        self.stretching / EQUILATERAL
    }

    /// Bending stiffness `D` of a sheet meshed with equilateral triangles of the given side, N·mm.
    pub fn bending_n_mm(&self, edge_mm: f64) -> f64 {
        EQUILATERAL * HINGE_SHARE * self.bending * edge_mm * edge_mm
    }

    /// The material that has these weights on equilateral triangles of the given side: E from `E t`, t from both.
    /// Without bending weight there is none, and t is 0.
    pub fn material(&self, edge_mm: f64, poisson_ratio: f64) -> SheetMaterial {
        let in_plane = self.in_plane_n_per_mm();
        let bending = self.bending_n_mm(edge_mm);
        let thickness_mm = (12.0 * (1.0 - poisson_ratio.powi(2)) * bending / in_plane).sqrt();
        SheetMaterial {
            youngs_modulus_mpa: in_plane / thickness_mm,
            poisson_ratio,
            thickness_mm,
            fold_line_factor: self.folding / self.bending,
        }
    }

    /// The weights that a material has on equilateral triangles of the given side.
    pub fn of_material(material: &SheetMaterial, edge_mm: f64) -> Self {
        let in_plane = material.youngs_modulus_mpa * material.thickness_mm;
        let bending = material.bending_stiffness() / (EQUILATERAL * HINGE_SHARE * edge_mm * edge_mm);
        Self { stretching: in_plane * EQUILATERAL, bending, folding: material.fold_line_factor * bending }
    }

    /// The membrane and the hinges of a mesh with these weights on every edge; inside junctions
    /// [`FREE_FACTOR`](crate::FREE_FACTOR) of the bending weight.
    pub fn goals(&self, mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
        let hinge = |weight: f64, id: EdgeId| HINGE_SHARE * weight * mesh.edge_length_mm(id).powi(2);
        let membrane = EdgeLengths::of_mesh(mesh, |_| self.stretching);
        let folds = Hinges::of_mesh(mesh, "fold lines", |id, e| match e.class {
            EdgeClass::Fold { turn_rad, .. } => Some((turn_rad, hinge(self.folding, id))),
            _ => None,
        });
        let faces = Hinges::of_mesh(mesh, "faces stay flat", |id, e| match e.class {
            EdgeClass::Facet => Some((0.0, hinge(self.bending, id))),
            _ => None,
        });
        let mut goals: Vec<Box<dyn Goal>> = vec![Box::new(membrane), Box::new(folds), Box::new(faces)];
        goals.extend(junctions(mesh, |id| hinge(self.bending, id)));
        goals
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};
    use softfold_geometry::{CreaseId, LoopId, Site, VertexId};

    /// Side of the triangles, mm.
    const EDGE_MM: f64 = 20.0;

    /// A ring of six equilateral triangles; its six inner edges are facets but for one fold.
    fn hexagon() -> FlatMesh {
        let rim = |k: u32| EDGE_MM * DVec2::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_3);
        let vertices: Vec<DVec2> = std::iter::once(DVec2::ZERO).chain((0..6).map(rim)).collect();
        let sites = vec![Site::Interior; 7];
        let triangles = (0..6).map(|k| [0, 1 + k, 1 + (k + 1) % 6].map(VertexId)).collect();
        FlatMesh::new(vertices, sites, triangles, |[_, b], boundary| match (boundary, b.0) {
            (true, _) => EdgeClass::Boundary { loop_id: LoopId(0) },
            (_, 1) => EdgeClass::Fold { crease: CreaseId(0), line: 0, turn_rad: 0.3 },
            _ => EdgeClass::Facet,
        })
    }

    #[test]
    fn the_authors_weights_are_the_material_that_the_text_names() {
        let material = Weights::AUTHORS.material(EDGE_MM, 0.3);
        let in_plane = material.youngs_modulus_mpa * material.thickness_mm;
        assert!((in_plane - 10_000.0 / 3f64.sqrt()).abs() < 1e-9);
        assert!((material.bending_stiffness() - 3f64.sqrt() / 16.0 * 1000.0 * 400.0).abs() < 1e-8);
        assert!(
            (material.thickness_mm - 9.05).abs() < 0.005 && (material.youngs_modulus_mpa - 638.0).abs() < 0.5
        );
        assert_eq!(material.fold_line_factor, 0.2);
    }

    #[test]
    fn there_and_back_is_the_same() {
        for (edge_mm, poisson) in [(1.0, 0.0), (20.0, 0.3), (300.0, 0.45)] {
            let material = Weights::AUTHORS.material(edge_mm, poisson);
            let back = Weights::of_material(&material, edge_mm);
            assert!((back.stretching / 5000.0 - 1.0).abs() < 1e-12);
            assert!(
                (back.bending / 1000.0 - 1.0).abs() < 1e-12 && (back.folding / 200.0 - 1.0).abs() < 1e-12
            );
        }
    }

    #[test]
    fn on_equilateral_triangles_both_have_the_same_energies() {
        let mesh = hexagon();
        let material = Weights::AUTHORS.material(EDGE_MM, 0.3);
        // A cone, stretched a little: the rim's edges are on the boundary, where the material has half the area.
        let x: Vec<DVec3> = mesh.vertices.iter().map(|p| DVec3::new(p.x, p.y, 0.4 * p.length())).collect();
        let (weighted, elastic) = (Weights::AUTHORS.goals(&mesh), material.goals(&mesh));
        for (w, e) in weighted.iter().zip(&elastic).skip(1) {
            let (w, e) = (w.energy(&x), e.energy(&x));
            assert!(w > 0.0 && (w / e - 1.0).abs() < 1e-12, "{w} {e}");
        }
        let stretch = 0.5 * 5000.0 * 6.0 * (EDGE_MM * (1.16f64.sqrt() - 1.0)).powi(2);
        assert!((weighted[0].energy(&x) / stretch - 1.0).abs() < 1e-12);
        assert!((elastic[0].energy(&x) / stretch - 1.0).abs() < 1e-12);
    }

    /// Kangaroo's move at a tip, transcribed from the formula at the top, against the force of our hinge.
    #[test]
    fn equal_wings_push_as_hard_as_kangaroos() {
        let mesh = hexagon();
        let hinges = &Weights::AUTHORS.goals(&mesh)[1];
        let flat: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        let goals = [Weights::AUTHORS.goals(&mesh).swap_remove(1)];
        let force = crate::Objective::new(7, &goals).gradient(&flat, crate::Scales::FULL).sum;
        let height = EDGE_MM * EQUILATERAL;
        let kangaroo = 200.0 * EDGE_MM * EDGE_MM * 0.3 / (4.0 * 2.0 * height);
        assert_eq!(hinges.name(), "fold lines");
        for tip in [2, 6] {
            assert!((force[tip].length() / kangaroo - 1.0).abs() < 1e-12);
        }
    }
}
