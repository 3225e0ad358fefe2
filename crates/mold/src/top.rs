//! The sheet's surface as triangles, fine where it is curved.

use crate::error::{During, MoldError};
use crate::samples::TrimIndex;
use glam::{DVec2, DVec3};
use softfold_geometry::{PlanarCurve, RigidTransform, SheetSurface, UniformBicubic};
use softfold_kernel::cgal;
use std::collections::{BTreeSet, HashMap};

/// A lattice cell is cut into at most this many steps a side: at 10 mm cells that is 0.15 mm.
const MOST_STEPS: f64 = 64.0;
/// Where the sheet is flat, points stand at most this many lattice cells apart.
const MOST_STRIDE: usize = 8;
/// A border starts in pieces of this many lattice cells: about a fold's width, so that none is overlooked.
const BORDER_CELLS: f64 = 4.0;
/// A border piece is halved at most this often: a thousandth of a lattice cell.
const MOST_HALVINGS: usize = 10;
/// Inner points keep this share of their own spacing from the border, so that no needles stand on it.
const BORDER_CLEARANCE: f64 = 0.45;
/// Share of the chord error that the border keeps: parts are held to their volume, and the border is all of its error.
const BORDER_SHARE: f64 = 0.2;

/// An open triangle mesh in space that is a graph over the plan unless the sheet hangs over.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Patch {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// A triangulation of the sheet's (u, v) inside its trim.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FlatPatch {
    pub(crate) points: Vec<DVec2>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Triangulates the trimmed surface: constrained Delaunay in (u, v), points as dense as the second derivatives ask for.
///
/// Between points at steps (a, b) a linear triangle leaves `(a²|S_uu| + 2ab|S_uv| + b²|S_vv|)/8` along the normal; the
/// steps give each direction half of `chord_mm`. The border is halved until its chords keep a fifth of that in space.
pub(crate) fn triangulate(
    sheet: &SheetSurface,
    index: &TrimIndex,
    chord_mm: f64,
) -> Result<Patch, MoldError> {
    let flat = flat_triangles(sheet, index, chord_mm)?;
    let positions = flat.points.iter().map(|&p| sheet.spline.at(p).position).collect();
    Ok(Patch { positions, triangles: flat.triangles })
}

/// The same before it is lifted into space.
pub(crate) fn flat_triangles(
    sheet: &SheetSurface,
    index: &TrimIndex,
    chord_mm: f64,
) -> Result<FlatPatch, MoldError> {
    let mut points = Vec::new();
    let mut constraints = Vec::new();
    for curve in &sheet.trim {
        let first = points.len() as u32;
        points.extend(border(&sheet.spline, curve, BORDER_SHARE * chord_mm));
        let end = points.len() as u32;
        constraints.extend((first..end).map(|i| [i, if i + 1 == end { first } else { i + 1 }]));
    }
    points.extend(inner(&sheet.spline, index, chord_mm));
    let flat: Vec<[f64; 2]> = points.iter().map(DVec2::to_array).collect();
    let cdt = cgal::constrained_delaunay(&flat, &constraints).during(|| "triangles of the sheet".into())?;
    let borders: BTreeSet<[u32; 2]> = cdt.constraints.iter().map(|c| sorted(c.vertices)).collect();
    let triangles = inside(&cdt.triangles, &borders);
    let points: Vec<DVec2> = cdt.points.iter().map(|&p| p.into()).collect();
    let (points, triangles) = compacted(&points, &triangles);
    Ok(FlatPatch { points, triangles })
}

/// Without the points that no triangle uses.
fn compacted<T: Copy>(points: &[T], triangles: &[[u32; 3]]) -> (Vec<T>, Vec<[u32; 3]>) {
    let mut renamed = vec![u32::MAX; points.len()];
    let mut kept = Vec::new();
    let mut rename = |i: u32| {
        if renamed[i as usize] == u32::MAX {
            renamed[i as usize] = kept.len() as u32;
            kept.push(points[i as usize]);
        }
        renamed[i as usize]
    };
    let triangles = triangles.iter().map(|t| t.map(&mut rename)).collect();
    (kept, triangles)
}

/// Points along a border curve, the first not repeated.
fn border(surface: &UniformBicubic, curve: &PlanarCurve, chord_mm: f64) -> Vec<DVec2> {
    let mut points = Vec::new();
    for joint in curve.joints_mm().windows(2) {
        let n = ((joint[1] - joint[0]) / (BORDER_CELLS * surface.spacing_mm)).ceil().max(1.0);
        let s = |k: f64| joint[0] + (joint[1] - joint[0]) * k / n;
        for k in 0..n as usize {
            halve(surface, curve, [s(k as f64), s(k as f64 + 1.0)], chord_mm, MOST_HALVINGS, &mut points);
        }
    }
    points
}

/// Pushes the points of the piece without its end.
fn halve(
    surface: &UniformBicubic,
    curve: &PlanarCurve,
    [from, to]: [f64; 2],
    chord_mm: f64,
    halvings: usize,
    points: &mut Vec<DVec2>,
) {
    let at = |share: f64| surface.at(curve.point(from + share * (to - from))).position;
    let (a, b) = (at(0.0), at(1.0));
    let off = [0.25, 0.5, 0.75].map(|share| at(share).distance(a.lerp(b, share)));
    if halvings > 0 && off.into_iter().fold(0.0, f64::max) > chord_mm {
        let middle = 0.5 * (from + to);
        halve(surface, curve, [from, middle], chord_mm, halvings - 1, points);
        halve(surface, curve, [middle, to], chord_mm, halvings - 1, points);
    } else {
        points.push(curve.point(from));
    }
}

/// Points inside the trim, cell by cell of the surface's lattice. Where one step is more than the error needs, only every
/// second, fourth or eighth corner is kept.
fn inner(surface: &UniformBicubic, index: &TrimIndex, chord_mm: f64) -> Vec<DVec2> {
    let (lower, _) = surface.domain();
    let h = surface.spacing_mm;
    let mut points = Vec::new();
    for i in 0..surface.count[0] - 3 {
        for j in 0..surface.count[1] - 3 {
            let corner = lower + h * DVec2::new(i as f64, j as f64);
            let wanted = steps(surface, corner, chord_mm);
            if (i | j) % stride(wanted) != 0 {
                continue;
            }
            let steps = wanted.ceil().clamp(DVec2::ONE, DVec2::splat(MOST_STEPS));
            let step = DVec2::splat(h) / steps;
            let clear_mm = BORDER_CLEARANCE * step.min_element();
            for k in 0..(steps.x * steps.y) as usize {
                let p = corner + step * DVec2::new((k as f64 / steps.y).floor(), k as f64 % steps.y);
                if index.contains(p) && !index.border_within(p, clear_mm) {
                    points.push(p);
                }
            }
        }
    }
    points
}

/// The largest power of two, up to [`MOST_STRIDE`], at which these steps a cell are still enough.
fn stride(steps: DVec2) -> usize {
    let mut stride = 1;
    while stride < MOST_STRIDE && 2.0 * stride as f64 * steps.max_element() <= 1.0 {
        stride *= 2;
    }
    stride
}

/// Into how many steps a lattice cell is to be cut each way: a fraction where less would do.
fn steps(surface: &UniformBicubic, corner: DVec2, chord_mm: f64) -> DVec2 {
    let mut bends = DVec2::ZERO;
    for k in 0..9 {
        let p = surface.at(corner + 0.5 * surface.spacing_mm * DVec2::new((k / 3) as f64, (k % 3) as f64));
        let [uu, uv, vv] = p.second.map(|s| s.dot(p.normal()).abs());
        bends = bends.max(DVec2::new(uu + uv, vv + uv));
    }
    let share = 0.5 * chord_mm;
    DVec2::new(bends.x.sqrt(), bends.y.sqrt()) * surface.spacing_mm / (8.0 * share).sqrt()
}

/// The triangles inside the border: every crossing of a constraint changes between outside and inside.
fn inside(triangles: &[[u32; 3]], borders: &BTreeSet<[u32; 2]>) -> Vec<[u32; 3]> {
    let mut sides: HashMap<[u32; 2], [usize; 2]> = HashMap::with_capacity(2 * triangles.len());
    for (t, triangle) in triangles.iter().enumerate() {
        for edge in edges(triangle) {
            sides.entry(sorted(edge)).or_insert([usize::MAX; 2])[usize::from(edge[0] > edge[1])] = t;
        }
    }
    let mut inside: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut todo: Vec<(usize, bool)> = Vec::new();
    for (t, triangle) in triangles.iter().enumerate() {
        let hull = edges(triangle).into_iter().map(sorted).find(|e| sides[e].contains(&usize::MAX));
        todo.extend(hull.map(|e| (t, borders.contains(&e))));
    }
    while let Some((t, is_inside)) = todo.pop() {
        if inside[t].replace(is_inside).is_some() {
            continue;
        }
        for edge in edges(&triangles[t]).map(sorted) {
            let [a, b] = sides[&edge];
            let other = if a == t { b } else { a };
            if other != usize::MAX && inside[other].is_none() {
                todo.push((other, is_inside != borders.contains(&edge)));
            }
        }
    }
    triangles.iter().zip(&inside).filter(|(_, i)| **i == Some(true)).map(|(t, _)| *t).collect()
}

impl Patch {
    /// The same in another place.
    pub(crate) fn moved(&self, to: &RigidTransform) -> Self {
        let positions = self.positions.iter().map(|p| to.point(*p)).collect();
        Self { positions, triangles: self.triangles.clone() }
    }

    /// Without the vertices that no triangle uses.
    pub(crate) fn compact(&self) -> Self {
        let (positions, triangles) = compacted(&self.positions, &self.triangles);
        Self { positions, triangles }
    }

    /// Signed area in plan, mm².
    pub(crate) fn plan_area_mm2(&self) -> f64 {
        self.triangles.iter().map(|t| self.plan_area_of(t)).sum()
    }

    /// Signed area of one triangle in plan, mm².
    pub(crate) fn plan_area_of(&self, triangle: &[u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|i| self.positions[i as usize].truncate());
        0.5 * (b - a).perp_dot(c - a)
    }

    /// The directed edges that only one triangle has.
    pub(crate) fn border_edges(&self) -> Vec<[u32; 2]> {
        let all: std::collections::HashSet<[u32; 2]> = self.triangles.iter().flat_map(edges).collect();
        self.triangles.iter().flat_map(edges).filter(|&[a, b]| !all.contains(&[b, a])).collect()
    }
}

pub(crate) fn edges(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

pub(crate) fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn patch(sheet: &SheetSurface, chord_mm: f64) -> Patch {
        triangulate(sheet, &TrimIndex::new(sheet).unwrap(), chord_mm).unwrap()
    }

    #[test]
    fn a_flat_ellipse_with_a_hole_has_its_area_and_border() {
        let mut sheet = shapes::flat(shapes::ellipse(150.0, 90.0));
        sheet.trim.push(shapes::ellipse(40.0, 30.0).reversed());
        let exact: f64 = sheet.trim.iter().map(|c| c.signed_area_mm2()).sum();
        let p = patch(&sheet, 0.01);
        assert!((p.plan_area_mm2() / exact - 1.0).abs() < 1e-4);
        let v = p.positions.len() as i64;
        let f = p.triangles.len() as i64;
        let e = (3 * f + p.border_edges().len() as i64) / 2;
        assert_eq!(v - e + f, 0, "a ring");
    }

    #[test]
    fn the_chord_error_is_kept() {
        let sheet = shapes::corrugation(shapes::ellipse(150.0, 90.0));
        let p = patch(&sheet, 0.02);
        let wave = std::f64::consts::TAU / 300.0;
        let worst = p.triangles.iter().map(|t| {
            let c = t.map(|i| p.positions[i as usize]).iter().sum::<DVec3>() / 3.0;
            (25.0 * (wave * (c.x + 0.2 * c.y)).sin() - c.z).abs()
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 0.03, "{worst}");
        assert!(p.triangles.len() < 12_000, "{}", p.triangles.len());
    }
}
