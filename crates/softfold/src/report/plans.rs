//! Plans as SVG: the pattern, its bands, how the board stands, the mold's parts and boards.

use crate::export::svg::{Anchor, Size, Style, Svg};
use softfold_geometry::{CreasePattern, DVec2, Role, SoftPattern, polygon};

/// Free border around a plan, as share of its larger side.
const MARGIN: f64 = 0.04;
/// Size of labels, as share of the plan's larger side.
const LABEL: f64 = 0.022;
const INK: &str = "#26282d";
const SHEET: &str = "#f3efe6";
const GREY: &str = "#8a8f99";
/// Mountain red, valley blue: the usual colours of crease patterns.
const MOUNTAIN: &str = "#c8322b";
const VALLEY: &str = "#2566b0";
const UNDECIDED: &str = "#8d4fb0";
const SAFE: &str = "#2f8f5b";
const SAFE_FILL: &str = "#d8efe1";
const PART_FILL: &str = "#e4ecf7";
const BOARD: &str = "#a86a1f";
const BOARD_FILL: &str = "#f5e8d2";

/// One printed part on the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanPart {
    /// Its name.
    pub name: String,
    /// Its outline from above, mm.
    pub outline: Vec<DVec2>,
}

/// One board of the waffle on the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanBoard {
    /// Its name.
    pub name: String,
    /// Its ends from above, mm.
    pub ends: [DVec2; 2],
}

/// One stock sheet with the boards that are cut from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StockSheet {
    /// Its size, mm.
    pub size_mm: DVec2,
    /// Names and outlines of what is cut, from the sheet's lower left corner, mm.
    pub cuts: Vec<(String, Vec<DVec2>)>,
}

/// The pattern as it was read: outline, holes, creases in the colours of their roles.
pub fn pattern_svg(pattern: &CreasePattern) -> String {
    let mut svg = around_curves(pattern.loops().map(|(_, c)| c));
    svg.curves(pattern.loops().map(|(_, c)| c), Style::line(INK, 1.6).fill(SHEET));
    let size = svg.extent_mm() * LABEL;
    for crease in &pattern.creases {
        svg.begin_group(&crease.name);
        svg.curves([&crease.curve], role_style(crease.role));
        let at = crease.curve.point(0.5 * crease.curve.length_mm());
        svg.label(
            at + DVec2::splat(0.4 * size),
            size,
            Anchor::Start,
            role_style(crease.role).stroke,
            &crease.name,
        );
        svg.end_group();
    }
    svg.finish(Size::Millimetres)
}

/// The softened pattern: every fold line of every band.
pub fn soft_pattern_svg(soft: &SoftPattern) -> String {
    let mut svg = around_curves(&soft.loops);
    svg.curves(&soft.loops, Style::line(INK, 1.6).fill(SHEET));
    for band in &soft.bands {
        let Some((steepest, softest)) = band.steepest().zip(band.softest()) else { continue };
        let colour = if steepest.fold_angle_rad < 0.0 { MOUNTAIN } else { VALLEY };
        svg.begin_group(&format!("crease {}, radius {:.1} mm", band.crease, softest.radius_mm));
        band.fold_lines.iter().for_each(|l| svg.polyline(&l.points, Style::line(colour, 0.8)));
        svg.end_group();
    }
    svg.finish(Size::Millimetres)
}

fn around_curves<'a>(curves: impl IntoIterator<Item = &'a softfold_geometry::PlanarCurve>) -> Svg {
    let controls: Vec<_> =
        curves.into_iter().flat_map(|c| c.segments()).flat_map(|s| s.control_points()).collect();
    Svg::around(&controls, MARGIN)
}

fn role_style(role: Role) -> Style<'static> {
    match role {
        Role::Mountain => Style::line(MOUNTAIN, 1.8).dashed("9 3 2 3"),
        Role::Valley => Style::line(VALLEY, 1.8).dashed("7 4"),
        Role::Unassigned => Style::line(UNDECIDED, 1.5).dashed("2 3"),
        Role::Flat => Style::line(GREY, 1.0),
        Role::Boundary | Role::Cut => Style::line(INK, 1.6),
    }
}

/// How the board stands, from above: footprint, contact hull, barycenter and the way to the nearest edge.
pub fn stability_svg(hull: &[DVec2], barycenter: DVec2, footprint: &[DVec2]) -> String {
    let all: Vec<_> = hull.iter().chain(footprint).copied().chain([barycenter]).collect();
    let mut svg = Svg::around(&all, 2.0 * MARGIN);
    let size = svg.extent_mm() * LABEL;
    svg.polygon(footprint, Style::line(GREY, 1.0).fill(SHEET));
    let stands = hull.len() > 2 && polygon::contains(hull, barycenter);
    let colour = if stands { SAFE } else { MOUNTAIN };
    svg.polygon(hull, Style::line(colour, 1.6).fill(if stands { SAFE_FILL } else { "none" }));
    if let Some(edge) = nearest_on_border(hull, barycenter) {
        svg.polyline(&[barycenter, edge], Style::line(colour, 1.2).dashed("4 3"));
        let text = format!("{:.0} mm", barycenter.distance(edge));
        svg.label(0.5 * (barycenter + edge) + DVec2::splat(0.5 * size), size, Anchor::Start, colour, &text);
    }
    svg.circle(barycenter, 0.4 * size, Style::filled(INK));
    svg.label(barycenter + DVec2::new(0.0, -1.6 * size), size, Anchor::Middle, INK, "barycenter");
    svg.finish(Size::Fluid)
}

fn nearest_on_border(hull: &[DVec2], p: DVec2) -> Option<DVec2> {
    let foot = |(a, b): (DVec2, DVec2)| {
        let d = b - a;
        let t = if d.length_squared() > 0.0 {
            ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        a + t * d
    };
    polygon::edges(hull).map(foot).min_by(|a, b| p.distance(*a).total_cmp(&p.distance(*b)))
}

/// The mold from above: the sheet's outlines, the printed parts with their names, the boards below them.
pub fn parts_svg(parts: &[PlanPart], outlines: &[Vec<DVec2>], boards: &[PlanBoard]) -> String {
    let points = parts.iter().flat_map(|p| &p.outline).chain(outlines.iter().flatten());
    let all: Vec<_> = points.copied().chain(boards.iter().flat_map(|b| b.ends)).collect();
    let mut svg = Svg::around(&all, MARGIN);
    let size = svg.extent_mm() * LABEL;
    parts.iter().for_each(|p| svg.polygon(&p.outline, Style::line(VALLEY, 1.0).fill(PART_FILL)));
    boards.iter().for_each(|b| svg.polyline(&b.ends, Style::line(BOARD, 1.4).dashed("8 4")));
    outlines.iter().for_each(|o| svg.polygon(o, Style::line(INK, 1.4)));
    parts.iter().for_each(|p| svg.label(middle(&p.outline), size, Anchor::Middle, INK, &p.name));
    for board in boards {
        // Before the board's start, so that boards which start at one point keep their names apart.
        let before = (board.ends[0] - board.ends[1]).normalize_or_zero() * size;
        let lowered = DVec2::new(0.0, -0.3 * size);
        svg.label(board.ends[0] + before + lowered, 0.8 * size, Anchor::Middle, BOARD, &board.name);
    }
    svg.finish(Size::Fluid)
}

/// The stock sheets one above the other, with the boards nested on them.
pub fn boards_svg(sheets: &[StockSheet]) -> String {
    /// Gap between sheets, as share of a sheet's height.
    const GAP: f64 = 0.06;
    let mut top = 0.0;
    let mut placed = Vec::new();
    for sheet in sheets {
        top -= sheet.size_mm.y;
        placed.push((DVec2::new(0.0, top), sheet));
        top -= GAP * sheet.size_mm.y;
    }
    let width = sheets.iter().map(|s| s.size_mm.x).fold(1.0, f64::max);
    let mut svg = Svg::around(&[DVec2::ZERO, DVec2::new(width, top.min(-1.0))], 0.5 * MARGIN);
    for (corner, sheet) in placed {
        draw_stock(&mut svg, corner, sheet);
    }
    svg.finish(Size::Fluid)
}

fn draw_stock(svg: &mut Svg, corner: DVec2, sheet: &StockSheet) {
    let DVec2 { x, y } = sheet.size_mm;
    let frame = [(0., 0.), (x, 0.), (x, y), (0., y)].map(|p| corner + DVec2::from(p));
    svg.polygon(&frame, Style::line(GREY, 1.0).fill(SHEET));
    let size = sheet.size_mm.max_element() * 0.8 * LABEL;
    for (name, outline) in &sheet.cuts {
        let outline: Vec<_> = outline.iter().map(|p| corner + *p).collect();
        svg.polygon(&outline, Style::line(BOARD, 1.0).fill(BOARD_FILL));
        svg.label(middle(&outline), size, Anchor::Middle, INK, name);
    }
}

/// Where a label stands well: the area's centre.
fn middle(outline: &[DVec2]) -> DVec2 {
    let (lo, hi) = polygon::bounds(outline);
    let area = polygon::signed_area_mm2(outline);
    let origin = 0.5 * (lo + hi);
    if area == 0.0 {
        return origin;
    }
    let moment = |(a, b): (DVec2, DVec2)| (a + b - 2.0 * origin) * (a - origin).perp_dot(b - origin) / 6.0;
    origin + polygon::edges(outline).map(moment).sum::<DVec2>() / area
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(at: f64) -> Vec<DVec2> {
        [(0., 0.), (100., 0.), (100., 100.), (0., 100.)].map(|p| DVec2::from(p) + at).to_vec()
    }

    #[test]
    fn the_way_to_the_nearest_edge_is_the_margin() {
        let svg = stability_svg(&square(0.0), DVec2::new(80.0, 50.0), &square(0.0));
        assert!(svg.contains(">20 mm</text>"));
        assert!(svg.contains(SAFE_FILL));
        assert!(!stability_svg(&square(0.0), DVec2::new(180.0, 50.0), &[]).contains(SAFE_FILL));
    }

    #[test]
    fn parts_and_boards_carry_their_names() {
        let parts = [PlanPart { name: "A<1>".into(), outline: square(0.0) }];
        let boards = [PlanBoard { name: "X1".into(), ends: [DVec2::ZERO, DVec2::ONE] }];
        let svg = parts_svg(&parts, &[square(3.0)], &boards);
        assert!(svg.contains("A&lt;1&gt;") && svg.contains("X1"));
        let stock = StockSheet { size_mm: DVec2::new(1250., 2500.), cuts: vec![("X1".into(), square(5.0))] };
        assert_eq!(boards_svg(&[stock.clone(), stock]).matches("X1").count(), 2);
    }

    #[test]
    fn the_middle_of_a_triangle_is_its_centroid() {
        let m = middle(&[DVec2::ZERO, DVec2::new(3., 0.), DVec2::new(0., 3.)]);
        assert!(m.distance(DVec2::ONE) < 1e-12);
    }

    #[test]
    fn a_plan_of_nothing_is_still_a_picture() {
        for svg in [stability_svg(&[], DVec2::ZERO, &[]), parts_svg(&[], &[], &[]), boards_svg(&[])] {
            assert!(svg.starts_with("<svg") && !svg.contains("NaN"), "{svg}");
        }
    }
}
