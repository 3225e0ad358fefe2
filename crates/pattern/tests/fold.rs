//! FOLD from bytes to a pattern and back, and what is written against the rules of FOLD 1.2.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use serde_json::Value;
use softfold_geometry::{Crease, CreaseId, CreasePattern, DVec2, PlanarCurve, Role, Segment, Source};
use softfold_pattern::{Format, PatternFile, ReadOptions, WriteOptions, read, write_cp, write_fold};

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn read_fold(text: &str) -> PatternFile {
    let file = read(text.as_bytes(), Format::Fold, "test", &ReadOptions::default());
    let file = file.unwrap_or_else(|e| panic!("{e}"));
    file.pattern.check().unwrap();
    file
}

fn crease(i: usize, name: &str, role: Role, segment: Segment, degrees: Option<f64>) -> Crease {
    Crease {
        id: CreaseId::new(i),
        name: name.to_owned(),
        role,
        curve: PlanarCurve::new(vec![segment]).unwrap(),
        fold_angle_rad: degrees.map(f64::to_radians),
        source: Source::default(),
    }
}

/// A square sheet with a square hole and one crease of each role, which do not meet.
fn pattern() -> CreasePattern {
    let square = |low: f64, high: f64| {
        let p = [v(low, low), v(high, low), v(high, high), v(low, high), v(low, low)];
        PlanarCurve::polyline(&p).unwrap()
    };
    let bent = Segment::Cubic { from: v(20.0, 0.0), c1: v(50.0, 30.0), c2: v(0.0, 70.0), to: v(30.0, 100.0) };
    let line = |x: f64| Segment::Line { from: v(x, 0.0), to: v(x + 1.0, 100.0) };
    CreasePattern {
        name: "test".to_owned(),
        outline: square(0.0, 100.0),
        holes: vec![square(60.0, 64.0).reversed()],
        slits: Vec::new(),
        creases: vec![
            crease(0, "bent", Role::Mountain, bent, Some(-72.5)),
            crease(1, "straight", Role::Valley, line(50.0), None),
            crease(2, "open", Role::Unassigned, line(80.0), None),
            crease(3, "ruling", Role::Flat, line(90.0), None),
        ],
    }
}

fn with_slit() -> CreasePattern {
    let slit = PlanarCurve::polyline(&[v(0.0, 50.0), v(10.0, 50.0)]).unwrap();
    CreasePattern { slits: vec![slit], ..pattern() }
}

#[test]
fn a_written_pattern_reads_back_the_same() {
    let first = pattern();
    let text = write_fold(&first, &WriteOptions::default());
    let file = read_fold(&text);
    let second = file.pattern;
    assert_eq!(second.creases.len(), first.creases.len());
    for (a, b) in first.creases.iter().zip(&second.creases) {
        assert_eq!((&a.name, a.role), (&b.name, b.role));
        let apart = |a: f64, b: f64| (a - b).abs();
        assert!(apart(a.fold_angle_rad.unwrap_or(9.0), b.fold_angle_rad.unwrap_or(9.0)) < 1e-9, "{}", a.name);
        for k in 0..=10 {
            let share = f64::from(k) / 10.0;
            let at = |c: &PlanarCurve| c.point(share * c.length_mm());
            assert!(at(&a.curve).distance(at(&b.curve)) < 1e-9, "{}", a.name);
        }
    }
    assert!((second.area_mm2() - first.area_mm2()).abs() < 1e-9);
    assert_eq!(write_fold(&second, &WriteOptions::default()), text, "the second writing is the same bytes");
}

/// The rules of FOLD 1.2 that a crease pattern must keep.
fn assert_is_fold_1_2(text: &str) {
    let file: Value = serde_json::from_str(text).unwrap();
    assert_eq!(file["file_spec"], 1.2);
    for (key, allowed) in [
        ("file_classes", &["singleModel", "multiModel", "animation", "diagrams"][..]),
        ("frame_classes", &["creasePattern", "foldedForm", "graph", "linkage"]),
        ("frame_attributes", &["2D", "cuts", "noCuts"]),
    ] {
        let values = file[key].as_array().unwrap();
        assert!(values.iter().all(|v| allowed.contains(&v.as_str().unwrap())), "{key}");
    }
    assert_eq!(file["frame_unit"], "mm");
    let list = |key: &str| file[key].as_array().unwrap_or_else(|| panic!("{key}")).clone();
    let vertices = list("vertices_coords");
    assert!(
        vertices
            .iter()
            .all(|p| p.as_array().unwrap().iter().filter(|x| x.is_f64() || x.is_i64()).count() == 2)
    );
    let edges = list("edges_vertices");
    for e in &edges {
        let ends: Vec<u64> = e.as_array().unwrap().iter().map(|i| i.as_u64().unwrap()).collect();
        assert!(ends.len() == 2 && ends[0] != ends[1] && ends.iter().all(|&i| (i as usize) < vertices.len()));
    }
    let letters = list("edges_assignment");
    let angles = list("edges_foldAngle");
    for key in file.as_object().unwrap().keys().filter(|k| k.contains("edges_")) {
        assert_eq!(list(key).len(), edges.len(), "{key}");
    }
    for (letter, angle) in letters.iter().zip(&angles) {
        let degrees = angle.as_f64().unwrap();
        let fits = match letter.as_str().unwrap() {
            "M" => (-180.0..0.0).contains(&degrees),
            "V" => degrees > 0.0 && degrees <= 180.0,
            "B" | "F" | "U" | "C" => degrees == 0.0,
            _ => false,
        };
        assert!(fits, "{letter} {degrees}");
    }
    let known = ["file_", "frame_", "vertices_", "edges_", "softfold:"];
    assert!(file.as_object().unwrap().keys().all(|k| known.iter().any(|p| k.starts_with(p))));
}

#[test]
fn what_is_written_keeps_the_rules_of_fold() {
    for chord_mm in [None, Some(1.0), Some(-1.0), Some(f64::NAN)] {
        assert_is_fold_1_2(&write_fold(&with_slit(), &WriteOptions { chord_mm }));
    }
    let text = write_fold(&with_slit(), &WriteOptions::default());
    assert!(text.contains("\"cuts\"") && text.contains("\"C\""));
    assert!(write_fold(&pattern(), &WriteOptions::default()).contains("\"noCuts\""));
}

#[test]
fn edges_keep_the_chord_error_and_meet_at_common_vertices() {
    let first = pattern();
    for chord_mm in [1.0, 0.01] {
        let text = write_fold(&first, &WriteOptions { chord_mm: Some(chord_mm) });
        let file: Value = serde_json::from_str(&text).unwrap();
        let vertex = |i: &Value| {
            let p = &file["vertices_coords"][i.as_u64().unwrap() as usize];
            v(p[0].as_f64().unwrap(), p[1].as_f64().unwrap())
        };
        let mut degree = vec![0; file["vertices_coords"].as_array().unwrap().len()];
        for (e, edge) in file["edges_vertices"].as_array().unwrap().iter().enumerate() {
            edge.as_array().unwrap().iter().for_each(|i| degree[i.as_u64().unwrap() as usize] += 1);
            if file["softfold:edges_crease"][e] == "bent" {
                let middle = 0.5 * (vertex(&edge[0]) + vertex(&edge[1]));
                assert!(first.creases[0].curve.nearest(middle).1 <= chord_mm);
            }
        }
        // Four creases end on the outline twice each: there three edges meet.
        assert_eq!(degree.iter().filter(|&&d| d == 3).count(), 8);
        assert!(degree.iter().all(|&d| d == 2 || d == 3));
    }
}

#[test]
fn a_pattern_of_straight_edges_becomes_outline_and_creases() {
    let text = r#"{"file_spec": 1.1, "frame_unit": "cm", "vertices_coords": [[0,0],[2,0],[4,0],[4,3],[2,3],[0,3]],
      "edges_vertices": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,0],[1,4]], "edges_assignment": ["B","B","B","B","B","B","M"],
      "edges_foldAngle": [0,0,0,0,0,0,-90]}"#;
    let p = read_fold(text).pattern;
    assert!((p.area_mm2() - 1200.0).abs() < 1e-9);
    let [c] = &p.creases[..] else { panic!("{} creases", p.creases.len()) };
    assert_eq!((c.role, c.fold_angle_rad), (Role::Mountain, Some(-90.0_f64.to_radians())));
    assert_eq!((c.source.element.as_str(), c.source.line), ("edge 6", None));
    assert!((c.curve.length_mm() - 30.0).abs() < 1e-9);
}

#[test]
fn a_refused_file_gives_all_that_was_found() {
    let text = r#"{"vertices_coords": [[0,0],[1,0]], "edges_vertices": [[0,1],[1,2]], "colour": 3}"#;
    let refused = read(text.as_bytes(), Format::Fold, "t", &ReadOptions::default()).unwrap_err();
    assert_eq!(refused.error.issue().element.as_deref(), Some("edges_vertices[1]"));
    assert_eq!(refused.issues.len(), 2, "{:?}", refused.issues);
    assert!(!refused.error.issue().mend.is_empty());
}

#[test]
fn cp_lines_read_back_to_the_same_pattern() {
    let first = pattern();
    let text = write_cp(&first, &WriteOptions { chord_mm: Some(0.001) });
    assert!(text.lines().all(|l| l.split(' ').count() == 5 && "1234".contains(&l[..1])), "{text}");
    let second = read(text.as_bytes(), Format::Cp, "test", &ReadOptions::default()).unwrap().pattern;
    assert!((second.area_mm2() - first.area_mm2()).abs() < 1e-9);
    let [bent, straight, ..] = &second.creases[..] else { panic!("{} creases", second.creases.len()) };
    assert_eq!((bent.role, straight.role), (Role::Mountain, Role::Valley));
    assert!((bent.curve.length_mm() - first.creases[0].curve.length_mm()).abs() < 1e-3);
    assert!(straight.curve.end(0).distance(v(50.0, 0.0)) < 1e-9, "v up again");
}
