//! Steps along a direction, with what it turns the sheet as a whole turned exactly.
//!
//! A sheet that is held weakly swings into place. Along a straight line that stretches it by half the angle's square,
//! and a stiff membrane allows tiny steps only; turned exactly it costs nothing.

use crate::objective::norm_squared;
use glam::{DMat3, DQuat, DVec3};

/// Smallest over largest determinant-like measure of the inertia below which points are on a line.
const ON_A_LINE: f64 = 1e-12;

/// A direction for every vertex, taken apart into a rigid motion and the rest.
pub(crate) struct Motion<'a> {
    x: &'a [DVec3],
    centre: DVec3,
    shift: DVec3,
    /// Axis times angle, rad.
    turn: DVec3,
    /// What the rigid motion leaves.
    rest: Vec<DVec3>,
}

impl<'a> Motion<'a> {
    /// The rigid motion that is nearest to `direction` in the sense of least squares.
    pub(crate) fn new(x: &'a [DVec3], direction: &[DVec3]) -> Self {
        let count = x.len().max(1) as f64;
        let centre = x.iter().sum::<DVec3>() / count;
        let shift = direction.iter().sum::<DVec3>() / count;
        let (mut spin, mut inertia) = (DVec3::ZERO, DMat3::ZERO);
        for (p, d) in x.iter().zip(direction) {
            let arm = *p - centre;
            spin += arm.cross(*d);
            inertia += DMat3::IDENTITY * arm.length_squared() - crate::goal::outer(arm, arm);
        }
        let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
        let fixed = inertia.determinant() > ON_A_LINE * size.powi(3);
        let turn = if fixed { inertia.inverse() * spin } else { DVec3::ZERO };
        let rest = x.iter().zip(direction).map(|(p, d)| *d - shift - turn.cross(*p - centre)).collect();
        Self { x, centre, shift, turn, rest }
    }

    /// Root mean square of what the rigid motion leaves, mm.
    pub(crate) fn rest_rms_mm(&self) -> f64 {
        (norm_squared(&self.rest) / self.rest.len().max(1) as f64).sqrt()
    }

    /// Positions after this share of the motion; to first order `x + share · direction`.
    pub(crate) fn at(&self, share: f64) -> Vec<DVec3> {
        let rotation = DMat3::from_quat(DQuat::from_scaled_axis(share * self.turn));
        let to = self.centre + share * self.shift;
        let moved = |(p, rest): (&DVec3, &DVec3)| to + rotation * (*p - self.centre + share * *rest);
        self.x.iter().zip(&self.rest).map(moved).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<DVec3> {
        (0..20)
            .map(|i| DVec3::new((1.3 * f64::from(i)).sin(), f64::from(i % 5), 0.2 * f64::from(i)))
            .collect()
    }

    #[test]
    fn a_turn_keeps_all_distances() {
        let x = points();
        let turn = DVec3::new(0.3, -0.5, 0.2);
        let direction: Vec<DVec3> = x.iter().map(|p| turn.cross(*p) + DVec3::Y).collect();
        let moved = Motion::new(&x, &direction).at(1.0);
        for i in 1..x.len() {
            assert!((moved[i].distance(moved[0]) - x[i].distance(x[0])).abs() < 1e-12);
        }
        assert!(moved[3].distance(x[3] + direction[3]) > 1e-3);
    }

    #[test]
    fn small_steps_follow_the_direction() {
        let x = points();
        let direction: Vec<DVec3> = x.iter().map(|p| DVec3::new(p.y.sin(), p.x * p.z, 1.0 - p.y)).collect();
        let error = |share: f64| {
            let moved = Motion::new(&x, &direction).at(share);
            let off = |i: usize| moved[i].distance(x[i] + share * direction[i]);
            (0..x.len()).map(off).fold(0.0, f64::max)
        };
        let order = (error(1e-2) / error(1e-3)).log10();
        assert!((order - 2.0).abs() < 0.1, "error falls with the power {order}");
    }

    #[test]
    fn points_on_a_line_move_straight() {
        let x = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
        let direction = [DVec3::Y, DVec3::ZERO, -DVec3::Y];
        assert_eq!(Motion::new(&x, &direction).at(1.0), [DVec3::Y, DVec3::X, DVec3::new(2.0, -1.0, 0.0)]);
    }
}
