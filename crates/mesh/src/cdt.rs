//! The constrained Delaunay triangulation behind one door: spade, or CGAL with exact crossings.

use crate::net::Net;
use crate::{MeshError, order};
use glam::DVec2;
use softfold_geometry::{CreaseId, LoopId, VertexId};
use spade::handles::{FaceHandle, FixedDirectedEdgeHandle, FixedVertexHandle, InnerTag};
use spade::{CdtEdge, ConstrainedDelaunayTriangulation, InsertionError, Point2, Triangulation};

/// Which library triangulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// spade, the default.
    Spade,
    /// CGAL, with exact constructions.
    Cgal,
}

impl Backend {
    /// Name in project files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Backend::Spade => "spade",
            Backend::Cgal => "cgal",
        }
    }
}

/// Where a constraint comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Constraint {
    /// A piece of a fold line.
    Fold {
        /// The crease.
        crease: CreaseId,
        /// Number of the line in its band.
        line: u32,
        /// Rest turn, rad.
        turn_rad: f64,
    },
    /// A piece of the outline or of a hole, with the sheet to its left.
    Boundary {
        /// Which closed curve.
        loop_id: LoopId,
    },
    /// A piece of a slit, with the sheet on both sides.
    Slit {
        /// Number of the slit.
        slit: u32,
    },
    /// A piece of the border of a junction's region, counter-clockwise around it.
    Junction {
        /// Number of the junction.
        junction: u32,
    },
}

/// Points and constrained edges between them.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarGraph {
    /// Points, (u, v) in mm.
    pub points: Vec<DVec2>,
    /// Edges that the triangulation must have.
    pub constraints: Vec<([VertexId; 2], Constraint)>,
}

/// Triangles of the sheet (those outside and in holes are taken away), counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangulated {
    /// Corners, each triangle with its lowest vertex first, in ascending order.
    pub triangles: Vec<[VertexId; 3]>,
}

/// Triangulates a graph; both backends give triangles of the same sheet.
///
/// # Errors
/// Constraints that cross, or points that a backend refuses.
pub fn triangulate(graph: &PlanarGraph, backend: Backend) -> Result<Triangulated, MeshError> {
    let sheet = backend.library().sheet(graph)?;
    Ok(Triangulated { triangles: canonical(graph.points.len(), &sheet) })
}

/// One point of so many along the curve is inserted before all others: the coarse triangulation that they fall into
/// spares flips (a biased order of insertion in two rounds; Amenta, Choi, Rote 2003).
const COARSE: usize = 32;

type Spade = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// The triangulation of the hull, with vertices numbered in the order of insertion.
pub(crate) struct Hull {
    cdt: Spade,
    /// The point of the graph that each vertex is.
    inputs: Vec<u32>,
    /// Pieces of boundary, with the sheet to their left.
    boundary: Vec<FixedDirectedEdgeHandle>,
}

/// Points come along a Hilbert curve: each is found at once from the one before it, and what belongs together lies
/// together in memory. At a million points that takes a quarter of the time of spade's own bulk load.
pub(crate) fn spade_hull(graph: &PlanarGraph) -> Result<Hull, MeshError> {
    let along = order::along_hilbert(&graph.points);
    let coarse = along.iter().step_by(COARSE);
    let fine = along.iter().enumerate().filter(|(i, _)| i % COARSE != 0).map(|(_, v)| v);
    let inputs: Vec<u32> = coarse.chain(fine).copied().collect();
    let mut cdt = Spade::with_capacity(inputs.len(), 3 * inputs.len(), 2 * inputs.len());
    let mut inserted = vec![0_u32; inputs.len()];
    for (i, &input) in inputs.iter().enumerate() {
        let p = graph.points[input as usize];
        let refused = |e: InsertionError| MeshError::Triangulation(e.to_string());
        if cdt.insert(Point2::new(p.x, p.y)).map_err(refused)?.index() != i {
            return Err(MeshError::Triangulation("two points of the mesh coincide".to_owned()));
        }
        inserted[input as usize] = i as u32;
    }
    let boundary = constrain(&mut cdt, graph, &inserted)?;
    Ok(Hull { cdt, inputs, boundary })
}

impl Hull {
    /// Whether there is no triangle.
    pub(crate) fn is_empty(&self) -> bool {
        self.cdt.num_inner_faces() == 0
    }

    /// All triangles, by the points of the graph.
    pub(crate) fn triangles(&self) -> Vec<[VertexId; 3]> {
        self.cdt.inner_faces().map(|f| self.corners(f)).collect()
    }

    /// Those of the sheet: reached from the left of a piece of boundary without crossing any.
    pub(crate) fn sheet(&self) -> Vec<[VertexId; 3]> {
        let mut walls = vec![false; self.cdt.num_undirected_edges()];
        self.boundary.iter().for_each(|e| walls[e.as_undirected().index()] = true);
        let mut reached = vec![false; self.cdt.num_all_faces()];
        let left = |e: &FixedDirectedEdgeHandle| self.cdt.directed_edge(*e).face().as_inner();
        let mut open: Vec<_> = self.boundary.iter().filter_map(left).collect();
        let mut sheet = Vec::with_capacity(self.cdt.num_inner_faces());
        while let Some(face) = open.pop() {
            if std::mem::replace(&mut reached[face.fix().index()], true) {
                continue;
            }
            sheet.push(self.corners(face));
            let free = face.adjacent_edges().into_iter().filter(|e| !walls[e.as_undirected().fix().index()]);
            open.extend(free.filter_map(|e| e.rev().face().as_inner()));
        }
        sheet
    }

    fn corners(&self, face: FaceHandle<'_, InnerTag, Point2<f64>, (), CdtEdge<()>, ()>) -> [VertexId; 3] {
        face.vertices().map(|v| VertexId(self.inputs[v.fix().index()]))
    }
}

/// Adds all constraints; the pieces of boundary among them.
fn constrain(
    cdt: &mut Spade,
    graph: &PlanarGraph,
    inserted: &[u32],
) -> Result<Vec<FixedDirectedEdgeHandle>, MeshError> {
    let ends = |e: &[VertexId; 2]| e.map(|v| FixedVertexHandle::from_index(inserted[v.index()] as usize));
    let mut boundary = Vec::new();
    for (edge, what) in &graph.constraints {
        let [a, b] = ends(edge);
        // Two or more edges would lead through a point that lies on it.
        match cdt.try_add_constraint(a, b)[..] {
            [piece] if matches!(what, Constraint::Boundary { .. }) => boundary.push(piece),
            [_] => (),
            _ => return Err(crossing(graph, *edge)),
        }
    }
    if cdt.num_constraints() != graph.constraints.len() {
        let is_whole = |e: &[VertexId; 2]| {
            let [a, b] = ends(e);
            cdt.get_edge_from_neighbors(a, b).is_some()
        };
        let cut = graph.constraints.iter().map(|(e, _)| *e).find(|e| !is_whole(e));
        return Err(crossing(graph, cut.unwrap_or_default()));
    }
    Ok(boundary)
}

/// Names the two constraints of which one was refused.
fn crossing(graph: &PlanarGraph, refused: [VertexId; 2]) -> MeshError {
    let ends = |e: &[VertexId; 2]| e.map(|v| graph.points[v.index()]);
    let mine = graph.constraints.iter().find(|(e, _)| *e == refused);
    for (other, second) in &graph.constraints {
        let Some((edge, first)) = mine else { break };
        if edge.iter().any(|v| other.contains(v)) {
            continue;
        }
        let ([a, b], [c, d]) = (ends(edge), ends(other));
        if let Some((t, _)) = softfold_geometry::polygon::segment_crossing(a, b, c, d) {
            return MeshError::Crossing { first: *first, second: *second, at: a.lerp(b, t) };
        }
    }
    let [a, b] = refused;
    MeshError::Triangulation(format!("edge {a}-{b} cannot be kept"))
}

pub(crate) fn cgal_triangles(graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError> {
    let points: Vec<[f64; 2]> = graph.points.iter().map(|p| p.to_array()).collect();
    let edges: Vec<[u32; 2]> = graph.constraints.iter().map(|(e, _)| e.map(|v| v.0)).collect();
    let cdt = softfold_kernel::cgal::constrained_delaunay(&points, &edges)?;
    if cdt.points.len() != points.len() || cdt.constraints.len() != edges.len() {
        return Err(MeshError::Triangulation("constraints cross or points coincide".to_owned()));
    }
    Ok(cdt.triangles.iter().map(|t| t.map(VertexId)).collect())
}

pub(crate) fn boundary(graph: &PlanarGraph) -> impl Iterator<Item = &([VertexId; 2], Constraint)> {
    graph.constraints.iter().filter(|c| matches!(c.1, Constraint::Boundary { .. }))
}

/// Keeps the triangles of the sheet: those reached from a boundary edge on its left side without crossing a boundary.
pub(crate) fn on_sheet(
    vertices: usize,
    boundary: impl Iterator<Item = [VertexId; 2]>,
    hull: Vec<[VertexId; 3]>,
) -> Vec<[VertexId; 3]> {
    let (mut net, rings) = Net::new(vertices, &hull);
    let mut open = Vec::new();
    for edge in boundary {
        net.fix(&rings, edge);
        open.extend(net.left_of(&rings, edge).map(|(t, _)| t));
    }
    let kept = net.reached(open);
    let mut kept = kept.into_iter();
    let mut triangles = hull;
    triangles.retain(|_| kept.next().unwrap_or(false));
    triangles
}

/// Each triangle with its lowest vertex first, in ascending order; by counting, in linear time.
pub(crate) fn canonical(vertices: usize, triangles: &[[VertexId; 3]]) -> Vec<[VertexId; 3]> {
    let mut next = vec![0_u32; vertices + 1];
    let lowest = |t: &[VertexId; 3]| t[0].min(t[1]).min(t[2]).index();
    triangles.iter().for_each(|t| next[lowest(t) + 1] += 1);
    for v in 0..vertices {
        next[v + 1] += next[v];
    }
    let mut sorted = vec![[VertexId(0); 3]; triangles.len()];
    for t in triangles {
        let low = lowest(t);
        let first = t.iter().position(|v| v.index() == low).unwrap_or(0);
        let place = &mut next[low];
        sorted[*place as usize] = [0, 1, 2].map(|k| t[(first + k) % 3]);
        *place += 1;
    }
    sorted.chunk_by_mut(|a, b| a[0] == b[0]).for_each(|same| same.sort_unstable());
    sorted
}
