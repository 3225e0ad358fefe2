//! A planar graph of curved edges and the loops around its regions.

use super::SideOf;
use softfold_geometry::DVec2;
use std::collections::BTreeMap;

/// A curve between two nodes.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) nodes: [usize; 2],
    /// Directions in which it leaves its start and, backwards, its end.
    pub(super) leaving: [DVec2; 2],
    /// Area that it sweeps as seen from the common origin, mm².
    pub(super) swept_mm2: f64,
    /// Start, points near the curve, end.
    pub(super) points: Vec<DVec2>,
    /// What lies to its left and to its right.
    pub(super) sides: [SideOf; 2],
}

/// The edges around one side of a region, the region to the left.
#[derive(Clone, Debug)]
pub(super) struct Loop {
    /// Positive counter-clockwise.
    pub(super) area_mm2: f64,
    pub(super) sides: Vec<SideOf>,
    pub(super) points: Vec<DVec2>,
}

/// Nodes and edges. Half-edge `2e` runs along edge `e`, `2e + 1` backwards.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    pub(super) nodes: Vec<DVec2>,
    pub(super) edges: Vec<Edge>,
    cells: BTreeMap<[i64; 2], Vec<usize>>,
    pub(super) same_mm: f64,
}

impl Graph {
    /// An empty graph in which points closer than `same_mm` are one node.
    pub(super) fn new(same_mm: f64) -> Self {
        Self { nodes: Vec::new(), edges: Vec::new(), cells: BTreeMap::new(), same_mm }
    }

    /// The node at a point.
    pub(super) fn node(&mut self, p: DVec2) -> usize {
        let cell = (p / self.same_mm).floor().as_i64vec2();
        let around = |i: i64| [cell.x + i % 3 - 1, cell.y + i / 3 - 1];
        let known = (0..9).filter_map(|i| self.cells.get(&around(i))).flatten();
        if let Some(&node) = known.into_iter().find(|n| self.nodes[**n].distance(p) <= self.same_mm) {
            return node;
        }
        self.nodes.push(p);
        self.cells.entry([cell.x, cell.y]).or_default().push(self.nodes.len() - 1);
        self.nodes.len() - 1
    }

    /// Makes two nodes one.
    pub(super) fn merge(&mut self, kept: usize, gone: usize) {
        let nodes = self.edges.iter_mut().flat_map(|e| &mut e.nodes);
        nodes.filter(|n| **n == gone).for_each(|n| *n = kept);
    }

    /// The loops around all regions.
    pub(super) fn loops(&self) -> Vec<Loop> {
        let next = self.next();
        let mut seen = vec![false; next.len()];
        let mut loops = Vec::new();
        for start in 0..next.len() {
            if seen[start] {
                continue;
            }
            let mut l = Loop { area_mm2: 0.0, sides: Vec::new(), points: Vec::new() };
            let mut h = start;
            while !seen[h] {
                seen[h] = true;
                self.walk(h, &mut l);
                h = next[h];
            }
            loops.push(l);
        }
        loops
    }

    fn walk(&self, h: usize, l: &mut Loop) {
        let edge = &self.edges[h / 2];
        let backward = h % 2;
        l.area_mm2 += if backward == 1 { -edge.swept_mm2 } else { edge.swept_mm2 };
        l.sides.push(edge.sides[backward]);
        let n = edge.points.len() - 1;
        match backward {
            0 => l.points.extend(&edge.points[..n]),
            _ => l.points.extend(edge.points[1..].iter().rev()),
        }
    }

    /// The half-edge that follows each one around the region to its left: at its end, the next one
    /// clockwise from where it came from.
    fn next(&self) -> Vec<usize> {
        let mut leaving: Vec<Vec<(f64, usize)>> = vec![Vec::new(); self.nodes.len()];
        for (e, edge) in self.edges.iter().enumerate() {
            for side in 0..2 {
                leaving[edge.nodes[side]].push((edge.leaving[side].to_angle(), 2 * e + side));
            }
        }
        let mut next = vec![0; 2 * self.edges.len()];
        for around in &mut leaving {
            around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let n = around.len();
            for i in 0..n {
                let came_from = around[i].1;
                next[came_from ^ 1] = around[(i + n - 1) % n].1;
            }
        }
        next
    }
}
