//! The sculpture from end to end: its files, its figures, and what other people's programs make of them.

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

use facts::{assert_near, number, product, solid_volume};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// What every run leaves behind: a name a line, `parts/*.ENDING` for one file of that ending per part.
const FILES: &str = include_str!("files.txt");
/// Side and height of the mold's cells, mm.
const CELL_MM: f64 = 221.0;
const MOLD_HEIGHT_MM: f64 = 50.0;
/// How far the foot may be from the ground, mm: the elastic plane gives a little under the sheet's own stiffness.
const FOOT_MAX_MM: f64 = 4.0;

/// The output of one run.
struct Run {
    folder: PathBuf,
    report: Value,
}

/// The run that all tests here look at.
fn sculpture() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| run_into("sculpture"))
}

fn run_into(name: &str) -> Run {
    let folder = common::fresh(name);
    let outcome = common::run(&common::fixture("sculpture/project.toml"), &folder);
    assert_eq!(outcome.code, Some(0), "{}{}", outcome.stdout, outcome.stderr);
    let text = std::fs::read_to_string(folder.join("report.json")).expect("report.json");
    Run { report: serde_json::from_str(&text).expect("report.json is JSON"), folder }
}

impl Run {
    /// A value of the report by its JSON pointer.
    fn value(&self, pointer: &str) -> &Value {
        self.report.pointer(pointer).unwrap_or_else(|| panic!("report.json has no {pointer}"))
    }

    fn number(&self, pointer: &str) -> f64 {
        self.value(pointer)
            .as_f64()
            .unwrap_or_else(|| panic!("{pointer} is no number: {}", self.value(pointer)))
    }

    fn is_true(&self, pointer: &str) -> bool {
        self.value(pointer).as_bool().unwrap_or_else(|| panic!("{pointer} is not true or false"))
    }

    fn parts(&self) -> &Vec<Value> {
        self.value("/mold/parts").as_array().expect("a list of parts")
    }

    /// Paths below `parts/` with one ending, sorted.
    fn part_files(&self, ending: &str) -> Vec<PathBuf> {
        let names = common::contents(&self.folder.join("parts")).into_keys();
        names.filter(|name| name.ends_with(ending)).map(|name| self.folder.join("parts").join(name)).collect()
    }

    /// What the report says of the part that a file holds.
    fn part(&self, file: &std::path::Path) -> &Value {
        let name = stem(file);
        let part = self.parts().iter().find(|part| part["name"] == *name);
        part.unwrap_or_else(|| panic!("no part {name} in the report"))
    }

    /// The volume of a part as it is printed, with its marks and grooves.
    fn part_volume(&self, file: &std::path::Path) -> f64 {
        number(&self.part(file)["volume_mm3"])
    }
}

fn stem(file: &std::path::Path) -> String {
    file.file_stem().expect("a file name").to_string_lossy().into_owned()
}

#[test]
fn every_promised_file_is_there() {
    let there = common::contents(&sculpture().folder);
    let parts = sculpture().parts().len();
    assert!(parts > 0, "no parts");
    let absent = |name: &&str| match name.split_once("/*.") {
        Some((_, ending)) => sculpture().part_files(&format!(".{ending}")).len() != parts,
        None => there.get(*name).is_none_or(Vec::is_empty),
    };
    assert_eq!(FILES.lines().filter(absent).collect::<Vec<_>>(), Vec::<&str>::new(), "absent or empty");
    assert!(there.values().all(|bytes| !bytes.is_empty()));
}

#[test]
fn the_mesh_is_of_the_size_that_the_paper_uses() {
    let vertices = sculpture().number("/mesh/vertices");
    assert!((4000.0..=7000.0).contains(&vertices), "{vertices} vertices");
}

#[test]
fn the_fold_is_an_equilibrium_that_keeps_its_area() {
    let gradient = sculpture().number("/fold/relative_gradient");
    assert!(gradient <= 1e-6, "relative gradient {gradient:e}");
    let (low, high) =
        (sculpture().number("/fold/area_error_min"), sculpture().number("/fold/area_error_max"));
    assert!(low <= high && low >= -0.015 && high <= 0.015, "area error {low} to {high}");
}

#[test]
fn the_sheet_is_held_as_in_the_case_study_and_its_foot_is_flat() {
    assert_eq!(*sculpture().value("/fold/solver"), "newton");
    let goals = sculpture().value("/fold/goals").as_array().expect("a list of goals");
    let of_kind = |kind: &str| goals.iter().filter(|goal| goal["kind"] == kind).count();
    assert_eq!((of_kind("Anchor"), of_kind("ClampLengths")), (8, 3), "{goals:?}");
    let foot: Vec<&Value> = goals.iter().filter(|goal| goal["name"] == "foot").collect();
    assert_eq!(foot.len(), 1, "goals named foot");
    let residual = number(&foot[0]["residual_mm"]);
    assert!(residual <= FOOT_MAX_MM, "the foot is {residual} mm off its plane");
}

#[test]
fn the_folded_sheet_does_not_pass_through_itself() {
    assert_eq!(sculpture().number("/fold/self_intersections"), 0.0);
}

#[test]
fn the_surface_is_valid_and_close_to_the_mesh() {
    assert!(sculpture().is_true("/surface/valid"));
    let deviation = sculpture().number("/surface/max_deviation_mm");
    assert!((0.0..=0.5).contains(&deviation), "{deviation} mm");
    assert!(sculpture().number("/surface/rms_deviation_mm") <= deviation);
    let face = sculpture().number("/surface/face_distance_mm");
    assert!((0.0..=0.5).contains(&face), "the exported face is {face} mm off the mesh");
}

#[test]
fn the_board_is_valid_weighs_what_it_should_and_stands() {
    assert!(sculpture().is_true("/board/valid"));
    assert!(sculpture().is_true("/stability/stable") && sculpture().number("/stability/margin_mm") > 0.0);
    let volume = sculpture().number("/board/volume_mm3");
    assert_near(
        "board volume by area times thickness",
        volume,
        sculpture().number("/board/area_times_thickness_mm3"),
        0.01,
    );
}

/// What a board of this size may weigh as a file.
const STEP_MOST_BYTES: u64 = 5_000_000;

#[test]
fn the_board_is_exact_and_light() {
    let bytes = std::fs::metadata(sculpture().folder.join("board.step")).expect("board.step").len();
    assert!(bytes < STEP_MOST_BYTES, "{bytes} bytes");
    let offset = sculpture().number("/board/offset_error_mm");
    assert!(offset <= 0.02, "a skin is {offset} mm off");
    let volume = sculpture().number("/board/volume_mm3");
    assert_near("offset of the sheet", volume, sculpture().number("/board/offset_volume_mm3"), 1e-4);
    assert_near("triangles", volume, sculpture().number("/board/mesh_volume_mm3"), 1e-3);
    let moments = sculpture().value("/board/principal_moments_kg_mm2").as_array().expect("three moments");
    // Of a thin plate the largest is nearly the sum of the others; folded it is less.
    let [a, b, c] = [0, 1, 2].map(|k| number(&moments[k]));
    assert!(0.0 < a && a <= b && b <= c && c <= a + b, "{moments:?}");
}

#[test]
fn every_part_is_valid_and_inner_cells_measure_what_a_cell_measures() {
    for part in sculpture().parts() {
        assert_eq!(part["valid"], true, "{}", part["name"]);
    }
    let inner: Vec<&Value> = sculpture().parts().iter().filter(|part| part["inner"] == true).collect();
    assert!(!inner.is_empty(), "no inner cell");
    for part in inner {
        let what = format!("cell {} before marks and grooves", part["name"]);
        assert_near(&what, number(&part["cell_volume_mm3"]), CELL_MM * CELL_MM * MOLD_HEIGHT_MM, 1e-4);
    }
}

/// The report without its times, wherever they stand.
fn without_seconds(value: &Value) -> Value {
    match value {
        Value::Object(map) => {
            let kept = map.iter().filter(|(key, _)| *key != "seconds");
            Value::Object(kept.map(|(key, inner)| (key.clone(), without_seconds(inner))).collect())
        }
        Value::Array(list) => Value::Array(list.iter().map(without_seconds).collect()),
        other => other.clone(),
    }
}

/// The page without the text of its elements of class `seconds`.
fn page_without_seconds(page: &str) -> String {
    let mut pieces = page.split("class=\"seconds\"");
    let mut kept = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let rest = piece.split_once('>').map_or("", |(_, rest)| rest);
        kept.push_str(rest.find('<').map_or("", |at| &rest[at..]));
    }
    kept
}

fn comparable(files: BTreeMap<String, Vec<u8>>) -> BTreeMap<String, Vec<u8>> {
    let without = |(name, bytes): (String, Vec<u8>)| {
        let bytes = match name.as_str() {
            "report.json" => {
                without_seconds(&serde_json::from_slice(&bytes).unwrap()).to_string().into_bytes()
            }
            "report.html" => page_without_seconds(&String::from_utf8(bytes).unwrap()).into_bytes(),
            _ => bytes,
        };
        (name, bytes)
    };
    files.into_iter().map(without).collect()
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let first = comparable(common::contents(&sculpture().folder));
    let second = comparable(common::contents(&run_into("sculpture-again").folder));
    assert_eq!(first.keys().collect::<Vec<_>>(), second.keys().collect::<Vec<_>>());
    let differing: Vec<&String> = first.keys().filter(|name| first[*name] != second[*name]).collect();
    assert_eq!(differing, Vec::<&String>::new(), "files that differ");
}

#[test]
fn only_times_are_left_out_of_the_comparison() {
    let report = serde_json::json!({"a": {"seconds": 1, "b": [{"seconds": 2, "c": 3}]}});
    assert_eq!(without_seconds(&report), serde_json::json!({"a": {"b": [{"c": 3}]}}));
    let page = |time| format!("<td>1</td><td class=\"seconds\" id=\"a\">{time}</td><b>2</b>");
    assert_eq!(page_without_seconds(&page("1.5")), page_without_seconds(&page("2.75")));
    assert!(page_without_seconds(&page("x")).ends_with("</td><b>2</b>"));
    assert_ne!(page_without_seconds("<b>1</b>"), page_without_seconds("<b>2</b>"));
}

#[test]
fn outside_readers_tell_good_files_from_faulty_ones() {
    let Some(said) = readers::self_test() else { return };
    assert_eq!(said["failed"], serde_json::json!([]));
    assert!(number(&said["checks"]) >= 30.0, "{said}");
}

#[test]
fn opencascade_8_agrees_with_the_step_files() {
    let run = sculpture();
    let files = ["sheet.step", "board.step", "mold.step"].map(|name| run.folder.join(name));
    let Some(facts) = readers::ask("step.py", &files) else { return };
    let sheet = product(&facts[0], "sheet");
    assert_eq!(sheet["solids"].as_array().unwrap().len(), 0, "a sheet is no solid");
    assert_eq!(number(&sheet["faces"]), run.number("/surface/faces"));
    let board = solid_volume(&facts[1], "board");
    assert_near("board.step against the report", board, run.number("/board/volume_mm3"), 1e-6);
    assert_near(
        "board.step against area times thickness",
        board,
        run.number("/board/area_times_thickness_mm3"),
        0.01,
    );
    let mold = solid_volume(&facts[2], "mold");
    assert_near("mold.step against the report", mold, run.number("/mold/volume_mm3"), 1e-6);
}

#[test]
fn opencascade_8_agrees_with_the_parts() {
    let files = sculpture().part_files(".step");
    let Some(facts) = readers::ask("step.py", &files) else { return };
    let mut inner = 0;
    for (file, facts) in files.iter().zip(&facts) {
        let what = file.display().to_string();
        let (part, volume) = (sculpture().part(file), solid_volume(facts, &stem(file)));
        // The exact solid is the cell; only the printed mesh has marks and grooves.
        assert_near(&what, volume, number(&part["cell_volume_mm3"]), 1e-6);
        if part["inner"] == true {
            inner += 1;
            assert_near(&format!("{what}: whole cell"), volume, CELL_MM * CELL_MM * MOLD_HEIGHT_MM, 1e-4);
        }
    }
    assert!(inner > 0, "no inner cell");
}

/// Fails unless a mesh is one closed manifold body of the wanted volume.
fn assert_printable(what: &str, mesh: &Value, volume_mm3: f64) {
    for property in ["watertight", "winding_consistent", "manifold", "finite"] {
        assert_eq!(mesh[property], true, "{what}: {property}");
    }
    assert_eq!(mesh["bodies"], 1, "{what}: bodies");
    assert_near(what, number(&mesh["volume_mm3"]), volume_mm3, 5e-4);
    assert_near(what, number(&mesh["manifold_volume_mm3"]), volume_mm3, 5e-4);
}

#[test]
fn trimesh_and_manifold_find_every_printed_part_closed() {
    let files = sculpture().part_files(".stl");
    let Some(facts) = readers::ask("mesh.py", &files) else { return };
    for (file, facts) in files.iter().zip(&facts) {
        let meshes = facts["meshes"].as_array().unwrap();
        assert_eq!(meshes.len(), 1, "{}", file.display());
        assert_printable(&file.display().to_string(), &meshes[0], sculpture().part_volume(file));
    }
}

#[test]
fn lib3mf_reads_every_part_by_its_name_in_millimetres() {
    let files = sculpture().part_files(".3mf");
    let Some(facts) = readers::ask("mesh.py", &files) else { return };
    for (file, facts) in files.iter().zip(&facts) {
        let what = file.display().to_string();
        assert_eq!(facts["units"], "MilliMeter", "{what}");
        assert_eq!(facts["warnings"], serde_json::json!([]), "{what}");
        assert_eq!(facts["build_items"], 1, "{what}");
        let meshes = facts["meshes"].as_array().unwrap();
        assert_eq!(meshes.len(), 1, "{what}");
        assert_eq!(meshes[0]["name"], stem(file), "{what}");
        assert_eq!(meshes[0]["lib3mf_manifold"], true, "{what}");
        assert_printable(&what, &meshes[0], sculpture().part_volume(file));
    }
}

#[test]
fn trimesh_reads_the_sheet_meshes() {
    let names = ["flat.obj", "folded.obj", "folded.ply", "cage.obj"];
    let files = names.map(|name| sculpture().folder.join(name));
    let Some(facts) = readers::ask("mesh.py", &files) else { return };
    let meshes: Vec<&Value> = facts.iter().map(|facts| &facts["meshes"][0]).collect();
    for (name, mesh) in names.iter().zip(&meshes).take(3) {
        assert_eq!(number(&mesh["vertices"]), sculpture().number("/mesh/vertices"), "{name}");
        assert_eq!(number(&mesh["triangles"]), sculpture().number("/mesh/triangles"), "{name}");
        assert_eq!(mesh["winding_consistent"], true, "{name}");
    }
    assert_eq!(meshes[2]["colours"], true, "folded.ply is coloured");
    assert!(number(&meshes[3]["triangles"]) > 0.0, "cage.obj has faces");
}

/// A drawing that an auditor finds nothing to mend in, in mm, with nothing drawn twice or across itself.
fn assert_clean_drawing(name: &str, facts: &Value) {
    for list in ["errors", "fixes"] {
        assert_eq!(facts[list], serde_json::json!([]), "{name}: {list}");
    }
    assert_eq!(facts["insunits"], 4, "{name}: millimetres");
    assert_eq!(facts["twice"], 0, "{name}: drawn twice {}", facts["twice_first"]);
    for (layer, drawn) in facts["layers"].as_object().unwrap() {
        assert_eq!(drawn["self_crossing"], 0, "{name}: layer {layer}");
        assert_eq!(drawn["crossing"], serde_json::json!([]), "{name}: layer {layer}");
        assert_eq!(drawn["without_geometry"], serde_json::json!({}), "{name}: layer {layer}");
    }
}

#[test]
fn ezdxf_finds_the_drawings_clean() {
    let names = ["waffle.dxf", "blank.dxf"];
    let files = names.map(|name| sculpture().folder.join(name));
    let Some(facts) = readers::ask("dxf.py", &files) else { return };
    for (name, facts) in names.iter().zip(&facts) {
        assert_clean_drawing(name, facts);
        let cuts = facts["layers"].as_object().unwrap().iter().filter(|(layer, _)| layer.contains("CUT"));
        let cuts: Vec<(&String, &Value)> = cuts.collect();
        assert!(!cuts.is_empty(), "{name}: no layer to cut in {}", facts["declared_layers"]);
        for (layer, drawn) in cuts {
            assert!(drawn["open"] == 0 && number(&drawn["closed"]) > 0.0, "{name}: layer {layer}: {drawn}");
        }
    }
}

/// The distance of the folded mesh from the exported face, measured once more from the files, is what the report tells, within
/// the chord of the triangles that stand for the face.
#[test]
fn comparing_the_folded_mesh_with_the_step_file_gives_the_reported_deviation() {
    const CHORD_MM: f64 = 0.05;
    let run = sculpture();
    let out = common::fresh("sculpture-compare");
    let [folder, step] = [run.folder.clone(), run.folder.join("sheet.step")];
    let arguments = [Path::new("compare"), &folder, &step, Path::new("--out"), &out];
    let said = common::softfold(&arguments);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    let text = std::fs::read_to_string(out.join("compare.json")).expect("compare.json");
    let record: Value = serde_json::from_str(&text).expect("JSON");
    assert!(record["alignment"].is_null(), "both lie where the run put them");
    let distance = |key: &str| number(&record["distance"][key]);
    assert_eq!(distance("points"), run.number("/mesh/vertices"));
    assert_eq!(number(&record["against"]["chord_mm"]), CHORD_MM);
    let told = run.number("/surface/max_deviation_mm");
    assert!((distance("max_mm") - told).abs() <= CHORD_MM, "{} {told}", distance("max_mm"));
    assert!(distance("rms_mm") <= run.number("/surface/rms_deviation_mm") + CHORD_MM / 2.0);
    let Some(facts) = readers::ask("figures.py", &[out.join("compare.ply")]) else { return };
    let read = &facts[0]["figures"]["distance"];
    let largest = number(&read["max"]).max(-number(&read["min"]));
    assert!((largest - distance("max_mm")).abs() < 1e-6, "{read}");
}

#[test]
fn the_surface_s_figures_are_read_place_by_place() {
    let run = sculpture();
    let Some(facts) = readers::ask("figures.py", &[run.folder.join("surface.ply")]) else { return };
    let figure = |name: &str, end: &str| number(&facts[0]["figures"][name][end]);
    let shape = |key: &str| run.number(&format!("/surface/shape/{key}"));
    assert_eq!(facts[0]["colours"], true);
    // The report looks at these and at other places; the file has single precision.
    let radius = figure("radius", "min") / shape("min_radius_mm");
    assert!((1.0 - 1e-6..1.02).contains(&radius), "{radius}");
    assert!((figure("radius_lower", "min") / shape("lower_skin_radius_mm") - 1.0).abs() < 1e-6);
    assert!(figure("strain_max", "max") <= shape("principal_strain_max") + 1e-7);
    assert!(figure("strain_min", "min") >= shape("principal_strain_min") - 1e-7);
    assert!(figure("double_bend", "min") >= 0.0 && figure("double_bend", "max") <= 1.0 + 1e-6);
    for (name, read) in facts[0]["figures"].as_object().unwrap() {
        assert_eq!(read["finite"], true, "{name}");
    }
    let shares = ["plane_share", "developable_share", "doubly_bent_share"].map(shape);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9 && shape("rulings") > 20.0, "{shares:?}");
}
