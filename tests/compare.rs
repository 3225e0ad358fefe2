//! `softfold compare`: shapes whose distance is known, moved by motions that are known, and what users get wrong.

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

use common::{Outcome, fresh, softfold};
use facts::number;
use serde_json::{Value, json};
use softfold::compare::{
    Align, CompareOptions, Comparison, Points, ReadOptions, What, compare as compare_files,
};
use softfold::export::{off, ply, stl};
use softfold_geometry::{DMat3, DVec2, DVec3, RigidTransform, TriMesh};
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::{Path, PathBuf};

fn options() -> CompareOptions {
    CompareOptions {
        reading: ReadOptions { what: What::Mesh, unit_mm: None, chord_mm: CompareOptions::CHORD_MM },
        align: Align::Auto,
        pose: None,
        points: Points::Auto,
        both: false,
        leave_out_mm: None,
        limit_mm: None,
    }
}

fn unmoved() -> CompareOptions {
    CompareOptions { align: Align::None, ..options() }
}

fn folder(name: &str) -> PathBuf {
    let folder = fresh(name);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// A file with all digits: FOLD.
fn write(path: &Path, mesh: &TriMesh) -> PathBuf {
    let coordinates: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let file = json!({ "file_spec": 1.2, "frame_classes": ["foldedForm"], "frame_unit": "mm",
        "vertices_coords": coordinates, "faces_vertices": mesh.triangles });
    fs::write(path, file.to_string()).expect("written");
    path.to_owned()
}

/// Compares two meshes through files.
fn compared(name: &str, a: &TriMesh, b: &TriMesh, options: &CompareOptions) -> Comparison {
    let folder = folder(name);
    let [a, b] = [("a", a), ("b", b)].map(|(n, m)| write(&folder.join(format!("{n}.fold")), m));
    compare_files(&a, &b, options).unwrap_or_else(|e| panic!("{e}"))
}

/// A grid of squares over a rectangle from `low` to `high`, cut in two, as `shape` bends it.
fn sheet(low: DVec2, high: DVec2, step: f64, shape: impl Fn(DVec2) -> DVec3) -> TriMesh {
    let count = ((high - low) / step).round();
    let (columns, rows) = (count.x as u32, count.y as u32);
    let at = |i: u32, j: u32| low + (high - low) * DVec2::new(f64::from(i), f64::from(j)) / count;
    let id = |i: u32, j: u32| i * (rows + 1) + j;
    let mut mesh = TriMesh::default();
    for i in 0..=columns {
        mesh.positions.extend((0..=rows).map(|j| shape(at(i, j))));
    }
    for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

/// A bent sheet without any symmetry. Waves both ways: a parabola would slide along itself by tilting.
fn bent(p: DVec2) -> DVec3 {
    let (u, v) = (p.x, p.y);
    let waves = 30.0 * (u / 70.0).sin() + 14.0 * (v / 40.0 + 0.4).cos();
    DVec3::new(u, v, waves + 0.0006 * u * v + 1e-6 * u.powi(3))
}

const LOW: DVec2 = DVec2::ZERO;
const HIGH: DVec2 = DVec2::new(400.0, 250.0);

fn bent_sheet() -> TriMesh {
    sheet(LOW, HIGH, 6.0, bent)
}

fn motion() -> RigidTransform {
    let rotation = DMat3::from_axis_angle(DVec3::new(0.3, -0.9, 0.5).normalize(), 2.4);
    RigidTransform { rotation, translation: DVec3::new(950.0, -310.0, 77.0) }
}

fn moved(mesh: &TriMesh, motion: &RigidTransform) -> TriMesh {
    TriMesh { positions: mesh.positions.iter().map(|p| motion.point(*p)).collect(), ..mesh.clone() }
}

/// Largest distance that a motion leaves between points and where they came from.
fn left_over(c: &Comparison, undone: &RigidTransform, points: &[DVec3]) -> f64 {
    let found = c.motion.expect("moved");
    points.iter().map(|p| found.point(undone.point(*p)).distance(*p)).fold(0.0, f64::max)
}

/// Normally distributed numbers that are always the same ones (Box and Muller, on a linear congruence).
struct Noise(u64);

impl Noise {
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.even().ln()).sqrt() * (TAU * self.even()).cos()
    }

    fn added(mut self, mesh: &TriMesh, sigma: f64) -> TriMesh {
        let mut mesh = mesh.clone();
        for p in &mut mesh.positions {
            *p += sigma * DVec3::new(self.normal(), self.normal(), self.normal());
        }
        mesh
    }
}

#[test]
fn a_moved_copy_is_found_back_to_rounding() {
    let mesh = bent_sheet();
    let c = compared("compare-copy", &moved(&mesh, &motion()), &mesh, &options());
    let off = left_over(&c, &motion(), &mesh.positions);
    assert!(off < 1e-9, "{off:e} mm");
    assert!(c.forth.max_mm < 1e-9, "{:e}", c.forth.max_mm);
    let a = c.alignment.expect("aligned");
    assert!(a.converged && a.trimmed < 0.02 && a.free_motions == 0 && !a.mirror_fits, "{a:?}");
    assert!(c.remarks.is_empty(), "{:?}", c.remarks);
}

#[test]
fn a_plane_is_held_by_its_border_and_a_turned_copy_by_a_given_pose() {
    let flat = sheet(LOW, HIGH, 6.0, |p| p.extend(0.0));
    let c = compared("compare-plane", &moved(&flat, &motion()), &flat, &options());
    assert!(c.forth.max_mm < 1e-6, "{:e}", c.forth.max_mm);
    // A pose that is a little off is enough; the search is not asked.
    let near = RigidTransform {
        rotation: DMat3::from_axis_angle(DVec3::Z, 0.05) * motion().inverse().rotation,
        translation: motion().inverse().translation + DVec3::new(3.0, -2.0, 4.0),
    };
    let given = CompareOptions { pose: Some(near), ..options() };
    let c = compared("compare-pose", &moved(&bent_sheet(), &motion()), &bent_sheet(), &given);
    assert!(left_over(&c, &motion(), &bent_sheet().positions) < 1e-9);
    assert_eq!(c.alignment.expect("aligned").starts, 0);
}

#[test]
fn noise_is_found_as_it_is() {
    let (mesh, sigma) = (sheet(LOW, HIGH, 4.0, bent), 0.1);
    let scan = Noise(7).added(&moved(&mesh, &motion()), sigma);
    let c = compared("compare-noise", &scan, &sheet(LOW, HIGH, 1.5, bent), &options());
    let n = c.forth.points as f64;
    // Of the root mean square of n normal numbers: standard deviation σ/√(2n). Borders, where noise to the side counts
    // too, are 4 % of the points and add less than 2 %; the chords of the mesh less still.
    let bound = 4.0 / (2.0 * n).sqrt() + 0.022;
    assert!((c.forth.rms_mm / sigma - 1.0).abs() < bound, "{} of {sigma}, {bound}", c.forth.rms_mm);
    // 50, 90, 99 % of a normal distribution, within their own deviations and the same share.
    let wanted = [0.674_49, 1.644_85, 2.575_83];
    let found = [c.forth.p50_mm, c.forth.p90_mm, c.forth.p99_mm];
    for (w, f) in wanted.iter().zip(found) {
        assert!((f / sigma / w - 1.0).abs() < 0.06, "{f} {w}");
    }
    let s = c.forth.signed.expect("sides");
    assert!(s.mean_mm.abs() < 5.0 * sigma / n.sqrt(), "{s:?}");
    // Six unknowns from n points of slopes of 0.3: shifts in the plane are known to σ/(0.3 √n), turns about the normal to
    // σ/(0.3 · 100 mm √n), so that the corners, 236 mm from the middle, are known to 0.15 σ; thrice that is rare.
    let off = left_over(&c, &motion(), &mesh.positions);
    assert!(off < 0.45 * sigma, "{off}");
}

/// A sphere of latitudes and longitudes, outward.
fn sphere(radius: f64, n: u32) -> TriMesh {
    let at = |i: u32, j: u32| {
        let (a, b) = (PI * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(2 * n));
        radius * DVec3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos())
    };
    let id = |i: u32, j: u32| match i {
        0 => 0,
        i if i == n => 1,
        i => 2 + (i - 1) * 2 * n + j % (2 * n),
    };
    let mut mesh = TriMesh { positions: vec![at(0, 0), at(n, 0)], triangles: vec![] };
    (1..n).for_each(|i| mesh.positions.extend((0..2 * n).map(|j| at(i, j))));
    for (i, j) in (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j))) {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        mesh.triangles.extend(
            [[a, b, c], [a, c, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]),
        );
    }
    mesh
}

#[test]
fn a_sphere_is_a_millimetre_from_one_a_millimetre_larger() {
    let (small, large) = (sphere(50.0, 90), sphere(51.0, 90));
    // From outside, a vertex is nearest to the vertex below it: exactly 1 mm on the side of the normals.
    let both = CompareOptions { both: true, ..unmoved() };
    let c = compared("compare-spheres", &large, &small, &both);
    let s = c.forth.signed.expect("closed");
    assert!((s.min_mm - 1.0).abs() < 1e-12 && (s.max_mm - 1.0).abs() < 1e-12, "{s:?}");
    // From inside, facets are nearer than their corners, by less than the chord.
    let s = c.back.expect("both").signed.expect("closed");
    assert!(s.max_mm < -0.999 && s.min_mm >= -1.0, "{s:?}");
}

#[test]
fn a_sphere_finds_its_centre_and_says_that_it_may_turn() {
    let shift = RigidTransform { translation: DVec3::new(31.0, -7.0, 12.0), ..RigidTransform::IDENTITY };
    let c = compared("compare-ball", &moved(&sphere(50.0, 40), &shift), &sphere(50.0, 40), &options());
    assert!(c.forth.max_mm < 0.3, "within the facets: {}", c.forth.max_mm);
    let centre = c.motion.expect("moved").point(shift.translation);
    assert!(centre.length() < 0.05, "{centre}");
}

/// The part of a sheet whose middle lies at u below `most`.
fn part(mesh: &TriMesh, most: f64) -> TriMesh {
    let keep = |t: &&[u32; 3]| mesh.corners(**t).iter().map(|p| p.x).sum::<f64>() < 3.0 * most;
    TriMesh { triangles: mesh.triangles.iter().filter(keep).copied().collect(), ..mesh.clone() }
}

#[test]
fn a_scan_of_a_part_is_aligned_whichever_way_round() {
    let mesh = bent_sheet();
    let scan = moved(&part(&mesh, 0.6 * HIGH.x), &motion());
    let c = compared("compare-part", &scan, &mesh, &options());
    assert!(left_over(&c, &motion(), &mesh.positions) < 1e-9);
    assert!(c.forth.max_mm < 1e-9 && c.forth.past_border == 0);
    let c = compared("compare-part-back", &mesh, &scan, &options());
    assert!(left_over(&c, &motion().inverse(), &scan.positions) < 1e-9);
    assert!(c.forth.p50_mm < 1e-9);
    let past = c.forth.past_border as f64 / c.forth.points as f64;
    assert!((0.36..0.42).contains(&past), "{past}");
    assert!(c.remarks.iter().any(|r| r.contains("past the border")), "{:?}", c.remarks);
    // Left out, only the common part counts.
    let near = CompareOptions { leave_out_mm: Some(1.0), ..options() };
    let c = compared("compare-part-near", &mesh, &scan, &near);
    assert!(c.forth.left_out > 1000 && c.forth.max_mm < 1.0);
}

#[test]
fn a_noisy_scan_of_a_part_with_stray_pieces_is_aligned() {
    let (mesh, sigma) = (bent_sheet(), 0.2);
    let mut scan = part(&sheet(LOW, HIGH, 5.0, bent), 0.6 * HIGH.x);
    // A table below it, a fifth of its area, that does not count.
    let table = sheet(DVec2::new(-60.0, 0.0), DVec2::new(60.0, 100.0), 6.0, |p| p.extend(-80.0));
    let first = scan.positions.len() as u32;
    scan.positions.extend(table.positions);
    scan.triangles.extend(table.triangles.iter().map(|t| t.map(|v| v + first)));
    let scan = Noise(3).added(&moved(&scan, &motion()), sigma);
    let c = compared("compare-stray", &scan, &mesh, &options());
    let off = left_over(&c, &motion(), &part(&mesh, 0.6 * HIGH.x).positions);
    assert!(off < sigma, "{off}");
    let a = c.alignment.expect("aligned");
    assert!((0.1..0.25).contains(&a.trimmed), "{a:?}");
}

#[test]
fn a_mirrored_scan_does_not_fit_and_that_is_said() {
    let mesh = bent_sheet();
    let mut scan = moved(&mesh, &motion());
    scan.positions.iter_mut().for_each(|p| p.y = -p.y);
    scan.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let c = compared("compare-mirror", &scan, &mesh, &options());
    assert!(c.forth.rms_mm > 1.0, "{}", c.forth.rms_mm);
    let rotation = c.motion.expect("moved").rotation;
    assert!((rotation.determinant() - 1.0).abs() < 1e-12);
    assert!(c.alignment.expect("aligned").mirror_fits);
    assert!(c.remarks.iter().any(|r| r.contains("mirror")), "{:?}", c.remarks);
}

#[test]
fn a_symmetric_sheet_fits_in_one_of_its_poses() {
    // A right angle with a soft bend: two half turns bring it onto itself.
    let fold = |p: DVec2| {
        let (r, s) = (25.0, p.x - 100.0);
        let half = 0.25 * PI * r;
        let a = (s / r).clamp(-0.25 * PI, 0.25 * PI);
        let past = (s.abs() - half).max(0.0) * s.signum();
        DVec3::new(r * a.sin() + past * a.cos(), p.y, r * (1.0 - a.cos()) + past.abs() * a.sin().abs())
    };
    let mesh = sheet(LOW, DVec2::new(200.0, 120.0), 4.0, fold);
    let c = compared("compare-symmetric", &moved(&mesh, &motion()), &mesh, &options());
    // The diagonals of a turned copy cross its own: within the chord of a square.
    assert!(c.forth.max_mm < 0.02, "{}", c.forth.max_mm);
}

#[test]
fn percentiles_of_a_known_distribution() {
    // A ramp over a plane: heights from 0 to 10 evenly, through the vertices and through points spread over the area.
    let ramp = sheet(LOW, HIGH, 2.0, |p| p.extend(10.0 * p.x / HIGH.x));
    let plane = sheet(DVec2::splat(-50.0), DVec2::splat(500.0), 550.0, |p| p.extend(0.0));
    for (points, slack) in [(Points::Vertices, 0.03), (Points::Spread(20_000), 0.002)] {
        let c = compared("compare-ramp", &ramp, &plane, &CompareOptions { points, ..unmoved() });
        for (found, wanted) in [(c.forth.p50_mm, 5.0), (c.forth.p90_mm, 9.0), (c.forth.p99_mm, 9.9)] {
            assert!((found - wanted).abs() < slack, "{points:?}: {found} {wanted}");
        }
        assert!((c.forth.rms_mm - 10.0 / 3.0_f64.sqrt()).abs() < slack, "{}", c.forth.rms_mm);
        let h = &c.forth.histogram;
        let each = c.forth.points as f64 / (10.0 / h.width_mm);
        let inner = &h.counts[1..h.counts.len() - 2];
        assert!(inner.iter().all(|n| (*n as f64 / each - 1.0).abs() < 0.05), "{h:?}");
    }
    // Large triangles are not measured by their corners alone.
    let c = compared(
        "compare-ramp-large",
        &sheet(LOW, HIGH, 200.0, |p| p.extend(10.0 * p.x / HIGH.x)),
        &plane,
        &unmoved(),
    );
    assert_eq!(c.forth.sampling, "spread");
    assert!((c.forth.p50_mm - 5.0).abs() < 0.01);
    assert!(c.shown.triangles.len() > 1000, "fine enough to be coloured: {}", c.shown.triangles.len());
}

fn call(arguments: &[&str]) -> Outcome {
    softfold(&arguments.iter().map(Path::new).collect::<Vec<_>>())
}

fn path(p: &Path) -> &str {
    p.to_str().expect("UTF-8")
}

/// A scan, what it should be, and a folder that does not exist yet.
fn two_files(name: &str) -> [PathBuf; 3] {
    let folder = folder(name);
    let mesh = bent_sheet();
    let (a, b) = (folder.join("scan.ply"), folder.join("wanted.off"));
    let scan = Noise(1).added(&moved(&mesh, &motion()), 0.05);
    fs::write(&a, ply::mesh("scan", &scan.positions, &scan.triangles)).unwrap();
    fs::write(&b, off::mesh(&mesh.positions, &mesh.triangles)).unwrap();
    [a, b, folder.join("out")]
}

#[test]
fn files_are_written_read_by_others_and_the_same_each_time() {
    let [a, b, out] = two_files("compare-files");
    let arguments = ["compare", path(&a), path(&b), "--both", "--out", path(&out)];
    let said = call(&arguments);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    assert!(said.stdout.contains("largest") && said.stdout.contains("99 % within"), "{}", said.stdout);
    let first = common::contents(&out);
    assert_eq!(first.keys().collect::<Vec<_>>(), ["compare.html", "compare.json", "compare.ply"]);
    assert_eq!(call(&arguments).code, Some(0), "its own files are replaced");
    assert_eq!(common::contents(&out), first);
    let record: Value = serde_json::from_slice(&first["compare.json"]).unwrap();
    assert_eq!(record["schema"], "softfold-compare/1");
    assert_eq!(record["alignment"]["start"], "found");
    assert!(number(&record["distance"]["p99_mm"]) < 0.2);
    assert!(record["distance_back"]["points"].is_u64());
    let page = String::from_utf8(first["compare.html"].clone()).unwrap();
    for word in ["Histogram", "<svg", "data:image/png", "99 % are within"] {
        assert!(page.contains(word), "{word}");
    }
    assert!(!page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "").contains("http"));
    let Some(facts) = readers::ask("figures.py", &[out.join("compare.ply")]) else { return };
    assert_eq!(number(&facts[0]["vertices"]), number(&record["measured"]["vertices"]));
    let distance = &facts[0]["figures"]["distance"];
    let signed = &record["distance"]["signed"];
    for (end, wanted) in [("min", &signed["min_mm"]), ("max", &signed["max_mm"])] {
        assert!((number(&distance[end]) - number(wanted)).abs() < 1e-6, "{end}: {distance} {signed}");
    }
    assert_eq!(facts[0]["colours"], true);
}

#[test]
fn a_limit_decides_the_status_and_json_tells_all() {
    let [a, b, _] = two_files("compare-limit");
    let run = |limit: &str| call(&["compare", path(&a), path(&b), "--limit-mm", limit, "--json"]);
    let said = run("1");
    assert_eq!(said.code, Some(0), "{}", said.stderr);
    let event: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!((&event["event"], &event["compare"]["passes"]), (&json!("compared"), &json!(true)));
    let said = run("0.01");
    assert_eq!(said.code, Some(3));
    let event: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(event["compare"]["passes"], false);
}

#[test]
fn a_scan_in_metres_is_scaled_and_without_that_it_is_said() {
    let folder = folder("compare-metres");
    let mesh = bent_sheet();
    let mut scan = moved(&mesh, &motion());
    scan.positions.iter_mut().for_each(|p| *p *= 1e-3);
    let (a, b) = (folder.join("scan.stl"), folder.join("wanted.off"));
    fs::write(&a, stl::binary("scan", &scan)).unwrap();
    fs::write(&b, off::mesh(&mesh.positions, &mesh.triangles)).unwrap();
    let said = call(&["compare", path(&a), path(&b)]);
    assert!(said.stdout.contains("--unit-mm 1000"), "{}{}", said.stdout, said.stderr);
    // The unit holds for both files; the second is written in metres too.
    let metres = TriMesh { positions: mesh.positions.iter().map(|p| 1e-3 * *p).collect(), ..mesh };
    fs::write(&b, ply::mesh("wanted", &metres.positions, &metres.triangles).as_slice()).unwrap();
    let b = folder.join("wanted.ply");
    fs::rename(folder.join("wanted.off"), &b).unwrap();
    let said = call(&["compare", path(&a), path(&b), "--unit-mm", "1000", "--json"]);
    let event: Value = serde_json::from_str(&said.stdout).unwrap_or_else(|e| panic!("{e}: {said:?}"));
    // STL has single precision: 950 mm to 6e-5 mm.
    assert!(number(&event["compare"]["distance"]["max_mm"]) < 5e-4, "{}", event["compare"]["distance"]);
    assert_eq!(event["compare"]["measured"]["unit_mm"], 1000.0);
}

#[test]
fn what_cannot_be_compared_is_refused_with_the_file_and_a_mend() {
    let [a, b, out] = two_files("compare-refused");
    let empty = folder("compare-refused-empty");
    let broken = empty.join("broken.step");
    fs::write(&broken, "ISO-10303-21;\nnothing more").unwrap();
    let flat = empty.join("flat.fold");
    fs::write(&flat, r#"{"frame_classes":["creasePattern"],"vertices_coords":[[0,0],[1,0],[1,1]],"faces_vertices":[[0,1,2]]}"#)
        .unwrap();
    let (a, b) = (path(&a), path(&b));
    let cases: [(&[&str], &str, &str); 9] = [
        (&["no-such.ply", b], "no-such.ply", "check the path"),
        (&[a, "wanted.docx"], "wanted.docx", "give a mesh"),
        (&[a, path(&empty)], "folded.fold", "softfold fold"),
        (&[a, path(&broken)], "broken.step", "export"),
        (&[path(&flat), b], "flat.fold", "folded state"),
        (&[a, b, "--pose", "1 2 3"], "--pose", "give"),
        (&[a, b, "--unit-mm", "0"], "--unit-mm", "positive"),
        (&[a, b, "--align", "none", "--leave-out-mm", "0.001"], "scan.ply", "--leave-out-mm"),
        (&[a, b, "--limit-mm=-1"], "--limit-mm", "positive"),
    ];
    for (arguments, place, mend) in cases {
        let said = call(&[&["compare"], arguments, &["--out", path(&out)]].concat());
        assert_eq!(said.code, Some(1), "{arguments:?}: {said:?}");
        assert!(said.stderr.contains(place) && said.stderr.contains(mend), "{arguments:?}: {}", said.stderr);
        assert!(!out.exists(), "{arguments:?} left a folder behind");
    }
    assert_eq!(call(&["compare", a, b, "--points", "none"]).code, Some(2));
    // A file of the user's in the way.
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("compare.ply"), "mine").unwrap();
    let said = call(&["compare", a, b, "--out", path(&out)]);
    assert!(said.code == Some(1) && said.stderr.contains("compare.ply"), "{said:?}");
    assert_eq!(fs::read_to_string(out.join("compare.ply")).unwrap(), "mine");
}
