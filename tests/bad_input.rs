//! Inputs at fault: one message that names the culprit, exit status 1, and nobody's files touched.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

mod common;

use common::Outcome;
use std::fs;
use std::path::PathBuf;

/// A copy of the sculpture's project that a test may spoil, and an output folder that somebody already uses.
struct Desk {
    folder: PathBuf,
}

impl Desk {
    fn new(name: &str) -> Self {
        let folder = common::fresh(&format!("bad-input-{name}"));
        fs::create_dir_all(folder.join("out")).unwrap();
        for (file, bytes) in common::contents(&common::fixture("sculpture")) {
            let to = folder.join(file);
            fs::create_dir_all(to.parent().unwrap()).unwrap();
            fs::write(to, bytes).unwrap();
        }
        fs::write(folder.join("out/report.json"), "the last good run").unwrap();
        fs::write(folder.join("out/notes.txt"), "mine").unwrap();
        Self { folder }
    }

    fn project(&self) -> PathBuf {
        self.folder.join("project.toml")
    }

    /// Rewrites the project's lines, and makes sure that something changed.
    fn rewrite(&self, change: impl Fn(&str) -> String) -> &Self {
        let before = fs::read_to_string(self.project()).expect("project.toml");
        let after = change(&before);
        assert_ne!(before, after, "the project was not changed: was a key renamed?");
        fs::write(self.project(), after).unwrap();
        self
    }

    /// Gives a key of a table another value; the top of the file is the table "".
    fn set(&self, table: &str, key: &str, value: &str) -> &Self {
        self.rewrite(|text| set_key(text, table, key, value))
    }

    fn pattern(&self, drawing: &str) -> &Self {
        let file = self.folder.join("pattern.svg");
        assert!(file.is_file(), "the project's pattern was renamed");
        fs::write(file, drawing).unwrap();
        self
    }

    /// Runs, and checks what every refusal has in common; gives the message.
    fn refusal(&self) -> String {
        let before = common::contents(&self.folder);
        let outcome = common::run(&self.project(), &self.folder.join("out"));
        let message = message_of(&outcome);
        assert_eq!(common::contents(&self.folder), before, "files were touched");
        message
    }

    /// Fails unless the refusal holds every one of these words.
    fn refuses_with(&self, words: &[&str]) {
        let message = self.refusal();
        let lower = message.to_lowercase();
        let absent: Vec<&&str> = words.iter().filter(|word| !lower.contains(&word.to_lowercase())).collect();
        assert!(absent.is_empty(), "{absent:?} not said in:\n{message}");
    }
}

/// The one message of a run that ends with status 1.
fn message_of(outcome: &Outcome) -> String {
    assert_eq!(outcome.code, Some(1), "{}{}", outcome.stdout, outcome.stderr);
    let errors = outcome.stderr.lines().filter(|line| line.starts_with("error")).count();
    assert_eq!(errors, 1, "one message:\n{}", outcome.stderr);
    assert!(!outcome.stderr.contains("panicked"), "{}", outcome.stderr);
    outcome.stderr.clone()
}

fn set_key(text: &str, table: &str, key: &str, value: &str) -> String {
    let mut current = String::new();
    let mut found = 0;
    let mut lines = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.trim().strip_prefix('[') {
            current = name.split(']').next().unwrap_or_default().to_owned();
        }
        let here = current == table && line.split_once('=').is_some_and(|(name, _)| name.trim() == key);
        found += usize::from(here);
        lines.push(if here { format!("{key} = {value}") } else { line.to_owned() });
    }
    assert_eq!(found, 1, "[{table}] {key} stands {found} times in the project");
    lines.join("\n") + "\n"
}

/// A sheet of 400 mm with the given outline and one valley crease.
fn drawing(outline: &str, crease: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"400mm\" height=\"400mm\" viewBox=\"0 0 400 400\">\n\
         <path id=\"outline\" d=\"{outline}\" fill=\"none\" stroke=\"#000000\"/>\n\
         <path id=\"crease-1\" d=\"{crease}\" fill=\"none\" stroke=\"#0000ff\"/>\n</svg>\n"
    )
}

const SQUARE: &str = "M 0 0 H 400 V 400 H 0 Z";
const ARC: &str = "M 0 200 Q 200 120 400 200";

#[test]
fn an_absent_project_is_named() {
    let folder = common::fresh("bad-input-absent");
    fs::create_dir_all(&folder).unwrap();
    let message = message_of(&common::run(&folder.join("nowhere.toml"), &folder.join("out")));
    assert!(message.contains("nowhere.toml"), "{message}");
    assert!(!folder.join("out").exists());
}

#[test]
fn an_absent_pattern_is_named() {
    let desk = Desk::new("no-pattern");
    desk.rewrite(|text| text.replace("\"pattern.svg\"", "\"nowhere.svg\"")).refuses_with(&["nowhere.svg"]);
}

#[test]
fn an_empty_project_is_refused() {
    let desk = Desk::new("empty-project");
    desk.rewrite(|_| String::new()).refuses_with(&["project.toml", "pattern"]);
}

#[test]
fn an_unknown_key_is_named_with_its_line() {
    let desk = Desk::new("unknown-key");
    desk.rewrite(|text| text.replacen("[soften]\n", "[soften]\nradius_inch = 2\n", 1));
    let text = fs::read_to_string(desk.project()).unwrap();
    let line = 1 + text.lines().position(|line| line.starts_with("radius_inch")).unwrap();
    desk.refuses_with(&["project.toml", "radius_inch", &line.to_string()]);
}

#[test]
fn a_line_that_is_no_toml_is_named() {
    let desk = Desk::new("no-toml");
    desk.rewrite(|text| text.replacen("[soften]", "[soften", 1)).refuses_with(&["project.toml", "line"]);
}

#[test]
fn a_word_instead_of_a_number_is_named() {
    Desk::new("word")
        .set("board", "thickness_mm", "\"thick\"")
        .refuses_with(&["project.toml", "thickness_mm"]);
}

#[test]
fn thickness_must_be_a_positive_number() {
    for (name, value) in [("negative", "-3.0"), ("zero", "0.0"), ("nan", "nan"), ("infinite", "inf")] {
        let desk = Desk::new(&format!("thickness-{name}"));
        desk.set("board", "thickness_mm", value).refuses_with(&["thickness", "positive"]);
    }
}

#[test]
fn a_radius_must_be_a_number_that_is_not_negative() {
    for (name, value) in [("negative", "-1.0"), ("nan", "nan")] {
        Desk::new(&format!("radius-{name}")).set("soften", "radius_mm", value).refuses_with(&["radius"]);
    }
}

#[test]
fn a_radius_too_large_is_told_with_crease_place_and_the_largest_that_fits() {
    Desk::new("radius-large")
        .set("soften", "radius_mm", "5000.0")
        .refuses_with(&["crease", "radius", "mm", "largest"]);
}

#[test]
fn an_open_outline_is_told_with_its_place() {
    let desk = Desk::new("open-outline");
    desk.pattern(&drawing("M 0 0 H 400 V 400 H 60", ARC)).refuses_with(&["pattern.svg", "outline", "400"]);
}

#[test]
fn a_pattern_without_an_outline_is_refused() {
    let desk = Desk::new("no-outline");
    desk.pattern(&drawing(ARC, ARC)).refuses_with(&["pattern.svg", "outline"]);
}

#[test]
fn a_crease_that_leaves_the_sheet_is_named() {
    let desk = Desk::new("crease-leaves");
    desk.pattern(&drawing(SQUARE, "M 200 100 L 200 560")).refuses_with(&["pattern.svg", "crease-1"]);
}

#[test]
fn coordinates_that_are_no_numbers_are_refused() {
    for (name, crease) in [("nan", "M NaN 200 L 400 200"), ("huge", "M 0 200 L 1e999 200")] {
        let desk = Desk::new(&format!("coordinates-{name}"));
        desk.pattern(&drawing(SQUARE, crease)).refuses_with(&["pattern.svg"]);
    }
}

#[test]
fn a_file_that_is_no_drawing_is_named() {
    for (name, text) in [("empty", ""), ("torn", "<svg><path d=\"M 0 0"), ("other", "solid stl")] {
        Desk::new(&format!("drawing-{name}")).pattern(text).refuses_with(&["pattern.svg"]);
    }
}

#[test]
fn a_wrong_command_line_is_no_fault_of_the_input() {
    let code = |arguments: &[&str]| {
        common::softfold(&arguments.iter().map(std::path::Path::new).collect::<Vec<_>>()).code
    };
    assert_eq!(code(&["run"]), Some(2));
    assert_eq!(code(&["bend", "project.toml"]), Some(2));
    assert_eq!(code(&["--help"]), Some(0));
}

#[test]
fn set_key_changes_that_key_alone() {
    let text = "a = 1\n[soften]\na = 2 # note\nb = 3\n[board]\na = 4\n";
    assert_eq!(set_key(text, "soften", "a", "9"), "a = 1\n[soften]\na = 9\nb = 3\n[board]\na = 4\n");
    assert_eq!(set_key(text, "", "a", "9"), "a = 9\n[soften]\na = 2 # note\nb = 3\n[board]\na = 4\n");
}
