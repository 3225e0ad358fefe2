//! Figures as people read them.

use crate::export::number;

/// Digits that a reader needs.
const SIGNIFICANT: i32 = 4;
/// Thin no-break space between groups of thousands.
const GROUP: char = '\u{202f}';

/// A figure with four significant digits; thousands are set apart.
pub(crate) fn figure(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value != 0.0 && value.abs() < 1e-3 {
        return scientific(value);
    }
    let magnitude = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    let text = number(value, (SIGNIFICANT - 1 - magnitude).clamp(0, 6) as usize);
    group(&text).replace('-', "−")
}

/// Two digits and a power of ten.
fn scientific(value: f64) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let text = format!("{value:.1e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    let raise = |c: char| c.to_digit(10).map_or('⁻', |d| RAISED[d as usize]);
    format!("{}·10{}", digits.replace('-', "−"), power.chars().map(raise).collect::<String>())
}

/// A figure with its unit.
pub(crate) fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "" => figure(value),
        "°" => format!("{}°", figure(value)),
        "%" => format!("{}{GROUP}%", figure(value)),
        _ => format!("{} {unit}", figure(value)),
    }
}

/// A figure that may be absent.
pub(crate) fn maybe(value: Option<f64>, unit: &str) -> String {
    value.map_or_else(|| "–".to_owned(), |v| with_unit(v, unit))
}

/// The size of a ratio as percent, without a sign.
pub(crate) fn percent_size(ratio: f64) -> String {
    percent(ratio.abs()).trim_start_matches('+').to_owned()
}

/// A signed ratio as percent.
pub(crate) fn percent(ratio: f64) -> String {
    let value = ratio * 100.0;
    let sign = if value > 0.0 { "+" } else { "" };
    format!("{sign}{}{GROUP}%", number(value, 2).replace('-', "−"))
}

/// A volume given in mm³, in litres or cm³.
pub(crate) fn volume(mm3: f64) -> String {
    if mm3.abs() >= 1e6 { with_unit(mm3 / 1e6, "l") } else { with_unit(mm3 / 1e3, "cm³") }
}

/// An area given in mm², in m² or cm².
pub(crate) fn area(mm2: f64) -> String {
    if mm2.abs() >= 1e5 { with_unit(mm2 / 1e6, "m²") } else { with_unit(mm2 / 1e2, "cm²") }
}

/// Yes or no.
pub(crate) fn yes(value: bool) -> String {
    if value { "yes" } else { "no" }.to_owned()
}

/// A point, mm.
pub(crate) fn place(at: &[f64]) -> String {
    let coordinates: Vec<_> = at.iter().map(|c| number(*c, 1).replace('-', "−")).collect();
    format!("({}) mm", coordinates.join(", "))
}

/// A count with its noun in the right number.
pub(crate) fn count(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", group(&n.to_string()), if n == 1 { one } else { many })
}

fn group(text: &str) -> String {
    /// Below this, four digits stand together.
    const FROM_DIGITS: usize = 5;
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let digits = whole.trim_start_matches('-').len();
    if digits < FROM_DIGITS {
        return text.to_owned();
    }
    let sign = whole.len() - digits;
    let mut out = String::new();
    for (i, c) in whole.chars().enumerate() {
        if i > sign && (whole.len() - i) % 3 == 0 {
            out.push(GROUP);
        }
        out.push(c);
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_short() {
        let cases = [
            (0.0, "0"),
            (27.8, "27.8"),
            (1234.5678, "1235"),
            (-1234567.0, "−1\u{202f}234\u{202f}567"),
            (0.00031, "3.1·10⁻⁴"),
            (0.06789123, "0.06789"),
            (f64::INFINITY, "–"),
        ];
        for (value, text) in cases {
            assert_eq!(figure(value), text);
        }
        assert_eq!(percent(-0.0063), "−0.63\u{202f}%");
        assert_eq!(volume(2_442_050.0), "2.442 l");
        assert_eq!(count(1, "part", "parts"), "1 part");
    }
}
