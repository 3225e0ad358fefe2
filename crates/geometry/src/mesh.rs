//! The flat mesh: triangles of the flat sheet whose edges know what they are.

use crate::{CheckError, CreaseId, EdgeId, LoopId, TriangleId, VertexId};
use glam::DVec2;

/// Where a vertex sits on the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Site {
    /// Anywhere inside a region.
    Interior,
    /// On the outline, a hole or a slit; where they meet, on the one of the lowest number.
    Boundary {
        /// Which curve: slits follow the outline and the holes.
        loop_id: LoopId,
        /// Arc length along it, mm.
        s_mm: f64,
    },
    /// On a fold line, away from the boundary.
    FoldLine {
        /// The crease.
        crease: CreaseId,
        /// Number of the line in its band.
        line: u32,
    },
}

/// What an edge is, known from the constraint that it came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EdgeClass {
    /// Part of a fold line; its turn is the rest angle, + valley.
    Fold {
        /// The crease.
        crease: CreaseId,
        /// Number of the line in its band.
        line: u32,
        /// Rest turn, rad.
        turn_rad: f64,
    },
    /// Inside a face: its rest turn is 0.
    Facet,
    /// Inside the region of a junction of creases or on its border: it may turn freely.
    Free,
    /// On the outline, a hole or one lip of a slit.
    Boundary {
        /// Which curve: slits follow the outline and the holes.
        loop_id: LoopId,
    },
}

/// An edge with its neighbours. `triangles[0]` lies to its left (it contains the edge from
/// `vertices[0]` to `vertices[1]`), `triangles[1]` to its right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Start and end.
    pub vertices: [VertexId; 2],
    /// Left and right neighbour; a boundary edge has only the left one.
    pub triangles: [Option<TriangleId>; 2],
    /// What it is.
    pub class: EdgeClass,
}

/// A triangle mesh of the flat sheet. Triangles are counter-clockwise in (u, v).
#[derive(Clone, Debug, PartialEq)]
pub struct FlatMesh {
    /// Vertices in (u, v), mm.
    pub vertices: Vec<DVec2>,
    /// Where each vertex sits.
    pub sites: Vec<Site>,
    /// Corner vertices, counter-clockwise.
    pub triangles: Vec<[VertexId; 3]>,
    /// All edges, ordered by their lower, then their higher vertex.
    pub edges: Vec<Edge>,
}

impl FlatMesh {
    /// A mesh from triangles; `class` tells what the edge between two vertices (lower first) is, given
    /// whether it is on the boundary.
    pub fn new(
        vertices: Vec<DVec2>,
        sites: Vec<Site>,
        triangles: Vec<[VertexId; 3]>,
        class: impl Fn([VertexId; 2], bool) -> EdgeClass,
    ) -> Self {
        let sides = sides_by_edge(vertices.len(), &triangles);
        let same = |a: &Side, b: &Side| a.low == b.low && a.high == b.high;
        let edges = sides.chunk_by(same).map(|sides| edge(sides, &class)).collect();
        Self { vertices, sites, triangles, edges }
    }

    /// Corner positions of a triangle.
    pub fn corners(&self, triangle: TriangleId) -> [DVec2; 3] {
        self.triangles[triangle.index()].map(|v| self.vertices[v.index()])
    }

    /// Area of a triangle, mm².
    pub fn triangle_area_mm2(&self, triangle: TriangleId) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * (b - a).perp_dot(c - a)
    }

    /// Area of the whole mesh, mm².
    pub fn area_mm2(&self) -> f64 {
        (0..self.triangles.len()).map(|t| self.triangle_area_mm2(TriangleId::new(t))).sum()
    }

    /// Flat length of an edge, mm.
    pub fn edge_length_mm(&self, edge: EdgeId) -> f64 {
        let [a, b] = self.edges[edge.index()].vertices;
        self.vertices[a.index()].distance(self.vertices[b.index()])
    }

    /// The vertex of a triangle that is not on the edge.
    pub fn opposite(&self, triangle: TriangleId, edge: [VertexId; 2]) -> VertexId {
        let corners = self.triangles[triangle.index()];
        corners.into_iter().find(|v| !edge.contains(v)).unwrap_or(corners[0])
    }

    /// The three inner angles of a triangle, rad.
    pub fn angles_rad(&self, triangle: TriangleId) -> [f64; 3] {
        let p = self.corners(triangle);
        [0, 1, 2].map(|k| {
            let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            a.angle_to(b).abs()
        })
    }

    /// Vertices of a boundary loop in order of arc length. Of vertices at one place, where slits end on the loop, those
    /// before a slit come before those behind it.
    ///
    /// A slit has vertices on both lips: they come in order of arc length too, those at one place one after the other,
    /// and free tips once. Its vertices on other loops or on slits of lower number are not among them.
    pub fn loop_vertices(&self, wanted: LoopId) -> Vec<VertexId> {
        let on_loop = |(i, site): (usize, &Site)| match *site {
            Site::Boundary { loop_id, s_mm } if loop_id == wanted => Some((s_mm, VertexId::new(i))),
            _ => None,
        };
        let mut found: Vec<_> = self.sites.iter().enumerate().filter_map(on_loop).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, v)| v).collect()
    }

    /// The contract of this type.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), CheckError> {
        let fault = |f: String| Err(CheckError::new("FlatMesh", f));
        if self.sites.len() != self.vertices.len() {
            return fault(format!("{} sites for {} vertices", self.sites.len(), self.vertices.len()));
        }
        if let Some(i) = self.vertices.iter().position(|v| !v.is_finite()) {
            return fault(format!("vertex {i} is not finite"));
        }
        if let Some(t) =
            self.triangles.iter().position(|t| t.iter().any(|v| v.index() >= self.vertices.len()))
        {
            return fault(format!("triangle {t} has a corner that is no vertex"));
        }
        if let Some(t) =
            (0..self.triangles.len()).find(|&t| self.triangle_area_mm2(TriangleId::new(t)) <= 0.0)
        {
            return fault(format!("triangle {t} is not counter-clockwise"));
        }
        self.edges.iter().try_for_each(|e| self.check_edge(e))?;
        self.check_boundary()
    }

    /// The boundary passes each of its vertices once.
    fn check_boundary(&self) -> Result<(), CheckError> {
        let mut sides = vec![0_usize; self.vertices.len()];
        for e in self.edges.iter().filter(|e| e.triangles[1].is_none()) {
            e.vertices.iter().for_each(|v| sides[v.index()] += 1);
        }
        match sides.iter().position(|n| !matches!(n, 0 | 2)) {
            Some(i) => {
                Err(CheckError::new("FlatMesh", format!("{} boundary edges meet in vertex {i}", sides[i])))
            }
            None => Ok(()),
        }
    }

    fn check_edge(&self, edge: &Edge) -> Result<(), CheckError> {
        let [a, b] = edge.vertices;
        let boundary = matches!(edge.class, EdgeClass::Boundary { .. });
        if edge.triangles[0].is_none() || edge.triangles[1].is_none() != boundary {
            return Err(CheckError::new(
                "FlatMesh",
                format!("edge {a}-{b} has a class that its neighbours contradict"),
            ));
        }
        Ok(())
    }
}

/// A side of a triangle.
#[derive(Clone, Copy)]
struct Side {
    low: VertexId,
    high: VertexId,
    triangle: TriangleId,
    /// Whether it goes from the lower vertex to the higher one.
    upwards: bool,
}

/// Sides of triangles by their lower, then their higher vertex; sorted by counting, in linear time.
fn sides_by_edge(vertices: usize, triangles: &[[VertexId; 3]]) -> Vec<Side> {
    let sides = || {
        triangles.iter().enumerate().flat_map(|(t, c)| {
            [[c[0], c[1]], [c[1], c[2]], [c[2], c[0]]].map(|[a, b]| Side {
                low: a.min(b),
                high: a.max(b),
                triangle: TriangleId::new(t),
                upwards: a < b,
            })
        })
    };
    // A corner that is no vertex is for check() to find.
    let named = triangles.iter().flatten().map(|v| v.index() + 1).max().unwrap_or(0);
    let vertices = vertices.max(named);
    let mut next = vec![0_usize; vertices + 1];
    sides().for_each(|s| next[s.low.index() + 1] += 1);
    for v in 0..vertices {
        next[v + 1] += next[v];
    }
    let nothing = Side { low: VertexId(0), high: VertexId(0), triangle: TriangleId(0), upwards: true };
    let mut sorted = vec![nothing; 3 * triangles.len()];
    for side in sides() {
        let place = &mut next[side.low.index()];
        sorted[*place] = side;
        *place += 1;
    }
    sorted.chunk_by_mut(|a, b| a.low == b.low).for_each(|same| same.sort_by_key(|s| s.high));
    sorted
}

/// The edge of one or two sides.
fn edge(sides: &[Side], class: &impl Fn([VertexId; 2], bool) -> EdgeClass) -> Edge {
    let (low, high) = (sides[0].low, sides[0].high);
    let side = |upwards: bool| sides.iter().find(|s| s.upwards == upwards).map(|s| s.triangle);
    let class = class([low, high], sides.len() == 1);
    match (side(true), side(false)) {
        (None, right) => Edge { vertices: [high, low], triangles: [right, None], class },
        (left, right) => Edge { vertices: [low, high], triangles: [left, right], class },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_triangles() -> FlatMesh {
        let vertices = [(0., 0.), (2., 0.), (2., 2.), (0., 2.)].map(DVec2::from).to_vec();
        let sites = (0..4).map(|i| Site::Boundary { loop_id: LoopId(0), s_mm: 2.0 * i as f64 }).collect();
        let triangles = vec![[0, 1, 2], [0, 2, 3]].into_iter().map(|t| t.map(VertexId)).collect();
        FlatMesh::new(vertices, sites, triangles, |_, boundary| match boundary {
            true => EdgeClass::Boundary { loop_id: LoopId(0) },
            false => EdgeClass::Facet,
        })
    }

    #[test]
    fn edges_have_their_triangles_on_the_stated_sides() {
        let m = two_triangles();
        m.check().unwrap();
        assert_eq!(m.edges.len(), 5);
        for e in &m.edges {
            let left = m.triangles[e.triangles[0].unwrap().index()];
            let i = left.iter().position(|&v| v == e.vertices[0]).unwrap();
            assert_eq!(left[(i + 1) % 3], e.vertices[1]);
        }
        assert_eq!(m.area_mm2(), 4.0);
        let angles = m.angles_rad(TriangleId(0));
        assert!((angles.iter().sum::<f64>() - std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn check_finds_a_flipped_triangle_and_a_wrong_class() {
        let mut m = two_triangles();
        m.triangles[0].swap(0, 1);
        assert!(m.check().unwrap_err().fault.contains("triangle 0"));
        let mut m = two_triangles();
        m.edges[0].class = EdgeClass::Free;
        assert!(m.check().unwrap_err().fault.contains("edge 0-1"));
    }

    #[test]
    fn check_finds_a_vertex_that_the_boundary_passes_twice() {
        let mut m = two_triangles();
        let corners = [(0., 0.), (-2., 0.), (-2., -2.)].map(DVec2::from);
        m.vertices.extend_from_slice(&corners[1..]);
        m.sites.extend([Site::Interior; 2]);
        m.triangles.push([0, 4, 5].map(VertexId));
        let m = FlatMesh::new(m.vertices, m.sites, m.triangles, |_, boundary| match boundary {
            true => EdgeClass::Boundary { loop_id: LoopId(0) },
            false => EdgeClass::Facet,
        });
        assert!(m.check().unwrap_err().fault.contains("4 boundary edges meet in vertex 0"));
    }

    #[test]
    fn loop_vertices_come_in_order() {
        let order: Vec<_> = two_triangles().loop_vertices(LoopId(0)).iter().map(|v| v.0).collect();
        assert_eq!(order, [0, 1, 2, 3]);
    }
}
