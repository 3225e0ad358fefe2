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
        assert_says(&self.refusal(), words);
    }

    /// The refusal in its parts; it must be about this file of the desk.
    fn told_of(&self, file: &str) -> Told {
        Told::parse(&self.refusal(), file)
    }

    /// The one line of the project with this key of this table, from 1.
    fn line_of(&self, table: &str, key: &str) -> usize {
        let lines = lines_of(&fs::read_to_string(self.project()).unwrap(), table, key);
        assert_eq!(lines.len(), 1, "[{table}] {key} stands on the lines {lines:?}");
        lines[0]
    }
}

fn assert_says(text: &str, words: &[&str]) {
    let lower = text.to_lowercase();
    let absent: Vec<&&str> = words.iter().filter(|word| !lower.contains(&word.to_lowercase())).collect();
    assert!(absent.is_empty(), "{absent:?} not said in:\n{text}");
}

/// A refusal in its parts: `error: PATH:LINE: element: what at (u, v) mm; mend`.
#[derive(Debug)]
struct Told {
    line: Option<usize>,
    what: String,
    mend: String,
}

impl Told {
    fn parse(message: &str, file: &str) -> Self {
        let said = message.lines().find_map(|line| line.strip_prefix("error: ")).expect("an error");
        let (_, rest) =
            said.split_once(&format!("{file}:")).unwrap_or_else(|| panic!("{file} is not named in: {said}"));
        let (line, rest) = match rest.split_once(": ").map(|(line, rest)| (line.parse().ok(), rest)) {
            Some((Some(line), rest)) => (Some(line), rest),
            _ => (None, rest),
        };
        let (what, mend) = rest.split_once("; ").unwrap_or_else(|| panic!("no mend in: {said}"));
        Self { line, what: what.trim().to_owned(), mend: mend.to_owned() }
    }

    fn on_line(self, line: usize) -> Self {
        assert_eq!(self.line, Some(line), "{self:?}");
        self
    }

    fn without_line(self) -> Self {
        assert_eq!(self.line, None, "{self:?}");
        self
    }

    /// What is at fault ends in its place, and that is near (u, v).
    fn at(self, u: f64, v: f64) -> Self {
        let place = self.what.rsplit_once(" at (").unwrap_or_else(|| panic!("no place in {self:?}")).1;
        let numbers = place.strip_suffix(") mm").unwrap_or_else(|| panic!("no (u, v) mm in {self:?}"));
        let numbers: Vec<f64> = numbers.split(", ").map(|n| n.parse().expect("a number")).collect();
        assert_eq!(numbers.len(), 2, "{self:?}");
        let off = (numbers[0] - u).hypot(numbers[1] - v);
        assert!(off <= 1.0, "{off} mm away from ({u}, {v}): {self:?}");
        self
    }

    fn says(self, words: &[&str]) -> Self {
        assert_says(&self.what, words);
        self
    }

    fn mends(self, words: &[&str]) {
        assert!(!self.mend.trim().is_empty(), "{self:?}");
        assert_says(&self.mend, words);
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

/// The lines, from 1, that give a value to a key of a table.
fn lines_of(text: &str, table: &str, key: &str) -> Vec<usize> {
    let mut current = String::new();
    let mut lines = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if let Some(name) = line.trim().strip_prefix('[') {
            current = name.split(']').next().unwrap_or_default().to_owned();
        }
        if current == table && line.split_once('=').is_some_and(|(name, _)| name.trim() == key) {
            lines.push(number);
        }
    }
    lines
}

fn set_key(text: &str, table: &str, key: &str, value: &str) -> String {
    let found = lines_of(text, table, key);
    assert_eq!(found.len(), 1, "[{table}] {key} stands {} times in the project", found.len());
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[found[0] - 1] = format!("{key} = {value}");
    lines.join("\n") + "\n"
}

/// Lines of the outline and of the crease in a [`drawing`].
const OUTLINE_LINE: usize = 2;
const CREASE_LINE: usize = 3;

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
    Told::parse(&message, "nowhere.toml").without_line().says(&["cannot be read"]).mends(&["project file"]);
    assert!(!folder.join("out").exists());
}

#[test]
fn an_absent_pattern_is_named() {
    let desk = Desk::new("no-pattern");
    desk.rewrite(|text| text.replace("\"pattern.svg\"", "\"nowhere.svg\""));
    let line = format!("project.toml:{}", desk.line_of("", "pattern"));
    desk.told_of("nowhere.svg").without_line().says(&["cannot be read"]).mends(&["`pattern`", &line]);
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
    // The keys that would do are the mend.
    let line = desk.line_of("soften", "radius_inch");
    desk.refuses_with(&[&format!("project.toml:{line}: "), "radius_inch", "expected", "`radius_mm`"]);
}

#[test]
fn a_line_that_is_no_toml_is_named() {
    let desk = Desk::new("no-toml");
    desk.rewrite(|text| text.replacen("[soften]", "[soften", 1));
    let text = fs::read_to_string(desk.project()).unwrap();
    let line = 1 + text.lines().position(|line| line == "[soften").unwrap();
    desk.refuses_with(&[&format!("project.toml:{line}: ")]);
}

#[test]
fn a_word_instead_of_a_number_is_named_with_its_line() {
    let desk = Desk::new("word");
    desk.set("board", "thickness_mm", "\"thick\"");
    let line = desk.line_of("board", "thickness_mm");
    desk.refuses_with(&[&format!("project.toml:{line}: "), "thickness_mm"]);
}

/// Gives a key of a table a value that is refused by the name of both, with its line and the mend.
fn refuses_value(case: &str, table: &str, key: &str, value: &str, mend: &str) {
    let desk = Desk::new(&format!("{key}-{case}"));
    desk.set(table, key, value);
    let line = desk.line_of(table, key);
    desk.told_of("project.toml").on_line(line).says(&[&format!("{table}.{key}")]).mends(&[mend]);
}

#[test]
fn thickness_must_be_a_positive_number() {
    for (case, value) in [("negative", "-3.0"), ("zero", "0.0"), ("nan", "nan"), ("infinite", "inf")] {
        refuses_value(case, "board", "thickness_mm", value, "a positive number");
    }
}

#[test]
fn a_radius_must_be_a_number_that_is_not_negative() {
    for (case, value) in [("negative", "-1.0"), ("nan", "nan")] {
        refuses_value(case, "soften", "radius_mm", value, "not negative");
    }
}

#[test]
fn no_number_of_a_project_may_be_nan() {
    for (table, key, value) in [
        ("waffle", "angle_deg", "nan"),
        ("waffle", "stock_mm", "[2440.0, nan]"),
        ("mold", "printer_mm", "[256.0, nan, 256.0]"),
        ("limits", "stability_margin_mm", "nan"),
        ("mesh", "target_edge_mm", "nan"),
        ("material", "poisson_ratio", "nan"),
    ] {
        refuses_value("nan", table, key, value, "give a");
    }
}

#[test]
fn a_radius_too_large_is_told_with_crease_place_and_the_largest_that_fits() {
    let desk = Desk::new("radius-large");
    desk.set("soften", "radius_mm", "5000.0");
    let line = desk.line_of("soften", "radius_mm");
    let told =
        desk.told_of("project.toml").on_line(line).says(&["crease '", "radius", "5000", " at (", ") mm"]);
    told.mends(&["largest radius that fits", " mm"]);
}

#[test]
fn an_open_outline_is_told_with_its_line_and_place() {
    let desk = Desk::new("open-outline");
    desk.pattern(&drawing("M 0 0 H 400 V 400 H 60", ARC));
    let told = desk.told_of("pattern.svg").on_line(OUTLINE_LINE).at(60.0, 0.0);
    told.says(&["outline", "open", "gap"]).mends(&["close the path"]);
}

#[test]
fn a_pattern_without_an_outline_is_refused() {
    let desk = Desk::new("no-outline");
    desk.pattern(&drawing(ARC, ARC));
    desk.told_of("pattern.svg").on_line(OUTLINE_LINE).at(400.0, 200.0).says(&["outline"]).mends(&["close"]);
}

#[test]
fn a_crease_that_leaves_the_sheet_is_named_with_its_line_and_place() {
    let desk = Desk::new("crease-leaves");
    desk.pattern(&drawing(SQUARE, "M 200 100 L 200 560"));
    let told = desk.told_of("pattern.svg").on_line(CREASE_LINE).at(200.0, 0.0);
    told.says(&["crease-1", "leaves the sheet", "160"]).mends(&["outline"]);
}

#[test]
fn coordinates_that_are_no_numbers_are_refused_with_their_line() {
    for (name, crease) in [("nan", "M NaN 200 L 400 200"), ("huge", "M 0 200 L 1e999 200")] {
        let desk = Desk::new(&format!("coordinates-{name}"));
        desk.pattern(&drawing(SQUARE, crease));
        let told = desk.told_of("pattern.svg").on_line(CREASE_LINE);
        told.says(&["crease-1", "number at position"]).mends(&["correct the number"]);
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
fn refusals_are_taken_apart() {
    let told =
        Told::parse("note\nerror: /a/p.svg:7: b: is open at (1.0, -2.5) mm; close it; or not\n", "p.svg");
    told.on_line(7).at(1.0, -2.5).says(&["b: is open"]).mends(&["close it; or not"]);
    Told::parse("error: a/p.svg: is: no; draw it", "p.svg")
        .without_line()
        .says(&["is: no"])
        .mends(&["draw it"]);
    let fails = |message: &'static str| std::panic::catch_unwind(|| Told::parse(message, "p.svg")).is_err();
    assert!(fails("error: p.svg:7: no mend") && fails("error: q.svg:7: a; b") && fails("p.svg:7: a; b"));
}

#[test]
fn set_key_changes_that_key_alone() {
    let text = "a = 1\n[soften]\na = 2 # note\nb = 3\n[board]\na = 4\n";
    assert_eq!(set_key(text, "soften", "a", "9"), "a = 1\n[soften]\na = 9\nb = 3\n[board]\na = 4\n");
    assert_eq!(set_key(text, "", "a", "9"), "a = 9\n[soften]\na = 2 # note\nb = 3\n[board]\na = 4\n");
}
