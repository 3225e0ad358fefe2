//! Which way each piece of the border runs in the grid: along the first axis, the second, or back.
//!
//! A shortest path around each loop: a piece should run as its label says, and a change of label costs unless the
//! outline has a corner there.

use super::background::Background;
use super::frame::Frame;
use super::grid::chain_axis;
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

/// Cost of a change of label where the outline does not turn: about twenty cells at 45° each way.
const CHANGE: f64 = 0.5;
/// Cost of a cell's length of border at 45° to its label; it grows with the fourth power.
const SLANT: f64 = 0.05;

/// Cost of an edge that runs along a line which ends on it.
const CROSSED: f64 = 5.0;
/// Cells beside the end of a line that the border goes on across it.
const BESIDE: f64 = 6.0;

/// A piece of the border between two changes of label.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// 0 along the first axis, 1 along the second, 2 and 3 against them; the sheet is at the left.
    pub(crate) label: usize,
    /// Vertices, both ends included; of a whole loop the first is repeated.
    pub(crate) vertices: Vec<usize>,
}

impl Piece {
    /// The coordinate that stays the same along it.
    pub(crate) fn axis(&self) -> usize {
        1 - self.label % 2
    }
}

/// The pieces of all loops.
pub(crate) fn pieces(ground: &Background<'_>, frame: &Frame, cell_mm: f64) -> Vec<Piece> {
    (0..ground.loops.len()).flat_map(|l| loop_pieces(ground, frame, l, cell_mm)).collect()
}

/// For each border edge the angle that the first axis should have there, rad.
pub(crate) fn border_angles(ground: &Background<'_>, pieces: &[Piece]) -> Vec<([usize; 2], f64)> {
    let of_piece = |piece: &Piece| {
        let quarter = FRAC_PI_2 * piece.label as f64;
        let angle =
            move |w: &[usize]| ([w[0], w[1]], (at(ground, w[1]) - at(ground, w[0])).to_angle() - quarter);
        piece.vertices.windows(2).map(angle).collect::<Vec<_>>()
    };
    pieces.iter().flat_map(of_piece).collect()
}

fn at(ground: &Background<'_>, v: usize) -> DVec2 {
    ground.mesh.vertices[v]
}

fn loop_pieces(ground: &Background<'_>, frame: &Frame, number: usize, cell_mm: f64) -> Vec<Piece> {
    let vertices = &ground.loops[number];
    let n = vertices.len();
    let edge = |k: usize| at(ground, vertices[(k + 1) % n]) - at(ground, vertices[k]);
    let slants: Vec<[f64; 4]> = (0..n)
        .map(|k| {
            let axis = DVec2::from_angle(frame.angle_at(ground, vertices[k]))
                + DVec2::from_angle(frame.angle_at(ground, vertices[(k + 1) % n]));
            let quarters = axis.angle_to(edge(k)) / FRAC_PI_2;
            [0.0, 1.0, 2.0, 3.0].map(|label| {
                let off = (quarters - label + 2.0).rem_euclid(4.0) - 2.0;
                SLANT * edge(k).length() / cell_mm * (2.0 * off).powi(4)
            })
        })
        .collect();
    let slants = crossed(ground, frame, number, cell_mm, slants);
    // Quarters by which the border turns at the start of edge k.
    let corners: Vec<f64> = (0..n).map(|k| edge((k + n - 1) % n).angle_to(edge(k)) / FRAC_PI_2).collect();
    split(vertices, &cheapest(&slants, &corners))
}

/// Where lines end on the border it must cross them, there and for some cells beside.
fn crossed(
    ground: &Background<'_>,
    frame: &Frame,
    number: usize,
    cell_mm: f64,
    mut slants: Vec<[f64; 4]>,
) -> Vec<[f64; 4]> {
    let vertices = &ground.loops[number];
    for (c, chain) in ground.chains.iter().enumerate().filter(|(_, c)| !c.closed) {
        for end in [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]] {
            let Some(start) = vertices.iter().position(|v| *v == end) else { continue };
            for k in beside(ground, vertices, start, BESIDE * cell_mm) {
                let along = (0..4).filter(|label| 1 - label % 2 == chain_axis(frame, c));
                along.for_each(|label| slants[k][label] = slants[k][label].max(CROSSED));
            }
        }
    }
    slants
}

/// Edges of a loop on both sides of a vertex up to a length, but not around corners.
fn beside(ground: &Background<'_>, vertices: &[usize], start: usize, length_mm: f64) -> Vec<usize> {
    let n = vertices.len();
    let edge = |k: usize| at(ground, vertices[(k + 1) % n]) - at(ground, vertices[k % n]);
    let turns = |a: usize, b: usize| edge(a).angle_to(edge(b)).abs() > 0.5 * FRAC_PI_2;
    let mut found = Vec::new();
    for forward in [true, false] {
        let step = |i: usize| if forward { (start + i) % n } else { (start + 2 * n - 1 - i) % n };
        let mut reached = 0.0;
        for i in 0..n {
            if reached > length_mm || (i > 0 && turns(step(i - 1), step(i))) {
                break;
            }
            reached += edge(step(i)).length();
            found.push(step(i));
        }
    }
    found
}

/// Labels of the edges of a loop.
fn cheapest(slants: &[[f64; 4]], corners: &[f64]) -> Vec<usize> {
    let ways = (0..4).map(|start| cheapest_from(slants, corners, start));
    ways.min_by(|a, b| a.0.total_cmp(&b.0)).map(|w| w.1).unwrap_or_default()
}

/// Cost of the change from one label to the next at a corner of so many quarters.
fn change(from: usize, to: usize, corner: f64) -> f64 {
    match (to + 4 - from) % 4 {
        0 => 0.0,
        1 => CHANGE * (1.0 - corner.clamp(0.0, 1.0)),
        3 => CHANGE * (1.0 + corner.clamp(-1.0, 0.0)),
        _ => f64::INFINITY,
    }
}

fn cheapest_from(slants: &[[f64; 4]], corners: &[f64], start: usize) -> (f64, Vec<usize>) {
    let mut costs = [f64::INFINITY; 4];
    costs[start] = slants[0][start];
    let mut from = vec![[0; 4]];
    for k in 1..slants.len() {
        let mut next = [(f64::INFINITY, 0); 4];
        for (to, best) in next.iter_mut().enumerate() {
            for (label, cost) in costs.iter().enumerate() {
                let whole = cost + change(label, to, corners[k]) + slants[k][to];
                if whole < best.0 {
                    *best = (whole, label);
                }
            }
        }
        costs = next.map(|b| b.0);
        from.push(next.map(|b| b.1));
    }
    let end = |l: usize| costs[l] + change(l, start, corners[0]);
    let last = (0..4).min_by(|&a, &b| end(a).total_cmp(&end(b))).unwrap_or(start);
    let mut labels = vec![last];
    for k in (1..slants.len()).rev() {
        labels.push(from[k][labels[labels.len() - 1]]);
    }
    labels.reverse();
    (end(last), labels)
}

fn split(vertices: &[usize], labels: &[usize]) -> Vec<Piece> {
    let n = labels.len();
    let Some(first) = (0..n).find(|&k| labels[k] != labels[(k + n - 1) % n]) else {
        let whole = vertices.iter().chain(vertices.first()).copied().collect();
        return vec![Piece { label: labels[0], vertices: whole }];
    };
    let mut pieces: Vec<Piece> = Vec::new();
    for k in (0..n).map(|k| (first + k) % n) {
        let (a, b) = (vertices[k], vertices[(k + 1) % n]);
        match pieces.last_mut() {
            Some(piece) if piece.label == labels[k] => piece.vertices.push(b),
            _ => pieces.push(Piece { label: labels[k], vertices: vec![a, b] }),
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_changes_its_label_at_its_corners() {
        let slant = |label: usize| [0, 1, 2, 3].map(|l| if l == label { 0.0 } else { 1.0 });
        let slants: Vec<_> = (0..8).map(|k| slant(k / 2)).collect();
        let corners: Vec<_> = (0..8).map(|k| if k % 2 == 0 { 1.0 } else { 0.0 }).collect();
        assert_eq!(cheapest(&slants, &corners), [0, 0, 1, 1, 2, 2, 3, 3]);
    }

    #[test]
    fn a_notch_that_is_not_worth_two_changes_is_passed_over() {
        let mut slants = vec![[0.0, 1.0, 9.0, 1.0]; 9];
        slants[4] = [0.3, 0.0, 9.0, 9.0];
        assert_eq!(cheapest(&slants, &[0.0; 9]), [0; 9]);
    }
}
