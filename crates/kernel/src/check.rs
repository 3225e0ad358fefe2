//! What the safe modules refuse before C++ sees it.

use crate::buffers::MeshView;
use crate::error::{KernelError, Result};

/// Refuses numbers that are not finite; `what` names the array, the message the row.
pub(crate) fn finite<const N: usize>(operation: &'static str, what: &str, rows: &[[f64; N]]) -> Result<()> {
    match rows.iter().position(|row| !row.iter().all(|x| x.is_finite())) {
        None => Ok(()),
        Some(i) => Err(KernelError::input(operation, format!("{what} {i} is not finite: {:?}", rows[i]))),
    }
}

/// Refuses rows that point past the end of an array of `count` elements.
pub(crate) fn indices<const N: usize>(
    operation: &'static str,
    what: &str,
    rows: &[[u32; N]],
    count: usize,
) -> Result<()> {
    match rows.iter().position(|row| row.iter().any(|&i| i as usize >= count)) {
        None => Ok(()),
        Some(i) => {
            let row = rows[i];
            Err(KernelError::input(operation, format!("{what} {i} {row:?} points past the {count} vertices")))
        }
    }
}

/// Refuses an array that 32-bit indices of C++ cannot address.
pub(crate) fn addressable(operation: &'static str, what: &str, count: usize) -> Result<()> {
    let limit = i32::MAX as usize;
    require(operation, count < limit, || format!("{count} {what} are too many (limit {limit})"))
}

/// Refuses a mesh that is empty, not finite, or has triangles that point nowhere.
pub(crate) fn mesh(operation: &'static str, mesh: MeshView<'_>) -> Result<()> {
    require(operation, !mesh.triangles.is_empty(), || "the mesh has no triangles".into())?;
    addressable(operation, "vertices", mesh.positions.len())?;
    addressable(operation, "triangles", mesh.triangles.len())?;
    finite(operation, "vertex", mesh.positions)?;
    indices(operation, "triangle", mesh.triangles, mesh.positions.len())
}

/// Refuses a length that is not a positive number.
pub(crate) fn positive(operation: &'static str, what: &str, value: f64) -> Result<()> {
    require(operation, value.is_finite() && value > 0.0, || format!("{what} must be above 0, not {value}"))
}

/// Refuses a length that is negative or no number.
pub(crate) fn not_negative(operation: &'static str, what: &str, value: f64) -> Result<()> {
    require(operation, value.is_finite() && value >= 0.0, || {
        format!("{what} must not be below 0, not {value}")
    })
}

/// Refuses a vector of no length.
pub(crate) fn vector(operation: &'static str, what: &str, vector: [f64; 3]) -> Result<()> {
    finite(operation, what, &[vector])?;
    require(operation, vector != [0.0; 3], || format!("{what} is zero"))
}

/// An error with `message` unless `holds`.
pub(crate) fn require(operation: &'static str, holds: bool, message: impl FnOnce() -> String) -> Result<()> {
    if holds { Ok(()) } else { Err(KernelError::input(operation, message())) }
}
