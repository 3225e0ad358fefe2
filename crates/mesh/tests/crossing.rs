//! Constraints that cross, overlap and touch: one suite for both backends, and each against the other.

#![allow(clippy::unwrap_used, clippy::panic, reason = "what helps a test may stop at the first surprise")]

use glam::DVec2;
use proptest::prelude::*;
use softfold_geometry::{VertexId, polygon};
use softfold_mesh::{Arranged, Backend, MeshError, crosscheck_crossing, noded};
use std::collections::{BTreeMap, BTreeSet};

/// Coordinates as a strategy makes them.
type Pairs = Vec<(f64, f64)>;

/// Points and constraints between them.
#[derive(Clone, Debug)]
struct Lines {
    points: Vec<DVec2>,
    constraints: Vec<[VertexId; 2]>,
}

impl Lines {
    fn new(points: &[(f64, f64)], constraints: &[[u32; 2]]) -> Self {
        let points = points.iter().map(|&p| DVec2::from(p)).collect();
        Self { points, constraints: constraints.iter().map(|c| c.map(VertexId)).collect() }
    }

    fn by(&self, backend: Backend) -> Result<Arranged, MeshError> {
        backend.library().crossing(&self.points, &self.constraints)
    }
}

fn both(lines: &Lines, test: impl Fn(&Arranged)) {
    for backend in [Backend::Spade, Backend::Cgal] {
        let arranged = lines.by(backend).unwrap();
        sound(lines, &arranged);
        test(&arranged);
    }
    agree(lines);
}

fn agree(lines: &Lines) {
    let check = crosscheck_crossing(&lines.points, &lines.constraints).unwrap();
    assert!(check.agrees(), "{check:?}\n{lines:?}");
}

/// What holds for every triangulation of lines that cross.
fn sound(lines: &Lines, a: &Arranged) {
    let edges: BTreeSet<[VertexId; 2]> =
        a.triangles.iter().flat_map(|t| (0..3).map(|k| sorted(t[k], t[(k + 1) % 3]))).collect();
    for (constraint, chain) in lines.constraints.iter().zip(&a.chains) {
        let ends = constraint.map(|v| a.vertex_of_input[v.index()]);
        let [from, to] = constraint.map(|v| lines.points[v.index()]);
        if ends[0] != ends[1] {
            assert_eq!([chain[0], chain[chain.len() - 1]], ends);
        }
        for w in chain.windows(2) {
            assert!(edges.contains(&sorted(w[0], w[1])), "a piece is no edge: {w:?} in {lines:?}");
        }
        for v in chain {
            let off = polygon::segment_distance(a.points[v.index()], from, to);
            assert!(off <= a.tolerance_mm, "{off} off the constraint in {lines:?}");
        }
    }
    for (p, v) in lines.points.iter().zip(&a.vertex_of_input) {
        assert!(p.distance(a.points[v.index()]) <= a.tolerance_mm);
    }
    let (lo, hi) = polygon::bounds(&lines.points);
    let perimeter = 2.0 * (hi - lo).element_sum();
    let hull =
        softfold_kernel::cgal::convex_hull(&lines.points.iter().map(|p| p.to_array()).collect::<Vec<_>>())
            .unwrap();
    let hull: Vec<DVec2> = hull.iter().map(|&i| lines.points[i as usize]).collect();
    let mut area = 0.0;
    for t in &a.triangles {
        let [p, q, r] = t.map(|v| a.points[v.index()]);
        let twice = (q - p).perp_dot(r - p);
        let longest = p.distance(q).max(q.distance(r)).max(r.distance(p));
        assert!(twice >= -longest * a.tolerance_mm, "a triangle is turned over in {lines:?}");
        area += 0.5 * twice;
    }
    let wanted = polygon::signed_area_mm2(&hull);
    assert!((area - wanted).abs() <= perimeter * a.tolerance_mm, "{area} for {wanted}");
}

fn sorted(a: VertexId, b: VertexId) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

fn pieces(a: &Arranged) -> usize {
    let all = a.chains.iter().flat_map(|c| c.windows(2).map(|w| sorted(w[0], w[1])));
    all.collect::<BTreeSet<_>>().len()
}

#[test]
fn two_diagonals_of_a_square_meet_in_its_middle() {
    let lines = Lines::new(&[(0., 0.), (3., 0.), (3., 3.), (0., 3.)], &[[0, 2], [1, 3]]);
    both(&lines, |a| {
        assert_eq!((a.points.len(), a.triangles.len(), pieces(a)), (5, 4, 4));
        assert_eq!(a.points[4], DVec2::splat(1.5));
        assert_eq!(a.chains, [[0, 4, 2], [1, 4, 3]].map(|c| c.map(VertexId).to_vec()));
    });
}

/// Three lines through (1/3, 1/3), which `f64` does not have: exactly one point, on the grid one or close ones.
#[test]
fn three_lines_through_a_point_without_a_number_meet_nearby() {
    let lines = Lines::new(
        &[(0., 0.), (1., 1.), (0., 1.), (0.5, 0.), (1., 0.), (0., 0.5)],
        &[[0, 1], [2, 3], [4, 5]],
    );
    let exact = lines.by(Backend::Cgal).unwrap();
    assert_eq!((exact.points.len(), pieces(&exact)), (7, 6));
    both(&lines, |a| {
        for p in &a.points[6..] {
            assert!(p.distance(DVec2::splat(1.0 / 3.0)) < 4.0 * a.tolerance_mm.max(1e-15));
        }
    });
}

#[test]
fn constraints_that_overlap_share_their_pieces() {
    let lines =
        Lines::new(&[(0., 0.), (4., 0.), (1., 0.), (6., 0.), (2., 3.)], &[[0, 1], [2, 3], [3, 0], [1, 1]]);
    both(&lines, |a| {
        assert_eq!((a.points.len(), pieces(a)), (5, 3));
        assert_eq!(a.chains[2], [3, 1, 2, 0].map(VertexId));
        assert!(a.chains[3].windows(2).all(|w| w[0] == w[1]));
    });
}

#[test]
fn a_constraint_goes_through_the_points_and_ends_that_it_touches() {
    let lines = Lines::new(
        &[(0., 0.), (8., 4.), (4., 2.), (2., 1.), (2., 5.), (6., 3.), (6., -1.)],
        &[[0, 1], [3, 4], [5, 6]],
    );
    both(&lines, |a| assert_eq!(a.chains[0], [0, 3, 2, 5, 1].map(VertexId)));
}

/// An end put on a line by arithmetic lies beside it by rounding: to CGAL it is apart, on the grid it is on.
#[test]
fn an_end_beside_a_line_by_rounding_is_on_it() {
    let (a, b) = (DVec2::new(0.1, 0.7), DVec2::new(317.3, 211.9));
    let shares = [0.1, 0.3, 0.47, 0.61, 0.8, 0.97];
    let mut lines = Lines::new(&[a.into(), b.into()], &[[0, 1]]);
    for (i, t) in shares.into_iter().enumerate() {
        lines.points.extend([a.lerp(b, t), DVec2::new(100.0 * t, 300.0)]);
        lines.constraints.push([2 * i as u32 + 2, 2 * i as u32 + 3].map(VertexId));
    }
    let cut = noded(&lines.points, &lines.constraints).unwrap();
    assert_eq!(cut.chains[0].len(), 8);
    both(&lines, |a| assert!(a.chains[0].len() <= 8));
}

#[test]
fn points_that_are_one_but_for_rounding_become_one() {
    let lines =
        Lines::new(&[(0., 0.), (500., 1.), (500.0 + 1e-13, 1.), (250., 400.)], &[[0, 1], [2, 3], [1, 2]]);
    let cut = noded(&lines.points, &lines.constraints).unwrap();
    assert_eq!(cut.points.len(), 3);
    assert_eq!(cut.vertex_of_input[1], cut.vertex_of_input[2]);
    assert_eq!(cut.chains[2], [cut.vertex_of_input[1]]);
    agree(&lines);
}

#[test]
fn points_on_one_line_and_numbers_that_are_none_are_refused() {
    let on_line = Lines::new(&[(0., 0.), (1., 1.), (2., 2.)], &[[0, 2]]);
    let broken = Lines::new(&[(0., 0.), (1., f64::NAN), (2., 2.)], &[[0, 2]]);
    let single = Lines::new(&[(1., 1.), (1., 1.)], &[[0, 1]]);
    let none = Lines::new(&[], &[]);
    for (lines, word) in [(on_line, "one line"), (broken, "finite"), (single, ""), (none, "")] {
        for backend in [Backend::Spade, Backend::Cgal] {
            let error = lines.by(backend).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}

#[test]
fn a_planar_graph_stays_as_it_is() {
    let ring: Vec<(f64, f64)> = (0..12)
        .map(|i| f64::from(i) * std::f64::consts::FRAC_PI_6)
        .map(|t| (90.0 * t.cos(), 70.0 * t.sin()))
        .collect();
    let sides: Vec<[u32; 2]> = (0..12).map(|i| [i, (i + 1) % 12]).collect();
    let lines = Lines::new(&ring, &sides);
    both(&lines, |a| {
        assert_eq!((a.points.len(), a.triangles.len(), pieces(a)), (12, 10, 12));
        assert!(a.chains.iter().all(|c| c.len() == 2));
    });
}

/// Lines that are all but parallel cross where they do, to the last digits.
#[test]
fn nearly_parallel_constraints_cross_at_the_right_place() {
    let (low, high) = (1.1e-9, 1.0 - 0.7e-9);
    let lines = Lines::new(&[(0., 0.), (3., 1.), (0., low), (3., high)], &[[0, 1], [2, 3]]);
    let exact = lines.by(Backend::Cgal).unwrap();
    let wanted = 3.0 * low / (low + (1.0 - high));
    assert!((exact.points[4].x / wanted - 1.0).abs() < 1e-14, "{} {wanted}", exact.points[4].x);
    agree(&lines);
}

/// How the points of a random set lie.
fn points() -> impl Strategy<Value = Vec<DVec2>> {
    let anywhere = prop::collection::vec((-300.0..300.0, -200.0..200.0), 3..40);
    // Small grids: overlaps, crossings at points, many constraints through one place.
    let whole = (2..9_i32).prop_flat_map(|n| prop::collection::vec((0..=n, 0..=n), 3..40));
    let whole = whole.prop_map(|v| v.into_iter().map(|(x, y)| (f64::from(x), f64::from(y))).collect());
    // The same points again, a little off: at rounding, about the tolerance, and well above it.
    let doubled = (
        prop::collection::vec((-1.0..1.0, -1.0..1.0), 3..20),
        prop::sample::select(vec![1e-16, 1e-12, 3e-12, 1e-9, 1e-6]),
    )
        .prop_flat_map(|(v, off)| {
            let n = v.len();
            (Just(v), prop::collection::vec((-off..off, -off..off), n))
        })
        .prop_map(|(v, off): (Pairs, Pairs)| {
            let near = v.iter().zip(off).map(|(p, d)| (p.0 + d.0, p.1 + d.1)).collect::<Vec<_>>();
            v.into_iter().chain(near).collect()
        });
    // On few lines, put there by arithmetic.
    let aligned = prop::collection::vec((0..4_u8, 0.0..1.0), 3..40).prop_map(|v| {
        let on = |(line, t): (u8, f64)| {
            let k = f64::from(line);
            (0.1 + t * (70.3 - 9.0 * k), 7.7 * k + t * (31.0 - 17.3 * k))
        };
        v.into_iter().map(on).collect()
    });
    let kinds: [BoxedStrategy<Vec<(f64, f64)>>; 4] =
        [anywhere.boxed(), whole.boxed(), doubled.boxed(), aligned.boxed()];
    prop::strategy::Union::new(kinds).prop_map(|v| v.into_iter().map(DVec2::from).collect())
}

fn lines() -> impl Strategy<Value = Lines> {
    points().prop_flat_map(|points| {
        let n = points.len() as u32;
        let constraints =
            prop::collection::vec((0..n, 0..n).prop_map(|(a, b)| [VertexId(a), VertexId(b)]), 1..20);
        (Just(points), constraints).prop_map(|(points, constraints)| Lines { points, constraints })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Constraints held, areas, triangles, and every exact crossing: on random sets of all kinds.
    #[test]
    fn spade_and_cgal_agree_on_random_constraints_that_cross(lines in lines()) {
        match crosscheck_crossing(&lines.points, &lines.constraints) {
            Ok(check) => prop_assert!(check.agrees(), "{check:?}"),
            // What no triangle has both refuse.
            Err(error) => {
                prop_assert!(lines.by(Backend::Spade).is_err(), "{error}");
                let wide = thickness(&lines.points);
                prop_assert!(wide < 1e-9, "{error}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn both_are_sound_on_random_constraints_that_cross(lines in lines()) {
        for backend in [Backend::Spade, Backend::Cgal] {
            if let Ok(arranged) = lines.by(backend) {
                sound(&lines, &arranged);
            }
        }
    }

    /// Cutting again what was cut changes nothing: pieces meet only at their ends.
    #[test]
    fn pieces_need_no_further_cut(lines in lines()) {
        let Ok(cut) = noded(&lines.points, &lines.constraints) else { return Ok(()) };
        let pieces: BTreeMap<[VertexId; 2], Vec<u32>> = cut.pieces();
        let edges: Vec<[u32; 2]> = pieces.keys().map(|e| e.map(|v| v.0)).collect();
        let flat: Vec<[f64; 2]> = cut.points.iter().map(|p| p.to_array()).collect();
        let Ok(cdt) = softfold_kernel::cgal::constrained_delaunay(&flat, &edges) else { return Ok(()) };
        prop_assert_eq!(cdt.points.len(), flat.len());
        prop_assert_eq!(cdt.constraints.len(), edges.len());
    }
}

/// Least width of the points' box turned to their longest distance.
fn thickness(points: &[DVec2]) -> f64 {
    let first = points[0];
    let far = points.iter().copied().max_by(|p, q| p.distance(first).total_cmp(&q.distance(first))).unwrap();
    let along = (far - first).normalize_or_zero();
    let off = points.iter().map(|p| along.perp_dot(*p - first));
    let (lo, hi) = off.fold((f64::MAX, f64::MIN), |(l, h), o| (l.min(o), h.max(o)));
    hi - lo
}
