//! Crease patterns from text and back: SVG in Origami Simulator's colours. No files, no printing:
//! the caller reads the text and adds the file's name to what is said here.
//!
//! [`read_svg`] runs these steps, a module each:
//!
//! | module | step |
//! |---|---|
//! | `document` | XML: the shapes with their lines, ids and exact geometry; the physical scale |
//! | `strokes` | usvg: transforms, styles and `use` resolved; curves in mm, v up; roles by colour |
//! | `outline` | boundary pieces chained to the outline and the holes |
//! | `creases` | creases joined, led onto the outline, checked |
//!
//! Coordinates: `(u, v) = (x, H − y)` in mm, with H the height of the view box, so that v points
//! up and everything on the page has coordinates that are not negative.

mod chain;
mod colour;
mod creases;
mod document;
mod error;
mod outline;
mod path;
mod polyline;
mod strokes;
mod write;

pub use error::PatternError;
pub use write::write_svg;

use softfold_geometry::{CreasePattern, Issue};

/// How a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Millimetres per user unit (unit of the view box), for files without a physical size; none:
    /// 96 pixels an inch, with a note that says so. A physical size in the file wins.
    pub unit_mm: Option<f64>,
}

/// A pattern, and what was remarked or repaired while it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternFile {
    /// The pattern.
    pub pattern: CreasePattern,
    /// Notes and warnings, in the order in which they arose.
    pub issues: Vec<Issue>,
}

/// Reads the text of an SVG file; `name` becomes the pattern's.
///
/// Roles come from the stroke colour, the nearest of black (boundary), red (mountain), blue
/// (valley), yellow (flat), green (cut) and magenta (unassigned), or from `data-assignment`
/// (FOLD's letters), which wins. Fold angles come from `data-foldAngle` (degrees) or from an opacity
/// below 1, times 180°; otherwise the file does not say. Closed cuts are holes.
///
/// # Errors
/// Text that is no drawing or has no size, numbers that are none, an outline that is missing, open
/// or crosses itself, creases that leave the sheet or meet each other. Lesser faults are mended
/// and told in [`PatternFile::issues`].
pub fn read_svg(text: &str, name: &str, options: &ReadOptions) -> Result<PatternFile, PatternError> {
    let mut issues = Vec::new();
    let document = document::Document::parse(text, options, &mut issues)?;
    let strokes = strokes::collect(&document, &mut issues)?;
    let sheet = outline::find(&strokes, &document, &mut issues)?;
    let creases = creases::find(&strokes, &sheet, &mut issues)?;
    let pattern =
        CreasePattern { name: name.to_owned(), outline: sheet.outline, holes: sheet.holes, creases };
    Ok(PatternFile { pattern, issues })
}
