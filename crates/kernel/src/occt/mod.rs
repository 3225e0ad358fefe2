//! B-spline faces, solids, their booleans, measures and STEP files, by OpenCascade.
//!
//! Nothing here prints. Shapes are opencascade-sys's `TopoDS_Shape`; what can throw goes through this crate's own
//! bridge, because that crate's calls end the process when OpenCascade throws.

mod query;
mod shape;
mod solid;
mod step;
mod surface;

pub use crate::buffers::BooleanOperation;
pub use query::{Counts, MassProperties, area, check, counts, mass_properties, triangulate};
pub use shape::{Shape, ShapeKind};
pub use solid::{boolean, extruded_polygon, prism, transformed};
pub use step::{NamedShape, ReadPart, StepOptions, StepSchema, read_step, write_step};
pub use surface::{BsplineSurface, TrimCurve, board_solid, surface_at, trimmed_face};

/// OpenCascade's version, `7.6.3` for example; empty if it cannot be told.
pub fn version() -> String {
    crate::bridge::occt::version().unwrap_or_default()
}
