//! The Hessian's traces: one number per pair of vertices, a Laplacian with the goals' weights.
//!
//! With `tr ∂²E/∂xᵢ∂xⱼ` for each 3×3 block of the Gauss-Newton Hessian, a ninth of its memory, `½ Σ tr(Hᵢⱼ) δᵢ·δⱼ` is
//! the sheet's quadratic energy with the directions forgotten: springs pull as they do in projective dynamics (Bouaziz
//! et al. 2014), hinges bend as in Bergou et al. (2006). Nowhere less than a third of the Hessian's own energy.

use crate::hessian::{BlockSink, coupled_rows, place_of};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::LltError;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Mat, Side};
use glam::{DMat3, DVec3};

/// Lower triangle of the matrix of traces, column by column.
pub(crate) struct Laplacian {
    symbolic: SymbolicSparseColMat<usize>,
    values: Vec<f64>,
    rows: Vec<Vec<u32>>,
    starts: Vec<usize>,
}

/// A Laplacian ready to be solved with.
pub(crate) struct Prefactored(Llt<usize, f64>);

impl Laplacian {
    /// A zero matrix with room for every pair of each group.
    pub(crate) fn new(vertices: usize, groups: &[Vec<u32>]) -> Self {
        let rows = coupled_rows(vertices, groups);
        let mut starts = vec![0];
        for r in &rows {
            starts.push(starts[starts.len() - 1] + r.len());
        }
        let indices: Vec<usize> = rows.iter().flatten().map(|&i| i as usize).collect();
        let values = vec![0.0; indices.len()];
        let symbolic = SymbolicSparseColMat::new_checked(vertices, vertices, starts.clone(), None, indices);
        Self { symbolic, values, rows, starts }
    }

    /// Factorises it with `shift` times its mean diagonal added.
    pub(crate) fn prefactored(&mut self, shift: f64) -> Result<Prefactored, LltError> {
        let columns = self.rows.len();
        let diagonal = &self.starts[..columns];
        let mean = diagonal.iter().map(|&s| self.values[s]).sum::<f64>() / columns.max(1) as f64;
        for &s in diagonal {
            self.values[s] += shift * mean;
        }
        let matrix = SparseColMatRef::new(self.symbolic.as_ref(), &self.values);
        let symbolic = SymbolicLlt::try_new(self.symbolic.as_ref(), Side::Lower)?;
        Llt::try_new_with_symbolic(symbolic, matrix, Side::Lower).map(Prefactored)
    }
}

impl Prefactored {
    /// Solves for the three coordinates at once.
    pub(crate) fn solve(&self, rhs: &[DVec3]) -> Vec<DVec3> {
        let rhs = Mat::from_fn(rhs.len(), 3, |i, k| rhs[i][k]);
        let d = self.0.solve(&rhs);
        (0..d.nrows()).map(|i| DVec3::new(d[(i, 0)], d[(i, 1)], d[(i, 2)])).collect()
    }
}

impl BlockSink for Laplacian {
    fn add(&mut self, i: u32, j: u32, block: DMat3) {
        let Some(place) = place_of(&self.rows, i, j) else { return };
        self.values[self.starts[j as usize] + place] += block.x_axis.x + block.y_axis.y + block.z_axis.z;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_springs_held_at_one_end_solves_by_hand() {
        let mut l = Laplacian::new(3, &[vec![0, 1], vec![1, 2]]);
        // Springs of stiffness 2 and 3 along x; vertex 0 held by 3 in all (trace of the identity).
        let along = DMat3::from_diagonal(DVec3::X);
        for (a, b, k) in [(0, 1, 2.0), (1, 2, 3.0)] {
            l.add(a, a, k * along);
            l.add(b, b, k * along);
            l.add(b, a, -k * along);
            l.add(a, b, 99.0 * along); // the upper one: passed over
        }
        l.add(0, 0, DMat3::IDENTITY);
        let pull = DVec3::new(6.0, -12.0, 0.0);
        let d = l.prefactored(0.0).unwrap().solve(&[DVec3::ZERO, DVec3::ZERO, pull]);
        for (d, factor) in d.iter().zip([1.0 / 3.0, 1.0 / 3.0 + 0.5, 1.0 / 3.0 + 0.5 + 1.0 / 3.0]) {
            assert!((*d - factor * pull).length() < 1e-12);
        }
    }
}
