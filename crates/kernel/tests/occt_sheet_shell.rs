//! Shells whose faces share edges and corners.

#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

use softfold_kernel::occt::{self, BsplineSurface, ShellTopology, TrimCurve};

/// A plane over −3 ≤ u ≤ 3, 0 ≤ v ≤ 1 as a uniform bicubic, by what it does to (u, v).
fn plane(place: impl Fn(f64, f64) -> [f64; 3]) -> BsplineSurface {
    let knots: Vec<f64> = (0..14).map(|k| f64::from(k) - 7.0).collect();
    let poles = (0..10).flat_map(|i| (0..10).map(move |j| (f64::from(i) - 5.0, f64::from(j) - 5.0)));
    BsplineSurface {
        poles: poles.map(|(u, v)| place(u, v)).collect(),
        pole_count: [10, 10],
        multiplicities_u: vec![1; 14],
        multiplicities_v: vec![1; 14],
        knots_u: knots.clone(),
        knots_v: knots,
    }
}

/// Two unit squares left and right of u = 0.
fn squares() -> ShellTopology {
    let line = |from: [f64; 2], to: [f64; 2]| TrimCurve::Line { from, to };
    ShellTopology {
        edges: vec![
            (line([0.0, 0.0], [0.0, 1.0]), [0, 1]),
            (line([0.0, 1.0], [-1.0, 1.0]), [1, 2]),
            (line([-1.0, 1.0], [-1.0, 0.0]), [2, 3]),
            (line([-1.0, 0.0], [0.0, 0.0]), [3, 0]),
            (line([0.0, 0.0], [1.0, 0.0]), [0, 4]),
            (line([1.0, 0.0], [1.0, 1.0]), [4, 5]),
            (line([1.0, 1.0], [0.0, 1.0]), [5, 1]),
        ],
        corners: 6,
        faces: vec![
            vec![vec![(0, false), (1, false), (2, false), (3, false)]],
            vec![vec![(4, false), (5, false), (6, false), (0, true)]],
        ],
    }
}

fn folded() -> [BsplineSurface; 2] {
    [plane(|u, v| [u, v, 0.0]), plane(|u, v| [0.0, v, u])]
}

#[test]
fn faces_share_the_edge_between_them() {
    let shell = occt::sheet_shell(&folded(), &squares()).unwrap();
    let counts = occt::counts(&shell).unwrap();
    assert_eq!((counts.shells, counts.faces, counts.edges), (1, 2, 7));
    assert!((occt::area(&shell).unwrap() - 2.0).abs() < 1e-9);
    assert!(occt::check(&shell).unwrap().is_empty());
    assert!(occt::largest_tolerance_mm(&shell).unwrap() <= 4.2e-7);
    let mesh = occt::triangulate(&shell, 0.01, 0.5).unwrap();
    assert_eq!(mesh.positions.len(), 6, "vertices of the shared edge are there once");
}

#[test]
fn faces_that_part_have_a_tolerance_that_says_so() {
    let mut surfaces = folded();
    surfaces[1].poles.iter_mut().for_each(|p| p[0] += 1e-4);
    let tolerance = occt::largest_tolerance_mm(&occt::sheet_shell(&surfaces, &squares()).unwrap()).unwrap();
    assert!((1e-4..1.2e-4).contains(&tolerance), "{tolerance}");
}

#[test]
fn topology_that_does_not_fit_is_refused() {
    let refused = |change: fn(&mut ShellTopology)| {
        let mut topology = squares();
        change(&mut topology);
        occt::sheet_shell(&folded(), &topology).unwrap_err().to_string()
    };
    assert!(refused(|t| t.faces.truncate(1)).contains("2 surfaces for 1 faces"));
    assert!(refused(|t| t.corners = 5).contains("names a corner"));
    assert!(refused(|t| t.faces[0][0][1].0 = 9).contains("do not join"));
    assert!(refused(|t| t.faces[0][0].swap(1, 2)).contains("do not join"));
    assert!(refused(|t| t.faces[1][0].clear()).contains("empty loop"));
    assert!(
        refused(|t| t.edges[5].0 = TrimCurve::Line { from: [9.0, 0.0], to: [9.0, 1.0] }).contains("domain")
    );
}
