//! From material to goals: the elastic sheet.

use crate::goal::{EdgeLengths, Goal, Hinges};
use softfold_geometry::{Edge, EdgeClass, EdgeId, FlatMesh, TriangleId};

/// An elastic sheet: real units and the factor by which fold lines hold their turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetMaterial {
    /// Young's modulus E, MPa.
    pub youngs_modulus_mpa: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// Thickness t, mm.
    pub thickness_mm: f64,
    /// How much stiffer fold lines hold their turn than faces stay flat.
    pub fold_line_factor: f64,
}

impl SheetMaterial {
    /// Bending stiffness `D = E t³ / 12 (1 − ν²)`, N·mm.
    pub fn bending_stiffness(&self) -> f64 {
        self.youngs_modulus_mpa * self.thickness_mm.powi(3) / (12.0 * (1.0 - self.poisson_ratio.powi(2)))
    }

    /// The membrane and the hinges of a mesh: per edge `k = E t (A₁ + A₂)/L²` and `κ = D L²/(A₁ + A₂)`, on fold lines
    /// times the factor; junction edges are free.
    pub fn goals(&self, mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
        let membrane = EdgeLengths::of_mesh(mesh, |e| self.edge_stiffness(mesh, e));
        let folds = Hinges::of_mesh(mesh, "fold lines", |id, e| match e.class {
            EdgeClass::Fold { turn_rad, .. } => {
                Some((turn_rad, self.fold_line_factor * self.hinge_stiffness(mesh, id)))
            }
            _ => None,
        });
        let faces = Hinges::of_mesh(mesh, "faces stay flat", |id, e| match e.class {
            EdgeClass::Facet => Some((0.0, self.hinge_stiffness(mesh, id))),
            _ => None,
        });
        vec![Box::new(membrane), Box::new(folds), Box::new(faces)]
    }

    fn edge_stiffness(&self, mesh: &FlatMesh, edge: EdgeId) -> f64 {
        let area = neighbour_area(mesh, &mesh.edges[edge.index()]);
        self.youngs_modulus_mpa * self.thickness_mm * area / mesh.edge_length_mm(edge).powi(2)
    }

    fn hinge_stiffness(&self, mesh: &FlatMesh, edge: EdgeId) -> f64 {
        let area = neighbour_area(mesh, &mesh.edges[edge.index()]);
        self.bending_stiffness() * mesh.edge_length_mm(edge).powi(2) / area
    }
}

fn neighbour_area(mesh: &FlatMesh, edge: &Edge) -> f64 {
    edge.triangles.iter().flatten().map(|&t: &TriangleId| mesh.triangle_area_mm2(t)).sum()
}
