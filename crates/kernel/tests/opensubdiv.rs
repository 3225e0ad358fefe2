//! OpenSubdiv's limit against the bicubic B-spline it must be.
#![allow(clippy::unwrap_used)] // what helps a test may stop at the first surprise, as tests do

mod common;

use softfold_kernel::opensubdiv::{self, BsplinePatches, Cage, Sample, Stencils};

/// A lattice of `n` × `n` quads; vertex (i, j) is i (n + 1) + j, s runs with i.
fn lattice(n: u32) -> Cage {
    let at = |i, j| i * (n + 1) + j;
    let quad = |k: u32| {
        let (i, j) = (k / n, k % n);
        [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    };
    Cage { vertex_count: ((n + 1) * (n + 1)) as usize, quads: (0..n * n).map(quad).collect() }
}

/// Three quads around one vertex: the simplest extraordinary one.
fn three_quads() -> Cage {
    Cage { vertex_count: 7, quads: vec![[0, 1, 2, 3], [0, 3, 4, 5], [0, 5, 6, 1]] }
}

fn basis(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
        (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
        t * t * t / 6.0,
    ]
}

fn slope(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-s * s / 2.0, (3.0 * t * t - 4.0 * t) / 2.0, (4.0 * s - 3.0 * s * s) / 2.0, t * t / 2.0]
}

fn samples_of(quads: impl Iterator<Item = u32>) -> Vec<Sample> {
    let places = [[0.0, 0.0], [0.3, 0.7], [1.0, 0.5], [0.9, 0.1]];
    quads.flat_map(|quad| places.map(|[s, t]| Sample { quad, s, t })).collect()
}

fn row<'a>(stencils: &'a Stencils, i: usize, weights: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
    let range = stencils.offsets[i] as usize..stencils.offsets[i + 1] as usize;
    range.map(|k| (stencils.indices[k], weights[k]))
}

fn dense(row: impl Iterator<Item = (u32, f64)>, count: usize) -> Vec<f64> {
    let mut weights = vec![0.0; count];
    row.for_each(|(i, w)| weights[i as usize] += w);
    weights
}

fn assert_same(found: &[f64], wanted: &[f64]) {
    for (k, (a, b)) in found.iter().zip(wanted).enumerate() {
        assert!((a - b).abs() < 1e-12, "vertex {k}: {a} is not {b}");
    }
}

#[test]
fn inside_a_lattice_the_limit_is_the_bicubic_b_spline() {
    let n = 6;
    let cage = lattice(n);
    let inner = (0..n * n).filter(|k| (1..n - 1).contains(&(k / n)) && (1..n - 1).contains(&(k % n)));
    let mut samples = samples_of(inner);
    samples.reverse(); // rows must come in this order all the same
    let stencils = opensubdiv::limit_stencils(&cage, &samples).unwrap();
    assert_eq!(stencils.offsets.len(), samples.len() + 1);
    for (r, sample) in samples.iter().enumerate() {
        let (i0, j0) = (sample.quad / n - 1, sample.quad % n - 1);
        let tensor = |s: [f64; 4], t: [f64; 4]| {
            let all =
                (0..16).map(|k| ((i0 + k / 4) * (n + 1) + j0 + k % 4, s[k as usize / 4] * t[k as usize % 4]));
            dense(all, cage.vertex_count)
        };
        let found = |weights| dense(row(&stencils, r, weights), cage.vertex_count);
        assert_same(&found(&stencils.weights), &tensor(basis(sample.s), basis(sample.t)));
        assert_same(&found(&stencils.weights_s), &tensor(slope(sample.s), basis(sample.t)));
        assert_same(&found(&stencils.weights_t), &tensor(basis(sample.s), slope(sample.t)));
    }
}

#[test]
fn stencils_reproduce_linear_functions_up_to_the_border() {
    let n = 5;
    let cage = lattice(n);
    let samples = samples_of(0..n * n);
    let stencils = opensubdiv::limit_stencils(&cage, &samples).unwrap();
    let value = |v: u32| 3.0 + 2.0 * f64::from(v / (n + 1)) - 5.0 * f64::from(v % (n + 1));
    let apply = |r, weights| row(&stencils, r, weights).map(|(v, w)| w * value(v)).sum::<f64>();
    for (r, sample) in samples.iter().enumerate() {
        let (i, j) = (f64::from(sample.quad / n) + sample.s, f64::from(sample.quad % n) + sample.t);
        assert!((apply(r, &stencils.weights) - (3.0 + 2.0 * i - 5.0 * j)).abs() < 1e-12);
        assert!((apply(r, &stencils.weights_s) - 2.0).abs() < 1e-12);
        assert!((apply(r, &stencils.weights_t) + 5.0).abs() < 1e-12);
    }
}

#[test]
fn the_limit_at_an_extraordinary_vertex_is_catmull_and_clarks() {
    let mut cage = three_quads();
    // Close the border far enough away that it does not matter: the formula needs the one-ring only.
    cage.quads.rotate_left(1);
    let cage = ring_around(&cage);
    let stencils = opensubdiv::limit_stencils(&cage, &[Sample { quad: 0, s: 0.0, t: 0.0 }]).unwrap();
    let found = dense(row(&stencils, 0, &stencils.weights), cage.vertex_count);
    // valence n: n²/(n (n + 5)) for the vertex, 4/(n (n + 5)) per edge, 1/(n (n + 5)) per face
    let wanted = [9.0, 4.0, 1.0, 4.0, 1.0, 4.0, 1.0].map(|w| w / 24.0);
    assert_same(&found[..7], &wanted);
}

/// The cage of three quads with a further ring outside: 0 stays the one extraordinary vertex of its inside.
fn ring_around(inner: &Cage) -> Cage {
    let rim = [1, 2, 3, 4, 5, 6];
    let outer = |k: usize| 7 + (k % 6) as u32;
    let quad = |k: usize| [rim[(k + 1) % 6], rim[k], outer(k), outer(k + 1)];
    Cage { vertex_count: 13, quads: inner.quads.iter().copied().chain((0..6).map(quad)).collect() }
}

fn point_row(patches: &BsplinePatches, point: u32, vertex_count: usize) -> Vec<f64> {
    let local = &patches.local_points;
    match (point as usize).checked_sub(vertex_count) {
        None => dense(std::iter::once((point, 1.0)), vertex_count),
        Some(i) => {
            let range = local.offsets[i] as usize..local.offsets[i + 1] as usize;
            dense(range.map(|k| (local.indices[k], local.weights[k])), vertex_count)
        }
    }
}

#[test]
fn patches_of_a_lattice_are_the_sixteen_neighbours() {
    let n = 8;
    let cage = lattice(n);
    let patches = opensubdiv::bspline_patches(&cage).unwrap();
    assert_eq!(patches.control_points.len(), 64);
    for (points, &quad) in patches.control_points.iter().zip(&patches.quads) {
        let (i, j) = (quad / n, quad % n);
        if (1..n - 1).contains(&i) && (1..n - 1).contains(&j) {
            let wanted: [u32; 16] = std::array::from_fn(|k| {
                let (t, s) = (k as u32 / 4, k as u32 % 4);
                (i + s - 1) * (n + 1) + j + t - 1
            });
            assert_eq!(*points, wanted, "quad {quad}");
        }
    }
    assert!(patches.domains.iter().all(|d| *d == [0.0, 0.0, 1.0]));
}

#[test]
fn patches_agree_with_stencils_everywhere() {
    let cages = [(lattice(3), 1e-12), (ring_around(&three_quads()), 1e-2)];
    for (cage, tolerance_at_extraordinary) in cages {
        let patches = opensubdiv::bspline_patches(&cage).unwrap();
        let mut exact = 0;
        for (p, points) in patches.control_points.iter().enumerate() {
            let (s, t) = (0.4, 0.7);
            let [s0, t0, size] = patches.domains[p];
            let sample = Sample { quad: patches.quads[p], s: s0 + size * s, t: t0 + size * t };
            let stencils = opensubdiv::limit_stencils(&cage, &[sample]).unwrap();
            let wanted = dense(row(&stencils, 0, &stencils.weights), cage.vertex_count);
            let mut found = vec![0.0; cage.vertex_count];
            for (k, &point) in points.iter().enumerate() {
                let weight = basis(s)[k % 4] * basis(t)[k / 4];
                let row = point_row(&patches, point, cage.vertex_count);
                found.iter_mut().zip(row).for_each(|(f, r)| *f += weight * r);
            }
            let off = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < tolerance_at_extraordinary, "patch {p}: {off}");
            exact += usize::from(off < 1e-12);
        }
        assert!(2 * exact > patches.quads.len(), "{exact} of {}", patches.quads.len());
    }
}

#[test]
fn patches_cover_every_quad_once() {
    let cage = ring_around(&three_quads());
    let patches = opensubdiv::bspline_patches(&cage).unwrap();
    let mut covered = vec![0.0; cage.quads.len()];
    for (quad, domain) in patches.quads.iter().zip(&patches.domains) {
        covered[*quad as usize] += domain[2] * domain[2];
    }
    assert!(covered.iter().all(|area| *area == 1.0), "{covered:?}");
}

#[test]
fn bad_cages_and_samples_are_errors() {
    let cage = lattice(2);
    let bad_samples = [
        Sample { quad: 4, s: 0.5, t: 0.5 },
        Sample { quad: 0, s: 1.5, t: 0.5 },
        Sample { quad: 0, s: 0.5, t: f64::NAN },
    ];
    for sample in bad_samples {
        assert!(opensubdiv::limit_stencils(&cage, &[sample]).is_err(), "{sample:?}");
    }
    let bad_cages = [
        Cage::default(),
        Cage { vertex_count: 4, quads: vec![[0, 1, 2, 4]] },
        Cage { vertex_count: 4, quads: vec![[0, 1, 2, 2]] },
        Cage { vertex_count: 6, quads: vec![[0, 1, 2, 3], [0, 1, 4, 5]] },
        Cage { vertex_count: 8, quads: vec![[0, 1, 2, 3], [1, 0, 4, 5], [0, 1, 6, 7]] },
        Cage { vertex_count: 7, quads: vec![[0, 1, 2, 3], [0, 4, 5, 6]] },
    ];
    for bad in bad_cages {
        assert!(opensubdiv::bspline_patches(&bad).is_err(), "{bad:?}");
        assert!(opensubdiv::limit_stencils(&bad, &[]).is_err(), "{bad:?}");
    }
    assert_eq!(opensubdiv::limit_stencils(&cage, &[]).unwrap().offsets, [0]);
}
