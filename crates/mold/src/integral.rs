//! Integrals over the sheet inside its trim, of what is smooth between knots.

use crate::plan::GAUSS;
use glam::DVec2;
use softfold_geometry::{PlanarCurve, Segment};
use std::collections::BTreeMap;

/// Every segment of the trim is looked at in so many pieces, in each of which it meets a knot line once.
const PIECES: usize = 64;
/// Every so manieth end of them ends a piece of the integral too, however few knots the segment meets: for small holes.
const PIECES_PER_STEP: usize = 8;
/// Halvings that find a crossing to the last digit.
const BISECTIONS: usize = 60;

/// `∫∫ f du dv` over the inside of the trim (outline counter-clockwise, holes clockwise). `f` is smooth between knots, which
/// cover the trim; five nodes of Gauss and Legendre each way in every cell are exact to degree nine, and cells that the
/// trim passes through are integrated along it, by Green's theorem.
pub(crate) fn over_trim<const N: usize>(
    trim: &[PlanarCurve],
    knots: [&[f64]; 2],
    f: impl Fn(DVec2) -> [f64; N],
) -> [f64; N] {
    let mut rows: BTreeMap<usize, BTreeMap<usize, Vec<Piece<'_>>>> = BTreeMap::new();
    for segment in trim.iter().flat_map(|curve| curve.segments()) {
        for piece in pieces(segment, knots) {
            let [i, j] = piece.cell;
            rows.entry(j).or_default().entry(i).or_default().push(piece);
        }
    }
    let domain = Domain { knots, f };
    let mut sum = [0.0; N];
    rows.iter().for_each(|(&j, cells)| domain.add_row(j, cells, &mut sum));
    sum
}

/// A piece of a trim segment inside one cell.
struct Piece<'a> {
    segment: &'a Segment,
    /// From and to, of 0 to 1.
    span: [f64; 2],
    cell: [usize; 2],
}

fn pieces<'a>(segment: &'a Segment, knots: [&[f64]; 2]) -> Vec<Piece<'a>> {
    let mut ends: Vec<f64> = (0..=PIECES).step_by(PIECES_PER_STEP).map(share).collect();
    (0..PIECES).for_each(|k| {
        for axis in [0, 1] {
            crossings(segment, axis, knots[axis], [share(k), share(k + 1)], &mut ends);
        }
    });
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let cell = |t: f64| [0, 1].map(|axis| cell_of(knots[axis], at(segment, t)[axis]));
    ends.windows(2).map(|w| Piece { segment, span: [w[0], w[1]], cell: cell(0.5 * (w[0] + w[1])) }).collect()
}

fn share(piece: usize) -> f64 {
    piece as f64 / PIECES as f64
}

fn cell_of(knots: &[f64], t: f64) -> usize {
    knots.partition_point(|k| *k <= t).clamp(1, knots.len() - 1) - 1
}

/// Adds where a coordinate of the segment meets the knots between two of its parameters.
fn crossings(segment: &Segment, axis: usize, knots: &[f64], span: [f64; 2], ends: &mut Vec<f64>) {
    let [from, to] = span.map(|t| at(segment, t)[axis]);
    let (low, high) = (from.min(to), from.max(to));
    let first = knots.partition_point(|k| *k <= low);
    for knot in knots[first..].iter().take_while(|k| **k < high) {
        let [mut a, mut b] = span;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (a + b);
            let same = (at(segment, middle)[axis] - knot) * (from - knot) > 0.0;
            if same { a = middle } else { b = middle }
        }
        ends.push(0.5 * (a + b));
    }
}

fn at(segment: &Segment, t: f64) -> DVec2 {
    match *segment {
        Segment::Line { from, to } => from.lerp(to, t),
        Segment::Cubic { from, c1, c2, to } => {
            let s = 1.0 - t;
            s * s * s * from + 3.0 * s * t * (s * c1 + t * c2) + t * t * t * to
        }
    }
}

fn rate(segment: &Segment, t: f64) -> DVec2 {
    match *segment {
        Segment::Line { from, to } => to - from,
        Segment::Cubic { from, c1, c2, to } => {
            let s = 1.0 - t;
            3.0 * (s * s * (c1 - from) + 2.0 * s * t * (c2 - c1) + t * t * (to - c2))
        }
    }
}

/// Nodes and weights on an interval.
fn nodes(from: f64, to: f64) -> [(f64, f64); 5] {
    let half = 0.5 * (to - from);
    GAUSS.map(|(node, weight)| (from + half * (1.0 + node), half * weight))
}

fn add<const N: usize>(sum: &mut [f64; N], weight: f64, value: [f64; N]) {
    sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * v);
}

struct Domain<'a, F> {
    knots: [&'a [f64]; 2],
    f: F,
}

impl<F> Domain<'_, F> {
    /// All cells of a row, from the right to the left. What lies to the right of a cell tells which part of its right side is
    /// inside: the ends of the trim's pieces there, upwards counted as 1 and downwards as −1.
    fn add_row<const N: usize>(&self, j: usize, cells: &BTreeMap<usize, Vec<Piece<'_>>>, sum: &mut [f64; N])
    where
        F: Fn(DVec2) -> [f64; N],
    {
        let mut right: BTreeMap<u64, (f64, i32)> = BTreeMap::new();
        let mut ends = cells.keys().rev().skip(1);
        for (&i, pieces) in cells.iter().rev() {
            pieces.iter().for_each(|piece| self.add_piece(piece, sum));
            self.add_side([i, j], &right, sum);
            for (v, sign) in
                pieces.iter().flat_map(|p| p.span.map(|t| at(p.segment, t).y).into_iter().zip([-1, 1]))
            {
                right.entry(v.to_bits()).or_insert((v, 0)).1 += sign;
            }
            right.retain(|_, (_, count)| *count != 0);
            let between = ends.next().map_or(0, |next| next + 1)..i;
            // Cells that no piece passes through are inside as a whole, or not at all.
            let inside: f64 = right.values().map(|(v, count)| v * f64::from(*count)).sum();
            if inside > 0.5 * (self.knots[1][j + 1] - self.knots[1][j]) {
                between.for_each(|whole| self.add_strip([whole, j], self.knots[1][j + 1], 1.0, sum));
            }
        }
    }

    /// `∫ (∫ f du) dv` along a piece, from the left side of its cell to the piece.
    fn add_piece<const N: usize>(&self, piece: &Piece<'_>, sum: &mut [f64; N])
    where
        F: Fn(DVec2) -> [f64; N],
    {
        for (t, weight) in nodes(piece.span[0], piece.span[1]) {
            let (p, dv) = (at(piece.segment, t), rate(piece.segment, t).y);
            self.add_line(piece.cell[0], p.x, p.y, weight * dv, sum);
        }
    }

    /// The part of a cell to the left of what of its right side is inside.
    fn add_side<const N: usize>(
        &self,
        cell: [usize; 2],
        right: &BTreeMap<u64, (f64, i32)>,
        sum: &mut [f64; N],
    ) where
        F: Fn(DVec2) -> [f64; N],
    {
        right.values().for_each(|(v, count)| self.add_strip(cell, *v, f64::from(*count), sum));
    }

    /// A cell from its lower side to v, so many times.
    fn add_strip<const N: usize>(&self, [i, j]: [usize; 2], v: f64, times: f64, sum: &mut [f64; N])
    where
        F: Fn(DVec2) -> [f64; N],
    {
        for (v, weight) in nodes(self.knots[1][j], v) {
            self.add_line(i, self.knots[0][i + 1], v, times * weight, sum);
        }
    }

    /// A line along u from the left side of a cell.
    fn add_line<const N: usize>(&self, i: usize, to: f64, v: f64, times: f64, sum: &mut [f64; N])
    where
        F: Fn(DVec2) -> [f64; N],
    {
        for (u, weight) in nodes(self.knots[0][i], to) {
            add(sum, times * weight, (self.f)(DVec2::new(u, v)));
        }
    }
}

/// The knots of both, ascending; those nearer than rounding are one.
pub(crate) fn united(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut all = [a, b].concat();
    all.sort_by(f64::total_cmp);
    let rounding = 1e-12 * (all[all.len() - 1] - all[0]);
    all.dedup_by(|next, kept| *next - *kept < rounding);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use std::f64::consts::PI;

    fn grid(step: f64) -> Vec<f64> {
        (-40..=40).map(|k| step * f64::from(k) + 0.37).collect()
    }

    #[test]
    fn moments_of_an_ellipse_and_its_hole_are_exact() {
        // A circle by cubics is a little off, so that moments are compared with those along the curve.
        let (outer, inner) = (shapes::ellipse(150.0, 90.0), shapes::ellipse(3.1, 2.2).reversed());
        let trim = [outer, inner];
        let knots = grid(7.7);
        let [area, u, uu_v] = over_trim(&trim, [&knots, &knots], |p| [1.0, p.x, p.x * p.x * p.y.powi(2)]);
        let exact: f64 = trim.iter().map(|c| c.signed_area_mm2()).sum();
        assert!((area / exact - 1.0).abs() < 1e-12, "{area} {exact}");
        assert!(u.abs() < 1e-7);
        let moment = |a: f64, b: f64| PI / 24.0 * a.powi(3) * b.powi(3);
        assert!((uu_v / (moment(150.0, 90.0) - moment(3.1, 2.2)) - 1.0).abs() < 2e-3, "{uu_v}");
    }

    #[test]
    fn coarse_and_fine_cells_give_the_same() {
        let trim = [shapes::ellipse(151.3, 92.7), shapes::ellipse(33.1, 17.9).reversed()];
        let f = |p: DVec2| [p.x.powi(5) * p.y + p.y.powi(4), 1e3 * p.x * p.x];
        let found = [200.0, 41.0, 9.3, 4.1].map(|step| {
            let knots = grid(step);
            over_trim(&trim, [&knots, &knots], f)
        });
        for other in &found[1..] {
            (0..2).for_each(|k| assert!((other[k] / found[0][k] - 1.0).abs() < 1e-9, "{found:?}"));
        }
    }

    #[test]
    fn sides_along_knots_are_no_trouble() {
        let knots: Vec<f64> = (-6..=6).map(|k| 10.0 * f64::from(k)).collect();
        let trim = [shapes::rectangle(100.0, 60.0), shapes::rectangle(20.0, 40.0).reversed()];
        let [area, second] = over_trim(&trim, [&knots, &knots], |p| [1.0, p.y * p.y]);
        assert!((area - 5200.0).abs() < 1e-9, "{area}");
        let exact = (100.0 * 60f64.powi(3) - 20.0 * 40f64.powi(3)) / 12.0;
        assert!((second / exact - 1.0).abs() < 1e-12);
    }

    #[test]
    fn knots_of_two_are_united() {
        assert_eq!(united(&[0.0, 1.0, 2.0], &[0.0, 0.5, 1.0 + 1e-14, 2.0]), [0.0, 0.5, 1.0, 2.0]);
    }
}
