//! Random messy drawings: what holds of every pattern.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use proptest::prelude::*;
use softfold_geometry::{CreasePattern, DVec2, PlanarCurve, Role, Segment, polygon};
use softfold_pattern::{Format, PatternFile, ReadOptions};

/// The join tolerance of a sheet of 200 mm.
const JOIN_MM: f64 = 0.002;
/// What nodes and curves may be off: ends move by a few join tolerances where several lines nearly meet.
const SLACK_MM: f64 = 10.0 * JOIN_MM;

/// A stroke: its colour, and the points of a polyline, or the control points of a cubic.
#[derive(Clone, Debug)]
struct Drawn {
    colour: &'static str,
    points: Vec<DVec2>,
    curved: bool,
}

impl Drawn {
    fn svg(&self) -> String {
        let p = |p: &DVec2| format!("{} {}", p.x, p.y);
        let d: Vec<String> = self.points.iter().map(p).collect();
        let rest =
            if self.curved { format!("C{}", d[1..].join(" ")) } else { format!("L{}", d[1..].join(" L")) };
        format!("<path d=\"M{} {rest}\" stroke=\"{}\"/>\n", d[0], self.colour)
    }
}

fn page(strokes: &[Drawn]) -> String {
    let head = r#"<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100" fill="none"><path d="M0 0H200V100H0Z" stroke="black"/>"#;
    format!("{head}{}</svg>", strokes.iter().map(Drawn::svg).collect::<String>())
}

fn read(strokes: &[Drawn], options: &ReadOptions) -> PatternFile {
    let text = page(strokes);
    let file = softfold_pattern::read(text.as_bytes(), Format::Svg, "t", options);
    let file = file.unwrap_or_else(|e| panic!("{e}\n{text}"));
    file.pattern.check().unwrap();
    file
}

/// Points anywhere, on a coarse grid, or near it: crossings, touches, repetitions, gaps.
fn place() -> impl Strategy<Value = DVec2> {
    let free = (0.0..200.0f64, 0.0..100.0f64);
    let grid = (0..=10i32, 0..=5i32).prop_map(|(x, y)| (20.0 * f64::from(x), 20.0 * f64::from(y)));
    let near = ((0..=10i32, 0..=5i32), -0.004..0.004f64, -1.5..1.5f64).prop_map(|((x, y), dx, dy)| {
        let inside = |v: f64, end: f64| v.clamp(0.0, end);
        (inside(20.0 * f64::from(x) + dx, 200.0), inside(20.0 * f64::from(y) + dy, 100.0))
    });
    prop_oneof![2 => free, 3 => grid, 1 => near].prop_map(DVec2::from)
}

fn free_place() -> impl Strategy<Value = DVec2> {
    (1.0..199.0f64, 1.0..99.0f64).prop_map(DVec2::from)
}

fn stroke(place: impl Strategy<Value = DVec2> + Clone) -> impl Strategy<Value = Drawn> {
    let colour = prop_oneof![3 => Just("red"), 3 => Just("blue"), 1 => Just("magenta"), 1 => Just("yellow")];
    let line = proptest::collection::vec(place.clone(), 2..5).prop_map(|p| (p, false));
    let curve = proptest::collection::vec(place, 4).prop_map(|p| (p, true));
    (colour, prop_oneof![line, curve]).prop_map(|(colour, (points, curved))| Drawn { colour, points, curved })
}

fn messy() -> impl Strategy<Value = Vec<Drawn>> {
    proptest::collection::vec(stroke(place().boxed()), 1..12)
}

/// Chords of a crease with its ends left out: what may not touch another crease.
fn inner_chords(c: &PlanarCurve) -> Vec<[DVec2; 2]> {
    let points = c.flatten(0.5 * JOIN_MM);
    let chords = points.windows(2).map(|w| [w[0], w[1]]);
    let ends = [c.end(0), c.end(1)];
    let free = |p: DVec2| c.is_closed() || ends.iter().all(|e| e.distance(p) > SLACK_MM);
    chords.filter(|[a, b]| free(*a) || free(*b)).collect()
}

/// Depth of the lens between two curves from where they cross to an end that they share: within the tolerance they
/// are one line there.
fn lens_mm(a: &PlanarCurve, b: &PlanarCurve, at: DVec2) -> f64 {
    let (from, _) = a.nearest(at);
    let shared = (0..2).filter(|s| (0..2).any(|o| b.end(o) == a.end(*s)));
    let depth = |side: usize| {
        let to = if side == 0 { 0.0 } else { a.length_mm() };
        let points = (0..=50).map(|k| a.point(from + (to - from) * f64::from(k) / 50.0));
        points.map(|p| b.nearest(p).1).fold(0.0, f64::max)
    };
    shared.map(depth).fold(f64::INFINITY, f64::min)
}

fn assert_meet_at_ends(pattern: &CreasePattern) {
    let folding: Vec<_> = pattern.creases.iter().filter(|c| c.role != Role::Flat).collect();
    let chords: Vec<_> = folding.iter().map(|c| inner_chords(&c.curve)).collect();
    for (i, a) in chords.iter().enumerate() {
        for (k, b) in chords.iter().enumerate().skip(i + 1) {
            for [[a0, a1], [b0, b1]] in a.iter().flat_map(|p| b.iter().map(move |q| [*p, *q])) {
                let Some((t, _)) = polygon::segment_crossing(a0, a1, b0, b1) else { continue };
                let at = a0.lerp(a1, t);
                let at_end = |c: usize| (0..2).any(|s| folding[c].curve.end(s).distance(at) <= SLACK_MM);
                let one = lens_mm(&folding[i].curve, &folding[k].curve, at) <= JOIN_MM;
                assert!(
                    one || (at_end(i) && at_end(k)),
                    "{} and {} cross at {at}",
                    folding[i].name,
                    folding[k].name
                );
            }
        }
    }
    for c in folding.iter().filter(|c| !c.curve.is_closed()) {
        for p in [c.curve.end(0), c.curve.end(1)] {
            for o in folding.iter().filter(|o| o.curve.nearest(p).1 <= 0.5 * JOIN_MM) {
                let meets = (0..2).any(|s| o.curve.end(s) == p);
                assert!(meets, "{} ends on {} at {p}, not at its end", c.name, o.name);
            }
        }
    }
}

fn assert_inside(pattern: &CreasePattern) {
    for c in &pattern.creases {
        for p in c.curve.flatten(0.1) {
            let out = (p - p.clamp(DVec2::ZERO, DVec2::new(200.0, 100.0))).length();
            assert!(out <= SLACK_MM, "{} is {out} mm outside", c.name);
        }
    }
}

/// Creases without names and order: kind, ends, length and middle, rounded.
fn geometry(pattern: &CreasePattern) -> Vec<(Role, [[i64; 2]; 3], i64)> {
    let round = |x: f64| (x * 1e6).round() as i64;
    let point = |p: DVec2| [round(p.x), round(p.y)];
    let mut all: Vec<_> = pattern
        .creases
        .iter()
        .map(|c| {
            let length = c.curve.length_mm();
            let mut ends = [point(c.curve.end(0)), point(c.curve.end(1))];
            ends.sort_unstable();
            let middle = c.curve.point(0.5 * length);
            let [a, b] = ends;
            (c.role, [a, b, if c.curve.is_closed() { a } else { point(middle) }], round(length))
        })
        .collect();
    all.sort();
    all
}

fn drawn_length(strokes: &[Drawn]) -> f64 {
    let segments = |d: &Drawn| match (&d.points[..], d.curved) {
        ([from, c1, c2, to], true) => vec![Segment::Cubic { from: *from, c1: *c1, c2: *c2, to: *to }],
        (p, _) => p.windows(2).map(|w| Segment::Line { from: w[0], to: w[1] }).collect(),
    };
    let length = |d: &Drawn| PlanarCurve::new(segments(d)).map_or(0.0, |c| c.length_mm());
    strokes.iter().map(length).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Creases meet at their ends alone, ends that meet are equal, and nothing is off the sheet.
    #[test]
    fn creases_meet_at_their_ends_inside_the_sheet(strokes in messy()) {
        let pattern = read(&strokes, &ReadOptions::default()).pattern;
        assert_meet_at_ends(&pattern);
        assert_inside(&pattern);
    }

    /// The same file gives the same pattern and says the same, and the order of its strokes matters to names alone.
    #[test]
    fn the_order_of_the_file_does_not_matter_to_the_geometry(strokes in messy()) {
        let first = read(&strokes, &ReadOptions::default());
        prop_assert_eq!(&first, &read(&strokes, &ReadOptions::default()));
        let mut turned = strokes.clone();
        turned.reverse();
        let second = read(&turned, &ReadOptions::default());
        prop_assert_eq!(geometry(&first.pattern), geometry(&second.pattern));
    }

    /// Where no gap is closed and nothing lies on something else, no length is lost.
    #[test]
    fn no_length_is_lost(strokes in proptest::collection::vec(stroke(free_place().boxed()), 1..10)) {
        let options = ReadOptions { refuse_mm: Some(JOIN_MM), ..ReadOptions::default() };
        let file = read(&strokes, &options);
        prop_assume!(file.issues.iter().all(|i| ["it lies on", "over itself"].iter().all(|m| !i.message.contains(m))));
        let pattern = file.pattern;
        let found: f64 = pattern.creases.iter().map(|c| c.curve.length_mm()).sum();
        let slack = 4.0 * JOIN_MM * (pattern.creases.len() + strokes.len()) as f64;
        prop_assert!((found - drawn_length(&strokes)).abs() <= slack, "{found} of {}", drawn_length(&strokes));
    }

    /// A sheet of random cuts and boundaries keeps its contract, or is refused in words.
    #[test]
    fn rims_of_any_kind_keep_the_contract(
        rims in proptest::collection::vec((stroke(place().boxed()), any::<bool>()), 1..10),
        folds in proptest::collection::vec(stroke(place().boxed()), 0..4),
    ) {
        let coloured = |(d, cut): (Drawn, bool)| Drawn { colour: if cut { "lime" } else { "black" }, ..d };
        let strokes: Vec<Drawn> = rims.into_iter().map(coloured).chain(folds).collect();
        match softfold_pattern::read(page(&strokes).as_bytes(), Format::Svg, "t", &ReadOptions::default()) {
            Ok(file) => {
                file.pattern.check().unwrap();
                prop_assert!(file.pattern.area_mm2() > 0.0);
                assert_inside(&file.pattern);
            }
            Err(e) => prop_assert!(!e.error.issue().message.is_empty()),
        }
    }
}
