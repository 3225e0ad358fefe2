//! The demonstration: the sculpture from pattern to mold.

use std::path::Path;
use std::time::SystemTime;

use crate::chore::{Chores, Failure, cargo, command, root, target};
use crate::packages;

const PROJECT: &str = "fixtures/sculpture/project.toml";
const OUT: &str = "out";

/// What a run leaves in its folder: a name a line, `parts/*.ENDING` where there is at least one of that ending. The
/// end-to-end test reads the same list.
const FILES: &str = include_str!("../../../tests/files.txt");

/// Builds, runs, and checks that every promised file is there.
///
/// # Errors
/// What failed, and how to go on.
pub(crate) fn run(chores: &mut Chores) -> Result<(), Failure> {
    let begun = SystemTime::now();
    packages::install(chores)?;
    let build = cargo(&["build", "--release", "-p", "softfold"]);
    chores.run("build", build, "The first error above says which file or library.")?;
    let softfold = command(target().join("release/softfold"), &["run", PROJECT, "--out", OUT]);
    chores.run("softfold run", softfold, "softfold's message above names the culprit.")?;
    let folder = root().join(OUT);
    let missing = missing(&folder, begun);
    if !missing.is_empty() {
        let what = format!("absent, empty, or left from an earlier run: {}", missing.join(", "));
        return Err(Failure::new(what, "A defect of softfold: please report it with report.json."));
    }
    print_guide(&folder);
    Ok(())
}

/// The promised files that are absent, empty, or older than this run.
fn missing(folder: &Path, begun: SystemTime) -> Vec<String> {
    let written = |name: &str| match name.split_once("/*.") {
        Some((inner, ending)) => holds(&folder.join(inner), ending, begun),
        None => is_written(&folder.join(name), begun),
    };
    FILES.lines().filter(|name| !written(name)).map(str::to_owned).collect()
}

fn is_written(file: &Path, begun: SystemTime) -> bool {
    let fresh = |data: std::fs::Metadata| data.len() > 0 && data.modified().is_ok_and(|time| time >= begun);
    file.metadata().is_ok_and(fresh)
}

fn holds(folder: &Path, ending: &str, begun: SystemTime) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let fits = |path: &Path| path.extension().is_some_and(|e| e == ending) && is_written(path, begun);
    entries.map(|entry| entry.path()).any(|path| fits(&path))
}

fn print_guide(folder: &Path) {
    println!("\nEverything is in {}. To look at:", folder.display());
    for (file, what) in [
        ("report.html", "figures, pictures and verdicts, in any browser"),
        ("folded.ply", "the folded sheet, coloured by its area error (MeshLab, Blender)"),
        ("board.step", "the thick object as a solid (any CAD program)"),
        ("mold.step", "the mold that makes it; parts/ has it in printable pieces"),
        ("waffle.dxf", "the boards that carry the mold, nested for the mill"),
    ] {
        println!("  {OUT}/{file:<14} {what}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn absent_empty_and_old_files_are_told() {
        let folder = target().join("tmp/xtask-demo-files");
        let _ = std::fs::remove_dir_all(&folder); // absent on the first run
        std::fs::create_dir_all(folder.join("parts")).unwrap();
        std::fs::write(folder.join("pattern.svg"), "<svg/>").unwrap();
        std::fs::write(folder.join("flat.obj"), "").unwrap();
        std::fs::write(folder.join("parts/A1.stl"), "solid").unwrap();
        let says = |begun, name: &str| missing(&folder, begun).contains(&name.to_owned());
        let before = SystemTime::now() - Duration::from_secs(60);
        assert!(!says(before, "pattern.svg") && says(before, "flat.obj") && says(before, "folded.obj"));
        assert!(!says(before, "parts/*.stl") && says(before, "parts/*.3mf"));
        let after = SystemTime::now() + Duration::from_secs(60);
        assert!(says(after, "pattern.svg") && says(after, "parts/*.stl"));
    }
}
