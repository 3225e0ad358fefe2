//! From material to goals: the elastic sheet.

use crate::goal::{EdgeLengths, Goal, Hinges, Plate};
use softfold_geometry::{Edge, EdgeClass, EdgeId, FlatMesh, TriangleId};

/// Stiffness of a free edge (inside a junction of creases) as share of a facet's: enough that the junction's triangles
/// do not flap or fold over, too little to hold the creases that meet there.
pub const FREE_FACTOR: f64 = 0.01;

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

/// How faces resist bending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceBending {
    /// A hinge at each edge, as Kangaroo has it: cheap and qualitative. On irregular meshes the sum is some ten per cent off
    /// the energy of a bent sheet however fine they are.
    #[default]
    Hinges,
    /// A [`Plate`], whose energy converges on any mesh: for figures that must be right.
    Plate,
}

impl SheetMaterial {
    /// Bending stiffness `D = E t³ / 12 (1 − ν²)`, N·mm.
    pub fn bending_stiffness(&self) -> f64 {
        self.youngs_modulus_mpa * self.thickness_mm.powi(3) / (12.0 * (1.0 - self.poisson_ratio.powi(2)))
    }

    /// The membrane and the hinges of a mesh: per edge `k = E t (A₁ + A₂)/L²` and `κ = D L²/(A₁ + A₂)`, on fold lines
    /// times the factor, inside junctions times [`FREE_FACTOR`].
    pub fn goals(&self, mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
        self.goals_by(mesh, FaceBending::Hinges)
    }

    /// The same, with faces that resist bending in the given way.
    pub fn goals_by(&self, mesh: &FlatMesh, faces: FaceBending) -> Vec<Box<dyn Goal>> {
        let membrane = EdgeLengths::of_mesh(mesh, |e| self.edge_stiffness(mesh, e));
        let folds = Hinges::of_mesh(mesh, "fold lines", |id, e| match e.class {
            EdgeClass::Fold { turn_rad, .. } => {
                Some((turn_rad, self.fold_line_factor * self.hinge_stiffness(mesh, id)))
            }
            _ => None,
        });
        let mut goals: Vec<Box<dyn Goal>> =
            vec![Box::new(membrane), Box::new(folds), self.faces(mesh, faces)];
        goals.extend(junctions(mesh, |id| self.hinge_stiffness(mesh, id)));
        goals
    }

    fn faces(&self, mesh: &FlatMesh, bending: FaceBending) -> Box<dyn Goal> {
        match bending {
            FaceBending::Plate => {
                Box::new(Plate::of_mesh(mesh, self.bending_stiffness(), self.poisson_ratio))
            }
            FaceBending::Hinges => {
                Box::new(Hinges::of_mesh(mesh, "faces stay flat", |id, e| match e.class {
                    EdgeClass::Facet => Some((0.0, self.hinge_stiffness(mesh, id))),
                    _ => None,
                }))
            }
        }
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

/// Hinges on the free edges at rest turn 0 and [`FREE_FACTOR`] of the stiffness that facets would have; none if there
/// are no such edges.
pub(crate) fn junctions(mesh: &FlatMesh, facet: impl Fn(EdgeId) -> f64) -> Option<Box<dyn Goal>> {
    if !mesh.edges.iter().any(|e| e.class == EdgeClass::Free) {
        return None;
    }
    let free = Hinges::of_mesh(mesh, "junctions", |id, e| match e.class {
        EdgeClass::Free => Some((0.0, FREE_FACTOR * facet(id))),
        _ => None,
    });
    Some(Box::new(free))
}

fn neighbour_area(mesh: &FlatMesh, edge: &Edge) -> f64 {
    edge.triangles.iter().flatten().map(|&t: &TriangleId| mesh.triangle_area_mm2(t)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;
    use glam::DVec3;

    const MATERIAL: SheetMaterial = SheetMaterial {
        youngs_modulus_mpa: 1000.0,
        poisson_ratio: 0.3,
        thickness_mm: 3.0,
        fold_line_factor: 10.0,
    };

    /// A sheet rolled to a cylinder: every inner edge across the axis turns.
    fn rolled(mesh: &FlatMesh) -> Vec<DVec3> {
        mesh.vertices
            .iter()
            .map(|p| DVec3::new(30.0 * (p.x / 30.0).sin(), p.y, 30.0 - 30.0 * (p.x / 30.0).cos()))
            .collect()
    }

    #[test]
    fn free_edges_bend_a_hundredth_as_hard_as_facets() {
        let facets = strip(6, 4, 5.0);
        let mut free = facets.clone();
        for e in &mut free.edges {
            if e.class == EdgeClass::Facet {
                e.class = EdgeClass::Free;
            }
        }
        let x = rolled(&facets);
        let [of_facets, of_free] = [&facets, &free].map(|mesh| MATERIAL.goals(mesh));
        assert_eq!((of_facets.len(), of_free.len()), (3, 4));
        let (faces, junctions) = (of_facets[2].energy(&x), of_free[3].energy(&x));
        assert_eq!(of_free[3].name(), "junctions");
        assert!(
            faces > 0.0 && (junctions / faces - FREE_FACTOR).abs() < 1e-12 && of_free[2].energy(&x) == 0.0
        );
    }
}
