//! The output folder: filled beside its place and swapped in when everything is there.

use crate::RunError;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The staging folder of this process, so that an interrupt can take it away.
static STAGING: Mutex<Option<PathBuf>> = Mutex::new(None);

/// A folder beside the output folder that is filled first; it goes away unless it is published.
pub struct Staging {
    folder: PathBuf,
    target: PathBuf,
}

impl Staging {
    /// An empty folder beside `target`, whose parents are made if need be.
    ///
    /// # Errors
    /// A place that cannot be written, or a target that is a file.
    pub fn beside(target: &Path) -> Result<Self, RunError> {
        if target.exists() && !target.is_dir() {
            return Err(RunError::in_file(target, None, "is a file; give --out a folder"));
        }
        let name = target.file_name().map_or_else(|| "out".to_owned(), |n| n.to_string_lossy().into_owned());
        let parent = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = parent.join(format!(".{name}.part-{}", std::process::id()));
        fs::create_dir_all(&folder).map_err(|e| unwritable(&folder, &e))?;
        remember(Some(folder.clone()));
        Ok(Self { folder, target: target.to_owned() })
    }

    /// Path of a file in the staging folder; folders on the way are made.
    ///
    /// # Errors
    /// A place that cannot be written.
    pub fn path(&self, name: &str) -> Result<PathBuf, RunError> {
        let path = self.folder.join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(|e| unwritable(parent, &e))?;
        }
        Ok(path)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// A place that cannot be written.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), RunError> {
        let path = self.path(name)?;
        fs::write(&path, bytes).map_err(|e| unwritable(&path, &e))
    }

    /// Moves every file into the target folder and takes away those that the report of an earlier run lists there and
    /// this run did not make. Files that are not softfold's stay.
    ///
    /// # Errors
    /// A place that cannot be written.
    pub fn publish(self) -> Result<(), RunError> {
        let new = names(&self.folder);
        let old = earlier_files(&self.target);
        for name in &new {
            let to = self.target.join(name);
            if let Some(parent) = to.parent() {
                fs::create_dir_all(parent).map_err(|e| unwritable(parent, &e))?;
            }
            fs::rename(self.folder.join(name), &to).map_err(|e| unwritable(&to, &e))?;
        }
        for stale in old.difference(&new) {
            let _ = fs::remove_file(self.target.join(stale)); // already gone is as good
        }
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
        remember(None);
    }
}

/// Takes the staging folder away, if there is one: for an interrupt.
pub fn abandon() {
    let folder = STAGING.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take();
    folder.into_iter().for_each(|f| {
        let _ = fs::remove_dir_all(f);
    });
}

fn remember(folder: Option<PathBuf>) {
    *STAGING.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = folder;
}

fn unwritable(path: &Path, error: &std::io::Error) -> RunError {
    RunError::in_file(path, None, format!("cannot be written: {error}; choose another --out"))
}

/// Files below a folder, with `/`.
fn names(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![(folder.to_owned(), String::new())];
    while let Some((at, prefix)) = open.pop() {
        for entry in fs::read_dir(at).into_iter().flatten().flatten() {
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            match entry.path().is_dir() {
                true => open.push((entry.path(), format!("{name}/"))),
                false => drop(found.insert(name)),
            }
        }
    }
    found
}

/// Files that the report in a folder says an earlier run made; only plain names below the folder count.
fn earlier_files(folder: &Path) -> BTreeSet<String> {
    let text = fs::read_to_string(folder.join("report.json")).unwrap_or_default();
    let report = crate::report::json::Report::from_json(&text);
    let files = report.map(|r| r.files).unwrap_or_default();
    files.into_iter().map(|f| f.path).filter(|p| is_inside(p)).collect()
}

fn is_inside(path: &str) -> bool {
    Path::new(path).components().all(|c| matches!(c, std::path::Component::Normal(_)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let f = std::env::temp_dir().join(format!("softfold-output-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&f);
        fs::create_dir_all(&f).unwrap();
        f
    }

    #[test]
    fn nothing_is_left_unless_it_is_published() {
        let root = folder("drop");
        let target = root.join("out");
        let staging = Staging::beside(&target).unwrap();
        staging.write("parts/A1.stl", "x").unwrap();
        drop(staging);
        assert_eq!(fs::read_dir(&root).unwrap().count(), 0);
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn publishing_keeps_foreign_files_and_takes_stale_ones_away() {
        let root = folder("publish");
        let target = root.join("out");
        fs::create_dir_all(target.join("parts")).unwrap();
        let report = r#"{"schema":"s","version":"0","pattern":{"name":"","creases":[],"area_mm2":0,"issues":[]},"verdicts":[],
            "files":[{"path":"parts/Z9.stl","purpose":""},{"path":"../../precious","purpose":""}],"stages":[]}"#;
        for (name, text) in [("report.json", report), ("notes.txt", "mine"), ("parts/Z9.stl", "old")] {
            fs::write(target.join(name), text).unwrap();
        }
        let staging = Staging::beside(&target).unwrap();
        staging.write("report.json", "new").unwrap();
        staging.write("parts/A1.stl", "x").unwrap();
        staging.publish().unwrap();
        let left: Vec<_> = names(&target).into_iter().collect();
        assert_eq!(left, ["notes.txt", "parts/A1.stl", "report.json"]);
        assert_eq!(fs::read_dir(&root).unwrap().count(), 1);
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn only_names_below_the_folder_are_trusted() {
        assert!(is_inside("parts/A1.stl"));
        assert!(!is_inside("../x") && !is_inside("/etc/x"));
    }
}
