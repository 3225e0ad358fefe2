//! The program `softfold`.
use clap::{Args, Parser, Subcommand};
use softfold::progress::{Bars, Events, Lines, Progress, Quiet};
use softfold::report::{json::Report, summary};
use softfold::{Loaded, RunError, Stage, files, output, starter};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
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

const EXIT_STATUS: &str = "Exit status: 0 done, 1 the input is at fault, 2 wrong command line, 3 a verdict failed (with --strict), \
                           70 a defect of softfold, 130 interrupted.";

#[derive(Subcommand)]
enum Command {
    /// Everything: pattern, bands, mesh, folding, surface, board, mold, files and report
    Run(Job),
    /// Read the project and its pattern, soften the creases, and say what was found
    Check(Project),
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
    /// Compare both triangulations, spade and CGAL; status 3 if they disagree
    Crosscheck(Project),
    /// Write a commented project to begin with into a new folder
    New {
        /// The folder
        folder: PathBuf,
    },
}

#[derive(Args)]
struct Project {
    /// The project file
    project: PathBuf,
    #[command(flatten)]
    voice: Voice,
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
        Command::Check(project) => check(&project),
        Command::Crosscheck(project) => crosscheck(&project),
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
    let loaded = Loaded::read(&job.project)?;
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

fn check(job: &Project) -> Result<u8, RunError> {
    let loaded = Loaded::read(&job.project)?;
    let results = softfold::run(&loaded, Stage::Soften, job.voice.progress().as_mut())?;
    for issue in &results.issues {
        match job.voice.json {
            true => say!("{}", serde_json::json!(softfold::report::json::Issue::from(issue))),
            false => say!("{:?}: {issue}", issue.severity),
        }
    }
    if !job.voice.json && !job.voice.quiet {
        say!("{}: fine; remarks: {}", job.project.display(), results.issues.len());
    }
    Ok(0)
}

fn crosscheck(job: &Project) -> Result<u8, RunError> {
    let loaded = Loaded::read(&job.project)?;
    let results = softfold::run(&loaded, Stage::Mesh, job.voice.progress().as_mut())?;
    let Some(check) = results.mesh.map(|m| m.crosscheck) else { return Ok(0) };
    let agrees = check.agrees();
    if job.voice.json {
        let check = softfold::report::json::Crosscheck::from(&check);
        say!("{}", serde_json::json!({ "event": "crosscheck", "crosscheck": check }));
        return Ok(if agrees { 0 } else { VERDICT_FAILED });
    }
    say!(
        "constraints {}, areas differ by {:.1e}, {} edges differ on cocircular points, {} otherwise",
        if check.constraints_held { "held" } else { "BROKEN" },
        check.area_relative_difference,
        check.cocircular_differences.len(),
        check.other_differences.len()
    );
    check.other_differences.iter().for_each(|p| say!("  at ({:.3}, {:.3}) mm", p.x, p.y));
    Ok(if agrees { 0 } else { VERDICT_FAILED })
}
