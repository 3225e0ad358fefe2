//! FOLD 1.0 to 1.2 (Demaine, Ku, Lang: "A New File Standard to Represent Folded Structures", 2016; the format's
//! specification at github.com/edemaine/fold).
//!
//! | module | what it knows |
//! |---|---|
//! | `json` | typed looks into the JSON, faults with key and index |
//! | `frames` | which frame is read, and what it inherits |
//! | `graph` | vertices, edges and faces, checked |
//! | `plane` | the plane and the front of a flat sheet |
//! | `develop` | folded forms laid out flat |
//! | `folded` | a folded form as the mesh in space that it is |
//! | `curves` | softfold's keys for exact curves and names |
//! | `strokes` | edges to strokes |

pub(crate) mod curves;
mod develop;
pub(crate) mod folded;
mod frames;
mod graph;
mod json;
mod plane;
mod strokes;

use crate::drawing::Stroke;
use crate::{PatternError, ReadOptions};
use develop::Placed;
use frames::{Frame, Frames};
use graph::Graph;
use json::told;
use softfold_geometry::{Issue, Severity};

/// Units of `frame_unit` in mm; "unit" and an absent unit say nothing.
const UNITS_MM: [(&str, f64); 7] =
    [("in", 25.4), ("pt", 25.4 / 72.0), ("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("um", 1e-3), ("nm", 1e-6)];
/// Keys of the specification, 1.0 to 1.2; others should have a namespace ("creator:key").
const KNOWN: [&str; 32] = [
    "file_spec",
    "file_creator",
    "file_author",
    "file_title",
    "file_description",
    "file_classes",
    "file_frames",
    "frame_author",
    "frame_title",
    "frame_description",
    "frame_classes",
    "frame_attributes",
    "frame_unit",
    "frame_parent",
    "frame_inherit",
    "vertices_coords",
    "vertices_vertices",
    "vertices_edges",
    "vertices_faces",
    "edges_vertices",
    "edges_faces",
    "edges_assignment",
    "edges_foldAngle",
    "edges_foldAngles",
    "edges_length",
    "edges_lengths",
    "faces_vertices",
    "faces_edges",
    "faces_faces",
    "faceOrders",
    "edgeOrders",
    "faces_orders",
];

/// The strokes of a FOLD file.
///
/// A frame whose class is `foldedForm`, or whose vertices lie in no coordinate plane, is laid out flat by its
/// faces. Fold angles are taken as written, also from such a frame.
///
/// # Errors
/// No JSON; wrong types, lengths, numbers or indices; no frame with edges; a folded form that cannot be laid out.
pub(crate) fn strokes(
    bytes: &[u8],
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    let file = json::parse(bytes)?;
    let frames = Frames::of(&file)?;
    let frame = frames.choose(options.frame, issues)?;
    note_strange_keys(frame, issues);
    let graph = Graph::read(frame, issues)?;
    let unit_mm = unit_mm(frame, options.unit_mm, issues);
    let creator = file.get("file_creator").and_then(serde_json::Value::as_str);
    let placed = place(&graph, frame, creator, unit_mm, issues)?;
    strokes::collect(&graph, frame, &placed, unit_mm, options, issues)
}

/// The edges in the plane.
fn place(
    graph: &Graph,
    frame: Frame<'_>,
    creator: Option<&str>,
    unit_mm: f64,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Placed>, PatternError> {
    let folded = frame.is_class("foldedForm") && !frame.is_class("creasePattern");
    if folded {
        return develop::develop(graph, frame, unit_mm, issues);
    }
    match plane::lay_out(graph, frame, creator, issues) {
        Some(points) => {
            let placed =
                |(edge, e): (usize, &graph::Edge)| Placed { edge, ends: e.vertices.map(|v| points[v]) };
            Ok(graph.edges.iter().enumerate().map(placed).collect())
        }
        None => develop::develop(graph, frame, unit_mm, issues),
    }
}

fn unit_mm(frame: Frame<'_>, given_mm: Option<f64>, issues: &mut Vec<Issue>) -> f64 {
    let entry = frame.entry("frame_unit");
    let unit = frame.text("frame_unit").map(str::trim);
    if let Some((_, mm)) = UNITS_MM.iter().find(|(name, _)| Some(*name) == unit) {
        return *mm;
    }
    if let Some(other) = unit.filter(|u| *u != "unit") {
        let what = format!("the unit \"{}\" is unknown", crate::lines::short(other));
        issues.push(told(Severity::Warning, &entry, what, "use in, pt, m, cm, mm, um or nm"));
    }
    given_mm.unwrap_or_else(|| {
        let what = "no physical size; one unit is taken as 1 mm";
        issues.push(told(Severity::Note, &entry, what, "give frame_unit, or the unit in the project file"));
        1.0
    })
}

fn note_strange_keys(frame: Frame<'_>, issues: &mut Vec<Issue>) {
    const SHOWN: usize = 8;
    let strange =
        || frame.own_keys().filter(|k| !k.contains(':') && !KNOWN.contains(k)).map(crate::lines::short);
    if let Some(first) = &strange().next() {
        let shown: Vec<String> = strange().take(SHOWN).collect();
        let what =
            format!("{} keys that FOLD does not know are ignored: {}", strange().count(), shown.join(", "));
        issues.push(told(
            Severity::Note,
            first,
            what,
            "give keys of your own a namespace, as in \"creator:key\"",
        ));
    }
}

#[cfg(test)]
mod tests;
