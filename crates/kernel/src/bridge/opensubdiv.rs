pub(crate) use ffi::*;

#[cxx::bridge(namespace = "softfold::opensubdiv")]
mod ffi {
    #[namespace = "softfold"]
    unsafe extern "C++" {
        include!("softfold-kernel/src/bridge/common.rs.h");
        type FlatRows = crate::bridge::common::FlatRows;
    }

    struct FlatStencils {
        offsets: Vec<u32>,
        indices: Vec<u32>,
        weights: Vec<f64>,
        weights_s: Vec<f64>,
        weights_t: Vec<f64>,
    }

    struct FlatPatches {
        /// 16 per patch.
        control_points: Vec<u32>,
        quads: Vec<u32>,
        /// s, t and size per patch.
        domains: Vec<f64>,
        local_points: FlatRows,
    }

    unsafe extern "C++" {
        include!("trycatch.h");
        include!("opensubdiv/limit_stencils.h");
        include!("opensubdiv/bspline_patches.h");
        /// Samples must come grouped by quad: `quads[i]` not descending.
        fn limit_stencils(vertex_count: u32, cage: &[u32], quads: &[u32], st: &[f64])
        -> Result<FlatStencils>;
        fn bspline_patches(vertex_count: u32, cage: &[u32], isolation: u32) -> Result<FlatPatches>;
    }
}
