use super::shape::Shape;
use super::{BooleanOperation, ShapeKind};
use crate::bridge::occt as ffi;
use crate::buffers::MeshView;
use crate::check;
use crate::error::{KernelError, Result};

/// Rotations may be off from orthonormal by this: they come from products of rounded matrices.
const ROTATION_TOLERANCE: f64 = 1e-9;

/// A shape swept along a vector (mm): a face gives a solid, oriented outward.
///
/// # Errors
/// A vector of no length; a solid or a compound with solids; a face swept within itself, if it has no volume.
pub fn prism(shape: &Shape, vector: [f64; 3]) -> Result<Shape> {
    const OPERATION: &str = "occt::prism";
    check::vector(OPERATION, "the vector", vector)?;
    let sweepable = !matches!(shape.kind(), ShapeKind::Solid | ShapeKind::CompSolid);
    check::require(OPERATION, sweepable, || "a solid cannot be swept; give one of its faces".into())?;
    Shape::made_by(OPERATION, || ffi::prism(shape.raw(), vector))
}

/// The solid above a polygon in the plane (mm, either orientation, not closed by a repeated point) from `z0` to `z1`.
///
/// # Errors
/// Fewer than three points, a polygon that meets itself, `z1` not above `z0`.
pub fn extruded_polygon(outline: &[[f64; 2]], z0: f64, z1: f64) -> Result<Shape> {
    const OPERATION: &str = "occt::extruded_polygon";
    check::require(OPERATION, outline.len() >= 3, || format!("{} points are no polygon", outline.len()))?;
    check::finite(OPERATION, "point", outline)?;
    check::finite(OPERATION, "height", &[[z0, z1]])?;
    check::require(OPERATION, z1 > z0, || format!("z1 = {z1} is not above z0 = {z0}"))?;
    check::require(OPERATION, has_area(outline), || "the polygon has no area".into())?;
    Shape::made_by(OPERATION, || ffi::extruded_polygon(outline.as_flattened(), z0, z1))
}

/// A mesh as plane faces, one a triangle, with shared edges: a shell, or a solid if the mesh is closed. What comes of a mesh
/// that is carried into CAD as it is; a thousand times as heavy as a surface, and not smooth.
///
/// # Errors
/// Indices out of range, triangles without area.
pub fn faceted(mesh: MeshView<'_>) -> Result<Shape> {
    const OPERATION: &str = "occt::faceted";
    check::mesh(OPERATION, mesh)?;
    Shape::made_by(OPERATION, || ffi::faceted(mesh.positions.as_flattened(), mesh.triangles.as_flattened()))
}

/// Union, intersection or difference. One solid comes back as a solid, several (or none, where nothing is left) as a
/// compound.
///
/// # Errors
/// What OpenCascade reports: arguments that meet themselves, or an intersection it cannot find.
pub fn boolean(a: &Shape, b: &Shape, operation: BooleanOperation) -> Result<Shape> {
    Shape::made_by("occt::boolean", || ffi::boolean(a.raw(), b.raw(), operation.code()))
}

/// The shape turned, then moved: x ↦ R x + t.
///
/// # Errors
/// A matrix that is no rotation (rows orthonormal to 1e-9, no mirror).
pub fn transformed(shape: &Shape, rotation: [[f64; 3]; 3], translation: [f64; 3]) -> Result<Shape> {
    const OPERATION: &str = "occt::transformed";
    check::finite(OPERATION, "row of the rotation", &rotation)?;
    check::finite(OPERATION, "translation", &[translation])?;
    check_rotation(OPERATION, &rotation)?;
    let rows = std::array::from_fn(|i| rotation[i / 3][i % 3]);
    Shape::made_by(OPERATION, || ffi::transformed(shape.raw(), rows, translation))
}

/// Rounding in the area of a polygon stays below this part of its extent squared.
const AREA_ROUNDING: f64 = 1e-14;

fn has_area(outline: &[[f64; 2]]) -> bool {
    let place = |i: usize| [0, 1].map(|k| outline[i % outline.len()][k] - outline[0][k]);
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let area: f64 = (0..outline.len()).map(|i| 0.5 * cross(place(i), place(i + 1))).sum();
    let extent = (0..outline.len()).map(|i| place(i)[0].hypot(place(i)[1])).fold(0.0, f64::max);
    area.abs() > AREA_ROUNDING * extent * extent
}

fn check_rotation(operation: &'static str, rows: &[[f64; 3]; 3]) -> Result<()> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let mut worst = (dot(cross(rows[0], rows[1]), rows[2]) - 1.0).abs();
    for i in 0..3 {
        for j in 0..3 {
            let wanted = if i == j { 1.0 } else { 0.0 };
            worst = worst.max((dot(rows[i], rows[j]) - wanted).abs());
        }
    }
    if worst <= ROTATION_TOLERANCE {
        return Ok(());
    }
    Err(KernelError::input(operation, format!("{rows:?} is no rotation: off by {worst:e}")))
}
