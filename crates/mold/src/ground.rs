//! The board cut flat where it stands.

use crate::board::{Board, require_valid};
use crate::error::{During, MoldError, Setting};
use crate::measure::{Inertia, Moments, outer};
use glam::{DMat3, DVec2, DVec3};
use softfold_geometry::{TriMesh, polygon};
use softfold_kernel::occt::{self, BooleanOperation, Shape, ShapeKind};

/// Step of the points among which the lowest is looked for, mm.
const LOWEST_STEP_MM: f64 = 1.0;
/// How far what is cut away reaches past the board, mm.
const BEYOND_MM: f64 = 10.0;
/// Chord error, mm, and angle, rad, of the triangles by which what is cut away is measured.
const REMOVED_CHORD_MM: f64 = 0.01;
const REMOVED_ANGLE_RAD: f64 = 0.1;
/// Chord error, mm, and angle, rad, of the triangles whose corners stand for a trimmed board.
const CHORD_MM: f64 = 0.05;
const ANGLE_RAD: f64 = 0.3;

/// How a board was trimmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundTrim {
    /// Height of the plane above the lowest point that there was, mm.
    pub height_mm: f64,
    /// Height of the plane in space, mm.
    pub plane_z_mm: f64,
    /// What was cut away, mm³.
    pub removed_mm3: f64,
}

/// Cuts away what of a board, as it is posed, lies below the horizontal plane `height_mm` above its lowest point, so that it
/// stands on a flat foot in the very pose it is in. Mass, barycenter and inertia are those of what is left; the skins,
/// the radii and the checks of the volume stay those of the whole board.
///
/// # Errors
/// A height that is not positive, a cut that leaves nothing or several pieces, a solid that OpenCascade does not find valid.
pub fn trim_ground(board: Board, height_mm: f64) -> Result<Board, MoldError> {
    const HEIGHT: Setting = Setting::of("board", "trim_ground_mm", "height of the cut at the ground (mm)");
    HEIGHT.positive(height_mm)?;
    let points = board.points(LOWEST_STEP_MM)?;
    let [lowest, highest] =
        points.iter().fold([f64::MAX, f64::MIN], |[lo, hi], p| [lo.min(p.z), hi.max(p.z)]);
    let plane_z_mm = lowest + height_mm;
    HEIGHT.require(plane_z_mm < highest, height_mm, "it must be lower than the board")?;
    let away = below(&points, lowest, plane_z_mm)?;
    let shape =
        occt::boolean(&board.shape, &away, BooleanOperation::Difference).during(|| "the cut".into())?;
    let pieces = if shape.kind() == ShapeKind::Solid { 1 } else { count(&shape)? };
    HEIGHT.require(pieces == 1, height_mm, pieces_mend(pieces))?;
    require_valid(&shape, "the board cut at the ground")?;
    let piece =
        occt::boolean(&board.shape, &away, BooleanOperation::Intersection).during(|| "the cut".into())?;
    let trim = |removed_mm3| GroundTrim { height_mm, plane_z_mm, removed_mm3 };
    Ok(without(board, shape, &measured(&piece)?, trim))
}

/// What is cut away, by its triangles: it is so little that their error is a millionth of the board, and OpenCascade's
/// integration takes minutes where symmetry makes a moment nothing.
fn measured(piece: &Shape) -> Result<Moments, MoldError> {
    let mesh =
        occt::triangulate(piece, REMOVED_CHORD_MM, REMOVED_ANGLE_RAD).during(|| "what is cut away".into())?;
    let positions = mesh.positions.iter().map(|p| DVec3::from(*p)).collect();
    Ok(Moments::of_mesh(&TriMesh { positions, triangles: mesh.triangles }))
}

/// The board less what was cut away.
fn without(board: Board, shape: Shape, removed: &Moments, trim: impl Fn(f64) -> GroundTrim) -> Board {
    let density_kg_mm3 = board.mass_kg / board.volume_mm3;
    let volume_mm3 = board.volume_mm3 - removed.volume_mm3;
    let barycenter_mm =
        (board.volume_mm3 * board.barycenter_mm - removed.volume_mm3 * removed.center_mm) / volume_mm3;
    let about = |at: DVec3, volume_mm3: f64| {
        let d = at - barycenter_mm;
        volume_mm3 * (DMat3::from_diagonal(DVec3::splat(d.length_squared())) - outer(d))
    };
    let moved = about(board.barycenter_mm, board.volume_mm3) - about(removed.center_mm, removed.volume_mm3);
    let tensor = board.inertia.tensor_kg_mm2 + density_kg_mm3 * (moved - removed.inertia_mm5);
    Board {
        shape,
        volume_mm3,
        mass_kg: density_kg_mm3 * volume_mm3,
        barycenter_mm,
        inertia: Inertia::of(tensor),
        trimmed: Some(trim(removed.volume_mm3)),
        ..board
    }
}

fn pieces_mend(pieces: usize) -> &'static str {
    if pieces == 0 {
        "it leaves nothing of the board; cut lower"
    } else {
        "it cuts the board to pieces; cut lower"
    }
}

fn count(shape: &Shape) -> Result<usize, MoldError> {
    Ok(occt::counts(shape).during(|| "the cut".into())?.solids)
}

/// The box around the points up to the plane.
fn below(points: &[DVec3], lowest: f64, plane_z_mm: f64) -> Result<Shape, MoldError> {
    let plan: Vec<DVec2> = points.iter().map(|p| p.truncate()).collect();
    let (lower, upper) = polygon::bounds(&plan);
    let (lower, upper) = (lower - BEYOND_MM, upper + BEYOND_MM);
    let corners = [[lower.x, lower.y], [upper.x, lower.y], [upper.x, upper.y], [lower.x, upper.y]];
    occt::extruded_polygon(&corners, lowest - BEYOND_MM, plane_z_mm).during(|| "what is cut away".into())
}

/// Points all over a trimmed board: the corners of its triangles, which lie on its faces and edges.
pub(crate) fn points(shape: &Shape) -> Result<Vec<DVec3>, MoldError> {
    let mesh = occt::triangulate(shape, CHORD_MM, ANGLE_RAD).during(|| "the cut board's triangles".into())?;
    Ok(mesh.positions.iter().map(|p| DVec3::from(*p)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::{BoardOptions, make_board};
    use crate::{rest_of_board, shapes};
    use softfold_geometry::SheetSurface;

    fn board(sheet: &SheetSurface, thickness_mm: f64) -> Board {
        make_board(sheet, &BoardOptions { thickness_mm, ..Default::default() }).unwrap()
    }

    /// A cylinder's hill: it stands on its two straight sides.
    fn arch() -> SheetSurface {
        let mut arch = shapes::cylinder(shapes::rectangle(240.0, 80.0));
        arch.spline.poles.iter_mut().for_each(|p| *p = DVec3::new(-p.x, p.y, -p.z));
        arch
    }

    #[test]
    fn a_leaning_board_loses_its_lowest_edge() {
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let leaning =
            shapes::sheet(shapes::rectangle(120.0, 80.0), |p| DVec3::new(cos * p.x, p.y, sin * p.x));
        let whole = board(&leaning, 10.0);
        let (volume, mass) = (whole.volume_mm3, whole.mass_kg);
        let cut = trim_ground(whole, 5.0).unwrap();
        // A triangle at the corner between the skin, at 30° to the ground, and the side.
        let removed = 0.5 * 5.0 * 5.0 * (sin / cos + cos / sin) * 80.0;
        let trimmed = cut.trimmed.unwrap();
        assert!((trimmed.removed_mm3 / removed - 1.0).abs() < 1e-6, "{}", trimmed.removed_mm3 / removed);
        assert!((cut.mass_kg / mass - (1.0 - removed / volume)).abs() < 1e-7);
        assert!(occt::check(&cut.shape).unwrap().is_empty());
        let rest = rest_of_board(&cut, 1.0, 0.01).unwrap();
        assert!(!rest.stability.stable, "it leans too far");
        assert!((rest.stability.ground_z_mm - trimmed.plane_z_mm).abs() < 1e-6);
    }

    #[test]
    fn an_arch_stands_on_flat_feet() {
        let whole = board(&arch(), 12.0);
        let before = rest_of_board(&whole, 1.0, 0.01).unwrap();
        let (volume, center) = (whole.volume_mm3, whole.barycenter_mm);
        let cut = trim_ground(whole, 4.0).unwrap();
        let after = rest_of_board(&cut, 1.0, 0.01).unwrap();
        assert!(before.stability.stable && after.stability.stable && after.tilt_deg < 1e-6);
        assert!(
            after.stability.margin_mm > before.stability.margin_mm - 1e-6 || after.stability.hull.len() >= 4
        );
        assert!((after.stability.height_mm - (before.stability.height_mm - 4.0)).abs() < 0.1);
        let removed = cut.trimmed.unwrap().removed_mm3;
        assert!(removed > 0.0 && cut.barycenter_mm.z > center.z);
        let mesh = occt::triangulate(&cut.shape, 0.02, 0.2).unwrap();
        let found = softfold_kernel::cgal::closed_check(mesh.view()).unwrap();
        assert!(found.closed && (found.volume_mm3 / (volume - removed) - 1.0).abs() < 1e-3, "{found:?}");
        assert!(cut.barycenter_mm.truncate().length() < 1e-3, "{}", cut.barycenter_mm);
    }

    #[test]
    fn a_box_without_its_foot_is_a_lower_box() {
        let flat = board(&shapes::flat(shapes::rectangle(120.0, 80.0)), 10.0);
        let cut = trim_ground(flat, 4.0).unwrap();
        let (mass, exact) =
            (120.0 * 80.0 * 6.0 * 1700e-9, [80.0 * 80.0 + 36.0, 120.0 * 120.0 + 36.0, 20_800.0]);
        assert!((cut.mass_kg / mass - 1.0).abs() < 1e-7);
        assert!(cut.barycenter_mm.distance(DVec3::Z * 2.0) < 1e-6, "{}", cut.barycenter_mm);
        for (found, squares) in cut.inertia.principal_kg_mm2.into_iter().zip(exact) {
            assert!((found / (mass / 12.0 * squares) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn heights_that_make_no_sense_are_refused_at_their_line() {
        for height in [0.0, -1.0, f64::NAN, 1e4] {
            let error = trim_ground(board(&arch(), 12.0), height).unwrap_err();
            assert_eq!(error.place(), ("board", "trim_ground_mm"), "{height}: {error}");
        }
        // A valley cut above its bottom falls into two.
        let valley = board(&shapes::cylinder(shapes::rectangle(240.0, 80.0)), 12.0);
        let error = trim_ground(valley, 30.0).unwrap_err();
        assert!(error.to_string().contains("pieces"), "{error}");
    }
}
