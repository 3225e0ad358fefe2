//! Values of edges, looked up by their two vertices.

use softfold_geometry::VertexId;

/// A value for each of some edges, whichever end is named first.
pub(crate) struct EdgeMap<T> {
    /// Where the edges of each lower vertex begin.
    starts: Vec<u32>,
    /// Higher vertex and value.
    entries: Vec<(VertexId, T)>,
}

impl<T: Copy> EdgeMap<T> {
    /// Of edges that come twice the last one counts.
    pub(crate) fn new(vertices: usize, edges: impl Iterator<Item = ([VertexId; 2], T)> + Clone) -> Self {
        let mut starts = vec![0_u32; vertices + 1];
        edges.clone().for_each(|(e, _)| starts[e[0].min(e[1]).index() + 1] += 1);
        for i in 0..vertices {
            starts[i + 1] += starts[i];
        }
        let mut sorted: Vec<_> = edges.map(|([a, b], value)| (a.min(b), a.max(b), value)).collect();
        sorted.sort_by_key(|e| e.0);
        Self { starts, entries: sorted.into_iter().map(|(_, high, value)| (high, value)).collect() }
    }

    /// The value of an edge.
    pub(crate) fn get(&self, [a, b]: [VertexId; 2]) -> Option<T> {
        let (low, high) = (a.min(b), a.max(b));
        let range = self.starts[low.index()] as usize..self.starts[low.index() + 1] as usize;
        self.entries[range].iter().rev().find(|e| e.0 == high).map(|e| e.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_found_from_both_ends_and_the_last_value_counts() {
        let edges = [([3, 1], 'a'), ([1, 2], 'b'), ([2, 3], 'c'), ([2, 1], 'd')];
        let map = EdgeMap::new(5, edges.iter().map(|(e, c)| (e.map(VertexId), *c)));
        let get = |a, b| map.get([VertexId(a), VertexId(b)]);
        assert_eq!(
            [get(1, 3), get(3, 1), get(1, 2), get(3, 2)],
            [Some('a'), Some('a'), Some('d'), Some('c')]
        );
        assert_eq!([get(0, 1), get(4, 3)], [None, None]);
    }
}
