//! The sections of a file: header, layers, blocks and entities.

use super::aci;
use super::fields::Fields;
use super::tags::{Tag, Tags};
use crate::PatternError;
use crate::error::{Origin, Place, issue};
use encoding_rs::Encoding;
use glam::DVec3;
use softfold_geometry::{Issue, Severity};
use std::collections::BTreeMap;

/// `LAYER` and `BLOCK` flag: frozen; and depends on another file.
const FROZEN: i64 = 1;
const EXTERNAL: i64 = 4 | 8;

/// What the header says.
#[derive(Clone, Debug, Default)]
pub(super) struct Header {
    /// `$INSUNITS`.
    pub(super) units: Option<i64>,
    /// Its line.
    pub(super) units_line: Option<u32>,
    /// `$MEASUREMENT`: 0 imperial, 1 metric.
    pub(super) measurement: Option<i64>,
    /// How text is to be read.
    pub(super) text: Text,
}

/// A layer.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    /// Its colour; none if its number is no colour.
    pub(super) rgb: Option<[u8; 3]>,
    /// Why its lines are not seen.
    pub(super) hidden: Option<&'static str>,
}

/// Something that is drawn.
#[derive(Clone, Debug)]
pub(super) struct Entity<'a> {
    /// Its kind, in capitals.
    pub(super) kind: String,
    /// Its label, handle and line.
    pub(super) origin: Origin,
    /// Its groups.
    pub(super) tags: &'a [Tag<'a>],
    /// The vertices of a POLYLINE.
    pub(super) vertices: Vec<&'a [Tag<'a>]>,
    /// Whether further vertices belong to it.
    open: bool,
}

/// A block.
#[derive(Clone, Debug)]
pub(super) struct Block<'a> {
    /// What comes to lie on the point of insertion.
    pub(super) base: DVec3,
    /// Whether it stands for another file.
    pub(super) external: bool,
    /// Its content.
    pub(super) entities: Vec<Entity<'a>>,
}

/// A file in its sections; layers and blocks by their names in small letters.
#[derive(Clone, Debug, Default)]
pub(super) struct Content<'a> {
    pub(super) header: Header,
    pub(super) layers: BTreeMap<String, Layer>,
    pub(super) blocks: BTreeMap<String, Block<'a>>,
    pub(super) entities: Vec<Entity<'a>>,
}

impl<'a> Content<'a> {
    /// Sorts the groups of a file.
    ///
    /// # Errors
    /// No section, or a number that is none.
    pub(super) fn read(tags: &'a Tags<'a>, issues: &mut Vec<Issue>) -> Result<Self, PatternError> {
        let mut reader = Reader::default();
        let mut sections = 0;
        for record in records(&tags.list) {
            match record.kind {
                b"SECTION" => {
                    sections += 1;
                    reader.begin(&record);
                }
                b"ENDSEC" => reader.section = b"",
                _ => reader.record(&record)?,
            }
        }
        if sections == 0 {
            let what = "the file is not DXF: it has no section";
            let mend = "save the drawing again as DXF, R12 or R2000";
            return Err(PatternError::Malformed(issue(Severity::Error, what, mend)));
        }
        if tags.changed {
            let what = "the line ends of this binary file were changed on its way, as if it were text; \
                numbers may be wrong";
            issues.push(issue(Severity::Warning, what, "copy the file again, as binary, or save it as text"));
        }
        if !tags.complete {
            let what = "the file does not end with EOF: it may be cut off, and lines may be missing";
            let line = tags.list.last().and_then(|t| t.line);
            issues.push(issue(Severity::Warning, what, "save or copy the file again").of_line(line));
        }
        Ok(reader.content)
    }
}

/// A group of code 0 and what follows.
struct Record<'a> {
    kind: &'a [u8],
    line: Option<u32>,
    tags: &'a [Tag<'a>],
}

fn records<'a>(tags: &'a [Tag<'a>]) -> impl Iterator<Item = Record<'a>> {
    let first = tags.iter().position(|t| t.code == 0).unwrap_or(tags.len());
    let rest = tags.get(first..).unwrap_or_default();
    rest.chunk_by(|_, next| next.code != 0).filter_map(|chunk| {
        let (head, tags) = chunk.split_first()?;
        Some(Record { kind: head.bytes(), line: head.line, tags })
    })
}

#[derive(Default)]
struct Reader<'a> {
    content: Content<'a>,
    section: &'a [u8],
    /// The block that is being read.
    block: Option<String>,
    /// How many of each kind came before, for the labels of those without handle.
    counts: BTreeMap<String, usize>,
}

impl<'a> Reader<'a> {
    fn begin(&mut self, record: &Record<'a>) {
        self.section = record.tags.iter().find(|t| t.code == 2).map_or(b"", Tag::bytes);
        self.block = None;
        if self.section == b"HEADER" {
            self.content.header = header(record.tags);
        }
    }

    fn record(&mut self, record: &Record<'a>) -> Result<(), PatternError> {
        match (self.section, record.kind) {
            (b"TABLES", b"LAYER") => self.layer(record),
            (b"BLOCKS", b"BLOCK") => self.block(record),
            (b"BLOCKS", b"ENDBLK") => {
                self.block = None;
                Ok(())
            }
            (b"BLOCKS" | b"ENTITIES", _) => {
                self.entity(record);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn name(&self, tags: &'a [Tag<'a>]) -> String {
        tags.iter().find(|t| t.code == 2).map_or_else(String::new, |t| self.content.header.text.of(t))
    }

    fn layer(&mut self, record: &Record<'a>) -> Result<(), PatternError> {
        let name = self.name(record.tags);
        let origin = Origin { label: format!("LAYER {name}"), id: None, line: record.line };
        let fields = Fields { tags: record.tags, origin: &origin };
        let number = fields.integer_or(62, 7)?;
        let true_colour = fields.integer_or(420, -1)?;
        let rgb = if true_colour >= 0 {
            Some(aci::rgb_of_true_colour(true_colour))
        } else {
            aci::rgb(number.saturating_abs())
        };
        let hidden = match () {
            () if fields.integer_or(70, 0)? & FROZEN != 0 => Some("is frozen"),
            () if number < 0 => Some("is off"),
            () if name.eq_ignore_ascii_case("defpoints") => Some("is never plotted"),
            () => None,
        };
        self.content.layers.insert(name.to_lowercase(), Layer { rgb, hidden });
        Ok(())
    }

    fn block(&mut self, record: &Record<'a>) -> Result<(), PatternError> {
        let name = self.name(record.tags);
        let origin = Origin { label: format!("BLOCK {name}"), id: None, line: record.line };
        let fields = Fields { tags: record.tags, origin: &origin };
        let block = Block {
            base: fields.point_if(10)?.unwrap_or_default(),
            external: fields.integer_or(70, 0)? & EXTERNAL != 0,
            entities: Vec::new(),
        };
        let key = name.to_lowercase();
        self.content.blocks.insert(key.clone(), block);
        self.block = Some(key);
        Ok(())
    }

    fn entity(&mut self, record: &Record<'a>) {
        let text = self.content.header.text;
        let list = match (&self.block, self.section) {
            (Some(name), _) => self.content.blocks.get_mut(name).map(|b| &mut b.entities),
            (None, b"ENTITIES") => Some(&mut self.content.entities),
            (None, _) => None,
        };
        let Some(list) = list else { return };
        match (record.kind, list.last_mut().filter(|e| e.open)) {
            (b"VERTEX", Some(polyline)) => polyline.vertices.push(record.tags),
            (b"SEQEND", Some(polyline)) => polyline.open = false,
            (b"SEQEND", None) => {}
            _ => list.push(entity(record, text, &mut self.counts)),
        }
    }
}

fn entity<'a>(record: &Record<'a>, text: Text, counts: &mut BTreeMap<String, usize>) -> Entity<'a> {
    let kind = String::from_utf8_lossy(record.kind).to_uppercase();
    let count = counts.entry(kind.clone()).or_default();
    *count += 1;
    let handle = record.tags.iter().find(|t| t.code == 5).map(|t| text.of(t)).filter(|h| !h.is_empty());
    let label = match &handle {
        Some(handle) => format!("{kind} {handle}"),
        None => format!("{kind} {count}"),
    };
    let origin = Origin { label, id: handle, line: record.line };
    let open = kind == "POLYLINE";
    Entity { kind, origin, tags: record.tags, vertices: Vec::new(), open }
}

fn header(tags: &[Tag<'_>]) -> Header {
    let after = |name: &[u8]| {
        let at = tags.iter().position(|t| t.code == 9 && t.bytes() == name)?;
        tags.get(at + 1)
    };
    let units = after(b"$INSUNITS");
    Header {
        units: units.and_then(Tag::integer),
        units_line: units.and_then(|t| t.line),
        measurement: after(b"$MEASUREMENT").and_then(Tag::integer),
        text: after(b"$DWGCODEPAGE").map_or_else(Text::default, |t| Text::of_code_page(t.bytes())),
    }
}

/// How names are written: UTF-8, or the code page of the header.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text(&'static Encoding);

impl Default for Text {
    fn default() -> Self {
        Self(encoding_rs::WINDOWS_1252)
    }
}

impl Text {
    fn of_code_page(name: &[u8]) -> Self {
        let label: &[u8] = match name.to_ascii_uppercase().as_slice() {
            b"ANSI_932" | b"DOS932" => b"shift_jis",
            b"ANSI_936" => b"gbk",
            b"ANSI_949" => b"euc-kr",
            b"ANSI_950" => b"big5",
            b"ANSI_874" => b"windows-874",
            b"ANSI_1250" => b"windows-1250",
            b"ANSI_1251" => b"windows-1251",
            b"ANSI_1253" => b"windows-1253",
            b"ANSI_1254" => b"windows-1254",
            b"ANSI_1255" => b"windows-1255",
            b"ANSI_1256" => b"windows-1256",
            b"ANSI_1257" => b"windows-1257",
            b"ANSI_1258" => b"windows-1258",
            _ => b"windows-1252",
        };
        Encoding::for_label(label).map_or_else(Self::default, Self)
    }

    /// The text of a group. Other alphabets than UTF-8's are almost never valid UTF-8, so that goes first,
    /// whatever the header says: many programs leave a wrong code page there.
    pub(super) fn of(self, tag: &Tag<'_>) -> String {
        let bytes = tag.bytes();
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => self.0.decode_without_bom_handling(bytes).0.into_owned(),
        };
        unescaped(&text)
    }
}

/// Text with `\U+XXXX` resolved.
fn unescaped(text: &str) -> String {
    const DIGITS: usize = 4;
    let mut units: Vec<u16> = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let code = rest.strip_prefix("\\U+").and_then(|r| r.get(..DIGITS));
        if let Some(unit) = code.and_then(|hex| u16::from_str_radix(hex, 16).ok()) {
            units.push(unit);
            rest = &rest["\\U+".len() + DIGITS..];
        } else {
            units.extend(c.encode_utf16(&mut [0; 2]).iter());
            rest = &rest[c.len_utf8()..];
        }
    }
    String::from_utf16_lossy(&units)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dxf::tags;

    fn text(bytes: &[u8], page: &[u8]) -> String {
        let tag = Tag { code: 2, value: tags::Value::Text(bytes), line: None };
        Text::of_code_page(page).of(&tag)
    }

    #[test]
    fn names_are_read_in_their_alphabet() {
        assert_eq!(text(b"\x8eR\x90\xfc", b"ANSI_932"), "山線");
        assert_eq!(text(b"Gr\xf6\xdfe", b"ANSI_1252"), "Größe");
        assert_eq!(text("Größe".as_bytes(), b"ANSI_932"), "Größe", "UTF-8 goes first");
        assert_eq!(text(b"mark_\\U+00E4\\U+D83D\\U+DE00\\U+1", b""), "mark_ä😀\\U+1");
    }

    #[test]
    fn sections_are_told_apart() {
        let file = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n9\n$MEASUREMENT\n70\n1\n0\nENDSEC\n\
            0\nSECTION\n2\nTABLES\n0\nLAYER\n2\nOff\n62\n-5\n0\nLAYER\n2\nb\n70\n1\n420\n255\n0\nENDSEC\n\
            0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nArm\n10\n1\n20\n2\n0\nLINE\n0\nENDBLK\n0\nENDSEC\n\
            0\nSECTION\n2\nENTITIES\n0\nPOLYLINE\n0\nVERTEX\n0\nVERTEX\n0\nSEQEND\n0\nVERTEX\n0\nLINE\n5\n3F\n\
            0\nENDSEC\n";
        let tags = tags::read(file.as_bytes()).unwrap();
        let mut issues = Vec::new();
        let content = Content::read(&tags, &mut issues).unwrap();
        assert_eq!((content.header.units, content.header.units_line), (Some(4), Some(8)));
        assert_eq!(content.layers["off"].hidden, Some("is off"));
        assert_eq!(content.layers["off"].rgb, Some([0, 0, 255]));
        assert_eq!(
            (content.layers["b"].hidden, content.layers["b"].rgb),
            (Some("is frozen"), Some([0, 0, 255]))
        );
        let arm = &content.blocks["arm"];
        assert_eq!((arm.base, arm.entities.len()), (DVec3::new(1.0, 2.0, 0.0), 1));
        let labels: Vec<_> = content.entities.iter().map(|e| e.origin.label.as_str()).collect();
        assert_eq!(labels, ["POLYLINE 1", "VERTEX 1", "LINE 3F"]);
        assert_eq!(content.entities[0].vertices.len(), 2);
        assert!(issues.len() == 1 && issues[0].message.contains("cut off"));
    }
}
