//! The map of the sheet onto a grid: both coordinates as even as their axes and cells want it, with fold lines and
//! pieces of the border on whole numbers.
//!
//! Two Poisson problems on the flat mesh, as in mixed-integer quadrangulation (Bommes et al. 2009, doi
//! 10.1145/1531326.1531383), but without singular points inside the sheet: the frame is a function, and what the border
//! does not follow is mended by layers along it.

use super::background::Background;
use super::frame::Frame;
use super::labels::Piece;
use super::sparse::Normal;
use glam::DVec2;
use softfold_geometry::FoldLine;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Weight of what must be on a whole number, against a cell's gradient.
const FIRM: f64 = 1e5;
/// Keeps the equations regular where only differences are asked.
const REST: f64 = 1e-9;
/// How often triangles that are turned over are made stiffer, as Bommes et al. do, and by how much.
const STIFFENINGS: usize = 6;
const STIFFER: f64 = 4.0;
/// Variables as near as this to a whole number are rounded together.
const NEAR: f64 = 0.1;

/// Cells wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cells {
    /// Length of a cell away from the bands, mm.
    pub(crate) cell_mm: f64,
    /// Cells across a strip of a band.
    pub(crate) per_strip: u32,
}

/// The map.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Grid coordinates of each triangle's corners. Neighbours differ by whole numbers where a hole is between.
    pub(crate) corners: Vec<[DVec2; 3]>,
}

/// What stays on one whole number.
struct Track {
    /// Vertices, in order.
    vertices: Vec<usize>,
    /// Variable and whole number to add.
    variable: usize,
    offset: f64,
}

/// Maps the sheet.
///
/// # Errors
/// The solver's words.
pub(crate) fn grid(
    ground: &Background<'_>,
    frame: &Frame,
    pieces: &[Piece],
    cells: Cells,
) -> Result<Grid, String> {
    let mut stiffness = vec![1.0; ground.mesh.triangles.len()];
    let mut best: Option<(usize, Grid)> = None;
    for _ in 0..STIFFENINGS {
        let [u, v] = [0, 1].map(|axis| coordinate(ground, frame, pieces, cells, axis, &stiffness));
        let corners =
            u?.into_iter().zip(v?).map(|(u, v)| [0, 1, 2].map(|k| DVec2::new(u[k], v[k]))).collect();
        let grid = Grid { corners };
        let folded: Vec<usize> = (0..stiffness.len()).filter(|&t| grid.is_folded(t)).collect();
        let count = folded.len();
        for t in folded {
            stiffness[t] *= STIFFER;
            ground.neighbours[t].iter().flatten().for_each(|&n| stiffness[n] *= STIFFER.sqrt());
        }
        if best.as_ref().is_none_or(|b| count < b.0) {
            best = Some((count, grid));
        }
        if count == 0 {
            break;
        }
    }
    best.map(|b| b.1).ok_or_else(|| "no map".to_owned())
}

impl Grid {
    /// Whether a triangle is turned over.
    fn is_folded(&self, t: usize) -> bool {
        let [a, b, c] = self.corners[t];
        (b - a).perp_dot(c - a) <= 0.0
    }
}

/// One coordinate at the corners of all triangles.
fn coordinate(
    ground: &Background<'_>,
    frame: &Frame,
    pieces: &[Piece],
    cells: Cells,
    axis: usize,
    stiffness: &[f64],
) -> Result<Vec<[f64; 3]>, String> {
    let (tracks, variables) = tracks(ground, frame, pieces, cells, axis);
    let mut problem = Problem { ground, tracks, variables, normal: Normal::new(0) };
    problem.assemble(frame, cells, axis, stiffness);
    let values = problem.round()?;
    Ok(problem.at_corners(&values))
}

struct Problem<'a> {
    ground: &'a Background<'a>,
    tracks: Vec<Track>,
    variables: usize,
    normal: Normal,
}

impl Problem<'_> {
    /// Unknowns: a value per vertex, the period of each hole, the variables of the tracks.
    fn hole(&self, h: usize) -> usize {
        self.ground.mesh.vertices.len() + h
    }

    fn variable(&self, k: usize) -> usize {
        self.hole(self.ground.hole_centres.len()) + k
    }

    fn assemble(&mut self, frame: &Frame, cells: Cells, axis: usize, stiffness: &[f64]) {
        let ground = self.ground;
        let unknowns = self.variable(self.variables);
        let mut normal = Normal::new(unknowns);
        let strips = Strips::new(ground, frame, axis);
        for t in 0..ground.mesh.triangles.len() {
            let (gradients, area) = ground.gradients(t);
            let first = frame.axis(ground, t);
            let along = if axis == 0 { first } else { first.perp() };
            let cell_mm =
                strips.width_mm(ground, t).map_or(cells.cell_mm, |w| w / f64::from(cells.per_strip));
            // Squared differences from one cell's step, over the cell's area.
            let weight = area * stiffness[t];
            for d in 0..2 {
                let mut row: Vec<(usize, f64)> =
                    ground.corners(t).into_iter().zip(gradients).map(|(v, g)| (v, g[d])).collect();
                for h in 0..ground.hole_centres.len() {
                    let swept = self.swept(t, h);
                    row.push((self.hole(h), gradients.iter().zip(swept).map(|(g, s)| g[d] * s / TAU).sum()));
                }
                normal.add_scalar(&row, along[d] / cell_mm, weight);
            }
        }
        (0..unknowns).for_each(|k| normal.add_scalar(&[(k, 1.0)], 0.0, REST));
        for track in &self.tracks {
            self.pin(track, &mut normal);
        }
        self.normal = normal;
    }

    /// Angles about a hole at the corners of a triangle, against the first.
    fn swept(&self, t: usize, hole: usize) -> [f64; 3] {
        let p = self.ground.points(t);
        p.map(|q| self.ground.swept(hole, p[0], q))
    }

    fn pin(&self, track: &Track, normal: &mut Normal) {
        let holes = self.ground.hole_centres.len();
        let angles: Vec<Vec<f64>> =
            (0..holes).map(|h| self.ground.angles_along(h, &track.vertices)).collect();
        for (k, &v) in track.vertices.iter().enumerate() {
            let mut row = vec![(v, 1.0), (self.variable(track.variable), -1.0)];
            row.extend((0..holes).map(|h| (self.hole(h), angles[h][k] / TAU)));
            normal.add_scalar(&row, track.offset, FIRM);
        }
    }

    /// Rounds periods and variables, the nearest first, and gives the values of all unknowns.
    fn round(&self) -> Result<Vec<f64>, String> {
        let mut open: Vec<usize> = (self.hole(0)..self.variable(self.variables)).collect();
        let mut normal = self.normal.clone();
        let fix =
            |normal: &mut Normal, k: usize, value: f64| normal.add_scalar(&[(k, 1.0)], value, 100.0 * FIRM);
        if self.variables > 0 {
            fix(&mut normal, self.variable(0), 0.0);
            open.retain(|k| *k != self.variable(0));
        }
        loop {
            let values = normal.solve_scalar()?;
            let off = |k: &usize| (values[*k] - values[*k].round()).abs();
            let Some(nearest) = open.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))) else {
                return Ok(values);
            };
            let now: Vec<usize> = open.iter().copied().filter(|k| *k == nearest || off(k) < NEAR).collect();
            now.iter().for_each(|&k| fix(&mut normal, k, values[k].round()));
            open.retain(|k| !now.contains(k));
        }
    }

    fn at_corners(&self, values: &[f64]) -> Vec<[f64; 3]> {
        let holes = self.ground.hole_centres.len();
        let of_triangle = |t: usize| {
            let vertices = self.ground.corners(t);
            let p = self.ground.points(t);
            let base: f64 = (0..holes).map(|h| values[self.hole(h)] * self.ground.angle(h, p[0]) / TAU).sum();
            let added = |k: usize| -> f64 {
                (0..holes).map(|h| values[self.hole(h)] * self.swept(t, h)[k] / TAU).sum()
            };
            [0, 1, 2].map(|k| values[vertices[k]] + base + added(k))
        };
        (0..self.ground.mesh.triangles.len()).map(of_triangle).collect()
    }
}

/// The coordinate that stays the same along a chain.
pub(crate) fn chain_axis(frame: &Frame, chain: usize) -> usize {
    usize::from(frame.quarters[chain] % 2 == 0)
}

/// Widths of the strips that lie across an axis.
struct Strips {
    /// Lines of this axis at each vertex: crease and line.
    lines: Vec<Vec<(u32, usize)>>,
}

impl Strips {
    fn new(ground: &Background<'_>, frame: &Frame, axis: usize) -> Self {
        let mut lines = vec![Vec::new(); ground.mesh.vertices.len()];
        let own = ground.chains.iter().enumerate().filter(|(c, _)| chain_axis(frame, *c) == axis);
        for (_, chain) in own {
            chain.vertices.iter().for_each(|&v| lines[v].push((chain.crease.0, chain.line)));
        }
        Self { lines }
    }

    /// Width of the strip that a triangle lies in: its height over the side on one fold line, the third corner being on
    /// another of the same crease.
    fn width_mm(&self, ground: &Background<'_>, t: usize) -> Option<f64> {
        let corners = ground.corners(t);
        let p = ground.points(t);
        let double = (p[1] - p[0]).perp_dot(p[2] - p[0]);
        (0..3).find_map(|k| {
            let [tip, a, b] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let on_side = |l: &&(u32, usize)| self.lines[b].contains(l);
            let base = self.lines[a].iter().find(on_side)?;
            let other = self.lines[tip].iter().any(|l| l.0 == base.0 && l.1 != base.1);
            other.then(|| double / p[(k + 1) % 3].distance(p[(k + 2) % 3]))
        })
    }
}

/// Chains and pieces of one axis with the variables they share.
fn tracks(
    ground: &Background<'_>,
    frame: &Frame,
    pieces: &[Piece],
    cells: Cells,
    axis: usize,
) -> (Vec<Track>, usize) {
    let chains: Vec<usize> = (0..ground.chains.len()).filter(|&c| chain_axis(frame, c) == axis).collect();
    let own: Vec<&Piece> = pieces.iter().filter(|p| p.axis() == axis).collect();
    let mut sets = Sets::new(own.len() + chains.len());
    let node = |k: usize| own.len() + k;
    let ranks: Vec<Option<f64>> = chains.iter().map(|&c| rank(ground, frame, c, cells)).collect();
    // Lines of a band are whole numbers apart.
    for k in 0..chains.len() {
        for l in 0..k {
            let same = ground.chains[chains[k]].crease == ground.chains[chains[l]].crease;
            if let (true, Some(a), Some(b)) = (same, ranks[k], ranks[l]) {
                sets.unite(node(k), node(l), a - b);
            }
        }
    }
    // Lines that meet in a point go on as one.
    let on_pieces: Vec<usize> = own.iter().flat_map(|p| p.vertices.iter().copied()).collect();
    let mut met: BTreeMap<usize, usize> = BTreeMap::new();
    for (k, &c) in chains.iter().enumerate() {
        for &v in ground.chains[c].vertices.iter().filter(|v| !on_pieces.contains(v)) {
            match met.get(&v) {
                Some(&l) => sets.unite(node(k), node(l), 0.0),
                None => drop(met.insert(v, k)),
            }
        }
    }
    let all = own
        .iter()
        .map(|p| p.vertices.clone())
        .chain(chains.iter().map(|&c| ground.chains[c].vertices.clone()));
    collect(all.collect(), &mut sets, own.len())
}

/// Tracks with their variables; a vertex that two tracks want on different numbers belongs to neither, but to a piece of
/// the border if there is one.
fn collect(all: Vec<Vec<usize>>, sets: &mut Sets, pieces: usize) -> (Vec<Track>, usize) {
    let mut wanted: BTreeMap<usize, Vec<(usize, usize, f64)>> = BTreeMap::new();
    for (node, vertices) in all.iter().enumerate() {
        let (root, offset) = sets.find(node);
        vertices.iter().for_each(|&v| wanted.entry(v).or_default().push((node, root, offset)));
    }
    let mut numbers: BTreeMap<usize, usize> = BTreeMap::new();
    let mut tracks = Vec::new();
    for (node, vertices) in all.into_iter().enumerate() {
        let (root, offset) = sets.find(node);
        let count = numbers.len();
        let variable = *numbers.entry(root).or_insert(count);
        let keeps = |v: &usize| {
            let others = wanted.get(v).map(Vec::as_slice).unwrap_or_default();
            others.iter().all(|&(n, r, o)| (r, o) == (root, offset) || (node < pieces && n >= pieces))
        };
        for run in vertices.split(|v| !keeps(v)).filter(|r| !r.is_empty()) {
            tracks.push(Track { vertices: run.to_vec(), variable, offset });
        }
    }
    (tracks, numbers.len())
}

/// Where a line stands in its band, in cells along the axis; none where that is no whole number.
fn rank(ground: &Background<'_>, frame: &Frame, c: usize, cells: Cells) -> Option<f64> {
    let chain = &ground.chains[c];
    let band = ground.soft.bands.iter().find(|b| b.crease == chain.crease)?;
    let line: &FoldLine = band.fold_lines.get(chain.line)?;
    let doubled = match line.rank {
        Some(k) => 2 * i64::from(k),
        None => i64::from(band.segments),
    } * i64::from(cells.per_strip);
    // The crease's left is the rising side where it runs along the first axis, or against the second.
    let sign = if matches!(frame.quarters[c], 0 | 3) { 1 } else { -1 };
    (doubled % 2 == 0).then_some((sign * doubled / 2) as f64)
}

/// Union-find whose members know their offset from the root.
struct Sets {
    parent: Vec<(usize, f64)>,
}

impl Sets {
    fn new(n: usize) -> Self {
        Self { parent: (0..n).map(|k| (k, 0.0)).collect() }
    }

    fn find(&self, mut k: usize) -> (usize, f64) {
        let mut offset = 0.0;
        while self.parent[k].0 != k {
            offset += self.parent[k].1;
            k = self.parent[k].0;
        }
        (k, offset)
    }

    /// Makes `a = b + offset`, unless that is known otherwise.
    fn unite(&mut self, a: usize, b: usize, offset: f64) {
        let ((ra, oa), (rb, ob)) = (self.find(a), self.find(b));
        match ra.cmp(&rb) {
            std::cmp::Ordering::Greater => self.parent[ra] = (rb, offset + ob - oa),
            std::cmp::Ordering::Less => self.parent[rb] = (ra, oa - offset - ob),
            std::cmp::Ordering::Equal => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_of_a_set_keep_their_distances() {
        let mut sets = Sets::new(4);
        sets.unite(3, 1, 2.0);
        sets.unite(1, 0, 5.0);
        sets.unite(3, 0, -100.0); // known otherwise
        assert_eq!(sets.find(3), (0, 7.0));
        assert_eq!(sets.find(2), (2, 0.0));
    }
}
