//! Goals in equilibrium: sheets at rest under what pulls, carries and holds them, against statics and closed forms.

use crate::goal::{EARTH_GRAVITY, Goal};
use crate::testing::{crossings, folded_strip};
use crate::{
    CoPlanar, Floor, Glue, LbfgsOptions, Load, OnCurve, OnMesh, SheetMaterial, SheetPoint, Solver,
    SpaceCurve, SphereCollide, TriangleMesh, fold, upright,
};
use glam::DVec3;
use softfold_geometry::{FlatMesh, FoldedSheet, VertexId};

const MATERIAL: SheetMaterial = SheetMaterial {
    youngs_modulus_mpa: 200.0,
    poisson_ratio: 0.3,
    thickness_mm: 2.0,
    fold_line_factor: 10.0,
};

/// Twelve by six squares of 5 mm with one sharp fold in the middle, its line at vertices 42 to 48.
fn folded_once(degrees: f64) -> FlatMesh {
    folded_strip(12, 6, 5.0, |column| if column == 6 { degrees.to_radians() } else { 0.0 })
}

fn run(mesh: &FlatMesh, goals: &[Box<dyn Goal>], solver: &Solver) -> FoldedSheet {
    fold(mesh, goals, &upright(mesh), solver, &mut |_| ()).unwrap()
}

fn both() -> [Solver; 2] {
    [Solver::default(), Solver::Lbfgs(LbfgsOptions::default())]
}

fn points(vertices: impl IntoIterator<Item = u32>) -> Vec<SheetPoint> {
    vertices.into_iter().map(|v| SheetPoint::vertex(VertexId(v))).collect()
}

fn floor(mesh: &FlatMesh) -> Floor {
    let vertices = (0..mesh.vertices.len() as u32).collect();
    Floor { name: "floor".into(), vertices, origin: DVec3::ZERO, normal: DVec3::Z, stiffness: 50.0 }
}

/// A tent on the floor under its own weight.
fn tent() -> (FlatMesh, Vec<Box<dyn Goal>>) {
    let mesh = folded_once(-80.0);
    let mut goals = MATERIAL.goals(&mesh);
    goals.push(Box::new(Load::self_weight(&mesh, 2.0e5, MATERIAL.thickness_mm, EARTH_GRAVITY)));
    goals.push(Box::new(floor(&mesh)));
    (mesh, goals)
}

#[test]
fn a_floor_carries_the_weight_of_what_stands_on_it() {
    let (mesh, goals) = tent();
    let weight = 60.0 * 30.0 * 2.0 * 2.0e5 * 1e-9 * 9.80665;
    for solver in both() {
        let sheet = run(&mesh, &goals, &solver);
        assert!(sheet.solve.converged, "{:?}", sheet.solve);
        let carried: f64 = sheet.positions.iter().map(|p| 50.0 * (-p.z).max(0.0)).sum();
        assert!((carried / weight - 1.0).abs() < 1e-3, "{carried} N of {weight} N");
    }
}

#[test]
fn newton_and_lbfgs_agree_on_a_sheet_between_rail_and_scan() {
    let mesh = folded_once(50.0);
    let mut goals = MATERIAL.goals(&mesh);
    let rail =
        SpaceCurve::beziers(
            &[[(-20., 0., 0.), (-5., 6., 0.), (5., -2., 0.), (20., 3., 0.)].map(DVec3::from)],
        );
    let foot = points((0..13).map(|column| 7 * column));
    goals.push(Box::new(OnCurve {
        name: "rail".into(),
        points: foot,
        target: rail.unwrap(),
        stiffness: 5.0,
    }));
    let scan = TriangleMesh::new(
        &[(-60., 8., 30.), (60., 8., 30.), (0., -40., 32.), (0., 60., 35.)].map(DVec3::from),
        &[[0, 2, 1], [0, 1, 3]],
    );
    let head = points((0..13).map(|column| 7 * column + 6));
    goals.push(Box::new(OnMesh { name: "scan".into(), points: head, target: scan.unwrap(), stiffness: 1.0 }));
    let [newton, lbfgs] = both().map(|solver| run(&mesh, &goals, &solver).solve);
    assert!(newton.converged && lbfgs.converged, "{newton:?} {lbfgs:?}");
    let difference = (newton.energy - lbfgs.energy).abs() / newton.energy;
    assert!(newton.energy > 1.0 && difference < 1e-6, "{} against {}", newton.energy, lbfgs.energy);
}

/// A roof of 60° with its ridge along the fold: the sheet fits it without strain.
#[test]
fn a_folded_sheet_lies_on_a_roof_of_its_angle() {
    let mesh = folded_once(60.0);
    let (s, c) = 30f64.to_radians().sin_cos();
    // Valleys rise towards the onlooker, who stands at −y.
    let corner = |side: f64, z: f64| DVec3::new(100.0 * side * c, -100.0 * s, z);
    let ridge = [DVec3::new(0.0, 0.0, -50.0), DVec3::new(0.0, 0.0, 80.0)];
    let roof =
        [corner(-1.0, -50.0), corner(-1.0, 80.0), ridge[0], ridge[1], corner(1.0, -50.0), corner(1.0, 80.0)];
    let roof = TriangleMesh::new(&roof, &[[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]]).unwrap();
    let mut goals = MATERIAL.goals(&mesh);
    let all = points(0..mesh.vertices.len() as u32);
    goals.push(Box::new(OnMesh { name: "roof".into(), points: all, target: roof, stiffness: 1.0 }));
    let target = SpaceCurve::polyline(&ridge).unwrap();
    goals.push(Box::new(OnCurve { name: "ridge".into(), points: points(42..49), target, stiffness: 1.0 }));
    for solver in both() {
        let sheet = run(&mesh, &goals, &solver);
        let residuals = goals.iter().map(|g| g.residual(&sheet.positions)).fold(0.0, f64::max);
        // lbfgs stops at 1e-6 of the forces; both below a thousandth of a millimetre.
        assert!(sheet.solve.energy < 1e-6 && residuals < 1e-3, "{:?} {residuals}", sheet.solve);
    }
}

#[test]
fn a_pleat_folded_past_touching_keeps_its_balls_apart() {
    let diameter = 4.0;
    let mesh = folded_once(175.0);
    let mut goals = MATERIAL.goals(&mesh);
    let free = run(&mesh, &goals, &Solver::default());
    let spheres = |stiffness| Box::new(SphereCollide::of_mesh(&mesh, diameter, stiffness));
    assert!(spheres(1.0).residual(&free.positions) > 2.0, "the case must need the goal");
    goals.push(spheres(1e4));
    let solvers = [
        Solver::default(),
        Solver::Lbfgs(LbfgsOptions { relative_gradient: 1e-4, ..LbfgsOptions::default() }),
    ];
    for solver in solvers {
        let sheet = run(&mesh, &goals, &solver);
        let depth = spheres(1.0).residual(&sheet.positions);
        assert!(sheet.solve.converged && depth < 0.01 * diameter && depth > 0.0, "{:?} {depth}", sheet.solve);
    }
}

/// Three soft folds of 150° that would turn the sheet through itself: its layers lie on each other instead.
#[test]
fn a_sheet_rolled_up_keeps_its_layers_apart() {
    let diameter = 3.0;
    let quarter = 150f64.to_radians() / 4.0;
    let mesh = folded_strip(36, 6, 2.5, |column| match column {
        6 | 10 | 16 | 20 | 26 | 30 => 0.5 * quarter,
        7..=9 | 17..=19 | 27..=29 => quarter,
        _ => 0.0,
    });
    let mut goals = MATERIAL.goals(&mesh);
    let free = run(&mesh, &goals, &Solver::default());
    assert!(crossings(&mesh, &free.positions) > 0, "the case must need the goal");
    let spheres = |stiffness| Box::new(SphereCollide::of_mesh(&mesh, diameter, stiffness));
    goals.push(spheres(1e3));
    let lbfgs = LbfgsOptions { relative_gradient: 1e-5, ..LbfgsOptions::default() };
    for solver in [Solver::default(), Solver::Lbfgs(lbfgs)] {
        let sheet = run(&mesh, &goals, &solver);
        let depth = spheres(1.0).residual(&sheet.positions);
        assert!(sheet.solve.converged && depth < 0.05 * diameter && depth > 0.0, "{:?} {depth}", sheet.solve);
        assert_eq!(crossings(&mesh, &sheet.positions), 0);
    }
}

#[test]
fn glued_corners_meet_and_a_rim_becomes_plane() {
    let mesh = folded_once(120.0);
    let mut goals = MATERIAL.goals(&mesh);
    let ends = [SheetPoint::vertex(VertexId(0)), SheetPoint::vertex(VertexId(84))];
    goals.push(Box::new(Glue { name: "seam".into(), points: ends, stiffness: 1e4 }));
    let rim = points((0..7).chain(84..91));
    goals.push(Box::new(CoPlanar { name: "rim".into(), points: rim, stiffness: 1e4 }));
    for solver in both() {
        let sheet = run(&mesh, &goals, &solver);
        assert!(sheet.solve.converged, "{:?}", sheet.solve);
        let residuals = [3, 4].map(|g| goals[g].residual(&sheet.positions));
        assert!(residuals[0] < 0.05 && residuals[1] < 0.01, "{residuals:?}");
    }
}

#[test]
fn a_sheet_that_falls_for_ever_is_told_and_stays_finite() {
    let mesh = folded_once(30.0);
    let mut goals = MATERIAL.goals(&mesh);
    goals.push(Box::new(Load::self_weight(&mesh, 2.0e5, MATERIAL.thickness_mm, EARTH_GRAVITY)));
    for solver in both() {
        let sheet = run(&mesh, &goals, &solver);
        assert!(!sheet.solve.converged && sheet.positions.iter().all(|p| p.is_finite()), "{:?}", sheet.solve);
        assert!(!sheet.solve.stop.contains("below"), "{}", sheet.solve.stop);
    }
}
