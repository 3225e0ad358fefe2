//! `[fold]`: solver, start, and what holds, pulls and carries the sheet.

use super::ProjectFault;
use super::number::{Number, Range, entry, finite};
use serde::Deserialize;

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
}

/// `[[fold.anchors]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Anchor {
    /// Name.
    pub name: String,
    /// Point of the sheet, mm.
    pub at: [f64; 2],
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
    /// One end on the sheet, mm.
    pub from: [f64; 2],
    /// The other end, mm.
    pub to: [f64; 2],
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
    /// Start of the piece of outline, mm.
    pub outline_from: [f64; 2],
    /// Its end, counter-clockwise, mm.
    pub outline_to: [f64; 2],
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
    /// One point of the sheet, mm.
    pub from: [f64; 2],
    /// The other, mm.
    pub to: [f64; 2],
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

/// `[[fold.coplanar]]`: points of the sheet brought into one plane, wherever that is.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoPlanar {
    /// Name.
    pub name: String,
    /// Points of the sheet, mm.
    pub at: Vec<[f64; 2]>,
    /// Stiffness, N/mm.
    pub stiffness: f64,
}

/// `[[fold.rails]]`: points of the sheet pulled onto a polyline in space.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rail {
    /// Name.
    pub name: String,
    /// Points of the sheet, mm.
    pub at: Vec<[f64; 2]>,
    /// Points of the polyline, mm.
    pub through: Vec<[f64; 3]>,
    /// Stiffness, N/mm.
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
    /// Point of the sheet, mm.
    pub at: [f64; 2],
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

impl Fold {
    pub(super) fn check(&self, text: &str) -> Result<(), ProjectFault> {
        for (i, a) in self.anchors.iter().enumerate() {
            let fine =
                finite(&a.at) && finite(&a.target) && a.stiffness.iter().all(|k| *k >= 0.0 && k.is_finite());
            entry(
                fine,
                text,
                "fold.anchors",
                i,
                &a.name,
                "at and target must be finite numbers, stiffness not negative",
            )?;
        }
        for (i, b) in self.bands.iter().enumerate() {
            let fine = finite(&b.from)
                && finite(&b.to)
                && [b.rest_mm, b.stiffness].iter().all(|v| *v >= 0.0 && v.is_finite());
            entry(
                fine,
                text,
                "fold.bands",
                i,
                &b.name,
                "its ends must be finite numbers, rest_mm and stiffness not negative",
            )?;
        }
        for (i, p) in self.planes.iter().enumerate() {
            let numbers =
                finite(&p.outline_from) && finite(&p.outline_to) && finite(&p.origin) && finite(&p.normal);
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
                "its points must be finite numbers, the normal not zero, stiffness not negative",
            )?;
        }
        self.check_new(text)
    }

    /// Glues, coplanar points, rails, floors and loads.
    fn check_new(&self, text: &str) -> Result<(), ProjectFault> {
        let stiff = |k: f64| k >= 0.0 && k.is_finite();
        for (i, g) in self.glues.iter().enumerate() {
            let fine = finite(&g.from) && finite(&g.to) && stiff(g.stiffness);
            let mend = "its ends must be finite numbers, stiffness not negative";
            entry(fine, text, "fold.glues", i, &g.name, mend)?;
        }
        for (i, c) in self.coplanar.iter().enumerate() {
            let fine = c.at.len() > 3 && c.at.iter().all(|p| finite(p)) && stiff(c.stiffness);
            let mend = "give four points or more in `at`, all finite, and a stiffness that is not negative";
            entry(fine, text, "fold.coplanar", i, &c.name, mend)?;
        }
        for (i, r) in self.rails.iter().enumerate() {
            let points = !r.at.is_empty() && r.at.iter().all(|p| finite(p));
            let rail = r.through.len() > 1 && r.through.iter().all(|p| finite(p));
            let mend = "give points of the sheet in `at` and two points of space or more in `through`, all finite, and a \
                        stiffness that is not negative";
            entry(points && rail && stiff(r.stiffness), text, "fold.rails", i, &r.name, mend)?;
        }
        for (i, f) in self.floors.iter().enumerate() {
            let fine = finite(&f.origin) && finite(&f.normal) && f.normal.iter().any(|c| *c != 0.0);
            let mend =
                "origin and normal must be finite numbers, the normal not zero, stiffness not negative";
            entry(fine && stiff(f.stiffness), text, "fold.floors", i, &f.name, mend)?;
        }
        for (i, l) in self.loads.iter().enumerate() {
            let fine = finite(&l.at) && finite(&l.force_n);
            entry(fine, text, "fold.loads", i, &l.name, "at and force_n must be finite numbers")?;
        }
        Ok(())
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
        if let Some(c) = &self.collide {
            all.push(Number::new("fold.collide", "diameter_mm", c.diameter_mm, Range::Positive));
            all.push(Number::new("fold.collide", "stiffness", c.stiffness, Range::NotNegative));
        }
        all
    }
}
