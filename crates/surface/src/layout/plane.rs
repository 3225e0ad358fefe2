//! The planar subdivision: nodes, edges of one segment each, loops with the sheet on their left.

use super::Line;
use crate::SurfaceError;
use glam::DVec2;
use softfold_geometry::{EdgeUse, PlanarCurve, Segment, ShellEdge, ShellEdgeKind, Tolerance, polygon};
use std::collections::BTreeMap;

/// Share of an edge's parameter at which its direction is told apart from those of others that leave the same node: edges
/// that touch there have parted.
const APART: f64 = 1e-3;

/// An edge and a direction: twice its number, and one more for backwards.
pub(super) type Half = usize;

/// An edge of the plane.
#[derive(Clone, Debug)]
pub(super) struct PlaneEdge {
    pub(super) segment: Segment,
    kind: ShellEdgeKind,
    pub(super) cut: Option<usize>,
    nodes: [usize; 2],
    gone: bool,
}

/// The subdivision.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub(super) edges: Vec<PlaneEdge>,
    nodes: Vec<DVec2>,
    same_mm: f64,
}

/// A closed walk along halves, each face on its left.
#[derive(Clone, Debug)]
pub(super) struct Loop {
    pub(super) halves: Vec<Half>,
}

/// Edges of a shell, and which of them stands for a half.
pub(super) struct ShellEdges {
    pub(super) edges: Vec<ShellEdge>,
    pub(super) uses: BTreeMap<Half, EdgeUse>,
    pub(super) corners: usize,
}

impl Plane {
    /// Divides the lines where ends of others lie on them, and at the joints of their segments.
    pub(super) fn new(lines: &[Line], tolerance: &Tolerance) -> Result<Self, SurfaceError> {
        let mut plane = Self { edges: Vec::new(), nodes: Vec::new(), same_mm: 2.0 * tolerance.join_mm };
        // Ends of lines first: what lies near them moves onto them.
        for line in lines.iter().filter(|l| !l.curve.is_closed()) {
            for side in 0..2 {
                plane.node(line.curve.end(side));
            }
        }
        let ends = plane.nodes.clone();
        for line in lines {
            plane.add(line, &ends)?;
        }
        Ok(plane)
    }

    fn add(&mut self, line: &Line, ends: &[DVec2]) -> Result<(), SurfaceError> {
        let curve = &line.curve;
        let total = curve.length_mm();
        let flat = curve.flatten(0.1 * self.same_mm);
        let bounds = polygon::bounds(&flat);
        let near =
            |p: &&DVec2| p.cmpge(bounds.0 - self.same_mm).all() && p.cmple(bounds.1 + self.same_mm).all();
        let on = ends.iter().filter(near).map(|&p| curve.nearest(p));
        let mut places: Vec<f64> = on.filter(|n| n.1 <= self.same_mm).map(|n| n.0).collect();
        let inner = |s: &f64| curve.is_closed() || (*s > self.same_mm && *s < total - self.same_mm);
        places.retain(inner);
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() <= self.same_mm);
        if curve.is_closed()
            && places.len() > 1
            && places[0] + total - places[places.len() - 1] <= self.same_mm
        {
            places.pop();
        }
        for part in parts(curve, &places).map_err(|_| SurfaceError::NoTrim)? {
            self.add_part(&part, line);
        }
        Ok(())
    }

    fn add_part(&mut self, part: &PlanarCurve, line: &Line) {
        for segment in part.segments() {
            let nodes = [segment.from(), segment.to()].map(|p| self.node(p));
            let segment = segment.with_ends(self.nodes[nodes[0]], self.nodes[nodes[1]]);
            self.edges.push(PlaneEdge { segment, kind: line.kind, cut: line.cut, nodes, gone: false });
        }
    }

    fn node(&mut self, p: DVec2) -> usize {
        let near = self.nodes.iter().position(|q| q.distance(p) <= self.same_mm);
        near.unwrap_or_else(|| {
            self.nodes.push(p);
            self.nodes.len() - 1
        })
    }

    /// Takes edges out of the subdivision.
    pub(super) fn remove(&mut self, edges: &[usize]) {
        edges.iter().for_each(|&e| self.edges[e].gone = true);
    }

    fn halves(&self) -> impl Iterator<Item = Half> + '_ {
        let alive = self.edges.iter().enumerate().filter(|(_, e)| !e.gone);
        alive.flat_map(
            |(i, e)| if e.kind == ShellEdgeKind::Border { 2 * i..2 * i + 1 } else { 2 * i..2 * i + 2 },
        )
    }

    fn start(&self, half: Half) -> usize {
        self.edges[half / 2].nodes[half % 2]
    }

    fn end(&self, half: Half) -> usize {
        self.edges[half / 2].nodes[1 - half % 2]
    }

    /// The angle in which a half leaves its start.
    fn leaves(&self, half: Half) -> f64 {
        let segment = &self.edges[half / 2].segment;
        let segment = if half % 2 == 1 { segment.reversed() } else { *segment };
        (segment.at(APART) - segment.from()).to_angle()
    }

    /// All loops: at each node on to the edge farthest to the left.
    pub(super) fn loops(&self) -> Vec<Loop> {
        let mut leaving: BTreeMap<usize, Vec<(f64, Half)>> = BTreeMap::new();
        self.halves().for_each(|h| leaving.entry(self.start(h)).or_default().push((self.leaves(h), h)));
        let mut next: BTreeMap<Half, Half> = self.halves().map(|h| (h, self.after(h, &leaving))).collect();
        let mut loops = Vec::new();
        while let Some((&first, _)) = next.iter().next() {
            let (mut halves, mut at) = (Vec::new(), first);
            while let Some(following) = next.remove(&at) {
                halves.push(at);
                at = following;
            }
            loops.push(Loop { halves });
        }
        loops
    }

    /// The first half clockwise from the one that leads back.
    fn after(&self, half: Half, leaving: &BTreeMap<usize, Vec<(f64, Half)>>) -> Half {
        let back = self.leaves(half ^ 1);
        let turn = |angle: f64| (back - angle).rem_euclid(std::f64::consts::TAU);
        let clockwise =
            |&(angle, h): &(f64, Half)| if h == half ^ 1 { std::f64::consts::TAU } else { turn(angle) };
        let all = leaving.get(&self.end(half)).into_iter().flatten();
        all.min_by(|a, b| clockwise(a).total_cmp(&clockwise(b))).map_or(half ^ 1, |l| l.1)
    }

    fn polygon(&self, of: &Loop, chord_mm: f64) -> Vec<DVec2> {
        let segment = |h: &Half| {
            let s = self.edges[h / 2].segment;
            if h % 2 == 1 { s.reversed() } else { s }
        };
        of.halves.iter().flat_map(|h| flat(&segment(h), chord_mm)).collect()
    }

    /// The loops of each face: the outer one, then inner ones.
    ///
    /// # Errors
    /// No face at all.
    pub(super) fn faces(&self, loops: &[Loop], chord_mm: f64) -> Result<Vec<Vec<usize>>, SurfaceError> {
        let polygons: Vec<_> = loops.iter().map(|l| self.polygon(l, chord_mm)).collect();
        let areas: Vec<f64> = polygons.iter().map(|p| polygon::signed_area_mm2(p)).collect();
        let least = self.same_mm * self.same_mm;
        let mut faces: Vec<Vec<usize>> =
            (0..loops.len()).filter(|&l| areas[l] > least).map(|l| vec![l]).collect();
        for inner in (0..loops.len()).filter(|&l| areas[l] <= least) {
            let inside = |f: &usize| {
                let outer = faces[*f][0];
                areas[outer] > -areas[inner] * (1.0 + f64::EPSILON.sqrt())
                    && polygon::contains(&polygons[outer], inner_point(&polygons[inner]))
            };
            let around = (0..faces.len())
                .filter(inside)
                .min_by(|a, b| areas[faces[*a][0]].total_cmp(&areas[faces[*b][0]]));
            if let Some(f) = around {
                faces[f].push(inner);
            }
        }
        if faces.is_empty() { Err(SurfaceError::NoTrim) } else { Ok(faces) }
    }

    /// Edges with one face on both sides: they divide nothing.
    pub(super) fn within_one_face(&self, loops: &[Loop], faces: &[Vec<usize>]) -> Vec<usize> {
        let mut face_of: BTreeMap<Half, usize> = BTreeMap::new();
        for (f, l) in faces.iter().enumerate().flat_map(|(f, of)| of.iter().map(move |&l| (f, l))) {
            face_of.extend(loops[l].halves.iter().map(|&h| (h, f)));
        }
        let inside = |e: &usize| {
            let edge = &self.edges[*e];
            edge.kind != ShellEdgeKind::Border
                && !edge.gone
                && face_of.get(&(2 * e)) == face_of.get(&(2 * e + 1))
        };
        (0..self.edges.len()).filter(inside).collect()
    }

    /// Edges for a shell: each lip of a slit is one of its own. Corners are one where faces meet along an edge.
    pub(super) fn shell_edges(&self, loops: &[Loop]) -> ShellEdges {
        let after: BTreeMap<Half, Half> = loops.iter().flat_map(|l| cycle(&l.halves)).collect();
        let mut corners = Corners::new(2 * self.edges.len());
        for h in after.keys().filter(|h| self.is_shared(**h)) {
            // Where the face on the right begins its way, the one on the left has ended it.
            corners.join(*h, after[&(h ^ 1)]);
        }
        let (names, count) = corners.numbered(after.keys());
        let mut made = ShellEdges { edges: Vec::new(), uses: BTreeMap::new(), corners: count };
        for (&h, &next) in &after {
            if h % 2 == 1 && self.is_shared(h) {
                let edge = made.uses[&(h ^ 1)].edge;
                made.uses.insert(h, EdgeUse { edge, reversed: true });
                continue;
            }
            let PlaneEdge { segment, kind, .. } = self.edges[h / 2];
            let segment = if h % 2 == 1 { segment.reversed() } else { segment };
            made.uses.insert(h, EdgeUse { edge: made.edges.len(), reversed: false });
            made.edges.push(ShellEdge { segment, kind, corners: [names[&h], names[&next]] });
        }
        made
    }

    fn is_shared(&self, half: Half) -> bool {
        matches!(self.edges[half / 2].kind, ShellEdgeKind::Crease | ShellEdgeKind::Smooth)
    }
}

/// Each with the one after it, around.
fn cycle(halves: &[Half]) -> impl Iterator<Item = (Half, Half)> + '_ {
    (0..halves.len()).map(|k| (halves[k], halves[(k + 1) % halves.len()]))
}

/// A point of a loop that bounds a hole: the middle of a side, which no other loop touches.
fn inner_point(polygon: &[DVec2]) -> DVec2 {
    0.5 * (polygon[0] + polygon[1 % polygon.len()])
}

/// The curve between the places, in order; a closed one begins at the first.
fn parts(curve: &PlanarCurve, places: &[f64]) -> Result<Vec<PlanarCurve>, softfold_geometry::CurveError> {
    let total = curve.length_mm();
    if places.is_empty() {
        return Ok(vec![curve.clone()]);
    }
    let mut stops = places.to_vec();
    if curve.is_closed() {
        stops.push(places[0]);
    } else {
        stops.insert(0, 0.0);
        stops.push(total);
    }
    stops.windows(2).map(|w| curve.part(w[0], w[1])).collect()
}

/// Points of a segment but for its end.
pub(super) fn flat(segment: &Segment, chord_mm: f64) -> Vec<DVec2> {
    match PlanarCurve::new(vec![*segment]) {
        Ok(curve) if curve.is_closed() => curve.flatten(chord_mm),
        Ok(curve) => {
            let mut points = curve.flatten(chord_mm);
            points.pop();
            points
        }
        Err(_) => vec![segment.from()],
    }
}

/// Corners that are one (union-find).
struct Corners(Vec<usize>);

impl Corners {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// A number for the corner at the start of each half, and how many there are.
    fn numbered<'a>(&mut self, halves: impl Iterator<Item = &'a Half>) -> (BTreeMap<Half, usize>, usize) {
        let (mut names, mut roots) = (BTreeMap::new(), BTreeMap::new());
        for &h in halves {
            let count = roots.len();
            names.insert(h, *roots.entry(self.root(h)).or_insert(count));
        }
        (names, roots.len())
    }
}
