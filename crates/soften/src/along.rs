//! What is asked of a crease: radius and fold angle, constant or along it.

use crate::Fault;
use softfold_geometry::Softness;

/// Places closer than this share of the crease are one: the rounding of a sum of lengths.
const SAME_PLACE: f64 = 1e-9;
/// Most places in a list: far beyond what a crease can show.
pub(crate) const MOST_PLACES: usize = 10_000;

/// A figure along a crease.
#[derive(Clone, Debug, PartialEq)]
pub enum Along {
    /// The same everywhere.
    Constant(f64),
    /// Pairs of arc length (mm, from the crease's start, ascending) and value; linear between them. On an
    /// open crease the first and the last value hold to its ends, on a closed one the last leads round to
    /// the first.
    Places(Vec<(f64, f64)>),
}

/// How many strips a band has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segments {
    /// So many.
    Count(u32),
    /// As few as keep every chord within a distance of the arc, where the two are farthest apart.
    Chord {
        /// Largest distance of chord and arc, mm.
        tolerance_mm: f64,
    },
}

/// How one crease is softened.
#[derive(Clone, Debug, PartialEq)]
pub struct CreaseSoftness {
    /// Radius of the soft fold, mm; sharp where it is 0.
    pub radius_mm: Along,
    /// Signed fold angle π − ρ, rad, + valley, − mountain; less than π in size, no fold where it is 0, and
    /// not 0 everywhere.
    pub fold_angle_rad: Along,
    /// Strips of the band, the same all along.
    pub segments: Segments,
}

/// Why a list of places is none.
#[derive(Clone, Debug, PartialEq)]
pub enum AlongFault {
    /// It has no entry.
    Empty,
    /// It has too many.
    TooMany {
        /// How many.
        places: usize,
    },
    /// A place is no finite number.
    NotFinite,
    /// A place is before the one ahead of it in the list.
    Unsorted {
        /// The place, mm.
        s_mm: f64,
    },
    /// A place is given twice.
    Twice {
        /// The place, mm.
        s_mm: f64,
    },
    /// A place is not on the crease.
    OffCrease {
        /// The place, mm.
        s_mm: f64,
        /// Length of the crease, mm.
        length_mm: f64,
    },
}

/// A crease as far as lists of places are concerned.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) length_mm: f64,
    pub(crate) closed: bool,
}

impl From<f64> for Along {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl Along {
    /// The same figure times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        self.mapped(|v| v * factor)
    }

    /// The same places with `f` applied to the values.
    #[must_use]
    pub fn mapped(&self, f: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Constant(v) => Self::Constant(f(*v)),
            Self::Places(p) => Self::Places(p.iter().map(|&(s, v)| (s, f(v))).collect()),
        }
    }

    /// All values given, at least one unless a list is empty.
    pub fn values(&self) -> Vec<f64> {
        match self {
            Self::Constant(v) => vec![*v],
            Self::Places(p) => p.iter().map(|&(_, v)| v).collect(),
        }
    }

    fn places(&self) -> &[(f64, f64)] {
        match self {
            Self::Constant(_) => &[],
            Self::Places(p) => p,
        }
    }

    fn check(&self, extent: Extent) -> Result<(), AlongFault> {
        let Self::Places(places) = self else { return Ok(()) };
        let slack_mm = SAME_PLACE * extent.length_mm;
        if places.is_empty() {
            return Err(AlongFault::Empty);
        }
        if places.len() > MOST_PLACES {
            return Err(AlongFault::TooMany { places: places.len() });
        }
        for &(s_mm, _) in places {
            if !s_mm.is_finite() {
                return Err(AlongFault::NotFinite);
            }
            if s_mm < -slack_mm || s_mm > extent.length_mm + slack_mm {
                return Err(AlongFault::OffCrease { s_mm, length_mm: extent.length_mm });
            }
        }
        for w in places.windows(2) {
            let s_mm = w[1].0;
            if (s_mm - w[0].0).abs() <= slack_mm {
                return Err(AlongFault::Twice { s_mm });
            }
            if s_mm < w[0].0 {
                return Err(AlongFault::Unsorted { s_mm });
            }
        }
        Ok(())
    }

    /// The value at a place of the crease.
    pub(crate) fn at(&self, s_mm: f64, extent: Extent) -> f64 {
        let places = match self {
            Self::Constant(v) => return *v,
            Self::Places(p) => p,
        };
        let (Some(&first), Some(&last)) = (places.first(), places.last()) else { return f64::NAN };
        let i = places.partition_point(|p| p.0 <= s_mm);
        let round = |p: (f64, f64), laps: f64| (p.0 + laps * extent.length_mm, p.1);
        let before = if i > 0 { Some(places[i - 1]) } else { extent.closed.then(|| round(last, -1.0)) };
        let after = places.get(i).copied().or_else(|| extent.closed.then(|| round(first, 1.0)));
        match (before, after) {
            (Some(a), _) if a.0 == s_mm => a.1,
            (Some(a), Some(b)) if b.0 > a.0 => a.1 + (s_mm - a.0) / (b.0 - a.0) * (b.1 - a.1),
            (Some(a), _) => a.1,
            (None, _) => first.1,
        }
    }
}

impl CreaseSoftness {
    /// The same radius and fold angle all along.
    pub fn constant(radius_mm: f64, fold_angle_rad: f64, segments: Segments) -> Self {
        Self { radius_mm: radius_mm.into(), fold_angle_rad: fold_angle_rad.into(), segments }
    }

    /// The same with all radii times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { radius_mm: self.radius_mm.scaled(factor), ..self.clone() }
    }

    /// Radius and fold angle together, with an entry wherever either has one and wherever the fold angle
    /// passes through 0; on a closed crease with entries at both ends if there are several.
    pub(crate) fn softnesses(&self, extent: Extent) -> Result<Vec<Softness>, Fault> {
        let list = |what| move |why| Fault::Along { what, why };
        self.radius_mm.check(extent).map_err(list("radius"))?;
        self.fold_angle_rad.check(extent).map_err(list("fold angle"))?;
        let at = |s_mm: f64| Softness {
            s_mm,
            radius_mm: self.radius_mm.at(s_mm, extent),
            fold_angle_rad: self.fold_angle_rad.at(s_mm, extent),
        };
        let entries: Vec<Softness> = self.merged_places(extent).into_iter().map(at).collect();
        entries.iter().try_for_each(check_entry)?;
        if entries.iter().all(|e| e.fold_angle_rad == 0.0) {
            return Err(Fault::FoldAngle { fold_angle_rad: 0.0, s_mm: None });
        }
        Ok(with_zeros(entries, SAME_PLACE * extent.length_mm))
    }

    fn merged_places(&self, extent: Extent) -> Vec<f64> {
        let lists = [self.radius_mm.places(), self.fold_angle_rad.places()];
        let inside = |s: f64| s.clamp(0.0, extent.length_mm);
        let mut places: Vec<f64> = lists.concat().iter().map(|p| inside(p.0)).collect();
        if places.is_empty() {
            return vec![0.0];
        }
        if extent.closed {
            places.extend([0.0, extent.length_mm]);
        }
        places.sort_by(f64::total_cmp);
        let slack_mm = SAME_PLACE * extent.length_mm;
        places.dedup_by(|b, a| *b - *a <= slack_mm);
        if let (true, Some(last)) = (extent.closed, places.last_mut()) {
            *last = extent.length_mm;
        }
        places
    }
}

fn check_entry(e: &Softness) -> Result<(), Fault> {
    if !(e.radius_mm >= 0.0 && e.radius_mm.is_finite()) {
        return Err(Fault::Radius { radius_mm: e.radius_mm, s_mm: Some(e.s_mm) });
    }
    if e.fold_angle_rad.is_nan() || e.fold_angle_rad.abs() >= std::f64::consts::PI {
        return Err(Fault::FoldAngle { fold_angle_rad: e.fold_angle_rad, s_mm: Some(e.s_mm) });
    }
    Ok(())
}

/// Adds an entry wherever the fold angle changes its sign between two; if that is within `slack_mm` of one
/// of them, makes that one 0.
fn with_zeros(entries: Vec<Softness>, slack_mm: f64) -> Vec<Softness> {
    let mut out: Vec<Softness> = Vec::with_capacity(entries.len());
    for mut e in entries {
        if let Some(a) = out.last_mut().filter(|a| a.fold_angle_rad * e.fold_angle_rad < 0.0) {
            let t = a.fold_angle_rad / (a.fold_angle_rad - e.fold_angle_rad);
            let s_mm = a.s_mm + t * (e.s_mm - a.s_mm);
            let radius_mm = a.radius_mm + t * (e.radius_mm - a.radius_mm);
            if s_mm - a.s_mm <= slack_mm {
                a.fold_angle_rad = 0.0;
            } else if e.s_mm - s_mm <= slack_mm {
                e.fold_angle_rad = 0.0;
            } else {
                out.push(Softness { s_mm, radius_mm, fold_angle_rad: 0.0 });
            }
        }
        out.push(e);
    }
    out
}
