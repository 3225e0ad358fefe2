//! The example of library use, run as a user runs it.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "../crates/softfold/examples/fold_arc.rs"]
#[allow(dead_code, reason = "its main is called with another path")]
mod fold_arc;

/// Most lines of the whole use.
const LINES: usize = 60;

#[test]
fn an_arc_is_folded_from_code_in_less_than_60_lines() {
    let source = include_str!("../crates/softfold/examples/fold_arc.rs");
    assert!(source.lines().count() < LINES, "{} lines", source.lines().count());
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("fold_arc.obj");
    fold_arc::run(&path).expect("a folded sheet");
    let text = std::fs::read_to_string(&path).expect("the file");
    let heights = text.lines().filter_map(|l| l.strip_prefix("v ")).map(|l| {
        let depth = l.split_whitespace().nth(1).expect("three coordinates");
        depth.parse::<f64>().expect("a number")
    });
    let (low, high) = heights.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
    assert!(text.contains("relative gradient below") && high - low > 20.0, "folded by {} mm", high - low);
    assert!(text.lines().filter(|l| l.starts_with("f ")).count() > 300);
}
