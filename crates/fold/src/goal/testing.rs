//! The proof of any goal: finite differences, positive semidefiniteness, rigid motions, descent.

use super::*;
use crate::Objective;
use faer::{Mat, Side};
use glam::DQuat;

/// Step of the differences, mm; right for shapes of a few mm.
const STEP: f64 = 1e-4;

/// Gradient against energy, Hessian against gradient, moves against gradient, at `x`.
pub(crate) fn prove(goal: Box<dyn Goal>, x: &[DVec3], tolerance: f64) {
    prove_by_steps(&[goal], x, STEP, tolerance);
}

/// The same with the step of the differences, mm: short against the smallest height of a triangle.
pub(crate) fn prove_by_steps(goals: &[Box<dyn Goal>], x: &[DVec3], e: f64, tolerance: f64) {
    let objective = Objective::new(x.len(), goals);
    let gradient = objective.gradient(x, Scales::FULL).sum;
    let hessian = objective.hessian(x, Curvature::Exact, Scales::FULL).to_dense();
    let scale = 1e-9 + gradient.iter().map(|g| g.length()).fold(0.0, f64::max);
    let stiffness = 1e-9 + hessian.iter().flatten().fold(0.0_f64, |m, h| m.max(h.abs()));
    for i in 0..3 * x.len() {
        let moved = |d: f64| {
            let mut y = x.to_vec();
            y[i / 3][i % 3] += d;
            y
        };
        let (p, m) = (moved(e), moved(-e));
        let slope = (objective.energy(&p, Scales::FULL) - objective.energy(&m, Scales::FULL)) / (2.0 * e);
        assert!(
            (slope - gradient[i / 3][i % 3]).abs() < tolerance * (scale + stiffness * e),
            "gradient {i}: {slope} {}",
            gradient[i / 3][i % 3]
        );
        let (gp, gm) = (objective.gradient(&p, Scales::FULL).sum, objective.gradient(&m, Scales::FULL).sum);
        for j in 0..3 * x.len() {
            let d = (gp[j / 3][j % 3] - gm[j / 3][j % 3]) / (2.0 * e);
            assert!(
                (d - hessian[i][j]).abs() < tolerance * stiffness,
                "hessian {i} {j}: {d} {}",
                hessian[i][j]
            );
        }
    }
    prove_moves(&objective, x, &gradient, tolerance * scale);
}

fn prove_moves(objective: &Objective<'_>, x: &[DVec3], gradient: &[DVec3], tolerance: f64) {
    let (weighted, _) = objective.moves(x);
    for (w, g) in weighted.iter().zip(gradient) {
        assert!((*w + *g).length() < tolerance, "moves are not the negative gradient: {w} {g}");
    }
}

/// The convex Hessian has no negative eigenvalue.
pub(crate) fn prove_convex(goals: &[Box<dyn Goal>], x: &[DVec3]) {
    let dense = Objective::new(x.len(), goals).hessian(x, Curvature::Convex, Scales::FULL).to_dense();
    let matrix = Mat::from_fn(dense.len(), dense.len(), |i, j| dense[i][j]);
    let values = matrix.self_adjoint_eigenvalues(Side::Lower).unwrap();
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(values.iter().all(|v| *v >= -1e-12 * largest), "{values:?}");
}

/// Where the goal has no force, its two Hessians are the same.
pub(crate) fn prove_gauss_newton(goals: &[Box<dyn Goal>], x: &[DVec3], tolerance: f64) {
    let objective = Objective::new(x.len(), goals);
    let [exact, convex] =
        [Curvature::Exact, Curvature::Convex].map(|c| objective.hessian(x, c, Scales::FULL).to_dense());
    let largest = convex.iter().flatten().fold(0.0_f64, |m, h| m.max(h.abs()));
    for (e, c) in exact.iter().flatten().zip(convex.iter().flatten()) {
        assert!((e - c).abs() <= tolerance * largest, "{e} {c}");
    }
}

/// The energy does not see rigid motions: it stays, and its forces have neither sum nor moment.
pub(crate) fn prove_rigid_invariance(goals: &[Box<dyn Goal>], x: &[DVec3]) {
    let objective = Objective::new(x.len(), goals);
    let energy = objective.energy(x, Scales::FULL);
    let gradient = objective.gradient(x, Scales::FULL);
    let rotation = DQuat::from_axis_angle(DVec3::new(0.6, -0.48, 0.64), 2.1);
    let moved: Vec<DVec3> = x.iter().map(|p| rotation * *p + DVec3::new(3.0, -5.0, 8.0)).collect();
    let after = objective.energy(&moved, Scales::FULL);
    let reach = x.iter().map(|p| p.length()).fold(1.0, f64::max);
    assert!((after - energy).abs() <= 1e-9 * energy + 1e-18, "{energy} {after}");
    let force: DVec3 = gradient.sum.iter().sum();
    let moment: DVec3 = x.iter().zip(&gradient.sum).map(|(p, g)| p.cross(*g)).sum();
    let scale = gradient.scale() + f64::MIN_POSITIVE;
    assert!(force.length() < 1e-10 * scale && moment.length() < 1e-9 * scale * reach, "{force} {moment}");
    let turned = objective.gradient(&moved, Scales::FULL).sum;
    for (t, g) in turned.iter().zip(&gradient.sum) {
        assert!((*t - rotation * *g).length() < 1e-8 * scale, "{t} {g}");
    }
}

/// One step of eq. 4 with this goal alone does not raise its energy.
pub(crate) fn prove_descent(goals: &[Box<dyn Goal>], x: &[DVec3]) {
    let objective = Objective::new(x.len(), goals);
    let (weighted, weights) = objective.moves(x);
    let moved = |(i, p): (usize, &DVec3)| if weights[i] > 0.0 { *p + weighted[i] / weights[i] } else { *p };
    let after: Vec<DVec3> = x.iter().enumerate().map(moved).collect();
    let energies = [x, &after].map(|x| objective.energy(x, Scales::FULL));
    assert!(energies[1] <= energies[0] + 1e-12 * energies[0].abs() + 1e-20, "{energies:?}");
}

#[test]
fn cross_matrix_is_the_cross_product() {
    let (a, b) = (DVec3::new(1., -2., 3.), DVec3::new(0.5, 4., -1.));
    assert!((cross_matrix(a) * b - a.cross(b)).length() < 1e-15);
    assert!((outer(a, b) * DVec3::ONE - a * b.element_sum()).length() < 1e-15);
}
