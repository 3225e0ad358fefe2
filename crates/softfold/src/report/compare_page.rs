//! `compare.html`: the figures of a comparison, its histogram and its pictures on one page, in the style of the report.

use super::html::{Picture, gallery};
use super::page::{Facts, STYLE, drawing, section, table};
use super::picture::{INK, Scale};
use super::words::{area, count, figure, percent_size, place, with_unit};
use crate::compare::{Figures, Histogram, Record, Source};
use crate::export::{escape_xml, number};
use std::fmt::Write;

/// What the page shows.
pub struct Page<'a> {
    /// All figures.
    pub record: &'a Record,
    /// How the first shape was placed, in words.
    pub placement: &'a str,
    /// Pictures of it.
    pub views: &'a [Picture],
    /// The colours of distances, for the bars.
    pub scale: &'a Scale,
}

/// The page.
pub fn html(page: &Page<'_>) -> String {
    let r = page.record;
    let names = [&r.measured, &r.against].map(|s| s.path.display().to_string());
    let title = format!("{} against {}", names[0], names[1]);
    let body = [
        header(&title, r),
        key_figures(r),
        remarks(r),
        section("views", "Where it is off", &gallery(page.views)),
        histograms(page),
        figures(page),
        files(r),
    ]
    .concat();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><title>{} – softfold</title>\n\
         <style>\n{STYLE}</style></head>\n<body><main>\n{body}\
         <footer>Made by softfold {}. Lengths in millimetres. Distances are from points of the first shape to the nearest \
         point of the second.</footer>\n</main></body></html>\n",
        escape_xml(&title),
        escape_xml(&r.version)
    )
}

fn header(title: &str, r: &Record) -> String {
    let pill = match (r.limit_mm, r.passes) {
        (None, _) => String::new(),
        (Some(limit), true) => format!("<span class=\"pill good\">within {}</span>", with_unit(limit, "mm")),
        (Some(limit), false) => format!("<span class=\"pill bad\">beyond {}</span>", with_unit(limit, "mm")),
    };
    format!("<header><h1>{}</h1>{pill}</header>\n", escape_xml(title))
}

fn key_figures(r: &Record) -> String {
    let d = &r.distance;
    let mm = |v: f64| with_unit(v, "mm");
    let key = [
        ("Largest distance", mm(d.max_mm)),
        ("Root mean square", mm(d.rms_mm)),
        ("Half are within", mm(d.p50_mm)),
        ("90 % are within", mm(d.p90_mm)),
        ("99 % are within", mm(d.p99_mm)),
    ];
    let cells: String =
        key.iter().map(|(l, f)| format!("<div><dt>{l}</dt><dd>{}</dd></div>", escape_xml(f))).collect();
    format!("<dl class=\"key\">{cells}</dl>\n")
}

fn remarks(r: &Record) -> String {
    let items: String = r.remarks.iter().map(|t| format!("<li>{}</li>\n", escape_xml(t))).collect();
    let list = if items.is_empty() { items } else { format!("<ul>\n{items}</ul>\n") };
    section("remarks", "Remarks", &list)
}

fn histograms(page: &Page<'_>) -> String {
    let r = page.record;
    let one = |f: &Figures, title: &str| {
        let h = &f.histogram;
        let beyond = match h.below + h.above {
            0 => String::new(),
            _ => format!(" Beyond the ends: {} below, {} above.", h.below, h.above),
        };
        let sign = if f.signed.is_some() {
            "with sign, positive on the side of the normals"
        } else {
            "without sign"
        };
        let caption =
            format!("{} points, bars {} wide, {sign}.{beyond}", f.points, with_unit(h.width_mm, "mm"));
        drawing(&histogram_svg(h, page.scale), title, &caption)
    };
    let mut content = one(&r.distance, "Distances of the first from the second");
    content += &r
        .distance_back
        .as_ref()
        .map(|b| one(b, "Distances of the second from the first"))
        .unwrap_or_default();
    section("histogram", "Histogram", &format!("<div class=\"gallery two\">\n{content}</div>\n"))
}

/// The drawing's size, and the rectangle of its bars: left, top, right, bottom.
const SIZE: [f64; 2] = [640.0, 300.0];
const PLOT: [f64; 4] = [52.0, 14.0, 600.0, 254.0];
/// Figures along the axis, about.
const TICKS: f64 = 6.0;

/// Bars over their distances, coloured as in the pictures.
fn histogram_svg(h: &Histogram, scale: &Scale) -> String {
    let [left, top, right, bottom] = PLOT;
    let most = h.counts.iter().copied().max().unwrap_or(0).max(1) as f64;
    let step = (right - left) / h.counts.len().max(1) as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n",
        SIZE[0], SIZE[1]
    );
    for (i, n) in h.counts.iter().enumerate().filter(|(_, n)| **n > 0) {
        let middle = h.from_mm + (i as f64 + 0.5) * h.width_mm;
        let [r, g, b] = scale.colour(middle);
        let high = (bottom - top) * *n as f64 / most;
        // Writing to a string cannot fail.
        let _ = writeln!(
            svg,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"rgb({r},{g},{b})\" stroke=\"#555\" stroke-width=\"0.5\"/>",
            number(left + i as f64 * step, 2),
            number(bottom - high, 2),
            number(step, 2),
            number(high, 2)
        );
    }
    svg += &axis(h);
    let _ =
        writeln!(svg, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", left - 6.0, top + 10.0, most);
    svg += "<text x=\"326\" y=\"294\" text-anchor=\"middle\">distance, mm</text>\n</svg>\n";
    svg
}

/// The line below the bars with round figures.
fn axis(h: &Histogram) -> String {
    let [left, _, right, bottom] = PLOT;
    let [r, g, b] = INK;
    let ink = format!("rgb({r},{g},{b})");
    let mut svg = format!("<path d=\"M{left} {bottom}H{right}\" stroke=\"{ink}\" fill=\"none\"/>\n");
    let bars = h.counts.len() as f64;
    let every = (bars / TICKS).ceil().max(1.0);
    let first = (h.from_mm / h.width_mm / every).ceil();
    let mut k = if h.width_mm > 0.0 { first } else { return svg };
    loop {
        let value = k * every * h.width_mm;
        let x = left + (right - left) * (value - h.from_mm) / (bars * h.width_mm);
        if x > right + 0.5 {
            return svg;
        }
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.2} {bottom}v5\" stroke=\"{ink}\"/><text x=\"{x:.2}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            bottom + 19.0,
            escape_xml(&figure(value))
        );
        k += 1.0;
    }
}

fn figures(page: &Page<'_>) -> String {
    let r = page.record;
    let mut tables = distance_facts(&r.distance, "First from second");
    tables += &r.distance_back.as_ref().map(|b| distance_facts(b, "Second from first")).unwrap_or_default();
    tables += &placement_facts(page);
    tables += &source_facts(&r.measured, "Measured");
    tables += &source_facts(&r.against, "Against");
    section("figures", "Figures", &format!("<div class=\"grid\">\n{tables}</div>\n"))
}

fn distance_facts(f: &Figures, heading: &str) -> String {
    let mm = |v: f64| with_unit(v, "mm");
    let from = if f.sampling == "spread" { "spread over the area" } else { "vertices" };
    let mut facts = Facts::default()
        .row("Points", format!("{}, {from}", count(f.points, "point", "points")))
        .row("Largest", format!("{} at {}", mm(f.max_mm), place(&f.max_at_mm)))
        .row("Root mean square", mm(f.rms_mm))
        .row("Mean", mm(f.mean_mm))
        .row("50 % within", mm(f.p50_mm))
        .row("90 % within", mm(f.p90_mm))
        .row("99 % within", mm(f.p99_mm));
    if let Some(s) = &f.signed {
        facts = facts
            .row("With sign", format!("{} to {}", mm(s.min_mm), mm(s.max_mm)))
            .row("Mean with sign", mm(s.mean_mm))
            .row("Deviation about it", mm(s.deviation_mm));
    }
    facts
        .row("Past the border", f.past_border.to_string())
        .row("Left out", f.left_out.to_string())
        .finish(heading)
}

fn placement_facts(page: &Page<'_>) -> String {
    let mut facts = Facts::default().row("First", page.placement);
    if let Some(m) = &page.record.alignment {
        facts = facts.row("Start", &m.start);
        if let Some(c) = &m.closest_points {
            facts = facts
                .row("Steps", c.iterations.to_string())
                .row("At rest", super::words::yes(c.converged))
                .row("Pairs that count, rms", with_unit(c.rms_mm, "mm"))
                .row("Pairs that do not count", percent_size(c.trimmed))
                .row("Motions that nothing holds", c.free_motions.to_string());
        }
    }
    facts.finish("Placed")
}

fn source_facts(s: &Source, heading: &str) -> String {
    let mut facts = Facts::default()
        .row("File", s.path.display().to_string())
        .row("Vertices", s.vertices.to_string())
        .row("Triangles", s.triangles.to_string())
        .row("Area", area(s.area_mm2));
    if let Some(chord) = s.chord_mm {
        facts = facts.row("Chord of the triangles", with_unit(chord, "mm"));
    }
    if let Some(unit) = s.unit_mm {
        facts = facts.row("A unit of the file", with_unit(unit, "mm"));
    }
    facts.finish(heading)
}

fn files(r: &Record) -> String {
    let rows: Vec<_> = r.files.iter().map(|f| vec![f.path.clone(), f.purpose.clone()]).collect();
    let content = match rows.is_empty() {
        true => String::new(),
        false => format!("<div class=\"scroll\">{}</div>\n", table(&["File", "What it is for"], &rows)),
    };
    section("files", "Files", &content)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram() -> Histogram {
        Histogram { from_mm: -0.4, width_mm: 0.1, counts: vec![1, 0, 7, 20, 9, 2], below: 0, above: 3 }
    }

    #[test]
    fn the_highest_bar_fills_the_plot_and_empty_bars_are_not_drawn() {
        let svg = histogram_svg(&histogram(), &Scale::diverging(0.4));
        assert_eq!(svg.matches("<rect").count(), 5);
        assert!(svg.contains("height=\"240\"") && svg.contains(">20</text>"), "{svg}");
        assert!(svg.contains(">0</text>") && svg.contains(">−0.4</text>"), "{svg}");
    }

    #[test]
    fn one_bar_without_width_has_no_axis_figures() {
        let h = Histogram { from_mm: 0.0, width_mm: 0.0, counts: vec![5], below: 0, above: 0 };
        assert!(histogram_svg(&h, &Scale::diverging(1.0)).contains("<rect"));
    }
}
