//! What the colours mean, and a scale.

use super::{BLUE, BOLD, INK, JUNCTION, RED, View, number};
use softfold_geometry::{CreasePattern, DVec2, SoftPattern, text};
use std::fmt::Write;

/// Height of the letters as a share of the sheet's size.
const LETTER_SHARE: f64 = 0.016;
/// Height of the legend, in heights of letters.
const HEIGHT: f64 = 6.4;
/// Width of a swatch, in heights of letters.
const SWATCH: f64 = 2.4;
/// Mean width of a letter, in its height.
const LETTER_WIDTH: f64 = 0.56;
/// The scale is the longest round length below this share of the sheet.
const SCALE_SHARE: f64 = 0.25;

/// Height of the legend for a sheet of a size.
pub(super) fn height(scale: f64) -> f64 {
    HEIGHT * LETTER_SHARE * scale
}

/// Writes the legend below the sheet.
pub(super) fn write(out: &mut String, view: &View, pattern: &CreasePattern, soft: &SoftPattern) {
    let letter = LETTER_SHARE * view.scale;
    let (left, top) = (letter, view.high.y - view.low.y);
    let _ = writeln!(out, "<g font-size=\"{}\">", number(letter));
    title(out, pattern, soft, DVec2::new(left, top + letter));
    let mut x = left;
    let y = top + 2.8 * letter;
    let line = |colour: &str, width: f64| format!("stroke=\"{colour}\" stroke-width=\"{}\"", number(width));
    let thin = view.stroke();
    let entries = [
        ("valley", line(BLUE, thin), Some(BLUE)),
        ("mountain", line(RED, thin), Some(RED)),
        ("sharp fold", line(BLUE, BOLD * thin), None),
        ("junction", line(JUNCTION, thin), Some("url(#junction)")),
        ("outline, slit", line(INK, BOLD * thin), None),
    ];
    for (name, stroke, fill) in entries {
        swatch(out, DVec2::new(x, y), letter, &stroke, fill);
        x += (SWATCH + 0.6) * letter;
        let _ = writeln!(out, "<text x=\"{}\" y=\"{}\">{name}</text>", number(x), number(y + 0.85 * letter));
        x += (LETTER_WIDTH * name.len() as f64 + 1.2) * letter;
    }
    scale_bar(out, view, DVec2::new(left, top + 5.4 * letter), letter);
    out.push_str("</g>\n");
}

fn title(out: &mut String, pattern: &CreasePattern, soft: &SoftPattern, at: DVec2) {
    let bands = soft.bands.iter().filter(|b| !b.fold_lines.is_empty()).count();
    let lines: usize = soft.bands.iter().map(|b| b.fold_lines.len()).sum();
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" font-weight=\"bold\">{}: bands {bands}, fold lines {lines}, junctions {}; \
         r radius, then fold angle, + valley, - mountain</text>",
        number(at.x),
        number(at.y),
        text::escape_xml(&pattern.name),
        soft.junctions.len()
    );
}

fn swatch(out: &mut String, at: DVec2, letter: f64, stroke: &str, fill: Option<&str>) {
    let (w, h) = (SWATCH * letter, letter);
    let _ = match fill {
        Some(fill) => {
            let opacity = if fill.starts_with('#') { 0.14 } else { 1.0 };
            writeln!(
                out,
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\" fill-opacity=\"{opacity}\" {stroke}/>",
                number(at.x),
                number(at.y),
                number(w),
                number(h)
            )
        }
        None => writeln!(
            out,
            "<path d=\"M{} {}h{}\" fill=\"none\" {stroke}/>",
            number(at.x),
            number(at.y + 0.5 * h),
            number(w)
        ),
    };
}

fn scale_bar(out: &mut String, view: &View, at: DVec2, letter: f64) {
    let length = round_length(SCALE_SHARE * view.scale);
    let _ = writeln!(
        out,
        "<path d=\"M{x} {top}v{h}h{w}v-{h}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"{}\"/>\
         <text x=\"{}\" y=\"{}\">{} mm</text>",
        number(BOLD * view.stroke()),
        number(at.x + length + 0.6 * letter),
        number(at.y),
        text::number(length, 6),
        x = number(at.x),
        top = number(at.y - 0.5 * letter),
        h = number(0.5 * letter),
        w = number(length),
    );
}

/// The longest of 1, 2, 5 times a power of ten up to a length.
fn round_length(most: f64) -> f64 {
    let power = 10f64.powf(most.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|f| f * power).find(|l| *l <= most).unwrap_or(power)
}
