//! From the folded sheet to its surface: one quad lattice over the flat sheet is a Catmull-Clark cage, whose limit, a
//! uniform bicubic B-spline in (u, v), is fitted to the folded vertices and trimmed by the flat outline.
//!
//! Values in, values out: no files, no printing, no clock; same input, same poles. Lengths are mm, angles radians.
//!
//! ```text
//! FoldedSheet + trim ── fit ──► Fitted { SheetSurface, Cage } ── analyse ──► SurfaceAnalysis
//!       + cuts ── fit_shell ──► FittedShell { SheetShell, cages }
//! ```
//! [`subd`] is the paper's own route: a cage that ends on the outline, converted to faces that share their edges.
//! Inside: `layout` divides the sheet along what is sharp or slit, `open` its mesh, `samples` lists what to fit, `lattice` lays
//! the cage, `poles` numbers the unknowns, `system` holds the sparse normal equations, `bending` their smoothing term, `fitting`
//! solves one lattice, `search` finds its spacing, `scale` reads the mesh's own. Figures of a finished surface: `analyse` its
//! extremes, `local` its shape at one point, `rulings` its straight lines, `bends` how much of it bends which way; the last
//! three ask nothing but a function of (u, v).

mod analyse;
mod bending;
mod bends;
mod error;
mod fitting;
mod lattice;
mod layout;
mod local;
mod open;
mod poles;
mod rulings;
mod samples;
mod scale;
mod search;
mod shell;
pub mod subd;
mod system;

#[cfg(test)]
mod shell_tests;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;

pub use analyse::{SurfaceAnalysis, analyse};
pub use bends::{BendShares, bend_shares};
pub use error::SurfaceError;
pub use lattice::Cage;
pub use local::LocalShape;
pub use rulings::{Bend, DOUBLE_BEND, Ruling, RulingOptions, rulings};

pub use layout::{Cut, CutKind};
pub use search::{Fitted, SurfaceOptions, fit};
pub use shell::{FittedShell, analyse_shell, fit_shell};
