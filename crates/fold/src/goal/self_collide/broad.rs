//! Which pairs can come near each other on a way: the broad phase.
//!
//! Near triangles are found by parry's tree of boxes (`tree.rs`), without those in windows of the sheet that bend so little that
//! nothing in them meets (`window.rs`). Each vertex and edge belongs to one of its triangles (Curtis, Tamstorf & Manocha, *Fast collision
//! detection for deformable models using representative-triangles*, 2008), so that no pair is found twice.

use super::accd::approach_mm;
use super::pair::{Gap, Pair};
use super::tree::Tree;
use super::way::Path;
use super::window::Windows;
use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, polygon};
use std::f64::consts::FRAC_2_PI;

/// Pairs of triangles looked at, per triangle, before a way counts as too long to be searched at once.
const CROWDED: usize = 600;

/// How far off a way places still count as on it, as share of the contact distance: rounding.
const SLACK: f64 = 1e-9;
/// Room for rounding in what windows promise.
const CERTAIN: f64 = 1.0 + 1e-6;

/// The sheet as its pairs see it.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    flat: Vec<DVec2>,
    /// Connected part of the sheet that each vertex is of, by its lowest vertex.
    part: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// Of each triangle the vertices and the edges that are its own.
    owned: Vec<(Vec<u32>, Vec<[u32; 2]>)>,
    /// Distances between parts that are not neighbours.
    gap: Gap,
    tree: Tree,
    windows: Windows,
}

/// Pairs that may matter at the places `base + t step`, 0 ≤ t ≤ 1.
pub(super) struct Candidates {
    base: Vec<DVec3>,
    /// Empty: the base alone.
    step: Vec<DVec3>,
    slack_mm: f64,
    /// In order.
    pairs: Vec<Pair>,
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
        let (flat, part) = (mesh.vertices.clone(), parts(mesh));
        let tree = Tree::new(triangles.clone(), &flat);
        let windows = Windows::new(mesh, &part, gap.contact_mm / FRAC_2_PI);
        Self { flat, part, triangles, owned, gap, tree, windows }
    }

    pub(super) fn flat(&self, vertex: u32) -> DVec2 {
        self.flat[vertex as usize]
    }

    /// The pairs that can come within [`Gap::within_mm`] of `spare` on the way from `x` by `step` (empty: at
    /// `x`); none if there are too many to be looked at and the search is not `patient`.
    pub(super) fn candidates(
        &self,
        x: &[DVec3],
        step: &[DVec3],
        spare: f64,
        patient: bool,
    ) -> Option<Candidates> {
        let path = Path { x, step };
        let calm = self.windows.calm(&self.triangles, path, CERTAIN * FRAC_2_PI);
        let most = if patient { usize::MAX } else { CROWDED * self.triangles.len() };
        let reach_mm = (1.0 + spare + SLACK) * self.gap.contact_mm;
        let mut pairs = Vec::new();
        for [a, b] in self.tree.pairs(path, reach_mm, |flat| calm.holds(flat), most)? {
            self.pairs_between(a as usize, b as usize, |pair| {
                let approach = if step.is_empty() { 0.0 } else { approach_mm(&pair, step) };
                let nearest_mm = pair.distance_mm(x) - approach;
                if nearest_mm < pair.gap.within_mm(spare) + SLACK * self.gap.contact_mm {
                    pairs.push(pair);
                }
            });
        }
        let slack_mm = 0.5 * SLACK * self.gap.contact_mm;
        Some(Candidates { base: x.to_vec(), step: step.to_vec(), slack_mm, pairs })
    }

    /// Calls `f` for the pairs of two triangles' own elements.
    pub(super) fn pairs_between(&self, a: usize, b: usize, mut f: impl FnMut(Pair)) {
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
        let bent_mm = FRAC_2_PI * flat_mm();
        let share = (bent_mm / self.gap.contact_mm).min(1.0);
        let gap =
            Gap { least_mm: share * self.gap.least_mm, contact_mm: share * self.gap.contact_mm, bent_mm };
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

    /// Whether these are all pairs that matter at `x`: it is on the way.
    pub(super) fn hold_at(&self, x: &[DVec3]) -> bool {
        self.off_mm(x) <= self.slack_mm
    }

    /// Every pair.
    pub(super) fn all(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter()
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
