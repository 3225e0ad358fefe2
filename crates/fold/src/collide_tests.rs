//! Sheets that would fold through themselves or through each other, with every accepted step looked at by brute force.

use crate::goal::{Curvature, Gradient, HessianSink, Moves, Part};
use crate::relax::Momentum;
use crate::testing::{crossings, folded_strip, strip};
use crate::{
    Goal, LbfgsOptions, Load, OnPlane, RelaxOptions, SelfCollide, SelfCollideOptions, SheetMaterial,
    SheetPoint, Solver, TriangleMesh, fold, goal::Target,
};
use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, FoldedSheet, VertexId};
use std::sync::{Arc, Mutex};

const MATERIAL: SheetMaterial = SheetMaterial {
    youngs_modulus_mpa: 200.0,
    poisson_ratio: 0.3,
    thickness_mm: 2.0,
    fold_line_factor: 10.0,
};

/// Keeps the places at which solvers ask for the gradient: every accepted one is among them.
#[derive(Clone, Default)]
struct Spy(Arc<Mutex<Vec<Vec<DVec3>>>>);

impl Goal for Spy {
    fn name(&self) -> &str {
        "spy"
    }
    fn kind(&self) -> &'static str {
        "Spy"
    }
    fn part(&self) -> Part {
        Part::Hold
    }
    fn couplings(&self) -> Vec<Vec<u32>> {
        Vec::new()
    }
    fn energy(&self, _: &[DVec3]) -> f64 {
        0.0
    }
    fn add_gradient(&self, x: &[DVec3], _: &mut Gradient<'_>) {
        self.0.lock().unwrap().push(x.to_vec());
    }
    fn add_hessian(&self, _: &[DVec3], _: Curvature, _: &mut HessianSink<'_>) {}
    fn add_moves(&self, _: &[DVec3], _: &mut Moves<'_>) {}
    fn residual(&self, _: &[DVec3]) -> f64 {
        0.0
    }
}

fn collide(mesh: &FlatMesh) -> Box<dyn Goal> {
    let thickness = MATERIAL.thickness_mm;
    let stiffness = MATERIAL.bending_stiffness();
    Box::new(SelfCollide::of_mesh(mesh, SelfCollideOptions::of_thickness(thickness, stiffness)))
}

fn flat(mesh: &FlatMesh) -> Vec<DVec3> {
    mesh.vertices.iter().map(|p| p.extend(0.0)).collect()
}

/// Folds with all accepted states checked.
fn folded(mesh: &FlatMesh, mut goals: Vec<Box<dyn Goal>>, start: &[DVec3], solver: &Solver) -> FoldedSheet {
    let spy = Spy::default();
    goals.push(Box::new(spy.clone()));
    let sheet = fold(mesh, &goals, start, solver, &mut |_| ()).unwrap();
    let states = spy.0.lock().unwrap();
    assert!(states.len() > 3 && states.last() == Some(&sheet.positions));
    for (k, x) in states.iter().enumerate() {
        assert_eq!(crossings(mesh, x), 0, "state {k} of {}", states.len());
    }
    sheet
}

/// Least distance between the vertices and the triangles of two panels, by another program than the barrier's.
fn panel_distance(sheet: &FoldedSheet, of: impl Fn(f64) -> bool, from: impl Fn(f64) -> bool) -> f64 {
    let u = |v: VertexId| sheet.mesh.vertices[v.index()].x;
    let inside = |t: &&[VertexId; 3]| t.iter().all(|v| from(u(*v)));
    let triangles: Vec<[u32; 3]> =
        sheet.mesh.triangles.iter().filter(inside).map(|t| t.map(|v| v.0)).collect();
    let target = TriangleMesh::new(&sheet.positions, &triangles).unwrap();
    let vertices = (0..sheet.positions.len()).map(VertexId::new).filter(|v| of(u(*v)));
    vertices.map(|v| sheet.position(v)).map(|p| target.nearest(p).place.distance(p)).fold(f64::MAX, f64::min)
}

/// Two creases that ask for 178° each, three panels of 30 mm: without thickness they would lie in 1 mm.
fn pleat() -> FlatMesh {
    folded_strip(18, 4, 5.0, |column| match column {
        6 => 178f64.to_radians(),
        12 => -178f64.to_radians(),
        _ => 0.0,
    })
}

#[test]
fn a_pleat_folded_past_touching_keeps_its_thickness() {
    let mesh = pleat();
    let free = fold(&mesh, &MATERIAL.goals(&mesh), &flat(&mesh), &Solver::default(), &mut |_| ()).unwrap();
    let layers = |s: &FoldedSheet| {
        [
            panel_distance(s, |u| u <= 25.0, |u| (30.0..=60.0).contains(&u)),
            panel_distance(s, |u| u >= 65.0, |u| (30.0..=60.0).contains(&u)),
        ]
    };
    assert!(layers(&free).iter().all(|d| *d < 0.5), "the case must need the goal: {:?}", layers(&free));
    let lbfgs = LbfgsOptions { relative_gradient: 1e-5, ..LbfgsOptions::default() };
    for solver in [Solver::default(), Solver::Lbfgs(lbfgs)] {
        let mut goals = MATERIAL.goals(&mesh);
        goals.push(collide(&mesh));
        let sheet = folded(&mesh, goals, &flat(&mesh), &solver);
        let layers = layers(&sheet);
        assert!(sheet.solve.converged, "{:?} {layers:?}", sheet.solve);
        // Not nearer than the thickness, and touching.
        assert!(layers.iter().all(|d| *d > 2.0 && *d < 2.5), "{layers:?}");
    }
}

/// Two strips of 30 × 20 mm over each other, the upper one `gap` mm above.
fn two_sheets(gap: f64) -> (FlatMesh, Vec<DVec3>) {
    let one = strip(6, 4, 5.0);
    let n = one.vertices.len();
    let moved = one.vertices.iter().map(|p| *p + DVec2::new(100.0, 0.0));
    let vertices: Vec<DVec2> = one.vertices.iter().copied().chain(moved).collect();
    let again = one.triangles.iter().map(|t| t.map(|v| VertexId::new(v.index() + n)));
    let triangles = one.triangles.iter().copied().chain(again).collect();
    let sites = [one.sites.clone(), one.sites.clone()].concat();
    let class = |[a, _]: [VertexId; 2], boundary: bool| match boundary {
        true => softfold_geometry::EdgeClass::Boundary {
            loop_id: softfold_geometry::LoopId((a.index() >= n).into()),
        },
        false => softfold_geometry::EdgeClass::Facet,
    };
    let mesh = FlatMesh::new(vertices, sites, triangles, class);
    // The upper sheet lies a little aside, so that corners meet faces and edges cross.
    let place = |(i, p): (usize, &DVec2)| match i < n {
        true => p.extend(0.0),
        false => DVec3::new(p.x - 98.3, p.y + 1.1, gap),
    };
    let start = mesh.vertices.iter().enumerate().map(place).collect();
    (mesh, start)
}

/// The lower sheet lies in a plane, the upper one is pushed down by 35 N.
fn pushed(mesh: &FlatMesh, start: &[DVec3]) -> Vec<Box<dyn Goal>> {
    let n = mesh.vertices.len() as u32 / 2;
    let mut goals = MATERIAL.goals(mesh);
    let plane = |name: &str, vertices: Vec<u32>, origin: DVec3, normal: DVec3, stiffness: f64| OnPlane {
        name: name.into(),
        vertices,
        origin,
        normal,
        stiffness,
    };
    goals.push(Box::new(plane("table", (0..n).collect(), DVec3::ZERO, DVec3::Z, 50.0)));
    // Nothing drifts away sideways.
    for v in [0, 24, n, n + 24] {
        for normal in [DVec3::X, DVec3::Y] {
            goals.push(Box::new(plane("pin", vec![v], start[v as usize], normal, 1.0)));
        }
    }
    let point = |v: u32| SheetPoint::vertex(VertexId(v));
    let forces = (n..2 * n).map(|v| (point(v), DVec3::new(0.0, 0.0, -1.0))).collect();
    goals.push(Box::new(Load { name: "hand".into(), forces }));
    goals
}

#[test]
fn two_sheets_pushed_together_stay_apart_and_carry_the_load() {
    let (mesh, start) = two_sheets(12.0);
    let mut goals = pushed(&mesh, &start);
    goals.push(collide(&mesh));
    let sheet = folded(&mesh, goals, &start, &Solver::default());
    let gap = panel_distance(&sheet, |u| u > 50.0, |u| u < 50.0);
    assert!(sheet.solve.converged && gap > 2.0 && gap < 2.5, "{:?} {gap}", sheet.solve);
    // What is pushed down above arrives below.
    let carried: f64 = (0..35).map(|v| 50.0 * -sheet.positions[v].z).sum();
    assert!((carried - 35.0).abs() < 1e-2, "{carried} N");
}

#[test]
fn eq_4_does_not_tunnel_either() {
    let (mesh, start) = two_sheets(4.0);
    let mut goals = pushed(&mesh, &start);
    goals.push(collide(&mesh));
    let options =
        RelaxOptions { momentum: Momentum::Share(0.9), max_iterations: 1000, ..RelaxOptions::default() };
    let spy = Spy::default();
    goals.push(Box::new(spy.clone()));
    let sheet = fold(&mesh, &goals, &start, &Solver::Relax(options), &mut |_| ()).unwrap();
    assert!(spy.0.lock().unwrap().iter().all(|x| crossings(&mesh, x) == 0));
    let gap = panel_distance(&sheet, |u| u > 50.0, |u| u < 50.0);
    assert!(gap > 2.0 && gap < 3.0, "{gap}");
}

/// A pleat that does not fold far enough to touch is the same with and without the goal, to the bit.
#[test]
fn where_nothing_touches_nothing_changes() {
    let mesh = folded_strip(18, 4, 5.0, |column| match column {
        6 => 60f64.to_radians(),
        12 => -60f64.to_radians(),
        _ => 0.0,
    });
    for solver in [Solver::default(), Solver::Lbfgs(LbfgsOptions::default())] {
        let run = |goals: &[Box<dyn Goal>]| fold(&mesh, goals, &flat(&mesh), &solver, &mut |_| ()).unwrap();
        let mut goals = MATERIAL.goals(&mesh);
        let without = run(&goals);
        goals.push(collide(&mesh));
        assert_eq!(run(&goals), without);
    }
}
