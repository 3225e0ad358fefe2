//! Whether real boards stand: an arch on two feet whose barycenter is put where we want it.

use crate::board::{Board, BoardOptions, Placement, make_board};
use crate::{rest_of_board, shapes, trim_ground};
use glam::{DVec2, DVec3};
use softfold_geometry::PlanarCurve;

/// Half the width of the arch's outline, mm: its feet are its ends.
const HALF_MM: f64 = 120.0;
/// Width of the legs, mm: the feet's hull reaches from 0 to it along y.
const FOOT_MM: f64 = 20.0;
/// Half the width of the plate that bulges out over the feet, mm.
const BULGE_HALF_MM: f64 = 60.0;
const THICKNESS_MM: f64 = 6.0;
const CONTACT_MM: f64 = 0.05;

/// How far the plate reaches for the barycenter to lie at y: of a cylinder's board, the sheet in its middle, that is the
/// centroid of the flat outline.
fn reach_for(y: f64) -> f64 {
    let legs = 2.0 * HALF_MM * FOOT_MM;
    let centroid = |reach: f64| {
        let plate = 2.0 * BULGE_HALF_MM * (reach - FOOT_MM);
        (legs * 0.5 * FOOT_MM + plate * 0.5 * (FOOT_MM + reach)) / (legs + plate)
    };
    let [mut low, mut high] = [FOOT_MM, 1e3];
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if centroid(middle) < y { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The arch with its barycenter `inside_mm` from the edge of its feet, negative outside.
fn arch(inside_mm: f64) -> Board {
    let (foot, half, reach) = (FOOT_MM, BULGE_HALF_MM, reach_for(FOOT_MM - inside_mm));
    let corners = [
        (-HALF_MM, 0.0),
        (HALF_MM, 0.0),
        (HALF_MM, foot),
        (half, foot),
        (half, reach),
        (-half, reach),
        (-half, foot),
        (-HALF_MM, foot),
        (-HALF_MM, 0.0),
    ];
    let outline = PlanarCurve::polyline(&corners.map(DVec2::from)).unwrap();
    let r = shapes::CYLINDER_RADIUS_MM;
    let hill = |p: DVec2| DVec3::new(r * (p.x / r).sin(), p.y, r * (p.x / r).cos());
    let options =
        BoardOptions { thickness_mm: THICKNESS_MM, placement: Placement::Mid, ..Default::default() };
    make_board(&shapes::sheet(outline, hill), &options).unwrap()
}

/// Four of the eight are within 1 mm of tipping.
const CASES_MM: [f64; 8] = [8.0, 3.0, 0.8, 0.2, -0.2, -0.8, -3.0, -8.0];

#[test]
fn eight_arches_stand_or_fall_as_their_barycenters_say() {
    for inside_mm in CASES_MM {
        let board = arch(inside_mm);
        assert!((board.barycenter_mm.y - (FOOT_MM - inside_mm)).abs() < 1e-3, "{}", board.barycenter_mm);
        let rest = rest_of_board(&board, 4.0, CONTACT_MM).unwrap();
        let found = &rest.stability;
        assert_eq!(found.stable, inside_mm > 0.0, "{inside_mm}: {rest:?}");
        assert_eq!(rest.rests, inside_mm > 0.0, "{inside_mm}");
        assert!((found.margin_mm - inside_mm).abs() < 0.01, "{inside_mm}: {}", found.margin_mm);
        assert!((rest.support_margin_mm - inside_mm).abs() < 0.01, "{inside_mm}: {}", rest.support_margin_mm);
        let height = board.barycenter_mm.z - found.ground_z_mm;
        let tipping = inside_mm.atan2(height).to_degrees();
        assert!((found.tipping_angle_deg - tipping).abs() < 0.01, "{inside_mm}: {}", found.tipping_angle_deg);
    }
}

#[test]
fn cut_flat_at_the_ground_the_arches_still_stand_or_fall_as_they_should() {
    for inside_mm in [0.8, -0.8] {
        let whole = arch(inside_mm);
        let y = whole.barycenter_mm.y;
        let cut = trim_ground(whole, 3.0).unwrap();
        // What the feet lose lies within them, so that the barycenter moves outwards.
        assert!(cut.barycenter_mm.y > y);
        let rest = rest_of_board(&cut, 4.0, CONTACT_MM).unwrap();
        let margin = FOOT_MM - cut.barycenter_mm.y;
        assert_eq!(rest.stability.stable, margin > 0.0, "{inside_mm} {margin}");
        assert!((rest.stability.margin_mm - margin).abs() < 0.01, "{inside_mm} {margin} {rest:?}");
    }
}
