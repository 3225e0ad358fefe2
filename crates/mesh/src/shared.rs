//! Points that lines have in common, found again within a tolerance.

use glam::DVec2;
use softfold_geometry::VertexId;
use std::collections::BTreeMap;

/// Vertices by place, in cells as wide as the distance below which two points are one.
pub(crate) struct SharedPoints {
    same_mm: f64,
    cells: BTreeMap<[i64; 2], Vec<(DVec2, VertexId)>>,
}

impl SharedPoints {
    /// Points within `same_mm` of each other are one.
    pub(crate) fn new(same_mm: f64) -> Self {
        Self { same_mm: same_mm.max(f64::MIN_POSITIVE), cells: BTreeMap::new() }
    }

    /// Notes the vertex of a point.
    pub(crate) fn insert(&mut self, p: DVec2, vertex: VertexId) {
        self.cells.entry(self.cell(p)).or_default().push((p, vertex));
    }

    /// The vertex nearest to a point, if it is the same point.
    pub(crate) fn find(&self, p: DVec2) -> Option<VertexId> {
        let [x, y] = self.cell(p);
        let around = |k: i64| [k.saturating_sub(1), k, k.saturating_add(1)];
        let cells = around(x).into_iter().flat_map(|x| around(y).map(|y| [x, y]));
        let near = cells.filter_map(|c| self.cells.get(&c)).flatten();
        let distances = near.map(|&(q, v)| (p.distance(q), v)).filter(|(d, _)| *d <= self.same_mm);
        distances.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, v)| v)
    }

    fn cell(&self, p: DVec2) -> [i64; 2] {
        (p / self.same_mm).floor().to_array().map(|c| c as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_found_within_the_tolerance_on_all_sides_of_a_cell() {
        let mut points = SharedPoints::new(0.1);
        let at = DVec2::new(-0.3, 0.7);
        points.insert(at, VertexId(3));
        for k in 0..16 {
            let direction = DVec2::from_angle(f64::from(k));
            assert_eq!(points.find(at + 0.099 * direction), Some(VertexId(3)));
            assert_eq!(points.find(at + 0.101 * direction), None);
        }
    }

    #[test]
    fn the_nearest_of_several_is_found() {
        let mut points = SharedPoints::new(1.0);
        points.insert(DVec2::new(0.9, 0.0), VertexId(0));
        points.insert(DVec2::new(-0.2, 0.0), VertexId(1));
        assert_eq!(points.find(DVec2::ZERO), Some(VertexId(1)));
        assert_eq!(points.find(DVec2::new(0.8, 0.0)), Some(VertexId(0)));
    }
}
