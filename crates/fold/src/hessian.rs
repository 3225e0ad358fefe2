//! The sparse Hessian: 3×3 blocks by vertex pairs in the lower triangle of a CSC matrix.

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use glam::DMat3;

/// What takes the 3×3 blocks ∂²E/∂xᵢ∂xⱼ.
pub(crate) trait BlockSink {
    /// Adds a block; those above the diagonal are passed over.
    fn add(&mut self, i: u32, j: u32, block: DMat3);
}

/// Of each vertex the vertices from it on that a group couples to it, in order.
pub(crate) fn coupled_rows(vertices: usize, groups: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut rows: Vec<Vec<u32>> = (0..vertices as u32).map(|v| vec![v]).collect();
    for group in groups {
        for &j in group {
            rows[j as usize].extend(group.iter().filter(|&&i| i > j));
        }
    }
    for r in &mut rows {
        r.sort_unstable();
        r.dedup();
    }
    rows
}

/// Lower triangle of a symmetric matrix of 3×3 blocks, stored column by column for faer.
pub struct Hessian {
    symbolic: SymbolicSparseColMat<usize>,
    values: Vec<f64>,
    /// Rows (vertices ≥ the column's) of each block column.
    rows: Vec<Vec<u32>>,
    /// First value of each scalar column.
    starts: Vec<usize>,
}

impl Hessian {
    /// A zero matrix for `vertices` vertices with room for every pair of each group.
    pub fn new(vertices: usize, groups: &[Vec<u32>]) -> Self {
        Self::with_rows(coupled_rows(vertices, groups))
    }

    fn with_rows(rows: Vec<Vec<u32>>) -> Self {
        let mut starts = vec![0];
        let mut row_indices = Vec::new();
        for r in &rows {
            let scalar: Vec<usize> =
                r.iter().flat_map(|&i| (0..3).map(move |k| 3 * i as usize + k)).collect();
            for c in 0..3 {
                row_indices.extend_from_slice(&scalar[c..]);
                starts.push(row_indices.len());
            }
        }
        let n = 3 * rows.len();
        let values = vec![0.0; row_indices.len()];
        let symbolic = SymbolicSparseColMat::new_checked(n, n, starts.clone(), None, row_indices);
        Self { symbolic, values, rows, starts }
    }

    /// Sets all values to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Whether every one of these pairs has its place.
    pub fn holds(&self, pairs: &[[u32; 2]]) -> bool {
        pairs.iter().all(|&[i, j]| self.rows[i.min(j) as usize].binary_search(&i.max(j)).is_ok())
    }

    /// Adds `shift` to the diagonal.
    pub fn shift(&mut self, shift: f64) {
        for column in 0..self.starts.len() - 1 {
            self.values[self.starts[column]] += shift;
        }
    }

    /// Mean of the diagonal.
    pub fn mean_diagonal(&self) -> f64 {
        let columns = self.starts.len() - 1;
        self.starts[..columns].iter().map(|&s| self.values[s]).sum::<f64>() / columns.max(1) as f64
    }

    /// Where the values stand.
    pub fn symbolic(&self) -> SymbolicSparseColMatRef<'_, usize> {
        self.symbolic.as_ref()
    }

    /// The matrix (lower triangle).
    pub fn matrix(&self) -> SparseColMatRef<'_, usize, f64> {
        SparseColMatRef::new(self.symbolic.as_ref(), &self.values)
    }

    #[cfg(test)]
    pub fn to_dense(&self) -> Vec<Vec<f64>> {
        let n = 3 * self.rows.len();
        let mut dense = vec![vec![0.0; n]; n];
        for column in 0..n {
            let rows = self.symbolic.row_idx_of_col_raw(column);
            for (k, &row) in rows.iter().enumerate() {
                dense[row][column] = self.values[self.starts[column] + k];
                dense[column][row] = dense[row][column];
            }
        }
        dense
    }
}

/// Where block (i, j) of a symmetric matrix stands in its column; none above the diagonal, which is not kept.
pub(crate) fn place_of(rows: &[Vec<u32>], i: u32, j: u32) -> Option<usize> {
    let place = (i >= j).then(|| rows[j as usize].binary_search(&i));
    debug_assert!(!matches!(place, Some(Err(_))), "block {i} {j} was not announced by couplings()");
    place?.ok()
}

impl BlockSink for Hessian {
    fn add(&mut self, i: u32, j: u32, block: DMat3) {
        let Some(place) = place_of(&self.rows, i, j) else { return };
        for c in 0..3 {
            let column = block.col(c);
            let first = self.starts[3 * j as usize + c] + 3 * place;
            let skip = if place == 0 { c } else { 0 };
            for r in skip..3 {
                self.values[first + r - c] += column[r];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_were_not_announced_have_no_place() {
        let h = Hessian::new(3, &[vec![2, 0]]);
        assert!(h.holds(&[[0, 2], [2, 0], [1, 1]]) && !h.holds(&[[0, 2], [1, 2]]));
    }

    #[test]
    fn blocks_land_in_their_places() {
        let mut h = Hessian::new(3, &[vec![2, 0]]);
        let block = DMat3::from_cols_array(&[1., 2., 3., 4., 5., 6., 7., 8., 9.]);
        h.add(2, 0, block);
        h.add(0, 2, block); // the upper one: passed over
        h.add(1, 1, DMat3::IDENTITY * 5.0);
        h.shift(0.5);
        let d = h.to_dense();
        assert_eq!((d[6][0], d[7][0], d[8][0], d[6][1], d[6][2], d[0][8]), (1., 2., 3., 4., 7., 3.));
        assert_eq!((d[3][3], d[4][4], d[3][4], d[0][0]), (5.5, 5.5, 0.0, 0.5));
    }
}
