//! Multilevel, warm and interrupted solves against the solve on one mesh from the start.

use crate::testing::folded_strip;
use crate::{
    Anchor, Between, FoldError, Goal, Halt, Level, NewtonOptions, Pyramid, RelaxOptions, Session,
    SheetMaterial, SheetPoint, Solver, fold, fold_multilevel, upright,
};
use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, FoldedSheet};

const MATERIAL: SheetMaterial = SheetMaterial {
    youngs_modulus_mpa: 500.0,
    poisson_ratio: 0.3,
    thickness_mm: 4.0,
    fold_line_factor: 10.0,
};
/// The strip's size: 240 × 160 mm.
const COLUMNS: usize = 48;
const LINES: usize = 32;

/// A strip of 5 mm squares, coarsened by `by`, with a fold of `fold_rad` between 100 and 140 mm, at most as wide as one coarse column.
fn strip(by: usize, fold_rad: f64) -> FlatMesh {
    let pieces = 8 / by;
    folded_strip(COLUMNS / by, LINES / by, 5.0 * by as f64, |column| match column {
        c if c == 20 / by || c == 28 / by => 0.5 * fold_rad / pieces as f64,
        c if (20 / by..28 / by).contains(&c) => fold_rad / pieces as f64,
        _ => 0.0,
    })
}

/// The sheet's own goals and two corners that are pulled to places where they cannot quite get.
fn goals(mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
    let mut goals = MATERIAL.goals(mesh);
    for (corner, target) in [
        (DVec2::ZERO, DVec3::new(-60.0, 30.0, 0.0)),
        (DVec2::new(240.0, 160.0), DVec3::new(70.0, 60.0, 150.0)),
    ] {
        let point = crate::locate(mesh, corner).unwrap();
        goals.push(Box::new(Anchor { name: "corner".into(), point, target, stiffness: DVec3::splat(0.5) }));
    }
    goals
}

/// Positions carried along straight lines: exact for linear fields only, the least that is asked of a carry.
fn linear(from: &FlatMesh, x: &[DVec3], to: &FlatMesh) -> Vec<DVec3> {
    let at = |p: &DVec2| -> SheetPoint { crate::locate(from, *p).unwrap() };
    to.vertices.iter().map(|p| at(p).position(x)).collect()
}

fn level(by: usize, fold_rad: f64) -> Level {
    let mesh = strip(by, fold_rad);
    Level { goals: goals(&mesh), mesh }
}

fn multilevel(levels: &[Level], fold_rad: f64, options: &NewtonOptions) -> Result<FoldedSheet, FoldError> {
    let Level { mesh, goals } = level(1, fold_rad);
    let pyramid = Pyramid { levels, between: None, carry: &linear };
    fold_multilevel(&pyramid, &mesh, &goals, &upright(&mesh), options, &mut |_| ())
}

fn one_level(fold_rad: f64) -> FoldedSheet {
    let Level { mesh, goals } = level(1, fold_rad);
    fold(&mesh, &goals, &upright(&mesh), &Solver::default(), &mut |_| ()).unwrap()
}

#[test]
fn through_a_pyramid_the_energy_is_that_of_one_level() {
    for fold_rad in [0.9, -1.6] {
        let one = one_level(fold_rad).solve;
        let levels = [level(4, fold_rad), level(2, fold_rad)];
        let many = multilevel(&levels, fold_rad, &NewtonOptions::default()).unwrap().solve;
        assert!(one.converged && many.converged, "{one:?} {many:?}");
        assert!(one.energy > 1.0 && (many.energy / one.energy - 1.0).abs() < 1e-6, "{one:?} {many:?}");
        assert_eq!(many.levels.iter().map(|l| l.vertices).collect::<Vec<_>>(), [117, 425, 1617]);
        assert_eq!(many.levels.iter().map(|l| l.iterations).sum::<u32>(), many.iterations);
        assert!(many.factorisations < one.factorisations, "{one:?} {many:?}");
        assert_eq!(many.factorisations, many.levels[2].factorisations);
    }
}

#[test]
fn what_a_mesh_begins_with_is_told_without_its_wrinkles() {
    let levels = [level(2, 0.9)];
    let Level { mesh, goals } = level(1, 0.9);
    let pyramid = Pyramid { levels: &levels, between: None, carry: &linear };
    let (mut coarse, mut last, mut begun) = (Vec::new(), 0, None);
    let mut watch = |i: crate::Iteration<'_>| {
        if i.level == 1 {
            (coarse, last) = (i.positions.to_vec(), i.number);
        } else {
            begun = begun.or(Some((i.number, i.energy)));
        }
    };
    let options = NewtonOptions::default();
    fold_multilevel(&pyramid, &mesh, &goals, &upright(&mesh), &options, &mut watch).unwrap();
    let carried = linear(&levels[0].mesh, &coarse, &mesh);
    let rough = crate::Objective::new(mesh.vertices.len(), &goals).energy(&carried, crate::Scales::FULL);
    let (number, energy) = begun.unwrap();
    assert_eq!(number, last);
    assert!(energy < 0.5 * rough, "{energy} of {rough}");
}

/// The end, and between which meshes another one was asked for, of a pyramid that has it and one that goes without.
fn with_between(bys: [usize; 2], near_mm: f64, between: Option<&Level>) -> (FoldedSheet, Vec<usize>) {
    let levels = bys.map(|by| level(by, 0.9));
    let Level { mesh, goals } = level(1, 0.9);
    let asked = std::cell::RefCell::new(Vec::new());
    let ask = |k: usize| {
        asked.borrow_mut().push(k);
        between
    };
    let pyramid = Pyramid { levels: &levels, between: Some(Between { mesh: &ask, near_mm }), carry: &linear };
    let options = NewtonOptions::default();
    let sheet = fold_multilevel(&pyramid, &mesh, &goals, &upright(&mesh), &options, &mut |_| ()).unwrap();
    (sheet, asked.take())
}

/// The coarsest mesh knows of no error; the one after it is 24 mm, mean edge, and tells what is left to 6 mm.
#[test]
fn a_mesh_between_is_folded_where_the_prediction_asks_for_it_and_not_where_it_does_not() {
    let middle = level(2, 0.9);
    let vertices =
        |sheet: &FoldedSheet| -> Vec<u32> { sheet.solve.levels.iter().map(|l| l.vertices).collect() };
    let (without, asked) = with_between([8, 4], 1e3, Some(&middle));
    assert_eq!((vertices(&without), asked), (vec![35, 117, 1617], vec![]));
    let (with, asked) = with_between([8, 4], 1e-3, Some(&middle));
    assert_eq!((vertices(&with), asked), (vec![35, 117, 425, 1617], vec![2]));
    let (none, asked) = with_between([8, 4], 1e-3, None);
    assert_eq!((none, asked), (without.clone(), vec![2]));
    let (a, b) = (with.solve, without.solve);
    assert!(a.converged && (a.energy / b.energy - 1.0).abs() < 1e-6, "{a:?} {b:?}");
    assert_eq!(a.levels.iter().map(|l| l.iterations).sum::<u32>(), a.iterations);
}

/// It is on the safe side, and not by an order of magnitude.
#[test]
fn the_prediction_is_of_the_size_of_the_truth() {
    let truth = one_level(0.9).positions;
    for bys in [[8, 4], [4, 2]] {
        let levels = bys.map(|by| level(by, 0.9));
        let Level { mesh, goals } = level(1, 0.9);
        let mut begun = Vec::new();
        let mut watch = |i: crate::Iteration<'_>| {
            if i.level == 0 && begun.is_empty() {
                begun = i.positions.to_vec();
            }
        };
        let pyramid = Pyramid { levels: &levels, between: None, carry: &linear };
        let options = NewtonOptions::default();
        fold_multilevel(&pyramid, &mesh, &goals, &upright(&mesh), &options, &mut watch).unwrap();
        let way: Vec<DVec3> = truth.iter().zip(&begun).map(|(to, from)| *to - *from).collect();
        let off_mm = crate::motion::Motion::new(&begun, &way).rest_rms_mm();
        let asks = |near_mm: f64| !with_between(bys, near_mm, None).1.is_empty();
        assert!(asks(0.8 * off_mm) && !asks(8.0 * off_mm), "{bys:?}: {off_mm} mm");
    }
}

#[test]
fn an_empty_pyramid_is_one_level() {
    let one = one_level(0.9);
    assert_eq!(multilevel(&[], 0.9, &NewtonOptions::default()).unwrap(), one);
}

#[test]
fn the_same_pyramid_gives_the_same_positions() {
    let levels = [level(2, 0.9)];
    let twice = [(); 2].map(|()| multilevel(&levels, 0.9, &NewtonOptions::default()).unwrap().positions);
    assert_eq!(twice[0], twice[1]);
}

/// A pyramid of another sheet misleads; its end must not be worse for it.
#[test]
fn a_misleading_pyramid_does_not_raise_the_energy() {
    let one = one_level(0.9).solve;
    let many = multilevel(&[level(2, -1.6)], 0.9, &NewtonOptions::default()).unwrap().solve;
    assert!(many.converged && many.energy < one.energy * (1.0 + 1e-6), "{one:?} {many:?}");
}

#[test]
fn a_spent_budget_gives_the_best_state_so_far() {
    let levels = [level(2, 0.9)];
    let Level { mesh, goals } = level(1, 0.9);
    let objective = crate::Objective::new(mesh.vertices.len(), &goals);
    let at_start = objective.energy(&upright(&mesh), crate::Scales::FULL);
    for max_iterations in [0, 1, 3, 12] {
        let options = NewtonOptions { max_iterations, ..NewtonOptions::default() };
        let sheet = multilevel(&levels, 0.9, &options).unwrap();
        let FoldedSheet { positions, solve, .. } = &sheet;
        assert!(!solve.converged && solve.stop.contains("budget"), "{solve:?}");
        assert!(solve.iterations <= max_iterations && solve.energy <= at_start, "{solve:?}");
        assert_eq!(objective.energy(positions, crate::Scales::FULL), solve.energy);
    }
}

#[test]
fn a_halt_ends_every_solver_with_what_it_has() {
    let Level { mesh, goals } = level(2, 0.9);
    let start = upright(&mesh);
    for kind in 0..3 {
        let halt = Halt::default();
        let solver = match kind {
            0 => Solver::Newton(NewtonOptions { halt: halt.clone(), ..NewtonOptions::default() }),
            1 => Solver::Lbfgs(crate::LbfgsOptions { halt: halt.clone(), ..crate::LbfgsOptions::default() }),
            _ => Solver::Relax(RelaxOptions { halt: halt.clone(), ..RelaxOptions::default() }),
        };
        let mut told = 0;
        let mut watch = |_: crate::Iteration<'_>| {
            told += 1;
            halt.set();
        };
        let solve = fold(&mesh, &goals, &start, &solver, &mut watch).unwrap().solve;
        assert!(!solve.converged && solve.stop.contains("time"), "{solve:?}");
        assert!(told <= 2, "{} told {told} times after its halt", solve.solver); // a factor may be used once more
    }
}

#[test]
fn a_slider_ends_where_a_fold_from_the_start_does() {
    let options = NewtonOptions { motion_mm: 1e-3, ..NewtonOptions::default() };
    let first = one_level(0.9);
    let mut session = Session::new(&first, &level(1, 0.9).goals, options).unwrap();
    for step in 1..=3 {
        let fold_rad = 0.9 * (1.0 + 0.05 * f64::from(step));
        let moved = session.update(&level(1, fold_rad).goals, &mut |_| ()).unwrap().solve;
        let anew = one_level(fold_rad).solve;
        assert!(moved.converged && (moved.energy / anew.energy - 1.0).abs() < 1e-6, "{moved:?} {anew:?}");
        assert!(moved.factorisations <= 4, "{moved:?}");
    }
}

#[test]
fn a_session_takes_goals_that_couple_other_vertices() {
    let first = one_level(0.9);
    let Level { mesh, goals } = level(1, 0.9);
    let mut session = Session::new(&first, &goals, NewtonOptions::default()).unwrap();
    let mut more = goals;
    let ends = [DVec2::new(0.0, 160.0), DVec2::new(240.0, 0.0)].map(|p| crate::locate(&mesh, p).unwrap());
    more.push(Box::new(crate::ClampLength { name: "band".into(), ends, rest_mm: 100.0, stiffness: 0.1 }));
    let moved = session.update(&more, &mut |_| ()).unwrap().solve;
    assert!(moved.converged && moved.energy > first.solve.energy, "{moved:?}");
}
