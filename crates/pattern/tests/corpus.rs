//! The seeds of the fuzz targets and what fuzzing found: each is a pattern that keeps its contract, or a refusal. The same
//! files and the same question as in `fuzz/`, on stable Rust.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests fail by panicking"
)]

use softfold_pattern::{DxfOptions, DxfVersion, Format, ReadOptions, WriteOptions, read};
use std::path::{Path, PathBuf};

fn files(folder: &str) -> Vec<PathBuf> {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(&place).unwrap_or_else(|e| panic!("{}: {e}", place.display())) {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&format!("{folder}/{}", path.file_name().unwrap().to_string_lossy())));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Whether the bytes give a pattern; one that does keeps its contract and can be written in every format.
fn is_read(bytes: &[u8], format: Format, name: &str) -> bool {
    let file = match read(bytes, format, name, &ReadOptions::default()) {
        Ok(file) => file,
        Err(refused) => {
            let issue = refused.error.issue();
            assert!(!issue.message.is_empty() && !issue.mend.is_empty(), "{name}: {refused}");
            return false;
        }
    };
    file.pattern.check().unwrap_or_else(|e| panic!("{name}: {e}"));
    let options = WriteOptions { chord_mm: Some(0.1 * file.pattern.size_mm()) };
    let dxf = DxfOptions { version: DxfVersion::R12, chord_mm: 0.1 * file.pattern.size_mm() };
    let texts = [
        softfold_pattern::write_svg(&file.pattern),
        softfold_pattern::write_fold(&file.pattern, &options),
        softfold_pattern::write_cp(&file.pattern, &options),
        softfold_pattern::write_dxf(&file.pattern, &dxf),
    ];
    assert!(texts.iter().all(|t| !t.is_empty()), "{name}: nothing written");
    true
}

fn format_of(path: &Path) -> Format {
    Format::of_ending(&path.extension().unwrap().to_string_lossy()).expect("an ending of a pattern")
}

#[test]
fn what_fuzzing_found_is_read_or_refused() {
    let found = files("tests/regressions");
    assert!(found.len() >= 3);
    for path in found {
        let _ = is_read(&std::fs::read(&path).unwrap(), format_of(&path), &path.display().to_string());
    }
}

#[test]
fn an_outline_without_area_is_refused() {
    for name in ["outline-without-area.fold", "outline-there-and-back.cp"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/regressions").join(name);
        assert!(!is_read(&std::fs::read(&path).unwrap(), format_of(&path), name), "{name}");
    }
}

#[test]
fn every_seed_survives_what_a_few_broken_bytes_do_to_it() {
    /// Bytes that end numbers, elements, lists and lines early.
    const BROKEN: [u8; 8] = [0, b' ', b'-', b'9', b'"', b'<', b'}', 0xff];
    let seeds = files("fuzz/seeds");
    assert!(seeds.len() >= 6, "a seed a format");
    for path in seeds {
        let bytes = std::fs::read(&path).unwrap();
        let (format, name) = (format_of(&path), path.display().to_string());
        let mut read = usize::from(is_read(&bytes, format, &name));
        for at in (0..bytes.len()).step_by(7) {
            let mut broken = bytes.clone();
            broken[at] = BROKEN[at % BROKEN.len()];
            read += usize::from(is_read(&broken, format, &name));
            let _ = is_read(&bytes[..at], format, &name);
        }
        assert!(read > 0, "{name}: not even one of its neighbours is read");
    }
}
