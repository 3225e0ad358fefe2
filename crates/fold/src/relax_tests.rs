//! Newton and eq. 4 from the same start, on four patterns: one energy.

use crate::goal::{ClampLength, Goal};
use crate::material::FaceBending;
use crate::relax::Momentum;
use crate::testing::folded_strip;
use crate::{RelaxOptions, SheetMaterial, SheetPoint, Solver, fold, upright};
use glam::DVec2;
use softfold_geometry::{FlatMesh, VertexId};
use std::f64::consts::TAU;

/// How much the energies may differ, relative.
const DIFFERENCE: f64 = 1e-6;

/// Thick for its size: eq. 4 takes the longer the more the membrane outweighs bending.
const MATERIAL: SheetMaterial =
    SheetMaterial { youngs_modulus_mpa: 10.0, poisson_ratio: 0.3, thickness_mm: 4.0, fold_line_factor: 10.0 };

/// Squares of 5 mm with folds of these turns, in degrees, at their columns; each vertex is put elsewhere on the sheet.
fn sheet(columns: usize, rows: usize, turns: &[(usize, f64)], place: impl Fn(DVec2) -> DVec2) -> FlatMesh {
    let turn = |column| turns.iter().find(|t| t.0 == column).map_or(0.0, |t| t.1.to_radians());
    let mut mesh = folded_strip(columns, rows, 5.0, turn);
    mesh.vertices.iter_mut().for_each(|p| *p = place(*p));
    mesh.check().unwrap();
    mesh
}

/// Turns of a soft fold in three strips from a column on.
fn soft(column: usize, degrees: f64) -> [(usize, f64); 4] {
    [(0, 1.0 / 6.0), (1, 1.0 / 3.0), (2, 1.0 / 3.0), (3, 1.0 / 6.0)]
        .map(|(k, share)| (column + k, share * degrees))
}

fn ring(p: DVec2) -> DVec2 {
    (90.0 + p.x) * DVec2::from_angle(p.y / 110.0)
}

fn wave(p: DVec2) -> DVec2 {
    p + 5.0 * DVec2::X * (TAU * p.y / 70.0).sin()
}

fn fan(p: DVec2) -> DVec2 {
    DVec2::new((p.x - 40.0) * (1.0 + 0.008 * p.y), p.y)
}

/// A band from one corner of a strip of so many rows to the other end of its first row.
fn band(mesh: &FlatMesh, rows: usize) -> Box<dyn Goal> {
    let ends = [0, mesh.vertices.len() - rows - 1].map(|v| SheetPoint::vertex(VertexId::new(v)));
    Box::new(ClampLength { name: "band".into(), ends, rest_mm: 20.0, stiffness: 1.0 })
}

#[test]
fn newton_and_eq_4_end_at_the_same_energy_on_four_patterns() {
    let s_curves: Vec<(usize, f64)> = soft(3, 50.0).into_iter().chain(soft(9, -50.0)).collect();
    let pleats = [(4, 60.0), (8, -60.0), (12, 60.0)];
    let patterns = [
        ("soft arc", sheet(10, 10, &soft(4, 70.0), ring), None, FaceBending::Hinges),
        ("mountain and valley S", sheet(15, 12, &s_curves, wave), None, FaceBending::Hinges),
        ("fan of sharp folds, held", sheet(16, 8, &pleats, fan), Some(8), FaceBending::Hinges),
        ("soft arc of a plate, held", sheet(10, 10, &soft(4, 70.0), ring), Some(10), FaceBending::Plate),
    ];
    for (name, mesh, held, faces) in patterns {
        let mut goals = MATERIAL.goals_by(&mesh, faces);
        goals.extend(held.map(|rows| band(&mesh, rows)));
        let relax = RelaxOptions {
            momentum: Momentum::Share(0.98),
            relative_gradient: 1e-6,
            max_iterations: 200_000,
            ..RelaxOptions::default()
        };
        let [newton, relax] = [Solver::default(), Solver::Relax(relax)]
            .map(|solver| fold(&mesh, &goals, &upright(&mesh), &solver, &mut |_| ()).unwrap().solve);
        let difference = (newton.energy - relax.energy).abs() / newton.energy;
        assert!(newton.converged && newton.energy > 1e-2, "{name}: {newton:?}");
        assert!(difference < DIFFERENCE, "{name}: {newton:?} {relax:?}");
    }
}
