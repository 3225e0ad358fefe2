//! Writers of files: every function takes values and gives text or bytes; none touches a file.
//!
//! All lengths are written in millimetres. Same input, same bytes: no clock, no random ids, one way to
//! print a number.

pub mod dxf;
mod error;
pub mod fold;
mod lines;
pub mod obj;
pub mod off;
pub mod ply;
pub mod stl;
pub mod svg;
pub mod threemf;

pub use error::ExportError;
pub use softfold_geometry::text::{escape_xml, number};
