//! The sparse Hessian: 3×3 blocks by vertex pairs in the lower triangle of a CSC matrix, vertices in order of elimination.

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use glam::{DMat3, DVec3};

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
    /// Vertices in order of elimination, which is the order of the columns.
    order: Vec<u32>,
    /// Place of each vertex in that order.
    places: Vec<u32>,
    /// Rows (places ≥ the column's) of all block columns, one after the other.
    rows: Vec<u32>,
    /// Where the rows of each block column begin.
    columns: Vec<usize>,
    /// First value of each scalar column.
    starts: Vec<usize>,
}

impl Hessian {
    /// A zero matrix with room for the pairs in `rows`, which [`coupled_rows`] made; `order[k]` is eliminated `k`-th.
    pub(crate) fn new(rows: &[Vec<u32>], order: Vec<u32>) -> Self {
        let mut places = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, &v)| places[v as usize] = k as u32);
        let mut lower: Vec<Vec<u32>> = vec![Vec::new(); order.len()];
        for (j, r) in rows.iter().enumerate() {
            for &i in r {
                let (a, b) = (places[i as usize], places[j]);
                lower[a.min(b) as usize].push(a.max(b));
            }
        }
        let mut columns = vec![0];
        for r in &mut lower {
            r.sort_unstable();
            columns.push(columns[columns.len() - 1] + r.len());
        }
        let (starts, row_indices) = scalar_pattern(&lower);
        let n = 3 * order.len();
        let values = vec![0.0; row_indices.len()];
        let symbolic = SymbolicSparseColMat::new_checked(n, n, starts.clone(), None, row_indices);
        Self { symbolic, values, order, places, rows: lower.concat(), columns, starts }
    }

    /// Sets all values to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Where the block of two places stands in its column.
    fn place_of(&self, row: u32, column: u32) -> Option<usize> {
        self.rows[self.columns[column as usize]..self.columns[column as usize + 1]].binary_search(&row).ok()
    }

    /// Whether every one of these pairs has its place.
    pub(crate) fn holds<'p>(&self, pairs: impl IntoIterator<Item = &'p [u32; 2]>) -> bool {
        pairs.into_iter().all(|pair| {
            let [a, b] = pair.map(|v| self.places[v as usize]);
            self.place_of(a.max(b), a.min(b)).is_some()
        })
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

    /// One vector per vertex as a column of this matrix' space.
    pub(crate) fn permuted(&self, vectors: &[DVec3]) -> Vec<f64> {
        self.order.iter().flat_map(|&v| vectors[v as usize].to_array()).collect()
    }

    /// A column of this matrix' space as one vector per vertex.
    pub(crate) fn unpermuted(&self, column: &[f64]) -> Vec<DVec3> {
        self.places.iter().map(|&k| DVec3::from_slice(&column[3 * k as usize..])).collect()
    }

    #[cfg(test)]
    pub fn to_dense(&self) -> Vec<Vec<f64>> {
        let n = 3 * self.order.len();
        let vertex_row = |row: usize| 3 * self.order[row / 3] as usize + row % 3;
        let mut dense = vec![vec![0.0; n]; n];
        for column in 0..n {
            let rows = self.symbolic.row_idx_of_col_raw(column);
            for (k, &row) in rows.iter().enumerate() {
                let (i, j) = (vertex_row(row), vertex_row(column));
                dense[i][j] = self.values[self.starts[column] + k];
                dense[j][i] = dense[i][j];
            }
        }
        dense
    }
}

/// First value of each scalar column, and the scalar rows of all values, of a lower triangle of 3×3 blocks.
fn scalar_pattern(lower: &[Vec<u32>]) -> (Vec<usize>, Vec<usize>) {
    let blocks: usize = lower.iter().map(Vec::len).sum();
    let (mut starts, mut row_indices) = (vec![0], Vec::with_capacity(9 * blocks));
    for r in lower {
        for c in 0..3 {
            let scalar = r.iter().flat_map(|&i| (0..3).map(move |k| 3 * i as usize + k));
            row_indices.extend(scalar.skip(c));
            starts.push(row_indices.len());
        }
    }
    (starts, row_indices)
}

/// Where block (i, j) of a symmetric matrix stands in its column; none above the diagonal, which is not kept.
pub(crate) fn place_of(rows: &[Vec<u32>], i: u32, j: u32) -> Option<usize> {
    let place = (i >= j).then(|| rows[j as usize].binary_search(&i));
    debug_assert!(!matches!(place, Some(Err(_))), "block {i} {j} was not announced by couplings()");
    place?.ok()
}

impl BlockSink for Hessian {
    fn add(&mut self, i: u32, j: u32, block: DMat3) {
        if i < j {
            return;
        }
        let (a, b) = (self.places[i as usize], self.places[j as usize]);
        let (row, column, block) = if a < b { (b, a, block.transpose()) } else { (a, b, block) };
        let place = self.place_of(row, column);
        debug_assert!(place.is_some(), "block {i} {j} was not announced by couplings()");
        let Some(place) = place else { return };
        for c in 0..3 {
            let entries = block.col(c);
            let first = self.starts[3 * column as usize + c] + 3 * place;
            let skip = if place == 0 { c } else { 0 };
            for r in skip..3 {
                self.values[first + r - c] += entries[r];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(vertices: usize, groups: &[Vec<u32>], order: &[u32]) -> Hessian {
        Hessian::new(&coupled_rows(vertices, groups), order.to_vec())
    }

    #[test]
    fn pairs_that_were_not_announced_have_no_place() {
        let h = of(3, &[vec![2, 0]], &[1, 2, 0]);
        assert!(h.holds(&[[0, 2], [2, 0], [1, 1]]) && !h.holds(&[[0, 2], [1, 2]]));
    }

    #[test]
    fn blocks_land_in_their_places_in_any_order() {
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            let mut h = of(3, &[vec![2, 0]], &order);
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

    #[test]
    fn vectors_go_there_and_back() {
        let h = of(3, &[], &[2, 0, 1]);
        let vectors = [DVec3::X, DVec3::Y, DVec3::new(7.0, 8.0, 9.0)];
        assert_eq!(h.permuted(&vectors)[..3], [7.0, 8.0, 9.0]);
        assert_eq!(h.unpermuted(&h.permuted(&vectors)), vectors);
    }
}
