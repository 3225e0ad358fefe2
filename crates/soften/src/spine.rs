//! A crease sampled for the fold lines of its band, run on past its ends where they reach the boundary.
//!
//! The fold line of share `c` is `p(s) + c x(s) n(s)` with `n` the left normal and `x` the width of a strip.
//! Where the crease has a corner, `n` is the mitre, so that parallels of polylines are polylines with
//! parallel sides.

use crate::Fault;
use crate::path::Path;
use crate::profile::Profile;
use crate::run_on::run_on;
use softfold_geometry::{DVec2, PlanarCurve, polygon};

/// Sharpest corner of a crease that is taken as a drawn approximation of a curve, rad (60°).
const SHARPEST_CORNER_RAD: f64 = 1.05;
/// Halvings of a piece at most when sampling: 2^12 pieces.
const MOST_HALVINGS: u32 = 12;
/// Halvings of a curved piece at least, so that no bend between two test points is missed.
const LEAST_HALVINGS: u32 = 1;
/// Where the distance of a chord from its curve is tested, as shares of the piece.
const TESTED: [f64; 3] = [0.25, 0.5, 0.75];
/// Places closer than this share of the crease are one: the accuracy of arc lengths.
const SAME_PLACE: f64 = 1e-9;

/// A sample of the crease.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Station {
    /// Arc length, mm; outside the crease where it is run on.
    pub(crate) s_mm: f64,
    /// Point on the crease.
    pub(crate) point: DVec2,
    /// Offset per mm: the left normal, or the mitre at a corner.
    pub(crate) normal: DVec2,
    /// Curvature, 1/mm, positive to the left.
    pub(crate) curvature: f64,
    /// Width of a strip, mm.
    pub(crate) strip_mm: f64,
}

/// Part of a path, with the arc lengths of its ends on the crease.
#[derive(Clone, Copy, Debug)]
struct Span {
    path: Path,
    t: [f64; 2],
    s_mm: [f64; 2],
}

/// A sampled crease.
#[derive(Clone, Debug)]
pub(crate) struct Spine<'a> {
    profile: &'a Profile,
    pub(crate) stations: Vec<Station>,
    /// What lies between two stations.
    spans: Vec<Span>,
}

/// What is sampled, and how finely.
#[derive(Clone, Debug)]
pub(crate) struct Sampling {
    /// Places that must be stations, ascending; the first and the last bound what is sampled.
    pub(crate) places_mm: Vec<f64>,
    /// Largest distance of the fold lines from their polylines, mm.
    pub(crate) chord_mm: f64,
    /// By how much start and end are run on past the crease, mm.
    pub(crate) run_on_mm: [f64; 2],
}

impl<'a> Spine<'a> {
    /// Samples a crease.
    ///
    /// # Errors
    /// A corner sharper than [`SHARPEST_CORNER_RAD`] on a soft stretch.
    pub(crate) fn new(curve: &PlanarCurve, profile: &'a Profile, sampling: &Sampling) -> Result<Self, Fault> {
        let mut spine = Self { profile, stations: Vec::new(), spans: Vec::new() };
        let mut spans = run_on_spans(curve, profile, sampling, 0);
        spans.extend(spans_between(curve, &sampling.places_mm));
        spans.extend(run_on_spans(curve, profile, sampling, 1));
        for span in spans {
            spine.append(&span, sampling.chord_mm)?;
        }
        if profile.ring {
            spine.close()?;
        }
        Ok(spine)
    }

    /// The station at a place that was asked for.
    pub(crate) fn index_of(&self, s_mm: f64) -> usize {
        self.stations.partition_point(|s| s.s_mm < s_mm).min(self.stations.len() - 1)
    }

    /// A fold line's points at a range of stations.
    pub(crate) fn points(&self, share: f64, stations: std::ops::RangeInclusive<usize>) -> Vec<DVec2> {
        self.stations[stations].iter().map(|s| s.at(share)).collect()
    }

    /// The exact point of a fold line at share `t` of piece `k`, and its foot's arc length.
    pub(crate) fn exact(&self, k: usize, t: f64, share: f64) -> (DVec2, f64) {
        let ([a, b], span) = ([&self.stations[k], &self.stations[k + 1]], &self.spans[k]);
        let u = span.t[0] + t * (span.t[1] - span.t[0]);
        let s_mm = span.s_mm_at(u);
        let offset_mm = if share == 0.0 { 0.0 } else { share * self.profile.strip_width_mm(s_mm) };
        // A mitre at an end of the piece fades out towards the other end.
        let mitre = (a.normal - span.path.normal(span.t[0])).lerp(b.normal - span.path.normal(span.t[1]), t);
        (span.path.point(u) + offset_mm * (span.path.normal(u) + mitre), s_mm)
    }

    fn station(&self, span: &Span, t: f64, s_mm: f64) -> Station {
        let strip_mm = self.profile.strip_width_mm(s_mm);
        let (point, normal) = (span.path.point(t), span.path.normal(t));
        Station { s_mm, point, normal, curvature: span.path.curvature(t), strip_mm }
    }

    fn append(&mut self, span: &Span, chord_mm: f64) -> Result<(), Fault> {
        let first = self.station(span, span.t[0], span.s_mm[0]);
        match self.stations.last_mut() {
            Some(last) => last.normal = mitred(last.normal, &first)?,
            None => self.stations.push(first),
        }
        self.sample(span, 0, chord_mm);
        Ok(())
    }

    fn sample(&mut self, span: &Span, halvings: u32, chord_mm: f64) {
        let enough = halvings >= LEAST_HALVINGS || span.path.is_line();
        if (enough && self.is_flat(span, chord_mm)) || halvings == MOST_HALVINGS {
            self.stations.push(self.station(span, span.t[1], span.s_mm[1]));
            self.spans.push(*span);
            return;
        }
        let t = 0.5 * (span.t[0] + span.t[1]);
        let s_mm = span.s_mm_at(t);
        self.sample(&Span { t: [span.t[0], t], s_mm: [span.s_mm[0], s_mm], ..*span }, halvings + 1, chord_mm);
        self.sample(&Span { t: [t, span.t[1]], s_mm: [s_mm, span.s_mm[1]], ..*span }, halvings + 1, chord_mm);
    }

    /// Whether chords stand for the crease and both edges of its band; all fold lines lie between them.
    fn is_flat(&self, span: &Span, chord_mm: f64) -> bool {
        let half = 0.5 * f64::from(self.profile.band.segments);
        let [a, b] = [0, 1].map(|i| self.station(span, span.t[i], span.s_mm[i]));
        let straight = span.path.is_line();
        if straight && a.strip_mm == 0.0 && b.strip_mm == 0.0 && self.is_sharp(span) {
            return true;
        }
        let tested = TESTED.map(|share| {
            let t = span.t[0] + share * (span.t[1] - span.t[0]);
            self.station(span, t, span.s_mm_at(t))
        });
        [-half, 0.0, half].into_iter().all(|share| {
            let [a, b] = [a.at(share), b.at(share)];
            tested.iter().all(|m| polygon::segment_distance(m.at(share), a, b) <= chord_mm)
        })
    }

    fn is_sharp(&self, span: &Span) -> bool {
        self.profile.strip_width_mm(0.5 * (span.s_mm[0] + span.s_mm[1])) == 0.0
    }

    fn close(&mut self) -> Result<(), Fault> {
        let first = self.stations[0];
        let last = self.stations.len() - 1;
        let normal = mitred(self.stations[last].normal, &first)?;
        // The arc length stays: radius and angle are the same there.
        let s_mm = self.stations[last].s_mm;
        self.stations[0].normal = normal;
        self.stations[last] = Station { s_mm, normal, ..first };
        Ok(())
    }
}

impl Station {
    /// The point of a fold line.
    pub(crate) fn at(&self, share: f64) -> DVec2 {
        if share == 0.0 { self.point } else { self.point + share * self.strip_mm * self.normal }
    }
}

impl Span {
    fn s_mm_at(&self, t: f64) -> f64 {
        if t == self.t[1] {
            return self.s_mm[1];
        }
        let share = self.path.arc_mm([self.t[0], t]) / self.path.arc_mm(self.t);
        self.s_mm[0] + share * (self.s_mm[1] - self.s_mm[0])
    }
}

/// The parts of a crease between neighbouring places and joints of its segments. Places beyond the length
/// of a closed crease go on from its start.
fn spans_between(curve: &PlanarCurve, places_mm: &[f64]) -> Vec<Span> {
    let (length, joints) = (curve.length_mm(), curve.joints_mm());
    let slack = SAME_PLACE * length;
    let mut all = places_mm.to_vec();
    let [low, high] = [places_mm[0], places_mm[places_mm.len() - 1]];
    for joint in joints.iter().flat_map(|j| [*j, j + length]) {
        let i = places_mm.partition_point(|p| *p < joint);
        let near = [i.checked_sub(1), Some(i)].into_iter().flatten().filter_map(|i| places_mm.get(i));
        if joint > low && joint < high && near.into_iter().all(|p| (p - joint).abs() > slack) {
            all.push(joint);
        }
    }
    all.sort_by(f64::total_cmp);
    all.dedup();
    all.windows(2).map(|w| span_of(curve, [w[0], w[1]], slack)).collect()
}

/// The part of one segment between two places.
fn span_of(curve: &PlanarCurve, s_mm: [f64; 2], slack: f64) -> Span {
    let (length, joints) = (curve.length_mm(), curve.joints_mm());
    let middle = 0.5 * (s_mm[0] + s_mm[1]);
    let lap = if middle > length { length } else { 0.0 };
    let segments = curve.segments();
    let i = joints.partition_point(|j| *j <= middle - lap).clamp(1, segments.len()) - 1;
    let path = Path::from(&segments[i]);
    let parameter = |s: f64| match s - lap {
        s if s <= joints[i] + slack => 0.0,
        s if s >= joints[i + 1] - slack => 1.0,
        s => path.parameter(s - joints[i]),
    };
    Span { path, t: s_mm.map(parameter), s_mm }
}

fn run_on_spans(curve: &PlanarCurve, profile: &Profile, sampling: &Sampling, side: usize) -> Vec<Span> {
    let edge_mm = [0.0, curve.length_mm()][side];
    let half_width_mm = profile.half_width_mm(edge_mm);
    let segments = run_on(curve, side, half_width_mm, sampling.run_on_mm[side]);
    let paths: Vec<Path> = segments.iter().map(Path::from).collect();
    let total: f64 = paths.iter().map(|p| p.arc_mm([0.0, 1.0])).sum();
    let mut s_mm = if side == 0 { -total } else { edge_mm };
    let mut spans = Vec::with_capacity(paths.len());
    for path in paths {
        let end = s_mm + path.arc_mm([0.0, 1.0]);
        spans.push(Span { path, t: [0.0, 1.0], s_mm: [s_mm, end] });
        s_mm = end;
    }
    if let (0, Some(last)) = (side, spans.last_mut()) {
        last.s_mm[1] = 0.0;
    }
    spans
}

/// The mitre of a normal and that of the station it meets. A crease without width may have any corner.
fn mitred(a: DVec2, next: &Station) -> Result<DVec2, Fault> {
    let b = next.normal;
    if next.strip_mm == 0.0 || a == b {
        return Ok(b);
    }
    let turn_rad = a.angle_to(b);
    if turn_rad.abs() > SHARPEST_CORNER_RAD {
        return Err(Fault::Corner { at: next.point, turn_rad });
    }
    Ok((a + b) / (1.0 + a.dot(b)))
}
