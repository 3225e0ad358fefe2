//! .cp, .opx and .ori: roles, the axis, and faults with their lines.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use proptest::prelude::*;
use softfold_geometry::{CreasePattern, DVec2, Issue, Role};
use softfold_pattern::{Format, ReadOptions, RoleMap, read};

/// Type, x1, y1, x2, y2: a sheet of 400 × 200 with y down, a mountain, a valley higher up, an auxiliary line.
const LINES: [(u8, [f64; 4]); 7] = [
    (1, [-200.0, -100.0, 200.0, -100.0]),
    (1, [200.0, -100.0, 200.0, 100.0]),
    (1, [200.0, 100.0, -200.0, 100.0]),
    (1, [-200.0, 100.0, -200.0, -100.0]),
    (2, [-200.0, 50.0, 200.0, 0.0]),
    (3, [-200.0, -50.0, 200.0, -50.0]),
    (4, [-200.0, -80.0, 200.0, -80.0]),
];

fn cp() -> String {
    let line = |(k, [a, b, c, d]): &(u8, [f64; 4])| format!("{k} {a} {b} {c} {d}\r\n");
    format!("# a comment\r\n\r\n{}", LINES.iter().map(line).collect::<String>())
}

/// As ORIPA writes it: properties that are 0 are left out.
fn opx() -> String {
    let property = |name: &str, kind: &str, value: f64| match value {
        0.0 => String::new(),
        _ => format!("      <void property=\"{name}\">\n       <{kind}>{value}</{kind}>\n      </void>\n"),
    };
    let line = |(i, (k, [a, b, c, d])): (usize, &(u8, [f64; 4]))| {
        let k = if *k == 4 { 0.0 } else { f64::from(*k) };
        let ends =
            [("x0", a), ("x1", c), ("y0", b), ("y1", d)].map(|(n, x)| property(n, "double", *x)).concat();
        format!(
            "    <void index=\"{i}\">\n     <object class=\"oripa.OriLineProxy\">\n{}{ends}     </object>\n    </void>\n",
            property("type", "int", k)
        )
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<java version=\"1.5.0_05\" class=\"java.beans.XMLDecoder\">\n \
         <object class=\"oripa.DataSet\">\n  <void property=\"paperSize\"><double>400.0</double></void>\n  \
         <void property=\"lines\">\n   <array class=\"oripa.OriLineProxy\" length=\"7\">\n{}   </array>\n  </void>\n \
         </object>\n</java>\n",
        LINES.iter().enumerate().map(line).collect::<String>()
    )
}

fn ori() -> String {
    let colour = |k: u8| ["", "BLACK_0", "RED_1", "BLUE_2", "CYAN_3"][usize::from(k)];
    let line = |(k, [a, b, c, d]): &(u8, [f64; 4])| {
        format!(r#"{{"a":"{a:?},{b:?}","b":"{c:?},{d:?}","color":"{}","selected":0}}"#, colour(*k))
    };
    let lines: Vec<String> = LINES.iter().map(line).collect();
    format!(
        r#"{{"@version":"v1.1","lineSegments":[{}],"circles":[{{"x":1.0}}],"texts":[],"title":"_"}}"#,
        lines.join(",")
    )
}

fn options() -> ReadOptions {
    ReadOptions { unit_mm: Some(0.5), ..ReadOptions::default() }
}

fn pattern(text: &str, format: Format, options: &ReadOptions) -> (CreasePattern, Vec<Issue>) {
    let file = read(text.as_bytes(), format, "test", options).unwrap_or_else(|e| panic!("{e}"));
    file.pattern.check().unwrap();
    (file.pattern, file.issues)
}

fn said(issues: &[Issue]) -> String {
    issues.iter().map(|i| format!("{i}\n")).collect()
}

#[test]
fn all_three_give_the_same_pattern_with_v_up() {
    for (text, format) in [(cp(), Format::Cp), (opx(), Format::Opx), (ori(), Format::Ori)] {
        let (p, issues) = pattern(&text, format, &options());
        assert!((p.area_mm2() - 200.0 * 100.0).abs() < 1e-9);
        let found: Vec<_> = p.creases.iter().map(|c| (c.role, c.curve.end(0), c.curve.end(1))).collect();
        let v = DVec2::new;
        assert_eq!(
            found,
            [
                (Role::Mountain, v(-100.0, -25.0), v(100.0, 0.0)),
                (Role::Valley, v(-100.0, 25.0), v(100.0, 25.0)),
                (Role::Flat, v(-100.0, 40.0), v(100.0, 40.0)),
            ],
            "{format:?}"
        );
        assert!(p.creases.iter().all(|c| c.fold_angle_rad.is_none()));
        assert_eq!(said(&issues).contains("circles left out (1)"), format == Format::Ori);
    }
}

#[test]
fn lines_of_the_file_are_named() {
    assert_eq!(pattern(&cp(), Format::Cp, &options()).0.creases[0].source.line, Some(7));
    assert_eq!(pattern(&opx(), Format::Opx, &options()).0.creases[1].source.element, "line 6");
    let source = &pattern(&ori(), Format::Ori, &options()).0.creases[0].source;
    assert_eq!((source.element.as_str(), source.line), ("lineSegments[4]", None));
}

#[test]
fn the_unit_is_told_where_the_user_gives_none() {
    for (text, format) in [(cp(), Format::Cp), (opx(), Format::Opx), (ori(), Format::Ori)] {
        let (p, issues) = pattern(&text, format, &ReadOptions::default());
        assert!((p.size_mm() - 400.0).abs() < 1e-9);
        assert!(said(&issues).contains("one unit is taken as 1 mm"));
    }
}

#[test]
fn what_is_no_crease_is_left_out_and_told() {
    let text = cp() + "0 0 0 10 0\n0 0 0 20 0\n7 0 0 10 0\n2 5 5 5 5\n";
    let (p, issues) = pattern(&text, Format::Cp, &options());
    assert_eq!(p.creases.len(), 3);
    for part in [
        "line 10: 2 lines of type 0 left out: 'line 8' (line 10), 'line 9' (line 11)",
        "1 line of type 7 left out",
        "line 13: 1 line without length left out",
    ] {
        assert!(said(&issues).contains(part), "{part} is not in: {}", said(&issues));
    }
    let (_, issues) = pattern(&ori().replace("CYAN_3", "MAGENTA_5"), Format::Ori, &options());
    assert!(said(&issues).contains("1 line of MAGENTA_5 left out: 'lineSegments[6]'"));
}

#[test]
fn the_user_speaks_of_types_as_of_layers() {
    for (text, format, kind) in
        [(cp(), Format::Cp, "type 4"), (opx(), Format::Opx, "Type 0"), (ori(), Format::Ori, "cyan_3")]
    {
        let roles = |role| RoleMap { layers: [(kind.to_owned(), role)].into(), ..RoleMap::default() };
        let with = |role| ReadOptions { roles: roles(role), ..options() };
        let (p, _) = pattern(&text, format, &with(Some(Role::Unassigned)));
        assert_eq!(p.creases[2].role, Role::Unassigned, "{format:?}");
        assert_eq!(pattern(&text, format, &with(None)).0.creases.len(), 2);
    }
}

#[test]
fn faults_are_refused_with_their_place_and_the_mend() {
    let bad = |text: String, old: &str, new: &str| text.replacen(old, new, 1);
    for (text, format, parts) in [
        (String::new(), Format::Cp, ["line 1", "empty"]),
        ("1 0 0 1\n".into(), Format::Cp, ["line 1: line 1: ", "type x1 y1 x2 y2"]),
        ("# c\n1 0 0 1 0 0\n".into(), Format::Cp, ["line 2: ", "four coordinates"]),
        ("1 0 0 1 0\n2 0 0 inf 0\n".into(), Format::Cp, ["line 2: ", "x2 is \"inf\", not a finite number"]),
        ("1 0 0 1e300 0\n".into(), Format::Cp, ["x2 is \"1e300\"", "beyond 1e12"]),
        ("M 0 0 1 0\n".into(), Format::Cp, ["line 1: ", "type is \"M\", not a whole number"]),
        ("0 0 0 1 0\n".into(), Format::Cp, ["no lines of a pattern", "draw the outline"]),
        (String::new(), Format::Opx, ["line 1", "empty"]),
        ("<java>\n</object>".into(), Format::Opx, ["line 2", "not XML"]),
        ("\n<svg/>".into(), Format::Opx, ["line 2", "<svg>, not the <java>"]),
        ("<java/>".into(), Format::Opx, ["no lines of a pattern", ""]),
        (bad(opx(), "<int>1", "<int>one"), Format::Opx, ["line 8: line 1: ", "type is \"one\""]),
        (bad(opx(), "<double>-200", "<double>x"), Format::Opx, ["line 1: ", "x0 is \"x\""]),
        (String::new(), Format::Ori, ["line 1", "export .fold or .cp"]),
        ("\u{1}\u{2}old".into(), Format::Ori, ["no save of Oriedita", "export .fold or .cp"]),
        ("[]".into(), Format::Ori, ["no save of Oriedita", "export .fold or .cp"]),
        ("{}".into(), Format::Ori, ["the save has no version", "export .fold or .cp"]),
        (bad(ori(), "v1.1", "unknown"), Format::Ori, ["version of the save is \"unknown\"", "export"]),
        (bad(ori(), "lineSegments", "lines"), Format::Ori, ["no list \"lineSegments\"", "export"]),
        (bad(ori(), r#""color":"RED_1","#, ""), Format::Ori, ["lineSegments[4]: ", "has no \"color\""]),
        (
            bad(ori(), "-200.0,50.0", "-200.0;50.0"),
            Format::Ori,
            ["lineSegments[4]: ", "a is \"-200.0;50.0\", not \"x,y\""],
        ),
        (bad(ori(), "-200.0,50.0", "-200.0,NaN"), Format::Ori, ["lineSegments[4]: ", "not a finite number"]),
    ] {
        let error = read(text.as_bytes(), format, "t", &options()).unwrap_err().to_string();
        assert!(parts.iter().all(|p| error.contains(p)), "{parts:?} are not all in: {error}");
    }
    let error = read(b"1 0 0\n\xff", Format::Cp, "t", &options()).unwrap_err().to_string();
    assert!(error.contains("line 2") && error.contains("UTF-8"), "{error}");
}

#[test]
fn other_saves_of_oriedita_are_read() {
    let old = ori().replace(r#""@version":"v1.1""#, r#""version":"0.0.11""#);
    assert_eq!(pattern(&old, Format::Ori, &options()).0.creases.len(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Text of any kind gives an error or a pattern, never a panic.
    #[test]
    fn noise_does_no_harm(noise in "[ -~\n]{0,40}", at in 0.0..1.0f64) {
        for (mut text, format) in [(cp(), Format::Cp), (opx(), Format::Opx), (ori(), Format::Ori)] {
            let at = (at * text.len() as f64) as usize;
            text.replace_range(at..(at + noise.len() / 2).min(text.len()), &noise);
            let _ = read(text.as_bytes(), format, "t", &options()).is_err();
            let _ = read(noise.as_bytes(), format, "t", &options()).is_err();
        }
    }
}
