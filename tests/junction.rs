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

#[test]
fn a_slit_opens_when_the_sheet_folds_and_in_the_surface_and_is_refused_before_a_board() {
    let folder = fresh("slit");
    std::fs::create_dir_all(&folder).unwrap();
    let pattern = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"300mm\" height=\"200mm\" viewBox=\"0 0 300 200\">\n\
        <rect width=\"300\" height=\"200\" fill=\"none\" stroke=\"#000\"/>\n\
        <line id=\"a\" x1=\"0\" y1=\"100\" x2=\"110\" y2=\"100\" stroke=\"#00f\"/>\n\
        <line id=\"b\" x1=\"190\" y1=\"100\" x2=\"300\" y2=\"100\" stroke=\"#00f\"/>\n\
        <path id=\"slit\" d=\"M110 100 C 130 60 170 60 190 100\" stroke=\"#0f0\"/>\n</svg>\n";
    std::fs::write(folder.join("p.svg"), pattern).unwrap();
    let project = folder.join("project.toml");
    let text = "pattern = \"p.svg\"\n[soften]\nradius_mm = 8\nfold_angle_deg = 50\n[mesh]\ntarget_edge_mm = 12\n[board]\nthickness_mm = 1\n";
    std::fs::write(&project, text).unwrap();
    let out = folder.join("out");
    let said = softfold(&[Path::new("fold"), &project, Path::new("--out"), &out]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let points = |file: &str| -> Vec<[f64; 3]> {
        let text = std::fs::read_to_string(out.join(file)).unwrap();
        let vertex = |l: &str| {
            let mut p = l.split_whitespace().map(|n| n.parse::<f64>().unwrap());
            [(); 3].map(|()| p.next().unwrap())
        };
        text.lines().filter_map(|l| l.strip_prefix("v ")).map(vertex).collect()
    };
    let (flat, folded) = (points("flat.obj"), points("folded.obj"));
    let away = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let lips = (0..flat.len()).flat_map(|i| (0..i).map(move |k| (i, k))).filter(|&(i, k)| flat[i] == flat[k]);
    let widest = lips.map(|(i, k)| away(folded[i], folded[k])).fold(0.0, f64::max);
    assert!(widest > 5.0, "the lips part by {widest} mm");
    let said = softfold(&[Path::new("surface"), &project, Path::new("--out"), &folder.join("surface")]);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let said = softfold(&[Path::new("board"), &project, Path::new("--out"), &folder.join("board")]);
    assert_eq!(said.code, Some(1));
    assert!(said.stderr.contains("slit") && said.stderr.contains("narrow holes"), "{}", said.stderr);
}
