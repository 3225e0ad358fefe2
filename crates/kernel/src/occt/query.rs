use super::shape::{Shape, run};
use crate::bridge::occt as ffi;
use crate::buffers::MeshBuffers;
use crate::check as require;
use crate::error::Result;
use opencascade_sys::top_abs::TopAbs_ShapeEnum;
use opencascade_sys::{top_exp, top_tools};

/// How many different parts a shape has; a shared one counts once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Solids.
    pub solids: usize,
    /// Shells.
    pub shells: usize,
    /// Faces.
    pub faces: usize,
    /// Edges.
    pub edges: usize,
}

/// Measures of a solid.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MassProperties {
    /// Volume, mm³.
    pub volume_mm3: f64,
    /// Center of the volume, mm.
    pub center: [f64; 3],
}

/// Measures of a solid and how its volume is spread.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Inertia {
    /// Volume, mm³.
    pub volume_mm3: f64,
    /// Center of the volume, mm.
    pub center: [f64; 3],
    /// Rows of the inertia tensor of the volume about its center, mm⁵: diagonal `∫ y² + z²` and so on, beside it
    /// `−∫ x y`. Times the density it is that of the mass.
    pub tensor_mm5: [[f64; 3]; 3],
}

/// How many solids, shells, faces and edges it has.
///
/// # Errors
/// None so far; a `Result` like every call here.
pub fn counts(shape: &Shape) -> Result<Counts> {
    Ok(Counts {
        solids: count(shape, TopAbs_ShapeEnum::TopAbs_SOLID),
        shells: count(shape, TopAbs_ShapeEnum::TopAbs_SHELL),
        faces: count(shape, TopAbs_ShapeEnum::TopAbs_FACE),
        edges: count(shape, TopAbs_ShapeEnum::TopAbs_EDGE),
    })
}

/// By opencascade-sys itself: walking a shape throws nothing.
fn count(shape: &Shape, kind: TopAbs_ShapeEnum) -> usize {
    let mut found = top_tools::new_indexed_map_of_shape();
    top_exp::TopExp::MapShapes(shape.raw(), kind, found.pin_mut());
    usize::try_from(found.Extent()).unwrap_or(0)
}

/// Faults in words, `face 2: self-intersecting wire` for example; empty when the shape is valid.
///
/// # Errors
/// Only if the check itself fails.
pub fn check(shape: &Shape) -> Result<Vec<String>> {
    run("occt::check", || ffi::check(shape.raw()))
}

/// Volume and center of solids, by an integration that is asked for this share of the volume on every face: with B-spline
/// faces it can be off by ten times that, and takes twice as long for a tenth of it.
///
/// # Errors
/// A shape without a solid; an integration that does not converge.
pub fn mass_properties(shape: &Shape, relative: f64) -> Result<MassProperties> {
    let mass = run("occt::mass_properties", || ffi::mass_properties(shape.raw(), relative))?;
    Ok(MassProperties { volume_mm3: mass.volume, center: mass.center })
}

/// As [`mass_properties`], with the inertia tensor, which takes as long again; minutes where symmetry makes a moment
/// nothing, because a share of it is asked for.
///
/// # Errors
/// As [`mass_properties`].
pub fn inertia(shape: &Shape, relative: f64) -> Result<Inertia> {
    let found = run("occt::inertia", || ffi::inertia(shape.raw(), relative))?;
    let row = |i: usize| [0, 1, 2].map(|k| found.rows[3 * i + k]);
    Ok(Inertia { volume_mm3: found.volume, center: found.center, tensor_mm5: [row(0), row(1), row(2)] })
}

/// Area of a shape's faces, mm².
///
/// # Errors
/// Only if the integration itself fails.
pub fn area(shape: &Shape) -> Result<f64> {
    run("occt::area", || ffi::area(shape.raw()))
}

/// The largest tolerance of a shape's vertices, edges and faces, mm: so far may be apart what is one. 1e-7 at least.
///
/// # Errors
/// None so far; a `Result` like every call here.
pub fn largest_tolerance_mm(shape: &Shape) -> Result<f64> {
    run("occt::largest_tolerance_mm", || ffi::largest_tolerance(shape.raw()))
}

/// Triangles off by at most `linear_mm` from the faces, and by `angular_rad` between neighbours along a curve. Faces
/// that share an edge share its vertices: a solid gives a closed mesh.
///
/// # Errors
/// Bounds that are not positive; a face that cannot be meshed.
pub fn triangulate(shape: &Shape, linear_mm: f64, angular_rad: f64) -> Result<MeshBuffers> {
    const OPERATION: &str = "occt::triangulate";
    require::positive(OPERATION, "linear_mm", linear_mm)?;
    require::positive(OPERATION, "angular_rad", angular_rad)?;
    run(OPERATION, || ffi::triangulate(shape.raw(), linear_mm, angular_rad)).map(MeshBuffers::from)
}
