//! The paper's steps as they are.

#![allow(clippy::unwrap_used, reason = "what helps a test may stop at the first surprise")]

mod common;

use common::{SIZE_MM, hole, options, pattern, rectangle, sound, star, straight_band, with_backends};
use glam::DVec2;
use softfold_geometry::Site;
use softfold_mesh::{Backend, MeshOptions, Method, mesh};

fn paper(target_edge_mm: f64) -> MeshOptions {
    MeshOptions { method: Method::Paper, ..options(target_edge_mm, Backend::Spade) }
}

#[test]
fn sheets_with_bands_holes_and_junctions_are_meshed() {
    let banded =
        pattern(vec![rectangle(SIZE_MM, 200.0)], vec![straight_band(0, 150.0, SIZE_MM, 200.0, 40.0)]);
    let star = star(SIZE_MM, &[(10.0, 20.0), (100.0, 0.0), (200.0, 20.0), (290.0, 20.0)]);
    for soft in [banded, star] {
        with_backends(|o| drop(sound(&soft, &MeshOptions { method: Method::Paper, ..o })));
    }
    let holed = pattern(vec![rectangle(SIZE_MM, 200.0), hole(DVec2::new(150.0, 100.0), 40.0)], vec![]);
    let m = mesh(&holed, &paper(15.0)).unwrap().mesh;
    // The hole is a polygon of sides of about 14 mm.
    assert!((m.area_mm2() / holed.area_mm2() - 1.0).abs() < 5e-3);
}

#[test]
fn points_inside_keep_their_distance_from_curves_and_curves_have_the_mean_spacing() {
    let soft = pattern(vec![rectangle(SIZE_MM, 200.0)], vec![straight_band(0, 150.0, SIZE_MM, 200.0, 40.0)]);
    let target = 10.0;
    let rounds = MeshOptions { relaxation_rounds: 0, ..paper(target) };
    let m = mesh(&soft, &rounds).unwrap().mesh;
    for (p, site) in m.vertices.iter().zip(&m.sites).filter(|(_, s)| **s == Site::Interior) {
        let clear = p.x.min(SIZE_MM - p.x).min(p.y).min(200.0 - p.y);
        assert!(clear >= 0.5 * target, "{p} {site:?}");
    }
    // Random points: the six nearest are 0.909 targets away on average; fewer are left beside curves, which makes it more.
    let sides = m.sites.iter().filter(|s| matches!(s, Site::Boundary { .. })).count();
    let spacing = 2.0 * (SIZE_MM + 200.0) / sides as f64;
    assert!((0.85 * target..1.05 * target).contains(&spacing), "{spacing}");
}

#[test]
fn the_seed_decides_and_nothing_else() {
    let soft = pattern(vec![rectangle(SIZE_MM, 200.0)], vec![straight_band(0, 150.0, SIZE_MM, 200.0, 40.0)]);
    let [a, b, other] = [1, 1, 2].map(|seed| mesh(&soft, &MeshOptions { seed, ..paper(12.0) }).unwrap());
    assert_eq!(a, b);
    assert_ne!(a.mesh.vertices, other.mesh.vertices);
}
