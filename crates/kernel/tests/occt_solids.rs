//! B-spline faces and solids against closed forms.
#![allow(clippy::unwrap_used)] // what helps a test may stop at the first surprise, as tests do

mod common;

use common::{assert_close, graph_surface, polygon, wavy};
use softfold_kernel::occt::{self, BsplineSurface, Counts, Shape, ShapeKind, TrimCurve};
use softfold_kernel::{BooleanOperation, KernelError, cgal};

const OUTLINE: [[f64; 2]; 5] = [[20.0, 30.0], [300.0, 40.0], [350.0, 200.0], [180.0, 340.0], [30.0, 250.0]];
const HOLE: [[f64; 2]; 4] = [[100.0, 100.0], [100.0, 180.0], [190.0, 170.0], [180.0, 90.0]];

fn sheet() -> BsplineSurface {
    graph_surface(22, 20.0, wavy)
}

fn lifted(by: f64) -> BsplineSurface {
    graph_surface(22, 20.0, |x, y| wavy(x, y) + by)
}

fn polygon_area(points: &[[f64; 2]]) -> f64 {
    let next = |i: usize| points[(i + 1) % points.len()];
    points.iter().enumerate().map(|(i, p)| 0.5 * (p[0] * next(i)[1] - p[1] * next(i)[0])).sum()
}

fn assert_valid(shape: &Shape) {
    assert_eq!(occt::check(shape).unwrap(), Vec::<String>::new());
}

fn volume(shape: &Shape) -> f64 {
    occt::mass_properties(shape, 1e-6).unwrap().volume_mm3
}

/// de Boor's basis on uniform knots: what the surface must be.
fn by_hand(surface: &BsplineSurface, step: f64, [u, v]: [f64; 2]) -> [f64; 3] {
    let split = |x: f64| {
        let cell = (x / step).floor().min(surface.pole_count[0] as f64 - 4.0);
        let (t, s) = (x / step - cell, 1.0 - (x / step - cell));
        let b1 = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
        let b2 = (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0;
        (cell as usize, [s * s * s / 6.0, b1, b2, t * t * t / 6.0])
    };
    let ((i, a), (j, b)) = (split(u), split(v));
    let mut point = [0.0; 3];
    for k in 0..16 {
        let pole = surface.poles[(i + k / 4) * surface.pole_count[1] + j + k % 4];
        (0..3).for_each(|c| point[c] += a[k / 4] * b[k % 4] * pole[c]);
    }
    point
}

/// Share by which integrated volumes may be off: a hundredth of the accuracy that the kernel asks for.
const INTEGRATED: f64 = 1e-8;

#[test]
fn clamping_a_uniform_surface_does_not_change_it() {
    let surface = sheet();
    assert_eq!(surface.domain().unwrap(), [[0.0, 380.0]; 2]);
    let uv: Vec<[f64; 2]> = (0..400).map(|k| [(k % 20) as f64 * 19.4, (k / 20) as f64 * 19.4]).collect();
    let found = occt::surface_at(&surface, &uv).unwrap();
    for (point, &place) in found.iter().zip(&uv) {
        let wanted = by_hand(&surface, 20.0, place);
        (0..3).for_each(|c| assert!((point[c] - wanted[c]).abs() < 1e-11, "{place:?}: {point:?} {wanted:?}"));
    }
}

#[test]
fn a_flat_face_has_its_outlines_area() {
    let flat = graph_surface(12, 40.0, |_, _| 7.0);
    let face = occt::trimmed_face(&flat, &[polygon(&OUTLINE), polygon(&HOLE)]).unwrap();
    assert_eq!(face.kind(), ShapeKind::Face);
    assert!(occt::mass_properties(&face, 1e-6).is_err(), "a face has no volume");
    assert_close(occt::area(&face).unwrap(), polygon_area(&OUTLINE) + polygon_area(&HOLE), 1e-9);
}

#[test]
fn a_wavy_prism_has_the_volume_of_its_projection() {
    for (loops, area) in [
        (vec![polygon(&OUTLINE)], polygon_area(&OUTLINE)),
        (vec![polygon(&OUTLINE), polygon(&HOLE)], polygon_area(&OUTLINE) + polygon_area(&HOLE)),
    ] {
        let face = occt::trimmed_face(&sheet(), &loops).unwrap();
        assert_valid(&face);
        let solid = occt::prism(&face, [0.0, 0.0, -50.0]).unwrap();
        assert_valid(&solid);
        assert_eq!(solid.kind(), ShapeKind::Solid);
        assert_close(volume(&solid), 50.0 * area, INTEGRATED);
    }
}

#[test]
fn a_board_has_the_volume_between_its_surfaces() {
    let loops = [polygon(&OUTLINE), polygon(&HOLE)];
    for (lower, upper) in [(sheet(), lifted(12.0)), (lifted(12.0), sheet())] {
        let board = occt::board_solid(&lower, &upper, &loops).unwrap();
        assert_valid(&board);
        assert_eq!(occt::counts(&board).unwrap(), Counts { solids: 1, shells: 1, faces: 11, edges: 27 });
        assert_close(volume(&board), 12.0 * (polygon_area(&OUTLINE) + polygon_area(&HOLE)), INTEGRATED);
    }
}

#[test]
fn a_board_meshes_to_a_closed_mesh_of_its_volume() {
    let board = occt::board_solid(&sheet(), &lifted(12.0), &[polygon(&OUTLINE), polygon(&HOLE)]).unwrap();
    let mesh = occt::triangulate(&board, 0.05, 0.3).unwrap();
    let check = cgal::closed_check(mesh.view()).unwrap();
    assert!(check.closed && check.manifold && check.outward, "{check:?}");
    assert_close(check.volume_mm3, volume(&board), 1e-3);
    assert_eq!(mesh, occt::triangulate(&board, 0.05, 0.3).unwrap());
}

#[test]
fn bezier_loops_may_be_one_closed_curve() {
    let flat = graph_surface(12, 40.0, |_, _| 0.0);
    let drop =
        TrimCurve::Bezier { poles: vec![[100.0, 100.0], [300.0, 100.0], [100.0, 300.0], [100.0, 100.0]] };
    let face = occt::trimmed_face(&flat, &[vec![drop]]).unwrap();
    assert_valid(&face);
    // ½∮(u dv − v du) of the cubic with p0 = p3, e1 = (200, 0), e2 = (0, 200): 3/20 e1×e2
    assert_close(occt::area(&face).unwrap(), 0.15 * 40_000.0, 1e-8);
    let solid = occt::prism(&face, [0.0, 0.0, 10.0]).unwrap();
    assert_close(volume(&solid), 60_000.0, 1e-8);
}

#[test]
fn a_board_with_curved_sides_is_valid_and_closed() {
    let curved = vec![
        TrimCurve::Bezier { poles: vec![[40.0, 40.0], [150.0, 10.0], [250.0, 90.0], [330.0, 40.0]] },
        TrimCurve::Line { from: [330.0, 40.0], to: [330.0, 300.0] },
        TrimCurve::Bezier { poles: vec![[330.0, 300.0], [200.0, 360.0], [40.0, 300.0]] },
        TrimCurve::Line { from: [40.0, 300.0], to: [40.0, 40.0] },
    ];
    let board = occt::board_solid(&sheet(), &lifted(8.0), std::slice::from_ref(&curved)).unwrap();
    assert_valid(&board);
    let face = occt::trimmed_face(&sheet(), &[curved]).unwrap();
    let prism = occt::prism(&face, [0.0, 0.0, 8.0]).unwrap();
    assert_close(volume(&board), volume(&prism), 1e-8);
}

#[test]
fn an_inner_cell_of_a_mold_has_its_exact_volume() {
    let outline = [[5.0, 5.0], [365.0, 5.0], [365.0, 365.0], [5.0, 365.0]];
    let face = occt::trimmed_face(&sheet(), &[polygon(&outline)]).unwrap();
    let mold = occt::prism(&face, [0.0, 0.0, -50.0]).unwrap();
    let (low, high) = (70.0, 70.0 + 221.0);
    let cell = [[low, low], [high, low], [high, high], [low, high]];
    let cutter = occt::extruded_polygon(&cell, -100.0, 100.0).unwrap();
    let part = occt::boolean(&mold, &cutter, BooleanOperation::Intersection).unwrap();
    assert_valid(&part);
    assert_eq!(part.kind(), ShapeKind::Solid);
    assert_close(volume(&part), 221.0 * 221.0 * 50.0, 1e-8);
}

#[test]
fn booleans_of_boxes_have_the_volumes_of_boxes() {
    let square = |x: f64| [[x, 0.0], [x + 10.0, 0.0], [x + 10.0, 10.0], [x, 10.0]];
    let a = occt::extruded_polygon(&square(0.0), 0.0, 10.0).unwrap();
    let b = occt::extruded_polygon(&square(4.0), 5.0, 15.0).unwrap();
    for (operation, wanted) in [
        (BooleanOperation::Union, 1700.0),
        (BooleanOperation::Intersection, 300.0),
        (BooleanOperation::Difference, 700.0),
    ] {
        let shape = occt::boolean(&a, &b, operation).unwrap();
        assert_eq!(shape.kind(), ShapeKind::Solid);
        assert_close(volume(&shape), wanted, 1e-12);
    }
    let far = occt::extruded_polygon(&square(50.0), 0.0, 1.0).unwrap();
    let nothing = occt::boolean(&a, &far, BooleanOperation::Intersection).unwrap();
    assert_eq!(occt::counts(&nothing).unwrap(), Counts::default());
    let both = occt::boolean(&a, &far, BooleanOperation::Union).unwrap();
    assert_eq!(occt::counts(&both).unwrap().solids, 2);
}

#[test]
fn a_box_has_a_boxs_measures() {
    let shape = occt::extruded_polygon(&[[0.0, 0.0], [0.0, 4.0], [6.0, 4.0], [6.0, 0.0]], 1.0, 3.0).unwrap();
    assert_valid(&shape);
    assert_eq!(occt::counts(&shape).unwrap(), Counts { solids: 1, shells: 1, faces: 6, edges: 12 });
    let mass = occt::mass_properties(&shape, 1e-6).unwrap();
    assert_close(mass.volume_mm3, 48.0, 1e-12);
    assert_close(occt::area(&shape).unwrap(), 2.0 * (24.0 + 12.0 + 8.0), 1e-9);
    for (found, wanted) in mass.center.iter().zip([3.0, 2.0, 2.0]) {
        assert_close(*found, wanted, 1e-12);
    }
}

#[test]
fn turning_a_shape_turns_its_center() {
    let shape = occt::extruded_polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], 0.0, 2.0).unwrap();
    let quarter = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let turned = occt::transformed(&shape, quarter, [10.0, 20.0, 30.0]).unwrap();
    let center = occt::mass_properties(&turned, 1e-6).unwrap().center;
    for (found, wanted) in center.iter().zip([9.0, 21.0, 31.0]) {
        assert_close(*found, wanted, 1e-12);
    }
    for bad in [
        [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]],
        [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    ] {
        assert!(occt::transformed(&shape, bad, [0.0; 3]).is_err());
    }
}

#[test]
fn copies_go_to_threads() {
    let solid =
        occt::prism(&occt::trimmed_face(&sheet(), &[polygon(&OUTLINE)]).unwrap(), [0.0, 0.0, 5.0]).unwrap();
    let wanted = volume(&solid);
    let threads: Vec<_> = (0..4)
        .map(|_| {
            let copy = solid.try_clone().unwrap();
            std::thread::spawn(move || (volume(&copy), occt::triangulate(&copy, 0.5, 0.5).unwrap()))
        })
        .collect();
    let meshes: Vec<_> = threads.into_iter().map(|t| t.join().unwrap()).collect();
    assert!(meshes.iter().all(|(v, mesh)| *v == wanted && *mesh == meshes[0].1));
}

#[test]
fn bad_surfaces_are_refused() {
    let spoil = |change: fn(&mut BsplineSurface)| {
        let mut surface = sheet();
        change(&mut surface);
        let loops = [polygon(&OUTLINE)];
        occt::trimmed_face(&surface, &loops).unwrap_err().to_string()
    };
    assert!(spoil(|s| s.multiplicities_u[0] = 9).contains("multiplicity 9 of knot 0 along u"));
    assert!(spoil(|s| s.multiplicities_v[3] = 2).contains("add up to 27"));
    assert!(spoil(|s| s.knots_u.swap(3, 4)).contains("do not ascend"));
    assert!(spoil(|s| s.poles[7][2] = f64::NAN).contains("pole 7"));
    assert!(spoil(|s| s.pole_count = [4, 4]).contains("484 poles"));
    assert!(spoil(|s| *s = BsplineSurface::default()).contains("0 poles"));
}

#[test]
fn bad_loops_are_refused() {
    let refuse = |loops: &[Vec<TrimCurve>]| occt::trimmed_face(&sheet(), loops).unwrap_err();
    let mut reversed = OUTLINE;
    reversed.reverse();
    let mut open = polygon(&OUTLINE);
    open.pop();
    let bow_tie = [[50.0, 50.0], [300.0, 60.0], [300.0, 300.0], [40.0, 310.0], [200.0, 20.0]];
    let crossing = [[150.0, 100.0], [150.0, 500.0], [190.0, 170.0]];
    assert!(refuse(&[]).to_string().contains("no trim loop"));
    assert!(refuse(&[polygon(&reversed)]).to_string().contains("counter-clockwise"));
    assert!(refuse(&[polygon(&OUTLINE), polygon(&OUTLINE)]).to_string().contains("clockwise, being a hole"));
    assert!(refuse(&[open]).to_string().contains("begins at"));
    assert!(refuse(&[polygon(&OUTLINE), polygon(&crossing)]).to_string().contains("outside of the domain"));
    assert!(
        refuse(&[polygon(&[[50.0, 50.0], [50.0, 50.0], [60.0, 60.0]])]).to_string().contains("no length")
    );
    let crossed = refuse(&[polygon(&bow_tie)]);
    assert!(
        matches!(crossed, KernelError::Failed { .. }) && crossed.to_string().contains("elf"),
        "{crossed}"
    );
    let hole_over_the_edge = [[250.0, 150.0], [250.0, 180.0], [365.0, 170.0]];
    let crossed = refuse(&[polygon(&OUTLINE), polygon(&hole_over_the_edge)]);
    assert!(matches!(crossed, KernelError::Failed { .. }), "{crossed}");
}

#[test]
fn failures_of_opencascade_are_errors() {
    let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
    let solid = occt::extruded_polygon(&square, 0.0, 1.0).unwrap();
    assert!(occt::prism(&solid, [0.0, 0.0, 1.0]).is_err());
    assert!(occt::extruded_polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], 0.0, 1.0).is_err());
    assert!(occt::extruded_polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], 0.0, 1.0).is_err());
    assert!(occt::extruded_polygon(&[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0]], 0.0, 1.0).is_err());
    assert!(occt::extruded_polygon(&square, 1.0, 1.0).is_err());
    assert!(occt::triangulate(&solid, f64::NAN, 0.5).is_err());
    let meeting = occt::board_solid(&sheet(), &sheet(), &[polygon(&OUTLINE)]).unwrap_err();
    assert!(meeting.to_string().contains("surfaces meet"), "{meeting}");
    assert!(occt::surface_at(&sheet(), &[[-1.0, 0.0]]).is_err());
}

#[test]
fn a_flat_face_swept_within_its_plane_is_an_error() {
    let face = occt::trimmed_face(&graph_surface(12, 40.0, |_, _| 0.0), &[polygon(&OUTLINE)]).unwrap();
    assert!(occt::prism(&face, [10.0, 0.0, 0.0]).is_err());
}

#[test]
fn the_version_is_told() {
    assert!(occt::version().starts_with("7."), "{}", occt::version());
}

#[test]
fn a_board_whose_surfaces_cross_is_an_error() {
    let flat = graph_surface(22, 20.0, |_, _| 0.0);
    let tilted = graph_surface(22, 20.0, |x, _| x - 200.0);
    let dented = graph_surface(22, 20.0, |x, y| {
        10.0 - 40.0 * (-((x - 180.0).powi(2) + (y - 150.0).powi(2)) / 4e3).exp()
    });
    for crossing in [tilted, dented] {
        let error = occt::board_solid(&flat, &crossing, &[polygon(&OUTLINE)]).unwrap_err();
        assert!(error.to_string().contains("surfaces meet near"), "{error}");
    }
}

/// Knots this close are one to OpenCascade: it throws its own exception, which is no `std::exception`.
#[test]
fn an_exception_of_opencascade_is_an_error() {
    let mut surface = sheet();
    surface.knots_u.iter_mut().chain(&mut surface.knots_v).for_each(|knot| *knot *= 1e-17);
    let error = occt::surface_at(&surface, &[[2e-16, 2e-16]]).unwrap_err();
    assert!(error.to_string().contains("Standard_"), "{error}");
}
