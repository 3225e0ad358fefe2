//! Why a file cannot be written.

/// A value that the wanted format cannot hold.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A coordinate is NaN or infinite.
    #[error("{what} has a coordinate that is no finite number")]
    NotFinite {
        /// The element.
        what: String,
    },
    /// A triangle that names a vertex twice, or a vertex that is not there.
    #[error(
        "triangle {triangle} of \"{object}\" has corners {corners:?}: they must be three different vertices"
    )]
    BadTriangle {
        /// The object's name.
        object: String,
        /// Number of the triangle, from 0.
        triangle: usize,
        /// Its corner indices.
        corners: [u32; 3],
    },
    /// The container of a package could not be written.
    #[error("the package could not be put together: {0}")]
    Zip(#[from] zip::result::ZipError),
    /// The compressor failed.
    #[error("the package could not be put together: {0}")]
    Io(#[from] std::io::Error),
    /// A picture of no size, or larger than PNG allows.
    #[error("the picture could not be encoded: {0}")]
    Png(#[from] png::EncodingError),
    /// A value that JSON cannot hold.
    #[error("the value does not fit into JSON: {0}")]
    Json(#[from] serde_json::Error),
}
