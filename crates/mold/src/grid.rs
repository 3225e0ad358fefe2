//! The grid that cuts the mold into parts: where it starts, and which slivers join their neighbours.

use crate::error::{MoldError, Setting};
use crate::plan::strip;
use crate::relief::Relief;
use crate::split::Axis;
use crate::top::Patch;
use glam::{DVec2, DVec3};
use softfold_geometry::polygon;

/// Pieces below this share of a square are rounding, not pieces.
const NOTHING: f64 = 1e-9;
/// A piece touches the side of its square if it comes this near, mm: the chord error of the plan and more.
const TOUCHES_MM: f64 = 0.1;

/// A box fits if it is larger by no more than this, mm: rounding of a sum of cells.
const FITS_MM: f64 = 1e-6;

/// The cell as an option.
pub(crate) const CELL: Setting = Setting::of("mold", "cell_mm", "mold cell (mm)");
/// More squares than any mold has parts: 22 m by 22 m at 221 mm.
const MOST_SQUARES: usize = 10_000;

/// The grid of squares, in the mold's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Lower left corner of square (0, 0), mm.
    pub origin_mm: DVec2,
    /// By how much the mold was turned about z to suit the grid, degrees.
    pub turned_deg: f64,
    /// Side of the squares, mm.
    pub cell_mm: f64,
    /// Squares along x.
    pub columns: usize,
    /// Squares along y.
    pub rows: usize,
}

/// A square of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    /// Along x, from 0.
    pub column: usize,
    /// Along y, from 0.
    pub row: usize,
}

/// What decides whether pieces are slivers and may be joined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) cell_mm: f64,
    pub(crate) sliver_mm2: f64,
    pub(crate) printer_mm: [f64; 3],
    pub(crate) thickness_mm: f64,
}

/// The mold in one square.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) cell: Cell,
    pub(crate) area_mm2: f64,
    pub(crate) lower: DVec3,
    pub(crate) upper: DVec3,
}

/// How good a grid is, the most important first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Score {
    /// Parts that do not fit the printer.
    unfit: usize,
    /// Parts in all.
    parts: usize,
    /// Slivers that could not be joined.
    slivers: usize,
    /// Area of the smallest part in plan.
    least_mm2: f64,
}

/// Worse than any grid.
const NO_SCORE: Score = Score { unfit: usize::MAX, parts: usize::MAX, slivers: usize::MAX, least_mm2: 0.0 };

impl Grid {
    /// Refuses a grid of so many squares that the side must be a slip.
    pub(crate) fn require_sane(&self) -> Result<(), MoldError> {
        let sane = self.columns.saturating_mul(self.rows) <= MOST_SQUARES;
        CELL.require(sane, self.cell_mm, "it cuts the mold into more than 10000 squares; make it larger")
    }

    /// Lower and upper corner of a square.
    pub fn square_mm(&self, cell: Cell) -> [DVec2; 2] {
        let lower = self.origin_mm + self.cell_mm * DVec2::new(cell.column as f64, cell.row as f64);
        [lower, lower + self.cell_mm]
    }

    fn at(origin_mm: DVec2, upper: DVec2, cell_mm: f64) -> Self {
        let count = ((upper - origin_mm) / cell_mm).ceil().max(DVec2::ONE);
        Self { origin_mm, turned_deg: 0.0, cell_mm, columns: count.x as usize, rows: count.y as usize }
    }
}

impl Cell {
    /// Row letter and column number: `A1` is at the lower left, `AA` follows `Z`.
    pub fn name(&self) -> String {
        let mut letters = Vec::new();
        let mut row = self.row + 1;
        while row > 0 {
            letters.push((b'A' + ((row - 1) % 26) as u8) as char);
            row = (row - 1) / 26;
        }
        letters.iter().rev().collect::<String>() + &(self.column + 1).to_string()
    }
}

/// The best of `steps × steps` evenly shifted grids for these plan polygons: fewest parts that do not fit the printer,
/// then fewest parts, then fewest slivers, then the largest smallest piece; the first of equals. `sheet` is what the
/// polygons border.
pub(crate) fn choose(loops: &[Vec<DVec2>], sheet: &Patch, limits: &Limits, steps: usize) -> (Grid, Score) {
    let (lower, upper) = polygon::bounds(&loops.concat());
    let first = Grid::at(lower, upper, limits.cell_mm);
    if first.require_sane().is_err() {
        return (first, NO_SCORE);
    }
    // Every candidate's lines are lines of the bins.
    let shift = limits.cell_mm / steps as f64;
    let relief = Relief::new(sheet, [lower, upper], shift);
    let candidates = (0..steps * steps).map(|k| {
        let origin = lower - shift * DVec2::new((k / steps) as f64, (k % steps) as f64);
        let grid = Grid::at(origin, upper, limits.cell_mm);
        (grid, score(&pieces(loops, &grid, &relief, limits.thickness_mm), limits))
    });
    let best = |best: (Grid, Score), c: (Grid, Score)| if better(&c.1, &best.1) { c } else { best };
    candidates.fold((first, NO_SCORE), best)
}

/// Whether one score is better than another.
pub(crate) fn better(a: &Score, b: &Score) -> bool {
    let counts = |s: &Score| [s.unfit, s.parts, s.slivers];
    counts(a).cmp(&counts(b)).then(b.least_mm2.total_cmp(&a.least_mm2)).is_lt()
}

fn score(pieces: &[Piece], limits: &Limits) -> Score {
    let groups = join_slivers(pieces, limits);
    let areas: Vec<f64> = groups.iter().map(|g| g.iter().map(|&i| pieces[i].area_mm2).sum()).collect();
    Score {
        unfit: groups.iter().filter(|g| !fits(size(g, pieces), limits.printer_mm)).count(),
        parts: groups.len(),
        slivers: areas.iter().filter(|a| **a < limits.sliver_mm2).count(),
        least_mm2: areas.iter().copied().fold(f64::INFINITY, f64::min),
    }
}

/// The mold's pieces in the squares of a grid, by column, then row.
fn pieces(loops: &[Vec<DVec2>], grid: &Grid, relief: &Relief, thickness_mm: f64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let span = |from: f64, k: usize| [from + k as f64 * grid.cell_mm, from + (k + 1) as f64 * grid.cell_mm];
    for column in 0..grid.columns {
        let strips: Vec<_> =
            loops.iter().map(|l| strip(l, Axis::X, span(grid.origin_mm.x, column))).collect();
        for row in 0..grid.rows {
            let cut: Vec<_> = strips.iter().map(|l| strip(l, Axis::Y, span(grid.origin_mm.y, row))).collect();
            let area_mm2: f64 = cut.iter().map(|l| polygon::signed_area_mm2(l)).sum();
            if area_mm2 > NOTHING * grid.cell_mm * grid.cell_mm {
                let (lower, upper) = polygon::bounds(&cut[0]);
                let cell = Cell { column, row };
                let [lowest, highest] = relief.over(grid.square_mm(cell)[0], grid.cell_mm);
                let (lower, upper) = (lower.extend(lowest - thickness_mm), upper.extend(highest));
                pieces.push(Piece { cell, area_mm2, lower, upper });
            }
        }
    }
    pieces
}

/// Joins slivers, the smallest first, to the neighbour they touch along the longest side if the result fits the printer
/// and is still one rectangle of squares. Gives groups of piece numbers, the largest piece of each first, in the order
/// of those.
pub(crate) fn join_slivers(pieces: &[Piece], limits: &Limits) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..pieces.len()).collect();
    let mut slivers: Vec<usize> =
        (0..pieces.len()).filter(|&i| pieces[i].area_mm2 < limits.sliver_mm2).collect();
    slivers.sort_by(|&a, &b| pieces[a].area_mm2.total_cmp(&pieces[b].area_mm2).then(a.cmp(&b)));
    for s in slivers {
        let mut best: Option<(f64, usize)> = None;
        for n in 0..pieces.len() {
            let contact = contact_mm(&pieces[s], &pieces[n], limits.cell_mm);
            let joined: Vec<usize> =
                (0..pieces.len()).filter(|&i| group[i] == group[n] || group[i] == group[s]).collect();
            let better = contact > 0.0 && best.is_none_or(|b| contact > b.0);
            if better && group[n] != group[s] && may_join(&joined, pieces, limits) {
                best = Some((contact, n));
            }
        }
        if let Some((_, n)) = best {
            let (from, to) = (group[s], group[n]);
            group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
        }
    }
    collect(&group, pieces)
}

/// Length along which two pieces can touch across their squares' common side; zero if they are no neighbours.
fn contact_mm(a: &Piece, b: &Piece, cell_mm: f64) -> f64 {
    let (dc, dr) = (a.cell.column.abs_diff(b.cell.column), a.cell.row.abs_diff(b.cell.row));
    if dc + dr != 1 {
        return 0.0;
    }
    let (across, along) = if dc == 1 { (0, 1) } else { (1, 0) };
    let gap = a.lower[across].max(b.lower[across]) - a.upper[across].min(b.upper[across]);
    let overlap = a.upper[along].min(b.upper[along]) - a.lower[along].max(b.lower[along]);
    if gap > TOUCHES_MM { 0.0 } else { overlap.clamp(0.0, cell_mm) }
}

/// Whether these pieces lie in one row or one column and fit the printer together.
fn may_join(members: &[usize], pieces: &[Piece], limits: &Limits) -> bool {
    let first = pieces[members[0]];
    let in_line = members.iter().all(|&i| pieces[i].cell.row == first.cell.row)
        || members.iter().all(|&i| pieces[i].cell.column == first.cell.column);
    in_line && fits(size(members, pieces), limits.printer_mm)
}

/// Size of the box around pieces.
fn size(members: &[usize], pieces: &[Piece]) -> DVec3 {
    let lower = members.iter().map(|&i| pieces[i].lower).fold(DVec3::INFINITY, DVec3::min);
    let upper = members.iter().map(|&i| pieces[i].upper).fold(DVec3::NEG_INFINITY, DVec3::max);
    upper - lower
}

/// Whether a box fits the printer, as it is or turned a quarter about z.
fn fits(size: DVec3, printer_mm: [f64; 3]) -> bool {
    fits_within(size, printer_mm, FITS_MM)
}

/// The same with so much slack.
pub(crate) fn fits_within(size: DVec3, printer_mm: [f64; 3], slack_mm: f64) -> bool {
    let [x, y, z] = printer_mm.map(|side| side + slack_mm);
    size.z <= z && ((size.x <= x && size.y <= y) || (size.x <= y && size.y <= x))
}

fn collect(group: &[usize], pieces: &[Piece]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); pieces.len()];
    for (i, &g) in group.iter().enumerate() {
        groups[g].push(i);
    }
    groups.retain(|g| !g.is_empty());
    for g in &mut groups {
        g.sort_by(|&a, &b| pieces[b].area_mm2.total_cmp(&pieces[a].area_mm2).then(a.cmp(&b)));
    }
    groups.sort_by_key(|g| (pieces[g[0]].cell.row, pieces[g[0]].cell.column));
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits =
        Limits { cell_mm: 100.0, sliver_mm2: 500.0, printer_mm: [120.0; 3], thickness_mm: 20.0 };

    fn choose(loops: &[Vec<DVec2>], limits: &Limits, steps: usize) -> (Grid, Score) {
        super::choose(loops, &Patch::default(), limits, steps)
    }

    #[test]
    fn absurd_cells_are_refused() {
        for cell_mm in [1e-20, 1e-3] {
            let (grid, _) = choose(&rectangle(300.0, 200.0), &Limits { cell_mm, ..LIMITS }, 20);
            assert_eq!(grid.require_sane().unwrap_err().place(), ("mold", "cell_mm"));
        }
    }

    #[test]
    fn a_cell_as_large_as_the_printer_fits_it() {
        let limits = Limits { cell_mm: 0.1 * 1001.0, printer_mm: [100.1; 3], ..LIMITS };
        let (_, score) = choose(&rectangle(5.0 * limits.cell_mm, 3.0 * limits.cell_mm), &limits, 7);
        assert_eq!((score.unfit, score.parts), (0, 15), "{score:?}");
    }

    #[test]
    fn a_grid_whose_parts_fit_comes_before_one_of_even_parts() {
        // 180 mm with a slope of one from the middle on: cut there, the right part is 90 + 20 mm high.
        let corner = |x: f64, y: f64| DVec3::new(x, y, (x - 90.0).max(0.0));
        let row = |y: f64| [corner(0., y), corner(90., y), corner(180., y)];
        let positions = [row(0.0), row(80.0)].concat();
        let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
        let sheet = Patch { positions, triangles };
        let cut_at = |z: f64| {
            let limits = Limits { printer_mm: [120.0, 120.0, z], ..LIMITS };
            let (grid, score) = super::choose(&rectangle(180.0, 80.0), &sheet, &limits, 20);
            (grid.origin_mm.x + 100.0, score.unfit, score.parts)
        };
        assert_eq!(cut_at(115.0), (90.0, 0, 2), "even parts");
        assert_eq!(cut_at(102.0), (100.0, 0, 2), "both fit");
        let (_, unfit, parts) = cut_at(80.0);
        assert_eq!((unfit, parts), (0, 3), "one more part, and all fit");
        assert_eq!(cut_at(30.0).1, 1, "no grid fits: one of the fewest that do not");
    }

    fn rectangle(w: f64, h: f64) -> Vec<Vec<DVec2>> {
        vec![[(0., 0.), (w, 0.), (w, h), (0., h)].map(DVec2::from).to_vec()]
    }

    #[test]
    fn names_run_like_a_spreadsheet() {
        let name = |row, column| Cell { row, column }.name();
        assert_eq!([name(0, 0), name(25, 8), name(26, 0), name(701, 9)], ["A1", "Z9", "AA1", "ZZ10"]);
    }

    #[test]
    fn a_rectangle_of_whole_squares_needs_no_more() {
        let (grid, score) = choose(&rectangle(300.0, 200.0), &LIMITS, 20);
        assert_eq!((grid.columns, grid.rows, score.parts, score.slivers), (3, 2, 6, 0));
        assert_eq!(grid.origin_mm, DVec2::ZERO);
    }

    #[test]
    fn a_narrow_rest_is_joined_to_its_neighbours() {
        // 304 mm are four columns; the last is a sliver of 4 mm that three squares take up.
        let limits = LIMITS;
        let (grid, score) = choose(&rectangle(304.0, 200.0), &limits, 1);
        assert_eq!((grid.columns, score.parts, score.slivers), (4, 6, 0));
        let groups =
            join_slivers(&pieces(&rectangle(304.0, 200.0), &grid, &Relief::default(), 20.0), &limits);
        assert!(groups.iter().filter(|g| g.len() == 2).count() == 2);
    }

    #[test]
    fn a_rest_that_does_not_fit_stays_and_is_told() {
        let limits = Limits { printer_mm: [101.0; 3], ..LIMITS };
        let (_, score) = choose(&rectangle(304.0, 100.0), &limits, 1);
        assert_eq!((score.parts, score.slivers), (4, 1));
    }

    #[test]
    fn the_search_beats_the_corner() {
        // A slim lens: at the corner its tips stand alone.
        let lens: Vec<_> = (0..100)
            .map(|k| DVec2::from_angle(k as f64 * std::f64::consts::TAU / 100.0) * DVec2::new(230.0, 60.0))
            .collect();
        let (_, plain) = choose(std::slice::from_ref(&lens), &LIMITS, 1);
        let (_, best) = choose(&[lens], &LIMITS, 20);
        assert!(
            !better(&plain, &best) && best.parts <= plain.parts && best.slivers == 0,
            "{plain:?} {best:?}"
        );
    }
}
