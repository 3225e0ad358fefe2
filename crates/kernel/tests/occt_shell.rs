//! Faces that share edges by their numbers.

#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

use softfold_kernel::occt::{self, BsplineSurface, ShellEdge, ShellFace, ShellUse};

/// A plane over 0..1 in both parameters, `step` mm a side, from `x0` on.
fn plane(x0: f64, step: f64) -> BsplineSurface {
    let pole = |k: usize| [x0 + step * ((k / 4) as f64 - 1.0), step * ((k % 4) as f64 - 1.0), 0.0];
    let knots: Vec<f64> = (0..8).map(|k| f64::from(k) - 3.0).collect();
    BsplineSurface {
        poles: (0..16).map(pole).collect(),
        pole_count: [4, 4],
        knots_u: knots.clone(),
        knots_v: knots,
        multiplicities_u: vec![1; 8],
        multiplicities_v: vec![1; 8],
    }
}

fn edge(vertices: [usize; 2], uses: &[(usize, [f64; 2], [f64; 2])]) -> ShellEdge {
    let one = |&(face, start, direction): &(usize, [f64; 2], [f64; 2])| ShellUse { face, start, direction };
    ShellEdge { vertices, length: 1.0, uses: uses.iter().map(one).collect() }
}

/// Two squares of 10 mm side by side; the edge between them runs down in the first and is the second's left side.
fn two() -> (Vec<[f64; 3]>, Vec<ShellEdge>, Vec<ShellFace>) {
    let at = |x: f64, y: f64| [x, y, 0.0];
    let vertices = vec![at(0., 0.), at(10., 0.), at(20., 0.), at(20., 10.), at(10., 10.), at(0., 10.)];
    let edges = vec![
        edge([0, 1], &[(0, [0., 0.], [1., 0.])]),
        edge([4, 1], &[(0, [1., 1.], [0., -1.]), (1, [0., 1.], [0., -1.])]),
        edge([4, 5], &[(0, [1., 1.], [-1., 0.])]),
        edge([5, 0], &[(0, [0., 1.], [0., -1.])]),
        edge([1, 2], &[(1, [0., 0.], [1., 0.])]),
        edge([2, 3], &[(1, [1., 0.], [0., 1.])]),
        edge([3, 4], &[(1, [1., 1.], [-1., 0.])]),
    ];
    let faces = vec![
        ShellFace { surface: plane(0.0, 10.0), border: vec![(0, true), (1, false), (2, true), (3, true)] },
        ShellFace { surface: plane(10.0, 10.0), border: vec![(4, true), (5, true), (6, true), (1, true)] },
    ];
    (vertices, edges, faces)
}

#[test]
fn two_squares_are_one_valid_shell_that_shares_an_edge() {
    let (vertices, edges, faces) = two();
    let (shell, gap_mm) = occt::shell(&vertices, &edges, &faces).unwrap();
    assert!(occt::check(&shell).unwrap().is_empty());
    assert!(gap_mm < 1e-12, "{gap_mm}");
    assert!((occt::area(&shell).unwrap() - 200.0).abs() < 1e-9);
    assert_eq!(occt::counts(&shell).unwrap().faces, 2);
}

#[test]
fn how_far_faces_are_apart_is_told() {
    let (vertices, edges, mut faces) = two();
    faces[1].surface.poles.iter_mut().for_each(|p| p[2] += 1e-4);
    let (_, gap_mm) = occt::shell(&vertices, &edges, &faces).unwrap();
    assert!((gap_mm - 1e-4).abs() < 1e-9, "{gap_mm}");
}

#[test]
fn numbers_without_a_place_are_refused() {
    let (vertices, mut edges, faces) = two();
    edges[1].uses[1].face = 7;
    assert!(occt::shell(&vertices, &edges, &faces).unwrap_err().to_string().contains("edge 1"));
    let (vertices, edges, mut faces) = two();
    faces[0].border[2].0 = 99;
    assert!(occt::shell(&vertices, &edges, &faces).unwrap_err().to_string().contains("face 0"));
}
