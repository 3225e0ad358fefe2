//! The surface stage: one smooth face, several where the sheet is sharp or slit, or those of a conforming cage.

use crate::RunError;
use crate::cuts::cuts;
use crate::progress::Progress;
use crate::project::Form;
use crate::shape::{self, SheetShape};
use crate::stages::{Loaded, Results, defect, made};
use softfold_geometry::{Deviation, FoldedSheet, SheetSurface};
use softfold_kernel::{MeshBuffers, cgal, occt};
use softfold_surface::subd::Conforming;
use softfold_surface::{
    Cage, Cut, CutKind, Fitted, FittedShell, SurfaceAnalysis, SurfaceError, SurfaceOptions,
};

/// The surface of a cage that conforms to the outline, as a shell.
pub struct SubdResult {
    /// Cage and faces.
    pub made: Conforming,
    /// The faces as one shell.
    pub shell: occt::Shape,
    /// How far apart faces are where they meet, mm.
    pub gap_mm: f64,
    /// What OpenCascade finds wrong with it.
    pub faults: Vec<String>,
}

/// The surface stage's results.
pub struct SurfaceResult {
    /// One smooth face with its cage, of which board and mold are made: sharp creases are rounded over about two lattice cells.
    /// None for a sheet with slits, which one face cannot follow.
    pub fitted: Option<Fitted>,
    /// Several faces, where the sheet is sharp or slit; this is the surface then.
    pub shell: Option<FittedShell>,
    /// Its shape, place by place.
    pub shape: SheetShape,
    /// Figures of the surface.
    pub analysis: SurfaceAnalysis,
    /// The trimmed face, or the shell of several.
    pub face: occt::Shape,
    /// Largest tolerance of its edges and vertices, mm.
    pub edge_tolerance_mm: f64,
    /// What OpenCascade finds wrong with it.
    pub faults: Vec<String>,
    /// Its triangles, by OpenCascade.
    pub face_mesh: MeshBuffers,
    /// Largest distance from a folded vertex to the face's own triangles, by CGAL, mm: the exported face against the
    /// mesh, through two other libraries.
    pub face_distance_mm: f64,
    /// The conforming cage and its faces, for `surface.form = "subd"`.
    pub subd: Option<SubdResult>,
}

impl SurfaceResult {
    /// How far the exported surface is from the folded vertices.
    pub fn deviation(&self) -> Deviation {
        let one = self.fitted.as_ref().map(|f| f.surface.deviation);
        let several = self.shell.as_ref().map(|s| s.shell.deviation);
        self.subd.as_ref().map(|s| s.made.deviation).or(several).or(one).unwrap_or_default()
    }

    /// What OpenCascade finds wrong with the faces of the lattice, and with the shell of the cage.
    pub fn all_faults(&self) -> Vec<String> {
        self.faults.iter().chain(self.subd.iter().flat_map(|s| &s.faults)).cloned().collect()
    }

    /// How many faces are exported.
    pub fn faces(&self) -> usize {
        let several = self.shell.as_ref().map_or(1, |s| s.shell.faces.len());
        self.subd.as_ref().map_or(several, |s| s.made.surface.faces.len())
    }

    /// The shape that is exported.
    pub fn exported(&self) -> &occt::Shape {
        self.subd.as_ref().map_or(&self.face, |s| &s.shell)
    }

    /// The control cages of the exported faces: of each face of the lattice, or the one that conforms to the outline.
    pub fn cages(&self) -> &[Cage] {
        match (&self.subd, &self.shell, &self.fitted) {
            (Some(subd), ..) => std::slice::from_ref(&subd.made.cage),
            (None, Some(shell), _) => &shell.cages,
            (None, None, Some(fitted)) => std::slice::from_ref(&fitted.cage),
            (None, None, None) => &[],
        }
    }
}

/// Chord error of the triangles that stand for the face in the check against the mesh, mm.
const FACE_CHORD_MM: f64 = 0.1;
/// Their angle, rad.
const FACE_ANGLE_RAD: f64 = 0.5;
/// Share of the surface's tolerance by which the curve where faces meet may leave the crease that it stands for.
const CREASE_SHARE: f64 = 0.4;
/// Step of the surface analysis as share of the lattice spacing.
const ANALYSIS_STEP: f64 = 0.5;

/// The stage.
///
/// # Errors
/// Options that make no sense, a form that the pattern cannot have.
pub(crate) fn surface(
    loaded: &Loaded,
    results: &mut Results,
    progress: &mut dyn Progress,
) -> Result<String, RunError> {
    let options = options(loaded);
    let sheet = &made(results.fold.as_ref())?.sheet;
    let (fitted, shell) = fits(loaded, results, sheet, &options)?;
    progress.advance(Some(0.6), "curvature and the trimmed faces");
    let (analysis, face, why) = seen(fitted.as_ref(), shell.as_ref())?;
    let face_mesh = occt::triangulate(&face, FACE_CHORD_MM, FACE_ANGLE_RAD).map_err(defect)?;
    let (surfaces, spacing_mm) = faces_of(fitted.as_ref(), shell.as_ref())?;
    let subd = match loaded.project.surface.form {
        Form::Lattice => None,
        Form::Subd => {
            progress.advance(Some(0.8), "the conforming cage");
            Some(subd(loaded, results, &options)?)
        }
    };
    let why = subd.as_ref().map_or(why, |s| s.made.why.clone());
    let result = SurfaceResult {
        shape: shape::of(&loaded.project, &sheet.mesh, &surfaces, spacing_mm),
        fitted,
        shell,
        analysis,
        edge_tolerance_mm: occt::largest_tolerance_mm(&face).map_err(defect)?,
        faults: occt::check(&face).map_err(defect)?,
        face_distance_mm: face_distance_mm(&face_mesh, sheet)?,
        face_mesh,
        face,
        subd,
    };
    let word = format!("deviation {:.3} mm, {why}", result.deviation().max_mm);
    results.surface = Some(result);
    Ok(word)
}

fn options(loaded: &Loaded) -> SurfaceOptions {
    let (wanted, defaults) = (&loaded.project.surface, SurfaceOptions::default());
    let tolerance_mm = wanted.tolerance_mm.unwrap_or(defaults.tolerance_mm);
    SurfaceOptions { tolerance_mm, spacing_mm: wanted.spacing_mm, ..defaults }
}

/// One face, if the sheet is not slit, and several, if it is slit or sharp.
fn fits(
    loaded: &Loaded,
    results: &Results,
    sheet: &FoldedSheet,
    options: &SurfaceOptions,
) -> Result<(Option<Fitted>, Option<FittedShell>), RunError> {
    let trim = &made(results.soft.as_ref())?.loops;
    let cuts = wanted_cuts(loaded, results, options.tolerance_mm)?;
    let slit = cuts.iter().any(|c| c.kind == CutKind::Slit);
    let at_fault = |e| surface_fault(loaded, &e);
    let several = (!cuts.is_empty()).then(|| softfold_surface::fit_shell(sheet, trim, &cuts, options));
    let shell = several.transpose().map_err(at_fault)?;
    // One face never follows a sharp crease: it does not try at spacings finer than those that several faces need.
    let spacing_mm = shell.as_ref().map_or(options.spacing_mm, |s| Some(s.spacing_mm));
    let one_face = || softfold_surface::fit(sheet, trim, &SurfaceOptions { spacing_mm, ..options.clone() });
    let fitted = (!slit).then(one_face).transpose().map_err(at_fault)?;
    Ok((fitted, shell))
}

/// A conforming cage is smooth everywhere: it has no cuts, and takes no slits.
fn wanted_cuts(loaded: &Loaded, results: &Results, tolerance_mm: f64) -> Result<Vec<Cut>, RunError> {
    let (pattern, soft) = (made(results.pattern.as_ref())?, made(results.soft.as_ref())?);
    if loaded.project.surface.form == Form::Subd {
        let mend =
            "surface.form = \"subd\" makes one smooth surface, but the sheet has slits; take \"lattice\"";
        return if soft.slits.is_empty() { Ok(vec![]) } else { Err(loaded.fault("surface", "form", mend)) };
    }
    let step_mm = loaded.project.mesh.target_edge_mm;
    cuts(pattern, soft, step_mm, CREASE_SHARE * tolerance_mm).map_err(defect)
}

/// The faces of the surface that counts, and the spacing of their lattice.
fn faces_of(
    fitted: Option<&Fitted>,
    shell: Option<&FittedShell>,
) -> Result<(Vec<SheetSurface>, f64), RunError> {
    if let Some(s) = shell {
        let faces = (0..s.shell.faces.len()).map(|f| s.shell.face_surface(f));
        return Ok((faces.collect::<Result<_, _>>().map_err(defect)?, s.spacing_mm));
    }
    let f = made(fitted)?;
    Ok((vec![f.surface.clone()], f.spacing_mm))
}

/// The surface that counts: of several faces, if there are.
fn seen(
    fitted: Option<&Fitted>,
    shell: Option<&FittedShell>,
) -> Result<(SurfaceAnalysis, occt::Shape, String), RunError> {
    if let Some(s) = shell {
        let analysis =
            softfold_surface::analyse_shell(&s.shell, ANALYSIS_STEP * s.spacing_mm).map_err(defect)?;
        return Ok((analysis, softfold_mold::sheet_shell(&s.shell).map_err(defect)?, s.why.clone()));
    }
    let f = made(fitted)?;
    let analysis = softfold_surface::analyse(&f.surface, ANALYSIS_STEP * f.spacing_mm).map_err(defect)?;
    Ok((analysis, softfold_mold::sheet_face(&f.surface).map_err(defect)?, f.why.clone()))
}

/// The paper's own route: a cage that conforms to the outline.
fn subd(loaded: &Loaded, results: &Results, options: &SurfaceOptions) -> Result<SubdResult, RunError> {
    let sheet = &made(results.fold.as_ref())?.sheet;
    let soft = made(results.soft.as_ref())?;
    let made = softfold_surface::subd::fit_conforming(sheet, soft, options)
        .map_err(|e| surface_fault(loaded, &e))?;
    let (shell, gap_mm) = made.surface.to_shell().map_err(defect)?;
    let faults = occt::check(&shell).map_err(defect)?;
    Ok(SubdResult { made, shell, gap_mm, faults })
}

fn face_distance_mm(face: &MeshBuffers, sheet: &FoldedSheet) -> Result<f64, RunError> {
    let points: Vec<[f64; 3]> = sheet.positions.iter().map(|p| p.to_array()).collect();
    let distances = cgal::distances_to_mesh(&points, face.view()).map_err(defect)?;
    Ok(distances.into_iter().fold(0.0, f64::max))
}

fn surface_fault(loaded: &Loaded, error: &SurfaceError) -> RunError {
    match error {
        SurfaceError::NotPositive { key, .. } => loaded.fault("surface", key, error),
        SurfaceError::TooManyPoles { .. } => loaded.fault("surface", "spacing_mm", error),
        SurfaceError::CageFolds { .. } => loaded.fault("surface", "form", error),
        other => defect(other),
    }
}
