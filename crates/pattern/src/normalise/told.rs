//! What is said of a drawing on the way, and the errors that stop it at the end.

use crate::PatternError;
use crate::error::issue;
use softfold_geometry::{Issue, Severity};

/// Most issues of one kind that are told one by one.
const MAX_OF_KIND: usize = 50;

/// Issues and errors, in the order in which they arose.
#[derive(Debug)]
pub(super) struct Told<'a> {
    issues: &'a mut Vec<Issue>,
    errors: Vec<PatternError>,
}

impl<'a> Told<'a> {
    pub(super) fn new(issues: &'a mut Vec<Issue>) -> Self {
        Self { issues, errors: Vec::new() }
    }

    pub(super) fn push(&mut self, issue: Issue) {
        self.issues.push(issue);
    }

    /// Issues of one kind: the first ones, and how many more there are.
    pub(super) fn push_all(&mut self, mut issues: Vec<Issue>) {
        let more = issues.len().saturating_sub(MAX_OF_KIND);
        let last = issues.get(MAX_OF_KIND.saturating_sub(1)).map(|i| i.severity);
        issues.truncate(MAX_OF_KIND);
        self.issues.append(&mut issues);
        if let (Some(severity), 1..) = (last, more) {
            self.issues.push(issue(severity, format!("and {more} more of the same kind"), ""));
        }
    }

    /// An error: no pattern will be made, but what else is wrong is still looked for.
    pub(super) fn refuse(&mut self, error: PatternError) {
        if self.errors.len() < MAX_OF_KIND {
            self.issues.push(error.issue().clone());
        }
        self.errors.push(error);
    }

    /// A note.
    pub(super) fn note(&mut self, message: String) {
        self.issues.push(issue(Severity::Note, message, ""));
    }

    /// The first error, if there is any.
    ///
    /// # Errors
    /// That one.
    pub(super) fn verdict(&mut self) -> Result<(), PatternError> {
        if self.errors.is_empty() { Ok(()) } else { Err(self.errors.remove(0)) }
    }
}
