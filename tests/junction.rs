//! Bands that meet, and a radius that changes along a crease: from the pattern to the folded sheet.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{fixture, fresh, softfold};
use serde_json::Value;
use std::path::Path;

/// Largest area error of the folded vertex; its rigid fold has none, its bands a little.
const AREA_ERROR: f64 = 0.015;

#[test]
fn four_bands_that_meet_fold_into_a_vertex_of_degree_four() {
    let out = fresh("junction");
    let said = softfold(&[
        Path::new("fold"),
        &fixture("junction/project.toml"),
        Path::new("--out"),
        &out,
        Path::new("--strict"),
    ]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let text = std::fs::read_to_string(out.join("report.json")).expect("report.json");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let number = |pointer: &str| report.pointer(pointer).and_then(Value::as_f64).expect("a number");
    assert_eq!(report["fold"]["converged"], true);
    assert!(number("/fold/area_error_min") > -AREA_ERROR && number("/fold/area_error_max") < AREA_ERROR);
    assert!(number("/fold/turn_error_max_deg") < 1.0);
    let left = report["pattern"]["creases"].as_array().expect("creases").iter().find(|c| c["name"] == "left");
    let profile = left.expect("the crease 'left'")["profile"].as_array().expect("a profile").clone();
    let radii: Vec<f64> = profile.iter().map(|p| p["radius_mm"].as_f64().expect("a radius")).collect();
    assert_eq!(radii, [20.0, 20.0, 5.0]);
}
