//! Pattern files outside a project: reading, checking, converting.

use crate::RunError;
use softfold_geometry::{CreasePattern, DVec2, Role, Severity, polygon};
use softfold_pattern::{DxfOptions, DxfVersion, Format, PatternFile, ReadOptions, Refused};
use std::io::Write;
use std::path::Path;

/// Endings of files that can be read, as a user is told them.
pub const READABLE: &str = "svg, fold, dxf, cp, opx or ori";
/// Endings of files that can be written.
pub const WRITABLE: &str = "svg, fold, dxf or cp";

/// The format of a file by its ending; none if it is no pattern.
pub fn format_of(path: &Path) -> Option<Format> {
    path.extension().and_then(|e| e.to_str()).and_then(Format::of_ending)
}

/// The bytes of a pattern file and its format.
///
/// # Errors
/// A file that cannot be read, or whose ending is unknown.
pub fn load(path: &Path, mend: &str) -> Result<(Vec<u8>, Format), RunError> {
    let format = format_of(path).ok_or_else(|| {
        RunError::in_file(path, None, format!("has no ending of a pattern; give {READABLE}"))
    })?;
    let bytes = std::fs::read(path)
        .map_err(|e| RunError::in_file(path, None, format!("cannot be read: {e}; {mend}")))?;
    Ok((bytes, format))
}

/// The name of a pattern: its file's without the ending.
pub fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(|| "pattern".to_owned(), |s| s.to_string_lossy().into_owned())
}

/// How a pattern is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WriteOptions {
    /// Largest distance of a curve from the lines that stand for it, mm.
    pub chord_mm: f64,
    /// Version of DXF files.
    pub dxf: DxfVersion,
}

impl WriteOptions {
    /// Chord tolerance where nothing is said, mm: what cutters resolve.
    pub const CHORD_MM: f64 = 0.02;
}

/// The text of a pattern in the format that `path` ends on.
///
/// # Errors
/// An ending that cannot be written.
pub fn text_of(pattern: &CreasePattern, path: &Path, options: &WriteOptions) -> Result<String, RunError> {
    let WriteOptions { chord_mm, dxf } = *options;
    match format_of(path) {
        Some(Format::Svg) => Ok(softfold_pattern::write_svg(pattern)),
        Some(Format::Fold) => Ok(softfold_pattern::write_fold(
            pattern,
            &softfold_pattern::WriteOptions { chord_mm: Some(chord_mm) },
        )),
        Some(Format::Dxf) => Ok(softfold_pattern::write_dxf(pattern, &DxfOptions { version: dxf, chord_mm })),
        Some(Format::Cp) => Ok(softfold_pattern::write_cp(
            pattern,
            &softfold_pattern::WriteOptions { chord_mm: Some(chord_mm) },
        )),
        _ => Err(RunError::in_file(
            path,
            None,
            format!("cannot be written; give a name that ends on {WRITABLE}"),
        )),
    }
}

/// Writes a file whole or not at all; an existing one only if `replace`.
///
/// # Errors
/// The file is there already, or cannot be written.
pub fn write(path: &Path, content: impl AsRef<[u8]>, replace: bool) -> Result<(), RunError> {
    let cannot = |e: &dyn std::fmt::Display| RunError::in_file(path, None, format!("cannot be written: {e}"));
    if path.exists() && !replace {
        return Err(RunError::in_file(
            path,
            None,
            "is there already; give another name, or --force to replace it",
        ));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    readable(builder.prefix(".softfold-"));
    let mut file = builder.tempfile_in(folder).map_err(|e| cannot(&e))?;
    file.write_all(content.as_ref()).map_err(|e| cannot(&e))?;
    let kept = if replace { file.persist(path) } else { file.persist_noclobber(path) };
    kept.map(|_| ()).map_err(|e| cannot(&e.error))
}

/// Temporary files are private; a result is as readable as any file that the user makes.
fn readable(builder: &mut tempfile::Builder<'_, '_>) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666)); // less the user's umask
    }
    #[cfg(not(unix))]
    let _ = builder;
}

/// What a pattern holds, in a few lines.
pub fn describe(pattern: &CreasePattern) -> String {
    let controls: Vec<DVec2> = pattern.outline.segments().iter().flat_map(|s| s.control_points()).collect();
    let (low, high) = polygon::bounds(&controls);
    let count = |role: Role| {
        let of_role: Vec<_> = pattern.creases.iter().filter(|c| c.role == role).collect();
        let length: f64 = of_role.iter().map(|c| c.curve.length_mm()).sum();
        (!of_role.is_empty()).then(|| format!("{} {} ({length:.0} mm)", of_role.len(), role_name(role)))
    };
    let roles = [Role::Mountain, Role::Valley, Role::Unassigned, Role::Flat];
    let creases: Vec<String> = roles.into_iter().filter_map(count).collect();
    format!(
        "sheet    {:.1} x {:.1} mm, {:.0} mm2, holes: {}, slits: {}\ncreases  {}\nmeet in  {} junctions",
        high.x - low.x,
        high.y - low.y,
        pattern.area_mm2(),
        pattern.holes.len(),
        pattern.slits.len(),
        if creases.is_empty() { "none".to_owned() } else { creases.join(", ") },
        pattern.junctions().len()
    )
}

fn role_name(role: Role) -> &'static str {
    match role {
        Role::Mountain => "mountain",
        Role::Valley => "valley",
        Role::Unassigned => "unassigned",
        Role::Flat => "flat",
        Role::Boundary => "boundary",
        Role::Cut => "cut",
    }
}

/// How many notes, warnings and errors there are.
pub fn tally(issues: &[softfold_geometry::Issue]) -> [usize; 3] {
    [Severity::Note, Severity::Warning, Severity::Error]
        .map(|wanted| issues.iter().filter(|i| i.severity == wanted).count())
}

/// Reads a pattern file.
///
/// # Errors
/// Why it gives no pattern, with all that was found.
pub fn read(
    bytes: &[u8],
    format: Format,
    path: &Path,
    options: &ReadOptions,
) -> Result<PatternFile, Box<Refused>> {
    softfold_pattern::read(bytes, format, &name_of(path), options)
}
