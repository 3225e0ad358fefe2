//! softfold: from a crease pattern with curved creases to a folded, thick, fabricable object.
//!
//! [`project`] says what is asked for, [`stages`] runs the stages in their order, [`record`] turns their results into
//! the [`report`], [`files`] writes them through [`export`] into a folder that [`output`] swaps in when it is whole.

pub mod compare;
pub mod crosscheck;
mod cuts;
pub mod diagnose;
pub mod error;
pub mod export;
pub mod files;
pub mod goals;
pub mod output;
pub mod patterns;
pub mod pictures;
pub mod progress;
pub mod project;
pub mod pyramid;
pub mod record;
pub mod report;
pub mod scan;
pub mod shape;
pub mod shape_pictures;
mod softness;
pub mod stages;
pub mod starter;
pub mod states;
mod surfaces;

pub use error::RunError;
pub use project::Project;
pub use stages::{Loaded, Results, Stage, run};
