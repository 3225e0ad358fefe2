//! Both solvers against closed forms and against each other.

use crate::goal::{Anchor, ClampLength, Goal, OnPlane};
use crate::testing::folded_strip;
use crate::{
    LbfgsOptions, Momentum, NewtonOptions, RelaxOptions, SheetMaterial, SheetPoint, Solver, fold, upright,
};
use glam::DVec3;
use softfold_geometry::{EdgeClass, FlatMesh, FoldedSheet};

const MATERIAL: SheetMaterial = SheetMaterial {
    youngs_modulus_mpa: 10.0, // soft against what holds it, or eq. 4 would need millions of steps
    poisson_ratio: 0.3,
    thickness_mm: 4.0,
    fold_line_factor: 10.0,
};
/// A soft fold of 80° in four strips: half turns at the outer lines.
const FOLD_RAD: f64 = 80.0 * std::f64::consts::PI / 180.0;

/// Twelve columns of 5 mm; the fold's five lines are columns 4 to 8.
fn soft_fold() -> FlatMesh {
    folded_strip(12, 6, 5.0, |column| match column {
        4 | 8 => FOLD_RAD / 8.0,
        5..=7 => FOLD_RAD / 4.0,
        _ => 0.0,
    })
}

fn run(mesh: &FlatMesh, goals: &[Box<dyn Goal>], start: &[DVec3], solver: &Solver) -> FoldedSheet {
    fold(mesh, goals, start, solver, &mut |_| ()).unwrap()
}

/// A repeatable disturbance of every vertex, at most `size` each way.
fn shaken(start: &[DVec3], size: f64) -> Vec<DVec3> {
    let noise = |k: f64| (12.9898 * k).sin() * 43758.5453 % 1.0;
    let shake = |i: usize| DVec3::new(noise(i as f64), noise(i as f64 + 0.3), noise(i as f64 + 0.7));
    start.iter().enumerate().map(|(i, p)| *p + size * shake(i)).collect()
}

/// An isometric fold: every rest length and turn can be had at once, so the energy must vanish.
#[test]
fn a_soft_straight_fold_is_the_inscribed_polygon_of_its_cylinder() {
    let mesh = soft_fold();
    for start in [upright(&mesh), shaken(&upright(&mesh), 0.4)] {
        let sheet = run(&mesh, &MATERIAL.goals(&mesh), &start, &Solver::default());
        assert!(sheet.solve.converged, "{:?}", sheet.solve);
        assert!(sheet.solve.energy < 1e-10, "energy {}", sheet.solve.energy);
        // Middles of the strips touch a cylinder of radius x / (2 tan(θ/2n)), corners lie on one of x / (2 sin(θ/2n)).
        let half_turn = FOLD_RAD / 8.0;
        let radius = 5.0 / (2.0 * half_turn.sin());
        let row = |column: usize| sheet.positions[column * 7];
        let axis = circumcentre([row(4), row(6), row(8)]);
        for column in 4..=8 {
            assert!((row(column).distance(axis) / radius - 1.0).abs() < 1e-6, "column {column}");
        }
        let ends = (row(1) - row(0)).angle_between(row(12) - row(11));
        assert!((ends - FOLD_RAD).abs() < 1e-7);
    }
}

fn circumcentre([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let n = u.cross(v);
    a + (u.length_squared() * v.cross(n) + v.length_squared() * n.cross(u)) / (2.0 * n.length_squared())
}

#[test]
fn valleys_rise_towards_the_onlooker() {
    let mesh = soft_fold();
    let sheet = run(&mesh, &MATERIAL.goals(&mesh), &upright(&mesh), &Solver::default());
    let inner = sheet.mesh.edges.iter().filter(|e| matches!(e.class, EdgeClass::Fold { .. }));
    assert!(inner.clone().count() >= 30);
    for edge in inner {
        assert!(sheet.turn_rad(edge).unwrap() > 0.0);
    }
}

/// A case whose goals contradict each other: the energy does not vanish.
fn held_fold() -> (FlatMesh, Vec<Box<dyn Goal>>) {
    let mesh = soft_fold();
    let mut goals = MATERIAL.goals(&mesh);
    let at = |v: u32| SheetPoint::new([v, v, v], [1.0, 0.0, 0.0]);
    let target = DVec3::new(-30.0, 4.0, 0.0);
    goals.push(Box::new(Anchor { name: "A".into(), point: at(0), target, stiffness: DVec3::splat(2.0) }));
    goals.push(Box::new(ClampLength {
        name: "band".into(),
        ends: [at(3), at(87)],
        rest_mm: 30.0,
        stiffness: 1.0,
    }));
    let vertices = (0..13).map(|column| column * 7).collect();
    goals.push(Box::new(OnPlane {
        name: "foot".into(),
        vertices,
        origin: DVec3::ZERO,
        normal: DVec3::Z,
        stiffness: 1.0,
    }));
    (mesh, goals)
}

#[test]
fn newton_and_eq_4_end_at_the_same_energy() {
    let (mesh, goals) = held_fold();
    let start = upright(&mesh);
    let newton = run(&mesh, &goals, &start, &Solver::default()).solve;
    assert!(newton.converged, "{newton:?}");
    // Without momentum the last digits of the gradient take hundreds of thousands of steps; the energy is there before.
    for (momentum, relative_gradient) in
        [(Momentum::Share(0.0), 5e-5), (Momentum::Share(0.95), 1e-6), (Momentum::Nesterov, 1e-6)]
    {
        let options =
            RelaxOptions { momentum, relative_gradient, max_iterations: 400_000, ..RelaxOptions::default() };
        let relax = run(&mesh, &goals, &start, &Solver::Relax(options)).solve;
        assert!(relax.converged, "{relax:?}");
        let difference = (newton.energy - relax.energy).abs() / newton.energy;
        assert!(
            newton.energy > 1e-3 && difference < 1e-4,
            "{} against {}: {difference:e}",
            newton.energy,
            relax.energy
        );
    }
}

#[test]
fn newton_and_lbfgs_end_at_the_same_energy() {
    let (mesh, goals) = held_fold();
    for start in [upright(&mesh), shaken(&upright(&mesh), 0.4)] {
        let newton = run(&mesh, &goals, &start, &Solver::default()).solve;
        let lbfgs = run(&mesh, &goals, &start, &Solver::Lbfgs(LbfgsOptions::default())).solve;
        assert!(newton.converged && lbfgs.converged, "{newton:?} {lbfgs:?}");
        let difference = (newton.energy - lbfgs.energy).abs() / newton.energy;
        assert!(newton.energy > 1e-3 && difference < 1e-6, "{} against {}", newton.energy, lbfgs.energy);
        assert!(lbfgs.stop.contains("relative gradient"), "{}", lbfgs.stop);
    }
}

#[test]
fn a_budget_that_is_too_small_is_told() {
    let (mesh, goals) = held_fold();
    let start = upright(&mesh);
    let newton = Solver::Newton(NewtonOptions { max_iterations: 3, ..NewtonOptions::default() });
    let relax = Solver::Relax(RelaxOptions { max_iterations: 3, ..RelaxOptions::default() });
    let lbfgs = Solver::Lbfgs(LbfgsOptions { max_iterations: 3, ..LbfgsOptions::default() });
    for solver in [newton, relax, lbfgs] {
        let solve = run(&mesh, &goals, &start, &solver).solve;
        assert!(!solve.converged && solve.iterations == 3 && solve.stop.contains("budget"), "{solve:?}");
    }
}

#[test]
fn the_same_start_gives_the_same_positions() {
    let (mesh, goals) = held_fold();
    let start = upright(&mesh);
    for solver in [Solver::default(), Solver::Lbfgs(LbfgsOptions::default())] {
        let twice = [(); 2].map(|()| run(&mesh, &goals, &start, &solver).positions);
        assert_eq!(twice[0], twice[1]);
    }
}

#[test]
fn starts_that_are_no_numbers_are_refused() {
    let mesh = soft_fold();
    let mut start = upright(&mesh);
    start[5].y = f64::NAN;
    assert!(fold(&mesh, &MATERIAL.goals(&mesh), &start, &Solver::default(), &mut |_| ()).is_err());
    assert!(fold(&mesh, &[], &start[1..], &Solver::default(), &mut |_| ()).is_err());
}
