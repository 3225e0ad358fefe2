use crate::bridge::common::FlatMesh;

/// A triangle mesh that owns its arrays.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshBuffers {
    /// Corner positions, mm.
    pub positions: Vec<[f64; 3]>,
    /// Three indices into `positions` each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A triangle mesh in arrays of the caller.
#[derive(Debug, Clone, Copy)]
pub struct MeshView<'a> {
    /// Corner positions, mm.
    pub positions: &'a [[f64; 3]],
    /// Three indices into `positions` each, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
}

/// What to keep of two solids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BooleanOperation {
    /// What is in either.
    Union,
    /// What is in both.
    Intersection,
    /// What is in the first and not in the second.
    Difference,
}

impl MeshBuffers {
    /// The same mesh, borrowed.
    pub fn view(&self) -> MeshView<'_> {
        MeshView { positions: &self.positions, triangles: &self.triangles }
    }

    /// The same mesh in an order that depends on its shape alone: every triangle begins at its least corner by
    /// coordinates, triangles are sorted by their corners, vertices are numbered as triangles name them first.
    ///
    /// Vertices at the same place stay apart. Vertices without triangles are left out.
    pub(crate) fn canonical(&self) -> Self {
        let ranks = self.ranks();
        let from_least_corner = |&t: &[u32; 3]| {
            let rank = |t: [u32; 3]| t.map(|i| ranks[i as usize]);
            let turns = [t, [t[1], t[2], t[0]], [t[2], t[0], t[1]]];
            turns.into_iter().map(|t| (rank(t), t)).min().unwrap_or((rank(t), t))
        };
        let mut sorted: Vec<_> = self.triangles.iter().map(from_least_corner).collect();
        sorted.sort_unstable_by_key(|(ranks, _)| *ranks);
        let mut numbers = vec![None; self.positions.len()];
        let mut positions = Vec::with_capacity(self.positions.len());
        let mut number = |old: u32| {
            *numbers[old as usize].get_or_insert_with(|| {
                positions.push(self.positions[old as usize]);
                positions.len() as u32 - 1
            })
        };
        let triangles = sorted.into_iter().map(|(_, t)| t.map(&mut number)).collect();
        Self { positions, triangles }
    }

    /// Each vertex's place among all by coordinates; vertices at the same place share theirs.
    fn ranks(&self) -> Vec<u32> {
        let place = |i: u32| self.positions[i as usize];
        let by_place = |a: [f64; 3], b: [f64; 3]| {
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
        };
        let mut order: Vec<u32> = (0..self.positions.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| by_place(place(a), place(b)));
        let mut ranks = vec![0; order.len()];
        for (k, &vertex) in order.iter().enumerate().skip(1) {
            let before = order[k - 1];
            let step = u32::from(by_place(place(before), place(vertex)).is_ne());
            ranks[vertex as usize] = ranks[before as usize] + step;
        }
        ranks
    }
}

impl From<FlatMesh> for MeshBuffers {
    fn from(flat: FlatMesh) -> Self {
        Self { positions: tuples(&flat.positions), triangles: tuples(&flat.triangles) }
    }
}

impl BooleanOperation {
    /// The number that stands for it in C++ (`cpp/boolean_operation.h`).
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Union => 0,
            Self::Intersection => 1,
            Self::Difference => 2,
        }
    }
}

/// Groups a flat array into tuples of `N`; C++ always gives a multiple of `N`.
pub(crate) fn tuples<T: Copy, const N: usize>(flat: &[T]) -> Vec<[T; N]> {
    flat.as_chunks().0.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron and its mirror image, which touch at the origin in a vertex each.
    fn touching() -> MeshBuffers {
        let half = |s: f64| [[0.0; 3], [s, 0.0, 0.0], [0.0, s, 0.0], [0.0, 0.0, s]];
        let positions = [half(1.0), half(-1.0)].concat();
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let triangles = faces.iter().copied().chain(faces.map(|[a, b, c]| [4 + a, 4 + c, 4 + b])).collect();
        MeshBuffers { positions, triangles }
    }

    /// The same with vertices and triangles in reversed order and triangles turned.
    fn renumbered(mesh: &MeshBuffers) -> MeshBuffers {
        let last = mesh.positions.len() as u32 - 1;
        let turned = |&[a, b, c]: &[u32; 3]| [b, c, a].map(|i| last - i);
        MeshBuffers {
            positions: mesh.positions.iter().rev().copied().collect(),
            triangles: mesh.triangles.iter().rev().map(turned).collect(),
        }
    }

    #[test]
    fn the_canonical_order_forgets_the_numbering_and_keeps_the_shape() {
        let mesh = touching();
        let canonical = mesh.canonical();
        assert_eq!(canonical, renumbered(&mesh).canonical());
        assert_eq!(canonical, canonical.canonical());
        assert_eq!((canonical.positions.len(), canonical.triangles.len()), (8, 8));
        let corners = |mesh: &MeshBuffers| {
            let mut all: Vec<String> = mesh
                .triangles
                .iter()
                .map(|t| {
                    let p = t.map(|i| mesh.positions[i as usize]);
                    let least = (0..3).min_by(|&a, &b| p[a].partial_cmp(&p[b]).unwrap()).unwrap();
                    format!("{:?}", [0, 1, 2].map(|k| p[(least + k) % 3].map(|x| x + 0.0)))
                })
                .collect();
            all.sort();
            all
        };
        assert_eq!(corners(&mesh), corners(&canonical));
    }
}
