//! Rigid motions.

use glam::{DMat3, DQuat, DVec3};

/// A rigid motion `x ↦ R x + t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    /// Rotation, determinant 1.
    pub rotation: DMat3,
    /// Translation, mm.
    pub translation: DVec3,
}

impl RigidTransform {
    /// The motion that does nothing.
    pub const IDENTITY: Self = Self { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Image of a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// The motion back.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// The rotation's unit axis and its angle from 0 to π.
    pub fn axis_angle(&self) -> (DVec3, f64) {
        let (axis, angle) = DQuat::from_mat3(&self.rotation).normalize().to_axis_angle();
        if angle > std::f64::consts::PI { (-axis, std::f64::consts::TAU - angle) } else { (axis, angle) }
    }

    /// The rotation's rows.
    pub fn rows(&self) -> [[f64; 3]; 3] {
        self.rotation.transpose().to_cols_array_2d()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_and_angle_are_those_of_the_rotation() {
        let axis = DVec3::new(1., -2., 3.).normalize();
        for angle in [1e-6, 0.7, 3.1] {
            let m =
                RigidTransform { rotation: DMat3::from_axis_angle(axis, angle), translation: DVec3::ZERO };
            let (found, about) = m.axis_angle();
            assert!(found.distance(axis) < 1e-6 && (about - angle).abs() < 1e-9, "{found} {about}");
        }
    }

    #[test]
    fn inverse_undoes() {
        let m = RigidTransform {
            rotation: DMat3::from_axis_angle(DVec3::new(1., 2., 3.).normalize(), 0.7),
            translation: DVec3::new(5., -2., 9.),
        };
        let p = DVec3::new(0.3, 11.0, -4.0);
        assert!(m.inverse().point(m.point(p)).distance(p) < 1e-12);
    }
}
