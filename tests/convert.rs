//! `softfold check`, `convert` and `soften` as a user runs them.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;
#[path = "common/readers.rs"]
mod readers;

use common::{Outcome, fixture, fresh, softfold};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Longest distance of a written curve from the drawn one, mm: `--chord-mm` where nothing is said.
const CHORD_MM: f64 = 0.02;

fn run(arguments: &[&str]) -> Outcome {
    softfold(&arguments.iter().map(Path::new).collect::<Vec<_>>())
}

fn path(p: &Path) -> &str {
    p.to_str().expect("a path in UTF-8")
}

/// A new folder of this test.
fn folder(name: &str) -> PathBuf {
    let folder = fresh(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Area and numbers of creases that `check --json` tells of a file.
fn checked(file: &Path) -> Value {
    let said = run(&["check", path(file), "--json"]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let last = said.stdout.lines().last().expect("a line");
    serde_json::from_str(last).expect("JSON")
}

#[test]
fn the_sculpture_goes_through_every_format_and_stays_itself() {
    let folder = folder("convert");
    let drawn = fixture("sculpture/pattern.svg");
    let original = checked(&drawn);
    for name in ["p.svg", "p.fold", "p.dxf", "r12.dxf", "p.cp"] {
        let to = folder.join(name);
        let dxf = if name == "r12.dxf" { "r12" } else { "r2000" };
        let said = run(&["convert", path(&drawn), path(&to), "--dxf", dxf]);
        assert_eq!(said.code, Some(0), "{name}: {}{}", said.stdout, said.stderr);
        let again = checked(&to);
        assert_eq!(again["creases"], original["creases"], "{name}");
        let area = |v: &Value| v["area_mm2"].as_f64().expect("an area");
        // A closed curve within the chord tolerance: the area differs by at most tolerance times length.
        let slack = CHORD_MM * 2.0 * (900.0 + 1800.0);
        assert!((area(&again) - area(&original)).abs() <= slack, "{name}: {again}");
    }
    let exact = |name: &str| checked(&folder.join(name))["area_mm2"].as_f64().unwrap();
    assert!(
        (exact("p.fold") - original["area_mm2"].as_f64().unwrap()).abs() < 1e-3,
        "curves are kept in FOLD"
    );
}

#[test]
fn ezdxf_finds_converted_patterns_clean() {
    let folder = folder("convert-dxf");
    let drawn = fixture("sculpture/pattern.svg");
    let files: Vec<PathBuf> = ["r12", "r2000"].iter().map(|v| folder.join(format!("{v}.dxf"))).collect();
    for (version, file) in ["r12", "r2000"].iter().zip(&files) {
        let said = run(&["convert", path(&drawn), path(file), "--dxf", version]);
        assert_eq!(said.code, Some(0), "{}", said.stderr);
    }
    let Some(facts) = readers::ask("dxf.py", &files) else { return };
    for (file, said) in files.iter().zip(&facts) {
        let name = file.display();
        assert!(said.get("error").is_none(), "{name}: {said}");
        for list in ["errors", "fixes"] {
            assert_eq!(said[list].as_array().map(Vec::len), Some(0), "{name}: {said}");
        }
        assert_eq!(said["twice"], 0, "{name}: {said}");
    }
}

#[test]
fn an_existing_file_is_kept_unless_told_otherwise() {
    let folder = folder("convert-keep");
    let to = folder.join("p.cp");
    std::fs::write(&to, "mine").unwrap();
    let drawn = fixture("sculpture/pattern.svg");
    let said = run(&["convert", path(&drawn), path(&to)]);
    assert_eq!(said.code, Some(1));
    assert!(said.stderr.contains("is there already") && said.stderr.contains("--force"), "{}", said.stderr);
    assert_eq!(std::fs::read_to_string(&to).unwrap(), "mine");
    assert_eq!(run(&["convert", path(&drawn), path(&to), "--force"]).code, Some(0));
    assert!(std::fs::read_to_string(&to).unwrap().starts_with('1'));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "nothing is left beside it");
}

#[test]
fn check_shows_every_issue_with_the_line_and_the_mend() {
    let folder = folder("check-issues");
    let file = folder.join("p.svg");
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200mm\" height=\"100mm\" viewBox=\"0 0 200 100\">\n\
        <rect id=\"o\" width=\"200\" height=\"100\" fill=\"none\" stroke=\"black\"/>\n\
        <line id=\"short\" x1=\"50\" y1=\"0\" x2=\"50\" y2=\"99.5\" stroke=\"red\"/>\n\
        <line id=\"free\" x1=\"120\" y1=\"0\" x2=\"120\" y2=\"60\" stroke=\"blue\"/>\n</svg>\n";
    std::fs::write(&file, svg).unwrap();
    let said = run(&["check", path(&file)]);
    assert_eq!(said.code, Some(0), "{}", said.stderr);
    for part in
        ["p.svg:3", "short", "0.500 mm", "p.svg:4", "inside the sheet", "warnings: 2", "200.0 x 100.0 mm"]
    {
        assert!(said.stdout.contains(part), "{part} in\n{}", said.stdout);
    }
    let json = run(&["check", path(&file), "--json"]).stdout;
    let events: Vec<Value> = json.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert!(events.iter().any(|e| e["line"] == 4 && e["severity"] == "warning"), "{json}");
}

#[test]
fn a_refused_file_lists_all_that_was_found_and_offers_the_mend() {
    let folder = folder("check-refused");
    let file = folder.join("p.svg");
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"100mm\" viewBox=\"0 0 100 100\">\n\
        <path id=\"a\" d=\"M0 0 L100 100\" stroke=\"red\"/>\n<path id=\"b\" d=\"M0 100 L100 0\" stroke=\"blue\"/>\n</svg>\n";
    std::fs::write(&file, svg).unwrap();
    let said = run(&["check", path(&file)]);
    assert_eq!(said.code, Some(1), "{}", said.stdout);
    assert!(said.stderr.contains("outline") && said.stderr.contains("hull"), "{}", said.stderr);
    let hull = run(&["check", path(&file), "--outline", "hull"]);
    assert_eq!(hull.code, Some(0), "{}", hull.stderr);
    assert!(hull.stdout.contains("meet in  1 junctions"), "{}", hull.stdout);
}

#[test]
fn soften_writes_the_bands_with_turns_and_radii() {
    let folder = folder("soften");
    let out = folder.join("bands.svg");
    let said = run(&["soften", path(&fixture("sculpture/project.toml")), "--out", path(&out)]);
    assert_eq!(said.code, Some(0), "{}", said.stderr);
    let svg = std::fs::read_to_string(&out).unwrap();
    for part in ["mountain", "valley", "30"] {
        assert!(svg.contains(part), "{part}");
    }
}
