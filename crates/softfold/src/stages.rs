//! The stages in their order: the only place that knows it.

use crate::progress::Progress;
use crate::project::line_of;
use crate::project::{self, Project};
use crate::states::{self, Beginning, SpringBack, State};
use crate::surfaces;
pub use crate::surfaces::{SubdResult, SurfaceResult};
use crate::{RunError, patterns, softness};
use softfold_fold::{
    Clearance, Goal, Halt, Iteration, LbfgsOptions, Momentum, NewtonOptions, RelaxOptions, Solver, Verdict,
};
use softfold_geometry::{CreasePattern, DVec3, FoldedSheet, Issue, SheetSurface, SoftPattern};
use softfold_kernel::{MeshBuffers, MeshView, cgal};
use softfold_mesh::{Backend, Crosscheck, MeshError, Meshed, Quality};
use softfold_mold::{
    Board, BoardOptions, Mold, MoldError, MoldOptions, Placement, Rest, StockOptions, WaffleOptions,
};
use softfold_pattern::{Format, ReadOptions};
use softfold_soften::SoftenError;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A stage of the run, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Text to pattern.
    Pattern,
    /// Creases to bands.
    Soften,
    /// Bands to a flat mesh.
    Mesh,
    /// Flat mesh to folded sheet.
    Fold,
    /// What folding did to the sheet.
    Analyse,
    /// Folded sheet to NURBS surface.
    Surface,
    /// Surface to thick board.
    Board,
    /// How the board stands.
    Stability,
    /// Surface to mold.
    Mold,
}

impl Stage {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Pattern => "pattern",
            Stage::Soften => "soften",
            Stage::Mesh => "mesh",
            Stage::Fold => "fold",
            Stage::Analyse => "analyse",
            Stage::Surface => "surface",
            Stage::Board => "board",
            Stage::Stability => "stability",
            Stage::Mold => "mold",
        }
    }
}

/// A project with the texts of its files.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// Path of the project file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// What it says.
    pub project: Project,
    /// Path of the pattern.
    pub pattern_path: PathBuf,
    /// The pattern's bytes.
    pub pattern_bytes: Vec<u8>,
    /// Their format.
    pub format: Format,
}

/// How one goal ended.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalFigure {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: &'static str,
    /// Its energy, N·mm.
    pub energy: f64,
    /// Largest |G|: mm, or rad for hinges.
    pub residual: f64,
}

/// The mesh stage's results.
pub struct MeshResult {
    /// Mesh and graph.
    pub meshed: Meshed,
    /// Angles.
    pub quality: Quality,
    /// spade against CGAL.
    pub crosscheck: Crosscheck,
    /// Which one made the mesh.
    pub backend: Backend,
}

/// The fold stage's results.
pub struct FoldResult {
    /// The folded sheet.
    pub sheet: FoldedSheet,
    /// What each goal contributes.
    pub goals: Vec<GoalFigure>,
    /// All states in order where there is more than one; the last is the folded sheet.
    pub states: Vec<State>,
    /// What creases kept when they were let go.
    pub spring_back: Vec<SpringBack>,
}

/// The analyse stage's results.
pub struct AnalyseResult {
    /// Figures.
    pub verdict: Verdict,
    /// Pairs of triangles that pass through each other.
    pub self_intersections: usize,
    /// Nearest places of the sheet that are no neighbours, if they are nearer than a few thicknesses.
    pub clearance: Option<Clearance>,
}

/// Everything a run has made so far.
#[derive(Default)]
pub struct Results {
    /// Remarks about the pattern.
    pub issues: Vec<Issue>,
    /// The pattern.
    pub pattern: Option<CreasePattern>,
    /// The bands.
    pub soft: Option<SoftPattern>,
    /// The mesh.
    pub mesh: Option<MeshResult>,
    /// The folded sheet.
    pub fold: Option<FoldResult>,
    /// Its figures.
    pub analyse: Option<AnalyseResult>,
    /// The surface.
    pub surface: Option<SurfaceResult>,
    /// The board.
    pub board: Option<Board>,
    /// How it stands.
    pub stability: Option<Rest>,
    /// The mold.
    pub mold: Option<Mold>,
    /// Volume of the mold from triangles swept by CGAL, mm³.
    pub mold_mesh_volume_mm3: f64,
    /// Size of the stock sheets of its boards, mm.
    pub stock_mm: [f64; 2],
    /// Stages with their times, s.
    pub seconds: Vec<(&'static str, f64)>,
}

impl Loaded {
    /// Reads a project and its pattern.
    ///
    /// # Errors
    /// Files that cannot be read, a project that is at fault.
    pub fn read(path: &Path) -> Result<Self, RunError> {
        if patterns::format_of(path).is_some() {
            let mend = "is a pattern; give a project file that names it with `pattern =` (`softfold new` writes one)";
            return Err(RunError::in_file(path, None, mend));
        }
        let text = read_text(path, "give the path of a project file; `softfold new` writes one")?;
        let project = Project::parse(&text).map_err(|f| RunError::in_file(path, f.line, f.message))?;
        let pattern_path = path.parent().unwrap_or(Path::new("")).join(&project.pattern);
        let asked = line_of(&text, "", "pattern");
        let mend = format!(
            "check `pattern` in {}{}",
            path.display(),
            asked.map(|l| format!(":{l}")).unwrap_or_default()
        );
        let (pattern_bytes, format) = patterns::load(&pattern_path, &mend)?;
        Ok(Self { path: path.to_owned(), text, project, pattern_path, pattern_bytes, format })
    }

    /// The project's name: its own, or its pattern's.
    pub fn name(&self) -> String {
        let stem = |p: &Path| p.file_stem().map(|s| s.to_string_lossy().into_owned());
        self.project
            .name
            .clone()
            .or_else(|| stem(&self.pattern_path))
            .unwrap_or_else(|| "softfold".to_owned())
    }

    /// How the project wants its pattern read.
    ///
    /// # Errors
    /// Roles that are none.
    pub fn read_options(&self) -> Result<ReadOptions, RunError> {
        let roles = self.project.roles.map().map_err(|(table, key, message)| {
            RunError::in_file(&self.path, line_of(&self.text, table, &key), message)
        })?;
        Ok(self.project.read.options(roles))
    }

    pub(crate) fn fault(&self, table: &str, key: &str, message: impl std::fmt::Display) -> RunError {
        RunError::in_file(&self.path, line_of(&self.text, table, key), message)
    }
}

fn read_text(path: &Path, mend: &str) -> Result<String, RunError> {
    let bytes = std::fs::read(path)
        .map_err(|e| RunError::in_file(path, None, format!("cannot be read: {e}; {mend}")))?;
    String::from_utf8(bytes)
        .map_err(|_| RunError::in_file(path, None, "is no text (UTF-8); give a text file"))
}

/// Runs the stages up to `until`.
///
/// # Errors
/// The first fault, with its place and mend.
pub fn run(loaded: &Loaded, until: Stage, progress: &mut dyn Progress) -> Result<Results, RunError> {
    let steps: [(Stage, StepFn); 9] = [
        (Stage::Pattern, pattern),
        (Stage::Soften, soften),
        (Stage::Mesh, mesh),
        (Stage::Fold, fold),
        (Stage::Analyse, analyse),
        (Stage::Surface, surfaces::surface),
        (Stage::Board, board),
        (Stage::Stability, stability),
        (Stage::Mold, mold),
    ];
    if until >= Stage::Mold {
        // A mold that cannot be is better refused before the minutes that lead to it.
        mold_options(&loaded.project).check().map_err(|e| mold_fault(loaded, &e))?;
    }
    let mut results = Results::default();
    for (stage, step) in steps.into_iter().filter(|(s, _)| *s <= until) {
        progress.begin(stage.name());
        let start = Instant::now();
        let word = step(loaded, &mut results, progress)?;
        let seconds = start.elapsed().as_secs_f64();
        results.seconds.push((stage.name(), seconds));
        progress.end(stage.name(), seconds, &word);
        if stage == Stage::Pattern && until >= Stage::Board {
            refuse_slits(loaded, made(results.pattern.as_ref())?)?;
        }
    }
    Ok(results)
}

/// Board and mold are made of one smooth face, which follows no slit: told before the minutes that lead to them.
fn refuse_slits(loaded: &Loaded, pattern: &CreasePattern) -> Result<(), RunError> {
    let Some(slit) = pattern.slits.first() else { return Ok(()) };
    let p = slit.end(0);
    let message = format!(
        "the sheet has {} slit(s), the first from ({:.3}, {:.3}) mm; boards and molds are made of sheets without them: make its \
         surface with `softfold surface`, or draw narrow holes in their place",
        pattern.slits.len(),
        p.x,
        p.y
    );
    Err(RunError::in_file(&loaded.pattern_path, None, message))
}

/// A stage: takes what is there, adds its own, and says it in a few words.
type StepFn = fn(&Loaded, &mut Results, &mut dyn Progress) -> Result<String, RunError>;

/// A stage's input that an earlier stage must have made.
pub(crate) fn made<T>(value: Option<&T>) -> Result<&T, RunError> {
    value.ok_or_else(|| RunError::Defect("a stage ran before its input was made".to_owned()))
}

pub(crate) fn defect(error: impl std::fmt::Display) -> RunError {
    RunError::Defect(error.to_string())
}

fn pattern(loaded: &Loaded, results: &mut Results, _: &mut dyn Progress) -> Result<String, RunError> {
    let file =
        softfold_pattern::read(&loaded.pattern_bytes, loaded.format, &loaded.name(), &loaded.read_options()?)
            .map_err(|e| RunError::from_issue(&loaded.pattern_path, e.error.issue()))?;
    let word = format!("creases: {}, remarks: {}", file.pattern.creases.len(), file.issues.len());
    file.pattern.check().map_err(defect)?;
    (results.pattern, results.issues) = (Some(file.pattern), file.issues);
    Ok(word)
}

fn soften(loaded: &Loaded, results: &mut Results, _: &mut dyn Progress) -> Result<String, RunError> {
    let pattern = made(results.pattern.as_ref())?;
    let softness = softness::of_all(loaded, pattern, &mut results.issues)?;
    let soft = softfold_soften::soften(pattern, &softness).map_err(|e| soften_fault(loaded, &e))?;
    soft.check().map_err(defect)?;
    let lines: usize = soft.bands.iter().map(|b| b.fold_lines.len()).sum();
    results.soft = Some(soft);
    Ok(format!("{lines} fold lines"))
}

fn soften_fault(loaded: &Loaded, error: &SoftenError) -> RunError {
    let issue = error.issue();
    let mut wrapped = issue.clone();
    wrapped.line = None;
    let place = match issue.line {
        Some(line) => format!("{}:{line}", loaded.pattern_path.display()),
        None => loaded.pattern_path.display().to_string(),
    };
    loaded.fault("soften", "radius_mm", format!("{wrapped} [{place}]"))
}

fn mesh(loaded: &Loaded, results: &mut Results, progress: &mut dyn Progress) -> Result<String, RunError> {
    let options = loaded.project.mesh.options();
    let backend = options.backend;
    let meshed =
        softfold_mesh::mesh(made(results.soft.as_ref())?, &options).map_err(|e| mesh_fault(loaded, &e))?;
    progress.advance(Some(0.8), "spade against CGAL");
    let crosscheck = softfold_mesh::crosscheck(&meshed.graph).map_err(defect)?;
    let quality = softfold_mesh::quality(&meshed.mesh);
    let word =
        format!("{} vertices, smallest angle {:.0}°", meshed.mesh.vertices.len(), quality.min_angle_deg);
    results.mesh = Some(MeshResult { meshed, quality, crosscheck, backend });
    Ok(word)
}

fn mesh_fault(loaded: &Loaded, error: &MeshError) -> RunError {
    match error {
        MeshError::Option { name, .. } => loaded.fault("mesh", name, error),
        MeshError::TooMany { .. } => loaded.fault("mesh", "target_edge_mm", error),
        MeshError::Crossing { .. } | MeshError::Triangulation(_) => RunError::in_file(
            &loaded.pattern_path,
            None,
            format!("{error}; look for lines that touch or lie on each other"),
        ),
        other => defect(other),
    }
}

fn fold(loaded: &Loaded, results: &mut Results, progress: &mut dyn Progress) -> Result<String, RunError> {
    let mesh = &made(results.mesh.as_ref())?.meshed.mesh;
    let pattern = made(results.pattern.as_ref())?;
    let start = match loaded.project.fold.start {
        project::Start::Upright => softfold_fold::upright(mesh),
        project::Start::Flat => mesh.vertices.iter().map(|p| p.extend(0.0)).collect(),
    };
    let halt = Halt::default();
    let began = Instant::now();
    let most_s = loaded.project.fold.max_seconds.unwrap_or(f64::INFINITY);
    let beginning = Beginning { mesh, pattern, start, solver: solver(&loaded.project.fold, &halt) };
    let mut watch = |state: &str, i: Iteration<'_>| {
        let word = format!("{state}, iteration {}, relative gradient {:.0e}", i.number, i.relative_gradient);
        progress.advance(None, &word);
        if began.elapsed().as_secs_f64() > most_s {
            halt.set();
        }
    };
    let mut course = states::fold_all(loaded, beginning, &mut watch)?;
    let sheet = made(course.states.last())?.sheet.clone();
    let word = format!("{} iterations, {}", sheet.solve.iterations, sheet.solve.stop);
    let goals = course.goals.iter().map(|g| figure(g.as_ref(), &sheet)).collect();
    if course.states.len() == 1 {
        course.states.clear(); // the result says it all
    }
    results.fold = Some(FoldResult { sheet, goals, states: course.states, spring_back: course.spring_back });
    Ok(word)
}

fn figure(goal: &dyn Goal, sheet: &FoldedSheet) -> GoalFigure {
    let x = &sheet.positions;
    GoalFigure {
        name: goal.name().to_owned(),
        kind: goal.kind(),
        energy: goal.energy(x),
        residual: goal.residual(x),
    }
}

fn solver(fold: &project::Fold, halt: &Halt) -> Solver {
    let halt = halt.clone();
    match fold.solver {
        project::Solver::Newton => {
            let usual = NewtonOptions::default();
            Solver::Newton(NewtonOptions {
                relative_gradient: fold.relative_gradient.unwrap_or(usual.relative_gradient),
                max_iterations: fold.max_iterations.unwrap_or(usual.max_iterations),
                halt,
                ..usual
            })
        }
        project::Solver::Lbfgs => {
            let usual = LbfgsOptions::default();
            Solver::Lbfgs(LbfgsOptions {
                relative_gradient: fold.relative_gradient.unwrap_or(usual.relative_gradient),
                max_iterations: fold.max_iterations.unwrap_or(usual.max_iterations),
                halt,
                ..usual
            })
        }
        project::Solver::Relax => {
            let usual = RelaxOptions::default();
            Solver::Relax(RelaxOptions {
                momentum: fold.momentum.map_or(usual.momentum, Momentum::Share),
                relative_gradient: fold.relative_gradient.unwrap_or(usual.relative_gradient),
                max_iterations: fold.max_iterations.unwrap_or(usual.max_iterations),
                halt,
            })
        }
    }
}

/// Distances of the sheet from itself are told up to this many thicknesses.
const CLEARANCE_WITHIN: f64 = 3.0;

fn analyse(loaded: &Loaded, results: &mut Results, progress: &mut dyn Progress) -> Result<String, RunError> {
    let sheet = &made(results.fold.as_ref())?.sheet;
    let verdict = softfold_fold::analyse(sheet);
    progress.advance(Some(0.5), "self-intersections");
    let positions: Vec<[f64; 3]> = sheet.positions.iter().map(|p| p.to_array()).collect();
    let triangles: Vec<[u32; 3]> = sheet.mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect();
    let pairs = cgal::self_intersections(MeshView { positions: &positions, triangles: &triangles })
        .map_err(defect)?;
    let [lo, hi] = verdict.area_error;
    let thickness_mm = loaded.project.board.thickness_mm;
    let clearance = softfold_fold::self_clearance(sheet, thickness_mm, CLEARANCE_WITHIN * thickness_mm);
    results.analyse = Some(AnalyseResult { verdict, self_intersections: pairs.len(), clearance });
    Ok(format!("area error {:+.2} % to {:+.2} %", 100.0 * lo.value, 100.0 * hi.value))
}

fn board(loaded: &Loaded, results: &mut Results, _: &mut dyn Progress) -> Result<String, RunError> {
    let wanted = &loaded.project.board;
    let options = BoardOptions {
        thickness_mm: wanted.thickness_mm,
        density_kg_m3: loaded.project.material.density_kg_m3,
        placement: placement(&loaded.project),
    };
    let sheet = smooth(results)?;
    let mut board = softfold_mold::make_board(sheet, &options).map_err(|e| mold_fault(loaded, &e))?;
    if let Some(height_mm) = wanted.trim_ground_mm {
        board = softfold_mold::trim_ground(board, height_mm).map_err(|e| mold_fault(loaded, &e))?;
    }
    let word = format!("{:.1} kg", board.mass_kg);
    results.board = Some(board);
    Ok(word)
}

/// Where the sheet's surface lies in the board.
pub(crate) fn placement(project: &Project) -> Placement {
    match project.board.placement {
        project::Placement::Mid => Placement::Mid,
        project::Placement::Lower => Placement::Lower,
        project::Placement::Upper => Placement::Upper,
    }
}

/// The one smooth face.
fn smooth(results: &Results) -> Result<&SheetSurface, RunError> {
    Ok(&made(made(results.surface.as_ref())?.fitted.as_ref())?.surface)
}

/// Errors of the board and the mold are the input's unless a library failed; they know the key that mends them.
fn mold_fault(loaded: &Loaded, error: &MoldError) -> RunError {
    let (table, key) = error.place();
    if error.is_defect() { defect(error) } else { loaded.fault(table, key, error) }
}

/// Step between the points that may touch the ground, mm.
const CONTACT_STEP_MM: f64 = 4.0;

fn stability(loaded: &Loaded, results: &mut Results, _: &mut dyn Progress) -> Result<String, RunError> {
    let contact_mm = loaded.project.stability.contact_mm;
    let rest = softfold_mold::rest_of_board(made(results.board.as_ref())?, CONTACT_STEP_MM, contact_mm)
        .map_err(|e| mold_fault(loaded, &e))?;
    let word = format!(
        "{}, margin {:.0} mm",
        if rest.stability.stable { "stands" } else { "falls" },
        rest.stability.margin_mm
    );
    results.stability = Some(rest);
    Ok(word)
}

/// What the project asks of the mold.
fn mold_options(project: &Project) -> MoldOptions {
    let (m, w) = (&project.mold, &project.waffle);
    let waffle = WaffleOptions {
        board_mm: w.board_mm,
        pitch_mm: w.pitch_mm,
        angle_deg: w.angle_deg,
        clearance_mm: w.clearance_mm,
        cutter_mm: w.cutter_mm,
        stock: StockOptions { size_mm: w.stock_mm, ..StockOptions::default() },
        ..WaffleOptions::default()
    };
    MoldOptions {
        thickness_mm: m.thickness_mm,
        cell_mm: m.cell_mm,
        printer_mm: m.printer_mm,
        waffle: Some(waffle),
        ..MoldOptions::default()
    }
}

fn mold(loaded: &Loaded, results: &mut Results, progress: &mut dyn Progress) -> Result<String, RunError> {
    let project = &loaded.project;
    let surface = made(results.surface.as_ref())?;
    let mut watch = |done: f64| progress.advance(Some(done), "parts");
    let mold = softfold_mold::make_mold_watched(smooth(results)?, &mold_options(project), &mut watch)
        .map_err(|e| mold_fault(loaded, &e))?;
    let word = format!("{} parts, {} boards", mold.parts.len(), mold.waffle.boards.len());
    results.mold_mesh_volume_mm3 = mesh_volume_mm3(&surface.face_mesh, &mold, project.mold.thickness_mm)?;
    (results.mold, results.stock_mm) = (Some(mold), project.waffle.stock_mm);
    Ok(word)
}

/// Volume of the mold by another way: the face's triangles swept by CGAL.
fn mesh_volume_mm3(face: &MeshBuffers, mold: &Mold, thickness_mm: f64) -> Result<f64, RunError> {
    let down = mold.pose.mold_from_sheet.inverse().rotation * DVec3::new(0.0, 0.0, -thickness_mm);
    let swept = cgal::extrude(face.view(), down.to_array()).map_err(defect)?;
    Ok(cgal::closed_check(swept.view()).map_err(defect)?.volume_mm3.abs())
}
