//! Whether bands and junction regions reach each other, themselves, or the boundary.

use crate::boundary::Boundary;
use crate::shape::{Part, Shape};
use rstar::{AABB, RTree, RTreeObject};
use softfold_geometry::{DVec2, FoldLine, LineEnd, polygon};

/// What takes room on the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Owner {
    /// The band of the crease with this number.
    Band(usize),
    /// The region of the meeting with this number.
    Region(usize),
}

/// A straight piece of the edge of a band or a region.
#[derive(Clone, Copy, Debug)]
struct Piece {
    ends: [DVec2; 2],
    owner: Owner,
    /// Start and end of the line that it belongs to, if that is sharp.
    sharp: Option<[DVec2; 2]>,
}

/// A soft stretch or a region, for what lies in it without touching its edge.
#[derive(Clone, Debug)]
struct Area {
    low: DVec2,
    high: DVec2,
    owner: Owner,
    /// Number of the part of a band.
    part: usize,
    /// A point of each edge, or in it: edges that do not cross those of another area lie in it or out of it
    /// as a whole.
    inside: Vec<DVec2>,
}

/// The region at a meeting.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub(crate) point: DVec2,
    pub(crate) polygon: Vec<DVec2>,
    pub(crate) on_boundary: bool,
}

/// Where two owners reach each other; the first comes first in order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub(crate) owners: [Owner; 2],
    pub(crate) at: DVec2,
}

/// Bands and regions that can be asked for contacts.
#[derive(Clone, Debug)]
pub(crate) struct Crowd<'a> {
    shapes: Vec<(usize, &'a Shape)>,
    regions: Vec<(usize, &'a Region)>,
    pieces: RTree<Piece>,
    areas: RTree<Area>,
    slack_mm: f64,
}

impl RTreeObject for Piece {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.ends[0].to_array(), self.ends[1].to_array())
    }
}

impl RTreeObject for Area {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.low.to_array(), self.high.to_array())
    }
}

impl<'a> Crowd<'a> {
    /// Bands by crease and regions by meeting, both ascending.
    pub(crate) fn new(
        shapes: Vec<(usize, &'a Shape)>,
        regions: Vec<(usize, &'a Region)>,
        slack_mm: f64,
    ) -> Self {
        let mut pieces = Vec::new();
        let mut areas = Vec::new();
        for (i, shape) in &shapes {
            for (number, part) in shape.parts.iter().enumerate() {
                pieces_of(*i, shape, part, &mut pieces);
                areas.push(area_of(*i, shape, part, number));
            }
        }
        for (j, region) in regions.iter().filter(|(_, r)| !r.polygon.is_empty()) {
            let owner = Owner::Region(*j);
            pieces.extend(polygon::edges(&region.polygon).map(|(a, b)| Piece {
                ends: [a, b],
                owner,
                sharp: None,
            }));
            let (low, high) = polygon::bounds(&region.polygon);
            // Star-shaped about its point.
            let inside = vec![0.5 * (region.point + region.polygon[0])];
            areas.push(Area { low, high, owner, part: 0, inside });
        }
        Self { shapes, regions, pieces: RTree::bulk_load(pieces), areas: RTree::bulk_load(areas), slack_mm }
    }

    /// The first contact of two of these, or of one with itself.
    pub(crate) fn contact(&self) -> Option<Contact> {
        self.contact_with(self, |a, b| a <= b)
    }

    /// The first contact of one of these with one of the others that is asked for.
    pub(crate) fn contact_with(
        &self,
        others: &Crowd<'_>,
        asked: impl Fn(Owner, Owner) -> bool,
    ) -> Option<Contact> {
        let mut found: Vec<Contact> = Vec::new();
        for a in &self.pieces {
            for b in others.pieces.locate_in_envelope_intersecting(a.envelope()) {
                if asked(a.owner, b.owner) {
                    found.extend(self.crossing(a, b).map(|at| contact(a.owner, b.owner, at)));
                }
            }
        }
        for a in &self.areas {
            for b in others.areas.locate_in_envelope_intersecting(a.envelope()) {
                let other = a.owner != b.owner || a.part != b.part;
                if other && (asked(a.owner, b.owner) || asked(b.owner, a.owner)) {
                    let mut mine = a.inside.iter().filter(|p| others.has(b, **p));
                    let mut theirs = b.inside.iter().filter(|p| self.has(a, **p));
                    let at = mine.next().or_else(|| theirs.next());
                    found.extend(at.map(|at| contact(a.owner, b.owner, *at)));
                }
            }
        }
        let key = |c: &Contact| (c.owners, c.at.x, c.at.y);
        found.into_iter().min_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2))
        })
    }

    /// Where two pieces cross, other than in an end that they share.
    fn crossing(&self, a: &Piece, b: &Piece) -> Option<DVec2> {
        if a.ends.iter().any(|p| b.ends.contains(p)) {
            return None;
        }
        let (t, _) = polygon::segment_crossing(a.ends[0], a.ends[1], b.ends[0], b.ends[1])?;
        let at = a.ends[0].lerp(a.ends[1], t);
        // Sharp creases may end in one point of the boundary, within tolerance.
        let ends_here =
            |p: &Piece| p.sharp.is_some_and(|e| e.iter().any(|e| e.distance(at) <= self.slack_mm));
        (!(ends_here(a) && ends_here(b))).then_some(at)
    }

    fn has(&self, area: &Area, p: DVec2) -> bool {
        match area.owner {
            Owner::Band(i) => self
                .shapes
                .binary_search_by_key(&i, |s| s.0)
                .is_ok_and(|k| self.shapes[k].1.contains(&self.shapes[k].1.parts[area.part], p)),
            Owner::Region(j) => self.regions.binary_search_by_key(&j, |r| r.0).is_ok_and(|k| {
                let corners = &self.regions[k].1.polygon;
                !corners.contains(&p) && polygon::contains(corners, p)
            }),
        }
    }
}

impl Region {
    /// Where the region reaches the boundary, other than in its point.
    pub(crate) fn meets_boundary(&self, boundary: &Boundary, slack_mm: f64) -> Option<DVec2> {
        let own = |p: DVec2| self.on_boundary && p.distance(self.point) <= slack_mm;
        let mut around = self.polygon.clone();
        around.extend(self.polygon.first());
        for w in around.windows(2) {
            for side in boundary.sides_near(w) {
                let crossing = polygon::segment_crossing(w[0], w[1], side.ends[0], side.ends[1]);
                if let Some(p) = crossing.map(|(t, _)| w[0].lerp(w[1], t)).filter(|p| !own(*p)) {
                    return Some(p);
                }
            }
        }
        let inside = |p: &DVec2| !own(*p) && polygon::contains(&self.polygon, *p);
        let corner = self.polygon.iter().copied().find(|p| !own(*p) && !boundary.contains(*p));
        corner.or_else(|| boundary.sides_near(&self.polygon).map(|s| s.ends[0]).find(inside))
    }
}

fn contact(a: Owner, b: Owner, at: DVec2) -> Contact {
    Contact { owners: if a <= b { [a, b] } else { [b, a] }, at }
}

/// The edges of a part, with caps where it ends freely.
fn pieces_of(i: usize, shape: &Shape, part: &Part, pieces: &mut Vec<Piece>) {
    let lines = shape.lines(part);
    let owner = Owner::Band(i);
    let (Some(first), Some(last)) = (lines.first(), lines.last()) else { return };
    let edges: &[&FoldLine] = if part.soft { &[first, last] } else { &[first] };
    for line in edges {
        let sharp = (!part.soft).then(|| [line.points[0], line.points[line.points.len() - 1]]);
        pieces.extend(line.points.windows(2).map(|w| Piece { ends: [w[0], w[1]], owner, sharp }));
    }
    for side in 0..2 {
        let end = |l: &FoldLine| if side == 0 { l.points[0] } else { l.points[l.points.len() - 1] };
        for pair in lines.windows(2) {
            if pair.iter().any(|l| l.ends[side] == LineEnd::Free) {
                pieces.push(Piece { ends: [end(&pair[0]), end(&pair[1])], owner, sharp: None });
            }
        }
    }
}

fn area_of(i: usize, shape: &Shape, part: &Part, number: usize) -> Area {
    let lines = shape.lines(part);
    let points: Vec<DVec2> = lines.iter().flat_map(|l| l.points.iter().copied()).collect();
    let (low, high) = polygon::bounds(&points);
    let middle = |l: &FoldLine| 0.5 * (l.points[(l.points.len() - 1) / 2] + l.points[l.points.len() / 2]);
    let inside = [lines.first(), lines.last()].into_iter().flatten().map(middle).collect();
    Area { low, high, owner: Owner::Band(i), part: number, inside }
}
