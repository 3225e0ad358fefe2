//! Patterns as DXF and back, and what stands in the files.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use proptest::prelude::*;
use softfold_geometry::{Crease, CreaseId, CreasePattern, DVec2, PlanarCurve, Role, Segment, Source};
use softfold_pattern::{DxfOptions, DxfVersion, Format, ReadOptions, read, write_dxf};
use std::f64::consts::{PI, TAU};

const VERSIONS: [DxfVersion; 2] = [DxfVersion::R12, DxfVersion::R2000];

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

/// An arc about a centre, as cubics of 15°; angles in rad.
fn arc(centre: DVec2, radius: f64, start: f64, sweep: f64) -> Vec<Segment> {
    let count = (sweep.abs() / (PI / 12.0)).ceil() as usize;
    let step = sweep / count as f64;
    let handle = 4.0 / 3.0 * (0.25 * step).tan() * radius;
    let on = |k: usize| DVec2::from_angle(start + step * k as f64);
    let piece = |k: usize| {
        let [a, b] = [on(k), on(k + 1)];
        let [from, to] = [a, b].map(|p| centre + radius * p);
        Segment::Cubic { from, c1: from + handle * a.perp(), c2: to - handle * b.perp(), to }
    };
    (0..count).map(piece).collect()
}

/// A chain of segments, closed: lines where they do not meet.
fn closed(parts: Vec<Vec<Segment>>) -> PlanarCurve {
    let mut all: Vec<Segment> = Vec::new();
    for segment in parts.into_iter().flatten() {
        if let Some(to) = all.last().map(Segment::to).filter(|p| p.distance(segment.from()) > 1e-9) {
            all.push(Segment::Line { from: to, to: segment.from() });
        }
        all.push(segment);
    }
    let [from, to] = [all[all.len() - 1].to(), all[0].from()];
    all.push(Segment::Line { from, to });
    PlanarCurve::new(all).unwrap()
}

/// A sheet of 300 × 100 mm with round corners.
fn outline(radius: f64) -> PlanarCurve {
    let corner = |x: f64, y: f64, quarter: f64| {
        arc(v(150.0 + x * (150.0 - radius), 50.0 + y * (50.0 - radius)), radius, quarter * 0.5 * PI, 0.5 * PI)
    };
    closed(vec![corner(-1., -1., 2.), corner(1., -1., 3.), corner(1., 1., 0.), corner(-1., 1., 1.)])
}

/// A crease from bottom to top that leans by `lean` and swings by `swing`.
fn crease(number: usize, role: Role, [lean, swing]: [f64; 2]) -> Crease {
    let x = 60.0 * (number as f64 + 1.0);
    let curve = PlanarCurve::new(vec![Segment::Cubic {
        from: v(x, 0.0),
        c1: v(x + swing, 30.0),
        c2: v(x - swing + lean, 70.0),
        to: v(x + lean, 100.0),
    }]);
    let (id, name) = (CreaseId::new(number), format!("crease-{}", number + 1));
    Crease { id, name, role, curve: curve.unwrap(), fold_angle_rad: None, source: Source::default() }
}

fn pattern(radius: f64, hole: f64, shapes: &[(Role, [f64; 2])]) -> CreasePattern {
    let hole = PlanarCurve::new(arc(v(30.0, 50.0), hole, 0.0, -TAU)).unwrap();
    let creases = shapes.iter().enumerate().map(|(i, (role, shape))| crease(i, *role, *shape));
    let pattern = CreasePattern {
        name: "test".to_owned(),
        outline: outline(radius),
        holes: vec![hole],
        slits: Vec::new(),
        creases: creases.collect(),
    };
    pattern.check().unwrap();
    pattern
}

/// Reads without refitting and without a unit other than mm.
fn read_back(text: &str) -> CreasePattern {
    let options = ReadOptions { unit_mm: Some(1.0), refit_mm: Some(0.0), ..ReadOptions::default() };
    let file = read(text.as_bytes(), Format::Dxf, "test", &options).unwrap_or_else(|e| panic!("{e}"));
    file.pattern.check().unwrap();
    file.pattern
}

/// Farthest that points of one curve lie from the other, mm.
fn distance(a: &PlanarCurve, b: &PlanarCurve) -> f64 {
    a.flatten(1e-3).iter().map(|p| b.nearest(*p).1).fold(0.0, f64::max)
}

fn assert_same(a: &PlanarCurve, b: &PlanarCurve, within_mm: f64) {
    assert_eq!(a.is_closed(), b.is_closed());
    let far = distance(a, b).max(distance(b, a));
    assert!(far <= within_mm, "{far} mm");
}

fn assert_round_trip(pattern: &CreasePattern, options: DxfOptions) {
    let back = read_back(&write_dxf(pattern, &options));
    let within_mm = options.chord_mm + 1e-5;
    assert_eq!((back.holes.len(), back.creases.len()), (pattern.holes.len(), pattern.creases.len()));
    assert_same(&pattern.outline, &back.outline, within_mm);
    assert_same(&pattern.holes[0], &back.holes[0], within_mm);
    for (a, b) in pattern.creases.iter().zip(&back.creases) {
        assert_eq!(a.role, b.role);
        assert_same(&a.curve, &b.curve, within_mm);
    }
}

const FIVE: [(Role, [f64; 2]); 4] = [
    (Role::Mountain, [0.0, 0.0]),
    (Role::Valley, [10.0, 15.0]),
    (Role::Unassigned, [-5.0, 8.0]),
    (Role::Flat, [5.0, -10.0]),
];

fn lines_of(text: &str) -> Vec<&str> {
    text.split("\r\n").map(str::trim).collect()
}

#[test]
fn a_pattern_comes_back_with_its_curves_and_roles() {
    for version in VERSIONS {
        assert_round_trip(&pattern(10.0, 12.0, &FIVE), DxfOptions { version, ..DxfOptions::default() });
    }
}

#[test]
fn arcs_are_bulges_and_come_back_as_round_as_they_were() {
    let pattern = pattern(10.0, 12.0, &[]);
    for version in VERSIONS {
        let text = write_dxf(&pattern, &DxfOptions { version, ..DxfOptions::default() });
        let bulges = lines_of(&text).chunks_exact(2).filter(|pair| pair[0] == "42").count();
        // The text style of R12 and the window of R2000 have a group 42 each; six others are arcs.
        assert!((6..=12).contains(&bulges), "{bulges}: four corners, two halves of the hole");
        let back = read_back(&text);
        assert_same(&pattern.outline, &back.outline, 1e-5);
        assert_same(&pattern.holes[0], &back.holes[0], 1e-5);
    }
}

#[test]
fn layers_are_named_and_coloured_by_role() {
    let mut pattern = pattern(10.0, 12.0, &FIVE);
    pattern.slits.push(PlanarCurve::polyline(&[v(10.0, 10.0), v(20.0, 10.0)]).unwrap());
    let text = write_dxf(&pattern, &DxfOptions::default());
    let lines = lines_of(&text);
    for (layer, colour) in
        [("CUT", "7"), ("SLIT", "3"), ("MOUNTAIN", "1"), ("VALLEY", "5"), ("FLAT", "2"), ("UNASSIGNED", "6")]
    {
        let declared =
            lines.windows(6).any(|w| w[0] == "2" && w[1] == layer && w[4] == "62" && w[5] == colour);
        assert!(declared, "{layer}");
        assert_eq!(
            lines.windows(2).filter(|w| w == &["8", layer]).count(),
            if layer == "CUT" { 2 } else { 1 }
        );
    }
    pattern.creases.clear();
    assert!(!write_dxf(&pattern, &DxfOptions::default()).contains("MOUNTAIN"), "only layers that are used");
}

#[test]
fn the_versions_say_what_they_are() {
    let pattern = pattern(10.0, 12.0, &FIVE);
    let text = |version| write_dxf(&pattern, &DxfOptions { version, ..DxfOptions::default() });
    let [old, new] = VERSIONS.map(text);
    assert!(old.contains("AC1009") && old.contains("POLYLINE\r\n") && !old.contains("LWPOLYLINE"));
    assert!(!old.contains("$INSUNITS") && old.contains("millimetres"));
    assert!(new.contains("AC1015") && new.contains("LWPOLYLINE"));
    assert!(new.contains("$INSUNITS\r\n 70\r\n4\r\n"));
    assert_eq!(new, text(DxfVersion::R2000), "same pattern, same bytes");
}

#[test]
fn a_coarser_tolerance_gives_fewer_vertices() {
    let pattern = pattern(10.0, 12.0, &FIVE);
    let length = |chord_mm| write_dxf(&pattern, &DxfOptions { chord_mm, ..DxfOptions::default() }).len();
    assert!(length(1.0) < length(0.02) && length(0.02) < length(1e-4));
}

fn role() -> impl Strategy<Value = Role> {
    prop_oneof![Just(Role::Mountain), Just(Role::Valley), Just(Role::Unassigned), Just(Role::Flat)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn patterns_round_trip_within_the_chord_tolerance(
        radius in 1.0..40.0,
        hole in 1.0..20.0,
        shapes in prop::collection::vec((role(), [-10.0..10.0, -20.0..20.0]), 0..4),
        old: bool,
        chord_mm in prop_oneof![Just(0.02), Just(0.1), Just(1e-3)],
    ) {
        let version = if old { DxfVersion::R12 } else { DxfVersion::R2000 };
        assert_round_trip(&pattern(radius, hole, &shapes), DxfOptions { version, chord_mm });
    }
}
