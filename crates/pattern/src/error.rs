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
    /// More lines, or more places where they meet, than any pattern has.
    #[error("{0}")]
    TooMuch(Issue),
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
            | Self::TooMuch(i) => i,
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
    /// On this line of the file, if known.
    fn of_line(self, line: Option<u32>) -> Self;
    /// At this place on the sheet.
    fn at(self, position: DVec2) -> Self;
}

impl Place for Issue {
    fn of(mut self, origin: &Origin) -> Self {
        self.element = Some(origin.label.clone());
        self.line = origin.line;
        self
    }

    fn line(mut self, line: u32) -> Self {
        self.line = Some(line);
        self
    }

    fn of_line(mut self, line: Option<u32>) -> Self {
        self.line = line;
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
    /// Its line in the file, from 1, where the format has lines.
    pub(crate) line: Option<u32>,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.line {
            Some(line) => write!(f, "'{}' (line {line})", self.label),
            None => write!(f, "'{}'", self.label),
        }
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

/// The text of a file.
///
/// # Errors
/// Bytes that are no UTF-8, with their line.
pub(crate) fn utf8(bytes: &[u8]) -> Result<&str, PatternError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|e| {
        let line = bytes[..e.valid_up_to()].iter().filter(|b| **b == b'\n').count() + 1;
        let what = "the file is no text in UTF-8";
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        PatternError::Malformed(issue(Severity::Error, what, "save it as UTF-8").line(line))
    })
}
