//! Why a run ends early: one message, and whose fault it is.

use softfold_geometry::Issue;
use std::path::Path;

/// Why a run ends early.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RunError {
    /// The user's input cannot be used: exit status 1.
    #[error("{0}")]
    Input(String),
    /// softfold broke its own rules: exit status 70.
    #[error("{0} (this is a defect of softfold: please report it with the project)")]
    Defect(String),
}

impl RunError {
    /// Input at fault, with its file.
    pub fn in_file(path: &Path, line: Option<usize>, message: impl std::fmt::Display) -> Self {
        match line {
            Some(line) => Self::Input(format!("{}:{line}: {message}", path.display())),
            None => Self::Input(format!("{}: {message}", path.display())),
        }
    }

    /// An issue of a pattern, with its file.
    pub fn from_issue(path: &Path, issue: &Issue) -> Self {
        let mut bare = issue.clone();
        bare.line = None;
        Self::in_file(path, issue.line.map(|l| l as usize), bare)
    }

    /// Exit status of the program.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 1,
            Self::Defect(_) => 70,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use softfold_geometry::{DVec2, Severity};

    #[test]
    fn an_issue_becomes_one_line_with_file_line_element_place_and_mend() {
        let issue = Issue {
            severity: Severity::Error,
            message: "is open".into(),
            element: Some("outline".into()),
            line: Some(7),
            position: Some(DVec2::new(1.0, 2.5)),
            mend: "close it".into(),
        };
        let error = RunError::from_issue(Path::new("a/p.svg"), &issue);
        assert_eq!(error.to_string(), "a/p.svg:7: outline: is open at (1.000, 2.500) mm; close it");
        assert_eq!(error.exit_code(), 1);
    }
}
