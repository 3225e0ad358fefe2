//! Patterns as SVG, in the convention that the reader reads.

use crate::colour;
use softfold_geometry::{CreasePattern, DVec2, PlanarCurve, Role, Segment, polygon, text};
use std::fmt::Write;

/// Decimals of every number: a nanometre, below any tolerance of a sheet.
const DECIMALS: usize = 6;
/// Stroke width as a share of the sheet's size, to be seen at any size.
const STROKE_SHARE: f64 = 1e-3;

/// A pattern as SVG in mm: the outline as `outline`, holes as `hole-N`, slits as `slit-N`, creases under their
/// names with role colour, opacity (fold angle by 180°), `data-assignment` and `data-foldAngle`. Reading it
/// back gives the same coordinates to the last written decimal, if none is negative.
pub fn write_svg(pattern: &CreasePattern) -> String {
    let page = Page::of(pattern);
    let mut out = page.head(pattern);
    for (id, curve) in pattern.loops() {
        let name = if id.0 == 0 { "outline".to_owned() } else { format!("hole-{id}") };
        page.path(&mut out, &name, Role::Boundary, None, curve);
    }
    for (k, slit) in pattern.slits.iter().enumerate() {
        page.path(&mut out, &format!("slit-{}", k + 1), Role::Cut, None, slit);
    }
    for crease in &pattern.creases {
        page.path(&mut out, &crease.name, crease.role, crease.fold_angle_rad, &crease.curve);
    }
    out.push_str("</g>\n</svg>\n");
    out
}

/// The page around a pattern, y down.
struct Page {
    left: f64,
    top: f64,
    size: DVec2,
}

impl Page {
    fn of(pattern: &CreasePattern) -> Self {
        let curves = pattern.boundaries().map(|l| l.1).chain(pattern.creases.iter().map(|c| &c.curve));
        let controls: Vec<DVec2> = curves.flat_map(controls).collect();
        let (low, high) = polygon::bounds(&controls);
        let low = low.min(DVec2::ZERO);
        Self { left: low.x, top: high.y, size: high - low }
    }

    fn head(&self, pattern: &CreasePattern) -> String {
        let [w, h, x] = [self.size.x, self.size.y, self.left].map(number);
        let stroke = number(STROKE_SHARE * pattern.size_mm());
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"{x} 0 {w} {h}\">\n\
             <title>{}</title>\n<g fill=\"none\" stroke-width=\"{stroke}\">\n",
            text::escape_xml(&pattern.name)
        )
    }

    fn path(&self, out: &mut String, id: &str, role: Role, angle: Option<f64>, curve: &PlanarCurve) {
        let mut extra = String::new();
        if let Some(rad) = angle {
            let degrees = rad.to_degrees();
            let opacity = (degrees.abs() / 180.0).min(1.0);
            let _ = write!(extra, " opacity=\"{}\" data-foldAngle=\"{}\"", number(opacity), number(degrees));
        }
        let _ = writeln!(
            out,
            "<path id=\"{}\" stroke=\"{}\" data-assignment=\"{}\"{extra} d=\"{}\"/>",
            text::escape_xml(id),
            colour::colour_of(role),
            role.letter(),
            self.data(curve)
        );
    }

    fn data(&self, curve: &PlanarCurve) -> String {
        let p = |p: DVec2| format!("{} {}", number(p.x), number(self.top - p.y));
        let mut d = format!("M{}", p(curve.segments()[0].from()));
        for s in curve.segments() {
            let _ = match *s {
                Segment::Line { to, .. } => write!(d, " L{}", p(to)),
                Segment::Cubic { c1, c2, to, .. } => write!(d, " C{} {} {}", p(c1), p(c2), p(to)),
            };
        }
        if curve.is_closed() {
            d.push('Z');
        }
        d
    }
}

fn controls(curve: &PlanarCurve) -> impl Iterator<Item = DVec2> + '_ {
    curve.segments().iter().flat_map(|s| s.control_points())
}

/// A number with [`DECIMALS`] at most.
fn number(x: f64) -> String {
    text::number(x, DECIMALS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_steady() {
        for (x, text) in
            [(1.0, "1"), (-1e-9, "0"), (0.1 + 0.2, "0.3"), (1234.5678901, "1234.56789"), (10.0, "10")]
        {
            assert_eq!(number(x), text);
        }
    }
}
