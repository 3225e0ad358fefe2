//! Patterns as FOLD 1.2.

use super::WriteOptions;
use super::planar::{Drawn, Planar, number};
use crate::fold::curves::{CURVES, EDGES_CREASE, EDGES_CURVE, written_angle_deg};
use serde_json::Value;
use softfold_geometry::{CreasePattern, DVec2, Role, Segment};
use std::fmt::Write;

/// A pattern as FOLD 1.2 in mm: a single crease pattern in the plane. Curves become chains of edges within
/// [`WriteOptions::chord_mm`], and edges are split where other lines end on them.
///
/// `edges_foldAngle` holds a number for every edge, as the format wants: a crease's own angle, ±180 for mountains
/// and valleys without one, 0 for all others. Slits are edges of assignment C. What FOLD cannot say stands in
/// softfold's own keys: `softfold:curves` (exact segments and fold angles), `softfold:edges_curve` and
/// `softfold:edges_crease` (names), so that [`crate::read`] gives the same pattern again, to 1e-9 mm.
pub fn write_fold(pattern: &CreasePattern, options: &WriteOptions) -> String {
    let planar = Planar::new(pattern, options.chord_for(pattern));
    let cuts = if pattern.slits.is_empty() { "noCuts" } else { "cuts" };
    let mut out = format!(
        "{{\n\"file_spec\": 1.2,\n\"file_creator\": \"softfold\",\n\"file_title\": {},\n\
         \"file_classes\": [\"singleModel\"],\n\"frame_classes\": [\"creasePattern\"],\n\
         \"frame_attributes\": [\"2D\", \"{cuts}\"],\n\"frame_unit\": \"mm\"",
        quoted(&pattern.name)
    );
    let line = |e: usize| &planar.lines[planar.edges[e].line];
    let edges = || 0..planar.edges.len();
    list(&mut out, "vertices_coords", planar.vertices.iter().map(|[x, y]| format!("[{x},{y}]")));
    list(
        &mut out,
        "edges_vertices",
        planar.edges.iter().map(|e| format!("[{},{}]", e.vertices[0], e.vertices[1])),
    );
    list(&mut out, "edges_assignment", edges().map(|e| format!("\"{}\"", line(e).role.letter())));
    list(
        &mut out,
        "edges_foldAngle",
        edges().map(|e| number(written_angle_deg(line(e).role, line(e).angle_deg))),
    );
    list(&mut out, EDGES_CREASE, edges().map(|e| line(e).name.map_or("null".to_owned(), quoted)));
    let span = |e: usize| {
        let [from, to] = planar.edges[e].span.map(number);
        format!("[{},{from},{to}]", planar.edges[e].line)
    };
    list(&mut out, EDGES_CURVE, edges().map(span));
    list(&mut out, CURVES, planar.lines.iter().map(curve));
    out.push_str("\n}\n");
    out
}

/// A key with a list, an item on each line.
fn list(out: &mut String, key: &str, items: impl Iterator<Item = String>) {
    let _ = write!(out, ",\n\"{key}\": [");
    for (i, item) in items.enumerate() {
        let _ = write!(out, "{}{item}", if i == 0 { "\n" } else { ",\n" });
    }
    out.push_str("\n]");
}

fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

/// A line with its exact segments.
fn curve(line: &Drawn<'_>) -> String {
    let angle = line.angle_deg.filter(|_| line.role != Role::Boundary);
    let angle = angle.map_or("null".to_owned(), number);
    let segments: Vec<String> = line.segments.iter().map(segment).collect();
    format!("{{\"foldAngle\":{angle},\"segments\":[{}]}}", segments.join(","))
}

fn segment(segment: &Segment) -> String {
    let controls = segment.control_points();
    let numbers: Vec<String> = controls.iter().flat_map(|p: &DVec2| [number(p.x), number(p.y)]).collect();
    format!("[{}]", numbers.join(","))
}
