//! The closing summary on the terminal: what came out, in plain words.

use super::json::{Board, Cage, Fold, Mold, Pattern, Report, Stability, Surface};
use super::words::{area, count, figure, maybe, percent, percent_size, volume, with_unit, yes};

/// Twelve to twenty lines: one a stage, then the verdicts, then the time. Ends with a line end.
pub fn summary(report: &Report) -> String {
    let mut lines = vec![pattern_line(&report.pattern)];
    lines.extend(report.pattern.creases.iter().take(MOST_CREASES).map(crease_line));
    let left = report.pattern.creases.len().saturating_sub(MOST_CREASES);
    if left > 0 {
        lines.push(row("", &format!("and {} more", count(left, "crease", "creases"))));
    }
    lines.extend(report.mesh.as_ref().map(mesh_line));
    lines.extend(report.fold.iter().flat_map(fold_lines));
    lines.extend(report.surface.iter().flat_map(surface_lines));
    lines.extend(report.board.as_ref().map(board_line));
    lines.extend(report.stability.as_ref().map(stability_line));
    lines.extend(report.mold.iter().flat_map(mold_lines));
    lines.extend(verdict_lines(report));
    lines.push(time_line(report));
    lines.join("\n") + "\n"
}

/// More creases than this are counted, not listed.
const MOST_CREASES: usize = 4;
/// Width of the words before the figures.
const LABEL_WIDTH: usize = 10;

fn row(label: &str, text: &str) -> String {
    format!("{label:<LABEL_WIDTH$} {text}")
}

fn pattern_line(p: &Pattern) -> String {
    let faults = match p.issues.len() {
        0 => "nothing to remark".to_owned(),
        n => format!("{} (see report.html)", count(n, "remark", "remarks")),
    };
    row(
        "Pattern",
        &format!(
            "{}: {}, {}, {faults}",
            p.name,
            area(p.area_mm2),
            count(p.creases.len(), "crease", "creases")
        ),
    )
}

fn crease_line(c: &super::json::Crease) -> String {
    row(
        "",
        &format!(
            "{}: {} over {}, radius {}, band {} wide of {}",
            c.name,
            with_unit(c.fold_angle_deg, "°"),
            with_unit(c.length_mm, "mm"),
            with_unit(c.radius_mm, "mm"),
            with_unit(c.band_width_mm, "mm"),
            count(c.segments as usize, "strip", "strips"),
        ),
    )
}

fn mesh_line(m: &super::json::Mesh) -> String {
    let angle = with_unit(m.min_angle_deg, "°");
    row(
        "Mesh",
        &format!("{}, smallest angle {angle} ({})", count(m.triangles, "triangle", "triangles"), m.backend),
    )
}

fn fold_lines(f: &Fold) -> Vec<String> {
    let end = if f.converged { "at rest" } else { "NOT at rest" };
    let steps = count(f.iterations as usize, "step", "steps");
    let hits = if f.self_intersections == 0 {
        "no part passes through another".to_owned()
    } else {
        format!("{} where the sheet passes through itself", count(f.self_intersections, "place", "places"))
    };
    vec![
        row("Folding", &format!("{end} after {steps} of {} ({})", f.solver, f.stop)),
        row(
            "",
            &format!(
                "area {} to {}, edges within {}",
                percent(f.area_error_min),
                percent(f.area_error_max),
                percent_size(f.max_edge_strain)
            ),
        ),
        row("", &format!("fold lines within {} of their turn; {hits}", with_unit(f.turn_error_max_deg, "°"))),
    ]
}

fn surface_lines(s: &Surface) -> Vec<String> {
    let Some(cage) = &s.cage else { return vec![surface_line(s)] };
    let valid = if s.valid { "valid" } else { "NOT valid" };
    let off = with_unit(s.max_deviation_mm, "mm");
    vec![
        row(
            "Surface",
            &format!(
                "{} of {} patches, {valid}; at most {off} from the folded sheet",
                count(cage.faces, "face", "faces"),
                cage.patches
            ),
        ),
        row("", &cage_words(cage)),
    ]
}

/// The cage in a few words: quads, valences, angles, rows.
fn cage_words(c: &Cage) -> String {
    let excused = match c.excused.len() {
        0 => String::new(),
        n => format!(" (but for {} that the outline makes sharper)", count(n, "corner", "corners")),
    };
    let rows = c.rows_along_bands.map(|r| format!("; {:.0} % of the rows along the bands", 100.0 * r));
    format!(
        "cage of {} quads, {:.1} % of inner vertices of valence 4, smallest angle {:.0}°{excused}{}",
        c.quads,
        100.0 * c.valence_4_share,
        c.min_angle_deg,
        rows.unwrap_or_default()
    )
}

fn surface_line(s: &Surface) -> String {
    let valid = if s.valid { "valid" } else { "NOT valid" };
    row(
        "Surface",
        &format!(
            "{} of {}×{} poles, {valid}; at most {} from the folded sheet",
            count(s.faces, "face", "faces"),
            s.poles[0],
            s.poles[1],
            with_unit(s.max_deviation_mm, "mm")
        ),
    )
}

fn board_line(b: &Board) -> String {
    let valid = if b.valid { "valid solid" } else { "NOT a valid solid" };
    row(
        "Board",
        &format!(
            "{} thick, {}, {}, {valid}; tightest radius {}",
            with_unit(b.thickness_mm, "mm"),
            volume(b.volume_mm3),
            with_unit(b.mass_kg, "kg"),
            maybe(b.min_radius_mm, "mm")
        ),
    )
}

fn stability_line(s: &Stability) -> String {
    let text = if s.stable {
        format!(
            "yes: {} to the nearest edge, tips at {} or by {} at its top",
            with_unit(s.margin_mm, "mm"),
            with_unit(s.tipping_angle_deg, "°"),
            with_unit(s.tipping_push_n, "N")
        )
    } else {
        format!("NO: the barycenter lies {} outside its feet", with_unit(-s.margin_mm, "mm"))
    };
    row("Stands", &text)
}

fn mold_lines(m: &Mold) -> Vec<String> {
    let bad = m.parts.iter().filter(|p| !p.valid).count();
    let state = if bad == 0 { "all good".to_owned() } else { format!("{bad} of them with FAULTS") };
    let draft = if m.undercuts == 0 { "no undercut" } else { "UNDERCUTS" };
    vec![
        row(
            "Mold",
            &format!(
                "{}, {state}; {draft}, least draft {}",
                count(m.parts.len(), "printed part", "printed parts"),
                with_unit(m.least_draft_deg, "°")
            ),
        ),
        row(
            "Waffle",
            &format!(
                "{} on {}, {} % of the stock used",
                count(m.boards.len(), "board", "boards"),
                count(m.sheets, "stock sheet", "stock sheets"),
                figure((100.0 * m.stock_use).round())
            ),
        ),
    ]
}

fn verdict_lines(report: &Report) -> Vec<String> {
    let failed: Vec<_> = report.verdicts.iter().filter(|v| !v.pass).collect();
    let passed = report.verdicts.len() - failed.len();
    let mut lines = vec![row(
        "Verdict",
        &format!("{passed} of {} passed", count(report.verdicts.len(), "check", "checks")),
    )];
    for v in failed {
        lines.push(row("  FAILED", &format!("{}: {}", v.name, finding(v))));
        lines.push(row("", &v.message));
    }
    lines
}

/// "27.8 mm (limit 25 mm)".
pub(crate) fn finding(v: &super::json::Verdict) -> String {
    match (v.figure, v.limit) {
        (Some(f), Some(l)) => format!("{} (limit {})", with_unit(f, &v.unit), with_unit(l, &v.unit)),
        (Some(f), None) => with_unit(f, &v.unit),
        (None, _) => yes(v.pass),
    }
}

fn time_line(report: &Report) -> String {
    let total: f64 = report.stages.iter().map(|s| s.seconds).sum();
    row("Time", &with_unit((total * 10.0).round() / 10.0, "s"))
}

#[cfg(test)]
mod tests {
    use super::super::json::tests::sample;
    use super::*;

    #[test]
    fn is_short_and_names_what_failed() {
        let text = summary(&sample());
        let lines = text.lines().count();
        assert!((12..=20).contains(&lines), "{lines}\n{text}");
        assert!(text.contains("1 of 2 checks passed"));
        assert!(text.contains("FAILED") && text.contains("Mold parts: 1 (limit 0)"));
        assert!(text.contains("−0.63\u{202f}%"));
    }

    #[test]
    fn a_run_that_stopped_early_says_what_it_has() {
        let text = summary(&Report::new(Pattern::default()));
        assert!(text.starts_with("Pattern") && !text.contains("Mold"));
    }
}
