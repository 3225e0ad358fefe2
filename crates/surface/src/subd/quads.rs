//! A quad mesh of the flat sheet and what its connections tell.

use glam::DVec2;
use std::collections::BTreeMap;

/// Quads run counter-clockwise in (u, v).
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Quads {
    pub(crate) points: Vec<DVec2>,
    pub(crate) quads: Vec<[u32; 4]>,
}

/// Edges of a quad mesh: from each directed edge to its quad, the quad being at the left.
pub(crate) type Sides = BTreeMap<[u32; 2], usize>;

impl Quads {
    /// The directed edges.
    ///
    /// # Errors
    /// An edge that two quads have on the same side.
    pub(crate) fn sides(&self) -> Result<Sides, [u32; 2]> {
        let mut sides = Sides::new();
        for (q, quad) in self.quads.iter().enumerate() {
            for k in 0..4 {
                let edge = [quad[k], quad[(k + 1) % 4]];
                if sides.insert(edge, q).is_some() {
                    return Err(edge);
                }
            }
        }
        Ok(sides)
    }

    /// Border loops, the sheet at the left.
    pub(crate) fn borders(&self, sides: &Sides) -> Vec<Vec<u32>> {
        let mut next: BTreeMap<u32, u32> =
            sides.keys().filter(|[a, b]| !sides.contains_key(&[*b, *a])).map(|[a, b]| (*a, *b)).collect();
        let mut loops = Vec::new();
        while let Some((&start, _)) = next.iter().next() {
            let mut around = vec![start];
            let mut here = start;
            while let Some(to) = next.remove(&here) {
                if to == start {
                    break;
                }
                around.push(to);
                here = to;
            }
            loops.push(around);
        }
        loops
    }

    /// Each edge once, lower vertex first.
    pub(crate) fn edges(&self) -> Vec<[u32; 2]> {
        let sorted =
            |q: &[u32; 4]| [0, 1, 2, 3].map(|k| [q[k].min(q[(k + 1) % 4]), q[k].max(q[(k + 1) % 4])]);
        let mut edges: Vec<[u32; 2]> = self.quads.iter().flat_map(sorted).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// How many edges end in each vertex.
    pub(crate) fn valences(&self) -> Vec<u32> {
        let mut valences = vec![0; self.points.len()];
        self.edges().as_flattened().iter().for_each(|&v| valences[v as usize] += 1);
        valences
    }

    /// Quads at each vertex with the vertex's place in them.
    pub(crate) fn around(&self) -> Vec<Vec<(usize, usize)>> {
        let mut around = vec![Vec::new(); self.points.len()];
        for (q, quad) in self.quads.iter().enumerate() {
            quad.iter().enumerate().for_each(|(k, &v)| around[v as usize].push((q, k)));
        }
        around
    }

    /// Inner angle of a quad at a corner, rad, 0 to 2π.
    pub(crate) fn angle(&self, q: usize, k: usize) -> f64 {
        let [p, next, last] = [0, 1, 3].map(|i| self.points[self.quads[q][(k + i) % 4] as usize]);
        (next - p).angle_to(last - p).rem_euclid(std::f64::consts::TAU)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> Quads {
        let points = [(0., 0.), (1., 0.), (2., 0.), (0., 1.), (1., 1.), (2., 1.)].map(DVec2::from).to_vec();
        Quads { points, quads: vec![[0, 1, 4, 3], [1, 2, 5, 4]] }
    }

    #[test]
    fn two_squares_have_one_border_and_seven_edges() {
        let two = two();
        let sides = two.sides().unwrap();
        assert_eq!(two.borders(&sides), [[0, 1, 2, 5, 4, 3]]);
        assert_eq!(two.edges().len(), 7);
        assert_eq!(two.valences(), [2, 3, 2, 2, 3, 2]);
        assert!((two.angle(0, 1) - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn an_edge_with_two_quads_on_one_side_is_found() {
        let twice = Quads { quads: vec![[0, 1, 4, 3], [0, 1, 5, 4]], ..two() };
        assert_eq!(twice.sides(), Err([0, 1]));
    }
}
