//! What .cp, .opx and .ori have in common: lists of straight lines with a type, without a physical size, with
//! y downwards.
//!
//! ORIPA and Oriedita paint their coordinates as they are on a screen whose y points down, so v = −y gives what
//! the user sees there. Mountains and valleys are told as seen in that picture and keep their roles.

use crate::drawing::Stroke;
use crate::error::{Origin, Place, issue, list};
use crate::{PatternError, ReadOptions};
use softfold_geometry::{DVec2, Issue, Role, Segment, Severity};
use std::collections::BTreeMap;

/// One line of a list.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    /// What the format says it is; none: no part of the pattern.
    pub(crate) role: Option<Role>,
    /// The format's word for that, by which the user may speak of all such lines as of a layer ("type 4").
    pub(crate) kind: String,
    /// Its colour on screen, where the format gives one.
    pub(crate) rgb: Option<[u8; 3]>,
    /// Start and end in the file's coordinates, y down.
    pub(crate) ends: [DVec2; 2],
    /// Where it stands.
    pub(crate) origin: Origin,
}

/// Largest number of a file, a million kilometres in mm: beyond it lie faults, and squares that overflow.
pub(crate) const LARGEST: f64 = 1e12;

/// The type of a line.
///
/// # Errors
/// What is wrong with the text.
pub(crate) fn kind(text: &str) -> Result<i64, String> {
    text.trim().parse().map_err(|_| format!("the type is \"{}\", not a whole number", short(text)))
}

/// A coordinate, or what is wrong with it.
pub(crate) fn coordinate(name: &str, text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.abs() <= LARGEST => Ok(x),
        Ok(x) if x.is_finite() => Err(format!("{name} is \"{}\", beyond {LARGEST:e}", short(text))),
        _ => Err(format!("{name} is \"{}\", not a finite number", short(text))),
    }
}

/// The start of a text that a message quotes.
pub(crate) fn short(text: &str) -> String {
    const SHOWN: usize = 40;
    let mut out: String = text.chars().take(SHOWN).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > SHOWN {
        out.push('…');
    }
    out
}

/// The lines as strokes in mm with v up; what is left out is told.
///
/// # Errors
/// No line is left.
pub(crate) fn strokes(
    lines: Vec<Line>,
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    let unit_mm = unit_mm(options, issues);
    let mut left_out: BTreeMap<String, Vec<Origin>> = BTreeMap::new();
    let mut points: Vec<Origin> = Vec::new();
    let mut strokes = Vec::new();
    for line in lines {
        let said = options.roles.of(Some(&line.origin.label), &[&line.kind], line.rgb);
        let Some(role) = said.unwrap_or(line.role) else {
            left_out.entry(line.kind).or_default().push(line.origin);
            continue;
        };
        let [from, to] = line.ends.map(|p| DVec2::new(p.x, -p.y) * unit_mm);
        if from == to {
            points.push(line.origin);
            continue;
        }
        let pieces = vec![vec![Segment::Line { from, to }]];
        strokes.push(Stroke { role, fold_angle_rad: None, origin: line.origin, pieces });
    }
    tell(&left_out, &points, issues);
    if strokes.is_empty() {
        let mend = "draw the outline and the creases";
        return Err(PatternError::Nothing(issue(
            Severity::Error,
            "the file has no lines of a pattern",
            mend,
        )));
    }
    Ok(strokes)
}

fn tell(left_out: &BTreeMap<String, Vec<Origin>>, points: &[Origin], issues: &mut Vec<Issue>) {
    for (kind, origins) in left_out {
        let what = format!("{} of {kind} left out: {}", lines(origins.len()), list(origins));
        let mend = "give this kind a role if it matters";
        issues.push(issue(Severity::Note, what, mend).of_line(origins[0].line));
    }
    if let Some(first) = points.first() {
        let what = format!("{} without length left out: {}", lines(points.len()), list(points));
        issues.push(issue(Severity::Warning, what, "delete them").of_line(first.line));
    }
}

/// So many lines.
fn lines(count: usize) -> String {
    if count == 1 { "1 line".to_owned() } else { format!("{count} lines") }
}

fn unit_mm(options: &ReadOptions, issues: &mut Vec<Issue>) -> f64 {
    options.unit_mm.unwrap_or_else(|| {
        let what = "no physical size; one unit is taken as 1 mm";
        issues.push(issue(Severity::Note, what, "give the unit in the project file"));
        1.0
    })
}
