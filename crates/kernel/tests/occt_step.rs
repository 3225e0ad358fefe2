//! STEP files: what is written comes back, and equal parts make equal bytes.
#![allow(clippy::unwrap_used)] // what helps a test may stop at the first surprise, as tests do

mod common;

use common::{assert_close, graph_surface, polygon, wavy};
use softfold_kernel::KernelError;
use softfold_kernel::occt::{self, IgesOptions, Material, NamedShape, Shape, StepOptions, StepSchema};
use std::fs;
use std::path::Path;

const OUTLINE: [[f64; 2]; 4] = [[20.0, 30.0], [300.0, 40.0], [350.0, 200.0], [30.0, 250.0]];

fn board() -> Shape {
    let lifted = |by: f64| graph_surface(22, 20.0, move |x, y| wavy(x, y) + by);
    occt::board_solid(&lifted(0.0), &lifted(9.0), &[polygon(&OUTLINE)]).unwrap()
}

fn cube() -> Shape {
    occt::extruded_polygon(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]], 0.0, 10.0).unwrap()
}

fn part<'a>(name: &'a str, shape: &'a Shape) -> NamedShape<'a> {
    NamedShape { name, color_srgb: [0.8, 0.1, 0.2], material: None, shape }
}

fn options(schema: StepSchema) -> StepOptions {
    StepOptions {
        schema,
        product: "Schale Größe 3".into(),
        author: "O'Neil".into(),
        ..StepOptions::default()
    }
}

fn volume(shape: &Shape) -> f64 {
    occt::mass_properties(shape, 1e-6).unwrap().volume_mm3
}

#[test]
fn parts_come_back_with_names_colours_and_volumes() {
    let folder = tempfile::tempdir().unwrap();
    let (board, cube) = (board(), cube());
    for schema in [StepSchema::Ap203, StepSchema::Ap214, StepSchema::Ap242] {
        let path = folder.path().join("parts.step");
        occt::write_step(&path, &[part("board", &board), part("cube", &cube)], &options(schema)).unwrap();
        let parts = occt::read_step(&path).unwrap();
        let names: Vec<_> = parts.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["board", "cube"], "{schema:?}");
        for (read, written) in parts.iter().zip([&board, &cube]) {
            assert_close(volume(&read.shape), volume(written), 1e-8);
            assert!(occt::check(&read.shape).unwrap().is_empty());
            assert_eq!(occt::counts(&read.shape).unwrap(), occt::counts(written).unwrap());
            if schema != StepSchema::Ap203 {
                let color = read.color_srgb.unwrap();
                assert!(
                    color.iter().zip([0.8, 0.1, 0.2]).all(|(a, b): (&f32, f32)| (a - b).abs() < 1e-3),
                    "{color:?}"
                );
            }
        }
    }
}

#[test]
fn materials_come_back_with_their_densities_in_units_that_make_sense() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("material.step");
    let cube = cube();
    for (name, density_kg_m3) in [("fiber cement", 1750.0), ("Väggplåt 'S' 鋼", 7850.5)] {
        let of = NamedShape { material: Some(Material { name, density_kg_m3 }), ..part("cube", &cube) };
        for schema in [StepSchema::Ap214, StepSchema::Ap242] {
            occt::write_step(&path, &[of, part("bare", &cube)], &options(schema)).unwrap();
            let parts = occt::read_step(&path).unwrap();
            let found = parts[0].material.clone().unwrap();
            assert_eq!(found.name, name, "{schema:?}");
            assert_close(found.density_kg_m3, density_kg_m3, 1e-9);
            assert_eq!(parts[1].material, None);
            let text = fs::read_to_string(&path).unwrap();
            assert!(text.is_ascii());
            // Grams to the first power, per centimetre to the third; OpenCascade leaves out the signs and the one.
            let units: Vec<&str> = text.lines().filter(|l| l.contains("DERIVED_UNIT_ELEMENT(")).collect();
            let power = |p: &str| units.iter().filter(|u| u.ends_with(&format!(",{p});"))).count();
            assert_eq!((units.len(), power("1."), power("-3.")), (2, 1, 1), "{units:?}");
        }
    }
    let senseless = Material { name: "x", density_kg_m3: f64::NAN };
    let of = NamedShape { material: Some(senseless), ..part("cube", &cube) };
    assert!(occt::write_step(&path, &[of], &options(StepSchema::Ap242)).is_err());
}

#[test]
fn equal_things_are_written_once_and_lines_are_short() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board.step");
    let board = board();
    occt::write_step(&path, &[part("board", &board)], &options(StepSchema::Ap242)).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.lines().all(|line| line.len() <= 80), "a long line");
    let points: Vec<&str> =
        text.lines().filter_map(|l| l.split_once("=CARTESIAN_POINT(")).map(|(_, point)| point).collect();
    let distinct: std::collections::BTreeSet<&&str> = points.iter().collect();
    assert!(points.len() > 500 && distinct.len() == points.len());
    // The ruled sides have the poles of their edges, so that they add none: twice the skins' and the edges' own.
    let read = occt::read_step(&path).unwrap();
    assert_close(volume(&read[0].shape), volume(&board), 1e-10);
}

#[test]
fn iges_brings_solids_colours_and_short_names_and_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let board = board();
    let options =
        IgesOptions { product: "Größe".into(), author: "O'Neil".into(), ..IgesOptions::default() };
    let paths = ["a.iges", "b.iges"].map(|name| folder.path().join(name));
    for path in &paths {
        occt::write_iges(path, &[part("board of oak", &board)], &options).unwrap();
    }
    let bytes = paths.each_ref().map(|path| fs::read(path).unwrap());
    assert!(bytes[0] == bytes[1] && bytes[0].is_ascii(), "equal parts make equal files");
    let parts = occt::read_iges(&paths[0]).unwrap();
    assert_eq!(parts.len(), 1);
    assert_eq!(parts[0].name.trim(), "board of");
    assert_eq!(occt::counts(&parts[0].shape).unwrap().solids, 1);
    assert!(occt::check(&parts[0].shape).unwrap().is_empty());
    assert_close(volume(&parts[0].shape), volume(&board), 1e-6);
    let color = parts[0].color_srgb.unwrap();
    assert!(color.iter().zip([0.8, 0.1, 0.2]).all(|(a, b): (&f32, f32)| (a - b).abs() < 5e-3), "{color:?}");
}

#[test]
fn brep_brings_the_very_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.brep");
    let board = board();
    occt::write_brep(&path, &board).unwrap();
    let read = occt::read_brep(&path).unwrap();
    assert_eq!(occt::counts(&read).unwrap(), occt::counts(&board).unwrap());
    assert_close(volume(&read), volume(&board), 1e-10);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn bad_iges_and_brep_files_are_errors_and_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let garbage = folder.path().join("garbage");
    fs::write(&garbage, "no shape at all\n").unwrap();
    for path in [garbage.as_path(), &folder.path().join("missing")] {
        assert!(matches!(occt::read_iges(path).unwrap_err(), KernelError::File { .. }));
        assert!(matches!(occt::read_brep(path).unwrap_err(), KernelError::File { .. }));
    }
    let (cube, nowhere) = (cube(), folder.path().join("missing/a"));
    assert!(occt::write_iges(&nowhere, &[part("cube", &cube)], &IgesOptions::default()).is_err());
    assert!(occt::write_iges(&folder.path().join("a"), &[], &IgesOptions::default()).is_err());
    assert!(occt::write_brep(&nowhere, &cube).is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn any_name_survives() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("names.step");
    let cube = cube();
    let long =
        "Wölbung der äußeren Schale, über die ganze Länge geführt, größer als eine Zeile der Datei breit ist";
    for name in ["Vägg-låda 壁", "it's 5\" wide", "a\\b", "💡 lamp", long, "äöü".repeat(40).as_str()]
    {
        occt::write_step(&path, &[part(name, &cube)], &options(StepSchema::Ap214)).unwrap();
        assert!(fs::read(&path).unwrap().is_ascii(), "{name}");
        assert_eq!(occt::read_step(&path).unwrap()[0].name, name);
    }
}

#[test]
fn equal_parts_make_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let path = folder.path().join(name);
        let (board, cube) = (board(), cube());
        occt::write_step(&path, &[part("board", &board), part("cube", &cube)], &options(StepSchema::Ap242))
            .unwrap();
        fs::read_to_string(path).unwrap()
    };
    let first = write("first.step");
    let second = write("second.step");
    let differing = first.lines().zip(second.lines()).find(|(a, b)| a != b);
    assert_eq!(differing, None);
    assert_eq!(first.len(), second.len());
    assert!(first.contains("1970-01-01T00:00:00"));
    assert!(first.contains("O''Neil"));
    assert!(!first.contains("Open CASCADE STEP translator"), "a product without a name");
}

#[test]
fn a_given_time_stands_in_the_header() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("time.step");
    let options =
        StepOptions { time_stamp: Some("2026-01-31T12:00:00".into()), ..options(StepSchema::Ap214) };
    occt::write_step(&path, &[part("cube", &cube())], &options).unwrap();
    assert!(fs::read_to_string(path).unwrap().contains("'2026-01-31T12:00:00'"));
}

#[test]
fn threads_may_write_and_read_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let work = |i: usize, folder: &Path| {
        let path = folder.join(format!("{i}.step"));
        let (name, cube) = (format!("cube {i}"), cube());
        for _ in 0..5 {
            occt::write_step(&path, &[part(&name, &cube)], &options(StepSchema::Ap214)).unwrap();
            let parts = occt::read_step(&path).unwrap();
            assert_eq!(parts[0].name, name);
            assert_close(volume(&parts[0].shape), 1000.0, 1e-12);
        }
    };
    std::thread::scope(|scope| {
        (0..4).for_each(|i| {
            drop(scope.spawn({
                let folder = folder.path();
                move || work(i, folder)
            }))
        });
    });
}

#[test]
fn bad_files_are_errors_and_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let garbage = folder.path().join("garbage.step");
    fs::write(&garbage, "ISO-10303-21;\nHEADER;\ngarbage\n").unwrap();
    for path in [garbage.as_path(), &folder.path().join("missing.step"), folder.path()] {
        let error = occt::read_step(path).unwrap_err();
        assert!(matches!(error, KernelError::File { .. }), "{error}");
    }
    let cube = cube();
    let nowhere = folder.path().join("missing/a.step");
    assert!(occt::write_step(&nowhere, &[part("cube", &cube)], &StepOptions::default()).is_err());
    assert!(occt::write_step(&folder.path().join("a.step"), &[], &StepOptions::default()).is_err());
    let color = NamedShape { color_srgb: [2.0, 0.0, 0.0], ..part("cube", &cube) };
    assert!(occt::write_step(&folder.path().join("a.step"), &[color], &StepOptions::default()).is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
