//! Why a pattern cannot be softened: the crease, the place, and the mend.

use softfold_geometry::{Crease, CreaseId, DVec2, Issue, Severity};
use std::fmt;

/// Why a pattern cannot be softened.
#[derive(Clone, Debug, PartialEq)]
pub enum SoftenError {
    /// There must be one softness for each crease.
    Count {
        /// Creases of the pattern.
        creases: usize,
        /// Softnesses given.
        given: usize,
    },
    /// One crease cannot be softened as asked.
    Crease {
        /// Its number.
        id: CreaseId,
        /// Its name.
        name: String,
        /// Its line in the file.
        line: Option<u32>,
        /// What is wrong.
        fault: Fault,
    },
}

/// What is wrong with the softness of one crease.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// The radius is negative or no finite number.
    Radius {
        /// The radius asked for, mm.
        radius_mm: f64,
    },
    /// The fold angle is 0, no number, or ±180° and beyond.
    FoldAngle {
        /// The angle asked for, rad.
        fold_angle_rad: f64,
    },
    /// No strips, or too many.
    Segments {
        /// The number asked for or worked out.
        segments: f64,
    },
    /// The chord tolerance is not positive.
    ChordTolerance {
        /// The tolerance asked for, mm.
        tolerance_mm: f64,
    },
    /// The crease has a corner, along which no band can be bent.
    Corner {
        /// Where.
        at: DVec2,
        /// How sharp, rad.
        turn_rad: f64,
    },
    /// The band does not fit on the sheet.
    Misfit {
        /// Why.
        why: Misfit,
        /// Where.
        at: DVec2,
        /// The radius asked for, mm.
        radius_mm: f64,
        /// The largest radius that fits, mm, all other bands as they are; none if not even a sharp
        /// fold does.
        largest_radius_mm: Option<f64>,
    },
}

/// Why a band does not fit.
#[derive(Clone, Debug, PartialEq)]
pub enum Misfit {
    /// The inner edge reaches the crease's centre of curvature.
    Curvature,
    /// The band reaches the outline or a hole along its side.
    Boundary,
    /// Two parts of the band reach each other.
    Itself,
    /// The band reaches another.
    Band {
        /// Name of the other crease.
        other: String,
        /// The largest radius of the other crease that fits with this one as it is, mm.
        other_largest_radius_mm: Option<f64>,
    },
}

impl SoftenError {
    pub(crate) fn of(crease: &Crease, fault: Fault) -> Self {
        Self::Crease { id: crease.id, name: crease.name.clone(), line: crease.source.line, fault }
    }

    /// What was found, where, and the mend.
    pub fn issue(&self) -> Issue {
        match self {
            Self::Count { creases, given } => Issue {
                severity: Severity::Error,
                message: format!("{given} softnesses for {creases} creases"),
                element: None,
                line: None,
                position: None,
                mend: "give one for each crease".to_owned(),
            },
            Self::Crease { name, line, fault, .. } => Issue {
                severity: Severity::Error,
                message: fault.message(),
                element: Some(format!("crease '{name}'")),
                line: *line,
                position: fault.at(),
                mend: fault.mend(name),
            },
        }
    }
}

impl Fault {
    fn at(&self) -> Option<DVec2> {
        match self {
            Self::Corner { at, .. } | Self::Misfit { at, .. } => Some(*at),
            _ => None,
        }
    }

    fn message(&self) -> String {
        match self {
            Self::Radius { radius_mm } => format!("the radius {radius_mm} mm is no radius"),
            Self::FoldAngle { fold_angle_rad } => {
                format!("the fold angle {:.3}° cannot be folded", fold_angle_rad.to_degrees())
            }
            Self::Segments { segments } => format!("a band cannot have {segments} strips"),
            Self::ChordTolerance { tolerance_mm } => format!("the chord tolerance {tolerance_mm} mm is none"),
            Self::Corner { turn_rad, .. } => {
                format!("the crease has a corner of {:.1}°", turn_rad.to_degrees())
            }
            Self::Misfit { why, radius_mm, .. } => {
                format!("the band of radius {radius_mm:.3} mm {}", why.message())
            }
        }
    }

    fn mend(&self, name: &str) -> String {
        match self {
            Self::Radius { .. } => "give 0 (sharp) or more".to_owned(),
            Self::FoldAngle { .. } => {
                "give degrees between -180 and 180, not 0; draw lines that stay flat yellow".to_owned()
            }
            Self::Segments { .. } => format!("give 1 to {}", crate::figures::MOST_SEGMENTS),
            Self::ChordTolerance { .. } => "give a positive length in mm".to_owned(),
            Self::Corner { .. } => "round the corner, or split the crease there".to_owned(),
            Self::Misfit { why, largest_radius_mm, .. } => misfit_mend(name, why, *largest_radius_mm),
        }
    }
}

fn misfit_mend(name: &str, why: &Misfit, largest: Option<f64>) -> String {
    let fits = |name: &str, radius: Option<f64>| match radius {
        Some(r) => format!("the largest radius that fits '{name}' is {r:.3} mm"),
        None => format!("no radius fits '{name}'"),
    };
    match why {
        Misfit::Band { other, other_largest_radius_mm } => {
            format!("{}, or {}", fits(name, largest), fits(other, *other_largest_radius_mm))
        }
        _ => fits(name, largest),
    }
}

impl Misfit {
    fn message(&self) -> String {
        match self {
            Self::Curvature => "swallows its inside: the crease is bent too tightly".to_owned(),
            Self::Boundary => "reaches the outline or a hole sideways".to_owned(),
            Self::Itself => "reaches another part of itself".to_owned(),
            Self::Band { other, .. } => format!("reaches the band of crease '{other}'"),
        }
    }
}

impl fmt::Display for SoftenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.issue().fmt(f)
    }
}

impl std::error::Error for SoftenError {}
