//! Planar triangulation and mesh operations with exact predicates, by CGAL.

use crate::bridge::cgal as ffi;
use crate::buffers::{BooleanOperation, MeshBuffers, MeshView, tuples};
use crate::check;
use crate::error::{KernelError, Library, Result};

pub use crate::nearest::{DistanceTree, Foot};

/// What [`constrained_delaunay`] gives.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Triangulation {
    /// The distinct input points in their order, then the points where constraints cross.
    pub points: Vec<[f64; 2]>,
    /// Counter-clockwise triangles that cover the convex hull of all points.
    pub triangles: Vec<[u32; 3]>,
    /// Every piece of every constraint: in the order of the input, and along each constraint from its first end.
    pub constraints: Vec<ConstraintEdge>,
    /// Which of `points` each input point became; equal input points share one.
    pub index_of_input: Vec<u32>,
}

/// An edge of the triangulation that is a piece of an input constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConstraintEdge {
    /// The ends in `Triangulation::points`, in the direction of the input constraint.
    pub vertices: [u32; 2],
    /// The input constraint it is a piece of. Where constraints overlap, an edge is listed once for each.
    pub input: u32,
}

/// What [`closed_check`] finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedCheck {
    /// No edge has a triangle on one side only.
    pub closed: bool,
    /// Every edge has at most two triangles, equally oriented, and every vertex one fan of them.
    pub manifold: bool,
    /// Closed and manifold with all normals pointing out of a bounded volume.
    pub outward: bool,
    /// Signed volume in mm³; only a volume if `closed`.
    pub volume_mm3: f64,
}

/// Constrained Delaunay triangulation; constraints are pairs of indices into `points`.
///
/// Where constraints cross, the crossing is computed exactly and becomes a point of the result, rounded to `f64` only
/// there. Constraints may touch, overlap and pass through points. A constraint between equal points has no pieces.
///
/// # Errors
/// Fewer than three distinct points, all points on one line, numbers that are not finite, indices out of range.
pub fn constrained_delaunay(points: &[[f64; 2]], constraints: &[[u32; 2]]) -> Result<Triangulation> {
    const OPERATION: &str = "cgal::constrained_delaunay";
    check::addressable(OPERATION, "points", points.len())?;
    check::finite(OPERATION, "point", points)?;
    check::indices(OPERATION, "constraint", constraints, points.len())?;
    let flat = ffi::constrained_delaunay(points.as_flattened(), constraints.as_flattened())
        .map_err(Library::Cgal.failure(OPERATION))?;
    let edge = |&[a, b, input]: &[u32; 3]| ConstraintEdge { vertices: [a, b], input };
    Ok(Triangulation {
        points: tuples(&flat.points),
        triangles: tuples(&flat.triangles),
        constraints: tuples(&flat.constraints).iter().map(edge).collect(),
        index_of_input: flat.index_of_input,
    })
}

/// Indices of the corners of the convex hull, counter-clockwise; points inside its edges are no corners.
///
/// Points on one line give its two ends, equal points the first of them.
///
/// # Errors
/// No points, numbers that are not finite.
pub fn convex_hull(points: &[[f64; 2]]) -> Result<Vec<u32>> {
    const OPERATION: &str = "cgal::convex_hull";
    check::require(OPERATION, !points.is_empty(), || "no points".into())?;
    check::addressable(OPERATION, "points", points.len())?;
    check::finite(OPERATION, "point", points)?;
    ffi::convex_hull(points.as_flattened()).map_err(Library::Cgal.failure(OPERATION))
}

/// Remeshes towards triangles with edges of `target_edge_mm`; the border stays on itself, the surface near itself.
///
/// # Errors
/// A mesh that is no oriented manifold; an edge length that is not positive.
pub fn isotropic_remesh(mesh: MeshView<'_>, target_edge_mm: f64, iterations: u32) -> Result<MeshBuffers> {
    const OPERATION: &str = "cgal::isotropic_remesh";
    check::mesh(OPERATION, mesh)?;
    check::positive(OPERATION, "target_edge_mm", target_edge_mm)?;
    let (positions, triangles) = flat(mesh);
    ffi::isotropic_remesh(positions, triangles, target_edge_mm, iterations)
        .map(MeshBuffers::from)
        .map_err(Library::Cgal.failure(OPERATION))
}

/// Pairs of triangles that intersect, each pair ascending, the list sorted. Neighbours that share an edge or a corner
/// count only if they meet elsewhere too.
///
/// # Errors
/// A mesh that is no oriented manifold.
pub fn self_intersections(mesh: MeshView<'_>) -> Result<Vec<[u32; 2]>> {
    const OPERATION: &str = "cgal::self_intersections";
    check::mesh(OPERATION, mesh)?;
    let (positions, triangles) = flat(mesh);
    let pairs = ffi::self_intersections(positions, triangles).map_err(Library::Cgal.failure(OPERATION))?;
    Ok(tuples(&pairs))
}

/// Distance in mm of each point to the nearest point of the mesh, which may be any set of triangles.
///
/// # Errors
/// A mesh in which every triangle is degenerate; numbers that are not finite.
pub fn distances_to_mesh(points: &[[f64; 3]], mesh: MeshView<'_>) -> Result<Vec<f64>> {
    const OPERATION: &str = "cgal::distances_to_mesh";
    check::mesh(OPERATION, mesh)?;
    check::finite(OPERATION, "point", points)?;
    let (positions, triangles) = flat(mesh);
    ffi::distances_to_mesh(points.as_flattened(), positions, triangles)
        .map_err(Library::Cgal.failure(OPERATION))
}

/// Union, intersection or difference of two closed, outward oriented meshes; the result is closed and outward
/// oriented, and empty if nothing is left. The order of its vertices and triangles depends on its shape alone: CGAL's
/// changes with the addresses of memory.
///
/// # Errors
/// A mesh that is not closed, not outward oriented or intersects itself (where the two meet); a result that would not
/// be manifold, for example of solids that touch in an edge.
pub fn boolean(a: MeshView<'_>, b: MeshView<'_>, operation: BooleanOperation) -> Result<MeshBuffers> {
    const OPERATION: &str = "cgal::boolean";
    check::mesh(OPERATION, a)?;
    check::mesh(OPERATION, b)?;
    let ((a_positions, a_triangles), (b_positions, b_triangles)) = (flat(a), flat(b));
    ffi::boolean(a_positions, a_triangles, b_positions, b_triangles, operation.code())
        .map(|mesh| MeshBuffers::from(mesh).canonical())
        .map_err(Library::Cgal.failure(OPERATION))
}

/// The closed, outward oriented solid between an open mesh and its translate by `vector` (mm).
///
/// # Errors
/// A mesh that is closed or no oriented manifold; a vector of no length.
pub fn extrude(mesh: MeshView<'_>, vector: [f64; 3]) -> Result<MeshBuffers> {
    const OPERATION: &str = "cgal::extrude";
    check::mesh(OPERATION, mesh)?;
    check::vector(OPERATION, "the vector", vector)?;
    let (positions, triangles) = flat(mesh);
    ffi::extrude(positions, triangles, vector)
        .map(MeshBuffers::from)
        .map_err(Library::Cgal.failure(OPERATION))
}

/// A closed manifold mesh around any set of triangles, `offset_mm` away from it; openings narrower than `alpha_mm` are
/// bridged.
///
/// # Errors
/// Lengths that are not positive; a wrap of more than a billion cells is refused (see the message).
pub fn alpha_wrap(mesh: MeshView<'_>, alpha_mm: f64, offset_mm: f64) -> Result<MeshBuffers> {
    const OPERATION: &str = "cgal::alpha_wrap";
    check::mesh(OPERATION, mesh)?;
    check::positive(OPERATION, "alpha_mm", alpha_mm)?;
    check::positive(OPERATION, "offset_mm", offset_mm)?;
    wrap_is_feasible(OPERATION, mesh, alpha_mm)?;
    let (positions, triangles) = flat(mesh);
    ffi::alpha_wrap(positions, triangles, alpha_mm, offset_mm)
        .map(MeshBuffers::from)
        .map_err(Library::Cgal.failure(OPERATION))
}

/// Whether a mesh bounds a solid, and how large that is. Takes any triangles.
///
/// # Errors
/// An empty mesh, numbers that are not finite, indices out of range.
pub fn closed_check(mesh: MeshView<'_>) -> Result<ClosedCheck> {
    const OPERATION: &str = "cgal::closed_check";
    check::mesh(OPERATION, mesh)?;
    let (positions, triangles) = flat(mesh);
    let found = ffi::closed_check(positions, triangles).map_err(Library::Cgal.failure(OPERATION))?;
    Ok(ClosedCheck {
        closed: found.closed,
        manifold: found.manifold,
        outward: found.outward,
        volume_mm3: found.volume,
    })
}

fn flat<'a>(mesh: MeshView<'a>) -> (&'a [f64], &'a [u32]) {
    (mesh.positions.as_flattened(), mesh.triangles.as_flattened())
}

/// A wrap's triangles are about as small as alpha: far too small an alpha would run for hours.
fn wrap_is_feasible(operation: &'static str, mesh: MeshView<'_>, alpha_mm: f64) -> Result<()> {
    const MOST_ALPHAS_ACROSS: f64 = 3e4; // squared about 1e9 cells on the surface
    let extent = |axis: usize| {
        let values = || mesh.positions.iter().map(|p| p[axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let size = (0..3).map(extent).fold(0.0, f64::max);
    if size / alpha_mm <= MOST_ALPHAS_ACROSS {
        return Ok(());
    }
    let message = format!(
        "alpha_mm {alpha_mm} is too small for a mesh of {size} mm; raise it above {}",
        size / MOST_ALPHAS_ACROSS
    );
    Err(KernelError::input(operation, message))
}
