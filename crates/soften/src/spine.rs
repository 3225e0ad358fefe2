//! A crease sampled for its parallel curves, run on past its ends.
//!
//! The parallel at offset `o` is `p + o·n` with `n` the left normal. Where the crease has a corner, `n`
//! is the mitre, so that parallels of polylines are polylines with parallel sides.

use crate::Fault;
use softfold_geometry::{DVec2, PlanarCurve, Segment};

/// Sharpest corner of a crease that is taken as a drawn approximation of a curve, rad (60°).
const SHARPEST_CORNER_RAD: f64 = 1.05;
/// A crease is run on with its curvature only if its band keeps this far from the centre of curvature: half
/// width by radius. The ends of drawn curves can have any curvature.
const TIGHTEST_RUN_ON: f64 = 0.5;
/// Most by which the arc that runs a crease on turns, rad.
const WIDEST_RUN_ON_RAD: f64 = 1.0;
/// Longest cubic of such an arc, rad: radial error below 1e-9 of the radius.
const ARC_PIECE_RAD: f64 = 0.15;
/// Halvings of a segment at most when sampling: 2^12 pieces.
const MOST_HALVINGS: u32 = 12;
/// Halvings at least, so that no bend between two test points is missed.
const LEAST_HALVINGS: u32 = 2;

/// A sample of the crease.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Station {
    /// Length along the samples, mm; below 0 and above the crease's length where it is run on.
    pub(crate) s_mm: f64,
    /// Point on the crease.
    pub(crate) point: DVec2,
    /// Offset per mm: the left normal, or the mitre at a corner.
    pub(crate) normal: DVec2,
    /// Curvature, 1/mm, positive to the left.
    pub(crate) curvature: f64,
}

/// The exact curve between two stations: a cubic's parameter range, or none if it is straight.
type Arc = Option<(Cubic, [f64; 2])>;

/// A sampled crease.
#[derive(Clone, Debug)]
pub(crate) struct Spine {
    pub(crate) stations: Vec<Station>,
    arcs: Vec<Arc>,
    /// Length of the sampled crease, without what it is run on by, mm.
    pub(crate) length_mm: f64,
    pub(crate) closed: bool,
}

/// How a crease is sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampling {
    /// Largest offset, mm.
    pub(crate) half_width_mm: f64,
    /// Largest distance of the parallels from their polylines, mm.
    pub(crate) chord_mm: f64,
    /// By how much start and end are run on past the crease, mm.
    pub(crate) run_on_mm: [f64; 2],
}

impl Spine {
    /// Samples a crease.
    ///
    /// # Errors
    /// A corner sharper than [`SHARPEST_CORNER_RAD`].
    pub(crate) fn new(curve: &PlanarCurve, sampling: &Sampling) -> Result<Self, Fault> {
        let mut spine =
            Self { stations: Vec::new(), arcs: Vec::new(), length_mm: 0.0, closed: curve.is_closed() };
        let [before, after] = [0, 1].map(|side| run_on(curve, side, sampling));
        let start_mm = spine.append_all(&before, sampling)?;
        let end_mm = spine.append_all(curve.segments(), sampling)?;
        spine.append_all(&after, sampling)?;
        spine.length_mm = end_mm - start_mm;
        for station in &mut spine.stations {
            station.s_mm -= start_mm;
        }
        if spine.closed {
            spine.close(sampling)?;
        }
        Ok(spine)
    }

    /// Stretches between stations.
    pub(crate) fn pieces(&self) -> usize {
        self.arcs.len()
    }

    /// The middle of the crease: piece number plus share of the piece.
    pub(crate) fn middle(&self) -> f64 {
        let half = 0.5 * self.length_mm;
        let k = self.stations.partition_point(|s| s.s_mm <= half).clamp(1, self.pieces()) - 1;
        let [a, b] = [self.stations[k].s_mm, self.stations[k + 1].s_mm];
        k as f64 + (half - a) / (b - a)
    }

    /// Length along the samples at a place: piece number plus share of the piece.
    pub(crate) fn s_mm(&self, place: f64) -> f64 {
        let k = (place.max(0.0) as usize).min(self.pieces() - 1);
        let [a, b] = [self.stations[k].s_mm, self.stations[k + 1].s_mm];
        a + (place - k as f64) * (b - a)
    }

    /// The parallel's points at the stations.
    pub(crate) fn offset_points(&self, offset_mm: f64) -> Vec<DVec2> {
        self.stations.iter().map(|s| s.point + offset_mm * s.normal).collect()
    }

    /// The exact parallel at share `t` of piece `k`.
    pub(crate) fn parallel(&self, k: usize, t: f64, offset_mm: f64) -> DVec2 {
        let [a, b] = [&self.stations[k], &self.stations[k + 1]];
        let Some((cubic, [t0, t1])) = &self.arcs[k] else {
            return (a.point + offset_mm * a.normal).lerp(b.point + offset_mm * b.normal, t);
        };
        // A mitre at an end of the piece fades out towards the other end.
        let mitre = (a.normal - cubic.normal(*t0)).lerp(b.normal - cubic.normal(*t1), t);
        let u = t0 + t * (t1 - t0);
        cubic.point(u) + offset_mm * (cubic.normal(u) + mitre)
    }

    /// Appends segments; the length so far.
    fn append_all(&mut self, segments: &[Segment], sampling: &Sampling) -> Result<f64, Fault> {
        for segment in segments {
            self.append(segment, sampling)?;
        }
        Ok(self.stations.last().map_or(0.0, |s| s.s_mm))
    }

    fn append(&mut self, segment: &Segment, sampling: &Sampling) -> Result<(), Fault> {
        let samples = match *segment {
            Segment::Line { from, to } => {
                let normal = (to - from).normalize_or_zero().perp();
                let end =
                    |point| Sample { station: Station { s_mm: 0.0, point, normal, curvature: 0.0 }, t: None };
                vec![end(from), end(to)]
            }
            Segment::Cubic { from, c1, c2, to } => {
                let cubic = Cubic([from, c1, c2, to]);
                let ts = cubic.sampled(sampling);
                ts.iter().map(|&t| Sample { station: cubic.station(t), t: Some((cubic, t)) }).collect()
            }
        };
        if let Some(last) = self.stations.last_mut() {
            last.normal = mitred(last.normal, samples[0].station.normal, last.point, sampling)?;
        } else {
            self.stations.push(samples[0].station);
        }
        for pair in samples.windows(2) {
            let before = self.stations[self.stations.len() - 1];
            let s_mm = before.s_mm + before.point.distance(pair[1].station.point);
            self.stations.push(Station { s_mm, ..pair[1].station });
            let arc = pair[0].t.zip(pair[1].t).map(|((cubic, t0), (_, t1))| (cubic, [t0, t1]));
            self.arcs.push(arc);
        }
        Ok(())
    }

    fn close(&mut self, sampling: &Sampling) -> Result<(), Fault> {
        let last = self.stations.len() - 1;
        let first = self.stations[0];
        let normal = mitred(self.stations[last].normal, first.normal, first.point, sampling)?;
        self.stations[last].normal = normal;
        self.stations[last].point = first.point;
        self.stations[0].normal = normal;
        Ok(())
    }
}

/// What runs a crease on past one end: an arc of the curvature that it ends with, so that parallels of
/// a circle stay circles, then a straight piece.
fn run_on(curve: &PlanarCurve, side: usize, sampling: &Sampling) -> Vec<Segment> {
    let length_mm = sampling.run_on_mm[side];
    if length_mm <= 0.0 {
        return Vec::new();
    }
    // Seen from the end, outwards: running backwards turns direction and curvature round.
    let (s_mm, sign) = if side == 0 { (0.0, -1.0) } else { (curve.length_mm(), 1.0) };
    let (mut at, mut direction) = (curve.point(s_mm), sign * curve.tangent(s_mm));
    let mut curvature = sign * curve.curvature(s_mm);
    let reach = curvature.abs() * sampling.half_width_mm;
    if !reach.is_finite() || reach > TIGHTEST_RUN_ON {
        curvature = 0.0;
    }
    let mut segments = Vec::new();
    let arc_mm = length_mm.min(WIDEST_RUN_ON_RAD / curvature.abs());
    if curvature != 0.0 {
        let pieces = (arc_mm * curvature.abs() / ARC_PIECE_RAD).ceil();
        for _ in 0..pieces as usize {
            let segment = circular(at, direction, curvature, arc_mm / pieces);
            direction = direction.rotate(DVec2::from_angle(curvature * arc_mm / pieces));
            at = segment.to();
            segments.push(segment);
        }
    }
    if length_mm > arc_mm || curvature == 0.0 {
        let rest = if curvature == 0.0 { length_mm } else { length_mm - arc_mm };
        segments.push(Segment::Line { from: at, to: at + rest * direction });
    }
    match side {
        0 => segments.iter().rev().map(Segment::reversed).collect(),
        _ => segments,
    }
}

/// A short arc as a cubic: control points a third of the way, `4/3 tan(φ/4)` of the radius.
fn circular(from: DVec2, direction: DVec2, curvature: f64, length_mm: f64) -> Segment {
    let angle = curvature * length_mm;
    let out = direction.rotate(DVec2::from_angle(angle));
    // Chord of an arc: 2 sin(φ/2)/κ towards half the angle.
    let to =
        from + direction.rotate(DVec2::from_angle(0.5 * angle)) * (2.0 * (0.5 * angle).sin() / curvature);
    let control = 4.0 / 3.0 * (0.25 * angle).tan() / curvature;
    Segment::Cubic { from, c1: from + control * direction, c2: to - control * out, to }
}

struct Sample {
    station: Station,
    t: Option<(Cubic, f64)>,
}

/// The mitre of two normals. A crease without width may have any corner.
fn mitred(a: DVec2, b: DVec2, at: DVec2, sampling: &Sampling) -> Result<DVec2, Fault> {
    if sampling.half_width_mm == 0.0 {
        return Ok(b);
    }
    let turn_rad = a.angle_to(b);
    if turn_rad.abs() > SHARPEST_CORNER_RAD {
        return Err(Fault::Corner { at, turn_rad });
    }
    Ok((a + b) / (1.0 + a.dot(b)))
}

/// A cubic Bézier by its control points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cubic(pub(crate) [DVec2; 4]);

impl Cubic {
    pub(crate) fn point(&self, t: f64) -> DVec2 {
        let [a, b, c, d] = self.0;
        let s = 1.0 - t;
        s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
    }

    fn first(&self, t: f64) -> DVec2 {
        let [a, b, c, d] = self.0;
        let s = 1.0 - t;
        3.0 * (s * s * (b - a) + 2.0 * s * t * (c - b) + t * t * (d - c))
    }

    fn second(&self, t: f64) -> DVec2 {
        let [a, b, c, d] = self.0;
        6.0 * ((1.0 - t) * (a - 2.0 * b + c) + t * (b - 2.0 * c + d))
    }

    /// Left unit normal; where a control point lies on its end, the limit from inside.
    fn normal(&self, t: f64) -> DVec2 {
        let towards_middle = if t < 0.5 { 1.0 } else { -1.0 };
        let direction = self.first(t).try_normalize();
        let limit = || (self.second(t) * towards_middle).normalize_or_zero();
        direction.unwrap_or_else(limit).perp()
    }

    fn curvature(&self, t: f64) -> f64 {
        let (d, dd) = (self.first(t), self.second(t));
        let speed = d.length();
        if speed > 0.0 { d.perp_dot(dd) / (speed * speed * speed) } else { 0.0 }
    }

    fn station(&self, t: f64) -> Station {
        Station { s_mm: 0.0, point: self.point(t), normal: self.normal(t), curvature: self.curvature(t) }
    }

    /// Parameters at which the crease and both edges of the band stay within the chord tolerance.
    fn sampled(&self, sampling: &Sampling) -> Vec<f64> {
        let mut ts = vec![0.0];
        self.sample([0.0, 1.0], 0, sampling, &mut ts);
        ts
    }

    fn sample(&self, [t0, t1]: [f64; 2], halvings: u32, sampling: &Sampling, ts: &mut Vec<f64>) {
        let flat = halvings >= LEAST_HALVINGS && self.is_flat([t0, t1], sampling);
        if flat || halvings == MOST_HALVINGS {
            ts.push(t1);
            return;
        }
        let middle = 0.5 * (t0 + t1);
        self.sample([t0, middle], halvings + 1, sampling, ts);
        self.sample([middle, t1], halvings + 1, sampling, ts);
    }

    fn is_flat(&self, [t0, t1]: [f64; 2], sampling: &Sampling) -> bool {
        let h = sampling.half_width_mm;
        [-h, 0.0, h].into_iter().all(|o| {
            let at = |t: f64| self.point(t) + o * self.normal(t);
            let (a, m, b) = (at(t0), at(0.5 * (t0 + t1)), at(t1));
            softfold_geometry::polygon::segment_distance(m, a, b) <= sampling.chord_mm
        })
    }
}
