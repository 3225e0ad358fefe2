//! The last step of reading: dense polylines of the pattern become smooth curves, where creases meet stays.

use crate::ReadOptions;
use crate::apart::{Fineness, crossing};
use crate::error::issue;
use crate::refit::{Refit, refit};
use softfold_geometry::text::number;
use softfold_geometry::{CreasePattern, DVec2, Issue, PlanarCurve, Segment, Severity, polygon};
use std::collections::{BTreeMap, BTreeSet};

/// Refit tolerance over the tolerance within which ends are joined: drawn vertices are exact to about the latter.
const TOLERANCE_PER_JOIN: f64 = 10.0;
/// Most curves that the note names.
const NAMED: usize = 8;

/// Distance of the chords by which curves are checked for crossings, as a share of the refit tolerance.
const CHECK_SHARE: f64 = 0.05;
/// Rounds of taking fits back that cross something; what still does so then leaves all as drawn.
const MAX_ROUNDS: usize = 8;

/// A curve with its dense runs refitted.
struct Fit {
    curve: PlanarCurve,
    parts: Vec<Refit>,
}

/// Refits outline, holes, slits and creases; one note says what was changed, one what would cross something if it were.
pub(crate) fn smooth(pattern: &mut CreasePattern, options: &ReadOptions, issues: &mut Vec<Issue>) {
    let tolerance = pattern.tolerance();
    let tolerance_mm = options.refit_mm.unwrap_or(TOLERANCE_PER_JOIN * tolerance.join_mm);
    let nodes = nodes(pattern);
    unsplit(pattern, &nodes);
    let names = names(pattern);
    let mut curves = curves(pattern);
    let mut fits: Vec<Option<Fit>> = curves.iter().map(|c| Fit::of(c, &nodes, tolerance_mm)).collect();
    let fineness = Fineness { chord_mm: CHECK_SHARE * tolerance_mm, end_mm: tolerance.join_mm };
    let crossing = take_back(&curves, &mut fits, fineness);
    tell(&names, &fits, tolerance_mm, issues);
    tell_crossing(&names, &crossing, issues);
    for (curve, fit) in curves.iter_mut().zip(fits) {
        if let Some(fit) = fit {
            **curve = fit.curve;
        }
    }
    unsplit(pattern, &BTreeSet::new());
}

/// Outline, holes, slits and creases.
fn curves(pattern: &mut CreasePattern) -> Vec<&mut PlanarCurve> {
    let boundaries =
        std::iter::once(&mut pattern.outline).chain(&mut pattern.holes).chain(&mut pattern.slits);
    boundaries.chain(pattern.creases.iter_mut().map(|c| &mut c.curve)).collect()
}

/// What these are called.
fn names(pattern: &CreasePattern) -> Vec<String> {
    let boundaries = (1..=pattern.holes.len() + pattern.slits.len()).map(|i| format!("boundary {i}"));
    let creases = pattern.creases.iter().map(|c| format!("'{}'", c.name));
    std::iter::once("the outline".to_owned()).chain(boundaries).chain(creases).collect()
}

/// Takes back the fits that cross themselves or anything else: what was drawn does not. Each with what it met.
fn take_back(
    curves: &[&mut PlanarCurve],
    fits: &mut [Option<Fit>],
    fineness: Fineness,
) -> BTreeMap<usize, usize> {
    let mut taken = BTreeMap::new();
    for round in 1.. {
        let fitted: BTreeSet<usize> = (0..fits.len()).filter(|&i| fits[i].is_some()).collect();
        let now = curves.iter().zip(fits.iter()).map(|(c, f)| f.as_ref().map_or(&**c, |f| &f.curve));
        let pairs = match fitted.is_empty() {
            true => BTreeSet::new(),
            false => crossing(&now.collect::<Vec<_>>(), &fitted, fineness),
        };
        if pairs.is_empty() {
            break;
        }
        let all = if round < MAX_ROUNDS { BTreeSet::new() } else { fitted };
        for (i, met) in pairs.into_iter().chain(all.into_iter().map(|i| (i, i))) {
            taken.entry(i).or_insert(met);
            fits[i] = None;
        }
    }
    taken
}

/// Makes one line again of lines that were split where something met them, but for the joints that are `held`; drawn
/// corners stay.
fn unsplit(pattern: &mut CreasePattern, held: &BTreeSet<[u64; 2]>) {
    let exact_mm = pattern.tolerance().point_mm;
    for curve in curves(pattern) {
        let mut segments: Vec<Segment> = Vec::new();
        for &segment in curve.segments() {
            match (segments.last().copied(), segment) {
                (Some(Segment::Line { from, to: joint }), Segment::Line { to, .. })
                    if polygon::segment_distance(joint, from, to) <= exact_mm
                        && (joint - from).dot(to - joint) > 0.0
                        && !held.contains(&bits(joint)) =>
                {
                    segments.pop();
                    segments.push(Segment::Line { from, to });
                }
                _ => segments.push(segment),
            }
        }
        if let Ok(whole) = PlanarCurve::new(segments) {
            *curve = whole;
        }
    }
}

/// Where curves end: there the boundary keeps a joint, to the last bit.
fn nodes(pattern: &CreasePattern) -> BTreeSet<[u64; 2]> {
    let open = pattern.creases.iter().map(|c| &c.curve).chain(&pattern.slits).filter(|c| !c.is_closed());
    open.flat_map(|c| [bits(c.end(0)), bits(c.end(1))]).collect()
}

fn bits(p: DVec2) -> [u64; 2] {
    let p = p + DVec2::ZERO; // −0 becomes 0
    [p.x.to_bits(), p.y.to_bits()]
}

impl Fit {
    /// None if there is nothing to refit, or the fit were no curve.
    fn of(curve: &PlanarCurve, nodes: &BTreeSet<[u64; 2]>, tolerance_mm: f64) -> Option<Self> {
        let mut segments: Vec<Segment> = Vec::new();
        let mut parts = Vec::new();
        let held = |s: &Segment| nodes.contains(&bits(s.to()));
        let stretches: Vec<&[Segment]> = curve.segments().split_inclusive(held).collect();
        let ring = curve.is_closed() && stretches.len() == 1 && !curve.segments().last().is_some_and(held);
        for stretch in stretches {
            match refit(stretch, ring, tolerance_mm) {
                Some(fitted) => {
                    segments.extend_from_slice(&fitted.segments);
                    parts.push(fitted);
                }
                None => segments.extend_from_slice(stretch),
            }
        }
        let fitted = PlanarCurve::new(segments).ok()?;
        let whole = !parts.is_empty() && fitted.is_closed() == curve.is_closed();
        whole.then_some(Self { curve: fitted, parts })
    }
}

/// The first few names, and how many more there are.
fn list<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<&str> = names.map(String::as_str).collect();
    let more = names.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", names[..names.len() - names.len().saturating_sub(NAMED)].join(", "))
}

fn tell(names: &[String], fits: &[Option<Fit>], tolerance_mm: f64, issues: &mut Vec<Issue>) {
    let done = || fits.iter().flatten();
    if done().next().is_none() {
        return;
    }
    let largest =
        |of: fn(&Refit) -> f64| number(done().flat_map(|f| &f.parts).map(of).fold(0.0, f64::max), 4);
    let message = format!(
        "dense polylines are now smooth curves within {} mm: {} vertices gone, {} pieces left, vertices at most {} mm off, \
         curves at most {} mm beside the drawn lines, in {}",
        number(tolerance_mm, 4),
        done().flat_map(|f| &f.parts).map(|p| p.vertices).sum::<usize>(),
        done().map(|f| f.curve.segments().len()).sum::<usize>(),
        largest(|p| p.largest_mm),
        largest(|p| p.bulge_mm),
        list(names.iter().zip(fits).filter(|(_, f)| f.is_some()).map(|(n, _)| n)),
    );
    let mend =
        "give refit_mm = 0 to keep the lines as drawn, or more where coordinates are rounded more coarsely";
    issues.push(issue(Severity::Note, message, mend));
}

fn tell_crossing(names: &[String], crossing: &BTreeMap<usize, usize>, issues: &mut Vec<Issue>) {
    let Some((first, met)) = crossing.first_key_value() else { return };
    let met = if first == met { "itself" } else { names[*met].as_str() };
    let message = format!(
        "polylines stay as drawn where a smooth curve through them would cross something ({} would cross {met}): {}",
        names[*first],
        list(crossing.keys().map(|i| &names[*i])),
    );
    let mend = "draw them farther apart, or as smooth curves";
    issues.push(issue(Severity::Warning, message, mend));
}
