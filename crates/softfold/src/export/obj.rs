//! Wavefront OBJ: triangle meshes, quad cages, and the flat mesh with its lines.

use super::lines::lines;
use softfold_geometry::text::{number, one_line};
use softfold_geometry::{DVec3, FlatMesh};
use std::fmt::Write;

/// Digits after the point: 1e-6 mm is far below every tolerance of a sheet.
const DECIMALS: usize = 6;

/// A triangle mesh; for the flat sheet give it z = 0.
pub fn mesh(title: &str, positions: &[DVec3], triangles: &[[u32; 3]]) -> String {
    document(title, positions, triangles)
}

/// Quad cages, for subdivision modelling: faces keep their four corners. One is one object; several are one object each,
/// `face-1` and so on.
pub fn cages(title: &str, cages: &[(&[DVec3], &[[u32; 4]])]) -> String {
    if let [(positions, quads)] = cages {
        return document(title, positions, quads);
    }
    let (mut out, mut first) = (String::new(), 0);
    for (number, (positions, quads)) in cages.iter().enumerate() {
        let moved: Vec<[u32; 4]> = quads.iter().map(|q| q.map(|v| v + first)).collect();
        out += &document(&format!("face-{}", number + 1), positions, &moved);
        first += positions.len() as u32;
    }
    out
}

/// The flat mesh at z = 0 with a group `sheet` of faces and a group of lines (`l`) for every boundary curve and every fold
/// line, as `fold_CREASE_LINE` and `boundary_LOOP`, named by number.
pub fn flat(title: &str, mesh: &FlatMesh) -> String {
    let positions: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect();
    let mut out = document(title, &positions, &triangles).replacen("\nf ", "\ng sheet\nf ", 1);
    for (name, chains) in lines(mesh) {
        let _ = writeln!(out, "g {name}");
        for chain in chains {
            out.push('l');
            chain.iter().for_each(|v| {
                let _ = write!(out, " {}", v.0 + 1);
            });
            out.push('\n');
        }
    }
    out
}

fn document<const N: usize>(title: &str, positions: &[DVec3], faces: &[[u32; N]]) -> String {
    let mut out = header(title, positions.len(), faces.len());
    for p in positions {
        let [x, y, z] = p.to_array().map(|c| number(c, DECIMALS));
        // Writing to a string cannot fail.
        let _ = writeln!(out, "v {x} {y} {z}");
    }
    for face in faces {
        out.push('f');
        face.iter().for_each(|i| {
            let _ = write!(out, " {}", i + 1);
        });
        out.push('\n');
    }
    out
}

fn header(title: &str, vertices: usize, faces: usize) -> String {
    let title = one_line(title);
    format!(
        "# softfold: {title}\n# units: mm; {vertices} vertices, {faces} faces\no {}\n",
        title.replace(' ', "_")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_keeps_its_corners_counted_from_one() {
        let p = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y * 0.5];
        let text = cages("cage of\nA", &[(&p, &[[0, 1, 2, 3]])]);
        assert!(text.contains("# units: mm"));
        assert!(text.contains("o cage_of_A\n"));
        assert!(text.ends_with("v 0 0.5 0\nf 1 2 3 4\n"));
    }

    #[test]
    fn a_mesh_has_a_line_per_element() {
        let text = mesh("m", &[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]);
        assert_eq!(text.lines().filter(|l| l.starts_with("v ")).count(), 3);
        assert_eq!(text.lines().filter(|l| l.starts_with("f ")).count(), 1);
    }
}
