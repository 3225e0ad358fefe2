//! Edges that faces share: corners of faces are points of the cage, counted in whole numbers, so that nothing is sewn by
//! distance.

use super::faces::{BsplineFace, UNIT};
use super::quads::Quads;
use glam::{DVec2, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// A point of the cage: a vertex, a point of an edge counted from its lower vertex, a point inside a quad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Spot {
    Vertex(u32),
    Edge([u32; 2], u32),
    Inside(usize, u32, u32),
}

/// A side of a face between two corners of faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeUse {
    /// The face.
    pub face: usize,
    /// Parameters of the face at the edge's start.
    pub start: DVec2,
    /// Unit direction of the edge in the face's parameters.
    pub direction: DVec2,
    /// Whether the face's border runs as the edge does.
    pub forward: bool,
}

/// An edge of the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedEdge {
    /// Its ends.
    pub vertices: [usize; 2],
    /// Its length in parameters of its faces.
    pub length: f64,
    /// One face at the border, two inside.
    pub uses: Vec<EdgeUse>,
}

/// Faces with the edges they share.
#[derive(Clone, Debug, PartialEq)]
pub struct Polysurface {
    /// The faces.
    pub faces: Vec<BsplineFace>,
    /// Corners, mm.
    pub vertices: Vec<DVec3>,
    /// Edges.
    pub edges: Vec<SharedEdge>,
    /// For each face its edges in order, counter-clockwise, with their place among the edge's uses.
    pub borders: Vec<Vec<(usize, usize)>>,
}

/// Finds what the faces share.
pub(crate) fn sewn(quads: &Quads, faces: Vec<BsplineFace>) -> Polysurface {
    let spots = Spots::new(quads, &faces);
    let mut made =
        Polysurface { faces: Vec::new(), vertices: Vec::new(), edges: Vec::new(), borders: Vec::new() };
    let mut numbers: BTreeMap<Spot, usize> = BTreeMap::new();
    // By the ends and the places next to them: two edges may share both ends.
    let mut edges: BTreeMap<[Spot; 4], usize> = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        let ring = ring(quads, face);
        let corners: Vec<usize> = (0..ring.len()).filter(|&k| spots.known(&ring[k].0)).collect();
        let mut border = Vec::new();
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            let ends = [&ring[from], &ring[to]];
            let vertices = ends.map(|(spot, at)| {
                *numbers.entry(*spot).or_insert_with(|| {
                    made.vertices.push(face.at(at.x, at.y).0);
                    made.vertices.len() - 1
                })
            });
            let beside = [ring[(from + 1) % ring.len()].0, ring[(to + ring.len() - 1) % ring.len()].0];
            let way = [ends[0].0, beside[0], beside[1], ends[1].0];
            let back = [way[3], way[2], way[1], way[0]];
            let e = *edges.entry(way.min(back)).or_insert_with(|| {
                made.edges.push(SharedEdge {
                    vertices,
                    length: ends[0].1.distance(ends[1].1),
                    uses: Vec::new(),
                });
                made.edges.len() - 1
            });
            let edge = &mut made.edges[e];
            let forward = edge.vertices == vertices;
            let [from, to] = if forward { [ends[0].1, ends[1].1] } else { [ends[1].1, ends[0].1] };
            edge.uses.push(EdgeUse {
                face: f,
                start: from,
                direction: (to - from).normalize_or_zero(),
                forward,
            });
            border.push((e, edge.uses.len() - 1));
        }
        made.borders.push(border);
    }
    made.faces = faces;
    made
}

/// Corners of all faces.
struct Spots {
    vertices: BTreeSet<u32>,
    on_edges: BTreeMap<[u32; 2], BTreeSet<u32>>,
    inside: BTreeMap<usize, BTreeSet<(u32, u32)>>,
}

impl Spots {
    fn new(quads: &Quads, faces: &[BsplineFace]) -> Self {
        let mut spots =
            Self { vertices: BTreeSet::new(), on_edges: BTreeMap::new(), inside: BTreeMap::new() };
        for face in faces {
            let (w, h) = face.size;
            for corner in [(0, 0), (w, 0), (w, h), (0, h)] {
                match spot(quads, face, corner) {
                    Spot::Vertex(v) => drop(spots.vertices.insert(v)),
                    Spot::Edge(e, at) => drop(spots.on_edges.entry(e).or_default().insert(at)),
                    Spot::Inside(q, x, y) => drop(spots.inside.entry(q).or_default().insert((x, y))),
                }
            }
        }
        spots
    }

    fn known(&self, spot: &Spot) -> bool {
        match spot {
            Spot::Vertex(v) => self.vertices.contains(v),
            Spot::Edge(e, at) => self.on_edges.get(e).is_some_and(|s| s.contains(at)),
            Spot::Inside(q, x, y) => self.inside.get(q).is_some_and(|s| s.contains(&(*x, *y))),
        }
    }
}

/// All places on the border of a face where corners of faces can be, counter-clockwise, with their parameters in it.
fn ring(quads: &Quads, face: &BsplineFace) -> Vec<(Spot, DVec2)> {
    let (w, h) = face.size;
    let corners = [(0, 0), (w, 0), (w, h), (0, h)];
    let side = |k: usize| candidates(corners[k], corners[(k + 1) % 4]);
    let unit = f64::from(UNIT);
    let place =
        |(x, y): (u32, u32)| (spot(quads, face, (x, y)), DVec2::new(f64::from(x), f64::from(y)) / unit);
    (0..4).flat_map(side).map(place).collect()
}

/// Places on a side where corners can be, from its start up to before its end: no patch is finer than that.
fn candidates(from: (u32, u32), to: (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    const STEP: u32 = UNIT / 64;
    let length = from.0.abs_diff(to.0) + from.1.abs_diff(to.1);
    let toward = |a: u32, b: u32, d: u32| match b.cmp(&a) {
        std::cmp::Ordering::Greater => a + d,
        std::cmp::Ordering::Less => a - d,
        std::cmp::Ordering::Equal => a,
    };
    (0..length / STEP).map(move |k| (toward(from.0, to.0, k * STEP), toward(from.1, to.1, k * STEP)))
}

/// The point of the cage at a point of a face.
fn spot(quads: &Quads, face: &BsplineFace, (x, y): (u32, u32)) -> Spot {
    let (x, y) = (x + face.origin.0, y + face.origin.1);
    let column = ((x / UNIT) as usize).min(face.cells.columns.len() - 1);
    let row = ((y / UNIT) as usize).min(face.cells.columns[0].len() - 1);
    let cell = face.cells.columns[column][row];
    let within = (x - column as u32 * UNIT, y - row as u32 * UNIT);
    let (s, t) = cell.own(within, UNIT);
    let quad = quads.quads[cell.quad];
    let edge = |a: u32, b: u32, from_a: u32| match from_a {
        0 => Spot::Vertex(a),
        UNIT => Spot::Vertex(b),
        _ if a < b => Spot::Edge([a, b], from_a),
        _ => Spot::Edge([b, a], UNIT - from_a),
    };
    match (s, t) {
        (_, 0) => edge(quad[0], quad[1], s),
        (_, UNIT) => edge(quad[3], quad[2], s),
        (0, _) => edge(quad[0], quad[3], t),
        (UNIT, _) => edge(quad[1], quad[2], t),
        _ => Spot::Inside(cell.quad, s, t),
    }
}
