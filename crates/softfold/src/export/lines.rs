//! Fold lines and boundary curves of a flat mesh as chains of vertices.

use softfold_geometry::{EdgeClass, FlatMesh, VertexId};
use std::collections::BTreeMap;

/// The chains of every fold line and boundary curve, by their names, in order of their numbers; fold lines first. A closed
/// chain repeats its first vertex.
pub(super) fn lines(mesh: &FlatMesh) -> Vec<(String, Vec<Vec<VertexId>>)> {
    let mut of_line: BTreeMap<[u32; 3], Vec<[VertexId; 2]>> = BTreeMap::new();
    for e in &mesh.edges {
        match e.class {
            EdgeClass::Fold { crease, line, .. } => {
                of_line.entry([0, crease.0, line]).or_default().push(e.vertices);
            }
            EdgeClass::Boundary { loop_id } => of_line.entry([1, loop_id.0, 0]).or_default().push(e.vertices),
            EdgeClass::Facet | EdgeClass::Free => {}
        }
    }
    let name = |key: [u32; 3]| match key {
        [0, crease, line] => format!("fold_{crease}_{line}"),
        [_, loop_id, _] => format!("boundary_{loop_id}"),
    };
    of_line.into_iter().map(|(key, edges)| (name(key), chains(&edges))).collect()
}

/// Edges joined end to end; at vertices of three edges or more chains end.
fn chains(edges: &[[VertexId; 2]]) -> Vec<Vec<VertexId>> {
    let mut at: BTreeMap<VertexId, Vec<usize>> = BTreeMap::new();
    for (i, e) in edges.iter().enumerate() {
        e.iter().for_each(|v| at.entry(*v).or_default().push(i));
    }
    let is_inner = |v: &VertexId| at.get(v).is_some_and(|e| e.len() == 2);
    let mut used = vec![false; edges.len()];
    // Ends first: what is left then are rings.
    let ends = at.iter().filter(|(v, _)| !is_inner(v)).flat_map(|(v, e)| e.iter().map(|i| (*v, *i)));
    let rings = at.iter().flat_map(|(v, e)| e.iter().map(|i| (*v, *i)));
    let mut chains = Vec::new();
    for (start, first) in ends.chain(rings) {
        let (mut from, mut next) = (start, (!used[first]).then_some(first));
        let mut chain = vec![start];
        while let Some(edge) = next {
            used[edge] = true;
            let [a, b] = edges[edge];
            from = if a == from { b } else { a };
            chain.push(from);
            next = match is_inner(&from) {
                true => at[&from].iter().copied().find(|i| !used[*i]),
                false => None,
            };
        }
        if chain.len() > 1 {
            chains.push(chain);
        }
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
        let edges: Vec<_> = edges.iter().map(|e| e.map(VertexId)).collect();
        chains(&edges).into_iter().map(|c| c.into_iter().map(|v| v.0).collect()).collect()
    }

    #[test]
    fn edges_are_joined_to_open_chains_rings_and_branches() {
        assert_eq!(joined(&[[2, 3], [0, 1], [1, 2]]), [[0, 1, 2, 3]]);
        assert_eq!(joined(&[[0, 1], [1, 2], [2, 0]]), [[0, 1, 2, 0]]);
        assert_eq!(joined(&[[0, 1], [1, 2], [1, 3]]).len(), 3);
        assert_eq!(joined(&[[0, 1], [4, 5]]).len(), 2);
    }
}
