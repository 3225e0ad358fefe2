//! The drawing as a planar graph: edges that are single segments between nodes, each knowing which stretches of
//! which strokes it stands for.

use crate::drawing::Stroke;
use crate::error::Origin;
use softfold_geometry::{DVec2, Role, Segment};
use std::collections::BTreeSet;

/// Fold angles that differ by less are one, rad: the rounding of decimals in files.
const SAME_ANGLE_RAD: f64 = 1e-6;

/// One subpath of a stroke, cleaned.
#[derive(Clone, Debug)]
pub(super) struct Subpath {
    /// Number of its stroke.
    pub(super) stroke: usize,
    /// Its segments; each is longer than the join tolerance.
    pub(super) segments: Vec<Segment>,
    /// Its arc length.
    pub(super) length_mm: f64,
    /// Whether it ends where it starts.
    pub(super) closed: bool,
}

/// What was drawn.
#[derive(Debug)]
pub(super) struct Drawing<'a> {
    pub(super) strokes: &'a [Stroke],
    /// In the order of the file.
    pub(super) subpaths: Vec<Subpath>,
}

/// A stretch of a subpath: positions are number of the segment plus its parameter, and fall along edges that run
/// against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Source {
    pub(super) subpath: u32,
    pub(super) range: [f64; 2],
}

/// A segment between two nodes.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) segment: Segment,
    pub(super) nodes: [u32; 2],
    pub(super) role: Role,
    pub(super) fold_angle_rad: Option<f64>,
    /// Where it came from, in the order of the file; empty for edges that nobody drew.
    pub(super) sources: Vec<Source>,
    /// Made outline by the user's word or for want of a drawn one: Boundary whatever its sources are.
    pub(super) rim: bool,
}

/// Edges between nodes; they share no points but nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    pub(super) points: Vec<DVec2>,
    pub(super) edges: Vec<Edge>,
}

/// An edge seen from one of its ends: it leaves there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Half {
    pub(super) edge: u32,
    pub(super) side: u8,
}

impl Half {
    pub(super) fn new(edge: usize, side: usize) -> Self {
        Self { edge: edge as u32, side: side as u8 }
    }

    pub(super) fn edge(self) -> usize {
        self.edge as usize
    }

    pub(super) fn side(self) -> usize {
        usize::from(self.side)
    }

    /// The same edge from its other end.
    pub(super) fn twin(self) -> Self {
        Self { edge: self.edge, side: 1 - self.side }
    }

    /// Position in arrays with two entries for each edge.
    pub(super) fn index(self) -> usize {
        2 * self.edge() + self.side()
    }
}

impl Source {
    /// Where the stretch begins along its subpath.
    pub(super) fn begin(&self) -> f64 {
        self.range[0].min(self.range[1])
    }

    /// Order of the file.
    pub(super) fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.subpath.cmp(&other.subpath).then(self.begin().total_cmp(&other.begin()))
    }

    /// The stretch of a part of the edge.
    pub(super) fn part(&self, [from, to]: [f64; 2]) -> Self {
        let [a, b] = self.range;
        Self { range: [from, to].map(|t| a + t * (b - a)), ..*self }
    }

    /// The stretch seen from the other side.
    pub(super) fn reversed(&self) -> Self {
        Self { range: [self.range[1], self.range[0]], ..*self }
    }
}

/// Whether lines of this role are folded: mountains, valleys and what is not decided.
pub(super) fn folds(role: Role) -> bool {
    matches!(role, Role::Mountain | Role::Valley | Role::Unassigned)
}

impl Edge {
    /// Whether it is outline, hole or slit.
    pub(super) fn is_rim(&self) -> bool {
        matches!(self.role, Role::Boundary | Role::Cut)
    }

    /// The edge run through from one of its ends.
    pub(super) fn run(&self, side: usize) -> Segment {
        if side == 0 { self.segment } else { self.segment.reversed() }
    }
}

impl Graph {
    /// The halves that leave each node, in the order of the edges.
    pub(super) fn leaving(&self) -> Vec<Vec<Half>> {
        let mut leaving = vec![Vec::new(); self.points.len()];
        for (i, e) in self.edges.iter().enumerate() {
            for side in 0..2 {
                leaving[e.nodes[side] as usize].push(Half::new(i, side));
            }
        }
        leaving
    }

    /// Node that a half leaves.
    pub(super) fn node(&self, h: Half) -> usize {
        self.edges[h.edge()].nodes[h.side()] as usize
    }

    /// Where a half leaves.
    pub(super) fn point(&self, h: Half) -> DVec2 {
        self.points[self.node(h)]
    }

    /// The segment of a half, run through from where it leaves.
    pub(super) fn run(&self, h: Half) -> Segment {
        self.edges[h.edge()].run(h.side())
    }
}

impl Drawing<'_> {
    /// The stroke of a stretch.
    pub(super) fn stroke(&self, drawn: &Source) -> &Stroke {
        &self.strokes[self.subpaths[drawn.subpath as usize].stroke]
    }

    /// Role and fold angle of an edge that stands for these stretches, and whether they contradict each other:
    /// boundary wins over cuts, cuts over creases, folded creases over flat ones, decided ones over undecided
    /// ones; a contradiction leaves the crease undecided.
    pub(super) fn resolve(&self, sources: &[Source]) -> (Role, Option<f64>, bool) {
        let roles: BTreeSet<Role> = sources.iter().map(|s| self.stroke(s).role).collect();
        for role in [Role::Boundary, Role::Cut] {
            if roles.contains(&role) || roles.is_empty() {
                return (role, None, false);
            }
        }
        if roles.contains(&Role::Mountain) && roles.contains(&Role::Valley) {
            return (Role::Unassigned, None, true);
        }
        let ranked = [Role::Mountain, Role::Valley, Role::Unassigned];
        let role = ranked.into_iter().find(|r| roles.contains(r)).unwrap_or(Role::Flat);
        let of_role = sources.iter().map(|s| self.stroke(s)).filter(|s| s.role == role);
        let angles: Vec<f64> = of_role.filter_map(|s| s.fold_angle_rad).collect();
        let least = angles.iter().copied().min_by(f64::total_cmp);
        match angles.iter().all(|a| least.is_some_and(|l| a - l <= SAME_ANGLE_RAD)) {
            true => (role, least, false),
            false => (Role::Unassigned, None, true),
        }
    }

    /// The element that an edge goes by: the first of the file that has its role, else the first.
    pub(super) fn origin(&self, edge: &Edge) -> Origin {
        self.primary(edge).map(|s| self.stroke(s).origin.clone()).unwrap_or_default()
    }

    /// The stretch that an edge goes by.
    pub(super) fn primary<'e>(&self, edge: &'e Edge) -> Option<&'e Source> {
        let of_role = edge.sources.iter().find(|s| self.stroke(s).role == edge.role);
        of_role.or(edge.sources.first())
    }
}
