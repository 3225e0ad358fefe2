//! Numbers of a project file in their ranges, and the lines on which they stand.

use super::ProjectFault;

/// The element that decides whether all are positive: the least, or one that is not finite.
pub(super) fn least(values: &[f64]) -> f64 {
    values
        .iter()
        .copied()
        .find(|v| !v.is_finite())
        .unwrap_or_else(|| values.iter().copied().fold(f64::MAX, f64::min))
}

pub(super) fn finite(values: &[f64]) -> bool {
    values.iter().all(|v| v.is_finite())
}

/// Line of a table's header, from 1.
pub fn line_of_header(text: &str, table: &str) -> Option<usize> {
    text.lines().position(|l| l.trim().starts_with(&format!("[{table}]"))).map(|i| i + 1)
}

/// Line of the `index`-th table of an array of tables, from 1.
pub fn line_of_entry(text: &str, array: &str, index: usize) -> Option<usize> {
    let header = format!("[[{array}]]");
    text.lines().enumerate().filter(|(_, l)| l.trim().starts_with(&header)).nth(index).map(|(i, _)| i + 1)
}

/// A fault in the `index`-th table of an array of tables.
pub(super) fn entry(
    fine: bool,
    text: &str,
    array: &str,
    index: usize,
    name: &str,
    mend: &str,
) -> Result<(), ProjectFault> {
    if fine {
        return Ok(());
    }
    let line = line_of_entry(text, array, index);
    Err(ProjectFault { line, message: format!("[[{array}]] '{name}': {mend}") })
}

/// What a number must be.
#[derive(Clone, Copy)]
pub(super) enum Range {
    Positive,
    NotNegative,
    AtLeastOne,
    /// Rounds of an iteration: more than a thousand change nothing but the time.
    Rounds,
    /// A thickness: below a hundredth of a millimetre solids drown in rounding.
    Thick,
    Finite,
    /// From 0 to below 1.
    Share,
    /// Above 0, at most 100.
    Percent,
    /// Poisson's ratio: below a half, or the sheet is incompressible.
    Fraction,
}

pub(super) struct Number {
    table: String,
    key: &'static str,
    value: f64,
    range: Range,
}

impl Number {
    pub(super) fn new(table: &str, key: &'static str, value: f64, range: Range) -> Self {
        Self { table: table.to_owned(), key, value, range }
    }

    pub(super) fn check(&self, text: &str) -> Result<(), ProjectFault> {
        let v = self.value;
        let (fine, wanted) = match self.range {
            Range::Positive => (v > 0.0 && v.is_finite(), "a positive number"),
            Range::NotNegative => (v >= 0.0 && v.is_finite(), "a number that is not negative"),
            Range::AtLeastOne => (v >= 1.0, "1 or more"),
            Range::Rounds => ((0.0..=1000.0).contains(&v), "a number from 0 to 1000"),
            Range::Thick => (v >= 0.01 && v.is_finite(), "a positive number, 0.01 or more"),
            Range::Finite => (v.is_finite(), "a finite number"),
            Range::Share => ((0.0..1.0).contains(&v), "a number from 0 to below 1"),
            Range::Percent => (v > 0.0 && v <= 100.0, "a number above 0, at most 100"),
            Range::Fraction => ((0.0..0.5).contains(&v), "a number from 0 to below 0.5"),
        };
        if fine {
            return Ok(());
        }
        let name =
            if self.table.is_empty() { self.key.to_owned() } else { format!("{}.{}", self.table, self.key) };
        let message = format!("{name} is {v}; give {wanted}");
        Err(ProjectFault { line: line_of(text, &self.table, self.key), message })
    }
}

/// A fault of the TOML itself, with the key that stands on its line.
pub(super) fn fault_of(text: &str, error: &toml::de::Error) -> ProjectFault {
    let said = error.message().replace('\n', ", ");
    let line = error.span().filter(|s| s.end > 0).map(|s| line_at(text, s.start));
    let key =
        line.and_then(|l| text.lines().nth(l - 1)).and_then(|l| l.split_once('=')).map(|(k, _)| k.trim());
    let message = match key.filter(|k| !k.starts_with('#') && !said.contains(k)) {
        Some(key) => format!("{key}: {said}"),
        None => said,
    };
    ProjectFault { line, message }
}

fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|b| *b == b'\n').count()
}

/// Line of a key in a table of a TOML text, from 1; a plain scan, good enough for messages.
pub fn line_of(text: &str, table: &str, key: &str) -> Option<usize> {
    let mut current = String::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(header) = line.strip_prefix('[') {
            current = header.split(']').next().unwrap_or_default().replace('"', "");
        } else if current == table && line.split('=').next().is_some_and(|k| k.trim() == key) {
            return Some(i + 1);
        }
    }
    None
}
