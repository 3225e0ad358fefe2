//! One pair that may collide, a point and a triangle or two edges, with its barrier.
//!
//! Source: Li et al., *Incremental Potential Contact* (2020), §4.1 (barrier) and §5 (mollifier of near-parallel edges);
//! the thickness as in Li, Kaufman & Jiang, *Codimensional Incremental Potential Contact* (2021), eq. 8.

use super::closest::Closest;
use crate::goal::{Curvature, cross_matrix, outer};
use glam::{DMat3, DVec3};

/// Squared sine, at rest, of the angle between two edges below which their barrier fades (Li et al. 2020, §5).
const MOLLIFIED: f64 = 1e-3;

/// What meets what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// The first corner, and the triangle of the others.
    PointTriangle,
    /// The edge of the first two corners, and that of the others.
    Edges,
}

/// The distances of a pair, mm: at the lesser the barrier is infinite, from the greater on it is nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    /// Distance that is never reached.
    pub(super) least_mm: f64,
    /// Distance at which the push begins.
    pub(super) contact_mm: f64,
    /// Distance of the two places when the sheet between them is bent by half a turn; infinite if there is none.
    pub(super) bent_mm: f64,
}

/// A pair of elements without a common vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    pub(super) corners: [u32; 4],
    pub(super) kind: Kind,
    pub(super) gap: Gap,
    /// Squared cross product below which edges count as nearly parallel, mm⁴; 0 for a point and a triangle.
    pub(super) parallel_mm4: f64,
}

/// The barrier `b(y) = −(y − 1)² ln y` with its two derivatives, y from 0 (touching) to 1 (where the push begins).
struct Barrier {
    value: f64,
    first: f64,
    second: f64,
}

/// The factor that fades the barrier of nearly parallel edges, by `c = |u × v|²`, with its derivatives.
struct Mollifier {
    value: f64,
    first: f64,
    second: f64,
}

impl Barrier {
    fn at(y: f64) -> Self {
        if y >= 1.0 {
            return Self { value: 0.0, first: 0.0, second: 0.0 };
        }
        if y <= 0.0 {
            return Self { value: f64::INFINITY, first: f64::NEG_INFINITY, second: f64::INFINITY };
        }
        let (z, ln) = (y - 1.0, y.ln());
        Self {
            value: -z * z * ln,
            first: -2.0 * z * ln - z * z / y,
            second: -2.0 * ln - 4.0 * z / y + z * z / (y * y),
        }
    }
}

impl Gap {
    /// Of places with no sheet between them.
    pub(super) fn new(least_mm: f64, contact_mm: f64) -> Self {
        Self { least_mm, contact_mm, bent_mm: f64::INFINITY }
    }

    /// The contact distance and `spare` of it more, where that is not beyond half a turn: neighbours are always so near.
    pub(super) fn within_mm(self, spare: f64) -> f64 {
        ((1.0 + spare) * self.contact_mm).min(self.bent_mm.max(self.contact_mm))
    }

    /// mm² between the squares of the two distances.
    fn width_mm2(self) -> f64 {
        (self.contact_mm - self.least_mm) * (self.contact_mm + self.least_mm)
    }

    fn barrier(self, squared_mm2: f64) -> Barrier {
        let b = Barrier::at((squared_mm2 - self.least_mm * self.least_mm) / self.width_mm2());
        let w = self.width_mm2();
        Barrier { value: b.value, first: b.first / w, second: b.second / (w * w) }
    }
}

/// Value and derivatives of a pair's barrier, by corners.
pub(super) struct Push {
    pub(super) gradient: [DVec3; 4],
    /// Stiffness that moves of eq. 4 weight each corner by.
    pub(super) weights: [f64; 4],
}

impl Pair {
    /// A pair of edges whose lengths on the flat sheet have this product, mm².
    pub(super) fn of_edges(corners: [u32; 4], gap: Gap, lengths_mm2: f64) -> Self {
        Self { corners, kind: Kind::Edges, gap, parallel_mm4: MOLLIFIED * lengths_mm2 * lengths_mm2 }
    }

    pub(super) fn of_point_triangle(corners: [u32; 4], gap: Gap) -> Self {
        Self { corners, kind: Kind::PointTriangle, gap, parallel_mm4: 0.0 }
    }

    /// How many of the corners are the first element's.
    pub(super) fn first_corners(&self) -> usize {
        match self.kind {
            Kind::PointTriangle => 1,
            Kind::Edges => 2,
        }
    }

    pub(super) fn places(&self, x: &[DVec3]) -> [DVec3; 4] {
        self.corners.map(|v| x[v as usize])
    }

    pub(super) fn closest(&self, places: &[DVec3; 4]) -> Closest {
        match self.kind {
            Kind::PointTriangle => Closest::of_point_triangle(places),
            Kind::Edges => Closest::of_edges(places),
        }
    }

    /// The distance, mm.
    pub(super) fn distance_mm(&self, x: &[DVec3]) -> f64 {
        self.closest(&self.places(x)).squared_mm2().sqrt()
    }

    fn mollifier(&self, places: &[DVec3; 4]) -> Mollifier {
        let epsilon = self.parallel_mm4;
        let c = cross(places).length_squared();
        if c >= epsilon {
            return Mollifier { value: 1.0, first: 0.0, second: 0.0 };
        }
        let share = c / epsilon;
        Mollifier {
            value: share * (2.0 - share),
            first: 2.0 * (1.0 - share) / epsilon,
            second: -2.0 / (epsilon * epsilon),
        }
    }

    /// The barrier, without its stiffness; nothing where the pair is apart.
    pub(super) fn energy(&self, x: &[DVec3]) -> f64 {
        let places = self.places(x);
        let barrier = self.gap.barrier(self.closest(&places).squared_mm2());
        if barrier.value == 0.0 {
            return 0.0;
        }
        self.mollifier(&places).value.max(f64::MIN_POSITIVE) * barrier.value
    }

    /// The barrier's gradient; none where the pair is apart.
    pub(super) fn push(&self, x: &[DVec3]) -> Option<Push> {
        let places = self.places(x);
        let closest = self.closest(&places);
        let b = self.gap.barrier(closest.squared_mm2());
        if b.value == 0.0 {
            return None;
        }
        let m = self.mollifier(&places);
        let by_distance = closest.gradient().map(|g| m.value * b.first * g);
        let (turn, c) = (cross_gradient(&places), cross(&places).length_squared());
        let by_angle = turn.map(|t| m.first * b.value * t);
        let stiffness = m.value * along(&b, closest.squared_mm2());
        let sum: f64 = closest.weights.iter().map(|w| w.abs()).sum();
        // The step along the gradient of c that would make it zero.
        let steepness: f64 = turn.iter().map(|t| t.length_squared()).sum();
        let twist = if c > 0.0 { m.first * b.value * steepness / c } else { 0.0 };
        let weights = closest.weights.map(|w| stiffness * sum * w.abs() + twist);
        Some(Push { gradient: [0, 1, 2, 3].map(|i| by_distance[i] + by_angle[i]), weights })
    }

    /// The barrier's second derivative by pairs of corners; none where the pair is apart.
    ///
    /// The convex form is Gauss-Newton's, the curvature along the line between the nearest places alone.
    pub(super) fn hessian(&self, x: &[DVec3], curvature: Curvature) -> Option<[[DMat3; 4]; 4]> {
        let places = self.places(x);
        let closest = self.closest(&places);
        let b = self.gap.barrier(closest.squared_mm2());
        if b.value == 0.0 {
            return None;
        }
        let m = self.mollifier(&places);
        let w = &closest.weights;
        if curvature == Curvature::Convex {
            let direction = closest.vector.normalize_or_zero();
            let block = m.value * along(&b, closest.squared_mm2()) * outer(direction, direction);
            return Some([0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| w[i] * w[j] * block)));
        }
        let (g, second) = (closest.gradient(), closest.hessian(&places));
        let mut h = [0, 1, 2, 3]
            .map(|i| [0, 1, 2, 3].map(|j| m.value * (b.second * outer(g[i], g[j]) + b.first * second[i][j])));
        if m.first != 0.0 {
            self.add_angle(&places, &m, &b, &g, &mut h);
        }
        Some(h)
    }

    /// What the mollifier's change adds to the Hessian.
    fn add_angle(
        &self,
        places: &[DVec3; 4],
        m: &Mollifier,
        b: &Barrier,
        g: &[DVec3; 4],
        h: &mut [[DMat3; 4]; 4],
    ) {
        let (c, second) = (cross_gradient(places), cross_hessian(places));
        for i in 0..4 {
            for j in 0..4 {
                h[i][j] += m.first * b.first * (outer(g[i], c[j]) + outer(c[i], g[j]))
                    + b.value * (m.second * outer(c[i], c[j]) + m.first * second[i][j]);
            }
        }
    }
}

/// Second derivative of the barrier by the distance itself, where positive.
fn along(b: &Barrier, squared_mm2: f64) -> f64 {
    (4.0 * squared_mm2 * b.second + 2.0 * b.first).max(0.0)
}

/// Cross product of the edges' vectors.
fn cross([a, b, c, d]: &[DVec3; 4]) -> DVec3 {
    (*b - *a).cross(*d - *c)
}

/// Derivative of `|u × v|²` by the four ends.
fn cross_gradient(x: &[DVec3; 4]) -> [DVec3; 4] {
    let (u, v, n) = (x[1] - x[0], x[3] - x[2], cross(x));
    let (by_u, by_v) = (2.0 * v.cross(n), 2.0 * n.cross(u));
    [-by_u, by_u, -by_v, by_v]
}

/// Its second derivative.
fn cross_hessian(x: &[DVec3; 4]) -> [[DMat3; 4]; 4] {
    let (u, v, n) = (x[1] - x[0], x[3] - x[2], cross(x));
    // n = u × v: ∂n/∂u = −[v]×, ∂n/∂v = [u]×.
    let (cu, cv) = (cross_matrix(u), cross_matrix(v));
    let (uu, vv) = (-2.0 * cv * cv, -2.0 * cu * cu);
    let uv = 2.0 * (cv * cu - cross_matrix(n));
    let sign = [-1.0, 1.0, -1.0, 1.0];
    let block = |i: usize, j: usize| match (i < 2, j < 2) {
        (true, true) => uu,
        (false, false) => vv,
        (true, false) => uv,
        (false, true) => uv.transpose(),
    };
    [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| sign[i] * sign[j] * block(i, j)))
}
