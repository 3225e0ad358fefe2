//! What each edge of the mesh is, from the constraint that it came from.

use crate::cdt::{Constraint, PlanarGraph};
use crate::edges::EdgeMap;
use crate::net::Net;
use crate::split::Opened;
use softfold_geometry::{EdgeClass, FlatMesh, LoopId, VertexId};

/// The mesh with classified edges; slits are boundaries after the `loops` of the pattern.
pub(crate) fn classified(graph: &PlanarGraph, opened: Opened, loops: usize) -> FlatMesh {
    let known = EdgeMap::new(graph.points.len(), graph.constraints.iter().copied());
    let Opened { vertices, sites, triangles, origins } = opened;
    let on_graph: Vec<[VertexId; 3]> = triangles.iter().map(|t| t.map(|v| origins[v.index()])).collect();
    let free = free_edges(graph, &on_graph);
    FlatMesh::new(vertices, sites, triangles, |edge, boundary| {
        let edge = sorted(edge.map(|v| origins[v.index()]));
        match known.get(edge) {
            Some(Constraint::Fold { crease, line, turn_rad }) if !boundary => {
                EdgeClass::Fold { crease, line, turn_rad }
            }
            Some(Constraint::Boundary { loop_id }) if boundary => EdgeClass::Boundary { loop_id },
            Some(Constraint::Slit { slit }) => {
                EdgeClass::Boundary { loop_id: LoopId::new(loops + slit as usize) }
            }
            // A boundary that no constraint made, or the reverse, is left for check() to find.
            _ if boundary => EdgeClass::Boundary { loop_id: LoopId(u32::MAX) },
            Some(Constraint::Junction { .. }) => EdgeClass::Free,
            _ if free.binary_search(&edge).is_ok() => EdgeClass::Free,
            _ => EdgeClass::Facet,
        }
    })
}

/// Edges inside the regions of junctions: those of triangles that are reached from a border on its left side without
/// crossing a constraint. Ascending; constraints may be among them.
fn free_edges(graph: &PlanarGraph, triangles: &[[VertexId; 3]]) -> Vec<[VertexId; 2]> {
    let is_border = |c: &&([VertexId; 2], Constraint)| matches!(c.1, Constraint::Junction { .. });
    let mut borders = graph.constraints.iter().filter(is_border).peekable();
    if borders.peek().is_none() {
        return Vec::new();
    }
    let (mut net, rings) = Net::new(graph.points.len(), triangles);
    graph.constraints.iter().for_each(|(edge, _)| net.fix(&rings, *edge));
    let reached = net.reached(borders.filter_map(|c| Some(net.left_of(&rings, c.0)?.0)).collect());
    let inside = triangles.iter().zip(reached).filter(|(_, reached)| *reached).map(|(t, _)| *t);
    let mut free: Vec<[VertexId; 2]> =
        inside.flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(sorted)).collect();
    free.sort_unstable();
    free.dedup();
    free
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}
