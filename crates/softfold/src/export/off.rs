//! OFF: triangles alone, as text. No comment says so: OpenMesh, for one, reads none.

use softfold_geometry::DVec3;
use softfold_geometry::text::number;
use std::fmt::Write;

/// Digits after the point: 1e-6 mm is far below every tolerance of a sheet.
const DECIMALS: usize = 6;

/// A triangle mesh; for the flat sheet give it z = 0.
pub fn mesh(positions: &[DVec3], triangles: &[[u32; 3]]) -> String {
    let mut out = format!("OFF\n{} {} 0\n", positions.len(), triangles.len());
    for p in positions {
        let [x, y, z] = p.to_array().map(|c| number(c, DECIMALS));
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{x} {y} {z}");
    }
    for [a, b, c] in triangles {
        let _ = writeln!(out, "3 {a} {b} {c}");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_come_before_vertices_and_triangles() {
        let text = mesh(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]);
        assert_eq!(text, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    }
}
