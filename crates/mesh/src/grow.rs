//! New vertices in a net: inside a triangle, or on a side.

use crate::net::{NONE, Net, side_from};
use glam::DVec2;
use robust::Coord;

/// Which side of a line from `a` to `b` a point is on, exactly: positive is left.
pub(crate) fn left_of_line(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let [a, b, p] = [a, b, p].map(|p| Coord { x: p.x, y: p.y });
    robust::orient2d(a, b, p)
}

impl Net {
    /// Puts the last point inside a triangle or on one of its free sides, and flips until all is Delaunay again; writes the
    /// triangles that are new to `changed`. Nothing is done, and the answer is no, if the point is not there.
    pub(crate) fn insert(&mut self, points: &[DVec2], t: usize, changed: &mut Vec<u32>) -> bool {
        let p = self.places(points, t);
        let Some(&new) = points.last() else { return false };
        let depth = [0, 1, 2].map(|k| left_of_line(p[k], p[(k + 1) % 3], new));
        if depth.iter().all(|d| *d > 0.0) {
            self.at.push(t as u32);
            self.cut_in_three(points, t, changed);
            return true;
        }
        let on = (0..3).find(|&k| depth[k] == 0.0 && depth[(k + 1) % 3] > 0.0 && depth[(k + 2) % 3] > 0.0);
        match on {
            Some(k) if self.walls[t][k] == NONE && self.across[t][k] != NONE => {
                self.split(points, [t, k], [NONE; 2], changed);
                true
            }
            _ => false,
        }
    }

    fn cut_in_three(&mut self, points: &[DVec2], t: usize, changed: &mut Vec<u32>) {
        let v = points.len() as u32 - 1;
        let [a, b, c] = self.corners[t];
        let [ab, bc, ca] = [0, 1, 2].map(|k| self.side(t, k));
        let [first, second, third] = [t as u32, self.corners.len() as u32, self.corners.len() as u32 + 1];
        self.grow(2);
        self.set(t, [a, b, v], [ab, (second, NONE), (third, NONE)]);
        self.set(second as usize, [b, c, v], [bc, (third, NONE), (first, NONE)]);
        self.set(third as usize, [c, a, v], [ca, (first, NONE), (second, NONE)]);
        self.turn_to(bc.0, c, second);
        self.turn_to(ca.0, a, third);
        self.at[c as usize] = second;
        self.at[a as usize] = first;
        changed.extend([first, second, third]);
        self.drain(points, &mut vec![(first, 0), (second, 0), (third, 0)], changed);
    }

    /// Splits a side at the last point, which sees the other sides of the triangles beside from inside, and flips until
    /// all is Delaunay again. The side gets the two walls, from its first end on.
    pub(crate) fn split(
        &mut self,
        points: &[DVec2],
        [t, k]: [usize; 2],
        walls: [u32; 2],
        changed: &mut Vec<u32>,
    ) {
        let v = points.len() as u32 - 1;
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[t][(k + i) % 3]);
        let u = self.across[t][k];
        let [bc, ca] = [self.side(t, k + 1), self.side(t, k + 2)];
        let new = self.corners.len() as u32;
        let beyond = if u == NONE { NONE } else { new + 1 };
        self.grow(if u == NONE { 1 } else { 2 });
        self.set(t, [a, v, c], [(u, walls[0]), (new, NONE), ca]);
        self.set(new as usize, [v, b, c], [(beyond, walls[1]), bc, (t as u32, NONE)]);
        self.turn_to(bc.0, c, new);
        self.at.push(t as u32);
        self.at[b as usize] = new;
        let mut open = vec![(t as u32, 1), (t as u32, 2), (new, 1)];
        changed.extend([t as u32, new]);
        if u != NONE {
            let j = side_from(&self.corners[u as usize], b);
            let d = self.corners[u as usize][(j + 2) % 3];
            let [ad, db] = [self.side(u as usize, j + 1), self.side(u as usize, j + 2)];
            self.set(u as usize, [v, a, d], [(t as u32, walls[0]), ad, (beyond, NONE)]);
            self.set(beyond as usize, [b, v, d], [(new, walls[1]), (u, NONE), db]);
            self.turn_to(db.0, b, beyond);
            self.at[d as usize] = u;
            open.extend([(u, 1), (u, 2), (beyond, 2)]);
            changed.extend([u, beyond]);
        }
        self.at[a as usize] = t as u32;
        self.drain(points, &mut open, changed);
    }

    /// Room for more triangles.
    fn grow(&mut self, more: usize) {
        let count = self.corners.len() + more;
        self.corners.resize(count, [NONE; 3]);
        self.across.resize(count, [NONE; 3]);
        self.walls.resize(count, [NONE; 3]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cdt::{Backend, canonical, triangulate};
    use crate::net::tests::{consistent, graph};
    use crate::rng::SplitMix64;
    use proptest::prelude::*;
    use softfold_geometry::VertexId;

    /// The triangle that holds a point.
    fn holding(net: &Net, points: &[DVec2], p: DVec2) -> Option<usize> {
        let is_in = |t: &usize| {
            let c = net.places(points, *t);
            (0..3).all(|k| left_of_line(c[k], c[(k + 1) % 3], p) >= 0.0)
        };
        (0..net.corners.len()).find(is_in)
    }

    /// A triangle and its side that a constraint is on.
    fn side_of(net: &Net, wall: u32) -> Option<[usize; 2]> {
        (0..net.corners.len())
            .flat_map(|t| [0, 1, 2].map(|k| [t, k]))
            .find(|[t, k]| net.walls[*t][*k] == wall)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn a_net_that_grows_is_what_both_backends_give(seed in any::<u64>(), count in 1_usize..120) {
            let mut random = SplitMix64(seed);
            let (mut graph, _) = graph(&mut random, 6);
            let first = triangulate(&graph, Backend::Spade).unwrap().triangles;
            let mut net = Net::of_graph(&graph, &first);
            let mut changed = Vec::new();
            for _ in 0..count {
                let p = 8.0 * DVec2::new(random.unit(), random.unit());
                // Points on a lattice too: they lie on free sides, on circles through others, and on one another.
                let p = if random.unit() < 0.3 { (4.0 * p).round() / 4.0 } else { p };
                if graph.points.contains(&p) {
                    continue;
                }
                if random.unit() < 0.8 {
                    let Some(t) = holding(&net, &graph.points, p) else { continue };
                    graph.points.push(p);
                    if !net.insert(&graph.points, t, &mut changed) {
                        graph.points.pop();
                    }
                } else {
                    let wall = (random.unit() * graph.constraints.len() as f64) as usize;
                    let ([a, b], what) = graph.constraints[wall];
                    let middle = 0.5 * (graph.points[a.index()] + graph.points[b.index()]);
                    let v = VertexId::new(graph.points.len());
                    let Some([t, k]) = side_of(&net, wall as u32) else { continue };
                    graph.points.push(middle);
                    let other = graph.constraints.len() as u32;
                    let forward = net.corners[t][k] == a.0;
                    let walls = if forward { [wall as u32, other] } else { [other, wall as u32] };
                    net.split(&graph.points, [t, k], walls, &mut changed);
                    graph.constraints[wall].0 = [a, v];
                    graph.constraints.push(([v, b], what));
                }
            }
            consistent(&net)?;
            for (i, (edge, _)) in graph.constraints.iter().enumerate() {
                let [t, k] = side_of(&net, i as u32).unwrap();
                let mut ends = [net.corners[t][k], net.corners[t][(k + 1) % 3]];
                let mut wanted = edge.map(|v| v.0);
                ends.sort_unstable();
                wanted.sort_unstable();
                prop_assert_eq!(ends, wanted);
            }
            let grown = canonical(graph.points.len(), &net.triangles());
            for backend in [Backend::Spade, Backend::Cgal] {
                let given = triangulate(&graph, backend).unwrap().triangles;
                let mut whole = Net::of_graph(&graph, &given);
                // Of the diagonals between points on one circle each has its own.
                whole.flip_all(&graph.points);
                prop_assert_eq!(&grown, &canonical(graph.points.len(), &whole.triangles()));
            }
        }
    }
}
