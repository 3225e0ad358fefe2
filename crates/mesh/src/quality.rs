//! How good the triangles are.

use softfold_geometry::{FlatMesh, TriangleId};

/// Angles of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Smallest angle, degrees.
    pub min_angle_deg: f64,
    /// Median over the triangles of their smallest angle, degrees.
    pub median_min_angle_deg: f64,
}

/// Measures a mesh; zeros if it has no triangle.
pub fn quality(mesh: &FlatMesh) -> Quality {
    let smallest =
        |t: usize| mesh.angles_rad(TriangleId::new(t)).into_iter().fold(f64::MAX, f64::min).to_degrees();
    let mut angles: Vec<f64> = (0..mesh.triangles.len()).map(smallest).collect();
    angles.sort_by(f64::total_cmp);
    let at = |i: usize| angles.get(i).copied().unwrap_or(0.0);
    Quality { min_angle_deg: at(0), median_min_angle_deg: at(angles.len() / 2) }
}
