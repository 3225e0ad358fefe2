//! Sparse normal equations: symmetric, over the poles of one lattice or several.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Mat, Side};
use glam::DVec3;

/// The lower triangle of a symmetric matrix, column by column: rows ascending, with their values.
#[derive(Clone, Debug)]
pub(crate) struct Symmetric {
    columns: Vec<Vec<(u32, f64)>>,
}

/// A sum of three matrices with any factors, ready to be factorised.
pub(crate) struct System {
    symbolic: SymbolicSparseColMat<usize>,
    order: SymbolicLlt<usize>,
    /// Their values at each place of the pattern.
    values: Vec<[f64; 3]>,
}

/// A factorised system.
pub(crate) struct Factor {
    values: Vec<f64>,
    llt: Llt<usize, f64>,
}

impl Symmetric {
    pub(crate) fn zero(size: usize) -> Self {
        Self { columns: vec![Vec::new(); size] }
    }

    /// Adds `weight · aᵀa` of a sparse row `a` of (unknown, coefficient), each unknown once.
    pub(crate) fn add_row(&mut self, row: &[(u32, f64)], weight: f64) {
        for &(low, a) in row {
            for &(high, b) in row.iter().filter(|entry| entry.0 >= low) {
                self.add(low, high, weight * a * b);
            }
        }
    }

    fn add(&mut self, low: u32, high: u32, value: f64) {
        let column = &mut self.columns[low as usize];
        match column.binary_search_by_key(&high, |entry| entry.0) {
            Ok(place) => column[place].1 += value,
            Err(place) => column.insert(place, (high, value)),
        }
    }

    /// `xᵀ self x`, coordinate by coordinate.
    #[cfg(test)]
    pub(crate) fn quadratic(&self, x: &[DVec3]) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (low, column) in self.columns.iter().enumerate() {
            for &(high, value) in column {
                let twice = if low == high as usize { 1.0 } else { 2.0 };
                sum += twice * value * x[low] * x[high as usize];
            }
        }
        sum
    }
}

impl System {
    /// The matrices in one pattern, with what the factorisation needs to know of it.
    ///
    /// # Errors
    /// The solver's words, if it runs out of memory.
    pub(crate) fn new(matrices: [&Symmetric; 3]) -> Result<Self, String> {
        let size = matrices[0].columns.len();
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in 0..size {
            for (row, value) in merged(matrices.map(|m| m.columns[column].as_slice())) {
                rows.push(row as usize);
                values.push(value);
            }
            starts.push(rows.len());
        }
        let symbolic = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
        let order = SymbolicLlt::try_new(symbolic.as_ref(), Side::Lower).map_err(|e| format!("{e:?}"))?;
        Ok(Self { symbolic, order, values })
    }

    /// Factorises the sum with these factors by a sparse LLᵀ.
    ///
    /// # Errors
    /// The solver's words, if the matrix is not positive definite.
    pub(crate) fn factor(&self, factors: [f64; 3]) -> Result<Factor, String> {
        let sum = |v: &[f64; 3]| v.iter().zip(factors).map(|(v, f)| v * f).sum();
        let values: Vec<f64> = self.values.iter().map(sum).collect();
        let matrix = SparseColMatRef::new(self.symbolic.as_ref(), &values);
        let llt = Llt::try_new_with_symbolic(self.order.clone(), matrix, Side::Lower)
            .map_err(|e| format!("{e:?}"))?;
        Ok(Factor { values, llt })
    }

    /// Solves the factorised system, with one step of iterative refinement.
    pub(crate) fn solve(&self, factor: &Factor, right: &[DVec3]) -> Vec<DVec3> {
        let solve = |b: &[DVec3]| -> Vec<DVec3> {
            let x = factor.llt.solve(&Mat::from_fn(b.len(), 3, |i, k| b[i][k]));
            (0..b.len()).map(|i| DVec3::new(x[(i, 0)], x[(i, 1)], x[(i, 2)])).collect()
        };
        let mut x = solve(right);
        let correction = solve(&self.residual(&factor.values, &x, right));
        x.iter_mut().zip(correction).for_each(|(x, c)| *x += c);
        x
    }

    /// `right − matrix · x`.
    fn residual(&self, values: &[f64], x: &[DVec3], right: &[DVec3]) -> Vec<DVec3> {
        let mut left = right.to_vec();
        for column in 0..x.len() {
            for (row, k) in self.symbolic.row_idx_of_col(column).zip(self.symbolic.col_range(column)) {
                left[row] -= values[k] * x[column];
                if row != column {
                    left[column] -= values[k] * x[row];
                }
            }
        }
        left
    }
}

/// Three columns as one, with all values in each row.
fn merged(columns: [&[(u32, f64)]; 3]) -> Vec<(u32, [f64; 3])> {
    let mut rest = columns;
    let mut all = Vec::with_capacity(columns[0].len());
    while let Some(row) = rest.iter().filter_map(|c| c.first()).map(|e| e.0).min() {
        let values = [0, 1, 2].map(|k| match rest[k].split_first() {
            Some((&(first, value), more)) if first == row => {
                rest[k] = more;
                value
            }
            _ => 0.0,
        });
        all.push((row, values));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row over the 4 × 4 poles from (i, j) on of 6 × 5, with coefficients of no pattern.
    fn row(i: u32, j: u32) -> Vec<(u32, f64)> {
        (0..16).map(|k| ((i + k / 4) * 5 + j + k % 4, f64::from((k * 7 + i + 2 * j) % 11) - 4.0)).collect()
    }

    #[test]
    fn solving_gives_back_what_the_product_was_made_of() {
        let (mut data, mut ones) = (Symmetric::zero(30), Symmetric::zero(30));
        let known: Vec<_> = (0..30).map(|k| DVec3::new(k as f64, (k * k % 17) as f64, -1.5)).collect();
        let mut right: Vec<_> = known.iter().map(|x| 0.5 * *x).collect();
        for (i, j) in [(0, 0), (1, 1), (2, 0), (2, 1), (0, 1)] {
            data.add_row(&row(i, j), 0.25);
            let value: DVec3 = row(i, j).iter().map(|&(k, a)| a * known[k as usize]).sum();
            row(i, j).iter().for_each(|&(k, a)| right[k as usize] += 0.25 * a * value);
        }
        (0..30).for_each(|k| ones.add_row(&[(k, 1.0)], 1.0));
        let system = System::new([&data, &ones, &Symmetric::zero(30)]).unwrap();
        let found = system.solve(&system.factor([1.0, 0.5, 0.0]).unwrap(), &right);
        for (x, y) in found.iter().zip(&known) {
            assert!(x.distance(*y) < 1e-10, "{x} {y}");
        }
    }

    #[test]
    fn a_singular_system_is_an_error() {
        let mut zero = Symmetric::zero(30);
        zero.add_row(&row(0, 0), 0.0);
        (0..30).for_each(|k| zero.add_row(&[(k, 0.0)], 1.0));
        assert!(System::new([&zero; 3]).unwrap().factor([1.0; 3]).is_err());
    }
}
