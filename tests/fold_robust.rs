//! Whatever is folded: finite positions, and at rest or told that it is not. Other people's patterns from the collection beside the checkout,
//! and random designs.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/shared.rs"]
mod shared;

use shared::{files, say, shared};
use softfold_fold::{NewtonOptions, SheetMaterial, Solver, fold, upright};
use softfold_geometry::{
    Crease, CreaseId, CreasePattern, DVec2, FoldedSheet, PlanarCurve, Role, Segment, Source,
};
use softfold_mesh::{MeshOptions, mesh};
use softfold_pattern::{Format, ReadOptions, read};
use softfold_soften::{CreaseSoftness, Segments, soften};
use std::collections::BTreeMap;

/// All endings of the collection.
const ENDINGS: [&str; 6] = ["cp", "dxf", "fold", "opx", "ori", "svg"];
/// Share of their angles by which patterns are folded.
const SHARE: f64 = 0.6;
/// Fold angle of creases of which a file says none, degrees.
const ANGLE_DEG: f64 = 60.0;
/// Edge length over the size of a sheet.
const EDGE: f64 = 1.0 / 12.0;
/// Thickness over the size.
const THICKNESS: f64 = 5e-3;
/// Relative gradient at which a sheet counts as at rest here.
const AT_REST: f64 = 1e-4;
/// Vertices times iterations that one pattern may take, and the most and fewest iterations: what is not at rest by then is told.
const WORK: u32 = 60_000;
const ITERATIONS: [u32; 2] = [8, 120];
/// Random designs.
const DESIGNS: u64 = 200;

/// What became of a pattern.
enum Outcome {
    /// Another stage refused it, with its reason.
    Refused(String),
    Folded(FoldedSheet),
}

fn folded(pattern: &CreasePattern, softness: &[CreaseSoftness]) -> Outcome {
    let soft = match soften(pattern, softness) {
        Ok(soft) => soft,
        Err(e) => return Outcome::Refused(format!("soften: {e}")),
    };
    let options = MeshOptions { target_edge_mm: EDGE * pattern.size_mm(), ..MeshOptions::default() };
    let mesh = match mesh(&soft, &options) {
        Ok(meshed) => meshed.mesh,
        Err(e) => return Outcome::Refused(format!("mesh: {e}")),
    };
    let sheet = SheetMaterial {
        youngs_modulus_mpa: 1000.0,
        poisson_ratio: 0.3,
        thickness_mm: THICKNESS * pattern.size_mm(),
        fold_line_factor: 10.0,
    };
    let max_iterations = (WORK / mesh.vertices.len().max(1) as u32).clamp(ITERATIONS[0], ITERATIONS[1]);
    let options = NewtonOptions { max_iterations, relative_gradient: AT_REST, ..NewtonOptions::default() };
    let folded = fold(&mesh, &sheet.goals(&mesh), &upright(&mesh), &Solver::Newton(options), &mut |_| ());
    Outcome::Folded(folded.unwrap_or_else(|e| panic!("{}: {e}", pattern.name)))
}

/// No position is NaN, and what the record says of rest is so.
fn is_honest(name: &str, sheet: &FoldedSheet) {
    assert!(sheet.positions.iter().all(|p| p.is_finite()), "{name}: a position that is no number");
    let solve = &sheet.solve;
    assert!(solve.energy.is_finite(), "{name}: {solve:?}");
    assert_eq!(solve.converged, solve.relative_gradient <= AT_REST, "{name}: {solve:?}");
    assert!(solve.converged || !solve.stop.is_empty(), "{name}: no word about why it stopped");
}

/// 60 % of each crease's angle, sharp.
fn sharp(pattern: &CreasePattern) -> Vec<CreaseSoftness> {
    let one = |c: &Crease| {
        let sign = if c.role == Role::Mountain { -1.0 } else { 1.0 };
        let known = c.fold_angle_rad.map(f64::abs).filter(|a| *a > 0.0);
        let angle = known.unwrap_or(ANGLE_DEG.to_radians());
        CreaseSoftness::constant(0.0, SHARE * sign * angle, Segments::Count(1))
    };
    pattern.creases.iter().map(one).collect()
}

#[test]
fn every_readable_pattern_folds_by_60_percent_or_says_that_it_is_not_at_rest() {
    let test = "every_readable_pattern_folds_by_60_percent_or_says_that_it_is_not_at_rest";
    let Some(folder) = shared(test, "patterns") else { return };
    let mut table: BTreeMap<&str, usize> = BTreeMap::new();
    let mut lines = vec![format!("\n{test}\nvertices  steps  gradient  pattern")];
    for path in files(&folder, &ENDINGS) {
        let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let name = path.strip_prefix(&folder).unwrap_or(&path).display().to_string();
        let bytes = std::fs::read(&path).expect("a readable file");
        let format = Format::of_ending(&ending).expect("an ending of a pattern");
        let Ok(file) = read(&bytes, format, &name, &ReadOptions::default()) else { continue };
        let began = std::time::Instant::now();
        let what = match folded(&file.pattern, &sharp(&file.pattern)) {
            Outcome::Refused(why) => {
                lines.push(format!("   refused                   {name}: {why}"));
                "refused"
            }
            Outcome::Folded(sheet) => {
                is_honest(&name, &sheet);
                let solve = &sheet.solve;
                let what = if solve.converged { "at rest" } else { "not at rest" };
                lines.push(format!(
                    "{:>8} {:>6}  {:>8.1e}  {name}: {what} {:.1} s",
                    sheet.mesh.vertices.len(),
                    solve.iterations,
                    solve.relative_gradient,
                    began.elapsed().as_secs_f64()
                ));
                what
            }
        };
        *table.entry(what).or_default() += 1;
    }
    say(&lines.join("\n"));
    table.iter().for_each(|(what, count)| say(&format!("{count:>6}  {what}")));
    assert!(table.get("at rest").is_some_and(|n| *n > 0), "nothing comes to rest");
}

/// Numbers from 0 to 1 that look random and are the same each time (a 64-bit linear congruence, Knuth's constants).
struct Chance(u64);

impl Chance {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A sheet of 300 mm by 120 to 300 with one to four curved creases from side to side, each in its own strip; radii, angles and
/// numbers of segments by chance.
fn design(seed: u64) -> (CreasePattern, Vec<CreaseSoftness>) {
    let mut chance = Chance(seed);
    (0..8).for_each(|_| {
        chance.within(0.0, 1.0);
    });
    let (width, height) = (300.0, chance.within(120.0, 300.0));
    let count = chance.within(1.0, 5.0) as usize;
    let strip = height / (count + 1) as f64;
    let mut softness = Vec::new();
    let crease = |i: usize| {
        let at = |x: f64, chance: &mut Chance| {
            DVec2::new(x, (i + 1) as f64 * strip + chance.within(-0.3, 0.3) * strip)
        };
        let [from, c1, c2, to] = [0.0, 0.3, 0.7, 1.0].map(|x| at(x * width, &mut chance));
        let angle_deg = chance.within(30.0, 130.0) * if chance.within(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
        // One in four is sharp; narrower strips than these would only make the mesh large.
        let sharp = chance.within(0.0, 1.0) < 0.25;
        let radius_mm = if sharp { 0.0 } else { chance.within(0.1, 0.25) * strip };
        let segments = Segments::Count(chance.within(1.0, 4.0) as u32);
        softness.push(CreaseSoftness::constant(radius_mm, angle_deg.to_radians(), segments));
        Crease {
            id: CreaseId::new(i),
            name: format!("crease-{i}"),
            role: if angle_deg < 0.0 { Role::Mountain } else { Role::Valley },
            curve: PlanarCurve::new(vec![Segment::Cubic { from, c1, c2, to }]).expect("a curve"),
            fold_angle_rad: None,
            source: Source::default(),
        }
    };
    let creases = (0..count).map(crease).collect();
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0)].map(DVec2::from);
    let outline = PlanarCurve::polyline(&corners).expect("an outline");
    let name = format!("design {seed}");
    (CreasePattern { name, outline, holes: Vec::new(), slits: Vec::new(), creases }, softness)
}

#[test]
fn two_hundred_random_designs_fold_or_say_that_they_are_not_at_rest() {
    let mut table: BTreeMap<String, usize> = BTreeMap::new();
    for seed in 0..DESIGNS {
        let (pattern, softness) = design(seed);
        pattern.check().expect("a sound pattern");
        let what = match folded(&pattern, &softness) {
            Outcome::Refused(why) => format!("refused by {}", why.split(':').next().unwrap_or_default()),
            Outcome::Folded(sheet) => {
                is_honest(&pattern.name, &sheet);
                let what = if sheet.solve.converged { "at rest" } else { "not at rest" };
                if !sheet.solve.converged {
                    say(&format!(
                        "{}: {} vertices, {:?}",
                        pattern.name,
                        sheet.mesh.vertices.len(),
                        sheet.solve
                    ));
                }
                what.to_owned()
            }
        };
        *table.entry(what).or_default() += 1;
    }
    say(&format!("\n{DESIGNS} random designs"));
    table.iter().for_each(|(what, count)| say(&format!("{count:>6}  {what}")));
    assert!(table.get("at rest").is_some_and(|n| *n > 0), "nothing comes to rest");
}
