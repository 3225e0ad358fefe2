//! IGES and BREP files.

use super::shape::{Shape, run};
use super::step::{Draft, NamedShape, ReadPart, checked_part, read_part, step_lock, utf8};
use crate::bridge::occt as ffi;
use crate::check;
use crate::error::{KernelError, Result};
use std::path::Path;

/// What an IGES file says about itself; as much of it as ASCII bears.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct IgesOptions {
    /// What the file is about.
    pub product: String,
    /// Date and time in the header, as `20260131.120000`; none gives [`IgesOptions::NO_TIME`].
    pub time_stamp: Option<String>,
    /// Who made it.
    pub author: String,
    /// For whom.
    pub organization: String,
    /// With which program.
    pub system: String,
}

impl IgesOptions {
    /// Stands in the header if no time is given, so that equal parts make equal files.
    pub const NO_TIME: &'static str = "19700101.000000";
    /// Entities of IGES have labels of so many characters; longer names are cut.
    pub const LABEL: usize = 8;
}

/// Writes parts as one IGES file in mm, each with its colour and the first eight ASCII characters of its name. The file
/// appears whole or not at all.
///
/// # Errors
/// No parts, colours outside of 0 to 1, a directory that cannot be written.
pub fn write_iges(path: &Path, parts: &[NamedShape<'_>], options: &IgesOptions) -> Result<()> {
    const OPERATION: &str = "occt::write_iges";
    check::require(OPERATION, !parts.is_empty(), || "no parts".into())?;
    let label = |name: &str| ascii(name).chars().take(IgesOptions::LABEL).collect::<String>();
    let flat = |part: &NamedShape<'_>| checked_part(OPERATION, part, label(part.name), String::new());
    let parts = parts.iter().map(flat).collect::<Result<Vec<_>>>()?;
    let header = ffi::StepHeader {
        schema: String::new(),
        product: ascii(&options.product),
        time_stamp: ascii(options.time_stamp.as_deref().unwrap_or(IgesOptions::NO_TIME)),
        author: ascii(&options.author),
        organization: ascii(&options.organization),
        system: ascii(&options.system),
    };
    whole(path, |draft| {
        let _guard = step_lock();
        run(OPERATION, || ffi::write_iges(draft, &parts, &header))
    })
}

/// Reads the parts of an IGES file, converted to mm.
///
/// # Errors
/// A file that is missing, is not IGES, or has no shape.
pub fn read_iges(path: &Path) -> Result<Vec<ReadPart>> {
    const OPERATION: &str = "occt::read_iges";
    let name = there(path)?;
    let parts = {
        let _guard = step_lock();
        run(OPERATION, || ffi::read_iges(name)).map_err(|error| KernelError::file(path, error))?
    };
    parts.into_iter().map(|part| read_part(OPERATION, part)).collect()
}

/// Writes a shape in OpenCascade's own text format: exact, in mm by agreement, without names and colours. The file appears
/// whole or not at all.
///
/// # Errors
/// A directory that cannot be written.
pub fn write_brep(path: &Path, shape: &Shape) -> Result<()> {
    whole(path, |draft| run("occt::write_brep", || ffi::write_brep(draft, shape.raw())))
}

/// Reads a shape in OpenCascade's own text format.
///
/// # Errors
/// A file that is missing or is not BREP.
pub fn read_brep(path: &Path) -> Result<Shape> {
    /// What such files begin with, after a line or two.
    const MARK: &str = "CASCADE Topology V";
    let name = there(path)?;
    let bytes = std::fs::read(path).map_err(|error| KernelError::file(path, error))?;
    // OpenCascade would print its refusal.
    if !String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).contains(MARK) {
        return Err(KernelError::file(path, "this is no BREP file OpenCascade can read"));
    }
    Shape::made_by("occt::read_brep", || ffi::read_brep(name)).map_err(|error| KernelError::file(path, error))
}

/// Writes under another name first.
fn whole(path: &Path, write: impl FnOnce(&str) -> Result<()>) -> Result<()> {
    let draft = Draft::beside(path)?;
    write(utf8(&draft.0)?).map_err(|error| KernelError::file(path, error))?;
    std::fs::rename(&draft.0, path).map_err(|error| KernelError::file(path, error))
}

fn there(path: &Path) -> Result<&str> {
    std::fs::File::open(path).map_err(|error| KernelError::file(path, error))?;
    utf8(path)
}

/// IGES has no other characters.
fn ascii(text: &str) -> String {
    text.chars().map(|c| if matches!(c, ' '..='~') { c } else { '_' }).collect()
}
