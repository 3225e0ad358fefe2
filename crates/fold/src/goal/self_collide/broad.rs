//! Which pairs can come near each other on a way: the broad phase.
//!
//! Each triangle is a box of six dimensions, where its corners are and where they are going; two triangles can meet if at
//! some time on the way all three gaps close. That the sheet moves as a whole costs nothing, only how its parts move
//! against each other. Each vertex and edge belongs to one of its triangles (Curtis, Tamstorf & Manocha, *Fast collision
//! detection for deformable models using representative-triangles*, 2008), so that no pair is found twice.

use super::accd::approach_mm;
use super::pair::{Gap, Pair};
use glam::{DVec2, DVec3};
use rstar::{AABB, RTree, RTreeObject, SelectionFunction};
use softfold_geometry::{FlatMesh, polygon};
use std::f64::consts::FRAC_2_PI;

/// Pairs of triangles looked at, per triangle, before a way counts as too long to be searched at once.
const CROWDED: usize = 600;

/// The sheet as its pairs see it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sheet {
    flat: Vec<DVec2>,
    /// Connected part of the sheet that each vertex is of, by its lowest vertex.
    part: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// Of each triangle the vertices and the edges that are its own.
    owned: Vec<(Vec<u32>, Vec<[u32; 2]>)>,
    /// Distances between parts that are not neighbours.
    gap: Gap,
}

/// Pairs that may matter at the places `base + t step`, 0 ≤ t ≤ 1, and around them.
pub(super) struct Candidates {
    base: Vec<DVec3>,
    /// Empty: the base alone.
    step: Vec<DVec3>,
    slack_mm: f64,
    /// Pairs with the least distance that they can have on the way beyond that of their contact, mm; in order.
    pairs: Vec<(Pair, f64)>,
}

type Box6 = AABB<[f64; 6]>;

struct Leaf {
    way: Box6,
    triangle: u32,
}

impl RTreeObject for Leaf {
    type Envelope = Box6;

    fn envelope(&self) -> Box6 {
        self.way
    }
}

/// Triangles behind one in the list that can come as near to it as `reach_mm` along each axis.
struct Meets<'a> {
    leaf: &'a Leaf,
    reach_mm: f64,
}

impl SelectionFunction<Leaf> for Meets<'_> {
    fn should_unpack_parent(&self, envelope: &Box6) -> bool {
        meet(&self.leaf.way, envelope, self.reach_mm)
    }

    fn should_unpack_leaf(&self, other: &Leaf) -> bool {
        other.triangle > self.leaf.triangle && meet(&self.leaf.way, &other.way, self.reach_mm)
    }
}

/// Whether two boxes on their ways come within `reach` of each other along all axes at one time.
fn meet(a: &Box6, b: &Box6, reach: f64) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    let mut clip = |start: f64, slope: f64| {
        // start + t slope ≥ 0
        match slope {
            s if s > 0.0 => from = from.max(-start / s),
            s if s < 0.0 => to = to.min(-start / s),
            _ if start < 0.0 => to = f64::NEG_INFINITY,
            _ => (),
        }
    };
    let (al, au, bl, bu) = (a.lower(), a.upper(), b.lower(), b.upper());
    for k in 0..3 {
        clip(reach + bu[k] - al[k], bu[k + 3] - al[k + 3]);
        clip(reach + au[k] - bl[k], au[k + 3] - bl[k + 3]);
    }
    from <= to
}

impl Sheet {
    pub(super) fn new(mesh: &FlatMesh, gap: Gap) -> Self {
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect();
        let mut owned = vec![(Vec::new(), Vec::new()); triangles.len()];
        let mut homeless = vec![true; mesh.vertices.len()];
        for (t, corners) in triangles.iter().enumerate() {
            for &v in corners {
                if std::mem::take(&mut homeless[v as usize]) {
                    owned[t].0.push(v);
                }
            }
        }
        for e in &mesh.edges {
            if let Some(t) = e.triangles[0] {
                owned[t.index()].1.push(e.vertices.map(|v| v.0));
            }
        }
        Self { flat: mesh.vertices.clone(), part: parts(mesh), triangles, owned, gap }
    }

    pub(super) fn flat(&self, vertex: u32) -> DVec2 {
        self.flat[vertex as usize]
    }

    /// The pairs that can come within their contact distance and `spare_mm` on the way from `x` by `step` (empty: at
    /// `x`), also where corners are `slack_mm` off it; none if there are too many to be looked at and the search is not `patient`.
    pub(super) fn candidates(
        &self,
        x: &[DVec3],
        step: &[DVec3],
        slack_mm: f64,
        spare_mm: f64,
        patient: bool,
    ) -> Option<Candidates> {
        let room_mm = 2.0 * slack_mm + spare_mm;
        let leaves = (0..self.triangles.len()).map(|t| self.leaf(t, x, step));
        let tree = RTree::bulk_load(leaves.collect());
        let most = if patient { usize::MAX } else { CROWDED * self.triangles.len() };
        let (mut pairs, mut seen, mut near) = (Vec::new(), 0, Vec::new());
        for t in 0..self.triangles.len() {
            let leaf = self.leaf(t, x, step);
            let meets = Meets { leaf: &leaf, reach_mm: self.gap.contact_mm + room_mm };
            near.clear();
            near.extend(tree.locate_with_selection_function(meets).map(|l| l.triangle as usize));
            near.sort_unstable();
            seen += near.len();
            if seen > most {
                return None;
            }
            for &other in &near {
                self.pairs_between(t, other, |pair| {
                    let approach = if step.is_empty() { 0.0 } else { approach_mm(&pair, step) };
                    let beyond_mm = pair.distance_mm(x) - approach - pair.gap.contact_mm;
                    if beyond_mm < room_mm {
                        pairs.push((pair, beyond_mm));
                    }
                });
            }
        }
        Some(Candidates { base: x.to_vec(), step: step.to_vec(), slack_mm, pairs })
    }

    fn leaf(&self, triangle: usize, x: &[DVec3], step: &[DVec3]) -> Leaf {
        let corners = self.triangles[triangle].map(|v| {
            let (p, d) = (x[v as usize], step.get(v as usize).copied().unwrap_or_default());
            [p.x, p.y, p.z, d.x, d.y, d.z]
        });
        Leaf { way: AABB::from_points(corners.iter()), triangle: triangle as u32 }
    }

    /// Calls `f` for the pairs of two triangles' own elements.
    fn pairs_between(&self, a: usize, b: usize, mut f: impl FnMut(Pair)) {
        for (own, other) in [(a, b), (b, a)] {
            for &v in &self.owned[own].0 {
                let [p, q, r] = self.triangles[other];
                if v != p && v != q && v != r {
                    let corners = [v, p, q, r];
                    self.gap_of(v, p, || self.flat_point_triangle(corners))
                        .into_iter()
                        .for_each(|gap| f(Pair::of_point_triangle(corners, gap)));
                }
            }
        }
        for &[i, j] in &self.owned[a].1 {
            for &[k, l] in &self.owned[b].1 {
                if i != k && i != l && j != k && j != l {
                    let corners = [i, j, k, l];
                    let length = |v: u32, w: u32| self.flat(v).distance(self.flat(w));
                    self.gap_of(i, k, || self.flat_edges(corners))
                        .into_iter()
                        .for_each(|gap| f(Pair::of_edges(corners, gap, length(i, j) * length(k, l))));
                }
            }
        }
    }

    /// The distances of a pair, by how far apart it is on the flat sheet: see the top of `self_collide`. None for lips
    /// of a slit, which lie on each other.
    fn gap_of(&self, v: u32, w: u32, flat_mm: impl Fn() -> f64) -> Option<Gap> {
        if self.part[v as usize] != self.part[w as usize] {
            return Some(self.gap);
        }
        let share = (FRAC_2_PI * flat_mm() / self.gap.contact_mm).min(1.0);
        let gap = Gap { least_mm: share * self.gap.least_mm, contact_mm: share * self.gap.contact_mm };
        (share > LEAST_SHARE).then_some(gap)
    }

    fn flat_point_triangle(&self, corners: [u32; 4]) -> f64 {
        let [p, a, b, c] = corners.map(|v| self.flat(v));
        [(a, b), (b, c), (c, a)]
            .map(|(q, r)| polygon::segment_distance(p, q, r))
            .into_iter()
            .fold(f64::MAX, f64::min)
    }

    fn flat_edges(&self, corners: [u32; 4]) -> f64 {
        let [a, b, c, d] = corners.map(|v| self.flat(v));
        [(a, c, d), (b, c, d), (c, a, b), (d, a, b)]
            .map(|(p, q, r)| polygon::segment_distance(p, q, r))
            .into_iter()
            .fold(f64::MAX, f64::min)
    }
}

/// Pairs that are this near on the flat sheet, as share of the contact distance, lie on each other: lips of a slit.
const LEAST_SHARE: f64 = 1e-6;

/// The lowest vertex of the part of the sheet that each vertex is of.
fn parts(mesh: &FlatMesh) -> Vec<u32> {
    let mut part: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    let root = |part: &[u32], mut v: u32| {
        while part[v as usize] != v {
            v = part[v as usize];
        }
        v
    };
    for e in &mesh.edges {
        let [a, b] = e.vertices.map(|v| root(&part, v.0));
        part[a.max(b) as usize] = a.min(b);
    }
    (0..part.len() as u32).map(|v| root(&part, v)).collect()
}

impl Candidates {
    /// No pairs, at `x`.
    pub(super) fn none(x: &[DVec3]) -> Self {
        Self { base: x.to_vec(), step: Vec::new(), slack_mm: 0.0, pairs: Vec::new() }
    }

    /// The pairs that can be within their contact distance and `spare_mm` at `x`, in order; none if these candidates are
    /// not all that matter there.
    pub(super) fn at(&self, x: &[DVec3], spare_mm: f64) -> Option<impl Iterator<Item = &Pair>> {
        let off_mm = self.off_mm(x);
        let room_mm = 2.0 * off_mm + spare_mm;
        let near = self.pairs.iter().filter(move |p| p.1 < room_mm).map(|p| &p.0);
        (off_mm <= self.slack_mm).then_some(near)
    }

    /// Every pair.
    pub(super) fn all(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().map(|p| &p.0)
    }

    /// How far vertices at `x` are off the way, at most, mm.
    fn off_mm(&self, x: &[DVec3]) -> f64 {
        let share = self.share_of(x);
        let way = |i: usize| self.step.get(i).map_or(DVec3::ZERO, |d| share * *d);
        let off = |(i, (b, p)): (usize, (&DVec3, &DVec3))| (*p - *b - way(i)).length_squared();
        self.base.iter().zip(x).enumerate().map(off).fold(0.0, f64::max).sqrt()
    }

    /// The place on the way that is likely `x`'s: by least squares.
    fn share_of(&self, x: &[DVec3]) -> f64 {
        let (mut along, mut length) = (0.0, 0.0);
        for ((b, p), d) in self.base.iter().zip(x).zip(&self.step) {
            along += (*p - *b).dot(*d);
            length += d.length_squared();
        }
        if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 }
    }
}
