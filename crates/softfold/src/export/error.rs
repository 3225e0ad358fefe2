//! Why a file cannot be written.

/// A value that the wanted format cannot hold.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// An entity of a drawing lies on a layer that the drawing does not declare.
    #[error(
        "DXF entity {entity} lies on the layer \"{layer}\", which the drawing does not declare; add it to the layers"
    )]
    UnknownLayer {
        /// Number of the entity, from 0.
        entity: usize,
        /// The layer's name.
        layer: String,
    },
    /// Two layers of a drawing have one name.
    #[error("the DXF layer \"{layer}\" is declared twice; declare it once")]
    DoubleLayer {
        /// The layer's name.
        layer: String,
    },
    /// A polyline with fewer points than it needs.
    #[error("DXF polyline {entity} on layer \"{layer}\" has {vertices} vertices; it needs two or more")]
    ShortPolyline {
        /// Number of the entity, from 0.
        entity: usize,
        /// The layer's name.
        layer: String,
        /// Vertices it has.
        vertices: usize,
    },
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
