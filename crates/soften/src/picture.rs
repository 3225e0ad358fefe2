//! The softened pattern as an SVG drawing in mm, to be checked by eye before anything is folded.

mod labels;
mod legend;

use labels::{Label, Labels};
use softfold_geometry::{Band, CreasePattern, DVec2, FoldLine, PlanarCurve, SoftPattern, polygon, text};
use std::fmt::Write;

/// Decimals of coordinates: a micrometre, below what a drawing shows.
const DECIMALS: usize = 3;
/// Decimals of radii (mm) and angles (degrees) in labels.
const LABEL_DECIMALS: usize = 2;
/// Thinnest stroke as a share of the sheet's size.
const STROKE_SHARE: f64 = 5e-4;
/// Strokes of sharp folds and of the boundary, in thinnest strokes.
const BOLD: f64 = 2.5;
/// Room around the sheet as a share of its size.
const MARGIN_SHARE: f64 = 0.02;
/// Chord error of curves in the drawing as a share of the sheet's size.
const CHORD_SHARE: f64 = 1e-5;

/// Mountains, as in FOLD viewers and on paper.
const RED: &str = "#c8102e";
/// Valleys.
const BLUE: &str = "#1f4fd8";
const JUNCTION: &str = "#8a6d00";
const SHEET: &str = "#f7f4ee";
const INK: &str = "#1a1a1a";

/// A drawing of the softened pattern in mm: outline, holes and slits; bands and their fold lines (red
/// mountain, blue valley; each line's place and turn as its tooltip); junction regions; each band's radius,
/// fold angle, strips and turns as a label beside its middle; a legend with a scale below.
pub fn write_svg(pattern: &CreasePattern, soft: &SoftPattern) -> String {
    let view = View::of(soft);
    let mut out = view.head(&pattern.name);
    view.sheet(&mut out, soft);
    for junction in soft.junctions.iter().filter(|j| !j.polygon.is_empty()) {
        let area = view.polyline(&junction.polygon);
        let _ = writeln!(
            out,
            "<path d=\"{area}Z\" fill=\"url(#junction)\" stroke=\"{JUNCTION}\" stroke-width=\"{}\"/>",
            number(view.stroke())
        );
    }
    let name = |band: &Band| pattern.creases.get(band.crease.index()).map_or("", |c| c.name.as_str());
    for band in &soft.bands {
        view.band(&mut out, name(band), band);
    }
    let folded = soft.bands.iter().filter(|b| !b.fold_lines.is_empty());
    let labels: Vec<Label> = folded.map(|b| Label::of(name(b), b)).collect();
    Labels::new(&view, soft, labels.len()).write(&mut out, &labels);
    legend::write(&mut out, &view, pattern, soft);
    out.push_str("</svg>\n");
    out
}

/// The page around the sheet, y down.
struct View {
    low: DVec2,
    high: DVec2,
    /// Larger side of the sheet.
    scale: f64,
}

impl View {
    fn of(soft: &SoftPattern) -> Self {
        let controls: Vec<DVec2> =
            soft.loops.iter().flat_map(PlanarCurve::segments).flat_map(|s| s.control_points()).collect();
        let (low, high) = polygon::bounds(&controls);
        let scale = (high - low).max_element();
        let margin = MARGIN_SHARE * scale;
        Self { low: low - margin, high: high + margin, scale }
    }

    fn stroke(&self) -> f64 {
        STROKE_SHARE * self.scale
    }

    fn head(&self, name: &str) -> String {
        let size = self.high - self.low;
        let [w, h] = [size.x, size.y + legend::height(self.scale)].map(number);
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"sans-serif\" fill=\"{INK}\">\n<title>{}</title>\n",
            text::escape_xml(name)
        );
        let step = number(8.0 * self.stroke());
        let _ = writeln!(
            out,
            "<defs><pattern id=\"junction\" width=\"{step}\" height=\"{step}\" patternUnits=\"userSpaceOnUse\" \
             patternTransform=\"rotate(45)\"><rect width=\"{step}\" height=\"{step}\" fill=\"#f3e3a0\"/>\
             <line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"{step}\" stroke=\"{JUNCTION}\" stroke-width=\"{}\"/></pattern></defs>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>",
            number(2.0 * self.stroke())
        );
        out
    }

    fn point(&self, p: DVec2) -> String {
        format!("{} {}", number(p.x - self.low.x), number(self.high.y - p.y))
    }

    fn polyline(&self, points: &[DVec2]) -> String {
        let all: Vec<String> = points.iter().map(|&p| self.point(p)).collect();
        format!("M{}", all.join(" "))
    }

    fn sheet(&self, out: &mut String, soft: &SoftPattern) {
        let flat = |c: &PlanarCurve| self.polyline(&c.flatten(CHORD_SHARE * self.scale));
        let outline: String = soft.loops.iter().map(|l| format!("{}Z", flat(l))).collect();
        let slits: String = soft.slits.iter().map(flat).collect();
        let bold = number(BOLD * self.stroke());
        let _ = writeln!(
            out,
            "<path d=\"{outline}\" fill=\"{SHEET}\" fill-rule=\"evenodd\" stroke=\"{INK}\" stroke-width=\"{bold}\"/>"
        );
        if !slits.is_empty() {
            let _ = writeln!(
                out,
                "<path d=\"{slits}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"{bold}\"><title>slit</title></path>"
            );
        }
    }

    fn band(&self, out: &mut String, name: &str, band: &Band) {
        let _ = writeln!(out, "<g><title>{}</title>", text::escape_xml(name));
        for stretch in band.fold_lines.chunk_by(|_, next| next.rank.is_some_and(|k| k > 0)) {
            let colour = colour(&stretch[0]);
            if let [right, .., left] = stretch {
                let around: Vec<DVec2> =
                    right.points.iter().chain(left.points.iter().rev()).copied().collect();
                let _ = writeln!(
                    out,
                    "<path d=\"{}Z\" fill=\"{colour}\" fill-opacity=\"0.14\" fill-rule=\"evenodd\"/>",
                    self.polyline(&around)
                );
            }
            for line in stretch {
                self.fold_line(out, line, colour);
            }
        }
        out.push_str("</g>\n");
    }

    fn fold_line(&self, out: &mut String, line: &FoldLine, colour: &str) {
        let width = if line.rank.is_none() { BOLD * self.stroke() } else { self.stroke() };
        let rank = line.rank.map_or("sharp".to_owned(), |k| format!("line {k}"));
        let offset = range(line.offsets_mm.iter().copied(), " mm");
        let turn = range(line.turns_rad.iter().map(|t| t.to_degrees()), "°");
        let _ = writeln!(
            out,
            "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"><title>{rank}: offset {offset}, turn {turn}</title></path>",
            self.polyline(&line.points),
            number(width)
        );
    }
}

/// By the sign of a line's turn.
fn colour(line: &FoldLine) -> &'static str {
    if line.turns_rad.iter().sum::<f64>() < 0.0 { RED } else { BLUE }
}

/// A figure, or the range in which it lies, as a label says it.
fn range(values: impl Iterator<Item = f64>, unit: &str) -> String {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
    let [low, high] = [low, high].map(|v| text::number(v, LABEL_DECIMALS));
    if low == high { format!("{low}{unit}") } else { format!("{low} to {high}{unit}") }
}

fn number(x: f64) -> String {
    text::number(x, DECIMALS)
}
