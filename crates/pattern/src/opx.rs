//! .opx, ORIPA's save file: a `java.beans` XML of an `oripa.DataSet`, whose property `lines` is an array of
//! `oripa.OriLineProxy` objects with the properties type, x0, y0, x1 and y1. Java leaves out properties that are
//! 0. Type 0 is auxiliary (flat), 1 cut (outline), 2 mountain, 3 valley. No physical size; y points down
//! ([`crate::lines`]).

use crate::document::Lines;
use crate::drawing::Stroke;
use crate::error::{Origin, Place, issue, utf8};
use crate::lines::{self, Line, coordinate};
use crate::{PatternError, ReadOptions};
use roxmltree::Node;
use softfold_geometry::{DVec2, Issue, Role, Severity};

/// Class of a line; also the class of the array that holds them all.
const LINE_CLASS: &str = "OriLineProxy";

/// The strokes of an .opx file.
///
/// # Errors
/// No text, no XML, no ORIPA file, or a number that is none.
pub(crate) fn strokes(
    bytes: &[u8],
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    let text = utf8(bytes)?;
    if text.trim().is_empty() {
        return Err(malformed("the file is empty".to_owned(), 1));
    }
    let xml = roxmltree::Document::parse(text)
        .map_err(|e| malformed(format!("the file is not XML: {e}"), e.pos().row))?;
    let (root, rows) = (xml.root_element(), Lines::new(text));
    if root.tag_name().name() != "java" {
        let what =
            format!("the root element is <{}>, not the <java> of an ORIPA file", root.tag_name().name());
        return Err(malformed(what, rows.of(root.range().start)));
    }
    let objects = root.descendants().filter(is_line);
    let origin = |object: &Node<'_, '_>, count: usize| Origin {
        label: format!("line {count}"),
        id: None,
        line: Some(rows.of(object.range().start)),
    };
    let lines = objects.zip(1..).map(|(o, i)| parse(&o, origin(&o, i))).collect::<Result<_, _>>()?;
    lines::strokes(lines, options, issues)
}

fn malformed(what: String, line: u32) -> PatternError {
    PatternError::Malformed(issue(Severity::Error, what, "save the pattern again with ORIPA").line(line))
}

fn is_line(node: &Node<'_, '_>) -> bool {
    let class = node.attribute("class").unwrap_or_default();
    node.tag_name().name() == "object" && class.rsplit('.').next() == Some(LINE_CLASS)
}

fn parse(object: &Node<'_, '_>, origin: Origin) -> Result<Line, PatternError> {
    let number = |what: String| {
        let mend = "correct the number, or delete the line";
        PatternError::Number(issue(Severity::Error, what, mend).of(&origin))
    };
    let property = |name: &str| {
        let void = object.children().find(|n| n.attribute("property") == Some(name))?;
        void.children().find(Node::is_element)?.text()
    };
    let at = |name: &str| property(name).map_or(Ok(0.0), |text| coordinate(name, text).map_err(&number));
    let kind = lines::kind(property("type").unwrap_or("0")).map_err(&number)?;
    let ends = [DVec2::new(at("x0")?, at("y0")?), DVec2::new(at("x1")?, at("y1")?)];
    Ok(Line { role: role_of(kind), kind: format!("type {kind}"), rgb: None, ends, origin })
}

/// The role of a line type; others are no creases.
fn role_of(kind: i64) -> Option<Role> {
    match kind {
        0 => Some(Role::Flat),
        1 => Some(Role::Boundary),
        2 => Some(Role::Mountain),
        3 => Some(Role::Valley),
        _ => None,
    }
}
