//! Points of the sheet on a triangle mesh in space: a scan.

use super::{Attract, Nearest, Target, TargetError, outer};
use glam::{DMat3, DVec3};
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// Points pulled to the nearest place of a triangle mesh: `E = ½ k Σ |p − q(p)|²`, strength k in N/mm per point;
/// Kangaroo's *OnMesh*. On the mesh they slide freely.
pub type OnMesh = Attract<TriangleMesh>;

/// A triangle mesh in space as a target. Which way its triangles look does not matter, and it need not be closed.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    triangles: RTree<Triangle>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Triangle([DVec3; 3]);

/// What of a triangle is nearest.
enum Feature {
    Corner,
    /// An edge, by its vector.
    Edge(DVec3),
    /// The inside, by the normal.
    Face(DVec3),
}

impl TriangleMesh {
    /// A mesh by its points, mm, and the corners of its triangles. Points that no triangle uses are passed over.
    ///
    /// # Errors
    /// [`TargetError`] for no triangle, a point that is not finite, or a corner that is none.
    pub fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, TargetError> {
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(TargetError::NotFinite(i));
        }
        if triangles.is_empty() {
            return Err(TargetError::Empty { least: 1, what: "triangle" });
        }
        let corner = |triangle: usize, corner: u32| {
            let fault = TargetError::Corner { triangle, corner, points: points.len() };
            points.get(corner as usize).copied().ok_or(fault)
        };
        let triangle =
            |(t, &[a, b, c]): (usize, &[u32; 3])| Ok(Triangle([corner(t, a)?, corner(t, b)?, corner(t, c)?]));
        let triangles = triangles.iter().enumerate().map(triangle).collect::<Result<_, TargetError>>()?;
        Ok(Self { triangles: RTree::bulk_load(triangles) })
    }
}

impl Target for TriangleMesh {
    const KIND: &'static str = "OnMesh";

    fn nearest(&self, point: DVec3) -> Nearest {
        let Some(triangle) = self.triangles.nearest_neighbor(point.to_array()).filter(|_| point.is_finite())
        else {
            return Nearest { place: DVec3::NAN, hessian: DMat3::ZERO, convex: DMat3::ZERO };
        };
        let (place, feature) = triangle.nearest(point);
        let hessian = match feature {
            Feature::Corner => DMat3::IDENTITY,
            Feature::Edge(d) => DMat3::IDENTITY - outer(d, d) / d.length_squared(),
            Feature::Face(n) => outer(n, n) / n.length_squared(),
        };
        Nearest { place, hessian, convex: hessian }
    }
}

impl Triangle {
    /// The nearest place and what it is on: the foot of the perpendicular if that is inside, else on an edge.
    fn nearest(&self, point: DVec3) -> (DVec3, Feature) {
        let [a, b, c] = self.0;
        let normal = (b - a).cross(c - a);
        let area = normal.length_squared();
        let inside = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal) > 0.0;
        // A triangle without area is its edges.
        if area > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
            return (point - (point - a).dot(normal) / area * normal, Feature::Face(normal));
        }
        let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| nearest_of_segment(p, q, point));
        let [first, second, third] = edges;
        let nearer = |x: (DVec3, Feature), y: (DVec3, Feature)| {
            if y.0.distance_squared(point) < x.0.distance_squared(point) { y } else { x }
        };
        nearer(nearer(first, second), third)
    }
}

fn nearest_of_segment(p: DVec3, q: DVec3, point: DVec3) -> (DVec3, Feature) {
    let d = q - p;
    let t = (point - p).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
    match t {
        t if t <= 0.0 => (p, Feature::Corner),
        t if t >= 1.0 => (q, Feature::Corner),
        t => (p + t * d, Feature::Edge(d)),
    }
}

impl RTreeObject for Triangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(self.0.map(|p| p.to_array()).iter())
    }
}

impl PointDistance for Triangle {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from(*point);
        self.nearest(point).0.distance_squared(point)
    }
}

impl PartialEq for TriangleMesh {
    fn eq(&self, other: &Self) -> bool {
        self.triangles.iter().eq(other.triangles.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron of radius 2.
    fn octahedron() -> TriangleMesh {
        let points =
            [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].map(|p| 2.0 * p);
        let triangles =
            [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
        TriangleMesh::new(&points, &triangles).unwrap()
    }

    #[test]
    fn the_distance_from_an_octahedron_is_the_closed_form() {
        let mesh = octahedron();
        for i in 0..300 {
            let k = f64::from(i);
            let point = 5.0 * DVec3::new((1.7 * k).sin(), (2.3 * k).sin(), (3.1 * k).sin());
            // By symmetry in the first octant: sorted |coordinates| projected to the simplex of sum 2.
            let p = point.abs();
            let expected = if p.element_sum() > 2.0 {
                to_simplex(p).distance(p)
            } else {
                (2.0 - p.element_sum()) / 3f64.sqrt()
            };
            let found = mesh.nearest(point).place.distance(point);
            assert!((found - expected).abs() < 1e-12, "{point}: {found} {expected}");
        }
    }

    /// The nearest point of x + y + z = 2, x, y, z ≥ 0 (Held, Wolfe & Crowder, 1974).
    fn to_simplex(p: DVec3) -> DVec3 {
        let mut sorted = p.to_array();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let mut shift = 0.0;
        let mut sum = 0.0;
        for (k, value) in sorted.into_iter().enumerate() {
            sum += value;
            let candidate = (sum - 2.0) / (k as f64 + 1.0);
            if value > candidate {
                shift = candidate;
            }
        }
        (p - shift).max(DVec3::ZERO)
    }

    #[test]
    fn a_triangle_without_area_is_its_edges() {
        let points = [DVec3::ZERO, DVec3::X, 3.0 * DVec3::X];
        let mesh = TriangleMesh::new(&points, &[[0, 1, 2], [1, 1, 1]]).unwrap();
        let nearest = mesh.nearest(DVec3::new(2.0, 1.0, 0.0));
        assert_eq!(nearest.place, 2.0 * DVec3::X);
    }

    #[test]
    fn a_mesh_that_has_no_place_is_refused() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert!(matches!(TriangleMesh::new(&points, &[]), Err(TargetError::Empty { .. })));
        let fault = TriangleMesh::new(&points, &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert_eq!(fault, TargetError::Corner { triangle: 1, corner: 3, points: 3 });
        assert_eq!(
            TriangleMesh::new(&[DVec3::INFINITY], &[[0, 0, 0]]).unwrap_err(),
            TargetError::NotFinite(0)
        );
    }
}
