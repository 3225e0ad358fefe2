//! What a run found: `report.json` for programs, `report.html` for people, pictures, and the closing
//! summary on the terminal.

pub mod compare_page;
pub mod html;
pub mod json;
pub mod mesh_plan;
mod page;
pub mod picture;
pub mod plans;
pub mod summary;
pub(crate) mod words;

pub use html::{Pictures, html};
pub use json::{Report, SCHEMA};
pub use summary::summary;
