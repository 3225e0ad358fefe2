//! Exact geometry of SVG shapes in their own coordinates: lines and cubics in `f64`.
//!
//! usvg keeps coordinates in `f32` and arcs to a tenth of a unit, too coarse for curves that are
//! offset to 0.01 mm; so shapes whose numbers are plain are read here, and only their transforms
//! and styles come from usvg.

use kurbo::{Arc, BezPath, Point, SvgArc, Vec2};
use svgtypes::{PathParser, PathSegment};

/// Largest distance of an arc from the cubics that stand for it, as a share of its radius:
/// 1e-5 mm on a radius of 1 m.
const ARC_ERROR: f64 = 1e-8;

/// The path of a `d` attribute.
///
/// # Errors
/// The parser's word and place.
pub(crate) fn parse(d: &str) -> Result<BezPath, svgtypes::Error> {
    let mut pen = Pen::default();
    for segment in PathParser::from(d) {
        pen.draw(segment?);
    }
    Ok(pen.path)
}

/// An axis-aligned ellipse.
pub(crate) fn ellipse(center: Point, radii: Vec2) -> BezPath {
    let arc = Arc::new(center, radii, 0.0, std::f64::consts::TAU, 0.0);
    let mut path = BezPath::new();
    let start = center + Vec2::new(radii.x, 0.0);
    path.move_to(start);
    append_arc(&mut path, &arc, start);
    path.close_path();
    path
}

/// An arc of the unit circle, angles in rad, counter-clockwise for a positive `sweep`.
pub(crate) fn unit_arc(start: f64, sweep: f64) -> BezPath {
    let on = |angle: f64| Point::new(angle.cos(), angle.sin());
    let arc = Arc::new(Point::ORIGIN, Vec2::new(1.0, 1.0), start, sweep, 0.0);
    let mut path = BezPath::new();
    path.move_to(on(start));
    let whole = sweep.abs() >= std::f64::consts::TAU;
    append_arc(&mut path, &arc, on(if whole { start } else { start + sweep }));
    path
}

/// A rectangle with corners rounded by `radii`.
pub(crate) fn rectangle(min: Point, size: Vec2, radii: Vec2) -> BezPath {
    let r = Vec2::new(radii.x.min(size.x / 2.0), radii.y.min(size.y / 2.0));
    let max = min + size;
    let mut path = BezPath::new();
    path.move_to((min.x + r.x, min.y));
    path.line_to((max.x - r.x, min.y));
    corner(&mut path, r, Point::new(max.x, min.y + r.y));
    path.line_to((max.x, max.y - r.y));
    corner(&mut path, r, Point::new(max.x - r.x, max.y));
    path.line_to((min.x + r.x, max.y));
    corner(&mut path, r, Point::new(min.x, max.y - r.y));
    path.line_to((min.x, min.y + r.y));
    corner(&mut path, r, Point::new(min.x + r.x, min.y));
    path.close_path();
    path
}

fn corner(path: &mut BezPath, radii: Vec2, to: Point) {
    let from = path.current_position().unwrap_or(to);
    svg_arc(path, SvgArc { from, to, radii, x_rotation: 0.0, large_arc: false, sweep: true });
}

fn svg_arc(path: &mut BezPath, arc: SvgArc) {
    match Arc::from_svg_arc(&arc) {
        Some(a) => append_arc(path, &a, arc.to),
        None => path.line_to(arc.to),
    }
}

/// Adds an arc as cubics; its last point is `end`, free of rounding.
fn append_arc(path: &mut BezPath, arc: &Arc, end: Point) {
    let tolerance = ARC_ERROR * arc.radii.x.abs().max(arc.radii.y.abs());
    let mut pieces: Vec<[Point; 3]> = Vec::new();
    arc.to_cubic_beziers(tolerance, |a, b, p| pieces.push([a, b, p]));
    if let Some(last) = pieces.last_mut() {
        last[2] = end;
    }
    for [a, b, p] in pieces {
        path.curve_to(a, b, p);
    }
}

/// Turns the commands of a path into absolute curves.
#[derive(Default)]
struct Pen {
    path: BezPath,
    at: Point,
    start: Point,
    /// Last control point of the cubic before, which a smooth cubic mirrors.
    cubic: Option<Point>,
    /// Control point of the quadratic before.
    quad: Option<Point>,
    /// Whether the next drawing command must begin a subpath (after a close).
    closed: bool,
}

impl Pen {
    fn draw(&mut self, segment: PathSegment) {
        let (cubic, quad) = (self.cubic.take(), self.quad.take());
        match segment {
            PathSegment::MoveTo { abs, x, y } => self.move_to(self.point(abs, x, y)),
            PathSegment::LineTo { abs, x, y } => self.line_to(self.point(abs, x, y)),
            PathSegment::HorizontalLineTo { abs, x } => {
                self.line_to(Point::new(if abs { x } else { self.at.x + x }, self.at.y));
            }
            PathSegment::VerticalLineTo { abs, y } => {
                self.line_to(Point::new(self.at.x, if abs { y } else { self.at.y + y }));
            }
            PathSegment::CurveTo { abs, x1, y1, x2, y2, x, y } => {
                self.curve_to(self.point(abs, x1, y1), self.point(abs, x2, y2), self.point(abs, x, y));
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                self.curve_to(self.mirrored(cubic), self.point(abs, x2, y2), self.point(abs, x, y));
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => {
                self.quad_to(self.point(abs, x1, y1), self.point(abs, x, y));
            }
            PathSegment::SmoothQuadratic { abs, x, y } => {
                self.quad_to(self.mirrored(quad), self.point(abs, x, y));
            }
            PathSegment::EllipticalArc { abs, rx, ry, x_axis_rotation, large_arc, sweep, x, y } => {
                let to = self.point(abs, x, y);
                let x_rotation = x_axis_rotation.to_radians();
                self.arc_to(Vec2::new(rx.abs(), ry.abs()), x_rotation, [large_arc, sweep], to);
            }
            PathSegment::ClosePath { .. } => self.close(),
        }
    }

    fn point(&self, abs: bool, x: f64, y: f64) -> Point {
        if abs { Point::new(x, y) } else { Point::new(self.at.x + x, self.at.y + y) }
    }

    fn mirrored(&self, control: Option<Point>) -> Point {
        control.map_or(self.at, |c| self.at + (self.at - c))
    }

    fn move_to(&mut self, p: Point) {
        self.path.move_to(p);
        (self.at, self.start, self.closed) = (p, p, false);
    }

    fn begin(&mut self) {
        if self.closed {
            self.move_to(self.start);
        }
    }

    fn line_to(&mut self, p: Point) {
        self.begin();
        self.path.line_to(p);
        self.at = p;
    }

    fn curve_to(&mut self, c1: Point, c2: Point, p: Point) {
        self.begin();
        self.path.curve_to(c1, c2, p);
        (self.at, self.cubic) = (p, Some(c2));
    }

    /// A quadratic is exactly the cubic whose controls are two thirds of the way to its own.
    fn quad_to(&mut self, c: Point, p: Point) {
        let from = self.at;
        self.curve_to(from.lerp(c, 2.0 / 3.0), p.lerp(c, 2.0 / 3.0), p);
        (self.cubic, self.quad) = (None, Some(c));
    }

    fn arc_to(&mut self, radii: Vec2, x_rotation: f64, [large_arc, sweep]: [bool; 2], to: Point) {
        self.begin();
        svg_arc(&mut self.path, SvgArc { from: self.at, to, radii, x_rotation, large_arc, sweep });
        self.at = to;
    }

    fn close(&mut self) {
        if !self.closed {
            self.path.close_path();
        }
        (self.at, self.closed) = (self.start, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{ParamCurveArclen, PathEl, Shape};

    #[test]
    fn arcs_keep_their_circle() {
        let path = parse("M 1000 0 A 1000 1000 0 0 1 0 1000").unwrap();
        for segment in path.segments() {
            use kurbo::ParamCurve;
            for k in 0..=20 {
                let p = segment.eval(f64::from(k) / 20.0);
                assert!((p.to_vec2().hypot() - 1000.0).abs() < 1e-4);
            }
        }
        assert_eq!(path.current_position(), Some(Point::new(0.0, 1000.0)));
    }

    #[test]
    fn arcs_of_the_unit_circle_end_where_they_should() {
        let path = unit_arc(1.0, 4.0);
        let end = path.current_position().unwrap();
        assert!(end.distance(Point::new(5.0_f64.cos(), 5.0_f64.sin())) < 1e-15);
        let sector = path.segments().map(|s| s.arclen(1e-10)).sum::<f64>();
        assert!((sector - 4.0).abs() < 1e-6, "{sector}");
        let whole = unit_arc(0.3, std::f64::consts::TAU);
        assert_eq!(whole.current_position(), Some(Point::new(0.3_f64.cos(), 0.3_f64.sin())));
    }

    #[test]
    fn smooth_and_relative_commands_are_absolute_curves() {
        let path = parse("m10 10c0 5 5 10 10 10s10 -5 10 -10q5 5 10 0t10 0h5v-5z").unwrap();
        let PathEl::CurveTo(c1, ..) = path.elements()[2] else { panic!("cubic") };
        assert_eq!(c1, Point::new(25.0, 20.0), "the mirror of (15, 20) at (20, 20)");
        let PathEl::CurveTo(c1, ..) = path.elements()[4] else { panic!("cubic") };
        assert!(c1.distance(Point::new(40.0 + 10.0 / 3.0, 10.0 - 10.0 / 3.0)) < 1e-12);
        assert_eq!(path.elements().last(), Some(&PathEl::ClosePath));
    }

    #[test]
    fn shapes_have_their_areas() {
        let pi = std::f64::consts::PI;
        let round = rectangle(Point::new(1.0, 2.0), Vec2::new(30.0, 20.0), Vec2::new(5.0, 5.0));
        assert!((round.area().abs() - (600.0 - (4.0 - pi) * 25.0)).abs() < 1e-5);
        let sharp = rectangle(Point::ORIGIN, Vec2::new(30.0, 20.0), Vec2::ZERO);
        assert_eq!(sharp.area().abs(), 600.0);
        assert!((ellipse(Point::ORIGIN, Vec2::new(3.0, 2.0)).area().abs() - 6.0 * pi).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_number_is_refused() {
        assert!(parse("M 0 0 L NaN 3").is_err());
        assert!(parse("M 0 0 L 1").is_err());
    }
}
