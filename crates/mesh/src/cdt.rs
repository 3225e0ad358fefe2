//! The constrained Delaunay triangulation behind one door: spade, or CGAL with exact crossings.

use crate::net::Net;
use crate::{MeshError, order};
use glam::DVec2;
use softfold_geometry::{CreaseId, LoopId, VertexId};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, InsertionError, Point2, Triangulation};

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

/// Triangles of the hull with vertices numbered in the order of insertion.
pub(crate) struct Inserted {
    triangles: Vec<[VertexId; 3]>,
    /// The point of the graph that each vertex is.
    inputs: Vec<u32>,
    /// The other way round.
    inserted: Vec<u32>,
}

/// Points come along a Hilbert curve: each is found at once from the one before it, and what belongs together lies
/// together in memory. At a million points that takes a quarter of the time of spade's own bulk load.
pub(crate) fn spade_hull(graph: &PlanarGraph) -> Result<Inserted, MeshError> {
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
    let ends = |e: &[VertexId; 2]| e.map(|v| inserted[v.index()]);
    constrain(&mut cdt, graph, ends)?;
    let triangles = cdt.inner_faces().map(|f| f.vertices().map(|v| VertexId::new(v.fix().index()))).collect();
    Ok(Inserted { triangles, inputs, inserted })
}

impl Inserted {
    /// Whether there is no triangle.
    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Those of the sheet.
    pub(crate) fn of_sheet(mut self, graph: &PlanarGraph) -> Self {
        let ends = boundary(graph).map(|(e, _)| e.map(|v| VertexId(self.inserted[v.index()])));
        self.triangles = on_sheet(self.inputs.len(), ends, self.triangles);
        self
    }

    /// The triangles by the points of the graph.
    pub(crate) fn by_input(mut self) -> Vec<[VertexId; 3]> {
        self.triangles.iter_mut().for_each(|t| *t = t.map(|v| VertexId(self.inputs[v.index()])));
        self.triangles
    }
}

type Spade = ConstrainedDelaunayTriangulation<Point2<f64>>;

fn constrain(
    cdt: &mut Spade,
    graph: &PlanarGraph,
    ends: impl Fn(&[VertexId; 2]) -> [u32; 2],
) -> Result<(), MeshError> {
    let vertex = |v: u32| FixedVertexHandle::from_index(v as usize);
    for (edge, _) in &graph.constraints {
        let [a, b] = ends(edge).map(vertex);
        // Two or more edges would lead through a point that lies on it.
        if cdt.try_add_constraint(a, b).len() != 1 {
            return Err(crossing(graph, *edge));
        }
    }
    if cdt.num_constraints() != graph.constraints.len() {
        let is_whole = |e: &[VertexId; 2]| {
            let [a, b] = ends(e).map(vertex);
            cdt.get_edge_from_neighbors(a, b).is_some()
        };
        let cut = graph.constraints.iter().map(|(e, _)| *e).find(|e| !is_whole(e));
        return Err(crossing(graph, cut.unwrap_or_default()));
    }
    Ok(())
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
