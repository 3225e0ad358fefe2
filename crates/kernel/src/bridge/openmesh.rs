pub(crate) use ffi::*;

#[cxx::bridge(namespace = "softfold::openmesh")]
mod ffi {
    #[namespace = "softfold"]
    unsafe extern "C++" {
        include!("softfold-kernel/src/bridge/common.rs.h");
        type FlatMesh = crate::bridge::common::FlatMesh;
    }

    struct CleanedMesh {
        positions: Vec<f64>,
        triangles: Vec<u32>,
        merged_vertices: u32,
        removed_triangles: u32,
        flipped_triangles: u32,
    }

    unsafe extern "C++" {
        include!("trycatch.h");
        include!("openmesh/read.h");
        include!("openmesh/clean.h");
        include!("openmesh/decimate.h");
        fn read(path: &str) -> Result<FlatMesh>;
        fn clean(positions: &[f64], triangles: &[u32], merge: f64) -> Result<CleanedMesh>;
        fn decimate(positions: &[f64], triangles: &[u32], max_error: f64) -> Result<FlatMesh>;
    }
}
