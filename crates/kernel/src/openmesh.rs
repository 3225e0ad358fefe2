//! Mesh files, cleaning and decimation on half-edges, by OpenMesh.

use crate::bridge::openmesh as ffi;
use crate::buffers::{MeshBuffers, MeshView, tuples};
use crate::check;
use crate::error::{KernelError, Library, Result};
use std::path::Path;

/// What [`clean`] gives.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cleaned {
    /// An oriented manifold mesh without unused vertices.
    pub mesh: MeshBuffers,
    /// How many vertices were merged into others.
    pub merged_vertices: u32,
    /// How many triangles were dropped: degenerate, double, or a third one at an edge.
    pub removed_triangles: u32,
    /// How many triangles were turned over.
    pub flipped_triangles: u32,
}

/// Reads a mesh from a PLY, OBJ, STL or OFF file, told by its extension. Polygons are triangulated; numbers are taken
/// as millimetres.
///
/// # Errors
/// A file that is missing, of another kind, damaged or without triangles.
pub fn read(path: &Path) -> Result<MeshBuffers> {
    let Some(text) = path.to_str() else { return Err(KernelError::file(path, "the path is not UTF-8")) };
    std::fs::File::open(path).map_err(|error| KernelError::file(path, error))?;
    let mesh: MeshBuffers =
        ffi::read(text).map_err(|exception| KernelError::file(path, exception.what()))?.into();
    check::mesh("openmesh::read", mesh.view()).map_err(|error| KernelError::file(path, error))?;
    Ok(mesh)
}

/// Makes an oriented manifold mesh of any triangles: merges vertices closer than `merge_mm`, drops degenerate and double
/// triangles and those an edge or a vertex has no room for, and turns triangles so that neighbours agree. Each
/// connected piece keeps the orientation of most of its triangles; a closed one is turned outward.
///
/// Dropped triangles leave holes; nothing is filled.
///
/// # Errors
/// An empty mesh, numbers that are not finite, indices out of range, no triangle left.
pub fn clean(mesh: MeshView<'_>, merge_mm: f64) -> Result<Cleaned> {
    const OPERATION: &str = "openmesh::clean";
    check::mesh(OPERATION, mesh)?;
    check::not_negative(OPERATION, "merge_mm", merge_mm)?;
    let cleaned = ffi::clean(mesh.positions.as_flattened(), mesh.triangles.as_flattened(), merge_mm)
        .map_err(Library::OpenMesh.failure(OPERATION))?;
    Ok(Cleaned {
        mesh: MeshBuffers { positions: tuples(&cleaned.positions), triangles: tuples(&cleaned.triangles) },
        merged_vertices: cleaned.merged_vertices,
        removed_triangles: cleaned.removed_triangles,
        flipped_triangles: cleaned.flipped_triangles,
    })
}

/// Fewer triangles by half-edge collapses, cheapest quadric first. Every vertex of the result is one of the input, no
/// normal turns over, and a closed manifold stays one.
///
/// The bound holds both ways: no vertex of the input is farther than `max_error_mm` from the result, and no place on
/// the result, as far as a grid of points on every triangle of every step tells, farther than that from the input.
///
/// # Errors
/// A mesh that is no oriented manifold (see [`clean`]); a bound that is not positive.
pub fn decimate(mesh: MeshView<'_>, max_error_mm: f64) -> Result<MeshBuffers> {
    const OPERATION: &str = "openmesh::decimate";
    check::mesh(OPERATION, mesh)?;
    check::positive(OPERATION, "max_error_mm", max_error_mm)?;
    ffi::decimate(mesh.positions.as_flattened(), mesh.triangles.as_flattened(), max_error_mm)
        .map(MeshBuffers::from)
        .map_err(Library::OpenMesh.failure(OPERATION))
}
