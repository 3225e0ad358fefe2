//! Sheets that stay sharp or are slit: surfaces of several faces, from the pattern to the STEP file.

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

fn surface_of(name: &str, project: &Path) -> (Value, PathBuf) {
    let out = fresh(&format!("{name}-surface"));
    let said = softfold(&[Path::new("surface"), project, Path::new("--out"), &out, Path::new("--strict")]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let text = std::fs::read_to_string(out.join("report.json")).expect("report.json");
    (serde_json::from_str(&text).expect("JSON"), out)
}

/// Faces meet to 1e-6 mm, and another kernel finds the same faces in the file.
fn assert_fits_together(report: &Value, out: &Path, faces: f64) {
    let surface = &report["surface"];
    assert_eq!((number(&surface["faces"]), &surface["valid"]), (faces, &Value::Bool(true)), "{surface}");
    assert!(number(&surface["max_deviation_mm"]) <= 0.05, "{surface}");
    assert!(number(&surface["shell"]["edge_tolerance_mm"]) <= 1e-6, "{surface}");
    if let Some(facts) = readers::ask("step.py", &[out.join("sheet.step")]) {
        assert_eq!(number(&product(&facts[0], "sheet")["faces"]), faces);
    }
}

#[test]
fn sharp_curved_creases_are_edges_that_faces_share() {
    let (report, out) = surface_of("creased", &fixture("creased").join("project.toml"));
    assert_fits_together(&report, &out, 3.0);
    let cage = std::fs::read_to_string(out.join("cage.obj")).expect("cage.obj");
    assert_eq!(cage.lines().filter(|l| l.starts_with("o ")).count(), 3, "a cage a face");
}

#[test]
fn a_crease_whose_curvature_jumps_is_followed_and_told() {
    let folder = fresh("hook");
    std::fs::create_dir_all(&folder).unwrap();
    let of = fixture("creased");
    let pattern = std::fs::read_to_string(of.join("pattern.svg")).unwrap();
    // A line that goes over into an arc.
    let hook = pattern.replace("M0 140 C 200 60 400 60 600 140", "M0 100 H200 C 350 100 480 120 600 190");
    assert_ne!(hook, pattern);
    std::fs::write(folder.join("pattern.svg"), hook).unwrap();
    std::fs::copy(of.join("project.toml"), folder.join("project.toml")).unwrap();
    let out = folder.join("out");
    let said = softfold(&[Path::new("surface"), &folder.join("project.toml"), Path::new("--out"), &out]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let text = std::fs::read_to_string(out.join("report.json")).expect("report.json");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let surface = &report["surface"];
    assert_eq!(surface["valid"], true);
    assert!(number(&surface["max_deviation_mm"]) <= 0.05, "{surface}");
    let gap = number(&surface["shell"]["gap_mm"]);
    assert!(gap <= 3e-4 && number(&surface["shell"]["edge_tolerance_mm"]) <= 1.2 * gap + 1e-6, "{surface}");
    if gap > 5e-7 {
        assert!(said.stdout.contains("without a jump of its curvature"), "{}", said.stdout);
    }
}

#[test]
fn sharp_creases_that_meet_share_their_corner() {
    let folder = fresh("sharp-junction");
    std::fs::create_dir_all(&folder).unwrap();
    let of = fixture("junction");
    std::fs::copy(of.join("pattern.svg"), folder.join("pattern.svg")).unwrap();
    let text = std::fs::read_to_string(of.join("project.toml")).unwrap();
    let sharp = |line: &str| match line.starts_with("radius_mm") {
        true => "radius_mm = 0".to_owned(),
        false => line.to_owned(),
    };
    let text: Vec<String> = text.lines().map(sharp).collect();
    std::fs::write(folder.join("project.toml"), text.join("\n")).unwrap();
    let (report, out) = surface_of("sharp-junction", &folder.join("project.toml"));
    assert_fits_together(&report, &out, 4.0);
}

#[test]
fn a_crease_that_divides_nothing_is_told() {
    let folder = fresh("lost-crease");
    std::fs::create_dir_all(&folder).unwrap();
    let pattern = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"300mm\" height=\"200mm\" viewBox=\"0 0 300 200\">\n\
        <rect width=\"300\" height=\"200\" fill=\"none\" stroke=\"#000\"/>\n\
        <rect x=\"120\" y=\"70\" width=\"60\" height=\"60\" fill=\"none\" stroke=\"#000\"/>\n\
        <line id=\"spoke\" x1=\"0\" y1=\"100\" x2=\"120\" y2=\"100\" stroke=\"#00f\"/>\n</svg>\n";
    std::fs::write(folder.join("p.svg"), pattern).unwrap();
    let text = "pattern = \"p.svg\"\n[soften]\nradius_mm = 0\nfold_angle_deg = 10\n[mesh]\ntarget_edge_mm = 12\n[board]\nthickness_mm = 1\n";
    std::fs::write(folder.join("project.toml"), text).unwrap();
    let out = folder.join("out");
    let said = softfold(&[Path::new("surface"), &folder.join("project.toml"), Path::new("--out"), &out]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let text = std::fs::read_to_string(out.join("report.json")).expect("report.json");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(report["surface"]["shell"]["rounded"], serde_json::json!(["spoke"]));
    let seams = report["verdicts"].as_array().unwrap().iter().find(|v| v["name"] == "surface seams");
    let seams = seams.expect("a verdict on the seams");
    assert_eq!(seams["pass"], false);
    assert!(seams["message"].as_str().unwrap().contains("lead them to the outline"), "{seams}");
}
