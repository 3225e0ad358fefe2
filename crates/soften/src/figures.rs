//! The numbers of a band (paper eq. 1 to 3): chord, tangent length, widths, turns, strips.

use crate::{Fault, Segments};
use softfold_geometry::Softness;

/// Most strips of a band: far beyond what a sheet or a mesh can show, and a stop for tolerances
/// that are far too small.
pub(crate) const MOST_SEGMENTS: u32 = 1000;
/// Steps of the search for the largest sagitta between two entries; each keeps 62 % of the interval.
const SEARCH_STEPS: usize = 60;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// A sagitta may exceed its tolerance by this share: rounding.
const ROUNDING: f64 = 1e-9;

/// Widths and lengths of a band at one place, for the report. The band is `n` chords of the arc, so its
/// width is a little less than the arc's length.
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
    /// The figures of a radius and a fold angle with `segments` strips; zeros for a sharp fold.
    pub fn of(softness: &Softness, segments: u32) -> Self {
        let (r, angle) = (softness.radius_mm, softness.fold_angle_rad.abs());
        let chord_mm = softness.strip_width_mm(segments);
        Self {
            segments,
            chord_mm,
            // cot(ρ/2) = tan((π−ρ)/2)
            tangent_length_mm: r * (angle / 2.0).tan(),
            band_width_mm: f64::from(segments) * chord_mm,
            arc_length_mm: r * angle,
        }
    }
}

/// Strips of a band; by chord tolerance the fewest that keep the sagitta everywhere.
pub(crate) fn segment_count(profile: &[Softness], segments: Segments) -> Result<u32, Fault> {
    let n = match segments {
        Segments::Count(n) => f64::from(n),
        Segments::Chord { tolerance_mm: t } if t > 0.0 && t.is_finite() => chord_count(profile, t),
        Segments::Chord { tolerance_mm } => return Err(Fault::ChordTolerance { tolerance_mm }),
    };
    match n >= 1.0 && n <= f64::from(MOST_SEGMENTS) {
        true => Ok(n as u32),
        false => Err(Fault::Segments { segments: n }),
    }
}

fn chord_count(profile: &[Softness], tolerance_mm: f64) -> f64 {
    let mut n = profile.iter().map(|e| chord_count_at(e, tolerance_mm)).fold(1.0, f64::max);
    // Between two entries, where one figure grows and the other shrinks, more can be needed.
    let keeps =
        |n: f64| profile.windows(2).all(|w| worst_sagitta_mm(w, n) <= tolerance_mm * (1.0 + ROUNDING));
    while n <= f64::from(MOST_SEGMENTS) && !keeps(n) {
        n += 1.0;
    }
    n
}

/// Fewest strips for which the sagitta `r (1 − cos(Δ/2))` of `Δ = (π−ρ)/n` keeps a tolerance.
fn chord_count_at(e: &Softness, tolerance_mm: f64) -> f64 {
    let r = e.radius_mm;
    let widest = if tolerance_mm < r { 2.0 * (1.0 - tolerance_mm / r).acos() } else { f64::INFINITY };
    (e.fold_angle_rad.abs() / widest - ROUNDING).ceil().max(1.0)
}

/// The largest sagitta between two entries: its logarithm is concave, since those of `r` and of
/// `1 − cos φ = 2 sin²(φ/2)` are, so a golden-section search finds it.
fn worst_sagitta_mm(pair: &[Softness], n: f64) -> f64 {
    let between = |a: f64, b: f64, t: f64| a + t * (b - a);
    let sagitta = |t: f64| {
        let angle = between(pair[0].fold_angle_rad, pair[1].fold_angle_rad, t).abs();
        between(pair[0].radius_mm, pair[1].radius_mm, t) * (1.0 - (angle / (2.0 * n)).cos())
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..SEARCH_STEPS {
        let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        if sagitta(a) < sagitta(b) { low = a } else { high = b }
    }
    sagitta(0.5 * (low + high))
}
