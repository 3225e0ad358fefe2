//! What `crates/README.md` promises, held against the sources: dependencies, and absences.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "architecture/picture.rs"]
mod picture;
#[path = "architecture/scan.rs"]
mod scan;
#[path = "architecture/tree.rs"]
mod tree;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use cargo_metadata::MetadataCommand;
use picture::{Arrow, Picture};
use scan::{EFFECTS, FOREIGN_CODE, Rule, Tests};

const PAGE: &str = "crates/README.md";
/// The only crate with foreign code.
const KERNEL: &str = "kernel";
/// The crates that take a value and give a value.
const STAGES: [&str; 7] = ["geometry", "pattern", "soften", "mesh", "fold", "surface", "mold"];
/// The longest file that one still reads as one.
const LINES_MAX: usize = 800;
/// The whole story in one look.
const TOP: [&str; 10] = [
    "Cargo.toml",
    "Cargo.lock",
    "build.rs",
    "crates",
    "cpp",
    "fixtures",
    "tests",
    "README.md",
    "CHANGELOG.md",
    "LICENSE",
];

/// Fails with one line per fault.
fn assert_none(faults: &[String]) {
    assert!(faults.is_empty(), "{} fault(s):\n{}", faults.len(), faults.join("\n"));
}

fn short(name: &str) -> &str {
    name.strip_prefix("softfold-").unwrap_or(name)
}

/// The workspace's crates and the arrows between them, tests' and build scripts' included.
fn workspace() -> Picture {
    let manifest = tree::root().join("Cargo.toml");
    let metadata = MetadataCommand::new().manifest_path(manifest).no_deps().exec().expect("cargo metadata");
    let names: BTreeSet<&str> = metadata.packages.iter().map(|package| package.name.as_str()).collect();
    let mut picture = Picture::default();
    for package in &metadata.packages {
        let from = short(package.name.as_str()).to_owned();
        let inner = package.dependencies.iter().filter(|dependency| names.contains(dependency.name.as_str()));
        picture.arrows.extend(inner.map(|to| Arrow { from: from.clone(), to: short(&to.name).to_owned() }));
        picture.crates.insert(from);
    }
    picture
}

#[test]
fn crates_depend_on_each_other_as_the_page_draws_it() {
    let page = tree::text(Path::new(PAGE)).expect(PAGE);
    assert_none(&picture::differences(&picture::read(&page).expect(PAGE), &workspace()));
}

#[test]
fn no_stage_imports_a_stage() {
    let stages = &STAGES[1..]; // all but geometry, which they share
    let both = |arrow: &&Arrow| [&arrow.from, &arrow.to].iter().all(|name| stages.contains(&name.as_str()));
    assert_none(&workspace().arrows.iter().filter(both).map(Arrow::to_string).collect::<Vec<_>>());
}

#[test]
fn the_picture_is_read_and_compared() {
    let drawn = picture::read("x\n```crates\nmesh -> geometry, kernel\ngeometry ->\n```\ny -> z").unwrap();
    assert_eq!(drawn.crates.len(), 2);
    assert_eq!(drawn.arrows.len(), 2);
    let there = picture::read("```crates\nmesh -> geometry, fold\nfold ->\n```").unwrap();
    let told = picture::differences(&drawn, &there);
    assert_eq!(told.len(), 4, "{told:?}");
    assert!(told.contains(&"mesh -> fold is there and is not drawn".to_owned()), "{told:?}");
    assert!(told.contains(&"mesh -> kernel is drawn and is not there".to_owned()), "{told:?}");
    assert!(picture::read("no block").is_err() && picture::read("```crates\nmesh\n```").is_err());
}

/// One line for each thing that `rule` forbids in the files that `chosen` picks.
fn forbidden(rule: &Rule, tests: Tests, chosen: impl Fn(&Path) -> bool) -> Vec<String> {
    let files: Vec<PathBuf> =
        tree::files().into_iter().filter(|f| tree::ends_in(f, &["rs"]) && chosen(f)).collect();
    assert!(!files.is_empty(), "nothing to look at");
    let faults = |file: &PathBuf| {
        let source = tree::text(file).unwrap_or_default();
        let found =
            scan::finds(&source, rule, tests).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        found
            .into_iter()
            .map(|find| format!("{}:{}: {}", file.display(), find.line, find.what))
            .collect::<Vec<_>>()
    };
    files.iter().flat_map(faults).collect()
}

/// A stage's source file that is not one of tests (`tests.rs`, `tests/…`, beside or below `src`).
fn is_stage_source(file: &Path) -> bool {
    let of_tests = |part: &std::ffi::OsStr| {
        part == "tests" || part == "tests.rs" || part == "examples" || part == "benches"
    };
    tree::crate_of(file).is_some_and(|name| STAGES.contains(&name)) && !file.iter().any(of_tests)
}

#[test]
fn foreign_code_stands_in_the_kernel_alone() {
    assert_none(&forbidden(&FOREIGN_CODE, Tests::Counted, |file| tree::crate_of(file) != Some(KERNEL)));
}

#[test]
fn no_stage_prints_opens_files_or_looks_at_a_clock() {
    assert_none(&forbidden(&EFFECTS, Tests::Ignored, is_stage_source));
}

#[test]
fn the_scanner_finds_planted_faults() {
    let count = |source: &str, rule: &Rule, tests| scan::finds(source, rule, tests).expect(source).len();
    let effects = |source: &str| count(source, &EFFECTS, Tests::Ignored);
    for planted in [
        "fn f() { println!(\"a\") }",
        "fn f() { vec![dbg!(1)]; }",
        "use std::fs;",
        "use std::{collections::HashMap, fs::read};",
        "fn f() { std::env::var(\"A\"); }",
        "use std::{time::{Duration, Instant}};",
        "fn f() { File::open(\"a\"); }",
        "macro_rules! m { () => { eprintln!() } }",
        "#[cfg(not(test))] fn f() { print!(\"a\") }",
        "#[cfg(test)] mod tests { }\nfn f() { std::process::exit(1) }",
        "#[cfg(test)] use std::fmt;\nuse std::net;",
        "use softfold_kernel::occt::write_step;",
        "fn f() { softfold_kernel::occt::read_step(\"a\"); }",
        "use softfold_kernel::openmesh::read;",
        "use softfold_kernel::openmesh::{clean, read};",
        "fn f() { openmesh::read(\"a\"); }",
        "fn f(p: &Path) -> bool { p.exists() }",
        "fn f(p: &Path) { p.metadata(); }",
        "fn f(p: &Path) -> bool { p.join(\"a\").is_file() }",
        "fn f(p: &Path) -> bool { p.is_dir() }",
        "fn f(p: &Path) { p.canonicalize(); }",
        "fn f(p: &Path) { p.read_dir(); }",
    ] {
        assert_eq!(effects(planted), 1, "{planted}");
    }
    for innocent in [
        "/// println!(\"a\")\nfn f() {} // std::fs /* dbg!() */",
        "const A: &str = \"std::fs::File::open println!\";",
        "#[cfg(test)] mod tests { fn f() { println!(\"a\"); std::fs::read(\"b\"); } }",
        "#[test] fn f() { dbg!(1); }",
        "use std::{collections::BTreeMap, io::Read, time::Duration, fmt::{self, Write}};",
        "struct FoldFile; fn f(env: f64, fs: f64) -> f64 { env + fs }",
        "fn f(m: MeshView) { softfold_kernel::openmesh::clean(m, 0.1); }",
        "fn f(exists: bool, metadata: u8) -> bool { exists && g(metadata).is_finite() }",
    ] {
        assert_eq!(effects(innocent), 0, "{innocent}");
    }
    let foreign = |source: &str| count(source, &FOREIGN_CODE, Tests::Counted);
    assert_eq!(foreign("#[cfg(test)] mod tests { unsafe fn f() {} }"), 1);
    assert_eq!(foreign("#[cxx::bridge] mod ffi {}"), 1);
    assert_eq!(foreign("// unsafe\nconst A: &str = \"unsafe cxx\"; #![deny(unsafe_code)]"), 0);
    let lines = scan::finds("fn a() {}\n\nfn b() { dbg!(1); }", &EFFECTS, Tests::Ignored).unwrap();
    assert_eq!(lines[0].line, 3);
}

#[test]
fn the_top_level_tells_the_whole_story() {
    let files = tree::files();
    let first = |file: &PathBuf| file.iter().next().map(|part| part.to_string_lossy().into_owned());
    let there: BTreeSet<String> =
        files.iter().filter_map(first).filter(|name| !name.starts_with('.')).collect();
    let wanted: BTreeSet<String> = TOP.iter().map(ToString::to_string).collect();
    assert_eq!(there, wanted, "left: what is there; right: what the page fixes");
}

/// A place on somebody's machine, or a package registry; put together here so that this file holds none.
const MACHINE_PATHS: [&str; 4] =
    [concat!("/ho", "me/"), concat!("/ro", "ot/"), concat!("/wo", "rk"), concat!("/Us", "ers/")];
const REGISTRIES: [&str; 7] = [
    concat!("index", "-url"),
    concat!("crates.io", "-index"),
    concat!("index.", "crates.io"),
    concat!("static.", "crates.io"),
    concat!("pypi.org", "/simple"),
    concat!("[regis", "tries"),
    concat!("[sou", "rce."),
];

/// Whether a line holds a path of a machine, as a path of its own and not inside a longer one.
fn names_a_machine(line: &str) -> bool {
    let word = |c: Option<char>, more: &str| c.is_some_and(|c| c.is_alphanumeric() || more.contains(c));
    MACHINE_PATHS.iter().any(|path| {
        line.match_indices(path).any(|(at, _)| {
            let (before, after) = (&line[..at], &line[at + path.len()..]);
            let whole = path.ends_with('/') || !word(after.chars().next(), "_-.");
            whole && !word(before.chars().next_back(), "_-./")
        })
    })
}

/// The folder beside the checkout; put together here as the paths above.
const BESIDE: &str = concat!("../sha", "red");
/// The only files that may know it: they do without it where it is absent, or refuse in words.
const MAY_LOOK_BESIDE: [&str; 6] = [
    ".ci/run",
    "tests/common/shared.rs",
    "tests/common/state.rs",
    "tests/patterns.rs",
    "tests/surface_truth.rs",
    "tests/truth.rs",
];

#[test]
fn nothing_leans_on_the_folder_beside_the_checkout() {
    let may = |file: &Path| MAY_LOOK_BESIDE.iter().any(|allowed| file == Path::new(allowed));
    let names = |file: &PathBuf| tree::text(file).is_some_and(|text| text.contains(BESIDE));
    let faults = tree::files().into_iter().filter(|file| !may(file) && names(file));
    assert_none(&faults.map(|file| file.display().to_string()).collect::<Vec<_>>());
}

fn names_a_registry(line: &str) -> bool {
    REGISTRIES.iter().any(|registry| line.contains(registry))
}

#[test]
fn no_file_knows_a_machine_or_a_registry() {
    let mut faults = Vec::new();
    for file in tree::files().iter().filter(|file| *file != Path::new("Cargo.lock")) {
        for (number, line) in tree::text(file).unwrap_or_default().lines().enumerate() {
            if names_a_machine(line) || names_a_registry(line) {
                faults.push(format!("{}:{}: {line}", file.display(), number + 1));
            }
        }
    }
    assert_none(&faults);
}

#[test]
fn machine_paths_and_registries_are_recognised() {
    let at = |path: &str, rest: &str| names_a_machine(&format!("let a = \"{path}{rest}\";"));
    assert!(at(MACHINE_PATHS[0], "ann/x") && at(MACHINE_PATHS[1], ".x") && at(MACHINE_PATHS[2], "/x"));
    assert!(at(MACHINE_PATHS[2], ""));
    assert!(!at(MACHINE_PATHS[2], "space/x") && !names_a_machine("an.example/home/page"));
    assert!(names_a_registry(&format!("pip install --{}=x", REGISTRIES[0])));
    assert!(!names_a_registry("https://crates.io/crates/spade and https://pypi.org/project/ezdxf"));
}

#[test]
fn every_locked_package_comes_from_the_public_index() {
    let lock = tree::text(Path::new("Cargo.lock")).expect("Cargo.lock");
    let public = format!("source = \"registry+https://github.com/rust-lang/{}\"", REGISTRIES[1]);
    let other = lock.lines().filter(|line| line.starts_with("source = ") && *line != public);
    assert_none(&other.map(str::to_owned).collect::<Vec<_>>());
}

/// With `builtin`, opencascade-sys compiles OCCT 7.8, whose symbols meet those of the system's 7.6.
#[test]
fn opencascade_sys_never_builds_its_own_kernel() {
    let arguments =
        ["tree", "--offline", "--workspace", "--prefix", "none", "-i", "opencascade-sys", "-f", "{p}|{f}"];
    let output =
        Command::new(env!("CARGO")).args(arguments).current_dir(tree::root()).output().expect("cargo tree");
    let told = String::from_utf8_lossy(&output.stdout);
    let features: Vec<&str> = told.lines().filter_map(|line| line.strip_prefix("opencascade-sys ")).collect();
    assert!(!features.is_empty(), "cargo tree: {told}{}", String::from_utf8_lossy(&output.stderr));
    features.iter().for_each(|line| assert!(line.ends_with('|'), "opencascade-sys has features: {line}"));
}

#[test]
fn no_file_is_too_long_to_read() {
    let sources =
        tree::files().into_iter().filter(|file| tree::ends_in(file, &["rs", "h", "hh", "hxx", "cc", "py"]));
    let long = sources.filter_map(|file| {
        let lines = tree::text(&file)?.lines().count();
        (lines > LINES_MAX).then(|| format!("{}: {lines} lines, at most {LINES_MAX}", file.display()))
    });
    assert_none(&long.collect::<Vec<_>>());
}

/// Tests that a page names as `path.rs::name`.
fn named_tests(page: &str) -> Vec<(&str, &str)> {
    let code = page.split('`').skip(1).step_by(2);
    code.filter_map(|word| word.split_once("::")).filter(|(file, _)| file.ends_with(".rs")).collect()
}

#[test]
fn every_test_that_the_page_names_exists() {
    let page = tree::text(Path::new(PAGE)).expect(PAGE);
    let named = named_tests(&page);
    assert!(!named.is_empty(), "the page names no test");
    let absent = |(file, name): &&(&str, &str)| {
        !tree::text(Path::new(file)).is_some_and(|source| source.contains(&format!("fn {name}(")))
    };
    assert_none(
        &named.iter().filter(absent).map(|(file, name)| format!("{file}::{name}")).collect::<Vec<_>>(),
    );
}

#[test]
fn named_tests_are_found_in_a_page() {
    let page = "a `tests/a.rs::b` and `std::fs` and `crates/x/src/y.rs::z`";
    assert_eq!(named_tests(page), [("tests/a.rs", "b"), ("crates/x/src/y.rs", "z")]);
}
