//! Nearest points of a triangle mesh, asked for again and again: the tree is CGAL's, the foot on its triangle ours.

use crate::bridge::cgal as ffi;
use crate::buffers::MeshView;
use crate::check;
use crate::error::{Library, Result};
use cxx::UniquePtr;

/// A mesh, any set of triangles, ready to be asked for its points nearest to others.
pub struct DistanceTree {
    tree: UniquePtr<ffi::DistanceTree>,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// The point of a mesh that is nearest to another point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// The triangle it lies in; one of them where it is shared.
    pub triangle: u32,
    /// The corners' shares in it; exactly 0 for a corner that is not its own, so that two zeros are a corner and one is an
    /// edge.
    pub weights: [f64; 3],
    /// Where it is.
    pub position: [f64; 3],
}

impl DistanceTree {
    /// The tree over a mesh. Degenerate triangles are left out.
    ///
    /// # Errors
    /// A mesh in which every triangle is degenerate; numbers that are not finite, indices out of range.
    pub fn new(mesh: MeshView<'_>) -> Result<Self> {
        const OPERATION: &str = "cgal::DistanceTree::new";
        check::mesh(OPERATION, mesh)?;
        let tree = ffi::distance_tree(mesh.positions.as_flattened(), mesh.triangles.as_flattened())
            .map_err(Library::Cgal.failure(OPERATION))?;
        Ok(Self { tree, positions: mesh.positions.to_vec(), triangles: mesh.triangles.to_vec() })
    }

    /// The nearest point of the mesh for each point.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn nearest(&self, points: &[[f64; 3]]) -> Result<Vec<Foot>> {
        const OPERATION: &str = "cgal::DistanceTree::nearest";
        check::finite(OPERATION, "point", points)?;
        let found = self.tree.nearest(points.as_flattened()).map_err(Library::Cgal.failure(OPERATION))?;
        Ok(points.iter().zip(found).map(|(p, t)| self.foot(*p, t)).collect())
    }

    fn foot(&self, point: [f64; 3], triangle: u32) -> Foot {
        let corners = self.triangles[triangle as usize].map(|i| self.positions[i as usize]);
        let weights = foot_weights(point, corners);
        let position = std::array::from_fn(|k| (0..3).map(|c| weights[c] * corners[c][k]).sum());
        Foot { triangle, weights, position }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Barycentric coordinates of the point of a triangle nearest to `p`, by the regions of its corners, edges and inside
/// (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
fn foot_weights(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let along = |from: [f64; 3]| [dot(ab, minus(p, from)), dot(ac, minus(p, from))];
    let ([d1, d2], [d3, d4], [d5, d6]) = (along(a), along(b), along(c));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let mix = |t: f64| (1.0 - t, t);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let (wa, wb) = mix(d1 / (d1 - d3));
        return [wa, wb, 0.0];
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let (wa, wc) = mix(d2 / (d2 - d6));
        return [wa, 0.0, wc];
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let (wb, wc) = mix((d4 - d3) / ((d4 - d3) + (d5 - d6)));
        return [0.0, wb, wc];
    }
    let sum = va + vb + vc;
    let (wb, wc) = (vb / sum, vc / sum);
    [1.0 - wb - wc, wb, wc]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cgal;

    /// Numbers that look like chance, from −1 to 1.
    fn chance(k: usize) -> f64 {
        (12.9898 * (k as f64 + 1.0)).sin() * 43_758.545_3 % 1.0
    }

    fn points(count: usize, from: usize) -> Vec<[f64; 3]> {
        (0..count).map(|i| std::array::from_fn(|k| 100.0 * chance(from + 3 * i + k))).collect()
    }

    #[test]
    fn feet_are_as_far_as_cgal_says_and_lie_in_their_triangles() {
        let positions = points(90, 0);
        let triangles: Vec<[u32; 3]> = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = MeshView { positions: &positions, triangles: &triangles };
        let asked = points(400, 1000);
        let feet = DistanceTree::new(mesh).unwrap().nearest(&asked).unwrap();
        let distances = cgal::distances_to_mesh(&asked, mesh).unwrap();
        for ((p, foot), distance) in asked.iter().zip(&feet).zip(&distances) {
            let d = minus(*p, foot.position);
            assert!((dot(d, d).sqrt() - distance).abs() < 1e-9, "{foot:?}");
            assert!(foot.weights.iter().all(|w| (0.0..=1.0).contains(w)), "{foot:?}");
        }
        let zeros =
            |n: usize| feet.iter().filter(|f| f.weights.iter().filter(|w| **w == 0.0).count() == n).count();
        assert!(zeros(0) > 10 && zeros(1) > 10 && zeros(2) > 10, "inside, edges and corners all occur");
    }

    #[test]
    fn a_degenerate_triangle_is_never_the_nearest_and_alone_is_refused() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0, 5.0, 5.0]];
        let mesh = |triangles| MeshView { positions: &positions, triangles };
        let tree = DistanceTree::new(mesh(&[[3, 3, 3], [0, 1, 2]])).unwrap();
        assert_eq!(tree.nearest(&[[5.0, 5.0, 5.0]]).unwrap()[0].triangle, 1);
        assert!(DistanceTree::new(mesh(&[[3, 3, 3]])).is_err());
        assert!(tree.nearest(&[[f64::NAN, 0.0, 0.0]]).is_err());
    }
}
