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
    record: &'static str,
}

/// The file of a run that lists its files.
const REPORT: &str = "report.json";

impl Staging {
    /// An empty folder beside `target`, whose parents are made if need be.
    ///
    /// # Errors
    /// A place that cannot be written, or a target that is a file.
    pub fn beside(target: &Path) -> Result<Self, RunError> {
        Self::recorded(target, REPORT)
    }

    /// The same for files that another record than the report lists, under its key `files`.
    ///
    /// # Errors
    /// As [`Staging::beside`].
    pub fn recorded(target: &Path, record: &'static str) -> Result<Self, RunError> {
        if target.exists() && !target.is_dir() {
            return Err(RunError::in_file(target, None, "is a file; give --out a folder"));
        }
        let name = target.file_name().map_or_else(|| "out".to_owned(), |n| n.to_string_lossy().into_owned());
        let parent = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = parent.join(format!(".{name}.part-{}", std::process::id()));
        fs::create_dir_all(&folder).map_err(|e| unwritable(&folder, &e))?;
        remember(Some(folder.clone()));
        Ok(Self { folder, target: target.to_owned(), record })
    }

    /// Finds out before a long run whether its results can be written, and leaves nothing behind.
    ///
    /// # Errors
    /// As [`Staging::beside`]; a file of the user's where one of `names` would be written.
    pub fn rehearse(target: &Path, names: &[&str]) -> Result<(), RunError> {
        Self::beside(target)?;
        let ours = earlier_files(target, REPORT);
        match names.iter().find(|n| !ours.contains(**n) && target.join(n).symlink_metadata().is_ok()) {
            Some(name) => Err(not_ours(&target.join(name))),
            None => Ok(()),
        }
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
    /// this run did not make. Files that are not softfold's stay. If a file cannot be put in its place, those that were
    /// replaced before it come back.
    ///
    /// # Errors
    /// A place that cannot be written.
    pub fn publish(self) -> Result<(), RunError> {
        let new = names(&self.folder);
        let old = earlier_files(&self.target, self.record);
        let mut swaps = Swaps { backup: self.folder.join(".replaced"), done: Vec::new() };
        for name in &new {
            let place = self.target.join(name);
            let foreign = !old.contains(name) && place.symlink_metadata().is_ok();
            let swapped = if foreign {
                Err(not_ours(&place))
            } else {
                swaps.swap(&self.folder.join(name), &place, name)
            };
            if let Err(error) = swapped {
                swaps.undo();
                return Err(error);
            }
        }
        for stale in old.difference(&new) {
            let _ = fs::remove_file(self.target.join(stale)); // already gone is as good
        }
        Ok(())
    }
}

/// Files put in their places, with what stood there kept until all are.
struct Swaps {
    backup: PathBuf,
    /// Place of the new file, and the old one if there was one.
    done: Vec<(PathBuf, Option<PathBuf>)>,
}

impl Swaps {
    fn swap(&mut self, from: &Path, to: &Path, name: &str) -> Result<(), RunError> {
        let make_room =
            |p: &Path| p.parent().map_or(Ok(()), fs::create_dir_all).map_err(|e| unwritable(p, &e));
        make_room(to)?;
        let kept = match to.symlink_metadata() {
            Ok(found) if found.is_dir() => {
                return Err(unwritable(to, &std::io::Error::other("a folder of this name is there")));
            }
            Ok(_) => {
                let kept = self.backup.join(name);
                make_room(&kept)?;
                fs::rename(to, &kept).map_err(|e| unwritable(to, &e))?;
                Some(kept)
            }
            Err(_) => None,
        };
        self.done.push((to.to_owned(), kept));
        fs::rename(from, to).map_err(|e| unwritable(to, &e))
    }

    fn undo(&mut self) {
        for (place, kept) in self.done.drain(..).rev() {
            let _ = fs::remove_file(&place);
            kept.into_iter().for_each(|k| {
                let _ = fs::rename(k, &place);
            });
        }
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

fn not_ours(path: &Path) -> RunError {
    RunError::in_file(
        path,
        None,
        "is there and no earlier run made it; choose another --out, or move the file away",
    )
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

/// All that matters here of a report or another record of files.
#[derive(serde::Deserialize)]
struct Record {
    files: Vec<crate::report::json::File>,
}

/// Files that the record in a folder says an earlier run made; only plain names below the folder count.
fn earlier_files(folder: &Path, record: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(folder.join(record)).unwrap_or_default();
    let files = serde_json::from_str::<Record>(&text).map(|r| r.files).unwrap_or_default();
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
            "files":[{"path":"report.json","purpose":""},{"path":"parts/Z9.stl","purpose":""},{"path":"../../precious","purpose":""}],"stages":[]}"#;
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
    fn what_was_there_comes_back_if_a_place_is_taken() {
        let root = folder("restore");
        let target = root.join("out");
        fs::create_dir_all(target.join("sheet.step")).unwrap(); // a folder where a file should go
        let report = r#"{"schema":"s","version":"0","pattern":{"name":"","creases":[],"area_mm2":0,"issues":[]},"verdicts":[],
            "files":[{"path":"board.step","purpose":""},{"path":"sheet.step","purpose":""}],"stages":[]}"#;
        fs::write(target.join("board.step"), "old").unwrap();
        fs::write(target.join("report.json"), report).unwrap();
        let staging = Staging::beside(&target).unwrap();
        for name in ["blank.dxf", "board.step", "sheet.step"] {
            staging.write(name, "new").unwrap();
        }
        let error = staging.publish().unwrap_err();
        assert!(error.to_string().contains("sheet.step"), "{error}");
        assert_eq!(names(&target).into_iter().collect::<Vec<_>>(), ["board.step", "report.json"]);
        assert_eq!(fs::read_to_string(target.join("board.step")).unwrap(), "old");
        assert_eq!(fs::read_dir(&root).unwrap().count(), 1);
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn files_of_the_user_are_never_replaced() {
        let root = folder("foreign");
        let target = root.join("out");
        fs::create_dir_all(&target).unwrap();
        fs::write(target.join("pattern.svg"), "mine").unwrap();
        assert!(
            Staging::rehearse(&target, &["pattern.svg"]).unwrap_err().to_string().contains("pattern.svg")
        );
        let staging = Staging::beside(&target).unwrap();
        staging.write("blank.dxf", "new").unwrap();
        staging.write("pattern.svg", "new").unwrap();
        assert!(staging.publish().unwrap_err().to_string().contains("pattern.svg"));
        assert_eq!(names(&target).into_iter().collect::<Vec<_>>(), ["pattern.svg"]);
        assert_eq!(fs::read_to_string(target.join("pattern.svg")).unwrap(), "mine");
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn only_names_below_the_folder_are_trusted() {
        assert!(is_inside("parts/A1.stl"));
        assert!(!is_inside("../x") && !is_inside("/etc/x"));
    }
}
