//! The numbers of a band (paper eq. 1 to 3): chord, tangent length, widths, turns.

use crate::{CreaseSoftness, Fault, Segments};

/// Most strips of a band: far beyond what a sheet or a mesh can show, and a stop for tolerances
/// that are far too small.
pub(crate) const MOST_SEGMENTS: u32 = 1000;

/// Widths and lengths of a band, for the report. The band is `n` chords of the arc, so its width is a
/// little less than the arc's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandFigures {
    /// Strips `n`.
    pub segments: u32,
    /// Chord `x = 2 r sin((π−ρ)/(2n))`, the width of a strip, mm.
    pub chord_mm: f64,
    /// Tangent length `a = r cot(ρ/2)`, from the sharp corner to where the arc begins, mm.
    pub tangent_length_mm: f64,
    /// Width `n·x` of the band on the flat sheet, mm.
    pub band_width_mm: f64,
    /// Length `r (π − ρ)` of the arc that the band stands for, mm.
    pub arc_length_mm: f64,
}

impl BandFigures {
    /// The figures of a softness; zeros and one segment for a sharp fold.
    ///
    /// # Errors
    /// Numbers that are no radius, fold angle, count or tolerance.
    pub fn new(softness: &CreaseSoftness) -> Result<Self, Fault> {
        let CreaseSoftness { radius_mm: r, fold_angle_rad, segments } = *softness;
        if !(r >= 0.0 && r.is_finite()) {
            return Err(Fault::Radius { radius_mm: r });
        }
        let angle = fold_angle_rad.abs();
        if !(angle > 0.0 && angle < std::f64::consts::PI) {
            return Err(Fault::FoldAngle { fold_angle_rad });
        }
        let n = count(r, angle, segments)?;
        let chord_mm = 2.0 * r * (angle / (2.0 * f64::from(n))).sin();
        Ok(Self {
            segments: n,
            chord_mm,
            // cot(ρ/2) = tan((π−ρ)/2)
            tangent_length_mm: r * (angle / 2.0).tan(),
            band_width_mm: f64::from(n) * chord_mm,
            arc_length_mm: r * angle,
        })
    }

    /// Offset and turn of each fold line, from right to left of the crease: `(k − n/2) x`, with
    /// `(π−ρ)/n` at the inner lines and half of that at the two outer ones, signed like
    /// `fold_angle_rad`. A single line with the whole turn if the band has no width.
    pub(crate) fn lines(&self, fold_angle_rad: f64) -> Vec<(f64, f64)> {
        if self.chord_mm == 0.0 {
            return vec![(0.0, fold_angle_rad)];
        }
        let n = self.segments;
        let turn = fold_angle_rad / f64::from(n);
        let line = |k: u32| {
            let offset = (f64::from(k) - 0.5 * f64::from(n)) * self.chord_mm;
            (offset, if k == 0 || k == n { 0.5 * turn } else { turn })
        };
        (0..=n).map(line).collect()
    }
}

/// Strips; by chord tolerance, as many as keep the sagitta `r (1 − cos(Δ/2))` of `Δ = (π−ρ)/n` in it.
fn count(radius_mm: f64, angle_rad: f64, segments: Segments) -> Result<u32, Fault> {
    let n = match segments {
        Segments::Count(n) => f64::from(n),
        Segments::Chord { tolerance_mm: t } => {
            if !(t > 0.0 && t.is_finite()) {
                return Err(Fault::ChordTolerance { tolerance_mm: t });
            }
            let widest = if t < radius_mm { 2.0 * (1.0 - t / radius_mm).acos() } else { f64::INFINITY };
            (angle_rad / widest).ceil().max(1.0)
        }
    };
    match n >= 1.0 && n <= f64::from(MOST_SEGMENTS) {
        true => Ok(n as u32),
        false => Err(Fault::Segments { segments: n }),
    }
}
