//! What was left out or changed while a drawing was read: one issue for each cause, with the elements.

use super::entities::Remark;
use super::spline::APPROXIMATION;
use crate::error::{Origin, Place, issue, list};
use softfold_geometry::{Issue, Severity};
use std::collections::BTreeMap;

/// Elements that are named at most, one more than are shown.
const NAMED: usize = 9;

/// Why something is told.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Cause {
    /// A kind of entity that is no line of a pattern.
    Kind(String),
    /// Neither layer nor colour is a role.
    NoRole { layer: String, colour: String },
    /// On a layer that is not seen.
    Hidden { layer: String, why: &'static str },
    /// Invisible by itself.
    Invisible,
    /// On a sheet of paper, not in the model.
    Paper,
    /// The block that an INSERT names is missing, or another file.
    NoBlock { block: String, why: &'static str },
    /// Off the plane z = 0, but parallel to it.
    Height,
    /// Not parallel to the plane z = 0.
    Tilted,
    /// No length.
    NoLength,
    /// As the curve's reader says.
    Curve(Remark),
}

impl Cause {
    fn told(&self) -> (Severity, String, &'static str) {
        let note = |what: String, mend| (Severity::Note, what, mend);
        let warning = |what: &str, mend| (Severity::Warning, what.to_owned(), mend);
        match self {
            Self::Kind(kind) => note(
                format!("{kind} is no line of a pattern; ignored"),
                "explode it into lines, arcs and polylines if it matters",
            ),
            Self::NoRole { layer, colour } => note(
                format!("neither layer \"{layer}\" nor colour {colour} is a role; ignored"),
                "name the layers CUT, MOUNTAIN, VALLEY, FLAT, UNASSIGNED or SLIT, or give the roles in the project file",
            ),
            Self::Hidden { layer, why } => note(
                format!("layer \"{layer}\" {why}; ignored"),
                "thaw the layer and turn it on if it matters",
            ),
            Self::Invisible => note("invisible; ignored".to_owned(), "make it visible if it matters"),
            Self::Paper => note("in paper space; ignored".to_owned(), "move it to the model if it matters"),
            Self::NoBlock { block, why } => (
                Severity::Warning,
                format!("the block \"{block}\" {why}; its lines are missing"),
                "bind or explode the block and save again",
            ),
            Self::Height => note("not at z = 0; laid onto the plane".to_owned(), ""),
            Self::Tilted => {
                warning("not parallel to the plane z = 0; its plan is used", "draw the pattern in the plane")
            }
            Self::NoLength => warning("the line has no length; ignored", "delete the element"),
            Self::Curve(remark) => told_of_curve(*remark),
        }
    }
}

fn told_of_curve(remark: Remark) -> (Severity, String, &'static str) {
    let (severity, what, mend) = match remark {
        Remark::NoSize => {
            (Severity::Warning, "its radius or an axis is 0; ignored".to_owned(), "delete the element")
        }
        Remark::NegativeRadius => {
            (Severity::Warning, "its radius is below 0; taken as if above".to_owned(), "correct the radius")
        }
        Remark::Approximated => {
            let what = format!(
                "rational, or of a degree above 3; approximated by cubics within {APPROXIMATION:e} of its size"
            );
            (Severity::Note, what, "")
        }
        Remark::Coarse => {
            let what = "a rational spline whose weights or knots are too far apart to be followed closely";
            (Severity::Warning, what.to_owned(), "draw it again with fewer control points")
        }
        Remark::ThroughPoints => {
            let what = "a spline given by points on it; a smooth cubic spline was laid through them";
            (
                Severity::Note,
                what.to_owned(),
                "convert it to control points if its shape between them matters",
            )
        }
        Remark::NoKnots => {
            let what = "a spline without knots; evenly spaced ones were taken";
            (Severity::Warning, what.to_owned(), "save the drawing again from a CAD program")
        }
    };
    (severity, what, mend)
}

/// Causes with their elements.
#[derive(Debug, Default)]
pub(super) struct Remarks(BTreeMap<Cause, (usize, Vec<Origin>)>);

impl Remarks {
    /// Notes an element.
    pub(super) fn add(&mut self, cause: Cause, origin: impl FnOnce() -> Origin) {
        let (count, origins) = self.0.entry(cause).or_default();
        *count += 1;
        if origins.len() < NAMED {
            origins.push(origin());
        }
    }

    /// One issue for each cause.
    pub(super) fn tell(&self, issues: &mut Vec<Issue>) {
        for (cause, (count, origins)) in &self.0 {
            let (severity, what, mend) = cause.told();
            let shown = origins.get(..NAMED - 1).unwrap_or(origins);
            let names = match count - shown.len() {
                0 => list(shown),
                more => format!("{} and {more} more", list(shown)),
            };
            let line = origins.first().and_then(|o| o.line);
            issues.push(issue(severity, format!("{what} ({count}): {names}"), mend).of_line(line));
        }
    }
}
