//! Triangle meshes in space: printed parts, boards, pictures.

use glam::DVec3;

/// An indexed triangle mesh in space, mm. Closed meshes are oriented outward.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, mm.
    pub positions: Vec<DVec3>,
    /// Corner indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|i| self.positions[i as usize])
    }

    /// Enclosed volume of a closed mesh, mm³ (sum of signed tetrahedra about a corner).
    pub fn volume_mm3(&self) -> f64 {
        let Some(&o) = self.positions.first() else { return 0.0 };
        let tetra = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(*t);
            (a - o).dot((b - o).cross(c - o)) / 6.0
        };
        self.triangles.iter().map(tetra).sum()
    }

    /// Surface area, mm².
    pub fn area_mm2(&self) -> f64 {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(*t);
            0.5 * (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(area).sum()
    }

    /// Lower and upper corner of the box around it; zeros if empty.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let Some(&first) = self.positions.first() else { return (DVec3::ZERO, DVec3::ZERO) };
        self.positions.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_far_away_has_its_volume() {
        let far = DVec3::splat(1e6);
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 6.0 + far).to_vec();
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        assert!((TriMesh { positions, triangles }.volume_mm3() - 36.0).abs() < 1e-9);
    }
}
