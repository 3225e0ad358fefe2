//! A folded form as it stands in space.

use super::frames::Frames;
use super::graph;
use super::json::{self, told};
use crate::PatternError;
use crate::error::issue;
use softfold_geometry::{DVec3, Issue, Severity, TriMesh};

/// The faces of a folded form, in mm: the frame of this number, else the last of class `foldedForm`. Faces of more than
/// three corners are cut into fans. `unit_mm` is for files that name no unit.
///
/// # Errors
/// No JSON; wrong types, lengths, numbers or indices; no such frame, or one without faces. What is only worth a remark
/// is added to `issues`.
pub fn read_folded(
    bytes: &[u8],
    frame: Option<usize>,
    unit_mm: Option<f64>,
    issues: &mut Vec<Issue>,
) -> Result<TriMesh, PatternError> {
    let file = json::parse(bytes)?;
    let frames = Frames::of(&file)?;
    let Some(chosen) = frames.folded(frame) else { return Err(no_folded_form(frame, frames.count())) };
    let (vertices, faces) = graph::faces_in_space(chosen)?;
    if faces.is_empty() {
        let what = "the folded form has no faces";
        let entry = chosen.entry("faces_vertices");
        return Err(PatternError::Nothing(told(Severity::Error, &entry, what, "export it with faces")));
    }
    let scale = super::unit_mm(chosen, unit_mm, issues);
    let positions: Vec<DVec3> = vertices.into_iter().map(|p| p * scale).collect();
    let fan = |f: &Vec<usize>| -> Vec<[u32; 3]> {
        f[1..].windows(2).map(|e| [f[0], e[0], e[1]].map(|i| i as u32)).collect()
    };
    Ok(TriMesh { positions, triangles: faces.iter().flat_map(fan).collect() })
}

fn no_folded_form(wanted: Option<usize>, count: usize) -> PatternError {
    let what = match wanted {
        Some(w) => format!("frame {w} is wanted, but the file has {count}"),
        None => "no frame of the file is a foldedForm".to_owned(),
    };
    PatternError::Nothing(issue(
        Severity::Error,
        what,
        "give a file with a folded state, folded.fold for example",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, frame: Option<usize>) -> Result<TriMesh, PatternError> {
        read_folded(text.as_bytes(), frame, None, &mut Vec::new())
    }

    const FILE: &str = r#"{"file_spec":1.2,"frame_classes":["creasePattern"],"frame_unit":"cm",
        "vertices_coords":[[0,0],[1,0],[1,1],[0,1]],"faces_vertices":[[0,1,2,3]],
        "file_frames":[{"frame_classes":["foldedForm"],"frame_parent":0,"frame_inherit":true,"vertices_coords":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]},
        {"frame_classes":["foldedForm"],"frame_parent":0,"frame_inherit":true,"vertices_coords":[[0,0,0],[1,0,0],[1,1,2],[0,1,2]]}]}"#;

    #[test]
    fn the_last_folded_form_is_read_in_millimetres_and_its_squares_are_cut() {
        let mesh = read(FILE, None).unwrap();
        assert_eq!(mesh.positions[2], DVec3::new(10.0, 10.0, 20.0));
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(read(FILE, Some(1)).unwrap().positions[2].z, 0.0);
    }

    #[test]
    fn files_without_a_folded_form_are_refused_with_a_mend() {
        let flat = r#"{"frame_classes":["creasePattern"],"vertices_coords":[[0,0],[1,0],[1,1]],"faces_vertices":[[0,1,2]]}"#;
        let said = |r: Result<TriMesh, PatternError>| r.unwrap_err().to_string();
        assert!(said(read(flat, None)).contains("foldedForm"), "{}", said(read(flat, None)));
        assert!(said(read(FILE, Some(7))).contains("frame 7"));
        let bare = r#"{"frame_classes":["foldedForm"],"vertices_coords":[[0,0,1],[1,0,0],[1,1,0]]}"#;
        assert!(said(read(bare, None)).contains("no faces"));
        let astray =
            r#"{"frame_classes":["foldedForm"],"vertices_coords":[[0,0,1]],"faces_vertices":[[0,1,2]]}"#;
        assert!(said(read(astray, None)).contains("faces_vertices[0]"));
    }
}
