//! A pattern as vertices and straight edges: curves flattened, edges split where other lines end on them.

use kurbo::{CubicBez, ParamCurve, ParamCurveNearest, Point};
use softfold_geometry::{CreasePattern, DVec2, PlanarCurve, Role, Segment, polygon, text};
use std::collections::BTreeMap;

/// Decimals of every coordinate: a millionth of a nanometre, so that reading back gives the same curves.
const DECIMALS: usize = 12;
/// Most pieces of one cubic, as where curves are flattened elsewhere.
const MAX_PIECES: usize = 4096;
/// Fewest pieces of one cubic, so that a closed curve never becomes a single chord.
const MIN_PIECES: usize = 2;
/// Accuracy of a nearest point, mm².
const NEAREST_ACCURACY_MM2: f64 = 1e-12;

/// One line of the pattern.
pub(super) struct Drawn<'a> {
    /// With the coordinates as they are written, so that what is read back is written the same.
    pub(super) segments: Vec<Segment>,
    closed: bool,
    pub(super) role: Role,
    /// The crease's name; none for outline, holes and slits.
    pub(super) name: Option<&'a str>,
    pub(super) angle_deg: Option<f64>,
}

/// A straight edge.
pub(super) struct PlanarEdge {
    pub(super) vertices: [usize; 2],
    /// Number of its line.
    pub(super) line: usize,
    /// Where it begins and ends on it; the whole part counts segments.
    pub(super) span: [f64; 2],
}

/// The pattern as a graph.
pub(super) struct Planar<'a> {
    /// Outline, holes, slits, creases.
    pub(super) lines: Vec<Drawn<'a>>,
    /// Coordinates as they are written.
    pub(super) vertices: Vec<[String; 2]>,
    /// In the order of the lines, along each.
    pub(super) edges: Vec<PlanarEdge>,
}

/// A number as it is written.
pub(super) fn number(x: f64) -> String {
    text::number(x, DECIMALS)
}

/// A curve with its coordinates as they are written.
fn written(curve: &PlanarCurve) -> Vec<Segment> {
    let round = |x: f64| number(x).parse().unwrap_or(x);
    let round = |p: DVec2| DVec2::new(round(p.x), round(p.y));
    let segment = |s: &Segment| match *s {
        Segment::Line { from, to } => Segment::Line { from: round(from), to: round(to) },
        Segment::Cubic { from, c1, c2, to } => {
            Segment::Cubic { from: round(from), c1: round(c1), c2: round(c2), to: round(to) }
        }
    };
    curve.segments().iter().map(segment).collect()
}

impl Drawn<'_> {
    fn end(&self, side: usize) -> DVec2 {
        match side {
            0 => self.segments[0].from(),
            _ => self.segments[self.segments.len() - 1].to(),
        }
    }
}

/// All lines of a pattern.
fn lines(pattern: &CreasePattern) -> Vec<Drawn<'_>> {
    let drawn = |curve: &PlanarCurve, role| Drawn {
        segments: written(curve),
        closed: curve.is_closed(),
        role,
        name: None,
        angle_deg: None,
    };
    let loops = pattern.loops().map(|(_, c)| drawn(c, Role::Boundary));
    let slits = pattern.slits.iter().map(|c| drawn(c, Role::Cut));
    let creases = pattern.creases.iter().map(|c| Drawn {
        name: Some(c.name.as_str()),
        angle_deg: c.fold_angle_rad.map(f64::to_degrees),
        ..drawn(&c.curve, c.role)
    });
    loops.chain(slits).chain(creases).collect()
}

impl<'a> Planar<'a> {
    /// The graph of a pattern; curves keep `chord_mm`.
    pub(super) fn new(pattern: &'a CreasePattern, chord_mm: f64) -> Self {
        let lines = lines(pattern);
        let reach_mm = pattern.tolerance().join_mm;
        let mut planar = Self { vertices: Vec::new(), edges: Vec::new(), lines: Vec::new() };
        let mut numbers = BTreeMap::new();
        for i in 0..lines.len() {
            let ends = (0..lines.len()).filter(|&j| j != i && !lines[j].closed);
            let ends: Vec<DVec2> = ends.flat_map(|j| [lines[j].end(0), lines[j].end(1)]).collect();
            let stops = stops(&lines[i], chord_mm, &ends, reach_mm);
            planar.add(i, &stops, &mut numbers);
        }
        planar.lines = lines;
        planar
    }

    /// The edges of a line.
    fn add(&mut self, line: usize, stops: &[(f64, DVec2)], numbers: &mut BTreeMap<[String; 2], usize>) {
        let mut last: Option<(f64, usize)> = None;
        for (k, &(t, p)) in stops.iter().enumerate() {
            let key = [number(p.x), number(p.y)];
            let vertex = *numbers.entry(key.clone()).or_insert(self.vertices.len());
            if vertex == self.vertices.len() {
                self.vertices.push(key);
            }
            match last {
                // Stops that are written alike are one, but the line goes on to its end.
                Some((_, before)) if before == vertex && k + 1 < stops.len() => continue,
                Some((from, before)) if before != vertex => {
                    self.edges.push(PlanarEdge { vertices: [before, vertex], line, span: [from, t] });
                }
                Some(_) => {
                    if let Some(edge) = self.edges.last_mut().filter(|e| e.line == line) {
                        edge.span[1] = t;
                    }
                }
                None => {}
            }
            last = Some((t, vertex));
        }
    }
}

/// Where a curve is cut into edges, along the curve: its joints, the points of its flattening, and the ends of
/// other lines on it, which keep their own coordinates.
fn stops(line: &Drawn<'_>, chord_mm: f64, ends: &[DVec2], reach_mm: f64) -> Vec<(f64, DVec2)> {
    let mut stops = vec![(0.0, line.end(0))];
    for (i, segment) in line.segments.iter().enumerate() {
        let n = pieces(segment, chord_mm);
        let inner = (1..n).map(|k| k as f64 / n as f64).map(|t| (t, eval(segment, t)));
        let mut inner = with_ends(segment, inner.collect(), ends, reach_mm);
        inner.sort_by(|a, b| a.0.total_cmp(&b.0));
        stops.extend(inner.into_iter().map(|(t, p)| (i as f64 + t, p)));
        stops.push(((i + 1) as f64, segment.to()));
    }
    let last = stops.len() - 1;
    if line.closed {
        stops[last].1 = stops[0].1;
    }
    let joints = if line.closed { 0..last + 1 } else { 1..last };
    for stop in stops[joints].iter_mut().filter(|s| s.0.fract() == 0.0) {
        let near = ends.iter().filter(|e| e.distance(stop.1) <= reach_mm);
        let nearest = near.min_by(|a, b| a.distance(stop.1).total_cmp(&b.distance(stop.1)));
        stop.1 = nearest.copied().unwrap_or(stop.1);
    }
    stops
}

/// The inner stops of a segment, with the ends of other lines on it in place of what they come near.
fn with_ends(
    segment: &Segment,
    mut inner: Vec<(f64, DVec2)>,
    ends: &[DVec2],
    reach_mm: f64,
) -> Vec<(f64, DVec2)> {
    let mut taken: Vec<(f64, DVec2)> = Vec::new();
    for &end in ends {
        let (t, distance) = nearest(segment, end, reach_mm);
        let near = |p: DVec2| p.distance(end) <= reach_mm;
        if distance > reach_mm || near(segment.from()) || near(segment.to()) || taken.contains(&(t, end)) {
            continue;
        }
        inner.retain(|&(_, p)| !near(p));
        taken.push((t, end));
    }
    inner.extend(taken);
    inner
}

/// Pieces of equal parameter that keep the chord error: `n = sqrt(L''/(8 ε))` with the largest second
/// derivative, the bound of the linear interpolation error.
fn pieces(segment: &Segment, chord_mm: f64) -> usize {
    match *segment {
        Segment::Line { .. } => 1,
        Segment::Cubic { from, c1, c2, to } => {
            let second = 6.0 * (from - 2.0 * c1 + c2).length().max((c1 - 2.0 * c2 + to).length());
            ((second / (8.0 * chord_mm)).sqrt().ceil() as usize).clamp(MIN_PIECES, MAX_PIECES)
        }
    }
}

fn cubic([from, c1, c2, to]: [DVec2; 4]) -> CubicBez {
    let point = |p: DVec2| Point::new(p.x, p.y);
    CubicBez::new(point(from), point(c1), point(c2), point(to))
}

fn eval(segment: &Segment, t: f64) -> DVec2 {
    match *segment {
        Segment::Line { from, to } => from.lerp(to, t),
        Segment::Cubic { from, c1, c2, to } => {
            let p = cubic([from, c1, c2, to]).eval(t);
            DVec2::new(p.x, p.y)
        }
    }
}

/// Parameter of the nearest point of a segment, and its distance, which is infinite for what is surely farther
/// than `reach_mm`.
fn nearest(segment: &Segment, p: DVec2, reach_mm: f64) -> (f64, f64) {
    match *segment {
        Segment::Line { from, to } => {
            let t = ((p - from).dot(to - from) / from.distance_squared(to)).clamp(0.0, 1.0);
            (t, p.distance(from.lerp(to, t)))
        }
        Segment::Cubic { from, c1, c2, to } => {
            // The curve lies within the box of its control points.
            let (low, high) = polygon::bounds(&[from, c1, c2, to]);
            if (low - p).max(p - high).max_element() > reach_mm {
                return (0.0, f64::INFINITY);
            }
            let near = cubic([from, c1, c2, to]).nearest(Point::new(p.x, p.y), NEAREST_ACCURACY_MM2);
            (near.t, near.distance_sq.sqrt())
        }
    }
}
