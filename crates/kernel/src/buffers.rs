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
