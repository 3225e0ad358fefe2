//! Bands cut into stretches: runs of fold lines side by side whose strips are meshed in common rows.

use crate::{MeshOptions, VERTEX_DENSITY};
use softfold_geometry::{Band, FoldLine, LineEnd};

/// The lines of a soft stretch from right to left, or the one line of a sharp stretch.
pub(crate) struct Stretch<'a> {
    pub(crate) band: &'a Band,
    /// Number in the band of the first line.
    pub(crate) first: u32,
    pub(crate) lines: &'a [FoldLine],
    /// Width of a strip where it is widest, mm; 0 for a sharp stretch.
    widest_mm: f64,
    /// At each end, if it is a tip: the length of crease on which strips are narrower than [`TIP_SHARE`] of the widest,
    /// mm; else 0.
    pub(crate) tips_mm: [f64; 2],
    /// Arc lengths of the crease at its ends, mm.
    ends_mm: [f64; 2],
}

/// Rows are no shorter than this share of the target, as long as the strips are wide enough for
/// [`MeshOptions::narrow_aspect`].
const SHORTEST: f64 = 0.25;
/// Where strips get narrower than this share of the widest on the way to a tip, one row goes on to the tip: strips narrow
/// down to nothing there, rows must not.
const TIP_SHARE: f64 = 1.0 / 64.0;
/// Halvings that find where that is.
const HALVINGS: u32 = 40;

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
        let ends_mm = lines.first().map_or([0.0; 2], |l| [l.s_mm[0], l.s_mm[l.s_mm.len() - 1]]);
        let mut stretch = Self { band, first, lines, widest_mm: 0.0, tips_mm: [0.0; 2], ends_mm };
        if !stretch.is_sharp() {
            let widths = lines.iter().flat_map(|l| &l.s_mm).map(|&s| stretch.width_mm(s));
            stretch.widest_mm = widths.fold(0.0, f64::max);
            stretch.tips_mm = [0, 1].map(|end| stretch.tip_mm(end));
        }
        stretch
    }

    /// Length of the narrow part before a tip, mm; 0 at other ends.
    fn tip_mm(&self, end: usize) -> f64 {
        if !self.lines.iter().all(|l| l.ends[end] == LineEnd::Tip) {
            return 0.0;
        }
        let (tip, far) = (self.ends_mm[end], self.ends_mm[1 - end]);
        let is_narrow = |share: f64| self.width_mm(tip + share * (far - tip)) < TIP_SHARE * self.widest_mm;
        // Widths are piecewise smooth between the places of the profile: the first one that is wide bounds the part.
        let share = |s: f64| (s - tip) / (far - tip);
        let places = self.band.profile.iter().map(|p| share(p.s_mm)).filter(|t| (0.0..1.0).contains(t));
        let mut wide = places.filter(|t| !is_narrow(*t)).fold(1.0, f64::min);
        let mut narrow = 0.0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (narrow + wide);
            *(if is_narrow(middle) { &mut narrow } else { &mut wide }) = middle;
        }
        (wide * (far - tip)).abs()
    }

    /// Whether an arc length of the crease is in the last row before a tip.
    pub(crate) fn is_at_tip(&self, s_mm: f64) -> bool {
        self.tip_at(s_mm).is_some()
    }

    fn tip_at(&self, s_mm: f64) -> Option<f64> {
        let within = |end: usize| (s_mm - self.ends_mm[end]).abs() < self.tips_mm[end];
        (0..2).find(|&end| within(end)).map(|end| self.tips_mm[end])
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
        let edge_mm = strip_edge_mm(self.width_mm(s_mm).max(TIP_SHARE * self.widest_mm), options);
        self.tip_at(s_mm).map_or(edge_mm, |tip_mm| tip_mm.max(edge_mm))
    }

    /// Wished length of its shortest rows, mm.
    pub(crate) fn narrowest_edge_mm(&self, options: &MeshOptions) -> f64 {
        let edges = self.lines.iter().flat_map(|l| self.edges_mm(l, options));
        let at_tips = self.tips_mm.iter().any(|t| *t > 0.0);
        let tip = if at_tips { strip_edge_mm(TIP_SHARE * self.widest_mm, options) } else { f64::MAX };
        edges.fold(tip.min(self.widest_edge_mm(options)), f64::min)
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
