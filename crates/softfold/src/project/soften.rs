//! `[soften]`: radii, angles and strips, for all creases and by crease.

use super::ProjectFault;
use super::number::{Number, Range, line_of};
use serde::Deserialize;
use std::collections::BTreeMap;

/// A value along a crease: one number, or `[[arc length in mm, value], ...]` with straight lines between.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged, expecting = "give a number, or a list of pairs [arc length in mm, value]")]
pub enum Along {
    /// The same everywhere.
    Constant(f64),
    /// At arc lengths, mm.
    Points(Vec<[f64; 2]>),
}

/// A radius along a crease, mm, or the rule that finds it.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged, expecting = "give a number, a list of pairs [arc length in mm, radius], or \"material\"")]
pub enum Radius {
    /// Given.
    Given(Along),
    /// Found.
    Rule(RadiusRule),
}

/// `radius_mm = "material"`
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum RadiusRule {
    /// The smallest that the board's thickness and material allow.
    Material,
}

/// `soften.compensation`: what the board's thickness does to the radii (paper eq. 5 and 6).
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Compensation {
    /// Nothing.
    #[default]
    None,
    /// The thickness is on one side: valleys lose it (eq. 5).
    OneSided,
    /// Valleys are softer by the thickness, so that both skins agree (eq. 6).
    Equal,
    /// Bands keep `band_width_mm`, and their radius follows the local fold angle.
    PerPoint,
}

/// `[soften]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Soften {
    /// Radius of all creases that say nothing else, mm.
    pub radius_mm: Radius,
    /// Strips per band.
    pub segments: Option<u32>,
    /// Largest distance of strips from the arc, mm, in place of `segments`.
    pub chord_mm: Option<f64>,
    /// Fold angle of creases of which neither file nor table says one, degrees, without sign.
    pub fold_angle_deg: Option<f64>,
    /// How far all creases fold, % of their angles.
    #[serde(default = "Soften::all")]
    pub fold_percent: f64,
    /// What the board's thickness does to radii.
    #[serde(default)]
    pub compensation: Compensation,
    /// Width of all bands with the compensation `per-point`, mm.
    pub band_width_mm: Option<f64>,
    /// By crease name.
    #[serde(default)]
    pub creases: BTreeMap<String, SoftCrease>,
}

/// `[soften.creases.NAME]`
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoftCrease {
    /// Signed fold angle, degrees.
    pub fold_angle_deg: Option<Along>,
    /// Radius, mm.
    pub radius_mm: Option<Radius>,
    /// Strips.
    pub segments: Option<u32>,
    /// Largest distance of strips from the arc, mm.
    pub chord_mm: Option<f64>,
}

impl Soften {
    /// Strips where nothing is said: turns of a quarter of the fold angle.
    pub const SEGMENTS: u32 = 4;

    const fn all() -> f64 {
        100.0
    }

    pub(super) fn numbers(&self) -> Vec<Number> {
        let mut all = numbers_of("soften", Some(&self.radius_mm), self.segments, self.chord_mm);
        all.push(Number::new("soften", "fold_percent", self.fold_percent, Range::Percent));
        all.extend(self.band_width_mm.map(|w| Number::new("soften", "band_width_mm", w, Range::Positive)));
        for (name, crease) in &self.creases {
            let table = format!("soften.creases.{name}");
            all.extend(numbers_of(&table, crease.radius_mm.as_ref(), crease.segments, crease.chord_mm));
        }
        all
    }

    pub(super) fn check(&self, text: &str) -> Result<(), ProjectFault> {
        let both = |table: &str, segments: Option<u32>, chord: Option<f64>| match (segments, chord) {
            (Some(_), Some(_)) => Err(ProjectFault {
                line: line_of(text, table, "chord_mm"),
                message: format!("{table} has segments and chord_mm; give one of them"),
            }),
            _ => Ok(()),
        };
        both("soften", self.segments, self.chord_mm)?;
        if (self.compensation == Compensation::PerPoint) != self.band_width_mm.is_some() {
            return Err(ProjectFault {
                line: line_of(text, "soften", "compensation").or(line_of(text, "soften", "band_width_mm")),
                message: "soften.compensation = \"per-point\" and soften.band_width_mm go together; give both or none".to_owned(),
            });
        }
        self.creases
            .iter()
            .try_for_each(|(name, c)| both(&format!("soften.creases.{name}"), c.segments, c.chord_mm))
    }
}

fn numbers_of(
    table: &str,
    radius: Option<&Radius>,
    segments: Option<u32>,
    chord_mm: Option<f64>,
) -> Vec<Number> {
    let radii: Vec<f64> = match radius {
        Some(Radius::Given(Along::Constant(r))) => vec![*r],
        Some(Radius::Given(Along::Points(points))) => points.iter().map(|p| p[1]).collect(),
        _ => Vec::new(),
    };
    let radii = radii.into_iter().map(|r| Number::new(table, "radius_mm", r, Range::NotNegative));
    let segments = segments.map(|n| Number::new(table, "segments", f64::from(n), Range::AtLeastOne));
    let chord = chord_mm.map(|c| Number::new(table, "chord_mm", c, Range::Positive));
    radii.chain(segments).chain(chord).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::Project;

    fn parse(soften: &str) -> Result<Project, ProjectFault> {
        Project::parse(&format!("pattern = \"p.svg\"\n[board]\nthickness_mm = 10\n[soften]\n{soften}\n"))
    }

    #[test]
    fn radii_are_numbers_lists_or_the_materials() {
        let p = parse("radius_mm = \"material\"\n[soften.creases.a]\nradius_mm = [[0, 0], [300, 30]]\nfold_angle_deg = -70")
            .unwrap();
        assert_eq!(p.soften.radius_mm, Radius::Rule(RadiusRule::Material));
        let a = &p.soften.creases["a"];
        let taper = Along::Points(vec![[0.0, 0.0], [300.0, 30.0]]);
        assert_eq!(a.radius_mm, Some(Radius::Given(taper)));
        assert_eq!(a.fold_angle_deg, Some(Along::Constant(-70.0)));
    }

    #[test]
    fn what_is_no_radius_is_named_with_its_line_and_the_mend() {
        let fault = parse("radius_mm = \"thick\"").unwrap_err();
        assert_eq!(fault.line, Some(5));
        assert!(
            fault.message.contains("radius_mm") && fault.message.contains("\"material\""),
            "{}",
            fault.message
        );
        let fault = parse("radius_mm = [[0, 3], [10, -1]]").unwrap_err();
        assert_eq!((fault.line, fault.message.contains("-1")), (Some(5), true));
        let fault = parse("radius_mm = 3\nsegments = 3\nchord_mm = 0.1").unwrap_err();
        assert_eq!((fault.line, fault.message.contains("give one of them")), (Some(7), true));
    }
}
