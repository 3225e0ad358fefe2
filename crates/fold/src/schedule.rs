//! States of folding: how far each crease is folded, and what it keeps of that when it is let go.
//!
//! A state is a mesh whose fold lines have the turns of that state; folding it from where the state before came to rest
//! gives the next. What the holds bend beyond the crease's own turn springs back when they are let go, and part of the
//! turn itself: with the plastic share p a crease that reached the turn θ is at rest at `θ' = θ₀ + p (θ − θ₀)`, where
//! θ₀ = 0 is the flat sheet that it was folded from. p = 1 keeps what was reached, p = 0 is an elastic sheet that never
//! was creased.

use softfold_geometry::{CreaseId, Edge, EdgeClass, EdgeId, FlatMesh, FoldedSheet};
use std::collections::BTreeMap;

/// The mesh with fold lines that turn by a share of their turns, by crease.
pub fn with_share(mesh: &FlatMesh, share: impl Fn(CreaseId) -> f64) -> FlatMesh {
    with_turns(mesh, |_, crease, turn_rad| share(crease) * turn_rad)
}

/// The mesh with the turns at which its fold lines are at rest when they are let go: of what each edge has reached, the
/// plastic share of its crease. Boundary edges and facets stay as they are.
pub fn after_release(sheet: &FoldedSheet, plastic_share: impl Fn(CreaseId) -> f64) -> FlatMesh {
    with_turns(&sheet.mesh, |edge, crease, turn_rad| {
        plastic_share(crease) * sheet.turn_rad(edge).unwrap_or(turn_rad)
    })
}

fn with_turns(mesh: &FlatMesh, turn: impl Fn(&Edge, CreaseId, f64) -> f64) -> FlatMesh {
    let edges = mesh.edges.iter().map(|e| match e.class {
        EdgeClass::Fold { crease, line, turn_rad } => {
            Edge { class: EdgeClass::Fold { crease, line, turn_rad: turn(e, crease, turn_rad) }, ..*e }
        }
        _ => *e,
    });
    FlatMesh { edges: edges.collect(), ..mesh.clone() }
}

/// The fold angle of each crease, rad: its fold lines' mean turns, by length, added up.
pub fn fold_angles_rad(sheet: &FoldedSheet) -> BTreeMap<CreaseId, f64> {
    let mut lines: BTreeMap<(CreaseId, u32), (f64, f64)> = BTreeMap::new();
    for (i, e) in sheet.mesh.edges.iter().enumerate() {
        if let (EdgeClass::Fold { crease, line, .. }, Some(turn)) = (e.class, sheet.turn_rad(e)) {
            let length = sheet.mesh.edge_length_mm(EdgeId::new(i));
            let sum = lines.entry((crease, line)).or_default();
            *sum = (sum.0 + length * turn, sum.1 + length);
        }
    }
    let mut angles = BTreeMap::new();
    for ((crease, _), (turns, length)) in lines {
        *angles.entry(crease).or_insert(0.0) += turns / length;
    }
    angles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::folded_strip;
    use crate::{Anchor, Goal, NewtonOptions, Scales, SheetMaterial, SheetPoint, Solver, fold};
    use glam::DVec3;
    use softfold_geometry::{SolveRecord, VertexId};

    const MATERIAL: SheetMaterial = SheetMaterial {
        youngs_modulus_mpa: 200.0,
        poisson_ratio: 0.3,
        thickness_mm: 2.0,
        fold_line_factor: 1.0,
    };

    /// Twelve columns of 5 mm with one straight fold in the middle.
    fn folded_once(degrees: f64) -> FlatMesh {
        folded_strip(12, 4, 5.0, |column| if column == 6 { degrees.to_radians() } else { 0.0 })
    }

    fn flat(mesh: &FlatMesh) -> Vec<DVec3> {
        mesh.vertices.iter().map(|p| p.extend(0.0)).collect()
    }

    fn run(mesh: &FlatMesh, goals: &[Box<dyn Goal>], start: &[DVec3], solver: &Solver) -> FoldedSheet {
        let sheet = fold(mesh, goals, start, solver, &mut |_| ()).unwrap();
        assert!(sheet.solve.converged, "{:?}", sheet.solve);
        sheet
    }

    fn angle_deg(sheet: &FoldedSheet) -> f64 {
        fold_angles_rad(sheet)[&CreaseId(0)].to_degrees()
    }

    #[test]
    fn the_angle_of_a_crease_adds_up_its_lines() {
        let mesh = folded_strip(4, 3, 5.0, |column| if column == 0 { 0.0 } else { 0.1 });
        // Three columns of fold lines, rolled so that each turns by 0.3 rad.
        let mut at = [DVec3::ZERO; 5];
        for k in 1..5 {
            let a = 0.3 * (k as f64 - 1.0);
            at[k] = at[k - 1] + 5.0 * DVec3::new(a.cos(), 0.0, a.sin());
        }
        let place = |p: &glam::DVec2| at[(p.x / 5.0).round() as usize] + DVec3::new(0.0, p.y, 0.0);
        let positions = mesh.vertices.iter().map(place).collect();
        let sheet = FoldedSheet { mesh, positions, solve: SolveRecord::default() };
        assert!((fold_angles_rad(&sheet)[&CreaseId(0)] - 0.9).abs() < 1e-12);
    }

    #[test]
    fn a_share_scales_turns_and_nothing_else() {
        let mesh = folded_once(80.0);
        assert_eq!(with_share(&mesh, |_| 1.0), mesh);
        let half = with_share(&mesh, |_| 0.5);
        half.check().unwrap();
        let sheet = run(&half, &MATERIAL.goals(&half), &flat(&half), &Solver::default());
        assert!((angle_deg(&sheet) - 40.0).abs() < 1e-6);
        assert_eq!((half.vertices, half.triangles), (mesh.vertices, mesh.triangles));
    }

    /// A straight fold is isometric at any angle: when the holds are gone it is at rest at p times what it had reached.
    #[test]
    fn a_fold_that_is_let_go_keeps_its_plastic_share_of_the_reached_turn() {
        let mesh = folded_once(60.0);
        let held = |mesh: &FlatMesh| {
            let mut goals = MATERIAL.goals(mesh);
            // Both ends are pulled together and up: the fold goes further than its own 60°.
            for (v, x) in [(0, 20.0), (4, 20.0), (60, 40.0), (64, 40.0)] {
                let target = DVec3::new(x, if v % 60 == 0 { 0.0 } else { 20.0 }, 25.0);
                let point = SheetPoint::vertex(VertexId(v));
                goals.push(Box::new(Anchor {
                    name: "hand".into(),
                    point,
                    target,
                    stiffness: DVec3::splat(20.0),
                }));
            }
            goals
        };
        let reached = run(&mesh, &held(&mesh), &flat(&mesh), &Solver::default());
        let before = angle_deg(&reached);
        assert!(before > 70.0, "the hold must bend it beyond its own turn: {before}");
        let warm = Solver::Newton(NewtonOptions { ramp: vec![Scales::FULL], ..NewtonOptions::default() });
        for p in [0.0, 0.35, 0.8, 1.0] {
            let released = after_release(&reached, |_| p);
            let sheet = run(&released, &MATERIAL.goals(&released), &reached.positions, &warm);
            assert!((angle_deg(&sheet) - p * before).abs() < 1e-5, "{p}: {} of {before}", angle_deg(&sheet));
            assert!(sheet.solve.energy < 1e-6, "{:?}", sheet.solve);
        }
    }
}
