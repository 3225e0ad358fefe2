//! Every check of the project, the cheap ones first.

use crate::chore::{Chores, Failure, cargo};
use crate::{outside, packages};

/// What proptest draws its cases from.
const RANDOM_SEED: &str = "PROPTEST_RNG_SEED";

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
    // The same random cases each time, so that a failure is of the change; another seed draws others.
    if std::env::var_os(RANDOM_SEED).is_none() {
        tests.env(RANDOM_SEED, "20260515");
    }
    chores.run("tests", tests, "The names of the tests that failed are listed above.")
}
