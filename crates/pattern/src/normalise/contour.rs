//! Contours of a planar graph: the faces left of its edges, and the outer loop of each part that hangs together.

use super::cluster::Groups;
use super::model::{Graph, Half};
use super::segment;
use softfold_geometry::DVec2;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Directions closer than this are told apart by their curvatures, rad: edges that leave a node tangentially.
const SAME_DIRECTION_RAD: f64 = 1e-7;

/// The contours of some edges of a graph.
pub(super) struct Contours {
    /// The outer contour of each part without its bridges, counter-clockwise. A contour that touches itself comes
    /// through the same node twice.
    pub(super) outer: Vec<Vec<Half>>,
    /// Edges that are on no closed contour.
    pub(super) bridges: Vec<usize>,
}

/// The contours of the edges that are `chosen`.
pub(super) fn contours(graph: &Graph, chosen: &[bool]) -> Contours {
    let mut chosen = chosen.to_vec();
    let faces = Faces::trace(graph, &chosen);
    // An edge with the same face on both sides is passed twice by one contour: it encloses nothing.
    let bridge = |e: &usize| chosen[*e] && faces.left[2 * e] == faces.left[2 * e + 1];
    let bridges: Vec<usize> = (0..graph.edges.len()).filter(bridge).collect();
    bridges.iter().for_each(|&e| chosen[e] = false);
    let faces = Faces::trace(graph, &chosen);
    Contours { outer: faces.outer(graph, &chosen), bridges }
}

struct Faces {
    /// Face on the left of each half.
    left: Vec<usize>,
    /// The halves around each face, the face on their left.
    rings: Vec<Vec<Half>>,
}

impl Faces {
    fn trace(graph: &Graph, chosen: &[bool]) -> Self {
        let next = turns(graph, chosen);
        let mut left = vec![usize::MAX; 2 * graph.edges.len()];
        let mut rings = Vec::new();
        for (edge, _) in chosen.iter().enumerate().filter(|c| *c.1) {
            for side in 0..2 {
                let mut half = Half::new(edge, side);
                let mut ring = Vec::new();
                while left[half.index()] == usize::MAX {
                    left[half.index()] = rings.len();
                    ring.push(half);
                    half = next[half.index()];
                }
                if !ring.is_empty() {
                    rings.push(ring);
                }
            }
        }
        Self { left, rings }
    }

    /// The outer contours: the outer face has its contour the wrong way round, so its area is the least.
    fn outer(&self, graph: &Graph, chosen: &[bool]) -> Vec<Vec<Half>> {
        let mut parts = Groups::new(graph.points.len());
        for (e, _) in graph.edges.iter().zip(chosen).filter(|(_, c)| **c) {
            parts.unite(e.nodes[0] as usize, e.nodes[1] as usize);
        }
        let mut least: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
        for (i, ring) in self.rings.iter().enumerate() {
            let part = parts.root(graph.node(ring[0]));
            let found = (area(graph, ring), i);
            let best = least.entry(part).or_insert(found);
            if found.0 < best.0 {
                *best = found;
            }
        }
        let turned = |ring: &[Half]| ring.iter().rev().map(|h| h.twin()).collect();
        least.values().map(|&(_, i)| turned(&self.rings[i])).collect()
    }
}

/// Area of a closed run of halves, positive counter-clockwise.
pub(super) fn area(graph: &Graph, ring: &[Half]) -> f64 {
    let origin = ring.first().map_or(DVec2::ZERO, |h| graph.point(*h));
    ring.iter().map(|h| segment::area(&graph.run(*h), origin)).sum()
}

/// The half that follows each half around the face on its left: at the node where it arrives, the next one
/// clockwise from its twin.
fn turns(graph: &Graph, chosen: &[bool]) -> Vec<Half> {
    let mut next: Vec<Half> = (0..2 * graph.edges.len()).map(|i| Half::new(i / 2, i % 2)).collect();
    for mut around in graph.leaving() {
        around.retain(|h| chosen[h.edge()]);
        let mut sorted: Vec<(f64, f64, Half)> = around.into_iter().map(|h| leaves(graph, h)).collect();
        sorted.sort_by(|a, b| direction_order(a, b).then(a.2.cmp(&b.2)));
        for (i, (_, _, half)) in sorted.iter().enumerate() {
            let clockwise = sorted[(i + sorted.len() - 1) % sorted.len()].2;
            next[half.twin().index()] = clockwise;
        }
    }
    next
}

/// Angle and curvature with which a half leaves its node.
fn leaves(graph: &Graph, half: Half) -> (f64, f64, Half) {
    let s = &graph.edges[half.edge()].segment;
    let angle = segment::leaving(s, half.side()).to_angle();
    // Directions are rounded, so that tangential curves are told apart by how they bend.
    let steps = (angle / SAME_DIRECTION_RAD).round() * SAME_DIRECTION_RAD;
    let steps = if steps <= SAME_DIRECTION_RAD - PI { steps + TAU } else { steps };
    (steps, segment::leaving_curvature(s, half.side()), half)
}

fn direction_order(a: &(f64, f64, Half), b: &(f64, f64, Half)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
}

/// A contour as loops that come through no node twice, in the order in which they close.
pub(super) fn simple_loops(graph: &Graph, contour: &[Half]) -> Vec<Vec<Half>> {
    let mut loops = Vec::new();
    let mut open: Vec<Half> = Vec::new();
    let mut at: BTreeMap<usize, usize> = BTreeMap::new();
    for &half in contour {
        if let Some(&start) = at.get(&graph.node(half)) {
            let closed = open.split_off(start);
            closed.iter().for_each(|h| {
                at.remove(&graph.node(*h));
            });
            loops.push(closed);
        }
        at.insert(graph.node(half), open.len());
        open.push(half);
    }
    loops.push(open);
    loops.retain(|l| !l.is_empty());
    loops
}
