//! A single-stroke alphabet of digits and capitals.

use glam::DVec2;

/// Height of a capital, in units of the drawing grid.
const HEIGHT: f64 = 6.0;
/// Width of a glyph, in the same units.
const WIDTH: f64 = 4.0;
/// From one glyph's left side to the next one's.
const ADVANCE: f64 = 6.0;

/// Strokes as grid points `xy`, lines separated by `|`. Zero is crossed, so that it is no O.
fn strokes(letter: char) -> &'static str {
    match letter {
        '0' => "10 01 05 16 36 45 41 30 10|11 35",
        '1' => "05 26 20|00 40",
        '2' => "05 16 36 45 44 00 40",
        '3' => "05 16 36 45 44 33 13|33 42 41 30 10 01",
        '4' => "30 36 02 42",
        '5' => "46 06 04 34 43 41 30 10 01",
        '6' => "45 36 16 05 01 10 30 41 42 33 03",
        '7' => "06 46 20",
        '8' => "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",
        '9' => "01 10 30 41 45 36 16 05 04 13 43",
        'A' => "00 03 16 36 43 40|02 42",
        'B' => "00 06 36 45 44 33 03|33 42 41 30 00",
        'C' => "45 36 16 05 01 10 30 41",
        'D' => "00 06 26 44 42 20 00",
        'E' => "46 06 00 40|03 33",
        'F' => "46 06 00|03 33",
        'G' => "45 36 16 05 01 10 30 41 43 23",
        'H' => "00 06|40 46|03 43",
        'I' => "10 30|16 36|20 26",
        'J' => "46 41 30 10 01",
        'K' => "00 06|46 03 40",
        'L' => "06 00 40",
        'M' => "00 06 23 46 40",
        'N' => "00 06 40 46",
        'O' => "10 01 05 16 36 45 41 30 10",
        'P' => "00 06 36 45 44 33 03",
        'Q' => "10 01 05 16 36 45 41 30 10|22 40",
        'R' => "00 06 36 45 44 33 03|23 40",
        'S' => "45 36 16 05 04 13 33 42 41 30 10 01",
        'T' => "06 46|26 20",
        'U' => "06 01 10 30 41 46",
        'V' => "06 20 46",
        'W' => "06 10 23 30 46",
        'X' => "00 46|06 40",
        'Y' => "06 23 46|23 20",
        'Z' => "06 46 00 40",
        _ => "13 33",
    }
}

/// Polylines of a text of capitals `height_mm` high, its lower left corner at the origin. What the alphabet lacks is
/// drawn as a dash.
pub(crate) fn text(text: &str, height_mm: f64) -> Vec<Vec<DVec2>> {
    let unit = height_mm / HEIGHT;
    let glyph = |(k, letter): (usize, char)| {
        let left = DVec2::new(k as f64 * ADVANCE, 0.0);
        strokes(letter)
            .split('|')
            .map(move |line| line.split(' ').map(|xy| (grid_point(xy) + left) * unit).collect::<Vec<_>>())
    };
    text.chars().enumerate().flat_map(glyph).collect()
}

/// Width of a text, mm.
pub(crate) fn width_mm(text: &str, height_mm: f64) -> f64 {
    let letters = text.chars().count().max(1) as f64;
    height_mm / HEIGHT * (ADVANCE * (letters - 1.0) + WIDTH)
}

fn grid_point(xy: &str) -> DVec2 {
    let digit = |b: u8| f64::from(b.saturating_sub(b'0'));
    match *xy.as_bytes() {
        [x, y] => DVec2::new(digit(x), digit(y)),
        _ => DVec2::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    const ALL: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ";

    #[test]
    fn every_glyph_is_its_own_and_stays_in_its_box() {
        let drawn: BTreeSet<&str> = ALL.chars().map(strokes).collect();
        assert_eq!(drawn.len(), 36);
        for line in ALL.chars().flat_map(|c| text(&c.to_string(), 6.0)) {
            assert!(line.len() >= 2);
            assert!(line.windows(2).all(|w| w[0] != w[1]));
            assert!(line.iter().all(|p| p.cmple(DVec2::new(4.0, 6.0)).all() && p.cmpge(DVec2::ZERO).all()));
        }
    }

    #[test]
    fn a_text_is_as_wide_as_told() {
        let right = text("A12", 12.0).concat().iter().map(|p| p.x).fold(0.0, f64::max);
        assert_eq!(right, width_mm("A12", 12.0));
    }
}
