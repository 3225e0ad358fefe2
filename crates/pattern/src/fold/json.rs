//! Typed looks into the JSON of a FOLD file; faults name the key and the index ("edges_vertices[12]").

use crate::PatternError;
use crate::error::{Place, issue, utf8};
use crate::lines::LARGEST;
use serde_json::{Map, Value};
use softfold_geometry::{Issue, Severity};

/// What to do with a file whose structure is broken.
const MEND: &str = "export the pattern again, or correct this entry";

/// The file's JSON object.
///
/// # Errors
/// Bytes that are no text, an empty file, no JSON, no object.
pub(super) fn parse(bytes: &[u8]) -> Result<Map<String, Value>, PatternError> {
    let text = utf8(bytes)?;
    let refuse = |what: String, line: usize| {
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        PatternError::Malformed(issue(Severity::Error, what, "export the pattern again").line(line))
    };
    if text.trim().is_empty() {
        return Err(refuse("the file is empty".to_owned(), 1));
    }
    match serde_json::from_str(text) {
        Ok(Value::Object(object)) => Ok(object),
        Ok(other) => Err(refuse(format!("the file is {}, not a FOLD object", kind(&other)), 1)),
        Err(e) => Err(refuse(format!("the file is not JSON: {e}"), e.line())),
    }
}

/// An issue about an entry of the file.
pub(super) fn told(
    severity: Severity,
    entry: &str,
    what: impl Into<String>,
    mend: impl Into<String>,
) -> Issue {
    Issue { element: Some(entry.to_owned()), ..issue(severity, what, mend) }
}

/// The structure of an entry is wrong.
pub(super) fn malformed(entry: &str, what: impl Into<String>) -> PatternError {
    PatternError::Malformed(told(Severity::Error, entry, what, MEND))
}

/// A number of an entry is none, or out of range.
pub(super) fn number_fault(entry: &str, what: impl Into<String>) -> PatternError {
    PatternError::Number(told(Severity::Error, entry, what, MEND))
}

/// What a value is, for messages.
pub(super) fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(b) => b.to_string(),
        Value::Number(n) => format!("the number {n}"),
        Value::String(s) => format!("the text \"{}\"", crate::lines::short(s)),
        Value::Array(a) => format!("a list of {}", a.len()),
        Value::Object(_) => "an object".to_owned(),
    }
}

/// A list.
pub(super) fn list(value: &Value, entry: impl Fn() -> String) -> Result<&[Value], PatternError> {
    let fault = || malformed(&entry(), format!("it is {}, not a list", kind(value)));
    value.as_array().map(Vec::as_slice).ok_or_else(fault)
}

/// A finite number, at most [`LARGEST`].
pub(super) fn number(value: &Value, entry: impl Fn() -> String) -> Result<f64, PatternError> {
    match value.as_f64().filter(|x| x.is_finite()) {
        Some(x) if x.abs() <= LARGEST => Ok(x),
        Some(x) => Err(number_fault(&entry(), format!("{x:e} is beyond {LARGEST:e}"))),
        None => Err(number_fault(&entry(), format!("it is {}, not a finite number", kind(value)))),
    }
}

/// A whole number below `count`; 2.0 is one too.
pub(super) fn index(
    value: &Value,
    count: usize,
    what: &str,
    entry: impl Fn() -> String,
) -> Result<usize, PatternError> {
    let whole = value.as_u64().or_else(|| {
        value
            .as_f64()
            .filter(|x| x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(x))
            .map(|x| x as u64)
    });
    match whole.and_then(|i| usize::try_from(i).ok()) {
        Some(i) if i < count => Ok(i),
        Some(i) => Err(number_fault(&entry(), format!("it names {what} {i}, but there are {count}"))),
        None => Err(number_fault(&entry(), format!("it is {}, not the number of a {what}", kind(value)))),
    }
}
