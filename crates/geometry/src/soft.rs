//! The softened pattern: every crease a band of fold lines.

use crate::{CheckError, CreaseId, LoopId, PlanarCurve, Tolerance};
use glam::DVec2;

/// A point on the outline or a hole, by arc length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlinePoint {
    /// Which closed curve.
    pub loop_id: LoopId,
    /// Arc length along it, mm.
    pub s_mm: f64,
}

/// One polyline of a band along which the strips turn against each other.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldLine {
    /// Signed distance from the crease, mm; positive to the left of its direction.
    pub offset_mm: f64,
    /// Points on the parallel curve in (u, v), along the crease, dense enough for the chord
    /// tolerance; the ends lie on the boundary (or are the crease's free ends).
    pub points: Vec<DVec2>,
    /// Turn at each point, rad, + valley; as many as `points`.
    pub turns_rad: Vec<f64>,
    /// Where the ends meet the boundary; none for an end inside the sheet.
    pub ends: [Option<OutlinePoint>; 2],
}

/// The softened strip of one crease: `n` strips of width `x` between `n + 1` fold lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// The crease it replaces.
    pub crease: CreaseId,
    /// Radius of the soft fold, mm (paper eq. 1); 0 for a sharp crease.
    pub radius_mm: f64,
    /// Signed fold angle π − ρ, rad.
    pub fold_angle_rad: f64,
    /// Chord `x = 2 r sin((π−ρ)/(2n))`: the width of one strip, mm.
    pub strip_width_mm: f64,
    /// The fold lines from right to left of the crease; a single one for a sharp crease.
    pub fold_lines: Vec<FoldLine>,
}

/// The flat sheet with its bands.
#[derive(Clone, Debug, PartialEq)]
pub struct SoftPattern {
    /// Outline (counter-clockwise) and holes (clockwise), by [`LoopId`].
    pub loops: Vec<PlanarCurve>,
    /// One band a crease, in crease order.
    pub bands: Vec<Band>,
    /// Tolerances of the sheet.
    pub tolerance: Tolerance,
}

impl Band {
    /// Half the band's width, mm.
    pub fn half_width_mm(&self) -> f64 {
        self.fold_lines.iter().map(|l| l.offset_mm.abs()).fold(0.0, f64::max)
    }
}

impl SoftPattern {
    /// Exact area of the sheet, mm².
    pub fn area_mm2(&self) -> f64 {
        self.loops.iter().map(PlanarCurve::signed_area_mm2).sum()
    }

    /// The contract of this type: turns of each band add up to its fold angle, lines are ordered
    /// by offset, and every line has a turn per point.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), CheckError> {
        self.bands.iter().try_for_each(Band::check)
    }
}

impl Band {
    /// Turns must add up to the fold angle within this, rad: rounding of a sum of a few terms.
    const TURN_SUM_RAD: f64 = 1e-12;

    fn check(&self) -> Result<(), CheckError> {
        let fault = |f: &str| Err(CheckError::new("Band", format!("crease {}: {f}", self.crease)));
        if self.fold_lines.iter().any(|l| l.points.len() < 2 || l.points.len() != l.turns_rad.len()) {
            return fault("a fold line needs two points or more and a turn for each");
        }
        if self.fold_lines.windows(2).any(|w| w[0].offset_mm >= w[1].offset_mm) {
            return fault("fold lines are not ordered by offset");
        }
        let sum: f64 = self.fold_lines.iter().map(|l| l.turns_rad[0]).sum();
        if (sum - self.fold_angle_rad).abs() > Self::TURN_SUM_RAD {
            return fault("turns do not add up to the fold angle");
        }
        Ok(())
    }
}
