//! Evening out the flat cage: every vertex moves where the angles around it are nearest to right ones and lengths change
//! the least from quad to quad. Border vertices slide along the border, those on fold lines along these.

use super::quads::Quads;
use super::rails::{Hold, Rails};
use glam::DVec2;
use std::collections::BTreeMap;

/// Weight of right angles.
const RIGHT: f64 = 0.3;
/// Weight of lengths that change little from quad to quad.
const LENGTHS: f64 = 0.3;
/// Cosine of the angle that is good enough, 60°, and weight of what is above it: it comes first.
const GOOD_COS: f64 = 0.5;
const SHARP: f64 = 200.0;
/// Corners below this are worth moving their surroundings for, rad: 52°.
const POOR_RAD: f64 = 52.0 * std::f64::consts::PI / 180.0;
/// Rings of quads that move with a poor corner.
const RINGS: usize = 6;
/// Sine of an angle below which a corner counts as turned over.
const TURNED: f64 = 0.05;
/// What a turned corner costs at least: more than all good ones around a vertex.
const TURNED_COST: f64 = 1e3;
/// First step, share of the shortest edge around.
const FIRST_STEP: f64 = 0.25;
/// Steps below this share of it are no more looked at.
const LEAST_STEP: f64 = 2e-3;
/// Directions that a free vertex tries.
const DIRECTIONS: usize = 8;

/// What a vertex is judged by.
#[derive(Default)]
struct Star {
    /// Corner, next, last.
    corners: Vec<[u32; 3]>,
    /// Two edges whose lengths should agree.
    pairs: Vec<[u32; 4]>,
}

/// Moves the vertices around irregular ones and around poor corners, `rounds` times; the map has laid the others better.
pub(crate) fn smooth(quads: &mut Quads, rails: &mut Rails, rounds: usize, irregular: &[u32]) {
    let stars = stars(quads);
    let moving = moving(quads, irregular);
    let mut steps: Vec<f64> = (0..stars.len()).map(|v| FIRST_STEP * shortest(quads, &stars[v])).collect();
    let least: Vec<f64> = steps.iter().map(|s| LEAST_STEP / FIRST_STEP * s).collect();
    for _ in 0..rounds {
        let mut moved = false;
        for v in 0..stars.len() {
            if !moving[v] || steps[v] < least[v] || rails.holds[v] == Hold::Fixed {
                continue;
            }
            match improved(quads, rails, &stars[v], v, steps[v]) {
                Some((p, hold)) => {
                    (quads.points[v], rails.holds[v]) = (p, hold);
                    steps[v] *= 1.2;
                    moved = true;
                }
                None => {
                    steps[v] *= 0.5;
                    moved |= steps[v] >= least[v];
                }
            }
        }
        if !moved {
            break;
        }
    }
}

/// Vertices within some quads of an irregular vertex or a poor corner.
fn moving(quads: &Quads, irregular: &[u32]) -> Vec<bool> {
    let mut moving = vec![false; quads.points.len()];
    irregular.iter().for_each(|&v| moving[v as usize] = true);
    for q in 0..quads.quads.len() {
        for k in 0..4 {
            let angle = quads.angle(q, k);
            if !(POOR_RAD..=std::f64::consts::PI - 0.5 * POOR_RAD).contains(&angle) {
                moving[quads.quads[q][k] as usize] = true;
            }
        }
    }
    for _ in 0..RINGS {
        let reached = |q: &&[u32; 4]| q.iter().any(|&v| moving[v as usize]);
        let next: Vec<u32> = quads.quads.iter().filter(reached).flatten().copied().collect();
        next.into_iter().for_each(|v| moving[v as usize] = true);
    }
    moving
}

fn shortest(quads: &Quads, star: &Star) -> f64 {
    let at = |v: u32| quads.points[v as usize];
    star.corners
        .iter()
        .flat_map(|c| [at(c[0]).distance(at(c[1])), at(c[0]).distance(at(c[2]))])
        .fold(f64::MAX, f64::min)
}

/// The best of the places a step away, if it is better than here.
fn improved(quads: &mut Quads, rails: &Rails, star: &Star, v: usize, step: f64) -> Option<(DVec2, Hold)> {
    let here = quads.points[v];
    let mut best = (cost(quads, star), None);
    let mut try_place = |quads: &mut Quads, p: DVec2, hold: Hold| {
        quads.points[v] = p;
        let c = cost(quads, star);
        if c < best.0 - 1e-12 {
            best = (c, Some((p, hold)));
        }
    };
    match rails.holds[v] {
        Hold::Fixed => {}
        Hold::Free => {
            for k in 0..DIRECTIONS {
                let angle = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
                try_place(quads, here + step * DVec2::from_angle(angle), Hold::Free);
            }
        }
        Hold::On { rail, s_mm } => {
            for s_mm in [s_mm - step, s_mm + step] {
                try_place(quads, rails.rails[rail].at(s_mm), Hold::On { rail, s_mm });
            }
        }
    }
    quads.points[v] = here;
    best.1
}

fn cost(quads: &Quads, star: &Star) -> f64 {
    let at = |v: u32| quads.points[v as usize];
    let corner = |c: &[u32; 3]| {
        let (a, b) = (at(c[1]) - at(c[0]), at(c[2]) - at(c[0]));
        let (sine, cosine) = (a.perp_dot(b), a.dot(b));
        let size = (a.length_squared() * b.length_squared()).sqrt();
        let off = cosine.abs() / size.max(1e-300);
        match sine > TURNED * size {
            true => RIGHT * off * off + SHARP * (off - GOOD_COS).max(0.0).powi(2),
            false => TURNED_COST * (2.0 - sine / size.max(1e-300)),
        }
    };
    let pair = |p: &[u32; 4]| {
        let ratio = at(p[0]).distance_squared(at(p[1])) / at(p[2]).distance_squared(at(p[3])).max(1e-300);
        (0.5 * ratio.max(1e-12).ln()).powi(2)
    };
    star.corners.iter().map(corner).sum::<f64>() + LENGTHS * star.pairs.iter().map(pair).sum::<f64>()
}

fn stars(quads: &Quads) -> Vec<Star> {
    let mut stars: Vec<Star> = (0..quads.points.len()).map(|_| Star::default()).collect();
    for quad in &quads.quads {
        for k in 0..4 {
            let corner = [quad[k], quad[(k + 1) % 4], quad[(k + 3) % 4]];
            corner.iter().for_each(|&v| stars[v as usize].corners.push(corner));
        }
        for k in 0..2 {
            let pair = [quad[k], quad[k + 1], quad[(k + 3) % 4], quad[k + 2]];
            pair.iter().for_each(|&v| stars[v as usize].pairs.push(pair));
        }
    }
    for pair in straight_on(quads) {
        for v in [pair[0], pair[1], pair[3]] {
            stars[v as usize].pairs.push(pair);
        }
    }
    stars
}

/// Pairs of edges that go straight on through an inner vertex of valence 4: `[a, middle, middle, b]`.
fn straight_on(quads: &Quads) -> Vec<[u32; 4]> {
    // Around each vertex: from each neighbour the next one counter-clockwise.
    let mut next: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); quads.points.len()];
    for quad in &quads.quads {
        for k in 0..4 {
            next[quad[k] as usize].insert(quad[(k + 1) % 4], quad[(k + 3) % 4]);
        }
    }
    let mut pairs = Vec::new();
    for (v, next) in next.iter().enumerate().filter(|(_, n)| n.len() == 4) {
        for (&a, b) in next {
            let opposite = next.get(b).copied();
            if let Some(opposite) = opposite.filter(|o| *o > a) {
                pairs.push([a, v as u32, v as u32, opposite]);
            }
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_vertex_goes_back_to_the_middle() {
        let mut points: Vec<DVec2> = (0..9).map(|k| DVec2::new(f64::from(k / 3), f64::from(k % 3))).collect();
        points[4] += DVec2::new(0.6, -0.4);
        let at = |k: u32| [k, k + 3, k + 4, k + 1];
        let mut quads = Quads { points, quads: vec![at(0), at(1), at(3), at(4)] };
        let mut holds = vec![Hold::Fixed; 9];
        holds[4] = Hold::Free;
        smooth(&mut quads, &mut Rails { rails: Vec::new(), holds }, 100, &[4]);
        assert!(quads.points[4].distance(DVec2::ONE) < 0.01, "{}", quads.points[4]);
    }
}
