//! A skin of the board as a spline whose knots stand as close as its shape asks, and no closer.

use crate::least_squares::{Stack, knots_within};
use crate::samples::TrimIndex;
use glam::{DVec2, DVec3};
use softfold_geometry::{SheetSurface, UniformBicubic, polygon};
use softfold_kernel::occt::BsplineSurface;

/// Places per lattice cell of the sheet and direction at which the offset is taken, to begin with and at most: knots may
/// stand as close as a few of them.
const SAMPLES_PER_CELL: [f64; 2] = [4.0, 16.0];
/// Cells of the sheet's lattice between the outline and the end of the skin.
const MARGIN_CELLS: f64 = 0.25;
/// Share of the tolerance that either direction gets to begin with: the worst places of the two seldom meet.
const SHARE: f64 = 0.65;
/// What is asked once the whole error is known: a little less than what would do.
const SAFETY: f64 = 0.95;
/// Rounds in which the share is lowered at most.
const ROUNDS: usize = 5;
/// Most places at which the offset is taken a second time, closer: about 300 MB.
const MOST_PLACES: f64 = 2e6;

/// A bicubic B-spline over a box of the sheet's (u, v), with clamped knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Distinct knots along u and v, mm; the ends count four times.
    pub knots: [Vec<f64>; 2],
    /// Poles, u outer and v inner: two more than knots each way.
    pub poles: Vec<DVec3>,
}

impl Skin {
    /// Poles along u and v.
    pub fn count(&self) -> [usize; 2] {
        [0, 1].map(|d| self.knots[d].len() + 2)
    }

    /// The place of the skin at (u, v); past the domain its last piece is continued.
    pub fn at(&self, uv: DVec2) -> DVec3 {
        let [(i, a), (j, b)] = [0, 1].map(|d| basis(&self.knots[d], uv[d]));
        let columns = self.count()[1];
        let row = |k: usize| -> DVec3 { (0..4).map(|l| b[l] * self.poles[(i + k) * columns + j + l]).sum() };
        (0..4).map(|k| a[k] * row(k)).sum()
    }

    /// The place at (u, v) and its derivatives by u and v.
    pub(crate) fn jet(&self, uv: DVec2) -> [DVec3; 3] {
        let [(i, a, da), (j, b, db)] = [0, 1].map(|d| basis_and_slopes(&self.knots[d], uv[d]));
        let columns = self.count()[1];
        let (mut place, mut along_u, mut along_v) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        for k in 0..4 {
            let row = &self.poles[(i + k) * columns + j..][..4];
            let sum = |weights: [f64; 4]| -> DVec3 { (0..4).map(|l| weights[l] * row[l]).sum() };
            let (here, slope) = (sum(b), sum(db));
            place += a[k] * here;
            along_u += da[k] * here;
            along_v += a[k] * slope;
        }
        [place, along_u, along_v]
    }

    /// The same surface in the form OpenCascade takes.
    pub(crate) fn bspline(&self) -> BsplineSurface {
        let clamped = |knots: &[f64]| {
            let mut multiplicities = vec![1; knots.len()];
            (multiplicities[0], multiplicities[knots.len() - 1]) = (4, 4);
            multiplicities
        };
        BsplineSurface {
            poles: self.poles.iter().map(|p| p.to_array()).collect(),
            pole_count: self.count(),
            multiplicities_u: clamped(&self.knots[0]),
            multiplicities_v: clamped(&self.knots[1]),
            knots_u: self.knots[0].clone(),
            knots_v: self.knots[1].clone(),
        }
    }
}

/// Number of the first of the four cubic B-splines that are not zero at `t`, and their values.
pub(crate) fn basis(knots: &[f64], t: f64) -> (usize, [f64; 4]) {
    let (first, values, _) = basis_and_slopes(knots, t);
    (first, values)
}

/// The same with their derivatives (Cox and de Boor).
fn basis_and_slopes(knots: &[f64], t: f64) -> (usize, [f64; 4], [f64; 4]) {
    let last = knots.len() - 1;
    let cell = knots.partition_point(|k| *k <= t).clamp(1, last) - 1;
    let knot = |i: isize| knots[(cell as isize + i).clamp(0, last as isize) as usize];
    let (mut values, mut shares) = ([1.0, 0.0, 0.0, 0.0], [0.0; 3]);
    for degree in 1..4 {
        let mut carried = 0.0;
        for r in 0..degree {
            let (right, left) = (knot(r as isize + 1), knot(r as isize + 1 - degree as isize));
            shares[r] = values[r] / (right - left);
            values[r] = carried + (right - t) * shares[r];
            carried = (t - left) * shares[r];
        }
        values[degree] = carried;
    }
    let [a, b, c] = shares.map(|share| 3.0 * share);
    (cell, values, [-a, a - b, b - c, c])
}

/// What both skins are made from.
pub(crate) struct SkinInput<'a> {
    pub(crate) sheet: &'a SheetSurface,
    pub(crate) index: &'a TrimIndex,
    /// Signed distances of the skins from the sheet, mm.
    pub(crate) offsets_mm: [f64; 2],
    /// Largest distance from the true offset that is aimed at, mm.
    pub(crate) tolerance_mm: f64,
}

/// Both skins, with the same knots: least squares through a lattice of places, the knots of each direction as dense as its
/// own error asks. `error_mm` tells the largest distance of given skins from the true offset, which is reached; none if
/// nothing could be fitted.
///
/// The tightest places decide about few rows and columns only, so that this takes a third of the poles of an even
/// lattice; and least squares are half as far off as interpolation.
pub(crate) fn skins(input: &SkinInput<'_>, error_mm: impl Fn(&[Skin; 2]) -> f64) -> Option<([Skin; 2], f64)> {
    let mut best: Option<([Skin; 2], f64)> = None;
    let mut per_cell = SAMPLES_PER_CELL[0];
    while per_cell <= SAMPLES_PER_CELL[1]
        && (best.is_none() || Offsets::places(input, per_cell) < MOST_PLACES)
    {
        let offsets = Offsets::of(input, per_cell);
        let found = offsets.nearest(input.tolerance_mm, &error_mm);
        best = best.into_iter().chain(found).min_by(|a, b| a.1.total_cmp(&b.1));
        if best.as_ref().is_some_and(|b| b.1 <= input.tolerance_mm) {
            break;
        }
        per_cell *= 2.0;
    }
    best
}

/// Both offsets at a lattice of places.
struct Offsets {
    /// Along u for every v of both, then along v for every u.
    stacks: [Stack; 2],
    least_knot_mm: f64,
    most_knot_mm: f64,
}

/// Knots stand at least so many places apart, so that each piece has enough of them.
const PLACES_PER_KNOT: f64 = 2.5;
/// Knots stand at most so many of the sheet's cells apart.
const CELLS_PER_KNOT: f64 = 6.0;

impl Offsets {
    fn of(input: &SkinInput<'_>, per_cell: f64) -> Self {
        let surface = &input.sheet.spline;
        let params = params(input, surface.spacing_mm / per_cell);
        let [rows, columns] = [params[0].len(), params[1].len()];
        let mut inside = vec![false; rows * columns];
        let mut values = [vec![DVec3::ZERO; rows * columns], vec![DVec3::ZERO; rows * columns]];
        for k in 0..rows * columns {
            let uv = DVec2::new(params[0][k / columns], params[1][k % columns]);
            let p = surface.at(uv);
            let normal = p.normal();
            inside[k] = input.index.contains(uv);
            for (field, offset_mm) in values.iter_mut().zip(input.offsets_mm) {
                field[k] = p.position + offset_mm * normal;
            }
        }
        let along = |axis: usize| Stack::of(&params, &values, &inside, axis);
        let step = |d: usize| params[d][1] - params[d][0];
        Self {
            stacks: [along(0), along(1)],
            least_knot_mm: PLACES_PER_KNOT * step(0).max(step(1)),
            most_knot_mm: CELLS_PER_KNOT * surface.spacing_mm,
        }
    }

    /// How many places there would be.
    fn places(input: &SkinInput<'_>, per_cell: f64) -> f64 {
        let (lower, upper) = polygon::bounds(&input.index.loops[0]);
        ((upper - lower) / input.sheet.spline.spacing_mm * per_cell).element_product()
    }

    /// The skins nearest to the tolerance that were found, and their error: the first within it.
    fn nearest(&self, tolerance_mm: f64, error_mm: impl Fn(&[Skin; 2]) -> f64) -> Option<([Skin; 2], f64)> {
        let mut aim_mm = SHARE * tolerance_mm;
        let mut best: Option<([Skin; 2], f64)> = None;
        for _ in 0..ROUNDS {
            let Some(made) = self.skins(aim_mm) else { break };
            let error = error_mm(&made);
            aim_mm *= (SAFETY * tolerance_mm / error).max(0.5);
            if best.as_ref().is_none_or(|b| error < b.1) {
                best = Some((made, error));
            }
            if error <= tolerance_mm {
                break;
            }
        }
        best
    }

    /// Skins whose error along either direction by itself is `aim_mm` where that can be reached.
    fn skins(&self, aim_mm: f64) -> Option<[Skin; 2]> {
        let spacings_mm = [self.least_knot_mm, self.most_knot_mm];
        let [u, v] = &self.stacks;
        let knots = [knots_within(u, aim_mm, spacings_mm)?, knots_within(v, aim_mm, spacings_mm)?];
        let rows = u.fit(&knots[0])?.turned(v.params());
        let poles = rows.fit(&knots[1])?.halves();
        Some(poles.map(|poles| Skin { knots: knots.clone(), poles }))
    }
}

/// Evenly spaced places along u and v, over the box of the outline's control points, which OpenCascade wants inside, and a
/// little more.
fn params(input: &SkinInput<'_>, step_mm: f64) -> [Vec<f64>; 2] {
    let outline = input.sheet.trim.iter().flat_map(|curve| curve.segments());
    let controls: Vec<DVec2> = outline.flat_map(|segment| segment.control_points()).collect();
    let (lower, upper) = polygon::bounds(&controls);
    let (first, last) = input.sheet.spline.domain();
    let margin = MARGIN_CELLS * input.sheet.spline.spacing_mm;
    let (lower, upper) = ((lower - margin).max(first), (upper + margin).min(last));
    [0, 1].map(|d| {
        let pieces = ((upper[d] - lower[d]) / step_mm).ceil().max(8.0);
        let at = |k: usize| lower[d] + (upper[d] - lower[d]) * k as f64 / pieces;
        (0..=pieces as usize).map(at).collect()
    })
}

/// The sheet's own surface as a skin, exactly: on its own domain, with clamped knots.
pub(crate) fn skin_of(surface: &UniformBicubic) -> Skin {
    let [knots_u, knots_v] = surface.knots().map(|k| k[3..k.len() - 3].to_vec());
    let columns = surface.count[1];
    let rows: Vec<Vec<DVec3>> = surface.poles.chunks(columns).map(clamped).collect();
    let turned: Vec<Vec<DVec3>> =
        (0..columns).map(|j| clamped(&rows.iter().map(|row| row[j]).collect::<Vec<_>>())).collect();
    let poles = (0..surface.count[0]).flat_map(|i| turned.iter().map(move |column| column[i])).collect();
    Skin { knots: [knots_u, knots_v], poles }
}

/// Poles of the same uniform cubic with its first and last knot of the domain counted four times (Boehm).
fn clamped(poles: &[DVec3]) -> Vec<DVec3> {
    let n = poles.len();
    let mut made = poles.to_vec();
    (made[0], made[1]) = ((poles[0] + 4.0 * poles[1] + poles[2]) / 6.0, (2.0 * poles[1] + poles[2]) / 3.0);
    made[n - 1] = (poles[n - 1] + 4.0 * poles[n - 2] + poles[n - 3]) / 6.0;
    made[n - 2] = (2.0 * poles[n - 2] + poles[n - 3]) / 3.0;
    made
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn input<'a>(sheet: &'a SheetSurface, index: &'a TrimIndex) -> SkinInput<'a> {
        SkinInput { sheet, index, offsets_mm: [-5.0, 5.0], tolerance_mm: 0.01 }
    }

    fn worst(sheet: &SheetSurface, index: &TrimIndex, skins: &[Skin; 2]) -> f64 {
        let places = index.lattice(1.7);
        let off = |s: usize, d: f64| {
            let at = |uv: DVec2| {
                let p = sheet.spline.at(uv);
                skins[s].at(uv).distance(p.position + d * p.normal())
            };
            places.iter().map(|p| at(p.uv)).fold(0.0, f64::max)
        };
        off(0, -5.0).max(off(1, 5.0))
    }

    #[test]
    fn the_basis_is_a_partition_and_reproduces_its_own_parameter() {
        let knots = [0.0, 1.0, 1.5, 4.0, 4.2, 9.0];
        let greville = |i: usize| {
            let knot = |k: usize| knots[(k + i).saturating_sub(3).min(5)];
            (knot(1) + knot(2) + knot(3)) / 3.0
        };
        for t in [0.0, 0.3, 1.0, 1.5, 3.99, 4.1, 8.0, 9.0] {
            let (first, values) = basis(&knots, t);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{t}");
            let back: f64 = (0..4).map(|k| values[k] * greville(first + k)).sum();
            assert!((back - t).abs() < 1e-14, "{t} {back}");
            let slope: f64 = (0..4).map(|k| basis_and_slopes(&knots, t).2[k] * greville(first + k)).sum();
            assert!((slope - 1.0).abs() < 1e-13, "{t} {slope}");
        }
    }

    #[test]
    fn the_sheet_is_its_own_skin() {
        let sheet = shapes::corrugation(shapes::ellipse(150.0, 90.0));
        let skin = skin_of(&sheet.spline);
        for p in TrimIndex::new(&sheet).unwrap().lattice(7.3) {
            let exact = sheet.spline.at(p.uv);
            assert!(skin.at(p.uv).distance(exact.position) < 1e-11);
            let [place, u, v] = skin.jet(p.uv);
            assert!(place.distance(exact.position) < 1e-11);
            assert!(u.distance(exact.first[0]) < 1e-11 && v.distance(exact.first[1]) < 1e-11);
        }
        let (lower, upper) = sheet.spline.domain();
        assert!(skin.at(lower).distance(sheet.spline.at(lower).position) < 1e-11);
        assert!(skin.at(upper).distance(sheet.spline.at(upper).position) < 1e-11);
    }

    #[test]
    fn a_fold_gets_its_knots_and_the_flat_beside_it_few() {
        // A fold of 60° about x = 0 with radius 40 mm, on a sheet 400 mm wide.
        let r = 40.0;
        let fold = |p: DVec2| {
            let a = (p.x / r).clamp(-0.5, 0.5);
            let straight = p.x - a * r;
            DVec3::new(r * a.sin() + straight * a.cos(), p.y, r * (1.0 - a.cos()) + straight * a.sin())
        };
        let sheet = shapes::sheet(shapes::rectangle(400.0, 100.0), fold);
        let index = TrimIndex::new(&sheet).unwrap();
        let (skins, error) = skins(&input(&sheet, &index), |s| worst(&sheet, &index, s)).unwrap();
        assert!(error <= 0.01, "{error}");
        let [u, v] = &skins[0].knots;
        let near = u.iter().filter(|k| k.abs() < 40.0).count() as f64 / 80.0;
        let far = u.iter().filter(|k| k.abs() > 100.0).count() as f64 / 200.0;
        assert!(near > 4.0 * far, "{near} knots a mm in the fold, {far} beside it");
        assert!(v.len() < 6, "{v:?}");
        assert_eq!(skins[0].knots, skins[1].knots);
    }

    #[test]
    fn the_domain_holds_the_control_points_of_a_turned_circle() {
        let circle = shapes::ellipse(90.0, 90.0).mapped(|p| DVec2::from_angle(0.6).rotate(p)).unwrap();
        let sheet = shapes::corrugation(circle);
        let index = TrimIndex::new(&sheet).unwrap();
        let [skin, _] = skins(&input(&sheet, &index), |s| worst(&sheet, &index, s)).unwrap().0;
        for p in sheet.trim[0].segments().iter().flat_map(|s| s.control_points()) {
            (0..2).for_each(|d| assert!(skin.knots[d][0] <= p[d] && p[d] <= *skin.knots[d].last().unwrap()));
        }
    }

    #[test]
    fn the_same_sheet_gives_the_same_skins() {
        let sheet = shapes::corrugation(shapes::ellipse(150.0, 90.0));
        let index = TrimIndex::new(&sheet).unwrap();
        let made = || skins(&input(&sheet, &index), |s| worst(&sheet, &index, s)).unwrap();
        let (first, error) = made();
        assert!(error <= 0.01);
        assert_eq!((first, error), made());
    }
}
