//! Cutting a patch along vertical planes, and giving it thickness.

use crate::top::{Patch, edges, sorted};
use glam::{DVec2, DVec3};
use softfold_geometry::TriMesh;
use std::collections::HashMap;

/// Vertices nearer to a plane than this are moved onto it, mm: far below any tolerance of a print, far above rounding.
const ON_PLANE_MM: f64 = 1e-6;

/// An axis of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    X,
    Y,
}

impl Axis {
    fn of(self, p: DVec3) -> f64 {
        self.of2(p.truncate())
    }

    pub(crate) fn of2(self, p: DVec2) -> f64 {
        match self {
            Axis::X => p.x,
            Axis::Y => p.y,
        }
    }

    fn set(self, p: &mut DVec3, value: f64) {
        match self {
            Axis::X => p.x = value,
            Axis::Y => p.y = value,
        }
    }
}

/// The same patch with vertices wherever the vertical plane `axis = value` meets it, so that no triangle crosses it.
/// One pass over the triangles; an edge is cut once, whichever triangle comes to it first.
pub(crate) fn cut(patch: Patch, axis: Axis, value: f64) -> Patch {
    let Patch { mut positions, triangles } = patch;
    for p in positions.iter_mut().filter(|p| (axis.of(**p) - value).abs() < ON_PLANE_MM) {
        axis.set(p, value);
    }
    let mut made: HashMap<[u32; 2], u32> = HashMap::new();
    let mut pieces = Vec::with_capacity(triangles.len());
    for triangle in triangles {
        let side = triangle.map(|i| axis.of(positions[i as usize]) - value);
        if side.iter().all(|s| *s >= 0.0) || side.iter().all(|s| *s <= 0.0) {
            pieces.push(triangle);
            continue;
        }
        let mut crossing = |edge: [u32; 2]| {
            *made.entry(sorted(edge)).or_insert_with(|| {
                let [a, b] = sorted(edge).map(|i| positions[i as usize]);
                let share = (value - axis.of(a)) / (axis.of(b) - axis.of(a));
                let mut p = a.lerp(b, share);
                axis.set(&mut p, value);
                positions.push(p);
                positions.len() as u32 - 1
            })
        };
        pieces.extend(halves(triangle, side, &mut crossing));
    }
    Patch { positions, triangles: pieces }
}

/// The two or three pieces of a triangle with corners on both sides, given the vertex on each crossing edge.
fn halves(triangle: [u32; 3], side: [f64; 3], crossing: &mut impl FnMut([u32; 2]) -> u32) -> Vec<[u32; 3]> {
    // Turn it so that the first corner is the one on the plane, or else the one alone on its side.
    let alone = |i: usize| side[i] * side[(i + 1) % 3] < 0.0 && side[i] * side[(i + 2) % 3] < 0.0;
    let first = (0..3).find(|&i| side[i] == 0.0).or_else(|| (0..3).find(|&i| alone(i))).unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|k| triangle[(first + k) % 3]);
    if side[first] == 0.0 {
        let m = crossing([b, c]);
        return vec![[a, b, m], [a, m, c]];
    }
    let (m, n) = (crossing([a, b]), crossing([a, c]));
    vec![[a, m, n], [m, b, c], [m, c, n]]
}

/// A patch cut along a grid.
pub(crate) struct CutPatch {
    whole: Patch,
    /// Column and row of each square that is not empty, and its triangles.
    pub(crate) cells: Vec<([usize; 2], Vec<[u32; 3]>)>,
}

impl CutPatch {
    /// Cuts a patch into the squares of a grid that starts at `origin` and covers it.
    pub(crate) fn new(patch: Patch, origin: DVec2, cell_mm: f64, count: [usize; 2]) -> Self {
        let lines = |n: usize| (1..n).map(move |k| k as f64 * cell_mm);
        let cut_x = lines(count[0]).fold(patch, |p, x| cut(p, Axis::X, origin.x + x));
        let whole = lines(count[1]).fold(cut_x, |p, y| cut(p, Axis::Y, origin.y + y));
        let mut cells: Vec<_> =
            (0..count[0] * count[1]).map(|k| ([k / count[1], k % count[1]], Vec::new())).collect();
        for t in &whole.triangles {
            let center = t.map(|i| whole.positions[i as usize].truncate()).iter().sum::<DVec2>() / 3.0;
            let place = ((center - origin) / cell_mm).floor().max(DVec2::ZERO);
            let column = (place.x as usize).min(count[0] - 1);
            let row = (place.y as usize).min(count[1] - 1);
            cells[column * count[1] + row].1.push(*t);
        }
        cells.retain(|(_, triangles)| !triangles.is_empty());
        Self { whole, cells }
    }

    /// The piece in these squares (numbers in `cells`), joined.
    pub(crate) fn piece(&self, members: &[usize]) -> Patch {
        let triangles = members.iter().flat_map(|&m| self.cells[m].1.iter().copied()).collect();
        Patch { positions: self.whole.positions.clone(), triangles }.compact()
    }
}

/// The closed solid between a patch and the same patch `thickness_mm` lower.
pub(crate) fn thicken(patch: &Patch, thickness_mm: f64) -> TriMesh {
    solid_down_to(patch, |p| p - DVec3::Z * thickness_mm)
}

/// The closed solid between a patch and its image straight below: the patch on top, its mirror below, a wall of two
/// triangles under each border edge.
pub(crate) fn solid_down_to(patch: &Patch, below: impl Fn(DVec3) -> DVec3) -> TriMesh {
    solid_between(patch, patch.positions.iter().map(|p| below(*p)))
}

/// The same down to given places, one for each vertex.
pub(crate) fn solid_between(patch: &Patch, bottom: impl IntoIterator<Item = DVec3>) -> TriMesh {
    let n = patch.positions.len() as u32;
    let positions = patch.positions.iter().copied().chain(bottom).collect();
    let mut triangles = patch.triangles.clone();
    triangles.extend(patch.triangles.iter().map(|&[a, b, c]| [a + n, c + n, b + n]));
    for [a, b] in patch.border_edges() {
        triangles.extend([[b, a, a + n], [b, a + n, b + n]]);
    }
    TriMesh { positions, triangles }
}

/// How many pieces hang together by edges.
pub(crate) fn piece_count(patch: &Patch) -> usize {
    let mut parent: Vec<u32> = (0..patch.positions.len() as u32).collect();
    for [a, b] in patch.triangles.iter().flat_map(edges) {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b) as usize] = a.min(b);
    }
    (0..parent.len() as u32).filter(|&i| parent[i as usize] == i).count()
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{samples::TrimIndex, shapes, top::triangulate};
    use softfold_geometry::SheetSurface;

    fn patch(sheet: &SheetSurface) -> Patch {
        triangulate(sheet, &TrimIndex::new(sheet).unwrap(), 0.05).unwrap()
    }

    fn pieces(
        sheet: &SheetSurface,
        origin: DVec2,
        cell_mm: f64,
        count: [usize; 2],
    ) -> Vec<([usize; 2], Patch)> {
        let cut = CutPatch::new(patch(sheet), origin, cell_mm, count);
        (0..cut.cells.len()).map(|k| (cut.cells[k].0, cut.piece(&[k]))).collect()
    }

    #[test]
    fn pieces_keep_the_area_and_stay_in_their_squares() {
        let sheet = shapes::corrugation(shapes::ellipse(150.0, 90.0));
        let area = patch(&sheet).plan_area_mm2();
        let origin = DVec2::new(-161.0, -97.0);
        let pieces = pieces(&sheet, origin, 70.0, [5, 3]);
        let sum: f64 = pieces.iter().map(|(_, p)| p.plan_area_mm2()).sum();
        assert!((sum / area - 1.0).abs() < 1e-12);
        for ([i, j], p) in &pieces {
            let lower = origin + 70.0 * DVec2::new(*i as f64, *j as f64) - 1e-9;
            let fits =
                |q: &DVec3| q.truncate().cmpge(lower).all() && q.truncate().cmple(lower + 70.0 + 2e-9).all();
            assert!(p.positions.iter().all(fits));
        }
    }

    #[test]
    fn an_inner_square_is_exact() {
        let sheet = shapes::corrugation(shapes::rectangle(300.0, 300.0));
        let pieces = pieces(&sheet, DVec2::splat(-150.0), 100.0, [3, 3]);
        let inner = &pieces.iter().find(|(k, _)| *k == [1, 1]).unwrap().1;
        assert!((inner.plan_area_mm2() - 1e4).abs() < 1e-8);
        assert!((thicken(inner, 50.0).volume_mm3() - 5e5).abs() < 1e-6);
    }

    #[test]
    fn neighbours_share_their_cut() {
        let pieces = pieces(
            &shapes::cylinder(shapes::rectangle(200.0, 100.0)),
            DVec2::new(-150.0, -60.0),
            150.0,
            [2, 1],
        );
        let on_cut = |p: &Patch| {
            let mut ends: Vec<_> = p.positions.iter().filter(|q| q.x == 0.0).map(|q| q.to_array()).collect();
            ends.sort_by(|a, b| a[1].total_cmp(&b[1]));
            ends
        };
        assert_eq!(pieces.len(), 2);
        assert!(on_cut(&pieces[0].1).len() > 5);
        assert_eq!(on_cut(&pieces[0].1), on_cut(&pieces[1].1));
    }

    #[test]
    fn joined_squares_are_one_piece_again() {
        let sheet = shapes::corrugation(shapes::ellipse(150.0, 90.0));
        let cut = CutPatch::new(patch(&sheet), DVec2::new(-161.0, -97.0), 70.0, [5, 3]);
        let all: Vec<usize> = (0..cut.cells.len()).collect();
        assert_eq!(piece_count(&cut.piece(&all)), 1);
        assert_eq!(piece_count(&cut.piece(&[0, cut.cells.len() - 1])), 2);
    }

    #[test]
    fn a_thick_patch_is_closed() {
        let p = patch(&shapes::cylinder(shapes::ellipse(100.0, 60.0)));
        let solid = thicken(&p, 20.0);
        let whole = Patch { positions: solid.positions.clone(), triangles: solid.triangles.clone() };
        assert!(whole.border_edges().is_empty());
        assert!((solid.volume_mm3() / (20.0 * p.plan_area_mm2()) - 1.0).abs() < 1e-12);
        assert_eq!(piece_count(&p), 1);
    }
}
