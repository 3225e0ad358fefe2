//! The few triangles that relaxation leaves with a small angle: their free corners move to where the smallest angle
//! around them is largest.

use crate::net::Net;
use glam::DVec2;
use std::f64::consts::TAU;

/// Angles below this are mended, degrees: a little more than the 20° that meshes shall have, so that a bad corner does
/// not stop right at it.
const SMALL_DEG: f64 = 22.0;
/// Rounds of moves and triangulation. Most triangles need one, and some cannot be mended.
const ROUNDS: u32 = 6;
/// Directions tried around a point.
const DIRECTIONS: u32 = 8;
/// First step, share of the mean distance to the neighbours, and how often it is halved.
const FIRST_STEP: f64 = 0.25;
const HALVINGS: u32 = 5;
/// Steps in all: moves that get ever better end in fewer.
const STEPS: u32 = 40;

/// Moves points from number `held` on at triangles with small angles, and flips until all is Delaunay again.
pub(crate) fn mend(points: &mut [DVec2], held: usize, net: &mut Net) {
    for _ in 0..ROUNDS {
        if !round(points, held, net) {
            break;
        }
        net.flip_to_delaunay(points, held);
    }
}

/// One round; whether any moved.
fn round(points: &mut [DVec2], held: usize, net: &Net) -> bool {
    let most = SMALL_DEG.to_radians().cos();
    let is_small = |t: &&[u32; 3]| greatest_cosine(t.map(|v| points[v as usize])) > most;
    let mut corners: Vec<u32> = net.corners().iter().filter(is_small).flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let mut moved = false;
    let mut ring = Vec::new();
    for v in corners.into_iter().map(|v| v as usize).filter(|v| *v >= held) {
        if !net.ring(v, &mut ring) {
            continue;
        }
        let around: Vec<DVec2> = ring.iter().map(|&n| points[n as usize]).collect();
        let best = best_place(points[v], &around);
        moved |= best != points[v];
        points[v] = best;
    }
    moved
}

/// Where the smallest angle of the triangles between a point and its neighbours is largest, by a search in shrinking
/// steps.
fn best_place(from: DVec2, around: &[DVec2]) -> DVec2 {
    let mut place = from;
    let mut best = ring_cosine(place, around, f64::MAX);
    let far: f64 = around.iter().map(|p| p.distance(place)).sum();
    let mut step = FIRST_STEP * far / around.len().max(1) as f64;
    let mut halvings = 0;
    for _ in 0..STEPS {
        let mut found = None;
        for k in 0..DIRECTIONS {
            let p = place + step * DVec2::from_angle(TAU * f64::from(k) / f64::from(DIRECTIONS));
            let cosine = ring_cosine(p, around, best);
            if cosine < best {
                (best, found) = (cosine, Some(p));
            }
        }
        match found {
            Some(p) => place = p,
            None if halvings == HALVINGS => break,
            None => {
                step *= 0.5;
                halvings += 1;
            }
        }
    }
    place
}

/// Cosine of the smallest angle of the triangles between a point and its neighbours; anything above `enough` if it is
/// not below that.
fn ring_cosine(p: DVec2, around: &[DVec2], enough: f64) -> f64 {
    let mut greatest = -1.0_f64;
    for (k, &a) in around.iter().enumerate() {
        greatest = greatest.max(greatest_cosine([p, a, around[(k + 1) % around.len()]]));
        if greatest >= enough {
            return f64::MAX;
        }
    }
    greatest
}

/// Cosine of the smallest angle of a triangle; above 1 if it is turned over.
fn greatest_cosine([a, b, c]: [DVec2; 3]) -> f64 {
    let sides = [b - a, c - b, a - c];
    if sides[0].perp_dot(sides[1]) <= 0.0 {
        return f64::MAX;
    }
    let lengths = sides.map(DVec2::length);
    let cosine = |k: usize| -sides[k].dot(sides[(k + 2) % 3]) / (lengths[k] * lengths[(k + 2) % 3]);
    cosine(0).max(cosine(1)).max(cosine(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use softfold_geometry::VertexId;

    #[test]
    fn a_point_near_a_side_of_its_hexagon_moves_to_the_middle() {
        let mut points: Vec<DVec2> = (0..6).map(|k| DVec2::from_angle(f64::from(k) * TAU / 6.0)).collect();
        points.push(DVec2::new(0.0, -0.8));
        let triangles: Vec<[VertexId; 3]> = (0..6).map(|k| [6, k, (k + 1) % 6].map(VertexId::new)).collect();
        let (net, _) = Net::new(7, &triangles);
        let (mut held, before) = (points.clone(), points.clone());
        assert!(!round(&mut held, 7, &net));
        assert_eq!(held, before);
        assert!(round(&mut points, 6, &net));
        assert!(points[6].length() < 0.1, "{}", points[6]);
        assert!(!round(&mut points, 6, &net), "nothing small is left");
    }
}
