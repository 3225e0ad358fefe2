//! Group codes and values, which DXF files are made of: as text, two lines each, or binary.
//!
//! Source: Autodesk, "DXF Reference", chapters "Group Codes" and "ASCII and Binary DXF Formats".

use crate::PatternError;
use crate::error::{Place, issue};
use softfold_geometry::Severity;

/// How a binary file begins.
const BINARY: &[u8] = b"AutoCAD Binary DXF\r\n\x1a\0";
/// How it begins after a program that took it for text has changed its line ends.
const BINARY_CHANGED: &[u8] = b"AutoCAD Binary DXF\n\x1a\0";
/// Group code of a comment.
const COMMENT: i32 = 999;
/// In binary files before R13 codes are bytes; this one says that two bytes follow.
const LONG_CODE: u8 = 255;

/// A value as the file holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value<'a> {
    /// Text, without the spaces around it; numbers too, in text files.
    Text(&'a [u8]),
    /// A number of a binary file.
    Real(f64),
    /// A whole number of a binary file.
    Integer(i64),
}

/// A group: code and value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tag<'a> {
    /// What the value means.
    pub(super) code: i32,
    /// The value.
    pub(super) value: Value<'a>,
    /// Line of the value, from 1; none in binary files.
    pub(super) line: Option<u32>,
}

impl<'a> Tag<'a> {
    /// The bytes of a text; empty for numbers of binary files.
    pub(super) fn bytes(&self) -> &'a [u8] {
        match self.value {
            Value::Text(bytes) => bytes,
            _ => b"",
        }
    }

    /// The value as a finite number.
    pub(super) fn real(&self) -> Option<f64> {
        let value = match self.value {
            Value::Text(bytes) => std::str::from_utf8(bytes).ok()?.parse().ok()?,
            Value::Real(value) => value,
            Value::Integer(value) => value as f64,
        };
        value.is_finite().then_some(value)
    }

    /// The value as a whole number; some programs write `4.0`.
    pub(super) fn integer(&self) -> Option<i64> {
        match self.value {
            Value::Integer(value) => Some(value),
            Value::Text(bytes) => match std::str::from_utf8(bytes).ok()?.parse() {
                Ok(value) => Some(value),
                Err(_) => self.whole(),
            },
            Value::Real(_) => self.whole(),
        }
    }

    fn whole(&self) -> Option<i64> {
        self.real().filter(|v| v.fract() == 0.0 && v.abs() < 1e15).map(|v| v as i64)
    }

    /// The value as it is shown to the user.
    pub(super) fn shown(&self) -> String {
        match self.value {
            Value::Text(bytes) => String::from_utf8_lossy(bytes).into_owned(),
            Value::Real(value) => value.to_string(),
            Value::Integer(value) => value.to_string(),
        }
    }

    fn is(&self, code: i32, text: &[u8]) -> bool {
        self.code == code && self.bytes() == text
    }
}

/// All groups of a file but its comments.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tags<'a> {
    /// The groups up to `EOF`.
    pub(super) list: Vec<Tag<'a>>,
    /// Whether `EOF` was there.
    pub(super) complete: bool,
    /// Whether a binary file's line ends were changed.
    pub(super) changed: bool,
}

/// The groups of a file.
///
/// # Errors
/// What is no group, with its line.
pub(super) fn read(bytes: &[u8]) -> Result<Tags<'_>, PatternError> {
    if let Some(rest) = bytes.strip_prefix(BINARY) {
        return read_binary(rest);
    }
    match bytes.strip_prefix(BINARY_CHANGED) {
        Some(rest) => Ok(Tags { changed: true, ..read_binary(rest)? }),
        None => read_text(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
    }
}

fn malformed(what: String, line: Option<u32>) -> PatternError {
    let mend = "save the drawing again as DXF, R12 or R2000";
    PatternError::Malformed(issue(Severity::Error, what, mend).of_line(line))
}

fn read_text(bytes: &[u8]) -> Result<Tags<'_>, PatternError> {
    if bytes.trim_ascii().is_empty() {
        return Err(malformed("the file is empty".to_owned(), Some(1)));
    }
    // Line ends: LF, CR LF, or CR alone in very old files.
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    let mut lines = (1_u32..).zip(bytes.split(move |b| *b == end));
    let mut tags = Tags::default();
    while let Some((line, code)) = lines.next() {
        let Some(code) = text_code(code) else {
            if code.trim_ascii().is_empty() && lines.all(|(_, rest)| rest.trim_ascii().is_empty()) {
                break;
            }
            return Err(malformed(no_code(code, tags.list.is_empty()), Some(line)));
        };
        let Some((line, value)) = lines.next() else { break };
        let tag = Tag { code, value: Value::Text(value.trim_ascii()), line: Some(line) };
        if tags.push(tag) {
            break;
        }
    }
    Ok(tags)
}

fn text_code(line: &[u8]) -> Option<i32> {
    std::str::from_utf8(line.trim_ascii()).ok()?.parse().ok()
}

fn no_code(line: &[u8], first: bool) -> String {
    const SHOWN: usize = 40;
    let line = line.trim_ascii();
    let shown = String::from_utf8_lossy(&line[..line.len().min(SHOWN)]);
    let shown: String = shown.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
    match first {
        true => format!("the file is not DXF: it begins with \"{shown}\", not with a group code"),
        false => format!("\"{shown}\" stands where a group code belongs"),
    }
}

impl<'a> Tags<'a> {
    /// Adds a group; whether it was the last one of the file.
    fn push(&mut self, tag: Tag<'a>) -> bool {
        self.complete = tag.is(0, b"EOF");
        if !self.complete && tag.code != COMMENT {
            self.list.push(tag);
        }
        self.complete
    }
}

fn read_binary(bytes: &[u8]) -> Result<Tags<'_>, PatternError> {
    // The first group is 0 SECTION: after two zero bytes, codes have two bytes.
    let mut input = Binary { rest: bytes, wide: bytes.starts_with(&[0, 0]) };
    let mut tags = Tags::default();
    while !input.rest.is_empty() {
        let at = BINARY.len() + bytes.len() - input.rest.len();
        let Some(code) = input.code() else { break };
        let kind = Kind::of(code)
            .ok_or_else(|| malformed(format!("the group code {code} at byte {at} does not exist"), None))?;
        let Some(value) = input.value(kind) else { break };
        if tags.push(Tag { code, value, line: None }) {
            break;
        }
    }
    Ok(tags)
}

/// How a value is stored in a binary file.
#[derive(Clone, Copy)]
enum Kind {
    Text,
    Real,
    /// A whole number of so many bytes.
    Integer(usize),
    /// A byte with a length, and so many bytes.
    Chunk,
}

impl Kind {
    fn of(code: i32) -> Option<Self> {
        Some(match code {
            310..=319 | 1004 => Self::Chunk,
            0..=9
            | 100..=109
            | 300..=309
            | 320..=369
            | 390..=399
            | 410..=419
            | 430..=439
            | 470..=481
            | 999..=1009 => Self::Text,
            10..=59 | 110..=149 | 210..=239 | 460..=469 | 1010..=1059 => Self::Real,
            60..=79 | 170..=179 | 270..=289 | 370..=389 | 400..=409 | 1060..=1070 => Self::Integer(2),
            90..=99 | 420..=429 | 440..=459 | 1071 => Self::Integer(4),
            160..=169 => Self::Integer(8),
            290..=299 => Self::Integer(1),
            _ => return None,
        })
    }
}

/// What is left of a binary file.
struct Binary<'a> {
    rest: &'a [u8],
    wide: bool,
}

impl<'a> Binary<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }

    /// A little-endian whole number of up to eight bytes, the last one signed.
    fn integer(&mut self, count: usize) -> Option<i64> {
        let bytes = self.take(count)?;
        let negative = count > 1 && bytes.last().is_some_and(|b| *b >= 0x80);
        let mut all = [if negative { 0xff } else { 0 }; 8];
        all.get_mut(..count)?.copy_from_slice(bytes);
        Some(i64::from_le_bytes(all))
    }

    fn code(&mut self) -> Option<i32> {
        if self.wide {
            return self.integer(2)?.try_into().ok();
        }
        match self.integer(1)? {
            code if code == i64::from(LONG_CODE) => self.integer(2)?.try_into().ok(),
            code => code.try_into().ok(),
        }
    }

    fn value(&mut self, kind: Kind) -> Option<Value<'a>> {
        Some(match kind {
            Kind::Text => {
                let length = self.rest.iter().position(|b| *b == 0)?;
                let text = self.take(length)?;
                self.take(1)?;
                Value::Text(text.trim_ascii())
            }
            Kind::Real => Value::Real(f64::from_bits(self.integer(8)? as u64)),
            Kind::Integer(count) => Value::Integer(self.integer(count)?),
            Kind::Chunk => {
                let length = usize::try_from(self.integer(1)?).ok()?;
                Value::Text(self.take(length)?)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tag(code: i32, text: &str, line: u32) -> Tag<'_> {
        Tag { code, value: Value::Text(text.as_bytes()), line: Some(line) }
    }

    #[test]
    fn text_files_have_lines_and_no_comments() {
        let expected = vec![tag(0, "SECTION", 4), tag(10, "1.5", 6)];
        for end in ["\n", "\r\n", "\r"] {
            let text = "999\nhello\n  0\nSECTION\n 10\n  1.5\n0\nEOF\nrubbish".replace('\n', end);
            let tags = read(text.as_bytes()).unwrap();
            assert_eq!((tags.list, tags.complete), (expected.clone(), true));
        }
        assert_eq!(expected[1].real(), Some(1.5));
        assert!(!read(b"0\nSECTION\n0\nENDSEC\n\n").unwrap().complete, "EOF is missing");
    }

    #[test]
    fn numbers_are_finite_or_none() {
        for (text, value) in
            [("1e3", Some(1000.0)), ("-.5", Some(-0.5)), ("2,5", None), ("inf", None), ("1e999", None)]
        {
            assert_eq!(tag(10, text, 1).real(), value, "{text}");
        }
        assert_eq!(tag(70, "4.0", 1).integer(), Some(4));
        assert_eq!(tag(70, "4.5", 1).integer(), None);
    }

    #[test]
    fn what_is_no_group_is_refused_with_its_line() {
        for (text, line, part) in [
            (&b" \n"[..], 1, "empty"),
            (b"<svg>", 1, "not DXF"),
            (b"0\nSECTION\nENTITIES\n2\n", 3, "ENTITIES"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.issue().line, Some(line));
            assert!(error.to_string().contains(part), "{error}");
        }
    }

    fn binary(wide: bool, groups: &[(i32, &[u8])]) -> Vec<u8> {
        let mut bytes = BINARY.to_vec();
        for (code, value) in groups {
            match (wide, *code < 255) {
                (true, _) => bytes.extend((*code as i16).to_le_bytes()),
                (false, true) => bytes.push(*code as u8),
                (false, false) => {
                    bytes.push(LONG_CODE);
                    bytes.extend((*code as i16).to_le_bytes());
                }
            }
            bytes.extend(*value);
        }
        bytes
    }

    #[test]
    fn binary_files_of_both_kinds_are_read() {
        let real = (-2.5_f64).to_le_bytes();
        let groups: [(i32, &[u8]); 6] = [
            (0, b"SECTION\0"),
            (10, &real),
            (62, &(-3_i16).to_le_bytes()),
            (310, &[2, 0, 7]),
            (1071, &70000_i32.to_le_bytes()),
            (0, b"EOF\0"),
        ];
        for wide in [false, true] {
            let bytes = binary(wide, &groups);
            let tags = read(&bytes).unwrap();
            assert!(tags.complete);
            assert_eq!(tags.list.iter().map(|t| t.code).collect::<Vec<_>>(), [0, 10, 62, 310, 1071]);
            assert_eq!(tags.list[1].real(), Some(-2.5));
            assert_eq!(tags.list[2].integer(), Some(-3));
            assert_eq!(tags.list[4].integer(), Some(70000));
            let changed: Vec<u8> = [BINARY_CHANGED, &bytes[BINARY.len()..]].concat();
            assert_eq!(read(&changed).unwrap(), Tags { changed: true, ..tags });
            for cut in BINARY.len()..bytes.len() {
                assert!(!read(&bytes[..cut]).unwrap().complete);
            }
        }
        assert!(read(&binary(true, &[(0, b"SECTION\0"), (85, b"")])).is_err(), "no such code");
    }
}
