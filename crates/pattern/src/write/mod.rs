//! Patterns as text: SVG with exact curves, FOLD and .cp with straight edges.

mod cp;
mod fold;
mod planar;
mod svg;

pub use cp::write_cp;
pub use fold::write_fold;
pub use svg::write_svg;

use softfold_geometry::CreasePattern;

/// Chord error of written polylines, mm, that no cutter or folder resolves.
const CHORD_MM: f64 = 0.02;
/// The same as a share of the sheet's size, for sheets below 200 mm.
const CHORD_SHARE: f64 = 1e-4;

/// How patterns are written in formats without curves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Largest distance between a curve and the edges that stand for it, mm; none (or no positive number): 0.02
    /// mm, for sheets below 200 mm a ten-thousandth of the size. Never below a millionth of the size.
    pub chord_mm: Option<f64>,
}

impl WriteOptions {
    /// The chord error for a pattern.
    fn chord_for(&self, pattern: &CreasePattern) -> f64 {
        let usual = CHORD_MM.min(CHORD_SHARE * pattern.size_mm());
        self.chord_mm.filter(|c| c.is_finite() && *c > 0.0).unwrap_or(usual).max(pattern.tolerance().chord_mm)
    }
}
