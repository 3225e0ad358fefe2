//! Reading and writing SVG: transforms, styles, `use`, units; repairs and their issues; faults and
//! what is said of them; the round trip.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use proptest::prelude::*;
use softfold_geometry::{DVec2, Issue, PlanarCurve, Role, Segment, Severity};
use softfold_pattern::{Format, PatternError, PatternFile, ReadOptions, Refused, write_svg};

const HEAD: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="200mm" height="100mm" viewBox="0 0 200 100" fill="none">"#;
const OUTLINE: &str = r#"<rect id="outline" width="200" height="100" stroke="black"/>"#;

/// A 200 × 100 mm drawing: line 1 the head, line 2 the outline, line 3 and on the body.
fn drawing(body: &str) -> String {
    format!("{HEAD}\n{OUTLINE}\n{body}\n</svg>")
}

fn read_svg(text: &str, name: &str, options: &ReadOptions) -> Result<PatternFile, Box<Refused>> {
    softfold_pattern::read(text.as_bytes(), Format::Svg, name, options)
}

/// What was told beside the tolerances and the ends joined within them.
fn remarks(file: &PatternFile) -> Vec<&Issue> {
    let usual = |i: &&Issue| i.message.contains("are one point") || i.message.contains("to meet others");
    file.issues.iter().filter(|i| !usual(i)).collect()
}

fn read(text: &str) -> PatternFile {
    let file = read_svg(text, "test", &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    file.pattern.check().unwrap();
    file
}

fn refused(text: &str) -> PatternError {
    read_svg(text, "test", &ReadOptions::default()).map(|f| f.pattern.name).unwrap_err().error
}

fn assert_says(said: impl ToString, parts: &[&str]) {
    let said = said.to_string();
    for part in parts {
        assert!(said.contains(part), "'{part}' is not in: {said}");
    }
}

fn warning<'a>(file: &'a PatternFile, part: &str) -> &'a Issue {
    remarks(file)
        .into_iter()
        .find(|i| i.to_string().contains(part))
        .unwrap_or_else(|| panic!("{:#?}", file.issues))
}

fn ends(c: &PlanarCurve) -> [DVec2; 2] {
    [c.point(0.0), c.point(c.length_mm())]
}

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

#[test]
fn a_crease_is_in_mm_with_v_up() {
    let file = read(&drawing(r#"<path id="fold" d="M50 100 L80 0" stroke="red"/>"#));
    assert!(remarks(&file).is_empty(), "{:?}", file.issues);
    let p = &file.pattern;
    assert_eq!((p.name.as_str(), p.holes.len(), p.creases.len()), ("test", 0, 1));
    assert!((p.area_mm2() - 20000.0).abs() < 1e-9);
    let c = &p.creases[0];
    assert_eq!((c.name.as_str(), c.role, c.fold_angle_rad), ("fold", Role::Mountain, None));
    assert_eq!((c.source.element.as_str(), c.source.line), ("fold", Some(3)));
    assert_eq!(ends(&c.curve), [v(50.0, 0.0), v(80.0, 100.0)]);
}

#[test]
fn transforms_styles_classes_and_use_are_resolved() {
    let body = r##"<style>.valley { stroke: #0000ff } #m { stroke: rgb(255,0,0) }</style>
<defs><path id="template" d="M0 0 V100" stroke="blue"/></defs>
<g transform="translate(10 0)"><path class="valley" transform="scale(2 1)" d="M5 0 V100"/></g>
<path id="m" d="M60 0 V100"/>
<g style="stroke:yellow"><path d="M80 0 V100"/></g>
<use href="#template" x="100"/><use xlink:href="#template" x="120"/>
<path d="M0 0 V100" transform="matrix(1 0 0 1 150 0)" style="stroke:#f0f;opacity:1"/>"##;
    let file = read(&drawing(body));
    let found: Vec<_> = file.pattern.creases.iter().map(|c| (c.role, ends(&c.curve)[0].x.round())).collect();
    use Role::{Flat, Mountain, Unassigned, Valley};
    let wanted = [
        (Valley, 20.0),
        (Mountain, 60.0),
        (Flat, 80.0),
        (Valley, 100.0),
        (Valley, 120.0),
        (Unassigned, 150.0),
    ];
    assert_eq!(found, wanted);
    let names: Vec<_> = file.pattern.creases.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["crease-1", "m", "crease-3", "template", "template-2", "crease-6"]);
}

#[test]
fn lines_and_labels_name_elements_without_id() {
    let file = read(&drawing(
        "\n<g>\n  <line x1=\"50\" x2=\"50\" y2=\"100\" stroke=\"red\"/>\n<polyline points=\"80,0 80,100\" stroke=\"blue\"/></g>",
    ));
    let sources: Vec<_> =
        file.pattern.creases.iter().map(|c| (c.source.element.as_str(), c.source.line)).collect();
    assert_eq!(sources, [("line 1", Some(5)), ("polyline 1", Some(6))]);
}

#[test]
fn units_come_from_the_page_then_from_the_caller_then_from_96_dpi() {
    let square = |page: &str| {
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" {page}><rect width="96" height="96" stroke="black" fill="none"/></svg>"#
        )
    };
    let side = |page: &str, unit_mm: Option<f64>| {
        let file = read_svg(&square(page), "t", &ReadOptions { unit_mm, ..ReadOptions::default() }).unwrap();
        (file.pattern.size_mm(), remarks(&file).len())
    };
    for (page, unit_mm, size, notes) in [
        (r#"width="10cm" height="10cm" viewBox="0 0 200 200""#, None, 48.0, 0),
        (r#"width="2in" height="2in" viewBox="0 0 192 192""#, None, 25.4, 0),
        (r#"width="144pt" height="144pt" viewBox="0 0 192 192""#, None, 25.4, 0),
        (r#"width="50.8mm" height="50.8mm""#, None, 25.4, 0),
        (r#"viewBox="0 0 192 192""#, None, 25.4, 1),
        (r#"width="192" height="192px""#, None, 25.4, 1),
        (r#"width="384" height="384" viewBox="0 0 192 192""#, None, 50.8, 1),
        (r#"width="100%" height="100%" viewBox="0 0 192 192""#, Some(2.0), 192.0, 0),
        (r#"width="384" height="384" viewBox="0 0 192 192""#, Some(2.0), 192.0, 0),
        (r#"width="10cm" height="10cm" viewBox="0 0 200 200""#, Some(7.0), 48.0, 0),
    ] {
        let (found, issues) = side(page, unit_mm);
        assert!((found - size).abs() < 1e-9, "{page} {unit_mm:?}: {found}");
        assert_eq!(issues, notes, "{page}");
    }
    assert_says(
        &read(&square(r#"viewBox="0 0 192 192""#)).issues[0],
        &["line 1", "96 pixels an inch", "0.264583 mm"],
    );
}

#[test]
fn lengths_with_units_inside_the_drawing_are_resolved() {
    // A millimetre is 96/25.4 user units, whatever the page's scale.
    let file = read(&drawing(r#"<line x1="10mm" y1="0" x2="10mm" y2="100%" stroke="red"/>"#));
    let x = 10.0 * 96.0 / 25.4;
    assert!(ends(&file.pattern.creases[0].curve)[1].distance(v(x, 0.0)) < 1e-4);
}

#[test]
fn the_view_box_corner_is_moved_to_the_origin() {
    let text = r##"<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="40mm" viewBox="-30 20 80 40"><rect x="-30" y="20" width="80" height="40" stroke="#000" fill="none"/></svg>"##;
    let corners: Vec<DVec2> = read(text).pattern.outline.segments().iter().map(Segment::from).collect();
    assert!(corners.contains(&v(0.0, 0.0)) && corners.contains(&v(80.0, 40.0)), "{corners:?}");
}

#[test]
fn arcs_and_quadratics_stay_exact_curves() {
    let file = read(&drawing(
        r#"<path d="M20 100 A50 50 0 0 1 120 100" stroke="red"/><path d="M130 100 Q160 20 190 100" stroke="blue"/>"#,
    ));
    let [arc, quad] = [0, 1].map(|i| &file.pattern.creases[i].curve);
    for k in 0..=50 {
        let p = arc.point(arc.length_mm() * f64::from(k) / 50.0);
        assert!((p.distance(v(70.0, 0.0)) - 50.0).abs() < 1e-6);
    }
    assert!(quad.point(quad.length_mm() / 2.0).distance(v(160.0, 40.0)) < 1e-9);
}

#[test]
fn fold_angles_come_from_attributes_then_from_opacity() {
    let body = r##"<path d="M20 0V100" stroke="red" opacity="0.5"/>
<path d="M40 0V100" stroke="blue" stroke-opacity="0.25"/>
<path d="M60 0V100" stroke="blue" data-foldAngle="70" opacity="0.5"/>
<path d="M80 0V100" stroke="#888" data-assignment="M" data-foldAngle="-30.5"/>
<path d="M100 0V100" stroke="blue" opacity="1"/>
<path d="M120 0V100" stroke="red" data-foldAngle="40"/>"##;
    let file = read(&drawing(body));
    let angles: Vec<_> = file
        .pattern
        .creases
        .iter()
        .map(|c| c.fold_angle_rad.map(|a| (a.to_degrees() * 1e4).round() / 1e4))
        .collect();
    assert_eq!(angles, [Some(-90.0), Some(45.0), Some(70.0), Some(-30.5), None, Some(-40.0)]);
    assert_says(warning(&file, "wrong sign"), &["line 8", "path 6"]);
}

#[test]
fn unknown_colours_text_and_hidden_lines_are_listed() {
    let body = r##"<path id="dim" d="M20 0V100" stroke="#888888"/>
<text x="3" y="3">note</text>
<path id="bare" d="M40 0V100"/><path d="M50 0V100" stroke="red" display="none"/>"##;
    let file = read(&drawing(body));
    assert!(file.pattern.creases.is_empty());
    assert_says(warning(&file, "#888888"), &["line 3", "'dim' (line 3)"]);
    assert_says(warning(&file, "<text>"), &["line 4", "1 <text> ignored"]);
    assert_says(warning(&file, "visible stroke"), &["'bare' (line 5)"]);
    assert!(file.issues.iter().all(|i| i.severity == Severity::Note));
}

#[test]
fn an_outline_in_pieces_is_chained_and_turned() {
    let text = format!(
        r#"{HEAD}<line x1="0" y1="0" x2="200" y2="0" stroke="black"/><polyline points="0,100 0,0" stroke="black"/>
<path d="M200 100 L0 100" stroke="black"/><path d="M200 0.0005 C 210 30 190 70 200 100" stroke="black"/></svg>"#
    );
    let file = read(&text);
    assert!(file.issues.iter().all(|i| i.severity == Severity::Note), "{:?}", file.issues);
    assert!((file.pattern.area_mm2() - 20000.0).abs() < 0.5);
    assert!(file.pattern.outline.is_closed());
}

#[test]
fn a_small_gap_is_closed_and_told() {
    let text = format!(
        "{HEAD}\n<path id=\"a\" d=\"M0 0 H200 V100\" stroke=\"black\"/>\n<path id=\"b\" d=\"M198.5 100 H0 V0\" stroke=\"black\"/></svg>"
    );
    let file = read(&text);
    let told = warning(&file, "gap");
    assert_eq!(told.severity, Severity::Warning);
    assert_says(told, &["gap of 1.500 mm", "'a' (line 2)", "'b' (line 3)", "(200.000, 0.000) mm"]);
    assert!((file.pattern.area_mm2() - 20000.0).abs() < 1e-6);
}

#[test]
fn holes_are_found_and_turned() {
    let body =
        r#"<circle cx="100" cy="50" r="20" stroke="black"/><path d="M20 20h10v10h-10z" stroke="lime"/>"#;
    let p = read(&drawing(body)).pattern;
    assert_eq!(p.holes.len(), 2);
    let area = 20000.0 - std::f64::consts::PI * 400.0 - 100.0;
    assert!((p.area_mm2() - area).abs() < 1e-4);
}

#[test]
fn loops_that_are_no_holes_are_ignored_and_told() {
    let body = r#"<rect width="200" height="100" stroke="black"/>
<rect x="120" y="20" width="40" height="40" stroke="black"/><rect id="inner" x="130" y="30" width="5" height="5" stroke="black"/>
<rect id="far" x="300" y="30" width="5" height="5" stroke="black"/><path id="slit" d="M10 10 h20" stroke="lime"/>"#;
    let file = read(&drawing(body));
    assert_eq!(file.pattern.holes.len(), 1);
    assert_says(warning(&file, "drawn twice"), &["rect 2", "line 3"]);
    assert_says(warning(&file, "inside a hole"), &["inner", "line 4"]);
    assert_says(warning(&file, "2 sheets"), &["the largest is read", "2 'far' (line 5) of 25.0 mm²"]);
    assert_says(warning(&file, "open cut"), &["1 open cut is a slit"]);
    assert_eq!(ends(&file.pattern.slits[0]), [v(10.0, 90.0), v(30.0, 90.0)]);
}

#[test]
fn ends_near_the_outline_are_led_onto_it() {
    let body = r#"<path id="short" d="M50 1.5 L60 100" stroke="red"/>
<path id="long" d="M100 101.2 C 110 60 110 40 100 0" stroke="blue"/>
<path id="rounded" d="M150 0.0005 V100" stroke="red"/>"#;
    let file = read(&drawing(body));
    for c in &file.pattern.creases {
        for end in ends(&c.curve) {
            let (s, d) = file.pattern.outline.nearest(end);
            assert!(d < 1e-9 && s >= 0.0, "{} {d}", c.name);
        }
    }
    assert_says(warning(&file, "1.500 mm before"), &["short", "line 3", "(50.000, 98.500)"]);
    assert_says(warning(&file, "1.200 mm past"), &["long", "line 4"]);
    assert_eq!(remarks(&file).len(), 2, "{:?}", file.issues);
    // Extended along its own direction.
    assert!(ends(&file.pattern.creases[0].curve)[0].distance(v(50.0 - 1.5 * 10.0 / 98.5, 100.0)) < 1e-9);
}

#[test]
fn creases_that_continue_each_other_are_one() {
    let body = r#"<path id="a" d="M0 50 H80" stroke="red"/><path d="M200 50 H80" stroke="red"/>
<path d="M0 80 H80" stroke="red"/>"#;
    let file = read(&drawing(body));
    assert_eq!(file.pattern.creases.len(), 2);
    assert!((file.pattern.creases[0].curve.length_mm() - 200.0).abs() < 1e-9);
    assert_eq!(file.pattern.creases[0].name, "a");
    assert_says(warning(&file, "continues"), &["a: joined", "'path 2' (line 3)"]);
    assert_says(warning(&file, "ends inside the sheet"), &["path 3", "line 4", "(80.000, 20.000)"]);
}

#[test]
fn creases_off_the_sheet_or_drawn_twice_are_ignored_and_told() {
    let body = r#"<path id="legend" d="M250 0 V20" stroke="red"/>
<path d="M50 0 V100" stroke="red"/><path id="again" d="M50 100 V0" stroke="red"/>"#;
    let file = read(&drawing(body));
    assert_eq!(file.pattern.creases.len(), 1);
    assert_says(warning(&file, "outside the sheet"), &["legend", "line 3"]);
    assert_says(warning(&file, "drawn twice"), &["again", "line 4", "'path 2'"]);
}

#[test]
fn flat_lines_may_touch_creases_and_are_ignored_off_the_sheet() {
    let body = r#"<path d="M0 50 H200" stroke="red"/><path d="M50 0 V50" stroke="yellow"/>"#;
    let file = read(&drawing(body));
    assert_eq!(file.pattern.creases.len(), 2);
    assert!(remarks(&file).is_empty(), "{:?}", file.issues);
    let file = read(&drawing(r#"<path id="ruling" d="M50 50 V-30" stroke="yellow"/>"#));
    assert_eq!(ends(&file.pattern.creases[0].curve), [v(50.0, 50.0), v(50.0, 100.0)]);
    assert_says(warning(&file, "leaves the sheet"), &["ruling", "line 3", "30.000 mm", "(50.000, 100.000)"]);
}

#[test]
fn a_curve_drawn_as_short_lines_is_one_crease() {
    let lines = (0..20).map(|i| {
        let y = |x: f64| 50.0 + 30.0 * (x / 40.0).sin();
        let (a, b) = (10.0 * f64::from(i), 10.0 * f64::from(i + 1));
        format!("<line x1='{a}' y1='{}' x2='{b}' y2='{}' stroke='blue'/>\n", y(a), y(b))
    });
    let text = drawing(&lines.collect::<String>());
    let file = read(&text);
    assert_eq!(file.pattern.creases.len(), 1);
    assert!(file.pattern.creases[0].curve.segments().len() < 8, "few cubics");
    assert_eq!(remarks(&file).len(), 2, "one note for the joints, one for the curve");
    assert!(file.issues.iter().any(|i| i.message.contains("smooth curves")), "{:?}", file.issues);
    let as_drawn = ReadOptions { refit_mm: Some(0.0), ..ReadOptions::default() };
    let file = read_svg(&text, "p", &as_drawn).unwrap();
    assert_eq!(file.pattern.creases[0].curve.segments().len(), 20);
}

#[test]
fn what_is_no_drawing_is_refused_with_its_line() {
    let size = r#"width="10mm" height="10mm""#;
    for (text, parts) in [
        (String::new(), vec!["line 1", "empty"]),
        (" \n ".into(), vec!["line 1", "empty"]),
        ("hello".into(), vec!["line 1", "not XML", "plain SVG"]),
        (
            "<svg xmlns=\"http://www.w3.org/2000/svg\">\n<path d=\"M0 0\">\n</svg>".into(),
            vec!["line 3", "not XML"],
        ),
        ("<!-- a -->\n<html/>".into(), vec!["line 2", "<html>, not <svg>"]),
        (
            format!("{HEAD}</svg>").replace("<svg ", "<svg data-a=\"").replace("xmlns=", "\" xmlns="),
            vec!["nothing is drawn", "black"],
        ),
        (
            format!(
                "\n<svg xmlns=\"http://www.w3.org/2000/svg\" {size}><path d=\"M0 0L5 5\" stroke=\"#ccc\"/></svg>"
            ),
            vec!["line 2", "nothing is drawn"],
        ),
        (
            "\n<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M0 0L5 5\" stroke=\"red\"/></svg>".into(),
            vec!["line 2", "no size", "width and height in mm"],
        ),
        (
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 0 9\"/>".into(),
            vec!["line 1", "no size", "0 0 0 9"],
        ),
        (
            drawing(r#"<path d="M0 50 H200" stroke="red"/>"#).replace(OUTLINE, ""),
            vec!["no outline", "black stroke"],
        ),
    ] {
        assert_says(refused(&text), &parts);
    }
}

#[test]
fn numbers_that_are_none_are_refused_with_element_and_line() {
    for (body, parts) in [
        (r#"<path id="bad" d="M0 NaN L9 9" stroke="red"/>"#, ["bad", "path data cannot be read"]),
        (r#"<path d="M0 0 L1e999 9" stroke="red"/>"#, ["path 1", "path data"]),
        (r#"<line x1="NaN" x2="9" stroke="red"/>"#, ["line 1", "x1 is \"NaN\""]),
        (r#"<polyline points="0,0 inf,9" stroke="red"/>"#, ["polyline 1", "\"inf\", not a finite number"]),
        (r#"<circle r="1e999" stroke="red"/>"#, ["circle 1", "r is"]),
        (r#"<path d="M0 50H200" data-assignment="X" stroke="red"/>"#, ["path 1", "data-assignment is \"X\""]),
        (
            r#"<path d="M0 50H200" data-foldAngle="200" stroke="red"/>"#,
            ["path 1", "data-foldAngle is \"200\""],
        ),
    ] {
        let error = refused(&drawing(body));
        assert!(matches!(error, PatternError::Number(_)), "{error}");
        assert_says(&error, &["line 3: ", parts[0], parts[1]]);
        assert!(!error.issue().mend.is_empty());
    }
}

#[test]
fn an_open_outline_is_refused_with_both_ends() {
    let text = format!("{HEAD}\n<path id=\"rim\" d=\"M0 0 H200 V100 H0 V30\" stroke=\"black\"/></svg>");
    let error = refused(&text);
    assert!(matches!(error, PatternError::Outline(_)));
    assert_says(
        &error,
        &[
            "line 2: rim: ",
            "outline is open",
            "(0.000, 100.000)",
            "(0.000, 70.000)",
            "30.000 mm",
            "close the path",
        ],
    );
    assert_eq!(error.issue().position, Some(v(0.0, 70.0)));
}

#[test]
fn outlines_that_cross_themselves_or_holes_are_refused() {
    let bow = format!("{HEAD}<path d=\"M0 0 L200 100 V0 L0 100Z\" stroke=\"black\"/></svg>");
    assert_says(refused(&bow), &["line 1", "crosses itself", "(100.000, 50.000)"]);
    let hole = drawing(r#"<circle id="bite" cx="200" cy="50" r="20" stroke="black"/>"#);
    assert_says(refused(&hole), &["line 3", "bite", "crosses the boundary 'outline' (line 2)"]);
}

#[test]
fn a_crease_that_leaves_the_sheet_is_refused_where_it_leaves() {
    let error = refused(&drawing(r#"<path id="wild" d="M0 50 H250" stroke="red"/>"#));
    assert!(matches!(error, PatternError::Crease(_)));
    assert_says(&error, &["line 3: wild: ", "leaves the sheet by 50.000 mm", "(200.000, 50.000)", "outline"]);
    let bulge = drawing(r#"<path d="M0 40 C60 -80 140 -80 200 40" stroke="red"/>"#);
    assert_says(refused(&bulge), &["path 1", "leaves the sheet by 50.0", ", 100.000) mm"]);
}

#[test]
fn creases_that_meet_end_in_junctions() {
    let cross = drawing(
        "<path id=\"a\" d=\"M0 50 H200\" stroke=\"red\"/>\n<path id=\"b\" d=\"M70 0 V100\" stroke=\"blue\"/>",
    );
    let p = read(&cross).pattern;
    let names: Vec<_> = p.creases.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["a", "a-2", "b", "b-2"]);
    let [junction] = &p.junctions()[..] else { panic!("one junction") };
    assert_eq!((junction.point, junction.ends.len()), (v(70.0, 50.0), 4));
    let tee = drawing(r#"<path d="M0 50 H200" stroke="red"/><path d="M70 0 V50" stroke="blue"/>"#);
    assert_eq!(read(&tee).pattern.junctions()[0].ends.len(), 3);
    let on_top = drawing(r#"<path d="M0 50 H200" stroke="red"/><path d="M0 50 H200" stroke="blue"/>"#);
    let file = read(&on_top);
    assert_eq!(file.pattern.creases[0].role, Role::Unassigned);
    assert_says(warning(&file, "undecided"), &["path 2", "'path 1' (line 3)"]);
}

#[test]
fn duplicate_ids_stay_apart() {
    let body = r#"<path id="x" d="M50 0 V100" stroke="red"/>
<path id="x" d="M90 0 V100" stroke="blue"/>"#;
    let p = read(&drawing(body)).pattern;
    let found: Vec<_> = p.creases.iter().map(|c| (c.name.as_str(), c.role, c.source.line)).collect();
    assert_eq!(found, [("x", Role::Mountain, Some(3)), ("x-2", Role::Valley, Some(4))]);
}

#[test]
fn a_written_pattern_reads_back_the_same() {
    let body = r#"<circle cx="60" cy="50" r="11" stroke="black"/>
<path id="a &amp; b" d="M110 0 C 90 30 130 60 110 100" stroke="red" data-foldAngle="-72.5"/>
<path d="M150 0 A80 80 0 0 1 150 100" stroke="blue"/><path d="M180 0 V100" stroke="magenta"/>
<path d="M190 0 V100" stroke="yellow"/>"#;
    let first = read(&drawing(body)).pattern;
    let text = write_svg(&first);
    let file = read(&text);
    assert!(remarks(&file).is_empty(), "{:?}", file.issues);
    let second = file.pattern;
    assert_eq!(second.creases.len(), first.creases.len());
    for (a, b) in first.creases.iter().zip(&second.creases) {
        assert_eq!((&a.name, a.role), (&b.name, b.role));
        assert_eq!(a.fold_angle_rad.map(f64::to_degrees), b.fold_angle_rad.map(f64::to_degrees));
        same(&a.curve, &b.curve);
    }
    for ((_, a), (_, b)) in first.loops().zip(second.loops()) {
        assert!((a.signed_area_mm2() - b.signed_area_mm2()).abs() < 1e-3);
    }
    assert_eq!(write_svg(&second), text, "the second writing is the same bytes");
}

fn same(a: &PlanarCurve, b: &PlanarCurve) {
    assert!((a.length_mm() - b.length_mm()).abs() < 1e-5);
    for k in 0..=10 {
        let share = f64::from(k) / 10.0;
        assert!(a.point(share * a.length_mm()).distance(b.point(share * b.length_mm())) < 2e-6);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any crease across the sheet keeps its coordinates through writing and reading.
    #[test]
    fn creases_round_trip(
        x in 5.0..195.0f64, y in 5.0..195.0f64, c1 in (20.0..180.0f64, 20.0..80.0f64), c2 in (20.0..180.0f64, 20.0..80.0f64),
        degrees in -179.0..179.0f64,
    ) {
        let role = if degrees < 0.0 { "M" } else { "V" };
        let body = format!(
            r#"<path d="M{x} 0 C{} {} {} {} {y} 100" stroke="gray" data-assignment="{role}" data-foldAngle="{degrees}"/>"#,
            c1.0, c1.1, c2.0, c2.1,
        );
        let first = read(&drawing(&body)).pattern;
        let second = read(&write_svg(&first)).pattern;
        same(&first.creases[0].curve, &second.creases[0].curve);
        prop_assert!((second.creases[0].fold_angle_rad.unwrap().to_degrees() - degrees).abs() < 1e-6);
    }

    /// Text of any kind gives an error, never a panic.
    #[test]
    fn noise_is_refused(noise in "[ -~\n]{0,80}") {
        let _ = read_svg(&noise, "t", &ReadOptions::default()).is_err();
        let _ = read_svg(&drawing(&noise), "t", &ReadOptions::default()).is_err();
        let d = format!("<path d='{}' stroke='red'/>", noise.replace(['<', '&', '\''], " "));
        let _ = read_svg(&drawing(&d), "t", &ReadOptions::default()).is_err();
    }
}

#[test]
fn clips_are_told_because_what_they_hide_is_read() {
    let file = read(&drawing(
        "<clipPath id='c'><rect width='10' height='10'/></clipPath>\n<path d='M50 0V100' stroke='red' clip-path='url(#c)'/>",
    ));
    assert_says(warning(&file, "clipped or masked"), &["line 4", "1 clipped"]);
}
