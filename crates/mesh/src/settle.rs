//! Points at small angles move to where the smallest angle around them is largest: free ones anywhere, those on curves
//! along their curve.

use crate::MeshOptions;
use crate::refine::{Planar, topology};
use crate::rings::Rings;
use crate::sharp::Sharp;
use crate::topology::least_angle_rad;
use crate::{MeshError, tracks::Span};
use glam::DVec2;
use softfold_geometry::VertexId;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Directions tried around a free point.
const DIRECTIONS: u32 = 8;
/// First step, share of the mean distance to the neighbours, how often it is halved, and steps in all.
const FIRST_STEP: f64 = 0.25;
const HALVINGS: u32 = 4;
const STEPS: u32 = 24;
/// A point on a curve keeps this share of both its edges.
const LEAST_LEFT: f64 = 0.3;
/// No move makes a piece shorter than this share of the distance at which curves all but touch: round by round the other
/// share alone would make some as short as nothing.
const LEAST_PIECE: f64 = 0.5;

/// What points move for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Aim {
    /// The smallest angle around each.
    Least,
    /// The mean of the smallest angles of the triangles around it; none of them gets bad by it.
    Mean,
}

/// For the sake of the mean no angle gets smaller than this, degrees.
const KEPT_DEG: f64 = 32.0;
/// Triangles that the pattern itself makes sharp do not count, but keep this share of their smallest angle.
const KEPT_SHARP: f64 = 0.5;

/// Moves the corners of triangles with smaller angles than that; whether any moved.
pub(crate) fn round(
    planar: &mut Planar<'_>,
    options: &MeshOptions,
    chord_mm: f64,
    (below_deg, aim): (f64, Aim),
) -> Result<bool, MeshError> {
    let topology = topology(planar, options.backend)?;
    let sharp = Sharp::new(planar, options.target_edge_mm);
    let small = below_deg.to_radians();
    let mut corners = BTreeSet::new();
    let mut excused = vec![false; topology.triangles.len()];
    for (t, excused) in excused.iter_mut().enumerate() {
        *excused = sharp.excuse(planar, &topology, t).is_some();
        if !*excused && least_angle_rad(topology.corners(&planar.graph.points, t)) < small {
            corners.extend(topology.triangles[t]);
        }
    }
    let rings = Rings::new(planar.graph.points.len(), &topology.triangles);
    let mut moved = false;
    for v in corners {
        let around = rings.of(v.index()).iter().map(|&t| t as usize);
        let ring: Vec<RingTriangle> = around.map(|t| (topology.triangles[t], excused[t])).collect();
        moved |= match sharp.slide(planar, v) {
            Some(pair) => {
                let slide = Slide { pair, chord_mm, least_mm: LEAST_PIECE * sharp.near_mm };
                slide.slid(planar, (v, &ring), aim)
            }
            None if sharp.at(v).is_empty() => float(planar, (v, &ring), aim),
            None => false,
        };
    }
    Ok(moved)
}

/// Corners of a triangle, and whether the pattern itself makes it sharp.
type RingTriangle = ([VertexId; 3], bool);

/// A vertex with the triangles around it.
type Ringed<'r> = (VertexId, &'r [RingTriangle]);

/// What is around a vertex, rad.
struct Angles {
    /// Smallest angle, and mean of those of the triangles.
    least: f64,
    mean: f64,
    /// Smallest angle of those that the pattern makes sharp.
    sharp: f64,
}

/// The angles around a vertex if it were at a place.
fn angles(points: &[DVec2], (v, ring): Ringed<'_>, place: DVec2) -> Angles {
    let at = |w: VertexId| if w == v { place } else { points[w.index()] };
    let (mut least, mut sharp, mut sum, mut count) = (f64::MAX, f64::MAX, 0.0, 0);
    for (t, excused) in ring {
        let angle = least_angle_rad(t.map(at));
        if *excused {
            sharp = sharp.min(angle);
        } else {
            (least, sum, count) = (least.min(angle), sum + angle, count + 1);
        }
    }
    Angles { least, mean: sum / f64::from(count.max(1)), sharp }
}

/// What a place is worth to a vertex.
fn worth<'r>(points: &'r [DVec2], ringed: Ringed<'r>, aim: Aim) -> impl Fn(DVec2) -> f64 + 'r {
    let now = angles(points, ringed, points[ringed.0.index()]);
    let kept = now.least.min(KEPT_DEG.to_radians());
    move |place| {
        let Angles { least, mean, sharp } = angles(points, ringed, place);
        match aim {
            _ if sharp < KEPT_SHARP * now.sharp => sharp.min(least) - TAU,
            Aim::Least => least,
            Aim::Mean if least < kept => least - TAU,
            Aim::Mean => mean,
        }
    }
}

fn float(planar: &mut Planar<'_>, (v, ring): Ringed<'_>, aim: Aim) -> bool {
    let points = &planar.graph.points;
    let start = points[v.index()];
    let far: f64 = ring.iter().flat_map(|r| r.0).map(|w| points[w.index()].distance(start)).sum();
    let step = FIRST_STEP * far / (2 * ring.len().max(1)) as f64;
    let around = |p: DVec2, step: f64| {
        (0..DIRECTIONS)
            .map(move |k| p + step * DVec2::from_angle(TAU * f64::from(k) / f64::from(DIRECTIONS)))
            .collect()
    };
    let best = climb(start, step, around, worth(points, (v, ring), aim));
    planar.graph.points[v.index()] = best;
    best != start
}

/// A move along a curve.
struct Slide {
    /// The pieces before and after the vertex.
    pair: [u32; 2],
    chord_mm: f64,
    /// No piece gets shorter than this.
    least_mm: f64,
}

impl Slide {
    /// Moves a vertex; whether it did.
    fn slid(&self, planar: &mut Planar<'_>, (v, ring): Ringed<'_>, aim: Aim) -> bool {
        let &Slide { pair, chord_mm, least_mm } = self;
        let [before, after] = pair.map(|c| planar.spans[c as usize]);
        let track = &planar.tracks[before.track as usize];
        let kept = |span: Span| (LEAST_LEFT * span.length_mm()).max(least_mm.min(span.length_mm()));
        let least = before.from_mm + kept(before);
        let most = after.to_mm - kept(after);
        let points = &planar.graph.points;
        let others = [
            planar.graph.constraints[pair[0] as usize].0[0],
            planar.graph.constraints[pair[1] as usize].0[1],
        ]
        .map(|w| points[w.index()]);
        let bends = |s: f64, p: DVec2| {
            let spans = [Span { to_mm: s, ..before }, Span { from_mm: s, ..after }];
            let bent = |(span, ends): (&Span, [DVec2; 2])| track.chord_error_mm(span, ends).0 > chord_mm;
            spans.iter().zip([[others[0], p], [p, others[1]]]).any(bent)
        };
        let start = before.to_mm;
        let best = {
            let worth = worth(points, (v, ring), aim);
            let now = worth(points[v.index()]);
            let value = |s: f64| {
                let p = track.about(s);
                let worth = worth(p);
                if worth > now && bends(s, p) { f64::MIN } else { worth }
            };
            let step = FIRST_STEP * 0.5 * (after.to_mm - before.from_mm);
            climb(start, step, |s, step| vec![(s - step).max(least), (s + step).min(most)], value)
        };
        if best == start {
            return false;
        }
        planar.graph.points[v.index()] = track.point(best);
        planar.spans[pair[0] as usize].to_mm = best;
        planar.spans[pair[1] as usize].from_mm = best;
        pair.iter().for_each(|&c| planar.turn(c as usize));
        planar.sites[v.index()] =
            planar.site(before.track, best, &planar.graph.constraints[pair[0] as usize].1);
        true
    }
}

/// The best place that is found from a start in shrinking steps.
fn climb<P: Copy>(
    start: P,
    first_step: f64,
    around: impl Fn(P, f64) -> Vec<P>,
    worth: impl Fn(P) -> f64,
) -> P {
    let (mut place, mut best, mut step, mut halvings) = (start, worth(start), first_step, 0);
    for _ in 0..STEPS {
        let tried = around(place, step).into_iter().map(|p| (worth(p), p));
        match tried.reduce(|a, b| if b.0 > a.0 { b } else { a }) {
            Some((better, p)) if better > best + 1e-6 => (best, place) = (better, p),
            _ if halvings == HALVINGS => break,
            _ => {
                step *= 0.5;
                halvings += 1;
            }
        }
    }
    place
}
