//! The outside readers: other people's programs, in a Python environment of their own, that read what softfold writes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::chore::{Chores, Failure, command, root, target};

/// The oldest Python that the pinned readers run on.
const OLDEST_PYTHON: (u32, u32) = (3, 11);

/// Script, and the endings of the files that it reads.
const SCRIPTS: [(&str, &[&str]); 4] = [
    ("step.py", &["step"]),
    ("mesh.py", &["stl", "3mf", "obj", "ply"]),
    ("figures.py", &["ply"]),
    ("dxf.py", &["dxf"]),
];

/// Prepares the readers, and reads a folder with them.
///
/// # Errors
/// What [`prepare`] says, or a script that cannot run.
pub(crate) fn run(chores: &mut Chores, folder: Option<&str>) -> Result<(), Failure> {
    prepare(chores)?;
    let folder = root().join(folder.unwrap_or("out"));
    let files = files_under(&folder);
    for (script, endings) in SCRIPTS {
        let fits =
            |path: &&PathBuf| endings.iter().any(|ending| path.extension().is_some_and(|e| e == *ending));
        let chosen: Vec<&PathBuf> = files.iter().filter(fits).collect();
        if !chosen.is_empty() {
            let mut reader = python(&[&format!("tests/readers/{script}")]);
            reader.args(chosen);
            chores.run(script, reader, "The script could not run.")?;
        }
    }
    Ok(())
}

/// Sets the environment up, and tests the readers themselves on good and faulty files.
///
/// # Errors
/// No Python, no package index, or a reader that fails its own test.
pub(crate) fn prepare(chores: &mut Chores) -> Result<(), Failure> {
    set_up(chores)?;
    let mend = "One of the pinned readers changed, or its script is wrong: see the names above.";
    chores.run("readers' own test", python(&["tests/readers/selftest.py"]), mend)
}

/// Makes the environment when it is not there, or was made from other requirements.
fn set_up(chores: &mut Chores) -> Result<(), Failure> {
    let requirements = "tests/readers/requirements.txt";
    let wanted = fs::read_to_string(root().join(requirements))
        .map_err(|error| Failure::new(format!("{requirements}: {error}"), "The checkout is incomplete."))?;
    let stamp = environment().join("softfold-requirements");
    if fs::read_to_string(&stamp).is_ok_and(|made_from| made_from == wanted) {
        println!("outside readers: ready in {}", short(&environment()));
        return Ok(());
    }
    check_python()?;
    let place = environment();
    let mut make = command("python3", &["-m", "venv", "--clear"]);
    make.arg(&place);
    chores.run("python environment", make, "Debian: apt-get install python3-venv")?;
    chores.run(
        "outside readers",
        python(&["-m", "pip", "install", "--disable-pip-version-check", "--quiet", "-r", requirements]),
        "pip says above why. If it could not reach its package index: check the network, the proxy variables \
         and pip's own configuration, and run again.\n  Without the readers: cargo test --workspace",
    )?;
    fs::write(&stamp, wanted)
        .map_err(|error| Failure::new(format!("{}: {error}", stamp.display()), "Is the disk full?"))
}

/// The environment's folder.
fn environment() -> PathBuf {
    target().join("readers-venv")
}

/// The environment's interpreter, told not to write byte code beside the scripts.
fn python(arguments: &[&str]) -> Command {
    command(environment().join("bin/python"), &[&["-B"], arguments].concat())
}

fn check_python() -> Result<(), Failure> {
    let (major, minor) = OLDEST_PYTHON;
    let probe = format!("import sys, venv; sys.exit(sys.version_info < ({major}, {minor}))");
    if crate::chore::works(command("python3", &["-c", &probe])) {
        return Ok(());
    }
    let what = format!("the outside readers need python3, {major}.{minor} or newer, with its venv module");
    Err(Failure::new(what, "Debian: apt-get install python3 python3-venv"))
}

fn short(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// All files under a folder, sorted; none when it is not there.
fn files_under(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { files.extend(files_under(&path)) } else { files.push(path) }
    }
    files.sort();
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reader_script_is_there() {
        for (script, _) in SCRIPTS {
            assert!(root().join("tests/readers").join(script).is_file(), "{script}");
        }
    }

    #[test]
    fn every_requirement_is_pinned() {
        let text = fs::read_to_string(root().join("tests/readers/requirements.txt")).unwrap();
        let lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
        lines.for_each(|line| assert!(line.contains("=="), "{line}"));
    }
}
