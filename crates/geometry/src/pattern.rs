//! The crease pattern: what the user drew, in mm, with roles.

use crate::{CheckError, CreaseId, LoopId, PlanarCurve, Tolerance, polygon};
use glam::DVec2;
use std::collections::BTreeMap;

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
    /// Open cuts inside the sheet; their ends may lie on the boundary or on each other.
    pub slits: Vec<PlanarCurve>,
    /// The creases; `creases[i].id` is `i`. They meet at their ends alone, and ends that meet are equal to
    /// the last bit ([`CreasePattern::junctions`]).
    pub creases: Vec<Crease>,
}

/// One end of a crease.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CreaseEnd {
    /// The crease.
    pub crease: CreaseId,
    /// 0: its start, 1: its end.
    pub side: usize,
}

/// A point where two or more ends of creases meet; creases that stay flat do not count.
#[derive(Clone, Debug, PartialEq)]
pub struct Junction {
    /// Where.
    pub point: DVec2,
    /// The ends that meet, counter-clockwise by the direction in which they leave, from that of −u on.
    pub ends: Vec<CreaseEnd>,
}

impl CreasePattern {
    /// Outline and holes, by [`LoopId`].
    pub fn loops(&self) -> impl Iterator<Item = (LoopId, &PlanarCurve)> {
        std::iter::once(&self.outline).chain(&self.holes).enumerate().map(|(i, c)| (LoopId::new(i), c))
    }

    /// Outline, holes and slits: all that bands end on, by [`LoopId`].
    pub fn boundaries(&self) -> impl Iterator<Item = (LoopId, &PlanarCurve)> {
        let curves = std::iter::once(&self.outline).chain(&self.holes).chain(&self.slits);
        curves.enumerate().map(|(i, c)| (LoopId::new(i), c))
    }

    /// Where creases meet, in order of the first crease end.
    pub fn junctions(&self) -> Vec<Junction> {
        let mut at: BTreeMap<[u64; 2], Vec<CreaseEnd>> = BTreeMap::new();
        for c in self.creases.iter().filter(|c| c.role != Role::Flat) {
            for side in 0..2 {
                let p = c.curve.end(side) + DVec2::ZERO; // −0 becomes 0
                let end = CreaseEnd { crease: c.id, side };
                at.entry([p.x.to_bits(), p.y.to_bits()]).or_default().push(end);
            }
        }
        // Both ends of a closed crease meet each other: a junction only if another joins them.
        let meet =
            |ends: &Vec<CreaseEnd>| ends.len() > 2 || (ends.len() == 2 && ends[0].crease != ends[1].crease);
        let mut meeting: Vec<Vec<CreaseEnd>> = at.into_values().filter(meet).collect();
        meeting.sort();
        let direction = |e: &CreaseEnd| self.creases[e.crease.index()].curve.leaving(e.side).to_angle();
        meeting
            .into_iter()
            .map(|mut ends| {
                let point = self.creases[ends[0].crease.index()].curve.end(ends[0].side);
                ends.sort_by(|a, b| direction(a).total_cmp(&direction(b)).then(a.cmp(b)));
                Junction { point, ends }
            })
            .collect()
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
        if let Some(i) = self.slits.iter().position(PlanarCurve::is_closed) {
            return fault(format!("slit {i} is closed: it is a hole"));
        }
        match self.creases.iter().enumerate().find(|(i, c)| c.id.index() != *i) {
            Some((i, c)) => fault(format!("crease {i} has the id {}", c.id)),
            None => Ok(()),
        }
    }
}
