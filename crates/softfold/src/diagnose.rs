//! Issues of a user's file as they are shown on a terminal: the line of the file, what was found, the mend.

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents,
    Severity, SourceCode, SourceSpan, SpanContents,
};
use softfold_geometry::Issue;
use std::fmt;

/// Longest part of a line that is shown, characters: drawing programs write files of a single line.
const LONGEST_LINE: usize = 110;

/// One issue with the line of the file that it is about.
#[derive(Debug)]
struct Shown {
    issue: Issue,
    line: Option<Line>,
}

/// A line of the file.
#[derive(Debug)]
struct Line {
    name: String,
    number: u32,
    text: String,
}

/// The issue as text: several lines with the place in the file, in colour if asked for.
pub fn show(issue: &Issue, file_name: &str, text: &str, colour: bool) -> String {
    let line = issue.line.and_then(|number| {
        let text = text.lines().nth(number as usize - 1)?;
        let text: String = text.trim().chars().take(LONGEST_LINE).collect();
        (!text.is_empty()).then(|| Line { name: file_name.to_owned(), number, text })
    });
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let mut out = String::new();
    let shown = Shown { issue: issue.clone(), line };
    // Writing to a string cannot fail; what was written by then is better than nothing.
    let _ = GraphicalReportHandler::new_themed(theme).with_links(false).render_report(&mut out, &shown);
    out.trim_end().to_owned()
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.issue.message)?;
        match self.issue.position {
            Some(p) => write!(f, " at ({:.3}, {:.3}) mm", p.x, p.y),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Shown {}

impl Diagnostic for Shown {
    fn severity(&self) -> Option<Severity> {
        use softfold_geometry::Severity as Ours;
        Some(match self.issue.severity {
            Ours::Note => Severity::Advice,
            Ours::Warning => Severity::Warning,
            Ours::Error => Severity::Error,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        (!self.issue.mend.is_empty()).then(|| Box::new(&self.issue.mend) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.line.as_ref().map(|l| l as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let line = self.line.as_ref()?;
        let label = LabeledSpan::new(self.issue.element.clone(), 0, line.text.len());
        Some(Box::new(std::iter::once(label)))
    }
}

impl SourceCode for Line {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        _: usize,
        _: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let line = self.number as usize - 1;
        let name = self.name.clone();
        Ok(Box::new(MietteSpanContents::new_named(name, self.text.as_bytes(), *span, line, 0, 1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use softfold_geometry::{DVec2, Severity};

    #[test]
    fn an_issue_is_shown_with_its_line_element_place_and_mend() {
        let issue = Issue {
            severity: Severity::Warning,
            message: "the crease ended 0.200 mm before the boundary; it was extended".into(),
            element: Some("crease 'a'".into()),
            line: Some(3),
            position: Some(DVec2::new(1.0, 2.5)),
            mend: "end the crease on the outline".into(),
        };
        let text = "<svg>\n<g>\n  <path id=\"a\" d=\"M0 0 L10 10\"/>\n</g>\n</svg>";
        let shown = show(&issue, "p.svg", text, false);
        for part in
            ["p.svg:3", "(1.000, 2.500) mm", "<path id=\"a\"", "crease 'a'", "end the crease on the outline"]
        {
            assert!(shown.contains(part), "{part} in\n{shown}");
        }
    }

    #[test]
    fn a_line_that_the_file_does_not_have_is_left_out_and_a_long_one_is_cut() {
        let mut issue = Issue {
            severity: Severity::Note,
            message: "m".into(),
            element: None,
            line: Some(9),
            position: None,
            mend: String::new(),
        };
        assert!(show(&issue, "p.svg", "one line", false).contains('m'));
        issue.line = Some(1);
        let long = "ä".repeat(5000);
        assert!(show(&issue, "p.svg", &long, false).chars().count() < 800);
    }
}
