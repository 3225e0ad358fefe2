//! `softfold new`: a commented project to begin with.

use crate::RunError;
use std::path::Path;

/// The files of the starter: the sculpture's own.
const FILES: [(&str, &str); 2] = [
    ("project.toml", include_str!("../../../fixtures/sculpture/project.toml")),
    ("pattern.svg", include_str!("../../../fixtures/sculpture/pattern.svg")),
];

/// Writes a commented project with its pattern into `folder`.
///
/// # Errors
/// A file that is there already, a folder that cannot be written.
pub fn write(folder: &Path) -> Result<(), RunError> {
    if let Some((name, _)) = FILES.iter().find(|(name, _)| folder.join(name).exists()) {
        return Err(RunError::in_file(&folder.join(name), None, "is there already; choose another folder"));
    }
    let unwritable = |e: std::io::Error| RunError::in_file(folder, None, format!("cannot be written: {e}"));
    std::fs::create_dir_all(folder).map_err(unwritable)?;
    FILES.iter().try_for_each(|(name, text)| std::fs::write(folder.join(name), text)).map_err(unwritable)
}
