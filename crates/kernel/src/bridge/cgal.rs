pub(crate) use ffi::*;

#[cxx::bridge(namespace = "softfold::cgal")]
mod ffi {
    #[namespace = "softfold"]
    unsafe extern "C++" {
        include!("softfold-kernel/src/bridge/common.rs.h");
        type FlatMesh = crate::bridge::common::FlatMesh;
    }

    struct FlatTriangulation {
        points: Vec<f64>,
        triangles: Vec<u32>,
        index_of_input: Vec<u32>,
        /// Two vertices and the input constraint, per piece.
        constraints: Vec<u32>,
    }

    struct Closedness {
        closed: bool,
        manifold: bool,
        outward: bool,
        volume: f64,
    }

    unsafe extern "C++" {
        include!("trycatch.h");
        include!("cgal/constrained_delaunay.h");
        include!("cgal/convex_hull.h");
        include!("cgal/isotropic_remesh.h");
        include!("cgal/self_intersections.h");
        include!("cgal/distances_to_mesh.h");
        include!("cgal/distance_tree.h");
        include!("cgal/boolean.h");
        include!("cgal/extrude.h");
        include!("cgal/alpha_wrap.h");
        include!("cgal/closed_check.h");
        fn constrained_delaunay(points: &[f64], constraints: &[u32]) -> Result<FlatTriangulation>;
        fn convex_hull(points: &[f64]) -> Result<Vec<u32>>;
        fn isotropic_remesh(
            positions: &[f64],
            triangles: &[u32],
            target_edge: f64,
            iterations: u32,
        ) -> Result<FlatMesh>;
        fn self_intersections(positions: &[f64], triangles: &[u32]) -> Result<Vec<u32>>;
        fn distances_to_mesh(points: &[f64], positions: &[f64], triangles: &[u32]) -> Result<Vec<f64>>;
        type DistanceTree;
        fn distance_tree(positions: &[f64], triangles: &[u32]) -> Result<UniquePtr<DistanceTree>>;
        fn nearest(self: &DistanceTree, points: &[f64]) -> Result<Vec<u32>>;
        fn boolean(
            a_positions: &[f64],
            a_triangles: &[u32],
            b_positions: &[f64],
            b_triangles: &[u32],
            operation: u8,
        ) -> Result<FlatMesh>;
        fn extrude(positions: &[f64], triangles: &[u32], vector: [f64; 3]) -> Result<FlatMesh>;
        fn alpha_wrap(positions: &[f64], triangles: &[u32], alpha: f64, offset: f64) -> Result<FlatMesh>;
        fn closed_check(positions: &[f64], triangles: &[u32]) -> Result<Closedness>;
    }
}
