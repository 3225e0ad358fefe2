//! CGAL's operations against closed forms.
#![allow(clippy::unwrap_used)] // what helps a test may stop at the first surprise, as tests do

mod common;

use common::{assert_close, box_mesh, grid_mesh};
use softfold_kernel::cgal::{self, ConstraintEdge};
use softfold_kernel::{BooleanOperation, KernelError, MeshBuffers, MeshView};

fn area(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> f64 {
    let signed = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| points[i as usize]);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    };
    assert!(triangles.iter().all(|t| signed(t) > 0.0), "a triangle is not counter-clockwise");
    triangles.iter().map(signed).sum()
}

fn cube_at(x: f64) -> MeshBuffers {
    box_mesh([x, 0.0, 0.0], [x + 10.0, 10.0, 10.0])
}

#[test]
fn crossing_constraints_are_split_at_the_crossing() {
    let points = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]];
    let found = cgal::constrained_delaunay(&points, &[[0, 2], [3, 1]]).unwrap();
    assert_eq!(found.points[..4], points);
    assert_eq!(found.points[4..], [[1.5, 1.5]]);
    let edge = |vertices, input| ConstraintEdge { vertices, input };
    assert_eq!(found.constraints, [edge([0, 4], 0), edge([4, 2], 0), edge([3, 4], 1), edge([4, 1], 1)]);
    assert_eq!(found.triangles.len(), 4);
    assert_close(area(&found.points, &found.triangles), 9.0, 1e-15);
}

#[test]
fn constraints_may_overlap_touch_and_pass_through_points() {
    let points = [[0.0, 0.0], [4.0, 0.0], [1.0, 0.0], [3.0, 0.0], [2.0, 2.0], [2.0, 0.0]];
    let found = cgal::constrained_delaunay(&points, &[[0, 1], [3, 2], [4, 5], [2, 2]]).unwrap();
    let pieces =
        |input| found.constraints.iter().filter(|e| e.input == input).map(|e| e.vertices).collect::<Vec<_>>();
    assert_eq!(pieces(0), [[0, 2], [2, 5], [5, 3], [3, 1]]);
    assert_eq!(pieces(1), [[3, 5], [5, 2]]);
    assert_eq!(pieces(2), [[4, 5]]);
    assert!(pieces(3).is_empty());
}

#[test]
fn equal_points_become_one() {
    let found =
        cgal::constrained_delaunay(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 1.0]], &[[2, 1]]).unwrap();
    assert_eq!(found.points, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(found.index_of_input, [0, 1, 0, 2]);
    assert_eq!(found.constraints, [ConstraintEdge { vertices: [0, 1], input: 0 }]);
}

#[test]
fn many_crossings_keep_every_constraint_and_the_area() {
    let n = 30;
    let line =
        |i: usize| [[i as f64 + 0.25, 0.0], [i as f64 * 1.1, 30.0], [0.0, i as f64 + 0.5], [40.0, i as f64]];
    let points: Vec<_> = (0..n).flat_map(line).collect();
    let constraints: Vec<_> =
        (0..n as u32).flat_map(|i| [[4 * i, 4 * i + 1], [4 * i + 2, 4 * i + 3]]).collect();
    let found = cgal::constrained_delaunay(&points, &constraints).unwrap();
    let length = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    for (input, ends) in constraints.iter().enumerate() {
        let pieces = found.constraints.iter().filter(|e| e.input as usize == input);
        let sum: f64 = pieces
            .map(|e| length(found.points[e.vertices[0] as usize], found.points[e.vertices[1] as usize]))
            .sum();
        assert_close(sum, length(points[ends[0] as usize], points[ends[1] as usize]), 1e-12);
    }
    let hull = cgal::convex_hull(&points).unwrap();
    let fan: Vec<_> = (2..hull.len()).map(|i| [hull[0], hull[i - 1], hull[i]]).collect();
    assert_close(area(&found.points, &found.triangles), area(&points, &fan), 1e-12);
    assert_eq!(found, cgal::constrained_delaunay(&points, &constraints).unwrap());
}

#[test]
fn ten_thousand_points_take_seconds_not_minutes() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut points: Vec<_> = (0..10_000).map(|_| [1000.0 * random(), 1000.0 * random()]).collect();
    for i in 0..1000 {
        let [x, y] = points[2 * i];
        points[2 * i + 1] = [x + 40.0 * random(), y + 40.0 * random()];
    }
    let constraints: Vec<[u32; 2]> = (0..1000).map(|i| [2 * i, 2 * i + 1]).collect();
    let start = std::time::Instant::now();
    let found = cgal::constrained_delaunay(&points, &constraints).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    println!("{} points, {seconds:.2} s", found.points.len());
    assert!(seconds < 20.0, "{seconds} s");
}

#[test]
fn a_hull_has_corners_only() {
    let points = [[1.0, 1.0], [0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    let hull = cgal::convex_hull(&points).unwrap();
    let start = hull.iter().position(|&i| i == 1).unwrap();
    let turned: Vec<_> = (0..hull.len()).map(|i| hull[(start + i) % hull.len()]).collect();
    assert_eq!(turned, [1, 2, 4, 5]);
    assert_eq!(cgal::convex_hull(&[[5.0, 5.0]]).unwrap(), [0]);
}

#[test]
fn booleans_of_boxes_have_the_volumes_of_boxes() {
    let (a, b) = (cube_at(0.0), box_mesh([4.0, 3.0, 2.0], [14.0, 13.0, 12.0]));
    let overlap = 6.0 * 7.0 * 8.0;
    for (operation, volume) in [
        (BooleanOperation::Union, 2000.0 - overlap),
        (BooleanOperation::Intersection, overlap),
        (BooleanOperation::Difference, 1000.0 - overlap),
    ] {
        let mesh = cgal::boolean(a.view(), b.view(), operation).unwrap();
        let check = cgal::closed_check(mesh.view()).unwrap();
        assert!(check.closed && check.manifold && check.outward, "{operation:?}: {check:?}");
        assert_close(check.volume_mm3, volume, 1e-12);
        assert_eq!(cgal::self_intersections(mesh.view()).unwrap(), Vec::<[u32; 2]>::new());
    }
}

/// A body that many small ones are cut out of, as marks are out of a printed part.
fn engraved() -> MeshBuffers {
    (0..6).fold(box_mesh([0.0; 3], [70.0, 30.0, 10.0]), |body, i| {
        let x = 5.0 + 10.3 * f64::from(i);
        let mark = box_mesh([x, 7.1, 8.0], [x + 4.7, 21.9, 12.0]);
        cgal::boolean(body.view(), mark.view(), BooleanOperation::Difference).unwrap()
    })
}

#[test]
fn the_same_boolean_gives_the_same_arrays() {
    let first = engraved();
    // Memory in use moves what CGAL allocates, and with that its order.
    let held: Vec<Vec<u8>> = (1..2000).map(|i| vec![1; 37 * i % 4096]).collect();
    assert_eq!(first, engraved());
    let elsewhere = std::thread::spawn(engraved).join().unwrap();
    assert_eq!(first, elsewhere);
    drop(held);
}

#[test]
fn disjoint_solids_have_an_empty_intersection() {
    let mesh =
        cgal::boolean(cube_at(0.0).view(), cube_at(20.0).view(), BooleanOperation::Intersection).unwrap();
    assert_eq!(mesh, MeshBuffers::default());
}

#[test]
fn booleans_refuse_open_and_inverted_meshes() {
    let mut open = cube_at(0.0);
    open.triangles.pop();
    let mut inverted = cube_at(0.0);
    inverted.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    for bad in [open, inverted] {
        let error = cgal::boolean(bad.view(), cube_at(5.0).view(), BooleanOperation::Union).unwrap_err();
        assert!(matches!(error, KernelError::Failed { operation: "cgal::boolean", .. }), "{error}");
    }
}

#[test]
fn an_extruded_sheet_is_a_box() {
    let sheet = grid_mesh(4, 2.5, |_, _| 0.0);
    for z in [3.0, -3.0] {
        let solid = cgal::extrude(sheet.view(), [0.0, 0.0, z]).unwrap();
        let check = cgal::closed_check(solid.view()).unwrap();
        assert!(check.closed && check.manifold && check.outward);
        assert_close(check.volume_mm3, 300.0, 1e-14);
    }
    assert!(cgal::extrude(cube_at(0.0).view(), [0.0, 0.0, 1.0]).is_err());
}

#[test]
fn distances_to_a_box_are_those_to_a_box() {
    let points = [[5.0, 5.0, 15.0], [13.0, 14.0, 5.0], [5.0, 5.0, 5.0], [0.0, 0.0, 0.0]];
    let found = cgal::distances_to_mesh(&points, cube_at(0.0).view()).unwrap();
    for (distance, wanted) in found.iter().zip([5.0, 5.0, 5.0, 0.0]) {
        assert!((distance - wanted).abs() < 1e-14, "{distance} {wanted}");
    }
}

#[test]
fn remeshing_reaches_the_edge_length_and_keeps_the_area() {
    let sheet = grid_mesh(4, 10.0, |_, _| 0.0);
    let mesh = cgal::isotropic_remesh(sheet.view(), 2.0, 5).unwrap();
    let flat: Vec<[f64; 2]> = mesh.positions.iter().map(|p| [p[0], p[1]]).collect();
    assert_close(area(&flat, &mesh.triangles), 1600.0, 1e-9);
    let ideal = 1600.0 / (3.0_f64.sqrt() / 4.0 * 4.0);
    let count = mesh.triangles.len() as f64;
    assert!((0.5 * ideal..2.0 * ideal).contains(&count), "{count} triangles, about {ideal} wanted");
}

#[test]
fn crossing_triangles_are_listed() {
    let mesh = MeshBuffers {
        positions: vec![
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [0.0, 4.0, 0.0],
            [1.0, 1.0, -1.0],
            [1.0, 1.0, 1.0],
            [9.0, 1.0, 0.0],
        ],
        triangles: vec![[0, 1, 2], [3, 4, 5]],
    };
    assert_eq!(cgal::self_intersections(mesh.view()).unwrap(), [[0, 1]]);
}

#[test]
fn a_wrap_closes_an_open_box() {
    let mut open = cube_at(0.0);
    open.triangles.pop();
    let wrap = cgal::alpha_wrap(open.view(), 20.0, 0.1).unwrap();
    let check = cgal::closed_check(wrap.view()).unwrap();
    assert!(check.closed && check.manifold && check.outward);
    assert!(check.volume_mm3 > 1000.0 && check.volume_mm3 < 1500.0, "{check:?}");
    let error = cgal::alpha_wrap(open.view(), 1e-9, 0.1).unwrap_err();
    assert!(error.to_string().contains("alpha_mm"), "{error}");
}

#[test]
fn closed_check_tells_open_inverted_and_touching() {
    let found = |mesh: &MeshBuffers| {
        let c = cgal::closed_check(mesh.view()).unwrap();
        (c.closed, c.manifold, c.outward)
    };
    let mut cube = cube_at(0.0);
    assert_eq!(found(&cube), (true, true, true));
    cube.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    assert_eq!(found(&cube), (true, true, false));
    assert_close(cgal::closed_check(cube.view()).unwrap().volume_mm3, -1000.0, 1e-14);
    cube.triangles.pop();
    assert_eq!(found(&cube), (false, true, false));
    assert_eq!(found(&two_tetrahedra(1)), (true, false, false));
    assert_eq!(found(&two_tetrahedra(2)), (true, false, false));
}

/// Two tetrahedra that share their first one or two vertices.
fn two_tetrahedra(shared: u32) -> MeshBuffers {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [-1.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let tetrahedron = |[a, b, c, d]: [u32; 4]| [[a, c, b], [a, b, d], [a, d, c], [b, c, d]];
    let apex = if shared == 2 { 1 } else { 6 };
    let triangles = [tetrahedron([0, 2, 3, 1]), tetrahedron([0, 4, 5, apex])].concat();
    MeshBuffers { positions, triangles }
}

#[test]
fn bad_input_is_refused_with_a_message() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]];
    let nan = MeshView { positions: &positions, triangles: &[[0, 1, 2]] };
    let out_of_range = MeshView { positions: &positions[..2], triangles: &[[0, 1, 2]] };
    let empty = MeshView { positions: &positions, triangles: &[] };
    for (mesh, word) in [(nan, "vertex 2"), (out_of_range, "triangle 0"), (empty, "no triangles")] {
        for error in [
            cgal::closed_check(mesh).unwrap_err(),
            cgal::isotropic_remesh(mesh, 1.0, 1).unwrap_err(),
            cgal::self_intersections(mesh).unwrap_err(),
            cgal::distances_to_mesh(&[], mesh).unwrap_err(),
            cgal::boolean(mesh, mesh, BooleanOperation::Union).unwrap_err(),
            cgal::extrude(mesh, [0.0, 0.0, 1.0]).unwrap_err(),
            cgal::alpha_wrap(mesh, 1.0, 1.0).unwrap_err(),
        ] {
            assert!(error.to_string().contains(word), "{error}");
        }
    }
    assert!(cgal::constrained_delaunay(&[[0.0, f64::INFINITY]], &[]).is_err());
    assert!(cgal::constrained_delaunay(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], &[[0, 2]]).is_err());
    assert!(cgal::constrained_delaunay(&[[0.0, 0.0]], &[[0, 1]]).is_err());
    assert!(cgal::constrained_delaunay(&[], &[]).is_err());
    assert!(cgal::convex_hull(&[]).is_err());
}

#[test]
fn a_mesh_that_is_no_manifold_is_an_error() {
    let mut mesh = cube_at(0.0);
    mesh.triangles.push(mesh.triangles[0]);
    let error = cgal::isotropic_remesh(mesh.view(), 1.0, 1).unwrap_err();
    assert!(error.to_string().contains("triangle 12"), "{error}");
}
