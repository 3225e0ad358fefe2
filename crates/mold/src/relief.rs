//! How high the sheet rises over the bins of a fine lattice, so that any square made of bins knows its box at once.

use crate::plan::strip;
use crate::split::Axis;
use crate::top::Patch;
use glam::{DVec2, DVec3};

/// Least and greatest height per bin. Empty where there is no sheet; the default has no bins.
#[derive(Clone, Debug, Default)]
pub(crate) struct Relief {
    lower: DVec2,
    bin_mm: f64,
    count: [usize; 2],
    heights: Vec<[f64; 2]>,
}

/// No height at all.
const EMPTY: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl Relief {
    /// The heights of a patch over square bins from `lower` to `upper`; what lies beside them counts to the next bin.
    pub(crate) fn new(patch: &Patch, [lower, upper]: [DVec2; 2], bin_mm: f64) -> Self {
        let count = ((upper - lower) / bin_mm).ceil().max(DVec2::ONE).to_array().map(|n| n as usize);
        let mut relief = Self { lower, bin_mm, count, heights: vec![EMPTY; count[0] * count[1]] };
        for triangle in &patch.triangles {
            relief.add(&triangle.map(|i| patch.positions[i as usize]));
        }
        relief
    }

    /// Least and greatest height over the square whose lower left corner is `corner`; level where there is no sheet.
    pub(crate) fn over(&self, corner: DVec2, side_mm: f64) -> [f64; 2] {
        let bins = |d: usize| {
            let first = ((corner[d] - self.lower[d]) / self.bin_mm).round() as isize;
            let end = first + (side_mm / self.bin_mm).round() as isize;
            [first, end].map(|k| k.clamp(0, self.count[d] as isize) as usize)
        };
        let mut range = EMPTY;
        if self.heights.is_empty() {
            return [0.0; 2];
        }
        let [[i0, i1], [j0, j1]] = [bins(0), bins(1)];
        for i in i0..i1 {
            let column = &self.heights[i * self.count[1]..][j0..j1];
            range = column.iter().fold(range, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        }
        if range == EMPTY { [0.0; 2] } else { range }
    }

    fn add(&mut self, triangle: &[DVec3; 3]) {
        let [[i0, i1], [j0, j1]] = [Axis::X, Axis::Y].map(|axis| self.range(axis, triangle));
        for i in i0..=i1 {
            let column =
                if i0 == i1 { triangle.to_vec() } else { strip(triangle, Axis::X, self.span(Axis::X, i)) };
            for j in j0..=j1 {
                let piece =
                    if j0 == j1 { column.clone() } else { strip(&column, Axis::Y, self.span(Axis::Y, j)) };
                let bin = &mut self.heights[i * self.count[1] + j];
                *bin = piece.iter().fold(*bin, |[a, b], p| [a.min(p.z), b.max(p.z)]);
            }
        }
    }

    /// First and last bin that a triangle reaches.
    fn range(&self, axis: Axis, triangle: &[DVec3; 3]) -> [usize; 2] {
        let at = triangle.map(|p| (axis.of2(p.truncate()) - axis.of2(self.lower)) / self.bin_mm);
        let last = (self.count[axis as usize] - 1) as f64;
        let bin = |at: f64| at.floor().clamp(0.0, last) as usize;
        [bin(at.into_iter().fold(f64::INFINITY, f64::min)), bin(at.into_iter().fold(0.0, f64::max))]
    }

    /// From where to where a bin reaches; the first and the last without end.
    fn span(&self, axis: Axis, bin: usize) -> [f64; 2] {
        let at = |k: usize| axis.of2(self.lower) + k as f64 * self.bin_mm;
        let from = if bin == 0 { f64::NEG_INFINITY } else { at(bin) };
        let last = bin + 1 == self.count[axis as usize];
        [from, if last { f64::INFINITY } else { at(bin + 1) }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_of_a_tilted_plane_have_their_heights() {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 2.0 * x - 0.5 * y);
        let positions = vec![corner(0., 0.), corner(100., 0.), corner(100., 60.), corner(0., 60.)];
        let patch = Patch { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] };
        let relief = Relief::new(&patch, [DVec2::ZERO, DVec2::new(100.0, 60.0)], 5.0);
        for (x, y) in [(0.0, 0.0), (35.0, 20.0), (80.0, 40.0)] {
            let [least, greatest] = relief.over(DVec2::new(x, y), 20.0);
            assert!((least - (2.0 * x - 0.5 * (y + 20.0))).abs() < 1e-9, "{x} {y}: {least}");
            assert!((greatest - (2.0 * (x + 20.0) - 0.5 * y)).abs() < 1e-9, "{x} {y}: {greatest}");
        }
        let partly = relief.over(DVec2::new(-15.0, -15.0), 20.0);
        assert!((partly[0] + 2.5).abs() < 1e-9 && (partly[1] - 10.0).abs() < 1e-9, "{partly:?}");
        assert_eq!(relief.over(DVec2::new(-40.0, 0.0), 20.0), [0.0; 2], "beside the sheet");
    }
}
