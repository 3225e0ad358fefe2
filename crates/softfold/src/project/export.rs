//! `[export]`: in which formats exact shapes are written.

use serde::Deserialize;
use softfold_kernel::occt::StepSchema;

/// A file format of exact shapes.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum ShapeFormat {
    /// STEP: names, colours, units, material.
    Step,
    /// IGES: names of eight characters, colours, units.
    Iges,
    /// OpenCascade's own: the bare shape.
    Brep,
}

impl ShapeFormat {
    /// How names of its files end.
    pub fn ending(self) -> &'static str {
        match self {
            ShapeFormat::Step => "step",
            ShapeFormat::Iges => "iges",
            ShapeFormat::Brep => "brep",
        }
    }
}

/// `export.step_schema`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Schema {
    /// AP242.
    #[default]
    Ap242,
    /// AP214, for older readers.
    Ap214,
}

impl Schema {
    /// The kernel's name for it.
    pub fn step(self) -> StepSchema {
        match self {
            Schema::Ap242 => StepSchema::Ap242,
            Schema::Ap214 => StepSchema::Ap214,
        }
    }
}

/// `[export]`
#[derive(Clone, Debug, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields, default)]
pub struct Export {
    /// Formats of sheet, board, mold and its parts.
    pub formats: Vec<ShapeFormat>,
    /// Application protocol of the STEP files.
    pub step_schema: Schema,
}

impl Default for Export {
    fn default() -> Self {
        Self { formats: vec![ShapeFormat::Step], step_schema: Schema::default() }
    }
}

impl Export {
    /// Whether files of this format are asked for.
    pub fn wants(&self, format: ShapeFormat) -> bool {
        self.formats.contains(&format)
    }
}
