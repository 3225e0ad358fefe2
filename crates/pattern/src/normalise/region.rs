//! Areas between closed curves: what is inside, and how far the border is.

use super::contour;
use super::model::{Edge, Graph, Half};
use super::split::{self, EdgeChord};
use rstar::{AABB, RTree};
use softfold_geometry::{DVec2, Tolerance};
use std::collections::BTreeMap;

/// The inside of closed curves; curves inside others are holes.
pub(super) struct Region {
    chords: RTree<EdgeChord>,
    /// Number of the loop of each edge in the tree.
    owner: Vec<usize>,
    right: f64,
}

impl Region {
    /// The inside of these loops.
    pub(super) fn new<'l>(
        graph: &Graph,
        loops: impl IntoIterator<Item = &'l Vec<Half>>,
        tolerance: &Tolerance,
    ) -> Self {
        let (mut edges, mut owner): (Vec<Edge>, Vec<usize>) = (Vec::new(), Vec::new());
        for (i, l) in loops.into_iter().enumerate() {
            edges.extend(l.iter().map(|h| graph.edges[h.edge()].clone()));
            owner.resize(edges.len(), i);
        }
        let chords = split::tree(&edges, tolerance);
        let right = chords.iter().flat_map(|c| c.chord.ends).map(|p| p.x).fold(f64::NEG_INFINITY, f64::max);
        Self { chords, owner, right }
    }

    /// Loops whose chords a ray to the right of a point crosses, once for each crossing.
    fn crossed(&self, p: DVec2) -> impl Iterator<Item = usize> + '_ {
        let ray = AABB::from_corners(p.to_array(), [self.right.max(p.x), p.y]);
        let hit = move |c: &&EdgeChord| {
            let [a, b] = c.chord.ends;
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.chords.locate_in_envelope_intersecting(ray).filter(hit).map(|c| self.owner[c.edge])
    }

    /// Whether a point is inside (even-odd rule).
    pub(super) fn contains(&self, p: DVec2) -> bool {
        self.crossed(p).count() % 2 == 1
    }

    /// The loops around a point, by number.
    pub(super) fn around(&self, p: DVec2) -> Vec<usize> {
        let mut crossings: BTreeMap<usize, usize> = BTreeMap::new();
        self.crossed(p).for_each(|l| *crossings.entry(l).or_default() += 1);
        crossings.into_iter().filter(|(_, n)| n % 2 == 1).map(|(l, _)| l).collect()
    }

    /// Distance of a point from the border.
    pub(super) fn distance(&self, p: DVec2) -> f64 {
        let near = self.chords.nearest_neighbor_with_distance_2(p.to_array());
        near.map_or(f64::INFINITY, |(_, d)| d.sqrt())
    }
}

/// Loops by falling area; those of the same area by place.
pub(super) fn by_area(graph: &Graph, loops: Vec<Vec<Half>>) -> Vec<Vec<Half>> {
    let keyed = |l: Vec<Half>| (contour::area(graph, &l), l.iter().map(|h| graph.node(*h)).min(), l);
    let mut keyed: Vec<_> = loops.into_iter().map(keyed).collect();
    keyed.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    keyed.into_iter().map(|(_, _, l)| l).collect()
}

/// For each loop, how many of the others are around it.
pub(super) fn depths(graph: &Graph, loops: &[Vec<Half>], tolerance: &Tolerance) -> Vec<usize> {
    let region = Region::new(graph, loops, tolerance);
    let depth = |(i, l): (usize, &Vec<Half>)| {
        let inner = super::segment::at(&graph.edges[l[0].edge()].segment, 0.5);
        region.around(inner).into_iter().filter(|&o| o != i).count()
    };
    loops.iter().enumerate().map(depth).collect()
}
