//! Triangles that know their neighbours and the constraints between them, in flat arrays, and the flips that make them
//! Delaunay again after vertices have moved.

use crate::cdt::PlanarGraph;
use crate::rings::Rings;
use glam::DVec2;
use robust::Coord;
use softfold_geometry::VertexId;

/// No triangle: beyond a boundary side. No constraint: on a side that may be flipped.
pub(crate) const NONE: u32 = u32::MAX;

/// A triangulation by its triangles. Side `k` of a triangle goes from its corner `k` to the next one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Net {
    /// Corners, counter-clockwise.
    pub(crate) corners: Vec<[u32; 3]>,
    /// The triangle beyond each side, or [`NONE`].
    pub(crate) across: Vec<[u32; 3]>,
    /// Numbers of the constraints on the sides, or [`NONE`]: those sides stay.
    pub(crate) walls: Vec<[u32; 3]>,
    /// A triangle at each vertex, or [`NONE`].
    pub(crate) at: Vec<u32>,
    /// What flips work with.
    open: Vec<(u32, u8)>,
    ring: Vec<u32>,
}

impl Net {
    /// Finds the neighbours of triangles, in linear time; with the triangles around each vertex.
    pub(crate) fn new(vertices: usize, triangles: &[[VertexId; 3]]) -> (Self, Rings) {
        let rings = Rings::new(vertices, triangles);
        let corners: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| v.0)).collect();
        let mut across = vec![[NONE; 3]; corners.len()];
        for (t, c) in corners.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (c[k], c[(k + 1) % 3]);
                if across[t][k] != NONE {
                    continue;
                }
                if let Some((u, j)) = left_of(&corners, &rings, [b, a]) {
                    across[t][k] = u as u32;
                    across[u][j] = t as u32;
                }
            }
        }
        let at = (0..vertices).map(|v| rings.of(v).first().copied().unwrap_or(NONE)).collect();
        let walls = vec![[NONE; 3]; corners.len()];
        (Self { corners, across, walls, at, open: vec![], ring: vec![] }, rings)
    }

    /// The same with the constraints of a graph as walls.
    pub(crate) fn of_graph(graph: &PlanarGraph, triangles: &[[VertexId; 3]]) -> Self {
        let (mut net, rings) = Self::new(graph.points.len(), triangles);
        for (i, (edge, _)) in graph.constraints.iter().enumerate() {
            net.wall(&rings, *edge, i as u32);
        }
        net
    }

    /// The triangle to the left of an edge, and which of its sides the edge is.
    pub(crate) fn left_of(&self, rings: &Rings, edge: [VertexId; 2]) -> Option<(usize, usize)> {
        left_of(&self.corners, rings, edge.map(|v| v.0))
    }

    /// The triangles that are reached from some of them without crossing a fixed side.
    pub(crate) fn reached(&self, from: Vec<usize>) -> Vec<bool> {
        let mut reached = vec![false; self.corners.len()];
        let mut open = from;
        while let Some(t) = open.pop() {
            if std::mem::replace(&mut reached[t], true) {
                continue;
            }
            let beyond = |&k: &usize| self.walls[t][k] == NONE && self.across[t][k] != NONE;
            open.extend((0..3).filter(beyond).map(|k| self.across[t][k] as usize));
        }
        reached
    }

    /// Corners of all triangles.
    pub(crate) fn triangles(&self) -> Vec<[VertexId; 3]> {
        self.corners.iter().map(|c| c.map(VertexId)).collect()
    }

    /// Places of the corners of a triangle.
    pub(crate) fn places(&self, points: &[DVec2], t: usize) -> [DVec2; 3] {
        self.corners[t].map(|v| points[v as usize])
    }

    /// Keeps an edge from being flipped.
    pub(crate) fn fix(&mut self, rings: &Rings, edge: [VertexId; 2]) {
        self.wall(rings, edge, 0);
    }

    /// The same for the constraint of a number.
    pub(crate) fn wall(&mut self, rings: &Rings, [a, b]: [VertexId; 2], number: u32) {
        for edge in [[a, b], [b, a]] {
            if let Some((t, k)) = self.left_of(rings, edge) {
                self.walls[t][k] = number;
            }
        }
    }

    /// Writes the neighbours of a vertex, counter-clockwise; false if it is on the boundary or has no triangles.
    pub(crate) fn ring(&self, vertex: usize, ring: &mut Vec<u32>) -> bool {
        ring.clear();
        let first = self.at[vertex];
        let mut t = first;
        while t != NONE {
            let c = self.corners[t as usize];
            let k = side_from(&c, vertex as u32);
            ring.push(c[(k + 1) % 3]);
            t = self.across[t as usize][(k + 2) % 3];
            if t == first {
                return true;
            }
        }
        false
    }

    /// Writes the triangles around a vertex, also of one on the boundary: those of one fan.
    pub(crate) fn around(&self, vertex: usize, triangles: &mut Vec<u32>) {
        triangles.clear();
        let first = self.at[vertex];
        for turn in [2, 0] {
            let mut t = first;
            while t != NONE {
                if turn == 2 || t != first {
                    triangles.push(t);
                }
                let k = side_from(&self.corners[t as usize], vertex as u32);
                t = self.across[t as usize][(k + turn) % 3];
                if t == first {
                    return;
                }
            }
        }
    }

    /// Flips edges until the triangulation is constrained Delaunay again after these vertices have moved: C. L. Lawson,
    /// *Software for C¹ surface interpolation* (1977). All triangles must be counter-clockwise; predicates are exact, so
    /// that it ends and they stay so. Writes the triangles that it turned to `changed`.
    pub(crate) fn flip_around(&mut self, points: &[DVec2], moved: &[u32], changed: &mut Vec<u32>) {
        let (mut open, mut around) = (std::mem::take(&mut self.open), std::mem::take(&mut self.ring));
        for &v in moved {
            self.around(v as usize, &mut around);
            for &t in &around {
                let k = side_from(&self.corners[t as usize], v);
                // The side that leaves the vertex and the one across from it; on the boundary the last one is fixed.
                open.extend([(t, k as u8), (t, (k as u8 + 1) % 3)]);
            }
            self.drain(points, &mut open, changed);
        }
        (self.open, self.ring) = (open, around);
    }

    /// The same all over; whether any side was turned.
    pub(crate) fn flip_all(&mut self, points: &[DVec2]) -> bool {
        let (mut open, mut changed) = (std::mem::take(&mut self.open), Vec::new());
        for t in 0..self.corners.len() {
            for k in 0..3 {
                // Each edge from one of its sides.
                if self.across[t][k] < t as u32 {
                    open.push((t as u32, k as u8));
                    self.drain(points, &mut open, &mut changed);
                }
            }
        }
        self.open = open;
        !changed.is_empty()
    }

    /// Flips sides that are not Delaunay, and what that makes so.
    pub(crate) fn drain(&mut self, points: &[DVec2], open: &mut Vec<(u32, u8)>, changed: &mut Vec<u32>) {
        while let Some((t, k)) = open.pop() {
            let (t, k) = (t as usize, k as usize);
            let u = self.across[t][k];
            if u == NONE || self.walls[t][k] != NONE {
                continue;
            }
            let u = u as usize;
            let j = side_from(&self.corners[u], self.corners[t][(k + 1) % 3]);
            if self.is_delaunay(points, [t, k], self.corners[u][(j + 2) % 3]) {
                continue;
            }
            self.flip([t, k], [u, j]);
            let [t, u] = [t as u32, u as u32];
            open.extend([(t, 0), (t, 1), (u, 0), (u, 1)]);
            changed.extend([t, u]);
        }
    }

    /// Whether a side stays before the corner beyond it, which is not inside the circle of its triangle. Of the two
    /// diagonals of four points on one circle the one that ends in the lowest vertex stays: what is Delaunay is then unique.
    fn is_delaunay(&self, points: &[DVec2], [t, k]: [usize; 2], beyond: u32) -> bool {
        let [a, b, c] = self.corners[t];
        let [p, q, r, s] = [a, b, c, beyond].map(|v| points[v as usize]).map(|p| Coord { x: p.x, y: p.y });
        let depth = robust::incircle(p, q, r, s);
        let apex = self.corners[t][(k + 2) % 3];
        depth < 0.0 || (depth == 0.0 && beyond.min(apex) > a.min(b).min(c))
    }

    /// Turns the edge between two triangles. Their sides 2 are the new edge.
    fn flip(&mut self, [t, k]: [usize; 2], [u, j]: [usize; 2]) {
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[t][(k + i) % 3]);
        let d = self.corners[u][(j + 2) % 3];
        let [bc, ca] = [self.side(t, k + 1), self.side(t, k + 2)];
        let [ad, db] = [self.side(u, j + 1), self.side(u, j + 2)];
        self.set(t, [c, a, d], [ca, ad, (u as u32, NONE)]);
        self.set(u, [d, b, c], [db, bc, (t as u32, NONE)]);
        // Seen from beyond, an edge begins where it ends here.
        self.turn_to(ad.0, d, t as u32);
        self.turn_to(bc.0, c, u as u32);
        for (v, t) in [(a, t), (c, t), (b, u), (d, u)] {
            self.at[v as usize] = t as u32;
        }
    }

    /// What lies across a side, and the constraint on it.
    pub(crate) fn side(&self, t: usize, k: usize) -> (u32, u32) {
        (self.across[t][k % 3], self.walls[t][k % 3])
    }

    /// Writes a triangle with what [`Self::side`] says of its sides.
    pub(crate) fn set(&mut self, t: usize, corners: [u32; 3], sides: [(u32, u32); 3]) {
        self.corners[t] = corners;
        self.across[t] = sides.map(|s| s.0);
        self.walls[t] = sides.map(|s| s.1);
    }

    /// The triangle beyond a side now borders on another one; seen from there the side begins at `from`.
    pub(crate) fn turn_to(&mut self, beyond: u32, from: u32, new: u32) {
        if beyond != NONE {
            let beyond = beyond as usize;
            self.across[beyond][side_from(&self.corners[beyond], from)] = new;
        }
    }
}

/// The side of a triangle that begins at one of its corners.
pub(crate) fn side_from(corners: &[u32; 3], vertex: u32) -> usize {
    if corners[0] == vertex { 0 } else { 2 - usize::from(corners[1] == vertex) }
}

fn left_of(corners: &[[u32; 3]], rings: &Rings, [a, b]: [u32; 2]) -> Option<(usize, usize)> {
    rings.of(a as usize).iter().find_map(|&t| {
        let c = corners[t as usize];
        (0..3).find(|&k| c[k] == a && c[(k + 1) % 3] == b).map(|k| (t as usize, k))
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::cdt::{Backend, Constraint, canonical, triangulate};
    use crate::grow::left_of_line;
    use crate::rng::SplitMix64;
    use proptest::prelude::*;
    use softfold_geometry::{CreaseId, LoopId};

    const SIDE: usize = 8;

    /// A square with a square hole, a fold line of two pieces, a slit, and random points between them.
    pub(crate) fn graph(random: &mut SplitMix64, count: usize) -> (PlanarGraph, usize) {
        let mut points: Vec<DVec2> = [(0, 0), (8, 0), (8, 8), (0, 8), (2, 2), (2, 4), (4, 4), (4, 2)]
            .map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)))
            .to_vec();
        points.extend([(5.0, 1.0), (5.3, 4.0), (5.0, 7.0), (1.0, 6.0), (4.0, 6.5)].map(DVec2::from));
        let outline = |id: u32| Constraint::Boundary { loop_id: LoopId(id) };
        let fold = Constraint::Fold { crease: CreaseId(0), line: 0, turn_rad: 0.1 };
        let mut edges: Vec<([u32; 2], Constraint)> = Vec::new();
        for k in 0..4 {
            edges.extend([([k, (k + 1) % 4], outline(0)), ([4 + k, 4 + (k + 1) % 4], outline(1))]);
        }
        edges.extend([([8, 9], fold), ([9, 10], fold), ([11, 12], Constraint::Slit { slit: 0 })]);
        let constraints = edges.into_iter().map(|(e, c)| (e.map(VertexId), c)).collect();
        let held = points.len();
        while points.len() < held + count {
            let p = SIDE as f64 * DVec2::new(random.unit(), random.unit());
            let in_hole = p.cmpge(DVec2::splat(2.0)).all() && p.cmple(DVec2::splat(4.0)).all();
            if !in_hole {
                points.push(p);
            }
        }
        (PlanarGraph { points, constraints }, held)
    }

    /// Moves every free point at random as far as no triangle turns over.
    fn shake(points: &mut [DVec2], held: usize, net: &Net, random: &mut SplitMix64) -> usize {
        let (mut ring, mut moved) = (Vec::new(), 0);
        for v in held..points.len() {
            let p = points[v] + DVec2::new(random.unit() - 0.5, random.unit() - 0.5);
            let is_left = |a: u32, b: u32| left_of_line(points[a as usize], points[b as usize], p) > 0.0;
            let whole = net.ring(v, &mut ring);
            if whole && (0..ring.len()).all(|i| is_left(ring[i], ring[(i + 1) % ring.len()])) {
                points[v] = p;
                moved += 1;
            }
        }
        moved
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn flips_after_moves_give_what_both_backends_give(seed in any::<u64>(), count in 3_usize..400) {
            let mut random = SplitMix64(seed);
            let (mut graph, held) = graph(&mut random, count);
            let before = triangulate(&graph, Backend::Spade).unwrap().triangles;
            let mut net = Net::of_graph(&graph, &before);
            let mut moved = 0;
            for _ in 0..4 {
                moved += shake(&mut graph.points, held, &net, &mut random);
                net.flip_all(&graph.points);
                let flipped = canonical(graph.points.len(), &net.triangles());
                for backend in [Backend::Spade, Backend::Cgal] {
                    prop_assert_eq!(&flipped, &triangulate(&graph, backend).unwrap().triangles);
                }
            }
            prop_assert!(moved > count / 4, "{} of {}", moved, count);
            consistent(&net)?;
        }
    }

    /// Neighbours name each other, constraints are fixed from both sides, vertices have a triangle of theirs.
    pub(crate) fn consistent(net: &Net) -> Result<(), TestCaseError> {
        for t in 0..net.corners.len() {
            for k in 0..3 {
                let Some(beyond) = net.across[t][k].lt(&NONE).then_some(net.across[t][k] as usize) else {
                    continue;
                };
                let j = side_from(&net.corners[beyond], net.corners[t][(k + 1) % 3]);
                prop_assert_eq!(net.corners[beyond][(j + 1) % 3], net.corners[t][k]);
                prop_assert_eq!(net.across[beyond][j] as usize, t);
                prop_assert_eq!(net.walls[beyond][j], net.walls[t][k]);
            }
        }
        for (v, &t) in net.at.iter().enumerate().filter(|(_, t)| **t != NONE) {
            prop_assert!(net.corners[t as usize].contains(&(v as u32)));
        }
        Ok(())
    }

    #[test]
    fn a_ring_goes_once_around_a_vertex_and_stops_at_the_boundary() {
        let triangles: Vec<[VertexId; 3]> = (0..5).map(|k| [5, k, (k + 1) % 5].map(VertexId)).collect();
        let (net, _) = Net::new(7, &triangles);
        let mut ring = Vec::new();
        assert!(net.ring(5, &mut ring));
        let first = ring.iter().position(|&v| v == 0).unwrap();
        ring.rotate_left(first);
        assert_eq!(ring, [0, 1, 2, 3, 4]);
        assert!(!net.ring(0, &mut ring), "on the boundary");
        assert!(!net.ring(6, &mut ring), "no triangles");
    }
}
