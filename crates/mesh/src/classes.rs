//! What each edge of the mesh is, from the constraint that it came from.

use crate::cdt::{Constraint, PlanarGraph};
use crate::split::Opened;
use softfold_geometry::{EdgeClass, FlatMesh, LoopId, VertexId};
use std::collections::{BTreeMap, BTreeSet};

/// The mesh with classified edges; slits are boundaries after the `loops` of the pattern.
pub(crate) fn classified(graph: &PlanarGraph, opened: Opened, loops: usize) -> FlatMesh {
    let known: BTreeMap<[VertexId; 2], Constraint> =
        graph.constraints.iter().map(|(e, c)| (sorted(*e), *c)).collect();
    let Opened { vertices, sites, triangles, origins } = opened;
    let on_graph: Vec<[VertexId; 3]> = triangles.iter().map(|t| t.map(|v| origins[v.index()])).collect();
    let free = free_edges(graph, &on_graph, &known);
    FlatMesh::new(vertices, sites, triangles, |edge, boundary| {
        let edge = sorted(edge.map(|v| origins[v.index()]));
        match known.get(&edge) {
            Some(Constraint::Fold { crease, line, turn_rad }) if !boundary => {
                EdgeClass::Fold { crease: *crease, line: *line, turn_rad: *turn_rad }
            }
            Some(Constraint::Boundary { loop_id }) if boundary => EdgeClass::Boundary { loop_id: *loop_id },
            Some(Constraint::Slit { slit }) => {
                EdgeClass::Boundary { loop_id: LoopId::new(loops + *slit as usize) }
            }
            // A boundary that no constraint made, or the reverse, is left for check() to find.
            _ if boundary => EdgeClass::Boundary { loop_id: LoopId(u32::MAX) },
            Some(Constraint::Junction { .. }) => EdgeClass::Free,
            _ if free.contains(&edge) => EdgeClass::Free,
            _ => EdgeClass::Facet,
        }
    })
}

/// Edges inside the regions of junctions: those without a constraint that are reached from a border on its left side.
fn free_edges(
    graph: &PlanarGraph,
    triangles: &[[VertexId; 3]],
    known: &BTreeMap<[VertexId; 2], Constraint>,
) -> BTreeSet<[VertexId; 2]> {
    let is_border = |c: &&([VertexId; 2], Constraint)| matches!(c.1, Constraint::Junction { .. });
    let mut open: Vec<[VertexId; 2]> = graph.constraints.iter().filter(is_border).map(|c| c.0).collect();
    let mut free = BTreeSet::new();
    if open.is_empty() {
        return free;
    }
    let sides = |t: &[VertexId; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let left: BTreeMap<[VertexId; 2], usize> =
        triangles.iter().enumerate().flat_map(|(i, t)| sides(t).map(|s| (s, i))).collect();
    let mut reached = vec![false; triangles.len()];
    while let Some(side) = open.pop() {
        let Some(&t) = left.get(&side) else { continue };
        if std::mem::replace(&mut reached[t], true) {
            continue;
        }
        for [a, b] in sides(&triangles[t]).into_iter().filter(|s| !known.contains_key(&sorted(*s))) {
            free.insert(sorted([a, b]));
            open.push([b, a]);
        }
    }
    free
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}
