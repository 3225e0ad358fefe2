//! Mesh files, cleaning and decimation on half-edges, by OpenMesh.

use crate::bridge::openmesh as ffi;
use crate::buffers::{MeshBuffers, MeshView, tuples};
use crate::check;
use crate::error::{KernelError, Library, Result};
use crate::mesh_file;
use std::collections::BTreeMap;
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
/// A file that is missing, of another kind, cut off, damaged or without triangles: with the line, where it is known, and a
/// mend.
pub fn read(path: &Path) -> Result<MeshBuffers> {
    let Some(text) = path.to_str() else { return Err(KernelError::file(path, "the path is not UTF-8")) };
    let bytes = std::fs::read(path).map_err(|error| KernelError::file(path, error))?;
    mesh_file::check(path, &bytes)?;
    let mesh: MeshBuffers =
        ffi::read(text).map_err(|exception| KernelError::file(path, exception.what()))?.into();
    check::mesh("openmesh::read", mesh.view()).map_err(|error| KernelError::file(path, error))?;
    Ok(mesh)
}

/// What [`without_strays`] gives.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Kept {
    /// The pieces that stay, without unused vertices.
    pub mesh: MeshBuffers,
    /// How many connected pieces there were.
    pub pieces: u32,
    /// How many of them were dropped.
    pub dropped_pieces: u32,
    /// Their triangles.
    pub dropped_triangles: u32,
}

/// Drops connected pieces whose area is below a share of the largest one's; triangles are connected over common corners.
///
/// # Errors
/// An empty mesh, numbers that are not finite, indices out of range; a share that is not from 0 to 1.
pub fn without_strays(mesh: MeshView<'_>, least_share: f64) -> Result<Kept> {
    const OPERATION: &str = "openmesh::without_strays";
    check::mesh(OPERATION, mesh)?;
    let in_range = (0.0..=1.0).contains(&least_share);
    check::require(OPERATION, in_range, || format!("least_share is {least_share}; it must be from 0 to 1"))?;
    let piece = pieces(mesh);
    let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
    for (t, piece) in mesh.triangles.iter().zip(&piece) {
        *areas.entry(*piece).or_default() += area(mesh, *t);
    }
    let largest = areas.values().copied().fold(0.0, f64::max);
    let stays = |piece: &u32| areas[piece] >= least_share * largest;
    let triangles: Vec<[u32; 3]> =
        mesh.triangles.iter().zip(&piece).filter(|(_, p)| stays(p)).map(|(t, _)| *t).collect();
    Ok(Kept {
        pieces: areas.len() as u32,
        dropped_pieces: areas.keys().filter(|p| !stays(p)).count() as u32,
        dropped_triangles: (mesh.triangles.len() - triangles.len()) as u32,
        mesh: used(mesh.positions, &triangles),
    })
}

/// A number per triangle: the same for triangles that hang together.
fn pieces(mesh: MeshView<'_>) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    for t in mesh.triangles {
        let [a, b, c] = t.map(|v| root(&mut parent, v));
        let least = a.min(b).min(c);
        [a, b, c].iter().for_each(|v| parent[*v as usize] = least);
    }
    mesh.triangles.iter().map(|t| root(&mut parent, t[0])).collect()
}

fn area(mesh: MeshView<'_>, t: [u32; 3]) -> f64 {
    let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
    let [p, q]: [[f64; 3]; 2] = [b, c].map(|x| std::array::from_fn(|k| x[k] - a[k]));
    let cross: [f64; 3] =
        std::array::from_fn(|k| p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]);
    0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The triangles with the vertices that they use, in their order.
fn used(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> MeshBuffers {
    let mut number = vec![u32::MAX; positions.len()];
    triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
    let mut kept = Vec::new();
    for (n, p) in number.iter_mut().zip(positions).filter(|(n, _)| **n == 0) {
        *n = kept.len() as u32;
        kept.push(*p);
    }
    let triangles = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    MeshBuffers { positions: kept, triangles }
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
