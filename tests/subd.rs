//! `surface.form = "subd"`: a quad cage that ends on the outline, from the pattern to the files, read by other programs.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;
#[path = "common/facts.rs"]
mod facts;
#[path = "common/readers.rs"]
mod readers;

use common::{fixture, fresh, softfold};
use facts::{number, product};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Largest distance of the surface from the folded vertices, mm.
const DEVIATION_MM: f64 = 0.05;

/// A fixture with its surface by subdivision; gives the folder of results.
fn run(name: &str, keys: &str) -> PathBuf {
    let project = fresh(&format!("{name}-subd-project"));
    std::fs::create_dir_all(&project).expect("folder");
    let text = std::fs::read_to_string(fixture(name).join("project.toml")).expect("project");
    let text = match text.contains("form = \"lattice\"") {
        true => text.replace("form = \"lattice\"", "form = \"subd\""),
        false => format!("{text}\n[surface]\nform = \"subd\"\n{keys}"),
    };
    std::fs::write(project.join("project.toml"), text).expect("project");
    std::fs::copy(fixture(name).join("pattern.svg"), project.join("pattern.svg")).expect("pattern");
    let out = fresh(&format!("{name}-subd"));
    let said = softfold(&[Path::new("surface"), &project.join("project.toml"), Path::new("--out"), &out]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    assert!(said.stdout.contains("cage of"), "{}", said.stdout);
    out
}

/// What is asked of every cage; gives the report.
fn good_cage(name: &str, keys: &str) -> Value {
    let out = run(name, keys);
    let text = std::fs::read_to_string(out.join("report.json")).expect("report.json");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let at = |pointer: &str| number(report.pointer(pointer).unwrap_or_else(|| panic!("no {pointer}")));
    assert!(at("/surface/cage/valence_4_share") >= 0.99, "{}", report["surface"]["cage"]);
    assert!(at("/surface/cage/min_angle_deg") >= 45.0, "{}", report["surface"]["cage"]);
    assert!(at("/surface/max_deviation_mm") <= DEVIATION_MM, "{}", report["surface"]);
    assert_eq!(report["surface"]["valid"], true);
    assert!(at("/surface/cage/faces") < 0.2 * at("/surface/cage/patches"));
    // One face has no joins.
    let joins = &report["surface"]["cage"]["g1_regular_deg"];
    assert!(joins.is_null() || number(joins) <= 0.1, "{joins}");
    let obj = std::fs::read_to_string(out.join("cage.obj")).expect("cage.obj");
    let faces: Vec<&str> = obj.lines().filter(|l| l.starts_with("f ")).collect();
    assert!(faces.iter().all(|f| f.split_whitespace().count() == 5), "all quads");
    let quads = at("/surface/cage/quads");
    assert_eq!(faces.len() as f64, quads);
    if let Some(facts) = readers::ask("mesh.py", &[out.join("cage.obj")]) {
        let mesh = &facts[0]["meshes"][0];
        assert_eq!(
            (number(&mesh["triangles"]), &mesh["winding_consistent"]),
            (2.0 * quads, &Value::Bool(true))
        );
    }
    if let Some(facts) = readers::ask("step.py", &[out.join("sheet.step")]) {
        let sheet = product(&facts[0], "sheet");
        assert_eq!((number(&sheet["faces"]), &sheet["valid"]), (at("/surface/faces"), &Value::Bool(true)));
    }
    report
}

#[test]
fn the_cage_of_a_straight_fold_is_a_lattice() {
    let report = good_cage("straight", "");
    assert_eq!(report["surface"]["cage"]["irregular"], serde_json::json!([]));
    assert!(number(&report["surface"]["cage"]["rows_along_bands"]) > 0.99);
}

#[test]
fn the_cage_of_a_ring_goes_around_its_hole() {
    let report = good_cage("annulus", "");
    assert_eq!(report["surface"]["cage"]["irregular"], serde_json::json!([]));
    assert!(number(&report["surface"]["cage"]["rows_along_bands"]) > 0.99);
}

#[test]
fn the_cage_of_a_fan_follows_its_five_pleats() {
    let report = good_cage("fan", "");
    assert!(number(&report["surface"]["cage"]["rows_along_bands"]) > 0.95);
}

#[test]
fn the_cage_of_a_junction_is_good() {
    // Left to itself the lattice, which board and mold are made of, follows the narrowest strips for minutes.
    good_cage("junction", "spacing_mm = 8.0\n");
}

#[test]
fn the_cage_of_the_sculpture_is_good() {
    let report = good_cage("sculpture", "");
    assert!(number(&report["surface"]["cage"]["rows_along_bands"]) > 0.95);
}
