//! Bands cut into stretches: runs of fold lines side by side whose strips are meshed in common rows.

use crate::{MeshOptions, VERTEX_DENSITY};
use softfold_geometry::{Band, FoldLine};

/// The lines of a soft stretch from right to left, or the one line of a sharp stretch.
pub(crate) struct Stretch<'a> {
    pub(crate) band: &'a Band,
    /// Number in the band of the first line.
    pub(crate) first: u32,
    pub(crate) lines: &'a [FoldLine],
    /// Width of a strip where it is widest, mm; 0 for a sharp stretch.
    widest_mm: f64,
}

/// Longest edge over the gap beside it: a right triangle of that shape has an angle of 27°.
pub(crate) const MOST_ASPECT: f64 = 2.0;
/// Rows are no shorter than this share of the target, as long as the strips are wide enough for
/// [`MeshOptions::narrow_aspect`].
const SHORTEST: f64 = 0.25;
/// Where a stretch tapers, rows get no shorter than at this share of its widest strip: strips narrow down to nothing
/// at a tip, rows must not.
const TIP_SHARE: f64 = 0.125;

/// The stretches of a band, in order.
pub(crate) fn stretches(band: &Band) -> Vec<Stretch<'_>> {
    let beside = |a: &FoldLine, b: &FoldLine| matches!((a.rank, b.rank), (Some(a), Some(b)) if a < b);
    let mut first = 0;
    let mut found = Vec::new();
    for lines in band.fold_lines.chunk_by(beside) {
        found.push(Stretch::new(band, first, lines));
        first += lines.len() as u32;
    }
    found
}

impl<'a> Stretch<'a> {
    fn new(band: &'a Band, first: u32, lines: &'a [FoldLine]) -> Self {
        let mut stretch = Self { band, first, lines, widest_mm: 0.0 };
        if !stretch.is_sharp() {
            let widths = lines.iter().flat_map(|l| &l.s_mm).map(|&s| stretch.width_mm(s));
            stretch.widest_mm = widths.fold(0.0, f64::max);
        }
        stretch
    }

    /// Whether it has no strips.
    pub(crate) fn is_sharp(&self) -> bool {
        self.lines.len() < 2
    }

    /// Whether its lines end where they start.
    pub(crate) fn is_closed(&self) -> bool {
        self.lines.iter().all(|l| l.points.first() == l.points.last())
    }

    /// The lines that border on the faces.
    pub(crate) fn outer_lines(&self) -> impl Iterator<Item = &'a FoldLine> {
        let last = self.lines.last().filter(|_| self.lines.len() > 1);
        self.lines.first().into_iter().chain(last)
    }

    /// Wished length of a row, mm, at an arc length of the crease.
    pub(crate) fn edge_mm(&self, s_mm: f64, options: &MeshOptions) -> f64 {
        if self.is_sharp() {
            return options.target_edge_mm;
        }
        strip_edge_mm(self.width_mm(s_mm).max(TIP_SHARE * self.widest_mm), options)
    }

    /// Whether strips are so narrow at an arc length of the crease that rows are longer than [`MOST_ASPECT`] of them.
    pub(crate) fn is_narrow(&self, s_mm: f64, options: &MeshOptions) -> bool {
        !self.is_sharp() && MOST_ASPECT * self.width_mm(s_mm) < SHORTEST * options.target_edge_mm
    }

    /// Whether it is so narrow anywhere.
    pub(crate) fn is_narrow_somewhere(&self, options: &MeshOptions) -> bool {
        self.lines.iter().flat_map(|l| &l.s_mm).any(|&s| self.is_narrow(s, options))
    }

    /// Whether it is so narrow everywhere.
    pub(crate) fn is_narrow_throughout(&self, options: &MeshOptions) -> bool {
        self.lines.iter().flat_map(|l| &l.s_mm).all(|&s| self.is_narrow(s, options))
    }

    /// Wished lengths of rows at the points of a line, mm.
    pub(crate) fn edges_mm(&self, line: &FoldLine, options: &MeshOptions) -> Vec<f64> {
        line.s_mm.iter().map(|&s| self.edge_mm(s, options)).collect()
    }

    /// Wished length of rows where the stretch is widest, mm.
    pub(crate) fn widest_edge_mm(&self, options: &MeshOptions) -> f64 {
        if self.is_sharp() { options.target_edge_mm } else { strip_edge_mm(self.widest_mm, options) }
    }

    /// Vertices that it asks for: its rows times its lines, and those between it and edges of the target's length on
    /// both sides, `∫ density/size² = density/(grading · row)` per mm.
    pub(crate) fn vertices(&self, options: &MeshOptions) -> f64 {
        let beside = if self.is_sharp() { 0.0 } else { 2.0 * VERTEX_DENSITY / options.grading };
        self.rows(options) * (self.lines.len() as f64 + beside)
    }

    fn rows(&self, options: &MeshOptions) -> f64 {
        let rows = |line: &FoldLine| {
            let edges = self.edges_mm(line, options);
            let piece = |i: usize| line.points[i].distance(line.points[i + 1]) / edges[i].min(edges[i + 1]);
            (0..line.points.len().saturating_sub(1)).map(piece).sum()
        };
        self.lines.iter().map(rows).fold(0.0, f64::max)
    }

    /// Width of its strips at an arc length of the crease, mm.
    pub(crate) fn width_mm(&self, s_mm: f64) -> f64 {
        self.band.at(s_mm).map_or(0.0, |s| s.strip_width_mm(self.band.segments))
    }
}

/// Wished length of rows across strips of a width: so many times as long as the strips are wide, and no longer than
/// the target.
fn strip_edge_mm(width_mm: f64, options: &MeshOptions) -> f64 {
    let shortest = (SHORTEST * options.target_edge_mm).min(options.narrow_aspect * width_mm);
    (options.band_aspect * width_mm).max(shortest).min(options.target_edge_mm)
}
