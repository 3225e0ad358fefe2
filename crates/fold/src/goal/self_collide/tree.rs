//! Which triangles come near each other on a way: parry's tree of boxes over patches of the sheet, refitted to each way.
//!
//! parry's boxes stand still: each bounds what its patch passes through, as seen by one who moves with the sheet on the mean.
//! Patches whose boxes meet are looked at more closely, as boxes on their way (`way.rs`), and so are their triangles. A leaf is a
//! patch and not a triangle because parry cannot be told which branches to leave out: most pairs of leaves that meet are
//! neighbours that surely do not come near each other, and of patches there are few. So it is as fast as a tree of boxes with
//! motions that leaves branches out.

use super::way::{Path, Way};
use glam::{DVec2, DVec3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use std::cell::OnceCell;

/// Triangles of a patch, at most.
const PATCH: usize = 8;
/// Room for rounding in the boxes, as share of the reach.
const ROUNDING: f64 = 1e-6;

/// Lower and upper corner on the flat sheet.
pub(super) type Rectangle = [DVec2; 2];

#[derive(Clone, Debug)]
struct Patch {
    triangles: Vec<u32>,
    /// The vertices of those, once each.
    vertices: Vec<u32>,
    flat: Rectangle,
}

/// The tree: made once, over the flat sheet.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    triangles: Vec<[u32; 3]>,
    /// Of each triangle.
    flat: Vec<Rectangle>,
    patches: Vec<Patch>,
    boxes: Bvh,
}

fn union(a: Rectangle, b: Rectangle) -> Rectangle {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn around(rectangles: impl Iterator<Item = Rectangle>) -> Rectangle {
    rectangles.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], union)
}

/// Around points.
pub(super) fn bounds(points: impl Iterator<Item = DVec2>) -> Rectangle {
    around(points.map(|p| [p; 2]))
}

fn aabb(lower: DVec3, upper: DVec3) -> Aabb {
    // parry has a glam of its own.
    Aabb::new(lower.to_array().into(), upper.to_array().into())
}

impl Tree {
    /// Of triangles by their corners, whose places on the flat sheet are `flat`.
    pub(super) fn new(triangles: Vec<[u32; 3]>, flat: &[DVec2]) -> Self {
        let of_triangle = |t: &[u32; 3]| bounds(t.iter().map(|v| flat[*v as usize]));
        let flat: Vec<Rectangle> = triangles.iter().map(of_triangle).collect();
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut parts = Vec::new();
        halve(&mut order, &flat, &mut parts);
        let patch = |own: Vec<u32>| {
            let mut vertices: Vec<u32> = own.iter().flat_map(|t| triangles[*t as usize]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            Patch { vertices, flat: around(own.iter().map(|t| flat[*t as usize])), triangles: own }
        };
        let patches: Vec<Patch> = parts.into_iter().map(patch).collect();
        let leaf = |p: &Patch| aabb(p.flat[0].extend(0.0), p.flat[1].extend(0.0));
        let boxes = Bvh::from_leaves(BvhBuildStrategy::Binned, &patches.iter().map(leaf).collect::<Vec<_>>());
        Self { triangles, flat, patches, boxes }
    }

    /// The pairs of triangles, ascending, that come within `reach` of each other along each axis at one time, save those in a
    /// rectangle of the flat sheet of which `apart` says that it does not meet itself; none if there are more than `most`.
    pub(super) fn pairs(
        &self,
        path: Path<'_>,
        reach: f64,
        apart: impl Fn(Rectangle) -> bool,
        most: usize,
    ) -> Option<Vec<[u32; 2]>> {
        let ways: Vec<Way> = self.patches.iter().map(|p| path.around(&p.vertices)).collect();
        // Those of a patch's triangles: of most patches they are not asked for.
        let finer: Vec<OnceCell<Vec<Way>>> = vec![OnceCell::new(); ways.len()];
        let of_triangles = |k: usize| {
            let way = |t: &u32| path.around(&self.triangles[*t as usize]);
            finer[k].get_or_init(|| self.patches[k].triangles.iter().map(way).collect())
        };
        let mut pairs = Vec::new();
        let mut look = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|k| k as usize);
            let [first, second] = [a, b].map(|k| &self.patches[k]);
            let met = a == b || ways[a].meets(&ways[b], reach);
            if !met || pairs.len() > most || apart(union(first.flat, second.flat)) {
                return;
            }
            for (&i, way) in first.triangles.iter().zip(of_triangles(a)) {
                for (&j, other) in second.triangles.iter().zip(of_triangles(b)) {
                    let flat = || union(self.flat[i as usize], self.flat[j as usize]);
                    if (a != b || i < j) && way.meets(other, reach) && !apart(flat()) {
                        pairs.push([i.min(j), i.max(j)]);
                    }
                }
            }
        };
        (0..ways.len() as u32).for_each(|k| look(k, k));
        let boxes = self.refitted(&ways, path.drift(), reach);
        boxes.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut look);
        if pairs.len() > most {
            return None;
        }
        pairs.sort_unstable();
        Some(pairs)
    }

    /// parry's tree around what the patches pass through, with half of `reach` on all sides.
    fn refitted(&self, ways: &[Way], drift: DVec3, reach: f64) -> Bvh {
        let mut boxes = self.boxes.clone();
        let half = DVec3::splat((0.5 + ROUNDING) * reach);
        for (k, way) in ways.iter().enumerate() {
            let [lower, upper] = way.swept(drift);
            boxes.insert_or_update_partially(aabb(lower - half, upper + half), k as u32, 0.0);
        }
        boxes.refit_without_opt();
        boxes
    }
}

/// Parts of the flat sheet of up to [`PATCH`] triangles, by halving.
fn halve(own: &mut [u32], flat: &[Rectangle], parts: &mut Vec<Vec<u32>>) {
    if own.len() <= PATCH {
        if !own.is_empty() {
            parts.push(own.to_vec());
        }
        return;
    }
    let of = |t: u32| flat[t as usize];
    let [lower, upper] = around(own.iter().map(|t| of(*t)));
    let size = upper - lower;
    let middle = |t: u32| {
        let sum = of(t)[0] + of(t)[1];
        if size.x > size.y { sum.x } else { sum.y }
    };
    let half = own.len() / 2;
    own.select_nth_unstable_by(half, |a, b| middle(*a).total_cmp(&middle(*b)).then(a.cmp(b)));
    let (first, second) = own.split_at_mut(half);
    halve(first, flat, parts);
    halve(second, flat, parts);
}
