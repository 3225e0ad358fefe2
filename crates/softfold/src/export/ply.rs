//! Coloured PLY (binary little endian): the folded sheet with its figures at every vertex.

use softfold_geometry::DVec3;
use softfold_geometry::text::one_line;
use std::fmt::Write;

/// Scalars beyond this are cut to it, and NaN becomes 0: viewers spoil their colour range on infinities
/// (the bend radius of a flat place is one).
const LARGEST_SCALAR: f64 = 1e9;

/// One figure a vertex, such as `area_error` or `bend_radius`.
#[derive(Clone, Copy, Debug)]
pub struct Scalar<'a> {
    /// Name of the property: letters, digits and `_`.
    pub name: &'a str,
    /// A value per vertex.
    pub values: &'a [f64],
}

/// A mesh with a colour and any number of figures at each vertex. Coordinates are `float` (6e-5 mm on
/// a sheet of a metre), which every reader takes. A vertex without a colour is grey, without a figure 0.
pub fn coloured(
    title: &str,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    colours: &[[u8; 3]],
    scalars: &[Scalar<'_>],
) -> Vec<u8> {
    let mut out = header(title, positions.len(), triangles.len(), scalars).into_bytes();
    for (i, p) in positions.iter().enumerate() {
        p.to_array().iter().for_each(|c| out.extend((*c as f32).to_le_bytes()));
        out.extend(colours.get(i).unwrap_or(&[128; 3]));
        for scalar in scalars {
            out.extend(bounded(scalar.values.get(i).copied().unwrap_or(0.0)).to_le_bytes());
        }
    }
    for t in triangles {
        out.push(3);
        t.iter().for_each(|v| out.extend(v.to_le_bytes()));
    }
    out
}

fn header(title: &str, vertices: usize, faces: usize, scalars: &[Scalar<'_>]) -> String {
    let mut text = format!(
        "ply\nformat binary_little_endian 1.0\ncomment softfold: {}\ncomment units: mm\nelement vertex {vertices}\n\
         property float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n",
        one_line(title)
    );
    for s in scalars {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "property float {}", s.name);
    }
    let _ = write!(text, "element face {faces}\nproperty list uchar uint vertex_indices\nend_header\n");
    text
}

fn bounded(value: f64) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(-LARGEST_SCALAR, LARGEST_SCALAR) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_body_has_the_declared_size_and_values() {
        let values = [0.25, f64::INFINITY, f64::NAN];
        let scalars = [Scalar { name: "bend_radius", values: &values }];
        let p = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let bytes = coloured("s", &p, &[[0, 1, 2]], &[[1, 2, 3]; 3], &scalars);
        let end = b"end_header\n";
        let start = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let body = &bytes[start..];
        assert_eq!(body.len(), 3 * (12 + 3 + 4) + 13);
        assert_eq!(body[12..15], [1, 2, 3]);
        assert_eq!(body[15..19], 0.25_f32.to_le_bytes());
        assert_eq!(body[34..38], 1e9_f32.to_le_bytes());
        assert_eq!(body[53..57], 0_f32.to_le_bytes());
    }
}
