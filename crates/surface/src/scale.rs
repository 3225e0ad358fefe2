//! How fine the folded mesh is where it turns.

use softfold_geometry::{EdgeClass, FlatMesh, TriangleId, VertexId};

/// Share of the strips that may be narrower than the width that is found: tips of bands that taper away must not rule
/// the whole lattice.
pub(crate) const NARROW_SHARE: f64 = 0.1;
/// For the width in the middle.
pub(crate) const MIDDLE: f64 = 0.5;

/// Width of the strips in the bands, mm: heights of the triangles on fold lines, but for the narrowest `share`. Without
/// fold lines the mean spacing of the mesh, the height of a triangle of mean area. None for a mesh without triangles.
pub(crate) fn strip_width_mm(mesh: &FlatMesh, share: f64) -> Option<f64> {
    if mesh.triangles.is_empty() {
        return None;
    }
    let mut heights: Vec<f64> = mesh
        .edges
        .iter()
        .filter(|e| matches!(e.class, EdgeClass::Fold { turn_rad, .. } if turn_rad != 0.0))
        .flat_map(|e| e.triangles.into_iter().flatten().map(|t| height_mm(mesh, t, e.vertices)))
        .collect();
    heights.sort_by(f64::total_cmp);
    let place = (share * heights.len() as f64) as usize;
    Some(heights.get(place).copied().unwrap_or_else(|| mean_height_mm(mesh)))
}

/// Height of a triangle over one of its edges, mm.
fn height_mm(mesh: &FlatMesh, triangle: TriangleId, edge: [VertexId; 2]) -> f64 {
    let [a, b] = edge.map(|v| mesh.vertices[v.index()]);
    2.0 * mesh.triangle_area_mm2(triangle) / a.distance(b)
}

/// Height of an equilateral triangle of mean area, mm.
fn mean_height_mm(mesh: &FlatMesh) -> f64 {
    let mean = mesh.area_mm2() / mesh.triangles.len() as f64;
    (3.0_f64.sqrt() * mean).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{BandSheet, scattered};
    use glam::DVec2;

    #[test]
    fn a_band_has_the_width_of_its_strips() {
        let band = BandSheet::right_angle(30.0, 5, 0.4);
        let wanted = 2.0 * 30.0 * (std::f64::consts::PI / 20.0).sin();
        let found = strip_width_mm(&band.sheet(13.0).mesh, NARROW_SHARE).unwrap();
        assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
    }

    #[test]
    fn a_mesh_without_folds_has_its_mean_spacing() {
        let found =
            strip_width_mm(&scattered(DVec2::new(120.0, 80.0), 10.0, |p| p.extend(0.0)).mesh, NARROW_SHARE)
                .unwrap();
        assert!((9.0..10.0).contains(&found), "{found}");
    }
}
