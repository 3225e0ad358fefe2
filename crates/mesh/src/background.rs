//! A grid behind the sheet for the points inside: which part of it is sheet, the sizing field at its nodes, and which
//! points lie in each cell. Cells are as wide as the target and are cut finer where the field asks for shorter edges.

use crate::inside::Inside;
use crate::size::SizeField;
use glam::DVec2;
use softfold_geometry::polygon;
use std::f64::consts::FRAC_1_SQRT_2;

/// No point.
const NONE: u32 = u32::MAX;
/// A cell is cut into no more parts than so many along each side.
const MOST_PARTS: f64 = 64.0;
/// More cells than this are not made: they get wider.
const MOST_CELLS: f64 = 8e6;
/// Cells along each side of a block: where the target holds throughout, its cells need no look at the field.
const BLOCK: usize = 8;

/// The grid; a cell is made when something first asks for it.
pub(crate) struct Background<'a> {
    sizes: &'a SizeField,
    inside: Inside,
    low: DVec2,
    cell_mm: f64,
    cells_per_mm: f64,
    counts: [usize; 2],
    cells: Vec<Cell>,
    /// Per block of cells: whether the target holds throughout, once it is known.
    even: Vec<Option<bool>>,
    /// Per part of a cell: the point that came last into it.
    newest: Vec<u32>,
    /// Per point: the one that came before it into its part.
    older: Vec<u32>,
    /// Sizes at the nodes of cells where they differ; NaN until asked for.
    nodes: Vec<f64>,
}

#[derive(Clone, Copy)]
struct Cell {
    ground: Ground,
    /// Parts along each side; 0 for a cell that is not made yet.
    parts: u32,
    first_part: u32,
    /// Where its nodes begin, unless the target holds throughout.
    first_node: Option<u32>,
}

/// What a cell lies on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ground {
    Sheet,
    Nothing,
    /// The boundary runs through.
    Both,
}

impl<'a> Background<'a> {
    /// A grid behind the polygons, which must not be all empty.
    pub(crate) fn new(polygons: &[Vec<DVec2>], sizes: &'a SizeField) -> Self {
        let all: Vec<DVec2> = polygons.iter().flatten().copied().collect();
        let (low, high) = polygon::bounds(&all);
        let extent = high - low;
        let cell_mm = sizes.target_mm().max((extent.x * extent.y / MOST_CELLS).sqrt());
        let cell_mm = cell_mm.max(extent.max_element() / MOST_CELLS);
        let counts = [extent.x, extent.y].map(|length| (length / cell_mm) as usize + 1);
        let empty = Cell { ground: Ground::Nothing, parts: 0, first_part: 0, first_node: None };
        let mut grid = Self {
            sizes,
            inside: Inside::new(polygons),
            low,
            cell_mm,
            cells_per_mm: 1.0 / cell_mm,
            counts,
            even: vec![None; counts[0].div_ceil(BLOCK) * counts[1].div_ceil(BLOCK)],
            cells: vec![empty; counts[0] * counts[1]],
            newest: Vec::new(),
            older: Vec::new(),
            nodes: Vec::new(),
        };
        for (a, b) in polygons.iter().flat_map(|p| polygon::edges(p)) {
            let [from, to] = [grid.cell_at(a.min(b)), grid.cell_at(a.max(b))];
            for y in from[1]..=to[1] {
                for x in from[0]..=to[0] {
                    grid.cells[y * counts[0] + x].ground = Ground::Both;
                }
            }
        }
        grid
    }

    /// Notes the point that follows those noted before.
    pub(crate) fn insert(&mut self, p: DVec2) {
        let at = self.cell_at(p);
        let cell = self.made(at);
        let [x, y] = self.part_at(at, cell.parts, p);
        let part = cell.first_part as usize + y * cell.parts as usize + x;
        let number = self.older.len() as u32;
        self.older.push(std::mem::replace(&mut self.newest[part], number));
    }

    /// Its lowest and highest corners.
    pub(crate) fn bounds(&self) -> (DVec2, DVec2) {
        let [x, y] = self.counts.map(|count| self.cell_mm * count as f64);
        (self.low, self.low + DVec2::new(x, y))
    }

    /// The longest edges, mm.
    pub(crate) fn target_mm(&self) -> f64 {
        self.sizes.target_mm()
    }

    /// Whether the target holds all around a point of the grid.
    pub(crate) fn is_even(&mut self, p: DVec2) -> bool {
        let at = self.cell_at(p);
        self.made(at).first_node.is_none()
    }

    /// Whether a point is on the sheet.
    pub(crate) fn is_sheet(&mut self, p: DVec2) -> bool {
        let offset = (p - self.low) * self.cells_per_mm;
        if offset.min_element() < 0.0
            || offset.x >= self.counts[0] as f64
            || offset.y >= self.counts[1] as f64
        {
            return false;
        }
        match self.made(self.cell_at(p)).ground {
            Ground::Sheet => true,
            Ground::Nothing => false,
            Ground::Both => self.inside.contains(p),
        }
    }

    /// Writes the points noted that are nearer than that, of those that `points` are.
    pub(crate) fn near(&mut self, points: &[DVec2], p: DVec2, distance_mm: f64, found: &mut Vec<DVec2>) {
        found.clear();
        let [low, high] = [p - distance_mm, p + distance_mm];
        let [from, to] = [self.cell_at(low), self.cell_at(high)];
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let cell = self.made([x, y]);
                let [first, last] = [low, high].map(|q| self.part_at([x, y], cell.parts, q));
                for row in first[1]..=last[1] {
                    let start = cell.first_part as usize + row * cell.parts as usize;
                    for part in start + first[0]..=start + last[0] {
                        let here = self.in_part(part).map(|i| points[i]);
                        found.extend(here.filter(|q| q.distance_squared(p) < distance_mm * distance_mm));
                    }
                }
            }
        }
    }

    fn in_part(&self, part: usize) -> impl Iterator<Item = usize> {
        let known = |point: u32| (point != NONE).then_some(point as usize);
        std::iter::successors(known(self.newest[part]), move |&i| known(self.older[i]))
    }

    /// The sizing field at a point, mm: between the nodes of the grid it is bilinear.
    pub(crate) fn size_mm(&mut self, p: DVec2) -> f64 {
        let at = self.cell_at(p);
        let cell = self.made(at);
        let Some(first_node) = cell.first_node else { return self.sizes.target_mm() };
        let parts = f64::from(cell.parts);
        let within = (parts * self.within(at, p)).clamp(DVec2::ZERO, DVec2::splat(parts));
        let corner = within.floor().min(DVec2::splat(parts - 1.0));
        let [x, y] = corner.to_array().map(|c| c as usize);
        let t = within - corner;
        let mut node = |dx: usize, dy: usize| {
            let index = first_node as usize + (y + dy) * (cell.parts as usize + 1) + x + dx;
            if self.nodes[index].is_nan() {
                let offset = corner + DVec2::new(dx as f64, dy as f64);
                let origin = DVec2::new(at[0] as f64, at[1] as f64);
                self.nodes[index] = self.sizes.at(self.low + self.cell_mm * (origin + offset / parts));
            }
            self.nodes[index]
        };
        let [lower, upper] = [0, 1].map(|dy| node(0, dy) * (1.0 - t.x) + node(1, dy) * t.x);
        lower * (1.0 - t.y) + upper * t.y
    }

    /// The cell of a point; the nearest one for points beyond the grid.
    fn cell_at(&self, p: DVec2) -> [usize; 2] {
        let offset = ((p - self.low) * self.cells_per_mm).to_array();
        [0, 1].map(|k| (offset[k].max(0.0) as usize).min(self.counts[k] - 1))
    }

    /// Where a point is in a cell, 0 to 1 both ways; beyond that outside of it.
    fn within(&self, cell: [usize; 2], p: DVec2) -> DVec2 {
        (p - self.low) * self.cells_per_mm - DVec2::new(cell[0] as f64, cell[1] as f64)
    }

    fn part_at(&self, cell: [usize; 2], parts: u32, p: DVec2) -> [usize; 2] {
        if parts == 1 {
            return [0; 2];
        }
        let within = (f64::from(parts) * self.within(cell, p)).to_array();
        within.map(|w| (w.max(0.0) as usize).min(parts as usize - 1))
    }

    #[inline]
    fn made(&mut self, [x, y]: [usize; 2]) -> Cell {
        let index = y * self.counts[0] + x;
        if self.cells[index].parts == 0 {
            self.make(index, [x, y]);
        }
        self.cells[index]
    }

    fn make(&mut self, index: usize, [x, y]: [usize; 2]) {
        let center = self.low + self.cell_mm * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        if self.cells[index].ground == Ground::Nothing && self.inside.contains(center) {
            self.cells[index].ground = Ground::Sheet;
        }
        let target_mm = self.sizes.target_mm();
        let least = match self.is_even_block([x / BLOCK, y / BLOCK]) {
            true => target_mm,
            false => self.sizes.least_within(center, self.cell_mm * FRAC_1_SQRT_2),
        };
        let parts = (self.cell_mm / least).ceil().clamp(1.0, MOST_PARTS);
        let cell = &mut self.cells[index];
        cell.parts = parts as u32;
        cell.first_part = self.newest.len() as u32;
        self.newest.resize(self.newest.len() + (parts * parts) as usize, NONE);
        if least < target_mm {
            cell.first_node = Some(self.nodes.len() as u32);
            self.nodes.resize(self.nodes.len() + (parts as usize + 1).pow(2), f64::NAN);
        }
    }

    /// Whether the target holds all over a block.
    fn is_even_block(&mut self, [x, y]: [usize; 2]) -> bool {
        let index = y * self.counts[0].div_ceil(BLOCK) + x;
        let block_mm = BLOCK as f64 * self.cell_mm;
        let center = self.low + block_mm * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let (sizes, reach_mm) = (self.sizes, block_mm * FRAC_1_SQRT_2);
        *self.even[index].get_or_insert_with(|| sizes.least_within(center, reach_mm) >= sizes.target_mm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshOptions;
    use crate::rng::SplitMix64;
    use crate::size::{Source, source};

    const SIDE_MM: f64 = 100.0;

    fn square() -> Vec<Vec<DVec2>> {
        let corners = [(0.0, 0.0), (SIDE_MM, 0.0), (SIDE_MM, SIDE_MM), (0.0, SIDE_MM)].map(DVec2::from);
        let hole = [(40.0, 40.0), (40.0, 60.0), (60.0, 60.0), (60.0, 40.0)].map(DVec2::from);
        vec![corners.to_vec(), hole.to_vec()]
    }

    fn field(sources: Vec<Source>) -> SizeField {
        SizeField::from_sources(sources, &MeshOptions { target_edge_mm: 8.0, ..MeshOptions::default() })
    }

    fn random(count: usize, reach: f64) -> Vec<DVec2> {
        let mut rng = SplitMix64(5);
        let mut unit = || reach * (rng.unit() - 0.5) + 0.5 * SIDE_MM;
        (0..count).map(|_| DVec2::new(unit(), unit())).collect()
    }

    #[test]
    fn the_points_nearby_are_found_on_fine_cells_too() {
        let sizes = field(vec![source(DVec2::new(30.0, 70.0), 0.2)]);
        let mut grid = Background::new(&square(), &sizes);
        let points = random(400, SIDE_MM);
        points.iter().for_each(|p| grid.insert(*p));
        let mut found = Vec::new();
        for (k, q) in random(2000, 1.3 * SIDE_MM).into_iter().enumerate() {
            let radius = 0.02 * (k % 700) as f64;
            grid.near(&points, q, radius, &mut found);
            let by_x = |a: &DVec2, b: &DVec2| a.x.total_cmp(&b.x);
            let mut expected: Vec<DVec2> =
                points.iter().copied().filter(|p| p.distance(q) < radius).collect();
            expected.sort_by(by_x);
            found.sort_by(by_x);
            assert_eq!(found, expected, "{q} {radius}");
        }
    }

    #[test]
    fn the_sheet_is_the_square_without_its_hole() {
        let sizes = field(vec![]);
        let mut grid = Background::new(&square(), &sizes);
        for p in random(4000, 1.3 * SIDE_MM) {
            let within = |lo: f64, hi: f64| p.to_array().iter().all(|c| (lo..hi).contains(c));
            assert_eq!(grid.is_sheet(p), within(0.0, SIDE_MM) && !within(40.0, 60.0), "{p}");
        }
    }

    #[test]
    fn sizes_between_nodes_are_near_the_field() {
        let sizes = field(vec![source(DVec2::new(30.0, 70.0), 0.5), source(DVec2::new(80.0, 20.0), 3.0)]);
        let mut grid = Background::new(&square(), &sizes);
        for p in random(4000, SIDE_MM) {
            let (coarse, exact) = (grid.size_mm(p), sizes.at(p));
            assert!((coarse / exact - 1.0).abs() < 0.1, "{p}: {coarse} {exact}");
        }
        let even = field(vec![]);
        let mut grid = Background::new(&square(), &even);
        assert!(random(100, SIDE_MM).into_iter().all(|p| grid.size_mm(p) == 8.0));
        assert!(grid.nodes.is_empty());
    }
}
