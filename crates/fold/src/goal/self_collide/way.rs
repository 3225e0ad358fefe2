//! Boxes on their way.
//!
//! A box has six dimensions, where the corners are and where they are going; two boxes meet if at some time on the way all
//! three gaps close. That the sheet moves as a whole costs nothing, only how its parts move against each other.

use glam::DVec3;

/// The places of all vertices, and how far each goes in a straight line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<'a> {
    pub(super) x: &'a [DVec3],
    /// Empty: nothing moves.
    pub(super) step: &'a [DVec3],
}

impl Path<'_> {
    /// The box around some vertices.
    pub(super) fn around(&self, vertices: &[u32]) -> Way {
        let mut way = Way::NONE;
        for &v in vertices {
            let (p, d) = (self.x[v as usize], self.step.get(v as usize).copied().unwrap_or_default());
            for (k, c) in [p.x, p.y, p.z, d.x, d.y, d.z].into_iter().enumerate() {
                way.lower[k] = way.lower[k].min(c);
                way.upper[k] = way.upper[k].max(c);
            }
        }
        way
    }

    /// The mean motion.
    pub(super) fn drift(&self) -> DVec3 {
        self.step.iter().sum::<DVec3>() / self.step.len().max(1) as f64
    }
}

/// A box on its way: bounds of the places at the start, then of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    lower: [f64; 6],
    upper: [f64; 6],
}

impl Way {
    const NONE: Self = Self { lower: [f64::INFINITY; 6], upper: [f64::NEG_INFINITY; 6] };

    /// Lower and upper corner of what the box passes through, seen by one who moves by `drift`.
    pub(super) fn swept(&self, drift: DVec3) -> [DVec3; 2] {
        let half = |bound: &[f64; 6]| {
            let [x, y, z, dx, dy, dz] = *bound;
            (DVec3::new(x, y, z), DVec3::new(dx, dy, dz) - drift)
        };
        let ((lower, slowest), (upper, fastest)) = (half(&self.lower), half(&self.upper));
        [lower + slowest.min(DVec3::ZERO), upper + fastest.max(DVec3::ZERO)]
    }

    /// Whether two boxes come within `reach` of each other along all axes at one time.
    pub(super) fn meets(&self, other: &Self, reach: f64) -> bool {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        let mut clip = |start: f64, slope: f64| {
            // start + t slope ≥ 0
            match slope {
                s if s > 0.0 => from = from.max(-start / s),
                s if s < 0.0 => to = to.min(-start / s),
                _ if start < 0.0 => to = f64::NEG_INFINITY,
                _ => (),
            }
        };
        let (al, au, bl, bu) = (&self.lower, &self.upper, &other.lower, &other.upper);
        for k in 0..3 {
            clip(reach + bu[k] - al[k], bu[k + 3] - al[k + 3]);
            clip(reach + au[k] - bl[k], au[k + 3] - bl[k + 3]);
        }
        from <= to
    }
}
