//! .cp, the line list of ORIPA, Orihime and Oriedita: `type x1 y1 x2 y2` on each line, type 1 outline, 2
//! mountain, 3 valley, 4 auxiliary (flat), 0 nothing. Empty lines and lines that start with `#` or `//` are
//! comments. No physical size; y points down ([`crate::lines`]).

use crate::drawing::Stroke;
use crate::error::{Origin, Place, issue, utf8};
use crate::lines::{self, Line, coordinate, short};
use crate::{PatternError, ReadOptions};
use softfold_geometry::{DVec2, Issue, Role, Severity};

/// The strokes of a .cp file.
///
/// # Errors
/// Bytes that are no text, an empty file, a line that is none of `type x1 y1 x2 y2`.
pub(crate) fn strokes(
    bytes: &[u8],
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    let text = utf8(bytes)?;
    if text.trim().is_empty() {
        let mend = "export the pattern again";
        return Err(PatternError::Malformed(issue(Severity::Error, "the file is empty", mend).line(1)));
    }
    let lines = text.lines().zip(1u32..).filter(|(line, _)| !is_comment(line)).zip(1..);
    let lines = lines.map(|((line, at), count)| parse(line, at, count)).collect::<Result<_, _>>()?;
    lines::strokes(lines, options, issues)
}

fn is_comment(line: &str) -> bool {
    let line = line.trim();
    line.is_empty() || line.starts_with('#') || line.starts_with("//")
}

/// The `count`-th line of the pattern, on line `at` of the file.
fn parse(line: &str, at: u32, count: usize) -> Result<Line, PatternError> {
    let origin = Origin { label: format!("line {count}"), id: None, line: Some(at) };
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[kind, x1, y1, x2, y2] = words.as_slice() else {
        let what = format!("\"{}\" is none of the form `type x1 y1 x2 y2`", short(line));
        let mend = "give each line a type and four coordinates";
        return Err(PatternError::Malformed(issue(Severity::Error, what, mend).of(&origin)));
    };
    let number = |what: String| {
        let mend = "correct the number, or delete the line";
        PatternError::Number(issue(Severity::Error, what, mend).of(&origin))
    };
    let role = lines::kind(kind).map_err(&number)?;
    let at = |name: &str, text: &str| coordinate(name, text).map_err(&number);
    let ends = [DVec2::new(at("x1", x1)?, at("y1", y1)?), DVec2::new(at("x2", x2)?, at("y2", y2)?)];
    Ok(Line { role: role_of(role), kind: format!("type {role}"), rgb: None, ends, origin })
}

/// The role of a line type; others are no creases.
fn role_of(kind: i64) -> Option<Role> {
    match kind {
        1 => Some(Role::Boundary),
        2 => Some(Role::Mountain),
        3 => Some(Role::Valley),
        4 => Some(Role::Flat),
        _ => None,
    }
}
