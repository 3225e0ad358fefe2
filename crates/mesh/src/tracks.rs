//! The curves that constraints follow: where a point slides, and where an edge is split.

use crate::boundary::{Boundaries, Flat};
use glam::DVec2;
use softfold_geometry::{CreaseId, FoldLine, PlanarCurve};
use std::fmt;

/// What a curve of the pattern is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Curve {
    /// The outline (0), a hole, or a slit: their numbers follow those of the holes.
    Boundary(u32),
    /// A fold line.
    Fold {
        /// The crease.
        crease: CreaseId,
        /// Number of the line in its band.
        line: u32,
    },
    /// A side of the region of a junction.
    Junction(u32),
}

impl fmt::Display for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Curve::Boundary(0) => write!(f, "the outline"),
            Curve::Boundary(number) => write!(f, "boundary {number}"),
            Curve::Fold { crease, line } => write!(f, "fold line {line} of crease {crease}"),
            Curve::Junction(number) => write!(f, "the region of junction {number}"),
        }
    }
}

/// A curve by arc length.
pub(crate) struct Track<'a> {
    pub(crate) curve: Curve,
    /// Lines of one stretch of a band keep their distance by its rows; none for other curves.
    pub(crate) stretch: Option<u32>,
    shape: Shape<'a>,
}

enum Shape<'a> {
    /// Boundary, also as a polyline; arc lengths that must keep a vertex, and how near to them is there, mm.
    Curve { curve: &'a PlanarCurve, flat: &'a Flat, anchors: &'a [f64], same_mm: f64 },
    /// Fold line, with the length of its polyline up to each point.
    Line { line: &'a FoldLine, lengths_mm: Vec<f64> },
    /// Straight.
    Side { from: DVec2, to: DVec2 },
}

/// The part of a track that a constraint stands for, from its first vertex to its second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) track: u32,
    pub(crate) from_mm: f64,
    pub(crate) to_mm: f64,
}

/// Share of a span by which a tangent looks along it.
const TANGENT: f64 = 1e-4;

impl<'a> Track<'a> {
    pub(crate) fn boundary(boundaries: &'a Boundaries<'a>, curve: usize) -> Self {
        let shape = Shape::Curve {
            curve: boundaries.curves[curve],
            flat: &boundaries.flat[curve],
            anchors: &boundaries.anchors[curve],
            same_mm: boundaries.same_mm,
        };
        Self { curve: Curve::Boundary(curve as u32), stretch: None, shape }
    }

    pub(crate) fn fold(crease: CreaseId, number: u32, stretch: Option<u32>, line: &'a FoldLine) -> Self {
        let sides = line.points.windows(2).map(|w| w[0].distance(w[1]));
        let lengths_mm = crate::places::running_sum(sides);
        Self { curve: Curve::Fold { crease, line: number }, stretch, shape: Shape::Line { line, lengths_mm } }
    }

    pub(crate) fn side(junction: u32, from: DVec2, to: DVec2) -> Self {
        Self { curve: Curve::Junction(junction), stretch: None, shape: Shape::Side { from, to } }
    }

    /// The point at an arc length; past the end of a closed boundary it goes round.
    pub(crate) fn point(&self, s_mm: f64) -> DVec2 {
        match &self.shape {
            Shape::Curve { curve, .. } => curve.point(s_mm),
            Shape::Line { line, lengths_mm } => {
                let (i, t) = side(lengths_mm, s_mm);
                line.points[i - 1].lerp(line.points[i], t)
            }
            Shape::Side { from, to } => *from + s_mm * (*to - *from).normalize_or_zero(),
        }
    }

    /// The same within the tolerance of chords, but fast.
    pub(crate) fn about(&self, s_mm: f64) -> DVec2 {
        match &self.shape {
            Shape::Curve { curve, flat, .. } => flat.point(s_mm, curve.length_mm()),
            _ => self.point(s_mm),
        }
    }

    /// Turn at an arc length, rad; none but on fold lines.
    pub(crate) fn turn_rad(&self, s_mm: f64) -> Option<f64> {
        let Shape::Line { line, lengths_mm } = &self.shape else { return None };
        let (i, t) = side(lengths_mm, s_mm);
        Some(line.turns_rad[i - 1] * (1.0 - t) + line.turns_rad[i] * t)
    }

    /// Arc length as the boundary counts it; none but on boundaries.
    pub(crate) fn on_boundary_mm(&self, s_mm: f64) -> Option<f64> {
        let Shape::Curve { curve, .. } = &self.shape else { return None };
        Some(if curve.is_closed() { s_mm.rem_euclid(curve.length_mm()) } else { s_mm })
    }

    /// Whether a place must keep its vertex.
    pub(crate) fn is_anchor(&self, s_mm: f64) -> bool {
        let Shape::Curve { curve, anchors, same_mm, .. } = &self.shape else { return false };
        let total = curve.length_mm();
        let is_near = |s: f64| {
            let next = anchors.partition_point(|a| *a < s - same_mm);
            anchors.get(next).is_some_and(|a| *a <= s + same_mm)
        };
        [s_mm - total, s_mm, s_mm + total].into_iter().any(is_near)
    }

    /// Direction in which the track leaves one end of a span into it.
    pub(crate) fn leaving(&self, span: &Span, end: usize) -> DVec2 {
        let step = TANGENT * (span.to_mm - span.from_mm);
        let (at, next) = match end {
            0 => (span.from_mm, span.from_mm + step),
            _ => (span.to_mm, span.to_mm - step),
        };
        (self.point(next) - self.point(at)).normalize_or_zero()
    }

    /// Largest distance of a span from its chord, mm, and where.
    pub(crate) fn chord_error_mm(&self, span: &Span, [a, b]: [DVec2; 2]) -> (f64, f64) {
        let (points, lengths_mm, total_mm) = match &self.shape {
            Shape::Side { .. } => return (0.0, 0.5 * (span.from_mm + span.to_mm)),
            Shape::Curve { curve, flat, .. } => (&flat.points, &flat.s_mm, curve.length_mm()),
            Shape::Line { line, lengths_mm } => (&line.points, lengths_mm, f64::MAX),
        };
        let mut worst = (0.0, 0.5 * (span.from_mm + span.to_mm));
        // A span of a closed curve may go round its start.
        for round in [0.0, total_mm] {
            let first = lengths_mm.partition_point(|l| l + round <= span.from_mm);
            let last = lengths_mm.partition_point(|l| l + round < span.to_mm);
            for i in first..last {
                let error = softfold_geometry::polygon::segment_distance(points[i], a, b);
                if error > worst.0 {
                    worst = (error, lengths_mm[i] + round);
                }
            }
        }
        worst
    }
}

impl Span {
    pub(crate) fn length_mm(&self) -> f64 {
        self.to_mm - self.from_mm
    }

    /// The parts before and after a place.
    pub(crate) fn split(self, s_mm: f64) -> [Self; 2] {
        [Self { to_mm: s_mm, ..self }, Self { from_mm: s_mm, ..self }]
    }
}

/// The side of a polyline at a length, and the share of it.
fn side(lengths_mm: &[f64], s_mm: f64) -> (usize, f64) {
    let i = lengths_mm.partition_point(|l| *l <= s_mm).clamp(1, lengths_mm.len() - 1);
    let [from, to] = [lengths_mm[i - 1], lengths_mm[i]];
    (i, ((s_mm - from) / (to - from)).clamp(0.0, 1.0))
}
