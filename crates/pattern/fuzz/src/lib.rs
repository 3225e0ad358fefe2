//! What every target asks of the readers.

use softfold_pattern::{DxfOptions, DxfVersion, Format, ReadOptions, WriteOptions};

/// Reads bytes; a pattern must keep its contract and be written in every format.
///
/// # Panics
/// On a defect: that is what is looked for.
pub fn read(bytes: &[u8], format: Format) {
    let Ok(file) = softfold_pattern::read(bytes, format, "fuzz", &ReadOptions::default()) else { return };
    file.pattern.check().expect("a pattern keeps its contract");
    let chord_mm = 0.1 * file.pattern.size_mm();
    let options = WriteOptions { chord_mm: Some(chord_mm) };
    let _ = softfold_pattern::write_svg(&file.pattern);
    let _ = softfold_pattern::write_cp(&file.pattern, &options);
    let _ = softfold_pattern::write_dxf(&file.pattern, &DxfOptions { version: DxfVersion::R12, chord_mm });
    let _ = softfold_pattern::write_fold(&file.pattern, &options);
}
