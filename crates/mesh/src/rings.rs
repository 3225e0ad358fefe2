//! Which triangles surround a vertex.

use softfold_geometry::VertexId;

/// Triangles around each vertex, in one flat array.
pub(crate) struct Rings {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Rings {
    pub(crate) fn new(vertices: usize, triangles: &[[VertexId; 3]]) -> Self {
        let mut starts = vec![0_u32; vertices + 1];
        triangles.iter().flatten().for_each(|v| starts[v.index() + 1] += 1);
        for i in 0..vertices {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut flat = vec![0; 3 * triangles.len()];
        for (t, corners) in triangles.iter().enumerate() {
            for v in corners {
                flat[next[v.index()] as usize] = t as u32;
                next[v.index()] += 1;
            }
        }
        Self { starts, triangles: flat }
    }

    /// Triangles around a vertex.
    pub(crate) fn of(&self, vertex: usize) -> &[u32] {
        &self.triangles[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}
