//! Triangles with their neighbours and the constraints between them.

use crate::cdt::Constraint;
use glam::DVec2;
use softfold_geometry::VertexId;

/// No triangle, or no constraint.
pub(crate) const NONE: u32 = u32::MAX;

/// Triangles and what lies across each of their sides: side `k` runs from corner `k` to the next.
pub(crate) struct Topology {
    pub(crate) triangles: Vec<[VertexId; 3]>,
    pub(crate) neighbours: Vec<[u32; 3]>,
    /// Numbers of the constraints on the sides.
    pub(crate) walls: Vec<[u32; 3]>,
}

impl Topology {
    pub(crate) fn new(triangles: Vec<[VertexId; 3]>, constraints: &[([VertexId; 2], Constraint)]) -> Self {
        let key = |a: VertexId, b: VertexId| (u64::from(a.0.min(b.0)) << 32) | u64::from(a.0.max(b.0));
        let mut sides = Vec::with_capacity(3 * triangles.len());
        for (t, c) in triangles.iter().enumerate() {
            sides.extend((0..3).map(|k| (key(c[k], c[(k + 1) % 3]), t as u32, k as u8)));
        }
        sides.sort_unstable();
        let mut walls_by_key: Vec<(u64, u32)> =
            constraints.iter().enumerate().map(|(i, (e, _))| (key(e[0], e[1]), i as u32)).collect();
        walls_by_key.sort_unstable();
        let mut neighbours = vec![[NONE; 3]; triangles.len()];
        let mut walls = vec![[NONE; 3]; triangles.len()];
        let mut next_wall = walls_by_key.iter().peekable();
        for run in sides.chunk_by(|a, b| a.0 == b.0) {
            while next_wall.next_if(|w| w.0 < run[0].0).is_some() {}
            let wall = next_wall.peek().filter(|w| w.0 == run[0].0).map_or(NONE, |w| w.1);
            for (i, &(_, t, k)) in run.iter().enumerate() {
                walls[t as usize][k as usize] = wall;
                if let (2, Some(other)) = (run.len(), run.get(1 - i.min(1))) {
                    neighbours[t as usize][k as usize] = other.1;
                }
            }
        }
        Self { triangles, neighbours, walls }
    }

    pub(crate) fn corners(&self, points: &[DVec2], t: usize) -> [DVec2; 3] {
        self.triangles[t].map(|v| points[v.index()])
    }
}

/// Side of a triangle that is shortest, by its first corner.
pub(crate) fn shortest(p: [DVec2; 3]) -> usize {
    let length = |k: usize| p[k].distance_squared(p[(k + 1) % 3]);
    (0..3).min_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0)
}

/// Smallest angle of a triangle, rad: that across its shortest side; not positive if it is turned over.
pub(crate) fn least_angle_rad(p: [DVec2; 3]) -> f64 {
    let k = shortest(p);
    let (a, b) = (p[k] - p[(k + 2) % 3], p[(k + 1) % 3] - p[(k + 2) % 3]);
    a.perp_dot(b).atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use softfold_geometry::LoopId;

    #[test]
    fn two_triangles_are_neighbours_across_their_diagonal() {
        let v = VertexId::new;
        let wall = ([v(2), v(0)], Constraint::Boundary { loop_id: LoopId(0) });
        let topology = Topology::new(vec![[v(0), v(1), v(2)], [v(0), v(2), v(3)]], &[wall]);
        assert_eq!(topology.neighbours, [[NONE, NONE, 1], [0, NONE, NONE]]);
        assert_eq!(topology.walls, [[NONE, NONE, 0], [0, NONE, NONE]]);
    }
}
