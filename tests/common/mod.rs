//! What the end-to-end tests share: the program, folders, and what is in them.

#![allow(dead_code, reason = "each test binary uses its part")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How a run of the program ended.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// Runs the program that was built with these tests.
pub(crate) fn softfold(arguments: &[&Path]) -> Outcome {
    let output =
        Command::new(env!("CARGO_BIN_EXE_softfold")).args(arguments).output().expect("softfold starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    Outcome { code: output.status.code(), stdout: text(&output.stdout), stderr: text(&output.stderr) }
}

/// `softfold run PROJECT --out FOLDER`
pub(crate) fn run(project: &Path, out: &Path) -> Outcome {
    softfold(&[Path::new("run"), project, Path::new("--out"), out])
}

/// A folder of the repository's inputs.
pub(crate) fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name)
}

/// A place of this name that does not exist yet, in a folder that does; below cargo's own folder for tests.
pub(crate) fn fresh(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder); // absent on the first run
    fs::create_dir_all(folder.parent().expect("a name below the folder for tests"))
        .expect("a writable target folder");
    folder
}

/// Every file below a folder: its name with `/`, and its bytes.
pub(crate) fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    collect(folder, "", &mut found);
    found
}

fn collect(folder: &Path, prefix: &str, found: &mut BTreeMap<String, Vec<u8>>) {
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let entry = entry.expect("a readable entry");
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(&entry.path(), &format!("{name}/"), found);
        } else {
            found.insert(name, fs::read(entry.path()).expect("a readable file"));
        }
    }
}
