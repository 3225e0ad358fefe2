//! The grid that cuts the mold into parts: where it starts, and which slivers join their neighbours.

use crate::error::MoldError;
use crate::plan::strip;
use crate::split::Axis;
use glam::{DVec2, DVec3};
use softfold_geometry::polygon;

/// Pieces below this share of a square are rounding, not pieces.
const NOTHING: f64 = 1e-9;
/// A piece touches the side of its square if it comes this near, mm: the chord error of the plan and more.
const TOUCHES_MM: f64 = 0.1;

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
}

/// The mold in one square.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) cell: Cell,
    pub(crate) area_mm2: f64,
    pub(crate) lower: DVec3,
    pub(crate) upper: DVec3,
}

/// How good a grid is, the smaller the better: parts, slivers left, and minus the smallest piece.
type Score = (usize, usize, f64);
/// Worse than any grid.
const NO_SCORE: Score = (usize::MAX, usize::MAX, 0.0);

impl Grid {
    /// Refuses a grid of so many squares that the side must be a slip.
    pub(crate) fn require_sane(&self) -> Result<(), MoldError> {
        if self.columns * self.rows <= MOST_SQUARES {
            return Ok(());
        }
        let mend = "it cuts the mold into more than 10000 squares; make it larger";
        Err(MoldError::Option { option: "mold cell (mm)", value: self.cell_mm, mend })
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

/// The best of `steps × steps` evenly shifted grids for these plan polygons: fewest parts, then fewest slivers, then the
/// largest smallest piece; the first of equals.
pub(crate) fn choose(loops: &[Vec<DVec2>], limits: &Limits, steps: usize) -> (Grid, Score) {
    let (lower, upper) = polygon::bounds(&loops.concat());
    let shift = limits.cell_mm / steps as f64;
    let candidates = (0..steps * steps).map(|k| {
        let origin = lower - shift * DVec2::new((k / steps) as f64, (k % steps) as f64);
        let grid = Grid::at(origin, upper, limits.cell_mm);
        (grid, score(&pieces(loops, &grid), limits))
    });
    let first = Grid::at(lower, upper, limits.cell_mm);
    if first.require_sane().is_err() {
        return (first, NO_SCORE);
    }
    let best = |best: (Grid, Score), c: (Grid, Score)| if better(&c.1, &best.1) { c } else { best };
    candidates.fold((first, NO_SCORE), best)
}

/// Whether one score is better than another.
pub(crate) fn better(a: &Score, b: &Score) -> bool {
    (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)).is_lt()
}

fn score(pieces: &[Piece], limits: &Limits) -> Score {
    let groups = join_slivers(pieces, limits);
    let areas: Vec<f64> = groups.iter().map(|g| g.iter().map(|&i| pieces[i].area_mm2).sum()).collect();
    let slivers = areas.iter().filter(|a| **a < limits.sliver_mm2).count();
    (groups.len(), slivers, -areas.iter().copied().fold(f64::INFINITY, f64::min))
}

/// The plan's pieces in the squares of a grid, by column, then row.
fn pieces(loops: &[Vec<DVec2>], grid: &Grid) -> Vec<Piece> {
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
                let (lower, upper) = (lower.extend(0.0), upper.extend(0.0));
                pieces.push(Piece { cell: Cell { column, row }, area_mm2, lower, upper });
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
    let lower = members.iter().map(|&i| pieces[i].lower).fold(DVec3::INFINITY, DVec3::min);
    let upper = members.iter().map(|&i| pieces[i].upper).fold(DVec3::NEG_INFINITY, DVec3::max);
    in_line && fits(upper - lower, limits.printer_mm)
}

/// Whether a box fits the printer, as it is or turned a quarter about z.
pub(crate) fn fits(size: DVec3, printer_mm: [f64; 3]) -> bool {
    let [x, y, z] = printer_mm;
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

    const LIMITS: Limits = Limits { cell_mm: 100.0, sliver_mm2: 500.0, printer_mm: [120.0, 120.0, 120.0] };

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
        assert_eq!((grid.columns, grid.rows, score.0, score.1), (3, 2, 6, 0));
        assert_eq!(grid.origin_mm, DVec2::ZERO);
    }

    #[test]
    fn a_narrow_rest_is_joined_to_its_neighbours() {
        // 304 mm are four columns; the last is a sliver of 4 mm that three squares take up.
        let limits = LIMITS;
        let (grid, score) = choose(&rectangle(304.0, 200.0), &limits, 1);
        assert_eq!((grid.columns, score.0, score.1), (4, 6, 0));
        let groups = join_slivers(&pieces(&rectangle(304.0, 200.0), &grid), &limits);
        assert!(groups.iter().filter(|g| g.len() == 2).count() == 2);
    }

    #[test]
    fn a_rest_that_does_not_fit_stays_and_is_told() {
        let limits = Limits { printer_mm: [101.0; 3], ..LIMITS };
        let (_, score) = choose(&rectangle(304.0, 100.0), &limits, 1);
        assert_eq!((score.0, score.1), (4, 1));
    }

    #[test]
    fn the_search_beats_the_corner() {
        // A slim lens: at the corner its tips stand alone.
        let lens: Vec<_> = (0..100)
            .map(|k| DVec2::from_angle(k as f64 * std::f64::consts::TAU / 100.0) * DVec2::new(230.0, 60.0))
            .collect();
        let (_, plain) = choose(std::slice::from_ref(&lens), &LIMITS, 1);
        let (_, best) = choose(&[lens], &LIMITS, 20);
        assert!(!better(&plain, &best) && best.0 <= plain.0 && best.1 == 0, "{plain:?} {best:?}");
    }
}
