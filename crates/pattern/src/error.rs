//! Why a file gives no pattern, and short ways to make an issue.

use softfold_geometry::{DVec2, Issue, Severity};

/// Why a file gives no pattern. Every case carries what was found, the element, its line, the place
/// on the sheet where there is one, and the mend.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatternError {
    /// The text is empty, no XML, or no SVG.
    #[error("{0}")]
    Malformed(Issue),
    /// The drawing has no size, so its lengths mean nothing.
    #[error("{0}")]
    NoSize(Issue),
    /// Nothing is drawn.
    #[error("{0}")]
    Nothing(Issue),
    /// A number of an element is none, or not finite.
    #[error("{0}")]
    Number(Issue),
    /// The outline is missing, open, or crosses itself or a hole.
    #[error("{0}")]
    Outline(Issue),
    /// A crease leaves the sheet, or cannot be a curve.
    #[error("{0}")]
    Crease(Issue),
    /// Two creases meet or cross.
    #[error("{0}")]
    Junction(Issue),
}

impl PatternError {
    /// What was found, where, and the mend.
    pub fn issue(&self) -> &Issue {
        match self {
            Self::Malformed(i)
            | Self::NoSize(i)
            | Self::Nothing(i)
            | Self::Number(i)
            | Self::Outline(i)
            | Self::Crease(i)
            | Self::Junction(i) => i,
        }
    }
}

/// An issue without a place.
pub(crate) fn issue(severity: Severity, message: impl Into<String>, mend: impl Into<String>) -> Issue {
    Issue { severity, message: message.into(), element: None, line: None, position: None, mend: mend.into() }
}

/// Where an issue is, added to it.
pub(crate) trait Place {
    /// In this element and on this line.
    fn of(self, origin: &Origin) -> Self;
    /// On this line of the file.
    fn line(self, line: u32) -> Self;
    /// At this place on the sheet.
    fn at(self, position: DVec2) -> Self;
}

impl Place for Issue {
    fn of(mut self, origin: &Origin) -> Self {
        self.element = Some(origin.label.clone());
        self.line = Some(origin.line);
        self
    }

    fn line(mut self, line: u32) -> Self {
        self.line = Some(line);
        self
    }

    fn at(mut self, position: DVec2) -> Self {
        self.position = Some(position);
        self
    }
}

/// The element that something came from.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Origin {
    /// Its id, or its kind and number among its kind ("path 3").
    pub(crate) label: String,
    /// Its own id.
    pub(crate) id: Option<String>,
    /// Its line in the file, from 1.
    pub(crate) line: u32,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "'{}' (line {})", self.label, self.line)
    }
}

/// The first few elements by name, and how many more there are.
pub(crate) fn list(origins: &[Origin]) -> String {
    const SHOWN: usize = 8;
    let mut names: Vec<String> = origins.iter().take(SHOWN).map(ToString::to_string).collect();
    if origins.len() > SHOWN {
        names.push(format!("and {} more", origins.len() - SHOWN));
    }
    names.join(", ")
}
