//! Points that are one: clusters of points closer than the join tolerance.

use super::clean::order;
use softfold_geometry::DVec2;
use std::collections::BTreeMap;

/// Points compared between two neighbouring cells at most; only a drawing with thousands of points within its own
/// join tolerance comes near, and then the first ones decide for their cells.
const MAX_COMPARED: usize = 64;
/// Cells on each side that hold points within the tolerance: a cell's diagonal is the tolerance.
const NEIGHBOURS: i64 = 2;

/// Points with what they are worth as the place of their node, 0 most.
pub(super) struct Candidate {
    pub(super) at: DVec2,
    pub(super) rank: u8,
}

/// Nodes of points.
pub(super) struct Nodes {
    /// Node of each point.
    pub(super) of: Vec<u32>,
    /// Places of the nodes, sorted.
    pub(super) points: Vec<DVec2>,
}

/// Groups points that are within `join_mm` of each other, or linked by such pairs or by `ties`; a group's place is
/// that of its best member, of the least coordinates where several are the best.
pub(super) fn cluster(candidates: &[Candidate], ties: &[[usize; 2]], join_mm: f64) -> Nodes {
    let mut sorted: Vec<usize> = (0..candidates.len()).collect();
    sorted.sort_by(|&a, &b| {
        let (a, b) = (&candidates[a], &candidates[b]);
        order(a.at, b.at).then(a.rank.cmp(&b.rank))
    });
    let mut distinct: Vec<&Candidate> = Vec::new();
    let mut distinct_of = vec![0; candidates.len()];
    for &i in &sorted {
        let c = &candidates[i];
        if distinct.last().is_none_or(|l| l.at != c.at) {
            distinct.push(c);
        }
        distinct_of[i] = distinct.len() - 1;
    }
    let mut groups = Groups::new(distinct.len());
    unite_near(&distinct, join_mm, &mut groups);
    for [a, b] in ties {
        groups.unite(distinct_of[*a], distinct_of[*b]);
    }
    nodes(&distinct, &distinct_of, &mut groups)
}

fn unite_near(points: &[&Candidate], join_mm: f64, groups: &mut Groups) {
    let side = join_mm * std::f64::consts::FRAC_1_SQRT_2;
    let cell = |p: DVec2| ((p.x / side).floor() as i64, (p.y / side).floor() as i64);
    let mut cells: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, p) in points.iter().enumerate() {
        cells.entry(cell(p.at)).or_default().push(i);
    }
    for (&(x, y), members) in &cells {
        for &m in members {
            groups.unite(members[0], m);
        }
        for dx in 0..=NEIGHBOURS {
            let least = if dx == 0 { 1 } else { -NEIGHBOURS };
            let near = cells.range((x + dx, y + least)..=(x + dx, y + NEIGHBOURS));
            for (_, others) in near {
                let pairs = members
                    .iter()
                    .take(MAX_COMPARED)
                    .flat_map(|&a| others.iter().take(MAX_COMPARED).map(move |&b| (a, b)));
                let mut within = pairs.filter(|&(a, b)| points[a].at.distance(points[b].at) <= join_mm);
                if let Some((a, b)) = within.next() {
                    groups.unite(a, b);
                }
            }
        }
    }
}

fn nodes(distinct: &[&Candidate], distinct_of: &[usize], groups: &mut Groups) -> Nodes {
    // The points are sorted, so the first of the best rank has the least coordinates.
    let mut best: BTreeMap<usize, usize> = BTreeMap::new();
    for i in 0..distinct.len() {
        let b = best.entry(groups.root(i)).or_insert(i);
        if distinct[i].rank < distinct[*b].rank {
            *b = i;
        }
    }
    let mut places: Vec<(usize, usize)> = best.into_iter().map(|(root, b)| (b, root)).collect();
    places.sort_unstable();
    let mut node_of_root = vec![0; distinct.len()];
    for (node, &(_, root)) in places.iter().enumerate() {
        node_of_root[root] = node as u32;
    }
    Nodes {
        of: distinct_of.iter().map(|&d| node_of_root[groups.root(d)]).collect(),
        points: places.iter().map(|&(b, _)| distinct[b].at).collect(),
    }
}

/// Union-find.
pub(super) struct Groups(Vec<usize>);

impl Groups {
    pub(super) fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    /// The least member of a group.
    pub(super) fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    /// Makes two groups one; false if they are.
    pub(super) fn unite(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Points closer than the tolerance share a node; nodes of chains alone are farther from each other.
        #[test]
        fn near_points_are_one(xs in proptest::collection::vec((0.0..9.0f64, 0.0..9.0f64, 0u8..3), 1..60)) {
            let points: Vec<Candidate> =
                xs.iter().map(|&(x, y, rank)| Candidate { at: DVec2::new(x, y), rank }).collect();
            let nodes = cluster(&points, &[], 1.0);
            for (i, a) in points.iter().enumerate() {
                prop_assert!(points.iter().any(|p| p.at == nodes.points[nodes.of[i] as usize]));
                for (k, b) in points.iter().enumerate() {
                    if a.at.distance(b.at) <= 1.0 {
                        prop_assert_eq!(nodes.of[i], nodes.of[k]);
                    }
                }
            }
        }
    }
}
