//! Closed contours of lines and arcs: what a router follows.

use glam::DVec2;
use softfold_geometry::polygon;

/// A piece of a contour, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProfileSegment {
    /// A straight cut.
    Line {
        /// Start.
        from: DVec2,
        /// End.
        to: DVec2,
    },
    /// A circular cut.
    Arc {
        /// Start.
        from: DVec2,
        /// End.
        to: DVec2,
        /// Centre of the circle.
        center: DVec2,
        /// Whether it turns counter-clockwise.
        ccw: bool,
    },
}

/// A closed contour: every segment starts where the one before ends, the first where the last ends. Counter-clockwise
/// around material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contour {
    /// The pieces in order.
    pub segments: Vec<ProfileSegment>,
}

impl ProfileSegment {
    /// Start.
    pub fn from(&self) -> DVec2 {
        match *self {
            ProfileSegment::Line { from, .. } | ProfileSegment::Arc { from, .. } => from,
        }
    }

    /// End.
    pub fn to(&self) -> DVec2 {
        match *self {
            ProfileSegment::Line { to, .. } | ProfileSegment::Arc { to, .. } => to,
        }
    }

    /// Points on the segment from its start to just before its end, no chord farther than `chord_mm` from the arc.
    fn flatten(&self, chord_mm: f64) -> Vec<DVec2> {
        let ProfileSegment::Arc { from, to, center, ccw } = *self else { return vec![self.from()] };
        let (a, b) = (from - center, to - center);
        let turn = if ccw { a.angle_to(b) } else { b.angle_to(a) };
        let turn = turn.rem_euclid(std::f64::consts::TAU);
        let step = 2.0 * (1.0 - chord_mm / a.length()).clamp(0.0, 1.0).acos();
        let n = (turn / step).ceil().max(1.0) as usize;
        let angle = |k: usize| turn * k as f64 / n as f64 * if ccw { 1.0 } else { -1.0 };
        (0..n).map(|k| center + DVec2::from_angle(angle(k)).rotate(a)).collect()
    }
}

impl Contour {
    /// The contour as a polygon, no chord farther than `chord_mm` from an arc.
    pub fn flatten(&self, chord_mm: f64) -> Vec<DVec2> {
        self.segments.iter().flat_map(|s| s.flatten(chord_mm)).collect()
    }

    /// Where the contour meets itself beyond the common ends of neighbours, if it does.
    pub fn self_crossing(&self, chord_mm: f64) -> Option<DVec2> {
        let polygon = self.flatten(chord_mm);
        let sides: Vec<_> = polygon::edges(&polygon).collect();
        let mut order: Vec<usize> = (0..sides.len()).collect();
        let left = |i: usize| sides[i].0.x.min(sides[i].1.x);
        let right = |i: usize| sides[i].0.x.max(sides[i].1.x);
        order.sort_by(|&a, &b| left(a).total_cmp(&left(b)));
        for (k, &i) in order.iter().enumerate() {
            for &j in order[k + 1..].iter().take_while(|&&j| left(j) <= right(i)) {
                let apart = i.abs_diff(j);
                if apart == 1 || apart == sides.len() - 1 {
                    continue;
                }
                let ((a0, a1), (b0, b1)) = (sides[i], sides[j]);
                if let Some((t, _)) = polygon::segment_crossing(a0, a1, b0, b1) {
                    return Some(a0.lerp(a1, t));
                }
            }
        }
        None
    }
}

/// A pen that draws a contour.
pub(crate) struct Pen {
    at: DVec2,
    segments: Vec<ProfileSegment>,
}

impl Pen {
    pub(crate) fn at(start: DVec2) -> Self {
        Self { at: start, segments: Vec::new() }
    }

    /// A line to a point, if it is not there already.
    pub(crate) fn line_to(&mut self, to: DVec2) {
        if to != self.at {
            self.segments.push(ProfileSegment::Line { from: self.at, to });
            self.at = to;
        }
    }

    pub(crate) fn arc_to(&mut self, to: DVec2, center: DVec2, ccw: bool) {
        self.segments.push(ProfileSegment::Arc { from: self.at, to, center, ccw });
        self.at = to;
    }

    /// Closes the contour by a line.
    pub(crate) fn close(mut self) -> Contour {
        if let Some(first) = self.segments.first().map(ProfileSegment::from) {
            self.line_to(first);
        }
        Contour { segments: self.segments }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stadium of two half circles.
    fn stadium() -> Contour {
        let mut pen = Pen::at(DVec2::new(-20.0, -10.0));
        pen.line_to(DVec2::new(20.0, -10.0));
        pen.arc_to(DVec2::new(20.0, 10.0), DVec2::new(20.0, 0.0), true);
        pen.line_to(DVec2::new(-20.0, 10.0));
        pen.arc_to(DVec2::new(-20.0, -10.0), DVec2::new(-20.0, 0.0), true);
        pen.close()
    }

    #[test]
    fn a_stadium_has_its_area_and_does_not_cross_itself() {
        let area = polygon::signed_area_mm2(&stadium().flatten(1e-4));
        assert!((area - (800.0 + std::f64::consts::PI * 100.0)).abs() < 0.02, "{area}");
        assert_eq!(stadium().self_crossing(0.01), None);
    }

    #[test]
    fn a_bow_tie_crosses_itself() {
        let mut pen = Pen::at(DVec2::ZERO);
        [(10., 10.), (10., 0.), (0., 10.)].into_iter().for_each(|p| pen.line_to(p.into()));
        assert_eq!(pen.close().self_crossing(0.01), Some(DVec2::splat(5.0)));
    }

    #[test]
    fn a_clockwise_arc_bulges_to_the_right() {
        let arc = ProfileSegment::Arc { from: DVec2::X, to: -DVec2::X, center: DVec2::ZERO, ccw: false };
        assert!(arc.flatten(1e-3).iter().all(|p| p.y <= 1e-12 && (p.length() - 1.0).abs() < 1e-12));
    }
}
