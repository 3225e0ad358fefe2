//! A sheet's surface and trim in the form OpenCascade takes.

use softfold_geometry::{PlanarCurve, RigidTransform, Segment, SheetShell, SheetSurface, UniformBicubic};
use softfold_kernel::occt::{self, BsplineSurface, Shape, ShellTopology, TrimCurve};

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

/// The sheet as several trimmed faces that share their edges.
///
/// # Errors
/// Edges that OpenCascade cannot put on the surfaces; a shell that it does not find valid.
pub fn shell(sheet: &SheetShell) -> softfold_kernel::Result<Shape> {
    let surfaces: Vec<_> = sheet.faces.iter().map(|f| bspline(&f.spline)).collect();
    occt::sheet_shell(&surfaces, &topology(sheet))
}

fn topology(sheet: &SheetShell) -> ShellTopology {
    ShellTopology {
        edges: sheet.edges.iter().map(|e| (trim_curve(&e.segment), e.corners)).collect(),
        corners: sheet.corners,
        faces: (sheet.faces.iter())
            .map(|f| f.loops.iter().map(|l| l.iter().map(|u| (u.edge, u.reversed)).collect()).collect())
            .collect(),
    }
}

/// The sheet in another place.
pub(crate) fn moved(sheet: &SheetSurface, to: &RigidTransform) -> SheetSurface {
    let mut moved = sheet.clone();
    moved.spline.poles.iter_mut().for_each(|p| *p = to.point(*p));
    moved
}
