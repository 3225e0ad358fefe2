//! OpenMesh's operations against closed forms.
#![allow(clippy::unwrap_used)] // what helps a test may stop at the first surprise, as tests do

mod common;

use common::{assert_close, box_mesh, grid_mesh};
use softfold_kernel::{KernelError, MeshBuffers, MeshView, cgal, openmesh};
use std::fs;

/// A box whose faces are grids of `n` × `n` squares.
fn fine_box(n: usize, size: f64) -> MeshBuffers {
    let step = size / n as f64;
    let sheet = grid_mesh(n, step, |_, _| 0.0);
    let mut soup = MeshBuffers::default();
    for (axis, far) in [(0, false), (0, true), (1, false), (1, true), (2, false), (2, true)] {
        let base = soup.positions.len() as u32;
        let place = |p: &[f64; 3]| {
            let mut q = [0.0; 3];
            q[axis] = if far { size } else { 0.0 };
            q[(axis + 1) % 3] = p[0];
            q[(axis + 2) % 3] = p[1];
            q
        };
        soup.positions.extend(sheet.positions.iter().map(place));
        let turn = |t: &[u32; 3]| if far { *t } else { [t[0], t[2], t[1]] };
        soup.triangles.extend(sheet.triangles.iter().map(|t| turn(t).map(|i| i + base)));
    }
    openmesh::clean(soup.view(), 1e-9).unwrap().mesh
}

fn soup_of(mesh: &MeshBuffers) -> MeshBuffers {
    let corners = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]);
    let triangle = |i| [3 * i, 3 * i + 1, 3 * i + 2];
    MeshBuffers {
        positions: corners.collect(),
        triangles: (0..mesh.triangles.len() as u32).map(triangle).collect(),
    }
}

#[test]
fn cleaning_makes_a_box_of_a_soup() {
    let cube = box_mesh([0.0; 3], [10.0; 3]);
    let mut soup = soup_of(&cube);
    for i in [1, 4, 7] {
        soup.triangles[i].swap(0, 1);
    }
    soup.triangles.push([0, 1, 1]);
    soup.triangles.push(soup.triangles[2]);
    soup.positions[5][0] += 1e-4;
    let cleaned = openmesh::clean(soup.view(), 1e-3).unwrap();
    assert_eq!((cleaned.merged_vertices, cleaned.removed_triangles, cleaned.flipped_triangles), (28, 2, 3));
    let check = cgal::closed_check(cleaned.mesh.view()).unwrap();
    assert!(check.closed && check.manifold && check.outward);
    assert_close(check.volume_mm3, 1000.0, 1e-4);
    assert_eq!(cleaned.mesh.positions.len(), 8);
}

#[test]
fn cleaning_turns_a_closed_piece_outward_and_drops_a_third_triangle_at_an_edge() {
    let mut mesh = box_mesh([0.0; 3], [10.0; 3]);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let [a, b, _] = mesh.triangles[0];
    mesh.positions.push([-5.0, -5.0, -5.0]);
    mesh.triangles.push([a, b, 8]);
    let cleaned = openmesh::clean(mesh.view(), 0.0).unwrap();
    assert_eq!((cleaned.removed_triangles, cleaned.flipped_triangles), (1, 12));
    assert!(cgal::closed_check(cleaned.mesh.view()).unwrap().outward);
}

#[test]
fn a_fine_box_decimates_to_twelve_triangles_or_so() {
    let fine = fine_box(20, 50.0);
    assert_eq!(fine.triangles.len(), 4800);
    let coarse = openmesh::decimate(fine.view(), 0.01).unwrap();
    let check = cgal::closed_check(coarse.view()).unwrap();
    assert!(check.closed && check.manifold && check.outward);
    assert_close(check.volume_mm3, 125_000.0, 1e-3);
    assert!(coarse.triangles.len() <= 24, "{} triangles", coarse.triangles.len());
}

#[test]
fn decimation_stays_within_its_bound() {
    let hills = grid_mesh(60, 1.0, |x, y| 3.0 * (0.2 * x).sin() * (0.15 * y).cos());
    let bound = 0.05;
    let coarse = openmesh::decimate(hills.view(), bound).unwrap();
    assert!(coarse.triangles.len() < hills.triangles.len() / 2, "{} triangles", coarse.triangles.len());
    let distances = cgal::distances_to_mesh(&hills.positions, coarse.view()).unwrap();
    let worst = distances.iter().copied().fold(0.0, f64::max);
    assert!(worst <= bound * (1.0 + 1e-9), "{worst}");
    let centers: Vec<[f64; 3]> = coarse
        .triangles
        .iter()
        .map(|t| {
            std::array::from_fn(|k| t.iter().map(|&i| coarse.positions[i as usize][k]).sum::<f64>() / 3.0)
        })
        .collect();
    let back = cgal::distances_to_mesh(&centers, hills.view()).unwrap();
    let worst = back.iter().copied().fold(0.0, f64::max);
    assert!(worst <= bound, "{worst} from the result to the input");
}

#[test]
fn files_of_four_kinds_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let texts = [
        ("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             element face 2\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
        ),
        (
            "a.stl",
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n\
             facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
        ),
    ];
    for (name, text) in texts {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        let mesh = openmesh::read(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 2), "{name}");
    }
}

#[test]
fn bad_files_and_meshes_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let missing = openmesh::read(&folder.path().join("missing.ply")).unwrap_err();
    assert!(matches!(missing, KernelError::File { .. }), "{missing}");
    for (name, text) in
        [("a.ply", "nonsense"), ("a.xyz", "1 2 3"), ("a.off", "OFF\n0 0 0\n"), ("a.obj", "v 0 0 0\n")]
    {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        assert!(openmesh::read(&path).is_err(), "{name}");
    }
    let cube = box_mesh([0.0; 3], [1.0; 3]);
    assert!(openmesh::decimate(cube.view(), 0.0).is_err());
    assert!(openmesh::clean(cube.view(), f64::NAN).is_err());
    assert!(openmesh::clean(MeshView { positions: &[[0.0; 3]], triangles: &[[0, 0, 0]] }, 0.0).is_err());
    let mut double = cube;
    double.triangles.push(double.triangles[0]);
    assert!(openmesh::decimate(double.view(), 0.1).is_err());
}

/// One file of each format, with the same box.
fn box_files() -> Vec<(&'static str, Vec<u8>)> {
    let cube = box_mesh([0.0; 3], [10.0; 3]);
    let line = |start: &str, numbers: Vec<String>| format!("{start}{}\n", numbers.join(" "));
    let vertices = |start: &str| {
        cube.positions.iter().map(|p| line(start, p.iter().map(f64::to_string).collect())).collect::<String>()
    };
    let faces = |start: &str, first: u32| {
        let face = |t: &[u32; 3]| line(start, t.iter().map(|i| (i + first).to_string()).collect());
        cube.triangles.iter().map(face).collect::<String>()
    };
    let (v, t) = (cube.positions.len(), cube.triangles.len());
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {v}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {t}\nproperty list uchar int vertex_indices\nend_header\n{}{}",
        vertices(""),
        faces("3 ", 0)
    );
    let mut binary =
        ply[..ply.find("end_header").unwrap()].replace("ascii", "binary_little_endian").into_bytes();
    binary.extend(b"end_header\n");
    cube.positions.iter().flatten().for_each(|x| binary.extend((*x as f32).to_le_bytes()));
    for t in &cube.triangles {
        binary.push(3);
        t.iter().for_each(|i| binary.extend(i.to_le_bytes()));
    }
    let mut stl = vec![b' '; 80];
    stl.extend((t as u32).to_le_bytes());
    for t in &cube.triangles {
        stl.extend([0; 12]);
        t.iter().flat_map(|&i| cube.positions[i as usize]).for_each(|x| stl.extend((x as f32).to_le_bytes()));
        stl.extend([0; 2]);
    }
    vec![
        ("a.obj", format!("{}{}", vertices("v "), faces("f ", 1)).into_bytes()),
        ("a.off", format!("OFF\n{v} {t} 0\n{}{}", vertices(""), faces("3 ", 0)).into_bytes()),
        ("a.ply", ply.into_bytes()),
        ("b.ply", binary),
        ("a.stl", stl),
    ]
}

/// Files cut off anywhere and with bytes changed are read or refused with a mend: no crash, no exception, no long wait.
#[test]
fn files_that_are_cut_off_or_spoilt_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in box_files() {
        let path = folder.path().join(name);
        let mut refused = 0;
        let mut try_it = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            if let Err(error) = openmesh::read(&path) {
                assert!(matches!(error, KernelError::File { .. }), "{name}: {error}");
                refused += 1;
            }
        };
        try_it(&bytes);
        let step = bytes.len() / 40 + 1;
        (0..bytes.len()).step_by(step).for_each(|cut| try_it(&bytes[..cut]));
        for at in (0..bytes.len()).step_by(step) {
            for value in [0, b'-', b'9', 0xff] {
                let mut spoilt = bytes.clone();
                spoilt[at] = value;
                try_it(&spoilt);
            }
        }
        assert!(refused >= 10, "{name}: {refused} refused");
        fs::write(&path, &bytes).unwrap();
        let whole = openmesh::read(&path).unwrap();
        assert_eq!((whole.triangles.len(), refused > 0), (12, true), "{name}");
    }
}

#[test]
fn a_file_that_holds_less_than_it_says_is_refused_with_its_counts() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in box_files().into_iter().filter(|(n, _)| *n != "a.obj") {
        let path = folder.path().join(name);
        fs::write(&path, &bytes[..bytes.len() * 9 / 10]).unwrap();
        let error = openmesh::read(&path).unwrap_err().to_string();
        assert!(error.contains(" 12") && error.contains("cut off"), "{error}");
    }
    let path = folder.path().join("far.off");
    fs::write(&path, "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 9\n").unwrap();
    let error = openmesh::read(&path).unwrap_err().to_string();
    assert!(error.contains("line 7") && error.contains("3 vertices"), "{error}");
}

#[test]
fn stray_pieces_are_dropped_by_their_area() {
    let mut mesh = box_mesh([0.0; 3], [10.0; 3]);
    let stray = box_mesh([50.0; 3], [50.5; 3]);
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(&stray.positions);
    mesh.triangles.extend(stray.triangles.iter().map(|t| t.map(|i| i + base)));
    // Areas 600 and 1.5: a share of 1/400.
    let kept = openmesh::without_strays(mesh.view(), 0.01).unwrap();
    assert_eq!((kept.pieces, kept.dropped_pieces, kept.dropped_triangles), (2, 1, 12));
    assert_eq!((kept.mesh.positions.len(), kept.mesh.triangles.len()), (8, 12));
    assert_eq!(openmesh::without_strays(mesh.view(), 0.002).unwrap().mesh, mesh);
    assert!(openmesh::without_strays(mesh.view(), 1.5).is_err());
}
