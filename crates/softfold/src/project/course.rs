//! `[fold.self_collision]`, `[[fold.schedule]]` and `[fold.release]`: how folding goes on, and what it ends with.

use super::ProjectFault;
use super::number::{Number, Range, line_of_entry, line_of_header};
use serde::Deserialize;
use std::collections::BTreeMap;

/// `[fold.self_collision]`: the sheet keeps its thickness from itself.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SelfCollision {
    /// Whether it does.
    pub on: bool,
    /// Least distance, mm; the board's thickness if absent.
    pub thickness_mm: Option<f64>,
    /// How far beyond it the sheet begins to push, mm; a quarter of it if absent.
    pub reach_mm: Option<f64>,
    /// How hard, N·mm; the sheet's bending stiffness if absent.
    pub stiffness: Option<f64>,
}

impl Default for SelfCollision {
    fn default() -> Self {
        Self { on: true, thickness_mm: None, reach_mm: None, stiffness: None }
    }
}

/// `[[fold.schedule]]`: a state on the way.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Its name; its percentage if absent.
    pub name: Option<String>,
    /// How far creases are folded, % of their angles.
    pub percent: f64,
    /// The same by crease.
    #[serde(default)]
    pub creases: BTreeMap<String, f64>,
}

/// `[fold.release]`: holds are let go, and creases spring back.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Release {
    /// Share of its reached turn that a crease keeps.
    pub plastic_set: f64,
    /// The same by crease.
    #[serde(default)]
    pub creases: BTreeMap<String, f64>,
    /// Names of the holds that stay.
    #[serde(default)]
    pub keep: Vec<String>,
}

impl SelfCollision {
    pub(super) fn numbers(&self) -> Vec<Number> {
        let n = |key, v: Option<f64>| v.map(|v| Number::new("fold.self_collision", key, v, Range::Positive));
        [n("thickness_mm", self.thickness_mm), n("reach_mm", self.reach_mm), n("stiffness", self.stiffness)]
            .into_iter()
            .flatten()
            .collect()
    }
}

impl Step {
    /// How far a crease is folded, as share of its angle.
    pub fn share(&self, crease: &str) -> f64 {
        self.creases.get(crease).copied().unwrap_or(self.percent) / 100.0
    }

    /// Its name, or its percentage.
    pub fn title(&self) -> String {
        self.name.clone().unwrap_or_else(|| format!("{} %", self.percent))
    }

    /// Whether all percentages are from 0 to 100.
    pub(super) fn check(&self, text: &str, index: usize) -> Result<(), ProjectFault> {
        let bad =
            std::iter::once(&self.percent).chain(self.creases.values()).find(|p| !(0.0..=100.0).contains(*p));
        let Some(bad) = bad else { return Ok(()) };
        let line = line_of_entry(text, "fold.schedule", index);
        let message = format!("[[fold.schedule]] '{}': {bad} % is none; give 0 to 100", self.title());
        Err(ProjectFault { line, message })
    }
}

impl Release {
    /// Share of its reached turn that a crease keeps.
    pub fn share(&self, crease: &str) -> f64 {
        self.creases.get(crease).copied().unwrap_or(self.plastic_set)
    }

    pub(super) fn check(&self, text: &str) -> Result<(), ProjectFault> {
        let bad = std::iter::once(&self.plastic_set)
            .chain(self.creases.values())
            .find(|p| !(0.0..=1.0).contains(*p));
        let Some(bad) = bad else { return Ok(()) };
        let message =
            format!("[fold.release]: a plastic set of {bad} is none; give 0 (elastic) to 1 (all is kept)");
        Err(ProjectFault { line: line_of_header(text, "fold.release"), message })
    }
}
