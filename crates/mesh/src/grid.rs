//! Points on a grid of a power of two, fine enough to be called exact, on which predicates are exact in integers.

use crate::MeshError;
use glam::DVec2;
use softfold_geometry::polygon;

/// Cells of the grid across the points' box, as a power of two: products of four differences, as crossings need them,
/// then fit into 128 bits.
const CELLS: i32 = 40;
/// Binary digits of `f64`: a grid finer than the coordinates' own rounding could not give points back exactly.
const DIGITS: i32 = 52;
/// Exponents of pitches: beyond these, products of lengths leave the range of `f64`.
const EXPONENTS: std::ops::RangeInclusive<i32> = -400..=400;

/// A place on the grid, in cells from its origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Cell {
    pub(crate) x: i64,
    pub(crate) y: i64,
}

/// The grid around some points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    origin: DVec2,
    pitch_mm: f64,
}

impl Grid {
    /// A grid with 2⁴⁰ cells or fewer across the points' box.
    ///
    /// # Errors
    /// Points that are not finite, that are all one, or that are astronomically far apart or near.
    pub(crate) fn around(points: &[DVec2]) -> Result<Self, MeshError> {
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::Triangulation(format!("point {i} is not finite")));
        }
        let (lo, hi) = polygon::bounds(points);
        let size = (hi - lo).max_element();
        let farthest = lo.abs().max(hi.abs()).max_element();
        let exponent = (exponent(size) - CELLS).max(exponent(farthest) - DIGITS);
        if size == 0.0 || !EXPONENTS.contains(&exponent) {
            return Err(MeshError::Triangulation(format!("its points lie within {size:e} mm of each other")));
        }
        let pitch_mm = 2_f64.powi(exponent);
        Ok(Self { origin: (lo / pitch_mm).floor() * pitch_mm, pitch_mm })
    }

    /// Distance of neighbouring places, mm.
    pub(crate) fn pitch_mm(self) -> f64 {
        self.pitch_mm
    }

    /// The nearest place on the grid.
    pub(crate) fn nearest(self, p: DVec2) -> Cell {
        let q = ((p - self.origin) / self.pitch_mm).round();
        Cell { x: q.x as i64, y: q.y as i64 }
    }

    /// The point of a place; exact.
    pub(crate) fn point(self, c: Cell) -> DVec2 {
        self.origin + self.pitch_mm * DVec2::new(c.x as f64, c.y as f64)
    }
}

/// The least power of two that is no less, as its exponent.
fn exponent(value: f64) -> i32 {
    if value == 0.0 { i32::MIN / 2 } else { value.log2().ceil() as i32 }
}

/// Twice the signed area of the triangle: positive if `c` lies to the left of `a`–`b`.
pub(crate) fn orientation(a: Cell, b: Cell, c: Cell) -> i128 {
    let d = |p: i64, q: i64| i128::from(p) - i128::from(q);
    d(b.x, a.x) * d(c.y, a.y) - d(b.y, a.y) * d(c.x, a.x)
}

/// The place nearest to where two segments cross inside both; none if they only touch, overlap or miss.
pub(crate) fn crossing([a, b]: [Cell; 2], [c, d]: [Cell; 2]) -> Option<Cell> {
    let (from, to) = (orientation(c, d, a), orientation(c, d, b));
    let (left, right) = (orientation(a, b, c), orientation(a, b, d));
    if from.signum() * to.signum() >= 0 || left.signum() * right.signum() >= 0 {
        return None;
    }
    // The share `from / (from − to)` of the way from a to b, rounded to the nearest, halves up.
    let whole = (from - to).abs();
    let along = |p: i64, q: i64| {
        let step = (i128::from(q) - i128::from(p)) * from.abs();
        p + (2 * step + whole).div_euclid(2 * whole) as i64
    };
    Some(Cell { x: along(a.x, b.x), y: along(a.y, b.y) })
}

/// Whether a closed segment meets the unit square around a place, whose upper and right sides belong to its neighbours:
/// each point of the plane is in one square.
pub(crate) fn passes([a, b]: [Cell; 2], place: Cell) -> bool {
    // Doubled, so that the square is −1 ≤ x, y < 1.
    let twice = |p: i64, q: i64| 2 * (p - q);
    let from = [twice(a.x, place.x), twice(a.y, place.y)];
    let step = [twice(b.x, a.x), twice(b.y, a.y)];
    let mut stay = Stay {
        enter: Share { over: 0, under: 1, open: false },
        leave: Share { over: 1, under: 1, open: false },
    };
    (0..2).all(|axis| stay.clip(from[axis], step[axis])) && stay.is_some()
}

/// `over / under` of the way along a segment; `open` if that place itself does not count.
#[derive(Clone, Copy)]
struct Share {
    over: i64,
    under: i64,
    open: bool,
}

impl Share {
    /// This share minus the other, times a positive number.
    fn minus(self, other: Self) -> i128 {
        i128::from(self.over) * i128::from(other.under) - i128::from(other.over) * i128::from(self.under)
    }
}

/// The part of a segment inside a square (Liang and Barsky 1984, in exact fractions).
struct Stay {
    enter: Share,
    leave: Share,
}

impl Stay {
    /// Keeps what lies in −1 ≤ c < 1 along one axis; false if the segment runs beside.
    fn clip(&mut self, from: i64, step: i64) -> bool {
        if step == 0 {
            return (-1..1).contains(&from);
        }
        let (low, high) = match step > 0 {
            true => (share(-1 - from, step, false), share(1 - from, step, true)),
            false => (share(from - 1, -step, true), share(from + 1, -step, false)),
        };
        self.enter = narrower(self.enter, low, 1);
        self.leave = narrower(self.leave, high, -1);
        true
    }

    fn is_some(&self) -> bool {
        let length = self.leave.minus(self.enter);
        length > 0 || (length == 0 && !self.enter.open && !self.leave.open)
    }
}

fn share(over: i64, under: i64, open: bool) -> Share {
    Share { over, under, open }
}

/// The one that leaves less: the larger (sign +1) or the smaller (−1); of equal ones, the open one.
fn narrower(a: Share, b: Share, sign: i128) -> Share {
    match (sign * a.minus(b)).signum() {
        1 => a,
        -1 => b,
        _ if a.open => a,
        _ => b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cell(x: i64, y: i64) -> Cell {
        Cell { x, y }
    }

    #[test]
    fn a_square_has_its_lower_and_left_sides_but_not_the_others() {
        let at = cell(0, 0);
        // Through corners: only (−½, −½) is in the square.
        assert!(passes([cell(-1, 0), cell(0, -1)], at));
        assert!(!passes([cell(1, 0), cell(0, 1)], at));
        assert!(!passes([cell(-1, 0), cell(0, 1)], at) && !passes([cell(0, -1), cell(1, 0)], at));
        // Ends inside, lines that stop short, lines beside.
        assert!(
            passes([at, at], at) && passes([at, cell(9, 4)], at) && passes([cell(-7, -7), cell(3, 3)], at)
        );
        assert!(!passes([cell(1, 0), cell(9, 0)], at) && !passes([cell(-9, 1), cell(9, 1)], at));
    }

    #[test]
    fn points_come_back_exactly_and_far_away_ones_keep_their_size() {
        let points = [(0.1, 0.7), (1000.3, -2.0)].map(DVec2::from);
        let grid = Grid::around(&points).unwrap();
        for p in points {
            assert!(grid.point(grid.nearest(p)).distance(p) <= 0.71 * grid.pitch_mm());
        }
        assert!(grid.pitch_mm() < 1e-9);
        let far = points.map(|p| p + 1e9);
        assert!(Grid::around(&far).unwrap().pitch_mm() < 1e-6);
        assert!(Grid::around(&[DVec2::ONE; 3]).is_err());
        assert!(Grid::around(&[DVec2::ONE, DVec2::new(f64::NAN, 0.0)]).is_err());
        assert!(Grid::around(&[DVec2::ZERO, DVec2::splat(1e-200)]).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        /// Every point of a segment is in the square of its nearest place, and every square passed has a point near.
        #[test]
        fn squares_passed_are_those_of_the_points(ends in prop::array::uniform4(-20_i64..20)) {
            let segment = [cell(ends[0], ends[1]), cell(ends[2], ends[3])];
            let [a, b] = segment.map(|c| DVec2::new(c.x as f64, c.y as f64));
            for k in 0..=997 {
                let p = a.lerp(b, f64::from(k) / 997.0);
                let near = (p + 0.5).floor();
                // Off the sides, where rounding of p would decide.
                if (p + 0.5 - near).min_element() > 1e-9 && (near + 0.5 - p).min_element() > 1e-9 {
                    prop_assert!(passes(segment, cell(near.x as i64, near.y as i64)), "{p}");
                }
            }
            for x in -21..21 {
                for y in -21..21 {
                    let far = softfold_geometry::polygon::segment_distance(DVec2::new(x as f64, y as f64), a, b);
                    let passed = passes(segment, cell(x, y));
                    prop_assert!(!passed || far <= 0.5_f64.sqrt() + 1e-12);
                    prop_assert!(passed || far >= 0.5 - 1e-12);
                }
            }
        }

        /// Crossings on large coordinates, against the same in floating point.
        #[test]
        fn crossings_are_where_they_are(ends in prop::array::uniform8(-(1_i64 << 40)..(1_i64 << 40))) {
            let first = [cell(ends[0], ends[1]), cell(ends[2], ends[3])];
            let second = [cell(ends[4], ends[5]), cell(ends[6], ends[7])];
            let [a, b, c, d] = [first[0], first[1], second[0], second[1]].map(|p| DVec2::new(p.x as f64, p.y as f64));
            let found = crossing(first, second);
            let wanted = softfold_geometry::polygon::segment_crossing(a, b, c, d);
            prop_assert_eq!(found.is_some(), wanted.is_some());
            if let (Some(p), Some((t, _))) = (found, wanted) {
                let sine = (b - a).perp_dot(d - c).abs() / (b - a).length() / (d - c).length();
                let q = a.lerp(b, t);
                prop_assert!(q.distance(DVec2::new(p.x as f64, p.y as f64)) < 1.0 + 1e-3 / sine);
            }
        }
    }
}
