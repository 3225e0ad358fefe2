//! `softfold scan`: meshes of scanners as they come, planted with their usual faults.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{Outcome, fresh, softfold};
use serde_json::Value;
use softfold::export::{obj, off, ply, stl};
use softfold_geometry::{DVec3, TriMesh};
use softfold_kernel::{MeshBuffers, cgal, openmesh};
use std::fs;
use std::path::{Path, PathBuf};

fn call(arguments: &[&str]) -> Outcome {
    softfold(&arguments.iter().map(Path::new).collect::<Vec<_>>())
}

fn folder(name: &str) -> PathBuf {
    let folder = fresh(name);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// A sphere of latitudes and longitudes around a place, outward.
fn sphere(center: DVec3, radius: f64, n: usize) -> TriMesh {
    let (rows, columns) = (n, 2 * n);
    let at = |i: usize, j: usize| {
        let (a, b) = (
            std::f64::consts::PI * i as f64 / rows as f64,
            std::f64::consts::TAU * j as f64 / columns as f64,
        );
        center + radius * DVec3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos())
    };
    let mut mesh = TriMesh { positions: vec![at(0, 0), at(rows, 0)], triangles: vec![] };
    mesh.positions.extend((1..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| at(i, j)));
    let id = |i: usize, j: usize| match i {
        0 => 0,
        i if i == rows => 1,
        i => (2 + (i - 1) * columns + j % columns) as u32,
    };
    for i in 0..rows {
        for j in 0..columns {
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            mesh.triangles.extend(
                [[a, b, c], [a, c, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]),
            );
        }
    }
    mesh
}

/// The same as a scanner writes it: every triangle with corners of its own.
fn soup(mesh: &TriMesh) -> TriMesh {
    let positions = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]).collect();
    TriMesh {
        positions,
        triangles: (0..mesh.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    }
}

fn figures(outcome: &Outcome) -> Value {
    serde_json::from_str(outcome.stdout.lines().last().unwrap_or_default())
        .unwrap_or_else(|e| panic!("{e}: {outcome:?}"))
}

#[test]
fn planted_faults_are_found_and_mended() {
    let folder = folder("scan-faults");
    let good = sphere(DVec3::ZERO, 50.0, 12);
    let count = good.triangles.len();
    let mut scan = soup(&good);
    // Two triangles twice, one degenerate, seven turned over, a third triangle at an edge, a stray piece.
    scan.triangles.extend([scan.triangles[3], scan.triangles[40], [0, 0, 1]]);
    (100..107).for_each(|i| scan.triangles[i].swap(0, 1));
    let wing = scan.positions.len() as u32;
    scan.positions.push(DVec3::new(0.0, 0.0, 90.0));
    scan.triangles.push([scan.triangles[200][0], scan.triangles[200][1], wing]);
    let stray = sphere(DVec3::splat(200.0), 0.5, 4);
    let base = scan.positions.len() as u32;
    scan.positions.extend(&stray.positions);
    scan.triangles.extend(stray.triangles.iter().map(|t| t.map(|i| i + base)));
    let (from, to) = (folder.join("scan.stl"), folder.join("clean.ply"));
    fs::write(&from, stl::binary("scan", &scan)).unwrap();
    let outcome = softfold(&[Path::new("scan"), &from, Path::new("--out"), &to, Path::new("--json")]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let said = figures(&outcome);
    assert_eq!(
        (said["flipped_triangles"].as_u64(), said["dropped_pieces"].as_u64()),
        (Some(7), Some(1)),
        "{said}"
    );
    assert!(said["removed_triangles"].as_u64() >= Some(3), "{said}");
    assert_eq!(said["triangles"].as_u64(), Some(count as u64), "{said}");
    let mesh = openmesh::read(&to).unwrap();
    let check = cgal::closed_check(mesh.view()).unwrap();
    assert!(check.closed && check.manifold && check.outward);
    assert!((check.volume_mm3 / good.volume_mm3() - 1.0).abs() < 1e-5);
}

#[test]
fn a_bound_on_the_error_of_decimation_is_held_in_every_format() {
    let folder = folder("scan-decimate");
    let fine = sphere(DVec3::new(300.0, 0.0, 0.0), 50.0, 20);
    let from = folder.join("fine.off");
    fs::write(&from, off::mesh(&fine.positions, &fine.triangles)).unwrap();
    let source = openmesh::read(&from).unwrap();
    for ending in ["ply", "obj", "off", "stl"] {
        let to = folder.join(format!("coarse.{ending}"));
        let bound = Path::new("1.5");
        let flags = [Path::new("--decimate-mm"), bound, Path::new("--json")];
        let outcome = softfold(&[&[Path::new("scan"), &from, Path::new("--out"), &to][..], &flags].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        let said = figures(&outcome);
        assert!(said["decimation_error_mm"].as_f64().is_some_and(|e| e > 0.0 && e <= 1.5), "{said}");
        let coarse = openmesh::clean(openmesh::read(&to).unwrap().view(), 1e-4).unwrap().mesh;
        assert!(coarse.triangles.len() < source.triangles.len() / 2, "{} triangles", coarse.triangles.len());
        // Points that the program did not look at: middles of triangles, by another grid.
        assert!(worst(&source, &coarse).max(worst(&coarse, &source)) <= 1.5 * (1.0 + 1e-6), "{ending}");
    }
}

fn worst(from: &MeshBuffers, to: &MeshBuffers) -> f64 {
    let middle = |t: &[u32; 3]| {
        let sum = |k: usize| t.iter().map(|&i| from.positions[i as usize][k]).sum::<f64>() / 3.0;
        [sum(0), sum(1), sum(2)]
    };
    let points: Vec<[f64; 3]> =
        from.positions.iter().copied().chain(from.triangles.iter().map(middle)).collect();
    cgal::distances_to_mesh(&points, to.view()).unwrap().into_iter().fold(0.0, f64::max)
}

#[test]
fn files_that_are_none_are_refused_with_a_mend_and_nothing_is_written() {
    let folder = folder("scan-bad");
    let good = sphere(DVec3::ZERO, 5.0, 4);
    let binary = stl::binary("x", &good);
    let far = obj::mesh("x", &good.positions, &[[0, 1, 99]]);
    let points = ply::mesh("x", &good.positions, &[]);
    let garbage: Vec<u8> = (0..5000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let files: [(&str, &[u8], &str); 9] = [
        ("empty.stl", b"", "is empty"),
        ("cut.stl", &binary[..binary.len() / 2], "cut off"),
        ("garbage.stl", &garbage, "cut off"),
        ("garbage.ply", &garbage, "does not begin"),
        ("garbage.off", &garbage, "is no OFF file"),
        ("garbage.obj", &garbage, "not text"),
        ("points.ply", &points, "no triangles"),
        ("far.obj", far.as_bytes(), "names none of"),
        ("scan.xyz", b"0 0 0", "ply, obj, stl or off"),
    ];
    let to = folder.join("out.ply");
    for (name, bytes, word) in files {
        let from = folder.join(name);
        fs::write(&from, bytes).unwrap();
        let outcome = softfold(&[Path::new("scan"), &from, Path::new("--out"), &to]);
        assert_eq!(outcome.code, Some(1), "{name}: {outcome:?}");
        assert!(outcome.stderr.contains(word) && outcome.stderr.contains(name), "{name}: {}", outcome.stderr);
        assert!(!to.exists(), "{name}");
    }
    let from = folder.join("good.stl");
    fs::write(&from, &binary).unwrap();
    let [from, to] = [from, to].map(|p| p.display().to_string());
    for (flag, value) in [("--decimate-mm", "0"), ("--merge-mm", "-1"), ("--least-share", "nan")] {
        let outcome = call(&["scan", &from, "--out", &to, &format!("{flag}={value}")]);
        assert_eq!(outcome.code, Some(1), "{outcome:?}");
        assert!(outcome.stderr.contains(flag), "{}", outcome.stderr);
    }
    assert_eq!(call(&["scan", &from, "--out", &to]).code, Some(0));
    assert_eq!(call(&["scan", &from, "--out", &to]).code, Some(1), "it is there already");
}
