//! The few triangles that relaxation leaves with a small angle: their free corners move to where the smallest angle
//! around them is largest.

use crate::rings::Rings;
use glam::DVec2;
use softfold_geometry::VertexId;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Angles below this are mended, degrees: a little more than the 20° that meshes shall have, so that a bad corner does
/// not stop right at it.
const SMALL_DEG: f64 = 22.0;
/// Rounds of moves and triangulation. Most triangles need one, and some cannot be mended.
pub(crate) const ROUNDS: u32 = 6;
/// Directions tried around a point.
const DIRECTIONS: u32 = 8;
/// First step, share of the mean distance to the neighbours, and how often it is halved.
const FIRST_STEP: f64 = 0.25;
const HALVINGS: u32 = 5;
/// Steps in all: moves that get ever better end in fewer.
const STEPS: u32 = 40;

/// Moves points from number `held` on at triangles with small angles; whether any moved.
pub(crate) fn round(points: &mut [DVec2], held: usize, triangles: &[[VertexId; 3]]) -> bool {
    let small = SMALL_DEG.to_radians();
    let is_small = |t: &&[VertexId; 3]| least_angle_rad(t.map(|v| points[v.index()])) < small;
    let corners: BTreeSet<usize> = triangles.iter().filter(is_small).flatten().map(|v| v.index()).collect();
    if corners.is_empty() {
        return false;
    }
    let rings = Rings::new(points.len(), triangles);
    let mut moved = false;
    for v in corners.into_iter().filter(|v| *v >= held) {
        let ring: Vec<[VertexId; 3]> = rings.of(v).iter().map(|&t| triangles[t as usize]).collect();
        let best = best_place(points, v, &ring);
        moved |= best != points[v];
        points[v] = best;
    }
    moved
}

/// Where the smallest angle of the triangles around a point is largest, by a search in shrinking steps.
fn best_place(points: &[DVec2], v: usize, ring: &[[VertexId; 3]]) -> DVec2 {
    let worth = |p: DVec2| {
        let at = |w: VertexId| if w.index() == v { p } else { points[w.index()] };
        ring.iter().map(|t| least_angle_rad(t.map(at))).fold(f64::MAX, f64::min)
    };
    let mut place = points[v];
    let mut best = worth(place);
    let far: f64 = ring.iter().flatten().map(|w| points[w.index()].distance(place)).sum();
    let mut step = FIRST_STEP * far / (2 * ring.len().max(1)) as f64;
    let mut halvings = 0;
    for _ in 0..STEPS {
        let tried = (0..DIRECTIONS).map(|k| {
            let p = place + step * DVec2::from_angle(TAU * f64::from(k) / f64::from(DIRECTIONS));
            (worth(p), p)
        });
        match tried.reduce(|a, b| if b.0 > a.0 { b } else { a }) {
            Some((better, p)) if better > best => (best, place) = (better, p),
            _ if halvings == HALVINGS => break,
            _ => {
                step *= 0.5;
                halvings += 1;
            }
        }
    }
    place
}

/// Smallest angle of a triangle; negative if it is turned over.
fn least_angle_rad(p: [DVec2; 3]) -> f64 {
    let angle = |k: usize| {
        let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
        a.perp_dot(b).atan2(a.dot(b))
    };
    angle(0).min(angle(1)).min(angle(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_near_a_side_of_its_hexagon_moves_to_the_middle() {
        let mut points: Vec<DVec2> = (0..6).map(|k| DVec2::from_angle(f64::from(k) * TAU / 6.0)).collect();
        points.push(DVec2::new(0.0, -0.8));
        let triangles: Vec<[VertexId; 3]> = (0..6).map(|k| [6, k, (k + 1) % 6].map(VertexId::new)).collect();
        let (mut held, before) = (points.clone(), points.clone());
        assert!(!round(&mut held, 7, &triangles));
        assert_eq!(held, before);
        assert!(round(&mut points, 6, &triangles));
        assert!(points[6].length() < 0.1, "{}", points[6]);
        assert!(!round(&mut points, 6, &triangles), "nothing small is left");
    }
}
