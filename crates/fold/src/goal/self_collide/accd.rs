//! How far a pair may go along a step before it comes too near: additive continuous collision detection.
//!
//! Source: Li, Kaufman & Jiang, *Codimensional Incremental Potential Contact* (2021), algorithm 1: the corners go on by
//! what the distance that is left surely allows, again and again, until nine tenths of the first gap are used.

use super::pair::Pair;
use glam::DVec3;

/// Share of the gap that a step leaves.
const KEPT: f64 = 0.1;
/// Advances before a pair that hardly comes nearer is stopped where it is: that is safe, only shorter.
const MAX_ADVANCES: u32 = 400;

/// How fast two elements can approach each other along a step, mm per step: the largest motions of both against their
/// common mean.
pub(super) fn approach_mm(pair: &Pair, step: &[DVec3]) -> f64 {
    let d = pair.corners.map(|v| step[v as usize]);
    let mean = 0.25 * d.into_iter().sum::<DVec3>();
    let largest = |range: std::ops::Range<usize>| {
        d[range].iter().map(|d| (*d - mean).length_squared()).fold(0.0, f64::max).sqrt()
    };
    let first = pair.first_corners();
    largest(0..first) + largest(first..4)
}

/// The largest share of `step`, up to `most`, that surely keeps a pair further apart than its least distance.
pub(super) fn admissible(pair: &Pair, x: &[DVec3], step: &[DVec3], most: f64) -> f64 {
    let speed = approach_mm(pair, step);
    let least = pair.gap.least_mm;
    let d = pair.corners.map(|v| step[v as usize]);
    let mean = 0.25 * d.into_iter().sum::<DVec3>();
    let start = pair.places(x);
    let room_at = |t: f64| {
        let places = [0, 1, 2, 3].map(|i| start[i] + t * (d[i] - mean));
        pair.closest(&places).squared_mm2().sqrt() - least
    };
    let room = room_at(0.0);
    if room.is_nan() || room <= 0.0 {
        return 0.0;
    }
    let mut t = 0.0;
    let mut left = room;
    for _ in 0..MAX_ADVANCES {
        let advance = (1.0 - KEPT) * left / speed;
        if t + advance >= most {
            return most;
        }
        let further = t + advance;
        left = room_at(further);
        if left.is_nan() || left <= KEPT * room {
            // The last place that is known to be far enough; the first advance always is.
            return if t == 0.0 { advance } else { t };
        }
        t = further;
    }
    t
}
