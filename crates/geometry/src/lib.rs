//! The values that travel through softfold: ids, tolerances, planar curves, patterns, meshes and
//! the sheet surface. No files, no printing, no clock, no foreign code.
//!
//! Units: lengths are `f64` millimetres, angles `f64` radians. The flat sheet's coordinates are
//! called `(u, v)`: `u` to the right and `v` up as one looks at the pattern; the sheet's normal
//! points at the onlooker. They are the parameters of everything that follows.

pub mod check;
pub mod curve;
pub mod id;
pub mod mesh;
pub mod pattern;
pub mod polygon;
pub mod pose;
pub mod sheet;
pub mod shell;
pub mod soft;
pub mod solid;
pub mod surface;
pub mod text;
pub mod tolerance;

pub use check::{CheckError, Issue, Severity};
pub use curve::{CurveError, PlanarCurve, Segment};
pub use glam::{DMat3, DVec2, DVec3};
pub use id::{CreaseId, EdgeId, LoopId, TriangleId, VertexId};
pub use mesh::{Edge, EdgeClass, FlatMesh, Site};
pub use pattern::{Crease, CreaseEnd, CreasePattern, Junction, Role, Source};
pub use pose::RigidTransform;
pub use sheet::{Extreme, FoldedSheet, LevelRecord, SolveRecord};
pub use shell::{EdgeUse, SheetShell, ShellEdge, ShellEdgeKind, ShellFace};
pub use soft::{Band, FoldLine, JunctionRegion, LineEnd, OutlinePoint, SoftPattern, Softness};
pub use solid::TriMesh;
pub use surface::{Deviation, SheetSurface, SurfacePoint, UniformBicubic};
pub use tolerance::Tolerance;
