//! The libraries that triangulate, behind one trait.

use crate::MeshError;
use crate::cdt::{Backend, Constraint, Hull, PlanarGraph, boundary, cgal_triangles, on_sheet, spade_hull};
use crate::noding::{Noded, noded};
use glam::DVec2;
use softfold_geometry::VertexId;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A constrained Delaunay triangulation by some library.
pub trait Triangulate: Sync {
    /// Triangles of the convex hull of all points, counter-clockwise, with every constraint as an edge.
    ///
    /// # Errors
    /// Constraints that cross, overlap or touch but at their ends; points that coincide, or all lie on one line.
    fn planar(&self, graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError>;

    /// Those of them that are on the sheet.
    ///
    /// # Errors
    /// As of [`Self::planar`].
    fn sheet(&self, graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError> {
        let ends = boundary(graph).map(|(e, _)| *e);
        Ok(on_sheet(graph.points.len(), ends, self.planar(graph)?))
    }

    /// The same as `planar` with constraints that may cross, overlap and touch: they are cut where they do.
    ///
    /// # Errors
    /// Points that are not finite or all lie on one line.
    fn crossing(&self, points: &[DVec2], constraints: &[[VertexId; 2]]) -> Result<Arranged, MeshError>;
}

/// Triangles over constraints that cross.
#[derive(Clone, Debug, PartialEq)]
pub struct Arranged {
    /// The distinct points of the input in their order, then those where constraints meet, mm.
    pub points: Vec<DVec2>,
    /// Which of `points` each point of the input became.
    pub vertex_of_input: Vec<VertexId>,
    /// The points along each constraint, from its first end to its second: each two neighbours are an edge. One point, or
    /// none, if both ends are one.
    pub chains: Vec<Vec<VertexId>>,
    /// Triangles of the convex hull, counter-clockwise.
    pub triangles: Vec<[VertexId; 3]>,
    /// How far points and pieces may lie from where they exactly are, mm. Of several points within as much of each other
    /// the triangles between may be turned over by it.
    pub tolerance_mm: f64,
}

impl Backend {
    /// The library.
    pub fn library(self) -> &'static dyn Triangulate {
        match self {
            Backend::Spade => &Spade,
            Backend::Cgal => &Cgal,
        }
    }
}

/// spade. Its predicates are exact; its own splitting of constraints is not used: it works in floating point, moves
/// constraints to neighbouring points where its crossings come out beside their edges, and ends by assertions. Constraints
/// are cut exactly before it sees them.
struct Spade;

/// CGAL: predicates and crossings are exact, and become `f64` only at the end.
struct Cgal;

/// What crossings lose when they become `f64`, share of the largest coordinate: a unit of the last place each way, in both
/// coordinates, and as much again in whatever measures it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Triangulate for Spade {
    fn planar(&self, graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError> {
        Ok(caught(graph)?.triangles())
    }

    fn sheet(&self, graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError> {
        Ok(caught(graph)?.sheet())
    }

    fn crossing(&self, points: &[DVec2], constraints: &[[VertexId; 2]]) -> Result<Arranged, MeshError> {
        let noded = noded(points, constraints)?;
        let triangles = self.planar(&graph_of(&noded))?;
        let Noded { points, vertex_of_input, chains, pitch_mm } = noded;
        let tolerance_mm = crate::noding::OFF_LINE * pitch_mm;
        Ok(Arranged { points, vertex_of_input, chains, triangles, tolerance_mm })
    }
}

/// A panic of a library on a user's lines is an error, not the end of the program.
fn caught(graph: &PlanarGraph) -> Result<Hull, MeshError> {
    let outcome = catch_unwind(AssertUnwindSafe(|| spade_hull(graph)));
    let stopped =
        || MeshError::Triangulation("spade stopped on these points; try backend = \"cgal\"".to_owned());
    let hull = outcome.unwrap_or_else(|_| Err(stopped()))?;
    match hull.is_empty() {
        true => Err(MeshError::Triangulation("all points lie on one line".to_owned())),
        false => Ok(hull),
    }
}

impl Triangulate for Cgal {
    fn planar(&self, graph: &PlanarGraph) -> Result<Vec<[VertexId; 3]>, MeshError> {
        cgal_triangles(graph)
    }

    fn crossing(&self, points: &[DVec2], constraints: &[[VertexId; 2]]) -> Result<Arranged, MeshError> {
        let flat: Vec<[f64; 2]> = points.iter().map(|p| p.to_array()).collect();
        let edges: Vec<[u32; 2]> = constraints.iter().map(|c| c.map(|v| v.0)).collect();
        let cdt = softfold_kernel::cgal::constrained_delaunay(&flat, &edges)?;
        let mut chains: Vec<Vec<VertexId>> = vec![Vec::new(); constraints.len()];
        for piece in &cdt.constraints {
            let chain = &mut chains[piece.input as usize];
            if chain.is_empty() {
                chain.push(VertexId(piece.vertices[0]));
            }
            chain.push(VertexId(piece.vertices[1]));
        }
        let farthest = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        Ok(Arranged {
            points: cdt.points.into_iter().map(DVec2::from).collect(),
            vertex_of_input: cdt.index_of_input.into_iter().map(VertexId).collect(),
            chains,
            triangles: cdt.triangles.iter().map(|t| t.map(VertexId)).collect(),
            tolerance_mm: ROUNDING * farthest,
        })
    }
}

/// The pieces as a graph; each is named by the first constraint that runs along it.
pub(crate) fn graph_of(noded: &Noded) -> PlanarGraph {
    let constraints =
        noded.pieces().into_iter().map(|(edge, of)| (edge, Constraint::Slit { slit: of[0] })).collect();
    PlanarGraph { points: noded.points.clone(), constraints }
}
