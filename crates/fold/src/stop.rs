//! When solvers stop, who may stop them, and what they say of it.

use crate::goal::Scales;
use crate::objective::Objective;
use glam::DVec3;
use softfold_geometry::SolveRecord;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag by which whoever watches a solver ends it: a clock, a user. The solver then returns the best state so far with
/// `converged = false`. Clones share the flag.
#[derive(Clone, Debug, Default)]
pub struct Halt(Arc<AtomicBool>);

impl Halt {
    /// Ends the solver after the step at hand.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was set.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl PartialEq for Halt {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// How a stage ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stop {
    /// The relative gradient is below this.
    Gradient(f64),
    /// A whole step moves no vertex by this much, mm.
    Motion(f64),
    /// So many iterations are spent.
    Iterations(u32),
    /// The watcher said so.
    Halted,
    /// No step lowers the energy.
    NoDescent,
}

impl Stop {
    /// Whether it is at rest.
    pub(crate) fn is_converged(self) -> bool {
        matches!(self, Stop::Gradient(_) | Stop::Motion(_))
    }

    /// Whether time or iterations ran out.
    pub(crate) fn is_budget(self) -> bool {
        matches!(self, Stop::Iterations(_) | Stop::Halted)
    }

    /// For the record.
    fn words(self) -> String {
        match self {
            Stop::Gradient(relative) => format!("relative gradient below {relative:e}"),
            Stop::Motion(mm) => format!("no vertex moves by {mm:e} mm any more"),
            Stop::Iterations(most) => format!("budget of {most} iterations spent"),
            Stop::Halted => "stopped from outside: its time was spent".to_owned(),
            Stop::NoDescent => "no step lowers the energy any more".to_owned(),
        }
    }
}

/// The record of a solver that stopped at `x`. It is no error if no step lowers the energy where the gradient is as
/// small as asked for.
pub(crate) fn record(
    solver: &str,
    objective: &Objective<'_>,
    x: &[DVec3],
    (stop, iterations): (Stop, u32),
    (scales, floor): (Scales, f64),
) -> SolveRecord {
    SolveRecord {
        solver: solver.to_owned(),
        iterations,
        energy: objective.energy(x, scales),
        relative_gradient: objective.gradient(x, scales).relative(floor),
        converged: stop.is_converged(),
        stop: stop.words(),
        ..SolveRecord::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_of_a_halt_share_it_and_others_do_not() {
        let halt = Halt::default();
        let (same, other) = (halt.clone(), Halt::default());
        halt.set();
        assert!(same.is_set() && !other.is_set());
        assert!(halt == same && halt != other);
    }
}
