//! The last step of reading: dense polylines of the pattern become smooth curves, where creases meet stays.

use crate::ReadOptions;
use crate::error::issue;
use crate::refit::{Refit, refit};
use softfold_geometry::text::number;
use softfold_geometry::{CreasePattern, DVec2, Issue, PlanarCurve, Segment, Severity, polygon};
use std::collections::BTreeSet;

/// Refit tolerance over the tolerance within which ends are joined: drawn vertices are exact to about the latter.
const TOLERANCE_PER_JOIN: f64 = 10.0;
/// Most curves that the note names.
const NAMED: usize = 8;

/// What was refitted.
#[derive(Default)]
struct Done {
    names: Vec<String>,
    vertices: usize,
    pieces: usize,
    largest_mm: f64,
    bulge_mm: f64,
}

/// Refits outline, holes, slits and creases; one note says what was changed.
pub(crate) fn smooth(pattern: &mut CreasePattern, options: &ReadOptions, issues: &mut Vec<Issue>) {
    let tolerance_mm = options.refit_mm.unwrap_or(TOLERANCE_PER_JOIN * pattern.tolerance().join_mm);
    let mut done = Done::default();
    unsplit(pattern);
    let nodes = nodes(pattern);
    let boundaries =
        std::iter::once(&mut pattern.outline).chain(&mut pattern.holes).chain(&mut pattern.slits);
    for (i, curve) in boundaries.enumerate() {
        let name = if i == 0 { "the outline".to_owned() } else { format!("boundary {i}") };
        done.take(curve, &name, &nodes, tolerance_mm);
    }
    for crease in &mut pattern.creases {
        let name = format!("'{}'", crease.name);
        done.take(&mut crease.curve, &name, &BTreeSet::new(), tolerance_mm);
    }
    done.tell(tolerance_mm, issues);
}

/// Makes one line again of lines that were split where something ends on them; drawn corners stay.
fn unsplit(pattern: &mut CreasePattern) {
    let exact_mm = pattern.tolerance().point_mm;
    let boundaries =
        std::iter::once(&mut pattern.outline).chain(&mut pattern.holes).chain(&mut pattern.slits);
    for curve in boundaries.chain(pattern.creases.iter_mut().map(|c| &mut c.curve)) {
        let mut segments: Vec<Segment> = Vec::new();
        for &segment in curve.segments() {
            match (segments.last().copied(), segment) {
                (Some(Segment::Line { from, to: joint }), Segment::Line { to, .. })
                    if polygon::segment_distance(joint, from, to) <= exact_mm
                        && (joint - from).dot(to - joint) > 0.0 =>
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

impl Done {
    fn take(&mut self, curve: &mut PlanarCurve, name: &str, nodes: &BTreeSet<[u64; 2]>, tolerance_mm: f64) {
        let mut segments: Vec<Segment> = Vec::new();
        let mut changed = Vec::new();
        let held = |s: &Segment| nodes.contains(&bits(s.to()));
        let stretches: Vec<&[Segment]> = curve.segments().split_inclusive(held).collect();
        let ring = curve.is_closed() && stretches.len() == 1 && !curve.segments().last().is_some_and(held);
        for stretch in stretches {
            match refit(stretch, ring, tolerance_mm) {
                Some(fitted) => {
                    segments.extend_from_slice(&fitted.segments);
                    changed.push(fitted);
                }
                None => segments.extend_from_slice(stretch),
            }
        }
        // A fit that were no curve would leave the drawing as it is.
        let Ok(fitted) = PlanarCurve::new(segments) else { return };
        if !changed.is_empty() && fitted.is_closed() == curve.is_closed() {
            changed.iter().for_each(|f| self.count(f));
            self.pieces += fitted.segments().len();
            self.names.push(name.to_owned());
            *curve = fitted;
        }
    }

    fn count(&mut self, fitted: &Refit) {
        self.vertices += fitted.vertices;
        self.largest_mm = self.largest_mm.max(fitted.largest_mm);
        self.bulge_mm = self.bulge_mm.max(fitted.bulge_mm);
    }

    fn tell(&self, tolerance_mm: f64, issues: &mut Vec<Issue>) {
        if self.names.is_empty() {
            return;
        }
        let more = self.names.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let message = format!(
            "dense polylines are now smooth curves within {} mm: {} vertices gone, {} pieces left, vertices at most {} mm off, \
             curves at most {} mm beside the drawn lines, in {}{more}",
            number(tolerance_mm, 4),
            self.vertices,
            self.pieces,
            number(self.largest_mm, 4),
            number(self.bulge_mm, 4),
            self.names[..self.names.len().min(NAMED)].join(", ")
        );
        issues.push(issue(Severity::Note, message, "give refit_mm = 0 to keep the lines as drawn"));
    }
}
