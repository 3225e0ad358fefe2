//! Rigid motions.

use glam::{DMat3, DVec3};

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

    /// The rotation's rows.
    pub fn rows(&self) -> [[f64; 3]; 3] {
        self.rotation.transpose().to_cols_array_2d()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
