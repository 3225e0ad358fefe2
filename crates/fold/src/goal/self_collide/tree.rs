//! Which triangles come near each other on a way: a tree of boxes over the flat sheet, whose boxes in space are made anew for
//! each search.
//!
//! A box has six dimensions, where the corners are and where they are going; two boxes meet if at some time on the way all
//! three gaps close. That the sheet moves as a whole costs nothing, only how its parts move against each other.

use glam::{DVec2, DVec3};

/// Triangles of a leaf.
const LEAF: usize = 4;

/// A box on its way: bounds of the places at the start, then of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    lower: [f64; 6],
    upper: [f64; 6],
}

impl Way {
    const NONE: Self = Self { lower: [f64::INFINITY; 6], upper: [f64::NEG_INFINITY; 6] };

    /// Of corners with their motions.
    pub(super) fn around(corners: [(DVec3, DVec3); 3]) -> Self {
        let point = |(p, d): (DVec3, DVec3)| [p.x, p.y, p.z, d.x, d.y, d.z];
        corners.map(point).into_iter().fold(Self::NONE, |w, p| w.with(&Self { lower: p, upper: p }))
    }

    fn with(self, other: &Self) -> Self {
        let mut both = self;
        for k in 0..6 {
            both.lower[k] = both.lower[k].min(other.lower[k]);
            both.upper[k] = both.upper[k].max(other.upper[k]);
        }
        both
    }

    /// Whether two boxes come within `reach` of each other along all axes at one time.
    fn meets(&self, other: &Self, reach: f64) -> bool {
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
        let (al, au, bl, bu) = (&self.lower, &self.upper, &other.lower, &other.upper);
        for k in 0..3 {
            clip(reach + bu[k] - al[k], bu[k + 3] - al[k + 3]);
            clip(reach + au[k] - bl[k], au[k + 3] - bl[k + 3]);
        }
        from <= to
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    /// Lower and upper corner on the flat sheet.
    flat: [DVec2; 2],
    /// Its triangles, in the tree's order.
    range: [usize; 2],
    /// The first child is the next node; none for a leaf.
    second_child: Option<usize>,
}

/// The tree: made once, by halving the flat sheet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    order: Vec<u32>,
    nodes: Vec<Node>,
    /// Of each triangle lower and upper corner on the flat sheet.
    flat: Vec<[DVec2; 2]>,
}

fn union(a: [DVec2; 2], b: [DVec2; 2]) -> [DVec2; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

impl Tree {
    /// Over boxes on the flat sheet, one for each triangle.
    pub(super) fn new(flat: Vec<[DVec2; 2]>) -> Self {
        let mut tree = Self { order: (0..flat.len() as u32).collect(), nodes: Vec::new(), flat };
        if !tree.flat.is_empty() {
            tree.grow([0, tree.flat.len()]);
        }
        tree
    }

    fn grow(&mut self, range: [usize; 2]) {
        let [from, to] = range;
        let own = &mut self.order[from..to];
        let of = |t: u32| self.flat[t as usize];
        let flat = own.iter().map(|t| of(*t)).fold([DVec2::INFINITY, DVec2::NEG_INFINITY], union);
        let node = self.nodes.len();
        self.nodes.push(Node { flat, range, second_child: None });
        if own.len() <= LEAF {
            return;
        }
        let size = flat[1] - flat[0];
        let middle = |t: u32| if size.x > size.y { of(t)[0].x + of(t)[1].x } else { of(t)[0].y + of(t)[1].y };
        let half = own.len() / 2;
        own.select_nth_unstable_by(half, |a, b| middle(*a).total_cmp(&middle(*b)).then(a.cmp(b)));
        self.grow([from, from + half]);
        self.nodes[node].second_child = Some(self.nodes.len());
        self.grow([from + half, to]);
    }

    fn boxes(&self, ways: &[Way]) -> Vec<Way> {
        let mut boxes = vec![Way::NONE; self.nodes.len()];
        for (k, node) in self.nodes.iter().enumerate().rev() {
            boxes[k] = match node.second_child {
                Some(second) => boxes[k + 1].with(&boxes[second]),
                None => self.own(k).iter().fold(Way::NONE, |w, t| w.with(&ways[*t as usize])),
            };
        }
        boxes
    }

    fn own(&self, node: usize) -> &[u32] {
        let [from, to] = self.nodes[node].range;
        &self.order[from..to]
    }

    /// The pairs of triangles, ascending, that come within `reach` of each other along each axis at one time, save those in a
    /// rectangle of the flat sheet of which `apart` says that it does not meet itself; none if there are more than `most`.
    pub(super) fn pairs(
        &self,
        ways: &[Way],
        reach: f64,
        apart: impl Fn([DVec2; 2]) -> bool,
        most: usize,
    ) -> Option<Vec<[u32; 2]>> {
        let (boxes, mut pairs) = (self.boxes(ways), Vec::new());
        let mut open = if self.nodes.is_empty() { Vec::new() } else { vec![(0, 0)] };
        while let Some((a, b)) = open.pop() {
            let (first, second) = (&self.nodes[a], &self.nodes[b]);
            if !boxes[a].meets(&boxes[b], reach) || apart(union(first.flat, second.flat)) {
                continue;
            }
            let count = |n: &Node| n.range[1] - n.range[0];
            match (first.second_child, second.second_child) {
                (Some(child), _) if a == b => open.extend([(a + 1, a + 1), (child, child), (a + 1, child)]),
                (Some(child), other) if other.is_none() || count(first) >= count(second) => {
                    open.extend([(a + 1, b), (child, b)]);
                }
                (_, Some(child)) => open.extend([(a, b + 1), (a, child)]),
                _ => {
                    let near = |i: u32, j: u32| {
                        let [i, j] = [i, j].map(|t| t as usize);
                        ways[i].meets(&ways[j], reach) && !apart(union(self.flat[i], self.flat[j]))
                    };
                    for &i in self.own(a) {
                        let others = self.own(b).iter().filter(|j| (a != b || i < **j) && near(i, **j));
                        pairs.extend(others.map(|&j| [i.min(j), i.max(j)]));
                    }
                    if pairs.len() > most {
                        return None;
                    }
                }
            }
        }
        pairs.sort_unstable();
        Some(pairs)
    }
}
