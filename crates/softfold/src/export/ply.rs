//! PLY (binary little endian): the folded sheet with colours and figures at every vertex, the flat mesh with its edges.

use softfold_geometry::text::one_line;
use softfold_geometry::{DVec3, Edge, EdgeClass, FlatMesh};
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
    triangles.iter().for_each(|t| push_face(&mut out, *t));
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

/// A triangle mesh without colours; coordinates are `double`.
pub fn mesh(title: &str, positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut text = plain_header(title, positions.len(), triangles.len());
    text.push_str("end_header\n");
    let mut out = text.into_bytes();
    positions.iter().for_each(|p| push_point(&mut out, *p));
    triangles.iter().for_each(|t| push_face(&mut out, *t));
    out
}

/// All but the last line.
fn plain_header(title: &str, vertices: usize, faces: usize) -> String {
    format!(
        "ply\nformat binary_little_endian 1.0\ncomment softfold: {}\ncomment units: mm\n\
         element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {faces}\nproperty list uchar uint vertex_indices\n",
        one_line(title)
    )
}

fn push_point(out: &mut Vec<u8>, p: DVec3) {
    p.to_array().iter().for_each(|c| out.extend(c.to_le_bytes()));
}

fn push_face(out: &mut Vec<u8>, corners: [u32; 3]) {
    out.push(3);
    corners.iter().for_each(|v| out.extend(v.to_le_bytes()));
}

/// The flat mesh at z = 0 with an element `edge`: its vertices, `class` (0 facet, 1 fold, 2 free, 3 boundary), `crease` and
/// `line` of folds and `loop` of boundaries (−1 elsewhere), and the turn of folds in degrees, + valley. Coordinates are
/// `double`.
pub fn flat(title: &str, mesh: &FlatMesh) -> Vec<u8> {
    let mut text = plain_header(title, mesh.vertices.len(), mesh.triangles.len());
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "comment edge classes: 0 facet, 1 fold, 2 free, 3 boundary; turns in degrees, valleys positive\n\
         element edge {}\nproperty int vertex1\nproperty int vertex2\nproperty uchar class\nproperty int crease\n\
         property int line\nproperty int loop\nproperty float turn_deg\nend_header\n",
        mesh.edges.len()
    );
    let mut out = text.into_bytes();
    mesh.vertices.iter().for_each(|p| push_point(&mut out, p.extend(0.0)));
    mesh.triangles.iter().for_each(|t| push_face(&mut out, t.map(|v| v.0)));
    mesh.edges.iter().for_each(|e| push_edge(&mut out, e));
    out
}

/// Number of what an edge is not part of.
const NONE: u32 = u32::MAX; // −1 to who reads it as `int`

fn push_edge(out: &mut Vec<u8>, edge: &Edge) {
    let (class, crease, line, loop_id, turn_rad) = match edge.class {
        EdgeClass::Facet => (0, NONE, NONE, NONE, 0.0),
        EdgeClass::Fold { crease, line, turn_rad } => (1, crease.0, line, NONE, turn_rad),
        EdgeClass::Free => (2, NONE, NONE, NONE, 0.0),
        EdgeClass::Boundary { loop_id } => (3, NONE, NONE, loop_id.0, 0.0),
    };
    edge.vertices.iter().for_each(|v| out.extend(v.0.to_le_bytes()));
    out.push(class);
    [crease, line, loop_id].iter().for_each(|n| out.extend(n.to_le_bytes()));
    out.extend((turn_rad.to_degrees() as f32).to_le_bytes());
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
