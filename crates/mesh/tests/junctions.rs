//! Bands that meet: regions, stars of sharp creases, grids.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{
    SIZE_MM, Straight, assert_good, euler, options, pattern, rectangle, sound, star, with_backends,
};
use glam::DVec2;
use proptest::prelude::*;
use softfold_geometry::{EdgeClass, EdgeId, JunctionRegion, LineEnd, Site, SoftPattern};
use softfold_mesh::Backend;
use std::collections::BTreeMap;

#[test]
fn three_to_six_bands_leave_a_free_region() {
    with_backends(|options| {
        for count in 3..=6 {
            let arms: Vec<(f64, f64)> =
                (0..count).map(|k| (10.0 + 360.0 * f64::from(k) / f64::from(count), 30.0)).collect();
            let soft = star(SIZE_MM, &arms);
            let m = sound(&soft, &options);
            assert_eq!(euler(&m), 1);
            // Most triangles are in strips, whose rows are 1.4 times as long as wide.
            let angles = common::angles_away_from(&m, &[]);
            assert!(angles[0] >= 20.0 && angles[angles.len() / 2] >= 40.0, "{count}: {:.1}", angles[0]);
        }
    });
}

#[test]
fn corners_of_a_region_that_miss_the_lines_by_rounding_are_their_ends() {
    let mut soft = star(SIZE_MM, &[(20.0, 30.0), (110.0, 10.0), (200.0, 12.0), (290.0, 20.0)]);
    for corner in &mut soft.junctions[0].polygon {
        *corner += DVec2::new(3e-13, -2e-13);
    }
    with_backends(|options| {
        let m = sound(&soft, &options);
        let shortest = (0..m.edges.len()).map(|e| m.edge_length_mm(EdgeId::new(e))).fold(f64::MAX, f64::min);
        assert!(shortest > 1e-3, "two points of {shortest} mm where there is one");
    });
}

#[test]
fn soft_and_sharp_creases_meet() {
    with_backends(|options| {
        let soft = star(SIZE_MM, &[(20.0, 30.0), (110.0, 0.0), (200.0, 12.0), (290.0, 0.0)]);
        assert_good(&sound(&soft, &options), &[]);
    });
}

#[test]
fn sharp_creases_meet_in_their_point() {
    with_backends(|options| {
        let soft = star(SIZE_MM, &[(0.0, 0.0), (70.0, 0.0), (150.0, 0.0), (230.0, 0.0)]);
        let m = sound(&soft, &options);
        let middle = DVec2::splat(0.5 * SIZE_MM);
        assert_eq!(m.vertices.iter().filter(|v| **v == middle).count(), 1);
        assert!(m.edges.iter().all(|e| e.class != EdgeClass::Free));
        assert_good(&m, &[]);
    });
}

/// Sharp creases along all inner lines of a grid of squares.
fn grid(cells: usize, cell_mm: f64) -> SoftPattern {
    let size = cells as f64 * cell_mm;
    let mut soft = pattern(vec![rectangle(size, size)], vec![]);
    let mut numbers = BTreeMap::new();
    for i in 1..cells {
        for j in 1..cells {
            let point = DVec2::new(i as f64, j as f64) * cell_mm;
            numbers.insert([i, j], soft.junctions.len());
            soft.junctions.push(JunctionRegion { point, polygon: vec![], creases: vec![] });
        }
    }
    for line in 1..cells {
        for step in 0..cells {
            for across in [false, true] {
                let node = |k: usize| if across { [k, line] } else { [line, k] };
                let at = |k: usize| DVec2::from_array(node(k).map(|c| c as f64 * cell_mm));
                let id = soft.bands.len() as u32;
                let crease = Straight::new(at(step), at(step + 1) - at(step), 0.0, 0.5);
                let end = |k: usize| match numbers.get(&node(k)) {
                    Some(&j) => LineEnd::Junction(j),
                    None => common::on_rectangle(at(k), size, size),
                };
                let mut fold_line = crease.line(None, &[0.0, cell_mm], [end(step), end(step + 1)]);
                fold_line.points = vec![at(step), at(step + 1)];
                let mut band = crease.band(id);
                band.fold_lines.push(fold_line);
                soft.bands.push(band);
            }
        }
    }
    soft.check().unwrap();
    soft
}

#[test]
fn every_corner_of_a_grid_of_sharp_creases_is_one_vertex() {
    let soft = grid(6, 30.0);
    with_backends(|options| {
        let m = sound(&soft, &options);
        for j in &soft.junctions {
            assert_eq!(m.vertices.iter().filter(|v| **v == j.point).count(), 1, "{}", j.point);
        }
        assert!(m.sites.contains(&Site::Interior));
        assert_good(&m, &[]);
    });
}

#[test]
fn creases_meet_on_the_outline() {
    let mut soft = pattern(vec![rectangle(SIZE_MM, SIZE_MM)], vec![]);
    let point = DVec2::new(123.0, 0.0);
    for (id, deg) in [(0, 60.0_f64), (1, 100.0), (2, 140.0)] {
        let crease = Straight::new(point, DVec2::from_angle(deg.to_radians()), 0.0, 0.5);
        let (out, end) = crease.exit(None, SIZE_MM, SIZE_MM);
        let mut band = crease.band(id);
        band.fold_lines.push(crease.line(None, &[0.0, out], [LineEnd::Junction(0), end]));
        soft.bands.push(band);
    }
    soft.junctions.push(JunctionRegion { point, polygon: vec![], creases: vec![] });
    with_backends(|options| {
        let m = sound(&soft, &options);
        assert_eq!(m.vertices.iter().filter(|v| v.distance(point) < 1e-6).count(), 1);
        assert_good(&m, &[]);
    });
}

#[test]
fn a_region_may_have_a_side_on_the_outline() {
    // Half a star: three bands that meet on the lower border, whose region is cut off there.
    let whole = star(SIZE_MM, &[(0.0, 0.0), (90.0, 20.0), (180.0, 0.0), (270.0, 20.0)]);
    let mut soft = whole.clone();
    soft.loops = vec![common::polyline(&[(0., 150.), (300., 150.), (300., 300.), (0., 300.), (0., 150.)])];
    let mut band = whole.bands[1].clone();
    for line in &mut band.fold_lines {
        line.ends[1] = common::on_rectangle(line.points[1] - DVec2::new(0.0, 150.0), SIZE_MM, 150.0);
    }
    let [right, left] = [whole.bands[0].fold_lines[0].points[0], whole.bands[2].fold_lines[0].points[0]];
    let inner = band.fold_lines.iter().map(|l| l.points[0]);
    soft.junctions[0].polygon = std::iter::once(right).chain(inner).chain([left]).collect();
    band.crease = softfold_geometry::CreaseId(0);
    soft.bands = vec![band];
    soft.check().unwrap();
    with_backends(|options| {
        let m = softfold_mesh::mesh(&soft, &options).unwrap().mesh;
        assert!((m.area_mm2() / soft.area_mm2() - 1.0).abs() < 1e-9);
        let region = &soft.junctions[0].polygon;
        for e in m.edges.iter().filter(|e| e.triangles[1].is_some()) {
            let [a, b] = e.vertices.map(|v| m.vertices[v.index()]);
            let inside = softfold_geometry::polygon::contains(region, 0.5 * (a + b));
            assert!(!inside || e.class == EdgeClass::Free, "{a} {b} {:?}", e.class);
        }
        assert!(m.edges.iter().any(|e| e.class == EdgeClass::Free));
    });
}

#[test]
fn creases_shorter_than_the_target_are_one_edge() {
    let soft = grid(10, 5.0);
    with_backends(|options| {
        let m = sound(&soft, &options);
        let folds = m.edges.iter().filter(|e| matches!(e.class, EdgeClass::Fold { .. })).count();
        assert_eq!(folds, soft.bands.len());
        assert_eq!(m.vertices.len(), 121);
    });
}

#[test]
fn thousands_of_creases_are_meshed_in_seconds() {
    let soft = grid(40, 7.5);
    assert!(soft.bands.len() > 3000);
    let start = std::time::Instant::now();
    let m = sound(&soft, &options(15.0, Backend::Spade));
    assert!(m.vertices.len() >= 41 * 41);
    // A few seconds on any machine; quadratic loops take minutes.
    assert!(start.elapsed().as_secs() < 30, "{:?}", start.elapsed());
}

#[test]
fn two_short_creases_with_the_same_ends_stay_apart() {
    // A lens of two curved creases, shorter than the target edge.
    let mut soft = grid(2, 20.0);
    let arc = |side: f64| -> Vec<DVec2> {
        (0..=20)
            .map(|k| {
                let t = f64::from(k) / 20.0;
                let bulge = if k == 0 || k == 20 { 0.0 } else { side * 8.0 * t * (1.0 - t) };
                DVec2::new(4.0 + 10.0 * t, 10.0 + bulge)
            })
            .collect()
    };
    soft.bands.clear();
    soft.junctions.clear();
    for (id, side) in [(0, -1.0), (1, 1.0)] {
        let crease = Straight::new(DVec2::new(4.0, 10.0), DVec2::X, 0.0, 0.5);
        let s: Vec<f64> = (0..=20).map(f64::from).collect();
        let mut line = crease.line(None, &s, [LineEnd::Junction(0), LineEnd::Junction(1)]);
        line.points = arc(side);
        let mut band = crease.band(id);
        band.fold_lines.push(line);
        soft.bands.push(band);
    }
    for k in [0, 20] {
        let point = soft.bands[0].fold_lines[0].points[k];
        soft.junctions.push(JunctionRegion { point, polygon: vec![], creases: vec![] });
    }
    with_backends(|mut options| {
        options.target_edge_mm = 30.0;
        let m = softfold_mesh::mesh(&soft, &options).unwrap().mesh;
        let lines: std::collections::BTreeSet<u32> = m
            .edges
            .iter()
            .filter_map(|e| match e.class {
                EdgeClass::Fold { crease, .. } => Some(crease.0),
                _ => None,
            })
            .collect();
        assert_eq!(lines.len(), 2);
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn random_stars_are_sound(
        start in 0.0..360.0f64,
        gaps in prop::collection::vec(1.0..2.5f64, 3..7),
        radii in prop::collection::vec(prop_oneof![Just(0.0), 2.0..25.0f64], 7),
        target in 8.0..25.0f64,
        cgal in any::<bool>(),
    ) {
        let whole: f64 = gaps.iter().sum();
        let mut angle = start;
        let mut arms = Vec::new();
        for (gap, radius) in gaps.iter().zip(&radii) {
            arms.push((angle.rem_euclid(360.0), *radius));
            angle += 360.0 * gap / whole;
        }
        let backend = if cgal { Backend::Cgal } else { Backend::Spade };
        let soft = star(SIZE_MM, &arms);
        // A line that ends all but in a corner of the outline is drawn into it, or leaves an edge too short to care for.
        let at_corner =
            |p: &DVec2| p.to_array().iter().all(|c| *c < target / 32.0 || *c > SIZE_MM - target / 32.0);
        let ends = soft.bands.iter().flat_map(|b| &b.fold_lines).flat_map(|l| l.points.last());
        prop_assume!(!ends.into_iter().any(at_corner));
        let m = sound(&soft, &options(target, backend));
        prop_assert_eq!(euler(&m), 1);
        let angles = common::angles_away_from(&m, &[]);
        prop_assert!(angles[0] > 8.0, "{:.1}", angles[0]);
    }
}
