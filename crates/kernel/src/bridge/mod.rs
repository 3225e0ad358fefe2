//! The private bridges. Every function that crosses returns `Result`: without it C++ throwing ends the process.
#![allow(unsafe_code)] // cxx declares C++ functions in `unsafe extern` blocks
#![allow(unreachable_pub)] // cxx makes everything in a bridge `pub`

pub(crate) mod cgal;
pub(crate) mod common;
pub(crate) mod occt;
pub(crate) mod openmesh;
pub(crate) mod opensubdiv;
