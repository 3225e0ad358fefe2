//! Names and orientation dots on the underside of parts.

use crate::error::{MoldError, Setting};
use crate::glyphs;
use crate::height::HeightField;
use crate::tool::Region;
use crate::waffle::Groove;
use glam::DVec2;

/// Strokes are cut into pieces of this length to follow the slope, mm: on a radius of 30 mm they leave 0.02 mm.
const PIECE_MM: f64 = 2.0;
/// Marks keep this far from edges, mm: a wall that prints.
const EDGE_MM: f64 = 4.0;
/// Marks keep this far from grooves, mm: a wall that prints.
const GROOVE_WALL_MM: f64 = 2.0;
/// Places for a mark are tried on a lattice of this spacing, mm: a third of the text's height.
const TRY_MM: f64 = 4.0;
/// If the text does not fit anywhere it is tried at these sizes.
const SIZES: [f64; 3] = [1.0, 0.75, 0.5];
/// Corners of an orientation dot.
const DOT_CORNERS: usize = 12;
/// A dot's centre lies this far from the text's lines, in strokes: half a stroke, its own radius of one, and a wall.
const DOT_GAP: f64 = 2.7;
/// Strokes of smaller names shrink less than the names: a wall of two perimeters is the least that prints.
const LEAST_STROKE_SHARE: f64 = 0.7;
/// A block of marks is looked at in this many places each way.
const LOOKS: usize = 6;
/// Distance over which the underside's slope is measured, mm.
const SLOPE_MM: f64 = 0.5;

/// How parts are marked: the name, legible from below with +X to the right; one dot at its +X side and two at its +Y
/// side (below the name, as one looks at it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkOptions {
    /// Height of the letters, mm.
    pub text_mm: f64,
    /// Width of the strokes, mm.
    pub stroke_mm: f64,
    /// Depth of the strokes, along z, mm.
    pub depth_mm: f64,
}

impl Default for MarkOptions {
    /// Three perimeters of a 0.4 mm nozzle wide, deep enough to feel.
    fn default() -> Self {
        Self { text_mm: 12.0, stroke_mm: 1.2, depth_mm: 1.0 }
    }
}

impl MarkOptions {
    pub(crate) fn check(&self) -> Result<(), MoldError> {
        Setting::inner("height of the part names (mm)").positive(self.text_mm)?;
        Setting::inner("stroke of the part names (mm)").positive(self.stroke_mm)?;
        Setting::inner("depth of the part names (mm)").positive(self.depth_mm)
    }
}

/// A rectangle in the plan, by its centre.
struct Block {
    center: DVec2,
    half: DVec2,
}

/// The regions to cut for a name somewhere on the underside, as near to the middle as there is room; none if there is no
/// room at half the size either. `sheet` is the part's own upper side.
pub(crate) fn regions(
    name: &str,
    sheet: &HeightField<'_>,
    middle: DVec2,
    reach_mm: f64,
    grooves: &[Groove],
    thickness_mm: f64,
    options: &MarkOptions,
) -> Vec<Region> {
    for size in SIZES {
        let text_mm = size * options.text_mm;
        let stroke_mm = size.max(LEAST_STROKE_SHARE) * options.stroke_mm;
        let half = half_size(name, text_mm, stroke_mm);
        let free = |c: &DVec2| Block { center: *c, half }.is_free(sheet, grooves);
        let Some(center) = places(middle, reach_mm).into_iter().find(free) else { continue };
        let shapes = shapes(name, text_mm, stroke_mm);
        let cut = |corners: Vec<DVec2>| {
            let mirrored = corners.iter().rev().map(|c| center + DVec2::new(c.x, -c.y)).collect();
            follow(mirrored, sheet, options.depth_mm - thickness_mm)
        };
        return shapes.into_iter().filter_map(cut).collect();
    }
    Vec::new()
}

/// Half the size of name and dots together, which are centred about the name's middle.
fn half_size(name: &str, text_mm: f64, stroke_mm: f64) -> DVec2 {
    let name_half = 0.5 * DVec2::new(glyphs::width_mm(name, text_mm), text_mm);
    name_half + (DOT_GAP + 1.0) * stroke_mm
}

/// Convex pieces of strokes and dots about the middle of the name, y up as one reads.
fn shapes(name: &str, text_mm: f64, stroke_mm: f64) -> Vec<Vec<DVec2>> {
    let size = DVec2::new(glyphs::width_mm(name, text_mm), text_mm);
    let mut shapes = Vec::new();
    for line in glyphs::text(name, text_mm) {
        for w in line.windows(2) {
            let n = (w[0].distance(w[1]) / PIECE_MM).ceil().max(1.0) as usize;
            let at = |k: usize| w[0].lerp(w[1], k as f64 / n as f64) - 0.5 * size;
            let half = 0.5 * stroke_mm;
            // Square ends: strokes overlap where they meet.
            shapes.extend((0..n).map(|k| Region::around(at(k), at(k + 1), half, half)));
        }
    }
    let gap = DOT_GAP * stroke_mm;
    let dots = [
        DVec2::new(0.5 * size.x + gap, 0.0),
        DVec2::new(-gap, -0.5 * size.y - gap),
        DVec2::new(gap, -0.5 * size.y - gap),
    ];
    shapes.extend(dots.map(|center| dot(center, stroke_mm)));
    shapes
}

fn dot(center: DVec2, radius_mm: f64) -> Vec<DVec2> {
    let turn = std::f64::consts::TAU / DOT_CORNERS as f64;
    (0..DOT_CORNERS).map(|k| center + radius_mm * DVec2::from_angle(turn * k as f64)).collect()
}

/// A region whose plane is the tangent plane of the upper side, moved by `shift_mm`.
fn follow(corners: Vec<DVec2>, sheet: &HeightField<'_>, shift_mm: f64) -> Option<Region> {
    let at = corners.iter().sum::<DVec2>() / corners.len() as f64;
    let rise =
        |d: DVec2| Some((sheet.at(at + SLOPE_MM * d)? - sheet.at(at - SLOPE_MM * d)?) / (2.0 * SLOPE_MM));
    let slope = DVec2::new(rise(DVec2::X)?, rise(DVec2::Y)?);
    Some(Region { corners, at, height_mm: sheet.at(at)? + shift_mm, slope })
}

/// Lattice places around `middle`, the nearest first.
fn places(middle: DVec2, reach_mm: f64) -> Vec<DVec2> {
    let n = (reach_mm / TRY_MM).ceil() as i64;
    let mut steps: Vec<(i64, i64)> = (-n..=n).flat_map(|i| (-n..=n).map(move |j| (i, j))).collect();
    steps.sort_by_key(|(i, j)| (i * i + j * j, *i, *j));
    steps.iter().map(|&(i, j)| middle + TRY_MM * DVec2::new(i as f64, j as f64)).collect()
}

impl Block {
    fn is_free(&self, sheet: &HeightField<'_>, grooves: &[Groove]) -> bool {
        let off_grooves = grooves.iter().all(|g| !g.meets(self.center, self.half, GROOVE_WALL_MM));
        let reach = self.half + EDGE_MM;
        let share = |k: usize| 2.0 * k as f64 / (LOOKS - 1) as f64 - 1.0;
        let look = |k: usize| self.center + reach * DVec2::new(share(k / LOOKS), share(k % LOOKS));
        off_grooves && (0..LOOKS * LOOKS).all(|k| sheet.at(look(k)).is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tool::tool;
    use crate::top::Patch;
    use glam::DVec3;
    use softfold_kernel::{MeshView, cgal};

    /// A tilted square of 100 mm.
    fn tilted() -> Patch {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.3 * x - 0.2 * y);
        let positions = vec![corner(-50., -50.), corner(50., -50.), corner(50., 50.), corner(-50., 50.)];
        Patch { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] }
    }

    #[test]
    fn every_letter_makes_a_closed_tool_at_every_size() {
        let patch = tilted();
        let field = HeightField::new(&patch);
        for letter in ('0'..='9').chain('A'..='Z') {
            for size in SIZES {
                let text_mm = size * MarkOptions::default().text_mm;
                let options = MarkOptions { text_mm, ..Default::default() };
                let cut = regions(&letter.to_string(), &field, DVec2::ZERO, 10.0, &[], 20.0, &options);
                let mesh = tool(&cut, -60.0).unwrap();
                let positions: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
                let view = MeshView { positions: &positions, triangles: &mesh.triangles };
                let found = cgal::closed_check(view).unwrap();
                assert!(
                    found.closed && found.manifold && found.outward,
                    "{letter} at {text_mm} mm: {found:?}"
                );
            }
        }
    }

    #[test]
    fn strokes_follow_the_slope_at_their_depth() {
        let patch = tilted();
        let field = HeightField::new(&patch);
        let options = MarkOptions::default();
        for region in regions("A12", &field, DVec2::ZERO, 10.0, &[], 20.0, &options) {
            let underside = 0.3 * region.at.x - 0.2 * region.at.y - 20.0;
            assert!((region.height_mm - underside - options.depth_mm).abs() < 1e-9);
            assert!(region.slope.distance(DVec2::new(0.3, -0.2)) < 1e-9);
        }
    }

    #[test]
    fn a_name_is_read_from_below_with_x_to_the_right() {
        let patch = tilted();
        let field = HeightField::new(&patch);
        let cut = regions("L", &field, DVec2::ZERO, 10.0, &[], 20.0, &MarkOptions::default());
        let middle = |r: &Region| r.corners.iter().sum::<DVec2>() / r.corners.len() as f64;
        let strokes: Vec<DVec2> = cut.iter().filter(|r| r.corners.len() == 4).map(middle).collect();
        // Seen from below y points down: the stem of the L is at the left, its foot at the largest y.
        let foot = strokes.iter().filter(|p| p.y > 5.0).map(|p| p.x).fold(f64::MIN, f64::max);
        let top = strokes.iter().filter(|p| p.y < -3.0).map(|p| p.x).fold(f64::MIN, f64::max);
        assert!(foot > 2.0 && top < -3.0, "{foot} {top}");
        let dots: Vec<DVec2> = cut.iter().filter(|r| r.corners.len() == DOT_CORNERS).map(middle).collect();
        assert_eq!(dots.iter().filter(|d| d.x > 5.0 && d.y.abs() < 1e-9).count(), 1, "one at +X");
        assert_eq!(dots.iter().filter(|d| d.y > 7.0).count(), 2, "two at +Y");
    }

    #[test]
    fn no_room_gives_no_mark() {
        let patch = Patch { positions: tilted().positions.iter().map(|p| *p * 0.2).collect(), ..tilted() };
        let field = HeightField::new(&patch);
        assert!(regions("A1", &field, DVec2::ZERO, 10.0, &[], 20.0, &MarkOptions::default()).is_empty());
    }
}
