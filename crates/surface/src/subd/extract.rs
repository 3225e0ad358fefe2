//! Quads of the grid: each whole cell has its middle in just one triangle; neighbours and corners are found by walking
//! straight from there.

use super::background::Background;
use super::grid::Grid;
use super::quads::Quads;
use glam::DVec2;
use std::collections::BTreeMap;

/// Steps of a walk before it is given up.
const MOST_STEPS: usize = 10_000;
/// Moves middles off edges and vertices of the mesh by what does not matter, so that each is in one triangle.
const NUDGE: DVec2 = DVec2::new(1.234_567e-7, 2.718_281e-7);
/// The cell from whose middle one starts: its corners in order, its neighbours right, up, left and down.
const CORNERS: [DVec2; 4] =
    [DVec2::new(-0.5, -0.5), DVec2::new(0.5, -0.5), DVec2::new(0.5, 0.5), DVec2::new(-0.5, 0.5)];
const STEPS: [DVec2; 4] = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];

/// A cell: its triangle and the lower corner in that triangle's coordinates.
type Cell = (usize, i64, i64);

/// The mesh of all whole cells, in the flat sheet; border vertices are on the border.
pub(crate) fn quads(ground: &Background<'_>, grid: &Grid) -> Quads {
    let walker = Walker { ground, grid };
    let cells = cells(grid);
    let number: BTreeMap<Cell, usize> = cells.iter().enumerate().map(|(k, c)| (*c, k)).collect();
    let mut same: Vec<usize> = (0..4 * cells.len()).collect();
    for (k, &cell) in cells.iter().enumerate() {
        for (side, step) in STEPS.into_iter().enumerate().take(2) {
            let Some((other, _)) = walker.walk(cell, step) else { continue };
            let Some(&other) = number.get(&other) else { continue };
            // Right: my corners 1, 2 are its 0, 3; up: my 3, 2 are its 0, 1.
            let pairs = if side == 0 { [(1, 0), (2, 3)] } else { [(3, 0), (2, 1)] };
            pairs.into_iter().for_each(|(a, b)| unite(&mut same, 4 * k + a, 4 * other + b));
        }
    }
    let mut vertices = BTreeMap::new();
    let mut made = Quads::default();
    for (k, &cell) in cells.iter().enumerate() {
        let quad = [0, 1, 2, 3].map(|c| {
            let root = find(&same, 4 * k + c);
            *vertices.entry(root).or_insert_with(|| {
                made.points.push(walker.place(cell, CORNERS[c]));
                made.points.len() as u32 - 1
            })
        });
        made.quads.push(quad);
    }
    made
}

fn find(same: &[usize], mut k: usize) -> usize {
    while same[k] != k {
        k = same[k];
    }
    k
}

fn unite(same: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(same, a), find(same, b));
    same[a.max(b)] = a.min(b);
}

/// All cells by the triangles their middles are in.
fn cells(grid: &Grid) -> Vec<Cell> {
    let mut cells = Vec::new();
    for (t, corners) in grid.corners.iter().enumerate() {
        if (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]) <= 0.0 {
            continue; // folded over: what it covers is covered by others
        }
        let lo = corners.iter().fold(corners[0], |l, c| l.min(*c)).floor();
        let hi = corners.iter().fold(corners[0], |h, c| h.max(*c)).ceil();
        for i in lo.x as i64..hi.x as i64 {
            for j in lo.y as i64..hi.y as i64 {
                let inside = barycentric(corners, middle((t, i, j))).iter().all(|w| *w >= 0.0);
                if inside {
                    cells.push((t, i, j));
                }
            }
        }
    }
    cells
}

fn middle((_, i, j): Cell) -> DVec2 {
    DVec2::new(i as f64, j as f64) + 0.5 + NUDGE
}

fn barycentric([a, b, c]: &[DVec2; 3], p: DVec2) -> [f64; 3] {
    let area = (*b - *a).perp_dot(*c - *a);
    let [u, v] = [(*c - *b).perp_dot(p - *b), (*a - *c).perp_dot(p - *c)].map(|w| w / area);
    [u, v, 1.0 - u - v]
}

struct Walker<'a> {
    ground: &'a Background<'a>,
    grid: &'a Grid,
}

/// The end of a walk.
struct End {
    triangle: usize,
    weights: [f64; 3],
    /// The point in the last triangle's coordinates.
    at: DVec2,
    /// Whether the border ended it.
    border: bool,
}

impl Walker<'_> {
    /// The cell at the other end of a step from a cell's middle, unless the border is between.
    fn walk(&self, cell: Cell, step: DVec2) -> Option<(Cell, [f64; 3])> {
        let end = self.go(cell.0, middle(cell), middle(cell) + step)?;
        let lower = (end.at - 0.5 - NUDGE).round();
        (!end.border).then_some(((end.triangle, lower.x as i64, lower.y as i64), end.weights))
    }

    /// The point of the sheet at a step from a cell's middle; where the border is reached before, there.
    fn place(&self, cell: Cell, step: DVec2) -> DVec2 {
        let to = middle(cell) + step - NUDGE;
        match self.go(cell.0, middle(cell), to) {
            Some(end) => {
                let p = self.ground.points(end.triangle);
                (0..3).map(|k| end.weights[k] * p[k]).sum()
            }
            None => self.ground.points(cell.0).into_iter().sum::<DVec2>() / 3.0,
        }
    }

    fn go(&self, start: usize, from: DVec2, to: DVec2) -> Option<End> {
        let (mut t, mut from, mut to) = (start, from, to);
        for _ in 0..MOST_STEPS {
            let corners = &self.grid.corners[t];
            let (w0, w1) = (barycentric(corners, from), barycentric(corners, to));
            let share = |k: usize| if w0[k] > w1[k] { (w0[k] / (w0[k] - w1[k])).max(0.0) } else { 0.0 };
            let exit = (0..3)
                .filter(|&k| w1[k] < 0.0 && w0[k] > w1[k])
                .min_by(|&a, &b| share(a).total_cmp(&share(b)));
            let Some(side) = exit else {
                return Some(End { triangle: t, weights: w1, at: to, border: false });
            };
            match self.ground.neighbours[t][side] {
                Some(next) => {
                    let shift = self.shift(t, next);
                    (t, from, to) = (next, from + shift, to + shift);
                }
                None => {
                    let s = share(side);
                    let weights = [0, 1, 2].map(|k| w0[k] + s * (w1[k] - w0[k]));
                    return Some(End { triangle: t, weights, at: to, border: true });
                }
            }
        }
        None
    }

    /// Whole numbers to add on the way from a triangle to its neighbour.
    fn shift(&self, t: usize, next: usize) -> DVec2 {
        let (a, b) = (self.ground.corners(t), self.ground.corners(next));
        let shared = (0..3).find_map(|k| Some((k, b.iter().position(|v| *v == a[k])?)));
        shared.map_or(DVec2::ZERO, |(k, l)| (self.grid.corners[next][l] - self.grid.corners[t][k]).round())
    }
}
