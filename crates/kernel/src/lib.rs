//! Safe doors to the C++ libraries: CGAL, OpenSubdiv, OpenMesh and OpenCascade.
//!
//! This is the only crate of the workspace with `cxx` and `unsafe`. Plain arrays go in and come out; one call is one
//! whole operation; every call returns a [`Result`], and no C++ exception ends the process. Lengths are millimetres,
//! angles radians.
//!
//! Three layers, each knowing only the next: the safe modules here, the private bridges in `bridge/`, and one C++ file
//! per operation in `cpp/`.

mod bridge;
mod buffers;
mod check;
mod error;
mod mesh_file;
mod nearest;
mod ply_file;

pub mod cgal;
pub mod occt;
pub mod openmesh;
pub mod opensubdiv;

pub use buffers::{BooleanOperation, MeshBuffers, MeshView};
pub use error::{KernelError, Library, Result};
