//! Every check of the project, the cheap ones first.

use crate::chore::{Chores, Failure, cargo};
use crate::{outside, packages};

/// Formatting, packages, outside readers, clippy, tests.
///
/// # Errors
/// The first check that fails.
pub(crate) fn run(chores: &mut Chores) -> Result<(), Failure> {
    packages::require_components()?;
    chores.run("formatting", cargo(&["fmt", "--all", "--check"]), "Run: cargo fmt --all")?;
    packages::install(chores)?;
    outside::prepare(chores)?;
    let clippy = cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]);
    chores.run("clippy", clippy, "The first message above names the line.")?;
    let mut tests = cargo(&["test", "--workspace", "--no-fail-fast"]);
    tests.env("SOFTFOLD_READERS", "required");
    chores.run("tests", tests, "The names of the tests that failed are listed above.")
}
