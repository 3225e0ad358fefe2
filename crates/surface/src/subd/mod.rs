//! The paper's own route: a quad cage that conforms to the outline, made in the flat pattern and lifted.
//!
//! ```text
//! FlatMesh + SoftPattern ── frame ──► directions ── labels ──► pieces of the border ── grid ──► whole-number map
//!   ── extract ──► quads ── layer ──► corners inside ── smooth ──► flat cage
//! FoldedSheet + flat cage ── places, lift ──► control cage ── faces, merge, sew ──► Polysurface ── shape ──► shell
//! ```

mod background;
mod extract;
mod faces;
mod fit;
mod flat;
mod frame;
mod grid;
mod joins;
mod labels;
mod layer;
mod lift;
mod merge;
mod places;
mod quads;
mod quality;
mod rails;
mod sew;
mod shape;
mod smooth;
mod sparse;
mod turned;

#[cfg(test)]
mod tests;

pub use faces::BsplineFace;
pub use fit::{Conforming, fit_conforming};
pub use joins::{JoinAngle, Joins};
pub use quality::{CageQuality, Excused};
pub use sew::{EdgeUse, Polysurface, SharedEdge};
