//! Solvers side by side: CPU seconds, on one thread, from flat to within 1 mm rms of the converged shape.
//!
//! That has two readings, and every ratio is printed in both: the *first* time that a state on the mesh itself is that near,
//! which for the multilevel solver may be what coarser meshes gave it, evened out by a few moves of eq. 4; and the time when
//! a Newton *step* on the mesh itself has brought it near. The second can never be better than the number of factorisations
//! that the other solver needs: one is spent on the finest matrix. Coarse meshes are made outside of the timed part.
//!
//! `cargo bench -p softfold --bench fold -- [cap=SECONDS] [only=NAME] [momentum=SHARE] [memory]`: `only` takes the cases whose
//! names begin so, as `only="S 2000"`; eq. 4 is stopped at the cap (40 s each if none is given; 0 leaves it out), then its ratio is a
//! lower bound, and the table says how far off it was; `momentum` is then the only one tried, and Nesterov's is left out. `memory` adds the run of 200,000
//! vertices. Shapes are compared outside of the timed part, after each iteration.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a benchmark may stop at the first surprise, and prints its table"
)]

#[path = "fold/cases.rs"]
mod cases;
#[path = "fold/measure.rs"]
mod measure;

use cases::{Case, NEAR_MM, SIZES, Sheet, sculpture};
use measure::{cpu_seconds, peak_gb, rms_mm};
use softfold_fold::{
    Halt, Iteration, Momentum, NewtonOptions, Pyramid, RelaxOptions, Session, Solver, fold, fold_multilevel,
};
use softfold_geometry::{DVec3, EdgeClass, FoldedSheet, SolveRecord};

/// Momenta that eq. 4 is tried with; the best one counts.
const MOMENTA: [f64; 5] = [0.99, 0.995, 0.998, 0.999, 0.9995];
/// Eq. 4 is stopped after so many seconds if nothing else is said.
const CAP_S: f64 = 40.0;

/// A solver's way to the shape.
struct Run {
    /// CPU seconds until it was near by a step on its own mesh, or until it was stopped.
    seconds: f64,
    /// CPU seconds until it was near at all, or until it was stopped.
    first_s: f64,
    /// What coarser meshes gave it to begin with: CPU seconds until then, and how near that was, mm.
    carried: Option<(f64, f64)>,
    /// How near the last iteration was, mm.
    rms_mm: f64,
    record: SolveRecord,
}

/// Takes the time between iterations, and ends a solver that is near or late.
struct Stopwatch<'a> {
    reference: &'a [DVec3],
    halt: Halt,
    cap_s: f64,
    since: f64,
    run_s: f64,
    rms_mm: f64,
    /// Number of the last iteration.
    number: u32,
    carried: Option<(f64, f64)>,
    first_s: Option<f64>,
    log: bool,
}

impl Stopwatch<'_> {
    fn look(&mut self, i: Iteration<'_>) {
        self.run_s += cpu_seconds() - self.since;
        if i.level == 0 {
            self.rms_mm = rms_mm(i.positions, self.reference);
            let stepped = i.number > self.number;
            if !stepped {
                self.carried = Some((self.run_s, self.rms_mm));
            }
            if self.rms_mm < NEAR_MM {
                self.first_s = self.first_s.or(Some(self.run_s));
            }
            if stepped && self.rms_mm < NEAR_MM || self.run_s > self.cap_s {
                self.halt.set();
            }
        }
        self.number = i.number;
        if self.log {
            println!(
                "    {:>3} level {} energy {:.9e} gradient {:.1e} rms {:.4} mm  {:.3} s",
                i.number, i.level, i.energy, i.relative_gradient, self.rms_mm, self.run_s
            );
        }
        self.since = cpu_seconds();
    }
}

fn timed(
    case: &Case,
    reference: &[DVec3],
    cap_s: f64,
    solve: impl FnOnce(&Case, Halt, &mut dyn FnMut(Iteration<'_>)) -> FoldedSheet,
) -> Run {
    let halt = Halt::default();
    let log = std::env::var_os("LOG").is_some();
    let mut watch = Stopwatch {
        reference,
        halt: halt.clone(),
        cap_s,
        since: cpu_seconds(),
        run_s: 0.0,
        rms_mm: rms_mm(&case.start, reference),
        number: 0,
        carried: None,
        first_s: None,
        log,
    };
    let sheet = solve(case, halt, &mut |i| watch.look(i));
    let first_s = watch.first_s.unwrap_or(watch.run_s);
    Run { seconds: watch.run_s, first_s, carried: watch.carried, rms_mm: watch.rms_mm, record: sheet.solve }
}

fn multilevel(case: &Case, options: NewtonOptions, watch: &mut dyn FnMut(Iteration<'_>)) -> FoldedSheet {
    let fold = |pyramid: &Pyramid<'_>| {
        fold_multilevel(pyramid, &case.mesh, &case.goals, &case.start, &options, watch).expect("a fold")
    };
    case.with_pyramid(fold)
}

fn solved(case: &Case, solver: &Solver, watch: &mut dyn FnMut(Iteration<'_>)) -> FoldedSheet {
    fold(&case.mesh, &case.goals, &case.start, solver, watch).expect("a fold")
}

fn eq_4(case: &Case, reference: &[DVec3], cap_s: f64, momentum: Momentum) -> Run {
    timed(case, reference, cap_s, |case, halt, watch| {
        let options = RelaxOptions { momentum, relative_gradient: 0.0, max_iterations: u32::MAX, halt };
        solved(case, &Solver::Relax(options), watch)
    })
}

/// What is asked for on the command line.
struct Asked {
    cap_s: f64,
    only: Option<String>,
    momentum: Option<f64>,
    memory: bool,
}

impl Asked {
    fn read() -> Self {
        let mut asked = Self { cap_s: CAP_S, only: None, momentum: None, memory: false };
        for word in std::env::args().skip(1) {
            match word.split_once('=') {
                Some(("cap", s)) => asked.cap_s = s.parse().expect("cap=SECONDS"),
                Some(("momentum", share)) => asked.momentum = Some(share.parse().expect("momentum=SHARE")),
                Some(("only", name)) => asked.only = Some(name.to_owned()),
                _ => asked.memory |= word == "memory",
            }
        }
        asked
    }

    fn wants(&self, name: &str) -> bool {
        self.only.as_ref().is_none_or(|only| name.starts_with(only.as_str()))
    }
}

fn row(case: &Case, method: &str, run: &Run, best: &Run) {
    let near = run.rms_mm < NEAR_MM;
    let (sign, off) = if near { ("", String::new()) } else { (">", format!("  {:.0} mm off", run.rms_mm)) };
    println!(
        "{:<12} {method:<24} {:>8} {:>6} {sign:>1}{:>8.3} s {sign:>1}{:>8.1} {sign:>1}{:>8.1}{off}",
        case.name,
        run.record.iterations,
        run.record.factorisations,
        run.seconds,
        run.first_s / best.first_s,
        run.seconds / best.seconds
    );
}

/// Folds to the very end; the benchmark's reference and its figures.
fn reference(case: &Case) -> FoldedSheet {
    let began = cpu_seconds();
    let mut tell = |i: Iteration<'_>| {
        if std::env::var_os("LOG").is_some() {
            println!(
                "    {:>3} level {} energy {:.9e} gradient {:.1e}",
                i.number, i.level, i.energy, i.relative_gradient
            );
        }
    };
    let sheet = multilevel(case, NewtonOptions::default(), &mut tell);
    let seconds = cpu_seconds() - began;
    println!(
        "{:<12} {} vertices, whole solve {seconds:.3} s, {} factorisations of the finest matrix, energy {:.9e}, gradient {:.1e}: {}",
        case.name,
        case.mesh.vertices.len(),
        sheet.solve.factorisations,
        sheet.solve.energy,
        sheet.solve.relative_gradient,
        sheet.solve.stop
    );
    for l in &sheet.solve.levels {
        println!(
            "             {:>7} vertices: {:>3} iterations, {:>3} factorisations, energy {:.6e}",
            l.vertices, l.iterations, l.factorisations, l.energy
        );
    }
    sheet
}

/// Updates in a row, each by this share of the fold angles.
const SLIDER: [f64; 3] = [1.05, 1.10, 1.05];
/// A slider's update is done when no vertex moves by this, mm: a hundredth of what counts as the same shape.
const SLIDER_MOTION_MM: f64 = 0.01;

/// What it costs to follow a slider.
fn slider(case: &Case, sheet: &FoldedSheet) {
    let Some(elastic) = &case.elastic else { return };
    let options = NewtonOptions { motion_mm: SLIDER_MOTION_MM, ..NewtonOptions::default() };
    let mut session = Session::new(sheet, &case.goals, options).expect("a session");
    for share in SLIDER {
        let mut mesh = sheet.mesh.clone();
        for e in &mut mesh.edges {
            if let EdgeClass::Fold { turn_rad, .. } = &mut e.class {
                *turn_rad *= share;
            }
        }
        let goals = elastic.goals(&mesh);
        let began = cpu_seconds();
        let moved = session.update(&goals, &mut |_| ()).expect("a fold");
        println!(
            "{:<12} slider at {:>3.0} %{:>26} {:>6}  {:>8.3} s  {}",
            case.name,
            100.0 * share,
            moved.solve.iterations,
            moved.solve.factorisations,
            cpu_seconds() - began,
            moved.solve.stop
        );
    }
}

/// Momentum of eq. 4 that was best on the smallest mesh of a sheet.
type Best = Option<f64>;

fn bench(case: &Case, asked: &Asked, best: &mut Best) {
    let sheet = reference(case);
    let target = &sheet.positions;
    let levels = timed(case, target, f64::INFINITY, |case, halt, watch| {
        multilevel(case, NewtonOptions { halt, ..NewtonOptions::default() }, watch)
    });
    row(case, "multilevel Newton", &levels, &levels);
    if let Some((seconds, rms_mm)) = levels.carried {
        println!("{:<12}   before a step on it {:>25.3} s  {rms_mm:.2} mm off", case.name, seconds);
    }
    let meshes: Vec<String> = sheet.solve.levels.iter().map(|l| l.vertices.to_string()).collect();
    println!("{:<12}   first near {:>34.3} s  meshes {}", case.name, levels.first_s, meshes.join(", "));
    let one = timed(case, target, f64::INFINITY, |case, halt, watch| {
        solved(case, &Solver::Newton(NewtonOptions { halt, ..NewtonOptions::default() }), watch)
    });
    row(case, "one-level Newton", &one, &levels);
    if one.rms_mm >= NEAR_MM {
        println!("             one level ends at another shape: energy {:.9e}", one.record.energy);
    }
    slider(case, &sheet);
    if asked.cap_s > 0.0 {
        if asked.momentum.is_none() {
            row(case, "eq. 4, Nesterov", &eq_4(case, target, asked.cap_s, Momentum::Nesterov), &levels);
        }
        let momenta = asked.momentum.or(*best).map_or(MOMENTA.to_vec(), |m| vec![m]);
        let mut cap_s = asked.cap_s;
        for momentum in momenta {
            let run = eq_4(case, target, cap_s, Momentum::Share(momentum));
            row(case, &format!("eq. 4, momentum {momentum}"), &run, &levels);
            if run.rms_mm < NEAR_MM {
                (cap_s, *best) = (run.seconds, Some(momentum));
            }
        }
    }
}

fn main() {
    let asked = Asked::read();
    println!("case         method                 iterations factor.  seconds     first      step (ratios)");
    for sheet in [Sheet::arc(), Sheet::s()] {
        let mut best = None;
        let most = if asked.memory { SIZES.len() } else { SIZES.len() - 1 };
        for size in 1..most {
            let name = format!("{} {}", sheet.name, SIZES[size].0);
            if !asked.wants(&name) {
                continue;
            }
            let case = sheet.case(size);
            if size == SIZES.len() - 1 {
                reference(&case);
                println!("             peak memory {:.2} GB", peak_gb());
            } else {
                bench(&case, &asked, &mut best);
            }
        }
    }
    if asked.wants("sculpture") {
        bench(&sculpture(), &asked, &mut None);
    }
}
