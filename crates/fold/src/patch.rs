//! Second derivatives on a triangle mesh of the flat sheet, with which a bending energy converges.
//!
//! Morley's plate element has the values at a triangle's corners and the derivative across each side in its middle; its second
//! derivatives on the triangle are `(1/A) Σ L n nᵀ (∂ₙx − n·∇x̂)` over the sides, with x̂ linear between the corners. Here the
//! derivatives across sides are no unknowns: a quadratic is fitted to each triangle and its neighbours, and both sides' fits
//! are averaged. Two properties make that converge on any mesh: quadratics are met exactly, and as the derivative across a side is the same
//! for both of its triangles, an evenly bent sheet is in equilibrium (sums over hinges have neither; a fit for each triangle by itself has
//! the first alone, and crumples). The energy is never below Morley's, hence as stable.
//!
//! Beyond the plane through its corners a quadratic has three coefficients. The points across the three sides give three
//! equations; if all six points lie near one conic, or sides are on a fold line or the boundary, the neighbours' neighbours
//! join in by least squares. What even they do not tell (across a strip one triangle wide, whose points lie on two lines) counts
//! as unbent.

use faer::{Mat, Side};
use glam::DVec2;
use softfold_geometry::{EdgeClass, FlatMesh, TriangleId, VertexId};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_SQRT_2;

/// The second derivatives on one triangle, as linear forms of the positions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Patch {
    /// The points it looks at, ascending.
    pub(crate) vertices: Vec<u32>,
    /// Per point the weights, 1/mm², of `(xᵤᵤ + xᵥᵥ)/√2`, `(xᵤᵤ − xᵥᵥ)/√2` and `√2 xᵤᵥ`: the squares add up to |∇²x|². Over all points they
    /// add up to 0.
    pub(crate) weights: Vec<[f64; 3]>,
    /// Flat area of the triangle, mm².
    pub(crate) area_mm2: f64,
}

/// Eigenvalue of the fit's normal matrix, over the largest, below which a second derivative is not determined; 0.1 to 0.5
/// between well-shaped triangles, 1e-3 and less where six points lie near a conic.
const DETERMINED: f64 = 0.02;

/// Rings of neighbours that may join in; further ones would couple much and tell little of the triangle.
const RINGS: usize = 2;

/// One patch for each triangle that has a neighbour on its face.
pub(crate) fn patches(mesh: &FlatMesh) -> Vec<Patch> {
    let across = neighbours(mesh);
    let quadratics: Vec<Option<Quadratic>> =
        (0..mesh.triangles.len()).map(|t| Quadratic::fitted(mesh, &across, t)).collect();
    let patch = |t: usize| Some(patch(mesh, t, quadratics[t].as_ref()?, &across[t], &quadratics));
    (0..mesh.triangles.len()).filter_map(patch).collect()
}

/// Of each triangle those on the same face, by the side that is shared: side k runs from corner k.
fn neighbours(mesh: &FlatMesh) -> Vec<[Option<usize>; 3]> {
    let mut across = vec![[None; 3]; mesh.triangles.len()];
    for e in mesh.edges.iter().filter(|e| e.class == EdgeClass::Facet) {
        if let [Some(a), Some(b)] = e.triangles {
            let side = |t: TriangleId, start: VertexId| {
                mesh.triangles[t.index()].iter().position(|v| *v == start).unwrap_or(0)
            };
            across[a.index()][side(a, e.vertices[0])] = Some(b.index());
            across[b.index()][side(b, e.vertices[1])] = Some(a.index());
        }
    }
    across
}

/// A linear form of the positions.
type Form = BTreeMap<u32, f64>;

fn patch(
    mesh: &FlatMesh,
    t: usize,
    own: &Quadratic,
    across: &[Option<usize>; 3],
    quadratics: &[Option<Quadratic>],
) -> Patch {
    let (corners, area_mm2) = (mesh.corners(TriangleId::new(t)), mesh.triangle_area_mm2(TriangleId::new(t)));
    let mut sums: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for k in 0..3 {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let (normal, middle) = (-(to - from).perp().normalize(), 0.5 * (from + to));
        let other = across[k].and_then(|n| quadratics[n].as_ref());
        let sides: Vec<&Quadratic> = std::iter::once(own).chain(other).collect();
        let tensor = [
            FRAC_1_SQRT_2,
            FRAC_1_SQRT_2 * (normal.x.powi(2) - normal.y.powi(2)),
            normal.x * normal.y / FRAC_1_SQRT_2,
        ];
        let mut add = |form: Form, factor: f64| {
            for (v, w) in form {
                let sum = sums.entry(v).or_default();
                (0..3).for_each(|m| sum[m] += factor * from.distance(to) / area_mm2 * tensor[m] * w);
            }
        };
        sides.iter().for_each(|q| add(q.derivative(middle, normal), 1.0 / sides.len() as f64));
        add(own.plane.derivative(normal), -1.0);
    }
    let (vertices, weights) = sums.into_iter().unzip();
    Patch { vertices, weights, area_mm2 }
}

/// Linear between a triangle's corners.
struct Plane {
    vertices: [u32; 3],
    corners: [DVec2; 3],
    /// Gradients of the barycentric coordinates, 1/mm.
    gradients: [DVec2; 3],
}

impl Plane {
    fn new(mesh: &FlatMesh, t: usize) -> Self {
        let corners = mesh.corners(TriangleId::new(t));
        let [a, b, c] = corners;
        let whole = (b - a).perp_dot(c - a);
        let gradients = [c - b, a - c, b - a].map(|side| side.perp() / whole);
        Self { vertices: mesh.triangles[t].map(|v| v.0), corners, gradients }
    }

    fn barycentric(&self, p: DVec2) -> [f64; 3] {
        // Each coordinate is 1 in its corner and 0 on the side across.
        [0, 1, 2].map(|k| self.gradients[k].dot(p - self.corners[(k + 1) % 3]))
    }

    fn derivative(&self, along: DVec2) -> Form {
        self.vertices.into_iter().zip(self.gradients.map(|g| g.dot(along))).collect()
    }
}

/// A quadratic through a triangle's corners, fitted to further points.
struct Quadratic {
    plane: Plane,
    middle: DVec2,
    size_mm: f64,
    /// Further points.
    reaches: Vec<Reach>,
    /// Of each further point what its height over the plane adds to the coefficients.
    rows: Vec<[f64; 3]>,
}

/// A further point of a fit.
struct Reach {
    vertex: u32,
    barycentric: [f64; 3],
    /// Heights of the three quadratics over the planes through their values at the corners.
    heights: [f64; 3],
    /// Weight: heights grow with the square of the distance, and so do their errors.
    weight: f64,
}

impl Quadratic {
    /// None if the triangle has no neighbour on its face.
    fn fitted(mesh: &FlatMesh, across: &[[Option<usize>; 3]], t: usize) -> Option<Self> {
        let plane = Plane::new(mesh, t);
        let [a, b, c] = plane.corners;
        let size_mm = ((b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared()).sqrt();
        let mut quadratic =
            Self { middle: (a + b + c) / 3.0, plane, size_mm, reaches: Vec::new(), rows: Vec::new() };
        let mut reached = vec![t];
        for _ in 0..RINGS {
            if grow(&mut reached, across) {
                quadratic.reaches = quadratic.reach(mesh, &reached);
                if quadratic.fit() == 3 {
                    break;
                }
            }
        }
        (!quadratic.rows.is_empty()).then_some(quadratic)
    }

    /// The points of the reached triangles besides the own corners.
    fn reach(&self, mesh: &FlatMesh, reached: &[usize]) -> Vec<Reach> {
        let mut found: Vec<u32> = Vec::new();
        for v in reached.iter().flat_map(|&t| mesh.triangles[t]) {
            if !self.plane.vertices.contains(&v.0) && !found.contains(&v.0) {
                found.push(v.0);
            }
        }
        let of_corners = self.plane.corners.map(|p| basis(self.local(p)));
        let reach = |vertex: u32| {
            let p = mesh.vertices[vertex as usize];
            let barycentric = self.plane.barycentric(p);
            let mut heights = basis(self.local(p));
            (0..3).for_each(|m| heights[m] -= (0..3).map(|k| barycentric[k] * of_corners[k][m]).sum::<f64>());
            Reach { vertex, barycentric, heights, weight: self.local(p).length_squared().powi(-2) }
        };
        found.into_iter().map(reach).collect()
    }

    fn local(&self, p: DVec2) -> DVec2 {
        (p - self.middle) / self.size_mm
    }

    /// Least squares; the number of coefficients that are determined.
    fn fit(&mut self) -> usize {
        let normal = Mat::from_fn(3, 3, |i, j| {
            self.reaches.iter().map(|r| r.weight * r.heights[i] * r.heights[j]).sum::<f64>()
        });
        let Ok(eigen) = normal.self_adjoint_eigen(Side::Lower) else { return 0 };
        let (u, s) = (eigen.U(), eigen.S().column_vector());
        let known: Vec<usize> = (0..3).filter(|&k| s[k] > DETERMINED * s[2]).collect();
        let inverse = |i: usize, j: usize| known.iter().map(|&k| u[(i, k)] * u[(j, k)] / s[k]).sum::<f64>();
        let row = |r: &Reach| {
            [0, 1, 2].map(|i| r.weight * (0..3).map(|j| inverse(i, j) * r.heights[j]).sum::<f64>())
        };
        self.rows = self.reaches.iter().map(row).collect();
        known.len()
    }

    /// Its derivative at a place.
    fn derivative(&self, at: DVec2, along: DVec2) -> Form {
        let of_corners = self.plane.corners.map(|p| basis(self.local(p)));
        let linear =
            |m: usize| (0..3).map(|k| of_corners[k][m] * self.plane.gradients[k].dot(along)).sum::<f64>();
        let slopes = basis_derivative(self.local(at), along / self.size_mm);
        let over: [f64; 3] = [0, 1, 2].map(|m| slopes[m] - linear(m));
        let mut form = self.plane.derivative(along);
        for (reach, row) in self.reaches.iter().zip(&self.rows) {
            let weight: f64 = (0..3).map(|m| over[m] * row[m]).sum();
            form.insert(reach.vertex, weight);
            for (corner, share) in self.plane.vertices.iter().zip(reach.barycentric) {
                *form.entry(*corner).or_default() -= weight * share;
            }
        }
        form
    }
}

/// The quadratics ½(ξ² + η²)/√2, ½(ξ² − η²)/√2 and ξη/√2.
fn basis(p: DVec2) -> [f64; 3] {
    [0.5 * p.length_squared(), 0.5 * (p.x * p.x - p.y * p.y), p.x * p.y].map(|q| FRAC_1_SQRT_2 * q)
}

fn basis_derivative(p: DVec2, along: DVec2) -> [f64; 3] {
    [p.dot(along), p.x * along.x - p.y * along.y, p.x * along.y + p.y * along.x].map(|q| FRAC_1_SQRT_2 * q)
}

/// Adds the neighbours of all that is reached; false if there are none.
fn grow(reached: &mut Vec<usize>, across: &[[Option<usize>; 3]]) -> bool {
    let before = reached.len();
    for k in 0..before {
        for next in across[reached[k]].into_iter().flatten() {
            if !reached.contains(&next) {
                reached.push(next);
            }
        }
    }
    reached.len() > before
}
