//! What a flat cage is worth: valences, angles, and rows along the bands.

use super::background::Background;
use super::quads::Quads;
use super::rails::{SheetCorner, corners};
use glam::DVec2;
use softfold_geometry::polygon;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Angle within which an edge runs along its band, rad.
const ALONG_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Distance within which a corner of a quad is a corner of the sheet, mm: what the map leaves of a line's end.
const SAME_MM: f64 = 1e-2;

/// Cells about a sharp corner of the pattern in which the first rows take up its angle.
const BESIDE: f64 = 0.5;

/// A corner of a quad that is sharper than 45° because the sheet is, or a fold line ends so on its border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excused {
    /// Where, (u, v) in mm.
    pub at: DVec2,
    /// The quad's angle, rad.
    pub angle_rad: f64,
}

/// Figures of a flat cage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CageQuality {
    /// Quads; there are no other faces.
    pub quads: usize,
    /// Vertices that are not on the border.
    pub inner_vertices: usize,
    /// Those of them where other than four edges meet, (u, v) in mm with their valence.
    pub irregular: Vec<(DVec2, u32)>,
    /// Smallest angle of a quad in the flat sheet, rad, but for the excused; and where.
    pub min_angle_rad: f64,
    /// Its place, (u, v) in mm.
    pub min_angle_at: DVec2,
    /// Corners below 45° that the pattern forces: corners of the outline, and fold lines that run into it as sharply.
    pub excused: Vec<Excused>,
    /// Of the edges in bands that run rather along than across: the share that is within 5° of the fold lines, by
    /// length. None without bands.
    pub rows_along_bands: Option<f64>,
}

impl CageQuality {
    /// Share of the inner vertices with four edges; 1 if there are none.
    pub fn valence_4_share(&self) -> f64 {
        1.0 - self.irregular.len() as f64 / self.inner_vertices.max(1) as f64
    }
}

pub(crate) fn quality(
    ground: &Background<'_>,
    quads: &Quads,
    borders: &[Vec<u32>],
    cell_mm: f64,
) -> CageQuality {
    let mut on_border = vec![false; quads.points.len()];
    borders.iter().flatten().for_each(|&v| on_border[v as usize] = true);
    let valences = quads.valences();
    let inner = || (0..valences.len()).filter(|v| !on_border[*v]);
    let irregular = inner().filter(|v| valences[*v] != 4).map(|v| (quads.points[v], valences[v])).collect();
    let mut found = CageQuality {
        quads: quads.quads.len(),
        inner_vertices: inner().count(),
        irregular,
        min_angle_rad: f64::INFINITY,
        rows_along_bands: rows_along_bands(ground, quads),
        ..CageQuality::default()
    };
    let mut forced = corners(&ground.soft.loops);
    forced.extend(line_ends(ground));
    angles(quads, &forced, BESIDE * cell_mm, &mut found);
    found
}

/// Ends of fold lines on the border with the angle at which they run into it.
fn line_ends(ground: &Background<'_>) -> Vec<SheetCorner> {
    let at = |v: usize| ground.mesh.vertices[v];
    let mut ends = Vec::new();
    for vertices in ground.chains.iter().filter(|c| !c.closed).map(|c| &c.vertices) {
        let n = vertices.len();
        for [end, before] in [[vertices[0], vertices[1]], [vertices[n - 1], vertices[n - 2]]] {
            let line = at(before) - at(end);
            let near = ground.soft.loops.iter().map(|c| (c, c.nearest(at(end))));
            let Some((curve, (s_mm, off))) = near.min_by(|a, b| a.1.1.total_cmp(&b.1.1)) else { continue };
            if off < SAME_MM {
                let angle = curve.tangent(s_mm).angle_to(line).abs();
                ends.push(SheetCorner { at: at(end), angle_rad: angle.min(std::f64::consts::PI - angle) });
            }
        }
    }
    ends
}

fn angles(quads: &Quads, corners: &[SheetCorner], near_mm: f64, found: &mut CageQuality) {
    let sharp = |p: DVec2| corners.iter().any(|c| c.angle_rad < FRAC_PI_4 && c.at.distance(p) < near_mm);
    for q in 0..quads.quads.len() {
        for k in 0..4 {
            let (angle_rad, at) = (quads.angle(q, k), quads.points[quads.quads[q][k] as usize]);
            if angle_rad < FRAC_PI_4 && sharp(at) {
                found.excused.push(Excused { at, angle_rad });
            } else if angle_rad < found.min_angle_rad {
                (found.min_angle_rad, found.min_angle_at) = (angle_rad, at);
            }
        }
    }
}

fn rows_along_bands(ground: &Background<'_>, quads: &Quads) -> Option<f64> {
    let (mut along_mm, mut all_mm) = (0.0, 0.0);
    for [a, b] in quads.edges() {
        let [a, b] = [a, b].map(|v| quads.points[v as usize]);
        let Some(direction) = band_direction(ground, 0.5 * (a + b)) else { continue };
        let off = direction.angle_to(b - a).abs();
        let off = off.min(std::f64::consts::PI - off);
        if off < 0.5 * FRAC_PI_2 {
            all_mm += a.distance(b);
            along_mm += if off <= ALONG_RAD { a.distance(b) } else { 0.0 };
        }
    }
    (all_mm > 0.0).then(|| along_mm / all_mm)
}

/// Direction of the nearest fold line at a point that is in a band: between its outermost lines, so that it is nearer to
/// one of its lines than a strip is wide, and has lines on both sides or on itself.
fn band_direction(ground: &Background<'_>, p: DVec2) -> Option<DVec2> {
    let mut best: Option<(f64, DVec2)> = None;
    for band in &ground.soft.bands {
        let width = band.strip_width_mm();
        let mut sides = [false; 2];
        let mut nearest: Option<(f64, DVec2)> = None;
        for line in &band.fold_lines {
            let near = line.points.windows(2).map(|w| (polygon::segment_distance(p, w[0], w[1]), w[0], w[1]));
            let Some((d, a, b)) = near.min_by(|x, y| x.0.total_cmp(&y.0)) else { continue };
            let side = (b - a).perp_dot(p - a);
            let on = d <= 1e-3 * (1.0 + width);
            sides[0] |= side >= 0.0 || on;
            sides[1] |= side <= 0.0 || on;
            if nearest.is_none_or(|n| d < n.0) {
                nearest = Some((d, b - a));
            }
        }
        if let Some(n) =
            nearest.filter(|n| sides == [true; 2] && n.0 <= width.max(1e-3) && best.is_none_or(|b| n.0 < b.0))
        {
            best = Some(n);
        }
    }
    best.map(|b| b.1)
}
