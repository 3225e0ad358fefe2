//! What strokes drawings give: geometry of each kind against closed forms, blocks, roles, units, faults.

use super::strokes;
use crate::drawing::Stroke;
use crate::{PatternError, ReadOptions, RoleMap};
use glam::DVec2;
use proptest::prelude::*;
use softfold_geometry::{Issue, PlanarCurve, Role, Segment, Severity};
use std::f64::consts::PI;

/// A drawing in mm: sections before the entities, and the entities, groups by spaces, elements by lines.
fn file(before: &str, entities: &str) -> String {
    let mut text = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n".to_owned();
    text += &groups(before);
    text += &format!("0\nSECTION\n2\nENTITIES\n{}0\nENDSEC\n0\nEOF\n", groups(entities));
    text
}

/// `LINE 10=1 20=2`: an element with its groups.
fn groups(short: &str) -> String {
    let element = |line: &str| {
        let mut words = line.split_whitespace();
        let mut text = format!("0\n{}\n", words.next()?);
        for word in words {
            let (code, value) = word.split_once('=').unwrap();
            text += &format!("{code}\n{value}\n");
        }
        Some(text)
    };
    short.lines().filter_map(element).collect()
}

fn read_with(text: &str, options: &ReadOptions) -> (Vec<Stroke>, Vec<Issue>) {
    let mut issues = Vec::new();
    let strokes = strokes(text.as_bytes(), options, &mut issues).unwrap_or_else(|e| panic!("{e}"));
    (strokes, issues)
}

fn read(before: &str, entities: &str) -> (Vec<Stroke>, Vec<Issue>) {
    read_with(&file(before, entities), &ReadOptions::default())
}

/// The only curve of a drawing that nothing is to be said about.
fn curve(entity: &str) -> PlanarCurve {
    let (strokes, issues) = read("", entity);
    assert_eq!(issues, vec![]);
    only(&strokes)
}

fn only(strokes: &[Stroke]) -> PlanarCurve {
    let [Stroke { pieces, .. }] = strokes else { panic!("{strokes:?}") };
    assert_eq!(pieces.len(), 1);
    PlanarCurve::new(pieces[0].clone()).unwrap()
}

fn refused(before: &str, entities: &str) -> PatternError {
    strokes(file(before, entities).as_bytes(), &ReadOptions::default(), &mut Vec::new()).unwrap_err()
}

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn assert_near(a: DVec2, b: DVec2) {
    assert!(a.distance(b) < 1e-9, "{a} is not {b}");
}

fn ends(c: &PlanarCurve) -> [DVec2; 2] {
    [c.end(0), c.end(1)]
}

fn told<'a>(issues: &'a [Issue], part: &str) -> &'a Issue {
    issues.iter().find(|i| i.to_string().contains(part)).unwrap_or_else(|| panic!("{part}: {issues:#?}"))
}

#[test]
fn a_line_has_its_ends_handle_and_line_number() {
    let (strokes, issues) = read("", "LINE 5=3F 8=CUT 10=1 20=2 11=30 21=40\nLINE 10=0 20=0 11=1 21=0");
    assert_eq!(issues, vec![]);
    assert_eq!(strokes[0].pieces, vec![vec![Segment::Line { from: v(1.0, 2.0), to: v(30.0, 40.0) }]]);
    assert_eq!((strokes[0].origin.label.as_str(), strokes[0].origin.id.as_deref()), ("LINE 3F", Some("3F")));
    assert_eq!((strokes[1].origin.label.as_str(), strokes[1].origin.id.as_deref()), ("LINE 2", None));
    assert_eq!(strokes[0].origin.line, Some(16));
    assert_eq!(strokes[0].role, Role::Boundary);
}

#[test]
fn arcs_run_counter_clockwise_over_zero() {
    let c = curve("ARC 10=10 20=20 40=100 50=330 51=30");
    assert!((c.length_mm() - 100.0 * PI / 3.0).abs() < 1e-6);
    let half = 100.0 * 0.75_f64.sqrt();
    assert_near(ends(&c)[0], v(10.0 + half, -30.0));
    assert_near(ends(&c)[1], v(10.0 + half, 70.0));
    assert!((c.point(0.5 * c.length_mm()) - v(110.0, 20.0)).length() < 1e-5);
}

#[test]
fn circles_are_closed_and_round() {
    let c = curve("CIRCLE 10=5 20=-5 40=1000");
    assert!(c.is_closed() && (c.signed_area_mm2() / (PI * 1e6) - 1.0).abs() < 3e-8);
    let (strokes, issues) = read("", "CIRCLE 10=5 20=-5 40=-10\nCIRCLE 10=0 20=0 40=0");
    assert!((only(&strokes).signed_area_mm2() / (PI * 100.0) - 1.0).abs() < 3e-8);
    told(&issues, "'CIRCLE 1' (line 16)");
    told(&issues, "radius or an axis is 0; ignored (1): 'CIRCLE 2'");
}

#[test]
fn ellipses_have_their_axes_and_area() {
    let c = curve("ELLIPSE 10=1 20=2 11=30 21=40 40=0.5");
    assert!(c.is_closed() && (c.signed_area_mm2() / (PI * 50.0 * 25.0) - 1.0).abs() < 1e-7);
    assert_near(c.end(0), v(31.0, 42.0));
    // A quarter from the major axis to the minor one, which a normal that points down turns round.
    let quarter = format!("ELLIPSE 10=0 20=0 11=2 21=0 40=0.5 41=0 42={}", PI / 2.0);
    assert_near(curve(&quarter).end(1), v(0.0, 1.0));
    assert_near(curve(&format!("{quarter} 210=0 220=0 230=-1")).end(1), v(0.0, -1.0));
}

#[test]
fn light_polylines_close_and_bulge() {
    let slot = curve("LWPOLYLINE 90=4 70=1 10=0 20=0 10=40 20=0 42=1 10=40 20=10 10=0 20=10 42=1");
    assert!(slot.is_closed());
    assert!((slot.signed_area_mm2() - (400.0 + 25.0 * PI)).abs() < 1e-5);
    assert_eq!(curve("LWPOLYLINE 10=0 20=0 10=1 20=0 10=1 20=1").segments().len(), 2);
    // Closed by flag and by its last corner: nothing of no length is left.
    let twice = "LWPOLYLINE 70=1 10=0 20=0 10=1 20=0 10=1 20=1 10=0 20=0";
    assert_eq!(curve(twice).segments().len(), 3);
}

#[test]
fn heavy_polylines_leave_out_control_points() {
    let c = curve(
        "POLYLINE 66=1 70=5 30=0\nVERTEX 10=0 20=0 70=16\nVERTEX 10=0 20=0 42=1 70=8\nVERTEX 10=10 20=0 42=1\nSEQEND",
    );
    assert!(c.is_closed() && (c.signed_area_mm2() / (PI * 25.0) - 1.0).abs() < 3e-8);
    let (strokes, issues) = read("", "POLYLINE 70=64\nVERTEX 10=0 20=0\nSEQEND\nLINE 10=0 20=0 11=1 21=1");
    assert_eq!(strokes.len(), 1);
    assert_eq!(told(&issues, "POLYLINE (mesh)").severity, Severity::Note);
}

#[test]
fn a_normal_that_points_down_mirrors_what_lies_in_its_own_plane() {
    let down = "210=0 220=0 230=-1";
    let c = curve(&format!("ARC 10=10 20=0 40=5 50=0 51=90 {down}"));
    assert_near(ends(&c)[0], v(-15.0, 0.0));
    assert_near(ends(&c)[1], v(-10.0, 5.0));
    let p = curve(&format!("LWPOLYLINE 10=1 20=2 42=1 10=3 20=2 {down}"));
    assert_near(ends(&p)[0], v(-1.0, 2.0));
    assert!((p.point(0.5 * p.length_mm()) - v(-2.0, 1.0)).length() < 1e-7, "the bulge is mirrored too");
    // Lines are in the coordinates of the drawing, whatever their normal.
    assert_near(curve(&format!("LINE 10=1 20=2 11=3 21=4 {down}")).end(0), v(1.0, 2.0));
}

#[test]
fn heights_are_told() {
    let (_, issues) = read("", "LINE 10=0 20=0 30=5 11=1 21=0 31=5\nLINE 10=0 20=0 11=1 21=0 31=2");
    assert_eq!(told(&issues, "not at z = 0").severity, Severity::Note);
    assert_eq!(told(&issues, "not parallel").severity, Severity::Warning);
    let (_, issues) = read("", "LINE 10=0 20=0 30=1e-13 11=1 21=0 31=0");
    assert_eq!(issues, vec![]);
}

#[test]
fn splines_are_exact_where_they_can_be() {
    let spline =
        "SPLINE 70=8 71=3 40=0 40=0 40=0 40=0 40=1 40=1 40=1 40=1 10=0 20=0 10=1 20=2 10=3 20=2 10=4 20=0";
    let Segment::Cubic { c1, c2, .. } = curve(spline).segments()[0] else { panic!("cubic") };
    assert_eq!([c1, c2], [v(1.0, 2.0), v(3.0, 2.0)]);
    let (strokes, issues) = read("", "SPLINE 70=8 71=3 11=0 21=0 11=1 21=2 11=3 21=2");
    assert_eq!(ends(&only(&strokes)), [v(0.0, 0.0), v(3.0, 2.0)]);
    told(&issues, "points on it");
}

const ARM: &str = "SECTION 2=BLOCKS\nBLOCK 2=Arm 10=1 20=0\nLINE 5=A1 8=0 62=0 10=1 20=0 11=3 21=0\nENDBLK\n\
    BLOCK 2=PAIR\nINSERT 5=B1 8=VALLEY 2=arm 10=10 20=0 50=90\nENDBLK\nENDSEC";

#[test]
fn blocks_are_scaled_turned_and_moved_from_their_base_point() {
    let c = |insert: &str| only(&read(ARM, insert).0);
    assert_eq!(ends(&c("INSERT 2=ARM 10=100 20=50 41=2 42=-3")), [v(100.0, 50.0), v(104.0, 50.0)]);
    // By hand: the arm of 2 from (10, 0) upwards; doubled; turned by 90°; moved.
    let nested = c("INSERT 2=Pair 10=5 20=6 41=2 42=2 43=2 50=90");
    assert_near(ends(&nested)[0], v(5.0, 26.0));
    assert_near(ends(&nested)[1], v(1.0, 26.0));
    let mirrored = c("INSERT 2=Arm 10=7 20=0 210=0 220=0 230=-1");
    assert_near(ends(&mirrored)[1], v(-9.0, 0.0));
}

#[test]
fn arrays_repeat_along_the_turned_axes() {
    let (strokes, _) = read(ARM, "INSERT 5=C 2=Arm 10=0 20=0 41=5 50=90 70=2 71=2 44=10 45=100");
    let starts: Vec<DVec2> = strokes.iter().map(|s| s.pieces[0][0].from()).collect();
    for (start, at) in starts.iter().zip([v(0.0, 0.0), v(0.0, 10.0), v(-100.0, 0.0), v(-100.0, 10.0)]) {
        assert_near(*start, at);
    }
    assert_eq!(strokes[2].origin.label, "LINE A1 in INSERT C[3]");
    assert_eq!(strokes[2].origin.id.as_deref(), Some("C[3]/A1"));
}

#[test]
fn things_in_blocks_take_on_layer_and_colour_of_their_insert() {
    let role = |insert: &str| read(ARM, insert).0[0].role;
    assert_eq!(role("INSERT 2=Arm 10=0 20=0 8=MOUNTAIN"), Role::Mountain, "layer 0 floats");
    assert_eq!(role("INSERT 2=Arm 10=0 20=0 62=5"), Role::Valley, "ByBlock");
    assert_eq!(role("INSERT 2=Pair 10=0 20=0 8=MOUNTAIN"), Role::Valley, "the innermost layer says");
}

#[test]
fn blocks_that_hold_themselves_are_refused() {
    let ring = "SECTION 2=BLOCKS\nBLOCK 2=A\nINSERT 2=B 10=0 20=0\nENDBLK\nBLOCK 2=B\nINSERT 5=7 2=a 10=0 20=0\nENDBLK\nENDSEC";
    let error = refused(ring, "INSERT 2=A 10=0 20=0");
    assert!(
        matches!(error, PatternError::Malformed(_)) && error.to_string().contains("holds itself"),
        "{error}"
    );
    assert_eq!(error.issue().element.as_deref(), Some("INSERT 7"));
}

#[test]
fn drawings_that_unfold_without_end_are_refused_soon() {
    let mut blocks = "SECTION 2=BLOCKS\nBLOCK 2=B0\nLINE 10=0 20=0 11=1 21=0\nENDBLK\n".to_owned();
    for level in 1..15 {
        let inner = level - 1;
        blocks += &format!("BLOCK 2=B{level}\n");
        blocks += &format!("INSERT 2=B{inner} 10=0 20=0 70=30 71=30 44=1 45=1\n").repeat(2);
        blocks += "ENDBLK\n";
    }
    let bomb = refused(&(blocks + "ENDSEC"), "INSERT 2=B14 10=0 20=0");
    assert!(bomb.to_string().contains("unfolded"), "{bomb}");
    let array = refused(ARM, "INSERT 2=Arm 10=0 20=0 70=2000000000 71=2000000000");
    assert!(array.to_string().contains("columns"), "{array}");
    // Empty blocks are work too.
    let empty = "SECTION 2=BLOCKS\nBLOCK 2=E\nENDBLK\nBLOCK 2=F\nINSERT 2=E 10=0 20=0 70=1000 71=1000\nENDBLK\nENDSEC";
    let error = refused(empty, "INSERT 2=F 10=0 20=0 70=1000 71=1000");
    assert!(error.to_string().contains("unfolded"), "{error}");
}

const LAYERS: &str = "SECTION 2=TABLES\nTABLE 2=LAYER\nLAYER 2=Red 62=1\nLAYER 2=Pale 62=8\nLAYER 2=Off 62=-5\n\
    LAYER 2=Cold 62=5 70=1\nLAYER 2=True 62=7 420=255\nENDTAB\nENDSEC";

#[test]
fn layers_say_the_role_then_colours() {
    for (entity, role) in [
        ("8=MountainLine", Role::Mountain),
        ("8=MOUNTAIN 62=5", Role::Mountain),
        ("8=Red", Role::Mountain),
        ("8=red 62=256", Role::Mountain),
        ("8=Red 62=5", Role::Valley),
        ("8=Red 420=65280", Role::Cut),
        ("8=True", Role::Valley),
        ("8=0", Role::Boundary),
        ("8=Undeclared", Role::Boundary),
        ("8=0 420=16777215", Role::Boundary),
        ("8=0 62=2", Role::Flat),
        ("8=0 62=6", Role::Unassigned),
    ] {
        let (strokes, issues) = read(LAYERS, &format!("LINE 10=0 20=0 11=1 21=0 {entity}"));
        assert_eq!((strokes[0].role, issues.len()), (role, 0), "{entity}");
    }
}

#[test]
fn a_block_on_a_layer_that_is_off_shows_what_lies_on_other_layers() {
    let block = "SECTION 2=BLOCKS\nBLOCK 2=X\nLINE 8=0 10=0 20=0 11=1 21=0\nLINE 8=CUT 10=0 20=0 11=2 21=0\nENDBLK\nENDSEC";
    let before = format!("{LAYERS}\n{block}");
    let (strokes, issues) = read(&before, "INSERT 8=Off 2=X 10=0 20=0");
    assert_eq!((strokes.len(), strokes[0].pieces[0][0].to()), (1, v(2.0, 0.0)));
    told(&issues, "is off; ignored (1): 'LINE 1 in INSERT 1'");
    let frozen = refused(&before, "INSERT 8=Cold 2=X 10=0 20=0");
    assert!(matches!(frozen, PatternError::Nothing(_)), "{frozen}");
}

#[test]
fn what_is_left_out_is_told_once_for_each_cause() {
    let line = "LINE 10=0 20=0 11=1 21=0";
    let mut entities =
        format!("{line}\n{line} 8=Off\n{line} 8=Cold\n{line} 60=1\n{line} 67=1\n{line} 8=Defpoints\n");
    entities += &format!("{line} 8=Pale\n").repeat(12);
    entities += "TEXT 1=hello\nTEXT 1=you\nHATCH 2=x\nINSERT 2=Gone 10=0 20=0\nLINE 10=1 20=1 11=1 21=1";
    let layers = LAYERS.replace("ENDTAB", "LAYER 2=Defpoints 62=7\nENDTAB");
    let (strokes, issues) = read(&layers, &entities);
    assert_eq!(strokes.len(), 1);
    for part in [
        "layer \"Off\" is off; ignored (1): 'LINE 2'",
        "layer \"Cold\" is frozen",
        "layer \"Defpoints\" is never plotted",
        "invisible; ignored (1)",
        "paper space",
        "neither layer \"Pale\" nor colour #808080 is a role; ignored (12): ",
        "TEXT is no line of a pattern; ignored (2): 'TEXT 1' (line ",
        "HATCH is no line",
        "the block \"Gone\" is not in the file",
        "no length",
    ] {
        told(&issues, part);
    }
    assert_eq!(issues.len(), 10, "{issues:#?}");
    assert!(told(&issues, "Pale").to_string().contains("and 4 more"));
}

#[test]
fn the_user_has_the_last_word_on_roles() {
    let roles = RoleMap {
        colours: vec![([128, 128, 128], Some(Role::Flat))],
        layers: [("notes".to_owned(), None), ("fold-in".to_owned(), Some(Role::Mountain))].into(),
        elements: [
            ("3F".to_owned(), Some(Role::Cut)),
            ("LINE 4".to_owned(), None),
            ("C/A1".to_owned(), Some(Role::Valley)),
        ]
        .into(),
    };
    let options = ReadOptions { roles, ..ReadOptions::default() };
    let line = "LINE 10=0 20=0 11=1 21=0";
    let entities = format!(
        "{line} 5=3F 8=notes\n{line} 8=NOTES\n{line}\n{line} 8=Fold-In\n{line} 62=8\nINSERT 5=C 2=Arm 10=0 20=0\nINSERT 5=D 2=Arm 10=0 20=0"
    );
    let (strokes, issues) = read_with(&file(ARM, &entities), &options);
    let roles: String = strokes.iter().map(|s| s.role.letter()).collect();
    assert_eq!((roles.as_str(), issues.len()), ("CMFVB", 0), "{strokes:?}");
}

#[test]
fn units_of_the_file_become_mm() {
    let text = file("", "LINE 10=0 20=0 11=1 21=2");
    let length = |text: &str, unit_mm| {
        let (strokes, issues) = read_with(text, &ReadOptions { unit_mm, ..ReadOptions::default() });
        (strokes[0].pieces[0][0].to(), issues.len())
    };
    assert_eq!(length(&text, Some(3.0)), (v(1.0, 2.0), 0));
    assert_eq!(length(&text.replace("70\n4", "70\n1"), None), (v(25.4, 50.8), 0));
    assert_eq!(length(&text.replace("70\n4", "70\n0"), None), (v(1.0, 2.0), 1));
    assert_eq!(length(&text.replace("70\n4", "70\n0"), Some(3.0)), (v(3.0, 6.0), 0));
}

#[test]
fn faults_have_element_and_line() {
    for (entity, line, parts) in [
        ("LINE 5=3F 10=1 20=2,5 11=0 21=0", Some(22), ["LINE 3F", "the group 20 is \"2,5\""]),
        ("LINE 10=1 20=2 11=0", Some(16), ["LINE 1", "the group 21 is missing"]),
        ("CIRCLE 10=0 20=0 40=nan", Some(22), ["CIRCLE 1", "\"nan\""]),
        ("CIRCLE 10=0 20=0 40=1e308 210=0 220=0 230=1\nLINE 10=1e308 20=0 11=0 21=0", None, ["", ""]),
        ("LWPOLYLINE 10=0 20=0 42=1e300 10=1e10 20=0", Some(16), ["LWPOLYLINE 1", "too large"]),
        ("SPLINE 71=3 10=0 20=0", Some(16), ["SPLINE 1", "1 control points"]),
    ] {
        let text = file("", entity).replace("70\n4", "70\n6");
        let Err(error) = strokes(text.as_bytes(), &ReadOptions::default(), &mut Vec::new()) else {
            panic!("{entity} was read")
        };
        assert!(matches!(error, PatternError::Number(_)), "{error}");
        assert!(parts.iter().all(|part| error.to_string().contains(part)), "{error}");
        assert!(line.is_none() || error.issue().line == line, "{error}");
    }
}

#[test]
fn what_is_no_drawing_is_refused() {
    let error = |text: &str| strokes(text.as_bytes(), &ReadOptions::default(), &mut Vec::new()).unwrap_err();
    assert!(matches!(error(""), PatternError::Malformed(_)));
    assert!(matches!(error("<svg/>"), PatternError::Malformed(_)));
    assert!(matches!(error("0\nLINE\n0\nEOF\n"), PatternError::Malformed(_)), "no section");
    assert!(matches!(error(&file("", "")), PatternError::Nothing(_)));
    assert!(matches!(error(&file("", "TEXT 1=x")), PatternError::Nothing(_)));
}

#[test]
fn a_file_that_is_cut_off_is_told_or_refused_wherever_it_is_cut() {
    let whole =
        file(&format!("{LAYERS}\n{ARM}"), "INSERT 2=Pair 10=0 20=0\nLWPOLYLINE 10=0 20=0 42=1 10=5 20=5");
    let (all, _) = read_with(&whole, &ReadOptions::default());
    for cut in 0..whole.len() - "EOF\n".len() {
        let mut issues = Vec::new();
        if let Ok(strokes) = strokes(&whole.as_bytes()[..cut], &ReadOptions::default(), &mut issues) {
            assert!(strokes.len() <= all.len());
            told(&issues, "cut off");
        }
    }
}

/// Elements and groups as a damaged or hostile file may have them.
fn any_group() -> impl Strategy<Value = String> {
    const KINDS: &str = "LINE ARC CIRCLE ELLIPSE LWPOLYLINE POLYLINE VERTEX SEQEND SPLINE INSERT BLOCK ENDBLK TEXT \
        SECTION ENDSEC LAYER TABLE";
    const CODES: &str =
        "2 5 8 10 11 12 20 21 30 38 40 41 42 43 44 50 51 60 62 66 67 70 71 72 210 220 230 420";
    const VALUES: &str =
        "0 1 -1 3 0.5 100 1e-300 1e300 -9223372036854775808 99999999999 A B ENTITIES BLOCKS TABLES";
    let of = |words: &'static str| prop::sample::select(words.split(' ').collect::<Vec<_>>());
    let kind = of(KINDS).prop_map(|kind| format!("0\n{kind}\n"));
    let group = (of(CODES), of(VALUES));
    prop_oneof![1 => kind, 4 => group.prop_map(|(code, value)| format!("{code}\n{value}\n"))]
}

proptest! {
    #[test]
    fn groups_in_any_order_give_finite_lines_or_a_fault(
        blocks in prop::collection::vec(any_group(), 0..60),
        entities in prop::collection::vec(any_group(), 0..120),
    ) {
        let text = format!(
            "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nA\n{}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}",
            blocks.concat(),
            entities.concat()
        );
        if let Ok(strokes) = strokes(text.as_bytes(), &ReadOptions::default(), &mut Vec::new()) {
            for segment in strokes.iter().flat_map(|s| &s.pieces).flatten() {
                prop_assert!(segment.control_points().iter().all(|p| p.is_finite()));
            }
        }
    }
}
