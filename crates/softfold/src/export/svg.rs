//! Small SVG pictures: polygons, lines, circles and labels in sheet coordinates, y up.

use super::{escape_xml, number};
use softfold_geometry::{DVec2, PlanarCurve, Segment};
use std::fmt::Write;

/// Digits after the point: a micrometre.
const DECIMALS: usize = 3;

/// How a shape is drawn; colours are CSS colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style<'a> {
    /// Colour of the inside, `none` for none.
    pub fill: &'a str,
    /// Colour of the line, `none` for none.
    pub stroke: &'a str,
    /// Width of the line on the screen, px, whatever the scale.
    pub width_px: f64,
    /// Dash pattern, px; empty for a full line.
    pub dash: &'a str,
}

/// Where a label's position lies in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

/// How large the picture says it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// As large as the thing itself, for a file that is cut or printed at 1:1.
    Millimetres,
    /// As large as the page lets it be, for a picture inside a page.
    Fluid,
}

/// A picture being drawn. Coordinates are mm with y up; the file's y runs down.
#[derive(Clone, Debug)]
pub struct Svg {
    lo: DVec2,
    hi: DVec2,
    body: String,
}

impl<'a> Style<'a> {
    /// A line without filling.
    pub const fn line(stroke: &'a str, width_px: f64) -> Self {
        Self { fill: "none", stroke, width_px, dash: "" }
    }

    /// A filled shape without a line.
    pub const fn filled(fill: &'a str) -> Self {
        Self { fill, stroke: "none", width_px: 0.0, dash: "" }
    }

    /// The same with a filling.
    pub const fn fill(mut self, fill: &'a str) -> Self {
        self.fill = fill;
        self
    }

    /// The same, dashed.
    pub const fn dashed(mut self, dash: &'a str) -> Self {
        self.dash = dash;
        self
    }

    fn attributes(&self) -> String {
        let mut out = format!(r#"fill="{}" stroke="{}""#, escape_xml(self.fill), escape_xml(self.stroke));
        if self.stroke != "none" {
            let width = number(self.width_px, DECIMALS);
            // Writing to a string cannot fail.
            let _ = write!(out, r#" stroke-width="{width}" vector-effect="non-scaling-stroke""#);
        }
        if !self.dash.is_empty() {
            let _ = write!(out, r#" stroke-dasharray="{}""#, escape_xml(self.dash));
        }
        out
    }
}

impl Svg {
    /// An empty picture of the box from `lo` to `hi`, mm.
    pub fn new(lo: DVec2, hi: DVec2) -> Self {
        Self { lo, hi, body: String::new() }
    }

    /// An empty picture around the points, with a margin that is a share of the larger side.
    pub fn around(points: &[DVec2], margin: f64) -> Self {
        let (lo, hi) = softfold_geometry::polygon::bounds(points);
        let border = DVec2::splat(((hi - lo).max_element() * margin).max(f64::MIN_POSITIVE));
        Self::new(lo - border, hi + border)
    }

    /// The larger side of the picture, mm.
    pub fn extent_mm(&self) -> f64 {
        (self.hi - self.lo).max_element()
    }

    /// A closed shape with straight sides.
    pub fn polygon(&mut self, points: &[DVec2], style: Style<'_>) {
        self.chain("polygon", points, style);
    }

    /// An open chain of straight pieces.
    pub fn polyline(&mut self, points: &[DVec2], style: Style<'_>) {
        self.chain("polyline", points, style);
    }

    /// Many straight pieces as one path; closed ones are filled.
    pub fn chains<'c>(
        &mut self,
        chains: impl IntoIterator<Item = &'c [DVec2]>,
        closed: bool,
        style: Style<'_>,
    ) {
        let mut data = String::new();
        for chain in chains {
            for (i, p) in chain.iter().enumerate() {
                data.push(if i == 0 { 'M' } else { 'L' });
                data.push_str(&self.pair(*p));
            }
            if closed {
                data.push('Z');
            }
        }
        if !data.is_empty() {
            self.push(format!(r#"<path {} d="{data}"/>"#, style.attributes()));
        }
    }

    /// Curves as one path, cubics as cubics; closed ones fill even-odd, so holes stay open.
    pub fn curves<'c>(&mut self, curves: impl IntoIterator<Item = &'c PlanarCurve>, style: Style<'_>) {
        let data: Vec<_> = curves.into_iter().map(|c| self.path_data(c)).collect();
        self.push(format!(r#"<path fill-rule="evenodd" {} d="{}"/>"#, style.attributes(), data.join(" ")));
    }

    /// A circle, mm.
    pub fn circle(&mut self, centre: DVec2, radius_mm: f64, style: Style<'_>) {
        let [x, y] = self.xy(centre);
        let radius = number(radius_mm, DECIMALS);
        self.push(format!(r#"<circle cx="{x}" cy="{y}" r="{radius}" {}/>"#, style.attributes()));
    }

    /// A label on one line; `size_mm` is the font's size.
    pub fn label(&mut self, at: DVec2, size_mm: f64, anchor: Anchor, colour: &str, text: &str) {
        let [x, y] = self.xy(at);
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.push(format!(
            r#"<text x="{x}" y="{y}" font-size="{}" text-anchor="{anchor}" fill="{}" font-family="system-ui,sans-serif">{}</text>"#,
            number(size_mm, DECIMALS),
            escape_xml(colour),
            escape_xml(text)
        ));
    }

    /// Opens a group whose `title` a browser shows as a hint; close it with [`Svg::end_group`].
    pub fn begin_group(&mut self, title: &str) {
        self.push(format!("<g><title>{}</title>", escape_xml(title)));
    }

    /// Closes the group.
    pub fn end_group(&mut self) {
        self.push("</g>".to_owned());
    }

    /// The picture as SVG text.
    pub fn finish(self, size: Size) -> String {
        let [w, h] = (self.hi - self.lo).to_array().map(|x| number(x, DECIMALS));
        let size = match size {
            Size::Millimetres => format!(r#" width="{w}mm" height="{h}mm""#),
            Size::Fluid => String::new(),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\"{size}>\n{}</svg>\n",
            self.body
        )
    }

    fn chain(&mut self, element: &str, points: &[DVec2], style: Style<'_>) {
        let points: Vec<_> = points.iter().map(|&p| self.pair(p)).collect();
        self.push(format!(r#"<{element} {} points="{}"/>"#, style.attributes(), points.join(" ")));
    }

    fn path_data(&self, curve: &PlanarCurve) -> String {
        let start = curve.segments().first().map_or(DVec2::ZERO, Segment::from);
        let mut data = format!("M{}", self.pair(start));
        for segment in curve.segments() {
            let _ = match *segment {
                Segment::Line { to, .. } => write!(data, "L{}", self.pair(to)),
                Segment::Cubic { c1, c2, to, .. } => {
                    write!(data, "C{} {} {}", self.pair(c1), self.pair(c2), self.pair(to))
                }
            };
        }
        if curve.is_closed() {
            data.push('Z');
        }
        data
    }

    fn push(&mut self, element: String) {
        self.body.push_str(&element);
        self.body.push('\n');
    }

    fn xy(&self, p: DVec2) -> [String; 2] {
        [p.x - self.lo.x, self.hi.y - p.y].map(|c| number(c, DECIMALS))
    }

    fn pair(&self, p: DVec2) -> String {
        self.xy(p).join(",")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn y_runs_up_and_text_is_escaped() {
        let mut svg = Svg::new(DVec2::ZERO, DVec2::new(100.0, 50.0));
        svg.polyline(&[DVec2::ZERO, DVec2::new(10.0, 50.0)], Style::line("red", 1.0).dashed("4 2"));
        svg.label(DVec2::ZERO, 5.0, Anchor::Middle, "black", "<A>");
        let text = svg.finish(Size::Millimetres);
        assert!(text.contains(r#"points="0,50 10,0""#));
        assert!(text.contains(r#"width="100mm" height="50mm""#));
        assert!(text.contains("&lt;A&gt;") && text.contains("stroke-dasharray=\"4 2\""));
    }

    #[test]
    fn a_cubic_stays_a_cubic() {
        let [from, c1, c2, to] = [(0., 0.), (0., 1.), (1., 1.), (1., 0.)].map(DVec2::from);
        let curve = PlanarCurve::new(vec![Segment::Cubic { from, c1, c2, to }]).unwrap();
        let mut svg = Svg::new(DVec2::ZERO, DVec2::ONE);
        svg.curves([&curve], Style::line("black", 1.0));
        assert!(svg.finish(Size::Fluid).contains("M0,1C0,0 1,0 1,1\""));
    }
}
