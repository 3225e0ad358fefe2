//! Points found on a mesh, and values carried from one mesh to another.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::{hole, options, pattern, polyline, rectangle, straight_band};
use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, Site, SoftPattern};
use softfold_mesh::{Backend, Locator, mesh, transfer};

fn sheet() -> SoftPattern {
    let loops = vec![rectangle(300.0, 200.0), hole(DVec2::new(80.0, 100.0), 40.0)];
    pattern(loops, vec![straight_band(0, 200.0, 300.0, 200.0, 30.0)])
}

fn meshed(soft: &SoftPattern, target_mm: f64) -> FlatMesh {
    mesh(soft, &options(target_mm, Backend::Spade)).unwrap().mesh
}

fn at_vertices(m: &FlatMesh, field: impl Fn(DVec2) -> DVec3) -> Vec<DVec3> {
    m.vertices.iter().map(|p| field(*p)).collect()
}

fn largest_error(m: &FlatMesh, values: &[DVec3], field: impl Fn(DVec2) -> DVec3) -> f64 {
    m.vertices.iter().zip(values).map(|(p, v)| field(*p).distance(*v)).fold(0.0, f64::max)
}

fn linear(p: DVec2) -> DVec3 {
    DVec3::new(3.0 * p.x - p.y + 7.0, 0.5 * p.y, 2.0 - p.x)
}

fn quadratic(p: DVec2) -> DVec3 {
    DVec3::new(p.x * p.x - 2.0 * p.x * p.y, 0.3 * p.y * p.y + p.x, p.length_squared()) / 300.0
}

#[test]
fn the_coordinates_of_a_located_point_give_the_point_back() {
    let m = meshed(&sheet(), 15.0);
    let locator = Locator::new(&m);
    for k in 0..2000 {
        let p = DVec2::new(f64::from(k) * 0.61803 % 1.0 * 300.0, f64::from(k) / 2000.0 * 200.0);
        let found = locator.locate(p);
        if p.distance(DVec2::new(80.0, 100.0)) < 30.0 {
            assert!(found.is_none(), "{p} is in the hole");
        } else if p.distance(DVec2::new(80.0, 100.0)) > 40.0 {
            let (t, w) = found.unwrap();
            let back: DVec2 = m.corners(t).iter().zip(w).map(|(c, w)| w * *c).sum();
            assert!(back.distance(p) < 1e-9 && w.iter().all(|w| *w > -1e-9), "{p} {back}");
        }
    }
}

#[test]
fn a_point_a_little_outside_is_at_the_nearest_point_and_one_far_away_nowhere() {
    let m = meshed(&sheet(), 15.0);
    let locator = Locator::with_tolerance(&m, 2.0);
    let (t, w) = locator.locate(DVec2::new(-1.5, 77.0)).unwrap();
    let back: DVec2 = m.corners(t).iter().zip(w).map(|(c, w)| w * *c).sum();
    assert!(back.distance(DVec2::new(0.0, 77.0)) < 1e-9, "{back}");
    assert!(locator.locate(DVec2::new(-2.5, 77.0)).is_none());
    assert!(locator.locate(DVec2::new(f64::NAN, 0.0)).is_none());
}

#[test]
fn linear_fields_are_carried_exactly_both_ways() {
    let (coarse, fine) = (meshed(&sheet(), 20.0), meshed(&sheet(), 8.0));
    for (from, to) in [(&coarse, &fine), (&fine, &coarse)] {
        let error = largest_error(to, &transfer(from, &at_vertices(from, linear), to), linear);
        assert!(error < 1e-8, "{error}");
    }
}

#[test]
fn quadratic_fields_are_carried_at_second_order() {
    let fine = meshed(&sheet(), 8.0);
    let error = |target_mm: f64| {
        let coarse = meshed(&sheet(), target_mm);
        largest_error(&fine, &transfer(&coarse, &at_vertices(&coarse, quadratic), &fine), quadratic)
    };
    // No more than the error bound of linear interpolation, |f''| h² / 8 on edges of at most 1.6 targets.
    let bound = |target_mm: f64| 2.0 * 2.7 / 300.0 * (1.6 * target_mm).powi(2) / 8.0;
    for target_mm in [40.0, 20.0, 10.0] {
        assert!(
            error(target_mm) < bound(target_mm),
            "{target_mm}: {} {}",
            error(target_mm),
            bound(target_mm)
        );
    }
    assert!(error(40.0) > 4.0 * error(10.0));
}

#[test]
fn values_do_not_leak_across_a_slit() {
    let mut soft = pattern(vec![rectangle(300.0, 200.0)], vec![]);
    // A bent slit from border to border: its chords differ between meshes.
    let arc: Vec<(f64, f64)> =
        (0..=60).map(|k| f64::from(k) / 60.0).map(|t| (150.0 + 80.0 * t * (1.0 - t), 200.0 * t)).collect();
    soft.slits.push(polyline(&arc));
    soft.check().unwrap();
    let (coarse, fine) = (meshed(&soft, 25.0), meshed(&soft, 9.0));
    let sides = |m: &FlatMesh| -> Vec<DVec3> {
        let rings = |v: usize| m.triangles.iter().enumerate().find(|(_, t)| t.iter().any(|c| c.index() == v));
        let side = |v: usize| {
            let (t, _) = rings(v).unwrap();
            let middle: DVec2 =
                m.corners(softfold_geometry::TriangleId::new(t)).into_iter().sum::<DVec2>() / 3.0;
            let t = middle.y / 200.0;
            if middle.x < 150.0 + 80.0 * t * (1.0 - t) { DVec3::ZERO } else { DVec3::ONE }
        };
        (0..m.vertices.len()).map(side).collect()
    };
    let values = sides(&coarse);
    assert!(
        coarse.sites.iter().filter(|s| matches!(s, Site::Boundary { loop_id, .. } if loop_id.0 == 1)).count()
            > 8
    );
    let carried = transfer(&coarse, &values, &fine);
    let wrong = carried.iter().zip(sides(&fine)).filter(|(a, b)| a.distance(*b) > 1e-6).count();
    assert_eq!(wrong, 0);
}

#[test]
fn fifty_thousand_values_are_carried_in_no_time() {
    let soft = pattern(vec![rectangle(300.0, 200.0)], vec![]);
    let (coarse, fine) = (meshed(&soft, 4.0), meshed(&soft, 1.17));
    assert!(fine.vertices.len() > 45_000, "{}", fine.vertices.len());
    let values = at_vertices(&coarse, linear);
    let start = std::time::Instant::now();
    transfer(&coarse, &values, &fine);
    // Well below a second on any machine that has it to itself.
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}
