//! Edges turn by their rest angles: bending and fold lines.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, cross_matrix, outer};
use glam::{DMat3, DVec3};
use softfold_geometry::{Edge, EdgeId, FlatMesh};
use std::f64::consts::{PI, TAU};

/// `E = Σ ½ κ (θ − θ₀)²` over interior edges, N·mm, with the angle error wrapped to (−π, π];
/// Kangaroo's *Hinge*. θ is the turn at the edge, + valley. Derivatives after Tamstorf & Grinspun,
/// *Discrete bending forces and their Jacobians* (2013), in a form that differentiates the heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Hinges {
    name: String,
    hinges: Vec<Hinge>,
}

/// One hinge: the edge `vertices[0]`–`vertices[1]`, the corner to its left and the one to its right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hinge {
    /// Edge start, edge end, left corner, right corner.
    pub vertices: [u32; 4],
    /// Rest turn, rad.
    pub rest_rad: f64,
    /// Stiffness, N·mm per rad².
    pub stiffness: f64,
}

/// Turn at a hinge with its derivatives by the four corners.
struct Turn {
    angle: f64,
    gradient: [DVec3; 4],
}

/// One wing of the hinge: gradient of θ by its tip, and where the tip's foot falls on the edge.
struct Lever {
    tip_gradient: DVec3,
    foot: f64,
}

/// A wing with its second derivatives.
struct Wing {
    lever: Lever,
    /// Derivative of `tip_gradient` by edge vector and tip vector.
    by_edge: DMat3,
    by_tip: DMat3,
    /// Derivative of `foot` by edge vector and tip vector.
    foot_by_edge: DVec3,
    foot_by_tip: DVec3,
}

impl Hinges {
    /// Hinges on the interior edges that `rest_and_stiffness` accepts: rest turn in rad, N·mm/rad².
    pub fn of_mesh(
        mesh: &FlatMesh,
        name: &str,
        rest_and_stiffness: impl Fn(EdgeId, &Edge) -> Option<(f64, f64)>,
    ) -> Self {
        let hinge = |(i, edge): (usize, &Edge)| {
            let [left, right] = [edge.triangles[0]?, edge.triangles[1]?];
            let (rest_rad, stiffness) = rest_and_stiffness(EdgeId::new(i), edge)?;
            let tips = [left, right].map(|t| mesh.opposite(t, edge.vertices).0);
            let [a, b] = edge.vertices.map(|v| v.0);
            Some(Hinge { vertices: [a, b, tips[0], tips[1]], rest_rad, stiffness })
        };
        Self { name: name.to_owned(), hinges: mesh.edges.iter().enumerate().filter_map(hinge).collect() }
    }
}

impl Hinge {
    fn corners(&self, x: &[DVec3]) -> [DVec3; 4] {
        self.vertices.map(|v| x[v as usize])
    }

    fn angle(&self, x: &[DVec3]) -> f64 {
        let [a, b, l, r] = self.corners(x);
        let e = b - a;
        let (left, right) = (e.cross(l - a), (r - a).cross(e));
        // Common factors of sine and cosine cancel in atan2.
        (right.cross(left).dot(e) / e.length().max(f64::MIN_POSITIVE)).atan2(left.dot(right))
    }

    fn error(&self, x: &[DVec3]) -> f64 {
        wrapped(self.angle(x) - self.rest_rad)
    }

    fn turn(&self, x: &[DVec3]) -> Turn {
        let [a, b, l, r] = self.corners(x);
        let levers = [lever(b - a, l - a, 1.0), lever(b - a, r - a, -1.0)];
        Turn { angle: self.angle(x), gradient: gradient_of(&levers) }
    }

    /// Second derivative of θ: block [i][j] by corners i and j.
    fn turn_hessian(&self, x: &[DVec3]) -> [[DMat3; 4]; 4] {
        let mut h = [[DMat3::ZERO; 4]; 4];
        let [a, b, l, r] = self.corners(x);
        for (k, w) in [wing(b - a, l - a, 1.0), wing(b - a, r - a, -1.0)].iter().enumerate() {
            let (tip, Lever { tip_gradient, foot }) = (2 + k, &w.lever);
            // The edge vector is x₁ − x₀, the tip vector x_tip − x₀.
            let by = [(0, -w.by_edge - w.by_tip), (1, w.by_edge), (tip, w.by_tip)];
            let foot_by = [-w.foot_by_edge - w.foot_by_tip, w.foot_by_edge, w.foot_by_tip];
            for ((j, tip_by), foot_by) in by.into_iter().zip(foot_by) {
                let shift = outer(*tip_gradient, foot_by);
                h[tip][j] += tip_by;
                h[0][j] -= (1.0 - foot) * tip_by - shift;
                h[1][j] -= *foot * tip_by + shift;
            }
        }
        h
    }
}

/// `side` is +1 for the left wing, whose normal is edge × tip, −1 for the right one.
fn lever(edge: DVec3, tip: DVec3, side: f64) -> Lever {
    let length = edge.length();
    let normal = side * edge.cross(tip);
    let over = normal / normal.length_squared().max(f64::MIN_POSITIVE);
    Lever { tip_gradient: length * over, foot: tip.dot(edge) / (length * length) }
}

/// As [`lever`], with the second derivatives.
fn wing(edge: DVec3, tip: DVec3, side: f64) -> Wing {
    let length = edge.length();
    let normal = side * edge.cross(tip);
    let area2 = normal.length_squared().max(f64::MIN_POSITIVE);
    let over = normal / area2;
    // d(n/|n|²) = M dn
    let m = (DMat3::IDENTITY - 2.0 * outer(normal, normal) / area2) / area2;
    let lever = lever(edge, tip, side);
    let foot = lever.foot;
    Wing {
        lever,
        by_edge: outer(over, edge / length) - side * length * m * cross_matrix(tip),
        by_tip: side * length * m * cross_matrix(edge),
        foot_by_edge: (tip - 2.0 * foot * edge) / (length * length),
        foot_by_tip: edge / (length * length),
    }
}

/// The edge's ends take up what the tips do, by the lever rule (no net force or moment).
fn gradient_of(levers: &[Lever; 2]) -> [DVec3; 4] {
    let [l, r] = levers;
    [
        -(1.0 - l.foot) * l.tip_gradient - (1.0 - r.foot) * r.tip_gradient,
        -l.foot * l.tip_gradient - r.foot * r.tip_gradient,
        l.tip_gradient,
        r.tip_gradient,
    ]
}

/// An angle in (−π, π].
fn wrapped(angle: f64) -> f64 {
    let a = angle.rem_euclid(TAU);
    if a > PI { a - TAU } else { a }
}

impl Goal for Hinges {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "Hinge"
    }

    fn part(&self) -> Part {
        Part::Bending
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.hinges.iter().map(|h| h.vertices.to_vec()).collect()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        self.hinges.iter().map(|h| 0.5 * h.stiffness * h.error(x).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        for h in &self.hinges {
            let turn = h.turn(x);
            let moment = h.stiffness * wrapped(turn.angle - h.rest_rad);
            h.vertices.iter().zip(turn.gradient).for_each(|(&v, g)| out.add(v, moment * g));
        }
    }

    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>) {
        for h in &self.hinges {
            let turn = h.turn(x);
            let moment = h.stiffness * wrapped(turn.angle - h.rest_rad);
            let second = (curvature == Curvature::Exact).then(|| h.turn_hessian(x));
            for i in 0..4 {
                for j in (0..4).filter(|&j| h.vertices[j] <= h.vertices[i]) {
                    let mut block = h.stiffness * outer(turn.gradient[i], turn.gradient[j]);
                    if let Some(second) = &second {
                        block += moment * second[i][j];
                    }
                    out.add(h.vertices[i], h.vertices[j], block);
                }
            }
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        for h in &self.hinges {
            let turn = h.turn(x);
            let steepness: f64 = turn.gradient.iter().map(|g| g.length_squared()).sum();
            if steepness == 0.0 {
                continue; // both wings without area: nothing turns
            }
            // The shortest motion that, to first order, gives the rest angle.
            let reach = wrapped(turn.angle - h.rest_rad) / steepness;
            h.vertices
                .iter()
                .zip(turn.gradient)
                .for_each(|(&v, g)| out.add(v, h.stiffness * steepness, -reach * g));
        }
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        self.hinges.iter().map(|h| h.error(x).abs()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hinge(rest_rad: f64) -> Hinge {
        Hinge { vertices: [2, 0, 3, 1], rest_rad, stiffness: 3.0 }
    }

    fn goal(rest_rad: f64) -> Box<dyn Goal> {
        Box::new(Hinges { name: "test".into(), hinges: vec![hinge(rest_rad)] })
    }

    /// Vertex 2 and 0 are the edge, 3 the left tip, 1 the right tip, at turn `angle`.
    fn folded(angle: f64) -> [DVec3; 4] {
        let (s, c) = (0.5 * angle).sin_cos();
        let (edge0, edge1) = (DVec3::new(0.1, -1.0, 0.2), DVec3::new(0.1, 1.3, 0.2));
        let left = edge0 + DVec3::new(-0.9 * c, 0.4, 0.9 * s);
        let right = edge0 + DVec3::new(1.2 * c, 1.9, 1.2 * s);
        [edge1, right, edge0, left]
    }

    #[test]
    fn angle_is_the_turn_from_minus_179_to_179() {
        for degrees in -179..=179 {
            let turn = f64::from(degrees).to_radians();
            assert!((hinge(0.0).angle(&folded(turn)) - turn).abs() < 1e-12, "{degrees}");
        }
    }

    #[test]
    fn derivatives_over_the_whole_range() {
        for degrees in (-179..=179).step_by(17) {
            let turn = f64::from(degrees).to_radians();
            super::super::testing::prove(goal(0.6 * turn), &folded(turn), 1e-5);
        }
    }

    #[test]
    fn derivatives_on_a_thin_triangle() {
        let mut x = folded(0.8);
        x[3] = x[2].lerp(x[3], 0.1);
        super::super::testing::prove(goal(0.3), &x, 1e-4);
    }

    #[test]
    fn the_error_wraps_through_pi() {
        let x = folded(179f64.to_radians());
        let h = hinge(-179f64.to_radians());
        assert!((h.error(&x).abs() - 2f64.to_radians()).abs() < 1e-9);
    }

    #[test]
    fn the_hessian_is_symmetric() {
        let h = hinge(0.0).turn_hessian(&folded(1.1));
        for i in 0..4 {
            for j in 0..4 {
                let d = h[i][j] - h[j][i].transpose();
                assert!(d.to_cols_array().iter().all(|v| v.abs() < 1e-12));
            }
        }
    }
}
