//! The folder `../shared` beside the checkout: closed forms, and other people's patterns. Where it is absent each test says
//! so and ends; `.ci/run` refuses to begin without it.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Says something that the test harness would keep to itself.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// A folder of `../shared`; none, and a word about it, where there is no such folder.
pub(crate) fn shared(test: &str, folder: &str) -> Option<PathBuf> {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(folder);
    if !place.is_dir() {
        say(&format!("\n*** skipped: {test}: there is no folder ../shared/{folder} beside the checkout ***"));
        return None;
    }
    Some(place)
}

/// Every file below a folder with one of these endings, sorted.
pub(crate) fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            found.extend(files(&path, endings));
        } else if path.extension().is_some_and(|e| endings.iter().any(|w| e == *w)) {
            found.push(path);
        }
    }
    found.sort();
    found
}
