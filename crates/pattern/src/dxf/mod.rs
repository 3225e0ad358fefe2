//! DXF in and out: what patterns are read from and written as, and drawings for workshops ([`Drawing`]).
//!
//! Reading has four steps: groups (`tags`), sections (`content`), curves of single entities (`entities`, `spline`),
//! and the walk through the model that unfolds blocks and gives roles (`walk`). Writing is in `write`.
//!
//! The groups are read here and not by the crate `dxf` (0.6.2, MIT), though that one is robust (no panic in 2850
//! damaged files): its entities have no line numbers, those that it does not know it drops without a word, it takes
//! `nan` for a coordinate, refuses files for a fault in sections that do not matter here, and brings `image` and
//! `chrono` (30 crates, 50 s of compiling). Blocks, axes, bulges and splines, the larger part, it leaves to its user.

mod aci;
mod blocks;
mod content;
mod curve;
mod entities;
mod fields;
mod remarks;
mod spline;
mod tags;
#[cfg(test)]
mod tests;
mod through;
mod units;
mod walk;
mod write;

pub use write::{Drawing, DrawingError, DxfOptions, DxfVersion, Entity, Layer, colour, write_dxf};

use crate::drawing::Stroke;
use crate::error::issue;
use crate::{PatternError, ReadOptions};
use softfold_geometry::{Issue, Severity};

/// The lines of the model of a DXF file, text or binary, in mm.
///
/// Roles come from [`ReadOptions::roles`] (elements by handle, `3F`; inside blocks by the handles of the INSERTs
/// too, `4A/3F`), else from the layer's name, else from the colour.
///
/// # Errors
/// What is no DXF, numbers that are none, blocks that hold themselves, a drawing without lines of a pattern.
pub(crate) fn strokes(
    bytes: &[u8],
    options: &ReadOptions,
    issues: &mut Vec<Issue>,
) -> Result<Vec<Stroke>, PatternError> {
    let tags = tags::read(bytes)?;
    let content = content::Content::read(&tags, issues)?;
    let unit_mm = units::unit_mm(&content.header, options, issues);
    let strokes = walk::Walk::new(&content, &options.roles, unit_mm).strokes(issues)?;
    if strokes.is_empty() {
        let what = "nothing is drawn in a layer or colour of a crease pattern";
        let mend = "draw the outline on a layer CUT, mountains on MOUNTAIN, valleys on VALLEY";
        return Err(PatternError::Nothing(issue(Severity::Error, what, mend)));
    }
    Ok(strokes)
}
