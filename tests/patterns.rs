//! Other people's patterns, from `../shared/patterns`: read, or refused with a reason; and softened.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/shared.rs"]
mod shared;

use shared::{files, say, shared};
use softfold::crosscheck;
use softfold_geometry::{CreasePattern, Role, Severity};
use softfold_mesh::MeshOptions;
use softfold_pattern::{Format, PatternFile, ReadOptions, Refused, read};
use softfold_soften::{CreaseSoftness, Segments, soften};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// All endings of the collection.
const ENDINGS: [&str; 6] = ["cp", "dxf", "fold", "opx", "ori", "svg"];
/// Endings of which nearly all files must give a pattern.
const HELD: [&str; 3] = ["cp", "fold", "svg"];
/// Share of those files that must.
const USABLE: f64 = 0.9;
/// Most memory that the whole collection may take, kB.
const MEMORY_KB: u64 = 1 << 20;
/// Fold angle of creases of which a file says none, degrees.
const ANGLE_DEG: f64 = 60.0;

/// What becomes of the collection as it is known: ending, outcome, files.
const KNOWN: [(&str, &str, usize); 15] = [
    ("cp", "clean", 5),
    ("cp", "refused: Outline", 1),
    ("dxf", "clean", 4),
    ("dxf", "refused: Nothing", 2),
    ("dxf", "refused: Outline", 9),
    ("dxf", "repaired", 7),
    ("fold", "clean", 37),
    ("fold", "refused: Malformed", 3),
    ("fold", "refused: Nothing", 1),
    ("fold", "refused: Outline", 5),
    ("fold", "repaired", 6),
    ("ori", "refused: Malformed", 2),
    ("ori", "repaired", 4),
    ("svg", "clean", 34),
    ("svg", "repaired", 35),
];

/// A file of the collection and what became of it.
struct Outcome {
    name: String,
    ending: String,
    seconds: f64,
    read: Result<PatternFile, Box<Refused>>,
}

fn outcome(path: &Path, folder: &Path) -> Outcome {
    let bytes = std::fs::read(path).expect("a readable file");
    let name = path.strip_prefix(folder).unwrap_or(path).display().to_string();
    let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    let format = Format::of_ending(&ending).expect("an ending of a pattern");
    let start = Instant::now();
    let read = std::panic::catch_unwind(|| read(&bytes, format, &name, &ReadOptions::default()));
    let read = read.unwrap_or_else(|_| panic!("{name}: the reader panicked"));
    Outcome { name, ending, seconds: start.elapsed().as_secs_f64(), read }
}

fn outcomes(test: &str) -> Option<Vec<Outcome>> {
    let folder = shared(test, "patterns")?;
    let found: Vec<PathBuf> = files(&folder, &ENDINGS);
    assert!(!found.is_empty(), "no patterns in {}", folder.display());
    Some(found.iter().map(|path| outcome(path, &folder)).collect())
}

/// In a word: `clean` (nothing was changed), `repaired`, or why it was refused.
fn verdict(outcome: &Outcome) -> String {
    match &outcome.read {
        Ok(file) if file.issues.iter().all(|i| i.severity == Severity::Note) => "clean".to_owned(),
        Ok(_) => "repaired".to_owned(),
        Err(refused) => {
            let kind = format!("{:?}", refused.error);
            format!("refused: {}", kind.split('(').next().unwrap_or_default())
        }
    }
}

/// Largest memory of this process so far, kB; none where the system does not tell.
fn peak_memory_kb() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").parse().ok()
}

#[test]
fn every_pattern_is_read_or_refused_for_a_reason_that_names_the_place() {
    let Some(all) = outcomes("every_pattern_is_read_or_refused_for_a_reason_that_names_the_place") else {
        return;
    };
    let mut table: BTreeMap<(String, String), usize> = BTreeMap::new();
    for o in &all {
        *table.entry((o.ending.clone(), verdict(o))).or_default() += 1;
        match &o.read {
            Ok(file) => file.pattern.check().unwrap_or_else(|e| panic!("{}: {e}", o.name)),
            Err(refused) => {
                let issue = refused.error.issue();
                assert!(!issue.message.is_empty() && !issue.mend.is_empty(), "{}: {refused}", o.name);
                assert!(refused.issues.iter().any(|i| i == issue), "{}: the reason is not listed", o.name);
                say(&format!("  {}: {refused}", o.name));
            }
        }
    }
    say(&format!("\n{} patterns of other people", all.len()));
    table.iter().for_each(|((ending, what), count)| say(&format!("{count:>6}  .{ending:<5} {what}")));
    let slowest = all.iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds)).expect("a file");
    say(&format!("slowest: {} in {:.2} s; memory: {:?} kB", slowest.name, slowest.seconds, peak_memory_kb()));
    let held: Vec<&Outcome> = all.iter().filter(|o| HELD.contains(&o.ending.as_str())).collect();
    let usable = held.iter().filter(|o| o.read.is_ok()).count();
    say(&format!("usable of .svg, .fold and .cp: {usable} of {}", held.len()));
    // A collection that grew has a table of its own; the share of usable files holds for any.
    if all.len() == KNOWN.iter().map(|k| k.2).sum::<usize>() {
        let known: BTreeMap<(String, String), usize> =
            KNOWN.iter().map(|(e, w, n)| ((e.to_string(), w.to_string()), *n)).collect();
        assert_eq!(table, known, "another outcome than the one on record");
    }
    assert!(usable as f64 >= USABLE * held.len() as f64, "{usable} of {}", held.len());
    assert!(peak_memory_kb().is_none_or(|kb| kb < MEMORY_KB), "{:?} kB", peak_memory_kb());
}

/// A softness for every crease: the file's angle or [`ANGLE_DEG`], a radius of a share of the sheet.
fn softness(pattern: &CreasePattern, radius_mm: f64) -> Vec<CreaseSoftness> {
    let one = |c: &softfold_geometry::Crease| {
        let sign = if c.role == Role::Mountain { -1.0 } else { 1.0 };
        let angle = c.fold_angle_rad.unwrap_or_default();
        // What is folded flat cannot be softened: its angle is kept just below.
        let size = if angle == 0.0 { ANGLE_DEG.to_radians() } else { angle.abs().min(3.0) };
        CreaseSoftness::constant(radius_mm, sign * size, Segments::Count(3))
    };
    pattern.creases.iter().map(one).collect()
}

#[test]
fn every_pattern_is_softened_sharply_and_softly_or_refused_with_the_largest_radius() {
    let test = "every_pattern_is_softened_sharply_and_softly_or_refused_with_the_largest_radius";
    let Some(all) = outcomes(test) else { return };
    /// Radius of the soft folds, by the sheet's size.
    const SOFT: f64 = 2e-4;
    let mut table: BTreeMap<String, usize> = BTreeMap::new();
    for o in &all {
        let Ok(file) = &o.read else { continue };
        for (kind, radius_mm) in [("sharp", 0.0), ("soft", SOFT * file.pattern.size_mm())] {
            let given = softness(&file.pattern, radius_mm);
            let what = match soften(&file.pattern, &given) {
                Ok(soft) => {
                    soft.check().unwrap_or_else(|e| panic!("{}: {e}", o.name));
                    format!("{kind}: softened")
                }
                Err(error) => {
                    let issue = error.issue();
                    assert!(!issue.mend.is_empty(), "{}: {error}", o.name);
                    say(&format!("  {} ({kind}): {error}", o.name));
                    format!("{kind}: refused")
                }
            };
            *table.entry(what).or_default() += 1;
        }
    }
    table.iter().for_each(|(what, count)| say(&format!("{count:>6}  {what}")));
    let of = |what: &str| table.get(what).copied().unwrap_or(0);
    assert_eq!(of("sharp: refused"), 0, "a sharp fold needs no room");
}

/// Share of the sheet's size to which meshes of other people's patterns are made for the cross-check.
const EDGE: f64 = 0.05;
/// Patterns that take longer are named.
const SLOW_S: f64 = 5.0;

/// spade and CGAL agree on the lines of every pattern that reads, and on its mesh with sharp creases.
#[test]
fn spade_and_cgal_agree_on_every_pattern_that_reads() {
    let Some(all) = outcomes("spade_and_cgal_agree_on_every_pattern_that_reads") else { return };
    let mut table: BTreeMap<String, usize> = BTreeMap::new();
    let mut count = |what: &str| *table.entry(what.to_owned()).or_default() += 1;
    for o in &all {
        let Ok(file) = &o.read else { continue };
        let start = Instant::now();
        let lines = crosscheck::of_lines(&file.pattern).unwrap_or_else(|e| panic!("{}: {e}", o.name));
        assert!(lines.agrees(), "{}: {lines:?}", o.name);
        count("lines agree");
        if lines.marginal > 0 {
            count("lines with meetings at the tolerance");
        }
        let soft = soften(&file.pattern, &softness(&file.pattern, 0.0))
            .unwrap_or_else(|e| panic!("{}: {e}", o.name));
        let options = MeshOptions {
            target_edge_mm: EDGE * file.pattern.size_mm(),
            relaxation_rounds: 2,
            ..MeshOptions::default()
        };
        match softfold_mesh::mesh(&soft, &options) {
            Ok(meshed) => {
                let check =
                    softfold_mesh::crosscheck(&meshed.graph).unwrap_or_else(|e| panic!("{}: {e}", o.name));
                assert!(check.agrees(), "{}: {check:?}", o.name);
                count("mesh agrees");
            }
            Err(error) => {
                say(&format!("  {}: {error}", o.name));
                count("mesh refused");
            }
        }
        let seconds = start.elapsed().as_secs_f64();
        if seconds > SLOW_S {
            say(&format!("  {}: {seconds:.1} s", o.name));
        }
    }
    table.iter().for_each(|(what, n)| say(&format!("{n:>6}  {what}")));
    let of = |what: &str| table.get(what).copied().unwrap_or(0);
    assert!(of("mesh agrees") > 100 && of("mesh refused") == 0, "{table:?}");
}
