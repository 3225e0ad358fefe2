//! Bands that change along their crease: tapers, tips, sharp stretches, narrow strips.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{
    Straight, angles_away_from, assert_good, on_rectangle, pattern, rectangle, sound, straight_band,
    with_backends,
};
use glam::DVec2;
use softfold_geometry::{Band, EdgeClass, FlatMesh, LineEnd, Softness};
use softfold_mesh::MeshOptions;

const WIDTH: f64 = 300.0;
const HEIGHT: f64 = 200.0;

fn vertical(profile: &[(f64, f64)]) -> Straight {
    let mut crease = Straight::new(DVec2::new(0.5 * WIDTH, 0.0), DVec2::Y, 0.0, 0.8);
    let soft = |&(s_mm, radius_mm): &(f64, f64)| Softness { s_mm, radius_mm, fold_angle_rad: 0.8 };
    crease.profile = profile.iter().map(soft).collect();
    crease
}

/// Soft at the lower border, sharp from a tip on.
fn tipped() -> (Straight, Band) {
    let crease = vertical(&[(0.0, 30.0), (120.0, 0.0)]);
    let mut band = crease.band(0);
    for k in 0..=crease.segments {
        let start = on_rectangle(crease.at(Some(k), 0.0), WIDTH, HEIGHT);
        band.fold_lines.push(crease.line(Some(k), &[0.0, 60.0, 120.0], [start, LineEnd::Tip]));
    }
    let end = on_rectangle(crease.at(None, HEIGHT), WIDTH, HEIGHT);
    band.fold_lines.push(crease.line(None, &[120.0, HEIGHT], [LineEnd::Tip, end]));
    (crease, band)
}

fn folds_at(m: &FlatMesh, p: DVec2) -> usize {
    let is_there = |v: &softfold_geometry::VertexId| m.vertices[v.index()] == p;
    let fold = |e: &&softfold_geometry::Edge| matches!(e.class, EdgeClass::Fold { .. });
    m.edges.iter().filter(fold).filter(|e| e.vertices.iter().any(is_there)).count()
}

#[test]
fn lines_come_together_in_a_tip_and_go_on_as_one() {
    let (crease, band) = tipped();
    let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![band]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        let tip = crease.at(None, 120.0);
        assert_eq!(m.vertices.iter().filter(|v| v.distance(tip) < 1e-9).count(), 1);
        assert_eq!(folds_at(&m, tip), 6, "five soft lines and the sharp one");
        // Next to the tip the pattern's own angle is a fourth of the band's.
        assert_good(&m, &[(tip, 25.0)]);
    });
}

#[test]
fn rows_of_a_taper_follow_the_width() {
    let crease = vertical(&[(0.0, 60.0), (HEIGHT, 12.0)]);
    let mut band = crease.band(0);
    for k in 0..=crease.segments {
        let ends = [0.0, HEIGHT].map(|s| on_rectangle(crease.at(Some(k), s), WIDTH, HEIGHT));
        band.fold_lines.push(crease.line(Some(k), &[0.0, HEIGHT], ends));
    }
    let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![band]);
    with_backends(|options| {
        let m = sound(&soft, &options);
        let mut counts = [0; 5];
        let mut rows = [0.0; 5];
        for e in &m.edges {
            if let EdgeClass::Fold { line, .. } = e.class {
                counts[line as usize] += 1;
                let [a, b] = e.vertices.map(|v| m.vertices[v.index()]);
                let wished = options.band_aspect * crease.width_mm(0.5 * (a.y + b.y));
                rows[line as usize] += a.distance(b) / wished.min(options.target_edge_mm);
            }
        }
        // Every other line begins and ends with half a row.
        assert!((0..5).all(|k| counts[k] == counts[0] + k % 2), "{counts:?}");
        assert!(rows.iter().all(|r| (r - f64::from(counts[0] as u32)).abs() < 1.0), "{counts:?} {rows:?}");
        assert_good(&m, &[]);
    });
}

#[test]
fn a_narrow_band_has_no_small_angles() {
    for radius_mm in [6.0, 2.0, 0.5] {
        let band = straight_band(0, 0.5 * WIDTH, WIDTH, HEIGHT, radius_mm);
        let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![band]);
        with_backends(|options| {
            assert_good(&sound(&soft, &options), &[]);
        });
    }
}

#[test]
fn paper_thin_bands_take_thousands_of_vertices_not_tens_of_thousands() {
    let bands = (1..=5).map(|k| straight_band(k - 1, f64::from(k) * 50.0, WIDTH, HEIGHT, 1.5)).collect();
    let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], bands);
    with_backends(|options| {
        // Long rows take fewer, at angles of 24°.
        let m = sound(&soft, &MeshOptions { narrow_aspect: 4.5, ..options });
        assert!(m.vertices.len() < 12_000, "{}", m.vertices.len());
    });
}

#[test]
fn lines_that_come_close_get_short_edges() {
    let sharp = |id: u32, u: f64| {
        let crease = Straight::new(DVec2::new(u, 0.0), DVec2::Y, 0.0, 0.8);
        let ends = [0.0, HEIGHT].map(|s| on_rectangle(crease.at(None, s), WIDTH, HEIGHT));
        let mut band = crease.band(id);
        band.fold_lines.push(crease.line(None, &[0.0, HEIGHT], ends));
        band
    };
    for gap_mm in [1.0, 3.0] {
        let bands = vec![sharp(0, 0.5 * WIDTH), sharp(1, 0.5 * WIDTH + gap_mm)];
        let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], bands);
        with_backends(|options| {
            let angles = angles_away_from(&sound(&soft, &options), &[]);
            assert!(angles[0] > 15.0, "{gap_mm}: {:.1}", angles[0]);
        });
    }
}

#[test]
fn a_crease_that_ends_all_but_in_a_corner_ends_in_it() {
    let crease = Straight::new(DVec2::new(1e-3, 0.0), DVec2::new(1.0, 1.0), 0.0, 0.8);
    let mut band = crease.band(0);
    let (s_mm, exit) = crease.exit(None, WIDTH, HEIGHT);
    let start = on_rectangle(crease.from, WIDTH, HEIGHT);
    band.fold_lines.push(crease.line(None, &[0.0, s_mm], [start, exit]));
    let soft = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![band]);
    with_backends(|options| {
        let m = softfold_mesh::mesh(&soft, &options).unwrap().mesh;
        assert_eq!(folds_at(&m, DVec2::ZERO), 1);
        assert!((m.area_mm2() / (WIDTH * HEIGHT) - 1.0).abs() < 1e-12);
        assert_good(&m, &[]);
    });
}

#[test]
fn a_crease_that_stays_flat_leaves_no_trace() {
    let mut flat = vertical(&[(0.0, 0.0)]).band(0);
    flat.profile.clear();
    let with = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![flat]);
    let without = pattern(vec![rectangle(WIDTH, HEIGHT)], vec![]);
    with_backends(|options| assert_eq!(sound(&with, &options), sound(&without, &options)));
}
