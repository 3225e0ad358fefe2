//! The paper's eq. 4 as printed: `P ← P + Σ w G / Σ w`, optionally with Kangaroo-like momentum.

use crate::Iteration;
use crate::goal::Scales;
use crate::objective::Objective;
use glam::DVec3;
use softfold_geometry::SolveRecord;

/// Options of eq. 4.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxOptions {
    /// Share of the last motion that goes on (0: eq. 4 alone); it is dropped when it goes against the moves,
    /// as Kangaroo does.
    pub momentum: f64,
    /// Stop when the relative gradient is below this.
    pub relative_gradient: f64,
    /// Most iterations.
    pub max_iterations: u32,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        Self { momentum: 0.99, relative_gradient: 1e-6, max_iterations: 50_000 }
    }
}

/// Iterations between two looks at the gradient: it costs as much as a step.
const LOOK_EVERY: u32 = 50;

/// Minimises the objective from `start`.
pub fn minimise(
    objective: &Objective<'_>,
    start: &[DVec3],
    options: &RelaxOptions,
    watch: &mut dyn FnMut(Iteration),
) -> (Vec<DVec3>, SolveRecord) {
    let mut x = start.to_vec();
    let mut velocity = vec![DVec3::ZERO; x.len()];
    let mut number = 0;
    let floor = objective.force_floor(start);
    let mut relative_gradient = objective.gradient(&x, Scales::FULL).relative(floor);
    while relative_gradient > options.relative_gradient && number < options.max_iterations {
        step(objective, options.momentum, &mut x, &mut velocity);
        number += 1;
        if number % LOOK_EVERY == 0 || number == options.max_iterations {
            relative_gradient = objective.gradient(&x, Scales::FULL).relative(floor);
            watch(Iteration { number, energy: objective.energy(&x, Scales::FULL), relative_gradient });
        }
    }
    let record = record(objective, &x, number, relative_gradient, options);
    (x, record)
}

fn step(objective: &Objective<'_>, momentum: f64, x: &mut [DVec3], velocity: &mut [DVec3]) {
    // Moves are taken where momentum has carried the points.
    for (x, v) in x.iter_mut().zip(velocity.iter_mut()) {
        *v *= momentum;
        *x += *v;
    }
    let (weighted, weights) = objective.moves(x);
    let moves: Vec<DVec3> =
        weighted.iter().zip(&weights).map(|(g, w)| if *w > 0.0 { *g / *w } else { DVec3::ZERO }).collect();
    let against: f64 = moves.iter().zip(velocity.iter()).map(|(m, v)| m.dot(*v)).sum();
    for ((x, v), m) in x.iter_mut().zip(velocity.iter_mut()).zip(moves) {
        *x += m;
        *v = if against < 0.0 { DVec3::ZERO } else { *v + m };
    }
}

fn record(
    objective: &Objective<'_>,
    x: &[DVec3],
    iterations: u32,
    relative_gradient: f64,
    options: &RelaxOptions,
) -> SolveRecord {
    let converged = relative_gradient <= options.relative_gradient;
    let stop = match converged {
        true => format!("relative gradient below {:e}", options.relative_gradient),
        false => format!("budget of {} iterations spent", options.max_iterations),
    };
    SolveRecord {
        solver: "relax".into(),
        iterations,
        energy: objective.energy(x, Scales::FULL),
        relative_gradient,
        converged,
        stop,
    }
}
