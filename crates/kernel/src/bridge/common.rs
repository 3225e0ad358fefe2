pub(crate) use ffi::*;

#[cxx::bridge(namespace = "softfold")]
mod ffi {
    /// A triangle mesh: x y z per vertex, three indices per triangle.
    struct FlatMesh {
        positions: Vec<f64>,
        triangles: Vec<u32>,
    }

    /// Sparse rows: row `i` is `offsets[i]..offsets[i + 1]` of `indices` and `weights`.
    struct FlatRows {
        offsets: Vec<u32>,
        indices: Vec<u32>,
        weights: Vec<f64>,
    }
}
