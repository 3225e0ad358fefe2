//! What a project can ask of the folding: each kind of goal does what it says, through the program.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{Outcome, fresh, softfold};
use serde_json::Value;
use std::path::{Path, PathBuf};

const PATTERN: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200mm\" height=\"100mm\" viewBox=\"0 0 200 100\">\n\
    <rect width=\"200\" height=\"100\" fill=\"none\" stroke=\"black\"/>\n\
    <line id=\"v\" x1=\"100\" y1=\"0\" x2=\"100\" y2=\"100\" stroke=\"blue\"/>\n</svg>\n";
const PROJECT: &str = "pattern = \"p.svg\"\n[soften]\nradius_mm = 8\nfold_angle_deg = 60\n[mesh]\ntarget_edge_mm = 8\n[board]\n\
    thickness_mm = 1\n[material]\nyoungs_modulus_mpa = 2000\n";

fn run(name: &str, fold: &str) -> (Outcome, PathBuf) {
    let folder = fresh(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("p.svg"), PATTERN).unwrap();
    let project = folder.join("project.toml");
    std::fs::write(&project, format!("{PROJECT}{fold}")).unwrap();
    let out = folder.join("out");
    (softfold(&[Path::new("fold"), &project, Path::new("--out"), &out]), out)
}

/// A vertex: its place on the sheet and in space, mm.
type Vertex = ([f64; 2], [f64; 3]);

/// The report of a run that ends at rest, and the folded vertices with their places on the sheet.
fn folded(name: &str, fold: &str) -> (Value, Vec<Vertex>) {
    let (said, out) = run(name, fold);
    assert_eq!(said.code, Some(0), "{name}: {}{}", said.stdout, said.stderr);
    let read = |file: &str| std::fs::read_to_string(out.join(file)).unwrap();
    let report: Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(report["fold"]["converged"], true, "{name}: {}", report["fold"]);
    let points = |text: &str| -> Vec<[f64; 3]> {
        let lines = text.lines().filter_map(|l| l.strip_prefix("v "));
        lines
            .map(|l| {
                let p: Vec<f64> = l.split_whitespace().map(|n| n.parse().unwrap()).collect();
                [p[0], p[1], p[2]]
            })
            .collect()
    };
    let flat = points(&read("flat.obj")).into_iter().map(|[u, v, _]| [u, v]);
    (report, flat.zip(points(&read("folded.obj"))).collect())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

/// Where the vertex at a place of the sheet is.
fn at(sheet: &[Vertex], uv: [f64; 2]) -> [f64; 3] {
    let off = |p: &[f64; 2]| (p[0] - uv[0]).hypot(p[1] - uv[1]);
    sheet.iter().min_by(|a, b| off(&a.0).total_cmp(&off(&b.0))).unwrap().1
}

#[test]
fn glue_holds_two_corners_together_and_coplanar_points_end_in_one_plane() {
    let glue = "[[fold.glues]]\nname = \"lips\"\nfrom = [0, 0]\nto = [200, 0]\nstiffness = 5\n";
    let flat =
        "[[fold.coplanar]]\nname = \"rim\"\nat = [[0, 0], [0, 100], [200, 0], [200, 100]]\nstiffness = 5\n";
    let (report, sheet) = folded("goals-glue", &format!("{glue}{flat}"));
    let gap = distance(at(&sheet, [0.0, 0.0]), at(&sheet, [200.0, 0.0]));
    assert!(gap < 2.0, "{gap} mm apart, 200 mm on the sheet");
    let goals = report["fold"]["goals"].as_array().unwrap();
    let residual =
        |name: &str| goals.iter().find(|g| g["name"] == name).unwrap()["residual_mm"].as_f64().unwrap();
    assert!(residual("rim") < 0.5, "{}", residual("rim"));
}

#[test]
fn a_floor_carries_the_sheets_own_weight() {
    let floor = "[fold]\nself_weight = true\n[[fold.floors]]\nname = \"table\"\norigin = [0, 0, -20]\nnormal = [0, 0, 1]\n\
        stiffness = 0.05\n[[fold.anchors]]\nname = \"a\"\nat = [100, 50]\ntarget = [0, 0, 0]\nstiffness = [0.001, 0.001, 0]\n";
    let (_, sheet) = folded("goals-floor", floor);
    let lowest = sheet.iter().map(|p| p.1[2]).fold(f64::INFINITY, f64::min);
    // The weight of 1 mm of this sheet is 0.34 N; the springs of the vertices on the floor give by far less than 1 mm.
    assert!((-21.0..=-19.9).contains(&lowest), "lowest at {lowest} mm");
}

#[test]
fn a_rail_leads_points_and_lbfgs_finds_the_same_shape() {
    let rail = "[[fold.rails]]\nname = \"rail\"\nat = [[0, 50], [100, 50], [200, 50]]\nthrough = [[-500, 0, 30], [500, 0, 30]]\nstiffness = 5\n";
    let (report, sheet) = folded("goals-rail", rail);
    for uv in [[0.0, 50.0], [200.0, 50.0]] {
        let p = at(&sheet, uv);
        assert!((p[2] - 30.0).abs() < 5.0, "{p:?}");
    }
    let (other, _) = folded("goals-rail-lbfgs", &format!("[fold]\nsolver = \"lbfgs\"\n{rail}"));
    let energy = |r: &Value| r["fold"]["energy"].as_f64().unwrap();
    assert!((energy(&other) / energy(&report) - 1.0).abs() < 1e-4, "{} {}", energy(&other), energy(&report));
}

#[test]
fn goals_that_miss_the_sheet_or_are_none_are_named_with_their_line() {
    let glue = "[[fold.glues]]\nname = \"lips\"\nfrom = [0, 0]\nto = [300, 0]\nstiffness = 5\n";
    let (said, _) = run("goals-bad-glue", glue);
    assert_eq!(said.code, Some(1));
    assert!(said.stderr.contains("project.toml:11") && said.stderr.contains("lips"), "{}", said.stderr);
    let (said, _) =
        run("goals-bad-load", "[[fold.loads]]\nname = \"w\"\nat = [10, 10]\nforce_n = [0, 0, nan]\n");
    assert!(said.stderr.contains("[[fold.loads]] 'w'") && said.stderr.contains("finite"), "{}", said.stderr);
    let (said, _) = run("goals-bad-plane", "[[fold.coplanar]]\nname = \"c\"\nat = [[1, 1]]\nstiffness = 1\n");
    assert!(said.stderr.contains("four points"), "{}", said.stderr);
}
