//! Where the sheet surely does not come near itself: windows of the flat sheet in which it bends little.
//!
//! Let J be the derivative of the place in space by that on the flat sheet, constant on each triangle, and M two orthonormal
//! vectors. If a convex window lies wholly on the sheet and the symmetric part of `MᵀJ` has no eigenvalue below c on any of its
//! triangles, then any two of its places, f apart on the flat sheet, are at least `c f` apart in space, even seen along the
//! plane of M: `(p − q)·Mᵀ(x(p) − x(q)) ≥ c |p − q|²`, by integration along the straight line from q to p. That is the test of
//! Volino & Magnenat-Thalmann (*Efficient self-collision detection on smoothly discretized surface animations using
//! geometrical shape regularity*, Eurographics 1994) with distances in place of crossings. The least eigenvalue is concave
//! in J, so on a straight way it is least at an end.
//!
//! With c = 2/π a window may bend by a good quarter of a turn: places in it are further apart than the ends of half a turn.

use super::tree::{Rectangle, bounds};
use super::way::Path;
use glam::{DMat2, DVec2, DVec3};
use softfold_geometry::{FlatMesh, VertexId};
use std::cell::Cell;

/// Sides of windows in sides of a square as large as two triangles. Small ones hold neighbours, and fit between a curved rim and
/// a sharp bend; large ones hold more at once, see also [`Windows::new`].
const SQUARES: [f64; 2] = [12.0, 5.0];
/// Boundary edges have no corner outside them by more than this, share of their length.
const STRAIGHT: f64 = 1e-9;

/// Windows of all sizes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Windows {
    grids: Vec<Grid>,
    /// Of each triangle the inverse of its edges' matrix on the flat sheet.
    inverse: Vec<DMat2>,
}

/// Square windows of two strides a side, one at each stride along both axes: any rectangle up to a stride wide is in one.
#[derive(Clone, Debug, PartialEq)]
struct Grid {
    origin: DVec2,
    stride_mm: f64,
    count: [usize; 2],
    /// The triangles of each window; none where it may not be convex, wholly on the sheet and of one part.
    triangles: Vec<Vec<u32>>,
}

/// Derivative of the place in space by u and v.
type Slope = [DVec3; 2];

/// What windows promise about one way, found where it is asked for.
pub(super) struct Calm<'a> {
    grids: &'a [Grid],
    /// Of each end of the way, of each triangle.
    ends: Vec<Vec<Slope>>,
    share: f64,
    /// Of each window of each grid.
    known: Vec<Vec<Cell<Option<bool>>>>,
}

impl Calm<'_> {
    /// Whether all places in a rectangle of the flat sheet surely stay apart by the share that was asked about.
    pub(super) fn holds(&self, flat: Rectangle) -> bool {
        self.grids.iter().zip(&self.known).any(|(grid, known)| {
            let promises = |w: usize| {
                let apart =
                    known[w].get().unwrap_or_else(|| spread(&grid.triangles[w], &self.ends, self.share));
                known[w].set(Some(apart));
                apart
            };
            grid.holding(flat).any(promises)
        })
    }
}

impl Windows {
    /// `part` tells of which part of the sheet a vertex is; the largest windows hold any pair that is up to `near_mm` apart on the
    /// flat sheet.
    pub(super) fn new(mesh: &FlatMesh, part: &[u32], near_mm: f64) -> Self {
        let [lower, upper] = bounds(mesh.vertices.iter().copied());
        let size = (upper - lower).max(DVec2::ZERO);
        let n = mesh.triangles.len().max(1) as f64;
        let square = (2.0 * size.x * size.y / n).sqrt();
        let [large, small] = SQUARES.map(|squares| (0.5 * squares * square).max(size.max_element() / n));
        let strides = [large.max(2.0 * near_mm), small];
        let inverse = |t: &[VertexId; 3]| {
            let [a, b, c] = t.map(|v| mesh.vertices[v.index()]);
            DMat2::from_cols(b - a, c - a).inverse()
        };
        Self {
            grids: strides.map(|stride_mm| Grid::new(mesh, part, lower, size, stride_mm)).to_vec(),
            inverse: mesh.triangles.iter().map(inverse).collect(),
        }
    }

    /// In which rectangles all places surely are at least `share` of their distance on the flat sheet apart on a whole way.
    pub(super) fn calm(&self, corners: &[[u32; 3]], path: Path<'_>, share: f64) -> Calm<'_> {
        let slopes = |at: &dyn Fn(u32) -> DVec3| -> Vec<Slope> {
            let slope = |(c, inverse): (&[u32; 3], &DMat2)| {
                let [a, b, c] = c.map(at);
                let (p, q) = (b - a, c - a);
                let along = |w: DVec2| w.x * p + w.y * q;
                [along(inverse.x_axis), along(inverse.y_axis)]
            };
            corners.iter().zip(&self.inverse).map(slope).collect()
        };
        let Path { x, step } = path;
        let mut ends = vec![slopes(&|v| x[v as usize])];
        if !step.is_empty() {
            ends.push(slopes(&|v| x[v as usize] + step[v as usize]));
        }
        let known = self.grids.iter().map(|g| vec![Cell::new(None); g.triangles.len()]).collect();
        Calm { grids: &self.grids, ends, share, known }
    }
}

impl Grid {
    fn new(mesh: &FlatMesh, part: &[u32], origin: DVec2, size: DVec2, stride_mm: f64) -> Self {
        let count = [size.x, size.y].map(|s| (s / stride_mm) as usize + 1);
        let mut grid = Self { origin, stride_mm, count, triangles: vec![Vec::new(); count[0] * count[1]] };
        let flat = |v: VertexId| mesh.vertices[v.index()];
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let touched = grid.touched(bounds(corners.iter().map(|v| flat(*v))));
            touched.for_each(|w| grid.triangles[w].push(t as u32));
        }
        let mut blocked: Vec<bool> = grid.triangles.iter().map(|own| !one_part(mesh, part, own)).collect();
        for e in &mesh.edges {
            let [Some(t), None] = e.triangles else { continue };
            let [a, b] = e.vertices.map(flat);
            let normal = (b - a).perp();
            let inwards: f64 = mesh.triangles[t.index()].iter().map(|v| normal.dot(flat(*v) - a)).sum();
            let normal = inwards.signum() * normal;
            let outside = |v: &VertexId| normal.dot(flat(*v) - a) < -STRAIGHT * normal.length_squared();
            for w in grid.touched(bounds([a, b].into_iter())) {
                let corners = |t: &u32| mesh.triangles[*t as usize].iter().any(outside);
                blocked[w] = blocked[w] || grid.triangles[w].iter().any(corners);
            }
        }
        let open = grid.triangles.iter_mut().zip(blocked);
        open.filter(|(_, blocked)| *blocked).for_each(|(own, _)| own.clear());
        grid
    }

    /// Windows that a rectangle may touch.
    fn touched(&self, [lower, upper]: Rectangle) -> impl Iterator<Item = usize> + use<> {
        // A little more: what only touches counts.
        let rim = DVec2::splat(1e-9);
        let [from, to] =
            [(lower - self.origin) / self.stride_mm - rim, (upper - self.origin) / self.stride_mm + rim];
        let [nu, nv] = self.count;
        let range =
            |from: f64, to: f64, n: usize| (from - 2.0).ceil().max(0.0) as usize..=(to as usize).min(n - 1);
        let rows = range(from.y, to.y, nv);
        range(from.x, to.x, nu).flat_map(move |i| rows.clone().map(move |j| i * nv + j))
    }

    /// The windows that hold a rectangle.
    fn holding(&self, [lower, upper]: Rectangle) -> impl Iterator<Item = usize> + use<> {
        let [from, to] = [(lower - self.origin) / self.stride_mm, (upper - self.origin) / self.stride_mm];
        let [nu, nv] = self.count;
        let range = |from: f64, to: f64, n: usize| {
            let first = (to - 2.0).ceil().max(0.0) as usize;
            first..(from.max(0.0) as usize + 1).min(n)
        };
        let rows = range(from.y, to.y, nv);
        range(from.x, to.x, nu).flat_map(move |i| rows.clone().map(move |j| i * nv + j))
    }
}

fn one_part(mesh: &FlatMesh, part: &[u32], own: &[u32]) -> bool {
    let of = |t: &u32| part[mesh.triangles[*t as usize][0].index()];
    own.iter().all(|t| of(t) == of(&own[0]))
}

/// Whether triangles, at all ends of a way, have slopes of at least `share` seen along their mean plane.
fn spread(own: &[u32], ends: &[Vec<Slope>], share: f64) -> bool {
    let all = || ends.iter().flat_map(|end| own.iter().map(|t| &end[*t as usize]));
    let mean = all().fold([DVec3::ZERO; 2], |[u, v], [su, sv]| [u + *su, v + *sv]);
    let Some([mu, mv]) = orthonormal(mean) else { return false };
    let least = |[u, v]: &Slope| {
        let (a, d, b) = (mu.dot(*u), mv.dot(*v), 0.5 * (mu.dot(*v) + mv.dot(*u)));
        0.5 * (a + d) - (0.25 * (a - d) * (a - d) + b * b).sqrt()
    };
    all().all(|slope| least(slope) >= share)
}

/// The orthonormal pair nearest to two vectors: their polar factor.
fn orthonormal([u, v]: Slope) -> Option<Slope> {
    let (a, b, d) = (u.length_squared(), u.dot(v), v.length_squared());
    let root = (a * d - b * b).max(0.0).sqrt();
    let trace = (a + d + 2.0 * root).sqrt();
    // (VᵀV)^½ = (VᵀV + root) / trace, and its determinant is root.
    let scale = 1.0 / (trace * root);
    let (su, sv, off) = (scale * (d + root), scale * (a + root), -scale * b);
    let pair = [su * u + off * v, off * u + sv * v];
    pair.iter().all(|p| (p.length_squared() - 1.0).abs() < 1e-9).then_some(pair)
}
