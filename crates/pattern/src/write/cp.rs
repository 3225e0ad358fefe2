//! Patterns as .cp, ORIPA's line list.

use super::WriteOptions;
use super::planar::{Planar, number};
use softfold_geometry::{CreasePattern, Role};
use std::fmt::Write;

/// A pattern as .cp: `type x1 y1 x2 y2` on each line, in mm with y = −v, as programs that read .cp paint y
/// downwards. Curves become chains of lines within [`WriteOptions::chord_mm`], and lines are split where others
/// end on them. Outline, holes and slits have type 1, mountains 2, valleys 3; flat and unassigned lines have type
/// 4, since the format knows no unassigned crease. Names and fold angles are lost.
pub fn write_cp(pattern: &CreasePattern, options: &WriteOptions) -> String {
    let planar = Planar::new(pattern, options.chord_for(pattern));
    let mut out = String::new();
    for edge in &planar.edges {
        let [[x1, y1], [x2, y2]] = edge.vertices.map(|v| {
            let [x, y] = &planar.vertices[v];
            [x.clone(), negated(y)]
        });
        let _ = writeln!(out, "{} {x1} {y1} {x2} {y2}", kind(planar.lines[edge.line].role));
    }
    out
}

fn kind(role: Role) -> u8 {
    match role {
        Role::Boundary | Role::Cut => 1,
        Role::Mountain => 2,
        Role::Valley => 3,
        Role::Flat | Role::Unassigned => 4,
    }
}

/// A written number with the other sign.
fn negated(number_text: &str) -> String {
    match number_text.strip_prefix('-') {
        Some(positive) => positive.to_owned(),
        None if number_text == number(0.0) => number(0.0),
        None => format!("-{number_text}"),
    }
}
