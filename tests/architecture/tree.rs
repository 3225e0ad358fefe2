//! The repository as its owner sees it: what is tracked or about to be, never what was built.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What builds and runs leave behind; `.gitignore` says the same.
const BUILT: [&str; 4] = ["target", "out", ".git", "__pycache__"];

/// The workspace root.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the workspace root")
}

/// Every file of the repository, relative to its root, sorted: by git where it is one, else by walking.
pub(crate) fn files() -> Vec<PathBuf> {
    let root = root();
    let mut files = by_git(&root).unwrap_or_else(|| {
        let mut found = Vec::new();
        walk(&root, &root, &mut found);
        found
    });
    files.retain(|file| root.join(file).is_file());
    files.sort();
    assert!(files.len() > 20, "only {} files found below {}", files.len(), root.display());
    files
}

fn by_git(root: &Path) -> Option<Vec<PathBuf>> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let top = PathBuf::from(git(&["rev-parse", "--show-toplevel"])?.trim_end());
    if top.canonicalize().ok()? != root {
        return None; // an unpacked archive inside somebody else's repository
    }
    let listed = git(&["ls-files", "-z", "--cached", "--others", "--exclude-standard"])?;
    Some(listed.split('\0').filter(|name| !name.is_empty()).map(PathBuf::from).collect())
}

fn walk(root: &Path, folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if BUILT.iter().any(|name| path.ends_with(name)) {
            continue;
        }
        if path.is_dir() {
            walk(root, &path, found);
        } else if let Ok(inside) = path.strip_prefix(root) {
            found.push(inside.to_path_buf());
        }
    }
}

/// A file's text; nothing where it is no text.
pub(crate) fn text(file: &Path) -> Option<String> {
    fs::read_to_string(root().join(file)).ok()
}

/// The crate below `crates/` that a file belongs to.
pub(crate) fn crate_of(file: &Path) -> Option<&str> {
    file.strip_prefix("crates").ok()?.components().next()?.as_os_str().to_str()
}

/// Whether a file ends in one of these.
pub(crate) fn ends_in(file: &Path, endings: &[&str]) -> bool {
    file.extension().is_some_and(|ending| endings.iter().any(|e| ending == *e))
}
