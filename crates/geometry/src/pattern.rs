//! The crease pattern: what the user drew, in mm, with roles.

use crate::{CheckError, CreaseId, LoopId, PlanarCurve, Tolerance, polygon};
use glam::DVec2;

/// What a line of the pattern is (FOLD's `edges_assignment`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// B: outline or hole.
    Boundary,
    /// M: mountain, negative fold angle.
    Mountain,
    /// V: valley, positive fold angle.
    Valley,
    /// F: an edge that stays flat.
    Flat,
    /// U: a crease whose direction is not decided.
    Unassigned,
    /// C: a slit.
    Cut,
}

impl Role {
    /// FOLD's letter.
    pub fn letter(self) -> char {
        match self {
            Role::Boundary => 'B',
            Role::Mountain => 'M',
            Role::Valley => 'V',
            Role::Flat => 'F',
            Role::Unassigned => 'U',
            Role::Cut => 'C',
        }
    }

    /// Sign of the fold angle: +1 valley, −1 mountain, 0 otherwise.
    pub fn sign(self) -> f64 {
        match self {
            Role::Valley => 1.0,
            Role::Mountain => -1.0,
            _ => 0.0,
        }
    }
}

/// Where in the user's file something came from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// The element's id, or its kind and number.
    pub element: String,
    /// Line of the file, from 1.
    pub line: Option<u32>,
}

/// A curve along which the sheet is folded.
#[derive(Clone, Debug, PartialEq)]
pub struct Crease {
    /// Its number in the pattern.
    pub id: CreaseId,
    /// The name by which the project file speaks of it: the element's id, or `crease-N`.
    pub name: String,
    /// Mountain, valley, flat or unassigned.
    pub role: Role,
    /// The crease line in (u, v).
    pub curve: PlanarCurve,
    /// Signed fold angle π − ρ, + valley, − mountain; none where the file does not say.
    pub fold_angle_rad: Option<f64>,
    /// Where it came from.
    pub source: Source,
}

/// Outline, holes and creases of a sheet, normalised: the outline runs counter-clockwise, holes
/// clockwise, creases are numbered in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct CreasePattern {
    /// Name of the file without its ending.
    pub name: String,
    /// The closed outline, counter-clockwise.
    pub outline: PlanarCurve,
    /// Closed holes, clockwise.
    pub holes: Vec<PlanarCurve>,
    /// The creases; `creases[i].id` is `i`.
    pub creases: Vec<Crease>,
}

impl CreasePattern {
    /// Outline and holes, by [`LoopId`].
    pub fn loops(&self) -> impl Iterator<Item = (LoopId, &PlanarCurve)> {
        std::iter::once(&self.outline).chain(&self.holes).enumerate().map(|(i, c)| (LoopId::new(i), c))
    }

    /// Area of the sheet, mm².
    pub fn area_mm2(&self) -> f64 {
        self.loops().map(|(_, c)| c.signed_area_mm2()).sum()
    }

    /// The larger side of the outline's box, mm.
    pub fn size_mm(&self) -> f64 {
        let controls: Vec<DVec2> = self.outline.segments().iter().flat_map(|s| s.control_points()).collect();
        let (lo, hi) = polygon::bounds(&controls);
        (hi - lo).max_element()
    }

    /// Tolerances of this sheet.
    pub fn tolerance(&self) -> Tolerance {
        Tolerance::for_size(self.size_mm())
    }

    /// The contract of this type.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), CheckError> {
        let fault = |f: String| Err(CheckError::new("CreasePattern", f));
        for (id, c) in self.loops() {
            if !c.is_closed() {
                return fault(format!("loop {id} is open"));
            }
            if (c.signed_area_mm2() > 0.0) != (id.0 == 0) {
                return fault(format!("loop {id} runs the wrong way round"));
            }
        }
        match self.creases.iter().enumerate().find(|(i, c)| c.id.index() != *i) {
            Some((i, c)) => fault(format!("crease {i} has the id {}", c.id)),
            None => Ok(()),
        }
    }
}
