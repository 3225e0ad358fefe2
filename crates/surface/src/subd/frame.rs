//! The direction of the rows at every vertex: along or across the bands, as even as it can be between them.

use super::background::{Background, Chain};
use super::sparse::Normal;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Weight of a band's direction against the evenness of an edge: the bands are followed, not asked.
const BAND_WEIGHT: f64 = 100.0;
/// Weight of the border's direction: it is heard, but must not bend the rows at the bands.
const BORDER_WEIGHT: f64 = 0.2;
/// Keeps the equations regular where nothing is asked.
const REST_WEIGHT: f64 = 1e-9;
/// Holes beyond this many are taken as they are: rows pass them by.
const MOST_TURNING_HOLES: usize = 6;

/// A direction per vertex.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// Angle of the first axis at each vertex, rad, but for `turns`.
    theta: Vec<f64>,
    /// How often the frame turns around each hole.
    turns: Vec<f64>,
    /// For each chain, by how many quarters it is turned against the first axis, 0 to 3.
    pub(crate) quarters: Vec<i64>,
    /// How uneven it is.
    energy: f64,
}

/// What fixes the angle of a vertex.
struct Pin {
    vertex: usize,
    theta: f64,
    weight: f64,
}

impl Frame {
    /// The frame of the bands alone; around each hole it turns as often as makes it most even.
    ///
    /// # Errors
    /// The solver's words.
    pub(crate) fn of_bands(ground: &Background<'_>) -> Result<Self, String> {
        let holes = ground.hole_centres.len();
        let mut best = Self::with_turns(ground, vec![0.0; holes])?;
        for hole in 0..holes.min(MOST_TURNING_HOLES) {
            let mut turns = best.turns.clone();
            turns[hole] = 1.0;
            let other = Self::with_turns(ground, turns)?;
            if other.energy < best.energy {
                best = other;
            }
        }
        Ok(best)
    }

    fn with_turns(ground: &Background<'_>, turns: Vec<f64>) -> Result<Self, String> {
        let n = ground.mesh.vertices.len();
        let first = outline_angle(ground);
        let mut frame =
            Self { theta: vec![first; n], turns, quarters: vec![0; ground.chains.len()], energy: 0.0 };
        let mut pins: Vec<Pin> = Vec::new();
        let mut order: Vec<usize> = (0..ground.chains.len()).collect();
        let size = |c: &usize| ground.chains[*c].vertices.len();
        order.sort_by_key(|c| (std::cmp::Reverse(size(c)), *c));
        let mut waiting = order;
        let mut is_first = true;
        while let Some(&lead) = waiting.first() {
            let crease = ground.chains[lead].crease;
            let (mut own, rest): (Vec<_>, Vec<_>) =
                waiting.into_iter().partition(|&c| ground.chains[c].crease == crease);
            waiting = rest;
            // The leading chain first, so that the other lines of the band follow it.
            let others = own.split_off(1);
            for group in [own, others] {
                for &c in &group {
                    frame.pin_chain(ground, c, &mut pins, is_first);
                }
                if !group.is_empty() {
                    frame.solve(ground, &pins)?;
                }
                is_first = false;
            }
        }
        if pins.is_empty() {
            frame.energy = frame.unevenness(ground);
        }
        Ok(frame)
    }

    /// The same with the border heard: `targets` gives the angle that the first axis should have on border edges.
    ///
    /// # Errors
    /// The solver's words.
    pub(crate) fn with_border(
        &self,
        ground: &Background<'_>,
        targets: &[([usize; 2], f64)],
    ) -> Result<Self, String> {
        let mut pins = Vec::new();
        let mut frame = self.clone();
        for c in 0..ground.chains.len() {
            frame.pin_chain(ground, c, &mut pins, false);
        }
        for &(edge, angle) in targets {
            for vertex in edge {
                let now = self.angle_at(ground, vertex);
                let off = (angle - now + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
                pins.push(Pin { vertex, theta: self.theta[vertex] + off, weight: 0.5 * BORDER_WEIGHT });
            }
        }
        if !pins.is_empty() {
            frame.solve(ground, &pins)?;
        }
        Ok(frame)
    }

    /// Angle of the first axis at a vertex, up to full turns.
    pub(crate) fn angle_at(&self, ground: &Background<'_>, vertex: usize) -> f64 {
        let p = ground.mesh.vertices[vertex];
        let turned = self.turns.iter().enumerate().filter(|t| *t.1 != 0.0);
        self.theta[vertex] + turned.map(|(h, w)| w * ground.angle(h, p)).sum::<f64>()
    }

    /// First axis in a triangle.
    pub(crate) fn axis(&self, ground: &Background<'_>, triangle: usize) -> DVec2 {
        let sum: DVec2 =
            ground.corners(triangle).map(|v| DVec2::from_angle(self.angle_at(ground, v))).iter().sum();
        sum.try_normalize().unwrap_or(DVec2::X)
    }

    /// Pins a chain to the quarter that it is nearest to, the first one as it is.
    fn pin_chain(&mut self, ground: &Background<'_>, c: usize, pins: &mut Vec<Pin>, is_first: bool) {
        let chain = &ground.chains[c];
        let mut wanted = tangents(ground, chain);
        for (hole, &turns) in self.turns.iter().enumerate().filter(|t| *t.1 != 0.0) {
            for (w, a) in wanted.iter_mut().zip(ground.angles_along(hole, &chain.vertices)) {
                *w -= turns * a;
            }
        }
        let off: f64 = chain.vertices.iter().zip(&wanted).map(|(&v, w)| self.theta[v] - w).sum();
        let quarters = match is_first {
            true => 0.0,
            false => (off / wanted.len() as f64 / FRAC_PI_2).round(),
        };
        self.quarters[c] = (-quarters as i64).rem_euclid(4);
        let pin = |(&vertex, w): (&usize, f64)| Pin {
            vertex,
            theta: w + quarters * FRAC_PI_2,
            weight: BAND_WEIGHT,
        };
        pins.extend(chain.vertices.iter().zip(wanted).map(pin));
    }

    fn solve(&mut self, ground: &Background<'_>, pins: &[Pin]) -> Result<(), String> {
        let mut normal = Normal::new(self.theta.len());
        for e in &ground.mesh.edges {
            let [a, b] = e.vertices.map(|v| v.index());
            normal.add_scalar(&[(a, -1.0), (b, 1.0)], -self.turned(ground, a, b), 1.0);
        }
        for pin in pins {
            normal.add_scalar(&[(pin.vertex, 1.0)], pin.theta, pin.weight);
        }
        (0..self.theta.len()).for_each(|v| normal.add_scalar(&[(v, 1.0)], self.theta[v], REST_WEIGHT));
        self.theta = normal.solve_scalar()?;
        let missed = |p: &Pin| p.weight * (self.theta[p.vertex] - p.theta).powi(2);
        self.energy = self.unevenness(ground) + pins.iter().map(missed).sum::<f64>();
        Ok(())
    }

    fn unevenness(&self, ground: &Background<'_>) -> f64 {
        let term = |e: &softfold_geometry::Edge| {
            let [a, b] = e.vertices.map(|v| v.index());
            (self.theta[b] - self.theta[a] + self.turned(ground, a, b)).powi(2)
        };
        ground.mesh.edges.iter().map(term).sum()
    }

    /// What the turning around holes adds from one vertex to the next.
    fn turned(&self, ground: &Background<'_>, a: usize, b: usize) -> f64 {
        let [p, q] = [a, b].map(|v| ground.mesh.vertices[v]);
        let by = |(h, w): (usize, &f64)| if *w == 0.0 { 0.0 } else { w * ground.swept(h, p, q) };
        self.turns.iter().enumerate().map(by).sum()
    }
}

/// Directions along a chain at its vertices, rad, without jumps.
fn tangents(ground: &Background<'_>, chain: &Chain) -> Vec<f64> {
    let n = chain.vertices.len();
    let at = |k: usize| ground.mesh.vertices[chain.vertices[k]];
    let direction = |k: usize| match (chain.closed, k) {
        (true, _) => at((k + 1) % n) - at((k + n - 1) % n),
        (false, 0) => at(1) - at(0),
        (false, k) if k + 1 == n => at(k) - at(k - 1),
        _ => at(k + 1) - at(k - 1),
    };
    let mut angles = vec![direction(0).to_angle()];
    for k in 1..n {
        angles.push(angles[k - 1] + direction(k - 1).angle_to(direction(k)));
    }
    angles
}

/// The direction that most of the outline runs along or across, rad.
fn outline_angle(ground: &Background<'_>) -> f64 {
    let Some(outline) = ground.loops.first() else { return 0.0 };
    let at = |k: usize| ground.mesh.vertices[outline[k % outline.len()]];
    let fourfold = |k: usize| {
        let d = at(k + 1) - at(k);
        d.length() * DVec2::from_angle(4.0 * d.to_angle())
    };
    let sum: DVec2 = (0..outline.len()).map(fourfold).sum();
    if sum.length() > 0.0 { 0.25 * sum.to_angle() } else { 0.0 }
}
