//! Where a point of the sheet is on a mesh.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use softfold_geometry::{FlatMesh, TriangleId, VertexId};

/// Finds triangles of a mesh by points of the sheet.
pub struct Locator<'a> {
    mesh: &'a FlatMesh,
    boxes: RTree<Box2>,
    /// Beyond side `k` of each triangle, which is opposite to its corner `k`.
    neighbours: Vec<[Option<TriangleId>; 3]>,
    tolerance_mm: f64,
}

type Box2 = GeomWithData<Rectangle<[f64; 2]>, u32>;

/// Points outside count as far as this share of the mean edge length: chords of boundary curves leave less.
const OUTSIDE: f64 = 0.25;
/// Barycentric coordinates above this are inside: rounding of points on edges.
const INSIDE: f64 = -1e-10;
/// Steps of a walk before it is given up. Vertices and the middle of what surrounds them are a few triangles apart.
const MOST_STEPS: usize = 256;

impl<'a> Locator<'a> {
    /// A locator for points on the mesh, and outside it by less than a quarter of the mean edge length.
    pub fn new(mesh: &'a FlatMesh) -> Self {
        let length: f64 = mesh
            .edges
            .iter()
            .map(|e| e.vertices.map(|v| mesh.vertices[v.index()]))
            .map(|[a, b]| a.distance(b))
            .sum();
        Self::with_tolerance(mesh, OUTSIDE * length / mesh.edges.len().max(1) as f64)
    }

    /// A locator for points on the mesh, and outside it by no more than that.
    pub fn with_tolerance(mesh: &'a FlatMesh, tolerance_mm: f64) -> Self {
        let to_box = |t: usize| {
            let [a, b, c] = mesh.corners(TriangleId::new(t));
            let corners = (a.min(b).min(c).to_array(), a.max(b).max(c).to_array());
            GeomWithData::new(Rectangle::from_corners(corners.0, corners.1), t as u32)
        };
        let boxes = RTree::bulk_load((0..mesh.triangles.len()).map(to_box).collect());
        Self { mesh, boxes, neighbours: neighbours(mesh), tolerance_mm }
    }

    /// The triangle of a point with its barycentric coordinates there; of a point a little outside, those of the nearest
    /// point of the mesh. Of several triangles, the one in which the point is deepest; then the first.
    pub fn locate(&self, p: DVec2) -> Option<(TriangleId, [f64; 3])> {
        let around =
            self.boxes.locate_in_envelope_intersecting(self.envelope(p, 0.0)).map(|b| TriangleId(b.data));
        let depth = |t: TriangleId| (self.barycentric(t, p), t);
        let deepest = around.map(depth).max_by(|a, b| least(a.0).total_cmp(&least(b.0)).then(b.1.cmp(&a.1)));
        match deepest {
            Some((weights, t)) if least(weights) >= INSIDE => Some((t, weights)),
            _ => self.nearest(p),
        }
    }

    fn nearest(&self, p: DVec2) -> Option<(TriangleId, [f64; 3])> {
        let around = self.boxes.locate_in_envelope_intersecting(self.envelope(p, self.tolerance_mm));
        let nearest = |b: &Box2| {
            let t = TriangleId(b.data);
            let at = nearest_point(self.mesh.corners(t), p);
            (at.distance(p), t, at)
        };
        let found = around.map(nearest).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.filter(|f| f.0 <= self.tolerance_mm).map(|(_, t, at)| (t, self.barycentric(t, at)))
    }

    fn envelope(&self, p: DVec2, by_mm: f64) -> AABB<[f64; 2]> {
        AABB::from_corners((p - by_mm).to_array(), (p + by_mm).to_array())
    }

    /// From the triangle of one point to that of another, across edges that two triangles share: never across a slit.
    /// Where the boundary ends the walk, the coordinates reach out of the last triangle.
    pub(crate) fn walk(&self, from: DVec2, to: DVec2) -> Option<(TriangleId, [f64; 3])> {
        let (mut here, _) = self.locate(from)?;
        for _ in 0..MOST_STEPS {
            let weights = self.barycentric(here, to);
            let behind = |k: &usize| weights[*k] < INSIDE && self.neighbours[here.index()][*k].is_some();
            let out = (0..3).filter(behind).min_by(|&a, &b| weights[a].total_cmp(&weights[b]));
            match out.and_then(|k| self.neighbours[here.index()][k]) {
                Some(next) => here = next,
                None => return Some((here, weights)),
            }
        }
        self.locate(to)
    }

    fn barycentric(&self, t: TriangleId, p: DVec2) -> [f64; 3] {
        let [a, b, c] = self.mesh.corners(t);
        let area = (b - a).perp_dot(c - a);
        let [u, v] = [(c - b).perp_dot(p - b), (a - c).perp_dot(p - c)].map(|w| w / area);
        [u, v, 1.0 - u - v]
    }
}

fn least(weights: [f64; 3]) -> f64 {
    weights.into_iter().fold(f64::MAX, f64::min)
}

fn neighbours(mesh: &FlatMesh) -> Vec<[Option<TriangleId>; 3]> {
    let mut neighbours = vec![[None; 3]; mesh.triangles.len()];
    for e in &mesh.edges {
        let [Some(a), Some(b)] = e.triangles else { continue };
        for (t, other) in [(a, b), (b, a)] {
            let tip: VertexId = mesh.opposite(t, e.vertices);
            let side = mesh.triangles[t.index()].iter().position(|v| *v == tip).unwrap_or(0);
            neighbours[t.index()][side] = Some(other);
        }
    }
    neighbours
}

/// The point of a triangle's border that is nearest to a point outside it.
fn nearest_point(corners: [DVec2; 3], p: DVec2) -> DVec2 {
    let on_side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        a + ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0) * (b - a)
    };
    [1, 2].map(on_side).into_iter().fold(on_side(0), |n, q| if q.distance(p) < n.distance(p) { q } else { n })
}
