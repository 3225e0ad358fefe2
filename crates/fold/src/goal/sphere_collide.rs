//! Spheres at vertices that must not overlap.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, outer};
use glam::{DMat3, DVec2, DVec3};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use softfold_geometry::{FlatMesh, VertexId};

/// `E = Σ ½ k max(0, D − |xᵢ − xⱼ|)²`, N·mm, over pairs of vertices: balls of diameter D that push each other apart;
/// Kangaroo's *SphereCollide*. Strength k in N/mm per pair.
///
/// Pairs that are no farther apart than D in the flat sheet are neighbours, not contacts, and left out. It keeps the
/// vertices apart, not the triangles between them: with D well above the edge length no vertex slips through. Two
/// vertices at the very same place have no direction in which to part and feel no force.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereCollide {
    name: String,
    diameter_mm: f64,
    stiffness: f64,
    /// The vertices in order, each with its place in the flat sheet.
    balls: Vec<(u32, DVec2)>,
}

/// Two vertices in contact: the direction from the first to the second, and how deep the balls overlap, mm.
struct Contact {
    pair: [u32; 2],
    direction: DVec3,
    depth_mm: f64,
}

impl SphereCollide {
    /// Balls of a diameter in mm at the given vertices of a mesh; stiffness in N/mm.
    pub fn at_vertices(
        mesh: &FlatMesh,
        vertices: impl IntoIterator<Item = VertexId>,
        diameter_mm: f64,
        stiffness: f64,
    ) -> Self {
        let ball = |v: VertexId| mesh.vertices.get(v.index()).map(|p| (v.0, *p));
        let mut balls: Vec<_> = vertices.into_iter().filter_map(ball).collect();
        balls.sort_by_key(|b| b.0);
        balls.dedup_by_key(|b| b.0);
        Self { name: "spheres".into(), diameter_mm, stiffness, balls }
    }

    /// Balls at all vertices of a mesh.
    pub fn of_mesh(mesh: &FlatMesh, diameter_mm: f64, stiffness: f64) -> Self {
        Self::at_vertices(mesh, (0..mesh.vertices.len()).map(VertexId::new), diameter_mm, stiffness)
    }

    /// Calls `f` for each pair nearer than `reach_mm` that is not one of neighbours, in order.
    fn near_pairs(&self, x: &[DVec3], reach_mm: f64, mut f: impl FnMut([u32; 2])) {
        let entry = |(i, &(v, _)): (usize, &(u32, DVec2))| GeomWithData::new(x[v as usize].to_array(), i);
        let tree = RTree::bulk_load(self.balls.iter().enumerate().map(entry).collect());
        for (i, &(v, flat)) in self.balls.iter().enumerate() {
            let apart = |j: usize| self.balls[j].1.distance(flat) > self.diameter_mm;
            let near = tree.locate_within_distance(x[v as usize].to_array(), reach_mm * reach_mm);
            let mut later: Vec<usize> = near.map(|n| n.data).filter(|&j| j > i && apart(j)).collect();
            later.sort_unstable();
            later.into_iter().for_each(|j| f([v, self.balls[j].0]));
        }
    }

    fn contacts_at(&self, x: &[DVec3]) -> Vec<Contact> {
        let mut contacts = Vec::new();
        self.near_pairs(x, self.diameter_mm, |pair| {
            let way = x[pair[1] as usize] - x[pair[0] as usize];
            let depth_mm = self.diameter_mm - way.length();
            if depth_mm > 0.0 {
                contacts.push(Contact { pair, direction: way.normalize_or_zero(), depth_mm });
            }
        });
        contacts
    }
}

impl Goal for SphereCollide {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "SphereCollide"
    }

    fn part(&self) -> Part {
        Part::Contact
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        Vec::new()
    }

    fn contacts(&self, x: &[DVec3], margin: f64) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        self.near_pairs(x, (1.0 + margin) * self.diameter_mm, |pair| pairs.push(pair));
        pairs
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        if self.balls.iter().any(|b| !x[b.0 as usize].is_finite()) {
            return f64::NAN; // the tree would find such a vertex near nothing
        }
        self.contacts_at(x).iter().map(|c| 0.5 * self.stiffness * c.depth_mm.powi(2)).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        for Contact { pair: [a, b], direction, depth_mm } in self.contacts_at(x) {
            let push = self.stiffness * depth_mm * direction;
            out.add(a, push);
            out.add(b, -push);
        }
    }

    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>) {
        for Contact { pair: [a, b], direction, depth_mm } in self.contacts_at(x) {
            let along = outer(direction, direction);
            // Balls that press on each other would rather slip sideways: negative, left out of the convex form.
            let transverse = match curvature {
                Curvature::Exact => -depth_mm / (self.diameter_mm - depth_mm).max(f64::MIN_POSITIVE),
                Curvature::Convex => 0.0,
            };
            let sideways = if direction == DVec3::ZERO { DMat3::ZERO } else { DMat3::IDENTITY - along };
            let block = self.stiffness * (along + transverse * sideways);
            out.add(a, a, block);
            out.add(b, b, block);
            out.add(b, a, -block);
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        for Contact { pair: [a, b], direction, depth_mm } in self.contacts_at(x) {
            // Each goes half the way; twice the stiffness makes Σ w G the force.
            let step = 0.5 * depth_mm * direction;
            out.add(a, 2.0 * self.stiffness, -step);
            out.add(b, 2.0 * self.stiffness, step);
        }
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.contacts_at(x).iter().map(|c| c.depth_mm).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;

    #[test]
    fn the_pairs_are_those_of_a_search_over_all() {
        let mesh = strip(7, 6, 3.0);
        let goal = SphereCollide::of_mesh(&mesh, 5.0, 2.0);
        let crumpled: Vec<DVec3> = (0..56)
            .map(|i| {
                6.0 * DVec3::new(
                    (1.3 * f64::from(i)).sin(),
                    (2.9 * f64::from(i)).sin(),
                    (0.7 * f64::from(i)).cos(),
                )
            })
            .collect();
        let mut expected = Vec::new();
        for i in 0..56 {
            for j in i + 1..56 {
                let flat = mesh.vertices[i].distance(mesh.vertices[j]);
                if flat > 5.0 && crumpled[i].distance(crumpled[j]) <= 5.0 {
                    expected.push([i as u32, j as u32]);
                }
            }
        }
        assert!(expected.len() > 50);
        assert_eq!(goal.contacts(&crumpled, 0.0), expected);
    }

    #[test]
    fn a_flat_sheet_touches_itself_nowhere() {
        let mesh = strip(7, 6, 3.0);
        let goal = SphereCollide::of_mesh(&mesh, 5.0, 2.0);
        let flat: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        assert_eq!((goal.energy(&flat), goal.residual(&flat)), (0.0, 0.0));
    }

    #[test]
    fn one_move_of_two_balls_parts_them() {
        let mesh = strip(9, 1, 3.0);
        let goal = SphereCollide::at_vertices(&mesh, [0, 18].map(VertexId), 4.0, 2.0);
        let mut x: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        x[18] = x[0] + DVec3::new(0.0, 0.0, 1.0);
        assert_eq!(goal.energy(&x), 0.5 * 2.0 * 9.0);
        let (mut weighted, mut weights) = ([DVec3::ZERO; 20], [0.0; 20]);
        goal.add_moves(&x, &mut Moves { weighted: &mut weighted, weights: &mut weights });
        for v in [0, 18] {
            x[v] += weighted[v] / weights[v];
        }
        assert_eq!((goal.energy(&x), x[0].distance(x[18])), (0.0, 4.0));
    }

    #[test]
    fn positions_that_are_no_numbers_give_no_number() {
        let goal = SphereCollide::of_mesh(&strip(2, 2, 3.0), 5.0, 2.0);
        assert!(goal.energy(&[DVec3::NAN; 9]).is_nan());
    }
}
