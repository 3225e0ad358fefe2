//! Points of the sheet in one plane, wherever that is.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part, outer};
use crate::SheetPoint;
use faer::{Mat, Side};
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;

/// `E = ½ k Σ ((pᵢ − c)·n)² = ½ k λ`, N·mm, with c the middle of the points and n, λ the eigenvector and smallest
/// eigenvalue of `Σ (pᵢ − c)(pᵢ − c)ᵀ`: the plane is the one that fits best; Kangaroo's *CoPlanar*. Strength k in N/mm
/// per point.
///
/// The plane follows the points, which does not change the gradient `k hᵢ n` (n minimises the energy). In the Hessian it
/// couples all points; above [`COUPLED_POINTS`] the matrix leaves that out and takes the plane as fixed, which is
/// positive and only slower.
#[derive(Clone, Debug, PartialEq)]
pub struct CoPlanar {
    /// Name for the report.
    pub name: String,
    /// The points of the sheet; up to three are always coplanar.
    pub points: Vec<SheetPoint>,
    /// Stiffness per point, N/mm.
    pub stiffness: f64,
}

/// Most points whose coupling is written into the matrix: their block is full, (3 · 3 · 200)² entries at most.
pub const COUPLED_POINTS: usize = 200;

/// Eigenvalues nearer together than this, relative to the largest, leave the plane undetermined between them (points
/// on a line): how it then turns is left out.
const DISTINCT: f64 = 1e-12;

/// The plane that fits best.
struct Plane {
    normal: DVec3,
    /// Smallest eigenvalue: sum of the squared heights, mm².
    least: f64,
    /// The directions in the plane with their eigenvalues.
    axes: [(DVec3, f64); 2],
    /// Points from their middle.
    from_middle: Vec<DVec3>,
}

impl Plane {
    fn height_mm(&self, i: usize) -> f64 {
        self.from_middle[i].dot(self.normal)
    }
}

/// Per vertex a sum over its points.
type Sums = BTreeMap<u32, DVec3>;

impl CoPlanar {
    fn plane(&self, x: &[DVec3]) -> Plane {
        let places: Vec<DVec3> = self.points.iter().map(|p| p.position(x)).collect();
        let middle = places.iter().sum::<DVec3>() / places.len().max(1) as f64;
        let from_middle: Vec<DVec3> = places.into_iter().map(|p| p - middle).collect();
        let spread = from_middle.iter().fold(DMat3::ZERO, |m, &q| m + outer(q, q));
        let [(normal, least), first, second] = eigen(spread);
        Plane { normal, least, axes: [first, second], from_middle }
    }

    fn coupled(&self) -> bool {
        self.points.len() <= COUPLED_POINTS
    }

    /// `Σ wᵢᵥ rᵢ` per vertex v over its points i, with r given per point.
    fn per_vertex(&self, of_point: impl Fn(usize) -> DVec3) -> Sums {
        let mut sums = Sums::new();
        for (i, point) in self.points.iter().enumerate() {
            let r = of_point(i);
            point.corners().for_each(|(v, w)| *sums.entry(v).or_insert(DVec3::ZERO) += w * r);
        }
        sums
    }

    /// What the plane gives way when the points move: it shifts along with them, and it turns about its two axes, by
    /// second-order perturbation of the eigenvalue.
    fn giving_way(&self, plane: &Plane, curvature: Curvature) -> Vec<Sums> {
        let count = self.points.len().max(1) as f64;
        let mut sums = vec![self.per_vertex(|_| plane.normal / count.sqrt())];
        let largest = plane.axes[1].1;
        // Gauss-Newton (Kaufman's form of variable projection): as if the points were in the plane already.
        let heights = if curvature == Curvature::Exact { 1.0 } else { 0.0 };
        for (axis, value) in plane.axes {
            let gap = value - heights * plane.least;
            if gap > DISTINCT * largest {
                let turn = |i: usize| {
                    heights * plane.height_mm(i) * axis + plane.from_middle[i].dot(axis) * plane.normal
                };
                sums.push(self.per_vertex(|i| turn(i) / gap.sqrt()));
            }
        }
        sums
    }
}

/// Eigenvectors with their eigenvalues, smallest first; NaN of a matrix that is not finite.
fn eigen(m: DMat3) -> [(DVec3, f64); 3] {
    let matrix = Mat::from_fn(3, 3, |i, j| m.col(j)[i]);
    match matrix.self_adjoint_eigen(Side::Lower) {
        Ok(found) if m.is_finite() => {
            let (u, s) = (found.U(), found.S().column_vector());
            [0, 1, 2].map(|k| (DVec3::new(u[(0, k)], u[(1, k)], u[(2, k)]), s[k].max(0.0)))
        }
        _ => [(DVec3::NAN, f64::NAN); 3],
    }
}

impl Goal for CoPlanar {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "CoPlanar"
    }

    fn part(&self) -> Part {
        Part::Hold
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        match self.coupled() {
            true => vec![self.per_vertex(|_| DVec3::ZERO).into_keys().collect()],
            false => self.points.iter().map(|p| p.vertices().to_vec()).collect(),
        }
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        let plane = self.plane(x);
        // More exact than the eigenvalue, which carries the rounding of the largest one.
        (0..self.points.len()).map(|i| 0.5 * self.stiffness * plane.height_mm(i).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        let plane = self.plane(x);
        for (i, point) in self.points.iter().enumerate() {
            let force = self.stiffness * plane.height_mm(i) * plane.normal;
            point.corners().for_each(|(v, w)| out.add(v, w * force));
        }
    }

    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>) {
        let plane = self.plane(x);
        let block = self.stiffness * outer(plane.normal, plane.normal);
        for point in &self.points {
            point.add_pairs(|i, j, w| out.add(i, j, w * block));
        }
        if !self.coupled() {
            return;
        }
        for sums in self.giving_way(&plane, curvature) {
            for (&i, &ri) in &sums {
                for (&j, &rj) in sums.range(..=i) {
                    out.add(i, j, -self.stiffness * outer(ri, rj));
                }
            }
        }
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        let plane = self.plane(x);
        for (i, point) in self.points.iter().enumerate() {
            let step = -plane.height_mm(i) * plane.normal;
            point.corners().for_each(|(v, w)| out.add(v, w * self.stiffness, step));
        }
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        let plane = self.plane(x);
        (0..self.points.len()).map(|i| plane.height_mm(i).abs()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_vertices(count: u32) -> CoPlanar {
        let points = (0..count).map(|v| SheetPoint::new([v; 3], [1.0, 0.0, 0.0])).collect();
        CoPlanar { name: "rim".into(), points, stiffness: 2.0 }
    }

    #[test]
    fn four_corners_of_a_bent_square_have_the_energy_of_their_heights() {
        let x = [(1., 1., 0.3), (-1., 1., -0.3), (-1., -1., 0.3), (1., -1., -0.3)].map(DVec3::from);
        let goal = at_vertices(4);
        assert!((goal.energy(&x) - 0.5 * 2.0 * 4.0 * 0.09).abs() < 1e-14);
        assert!((goal.residual(&x) - 0.3).abs() < 1e-14);
    }

    #[test]
    fn points_in_any_plane_and_on_a_line_have_none() {
        let (u, v) = (DVec3::new(1., 2., 3.), DVec3::new(-2., 0.5, 1.));
        let place = |i: f64| 7.0 * DVec3::ONE + (1.3 * i).sin() * u + (2.9 * i).cos() * v;
        let planar: Vec<DVec3> = (0..9).map(|i| place(f64::from(i))).collect();
        let line: Vec<DVec3> = (0..9).map(|i| f64::from(i) * u).collect();
        for x in [planar, line] {
            assert!(at_vertices(9).energy(&x) < 1e-26);
        }
    }

    #[test]
    fn many_points_are_not_coupled_but_keep_their_gradient() {
        let count = COUPLED_POINTS as u32 + 1;
        let goal = at_vertices(count);
        assert_eq!(goal.couplings().len(), count as usize);
        assert_eq!(at_vertices(count - 1).couplings().len(), 1);
    }
}
