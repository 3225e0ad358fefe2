//! Bending against closed forms, on irregular meshes.

use crate::goal::{Anchor, Goal, Hinges, Plate};
use crate::material::FaceBending;
use crate::testing::{irregular, strip};
use crate::{NewtonOptions, Scales, SheetMaterial, SheetPoint, Solver, fold, locate};
use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, TriangleId, VertexId};
use std::f64::consts::PI;

/// Bending stiffness, N·mm.
const D: f64 = 7.0;
/// Poisson's ratio.
const NU: f64 = 0.3;

fn plate(mesh: &FlatMesh) -> Plate {
    Plate::of_mesh(mesh, D, NU)
}

/// The sum over hinges as a [`SheetMaterial`] has it.
fn hinges(mesh: &FlatMesh) -> Hinges {
    let area = |t: Option<TriangleId>| t.map_or(0.0, |t| mesh.triangle_area_mm2(t));
    Hinges::of_mesh(mesh, "hinges", |id, e| {
        let share = mesh.edge_length_mm(id).powi(2) / (area(e.triangles[0]) + area(e.triangles[1]));
        Some((0.0, D * share))
    })
}

fn shaped(mesh: &FlatMesh, f: impl Fn(DVec2) -> DVec3) -> Vec<DVec3> {
    mesh.vertices.iter().map(|p| f(*p)).collect()
}

/// Rolled about an axis that is turned against the mesh.
fn cylinder(radius: f64, turned: f64) -> impl Fn(DVec2) -> DVec3 {
    move |p| {
        let (along, across) = (DVec2::from_angle(turned).dot(p), DVec2::from_angle(turned).perp_dot(p));
        DVec3::new(across, radius * (along / radius).sin(), radius * (1.0 - (along / radius).cos()))
    }
}

#[test]
fn quadratics_have_their_exact_energy_on_any_mesh() {
    for (mesh, [a, b, c]) in [
        (irregular(9, 7, 5.0, 1), [0.02, -0.01, 0.005]),
        (irregular(4, 3, 2.0, 5), [0.0, 0.0, 0.03]),
        (strip(5, 6, 4.0), [0.01, 0.01, 0.0]),
    ] {
        let x = shaped(&mesh, |p| {
            DVec3::new(p.x, p.y, 0.5 * a * p.x * p.x + c * p.x * p.y + 0.5 * b * p.y * p.y)
        });
        let density = 0.5 * D * ((1.0 - NU) * (a * a + 2.0 * c * c + b * b) + NU * (a + b) * (a + b));
        let exact = density * mesh.area_mm2();
        let got = plate(&mesh).energy(&x);
        assert!((got / exact - 1.0).abs() < 1e-10, "{got} {exact}");
    }
}

#[test]
fn a_cylinder_has_its_energy_on_irregular_meshes_where_hinges_never_have() {
    let (radius, width, length) = (30.0, 24.0, 40.0);
    let exact = 0.5 * D * width * length / (radius * radius);
    for turned in [0.0, 0.4] {
        let errors = [1, 2, 4].map(|n: usize| {
            let mesh = irregular(10 * n, 6 * n, 4.0 / n as f64, 3);
            let x = shaped(&mesh, cylinder(radius, turned));
            [plate(&mesh).energy(&x), hinges(&mesh).energy(&x)].map(|e: f64| e / exact - 1.0)
        });
        assert!(errors[2][0].abs() < 5e-4, "{turned}: {errors:?}");
        for [coarse, fine] in [[errors[0], errors[1]], [errors[1], errors[2]]] {
            assert!((coarse[0] / fine[0]).abs() > 3.5 && fine[1] > 0.1, "{turned}: {errors:?}");
        }
    }
}

/// Pinned strut: rotation of its ends in degrees, force over Euler's, distance of the ends and rise over the length
/// (elliptic integrals).
const ELASTICA: [[f64; 4]; 8] = [
    [20.0, 1.0154, 0.9697, 0.1097],
    [40.0, 1.0637, 0.8812, 0.2111],
    [60.0, 1.1517, 0.7410, 0.2966],
    [80.0, 1.2939, 0.5594, 0.3597],
    [100.0, 1.5184, 0.3490, 0.3958],
    [120.0, 1.8848, 0.1232, 0.4016],
    [140.0, 2.5423, -0.1069, 0.3752],
    [160.0, 4.0301, -0.3403, 0.3123],
];

/// Half the angle of the arc of length 1 with this chord: `sin a / a`, by halving; beyond the half circle the ends have passed each other.
fn arc_of_chord(chord: f64) -> f64 {
    let (mut low, mut high) = (1e-3, 4.4);
    for _ in 0..60 {
        let a: f64 = 0.5 * (low + high);
        if a.sin() / a > chord { low = a } else { high = a }
    }
    low
}

/// A strip of this length, mm, on an irregular mesh, pushed together as far as the table says; gives force and rise as the
/// table has them.
fn pushed_together(columns: usize, row: [f64; 4]) -> [f64; 2] {
    const LENGTH: f64 = 100.0;
    /// Of what holds its ends, N/mm; the push is about 10 N.
    const HOLD: f64 = 1e3;
    let h = LENGTH / columns as f64;
    let mesh = irregular(columns, columns / 8, h, 11);
    let width = (columns / 8) as f64 * h;
    // A beam: no strain across.
    let sheet = SheetMaterial {
        youngs_modulus_mpa: 1e3,
        poisson_ratio: 0.0,
        thickness_mm: 1.0,
        fold_line_factor: 1.0,
    };
    let mut goals = sheet.goals_by(&mesh, FaceBending::Plate);
    let end = |x: f64| (0..mesh.vertices.len()).filter(|v| x == mesh.vertices[*v].x).collect::<Vec<usize>>();
    let held = |at: f64, to: f64| end(at).into_iter().map(move |v| (v, to));
    for (v, x) in held(0.0, 0.0).chain(held(LENGTH, row[2] * LENGTH)) {
        let (point, target) = (SheetPoint::vertex(VertexId::new(v)), DVec3::new(x, mesh.vertices[v].y, 0.0));
        let stiffness = DVec3::splat(HOLD);
        goals.push(Box::new(Anchor { name: "end".into(), point, target, stiffness }));
    }
    // Symmetric: once its ends have passed each other, a strut that is pinned alone would swing round or twist.
    let (point, target) =
        (locate(&mesh, DVec2::new(0.5 * LENGTH, 0.5 * width)).unwrap(), DVec3::X * 0.5 * row[2] * LENGTH);
    goals.push(Box::new(Anchor { name: "middle".into(), point, target, stiffness: HOLD * DVec3::X }));
    // From an arc whose ends are where they shall be: they must not be let go.
    let turn = arc_of_chord(row[2]);
    let start = shaped(&mesh, |p| {
        let (r, a) = (LENGTH / (2.0 * turn), turn * (1.0 - 2.0 * p.x / LENGTH));
        DVec3::new(r * (turn.sin() - a.sin()), p.y, r * (a.cos() - turn.cos()))
    });
    let solver = Solver::Newton(NewtonOptions { ramp: vec![Scales::FULL], ..NewtonOptions::default() });
    let folded = fold(&mesh, &goals, &start, &solver, &mut |_| ()).unwrap();
    assert!(folded.solve.converged, "{:?}", folded.solve);
    // Mean of both ends: what holds the middle takes its share from them.
    let pull =
        |at: f64, to: f64| end(at).into_iter().map(|v| HOLD * (folded.positions[v].x - to)).sum::<f64>();
    let push = 0.5 * (pull(LENGTH, row[2] * LENGTH) - pull(0.0, 0.0));
    let euler = PI * PI * sheet.bending_stiffness() * width / (LENGTH * LENGTH);
    let rise = folded.positions.iter().map(|p| p.z).fold(0.0, f64::max);
    [push / euler, rise / LENGTH]
}

/// Relative errors of force and rise.
fn elastica_errors(columns: usize, row: [f64; 4]) -> [f64; 2] {
    let [force, rise] = pushed_together(columns, row);
    [(force / row[1] - 1.0).abs(), (rise / row[3] - 1.0).abs()]
}

#[test]
fn a_pinned_strut_is_the_elastica_on_irregular_meshes() {
    for row in ELASTICA {
        let errors = elastica_errors(80, row);
        assert!(errors.iter().all(|e| *e < 0.01), "{} degrees: {errors:?}", row[0]);
    }
}

#[test]
fn the_elastica_is_met_the_better_the_finer_the_mesh() {
    for row in [ELASTICA[2], ELASTICA[5]] {
        let errors = [24, 48, 96].map(|columns| elastica_errors(columns, row));
        // The table has four digits, and a sheet of 1 mm is not quite inextensible.
        assert!(errors[2].iter().all(|e| *e < 2e-3), "{} degrees: {errors:?}", row[0]);
        assert!(errors[0][0] > 2.0 * errors[1][0] && errors[1][0] > 1.5 * errors[2][0], "{errors:?}");
    }
}
