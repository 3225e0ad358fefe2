//! `softfold mesh` and `softfold crosscheck` as a user runs them: the files of the flat mesh, read back.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{fixture, fresh, softfold};
use serde_json::Value;
use softfold_geometry::DVec2;
use softfold_kernel::openmesh;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The mesh of the junction's project: valleys and mountains, an outline, a region whose edges are free.
fn meshed() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = fresh("mesh-files");
        let project = fixture("junction").join("project.toml");
        let outcome = softfold(&[Path::new("mesh"), &project, Path::new("--out"), &folder]);
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        folder
    })
}

fn text(name: &str) -> String {
    fs::read_to_string(meshed().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn fold() -> Value {
    serde_json::from_str(&text("flat.fold")).unwrap()
}

fn count(file: &Value, key: &str) -> usize {
    file[key].as_array().unwrap_or_else(|| panic!("no {key}")).len()
}

#[test]
fn openmesh_reads_the_flat_mesh_back_from_every_format() {
    let file = fold();
    let (vertices, triangles) = (count(&file, "vertices_coords"), count(&file, "faces_vertices"));
    let point = |i: usize| {
        let p = &file["vertices_coords"][i];
        DVec2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap())
    };
    for ending in ["obj", "ply", "off", "stl"] {
        let mesh = openmesh::read(&meshed().join(format!("flat.{ending}"))).unwrap();
        assert_eq!(mesh.triangles.len(), triangles, "{ending}");
        if ending != "stl" {
            assert_eq!(mesh.positions.len(), vertices, "{ending}");
            for (i, p) in mesh.positions.iter().enumerate() {
                assert!(
                    point(i).distance(DVec2::new(p[0], p[1])) < 1e-4 && p[2] == 0.0,
                    "{ending}: vertex {i}"
                );
            }
        }
        let whole = openmesh::clean(mesh.view(), 1e-4).unwrap();
        let faults = (whole.removed_triangles, whole.flipped_triangles);
        assert_eq!((whole.mesh.positions.len(), faults), (vertices, (0, 0)), "{ending}");
    }
}

/// The rules of the FOLD format for a mesh of a plane: indices in range, lists as long as their elements, edges once each and
/// between the faces they name, letters and angles of one sign, faces counter-clockwise.
#[test]
fn the_fold_file_keeps_the_rules_of_the_format() {
    let file = fold();
    let (vertices, edges) = (count(&file, "vertices_coords"), count(&file, "edges_vertices"));
    let per_edge = [
        "edges_assignment",
        "edges_foldAngle",
        "edges_faces",
        "softfold:edges_class",
        "softfold:edges_crease",
    ];
    per_edge.iter().for_each(|key| assert_eq!(count(&file, key), edges, "{key}"));
    let id = |v: &Value| usize::try_from(v.as_u64().unwrap()).unwrap();
    let mut sides: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for (f, corners) in file["faces_vertices"].as_array().unwrap().iter().enumerate() {
        let c: Vec<usize> = corners.as_array().unwrap().iter().map(id).collect();
        assert!(c.len() == 3 && c.iter().all(|v| *v < vertices));
        (0..3).for_each(|k| {
            sides.entry([c[k].min(c[(k + 1) % 3]), c[k].max(c[(k + 1) % 3])]).or_default().push(f)
        });
    }
    let mut seen: BTreeMap<(String, String), usize> = BTreeMap::new();
    for e in 0..edges {
        let ends = [0, 1].map(|k| id(&file["edges_vertices"][e][k]));
        let faces =
            sides.remove(&[ends[0].min(ends[1]), ends[0].max(ends[1])]).expect("an edge of a face, once");
        let mut named: Vec<usize> =
            file["edges_faces"][e].as_array().unwrap().iter().filter(|f| !f.is_null()).map(id).collect();
        named.sort_unstable();
        assert_eq!(named, faces, "edge {e}");
        let letter = file["edges_assignment"][e].as_str().unwrap();
        let class = file["softfold:edges_class"][e].as_str().unwrap();
        let angle = file["edges_foldAngle"][e].as_f64().unwrap();
        assert_eq!(letter == "B", faces.len() == 1, "edge {e}");
        assert_eq!((letter == "V", letter == "M"), (angle > 0.0, angle < 0.0), "edge {e}");
        assert_eq!(file["softfold:edges_crease"][e].is_null(), class != "fold", "edge {e}");
        *seen.entry((letter.to_owned(), class.to_owned())).or_default() += 1;
    }
    assert!(sides.is_empty(), "faces with sides that are no edges");
    let kinds: Vec<(&str, &str)> = seen.keys().map(|(l, c)| (l.as_str(), c.as_str())).collect();
    assert_eq!(kinds, [("B", "boundary"), ("J", "facet"), ("J", "free"), ("M", "fold"), ("V", "fold")]);
}

#[test]
fn lines_of_the_obj_and_edges_of_the_ply_are_those_of_the_mesh() {
    let file = fold();
    let letters = file["edges_assignment"].as_array().unwrap();
    let of = |wanted: &[&str]| letters.iter().filter(|l| wanted.contains(&l.as_str().unwrap())).count();
    let mut pieces: BTreeMap<bool, usize> = BTreeMap::new();
    let mut group = String::new();
    for line in text("flat.obj").lines() {
        match line.split_once(' ') {
            Some(("g", name)) => group = name.to_owned(),
            Some(("l", chain)) => {
                *pieces.entry(group.starts_with("fold_")).or_default() += chain.split(' ').count() - 1
            }
            Some(("f", _)) => assert_eq!(group, "sheet"),
            _ => {}
        }
    }
    assert_eq!((pieces[&true], pieces[&false]), (of(&["M", "V"]), of(&["B"])));
    let ply = fs::read(meshed().join("flat.ply")).unwrap();
    let end = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let (v, f, e) = (count(&file, "vertices_coords"), count(&file, "faces_vertices"), letters.len());
    assert_eq!(ply.len(), end + 24 * v + 13 * f + 25 * e);
    let mut classes = [0; 4];
    ply[end + 24 * v + 13 * f..].chunks(25).for_each(|edge| classes[usize::from(edge[8])] += 1);
    assert_eq!((classes[1], classes[3], classes.iter().sum::<usize>()), (of(&["M", "V"]), of(&["B"]), e));
}

#[test]
fn the_picture_has_a_group_for_every_kind_of_edge() {
    let picture = text("mesh.svg");
    for kind in ["facet", "free", "valley fold", "mountain fold", "boundary"] {
        assert!(picture.contains(&format!("<title>{kind}</title>")), "{kind}");
    }
}

#[test]
fn crosscheck_takes_projects_and_patterns() {
    let folder = fixture("junction");
    for file in [folder.join("project.toml"), folder.join("pattern.svg")] {
        let outcome = softfold(&[Path::new("crosscheck"), &file, Path::new("--json")]);
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        let said: Value = serde_json::from_str(outcome.stdout.lines().last().unwrap()).unwrap();
        assert_eq!(said["agrees"], true);
        assert!(said["crosscheck"]["meetings"].as_u64() > Some(0), "{said}");
        let plain = softfold(&[Path::new("crosscheck"), &file]);
        assert!(plain.stdout.contains("constraints held"), "{}", plain.stdout);
    }
    let outcome = softfold(&[Path::new("crosscheck"), Path::new("nothing.svg")]);
    assert_eq!(outcome.code, Some(1));
}

/// The paper's way to a mesh, through the project file.
#[test]
fn the_method_of_the_project_is_followed() {
    let folder = fresh("mesh-paper");
    fs::create_dir_all(&folder).unwrap();
    for (name, bytes) in common::contents(&fixture("junction")) {
        fs::write(folder.join(name), bytes).unwrap();
    }
    let project = folder.join("project.toml");
    let said = |text: &str| {
        fs::write(&project, text).unwrap();
        let outcome = softfold(&[Path::new("mesh"), &project, Path::new("--out"), &folder.join("out")]);
        (outcome.code, outcome.stderr, fs::read(folder.join("out/flat.off")).unwrap_or_default())
    };
    let before = fs::read_to_string(&project).unwrap();
    assert!(before.contains("[mesh]\n"), "the project has no [mesh]");
    let (code, error, graded) = said(&before);
    assert_eq!(code, Some(0), "{error}");
    let (code, error, paper) = said(&before.replace("[mesh]\n", "[mesh]\nmethod = \"paper\"\n"));
    assert_eq!(code, Some(0), "{error}");
    assert_ne!(graded, paper);
    let (code, error, _) = said(&before.replace("[mesh]\n", "[mesh]\nmethod = \"best\"\n"));
    assert!(code == Some(1) && error.contains("best") && error.contains("project.toml:"), "{error}");
}
