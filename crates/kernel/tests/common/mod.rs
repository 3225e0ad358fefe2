//! Shapes that several tests use.
#![allow(dead_code)] // no test file uses all of them

use softfold_kernel::MeshBuffers;
use softfold_kernel::occt::{BsplineSurface, TrimCurve};

/// A closed, outward oriented box.
pub(crate) fn box_mesh(low: [f64; 3], high: [f64; 3]) -> MeshBuffers {
    let corner =
        |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    MeshBuffers { positions: (0..8).map(corner).collect(), triangles }
}

/// A flat grid of `n` × `n` squares of side `step` at height `z`, normals up.
pub(crate) fn grid_mesh(n: usize, step: f64, height: impl Fn(f64, f64) -> f64) -> MeshBuffers {
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let mut mesh = MeshBuffers::default();
    for i in 0..=n {
        for j in 0..=n {
            let (x, y) = (i as f64 * step, j as f64 * step);
            mesh.positions.push([x, y, height(x, y)]);
        }
    }
    for i in 0..n {
        for j in 0..n {
            mesh.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    mesh
}

/// Uniform, unclamped knots: poles at the knots' places, so that x = u and y = v on the whole domain.
pub(crate) fn graph_surface(count: usize, step: f64, height: impl Fn(f64, f64) -> f64) -> BsplineSurface {
    let place = |i: usize| (i as f64 - 1.0) * step;
    let poles = (0..count * count)
        .map(|k| [place(k / count), place(k % count)])
        .map(|[x, y]| [x, y, height(x, y)])
        .collect();
    let knots: Vec<f64> = (0..count + 4).map(|i| (i as f64 - 3.0) * step).collect();
    BsplineSurface {
        poles,
        pole_count: [count, count],
        knots_u: knots.clone(),
        knots_v: knots,
        multiplicities_u: vec![1; count + 4],
        multiplicities_v: vec![1; count + 4],
    }
}

/// Hills and valleys of 5 mm.
pub(crate) fn wavy(x: f64, y: f64) -> f64 {
    5.0 * (0.04 * x).sin() * (0.05 * y).cos()
}

/// A closed loop of lines through points.
pub(crate) fn polygon(points: &[[f64; 2]]) -> Vec<TrimCurve> {
    let next = |i: usize| points[(i + 1) % points.len()];
    points.iter().enumerate().map(|(i, &from)| TrimCurve::Line { from, to: next(i) }).collect()
}

/// Asserts that two numbers differ by at most `tolerance` of the second.
#[track_caller]
pub(crate) fn assert_close(found: f64, wanted: f64, tolerance: f64) {
    let off = (found - wanted).abs() / wanted.abs().max(f64::MIN_POSITIVE);
    assert!(off <= tolerance, "{found} is off from {wanted} by {off:e}, more than {tolerance:e}");
}
