//! A sheet's surface and trim in the form OpenCascade takes.

use softfold_geometry::{PlanarCurve, RigidTransform, Segment, SheetSurface, UniformBicubic};
use softfold_kernel::occt::{self, BsplineSurface, Shape, TrimCurve};

/// The same surface, its knots uniform and single throughout.
pub(crate) fn bspline(surface: &UniformBicubic) -> BsplineSurface {
    let [knots_u, knots_v] = surface.knots();
    BsplineSurface {
        poles: surface.poles.iter().map(|p| p.to_array()).collect(),
        pole_count: surface.count,
        multiplicities_u: vec![1; knots_u.len()],
        multiplicities_v: vec![1; knots_v.len()],
        knots_u,
        knots_v,
    }
}

/// The trim's loops as curves in the parameter plane.
pub(crate) fn trim_loops(trim: &[PlanarCurve]) -> Vec<Vec<TrimCurve>> {
    trim.iter().map(|curve| curve.segments().iter().map(trim_curve).collect()).collect()
}

fn trim_curve(segment: &Segment) -> TrimCurve {
    match *segment {
        Segment::Line { from, to } => TrimCurve::Line { from: from.to_array(), to: to.to_array() },
        Segment::Cubic { .. } => {
            TrimCurve::Bezier { poles: segment.control_points().iter().map(|p| p.to_array()).collect() }
        }
    }
}

/// The sheet as a trimmed face.
///
/// # Errors
/// A trim that OpenCascade cannot put on the surface.
pub fn face(sheet: &SheetSurface) -> softfold_kernel::Result<Shape> {
    occt::trimmed_face(&bspline(&sheet.spline), &trim_loops(&sheet.trim))
}

/// The sheet in another place.
pub(crate) fn moved(sheet: &SheetSurface, to: &RigidTransform) -> SheetSurface {
    let mut moved = sheet.clone();
    moved.spline.poles.iter_mut().for_each(|p| *p = to.point(*p));
    moved
}
