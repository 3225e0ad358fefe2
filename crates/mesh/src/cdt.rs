//! The constrained Delaunay triangulation behind one door: spade, or CGAL with exact crossings.

use crate::MeshError;
use glam::DVec2;
use softfold_geometry::{CreaseId, LoopId, VertexId};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::{BTreeMap, BTreeSet};

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
    let hull = match backend {
        Backend::Spade => spade_triangles(graph)?,
        Backend::Cgal => cgal_triangles(graph)?,
    };
    let mut triangles: Vec<_> = on_sheet(graph, &hull).into_iter().map(lowest_first).collect();
    triangles.sort_unstable();
    Ok(Triangulated { triangles })
}

fn spade_triangles(graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError> {
    let points = graph.points.iter().map(|p| Point2::new(p.x, p.y)).collect();
    let edges = graph.constraints.iter().map(|(e, _)| e.map(VertexId::index)).collect();
    let mut refused = Vec::new();
    let cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(points, edges, |e| {
        refused.push(e)
    })
    .map_err(|e| MeshError::Triangulation(e.to_string()))?;
    if let Some(edge) = refused.first() {
        return Err(crossing(graph, *edge));
    }
    if cdt.num_vertices() != graph.points.len() {
        return Err(MeshError::Triangulation("two points of the mesh coincide".to_owned()));
    }
    if cdt.num_constraints() != graph.constraints.len() {
        let is_whole = |e: [usize; 2]| cdt.get_edge_from_neighbors(vertex(e[0]), vertex(e[1])).is_some();
        let cut = graph.constraints.iter().map(|(e, _)| e.map(VertexId::index)).find(|e| !is_whole(*e));
        return Err(crossing(graph, cut.unwrap_or_default()));
    }
    Ok(cdt.inner_faces().map(|f| f.vertices().map(|v| VertexId::new(v.fix().index()))).collect())
}

fn vertex(index: usize) -> FixedVertexHandle {
    FixedVertexHandle::from_index(index)
}

/// Names the two constraints of which one was refused.
fn crossing(graph: &PlanarGraph, refused: [usize; 2]) -> MeshError {
    let ends = |e: &[VertexId; 2]| e.map(|v| graph.points[v.index()]);
    // The triangulation may name the edge from either end.
    let mine = graph.constraints.iter().find(|(e, _)| refused.iter().all(|&v| e.contains(&VertexId::new(v))));
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
    MeshError::Triangulation(format!("edge {refused:?} cannot be kept"))
}

fn cgal_triangles(graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError> {
    let points: Vec<[f64; 2]> = graph.points.iter().map(|p| p.to_array()).collect();
    let edges: Vec<[u32; 2]> = graph.constraints.iter().map(|(e, _)| e.map(|v| v.0)).collect();
    let cdt = softfold_kernel::cgal::constrained_delaunay(&points, &edges)?;
    if cdt.points.len() != points.len() || cdt.constraints.len() != edges.len() {
        return Err(MeshError::Triangulation("constraints cross or points coincide".to_owned()));
    }
    Ok(cdt.triangles.iter().map(|t| t.map(VertexId)).collect())
}

/// Keeps the triangles of the sheet: those reached from a boundary constraint on its left side without
/// crossing a boundary.
fn on_sheet(graph: &PlanarGraph, hull: &[[VertexId; 3]]) -> Vec<[VertexId; 3]> {
    let is_boundary = |c: &&([VertexId; 2], Constraint)| matches!(c.1, Constraint::Boundary { .. });
    let walls: BTreeSet<[VertexId; 2]> = graph.constraints.iter().filter(is_boundary).map(|c| c.0).collect();
    let mut by_edge = BTreeMap::new();
    for (t, corners) in hull.iter().enumerate() {
        for k in 0..3 {
            by_edge.insert([corners[k], corners[(k + 1) % 3]], t);
        }
    }
    let mut kept = vec![false; hull.len()];
    let mut open: Vec<usize> = walls.iter().filter_map(|e| by_edge.get(e).copied()).collect();
    while let Some(t) = open.pop() {
        if std::mem::replace(&mut kept[t], true) {
            continue;
        }
        for k in 0..3 {
            let edge = [hull[t][k], hull[t][(k + 1) % 3]];
            let back = [edge[1], edge[0]];
            if !walls.contains(&edge) && !walls.contains(&back) {
                open.extend(by_edge.get(&back));
            }
        }
    }
    hull.iter().zip(kept).filter(|(_, k)| *k).map(|(t, _)| *t).collect()
}

fn lowest_first(t: [VertexId; 3]) -> [VertexId; 3] {
    let lowest = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
    [0, 1, 2].map(|k| t[(lowest + k) % 3])
}
