//! Points along the fold lines of a stretch: as many on each, so that rows run across the strips.

use crate::MeshOptions;
use crate::places::{running_sum, share};
use crate::size::SizeField;
use crate::stretch::Stretch;
use glam::DVec2;
use softfold_geometry::FoldLine;
use std::f64::consts::FRAC_PI_3;

/// A point on a fold line with the turn there, rad, and the length of the line up to it, mm.
pub(crate) type Sample = (DVec2, f64, f64);

/// A closed fold line of fewer pieces would close on itself.
const LEAST_PIECES_OF_A_RING: usize = 3;
/// A short open line gets a piece for so much of its bend, rad, and three at most: more are for the target to ask for.
const BEND_PER_PIECE_RAD: f64 = FRAC_PI_3;
/// Steps of the numerical integral of 1/size: so many for every edge of the target's length, and for every row, within
/// bounds: what asks for short rows at the ends must be felt.
const STEPS_PER_TARGET: f64 = 16.0;
const STEPS_PER_ROW: f64 = 8.0;
const STEPS: [f64; 2] = [64.0, 65536.0];

/// Neighbouring lines are set off against each other by half a row: triangles twice as long as wide then have angles of
/// 45° instead of 27°. Every other line begins and ends with half a row; lines that close on themselves are shifted by this
/// share of a row one way and the other.
const SHIFT: f64 = 0.25;

/// The first piece of a line set off by half a row is no shorter than so many widths of its strip, as far as this share
/// of the row allows.
const FIRST_PIECE: f64 = 1.0;
const MOST_OF_A_ROW: f64 = 0.85;

/// Where the ends of lines are shifted against each other, rows that run straight across become slanted like them within
/// so many times the shift.
const SLANT: f64 = 4.0;

/// Where the points of a line are.
enum Spacing {
    /// At equal parts of its length.
    Equal,
    /// At equal shares of this running sum over equal parts of its length.
    Graded(Vec<f64>),
}

/// The points of each line of a stretch: `least` pieces or more of each.
pub(crate) fn rows(
    stretch: &Stretch<'_>,
    options: &MeshOptions,
    sizes: &SizeField,
    least: usize,
) -> Vec<Vec<Sample>> {
    let lines = along_lines(stretch);
    let least = least.max(least_pieces(stretch));
    let (pieces, spacings) = spacings(stretch, &lines, options, sizes, least);
    let half_rows = !stretch.is_sharp() && !stretch.is_closed();
    let samples = |(number, (line, spacing)): (usize, (&Along, &Spacing))| {
        let length = |row: f64| line.length_mm_at(spacing, row, pieces);
        if half_rows && number % 2 == 1 {
            let half = half_rows_of(stretch, line, spacing, pieces);
            return half.into_iter().map(|row| line.at(length(row))).collect();
        }
        let shift = if number % 2 == 0 { SHIFT } else { -SHIFT };
        let sample = |k: usize| {
            // The seam of closed lines stays where it is.
            let shifted = stretch.is_closed() && k > 0 && k < pieces;
            line.at(length(if shifted { k as f64 + shift } else { k as f64 }))
        };
        (0..=pieces).map(sample).collect()
    };
    lines.iter().zip(&spacings).enumerate().map(samples).collect()
}

/// Rows at which a line has points that is set off against its neighbours by half a row.
fn half_rows_of(stretch: &Stretch<'_>, line: &Along, spacing: &Spacing, pieces: usize) -> Vec<f64> {
    let share = |from: f64, to: f64| {
        let [a, b] = [from, to].map(|row| line.length_mm_at(spacing, row, pieces));
        (FIRST_PIECE * stretch.width_mm(line.place_mm(a)) / (b - a).abs()).clamp(0.5, MOST_OF_A_ROW)
    };
    // At a tip the one row up to it is whole.
    let tips = stretch.tips_mm.map(|t| usize::from(t > 0.0 && pieces > 2));
    let (first, last) = (tips[0] as f64, (pieces - tips[1]) as f64);
    let mut rows: Vec<f64> = (tips[0]..pieces - tips[1]).map(|k| k as f64 + 0.5).collect();
    let count = rows.len();
    if count > 1 {
        rows[0] = first + share(first, first + 1.0);
        rows[count - 1] = last - share(last, last - 1.0);
    }
    rows.insert(0, first);
    rows.push(last);
    if tips[0] > 0 {
        rows.insert(0, 0.0);
    }
    if tips[1] > 0 {
        rows.push(pieces as f64);
    }
    rows
}

fn least_pieces(stretch: &Stretch<'_>) -> usize {
    if stretch.is_closed() {
        return LEAST_PIECES_OF_A_RING;
    }
    let bend = stretch.lines.iter().map(bend_rad).fold(0.0, f64::max);
    ((bend / BEND_PER_PIECE_RAD).ceil() as usize).clamp(1, LEAST_PIECES_OF_A_RING)
}

/// Sum of the turns between the sides of a line, rad.
fn bend_rad(line: &FoldLine) -> f64 {
    let angle = |w: &[DVec2]| (w[1] - w[0]).angle_to(w[2] - w[1]).abs();
    line.points.windows(3).map(angle).filter(|a| a.is_finite()).sum()
}

fn spacings(
    stretch: &Stretch<'_>,
    lines: &[Along],
    options: &MeshOptions,
    sizes: &SizeField,
    least: usize,
) -> (usize, Vec<Spacing>) {
    let longest = lines.iter().map(Along::length_mm).fold(0.0, f64::max);
    let row_mm = stretch.narrowest_edge_mm(options);
    let per_mm = (STEPS_PER_TARGET / options.target_edge_mm).max(STEPS_PER_ROW / row_mm);
    let steps = (per_mm * longest).clamp(STEPS[0], STEPS[1]) as usize;
    let middle = |k: usize| (k as f64 + 0.5) / steps as f64;
    let around = |k: usize| {
        let at = |line: &Along| sizes.at(line.at(line.length_mm() * middle(k)).0);
        lines.first().into_iter().chain(lines.last()).map(at).fold(f64::MAX, f64::min)
    };
    let around: Vec<f64> = (0..steps).map(around).collect();
    if let Some(edge_mm) = common_edge_mm(stretch, options)
        && around.iter().all(|&size| size >= edge_mm)
    {
        let pieces = (longest / edge_mm).round().max(least as f64) as usize;
        return (pieces, lines.iter().map(|_| Spacing::Equal).collect());
    }
    let density = |line: &Along, k: usize| {
        let s_mm = line.place_mm(line.length_mm() * middle(k));
        let own = stretch.edge_mm(s_mm, options);
        let size = if stretch.is_at_tip(s_mm) { own } else { own.min(around[k]) };
        line.length_mm() / steps as f64 / size
    };
    let integral = |line| running_sum((0..steps).map(|k| density(line, k)));
    let integrals: Vec<Vec<f64>> = lines.iter().map(integral).collect();
    let most = integrals.iter().map(|i| i[steps]).fold(0.0, f64::max);
    let pieces = (most.round() as usize).max(least);
    (pieces, integrals.into_iter().map(Spacing::Graded).collect())
}

/// The length of all rows of a stretch, if it is the same for all.
fn common_edge_mm(stretch: &Stretch<'_>, options: &MeshOptions) -> Option<f64> {
    let mut edges = stretch.lines.iter().flat_map(|l| stretch.edges_mm(l, options));
    let first = edges.next()?;
    edges.all(|e| e == first).then_some(first)
}

/// The lines of a stretch by what their rows are spaced by.
fn along_lines(stretch: &Stretch<'_>) -> Vec<Along> {
    let by_length = || stretch.lines.iter().map(Along::by_length).collect();
    let ascends = |l: &FoldLine| l.s_mm.windows(2).all(|w| w[0] < w[1]);
    if stretch.is_sharp() || !stretch.lines.iter().all(ascends) {
        return by_length();
    }
    let ends = |l: &FoldLine| [l.s_mm[0], l.s_mm[l.s_mm.len() - 1]];
    let count = stretch.lines.len() as f64;
    let mean = [0, 1].map(|k| stretch.lines.iter().map(|l| ends(l)[k]).sum::<f64>() / count);
    let off = |l: &FoldLine| (0..2).map(|k| (ends(l)[k] - mean[k]).abs()).fold(0.0, f64::max);
    let reach = SLANT * stretch.lines.iter().map(off).fold(0.0, f64::max);
    let inner = [mean[0] + reach, mean[1] - reach];
    if inner[0] >= inner[1] {
        return by_length();
    }
    stretch.lines.iter().map(|l| Along::by_crease(l, mean, inner)).collect()
}

/// A fold line by the length of its polyline, or by arc length on the crease.
struct Along {
    samples: Vec<Sample>,
    /// Arc length on the crease at each point, mm.
    s_mm: Vec<f64>,
    /// What rows are spaced by, at each point, from 0 on, mm.
    along: Vec<f64>,
}

impl Along {
    fn by_length(line: &FoldLine) -> Self {
        let along = running_sum(line.points.windows(2).map(|w| w[0].distance(w[1])));
        let sample = |i: usize| (line.points[i], line.turns_rad[i], along[i]);
        Self { samples: (0..along.len()).map(sample).collect(), s_mm: line.s_mm.clone(), along }
    }

    /// By arc length on the crease between the `inner` places, so that rows run straight across; before and after,
    /// stretched so that the line's ends are at the `ends` of all lines.
    fn by_crease(line: &FoldLine, ends: [f64; 2], inner: [f64; 2]) -> Self {
        let mut along = Self::by_length(line);
        along.along.clone_from(&along.s_mm);
        inner.into_iter().for_each(|s| along.insert(s));
        let own = [along.s_mm[0], along.s_mm[along.s_mm.len() - 1]];
        let row = |s: f64| match s {
            s if s < inner[0] => ends[0] + (s - own[0]) / (inner[0] - own[0]) * (inner[0] - ends[0]),
            s if s > inner[1] => ends[1] - (own[1] - s) / (own[1] - inner[1]) * (ends[1] - inner[1]),
            s => s,
        };
        along.along = along.s_mm.iter().map(|s| row(*s) - ends[0]).collect();
        along
    }

    /// Adds a point.
    fn insert(&mut self, along: f64) {
        let (i, _) = self.side(along);
        let (sample, s_mm) = (self.at(along), self.place_mm(along));
        if self.along[i - 1] < along && along < self.along[i] {
            self.samples.insert(i, sample);
            self.s_mm.insert(i, s_mm);
            self.along.insert(i, along);
        }
    }

    fn length_mm(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    /// The side at a length, and the share of it.
    fn side(&self, s: f64) -> (usize, f64) {
        let along = &self.along;
        let i = along.partition_point(|&a| a <= s).clamp(1, along.len() - 1);
        (i, ((s - along[i - 1]) / (along[i] - along[i - 1])).clamp(0.0, 1.0))
    }

    fn at(&self, s: f64) -> Sample {
        let (i, t) = self.side(s);
        let [(p, turn, length), (q, to, longer)] = [self.samples[i - 1], self.samples[i]];
        (p.lerp(q, t), turn * (1.0 - t) + to * t, length * (1.0 - t) + longer * t)
    }

    /// Arc length on the crease at a length.
    fn place_mm(&self, s: f64) -> f64 {
        let (i, t) = self.side(s);
        self.s_mm[i - 1] + t * (self.s_mm[i] - self.s_mm[i - 1])
    }

    /// The length at which so many rows of `pieces` are passed.
    fn length_mm_at(&self, spacing: &Spacing, row: f64, pieces: usize) -> f64 {
        let total = self.length_mm();
        match spacing {
            Spacing::Equal => total * row / pieces as f64,
            Spacing::Graded(integral) => {
                total * share(integral, row / pieces as f64) / (integral.len() - 1) as f64
            }
        }
    }
}
