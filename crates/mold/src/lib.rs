//! From the folded sheet's surface to the things that are made: the thick [`Board`] and whether it stands, the [`Mold`]
//! with its printable parts, and the [`Waffle`] of boards that carries the mold.
//!
//! Values in, values out: no files, no printing, no clock; same input, same result, on any number of threads.
//! Lengths are mm, z is up, angles are radians unless a name says `_deg`.
//!
//! ```text
//! SheetSurface ── make_board ──► Board ── rest_of_board ──► Rest { stability, .. }
//!       └─────── make_mold ───► Mold { pose, shape, parts, waffle { boards, nest } }
//! ```
//! Inside: `samples` looks at a surface inside its trim, `top` triangulates it, `split` cuts it along the grid that
//! `grid` chose by the outline in plan and the heights in `relief`, `parts` makes solids of the pieces, `tool` makes one solid of all that is cut out of a piece.

mod board;
mod cap;
mod contour;
mod error;
mod glyphs;
mod grid;
mod ground;
mod height;
mod integral;
mod least_squares;
mod marks;
mod measure;
mod mold;
mod nest;
mod parts;
mod plan;
mod pose;
mod relief;
mod rest;
mod samples;
mod skin;
mod spline;
mod split;
mod stability;
mod tool;
mod top;
mod triangles;
mod waffle;

#[cfg(test)]
mod shapes;
#[cfg(test)]
mod stand_tests;

pub use board::{Board, BoardOptions, Placement, SkinRadius, make_board};
pub use contour::{Contour, ProfileSegment};
pub use error::MoldError;
pub use grid::{Cell, Grid};
pub use ground::{GroundTrim, trim_ground};
pub use marks::MarkOptions;
pub use measure::{Inertia, SheetIntegrals};
pub use mold::{Mold, MoldOptions, make_mold, make_mold_watched};
pub use nest::{Nest, Placed, Sheet, StockOptions, nest};
pub use parts::Part;
pub use pose::{MoldPose, PoseChoice, Undercut, find_pose};
pub use rest::{Rest, rest, rest_of_board};
pub use skin::Skin;
pub use spline::{face as sheet_face, shell as sheet_shell};
pub use stability::{Stability, stability};
pub use triangles::solid_of_skins;
pub use waffle::{DroppedBoard, Waffle, WaffleBoard, WaffleOptions};
