//! What a unit of the drawing is.

use super::content::Header;
use crate::ReadOptions;
use crate::error::{Place, issue};
use softfold_geometry::{Issue, Severity};

/// `$INSUNITS` from 1 on: name, and millimetres.
const UNITS: [(&str, f64); 24] = [
    ("inch", 25.4),
    ("foot", 304.8),
    ("mile", 1_609_344.0),
    ("millimetre", 1.0),
    ("centimetre", 10.0),
    ("metre", 1e3),
    ("kilometre", 1e6),
    ("microinch", 25.4e-6),
    ("mil", 25.4e-3),
    ("yard", 914.4),
    ("ångström", 1e-7),
    ("nanometre", 1e-6),
    ("micrometre", 1e-3),
    ("decimetre", 100.0),
    ("decametre", 1e4),
    ("hectometre", 1e5),
    ("gigametre", 1e12),
    ("astronomical unit", 1.495_978_707e14),
    ("light year", 9.460_730_472_580_8e18),
    ("parsec", 3.085_677_581_491_367e19),
    ("US survey foot", 1200e3 / 3937.0),
    ("US survey inch", 100e3 / 3937.0),
    ("US survey yard", 3600e3 / 3937.0),
    ("US survey mile", 6_336_000e3 / 3937.0),
];
/// What a unit is taken for where neither file nor user says.
const ASSUMED_MM: f64 = 1.0;

/// Millimetres per unit: what the file says, else the user, else 1 with a note.
pub(super) fn unit_mm(header: &Header, options: &ReadOptions, issues: &mut Vec<Issue>) -> f64 {
    let code = header.units.unwrap_or(0);
    let known = usize::try_from(code).ok().and_then(|i| UNITS.get(i.checked_sub(1)?));
    if let Some((_, mm)) = known {
        return *mm;
    }
    if code != 0 {
        let what = format!("$INSUNITS is {code}, which is no unit");
        let mend = "set the drawing's units (DWGUNITS or UNITS) and save again";
        issues.push(issue(Severity::Warning, what, mend).of_line(header.units_line));
    }
    options.unit_mm.unwrap_or_else(|| {
        let hint = match header.measurement {
            Some(0) => "; $MEASUREMENT says imperial: it may be inches",
            Some(1) => ", and $MEASUREMENT says metric",
            _ => "",
        };
        let what =
            format!("the drawing has no unit ($INSUNITS); one unit is taken for {ASSUMED_MM} mm{hint}");
        let mend = "give the unit in the project file, or set the drawing's units and save again";
        issues.push(issue(Severity::Note, what, mend).of_line(header.units_line));
        ASSUMED_MM
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(units: Option<i64>, measurement: Option<i64>, unit_mm_given: Option<f64>) -> (f64, Vec<Issue>) {
        let mut issues = Vec::new();
        let header = Header { units, measurement, ..Header::default() };
        let options = ReadOptions { unit_mm: unit_mm_given, ..ReadOptions::default() };
        (unit_mm(&header, &options, &mut issues), issues)
    }

    #[test]
    fn the_file_wins_over_the_user_and_the_user_over_the_guess() {
        assert_eq!(told(Some(4), None, Some(5.0)), (1.0, vec![]));
        assert_eq!(told(Some(1), None, None), (25.4, vec![]));
        assert_eq!(told(Some(0), None, Some(5.0)), (5.0, vec![]));
        let (mm, issues) = told(None, Some(0), None);
        assert_eq!((mm, issues.len(), issues[0].severity), (1.0, 1, Severity::Note));
        assert!(issues[0].message.contains("1 mm") && issues[0].message.contains("inches"));
        for code in [99, -1, i64::MIN, i64::MAX] {
            assert_eq!(told(Some(code), None, None).1[0].severity, Severity::Warning);
        }
        let (mm, issues) = told(Some(99), None, None);
        assert_eq!((mm, issues.len(), issues[0].severity), (1.0, 2, Severity::Warning));
    }

    #[test]
    fn units_have_their_known_ratios() {
        let mm = |code: i64| told(Some(code), None, None).0;
        assert!((mm(2) - 12.0 * mm(1)).abs() < 1e-9 && (mm(3) - 5280.0 * mm(2)).abs() < 1e-6);
        assert!((mm(21) / mm(2) - 1.000_002).abs() < 1e-9, "the survey foot is two millionths longer");
        assert!((mm(24) - 5280.0 * mm(21)).abs() < 1e-5 && (mm(23) - 36.0 * mm(22)).abs() < 1e-9);
        assert!((mm(20) / mm(18) - 206_264.806_247).abs() < 1e-5, "a parsec is an astronomical unit at 1\"");
    }
}
