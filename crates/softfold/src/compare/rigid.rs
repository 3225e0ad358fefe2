//! Best rigid motions: between pairs of points (Kabsch) and, a step at a time, along given directions.

use faer::{Mat, Side};
use softfold_geometry::{DMat3, DVec3, RigidTransform};

/// Directions whose weight is below this share of the strongest one's are free: nothing holds them.
const FREE: f64 = 1e-10;

/// A small motion about a place: `p ↦ p + turn × (p − about) + shift`, to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) about: DVec3,
    pub(super) turn: DVec3,
    pub(super) shift: DVec3,
    /// How many of the six directions of motion nothing held.
    pub(super) free: u8,
}

/// One equation of a step: a point shall move by `by` along the unit vector `along`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) at: DVec3,
    pub(super) along: DVec3,
    pub(super) by: f64,
    pub(super) weight: f64,
}

/// The rigid motion that brings weighted points nearest to their partners in the mean square (Kabsch 1976, by singular
/// values); never a mirror image. None if a matrix has no decomposition.
pub(super) fn kabsch(pairs: &[(DVec3, DVec3, f64)]) -> Option<RigidTransform> {
    let total: f64 = pairs.iter().map(|p| p.2).sum();
    let from = pairs.iter().map(|(p, _, w)| *p * *w).sum::<DVec3>() / total;
    let to = pairs.iter().map(|(_, q, w)| *q * *w).sum::<DVec3>() / total;
    let mut covariance = Mat::<f64>::zeros(3, 3);
    for (p, q, w) in pairs {
        let (p, q) = (*p - from, *q - to);
        for i in 0..3 {
            for j in 0..3 {
                covariance[(i, j)] += w * q[i] * p[j];
            }
        }
    }
    let svd = covariance.svd().ok()?;
    let matrix = |m: faer::MatRef<'_, f64>| {
        DMat3::from_cols_array_2d(&std::array::from_fn(|j| std::array::from_fn(|i| m[(i, j)])))
    };
    let (u, v) = (matrix(svd.U()), matrix(svd.V()));
    // The least singular value takes the sign that keeps the hand.
    let hand = DVec3::new(1.0, 1.0, (u.determinant() * v.determinant()).signum());
    let rotation = orthonormal(u * DMat3::from_diagonal(hand) * v.transpose());
    (rotation.is_finite()).then(|| RigidTransform { rotation, translation: to - rotation * from })
}

/// Eigenvalues of a symmetric matrix, largest first, with their vectors, right-handed.
pub(super) fn principal(m: DMat3) -> Option<([f64; 3], DMat3)> {
    let eigen = Mat::from_fn(3, 3, |i, j| m.col(j)[i]).self_adjoint_eigen(Side::Lower).ok()?;
    let (u, s) = (eigen.U(), eigen.S().column_vector());
    let axis = |k: usize| DVec3::new(u[(0, k)], u[(1, k)], u[(2, k)]);
    let (x, y) = (axis(2), axis(1));
    Some(([s[2], s[1], s[0]], DMat3::from_cols(x, y, x.cross(y))))
}

/// Least squares of all rows; what no row holds stays as it is.
pub(super) fn step(rows: &[Row]) -> Option<Step> {
    let total: f64 = rows.iter().map(|r| r.weight).sum();
    let about = rows.iter().map(|r| r.at * r.weight).sum::<DVec3>() / total;
    let spread = rows.iter().map(|r| r.weight * r.at.distance_squared(about)).sum::<f64>() / total;
    let arm_mm = spread.sqrt(); // turns in units of this, so that all six are lengths
    let (mut matrix, mut right) = (Mat::<f64>::zeros(6, 6), [0.0; 6]);
    for r in rows {
        let turn = (r.at - about).cross(r.along) / arm_mm;
        let j = [turn.x, turn.y, turn.z, r.along.x, r.along.y, r.along.z];
        for a in 0..6 {
            right[a] += r.weight * r.by * j[a];
            (0..6).for_each(|b| matrix[(a, b)] += r.weight * j[a] * j[b]);
        }
    }
    let (x, free) = held_part(&matrix, right)?;
    let part = |k: usize| DVec3::new(x[k], x[k + 1], x[k + 2]);
    Some(Step { about, turn: part(0) / arm_mm, shift: part(3), free })
}

/// The solution in the directions that the matrix holds, and how many it does not.
fn held_part(matrix: &Mat<f64>, right: [f64; 6]) -> Option<([f64; 6], u8)> {
    let eigen = matrix.self_adjoint_eigen(Side::Lower).ok()?;
    let (u, s) = (eigen.U(), eigen.S().column_vector());
    let strongest = s[5];
    if !(strongest.is_finite() && strongest > 0.0) {
        return None;
    }
    let (mut x, mut free) = ([0.0; 6], 0);
    for k in 0..6 {
        if s[k] <= FREE * strongest {
            free += 1;
            continue;
        }
        let share = (0..6).map(|i| u[(i, k)] * right[i]).sum::<f64>() / s[k];
        (0..6).for_each(|i| x[i] += share * u[(i, k)]);
    }
    Some((x, free))
}

impl Step {
    /// A part of it as a rigid motion.
    pub(super) fn motion(&self, share: f64) -> RigidTransform {
        let (angle, shift) = (share * self.turn.length(), share * self.shift);
        let rotation = match self.turn.try_normalize() {
            Some(axis) => DMat3::from_axis_angle(axis, angle),
            None => DMat3::IDENTITY,
        };
        RigidTransform { rotation, translation: self.about + shift - rotation * self.about }
    }

    /// How far it moves anything within `reach_mm` of its centre, mm.
    pub(super) fn length_mm(&self, reach_mm: f64) -> f64 {
        self.turn.length() * reach_mm + self.shift.length()
    }
}

/// `second` after `first`; the rotation is made orthonormal again.
pub(super) fn after(second: &RigidTransform, first: &RigidTransform) -> RigidTransform {
    RigidTransform {
        rotation: orthonormal(second.rotation * first.rotation),
        translation: second.point(first.translation),
    }
}

/// The rotation nearest to a matrix that is almost one (Higham 1986).
pub(super) fn orthonormal(m: DMat3) -> DMat3 {
    /// The error squares at every turn; from a tenth four are enough.
    const TURNS: usize = 6;
    (0..TURNS).fold(m, |r, _| (r + r.inverse().transpose()) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud() -> Vec<DVec3> {
        let chance = |k: usize| (12.9898 * (k as f64 + 1.0)).sin() * 43_758.545_3 % 1.0;
        (0..40).map(|i| 300.0 * DVec3::new(chance(i), 2.0 * chance(i + 50), 0.3 * chance(i + 100))).collect()
    }

    fn motion() -> RigidTransform {
        let rotation = DMat3::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 2.3);
        RigidTransform { rotation, translation: DVec3::new(800.0, -20.0, 333.0) }
    }

    #[test]
    fn kabsch_finds_a_motion_exactly_and_never_a_mirror_image() {
        let pairs: Vec<_> = cloud().into_iter().map(|p| (p, motion().point(p), 1.0)).collect();
        let found = kabsch(&pairs).unwrap();
        assert!(pairs.iter().all(|(p, q, _)| found.point(*p).distance(*q) < 1e-11));
        let mirrored: Vec<_> = cloud().into_iter().map(|p| (p, DVec3::new(-p.x, p.y, p.z), 1.0)).collect();
        let found = kabsch(&mirrored).unwrap();
        assert!((found.rotation.determinant() - 1.0).abs() < 1e-12);
        assert!(mirrored.iter().any(|(p, q, _)| found.point(*p).distance(*q) > 50.0));
    }

    #[test]
    fn a_step_solves_small_motions_and_leaves_what_nothing_holds() {
        let small =
            Step { about: DVec3::ZERO, turn: 1e-7 * DVec3::ONE, shift: DVec3::new(1e-5, 0.0, 2e-5), free: 0 };
        let row = |(i, p): (usize, DVec3)| {
            let along = [DVec3::X, DVec3::Y, DVec3::Z][i % 3];
            Row { at: p, along, by: (small.motion(1.0).point(p) - p).dot(along), weight: 1.0 }
        };
        let rows: Vec<Row> = cloud().into_iter().enumerate().map(row).collect();
        let found = step(&rows).unwrap();
        let far = DVec3::new(700.0, 10.0, -400.0);
        assert!(found.motion(1.0).point(far).distance(small.motion(1.0).point(far)) < 1e-10);
        assert_eq!(found.free, 0);
        // A plane holds two turns and a shift.
        let flat = |p: DVec3| Row { at: p.with_z(0.0), along: DVec3::Z, by: 2.0, weight: 1.0 };
        let found = step(&cloud().into_iter().map(flat).collect::<Vec<_>>()).unwrap();
        assert_eq!(found.free, 3);
        assert!(found.motion(1.0).point(DVec3::ZERO).distance(2.0 * DVec3::Z) < 1e-9);
    }

    #[test]
    fn principal_axes_are_sorted_and_right_handed() {
        let r = motion().rotation;
        let m = r * DMat3::from_diagonal(DVec3::new(2.0, 7.0, 1.0)) * r.transpose();
        let (values, axes) = principal(m).unwrap();
        assert!(values.iter().zip([7.0, 2.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(
            (axes.determinant() - 1.0).abs() < 1e-12 && (m * axes.x_axis).distance(7.0 * axes.x_axis) < 1e-12
        );
    }
}
