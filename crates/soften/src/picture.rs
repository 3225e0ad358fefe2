//! The bands as an SVG picture, in mm.

use softfold_geometry::{Band, CreasePattern, DVec2, FoldLine, PlanarCurve, SoftPattern, polygon, text};
use std::fmt::Write;

/// Decimals of coordinates: a micrometre, below what a picture shows.
const DECIMALS: usize = 3;
/// Thinnest stroke as a share of the sheet's size.
const STROKE_SHARE: f64 = 5e-4;
/// Height of the labels as a share of the sheet's size.
const LABEL_SHARE: f64 = 0.015;
/// Room around the sheet as a share of its size.
const MARGIN_SHARE: f64 = 0.02;
/// Chord error of curves in the picture as a share of the sheet's size.
const CHORD_SHARE: f64 = 1e-5;

/// A picture of the softened pattern in mm: the sheet, its bands (red mountain, blue valley), every fold line
/// with its turn as a tooltip, and each band's radius, fold angle and strips as a label.
pub fn write_svg(pattern: &CreasePattern, soft: &SoftPattern) -> String {
    let view = View::of(soft);
    let mut out = view.head(&pattern.name);
    let outline: String = soft.loops.iter().map(|l| view.curve(l)).collect();
    let _ = writeln!(
        out,
        "<path d=\"{outline}\" fill=\"#f7f4ee\" fill-rule=\"evenodd\" stroke=\"#000000\" stroke-width=\"{}\"/>",
        number(2.0 * STROKE_SHARE * view.scale)
    );
    for band in &soft.bands {
        let name = pattern.creases.get(band.crease.index()).map_or("", |c| c.name.as_str());
        view.band(&mut out, name, band);
    }
    out.push_str("</svg>\n");
    out
}

/// The page around the sheet, y down.
struct View {
    low: DVec2,
    high: DVec2,
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

    fn head(&self, name: &str) -> String {
        let size = self.high - self.low;
        let [w, h] = [size.x, size.y].map(number);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"sans-serif\" font-size=\"{}\">\n<title>{}</title>\n",
            number(LABEL_SHARE * self.scale),
            text::escape_xml(name)
        )
    }

    fn point(&self, p: DVec2) -> String {
        format!("{} {}", number(p.x - self.low.x), number(self.high.y - p.y))
    }

    fn polyline(&self, points: &[DVec2]) -> String {
        let all: Vec<String> = points.iter().map(|&p| self.point(p)).collect();
        format!("M{}", all.join(" "))
    }

    fn curve(&self, curve: &PlanarCurve) -> String {
        format!("{}Z", self.polyline(&curve.flatten(CHORD_SHARE * self.scale)))
    }

    fn band(&self, out: &mut String, name: &str, band: &Band) {
        let colour = if band.fold_angle_rad < 0.0 { "#c8102e" } else { "#1f4fd8" };
        let (Some(right), Some(left)) = (band.fold_lines.first(), band.fold_lines.last()) else { return };
        let around: Vec<DVec2> = right.points.iter().chain(left.points.iter().rev()).copied().collect();
        let _ = writeln!(out, "<g id=\"{}\">", text::escape_xml(name));
        let area = self.polyline(&around);
        let _ = writeln!(
            out,
            "<path d=\"{area}Z\" fill=\"{colour}\" fill-opacity=\"0.15\" fill-rule=\"evenodd\"/>"
        );
        for line in &band.fold_lines {
            self.fold_line(out, line, colour);
        }
        self.label(out, name, band, right.points[right.points.len() / 2]);
        out.push_str("</g>\n");
    }

    fn fold_line(&self, out: &mut String, line: &FoldLine, colour: &str) {
        let turn = line.turns_rad.first().copied().unwrap_or_default().to_degrees();
        let _ = writeln!(
            out,
            "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"><title>offset {} mm, turn {}°</title></path>",
            self.polyline(&line.points),
            number(STROKE_SHARE * self.scale),
            number(line.offset_mm),
            number(turn)
        );
    }

    fn label(&self, out: &mut String, name: &str, band: &Band, at: DVec2) {
        let place = self.point(at).replacen(' ', "\" y=\"", 1);
        let _ = writeln!(
            out,
            "<text x=\"{place}\">{}: r {} mm, {}°, {} strips</text>",
            text::escape_xml(name),
            number(band.radius_mm),
            number(band.fold_angle_rad.to_degrees()),
            band.fold_lines.len() - 1
        );
    }
}

fn number(x: f64) -> String {
    text::number(x, DECIMALS)
}
