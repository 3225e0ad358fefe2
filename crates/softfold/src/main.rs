//! The program `softfold`.
use clap::{Args, Parser, Subcommand};
use softfold::compare::{self, Align, CompareOptions, Points, What};
use softfold::patterns::{self, WriteOptions};
use softfold::progress::{Bars, Events, Lines, Progress, Quiet};
use softfold::project::{Outline, Read, Roles, Schema, ShapeFormat};
use softfold::report::{json::Report, summary};
use softfold::scan::{self, ScanOptions};
use softfold::{Loaded, RunError, Stage, crosscheck, diagnose, files, output, starter};
use softfold_pattern::{DxfVersion, PatternFile, ReadOptions};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A line on standard output. A closed pipe must not end the run: whoever listens has heard enough.
macro_rules! say {
    ($($words:tt)*) => {{ let _ = writeln!(std::io::stdout(), $($words)*); }};
}

/// A line on standard error, likewise.
macro_rules! warn {
    ($($words:tt)*) => {{ let _ = writeln!(std::io::stderr(), $($words)*); }};
}

/// From a crease pattern with curved creases to a folded, thick, fabricable object.
#[derive(Parser)]
#[command(version, after_help = EXIT_STATUS)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_STATUS: &str = "Exit status: 0 done, 1 the input is at fault, 2 wrong command line, 3 a verdict failed (with --strict; \
                           with --limit-mm for compare), \
                           70 a defect of softfold, 130 interrupted.";

#[derive(Subcommand)]
enum Command {
    /// Everything: pattern, bands, mesh, folding, surface, board, mold, files and report
    Run(Job),
    /// Read a pattern (svg, fold, dxf, cp, opx, ori), or a project with its pattern and bands, and say what was found
    Check(Check),
    /// Write a pattern in another format: svg, fold, dxf or cp, by the ending of the name
    Convert(Convert),
    /// Soften the creases of a project and write the bands as SVG, with turns and radii, to be checked
    Soften(Soften),
    /// Up to the flat mesh
    Mesh(Job),
    /// Up to the folded sheet and its figures
    Fold(Job),
    /// Up to the NURBS surface
    Surface(Job),
    /// Up to the board and how it stands
    Board(Job),
    /// Up to the mold (the same as run)
    Mold(Job),
    /// Compare both triangulations, spade and CGAL, on the lines of a pattern or project and on its mesh; status 3 if they
    /// disagree
    Crosscheck(Check),
    /// Read a scanned surface (ply, obj, stl, off), clean it, make it smaller, and write it
    Scan(Scan),
    /// Say how far a shape is from another: meshes and scans (ply, obj, stl, off), step and fold files, folders of runs
    Compare(Compare),
    /// Write a commented project to begin with into a new folder
    New {
        /// The folder
        folder: PathBuf,
    },
}

#[derive(Args)]
struct Check {
    /// The pattern or the project file
    file: PathBuf,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    voice: Voice,
}

#[derive(Args)]
struct Convert {
    /// The pattern
    from: PathBuf,
    /// The new file
    to: PathBuf,
    #[command(flatten)]
    reading: Reading,
    /// Largest distance between a curve and the lines that stand for it, mm
    #[arg(long, default_value_t = WriteOptions::CHORD_MM)]
    chord_mm: f64,
    /// Version of DXF files
    #[arg(long, default_value = "r2000")]
    dxf: Dxf,
    /// Replace the new file if it is there already
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    voice: Voice,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Dxf {
    R12,
    R2000,
}

/// How a pattern is read; projects say it in [read] and [roles].
#[derive(Args)]
struct Reading {
    /// Millimetres per unit of a file without a physical size
    #[arg(long)]
    unit_mm: Option<f64>,
    /// What is the outline
    #[arg(long)]
    outline: Option<Outline>,
    /// Which of several sheets, from 1 by falling area
    #[arg(long)]
    sheet: Option<usize>,
    /// Which frame of a FOLD file, from 0
    #[arg(long)]
    frame: Option<usize>,
    /// Refit dense polylines by smooth curves within this, mm; 0: never
    #[arg(long)]
    refit_mm: Option<f64>,
    /// Join ends closer than this, mm
    #[arg(long)]
    join_mm: Option<f64>,
    /// Refuse gaps wider than this, mm
    #[arg(long)]
    refuse_mm: Option<f64>,
    /// What a line is: #rrggbb=V, layer:NAME=M or id:NAME=ignore; may be repeated
    #[arg(long = "role", value_name = "KEY=ROLE")]
    roles: Vec<String>,
}

#[derive(Args)]
struct Soften {
    /// The project file
    project: PathBuf,
    /// The SVG to write
    #[arg(long, default_value = "bands.svg")]
    out: PathBuf,
    /// Replace the file if it is there already
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    voice: Voice,
}

#[derive(Args)]
struct Scan {
    /// The mesh
    file: PathBuf,
    /// The mesh to write, in the format of its ending
    #[arg(long)]
    out: PathBuf,
    /// Merge vertices closer than this, mm [default: a millionth of the size]
    #[arg(long)]
    merge_mm: Option<f64>,
    /// Drop pieces with less than this share of the largest one's area
    #[arg(long, default_value_t = ScanOptions::LEAST_SHARE)]
    least_share: f64,
    /// Make it smaller, with no larger error than this, mm
    #[arg(long)]
    decimate_mm: Option<f64>,
    /// Replace the new file if it is there already
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    voice: Voice,
}

#[derive(Args)]
struct Compare {
    /// The shape whose points are measured
    measured: PathBuf,
    /// The shape whose surface they are measured against
    against: PathBuf,
    /// Which result of a folder that a run wrote
    #[arg(long, default_value = "mesh")]
    what: What,
    /// Whether the first is moved onto the second
    #[arg(long, default_value = "auto")]
    align: Align,
    /// Where the first begins: "x y z rx ry rz" (mm; degrees about x, then y, then z) or a matrix by rows [default: found]
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    pose: Option<String>,
    /// Millimetres per unit of meshes, which name none
    #[arg(long)]
    unit_mm: Option<f64>,
    /// Chord error of the triangles that stand for the faces of step files, mm
    #[arg(long, default_value_t = CompareOptions::CHORD_MM)]
    chord_mm: f64,
    /// Measure the vertices, or so many points spread evenly over the area [default: by the size of the triangles]
    #[arg(long, value_name = "vertices|COUNT", value_parser = points)]
    points: Option<Points>,
    /// Measure the second against the first too
    #[arg(long)]
    both: bool,
    /// Leave out points farther off than this, mm
    #[arg(long)]
    leave_out_mm: Option<f64>,
    /// End with status 3 if a distance is larger than this, mm
    #[arg(long)]
    limit_mm: Option<f64>,
    /// Folder for compare.json, the coloured compare.ply, and compare.html
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    voice: Voice,
}

/// Reads the value of `--points`.
fn points(text: &str) -> Result<Points, String> {
    /// Fewer are no picture of a surface, more take minutes.
    const COUNTS: std::ops::RangeInclusive<usize> = 100..=10_000_000;
    match text.parse() {
        _ if text == "vertices" => Ok(Points::Vertices),
        Ok(count) if COUNTS.contains(&count) => Ok(Points::Spread(count)),
        _ => Err(format!("give \"vertices\" or a count from {} to {}", COUNTS.start(), COUNTS.end())),
    }
}

#[derive(Args)]
struct Job {
    /// The project file
    project: PathBuf,
    /// Folder for the results; it is left as it was if the run fails
    #[arg(long, default_value = "out")]
    out: PathBuf,
    /// End with status 3 if a verdict fails
    #[arg(long)]
    strict: bool,
    /// Formats of exact shapes, in place of the project's: step, iges, brep
    #[arg(long = "formats", value_delimiter = ',', value_name = "FORMAT")]
    formats: Vec<ShapeFormat>,
    /// Application protocol of STEP files, in place of the project's
    #[arg(long)]
    step_schema: Option<Schema>,
    #[command(flatten)]
    voice: Voice,
}

#[derive(Args)]
struct Voice {
    /// Say nothing but errors
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
    /// Tell events as JSON, one a line, on standard output
    #[arg(long)]
    json: bool,
}

/// Status when a verdict failed and `--strict` was given.
const VERDICT_FAILED: u8 = 3;
/// Status after an interrupt, as shells have it.
const INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    let cli = Cli::parse();
    // Without the handler an interrupt would leave the staging folder behind, nothing worse.
    let _ = ctrlc::set_handler(|| {
        output::abandon();
        warn!("interrupted: the output folder is as it was");
        std::process::exit(INTERRUPTED);
    });
    // A panic has told its place already; it is a defect, and its status says so.
    let outcome = std::panic::catch_unwind(|| execute(cli.command));
    match outcome.unwrap_or_else(|_| Err(RunError::Defect("softfold stopped in the middle".to_owned()))) {
        Ok(status) => ExitCode::from(status),
        Err(error) => {
            warn!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn execute(command: Command) -> Result<u8, RunError> {
    match command {
        Command::Run(job) | Command::Mold(job) => run(&job, Stage::Mold),
        Command::Mesh(job) => run(&job, Stage::Mesh),
        Command::Fold(job) => run(&job, Stage::Analyse),
        Command::Surface(job) => run(&job, Stage::Surface),
        Command::Board(job) => run(&job, Stage::Stability),
        Command::Check(job) if patterns::format_of(&job.file).is_some() => check_pattern(&job),
        Command::Check(job) => check_project(&job),
        Command::Convert(job) => convert(&job),
        Command::Soften(job) => soften(&job),
        Command::Crosscheck(job) => crosscheck(&job),
        Command::Scan(job) => scan(&job),
        Command::Compare(job) => compare(&job),
        Command::New { folder } => {
            starter::write(&folder)?;
            say!(
                "wrote {0}/project.toml and {0}/pattern.svg; run: softfold run {0}/project.toml",
                folder.display()
            );
            Ok(0)
        }
    }
}

impl Voice {
    fn progress(&self) -> Box<dyn Progress> {
        match (self.quiet, self.json) {
            (true, _) => Box::new(Quiet),
            (_, true) => Box::new(Events(std::io::stdout())),
            _ if std::io::stderr().is_terminal() => Box::new(Bars::default()),
            _ => Box::new(Lines(std::io::stderr())),
        }
    }
}

fn run(job: &Job, until: Stage) -> Result<u8, RunError> {
    let mut loaded = Loaded::read(&job.project)?;
    let export = &mut loaded.project.export;
    export.step_schema = job.step_schema.unwrap_or(export.step_schema);
    if !job.formats.is_empty() {
        export.formats = job.formats.clone();
    }
    output::Staging::rehearse(&job.out, files::FIRST)?;
    let mut progress = job.voice.progress();
    let mut results = softfold::run(&loaded, until, progress.as_mut())?;
    progress.begin("export");
    let start = std::time::Instant::now();
    let report = files::write(&loaded, &mut results, &job.out)?;
    progress.end(
        "export",
        start.elapsed().as_secs_f64(),
        &format!("{} files in {}", report.files.len(), job.out.display()),
    );
    tell(job, &report);
    Ok(if job.strict && !report.passes() { VERDICT_FAILED } else { 0 })
}

fn tell(job: &Job, report: &Report) {
    if job.voice.json {
        say!("{}", serde_json::json!({ "event": "done", "passes": report.passes(), "out": job.out }));
    } else if !job.voice.quiet {
        say!("\n{}", summary(report));
    }
}

impl Reading {
    /// The options, with a fault of the command line as an error.
    fn options(&self) -> Result<ReadOptions, RunError> {
        let mut roles = Roles::default();
        self.roles.iter().try_for_each(|r| roles.add(r)).map_err(RunError::Input)?;
        let lengths =
            [("--unit-mm", self.unit_mm), ("--join-mm", self.join_mm), ("--refuse-mm", self.refuse_mm)];
        let bad = |v: f64| !(v.is_finite() && v > 0.0);
        if let Some((name, v)) = lengths.iter().find_map(|(n, v)| Some((n, (*v).filter(|v| bad(*v))?))) {
            return Err(RunError::Input(format!("{name} is {v}; give a positive length in mm")));
        }
        if let Some(v) = self.refit_mm.filter(|v| !(v.is_finite() && *v >= 0.0)) {
            return Err(RunError::Input(format!("--refit-mm is {v}; give a length in mm, 0 for never")));
        }
        let read = Read {
            unit_mm: self.unit_mm,
            outline: self.outline.unwrap_or_default(),
            sheet: self.sheet,
            frame: self.frame,
            refit_mm: self.refit_mm,
            join_mm: self.join_mm,
            refuse_mm: self.refuse_mm,
        };
        Ok(read.options(roles.map().unwrap_or_default()))
    }
}

/// Tells the issues of a file: as JSON, one a line, or as people read them.
fn tell_issues(issues: &[softfold_geometry::Issue], path: &Path, bytes: &[u8], voice: &Voice) {
    let text = String::from_utf8_lossy(bytes);
    let colour = std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    for issue in issues.iter().filter(|_| !voice.quiet) {
        match voice.json {
            true => say!("{}", serde_json::json!(softfold::report::json::Issue::from(issue))),
            false => say!("{}\n", diagnose::show(issue, &path.display().to_string(), &text, colour)),
        }
    }
}

/// Reads a pattern and tells its issues.
fn read_pattern(path: &Path, reading: &Reading, voice: &Voice) -> Result<PatternFile, RunError> {
    let options = reading.options()?;
    let (bytes, format) = patterns::load(path, "give the path of a pattern")?;
    let read = patterns::read(&bytes, format, path, &options);
    tell_issues(read.as_ref().map_or_else(|e| &e.issues, |f| &f.issues), path, &bytes, voice);
    let file = read.map_err(|e| RunError::from_issue(path, e.error.issue()))?;
    file.pattern.check().map_err(|e| RunError::Defect(e.to_string()))?;
    Ok(file)
}

fn check_pattern(job: &Check) -> Result<u8, RunError> {
    let file = read_pattern(&job.file, &job.reading, &job.voice)?;
    let [notes, warnings, _] = patterns::tally(&file.issues);
    if job.voice.json {
        let p = &file.pattern;
        let (creases, junctions) = (p.creases.len(), p.junctions().len());
        say!(
            "{}",
            serde_json::json!({ "event": "checked", "area_mm2": p.area_mm2(), "creases": creases, "junctions": junctions,
                "holes": p.holes.len(), "slits": p.slits.len(), "notes": notes, "warnings": warnings })
        );
    } else if !job.voice.quiet {
        say!("{}", patterns::describe(&file.pattern));
        say!("{}: readable; notes: {notes}, warnings: {warnings}", job.file.display());
    }
    Ok(0)
}

fn check_project(job: &Check) -> Result<u8, RunError> {
    let loaded = Loaded::read(&job.file)?;
    let results = softfold::run(&loaded, Stage::Soften, job.voice.progress().as_mut())?;
    tell_issues(&results.issues, &loaded.pattern_path, &loaded.pattern_bytes, &job.voice);
    if !job.voice.json && !job.voice.quiet {
        say!("{}: fine; remarks: {}", job.file.display(), results.issues.len());
    }
    Ok(0)
}

fn convert(job: &Convert) -> Result<u8, RunError> {
    if !(job.chord_mm.is_finite() && job.chord_mm > 0.0) {
        return Err(RunError::Input(format!("--chord-mm is {}; give a positive length in mm", job.chord_mm)));
    }
    let file = read_pattern(&job.from, &job.reading, &job.voice)?;
    let dxf = match job.dxf {
        Dxf::R12 => DxfVersion::R12,
        Dxf::R2000 => DxfVersion::R2000,
    };
    let text = patterns::text_of(&file.pattern, &job.to, &WriteOptions { chord_mm: job.chord_mm, dxf })?;
    patterns::write(&job.to, &text, job.force)?;
    if !job.voice.json && !job.voice.quiet {
        say!("{}\nwrote {}", patterns::describe(&file.pattern), job.to.display());
    }
    Ok(0)
}

fn soften(job: &Soften) -> Result<u8, RunError> {
    let loaded = Loaded::read(&job.project)?;
    let results = softfold::run(&loaded, Stage::Soften, job.voice.progress().as_mut())?;
    let (Some(pattern), Some(soft)) = (&results.pattern, &results.soft) else { return Ok(0) };
    patterns::write(&job.out, softfold_soften::write_svg(pattern, soft), job.force)?;
    if !job.voice.json && !job.voice.quiet {
        say!("wrote {}", job.out.display());
    }
    Ok(0)
}

fn crosscheck(job: &Check) -> Result<u8, RunError> {
    let found = match patterns::format_of(&job.file) {
        Some(_) => {
            // The issues of a file are told by `check`.
            let quiet = Voice { quiet: true, json: false };
            crosscheck::of_pattern(&read_pattern(&job.file, &job.reading, &quiet)?.pattern, &job.file)?
        }
        None => crosscheck::of_project(&Loaded::read(&job.file)?, job.voice.progress().as_mut())?,
    };
    if job.voice.json {
        let told = softfold::report::json::Crosschecks::from(&found);
        say!(
            "{}",
            serde_json::json!({ "event": "crosscheck", "agrees": found.agrees(), "crosscheck": told })
        );
    } else if !job.voice.quiet || !found.agrees() {
        say!("{}", found.words().trim_end());
    }
    Ok(if found.agrees() { 0 } else { VERDICT_FAILED })
}

fn scan(job: &Scan) -> Result<u8, RunError> {
    let Scan { merge_mm, least_share, decimate_mm, .. } = *job;
    let scan = scan::scan(&job.file, &ScanOptions { merge_mm, least_share, decimate_mm })?;
    patterns::write(&job.out, scan.file(&job.out)?, job.force)?;
    if job.voice.json {
        let [vertices, triangles] = [scan.mesh.positions.len(), scan.mesh.triangles.len()];
        say!(
            "{}",
            serde_json::json!({ "event": "scanned", "read": scan.read, "merged_vertices": scan.merged_vertices,
                "removed_triangles": scan.removed_triangles, "flipped_triangles": scan.flipped_triangles,
                "pieces": scan.pieces[0], "dropped_pieces": scan.pieces[1], "vertices": vertices, "triangles": triangles,
                "decimation_error_mm": scan.decimated.map(|d| d.1), "volume_mm3": scan.volume_mm3 })
        );
    } else if !job.voice.quiet {
        say!("{}\nwrote {}", scan.words(), job.out.display());
    }
    Ok(0)
}

fn compare(job: &Compare) -> Result<u8, RunError> {
    let options = CompareOptions {
        reading: compare::ReadOptions { what: job.what, unit_mm: job.unit_mm, chord_mm: job.chord_mm },
        align: job.align,
        pose: job.pose.as_deref().map(compare::pose).transpose()?,
        points: job.points.unwrap_or_default(),
        both: job.both,
        leave_out_mm: job.leave_out_mm,
        limit_mm: job.limit_mm,
    };
    let compared = compare::compare(&job.measured, &job.against, &options)?;
    let record = match &job.out {
        Some(out) => compare::write(&compared, out)?,
        None => compare::Record::from(&compared),
    };
    if job.voice.json {
        say!("{}", serde_json::json!({ "event": "compared", "compare": record, "out": job.out }));
    } else if !job.voice.quiet {
        say!("{}", compared.words());
        job.out
            .iter()
            .for_each(|out| say!("wrote compare.json, compare.ply and compare.html in {}", out.display()));
    }
    Ok(if compared.passes() { 0 } else { VERDICT_FAILED })
}
