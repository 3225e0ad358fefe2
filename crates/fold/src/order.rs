//! The order in which vertices are eliminated: nested dissection on the flat coordinates.
//!
//! A part of the sheet is cut across its longer side, the vertices along the cut that keep both sides apart come last,
//! and the sides are ordered the same way (George 1973; with coordinates: Heath & Raghavan 1995). The separator is the least
//! set of vertices that touches every coupling across the cut: a vertex cover by a largest matching (König 1931). The elimination tree is then put in
//! postorder (Liu 1990), so that columns with the same rows stand side by side and are factorised as one dense block.

use glam::DVec2;

/// Parts of so few vertices are not cut any more.
const LEAF: usize = 12;
/// No vertex, no parent.
const NONE: u32 = u32::MAX;

/// The vertices in order of elimination: `order[k]` comes `k`-th. `rows` holds, of each vertex, itself and the later
/// ones that it is coupled to, as [`coupled_rows`](crate::hessian::coupled_rows) gives them.
pub(crate) fn nested_dissection(places: &[DVec2], rows: &[Vec<u32>]) -> Vec<u32> {
    let graph = Graph::new(rows);
    let mut dissection = Dissection {
        graph: &graph,
        places,
        side: vec![0; rows.len()],
        mate: vec![NONE; rows.len()],
        seen: vec![0; rows.len()],
        round: 0,
        parts: 0,
    };
    let mut order = Vec::with_capacity(rows.len());
    dissection.dissect((0..rows.len() as u32).collect(), &mut order);
    postordered(&graph, &order)
}

/// Neighbours of each vertex, in one flat array.
struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Graph {
    fn new(rows: &[Vec<u32>]) -> Self {
        let pairs = || rows.iter().enumerate().flat_map(|(j, r)| r.iter().map(move |&i| (i as usize, j)));
        let mut starts = vec![0; rows.len() + 1];
        for (i, j) in pairs().filter(|(i, j)| i != j) {
            starts[i + 1] += 1;
            starts[j + 1] += 1;
        }
        for v in 0..rows.len() {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; starts[rows.len()]];
        for (i, j) in pairs().filter(|(i, j)| i != j) {
            for (a, b) in [(i, j), (j, i)] {
                neighbours[next[a]] = b as u32;
                next[a] += 1;
            }
        }
        Self { starts, neighbours }
    }

    fn of(&self, v: u32) -> &[u32] {
        &self.neighbours[self.starts[v as usize]..self.starts[v as usize + 1]]
    }
}

struct Dissection<'a> {
    graph: &'a Graph,
    places: &'a [DVec2],
    /// Which side of which cut each vertex is on: two numbers a cut.
    side: Vec<u32>,
    /// Partner of each vertex in the matching across the cut.
    mate: Vec<u32>,
    /// Last round of the search for a path that saw the vertex.
    seen: Vec<u32>,
    round: u32,
    parts: u32,
}

impl Dissection<'_> {
    fn dissect(&mut self, mut part: Vec<u32>, order: &mut Vec<u32>) {
        if part.len() <= LEAF {
            order.extend(part);
            return;
        }
        self.halve(&mut part);
        let right = part.split_off(part.len() / 2);
        self.parts += 1;
        let [a, b] = [2 * self.parts, 2 * self.parts + 1];
        part.iter().for_each(|&v| self.side[v as usize] = a);
        right.iter().for_each(|&v| self.side[v as usize] = b);
        let separator = self.cover(&part, [a, b]);
        separator.iter().for_each(|&v| self.side[v as usize] = 0);
        let rest = |half: Vec<u32>, name: u32, side: &[u32]| -> Vec<u32> {
            half.into_iter().filter(|&v| side[v as usize] == name).collect()
        };
        let (left, right) = (rest(part, a, &self.side), rest(right, b, &self.side));
        self.dissect(left, order);
        self.dissect(right, order);
        order.extend(separator);
    }

    /// Puts the half of a part that lies before the middle of its longer side first.
    fn halve(&self, part: &mut [u32]) {
        let at = |v: u32| self.places[v as usize];
        let mean = part.iter().map(|&v| at(v)).sum::<DVec2>() / part.len() as f64;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for &v in part.iter() {
            let d = at(v) - mean;
            (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
        }
        // Direction of the largest spread.
        let along = DVec2::from_angle(0.5 * (2.0 * xy).atan2(xx - yy));
        let key = |v: u32| at(v).dot(along);
        part.select_nth_unstable_by(part.len() / 2, |&v, &w| key(v).total_cmp(&key(w)).then(v.cmp(&w)));
    }

    /// The least set of vertices that touches every coupling between side `a` and side `b`; `left` is side `a`.
    fn cover(&mut self, left: &[u32], [a, b]: [u32; 2]) -> Vec<u32> {
        let across =
            |d: &Self, v: u32, other: u32| d.graph.of(v).iter().any(|&w| d.side[w as usize] == other);
        let rim: Vec<u32> = left.iter().copied().filter(|&v| across(self, v, b)).collect();
        for &v in &rim {
            self.round += 1;
            self.augment(v, b);
        }
        // König: what alternating paths from unmatched vertices reach on the right, and do not reach on the left.
        self.round += 1;
        let mut right = Vec::new();
        for &v in &rim {
            if self.mate[v as usize] == NONE {
                self.reach(v, b, &mut right);
            }
        }
        let unreached = rim.iter().copied().filter(|&v| self.seen[v as usize] != self.round);
        let cover: Vec<u32> = unreached.chain(right).collect();
        debug_assert!(rim.iter().all(|&v| self.side[v as usize] == a));
        for &v in &rim {
            let mate = std::mem::replace(&mut self.mate[v as usize], NONE);
            if mate != NONE {
                self.mate[mate as usize] = NONE;
            }
        }
        cover
    }

    /// Looks for a path from an unmatched vertex to another one beyond the cut along which the matching grows.
    fn augment(&mut self, v: u32, other: u32) -> bool {
        for k in self.graph.starts[v as usize]..self.graph.starts[v as usize + 1] {
            let w = self.graph.neighbours[k];
            if self.side[w as usize] != other || self.seen[w as usize] == self.round {
                continue;
            }
            self.seen[w as usize] = self.round;
            let mate = self.mate[w as usize];
            if mate == NONE || self.augment(mate, other) {
                (self.mate[w as usize], self.mate[v as usize]) = (v, w);
                return true;
            }
        }
        false
    }

    fn reach(&mut self, v: u32, other: u32, right: &mut Vec<u32>) {
        let mut stack = vec![v];
        self.seen[v as usize] = self.round;
        while let Some(v) = stack.pop() {
            for &w in self.graph.of(v) {
                if self.side[w as usize] != other || self.seen[w as usize] == self.round {
                    continue;
                }
                self.seen[w as usize] = self.round;
                right.push(w);
                let mate = self.mate[w as usize];
                if mate != NONE && self.seen[mate as usize] != self.round {
                    self.seen[mate as usize] = self.round;
                    stack.push(mate);
                }
            }
        }
    }
}

/// Parent of each column of the factor in the elimination tree of an order.
fn parents(graph: &Graph, order: &[u32]) -> Vec<u32> {
    let mut position = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &v)| position[v as usize] = k as u32);
    let mut parent = vec![NONE; order.len()];
    let mut ancestor = vec![NONE; order.len()];
    for (k, &v) in order.iter().enumerate() {
        for &w in graph.of(v) {
            let mut i = position[w as usize];
            while i < k as u32 {
                let next = std::mem::replace(&mut ancestor[i as usize], k as u32);
                if next == NONE {
                    parent[i as usize] = k as u32;
                    break;
                }
                i = next;
            }
        }
    }
    parent
}

/// The same elimination with each subtree of its tree in one piece.
fn postordered(graph: &Graph, order: &[u32]) -> Vec<u32> {
    let n = order.len();
    let parent = parents(graph, order);
    // First child and next sibling, so that children come in ascending order.
    let (mut child, mut sibling) = (vec![NONE; n + 1], vec![NONE; n]);
    for k in (0..n).rev() {
        let p = if parent[k] == NONE { n } else { parent[k] as usize };
        sibling[k] = std::mem::replace(&mut child[p], k as u32);
    }
    let mut done = Vec::with_capacity(n);
    let mut stack: Vec<u32> = Vec::new();
    let mut here = child[n];
    loop {
        while here != NONE {
            stack.push(here);
            here = child[here as usize];
        }
        let Some(k) = stack.pop() else { return done };
        done.push(order[k as usize]);
        here = sibling[k as usize];
    }
}

/// Entries of the factor, below and on the diagonal, if vertices are eliminated in this order: one per pair of vertices.
#[cfg(test)]
pub(crate) fn fill(rows: &[Vec<u32>], order: &[u32]) -> usize {
    let graph = Graph::new(rows);
    let parent = parents(&graph, order);
    let mut position = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &v)| position[v as usize] = k);
    let mut seen = vec![NONE; order.len()];
    let mut entries = order.len();
    for (k, &v) in order.iter().enumerate() {
        seen[k] = k as u32;
        for &w in graph.of(v) {
            // Row k of the factor: the paths from earlier neighbours up to k.
            let mut i = position[w as usize];
            while i < k && seen[i] != k as u32 {
                seen[i] = k as u32;
                entries += 1;
                i = parent[i] as usize;
            }
        }
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SheetMaterial;
    use crate::hessian::coupled_rows;
    use crate::testing::strip;

    fn coupled(columns: usize, lines: usize) -> (Vec<DVec2>, Vec<Vec<u32>>) {
        let mesh = strip(columns, lines, 5.0);
        let material = SheetMaterial {
            youngs_modulus_mpa: 1.0,
            poisson_ratio: 0.3,
            thickness_mm: 1.0,
            fold_line_factor: 1.0,
        };
        let groups: Vec<Vec<u32>> = material.goals(&mesh).iter().flat_map(|g| g.couplings()).collect();
        let rows = coupled_rows(mesh.vertices.len(), &groups);
        (mesh.vertices, rows)
    }

    #[test]
    fn every_vertex_comes_once() {
        for (columns, lines) in [(1, 1), (3, 2), (17, 11), (60, 2)] {
            let (places, rows) = coupled(columns, lines);
            let mut order = nested_dissection(&places, &rows);
            order.sort_unstable();
            assert!(order.iter().enumerate().all(|(k, &v)| k == v as usize) && order.len() == places.len());
        }
        assert_eq!(nested_dissection(&[], &[]), Vec::<u32>::new());
    }

    #[test]
    fn on_a_square_the_factor_has_at_most_two_thirds_of_the_entries_of_row_after_row() {
        let (places, rows) = coupled(50, 50);
        let natural: Vec<u32> = (0..places.len() as u32).collect();
        let dissected = nested_dissection(&places, &rows);
        let (by_rows, by_parts) = (fill(&rows, &natural), fill(&rows, &dissected));
        assert!(3 * by_parts < 2 * by_rows, "{by_parts} against {by_rows}");
    }

    #[test]
    fn vertices_at_one_place_and_couplings_across_the_sheet_are_no_trouble() {
        let (mut places, mut rows) = coupled(12, 9);
        places.iter_mut().for_each(|p| *p = DVec2::ZERO);
        let last = rows.len() as u32 - 1;
        rows[0].push(last);
        let mut order = nested_dissection(&places, &rows);
        order.sort_unstable();
        assert_eq!(order, (0..=last).collect::<Vec<u32>>());
    }

    #[test]
    fn the_fill_of_a_path_and_of_a_star_is_known() {
        let path: Vec<Vec<u32>> = (0..5_u32).map(|v| (v..5.min(v + 2)).collect()).collect();
        assert_eq!(fill(&path, &[0, 1, 2, 3, 4]), 9);
        let star: Vec<Vec<u32>> =
            (0..5_u32).map(|v| if v == 0 { (0..5).collect() } else { vec![v] }).collect();
        assert_eq!(fill(&star, &[0, 1, 2, 3, 4]), 15); // the middle first joins all
        assert_eq!(fill(&star, &[1, 2, 3, 4, 0]), 9);
    }
}
