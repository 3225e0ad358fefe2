//! Why a pattern cannot be softened: the crease, the place, and the mend.

use crate::{AlongFault, BoardFault};
use softfold_geometry::{Crease, CreaseId, DVec2, Issue, Severity};
use std::fmt;

/// Longer lengths (1 km) have an exponent in messages.
const LONGEST_WRITTEN_OUT_MM: f64 = 1e6;

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
        /// Where along the crease, mm.
        s_mm: Option<f64>,
    },
    /// The fold angle is no number, or ±180° and beyond, or 0 all along.
    FoldAngle {
        /// The angle asked for, rad.
        fold_angle_rad: f64,
        /// Where along the crease, mm.
        s_mm: Option<f64>,
    },
    /// A list of places along the crease is none.
    Along {
        /// What the list is of.
        what: &'static str,
        /// What is wrong with it.
        why: AlongFault,
    },
    /// The board is too thick for what is asked, or no board.
    Board {
        /// What is wrong.
        why: BoardFault,
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
        why: Box<Misfit>,
        /// Where.
        at: DVec2,
        /// The radius asked for, mm; where it changes along the crease, the largest.
        radius_mm: f64,
        /// The largest radius that fits, mm, all other bands as they are and the radii along this one scaled
        /// together; none if not even a sharp fold does.
        largest_radius_mm: Option<f64>,
        /// If no radius does: the largest factor on all radii of the pattern with which all bands fit; none if
        /// not even sharp folds do.
        all_share: Option<f64>,
    },
    /// The fold lines of the band would have more points than anything can be done with.
    TooFine {
        /// How many points.
        points: usize,
    },
}

/// Why a band does not fit.
#[derive(Clone, Debug, PartialEq)]
pub enum Misfit {
    /// The inner edge reaches the crease's centre of curvature.
    Curvature,
    /// The band reaches the outline, a hole or a slit along its side, or has one in it.
    Boundary,
    /// The junction regions at its ends leave nothing of it.
    Short,
    /// The region where creases meet does not fit.
    Junction {
        /// Names of the creases that meet.
        creases: Vec<String>,
        /// The largest factor on all their radii with which they fit; none if not even sharp folds do.
        largest_share: Option<f64>,
    },
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
            Self::Radius { radius_mm, s_mm } => {
                format!("the radius {radius_mm} mm{} is no radius", place(*s_mm))
            }
            Self::FoldAngle { fold_angle_rad, s_mm } => {
                let degrees = fold_angle_rad.to_degrees();
                format!("the fold angle {degrees:.3}°{} cannot be folded", place(*s_mm))
            }
            Self::Along { what, why } => format!("the list of its {what} {}", why.message()),
            Self::Board { why } => why.message(),
            Self::Segments { segments } => format!("a band cannot have {segments} strips"),
            Self::ChordTolerance { tolerance_mm } => format!("the chord tolerance {tolerance_mm} mm is none"),
            Self::Corner { turn_rad, .. } => {
                format!("the crease has a corner of {:.1}°", turn_rad.to_degrees())
            }
            Self::TooFine { points } => format!("the fold lines of its band would have {points} points"),
            Self::Misfit { why, radius_mm: 0.0, .. } => format!("the sharp crease {}", why.message()),
            Self::Misfit { why, radius_mm, .. } => {
                format!("the band of radius {} {}", length(*radius_mm), why.message())
            }
        }
    }

    fn mend(&self, name: &str) -> String {
        match self {
            Self::Radius { .. } => "give 0 (sharp) or more".to_owned(),
            Self::FoldAngle { .. } => {
                "give degrees between -180 and 180, not 0 everywhere; draw lines that stay flat yellow"
                    .to_owned()
            }
            Self::Along { .. } => {
                "give pairs of arc length in mm, ascending from 0 to the crease's length, and value"
                    .to_owned()
            }
            Self::Board { why } => why.mend(),
            Self::Segments { .. } => format!("give 1 to {}", crate::figures::MOST_SEGMENTS),
            Self::ChordTolerance { .. } => "give a positive length in mm".to_owned(),
            Self::Corner { .. } => "round the corner, or split the crease there".to_owned(),
            Self::TooFine { .. } => {
                "give fewer strips or fewer places, or draw the crease with fewer segments".to_owned()
            }
            Self::Misfit { radius_mm: 0.0, .. } => "end it there, or draw it elsewhere".to_owned(),
            Self::Misfit { why, largest_radius_mm, all_share, .. } => {
                let mend = misfit_mend(name, why, *largest_radius_mm);
                let all =
                    |share: &f64| format!("; all radii of the pattern fit at {:.2} %", floor_percent(*share));
                mend + &all_share.as_ref().map_or(String::new(), all)
            }
        }
    }
}

fn misfit_mend(name: &str, why: &Misfit, largest: Option<f64>) -> String {
    let fits = |name: &str, radius: Option<f64>| match radius {
        Some(0.0) => format!("'{name}' fits as a sharp fold only, with radius 0"),
        Some(r) => format!("the largest radius that fits '{name}' is {}", floor_length(r)),
        None => format!("no radius fits '{name}'"),
    };
    match why {
        Misfit::Band { other, other_largest_radius_mm } => {
            format!("{}, or {}", fits(name, largest), fits(other, *other_largest_radius_mm))
        }
        Misfit::Junction { largest_share: Some(share), .. } => {
            format!(
                "{}; all radii that meet there fit at {:.2} %",
                fits(name, largest),
                floor_percent(*share)
            )
        }
        _ => fits(name, largest),
    }
}

/// A length as a message says it.
fn length(mm: f64) -> String {
    if mm < LONGEST_WRITTEN_OUT_MM { format!("{mm:.3} mm") } else { format!("{mm:e} mm") }
}

/// A length as a message says it, never more than it is.
fn floor_length(mm: f64) -> String {
    length(if mm < LONGEST_WRITTEN_OUT_MM { (1e3 * mm).floor() / 1e3 } else { mm })
}

/// In percent with two digits, never more than it is.
fn floor_percent(share: f64) -> f64 {
    (1e4 * share).floor() / 1e2
}

/// Where along a crease, for a message.
fn place(s_mm: Option<f64>) -> String {
    s_mm.filter(|s| *s != 0.0).map_or(String::new(), |s| format!(" at {s:.3} mm along it"))
}

impl AlongFault {
    fn message(&self) -> String {
        match self {
            Self::Empty => "is empty".to_owned(),
            Self::TooMany { places } => {
                format!("has {places} entries, more than {}", crate::along::MOST_PLACES)
            }
            Self::NotFinite => "has a place that is no finite number".to_owned(),
            Self::Unsorted { s_mm } => format!("is not sorted: {s_mm} mm comes after a place beyond it"),
            Self::Twice { s_mm } => format!("has the place {s_mm} mm twice"),
            Self::OffCrease { s_mm, length_mm } => {
                format!("has the place {s_mm} mm, but the crease is {length_mm:.3} mm long")
            }
        }
    }
}

impl Misfit {
    pub(crate) fn junction() -> Self {
        Self::Junction { creases: Vec::new(), largest_share: None }
    }

    fn message(&self) -> String {
        match self {
            Self::Curvature => "swallows its inside: the crease is bent too tightly".to_owned(),
            Self::Boundary => "reaches the outline, a hole or a slit sideways".to_owned(),
            Self::Short => "has no room between the junctions at its ends".to_owned(),
            Self::Junction { creases, .. } => {
                format!("leaves no room for the region where {} meet", creases.join(", "))
            }
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

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.message())
    }
}
