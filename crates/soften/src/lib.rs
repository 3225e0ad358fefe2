//! From creases to bands: every crease becomes a strip of fold lines that share its turn. No files,
//! no printing; a pattern and a softness for each crease in, a [`SoftPattern`] out.
//!
//! A fold of radius `r` is an arc; on the flat sheet it is a band of `n` strips, each as wide as a chord of
//! the arc, centred on the crease (Koschitz, Foschi, Maleczek, "Algorithmic Design and Fabrication of
//! Soft Curved-Folding", eq. 1 to 3; [`BandFigures`]). Its `n + 1` fold lines are parallel curves of
//! the crease, from boundary to boundary. Bands that do not fit are refused with the largest radius
//! that does.
//!
//! | module | what it knows |
//! |---|---|
//! | `figures` | the numbers of a band |
//! | `spine` | a crease sampled for its parallels |
//! | `boundary` | where parallels meet the outline and the holes, exactly |
//! | `shape` | one band on the sheet, and whether it fits |
//! | `picture` | the bands as SVG |

mod boundary;
mod error;
mod figures;
mod picture;
mod shape;
mod spine;

pub use error::{Fault, Misfit, SoftenError};
pub use figures::BandFigures;
pub use picture::write_svg;

use boundary::Boundary;
use shape::{Problem, Shape, Sheet};
use softfold_geometry::{Band, Crease, CreasePattern, DVec2, Role, SoftPattern};

/// The largest radius is searched from this share of the refused one; if that does not fit, none does.
const LEAST_RADIUS_SHARE: f64 = 1e-4;
/// Halvings of the search for the largest radius: 1e-7 of the refused one.
const RADIUS_HALVINGS: u32 = 24;

/// How many strips a band has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segments {
    /// So many.
    Count(u32),
    /// As few as keep every chord within a distance of the arc.
    Chord {
        /// Largest distance of chord and arc, mm.
        tolerance_mm: f64,
    },
}

/// How one crease is softened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreaseSoftness {
    /// Radius of the soft fold, mm; 0 leaves the crease sharp.
    pub radius_mm: f64,
    /// Signed fold angle π − ρ, rad, + valley, − mountain; not 0, and less than π in size.
    pub fold_angle_rad: f64,
    /// Strips of the band.
    pub segments: Segments,
}

/// Softens every crease; `softness[i]` is for the crease with id `i`.
///
/// Bands keep the order of the creases. A sharp crease has a single fold line. A flat crease
/// ([`Role::Flat`]) folds nothing: its softness is not looked at, and its band has no fold lines. Fold lines
/// end exactly on the boundary where their crease does, otherwise square to the crease's free end; those of
/// a closed crease repeat their first point at the end.
///
/// # Errors
/// The first request that is no softness, then the first band that does not fit: it reaches its
/// centre of curvature, itself, the boundary sideways, or another band.
pub fn soften(pattern: &CreasePattern, softness: &[CreaseSoftness]) -> Result<SoftPattern, SoftenError> {
    if softness.len() != pattern.creases.len() {
        return Err(SoftenError::Count { creases: pattern.creases.len(), given: softness.len() });
    }
    let tolerance = pattern.tolerance();
    let sheet = Sheet { boundary: Boundary::new(pattern, tolerance.chord_mm), tolerance };
    let stage = Stage { sheet, creases: &pattern.creases, softness };
    let shapes = stage.shapes()?;
    stage.refuse_overlaps(&shapes)?;
    let bands = shapes.into_iter().enumerate().map(|(i, shape)| stage.band(i, shape)).collect();
    let loops = pattern.loops().map(|(_, c)| c.clone()).collect();
    Ok(SoftPattern { loops, bands, tolerance })
}

struct Stage<'a> {
    sheet: Sheet,
    creases: &'a [Crease],
    softness: &'a [CreaseSoftness],
}

impl Stage<'_> {
    /// The shape of each band; none for flat creases.
    fn shapes(&self) -> Result<Vec<Option<Shape>>, SoftenError> {
        let tried: Vec<_> = self
            .creases
            .iter()
            .zip(self.softness)
            .map(|(c, s)| (c.role != Role::Flat).then(|| Shape::new(&self.sheet, c, s)).transpose())
            .collect();
        let fitting: Vec<_> = tried.iter().map(|t| t.as_ref().ok().and_then(Option::as_ref)).collect();
        let refused = tried.iter().enumerate().find_map(|(i, t)| Some((i, t.as_ref().err()?)));
        if let Some((i, problem)) = refused {
            let fault = match problem {
                Problem::Fault(fault) => fault.clone(),
                Problem::Misfit(why, at) => {
                    self.misfit(i, why.clone(), *at, self.largest_radius(i, &fitting))
                }
            };
            return Err(SoftenError::of(&self.creases[i], fault));
        }
        Ok(tried.into_iter().map(|t| t.ok().flatten()).collect())
    }

    /// Refuses the first two bands that reach each other.
    fn refuse_overlaps(&self, shapes: &[Option<Shape>]) -> Result<(), SoftenError> {
        for (i, a) in shapes.iter().enumerate() {
            for (j, b) in shapes.iter().enumerate().skip(i + 1) {
                let (Some(a), Some(b)) = (a, b) else { continue };
                let Some(at) = a.meets(b, self.sheet.tolerance.join_mm) else { continue };
                let all: Vec<_> = shapes.iter().map(Option::as_ref).collect();
                let why = Misfit::Band {
                    other: self.creases[j].name.clone(),
                    other_largest_radius_mm: self.largest_radius(j, &all),
                };
                let fault = self.misfit(i, why, at, self.largest_radius(i, &all));
                return Err(SoftenError::of(&self.creases[i], fault));
            }
        }
        Ok(())
    }

    fn misfit(&self, i: usize, why: Misfit, at: DVec2, largest_radius_mm: Option<f64>) -> Fault {
        Fault::Misfit { why, at, radius_mm: self.softness[i].radius_mm, largest_radius_mm }
    }

    /// The largest radius of crease `i` that fits on the sheet between the other bands, by halving: a
    /// smaller band lies inside a larger one, so what fits is an interval from 0.
    fn largest_radius(&self, i: usize, shapes: &[Option<&Shape>]) -> Option<f64> {
        let fits = |radius_mm: f64| {
            let softness = CreaseSoftness { radius_mm, ..self.softness[i] };
            let others = shapes.iter().enumerate().filter(|&(j, _)| j != i).filter_map(|(_, s)| *s);
            let slack_mm = self.sheet.tolerance.join_mm;
            Shape::new(&self.sheet, &self.creases[i], &softness)
                .is_ok_and(|s| others.into_iter().all(|o| s.meets(o, slack_mm).is_none()))
        };
        let mut high = self.softness[i].radius_mm;
        let mut low = LEAST_RADIUS_SHARE * high;
        if high == 0.0 || !fits(low) {
            return None;
        }
        for _ in 0..RADIUS_HALVINGS {
            let middle = 0.5 * (low + high);
            if fits(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }

    fn band(&self, i: usize, shape: Option<Shape>) -> Band {
        let crease = self.creases[i].id;
        match shape {
            None => Band {
                crease,
                radius_mm: 0.0,
                fold_angle_rad: 0.0,
                strip_width_mm: 0.0,
                fold_lines: Vec::new(),
            },
            Some(shape) => Band {
                crease,
                radius_mm: self.softness[i].radius_mm,
                fold_angle_rad: self.softness[i].fold_angle_rad,
                strip_width_mm: shape.figures.chord_mm,
                fold_lines: shape.lines,
            },
        }
    }
}
