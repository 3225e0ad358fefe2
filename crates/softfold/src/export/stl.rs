//! Binary STL. The format has no unit; the header says mm.

use softfold_geometry::text::one_line;
use softfold_geometry::{DVec3, TriMesh};

/// Length of the header, fixed by the format.
const HEADER_BYTES: usize = 80;
/// Length of one triangle: normal, three corners, attribute.
const TRIANGLE_BYTES: usize = 50;

/// A mesh as binary STL, single precision.
pub fn binary(title: &str, mesh: &TriMesh) -> Vec<u8> {
    let mut out = header(title);
    out.reserve(4 + mesh.triangles.len() * TRIANGLE_BYTES);
    out.extend((mesh.triangles.len() as u32).to_le_bytes());
    for &t in &mesh.triangles {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        [normal, a, b, c].into_iter().for_each(|p| push(&mut out, p));
        out.extend([0, 0]);
    }
    out
}

/// Never starts with `solid`, by which readers tell the text form.
fn header(title: &str) -> Vec<u8> {
    let mut out = format!("softfold STL, mm: {}", one_line(title)).into_bytes();
    out.resize(HEADER_BYTES, b' ');
    out
}

fn push(out: &mut Vec<u8>, p: DVec3) {
    p.to_array().iter().for_each(|c| out.extend((*c as f32).to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_count_and_normal() {
        let mesh =
            TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]; 2] };
        let bytes = binary(&"ü".repeat(99), &mesh);
        assert_eq!(bytes.len(), 84 + 2 * 50);
        assert_eq!(bytes[80..84], 2_u32.to_le_bytes());
        assert_eq!(bytes[84 + 8..84 + 12], 1_f32.to_le_bytes());
        assert_eq!(bytes, binary(&"ü".repeat(99), &mesh));
    }
}
