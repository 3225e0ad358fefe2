//! Drawings as they come to patterns: crossings, gaps, repetitions, sheets, holes, slits, outlines, corners.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use softfold_geometry::{Crease, DVec2, Issue, PlanarCurve, Role, Severity};
use softfold_pattern::{Format, Outline, PatternError, PatternFile, ReadOptions, Refused};

const OUTLINE: &str = r#"<path id="outline" d="M0 0H200V100H0Z" stroke="black"/>"#;

/// A 200 × 100 mm page with u to the right and v up, so that paths are written as they lie on the sheet; the body
/// begins on line 2.
fn page(body: &str) -> String {
    let head = r#"<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100" fill="none"><g transform="matrix(1 0 0 -1 0 100)">"#;
    format!("{head}\n{body}\n</g></svg>")
}

/// The page with its outline on line 2; the body begins on line 3.
fn sheet(body: &str) -> String {
    page(&format!("{OUTLINE}\n{body}"))
}

fn try_read(text: &str, options: &ReadOptions) -> Result<PatternFile, Box<Refused>> {
    softfold_pattern::read(text.as_bytes(), Format::Svg, "test", options)
}

fn read_with(text: &str, options: &ReadOptions) -> PatternFile {
    let file = try_read(text, options).unwrap_or_else(|e| panic!("{e}"));
    file.pattern.check().unwrap();
    file
}

fn read(text: &str) -> PatternFile {
    read_with(text, &ReadOptions::default())
}

fn refused(text: &str) -> Box<Refused> {
    try_read(text, &ReadOptions::default()).unwrap_err()
}

/// The only issue that says this.
fn told<'a>(issues: &'a [Issue], severity: Severity, parts: &[&str]) -> &'a Issue {
    let says = |i: &&Issue| i.severity == severity && parts.iter().all(|p| i.to_string().contains(p));
    let found: Vec<&Issue> = issues.iter().filter(says).collect();
    let [only] = found[..] else { panic!("{parts:?} is told {} times in {issues:#?}", found.len()) };
    only
}

fn warned<'a>(file: &'a PatternFile, parts: &[&str]) -> &'a Issue {
    told(&file.issues, Severity::Warning, parts)
}

fn noted<'a>(file: &'a PatternFile, parts: &[&str]) -> &'a Issue {
    told(&file.issues, Severity::Note, parts)
}

fn warnings(file: &PatternFile) -> Vec<&Issue> {
    file.issues.iter().filter(|i| i.severity > Severity::Note).collect()
}

fn names(file: &PatternFile) -> Vec<&str> {
    file.pattern.creases.iter().map(|c| c.name.as_str()).collect()
}

fn named<'a>(file: &'a PatternFile, name: &str) -> &'a Crease {
    file.pattern.creases.iter().find(|c| c.name == name).unwrap_or_else(|| panic!("{:?}", names(file)))
}

fn ends(c: &PlanarCurve) -> [DVec2; 2] {
    [c.end(0), c.end(1)]
}

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

#[test]
fn curves_that_cross_are_cut_exactly_on_both() {
    let a = "M0 20 C60 120 140 -40 200 80";
    let b = "M60 0 C20 60 120 40 90 100";
    let body = format!(r#"<path id="a" d="{a}" stroke="red"/><path id="b" d="{b}" stroke="blue"/>"#);
    let file = read(&sheet(&body));
    assert_eq!(names(&file), ["a", "a-2", "b", "b-2"]);
    let whole =
        |d: &str| read(&sheet(&format!(r#"<path d="{d}" stroke="red"/>"#))).pattern.creases[0].curve.clone();
    for (name, whole) in [("a", whole(a)), ("b", whole(b))] {
        let parts = [named(&file, name), named(&file, &format!("{name}-2"))];
        let length: f64 = parts.iter().map(|p| p.curve.length_mm()).sum();
        assert!((length - whole.length_mm()).abs() < 1e-9 * length, "{length}");
        for part in parts {
            for k in 0..=20 {
                let p = part.curve.point(part.curve.length_mm() * f64::from(k) / 20.0);
                assert!(whole.nearest(p).1 < 1e-9, "{name} {p}");
            }
        }
    }
    let [junction] = &file.pattern.junctions()[..] else { panic!("one junction") };
    assert_eq!(junction.ends.len(), 4);
    assert!(warnings(&file).is_empty());
}

#[test]
fn curves_may_cross_more_than_once() {
    let body = r#"<path id="a" d="M0 50 C50 130 50 -30 100 50 C150 130 150 -30 200 50" stroke="red"/>
<path id="b" d="M0 40 C50 40 150 55 200 60" stroke="blue"/>"#;
    let p = read(&sheet(body)).pattern;
    let junctions = p.junctions();
    assert_eq!(junctions.len(), 3);
    assert!(junctions.iter().all(|j| j.ends.len() == 4));
}

#[test]
fn a_loop_of_one_cubic_crosses_itself_in_a_junction() {
    let p = read(&sheet(r#"<path id="a" d="M60 0 C240 120 -40 120 140 0" stroke="red"/>"#)).pattern;
    let junctions = p.junctions();
    let [junction, _] = &junctions[..] else { panic!("{junctions:?}") };
    assert!((junction.point.x - 100.0).abs() < 1e-9);
    assert_eq!((junction.ends.len(), p.creases.len()), (4, 4));
}

#[test]
fn an_end_on_a_crease_is_moved_onto_it_and_the_crease_stays() {
    let body = r#"<path id="through" d="M0 50 H200" stroke="red"/><path id="tee" d="M70 0 V50.0015" stroke="blue"/>"#;
    let file = read(&sheet(body));
    assert_eq!(ends(&named(&file, "tee").curve), [v(70.0, 0.0), v(70.0, 50.0)]);
    assert_eq!(file.pattern.junctions()[0].ends.len(), 3);
    assert!(warnings(&file).is_empty());
    noted(&file, &["1 end was moved by less than 0.002 mm"]);
}

#[test]
fn a_gap_between_creases_is_closed_and_told() {
    let body = r#"<path id="a" d="M0 50 H99" stroke="red"/>
<path id="b" d="M200 51 H100" stroke="red"/>"#;
    let file = read(&sheet(body));
    warned(
        &file,
        &["line 3: a: ", "gap of 1.414 mm between 'a' (line 3) and 'b' (line 4)", "(99.000, 50.000)"],
    );
    assert_eq!(names(&file), ["a"], "they continue each other");
    assert_eq!(ends(&file.pattern.creases[0].curve), [v(0.0, 50.0), v(200.0, 51.0)]);
}

#[test]
fn a_gap_before_a_crease_is_closed_along_the_end_s_own_direction() {
    let body = r#"<path d="M0 50 H200" stroke="red"/>
<path id="short" d="M60 0 L69 45 L69.8 49" stroke="blue"/>"#;
    let file = read(&sheet(body));
    warned(&file, &["line 4: short: ", "ended 1.000 mm before 'path 2' (line 3)", "(69.800, 49.000)"]);
    assert!(named(&file, "short").curve.end(1).distance(v(70.0, 50.0)) < 1e-9);
    assert_eq!(file.pattern.junctions().len(), 1);
}

#[test]
fn a_wider_gap_is_left_and_told() {
    let file =
        read(&sheet(r#"<path d="M0 50 H200" stroke="red"/><path id="short" d="M70 0 V47" stroke="blue"/>"#));
    warned(&file, &["short: ", "ends inside the sheet", "(70.000, 47.000)"]);
    assert!(file.pattern.junctions().is_empty());
    let options = ReadOptions { refuse_mm: Some(4.0), ..ReadOptions::default() };
    let body = r#"<path d="M0 50 H200" stroke="red"/><path id="short" d="M70 0 V47" stroke="blue"/>"#;
    assert_eq!(read_with(&sheet(body), &options).pattern.junctions().len(), 1);
}

#[test]
fn a_gap_beside_a_short_tick_is_left() {
    let file = read(&sheet(r#"<path d="M0 50 H200" stroke="red"/><path d="M70 47 V49" stroke="blue"/>"#));
    assert_eq!(file.pattern.creases[1].curve.length_mm(), 2.0);
}

#[test]
fn an_overshoot_is_trimmed_and_told() {
    let body = r#"<path id="a" d="M0 50 H200" stroke="red"/>
<path id="b" d="M70 0 V51.5" stroke="blue"/>"#;
    let file = read(&sheet(body));
    warned(&file, &["line 4: b: ", "ran 1.500 mm past 'a' (line 3)", "(70.000, 51.500)"]);
    assert_eq!(names(&file), ["a", "a-2", "b"]);
    assert_eq!(ends(&named(&file, "b").curve), [v(70.0, 0.0), v(70.0, 50.0)]);
}

#[test]
fn lines_that_miss_one_point_by_rounding_meet_in_one() {
    let body = r#"<path d="M0 0.003 L200 100" stroke="red"/><path d="M0 100 L200 0" stroke="red"/>
<path d="M100.003 0 V100" stroke="blue"/><path d="M0 50.002 H200" stroke="blue"/>"#;
    let p = read(&sheet(body)).pattern;
    let [junction] = &p.junctions()[..] else { panic!("{:#?}", p.junctions()) };
    assert_eq!((junction.ends.len(), p.creases.len()), (8, 8));
}

#[test]
fn what_is_drawn_twice_is_one() {
    let body = r#"<path id="a" d="M50 0 C50 40 70 60 60 100" stroke="red"/>
<path id="b" d="M60 100 C70 60 50 40 50 0" stroke="red"/>"#;
    let file = read(&sheet(body));
    assert_eq!(names(&file), ["a"]);
    noted(&file, &["line 4: b: ", "drawn twice, first as 'a' (line 3)"]);
    assert!(warnings(&file).is_empty());
}

#[test]
fn a_partial_overlap_is_merged_and_told() {
    let body = r#"<path id="a" d="M0 50 H120" stroke="red"/>
<path id="b" d="M80 50 H200" stroke="red"/>"#;
    let file = read(&sheet(body));
    assert_eq!(names(&file), ["a"]);
    assert_eq!(named(&file, "a").curve.length_mm(), 200.0);
    warned(&file, &["line 4: b: ", "over 40.000 mm it lies on 'a' (line 3)", "(100.000, 50.000)"]);
}

#[test]
fn arcs_of_one_circle_that_overlap_are_merged() {
    let body = r#"<path id="a" d="M50 0 A50 50 0 0 1 100 50 A50 50 0 0 1 50 100" stroke="red"/>
<path id="b" d="M85.35533905932738 14.644660940672622 A50 50 0 0 1 85.35533905932738 85.35533905932738" stroke="red"/>"#;
    let file = read(&sheet(body));
    assert_eq!(names(&file), ["a"]);
    assert!((named(&file, "a").curve.length_mm() - 50.0 * std::f64::consts::PI).abs() < 1e-3);
}

#[test]
fn a_mountain_on_a_valley_is_undecided_where_they_lie_on_each_other() {
    let body = r#"<path id="a" d="M0 50 H120" stroke="red"/>
<path id="b" d="M80 50 H200" stroke="blue"/>"#;
    let file = read(&sheet(body));
    let found: Vec<_> =
        file.pattern.creases.iter().map(|c| (c.name.as_str(), c.role, c.curve.length_mm())).collect();
    let wanted = [("a", Role::Mountain, 80.0), ("a-2", Role::Unassigned, 40.0), ("b", Role::Valley, 80.0)];
    assert_eq!(found, wanted);
    warned(&file, &["line 4: b: ", "40.000 mm", "'a' (line 3)", "undecided", "(100.000, 50.000)"]);
}

#[test]
fn different_fold_angles_on_one_line_are_undecided() {
    let body = r#"<path d="M0 50 H200" stroke="red" data-foldAngle="-90"/>
<path id="b" d="M0 50 H200" stroke="red" data-foldAngle="-80"/>"#;
    let file = read(&sheet(body));
    let c = &file.pattern.creases[0];
    assert_eq!((c.role, c.fold_angle_rad), (Role::Unassigned, None));
    warned(&file, &["line 4: b: ", "undecided"]);
}

#[test]
fn boundaries_win_over_creases_and_creases_over_flat_lines() {
    let body = r#"<path id="edge" d="M0 0 H200" stroke="red"/>
<path id="flat" d="M50 0 V100" stroke="yellow"/><path id="fold" d="M50 0 V100" stroke="blue"/>"#;
    let file = read(&sheet(body));
    assert_eq!(names(&file), ["fold"]);
    assert_eq!(file.pattern.creases[0].role, Role::Valley);
    noted(&file, &["edge: ", "200.000 mm", "'outline' (line 2)", "boundary wins"]);
    noted(&file, &["fold: ", "'flat' (line 4)", "as the folded crease it wins"]);
    assert!(warnings(&file).is_empty());
}

const SHEETS: &str = r#"<path id="small" d="M0 0H50V50H0Z" stroke="black"/>
<path id="large" d="M60 0H160V60H60Z" stroke="black"/><path id="mid" d="M0 60H50V115H0Z" stroke="black"/>
<path id="s" d="M0 20H50" stroke="red"/><path id="l" d="M60 20H160" stroke="red"/>"#;

#[test]
fn the_largest_of_several_sheets_is_read_and_the_others_are_told() {
    let file = read(&page(SHEETS));
    assert_eq!((file.pattern.area_mm2(), names(&file)), (6000.0, vec!["l"]));
    warned(
        &file,
        &[
            "3 sheets",
            "the largest is read",
            "2 'mid' (line 3) of 2750.0 mm² around (25.000, 87.500)",
            "3 'small'",
        ],
    );
    assert_eq!(warnings(&file).len(), 1, "creases of other sheets are theirs");
}

#[test]
fn a_sheet_can_be_chosen_by_its_number() {
    let choose =
        |sheet| try_read(&page(SHEETS), &ReadOptions { sheet: Some(sheet), ..ReadOptions::default() });
    let file = choose(3).unwrap();
    assert_eq!((file.pattern.area_mm2(), names(&file)), (2500.0, vec!["s"]));
    assert!(warnings(&file).is_empty());
    for number in [0, 4] {
        let error = choose(number).unwrap_err();
        assert!(matches!(error.error, PatternError::Outline(_)));
        told(
            &error.issues,
            Severity::Error,
            &["holds 3 sheets", &format!("no number {number}"), "from 1 to 3"],
        );
    }
}

#[test]
fn closed_boundaries_and_cuts_inside_are_holes_and_what_lies_in_them_is_told() {
    let body = r#"<path d="M20 20h20v20h-20z" stroke="black"/><path d="M60 20h20l-10 20z" stroke="lime"/>
<path id="lost" d="M25 30 H35" stroke="red"/><path id="away" d="M250 30 H300" stroke="red"/>"#;
    let file = read(&sheet(body));
    assert_eq!(file.pattern.holes.len(), 2);
    assert_eq!(file.pattern.area_mm2(), 20000.0 - 400.0 - 200.0);
    assert!(file.pattern.creases.is_empty());
    warned(&file, &["inside a hole", "'lost' (line 4)"]);
    warned(&file, &["outside the sheet", "'away' (line 4)"]);
}

#[test]
fn a_crease_across_a_hole_ends_on_it() {
    let body = r#"<path d="M80 30h40v40h-40z" stroke="black"/><path id="a" d="M0 50 H200" stroke="red"/>"#;
    let file = read(&sheet(body));
    assert_eq!(names(&file), ["a", "a-2"]);
    assert_eq!(ends(&named(&file, "a").curve), [v(0.0, 50.0), v(80.0, 50.0)]);
    warned(&file, &["a: ", "across a hole", "(80.000, 50.000)"]);
}

#[test]
fn open_cuts_are_slits_and_creases_end_on_them() {
    let body = r#"<path id="slit" d="M80 20 V50 L90 80" stroke="lime"/><path d="M30 0 V30 H40" stroke="lime"/>
<path id="a" d="M0 40 H200" stroke="red"/>"#;
    let file = read(&sheet(body));
    let slits: Vec<_> = file.pattern.slits.iter().map(ends).collect();
    assert_eq!(slits, [[v(80.0, 20.0), v(90.0, 80.0)], [v(30.0, 0.0), v(40.0, 30.0)]]);
    assert_eq!(names(&file), ["a", "a-2"]);
    assert_eq!(ends(&named(&file, "a-2").curve), [v(80.0, 40.0), v(200.0, 40.0)]);
    noted(&file, &["2 open cuts are slits"]);
    assert!(warnings(&file).is_empty());
}

#[test]
fn branching_cuts_are_slits_between_their_nodes() {
    let body = r#"<path d="M50 50 H100" stroke="lime"/><path d="M100 50 L120 70" stroke="lime"/><path d="M100 50 L120 30" stroke="lime"/>"#;
    assert_eq!(read(&sheet(body)).pattern.slits.len(), 3);
    let cross = r#"<path d="M50 50 H100" stroke="lime"/><path d="M70 30 V70" stroke="lime"/>"#;
    assert_eq!(read(&sheet(cross)).pattern.slits.len(), 4);
}

#[test]
fn boundary_lines_inside_are_slits_and_those_that_split_the_sheet_are_told() {
    let body = r#"<path id="open" d="M20 20 V50" stroke="black"/>
<path id="chord" d="M100 0 V100" stroke="black"/>"#;
    let file = read(&sheet(body));
    assert_eq!((file.pattern.slits.len(), file.pattern.area_mm2()), (2, 20000.0));
    warned(&file, &["line 3: open: ", "closes no loop"]);
    warned(&file, &["line 4: chord: ", "closes no loop"]);
    warned(&file, &["line 4: chord: ", "splits the sheet"]);
}

#[test]
fn boundary_cells_that_share_the_outline_are_no_holes() {
    let cells = r#"<path d="M0 0H100V100H0Z" stroke="black"/><path d="M100 0H200V100H100Z" stroke="black"/>"#;
    let file = read(&page(cells));
    assert_eq!(
        (file.pattern.area_mm2(), file.pattern.holes.len(), file.pattern.slits.len()),
        (20000.0, 0, 1)
    );
    warned(&file, &["splits the sheet"]);
}

#[test]
fn closed_cuts_alone_are_the_outline() {
    let body = r#"<path id="rim" d="M0 0H200V100H0Z" stroke="lime"/><path d="M20 20h20v20h-20z" stroke="lime"/>
<path d="M60 20 h20" stroke="lime"/><path id="a" d="M100 0 V100" stroke="red"/>"#;
    let file = read(&page(body));
    assert_eq!(
        (file.pattern.area_mm2(), file.pattern.holes.len(), file.pattern.slits.len()),
        (19600.0, 1, 1)
    );
    assert_eq!(names(&file), ["a"]);
    assert!(warnings(&file).is_empty());
}

/// Creases without outline: a plus sign and the square around its ends is not drawn.
const PLUS: &str =
    r#"<path id="a" d="M0 50 H200" stroke="red"/><path id="b" d="M100 0 V100" stroke="blue"/>"#;

#[test]
fn without_outline_the_mends_are_offered_with_their_areas() {
    let error = refused(&page(PLUS));
    assert!(matches!(error.error, PatternError::Outline(_)));
    told(&error.issues, Severity::Error, &["no outline", "outline = \"hull\" (10000.0 mm²)"]);
    let notched = r#"<path d="M0 0 H200 V100 H120 V50 H80 V100 H0 Z" stroke="red"/><path d="M0 20 H200" stroke="blue"/>"#;
    let error = refused(&page(notched));
    told(&error.issues, Severity::Error, &["\"hull\" (20000.0 mm²)", "\"lines\" (18000.0 mm²)"]);
    let bare = refused(&page(r#"<path d="M0 0H200V100Z" stroke="red"/>"#));
    told(&bare.issues, Severity::Error, &["no outline", "\"lines\" (10000.0 mm²)"]);
}

#[test]
fn the_hull_is_the_outline_if_asked_for() {
    let options = ReadOptions { outline: Outline::Hull, ..ReadOptions::default() };
    let file = read_with(&page(PLUS), &options);
    assert!((file.pattern.area_mm2() - 10000.0).abs() < 1e-9);
    assert_eq!(names(&file), ["a", "a-2", "b", "b-2"]);
    warned(&file, &["convex hull"]);
    let round = r#"<circle cx="100" cy="50" r="40" stroke="red"/><path d="M60 50 H140" stroke="blue"/>"#;
    let file = read_with(&page(round), &options);
    assert!((file.pattern.area_mm2() - 1600.0 * std::f64::consts::PI).abs() < 0.5);
    assert_eq!(file.pattern.creases.len(), 1, "the circle became the outline");
}

#[test]
fn the_outermost_lines_are_the_outline_if_asked_for() {
    let options = ReadOptions { outline: Outline::Lines, ..ReadOptions::default() };
    let body = r#"<path id="rim" d="M0 0 H200 V100 H120 V50 H80 V100 H0 Z" stroke="red"/><path id="a" d="M0 20 H200" stroke="blue"/>"#;
    let file = read_with(&page(body), &options);
    assert_eq!((file.pattern.area_mm2(), names(&file)), (18000.0, vec!["a"]));
    warned(&file, &["outermost lines", "'rim' (line 2)"]);
    let error = try_read(&page(PLUS), &options).unwrap_err();
    told(&error.issues, Severity::Error, &["enclose nothing"]);
}

#[test]
fn a_convex_outline_in_crease_colours_is_taken_and_told() {
    let body =
        r#"<path id="rim" d="M0 0H200V100H0Z" stroke="red"/><path id="a" d="M0 20 H200" stroke="blue"/>"#;
    let file = read(&page(body));
    assert_eq!((file.pattern.area_mm2(), names(&file)), (20000.0, vec!["a"]));
    warned(&file, &["drawn in crease colours", "'rim' (line 2)"]);
}

#[test]
fn creases_that_close_an_open_outline_are_taken_and_told() {
    let body = r#"<path id="rim" d="M0 0H200V100H0" stroke="black"/>
<path id="spine" d="M0 0 V100" stroke="blue"/><path id="a" d="M0 20 H200" stroke="red"/>"#;
    let file = read(&page(body));
    assert_eq!((file.pattern.area_mm2(), names(&file)), (20000.0, vec!["a"]));
    warned(&file, &["outline is open", "'spine' (line 3)"]);
}

#[test]
fn an_outline_with_gaps_is_refused_with_all_of_them() {
    let body = r#"<path id="a" d="M10 0H200V40" stroke="black"/>
<path id="b" d="M200 50V100H0V0" stroke="black"/>"#;
    let error = refused(&page(body));
    assert!(matches!(error.error, PatternError::Outline(_)));
    told(
        &error.issues,
        Severity::Error,
        &["'a' (line 2)", "'b' (line 3)", "(200.000, 50.000)", "10.000 mm", "make these two ends meet"],
    );
    told(&error.issues, Severity::Error, &["(10.000, 0.000)", "(0.000, 0.000)"]);
    assert_eq!(error.issues.iter().filter(|i| i.severity == Severity::Error).count(), 2);
}

#[test]
fn a_gap_of_the_outline_beside_a_crease_is_closed_to_the_outline() {
    let body = r#"<path id="rim" d="M0.5 100 H0 V0 H200 V100 H1.5" stroke="black"/><path d="M1 0 V99.9" stroke="red"/>"#;
    let file = read(&page(body));
    assert!((file.pattern.area_mm2() - 20000.0).abs() < 1e-9);
    assert_eq!(ends(&file.pattern.creases[0].curve), [v(1.0, 0.0), v(1.0, 100.0)]);
}

#[test]
fn outlines_that_touch_or_cross_themselves_in_a_point_are_refused() {
    for d in ["M0 0L200 100V0L0 100Z", "M0 0 L100 50 L0 100 Z M200 0 L100 50 L200 100 Z"] {
        let error = refused(&page(&format!(r#"<path id="eight" d="{d}" stroke="black"/>"#)));
        told(&error.issues, Severity::Error, &["eight: ", "crosses itself", "(100.000, 50.000)"]);
    }
}

#[test]
fn an_outline_that_crosses_itself_keeps_its_outer_contour() {
    let body = r#"<path id="star" d="M100 0 L130 95 L50 35 L150 35 L70 95 Z" stroke="black"/>"#;
    let file = read(&page(body));
    assert_eq!(file.pattern.outline.segments().len(), 10);
    assert!(file.pattern.slits.is_empty() && file.pattern.holes.is_empty());
    warned(&file, &["star: ", "crosses itself", "outer contour"]);
}

#[test]
fn a_tiny_loop_at_a_corner_falls_away() {
    let body = r#"<path id="rim" d="M0 0 H200 V100.2 L199.8 100 H0 Z M199.8 100 H200" stroke="black"/>"#;
    let file = read(&page(body));
    assert!((file.pattern.area_mm2() - 20000.0).abs() < 0.1);
}

#[test]
fn corners_split_a_crease_and_polylines_do_not() {
    let file = read(&sheet(r#"<path id="a" d="M0 20 L100 90 L200 20" stroke="red"/>"#));
    assert_eq!(names(&file), ["a", "a-2"]);
    assert_eq!(file.pattern.junctions()[0].ends.len(), 2);
    let turned: String = (1..=6)
        .scan(v(50.0, 0.0), |p, k| {
            *p += 10.0 * DVec2::from_angle((90.0 + 30.0 * f64::from(k - 1)).to_radians());
            Some(format!("L{} {} ", p.x, p.y))
        })
        .collect();
    let file = read(&sheet(&format!(r#"<path id="a" d="M50 0 {turned}" stroke="red"/>"#)));
    assert_eq!(names(&file), ["a"], "turns of 30° are a curve");
    assert_eq!(file.pattern.creases[0].curve.segments().len(), 6);
}

#[test]
fn a_tiny_jog_is_no_corner() {
    let file = read(&sheet(r#"<path id="a" d="M0 50 H100 V50.01 H200" stroke="red"/>"#));
    assert_eq!(names(&file), ["a"]);
}

#[test]
fn flat_lines_do_not_break_creases() {
    let body = r#"<path id="a" d="M0 50 C60 50 140 60 200 50" stroke="red"/>
<path id="f" d="M50 0 V100" stroke="yellow"/><path id="g" d="M100 0 V53.75" stroke="yellow"/>"#;
    let file = read(&sheet(body));
    let whole = named(&file, "a");
    assert_eq!(whole.curve.segments().len(), 1, "the drawn curve is whole");
    let alone = read(&sheet(r#"<path d="M0 50 C60 50 140 60 200 50" stroke="red"/>"#)).pattern;
    let (a, b) = (alone.creases[0].curve.segments(), whole.curve.segments());
    assert!(a[0].control_points().iter().zip(b[0].control_points()).all(|(a, b)| a.distance(b) < 1e-9));
    let flat: Vec<_> =
        file.pattern.creases.iter().filter(|c| c.role == Role::Flat).map(|c| &c.name[..]).collect();
    assert_eq!(flat, ["f", "f-2", "g"]);
    assert!(file.pattern.junctions().is_empty());
}

#[test]
fn closed_creases_stay_closed_and_those_with_a_corner_end_in_it() {
    let body = r#"<circle id="ring" cx="50" cy="50" r="30" stroke="red"/><path id="drop" d="M150 10 C200 80 100 80 150 10" stroke="blue"/>"#;
    let file = read(&sheet(body));
    assert_eq!(names(&file), ["ring", "drop", "drop-2"]);
    let ring = &named(&file, "ring").curve;
    assert!(ring.is_closed());
    assert!((ring.length_mm() - 60.0 * std::f64::consts::PI).abs() < 1e-2);
    let [to, fro] = ["drop", "drop-2"].map(|n| ends(&named(&file, n).curve));
    assert_eq!((to[0], to[1], fro[1]), (v(150.0, 10.0), fro[0], v(150.0, 10.0)));
    assert!(warnings(&file).is_empty());
}

#[test]
fn creases_that_leave_the_sheet_are_all_refused_at_once() {
    let body = r#"<path id="a" d="M0 50 H250" stroke="red"/>
<path id="b" d="M50 0 V130" stroke="blue"/><path id="c" d="M80 0 V101" stroke="blue"/>"#;
    let error = refused(&sheet(body));
    assert!(matches!(error.error, PatternError::Crease(_)));
    told(
        &error.issues,
        Severity::Error,
        &["line 3: a: ", "leaves the sheet by 50.000 mm", "(200.000, 50.000)"],
    );
    told(
        &error.issues,
        Severity::Error,
        &["line 4: b: ", "leaves the sheet by 30.000 mm", "(50.000, 100.000)"],
    );
    told(&error.issues, Severity::Warning, &["c: ", "ran 1.000 mm past the boundary"]);
    assert_eq!(error.error.issue(), error.issues.iter().find(|i| i.severity == Severity::Error).unwrap());
}

#[test]
fn a_crease_that_bulges_over_the_outline_by_little_is_trimmed() {
    let file = read(&sheet(r#"<path id="a" d="M0 90 Q100 111 200 90" stroke="red"/>"#));
    warned(&file, &["a: ", "leaves the sheet by 0.5", "trimmed"]);
    assert_eq!(names(&file), ["a", "a-2"]);
}

#[test]
fn one_element_of_many_lines_has_numbered_names_in_its_order() {
    let file = read(&sheet(r#"<path id="grid" d="M50 0V100M0 50H200M150 100V0" stroke="red"/>"#));
    let found: Vec<_> = file.pattern.creases.iter().map(|c| (c.name.as_str(), c.curve.end(0))).collect();
    let wanted = [
        ("grid", v(50.0, 0.0)),
        ("grid-2", v(50.0, 50.0)),
        ("grid-3", v(0.0, 50.0)),
        ("grid-4", v(50.0, 50.0)),
        ("grid-5", v(150.0, 50.0)),
        ("grid-6", v(150.0, 100.0)),
        ("grid-7", v(150.0, 50.0)),
    ];
    assert_eq!(found, wanted);
}

#[test]
fn the_tolerances_are_told_and_can_be_given() {
    noted(&read(&sheet("")), &["closer than 0.002 mm", "up to 2 mm"]);
    let options = ReadOptions { join_mm: Some(0.5), refuse_mm: Some(3.5), ..ReadOptions::default() };
    let body = r#"<path d="M0 50 H200" stroke="red"/><path d="M70 0 V49.6" stroke="blue"/>"#;
    let file = read_with(&sheet(body), &options);
    noted(&file, &["closer than 0.5 mm", "up to 3.5 mm"]);
    assert_eq!(file.pattern.junctions()[0].point, v(70.0, 50.0));
    for bad in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
        let options = ReadOptions { join_mm: Some(bad), refuse_mm: Some(bad), ..ReadOptions::default() };
        assert_eq!(read_with(&sheet(body), &options).pattern.creases.len(), 3, "the usual ones are taken");
    }
}

#[test]
fn lines_without_length_are_left_out_and_told() {
    let file = read(&sheet(
        r#"<path id="dot" d="M50 50 L50.001 50" stroke="red"/><path id="a" d="M0 50H20" stroke="red"/>"#,
    ));
    assert_eq!(names(&file), ["a"]);
    noted(&file, &["without length", "'dot' (line 3)"]);
}

#[test]
fn a_curve_of_a_million_tiny_steps_is_not_lost() {
    let steps: String = (0..20_000).map(|i| format!("L{} {} ", f64::from(i) * 0.01, 50)).collect();
    let file = read(&sheet(&format!(r#"<path id="a" d="M0 50 {steps} H200" stroke="red"/>"#)));
    assert!((named(&file, "a").curve.length_mm() - 200.0).abs() < 1e-9);
}

#[test]
fn drawings_beyond_all_measure_are_refused() {
    let hatch: String = (0..700)
        .map(|i| f64::from(i) * 0.14)
        .map(|x| format!("M{} 0 L{} 100 M0 {x} H200 ", x + 50.0, x + 40.0))
        .collect();
    let error = refused(&sheet(&format!(r#"<path d="{hatch}" stroke="red"/>"#)));
    assert!(matches!(error.error, PatternError::TooMuch(_)), "{}", error.error);
}

#[test]
fn outline_lines_that_stop_short_of_their_corner_are_led_to_it() {
    let file = read(&page(
        "<path id='a' d='M0 0H199.8' stroke='black'/><path id='b' d='M200 0.1V100' stroke='black'/>\
         <path d='M200 100H0V0' stroke='black'/>",
    ));
    warned(&file, &["gap of 0.224 mm", "'a' (line 2)", "'b' (line 2)"]);
    let corner = |s: &softfold_geometry::Segment| s.from().distance(v(200.0, 0.0)) < 1e-9;
    assert!(file.pattern.outline.segments().iter().any(corner), "{:?}", file.pattern.outline);
    assert!((file.pattern.area_mm2() - 2e4).abs() < 1e-6);
}

#[test]
fn slits_are_named_with_their_lines() {
    let file = read(&sheet(
        "<path id='c' d='M50 20V50' stroke='lime'/>\n<path id='d' d='M90 20V50' stroke='lime'/>",
    ));
    noted(&file, &["2 open cuts are slits", "'c' (line 3)", "'d' (line 4)"]);
}

#[test]
fn an_outline_drawn_twice_a_little_apart_is_one_fault_with_a_mend() {
    let twice = sheet("<path id='again' d='M0.02 0.01H200.01V99.99H0.02Z' stroke='black'/>");
    let refused = refused(&twice);
    let above: Vec<&Issue> = refused.issues.iter().filter(|i| i.severity > Severity::Note).collect();
    let [only] = above[..] else { panic!("{above:#?}") };
    assert!(only.to_string().contains("'outline'") && only.mend.contains("join_mm"), "{only}");
    // And the mend works.
    let file = read_with(&twice, &ReadOptions { join_mm: Some(0.05), ..ReadOptions::default() });
    assert!((file.pattern.area_mm2() - 2e4).abs() < 5.0);
}

#[test]
fn a_frame_around_the_sheet_is_offered_for_deletion() {
    let file = read(&sheet(
        "<path d='M20 20H180V80H20Z' stroke='black'/><path id='m' d='M100 20V80' stroke='red'/>",
    ));
    assert!(warned(&file, &["inside a hole", "'m'"]).mend.contains("frame around the sheet, delete it"));
    let file = read(&sheet(
        "<path d='M20 20H180V80H20Z' stroke='black'/><path d='M100 20V80' stroke='red'/><path d='M10 0V100' stroke='red'/>",
    ));
    assert!(warned(&file, &["inside a hole"]).mend.contains("on the sheet"));
}
