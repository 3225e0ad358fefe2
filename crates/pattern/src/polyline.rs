//! Curves as polylines: crossings and distances for the checks of a pattern.

use softfold_geometry::{DVec2, PlanarCurve, polygon};

/// Two curves that are checked as polylines within the join tolerance may seem so many of it apart
/// where they touch.
pub(crate) const CHECK_SLACK: f64 = 2.0;

/// A flattened curve; a closed one ends with its first point.
#[derive(Clone, Debug)]
pub(crate) struct Polyline {
    pub(crate) points: Vec<DVec2>,
    low: DVec2,
    high: DVec2,
}

/// Where a polyline is crossed: the place along it, as segment number plus share of the segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) along: f64,
    pub(crate) at: DVec2,
}

impl Polyline {
    /// The curve as a polyline within `chord_mm`.
    pub(crate) fn new(curve: &PlanarCurve, chord_mm: f64) -> Self {
        let mut points = curve.flatten(chord_mm);
        if curve.is_closed() {
            points.push(points[0]);
        }
        let (low, high) = polygon::bounds(&points);
        Self { points, low, high }
    }

    /// Whether the boxes come within `reach` of each other.
    pub(crate) fn near(&self, other: &Self, reach: f64) -> bool {
        boxes_meet((self.low, self.high), (other.low, other.high), reach)
    }

    /// All crossings with another polyline, in order along this one.
    pub(crate) fn crossings(&self, other: &Self) -> Vec<Crossing> {
        let mut found = Vec::new();
        if !self.near(other, 0.0) {
            return found;
        }
        for (i, a) in self.points.windows(2).enumerate() {
            let box_a = (a[0].min(a[1]), a[0].max(a[1]));
            if !boxes_meet(box_a, (other.low, other.high), 0.0) {
                continue;
            }
            for b in other.points.windows(2) {
                if !boxes_meet(box_a, (b[0].min(b[1]), b[0].max(b[1])), 0.0) {
                    continue;
                }
                if let Some((t, _)) = polygon::segment_crossing(a[0], a[1], b[0], b[1]) {
                    let at = a[0].lerp(a[1], t);
                    found.push(Crossing { along: i as f64 + t, at });
                }
            }
        }
        found.sort_by(|a, b| a.along.total_cmp(&b.along));
        found
    }

    /// First place where a closed polyline crosses itself.
    pub(crate) fn self_crossing(&self) -> Option<DVec2> {
        let n = self.points.len() - 1;
        let side = |i: usize| (self.points[i], self.points[i + 1]);
        for i in 0..n {
            let (a, b) = side(i);
            for k in i + 2..n {
                let (c, d) = side(k);
                let neighbours = i == 0 && k == n - 1 && self.points[0] == self.points[n];
                if neighbours || !boxes_meet((a.min(b), a.max(b)), (c.min(d), c.max(d)), 0.0) {
                    continue;
                }
                if let Some((t, _)) = polygon::segment_crossing(a, b, c, d) {
                    return Some(a.lerp(b, t));
                }
            }
        }
        None
    }

    /// Distance of a point from the polyline.
    pub(crate) fn distance(&self, p: DVec2) -> f64 {
        self.points.windows(2).map(|w| polygon::segment_distance(p, w[0], w[1])).fold(f64::INFINITY, f64::min)
    }

    /// Whether a point is inside the closed polyline.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        polygon::contains(&self.points[..self.points.len() - 1], p)
    }

    /// The point at a place along the polyline.
    pub(crate) fn point(&self, along: f64) -> DVec2 {
        let i = (along.floor().max(0.0) as usize).min(self.points.len() - 2);
        self.points[i].lerp(self.points[i + 1], along - i as f64)
    }

    /// First and last point.
    pub(crate) fn ends(&self) -> [DVec2; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }
}

fn boxes_meet(a: (DVec2, DVec2), b: (DVec2, DVec2), reach: f64) -> bool {
    a.0.x <= b.1.x + reach && b.0.x <= a.1.x + reach && a.0.y <= b.1.y + reach && b.0.y <= a.1.y + reach
}
