//! The picture of `crates/README.md`, as a list of arrows.

use std::collections::BTreeSet;
use std::fmt;

/// One crate may use another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Arrow {
    pub(crate) from: String,
    pub(crate) to: String,
}

impl fmt::Display for Arrow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} -> {}", self.from, self.to)
    }
}

/// What the page draws: its crates and its arrows.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Picture {
    pub(crate) crates: BTreeSet<String>,
    pub(crate) arrows: BTreeSet<Arrow>,
}

/// The fence that opens the picture.
const FENCE: &str = "```crates";

/// Reads the block that [`FENCE`] opens: lines `from -> to, to`, `from ->` for a crate that uses none.
///
/// # Errors
/// No such block, or a line that is no arrow.
pub(crate) fn read(page: &str) -> Result<Picture, String> {
    let after = page.split_once(FENCE).ok_or(format!("no block {FENCE}"))?.1;
    let block = after.split_once("```").ok_or("the block does not end")?.0;
    let mut picture = Picture::default();
    for line in block.lines().filter(|line| !line.trim().is_empty()) {
        let (from, targets) = line.split_once("->").ok_or(format!("no arrow in `{line}`"))?;
        let from = from.trim().to_owned();
        let targets = targets.split(',').map(str::trim).filter(|to| !to.is_empty());
        picture.arrows.extend(targets.map(|to| Arrow { from: from.clone(), to: to.to_owned() }));
        picture.crates.insert(from);
    }
    Ok(picture)
}

/// Differences between what is drawn and what is there; empty when the page is true.
pub(crate) fn differences(drawn: &Picture, there: &Picture) -> Vec<String> {
    let undrawn = there.arrows.difference(&drawn.arrows).map(|a| format!("{a} is there and is not drawn"));
    let absent = drawn.arrows.difference(&there.arrows).map(|a| format!("{a} is drawn and is not there"));
    let missing = there.crates.difference(&drawn.crates).map(|c| format!("crate {c} is not drawn"));
    let ghosts =
        drawn.crates.difference(&there.crates).map(|c| format!("crate {c} is drawn and is not there"));
    undrawn.chain(absent).chain(missing).chain(ghosts).collect()
}
