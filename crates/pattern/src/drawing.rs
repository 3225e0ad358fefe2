//! What every reader makes of its file: strokes with roles, in mm with v up.

use crate::error::Origin;
use softfold_geometry::{Role, Segment};

/// A drawn element with a role.
#[derive(Clone, Debug)]
pub(crate) struct Stroke {
    /// What it is.
    pub(crate) role: Role,
    /// Signed fold angle, where the file says.
    pub(crate) fold_angle_rad: Option<f64>,
    /// The element.
    pub(crate) origin: Origin,
    /// Its subpaths in (u, v); never empty.
    pub(crate) pieces: Vec<Vec<Segment>>,
}
