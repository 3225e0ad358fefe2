//! The nearest places of a point and a triangle, or of two edges, with the derivatives of their squared distance.
//!
//! Both are one thing: four corners with weights that add up to zero, `r = Σ wᵢ xᵢ`, where the weights are affine in the
//! places' parameters q and those minimise `|r|²`. Hence `∂|r|²/∂xᵢ = 2 wᵢ r`, and by the implicit function theorem
//! `∂²|r|²/∂xᵢ∂xⱼ = 2 (wᵢ wⱼ I − Σ aᵢₖ G⁻¹ₖₗ aⱼₗᵀ)` with `aᵢₖ = r ∂wᵢ/∂qₖ + wᵢ eₖ`, `eₖ = ∂r/∂qₖ` and `G = (eₖ·eₗ)`: one form
//! for all of the cases that Li et al. 2020 list (point-point to edge-edge).

use crate::goal::outer;
use glam::{DMat3, DVec3};

/// Squared sine of the angle between two edges below which they count as parallel: their lines' nearest places are
/// rounding there, and those of their ends as near.
const PARALLEL: f64 = 1e-12;

/// The nearest places of a pair, by the weights of its four corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    /// Weight of each corner; they add up to zero.
    pub(super) weights: [f64; 4],
    /// From the one place to the other, mm.
    pub(super) vector: DVec3,
    /// Change of the weights by each parameter that is free to move.
    slides: [Option<[f64; 4]>; 2],
}

impl Closest {
    fn new(x: &[DVec3; 4], weights: [f64; 4], slides: [Option<[f64; 4]>; 2]) -> Self {
        Self { weights, vector: combined(x, &weights), slides }
    }

    /// Of a point and a triangle: corners p, a, b, c.
    pub(super) fn of_point_triangle(x: &[DVec3; 4]) -> Self {
        let [p, a, b, c] = *x;
        let normal = (b - a).cross(c - a);
        let area = normal.length_squared();
        let shares = [(b, c), (c, a), (a, b)].map(|(q, r)| (r - q).cross(p - q).dot(normal));
        if area > 0.0 && shares.iter().all(|s| *s > 0.0) {
            let [wa, wb, wc] = shares.map(|s| s / shares.iter().sum::<f64>());
            let slides = [Some([0.0, 1.0, -1.0, 0.0]), Some([0.0, 1.0, 0.0, -1.0])];
            return Self::new(x, [1.0, -wa, -wb, -wc], slides);
        }
        nearest([[1, 2], [2, 3], [3, 1]].map(|edge| Self::of_point_edge(x, 0, edge, -1.0)))
    }

    /// Of two edges: corners a, b and c, d.
    pub(super) fn of_edges(x: &[DVec3; 4]) -> Self {
        let [a, b, c, d] = *x;
        let (u, v, r) = (b - a, d - c, a - c);
        let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
        let sine = uu * vv - uv * uv;
        if sine > PARALLEL * uu * vv {
            let s = (uv * v.dot(r) - vv * u.dot(r)) / sine;
            let t = (uu * v.dot(r) - uv * u.dot(r)) / sine;
            if s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0 {
                let slides = [Some([-1.0, 1.0, 0.0, 0.0]), Some([0.0, 0.0, 1.0, -1.0])];
                return Self::new(x, [1.0 - s, s, t - 1.0, -t], slides);
            }
        }
        nearest(
            [(0, [2, 3], -1.0), (1, [2, 3], -1.0), (2, [0, 1], 1.0), (3, [0, 1], 1.0)]
                .map(|(point, edge, sign)| Self::of_point_edge(x, point, edge, sign)),
        )
    }

    /// Of corner `point` and the edge between two others, which has the weights' sign `sign`.
    fn of_point_edge(x: &[DVec3; 4], point: usize, [i, j]: [usize; 2], sign: f64) -> Self {
        let along = x[j] - x[i];
        let t = (x[point] - x[i]).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        let mut weights = [0.0; 4];
        weights[point] = -sign;
        let mut slide = [0.0; 4];
        (slide[i], slide[j]) = (-sign, sign);
        let inside = t > 0.0 && t < 1.0;
        let t = t.clamp(0.0, 1.0);
        (weights[i], weights[j]) = (sign * (1.0 - t), sign * t);
        Self::new(x, weights, [inside.then_some(slide), None])
    }

    /// Squared distance, mm².
    pub(super) fn squared_mm2(&self) -> f64 {
        self.vector.length_squared()
    }

    /// Derivative of the squared distance by each corner.
    pub(super) fn gradient(&self) -> [DVec3; 4] {
        self.weights.map(|w| 2.0 * w * self.vector)
    }

    /// Second derivative of the squared distance by each pair of corners.
    pub(super) fn hessian(&self, x: &[DVec3; 4]) -> [[DMat3; 4]; 4] {
        let w = &self.weights;
        let mut h = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| 2.0 * w[i] * w[j] * DMat3::IDENTITY));
        let slides: Vec<[f64; 4]> = self.slides.into_iter().flatten().collect();
        let ways: Vec<DVec3> = slides.iter().map(|s| combined(x, s)).collect();
        let inverse = inverse_gram(&ways);
        let a = |i: usize, k: usize| slides[k][i] * self.vector + w[i] * ways[k];
        for (i, row) in h.iter_mut().enumerate() {
            for (j, block) in row.iter_mut().enumerate() {
                for k in 0..slides.len() {
                    for l in 0..slides.len() {
                        *block -= 2.0 * inverse[k][l] * outer(a(i, k), a(j, l));
                    }
                }
            }
        }
        h
    }
}

fn combined(x: &[DVec3; 4], weights: &[f64; 4]) -> DVec3 {
    x.iter().zip(weights).map(|(x, w)| *w * *x).sum()
}

fn nearest<const N: usize>(candidates: [Closest; N]) -> Closest {
    let mut least = &candidates[0];
    for c in &candidates[1..] {
        if c.squared_mm2() < least.squared_mm2() {
            least = c;
        }
    }
    *least
}

/// Inverse of the matrix of the products of up to two vectors.
fn inverse_gram(e: &[DVec3]) -> [[f64; 2]; 2] {
    match e {
        [e] => [[1.0 / e.length_squared().max(f64::MIN_POSITIVE), 0.0], [0.0; 2]],
        [e, f] => {
            let (ee, ff, ef) = (e.length_squared(), f.length_squared(), e.dot(*f));
            let det = e.cross(*f).length_squared().max(f64::MIN_POSITIVE);
            [[ff / det, -ef / det], [-ef / det, ee / det]]
        }
        _ => [[0.0; 2]; 2],
    }
}
