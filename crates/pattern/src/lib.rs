//! Crease patterns from text and back: SVG, FOLD, DXF, .cp, .opx and .ori in, SVG, FOLD, DXF and .cp out. No
//! files, no printing: the caller reads the bytes and adds the file's name to what is said here.
//!
//! [`read`] takes two steps: a reader for each format makes strokes with roles, in mm with v up; one normaliser
//! makes a [`CreasePattern`] of them.
//!
//! | module | what it knows |
//! |---|---|
//! | `roles`, `colour` | which line is what |
//! | `document`, `strokes`, `path` | SVG: XML with lines, ids and exact geometry; usvg's transforms and styles |
//! | `drawing` | strokes, what every reader makes |
//! | `fold`, `dxf`, `lines`, `cp`, `opx`, `ori` | the other formats |
//! | `write` | patterns as SVG, FOLD and .cp |
//! | `normalise` | strokes to a pattern |
//! | `smooth`, `refit`, `fair`, `apart` | dense polylines to smooth curves |

mod apart;
mod colour;
mod cp;
mod document;
mod drawing;
pub mod dxf;
mod error;
mod fair;
mod fold;
mod lines;
mod normalise;
mod opx;
mod ori;
mod path;
mod refit;
mod roles;
mod smooth;
mod strokes;
mod write;

pub use dxf::{DxfOptions, DxfVersion, write_dxf};
pub use error::PatternError;
pub use fold::folded::read_folded;
pub use roles::RoleMap;
pub use write::{WriteOptions, write_cp, write_fold, write_svg};

use drawing::Stroke;
use softfold_geometry::{CreasePattern, Issue};

/// A format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Format {
    /// SVG in Origami Simulator's colours.
    Svg,
    /// FOLD 1.0 to 1.2.
    Fold,
    /// AutoCAD's DXF, text or binary.
    Dxf,
    /// ORIPA's and Orihime's line list.
    Cp,
    /// ORIPA's XML.
    Opx,
    /// Oriedita's save file.
    Ori,
}

impl Format {
    /// The format of a file with this ending (without dot, any case); none for others.
    pub fn of_ending(ending: &str) -> Option<Self> {
        match ending.to_ascii_lowercase().as_str() {
            "svg" => Some(Self::Svg),
            "fold" => Some(Self::Fold),
            "dxf" => Some(Self::Dxf),
            "cp" => Some(Self::Cp),
            "opx" => Some(Self::Opx),
            "ori" => Some(Self::Ori),
            _ => None,
        }
    }
}

/// What is the outline of the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outline {
    /// What is drawn as boundary; where nothing is, a closed contour around all creases that is convex.
    #[default]
    Drawn,
    /// The outermost lines, whatever their role.
    Lines,
    /// The convex hull of all lines.
    Hull,
}

/// How a file is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Millimetres per unit of the file, for files without a physical size; none: what is usual for the
    /// format, with a note that says so. A physical size in the file wins.
    pub unit_mm: Option<f64>,
    /// The user's word on roles.
    pub roles: RoleMap,
    /// What is the outline.
    pub outline: Outline,
    /// Which sheet of a file that holds several, from 1 in order of falling area; none: the largest.
    pub sheet: Option<usize>,
    /// Which frame of a FOLD file, from 0; none: the first that is a crease pattern.
    pub frame: Option<usize>,
    /// Dense polylines are refitted by smooth curves within this, mm; 0: never; none: by the sheet's size.
    pub refit_mm: Option<f64>,
    /// Ends closer than this are joined, mm; none: by the sheet's size.
    pub join_mm: Option<f64>,
    /// Gaps wider than this are refused, mm; none: by the sheet's size.
    pub refuse_mm: Option<f64>,
}

/// A pattern, and what was remarked or repaired while it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternFile {
    /// The pattern.
    pub pattern: CreasePattern,
    /// Notes and warnings, in the order in which they arose.
    pub issues: Vec<Issue>,
}

/// Why there is no pattern, and what else was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct Refused {
    /// The reason.
    pub error: PatternError,
    /// All that was found: notes, warnings and errors, the reason among them.
    pub issues: Vec<Issue>,
}

/// Reads the bytes of a file; `name` becomes the pattern's.
///
/// Roles come from [`ReadOptions::roles`], else from what the format says outright (`data-assignment` in SVG,
/// `edges_assignment` in FOLD, the line's type in .cp), else from the layer's name in DXF, else from the nearest
/// of the usual colours: black (boundary), red (mountain), blue (valley), yellow (flat), green (cut) and
/// magenta (unassigned); in SVG a colour that is none of these leaves the word to the layer's name. Fold
/// angles come from `data-foldAngle` or `edges_foldAngle` (degrees) or from an opacity below 1, times 180°;
/// otherwise the file does not say. Closed cuts are holes, open ones slits.
///
/// # Errors
/// Text that is not of its format or has no size, numbers that are none, an outline that is missing, open
/// or crosses itself, creases that leave the sheet. Lesser faults are mended and told in
/// [`PatternFile::issues`].
pub fn read(
    bytes: &[u8],
    format: Format,
    name: &str,
    options: &ReadOptions,
) -> Result<PatternFile, Box<Refused>> {
    let mut issues = Vec::new();
    match pattern(bytes, format, name, options, &mut issues) {
        Ok(pattern) => Ok(PatternFile { pattern, issues }),
        Err(error) => {
            if !issues.contains(error.issue()) {
                issues.push(error.issue().clone());
            }
            Err(Box::new(Refused { error, issues }))
        }
    }
}

fn pattern(
    bytes: &[u8],
    format: Format,
    name: &str,
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<CreasePattern, PatternError> {
    let strokes = match format {
        Format::Svg => svg(bytes, options, issues)?,
        Format::Fold => fold::strokes(bytes, options, issues)?,
        Format::Dxf => dxf::strokes(bytes, options, issues)?,
        Format::Cp => cp::strokes(bytes, options, issues)?,
        Format::Opx => opx::strokes(bytes, options, issues)?,
        Format::Ori => ori::strokes(bytes, options, issues)?,
    };
    let mut pattern = normalise::pattern(strokes, name, options, issues)?;
    smooth::smooth(&mut pattern, options, issues);
    Ok(pattern)
}

fn svg(bytes: &[u8], options: &ReadOptions, issues: &mut Vec<Issue>) -> Result<Vec<Stroke>, PatternError> {
    let text = error::utf8(bytes)?;
    let document = document::Document::parse(text, options, issues)?;
    strokes::collect(&document, options, issues)
}
