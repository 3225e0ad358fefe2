//! Surfaces of several faces, for sheets that are sharp or slit somewhere.

use crate::analyse::{SurfaceAnalysis, analyse};
use crate::layout::{Cut, CutKind};
use crate::search::{Found, GAP_MM, Search, SurfaceOptions};
use crate::{Cage, SurfaceError};
use softfold_geometry::{Extreme, FoldedSheet, PlanarCurve, SheetShell, ShellFace};

/// A fitted surface of several faces and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedShell {
    /// The faces. Their deviation is as that of [`Fitted::surface`].
    pub shell: SheetShell,
    /// The control cage of each face.
    pub cages: Vec<Cage>,
    /// Spacing of the lattice, mm.
    pub spacing_mm: f64,
    /// Bending weight that was used.
    pub bending_weight: f64,
    /// Whether the deviation is within the tolerance.
    pub tolerance_met: bool,
    /// Whether faces that share an edge are nowhere farther apart there than [`FittedShell::GAP_MM`].
    pub watertight: bool,
    /// Cuts that bound no face although they are lengthened at both ends: a crease is rounded there.
    pub lost: Vec<CutKind>,
    /// Why the search ended, in words.
    pub why: String,
}

impl FittedShell {
    /// Largest distance between two faces along the edge that they share, mm.
    pub const GAP_MM: f64 = GAP_MM;
}

/// Fits a surface of several faces to a sheet that is sharp or slit along `cuts`, as [`fit`] does for one face.
///
/// All faces have their poles on one lattice of (u, v), so that along a crease, whose poles are those of both faces' own
/// lattices, the faces can be the same curve: their distance there is part of what is minimised, with a large weight. The
/// difference of the two is a spline that vanishes along the crease and has the fold as its slope across; it tends to
/// that with the fourth power of the spacing, and exactly so for straight and circular creases.
///
/// A cut that ends inside the sheet goes on straight to the next curve as an edge across which the two faces share all
/// poles that act there: they are one surface with continuous curvature. Within two cells of such an end a crease is
/// rounded.
///
/// # Errors
/// As [`fit`].
pub fn fit_shell(
    sheet: &FoldedSheet,
    trim: &[PlanarCurve],
    cuts: &[Cut],
    options: &SurfaceOptions,
) -> Result<FittedShell, SurfaceError> {
    let (problem, found) = Search::run(sheet, trim, cuts, options)?;
    let Found { solution, bending_weight, why } = found;
    let layout = problem.layout;
    let faces = solution.faces.iter().zip(layout.faces);
    let shell = SheetShell {
        faces: faces.map(|((_, spline), loops)| ShellFace { spline: spline.clone(), loops }).collect(),
        edges: layout.edges,
        corners: layout.corners,
        deviation: solution.deviation,
        gap_mm: solution.gap_mm,
    };
    shell.check()?;
    Ok(FittedShell {
        cages: solution.faces.iter().map(|(lattice, s)| lattice.cage(s.poles.clone())).collect(),
        shell,
        spacing_mm: solution.spacing_mm,
        bending_weight,
        tolerance_met: solution.deviation.max_mm <= options.tolerance_mm,
        watertight: solution.gap_mm.value <= GAP_MM,
        lost: layout.lost.iter().map(|&i| cuts[i].kind).collect(),
        why,
    })
}

/// Looks at all faces as [`analyse`] does at one.
///
/// # Errors
/// As [`analyse`].
pub fn analyse_shell(shell: &SheetShell, step_mm: f64) -> Result<SurfaceAnalysis, SurfaceError> {
    let mut whole: Option<SurfaceAnalysis> = None;
    for face in 0..shell.faces.len() {
        let surface = shell.face_surface(face).map_err(|_| SurfaceError::NoTrim)?;
        let of_face = analyse(&surface, step_mm)?;
        whole = Some(whole.map_or(of_face, |w| together(w, of_face)));
    }
    whole.ok_or(SurfaceError::NoTrim)
}

fn together(a: SurfaceAnalysis, b: SurfaceAnalysis) -> SurfaceAnalysis {
    let pick =
        |a: Extreme, b: Extreme, better: fn(f64, f64) -> bool| if better(b.value, a.value) { b } else { a };
    SurfaceAnalysis {
        min_radius_mm: pick(a.min_radius_mm, b.min_radius_mm, |new, old| new < old),
        principal_strain: [
            pick(a.principal_strain[0], b.principal_strain[0], |new, old| new < old),
            pick(a.principal_strain[1], b.principal_strain[1], |new, old| new > old),
        ],
        gaussian_curvature_per_mm2: pick(
            a.gaussian_curvature_per_mm2,
            b.gaussian_curvature_per_mm2,
            |new, old| new.abs() > old.abs(),
        ),
        area_mm2: a.area_mm2 + b.area_mm2,
    }
}
