//! Constraints that cross, overlap or touch, as pieces that meet only at their ends.
//!
//! Snap rounding (J. Hobby, *Practical segment intersection with finite precision output*, 1999; Guibas and Marimont
//! 1998): points and crossings are rounded to a grid, and every constraint is led through the middles of the grid's
//! squares that it passes and that hold a point. Pieces then meet nowhere but at their ends. All of it is exact in
//! integers, so no rounding can make two libraries see two arrangements.
//!
//! Before the rounding, constraints are led through points that they touch: rounding alone might part the two.

use crate::MeshError;
use crate::grid::{Cell, Grid, crossing, passes};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use softfold_geometry::{VertexId, polygon};
use std::collections::{BTreeMap, BTreeSet};

/// A point this near to a constraint is on it, pitches of the grid: more than the rounding of both can part them.
const TOUCH: f64 = 2.0;

/// The farthest that a piece lies from the constraint it came from, pitches of the grid: touching, then twice the
/// rounding to the middle of a square.
pub(crate) const OFF_LINE: f64 = TOUCH + 2.0 * std::f64::consts::FRAC_1_SQRT_2;

/// Points and pieces of constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct Noded {
    /// The distinct points of the input in their order, then those where constraints meet, mm.
    pub points: Vec<DVec2>,
    /// Which of `points` each point of the input became.
    pub vertex_of_input: Vec<VertexId>,
    /// The points along each constraint, from its first end to its second; one alone if both ends are one point. Where
    /// points lie within a few pitches of each other it may go back by as much.
    pub chains: Vec<Vec<VertexId>>,
    /// Points moved by less than this, and no piece lies farther from its constraint than four times this, mm.
    pub pitch_mm: f64,
}

impl Noded {
    /// Every piece once, lower vertex first, with the constraints that run along it.
    pub fn pieces(&self) -> BTreeMap<[VertexId; 2], Vec<u32>> {
        let mut pieces: BTreeMap<_, Vec<u32>> = BTreeMap::new();
        for (i, chain) in self.chains.iter().enumerate() {
            for w in chain.windows(2) {
                pieces.entry([w[0].min(w[1]), w[0].max(w[1])]).or_default().push(i as u32);
            }
        }
        pieces
    }
}

/// Cuts constraints into pieces that meet only at their ends.
///
/// # Errors
/// Points that are not finite, or that are all one.
pub fn noded(points: &[DVec2], constraints: &[[VertexId; 2]]) -> Result<Noded, MeshError> {
    let grid = Grid::around(points)?;
    let mut nodes = Nodes::new();
    let vertex_of_input: Vec<VertexId> = points.iter().map(|p| nodes.vertex(grid.nearest(*p))).collect();
    let ends = |c: &[VertexId; 2]| c.map(|v| vertex_of_input[v.index()]);
    let touched = Touched::new(points, &vertex_of_input, TOUCH * grid.pitch_mm());
    let led: Vec<Vec<VertexId>> =
        constraints.iter().map(|c| touched.along(c.map(|v| points[v.index()]), ends(c))).collect();
    let sides: Vec<[Cell; 2]> =
        led.iter().flat_map(|l| l.windows(2)).map(|w| [w[0], w[1]].map(|v| nodes.cells[v.index()])).collect();
    for cell in crossings(&sides) {
        nodes.vertex(cell);
    }
    let squares = nodes.squares();
    let chains = led.iter().map(|l| nodes.chain(l, &squares)).collect();
    let points = nodes.cells.iter().map(|c| grid.point(*c)).collect();
    Ok(Noded { points, vertex_of_input, chains, pitch_mm: grid.pitch_mm() })
}

/// Distinct places on the grid, by number.
struct Nodes {
    cells: Vec<Cell>,
    known: BTreeMap<Cell, VertexId>,
}

type Square = GeomWithData<[i64; 2], VertexId>;

impl Nodes {
    fn new() -> Self {
        Self { cells: vec![], known: BTreeMap::new() }
    }

    fn vertex(&mut self, cell: Cell) -> VertexId {
        *self.known.entry(cell).or_insert_with(|| {
            self.cells.push(cell);
            VertexId::new(self.cells.len() - 1)
        })
    }

    fn squares(&self) -> RTree<Square> {
        let square = |(i, c): (usize, &Cell)| Square::new([c.x, c.y], VertexId::new(i));
        RTree::bulk_load(self.cells.iter().enumerate().map(square).collect())
    }

    /// The nodes whose squares the sides of a chain pass, in order.
    fn chain(&self, led: &[VertexId], squares: &RTree<Square>) -> Vec<VertexId> {
        let mut chain = vec![led[0]];
        for w in led.windows(2) {
            let side = [w[0], w[1]].map(|v| self.cells[v.index()]);
            let [a, b] = side;
            let around = AABB::from_corners(
                [a.x.min(b.x) - 1, a.y.min(b.y) - 1],
                [a.x.max(b.x) + 1, a.y.max(b.y) + 1],
            );
            let passed = squares.locate_in_envelope(around).map(|s| s.data);
            let mut passed: Vec<VertexId> = passed.filter(|v| passes(side, self.cells[v.index()])).collect();
            passed.sort_by_key(|v| order_along(side, self.cells[v.index()]));
            chain.extend(passed);
        }
        chain.dedup();
        chain
    }
}

/// Sorts the squares that a segment passes: first along the axis on which it goes farther, then along the other.
fn order_along([a, b]: [Cell; 2], at: Cell) -> [i64; 2] {
    let [x, y] = [(b.x - a.x).signum() * (at.x - a.x), (b.y - a.y).signum() * (at.y - a.y)];
    if (b.x - a.x).abs() >= (b.y - a.y).abs() { [x, y] } else { [y, x] }
}

/// Finds points of the input that a constraint touches.
struct Touched {
    points: RTree<GeomWithData<[f64; 2], VertexId>>,
    reach_mm: f64,
}

impl Touched {
    fn new(points: &[DVec2], vertices: &[VertexId], reach_mm: f64) -> Self {
        let point = |(p, v): (&DVec2, &VertexId)| GeomWithData::new(p.to_array(), *v);
        Self { points: RTree::bulk_load(points.iter().zip(vertices).map(point).collect()), reach_mm }
    }

    /// The ends of a constraint with the touched points between them, in order.
    fn along(&self, [a, b]: [DVec2; 2], [from, to]: [VertexId; 2]) -> Vec<VertexId> {
        let around =
            AABB::from_corners((a.min(b) - self.reach_mm).to_array(), (a.max(b) + self.reach_mm).to_array());
        let mut seen = BTreeSet::from([from, to]);
        let near = self.points.locate_in_envelope(around).filter_map(|p| {
            let at = DVec2::from(*p.geom());
            let is_between = (at - a).dot(b - a) > 0.0 && (at - b).dot(a - b) > 0.0;
            let is_on = is_between && polygon::segment_distance(at, a, b) <= self.reach_mm;
            is_on.then(|| ((at - a).dot(b - a), p.data))
        });
        let mut near: Vec<(f64, VertexId)> = near.collect();
        near.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        near.retain(|(_, v)| seen.insert(*v));
        let inner = near.into_iter().map(|(_, v)| v);
        let mut led: Vec<VertexId> = std::iter::once(from).chain(inner).chain([to]).collect();
        led.dedup();
        led
    }
}

/// The places where sides cross.
fn crossings(sides: &[[Cell; 2]]) -> BTreeSet<Cell> {
    let line = |(i, [a, b]): (usize, &[Cell; 2])| {
        let box_ = Rectangle::from_corners([a.x, a.y], [b.x, b.y]);
        GeomWithData::new(box_, i)
    };
    let tree = RTree::bulk_load(sides.iter().enumerate().map(line).collect());
    let pairs = tree.intersection_candidates_with_other_tree(&tree);
    pairs
        .filter(|(p, q)| p.data < q.data)
        .filter_map(|(p, q)| crossing(sides[p.data], sides[q.data]))
        .collect()
}
