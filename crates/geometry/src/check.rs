//! What `check()` says of a broken value, and what readers say of an imperfect file.

use glam::DVec2;

/// A value that breaks its own contract: a defect of softfold, not of the user's input.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{value}: {fault}")]
pub struct CheckError {
    /// The type that was checked.
    pub value: &'static str,
    /// What is wrong, with the element.
    pub fault: String,
}

impl CheckError {
    /// A fault of `value`.
    pub fn new(value: &'static str, fault: impl Into<String>) -> Self {
        Self { value, fault: fault.into() }
    }
}

/// How much an [`Issue`] matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Told for the record: nothing was changed.
    Note,
    /// Something was repaired, or looks unintended.
    Warning,
    /// The input cannot be used as it is.
    Error,
}

/// One remark about the user's input: what, where, and what to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Issue {
    /// How much it matters.
    pub severity: Severity,
    /// What was found.
    pub message: String,
    /// The element of the file: its id, or its kind and number.
    pub element: Option<String>,
    /// Line of the file, counted from 1.
    pub line: Option<u32>,
    /// Place on the sheet, (u, v) in mm.
    pub position: Option<DVec2>,
    /// What the user can do.
    pub mend: String,
}

impl std::fmt::Display for Issue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        if let Some(element) = &self.element {
            write!(f, "{element}: ")?;
        }
        write!(f, "{}", self.message)?;
        if let Some(p) = self.position {
            write!(f, " at ({:.3}, {:.3}) mm", p.x, p.y)?;
        }
        if !self.mend.is_empty() {
            write!(f, "; {}", self.mend)?;
        }
        Ok(())
    }
}
