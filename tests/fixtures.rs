//! The other inputs of our own, from the pattern to the board: what leaves for CAM is valid, exact, and read by another
//! kernel with nothing lost.

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
use facts::{assert_near, number, product, solid_volume};
use serde_json::Value;
use std::path::Path;

/// Largest distance of the surface from the folded vertices, mm.
const DEVIATION_MM: f64 = 0.05;
/// The same of a board's volume from area times thickness: what is left is thickness³ over 12 times the curvature of Gauss.
const VOLUME: f64 = 1e-4;

/// Folds a fixture up to its board and compares the files with the report; gives the report.
fn board_of(name: &str, area_error: f64) -> Value {
    let out = fresh(&format!("{name}-board"));
    let project = fixture(name).join("project.toml");
    let said = softfold(&[Path::new("board"), &project, Path::new("--out"), &out, Path::new("--strict")]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let text = std::fs::read_to_string(out.join("report.json")).expect("report.json");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let at = |pointer: &str| number(report.pointer(pointer).unwrap_or_else(|| panic!("no {pointer}")));
    assert_eq!(report["fold"]["converged"], true);
    assert!(at("/fold/area_error_min") > -area_error && at("/fold/area_error_max") < area_error);
    assert!(at("/surface/max_deviation_mm") <= DEVIATION_MM);
    assert_eq!(report["surface"]["valid"], true);
    assert_eq!(report["board"]["valid"], true);
    let volume = at("/board/volume_mm3");
    assert_near("area times thickness", volume, at("/board/area_times_thickness_mm3"), VOLUME);
    assert_near("area and curvature times thickness", volume, at("/board/offset_volume_mm3"), VOLUME);
    assert_near("the same board as triangles", volume, at("/board/mesh_volume_mm3"), 1e-3);
    let files = ["sheet.step", "board.step"].map(|f| out.join(f));
    if let Some(facts) = readers::ask("step.py", &files) {
        assert_eq!(number(&product(&facts[0], "sheet")["faces"]), at("/surface/faces"));
        assert_near("board.step", solid_volume(&facts[1], "board"), volume, 1e-6);
        assert_eq!(facts[1]["products"][0]["material"]["name"], "fiber cement");
    }
    report
}

#[test]
fn a_straight_fold_is_a_piece_of_a_cylinder_between_planes() {
    let report = board_of("straight", 1e-6);
    // The band's strips, as wide as chords, become arcs: so much longer is the sheet's section, and the board has no
    // curvature of Gauss.
    let crease = &report["pattern"]["creases"][0];
    let width = 600.0 - number(&crease["band_width_mm"]) + number(&crease["arc_mm"]);
    assert_near("board", number(&report["board"]["volume_mm3"]), width * 400.0 * 4.0, 2e-5);
}

#[test]
fn a_ring_crease_bends_its_ring_to_a_saddle() {
    let report = board_of("annulus", 0.015);
    // Flat rings of this size would be a quarter as high.
    assert!(number(&report["stability"]["height_mm"]) > 60.0, "{}", report["stability"]["height_mm"]);
    assert!(number(&report["pattern"]["creases"][0]["length_mm"]) > 1350.0);
}

#[test]
fn a_fan_of_five_pleats_stays_one_smooth_face() {
    let report = board_of("fan", 0.005);
    assert_eq!(report["pattern"]["creases"].as_array().expect("creases").len(), 5);
    assert_eq!(number(&report["surface"]["faces"]), 1.0);
}

#[test]
fn every_format_of_exact_shapes_is_read_by_another_kernel_with_nothing_lost() {
    let out = fresh("straight-formats");
    let project = fixture("straight").join("project.toml");
    let job = ["--formats", "step,iges,brep", "--step-schema", "ap214", "--out"].map(Path::new);
    let said = softfold(&[&[Path::new("board"), &project], job.as_slice(), &[&out]].concat());
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let step = std::fs::read_to_string(out.join("board.step")).expect("board.step");
    assert!(step.contains("AUTOMOTIVE_DESIGN"), "AP214");
    let text = std::fs::read_to_string(out.join("report.json")).expect("report.json");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let listed = |name: &str| report["files"].as_array().expect("files").iter().any(|f| f["path"] == name);
    let names = ["step", "iges", "brep"].map(|ending| format!("board.{ending}"));
    assert!(names.iter().all(|name| listed(name)));
    let Some(facts) = readers::ask("step.py", &names.map(|name| out.join(name))) else { return };
    for facts in &facts {
        let products = facts["products"].as_array().expect("products");
        let solids = products[0]["solids"].as_array().expect("solids");
        assert_eq!((products.len(), solids.len()), (1, 1), "{facts}");
        assert!(solids[0]["valid"] == true && solids[0]["closed"] == true, "{facts}");
        assert_near("volume", number(&solids[0]["volume_mm3"]), number(&report["board"]["volume_mm3"]), 1e-6);
    }
    assert_eq!(facts[1]["products"][0]["name"], "board", "IGES");
    let material = &facts[0]["products"][0]["material"];
    assert_near("density", number(&material["density_kg_m3"]), 1750.0, 1e-9);
}
