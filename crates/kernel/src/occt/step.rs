use super::part21::tidy;
use super::shape::{Shape, run};
use crate::bridge::occt as ffi;
use crate::check;
use crate::error::{KernelError, Result};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a part is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material<'a> {
    /// Its name, any text but none.
    pub name: &'a str,
    /// Its density, kg/m³.
    pub density_kg_m3: f64,
}

/// One part of a STEP file to be.
#[derive(Debug, Clone, Copy)]
pub struct NamedShape<'a> {
    /// The part's name, any text.
    pub name: &'a str,
    /// Red, green, blue as on screen, 0 to 1.
    pub color_srgb: [f32; 3],
    /// What it is made of; an attribute of the part in STEP files, which other formats have no place for.
    pub material: Option<Material<'a>>,
    /// What it is.
    pub shape: &'a Shape,
}

/// What a part that was read is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadMaterial {
    /// Its name.
    pub name: String,
    /// Its density, kg/m³; 0 if the file tells none.
    pub density_kg_m3: f64,
}

/// One part of a file that was read.
#[derive(Debug)]
pub struct ReadPart {
    /// The part's name; empty if the file has none.
    pub name: String,
    /// Its colour as on screen, 0 to 1, if it has one as a whole.
    pub color_srgb: Option<[f32; 3]>,
    /// What it is made of, if the file says so.
    pub material: Option<ReadMaterial>,
    /// What it is, in place, in mm.
    pub shape: Shape,
}

/// The application protocol of a STEP file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum StepSchema {
    /// AP203, read by everything.
    Ap203,
    /// AP214, with colours.
    Ap214,
    /// AP242, its successor; the usual choice.
    #[default]
    Ap242,
}

/// What a STEP file says about itself.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StepOptions {
    /// The application protocol.
    pub schema: StepSchema,
    /// What the file is about; its name in the header.
    pub product: String,
    /// Date and time in the header, as `2026-01-31T12:00:00`; none gives [`StepOptions::NO_TIME`].
    pub time_stamp: Option<String>,
    /// Who made it.
    pub author: String,
    /// For whom.
    pub organization: String,
    /// With which program.
    pub system: String,
}

impl StepOptions {
    /// Stands in the header if no time is given, so that equal parts make equal files.
    pub const NO_TIME: &'static str = "1970-01-01T00:00:00";
}

/// Writes parts as one STEP file in mm, each with its name and colour. The file appears whole or not at all.
///
/// # Errors
/// No parts, colours outside of 0 to 1, a directory that cannot be written.
pub fn write_step(path: &Path, parts: &[NamedShape<'_>], options: &StepOptions) -> Result<()> {
    const OPERATION: &str = "occt::write_step";
    check::require(OPERATION, !parts.is_empty(), || "no parts".into())?;
    let mut texts = Texts::default();
    let header = flat_header(options, &mut texts);
    let part = |part| flat_part(OPERATION, part, &mut texts);
    let parts = parts.iter().map(part).collect::<Result<Vec<_>>>()?;
    let draft = Draft::beside(path)?;
    write_draft(path, &draft.0, &parts, &header)?;
    let written = std::fs::read_to_string(&draft.0).map_err(|error| KernelError::file(path, error))?;
    std::fs::write(&draft.0, texts.put_into(&tidy(&written)))
        .map_err(|error| KernelError::file(path, error))?;
    std::fs::rename(&draft.0, path).map_err(|error| KernelError::file(path, error))
}

/// Reads the parts of a STEP file, converted to mm; assemblies are taken apart and their parts put in place.
///
/// # Errors
/// A file that is missing, is not STEP, or has no shape.
pub fn read_step(path: &Path) -> Result<Vec<ReadPart>> {
    const OPERATION: &str = "occt::read_step";
    std::fs::File::open(path).map_err(|error| KernelError::file(path, error))?;
    let parts = {
        let name = utf8(path)?;
        let _guard = step_lock();
        run(OPERATION, || ffi::read_step(name)).map_err(|error| KernelError::file(path, error))?
    };
    parts.into_iter().map(|part| read_part(OPERATION, part)).collect()
}

/// A part as it came from C++.
pub(super) fn read_part(operation: &'static str, part: ffi::StepPart) -> Result<ReadPart> {
    let color_srgb = (part.color[0] >= 0.0).then_some(part.color);
    let density_kg_m3 = part.density_g_cm3 * KG_M3_PER_G_CM3;
    let material = (!part.material.is_empty()).then_some(ReadMaterial { name: part.material, density_kg_m3 });
    let shape = Shape::wrap(operation, part.shape)?;
    Ok(ReadPart { name: part.name, color_srgb, material, shape })
}

/// What OpenCascade has densities in.
const KG_M3_PER_G_CM3: f64 = 1000.0;

/// OpenCascade's STEP and IGES translators keep process-wide state: one call at a time.
pub(super) fn step_lock() -> MutexGuard<'static, ()> {
    static STEP: Mutex<()> = Mutex::new(());
    STEP.lock().unwrap_or_else(PoisonError::into_inner)
}

fn write_draft(
    path: &Path,
    draft: &Path,
    parts: &Vec<ffi::StepPart>,
    header: &ffi::StepHeader,
) -> Result<()> {
    let name = utf8(draft)?;
    let _guard = step_lock();
    run("occt::write_step", || ffi::write_step(name, parts, header))
        .map_err(|error| KernelError::file(path, error))
}

fn flat_part(operation: &'static str, part: &NamedShape<'_>, texts: &mut Texts) -> Result<ffi::StepPart> {
    let name = texts.stand_in(part.name);
    let material = part.material.map(|m| texts.stand_in(m.name)).unwrap_or_default();
    checked_part(operation, part, name, material)
}

/// A part on its way to C++, under a name and of a material that the format bears.
pub(super) fn checked_part(
    operation: &'static str,
    part: &NamedShape<'_>,
    name: String,
    material: String,
) -> Result<ffi::StepPart> {
    let in_range = part.color_srgb.iter().all(|c| (0.0..=1.0).contains(c));
    check::require(operation, in_range, || {
        format!("part {:?}: colour {:?} is not 0 to 1", part.name, part.color_srgb)
    })?;
    let density = part.material.map_or(0.0, |m| m.density_kg_m3);
    check::require(operation, density >= 0.0 && density.is_finite(), || {
        format!("part {:?}: density {density} kg/m3 is none", part.name)
    })?;
    let shape = run(operation, || ffi::copy(part.shape.raw()))?;
    let density_g_cm3 = density / KG_M3_PER_G_CM3;
    Ok(ffi::StepPart { name, color: part.color_srgb, material, density_g_cm3, shape })
}

fn flat_header(options: &StepOptions, texts: &mut Texts) -> ffi::StepHeader {
    let schema = match options.schema {
        StepSchema::Ap203 => "AP203",
        StepSchema::Ap214 => "AP214IS",
        StepSchema::Ap242 => "AP242DIS",
    };
    ffi::StepHeader {
        schema: schema.to_owned(),
        product: texts.stand_in(&options.product),
        time_stamp: texts.stand_in(options.time_stamp.as_deref().unwrap_or(StepOptions::NO_TIME)),
        author: texts.stand_in(&options.author),
        organization: texts.stand_in(&options.organization),
        system: texts.stand_in(&options.system),
    }
}

pub(super) fn utf8(path: &Path) -> Result<&str> {
    path.to_str().ok_or_else(|| KernelError::file(path, "the path is not UTF-8"))
}

/// A file under a name of its own, removed when it goes out of scope under that name.
pub(super) struct Draft(pub(super) PathBuf);

impl Draft {
    pub(super) fn beside(path: &Path) -> Result<Self> {
        let Some(name) = path.file_name() else { return Err(KernelError::file(path, "this names no file")) };
        static DRAFTS: AtomicU32 = AtomicU32::new(0);
        let number = DRAFTS.fetch_add(1, Ordering::Relaxed);
        let mut draft = name.to_os_string();
        draft.push(format!(".{}-{number}.part", std::process::id()));
        Ok(Self(path.with_file_name(draft)))
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0); // after success it has been renamed: nothing there
    }
}

/// The texts of a file. OpenCascade writes them as UTF-8, which STEP does not allow, and breaks long ones within a
/// character. So it gets short stand-ins, and the texts are put in their place afterwards.
#[derive(Default)]
struct Texts(Vec<String>);

impl Texts {
    fn stand_in(&mut self, text: &str) -> String {
        self.0.push(part_21(text));
        Self::name(self.0.len() - 1)
    }

    fn name(index: usize) -> String {
        format!("softfold-text-{index:06}")
    }

    fn put_into(&self, written: &str) -> String {
        let stem = Self::name(0).replace("000000", "");
        let mut pieces = written.split(stem.as_str());
        let mut out = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let text =
                piece.get(..6).and_then(|digits| digits.parse().ok()).and_then(|i: usize| self.0.get(i));
            match text {
                Some(text) => out.extend([text, &piece[6..]]),
                None => out.extend([stem.as_str(), piece]),
            }
        }
        out
    }
}

/// A text as STEP's part 21 wants it: ASCII, quotes and backslashes doubled, anything else as `\X2\hhhh\X0\`, or as
/// `\X4\hhhhhhhh\X0\` past the basic plane.
fn part_21(text: &str) -> String {
    let mut coded = String::with_capacity(text.len());
    let mut open = 0; // digits per character of the run we are in, 0 outside of one
    for c in text.chars() {
        let width = match c {
            ' '..='~' => 0,
            '\0'..='\u{ffff}' => 4,
            _ => 8,
        };
        if width != open {
            coded.push_str(if open == 0 { "" } else { r"\X0\" });
            coded.push_str(["", r"\X2\", r"\X4\"][width / 4]);
            open = width;
        }
        match c {
            '\'' | '\\' => coded.extend([c, c]),
            c if width == 0 => coded.push(c),
            c => coded.push_str(&format!("{:01$X}", u32::from(c), width)),
        }
    }
    coded.push_str(if open == 0 { "" } else { r"\X0\" });
    coded
}

#[cfg(test)]
mod tests {
    use super::{Texts, part_21};

    #[test]
    fn part_21_codes_what_is_not_ascii() {
        assert_eq!(part_21("it's a\\b"), r"it''s a\\b");
        assert_eq!(part_21("V\u{e4}gg \u{58c1}"), r"V\X2\00E4\X0\gg \X2\58C1\X0\");
        assert_eq!(part_21("\u{e4}\u{1f4a1}\n"), r"\X2\00E4\X0\\X4\0001F4A1\X0\\X2\000A\X0\");
    }

    #[test]
    fn texts_replace_their_stand_ins() {
        let mut texts = Texts::default();
        let (a, b) = (texts.stand_in("first"), texts.stand_in("softfold-text-000000"));
        let written = format!("('{b}','{a}'); softfold-text- softfold-text-000002");
        let wanted = "('softfold-text-000000','first'); softfold-text- softfold-text-000002";
        assert_eq!(texts.put_into(&written), wanted);
    }
}
