//! `[fold]`: solver, start, and what holds, pulls and carries the sheet.

use super::ProjectFault;
use super::course::{Release, SelfCollision, Step};
use super::number::{Number, Range, entry, finite};
use super::place::{MEND, Place, Spot};
use serde::Deserialize;
use std::path::PathBuf;

/// `fold.solver`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Solver {
    /// Newton's method.
    #[default]
    Newton,
    /// L-BFGS on a prefactored matrix: little memory.
    Lbfgs,
    /// The paper's eq. 4.
    Relax,
}

/// `fold.start`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Start {
    /// The flat sheet stands on its foot.
    Upright,
    /// The flat sheet lies on the ground.
    #[default]
    Flat,
}

/// `[fold]`
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fold {
    /// Solver.
    pub solver: Solver,
    /// Start.
    pub start: Start,
    /// Relative gradient at which to stop.
    pub relative_gradient: Option<f64>,
    /// Most iterations.
    pub max_iterations: Option<u32>,
    /// Most seconds; the best state until then is kept.
    pub max_seconds: Option<f64>,
    /// Momentum of eq. 4, from 0 (as printed) to below 1.
    pub momentum: Option<f64>,
    /// `[[fold.anchors]]`
    pub anchors: Vec<Anchor>,
    /// `[[fold.bands]]`
    pub bands: Vec<Band>,
    /// `[[fold.planes]]`
    pub planes: Vec<Plane>,
    /// `[[fold.glues]]`
    pub glues: Vec<Glue>,
    /// `[[fold.coplanar]]`
    pub coplanar: Vec<CoPlanar>,
    /// `[[fold.rails]]`
    pub rails: Vec<Rail>,
    /// `[[fold.scans]]`
    pub scans: Vec<Scan>,
    /// `[[fold.floors]]`
    pub floors: Vec<Floor>,
    /// `[[fold.loads]]`
    pub loads: Vec<Load>,
    /// The sheet's own weight pulls along −z.
    pub self_weight: bool,
    /// How hard triangles keep their areas, N/mm.
    pub area_stiffness: Option<f64>,
    /// `[fold.collide]`
    pub collide: Option<Collide>,
    /// `[fold.self_collision]`
    pub self_collision: SelfCollision,
    /// `[[fold.schedule]]`
    pub schedule: Vec<Step>,
    /// `[fold.release]`
    pub release: Option<Release>,
    /// `[fold.weights]`
    pub weights: Option<Weights>,
}

/// `[fold.weights]`: strengths as in Kangaroo, in place of the material's.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// Of edges keeping their lengths.
    pub stretching: f64,
    /// Of faces staying flat.
    pub bending: f64,
    /// Of fold lines holding their turns.
    pub folding: f64,
}

/// `[[fold.anchors]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Anchor {
    /// Name.
    pub name: String,
    /// Point of the sheet.
    pub at: Place,
    /// Place in space, mm.
    pub target: [f64; 3],
    /// Stiffness along x, y, z, N/mm.
    pub stiffness: [f64; 3],
}

/// `[[fold.bands]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Name.
    pub name: String,
    /// One end on the sheet.
    pub from: Place,
    /// The other end.
    pub to: Place,
    /// Length up to which it is slack, mm.
    pub rest_mm: f64,
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

/// `[[fold.planes]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// Name.
    pub name: String,
    /// Start of the piece of outline.
    pub outline_from: Option<Place>,
    /// Its end, counter-clockwise.
    pub outline_to: Option<Place>,
    /// In place of a piece of outline: corners of a polygon whose vertices are kept in the plane, mm.
    pub region: Option<Vec<[f64; 2]>>,
    /// A point of the plane, mm.
    pub origin: [f64; 3],
    /// Its normal.
    pub normal: [f64; 3],
    /// Stiffness per vertex, N/mm.
    pub stiffness: f64,
}

/// `[[fold.glues]]`: two points of the sheet held together.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Glue {
    /// Name.
    pub name: String,
    /// One point of the sheet.
    pub from: Place,
    /// The other.
    pub to: Place,
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

/// `[[fold.coplanar]]`: points of the sheet brought into one plane, wherever that is.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoPlanar {
    /// Name.
    pub name: String,
    /// Points of the sheet, or all of a region.
    pub at: Vec<Spot>,
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

/// `[[fold.rails]]`: points of the sheet pulled onto a polyline in space.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rail {
    /// Name.
    pub name: String,
    /// Points of the sheet, or all of a region.
    pub at: Vec<Spot>,
    /// Points of the polyline, mm.
    pub through: Vec<[f64; 3]>,
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

/// `[[fold.scans]]`: points of the sheet pulled onto a triangle mesh in space.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scan {
    /// Name.
    pub name: String,
    /// Points of the sheet, or all of a region.
    pub at: Vec<Spot>,
    /// The mesh, mm: OBJ, PLY, STL or OFF, relative to the project file.
    pub file: PathBuf,
    /// Stiffness per point, N/mm.
    pub stiffness: f64,
}

/// `[[fold.floors]]`: a plane that the sheet stays on one side of.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Floor {
    /// Name.
    pub name: String,
    /// A point of the plane, mm.
    pub origin: [f64; 3],
    /// Its normal, towards the sheet.
    pub normal: [f64; 3],
    /// Stiffness per vertex, N/mm.
    pub stiffness: f64,
}

/// `[[fold.loads]]`: a force at a point of the sheet.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Name.
    pub name: String,
    /// Point of the sheet.
    pub at: Place,
    /// Force, N.
    pub force_n: [f64; 3],
}

/// `[fold.collide]`: balls at the vertices that do not pass into each other.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Collide {
    /// Diameter of the balls, mm.
    pub diameter_mm: f64,
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

impl Plane {
    const WHERE: &str = "give outline_from and outline_to, or region = [[u, v], ...] with three corners or more; places \
                         are [u, v] or { outline_mm or outline_share = NUMBER }";

    fn says_where(&self) -> bool {
        match (&self.outline_from, &self.outline_to, &self.region) {
            (Some(from), Some(to), None) => from.is_fine() && to.is_fine(),
            (None, None, Some(region)) => region.len() > 2 && region.iter().all(|p| finite(p)),
            _ => false,
        }
    }
}

/// Whether these are `least` points or have a region among them.
fn enough(spots: &[Spot], least: usize) -> bool {
    spots.len() >= least || spots.iter().any(|s| matches!(s, Spot::Region(_)))
}

impl Fold {
    pub(super) fn check(&self, text: &str) -> Result<(), ProjectFault> {
        for (i, a) in self.anchors.iter().enumerate() {
            entry(a.at.is_fine(), text, "fold.anchors", i, &a.name, MEND)?;
            let fine = finite(&a.target) && a.stiffness.iter().all(|k| *k >= 0.0 && k.is_finite());
            entry(
                fine,
                text,
                "fold.anchors",
                i,
                &a.name,
                "target must be finite numbers, stiffness not negative",
            )?;
        }
        for (i, b) in self.bands.iter().enumerate() {
            entry(b.from.is_fine() && b.to.is_fine(), text, "fold.bands", i, &b.name, MEND)?;
            let fine = [b.rest_mm, b.stiffness].iter().all(|v| *v >= 0.0 && v.is_finite());
            entry(
                fine,
                text,
                "fold.bands",
                i,
                &b.name,
                "rest_mm and stiffness must be finite numbers, not negative",
            )?;
        }
        for (i, p) in self.planes.iter().enumerate() {
            entry(p.says_where(), text, "fold.planes", i, &p.name, Plane::WHERE)?;
            let numbers = finite(&p.origin) && finite(&p.normal);
            let fine = numbers
                && p.normal.iter().any(|c| *c != 0.0)
                && p.stiffness >= 0.0
                && p.stiffness.is_finite();
            entry(
                fine,
                text,
                "fold.planes",
                i,
                &p.name,
                "origin and normal must be finite numbers, the normal not zero, stiffness not negative",
            )?;
        }
        self.check_new(text)
    }

    /// Names of all that holds, pulls or loads the sheet and can be let go.
    pub fn hold_names(&self) -> Vec<&str> {
        let anchors = self.anchors.iter().map(|h| &h.name);
        let bands = self.bands.iter().map(|h| &h.name);
        let planes = self.planes.iter().map(|h| &h.name);
        let glues = self.glues.iter().map(|h| &h.name);
        let coplanar = self.coplanar.iter().map(|h| &h.name);
        let rails = self.rails.iter().map(|h| &h.name);
        let scans = self.scans.iter().map(|h| &h.name);
        let loads = self.loads.iter().map(|h| &h.name);
        let points = glues.chain(coplanar).chain(rails).chain(scans);
        let all = anchors.chain(bands).chain(planes).chain(points).chain(loads);
        all.map(String::as_str).collect()
    }

    /// Glues, coplanar points, rails, floors and loads.
    fn check_new(&self, text: &str) -> Result<(), ProjectFault> {
        let stiff = |k: f64| k >= 0.0 && k.is_finite();
        for (i, g) in self.glues.iter().enumerate() {
            entry(g.from.is_fine() && g.to.is_fine(), text, "fold.glues", i, &g.name, MEND)?;
            let mend = "stiffness must be a finite number, not negative";
            entry(stiff(g.stiffness), text, "fold.glues", i, &g.name, mend)?;
        }
        for (i, c) in self.coplanar.iter().enumerate() {
            let fine = enough(&c.at, 4) && c.at.iter().all(Spot::is_fine) && stiff(c.stiffness);
            let mend = "give four points or more or a region in `at`, all finite, and a stiffness that is not negative";
            entry(fine, text, "fold.coplanar", i, &c.name, mend)?;
        }
        for (i, r) in self.rails.iter().enumerate() {
            let points = enough(&r.at, 1) && r.at.iter().all(Spot::is_fine);
            let rail = r.through.len() > 1 && r.through.iter().all(|p| finite(p));
            let mend = "give points of the sheet in `at` and two points of space or more in `through`, all finite, and a \
                        stiffness that is not negative";
            entry(points && rail && stiff(r.stiffness), text, "fold.rails", i, &r.name, mend)?;
        }
        for (i, s) in self.scans.iter().enumerate() {
            let fine = enough(&s.at, 1) && s.at.iter().all(Spot::is_fine) && stiff(s.stiffness);
            let mend = "give points of the sheet or a region in `at`, all finite, and a stiffness that is not negative";
            entry(fine, text, "fold.scans", i, &s.name, mend)?;
        }
        for (i, f) in self.floors.iter().enumerate() {
            let fine = finite(&f.origin) && finite(&f.normal) && f.normal.iter().any(|c| *c != 0.0);
            let mend =
                "origin and normal must be finite numbers, the normal not zero, stiffness not negative";
            entry(fine && stiff(f.stiffness), text, "fold.floors", i, &f.name, mend)?;
        }
        for (i, l) in self.loads.iter().enumerate() {
            entry(l.at.is_fine(), text, "fold.loads", i, &l.name, MEND)?;
            entry(finite(&l.force_n), text, "fold.loads", i, &l.name, "force_n must be finite numbers")?;
        }
        self.schedule.iter().enumerate().try_for_each(|(i, step)| step.check(text, i))?;
        self.release.as_ref().map_or(Ok(()), |r| r.check(text))
    }

    pub(super) fn numbers(&self) -> Vec<Number> {
        let n = |key, value: Option<f64>, range| value.map(|v| Number::new("fold", key, v, range));
        let mut all: Vec<Number> = [
            n("relative_gradient", self.relative_gradient, Range::Share),
            n("momentum", self.momentum, Range::Share),
            n("max_seconds", self.max_seconds, Range::Positive),
            n("area_stiffness", self.area_stiffness, Range::NotNegative),
        ]
        .into_iter()
        .flatten()
        .collect();
        all.extend(self.self_collision.numbers());
        if let Some(c) = &self.collide {
            all.push(Number::new("fold.collide", "diameter_mm", c.diameter_mm, Range::Positive));
            all.push(Number::new("fold.collide", "stiffness", c.stiffness, Range::NotNegative));
        }
        if let Some(w) = &self.weights {
            let keys = [("stretching", w.stretching), ("bending", w.bending), ("folding", w.folding)];
            all.extend(keys.map(|(key, value)| Number::new("fold.weights", key, value, Range::Positive)));
        }
        all
    }
}
