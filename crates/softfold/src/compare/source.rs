//! What is compared: mesh files, STEP files, FOLD files and folders of runs, as triangles in mm.

use super::body;
use crate::RunError;
use crate::report::json::Report;
use serde::{Deserialize, Serialize};
use softfold_geometry::TriMesh;
use softfold_kernel::occt;
use softfold_kernel::{KernelError, MeshBuffers, openmesh};
use std::path::{Path, PathBuf};

/// Which result of a run's folder is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum What {
    /// The folded mesh.
    #[default]
    Mesh,
    /// The surface, from sheet.step.
    Surface,
    /// The board, from board.step.
    Board,
}

/// How files are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadOptions {
    /// Which result of a folder.
    pub what: What,
    /// Millimetres per unit of files that name none.
    pub unit_mm: Option<f64>,
    /// Chord error of the triangles that stand for CAD faces, mm.
    pub chord_mm: f64,
}

/// Angle between neighbouring triangles of CAD faces, rad: the chord decides on all but the tightest bends.
const ANGLE_RAD: f64 = 0.3;

/// What was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// The file.
    pub path: PathBuf,
    /// `mesh`, `step` or `fold`.
    pub kind: String,
    /// Whether a run of softfold wrote it, so that it lies where that run put it.
    pub of_a_run: bool,
    /// Vertices, those at the same place counted once.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Area, mm².
    pub area_mm2: f64,
    /// Chord error that was asked of OpenCascade's triangles for CAD faces, mm; in places they are off by up to twice that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chord_mm: Option<f64>,
    /// Millimetres per unit of the file, if it was said or is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit_mm: Option<f64>,
    /// Whether its triangles agree on their sides, so that distances from it have a sign.
    pub oriented: bool,
}

/// What a file is by its ending.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Mesh,
    Step,
    Fold,
}

impl Kind {
    fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "ply" | "obj" | "stl" | "off" => Some(Self::Mesh),
            "step" | "stp" => Some(Self::Step),
            "fold" => Some(Self::Fold),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Step => "step",
            Self::Fold => "fold",
        }
    }
}

/// Reads what `path` names: a file, or the wanted result of a run's folder.
///
/// # Errors
/// A file that is missing, of another kind or damaged; a folder without the result.
pub(super) fn read(path: &Path, options: &ReadOptions) -> Result<(Source, TriMesh), RunError> {
    let path = if path.is_dir() { in_folder(path, options.what)? } else { path.to_owned() };
    let Some(kind) = Kind::of(&path) else {
        let mend = "cannot be compared; give a mesh (ply, obj, stl, off), a step or fold file, or the folder of a run";
        return Err(RunError::in_file(&path, None, mend));
    };
    if !path.exists() {
        return Err(RunError::in_file(&path, None, "is not there; check the path"));
    }
    let of_a_run = is_of_a_run(&path);
    let unit_mm = if of_a_run { None } else { options.unit_mm };
    let mesh = match kind {
        Kind::Mesh => scaled(openmesh::read(&path).map_err(|e| unreadable(&path, &e))?, unit_mm),
        Kind::Step => step(&path, options.chord_mm)?,
        Kind::Fold => fold(&path, unit_mm)?,
    };
    let mesh = body::welded(&mesh);
    if mesh.area_mm2() <= 0.0 {
        return Err(RunError::in_file(
            &path,
            None,
            "holds no triangle of any area; look at it in a mesh viewer",
        ));
    }
    let source = Source {
        kind: kind.name().to_owned(),
        of_a_run,
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        area_mm2: mesh.area_mm2(),
        chord_mm: (kind == Kind::Step).then_some(options.chord_mm),
        unit_mm: if kind == Kind::Mesh { unit_mm } else { None },
        oriented: false,
        path,
    };
    Ok((source, mesh))
}

/// The file of a result in a run's folder.
fn in_folder(folder: &Path, what: What) -> Result<PathBuf, RunError> {
    let (names, command): (&[&str], _) = match what {
        // The FOLD file has all digits.
        What::Mesh => (&["folded.fold", "folded.ply"], "fold"),
        What::Surface => (&["sheet.step"], "surface"),
        What::Board => (&["board.step"], "board"),
    };
    let found = names.iter().map(|n| folder.join(n)).find(|p| p.is_file());
    let mend =
        format!("has no {}; make it by `softfold {command} PROJECT --out {}`", names[0], folder.display());
    found.ok_or_else(|| RunError::in_file(folder, None, mend))
}

/// Whether the report beside a file lists it.
fn is_of_a_run(path: &Path) -> bool {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let text = std::fs::read_to_string(path.with_file_name("report.json")).unwrap_or_default();
    Report::from_json(&text).is_ok_and(|r| r.files.iter().any(|f| f.path == name))
}

fn unreadable(path: &Path, error: &KernelError) -> RunError {
    match error {
        KernelError::File { .. } => RunError::Input(error.to_string()), // has the path, and a mend where there is one
        other => RunError::in_file(path, None, format!("{other}; look at the file in a mesh viewer")),
    }
}

fn scaled(mut mesh: MeshBuffers, unit_mm: Option<f64>) -> MeshBuffers {
    let unit_mm = unit_mm.unwrap_or(1.0);
    mesh.positions.iter_mut().flatten().for_each(|x| *x *= unit_mm);
    mesh
}

/// All parts of a STEP file as triangles.
fn step(path: &Path, chord_mm: f64) -> Result<MeshBuffers, RunError> {
    let parts = occt::read_step(path)
        .map_err(|e| RunError::Input(format!("{e}; export it again as STEP AP203, AP214 or AP242")))?;
    let mut all = MeshBuffers::default();
    for part in &parts {
        let mesh = occt::triangulate(&part.shape, chord_mm, ANGLE_RAD).map_err(|e| unreadable(path, &e))?;
        let first = all.positions.len() as u32;
        all.positions.extend(mesh.positions);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| first + i)));
    }
    if all.triangles.is_empty() {
        return Err(RunError::in_file(path, None, "holds no face; export surfaces or solids"));
    }
    Ok(all)
}

/// The folded form of a FOLD file.
fn fold(path: &Path, unit_mm: Option<f64>) -> Result<MeshBuffers, RunError> {
    let bytes = std::fs::read(path)
        .map_err(|e| RunError::in_file(path, None, format!("cannot be read: {e}; check the path")))?;
    let mesh = softfold_pattern::read_folded(&bytes, None, unit_mm, &mut Vec::new())
        .map_err(|e| RunError::from_issue(path, e.issue()))?;
    Ok(MeshBuffers {
        positions: mesh.positions.iter().map(|p| p.to_array()).collect(),
        triangles: mesh.triangles,
    })
}
