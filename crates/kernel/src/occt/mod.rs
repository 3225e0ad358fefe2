//! B-spline faces, solids, their booleans, measures, and STEP, IGES and BREP files, by OpenCascade.
//!
//! Nothing here prints. Shapes are opencascade-sys's `TopoDS_Shape`; what can throw goes through this crate's own
//! bridge, because that crate's calls end the process when OpenCascade throws.

mod other_files;
mod part21;
mod query;
mod shape;
mod sheet_shell;
mod shell;
mod solid;
mod step;
mod surface;

pub use crate::buffers::BooleanOperation;
pub use other_files::{IgesOptions, read_brep, read_iges, write_brep, write_iges};
pub use query::{
    Counts, Inertia, MassProperties, area, check, counts, inertia, largest_tolerance_mm, mass_properties,
    triangulate,
};
pub use shape::{Shape, ShapeKind};
pub use sheet_shell::{ShellTopology, sheet_shell};
pub use shell::{ShellEdge, ShellFace, ShellUse, shell};
pub use solid::{boolean, extruded_polygon, faceted, prism, transformed};
pub use step::{
    Material, NamedShape, ReadMaterial, ReadPart, StepOptions, StepSchema, read_step, write_step,
};
pub use surface::{BsplineSurface, TrimCurve, board_solid, surface_at, trimmed_face};

/// OpenCascade's version, `7.6.3` for example; empty if it cannot be told.
pub fn version() -> String {
    crate::bridge::occt::version().unwrap_or_default()
}
