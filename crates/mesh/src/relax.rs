//! Relaxation: free points move to the middle of their surroundings, points on curves are held.

use crate::net::Net;
use glam::DVec2;

/// Share of a triangle's area that must be left after a move.
const LEAST_AREA_LEFT: f64 = 0.1;

/// How triangles weigh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    /// By their area: points spread evenly.
    Area,
    /// All the same: points keep the spacing that they have.
    Same,
}

/// One round: every point from number `held` on moves to the weighted centre of its triangles, unless that would turn
/// one of them over.
pub(crate) fn round(points: &mut [DVec2], held: usize, net: &Net, weight: Weight) {
    let (mut ring, mut around) = (Vec::new(), Vec::new());
    for v in held..points.len() {
        if !net.ring(v, &mut ring) {
            continue;
        }
        let old = points[v];
        around.clear();
        around.extend(ring.iter().map(|&n| points[n as usize] - old));
        let step = to_middle(&around, weight);
        if sides(&around).all(|(a, b)| (a - step).perp_dot(b - step) > LEAST_AREA_LEFT * a.perp_dot(b)) {
            points[v] = old + step;
        }
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
