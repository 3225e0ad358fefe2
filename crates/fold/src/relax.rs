//! The paper's eq. 4 as printed: `P ← P + Σ w G / Σ w`, optionally with momentum.

use crate::Iteration;
use crate::goal::Scales;
use crate::objective::Objective;
use crate::stop::{Halt, Stop, record};
use glam::DVec3;
use softfold_geometry::SolveRecord;

/// What carries points on from one move to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Momentum {
    /// Share of the last motion that goes on (0: eq. 4 alone); it is dropped when it goes against the moves,
    /// as Kangaroo does.
    Share(f64),
    /// A share that grows with the steps since it was last dropped (Nesterov 1983), which happens when it goes against
    /// the motion (O'Donoghue & Candès 2015, gradient scheme).
    Nesterov,
}

/// Options of eq. 4.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxOptions {
    /// What carries points on.
    pub momentum: Momentum,
    /// Stop when the relative gradient is below this.
    pub relative_gradient: f64,
    /// Most iterations.
    pub max_iterations: u32,
    /// Ends it from outside.
    pub halt: Halt,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        Self {
            momentum: Momentum::Share(0.99),
            relative_gradient: 1e-6,
            max_iterations: 50_000,
            halt: Halt::default(),
        }
    }
}

/// Iterations between two looks at the gradient: it costs as much as a step.
const LOOK_EVERY: u32 = 50;

/// Points on their way.
struct Moving {
    x: Vec<DVec3>,
    velocity: Vec<DVec3>,
    /// Nesterov's weight; 1 after momentum was dropped.
    weight: f64,
}

/// Minimises the objective from `start`.
pub fn minimise(
    objective: &Objective<'_>,
    start: &[DVec3],
    options: &RelaxOptions,
    watch: &mut dyn FnMut(Iteration<'_>),
) -> (Vec<DVec3>, SolveRecord) {
    let mut moving = Moving::new(start);
    let mut number = 0;
    let floor = objective.force_floor(start);
    let mut relative_gradient = objective.gradient(&moving.x, Scales::FULL).relative(floor);
    let stop = loop {
        if relative_gradient <= options.relative_gradient {
            break Stop::Gradient(options.relative_gradient);
        }
        if number >= options.max_iterations {
            break Stop::Iterations(options.max_iterations);
        }
        if options.halt.is_set() {
            break Stop::Halted;
        }
        moving.step(objective, options.momentum);
        number += 1;
        if number % LOOK_EVERY == 0 || number == options.max_iterations {
            let (energy, positions) = (objective.energy(&moving.x, Scales::FULL), &moving.x);
            relative_gradient = objective.gradient(positions, Scales::FULL).relative(floor);
            watch(Iteration { number, level: 0, energy, relative_gradient, positions });
        }
    };
    let record = record("relax", objective, &moving.x, (stop, number), (Scales::FULL, floor));
    (moving.x, record)
}

/// A few moves that even out what is rough: eq. 4 evens out the finest wrinkles first, and long before it bends the sheet.
pub(crate) fn smoothed(
    objective: &Objective<'_>,
    rough: &[DVec3],
    moves: u32,
    momentum: Momentum,
) -> Vec<DVec3> {
    let mut moving = Moving::new(rough);
    (0..moves).for_each(|_| moving.step(objective, momentum));
    moving.x
}

impl Moving {
    fn new(start: &[DVec3]) -> Self {
        Self { x: start.to_vec(), velocity: vec![DVec3::ZERO; start.len()], weight: 1.0 }
    }

    fn step(&mut self, objective: &Objective<'_>, momentum: Momentum) {
        let next = 0.5 * (1.0 + (1.0 + 4.0 * self.weight * self.weight).sqrt());
        let share = match momentum {
            Momentum::Share(share) => share,
            Momentum::Nesterov => (self.weight - 1.0) / next,
        };
        // Moves are taken where momentum has carried the points.
        self.velocity.iter_mut().for_each(|v| *v *= share);
        go(objective, &mut self.x, &mut self.velocity);
        let (weighted, weights) = objective.moves(&self.x);
        let mut moves: Vec<DVec3> = weighted
            .iter()
            .zip(&weights)
            .map(|(g, w)| if *w > 0.0 { *g / *w } else { DVec3::ZERO })
            .collect();
        let motion = |m: DVec3, v: DVec3| match momentum {
            Momentum::Share(_) => v,
            Momentum::Nesterov => v + m,
        };
        let against: f64 = moves.iter().zip(&self.velocity).map(|(m, v)| m.dot(motion(*m, *v))).sum();
        go(objective, &mut self.x, &mut moves);
        for (v, m) in self.velocity.iter_mut().zip(moves) {
            *v = if against < 0.0 { DVec3::ZERO } else { *v + m };
        }
        self.weight = if against < 0.0 { 1.0 } else { next };
    }
}

/// Moves the points as far as no barrier forbids, and shortens the motion to that.
fn go(objective: &Objective<'_>, x: &mut [DVec3], motion: &mut [DVec3]) {
    let share = objective.largest_step(x, motion);
    for (x, m) in x.iter_mut().zip(motion) {
        *m *= share;
        *x += *m;
    }
}
