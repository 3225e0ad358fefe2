//! Dense polylines as drawing programs export them: rounded, close to other lines, met in the middle of their lines.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use softfold_geometry::{CreasePattern, DVec2, Severity};
use softfold_pattern::{Format, PatternFile, ReadOptions};
use std::f64::consts::{PI, TAU};

const SQUARE: &str = "<path d='M0 0H100V100H0Z' stroke='black'/>";

fn read(body: &str) -> PatternFile {
    let text = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100' fill='none'>{body}</svg>"
    );
    let file = softfold_pattern::read(text.as_bytes(), Format::Svg, "t", &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{e}"));
    file.pattern.check().unwrap();
    file
}

/// A path of points for k from 0 to `n`, written with so many decimals.
fn path(n: u32, decimals: usize, end: &str, stroke: &str, point: impl Fn(f64) -> (f64, f64)) -> String {
    let at = |k: u32| {
        let (x, y) = point(f64::from(k) / f64::from(n));
        format!("{x:.decimals$},{y:.decimals$} ")
    };
    let last = if end.is_empty() { n } else { n - 1 };
    format!("<path d='M{}{end}' stroke='{stroke}'/>", (0..=last).map(at).collect::<String>())
}

fn sharpest(pattern: &CreasePattern, crease: usize) -> f64 {
    let curve = &pattern.creases[crease].curve;
    (0..=1000).map(|k| curve.curvature(curve.length_mm() * f64::from(k) / 1000.0).abs()).fold(0.0, f64::max)
}

#[test]
fn rounding_to_two_decimals_leaves_no_trace_in_the_curvature() {
    let rounded = [
        // Half a wave: 20·(π/100)² at its top.
        (path(200, 2, "", "red", |t| (100.0 * t, 50.0 + 20.0 * (PI * t).sin())), 20.0 * (PI / 100.0).powi(2)),
        (
            path(200, 2, "", "red", |t| (100.0 * t, 50.0 + 20.0 * (TAU * t).sin())),
            20.0 * (TAU / 100.0).powi(2),
        ),
        (
            path(200, 2, "Z", "red", |t| (50.0 + 30.0 * (TAU * t).cos(), 50.0 + 30.0 * (TAU * t).sin())),
            1.0 / 30.0,
        ),
    ];
    for (line, curvature) in rounded {
        let pattern = read(&format!("{SQUARE}{line}")).pattern;
        let segments = pattern.creases[0].curve.segments().len();
        let sharpest = sharpest(&pattern, 0);
        assert!(segments < 12, "{segments} pieces");
        assert!((sharpest / curvature - 1.0).abs() < 0.05, "{sharpest} {curvature}");
    }
}

/// An 18-gon around (50, 50) with a horizontal side at the bottom: a circle through its corners lies up to 0.46 mm
/// outside of it.
fn coarse_circle() -> String {
    let turn = |t: f64| TAU * (t + 0.5 / 18.0);
    path(18, 4, "Z", "red", |t| (50.0 + 30.0 * turn(t).sin(), 50.0 + 30.0 * turn(t).cos()))
}

#[test]
fn a_polyline_stays_as_drawn_where_its_curve_would_cross_another_crease_or_the_outline() {
    let crease = format!("{SQUARE}{}<path id='v' d='M0 79.8H100' stroke='blue'/>", coarse_circle());
    let outline = format!("<path d='M0 0H100V79.8H0Z' stroke='black'/>{}", coarse_circle());
    for (body, what) in [(crease, "'v'"), (outline, "the outline")] {
        let file = read(&body);
        assert_eq!(file.pattern.creases[0].curve.segments().len(), 18, "{:?}", file.issues);
        let told = |i: &&softfold_geometry::Issue| i.message.contains(&format!("would cross {what}"));
        assert_eq!(file.issues.iter().find(told).unwrap().severity, Severity::Warning);
    }
    let alone = read(&format!("{SQUARE}{}", coarse_circle()));
    assert!(alone.pattern.creases[0].curve.segments().len() < 12, "nothing near: a circle");
}

#[test]
fn a_crease_that_ends_between_two_vertices_of_a_smoothed_outline_still_ends_on_it() {
    let turn = |t: f64| TAU * (t + 0.01);
    let outline = path(50, 5, "Z", "black", |t| (50.0 + 50.0 * turn(t).sin(), 50.0 + 50.0 * turn(t).cos()));
    // In the middle of a side, a tenth of a millimetre inside the circle.
    let file = read(&format!("{outline}<path d='M50 50V0.09866' stroke='red'/>"));
    let crease = &file.pattern.creases[0].curve;
    let end = if crease.end(0).distance(DVec2::splat(50.0)) < 1.0 { crease.end(1) } else { crease.end(0) };
    let outline = &file.pattern.outline;
    assert!(outline.segments().len() < 30, "smooth: {}", outline.segments().len());
    assert!(outline.segments().iter().any(|s| s.from() == end), "the outline has a joint at {end}");
}
