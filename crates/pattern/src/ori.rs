//! .ori, Oriedita's save file: JSON whose `lineSegments` have ends `a` and `b` as text "x,y" and a `color`:
//! BLACK_0 outline, RED_1 mountain, BLUE_2 valley, CYAN_3 auxiliary (flat). Other colours, and the lines, circles
//! and texts that help to draw, are no part of the pattern. No physical size; y points down ([`crate::lines`]).
//!
//! Known versions: `"version": "0.…"` of Oriedita 0, `"@version": "v1"` and its minor versions.

use crate::drawing::Stroke;
use crate::error::{Origin, Place, issue, utf8};
use crate::lines::{self, Line, coordinate, short};
use crate::{PatternError, ReadOptions};
use serde_json::{Map, Value};
use softfold_geometry::{DVec2, Issue, Role, Severity};

/// What to do with a file that cannot be read.
const MEND: &str = "open it with Oriedita and export .fold or .cp";
/// Lists of a save that hold no creases, and what they hold.
const HELPS: [(&str, &str); 4] = [
    ("auxLineSegments", "auxiliary live lines"),
    ("circles", "circles"),
    ("points", "points"),
    ("texts", "texts"),
];

/// The strokes of an .ori file.
///
/// # Errors
/// An empty file, another format, an unknown version, a line without ends or with a number that is none.
pub(crate) fn strokes(
    bytes: &[u8],
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    let save = parse(utf8(bytes)?)?;
    check_version(&save)?;
    let Some(segments) = save.get("lineSegments").and_then(Value::as_array) else {
        return Err(malformed("the save has no list \"lineSegments\"".to_owned()));
    };
    let lines = segments.iter().enumerate().map(|(i, s)| line(s, i)).collect::<Result<_, _>>()?;
    for (key, what) in HELPS {
        let count = save.get(key).and_then(Value::as_array).map_or(0, Vec::len);
        if count > 0 {
            issues.push(
                issue(Severity::Note, format!("{what} left out ({count})"), "").of(&origin(key.to_owned())),
            );
        }
    }
    lines::strokes(lines, options, issues)
}

fn malformed(what: String) -> PatternError {
    PatternError::Malformed(issue(Severity::Error, what, MEND))
}

fn origin(label: String) -> Origin {
    Origin { label, id: None, line: None }
}

fn parse(text: &str) -> Result<Map<String, Value>, PatternError> {
    if text.trim().is_empty() {
        return Err(PatternError::Malformed(issue(Severity::Error, "the file is empty", MEND).line(1)));
    }
    match serde_json::from_str(text) {
        Ok(Value::Object(save)) => Ok(save),
        Ok(_) => Err(malformed("the file is no save of Oriedita".to_owned())),
        Err(e) => {
            let what = format!("the file is no save of Oriedita: {e}");
            let line = u32::try_from(e.line()).unwrap_or(u32::MAX);
            Err(PatternError::Malformed(issue(Severity::Error, what, MEND).line(line)))
        }
    }
}

fn check_version(save: &Map<String, Value>) -> Result<(), PatternError> {
    let version = |key: &str| save.get(key).and_then(Value::as_str);
    match (version("@version"), version("version")) {
        (Some(v), _) if v == "v1" || v.starts_with("v1.") => Ok(()),
        (None, Some(v)) if v.starts_with("0.") => Ok(()),
        (Some(v), _) | (None, Some(v)) => {
            Err(malformed(format!("the version of the save is \"{}\"", short(v))))
        }
        (None, None) => Err(malformed("the save has no version".to_owned())),
    }
}

fn line(segment: &Value, index: usize) -> Result<Line, PatternError> {
    let origin = origin(format!("lineSegments[{index}]"));
    let text = |key: &str| {
        segment.get(key).and_then(Value::as_str).ok_or_else(|| {
            let what = format!("the line has no \"{key}\"");
            PatternError::Malformed(issue(Severity::Error, what, MEND).of(&origin))
        })
    };
    let colour = text("color")?;
    let ends = [point("a", text("a")?, &origin)?, point("b", text("b")?, &origin)?];
    let (role, rgb) = known(colour).map_or((None, None), |(role, rgb)| (Some(role), Some(rgb)));
    Ok(Line { role, kind: short(colour), rgb, ends, origin })
}

/// Role and colour on screen of Oriedita's line colours.
fn known(colour: &str) -> Option<(Role, [u8; 3])> {
    match colour {
        "BLACK_0" => Some((Role::Boundary, [0, 0, 0])),
        "RED_1" => Some((Role::Mountain, [255, 0, 0])),
        "BLUE_2" => Some((Role::Valley, [0, 0, 255])),
        "CYAN_3" => Some((Role::Flat, [0, 255, 255])),
        _ => None,
    }
}

fn point(name: &str, text: &str, origin: &Origin) -> Result<DVec2, PatternError> {
    let number = |what: String| PatternError::Number(issue(Severity::Error, what, MEND).of(origin));
    let Some((x, y)) = text.split_once(',') else {
        return Err(number(format!("{name} is \"{}\", not \"x,y\"", short(text))));
    };
    let at = |text: &str| coordinate(name, text).map_err(number);
    Ok(DVec2::new(at(x)?, at(y)?))
}
