//! Every goal through the same proof, over a sheet folded from −179° to 179°, stretched, crushed and with slivers.

use super::testing::{
    prove_by_steps, prove_convex, prove_descent, prove_gauss_newton, prove_rigid_invariance,
};
use super::*;
use crate::SheetPoint;
use crate::testing::strip;
use softfold_geometry::{FlatMesh, VertexId};

/// Side of the sheet's squares, mm.
const SIDE: f64 = 5.0;

/// Two by two squares: the middle column (vertices 3, 4, 5) is the hinge of the sweep.
fn sheet() -> FlatMesh {
    strip(2, 2, SIDE)
}

/// A shape of the sheet, and the step of the differences that suits its smallest triangle, mm.
struct Shape {
    name: String,
    x: Vec<DVec3>,
    step: f64,
}

/// A repeatable disturbance, at most `size` each way.
fn noise(i: usize, size: f64) -> DVec3 {
    let k = i as f64;
    size * DVec3::new((12.9 * k + 0.3).sin(), (78.2 * k + 1.1).sin(), (37.7 * k + 2.3).sin())
}

/// The sheet folded about its middle column by a turn (+ valley), shaken a little.
fn folded(degrees: f64, shake: f64) -> Shape {
    let (s, c) = (0.5 * degrees.to_radians()).sin_cos();
    let place = |(i, p): (usize, &glam::DVec2)| {
        let off = p.x - SIDE;
        DVec3::new(off * c, p.y, off.abs() * s) + noise(i, shake)
    };
    let x = sheet().vertices.iter().enumerate().map(place).collect();
    Shape { name: format!("folded by {degrees}"), x, step: 1e-4 }
}

fn shapes() -> Vec<Shape> {
    let mut all: Vec<Shape> = (-179..=179).step_by(17).map(|d| folded(f64::from(d), 0.03)).collect();
    all.push(Shape { name: "crumpled".into(), ..folded(40.0, 2.0) });
    let stretched = folded(60.0, 0.1).x.into_iter().map(|p| 3.0 * p).collect();
    all.push(Shape { name: "stretched".into(), x: stretched, step: 1e-4 });
    let crushed = folded(60.0, 0.1).x.into_iter().map(|p| 0.4 * p).collect();
    all.push(Shape { name: "crushed".into(), x: crushed, step: 3e-5 });
    let far = folded(-70.0, 0.1).x.into_iter().map(|p| p + DVec3::new(300.0, -200.0, 500.0)).collect();
    all.push(Shape { name: "far away".into(), x: far, step: 1e-4 });
    // Triangles a hundredth as high as long.
    let squashed = |p: DVec3| DVec3::new(p.x, 0.01 * p.y, p.z);
    let slivers = folded(25.0, 0.1).x.into_iter().map(squashed).collect();
    all.push(Shape { name: "slivers".into(), x: slivers, step: 1e-6 });
    all
}

fn sheet_goals(mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
    vec![
        Box::new(EdgeLengths::of_mesh(mesh, |e| 3.0 + e.index() as f64)),
        Box::new(Hinges::of_mesh(mesh, "hinges", |e, _| Some((0.4, 2.0 + e.index() as f64)))),
        Box::new(Area::of_mesh(mesh, 4.0)),
        Box::new(Plate::of_mesh(mesh, 3.0, 0.3)),
    ]
}

fn point(vertices: [u32; 3]) -> SheetPoint {
    SheetPoint::new(vertices, [0.2, 0.5, 0.3])
}

/// Goals that bind the sheet to itself: rigid motions do not change them.
fn inner_goals(mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
    let points =
        vec![point([0, 3, 4]), point([1, 4, 5]), point([3, 6, 7]), point([4, 7, 8]), point([2, 5, 8])];
    let ends = [point([0, 3, 4]), point([4, 7, 8])];
    vec![
        Box::new(ClampLength { name: "band".into(), ends, rest_mm: 1.0, stiffness: 3.0 }),
        Box::new(Glue { name: "seam".into(), points: ends, stiffness: 3.0 }),
        Box::new(CoPlanar { name: "rim".into(), points, stiffness: 2.0 }),
        Box::new(SphereCollide::of_mesh(mesh, 0.9 * SIDE, 2.0)),
        // Thin, with a long reach: at work wherever the sheet is folded by more than some 100°.
        Box::new(SelfCollide::of_mesh(
            mesh,
            SelfCollideOptions { thickness_mm: 1e-3, reach_mm: 2.0 * SIDE, stiffness: 2.0 },
        )),
    ]
}

fn rail() -> SpaceCurve {
    let p = |x, y, z| DVec3::new(x, y, z);
    SpaceCurve::beziers(&[[p(-6., 0., 2.), p(-2., 9., 4.), p(2., -4., -3.), p(7., 6., 1.)]]).unwrap()
}

fn ridge() -> SpaceCurve {
    SpaceCurve::polyline(&[DVec3::new(-9., 1., 0.3), DVec3::new(0.1, 4., 2.), DVec3::new(8., 3., -1.)])
        .unwrap()
}

/// A tetrahedron.
fn scan() -> TriangleMesh {
    let points = [(-3., -3., 1.), (9., 0., -1.), (0., 11., 2.), (1., 3., 4.)].map(DVec3::from);
    TriangleMesh::new(&points, &[[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

/// Goals that bind the sheet to the world.
fn outer_goals(mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
    let points = || vec![point([0, 3, 4]), point([4, 7, 8]), SheetPoint::vertex(VertexId(2))];
    let (normal, origin) = (DVec3::new(1., 2., 2.) / 3.0, DVec3::new(0.3, 0.2, 1.1));
    let vertices: Vec<u32> = (0..9).collect();
    vec![
        Box::new(Anchor { name: "A".into(), point: point([0, 3, 4]), target: origin, stiffness: DVec3::ONE }),
        Box::new(OnPlane { name: "p".into(), vertices: vertices.clone(), origin, normal, stiffness: 2.0 }),
        Box::new(Floor { name: "f".into(), vertices, origin, normal, stiffness: 2.0 }),
        Box::new(OnCurve { name: "rail".into(), points: points(), target: rail(), stiffness: 2.0 }),
        Box::new(OnCurve { name: "ridge".into(), points: points(), target: ridge(), stiffness: 2.0 }),
        Box::new(OnMesh { name: "scan".into(), points: points(), target: scan(), stiffness: 2.0 }),
        Box::new(Load::self_weight(mesh, 1600.0, 10.0, EARTH_GRAVITY)),
        Box::new(Load::at("hand", point([1, 4, 5]), DVec3::new(3.0, -2.0, 1.0))),
    ]
}

fn all_goals() -> Vec<[Box<dyn Goal>; 1]> {
    let mesh = sheet();
    sheet_goals(&mesh).into_iter().chain(inner_goals(&mesh)).chain(outer_goals(&mesh)).map(|g| [g]).collect()
}

/// Runs a proof for all goals over all shapes and tells which failed.
fn sweep(goals: &[[Box<dyn Goal>; 1]], proof: impl Fn(&[Box<dyn Goal>], &Shape)) {
    let mut failed = Vec::new();
    for shape in &shapes() {
        for goal in goals {
            let run = std::panic::AssertUnwindSafe(|| proof(goal, shape));
            if let Err(fault) = std::panic::catch_unwind(run) {
                let fault = fault.downcast_ref::<String>().cloned().unwrap_or_default();
                failed.push(format!("{} `{}` {}: {fault}", goal[0].kind(), goal[0].name(), shape.name));
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn every_goal_is_at_work_in_some_shape() {
    for [goal] in all_goals() {
        let at_work = shapes().iter().filter(|s| goal.energy(&s.x) != 0.0).count();
        assert!(at_work >= 3, "{} `{}`: {at_work}", goal.kind(), goal.name());
    }
}

#[test]
fn derivatives_and_moves_are_those_of_the_energy() {
    sweep(&all_goals(), |goal, shape| prove_by_steps(goal, &shape.x, shape.step, 2e-5));
}

#[test]
fn the_convex_hessian_has_no_negative_direction() {
    sweep(&all_goals(), |goal, shape| prove_convex(goal, &shape.x));
}

#[test]
fn rigid_motions_change_nothing_inside_the_sheet() {
    let mesh = sheet();
    let goals: Vec<_> = sheet_goals(&mesh).into_iter().chain(inner_goals(&mesh)).map(|g| [g]).collect();
    sweep(&goals, |goal, shape| prove_rigid_invariance(goal, &shape.x));
}

#[test]
fn one_move_of_eq_4_does_not_raise_the_energy() {
    sweep(&all_goals(), |goal, shape| prove_descent(goal, &shape.x));
}

#[test]
fn without_force_the_true_hessian_is_the_convex_one() {
    let mesh = sheet();
    let flat = folded(0.0, 0.0).x;
    let hinges = Hinges::of_mesh(&mesh, "hinges", |_, _| Some((0.0, 2.0)));
    prove_gauss_newton(&[Box::new(hinges)], &flat, 1e-12);
    for goal in sheet_goals(&mesh).into_iter().filter(|g| g.kind() != "Hinge") {
        prove_gauss_newton(&[goal], &flat, 1e-12);
    }
    for goal in inner_goals(&mesh).into_iter().filter(|g| g.kind() == "CoPlanar") {
        prove_gauss_newton(&[goal], &flat, 1e-12);
    }
}
