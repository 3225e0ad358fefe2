//! Roles in SVG: the user's word, then data-assignment, then colours, then layers; and slits in what is written.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests fail by panicking

use softfold_geometry::{CreasePattern, DVec2, Issue, PlanarCurve, Role, Severity};
use softfold_pattern::{Format, PatternFile, ReadOptions, RoleMap, read, write_svg};

/// A 200 × 100 mm drawing: line 1 the head, line 2 the outline, line 3 and on the body.
fn drawing(body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
         width=\"200mm\" height=\"100mm\" viewBox=\"0 0 200 100\" fill=\"none\">\n\
         <rect width=\"200\" height=\"100\" stroke=\"black\"/>\n{body}\n</svg>"
    )
}

fn file(body: &str, roles: RoleMap) -> PatternFile {
    let options = ReadOptions { roles, ..ReadOptions::default() };
    read(drawing(body).as_bytes(), Format::Svg, "test", &options).unwrap_or_else(|e| panic!("{e}"))
}

fn letters(file: &PatternFile) -> String {
    file.pattern.creases.iter().map(|c| c.role.letter()).collect()
}

fn note<'a>(file: &'a PatternFile, part: &str) -> &'a Issue {
    let found = file.issues.iter().find(|i| i.to_string().contains(part));
    found.unwrap_or_else(|| panic!("'{part}' is not in {:#?}", file.issues))
}

#[test]
fn the_users_word_wins_over_everything() {
    let body = r##"<g inkscape:label="Folds" id="layer1">
<path id="a" d="M20 0V100" stroke="red" data-assignment="M"/>
<path id="b" d="M40 0V100" stroke="red" data-assignment="M"/></g>
<path d="M60 0V100" stroke="#ff8000"/><path id="d" d="M80 0V100" stroke="blue"/>"##;
    let by_layer = |name: &str| RoleMap {
        layers: [(name.to_owned(), Some(Role::Flat))].into(),
        elements: [("b".to_owned(), Some(Role::Unassigned)), ("d".to_owned(), None)].into(),
        colours: vec![([255, 128, 0], Some(Role::Mountain))],
    };
    for name in ["folds", "LAYER1"] {
        let read = file(body, by_layer(name));
        assert_eq!(letters(&read), "FUM", "{name}");
        let left = note(&read, "left out by the project's roles");
        assert_eq!((left.severity, left.line), (Severity::Note, Some(6)));
        assert!(left.message.contains("'d' (line 6)"));
    }
}

#[test]
fn the_name_that_illustrator_keeps_beside_the_id_is_a_layers_name() {
    let body = r#"<g id="Up_2" data-name="Up folds"><path d="M20 0V100" stroke="black"/></g>"#;
    let layers = [("Up folds".to_owned(), Some(Role::Valley))].into();
    assert_eq!(letters(&file(body, RoleMap { layers, ..RoleMap::default() })), "V");
}

#[test]
fn the_innermost_layer_decides() {
    let body = r#"<g id="outer"><g id="inner"><path d="M20 0V100" stroke="red"/></g></g>"#;
    let layers = [("outer".to_owned(), Some(Role::Flat)), ("inner".to_owned(), Some(Role::Valley))].into();
    assert_eq!(letters(&file(body, RoleMap { layers, ..RoleMap::default() })), "V");
}

#[test]
fn data_assignment_wins_over_the_colour_and_the_colour_over_the_layers_name() {
    let body = r##"<g inkscape:label="Mountain lines"><path d="M20 0V100" stroke="blue" data-assignment="U"/>
<path d="M40 0V100" stroke="blue"/><path d="M60 0V100" stroke="#888"/></g><path d="M80 0V100" stroke="#888"/>"##;
    let read = file(body, RoleMap::default());
    assert_eq!(letters(&read), "UVM");
    let told = note(&read, "taken as mountain");
    assert!(
        told.message.contains("layer 'Mountain lines'") && told.message.contains("'path 3' (line 4)"),
        "{told}"
    );
    assert_eq!(note(&read, "is no role").line, Some(4));
}

#[test]
fn a_colour_taken_for_its_neighbour_is_told_once_with_its_distance() {
    let body = r##"<path d="M20 0V100" stroke="#dc143c"/><path d="M40 0V100" stroke="#dc143c"/>
<path d="M60 0V100" stroke="#4169e1"/><path d="M80 0V100" stroke="green"/>"##;
    let read = file(body, RoleMap::default());
    let told: Vec<&str> =
        read.issues.iter().map(|i| i.message.as_str()).filter(|m| m.contains("taken as")).collect();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(
        told[0].starts_with("stroke #4169e1 is taken as valley (distance 127 of at most 130): 'path 3'"),
        "{told:?}"
    );
    assert!(
        told[1].starts_with("stroke #dc143c is taken as mountain (distance 72 of at most 130)"),
        "{told:?}"
    );
}

#[test]
fn lines_that_are_left_out_may_leave_nothing() {
    let text = drawing("").replace("<rect", "<rect id=\"r\"");
    let elements = [("r".to_owned(), None)].into();
    let options = ReadOptions { roles: RoleMap { elements, ..RoleMap::default() }, ..ReadOptions::default() };
    let refused = read(text.as_bytes(), Format::Svg, "t", &options).unwrap_err();
    assert!(refused.to_string().contains("nothing is drawn"));
    assert!(refused.issues.iter().any(|i| i.message.contains("left out by the project's roles")));
}

#[test]
fn slits_are_written_as_cuts() {
    let pattern =
        file(r#"<path id="fold" d="M50 0V100" stroke="red" data-foldAngle="-30"/>"#, RoleMap::default())
            .pattern;
    let slit = PlanarCurve::polyline(&[DVec2::new(0.0, 20.0), DVec2::new(30.0, 25.0)]).unwrap();
    let text = write_svg(&CreasePattern { slits: vec![slit], ..pattern });
    for part in [
        r##"<path id="slit-1" stroke="#00ff00" data-assignment="C" d="M0 80 L30 75"/>"##,
        r##"<path id="fold" stroke="#ff0000" data-assignment="M" opacity="0.166667" data-foldAngle="-30" d="M50 0 L50 100"/>"##,
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
}
