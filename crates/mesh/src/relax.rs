//! Relaxation: free points move to the middle of their surroundings, points on curves are held.

use crate::rings::Rings;
use glam::DVec2;
use softfold_geometry::VertexId;

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
pub(crate) fn round(points: &mut [DVec2], held: usize, triangles: &[[VertexId; 3]], weight: Weight) {
    let rings = Rings::new(points.len(), triangles);
    for v in held..points.len() {
        let ring = rings.of(v);
        if ring.is_empty() {
            continue;
        }
        let (old, new) = (points[v], middle(points, triangles, ring, weight));
        let before = areas(points, triangles, ring);
        points[v] = new;
        let after = areas(points, triangles, ring);
        if after.iter().zip(&before).any(|(a, b)| *a < LEAST_AREA_LEFT * b) {
            points[v] = old;
        }
    }
}

fn corners(points: &[DVec2], triangle: [VertexId; 3]) -> [DVec2; 3] {
    triangle.map(|v| points[v.index()])
}

fn middle(points: &[DVec2], triangles: &[[VertexId; 3]], ring: &[u32], by: Weight) -> DVec2 {
    let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
    for &t in ring {
        let [a, b, c] = corners(points, triangles[t as usize]);
        let area = match by {
            Weight::Area => (b - a).perp_dot(c - a),
            Weight::Same => 1.0,
        };
        sum += area * (a + b + c) / 3.0;
        weight += area;
    }
    sum / weight
}

fn areas(points: &[DVec2], triangles: &[[VertexId; 3]], ring: &[u32]) -> Vec<f64> {
    ring.iter()
        .map(|&t| {
            let [a, b, c] = corners(points, triangles[t as usize]);
            (b - a).perp_dot(c - a)
        })
        .collect()
}
