//! The reader at the level of strokes: creases that meet, folded forms, softfold's keys.

use super::strokes;
use crate::drawing::Stroke;
use crate::write::{WriteOptions, write_fold};
use crate::{PatternError, ReadOptions, RoleMap};
use proptest::prelude::*;
use softfold_geometry::{Crease, CreaseId, CreasePattern, DVec2, Issue, PlanarCurve, Role, Segment, Source};

fn read_with(text: &str, options: &ReadOptions) -> Result<(Vec<Stroke>, Vec<Issue>), PatternError> {
    let mut issues = Vec::new();
    strokes(text.as_bytes(), options, &mut issues).map(|s| (s, issues))
}

fn read(text: &str) -> (Vec<Stroke>, Vec<Issue>) {
    read_with(text, &ReadOptions::default()).unwrap()
}

fn refused(text: &str) -> String {
    read_with(text, &ReadOptions::default()).unwrap_err().to_string()
}

fn said(issues: &[Issue]) -> String {
    issues.iter().map(|i| format!("{i}\n")).collect()
}

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn ends(s: &Stroke) -> [DVec2; 2] {
    [s.pieces[0][0].from(), s.pieces[0][s.pieces[0].len() - 1].to()]
}

/// A square of side 2 with a valley along a diagonal, flat, with keys of `more`.
fn diagonal(coords: &str, more: &str) -> String {
    format!(
        r#"{{"vertices_coords": {coords}, "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[1,3]],
        "edges_assignment": ["B","B","B","B","V"]{more}}}"#
    )
}

const FLAT: &str = "[[0,0],[2,0],[2,2],[0,2]]";
const FACES: &str = r#", "faces_vertices": [[0,1,3],[1,2,3]]"#;

#[test]
fn units_come_from_the_frame_then_from_the_caller_then_are_told() {
    let inches = diagonal(FLAT, r#", "frame_unit": "in""#);
    let twice = ReadOptions { unit_mm: Some(2.0), ..ReadOptions::default() };
    for (text, options, side, notes) in [
        (&inches, &twice, 50.8, 0),
        (&diagonal(FLAT, r#", "frame_unit": "cm""#), &twice, 20.0, 0),
        (&diagonal(FLAT, r#", "frame_unit": "unit""#), &twice, 4.0, 0),
        (&diagonal(FLAT, ""), &ReadOptions::default(), 2.0, 1),
        (&diagonal(FLAT, r#", "frame_unit": "ell""#), &ReadOptions::default(), 2.0, 2),
    ] {
        let (strokes, issues) = read_with(text, options).unwrap();
        assert_eq!((ends(&strokes[0])[1].x, issues.len()), (side, notes), "{text}");
    }
    assert!(said(&read(&diagonal(FLAT, "")).1).contains("one unit is taken as 1 mm"));
}

#[test]
fn letters_and_angles_are_read_and_contradictions_told() {
    let text = r#"{"vertices_coords": [[0,0],[1,0]], "frame_unit": "mm",
      "edges_vertices": [[0,1],[0,1],[0,1],[0,1],[0,1],[0,1],[0,1],[0,1],[0,1]],
      "edges_assignment": ["M","V","F","U","C","J","m","V","U"],
      "edges_foldAngle": [-90, 45.5, 0, 30, 0, 0, 60, 0, null]}"#;
    let (strokes, issues) = read(text);
    use Role::{Cut, Flat, Mountain, Unassigned, Valley};
    let degrees = |a: f64| (a.to_degrees() * 1e9).round() / 1e9;
    let found: Vec<_> = strokes.iter().map(|s| (s.role, s.fold_angle_rad.map(degrees))).collect();
    let wanted = [
        (Mountain, Some(-90.0)),
        (Valley, Some(45.5)),
        (Flat, None),
        (Unassigned, Some(30.0)),
        (Cut, None),
        (Mountain, Some(-60.0)),
        (Valley, None),
        (Unassigned, None),
    ];
    assert_eq!(found, wanted);
    assert_eq!(strokes[5].origin.label, "edge 6");
    for part in [
        "assignment J split faces and are left out, 1 in all: 'edge 5'",
        "wrong sign",
        "'edge 6'",
        "'edge 7'",
    ] {
        assert!(said(&issues).contains(part), "{part}: {}", said(&issues));
    }
}

#[test]
fn the_plural_of_fold_1_0_is_read() {
    let (strokes, _) = read(&diagonal(FLAT, r#", "edges_foldAngles": [0,0,0,0,120]"#));
    assert_eq!(strokes[4].fold_angle_rad, Some(120.0_f64.to_radians()));
}

#[test]
fn edges_whose_assignment_is_null_are_told() {
    let edges =
        r#""edges_vertices": [[0,1],[1,2],[2,3],[3,0],[1,3]], "edges_assignment": ["B","B","B","B",null]"#;
    let (strokes, issues) = read(&format!(r#"{{"vertices_coords": {FLAT}, {edges}}}"#));
    assert_eq!(strokes[4].role, Role::Unassigned);
    assert!(
        said(&issues).contains("without assignment") && said(&issues).contains("'edge 4'"),
        "{}",
        said(&issues)
    );
}

#[test]
fn without_assignments_edges_of_one_face_are_boundary() {
    let bare = |more: &str| {
        let more = format!(r#""edges_vertices": [[0,1],[1,2],[2,3],[3,0],[1,3]]{more}"#);
        format!(r#"{{"vertices_coords": {FLAT}, {more}}}"#)
    };
    let letters = |text: &str| read(text).0.iter().map(|s| s.role.letter()).collect::<String>();
    assert_eq!(letters(&bare(FACES)), "BBBBU");
    assert_eq!(letters(&bare(r#", "edges_faces": [[0,null],[1],[1,null],[null,0],[0,1]]"#)), "BBBBU");
    assert_eq!(letters(&bare("")), "UUUUU");
    assert_eq!(letters(&format!(r#"{{"vertices_coords": {FLAT}{FACES}}}"#)), "BBBUB", "edges of the faces");
}

#[test]
fn a_sheet_in_space_is_seen_from_its_front() {
    for (coords, end, told) in [
        ("[[0,0,5],[2,0,5],[2,2,5],[0,2,5]]", v(0.0, 2.0), None),
        ("[[0,1,0],[2,1,0],[2,1,-2],[0,1,-2]]", v(0.0, 2.0), Some("(x, -z), seen from +y")),
        ("[[7,0,0],[7,2,0],[7,2,2],[7,0,2]]", v(0.0, 2.0), Some("(y, z), seen from +x")),
        // Simulators with y up write the page's x and downward y as x and z.
        ("[[0,0,0],[2,0,0],[2,0,2],[0,0,2]]", v(0.0, -2.0), Some("(x, -z)")),
        ("[[0,0],[2,0],[2,-2],[0,-2]]", v(0.0, -2.0), None),
    ] {
        let (strokes, issues) = read(&diagonal(coords, r#", "frame_unit": "mm""#));
        assert_eq!(ends(&strokes[4])[1], end, "{coords}");
        assert_eq!(issues.is_empty(), told.is_none(), "{}", said(&issues));
        assert!(said(&issues).contains(told.unwrap_or_default()), "{}", said(&issues));
    }
}

#[test]
fn faces_that_run_clockwise_turn_the_sheet_round() {
    // y points down in this file, so on paper the second vertex is below the first.
    let down = diagonal("[[0,0],[0,2],[2,2],[2,0]]", FACES);
    let (strokes, issues) = read(&down);
    assert_eq!(ends(&strokes[0]), [v(0.0, 0.0), v(0.0, -2.0)]);
    assert!(said(&issues).contains("faces run clockwise"), "{}", said(&issues));
    let (_, issues) = read(&diagonal(FLAT, r#", "file_creator": "Oriedita 1""#));
    assert!(said(&issues).contains("whose y points down"));
    let (_, issues) = read(&diagonal(FLAT, &format!(r#", "file_creator": "oriedita"{FACES}"#)));
    assert!(!said(&issues).contains("points down"), "faces are surer than the creator");
}

#[test]
fn folded_forms_are_laid_out_flat() {
    let (s, c) = (0.5_f64.sqrt(), 0.3_f64.cos());
    let lift = 0.3_f64.sin();
    // The corner 2 swung about the diagonal from 1 to 3: flat at (2, 2), centre of the diagonal (1, 1).
    let swung = format!("[[0,0,0],[2,0,0],[{},{},{}],[0,2,0]]", 1.0 + c, 1.0 + c, lift / s);
    let folded = format!(r#"{FACES}, "frame_classes": ["foldedForm"], "edges_foldAngle": [0,0,0,0,180]"#);
    for coords in ["[[0,0],[2,0],[0,0],[0,2]]", &swung, FLAT] {
        let (strokes, issues) = read(&diagonal(coords, &folded));
        let corners: Vec<DVec2> = strokes[..4].iter().map(|s| ends(s)[0]).collect();
        for (p, q) in corners.iter().zip([v(0.0, 0.0), v(2.0, 0.0), v(2.0, 2.0), v(0.0, 2.0)]) {
            assert!(p.distance(q) < 1e-12, "{coords}: {corners:?}");
        }
        assert_eq!(strokes[4].fold_angle_rad, Some(std::f64::consts::PI));
        assert!(
            said(&issues).contains("laid out flat, 2 faces; it closes within 0.000000 mm"),
            "{}",
            said(&issues)
        );
    }
}

#[test]
fn seams_are_opened_and_separate_parts_lie_side_by_side() {
    let folded = r#", "frame_classes": ["foldedForm"]"#;
    let seam = diagonal(FLAT, &format!("{FACES}{folded}")).replace("\"V\"", "\"C\"");
    let (strokes, issues) = read(&seam);
    assert_eq!(strokes.len(), 6, "the cut is an edge of both parts");
    assert!(said(&issues).contains("in 2 parts"));
    let [a, b] = [ends(&strokes[4]), ends(&strokes[5])];
    assert!(a[0].x.max(a[1].x) < b[0].x.min(b[1].x), "{a:?} {b:?}");
}

#[test]
fn forms_that_are_no_sheet_are_refused_with_face_and_gap() {
    let folded = |coords: &str, faces: &str| {
        diagonal(coords, &format!(r#", "faces_vertices": {faces}, "frame_classes": ["foldedForm"]"#))
    };
    // Four triangles around a raised centre: a pyramid's angles leave a gap.
    let pyramid = r#"{"vertices_coords": [[0,0,0],[2,0,0],[2,2,0],[0,2,0],[1,1,1]], "frame_classes": ["foldedForm"],
      "edges_vertices": [[0,1]], "faces_vertices": [[0,1,4],[1,2,4],[2,3,4],[3,0,4]]}"#;
    let no_faces = diagonal("[[0,0],[2,0],[0,0],[0,2]]", r#", "frame_classes": ["foldedForm"]"#);
    for (text, parts) in [
        (pyramid.to_owned(), ["faces_vertices[", "misses vertex", " mm ("]),
        (no_faces, ["vertices_coords", "no faces_vertices", "export the crease pattern"]),
        (folded(FLAT, "[[0,1,3],[1,3,2]]"), ["faces 0 and 1", "same way", "1 and 3"]),
        (folded(FLAT, "[[0,1,3],[1,2,3],[3,1,0]]"), ["3 faces meet", "1 and 3", "at most two"]),
        (
            folded("[[0,0],[2,0],[1,0],[0,2]]", "[[0,1,3],[0,2,1]]"),
            ["faces_vertices[1]", "no area", "delete"],
        ),
        (
            folded("[[0,0,0],[2,0,0],[2,2,2],[0,2,0]]", "[[0,1,2,3]]"),
            ["faces_vertices[0]", "not flat", "triangles"],
        ),
    ] {
        let error = refused(&text);
        assert!(parts.iter().all(|p| error.contains(p)), "{parts:?} are not all in: {error}");
    }
}

#[test]
fn frames_inherit_and_the_first_crease_pattern_is_read() {
    let text = format!(
        r#"{{"file_frames": [{{"frame_parent": 0, "frame_inherit": true, "frame_classes": ["foldedForm"], "frame_title": "done"}},
        {{"frame_parent": 3, "frame_inherit": true, "frame_classes": ["creasePattern"], "frame_unit": "cm"}},
        {{"frame_parent": 0, "frame_inherit": true, "frame_unit": "m"}}],
        "vertices_coords": {FLAT}, "edges_vertices": [[0,1],[1,2]], "edges_assignment": ["B","M"]}}"#
    );
    let (strokes, issues) = read(&text);
    assert_eq!(ends(&strokes[0])[1], v(20.0, 0.0), "inherited through frame 3, own unit");
    let note = said(&issues);
    assert!(
        note.contains(
            "frame 2 (creasePattern) is read; the others are frame 0, frame 1 'done' (foldedForm), frame 3"
        ),
        "{note}"
    );
    let third = ReadOptions { frame: Some(3), ..ReadOptions::default() };
    assert_eq!(ends(&read_with(&text, &third).unwrap().0[0])[1], v(2000.0, 0.0));
    let none = ReadOptions { frame: Some(4), ..ReadOptions::default() };
    let error = read_with(&text, &none).unwrap_err().to_string();
    assert!(error.contains("frame 4 is wanted, but the file has frames 0 to 3"), "{error}");
    let circle = text.replace(
        "\"frame_parent\": 0, \"frame_inherit\": true, \"frame_unit\"",
        "\"frame_parent\": 2, \"frame_inherit\": true, \"frame_unit\"",
    );
    assert!(refused(&circle).contains("inherits from itself"));
    assert!(
        refused(&text.replace("\"frame_parent\": 3", "\"frame_parent\": 9"))
            .contains("file_frames[1].frame_parent: it names frame 9")
    );
}

#[test]
fn faults_name_the_key_and_the_index() {
    for (old, new, parts) in [
        ("[2,3]", "[2,4]", vec!["edges_vertices[2]: ", "vertex 4, but there are 4"]),
        ("[2,3]", "[2,-1]", vec!["edges_vertices[2]: ", "-1"]),
        ("[2,3]", "[2]", vec!["edges_vertices[2]: ", "1 vertices, not 2"]),
        ("[2,3]", "7", vec!["edges_vertices[2]: ", "the number 7, not a list"]),
        ("[2,2]", "[2,null]", vec!["vertices_coords[2]: ", "null, not a finite number"]),
        ("[2,2]", "[2,1e999]", vec!["line 1", "not JSON"]),
        ("[2,2]", "[2,1e200]", vec!["vertices_coords[2]: ", "beyond 1e12"]),
        ("[2,2]", "[2,NaN]", vec!["line 1", "not JSON"]),
        ("[2,2]", "[2]", vec!["vertices_coords[2]: ", "1 coordinates, not 2 or 3"]),
        (r#""V""#, r#""X""#, vec!["edges_assignment[4]: ", "the text \"X\", none of B, M, V"]),
        (r#","V""#, "", vec!["edges_assignment: ", "4 entries for 5 edges"]),
        (r#"["B","B","B","B","V"]"#, r#""B""#, vec!["edges_assignment: ", "the text \"B\", not a list"]),
        (
            r#""V"]"#,
            r#""V"], "edges_foldAngle": [0,0,0,0,181]"#,
            vec!["edges_foldAngle[4]: ", "181 is not from -180 to 180"],
        ),
        (r#""V"]"#, r#""V"], "edges_foldAngle": [0]"#, vec!["edges_foldAngle: ", "1 entries for 5 edges"]),
        (
            r#""V"]"#,
            r#""V"], "faces_vertices": [[0,1]]"#,
            vec!["faces_vertices[0]: ", "2 vertices, not 3 or more"],
        ),
        (r#""V"]"#, r#""V"], "file_frames": [3]"#, vec!["file_frames[0]: ", "the number 3, not a frame"]),
        (
            r#""V"]"#,
            r#""V"], "softfold:edges_crease": []"#,
            vec!["softfold:edges_crease: ", "0 entries for 5 edges"],
        ),
        ("\"edges_v", "\n!\"edges_v", vec!["line 2: ", "not JSON"]),
    ] {
        let text = diagonal(FLAT, "").replacen(old, new, 1);
        let error = refused(&text);
        assert!(parts.iter().all(|p| error.contains(p)), "{parts:?} are not all in: {error}");
    }
    for (text, part) in
        [("", "empty"), ("[1]", "a list of 1, not a FOLD object"), ("{}", "no frame of the file has")]
    {
        assert!(refused(text).contains(part), "{text}");
    }
}

#[test]
fn deep_nesting_is_refused() {
    let text = "[".repeat(100_000);
    assert!(refused(&format!("{{\"file_frames\": {text}")).contains("not JSON"));
}

#[test]
fn keys_without_a_namespace_are_listed() {
    let (_, issues) = read(&diagonal(FLAT, r#", "colour": 1, "other:key": 2, "frame_title": "x""#));
    assert!(
        said(&issues).contains("1 keys that FOLD does not know are ignored: colour;"),
        "{}",
        said(&issues)
    );
}

#[test]
fn the_users_word_wins_over_the_assignment() {
    let elements = [("edge 4".to_owned(), None), ("edge 0".to_owned(), Some(Role::Cut))].into();
    let roles = RoleMap { elements, ..RoleMap::default() };
    let (strokes, issues) =
        read_with(&diagonal(FLAT, ""), &ReadOptions { roles, ..ReadOptions::default() }).unwrap();
    assert_eq!(strokes.iter().map(|s| s.role.letter()).collect::<String>(), "CBBB");
    assert!(said(&issues).contains("left out by the project's roles, 1 in all: 'edge 4'"));
}

#[test]
fn edges_of_one_crease_name_are_one_stroke() {
    let text = r#"{"vertices_coords": [[0,0],[1,0],[2,1],[9,9]], "frame_unit": "mm", "edges_vertices": [[0,1],[0,3],[2,1]],
      "edges_assignment": ["M","V","M"], "softfold:edges_crease": ["rim", null, "rim"]}"#;
    let (strokes, _) = read(text);
    assert_eq!(strokes.len(), 2);
    assert_eq!((strokes[0].origin.id.as_deref(), strokes[0].pieces.len()), (Some("rim"), 1));
    assert_eq!(ends(&strokes[0]), [v(0.0, 0.0), v(2.0, 1.0)]);
    assert_eq!(strokes[1].origin.label, "edge 1");
}

fn line(from: DVec2, to: DVec2) -> Segment {
    Segment::Line { from, to }
}

fn crease(i: usize, name: &str, role: Role, segments: Vec<Segment>, degrees: Option<f64>) -> Crease {
    Crease {
        id: CreaseId::new(i),
        name: name.to_owned(),
        role,
        curve: PlanarCurve::new(segments).unwrap(),
        fold_angle_rad: degrees.map(f64::to_radians),
        source: Source::default(),
    }
}

/// A sheet with a round hole, a slit on the outline, two creases that meet and one that ends on the outline
/// between its corners.
fn pattern(c: [DVec2; 2], meet: DVec2, degrees: f64) -> CreasePattern {
    let corners = [v(0.0, 0.0), v(200.0, 0.0), v(200.0, 100.0), v(0.0, 100.0), v(0.0, 0.0)];
    let r = 8.0 * 0.5522847498;
    let arc = |a: DVec2, b: DVec2| {
        let o = v(170.0, 50.0);
        Segment::Cubic {
            from: o + 8.0 * a,
            c1: o + 8.0 * a + r * b,
            c2: o + 8.0 * b + r * a,
            to: o + 8.0 * b,
        }
    };
    let hole =
        [DVec2::X, -DVec2::Y, -DVec2::X, DVec2::Y, DVec2::X].windows(2).map(|w| arc(w[0], w[1])).collect();
    let bent = vec![Segment::Cubic { from: v(50.0 / 3.0, 0.0), c1: c[0], c2: c[1], to: meet }];
    let role = if degrees < 0.0 { Role::Mountain } else { Role::Valley };
    CreasePattern {
        name: "a \"sheet\"".to_owned(),
        outline: PlanarCurve::polyline(&corners).unwrap(),
        holes: vec![PlanarCurve::new(hole).unwrap()],
        slits: vec![PlanarCurve::polyline(&[v(0.0, 100.0 / 3.0), v(10.0, 40.0)]).unwrap()],
        creases: vec![
            crease(0, "bent", role, bent, Some(degrees)),
            crease(1, "a & \"b\"", Role::Mountain, vec![line(meet, v(200.0, 70.0))], None),
            crease(2, "undecided", Role::Unassigned, vec![line(meet, v(90.0, 100.0))], Some(degrees)),
            crease(3, "flat", Role::Flat, vec![line(v(150.0, 0.0), v(150.0, 100.0))], None),
        ],
    }
}

fn sample() -> CreasePattern {
    pattern([v(30.0, 40.0), v(60.0, 10.0)], v(100.0, 60.0 + 1.0 / 3.0), 72.5)
}

fn assert_same(curve: &PlanarCurve, stroke: &Stroke) {
    let [piece] = &stroke.pieces[..] else {
        panic!("{} has {} pieces", stroke.origin.label, stroke.pieces.len())
    };
    assert_eq!(piece.len(), curve.segments().len(), "{}", stroke.origin.label);
    for (a, b) in curve.segments().iter().zip(piece) {
        let (a, b) = (a.control_points(), b.control_points());
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(p, q)| p.distance(*q) < 1e-9), "{a:?} {b:?}");
    }
}

fn assert_round_trip(pattern: &CreasePattern) {
    let text = write_fold(pattern, &WriteOptions::default());
    let (strokes, issues) = read(&text);
    assert_eq!(said(&issues), "");
    let loops = pattern.loops().map(|(_, c)| (c, Role::Boundary));
    let slits = pattern.slits.iter().map(|c| (c, Role::Cut));
    let plain: Vec<_> = loops.chain(slits).collect();
    assert_eq!(strokes.len(), plain.len() + pattern.creases.len());
    for ((curve, role), stroke) in plain.iter().zip(&strokes) {
        assert_eq!((stroke.role, stroke.fold_angle_rad, &stroke.origin.id), (*role, None, &None));
        assert_same(curve, stroke);
    }
    for (crease, stroke) in pattern.creases.iter().zip(&strokes[plain.len()..]) {
        assert_eq!((stroke.role, stroke.origin.id.as_deref()), (crease.role, Some(crease.name.as_str())));
        let angles = [stroke.fold_angle_rad, crease.fold_angle_rad].map(|a| a.map(f64::to_degrees));
        assert!(
            matches!(angles, [Some(a), Some(b)] if (a - b).abs() < 1e-9) || angles == [None, None],
            "{}: {angles:?}",
            crease.name
        );
        assert_same(&crease.curve, stroke);
    }
}

#[test]
fn curves_names_roles_and_angles_survive_writing() {
    assert_round_trip(&sample());
}

#[test]
fn ends_that_meet_still_meet_to_the_last_bit() {
    let (strokes, _) = read(&write_fold(&sample(), &WriteOptions::default()));
    let crease = |name: &str| strokes.iter().find(|s| s.origin.id.as_deref() == Some(name)).unwrap();
    let meet = ends(crease("bent"))[1];
    assert_eq!((ends(crease("a & \"b\""))[0], ends(crease("undecided"))[0]), (meet, meet));
}

#[test]
fn curves_whose_edges_were_changed_are_not_used() {
    let text = write_fold(&sample(), &WriteOptions::default());
    // Another program moves the end of the bent crease.
    let moved = text.replacen("[100,60.333333333333]", "[101,60.333333333333]", 1);
    assert_ne!(moved, text);
    let (strokes, issues) = read(&moved);
    assert!(said(&issues).contains("3 of the kept curves no longer fit"), "{}", said(&issues));
    let bent = strokes.iter().find(|s| s.origin.id.as_deref() == Some("bent")).unwrap();
    assert!(bent.pieces[0].len() > 4 && bent.pieces.len() == 1, "a chain of its edges");
    assert_eq!(ends(bent)[1], v(101.0, 60.333333333333));
    // And another one assigns all creases anew.
    let (strokes, _) = read(&text.replace("\"V\"", "\"M\"").replace("72.5", "-30"));
    let bent = strokes.iter().find(|s| s.origin.id.as_deref() == Some("bent")).unwrap();
    assert!((bent.fold_angle_rad.unwrap().to_degrees() + 30.0).abs() < 1e-9);
    assert_eq!((bent.role, bent.pieces[0].len()), (Role::Mountain, 1), "the curve is still the same");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any curve keeps its control points, and what ends on it its place.
    #[test]
    fn patterns_round_trip(
        c in prop::array::uniform4(5.0..95.0f64), meet in (60.0..140.0f64, 20.0..80.0f64), degrees in -179.0..179.0f64,
    ) {
        prop_assume!(degrees.abs() > 1e-6);
        assert_round_trip(&pattern([v(c[0], c[1]), v(c[2], c[3])], v(meet.0, meet.1), degrees));
    }

    /// Broken files give errors, never a panic.
    #[test]
    fn noise_is_refused(noise in "[ -~\n]{0,40}", at in 0.0..1.0f64) {
        let mut text = write_fold(&sample(), &WriteOptions { chord_mm: Some(5.0) });
        let at = (at * text.len() as f64) as usize;
        if text.is_char_boundary(at) {
            text.replace_range(at..(at + noise.len() / 2).min(text.len()), &noise);
        }
        let _ = read_with(&text, &ReadOptions::default()).is_err();
        let _ = read_with(&noise, &ReadOptions::default()).is_err();
    }
}
