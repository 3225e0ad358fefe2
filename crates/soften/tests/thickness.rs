//! Radii from the board: closed forms of the paper's equations 1, 5 and 6.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

mod common;

use common::*;
use proptest::prelude::*;
use softfold_geometry::Role;
use softfold_soften::thickness::{equal_radius_mm, one_sided_radius_mm, radius_of_width_mm};
use softfold_soften::{Along, Board, Compensation, CreaseSoftness, Fault, compensated, soften};

const BOARD: Board = Board { thickness_mm: 8.0, strain_limit: 0.1, inside_radius_mm: 30.0 };

#[test]
fn the_smallest_radius_keeps_the_strain_and_the_inside_radius() {
    assert_eq!(BOARD.smallest_radius_mm(), 40.0_f64.max(34.0));
    let soft_fibre = Board { strain_limit: 0.5, ..BOARD };
    assert_eq!(soft_fibre.smallest_radius_mm(), 34.0);
    assert!((BOARD.outer_strain(BOARD.smallest_radius_mm()) - BOARD.strain_limit).abs() < 1e-15);
}

#[test]
fn one_sided_boards_change_valleys_alone() {
    for (degrees, one_sided, equal) in [(90.0, 42.0, 58.0), (-90.0, 50.0, 50.0)] {
        let of = |mode| {
            compensated(&soft(50.0, degrees, 4), Role::Valley, &BOARD, mode).unwrap().softness.radius_mm
        };
        assert_eq!(of(Compensation::OneSided), Along::Constant(one_sided));
        assert_eq!(of(Compensation::Equal), Along::Constant(equal));
        assert_eq!(of(Compensation::None), Along::Constant(50.0));
    }
}

#[test]
fn equal_radii_come_out_equal_on_the_other_side() {
    for r in [10.0, 50.0] {
        let [valley, mountain] =
            [1.0, -1.0].map(|sign| one_sided_radius_mm(equal_radius_mm(r, sign, 8.0), sign, 8.0));
        assert_eq!((valley, mountain), (r, r));
    }
}

#[test]
fn a_board_thicker_than_a_radius_is_refused() {
    let error = compensated(&soft(5.0, 90.0, 4), Role::Valley, &BOARD, Compensation::OneSided).unwrap_err();
    assert!(matches!(error, Fault::Board { .. }));
    for bad in [
        Board { thickness_mm: -1.0, ..BOARD },
        Board { strain_limit: 0.0, ..BOARD },
        Board { inside_radius_mm: f64::NAN, ..BOARD },
    ] {
        assert!(compensated(&soft(5.0, 90.0, 4), Role::Valley, &bad, Compensation::None).is_err());
    }
}

#[test]
fn radii_below_what_the_board_bears_are_told() {
    let told =
        |s: &CreaseSoftness| compensated(s, Role::Valley, &BOARD, Compensation::None).unwrap().tight_mm;
    assert_eq!(told(&soft(39.9, 90.0, 4)), vec![0.0]);
    assert!(told(&soft(40.0, 90.0, 4)).is_empty());
    assert_eq!(told(&tapered(&[(0.0, 50.0), (100.0, 10.0), (200.0, 0.0)], 90.0, 4)), vec![100.0, 200.0]);
}

#[test]
fn a_crease_that_changes_its_sign_loses_the_thickness_on_its_valley_side_alone() {
    let angles = Along::Places(vec![(0.0, 1.0), (200.0, 1.0), (400.0, -1.0), (600.0, -1.0)]);
    let softness = CreaseSoftness { fold_angle_rad: angles, ..soft(50.0, 0.0, 4) };
    let c = compensated(&softness, Role::Valley, &BOARD, Compensation::OneSided).unwrap();
    let p = pattern(sheet(), vec![], vec![line((500.0, 0.0), (500.0, 600.0))]);
    let s = soften(&p, &[c.softness]).unwrap();
    s.check().unwrap();
    for (at, r) in [(0.0, 42.0), (100.0, 42.0), (299.0, 42.0), (301.0, 50.0), (600.0, 50.0)] {
        assert!((s.bands[0].at(at).unwrap().radius_mm - r).abs() < 1e-9, "{at}");
    }
}

#[test]
fn a_constant_fold_angle_gets_the_one_radius_of_its_width() {
    let mode = Compensation::PerPoint { width_mm: 80.0 };
    let c = compensated(&soft(0.0, 60.0, 4), Role::Valley, &BOARD, mode).unwrap();
    let Along::Constant(r) = c.softness.radius_mm else { panic!() };
    assert!((r / radius_of(40.0, 60.0, 4) - 1.0).abs() < 1e-12);
    assert!(c.raised_mm.is_empty());
    let c = compensated(&soft(0.0, 150.0, 4), Role::Valley, &BOARD, mode).unwrap();
    assert_eq!((c.softness.radius_mm, c.raised_mm), (Along::Constant(40.0), vec![0.0]));
}

proptest! {
    /// The radius of a width gives back that width, and a radius that follows the angle keeps the band's
    /// width to 0.23 %, never below what the board bears.
    #[test]
    fn bands_that_follow_the_angle_keep_their_width(
        width in 10.0..80.0f64, angles in proptest::collection::vec(-150.0..150.0f64, 4), n in 1u32..9,
    ) {
        prop_assume!(angles.iter().any(|a| a.abs() > 5.0));
        let list: Vec<(f64, f64)> = angles.iter().enumerate().map(|(i, a)| (200.0 * i as f64, a.to_radians())).collect();
        let softness = CreaseSoftness { fold_angle_rad: Along::Places(list), ..soft(0.0, 0.0, n) };
        let board = Board { thickness_mm: 2.0, strain_limit: 0.1, inside_radius_mm: 5.0 };
        let c = compensated(&softness, Role::Valley, &board, Compensation::PerPoint { width_mm: width }).unwrap();
        let p = pattern(sheet(), vec![], vec![line((500.0, 0.0), (500.0, 600.0))]);
        let s = soften(&p, &[c.softness]).unwrap();
        s.check().unwrap();
        for i in 0..=600 {
            let at = s.bands[0].at(f64::from(i)).unwrap();
            prop_assert!(at.radius_mm >= board.smallest_radius_mm() - 1e-9);
            let wanted = radius_of_width_mm(width, at.fold_angle_rad, n);
            if at.fold_angle_rad.abs() > 1.1f64.to_radians() && wanted > 1.1 * board.smallest_radius_mm() {
                let w = f64::from(n) * at.strip_width_mm(n);
                prop_assert!((w / width - 1.0).abs() < 2.5e-3, "{i} {w} {width}");
            }
        }
    }
}
