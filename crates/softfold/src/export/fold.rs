//! FOLD 1.2: the flat mesh as a crease pattern, and folded sheets as further frames of it.
//!
//! FOLD has no key for curved creases: `softfold:edges_crease` and `softfold:edges_foldLine` tie the
//! pieces of a soft fold to the crease and the fold line that they stand for; `softfold:edges_class` tells facet edges from
//! free ones, which FOLD both calls J.

use super::ExportError;
use serde::Serialize;
use softfold_geometry::{Edge, EdgeClass, FlatMesh, FoldedSheet};

/// What the file says about itself and its creases.
#[derive(Clone, Copy, Debug)]
pub struct Titles<'a> {
    /// Title of the file.
    pub title: &'a str,
    /// Names of the creases, by crease id.
    pub creases: &'a [String],
}

/// Keys in the order in which they are written.
#[derive(Serialize)]
struct File<'a> {
    file_spec: f64,
    file_creator: &'static str,
    file_title: &'a str,
    file_classes: [&'static str; 1],
    frame_title: &'static str,
    frame_classes: [&'static str; 1],
    frame_attributes: [&'static str; 3],
    frame_unit: &'static str,
    vertices_coords: Vec<[f64; 2]>,
    edges_vertices: Vec<[u32; 2]>,
    edges_assignment: Vec<char>,
    #[serde(rename = "edges_foldAngle")]
    edges_fold_angle: Vec<f64>,
    edges_faces: Vec<[Option<u32>; 2]>,
    faces_vertices: Vec<[u32; 3]>,
    #[serde(rename = "softfold:creases")]
    creases: &'a [String],
    #[serde(rename = "softfold:edges_class")]
    edges_class: Vec<&'static str>,
    #[serde(rename = "softfold:edges_crease")]
    edges_crease: Vec<Option<u32>>,
    #[serde(rename = "softfold:edges_foldLine")]
    edges_fold_line: Vec<Option<u32>>,
    #[serde(rename = "softfold:edges_loop")]
    edges_loop: Vec<Option<u32>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    file_frames: Vec<FoldedFrame<'a>>,
}

/// The folded form; what it does not say it inherits.
#[derive(Serialize)]
struct FoldedFrame<'a> {
    frame_title: &'a str,
    frame_classes: [&'static str; 1],
    frame_attributes: [&'static str; 3],
    frame_unit: &'static str,
    frame_parent: u32,
    frame_inherit: bool,
    vertices_coords: Vec<[f64; 3]>,
    #[serde(rename = "edges_foldAngle")]
    edges_fold_angle: Vec<f64>,
}

/// The flat mesh as a crease pattern; fold angles are the turns that the fold lines shall make.
///
/// # Errors
/// None with finite coordinates.
pub fn flat(mesh: &FlatMesh, titles: Titles<'_>) -> Result<String, ExportError> {
    Ok(serde_json::to_string(&file(mesh, titles, Vec::new()))?)
}

/// The flat mesh and, as frame 1, the folded sheet; there the fold angles are the turns it makes.
///
/// # Errors
/// None with finite coordinates.
pub fn folded(sheet: &FoldedSheet, titles: Titles<'_>) -> Result<String, ExportError> {
    Ok(serde_json::to_string(&file(&sheet.mesh, titles, vec![frame("folded", sheet)]))?)
}

/// The flat mesh and its states by name and in order, a frame each from 1 on.
///
/// # Errors
/// None with finite coordinates.
pub fn states<'a>(
    mesh: &'a FlatMesh,
    states: impl IntoIterator<Item = (&'a str, &'a FoldedSheet)>,
    titles: Titles<'a>,
) -> Result<String, ExportError> {
    let frames = states.into_iter().map(|(name, sheet)| frame(name, sheet)).collect();
    Ok(serde_json::to_string(&file(mesh, titles, frames))?)
}

fn frame<'a>(frame_title: &'a str, sheet: &FoldedSheet) -> FoldedFrame<'a> {
    let made = |e: &Edge| match e.class {
        EdgeClass::Fold { .. } => sheet.turn_rad(e).unwrap_or(0.0).to_degrees(),
        _ => 0.0,
    };
    FoldedFrame {
        frame_title,
        frame_classes: ["foldedForm"],
        frame_attributes: ["3D", "manifold", "orientable"],
        frame_unit: "mm",
        frame_parent: 0,
        frame_inherit: true,
        vertices_coords: sheet.positions.iter().map(|p| p.to_array()).collect(),
        edges_fold_angle: sheet.mesh.edges.iter().map(made).collect(),
    }
}

fn file<'a>(mesh: &FlatMesh, titles: Titles<'a>, file_frames: Vec<FoldedFrame<'a>>) -> File<'a> {
    File {
        file_spec: 1.2,
        file_creator: "softfold",
        file_title: titles.title,
        file_classes: ["singleModel"],
        frame_title: "flat",
        frame_classes: ["creasePattern"],
        frame_attributes: ["2D", "manifold", "orientable"],
        frame_unit: "mm",
        vertices_coords: mesh.vertices.iter().map(|p| p.to_array()).collect(),
        edges_vertices: mesh.edges.iter().map(|e| e.vertices.map(|v| v.0)).collect(),
        edges_assignment: mesh.edges.iter().map(|e| assignment(&e.class)).collect(),
        edges_fold_angle: mesh.edges.iter().map(|e| rest_turn_deg(&e.class)).collect(),
        edges_faces: mesh.edges.iter().map(|e| e.triangles.map(|t| t.map(|t| t.0))).collect(),
        faces_vertices: mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect(),
        creases: titles.creases,
        edges_class: mesh.edges.iter().map(|e| class_name(&e.class)).collect(),
        edges_crease: mesh.edges.iter().map(|e| fold_line(&e.class).map(|f| f[0])).collect(),
        edges_fold_line: mesh.edges.iter().map(|e| fold_line(&e.class).map(|f| f[1])).collect(),
        edges_loop: mesh.edges.iter().map(|e| loop_number(&e.class)).collect(),
        file_frames,
    }
}

/// FOLD's letter; J (1.2) marks the edges that only split a face into triangles.
fn assignment(class: &EdgeClass) -> char {
    match *class {
        EdgeClass::Fold { turn_rad, .. } if turn_rad > 0.0 => 'V',
        EdgeClass::Fold { turn_rad, .. } if turn_rad < 0.0 => 'M',
        EdgeClass::Fold { .. } => 'F',
        EdgeClass::Facet | EdgeClass::Free => 'J',
        EdgeClass::Boundary { .. } => 'B',
    }
}

fn class_name(class: &EdgeClass) -> &'static str {
    match class {
        EdgeClass::Fold { .. } => "fold",
        EdgeClass::Facet => "facet",
        EdgeClass::Free => "free",
        EdgeClass::Boundary { .. } => "boundary",
    }
}

fn rest_turn_deg(class: &EdgeClass) -> f64 {
    match *class {
        EdgeClass::Fold { turn_rad, .. } => turn_rad.to_degrees(),
        _ => 0.0,
    }
}

/// Crease id and number of the line in its band.
fn fold_line(class: &EdgeClass) -> Option<[u32; 2]> {
    match *class {
        EdgeClass::Fold { crease, line, .. } => Some([crease.0, line]),
        _ => None,
    }
}

fn loop_number(class: &EdgeClass) -> Option<u32> {
    match *class {
        EdgeClass::Boundary { loop_id } => Some(loop_id.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};
    use softfold_geometry::{CreaseId, DVec2, LoopId, Site, SolveRecord, VertexId};

    /// Two squares that meet at a mountain fold of 90°, each split by a facet edge.
    fn sheet() -> FoldedSheet {
        let flat = [(0., 0.), (1., 0.), (2., 0.), (2., 1.), (1., 1.), (0., 1.)].map(DVec2::from).to_vec();
        let triangles = [[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4]].map(|t| t.map(VertexId)).to_vec();
        let mesh = FlatMesh::new(flat, vec![Site::Interior; 6], triangles, |key, boundary| match key {
            _ if boundary => EdgeClass::Boundary { loop_id: LoopId(0) },
            [VertexId(1), VertexId(4)] => EdgeClass::Fold { crease: CreaseId(0), line: 2, turn_rad: -0.5 },
            _ => EdgeClass::Facet,
        });
        let fold = |p: &DVec2| if p.x > 1.5 { [1.0, p.y, -1.0] } else { [p.x, p.y, 0.0] };
        let positions = mesh.vertices.iter().map(|p| fold(p).into()).collect();
        FoldedSheet { mesh, positions, solve: SolveRecord::default() }
    }

    fn read() -> Value {
        let names = ["rim".to_owned()];
        serde_json::from_str(&folded(&sheet(), Titles { title: "t", creases: &names }).unwrap()).unwrap()
    }

    #[test]
    fn the_flat_frame_says_what_every_edge_is() {
        let file = read();
        assert_eq!(file["file_spec"], json!(1.2));
        assert_eq!(file["frame_unit"], json!("mm"));
        let letters = file["edges_assignment"].as_array().unwrap();
        let count = |c: &str| letters.iter().filter(|l| *l == c).count();
        assert_eq!((count("B"), count("M"), count("J")), (6, 1, 2));
        let fold = letters.iter().position(|l| l == "M").unwrap();
        assert_eq!(file["softfold:edges_crease"][fold], json!(0));
        assert_eq!(file["softfold:edges_foldLine"][fold], json!(2));
        assert!((file["edges_foldAngle"][fold].as_f64().unwrap() + 0.5_f64.to_degrees()).abs() < 1e-12);
        assert_eq!(file["softfold:edges_class"][fold], "fold");
        assert_eq!(file["softfold:creases"][0], "rim");
    }

    #[test]
    fn faces_are_counter_clockwise() {
        let file = read();
        let at =
            |v: &Value, k: usize| file["vertices_coords"][v.as_u64().unwrap() as usize][k].as_f64().unwrap();
        for face in file["faces_vertices"].as_array().unwrap() {
            let p = [0, 1, 2].map(|i| DVec2::new(at(&face[i], 0), at(&face[i], 1)));
            assert!((p[1] - p[0]).perp_dot(p[2] - p[0]) > 0.0);
        }
    }

    #[test]
    fn the_folded_frame_holds_the_turn_that_is_made() {
        let file = read();
        let frame = &file["file_frames"][0];
        assert_eq!(frame["frame_classes"][0], "foldedForm");
        assert_eq!(frame["vertices_coords"].as_array().unwrap().len(), 6);
        let fold = file["edges_assignment"].as_array().unwrap().iter().position(|l| l == "M").unwrap();
        assert!((frame["edges_foldAngle"][fold].as_f64().unwrap() + 90.0).abs() < 1e-9);
    }

    #[test]
    fn states_are_frames_that_inherit_the_flat_one() {
        let sheet = sheet();
        let names = ["rim".to_owned()];
        let titles = Titles { title: "t", creases: &names };
        let text = states(&sheet.mesh, [("half", &sheet), ("whole", &sheet)], titles).unwrap();
        let file: Value = serde_json::from_str(&text).unwrap();
        let frames = file["file_frames"].as_array().unwrap();
        assert_eq!(frames.len(), 2);
        for (frame, name) in frames.iter().zip(["half", "whole"]) {
            assert_eq!((&frame["frame_title"], &frame["frame_parent"]), (&json!(name), &json!(0)));
            assert_eq!(
                (&frame["frame_inherit"], &frame["frame_classes"]),
                (&json!(true), &json!(["foldedForm"]))
            );
            assert_eq!(frame["vertices_coords"][0].as_array().unwrap().len(), 3);
        }
        assert_eq!(file["frame_classes"], json!(["creasePattern"]));
    }
}
