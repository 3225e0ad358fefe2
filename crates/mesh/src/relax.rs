//! Relaxation: free points move to the middle of their surroundings, points on curves are held.

use crate::draft::Draft;
use glam::DVec2;

/// Share of a triangle's area that must be left after a move.
const LEAST_AREA_LEFT: f64 = 0.1;
/// Moves by less than this share of the mean distance to the neighbours are not made.
const LEAST_MOVE: f64 = 0.02;

/// How triangles weigh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    /// By their area: points spread evenly.
    Area,
    /// All the same: points keep the spacing that they have.
    Same,
}

/// Rounds in which every restless point moves to the weighted centre of its triangles, unless that would turn one of
/// them over; restless are those given, and from then on those beside which something moved. Points before number `held`
/// stay.
pub(crate) fn relax(
    draft: &mut Draft<'_>,
    held: usize,
    rounds: u32,
    weight: Weight,
    mut restless: Vec<bool>,
) {
    let (points, net) = (&mut draft.planar.graph.points, &mut draft.net);
    let (mut ring, mut around, mut changed) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds {
        let mut moved = Vec::new();
        let mut next = vec![false; points.len()];
        for v in (held..points.len()).filter(|v| restless[*v]) {
            if !net.ring(v, &mut ring) {
                continue;
            }
            let old = points[v];
            around.clear();
            around.extend(ring.iter().map(|&n| points[n as usize] - old));
            let step = to_middle(&around, weight);
            let size = around.iter().map(|a| a.length_squared()).sum::<f64>() / around.len() as f64;
            let holds =
                |(a, b): (DVec2, DVec2)| (a - step).perp_dot(b - step) > LEAST_AREA_LEFT * a.perp_dot(b);
            if step.length_squared() > LEAST_MOVE * LEAST_MOVE * size && sides(&around).all(holds) {
                points[v] = old + step;
                moved.push(v as u32);
                next[v] = true;
                ring.iter().for_each(|&n| next[n as usize] = n as usize >= held);
            }
        }
        net.flip_around(points, &moved, &mut changed);
        changed.clear();
        restless = next;
    }
}

/// From a point to the weighted centre of the triangles between it and its neighbours, given from it.
fn to_middle(around: &[DVec2], by: Weight) -> DVec2 {
    let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
    for (a, b) in sides(around) {
        let area = match by {
            Weight::Area => a.perp_dot(b),
            Weight::Same => 1.0,
        };
        sum += area * (a + b);
        weight += area;
    }
    sum / (3.0 * weight)
}

fn sides(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    let last = ring.last().copied().unwrap_or_default();
    ring.iter().scan(last, |from, &to| Some((std::mem::replace(from, to), to)))
}
