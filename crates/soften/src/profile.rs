//! A crease's softness along its length, and the stretches on which it is soft or sharp.

use crate::along::Extent;
use crate::figures::segment_count;
use crate::{CreaseSoftness, Fault};
use softfold_geometry::{Band, Crease, Softness};

/// A maximal piece of a crease that is soft all along or sharp all along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// From and to, mm along the crease.
    pub(crate) s_mm: [f64; 2],
    pub(crate) soft: bool,
}

/// The softness of one crease, as its band holds it, before there are fold lines.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    /// Without fold lines.
    pub(crate) band: Band,
    pub(crate) stretches: Vec<Stretch>,
    /// Where along the crease the band begins and ends; the length of a closed crease may be run through
    /// from any place on.
    pub(crate) range_mm: [f64; 2],
    /// The only stretch runs round a closed crease and ends at its start.
    pub(crate) ring: bool,
}

impl Profile {
    /// The profile of a crease; `closed` if it ends at its start and meets no other there.
    ///
    /// # Errors
    /// A softness that is none.
    pub(crate) fn new(crease: &Crease, softness: &CreaseSoftness, closed: bool) -> Result<Self, Fault> {
        let length_mm = crease.curve.length_mm();
        let profile = softness.softnesses(Extent { length_mm, closed })?;
        let segments = segment_count(&profile, softness.segments)?;
        let band = Band { crease: crease.id, segments, profile, fold_lines: Vec::new() };
        let open = Self::on(band, [0.0, length_mm]);
        if !closed {
            return Ok(open);
        }
        let joined = open.joined_at_the_seam(length_mm);
        match (joined, open.stretches.first()) {
            (true, Some(_)) if open.stretches.len() == 1 => Ok(Self { ring: true, ..open }),
            (true, Some(first)) => {
                let start = first.s_mm[1];
                Ok(Self::on(rotated(open.band, start, length_mm), [start, start + length_mm]))
            }
            _ => Ok(open),
        }
    }

    fn on(band: Band, range_mm: [f64; 2]) -> Self {
        let mut profile = Self { band, stretches: Vec::new(), range_mm, ring: false };
        profile.stretches = profile.runs();
        profile
    }

    /// Width of a strip at a place, mm.
    pub(crate) fn strip_width_mm(&self, s_mm: f64) -> f64 {
        self.band.at(s_mm).map_or(0.0, |s| s.strip_width_mm(self.band.segments))
    }

    /// Half the band's width at a place, mm.
    pub(crate) fn half_width_mm(&self, s_mm: f64) -> f64 {
        0.5 * f64::from(self.band.segments) * self.strip_width_mm(s_mm)
    }

    /// Radius where it is largest, mm.
    pub(crate) fn largest_radius_mm(&self) -> f64 {
        self.band.softest().map_or(0.0, |s| s.radius_mm)
    }

    /// Places inside the range at which radius and fold angle have an entry.
    pub(crate) fn places(&self) -> impl Iterator<Item = f64> + '_ {
        let [a, b] = self.range_mm;
        self.band.profile.iter().map(|e| e.s_mm).filter(move |&s| s > a && s < b)
    }

    fn runs(&self) -> Vec<Stretch> {
        let places: Vec<f64> =
            [self.range_mm[0]].into_iter().chain(self.places()).chain([self.range_mm[1]]).collect();
        let mut runs: Vec<Stretch> = Vec::new();
        for w in places.windows(2) {
            let Some(soft) = self.kind([w[0], w[1]]) else { continue };
            match runs.last_mut() {
                Some(r) if r.s_mm[1] == w[0] && r.soft == soft && !self.is_tip(w[0], soft) => {
                    r.s_mm[1] = w[1]
                }
                _ => runs.push(Stretch { s_mm: [w[0], w[1]], soft }),
            }
        }
        runs
    }

    /// Whether the crease is soft between two neighbouring places; none if it stays flat.
    fn kind(&self, s_mm: [f64; 2]) -> Option<bool> {
        let [a, b] = s_mm.map(|s| self.band.at(s));
        let (a, b) = (a?, b?);
        let flat = a.fold_angle_rad == 0.0 && b.fold_angle_rad == 0.0;
        (!flat).then_some(a.radius_mm > 0.0 || b.radius_mm > 0.0)
    }

    /// Whether a stretch that is soft or not comes to a point at a place.
    pub(crate) fn is_tip(&self, s_mm: f64, soft: bool) -> bool {
        match soft {
            true => self.strip_width_mm(s_mm) == 0.0,
            false => self.band.at(s_mm).is_none_or(|s| s.fold_angle_rad == 0.0),
        }
    }

    /// Whether the last stretch of a closed crease goes on in its first.
    fn joined_at_the_seam(&self, length_mm: f64) -> bool {
        match (self.stretches.first(), self.stretches.last()) {
            (Some(a), Some(b)) => {
                let meet = a.s_mm[0] == 0.0 && b.s_mm[1] == length_mm && a.soft == b.soft;
                meet && !self.is_tip(0.0, a.soft)
            }
            _ => false,
        }
    }
}

/// The band of a closed crease with arc lengths from `start_mm` on, which is one of its entries.
fn rotated(band: Band, start_mm: f64, length_mm: f64) -> Band {
    let shifted = |e: &Softness| Softness { s_mm: e.s_mm + length_mm, ..*e };
    let late = band.profile.iter().filter(|e| e.s_mm >= start_mm).copied();
    let early = band.profile.iter().filter(|e| e.s_mm > 0.0 && e.s_mm <= start_mm).map(shifted);
    let profile = late.chain(early).collect();
    Band { profile, ..band }
}
