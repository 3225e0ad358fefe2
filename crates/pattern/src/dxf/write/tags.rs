//! Group codes and values, written one after the other.

use std::fmt::Write;

/// First handle that is not spoken for.
const FIRST_FREE: u32 = 0x20;
/// Owner of tables and of the root dictionary.
pub(super) const NOBODY: u32 = 0;

/// A DXF file being written: group codes and values.
pub(super) struct Tags {
    out: String,
    next_handle: u32,
}

impl Tags {
    pub(super) fn new() -> Self {
        Self { out: String::new(), next_handle: FIRST_FREE }
    }

    /// A value that is known to be plain ASCII.
    pub(super) fn raw(&mut self, code: i32, value: &str) -> &mut Self {
        // Writing to a string cannot fail.
        let _ = write!(self.out, "{code:>3}\r\n{value}\r\n");
        self
    }

    /// Text: control characters become spaces, what is not ASCII is written as `\U+XXXX`.
    pub(super) fn text(&mut self, code: i32, value: &str) -> &mut Self {
        let mut plain = String::with_capacity(value.len());
        for c in value.chars() {
            match c {
                c if c.is_control() => plain.push(' '),
                c if c.is_ascii() => plain.push(c),
                c => c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| {
                    let _ = write!(plain, "\\U+{unit:04X}");
                }),
            }
        }
        self.raw(code, &plain)
    }

    /// A whole number.
    pub(super) fn integer(&mut self, code: i32, value: i64) -> &mut Self {
        self.raw(code, &value.to_string())
    }

    /// The number of an object.
    pub(super) fn handle(&mut self, code: i32, value: u32) -> &mut Self {
        self.raw(code, &format!("{value:X}"))
    }

    /// A handle that no other object has.
    pub(super) fn fresh(&mut self) -> u32 {
        self.next_handle += 1;
        self.next_handle - 1
    }

    /// Head of an entity with a handle (R13 and later).
    pub(super) fn entity(&mut self, kind: &str, layer: &str, owner: u32) {
        let handle = self.fresh();
        self.object(kind, handle, owner).text(100, "AcDbEntity").text(8, layer);
    }

    /// Head of an object with a given handle.
    pub(super) fn object(&mut self, kind: &str, handle: u32, owner: u32) -> &mut Self {
        self.raw(0, kind).handle(5, handle).handle(330, owner)
    }

    /// Several values that are known to be plain ASCII.
    pub(super) fn all(&mut self, tags: &[(i32, &str)]) -> &mut Self {
        tags.iter().for_each(|(code, value)| {
            self.raw(*code, value);
        });
        self
    }

    /// A section around `content`.
    pub(super) fn section(&mut self, name: &str, content: impl FnOnce(&mut Self)) {
        self.raw(0, "SECTION").raw(2, name);
        content(self);
        self.raw(0, "ENDSEC");
    }

    /// A table around `content`, of `count` records.
    pub(super) fn table(&mut self, name: &str, handle: u32, count: usize, content: impl FnOnce(&mut Self)) {
        self.raw(0, "TABLE").raw(2, name).handle(5, handle).handle(330, NOBODY);
        self.raw(100, "AcDbSymbolTable").integer(70, count as i64);
        content(self);
        self.raw(0, "ENDTAB");
    }

    /// Head of a record of a table.
    pub(super) fn record(&mut self, kind: &str, owner: u32, class: &str, name: &str) -> &mut Self {
        let handle = self.fresh();
        self.object(kind, handle, owner).raw(100, "AcDbSymbolTableRecord").raw(100, class);
        self.text(2, name).raw(70, "0")
    }

    /// The file, and the first handle that was not given.
    pub(super) fn finish(mut self) -> (String, u32) {
        self.raw(0, "EOF");
        (self.out, self.next_handle)
    }
}
