//! From creases to bands: every crease becomes a strip of fold lines that share its turn. No files,
//! no printing; a pattern and a softness for each crease in, a [`SoftPattern`] out.
//!
//! A fold of radius `r` is an arc; on the flat sheet it is a band of `n` strips, each as wide as a chord of
//! the arc, centred on the crease (Koschitz, Foschi, Maleczek, "Algorithmic Design and Fabrication of
//! Soft Curved-Folding", eq. 1 to 3; [`BandFigures`]). Radius and fold angle may change along the
//! crease: the `n + 1` fold lines keep their shares of the width, and come together in a tip where it
//! vanishes. Where creases meet, the bands are cut back to a region that they leave free. Bands that do not
//! fit are refused with the largest radius that does.
//!
//! | module | what it knows |
//! |---|---|
//! | `along` | radius and fold angle as they are asked for |
//! | `thickness` | radii that a board can bear |
//! | `figures` | the numbers of a band |
//! | `profile` | radius and fold angle along one crease; soft and sharp stretches |
//! | `path`, `run_on`, `spine` | a crease sampled for its fold lines |
//! | `boundary` | where fold lines meet outline, holes and slits, exactly |
//! | `layout` | where the ends of creases are |
//! | `junction` | how bands are cut back where creases meet |
//! | `lines`, `shape` | one band on the sheet, and whether it fits |
//! | `contact` | whether bands reach each other |
//! | `stage` | the order of work; the largest radius that fits |
//! | `regions` | every region of the sheet, with its exact area |
//! | `picture` | the bands as SVG |

mod along;
mod boundary;
mod contact;
mod error;
mod figures;
mod junction;
mod layout;
mod lines;
mod path;
mod picture;
mod profile;
mod regions;
mod run_on;
mod shape;
mod spine;
mod stage;
pub mod thickness;

pub use along::{Along, AlongFault, CreaseSoftness, Segments};
pub use error::{Fault, Misfit, SoftenError};
pub use figures::BandFigures;
pub use picture::write_svg;
pub use regions::{RegionKind, SheetRegion, regions};
pub use thickness::{Board, BoardFault, Compensated, Compensation, compensated};

use softfold_geometry::{CreasePattern, SoftPattern};

/// Softens every crease; `softness[i]` is for the crease with id `i`.
///
/// Bands keep the order of the creases. A sharp stretch of a crease has a single fold line, one without fold
/// angle none. A flat crease ([`softfold_geometry::Role::Flat`]) folds nothing: its softness is not looked
/// at, and its band has no fold lines. Fold lines end exactly on the boundary where their crease does, at
/// the region of a junction where creases meet, otherwise square to the crease's free end; those of
/// a closed crease repeat their first point at the end. Arc lengths of a closed crease that is soft in parts
/// start where its first stretch ends and go on past its length.
///
/// # Errors
/// The first request that is no softness, then the first band that does not fit: it reaches its
/// centre of curvature, itself, the boundary sideways, or another band, or where creases meet there is
/// no room for a region between their bands.
pub fn soften(pattern: &CreasePattern, softness: &[CreaseSoftness]) -> Result<SoftPattern, SoftenError> {
    if softness.len() != pattern.creases.len() {
        return Err(SoftenError::Count { creases: pattern.creases.len(), given: softness.len() });
    }
    stage::Stage::new(pattern, softness)?.run()
}
