//! How far two shapes are from each other, wherever they lie.

use softfold_geometry::{DMat3, DVec3};

/// Rotation about `from`, then shift to `to`, that brings points nearest to their targets.
pub(crate) struct Alignment {
    rotation: DMat3,
    from: DVec3,
    to: DVec3,
}

impl Alignment {
    /// The best one in the mean square; a mirror image is far from its original.
    ///
    /// The rotation is the orthogonal factor of the covariance's polar decomposition (Higham 1986: the mean of a matrix
    /// and its inverse transpose converges to it).
    pub(crate) fn of(points: &[DVec3], targets: &[DVec3]) -> Self {
        let mean = |p: &[DVec3]| p.iter().sum::<DVec3>() / p.len() as f64;
        let (from, to) = (mean(points), mean(targets));
        let pairs = points.iter().zip(targets).map(|(p, t)| (*p - from, *t - to));
        let mut rotation =
            pairs.fold(DMat3::ZERO, |sum, (p, t)| sum + DMat3::from_cols(t * p.x, t * p.y, t * p.z));
        assert!(rotation.determinant() > 0.0, "a mirror image, or flat");
        for _ in 0..60 {
            rotation = (rotation + rotation.inverse().transpose()) * 0.5;
        }
        Self { rotation, from, to }
    }

    pub(crate) fn place(&self, p: DVec3) -> DVec3 {
        self.rotation * (p - self.from) + self.to
    }
}

/// Root mean square distance of corresponding points after the best rotation and shift of `points`.
pub(crate) fn aligned_rms_mm(points: &[DVec3], targets: &[DVec3]) -> f64 {
    let aligned = Alignment::of(points, targets);
    let sum: f64 = points.iter().zip(targets).map(|(p, t)| aligned.place(*p).distance_squared(*t)).sum();
    (sum / points.len() as f64).sqrt()
}

/// A repeatable disturbance of every point, at most `size` along each axis.
pub(crate) fn shaken(points: &[DVec3], size: f64) -> Vec<DVec3> {
    let noise = |k: f64| (12.9898 * k).sin() * 43_758.545_3 % 1.0;
    let shake = |i: usize| DVec3::new(noise(i as f64), noise(i as f64 + 0.3), noise(i as f64 + 0.7));
    points.iter().enumerate().map(|(i, p)| *p + size * shake(i)).collect()
}
