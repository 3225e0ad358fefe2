//! A lattice of equilateral triangles for the wide parts of a sheet, where edges are as long as the target throughout:
//! no other points are as even, and none are found as fast.

use crate::background::Background;
use crate::rng::SplitMix64;
use glam::DVec2;
use std::f64::consts::FRAC_PI_3;

/// Points keep this distance from those given, share of the target.
const APART: f64 = 0.86;
/// Points are off the lattice at random by up to this share of the target, both ways: no three lie on one line.
const OFF: f64 = 0.03;
/// Height of an equilateral triangle over its side.
const HEIGHT: f64 = 0.866_025_403_784_438_6;

/// Points of the lattice in their rows.
#[derive(Default)]
struct Lattice {
    points: Vec<DVec2>,
    /// Per row: the number in the row of its first place, and where its places begin.
    rows: Vec<(i64, usize)>,
    /// Per place: whether a point is there.
    kept: Vec<bool>,
}

/// Adds the points that lie on the sheet and away from the points given, in patches of seven or more; per point added
/// whether its six neighbours are there too. The seed turns the lattice, moves it, and shakes its points.
pub(crate) fn fill(points: &mut Vec<DVec2>, grid: &mut Background<'_>, rng: &mut SplitMix64) -> Vec<bool> {
    let lattice = Lattice::new(points, grid, rng);
    let whole: Vec<bool> = lattice.places().map(|(row, i)| lattice.is_whole(row, i)).collect();
    let beside = |row: usize, i: i64| lattice.around(row, i).into_iter().flatten().any(|n| whole[n]);
    let mut added = Vec::new();
    for ((row, i), &whole) in lattice.places().zip(&whole) {
        let place = lattice.place(row, i).unwrap_or(0);
        if lattice.kept[place] && (whole || beside(row, i)) {
            points.push(lattice.points[place]);
            grid.insert(lattice.points[place]);
            added.push(whole);
        }
    }
    added
}

impl Lattice {
    fn new(points: &[DVec2], grid: &mut Background<'_>, rng: &mut SplitMix64) -> Self {
        let side = grid.target_mm();
        let (low, high) = grid.bounds();
        let along = DVec2::from_angle(FRAC_PI_3 * rng.unit());
        let across = along.perp();
        let origin = low + side * DVec2::new(rng.unit(), rng.unit());
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)].map(|c| c - origin);
        let heights = corners.map(|c| c.dot(across) / (HEIGHT * side));
        let [first, last] = [
            heights.iter().copied().fold(f64::MAX, f64::min),
            heights.iter().copied().fold(f64::MIN, f64::max),
        ];
        let (mut lattice, mut near) = (Self::default(), Vec::new());
        for row in first.ceil() as i64..=last.floor() as i64 {
            let start = origin + (HEIGHT * side * row as f64) * across + (0.5 * side * row as f64) * along;
            let Some([from, to]) = clipped(start, along, [low, high]) else {
                lattice.rows.push((0, lattice.kept.len()));
                continue;
            };
            let [from, to] = [(from / side).ceil() as i64, (to / side).floor() as i64];
            lattice.rows.push((from, lattice.kept.len()));
            for i in from..=to {
                let off = 2.0 * DVec2::new(rng.unit(), rng.unit()) - DVec2::ONE;
                let p = start + (side * i as f64) * along + OFF * side * off;
                let is_clear = grid.is_even(p) && grid.is_sheet(p) && {
                    grid.near(points, p, APART * side, &mut near);
                    near.is_empty()
                };
                lattice.points.push(p);
                lattice.kept.push(is_clear);
            }
        }
        lattice.rows.push((0, lattice.kept.len()));
        lattice
    }

    /// All places, by row and number in it.
    fn places(&self) -> impl Iterator<Item = (usize, i64)> {
        let in_row = |(row, w): (usize, &[(i64, usize)])| {
            let (first, count) = (w[0].0, (w[1].1 - w[0].1) as i64);
            (first..first + count).map(move |i| (row, i))
        };
        self.rows.windows(2).enumerate().flat_map(in_row)
    }

    fn place(&self, row: usize, i: i64) -> Option<usize> {
        let (&(first, start), &(_, end)) = (self.rows.get(row)?, self.rows.get(row + 1)?);
        let place = start + usize::try_from(i - first).ok()?;
        (place < end).then_some(place)
    }

    fn around(&self, row: usize, i: i64) -> [Option<usize>; 6] {
        let above = row + 1;
        let below = row.wrapping_sub(1);
        [(row, i - 1), (row, i + 1), (above, i), (above, i - 1), (below, i), (below, i + 1)]
            .map(|(row, i)| if row == usize::MAX { None } else { self.place(row, i) })
    }

    fn is_whole(&self, row: usize, i: i64) -> bool {
        let is_kept = |place: Option<usize>| place.is_some_and(|p| self.kept[p]);
        is_kept(self.place(row, i)) && self.around(row, i).into_iter().all(is_kept)
    }
}

/// The part of a line inside a box, as lengths along it.
fn clipped(start: DVec2, along: DVec2, [low, high]: [DVec2; 2]) -> Option<[f64; 2]> {
    let (mut from, mut to) = (f64::MIN, f64::MAX);
    for k in 0..2 {
        if along[k].abs() < f64::EPSILON {
            if start[k] < low[k] || start[k] > high[k] {
                return None;
            }
            continue;
        }
        let [a, b] = [low[k], high[k]].map(|wall| (wall - start[k]) / along[k]);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from <= to).then_some([from, to])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshOptions;
    use crate::size::{SizeField, source};

    const SIDE_MM: f64 = 60.0;
    const TARGET_MM: f64 = 2.0;

    fn filled(seed: u64) -> (Vec<DVec2>, Vec<bool>) {
        let square =
            vec![[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|p| SIDE_MM * DVec2::from(p)).to_vec()];
        let options = MeshOptions { target_edge_mm: TARGET_MM, ..MeshOptions::default() };
        let sizes = SizeField::from_sources(vec![source(DVec2::splat(30.0), 0.5)], &options);
        let mut grid = Background::new(&square, &sizes);
        let mut points = vec![DVec2::new(11.0, 12.0)];
        grid.insert(points[0]);
        let whole = fill(&mut points, &mut grid, &mut SplitMix64(seed));
        (points, whole)
    }

    #[test]
    fn points_are_as_many_as_equilateral_triangles_have_and_keep_their_distance() {
        for seed in 0..20 {
            let (points, whole) = filled(seed);
            let least = |i: usize| {
                let others = points.iter().enumerate().filter(|(j, _)| *j != i);
                others.map(|(_, q)| q.distance(points[i])).fold(f64::MAX, f64::min)
            };
            for (i, p) in points.iter().enumerate().skip(1) {
                let apart = p.distance(points[0]);
                assert!(apart >= APART * TARGET_MM && p.distance(DVec2::splat(30.0)) > 4.0, "{seed} {p}");
                assert!(p.min_element() >= 0.0 && p.max_element() <= SIDE_MM);
                assert!(i == 0 || least(i) > APART * TARGET_MM, "{seed}: {}", least(i));
            }
            let inner = (SIDE_MM - 2.0 * TARGET_MM).powi(2) - std::f64::consts::PI * 10.0_f64.powi(2);
            let density = crate::VERTEX_DENSITY / TARGET_MM.powi(2);
            assert!(points.len() as f64 > 0.9 * density * inner, "{seed}: {}", points.len());
            assert!((points.len() as f64) < density * SIDE_MM * SIDE_MM, "{seed}: {}", points.len());
            assert!(whole.iter().filter(|w| **w).count() * 10 > whole.len() * 7);
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_points_and_another_does_not() {
        assert_eq!(filled(1), filled(1));
        assert_ne!(filled(1).0, filled(2).0);
    }

    #[test]
    fn a_line_is_clipped_to_its_box() {
        let walls = [DVec2::ZERO, DVec2::new(4.0, 2.0)];
        assert_eq!(clipped(DVec2::new(-1.0, 1.0), DVec2::X, walls), Some([1.0, 5.0]));
        assert_eq!(clipped(DVec2::new(-1.0, 3.0), DVec2::X, walls), None);
        assert_eq!(clipped(DVec2::ZERO, DVec2::ONE, walls), Some([0.0, 2.0]));
    }
}
