//! Sparse least squares of any pattern: rows are added one by one, the normal equations are solved by faer's LLᵀ.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use glam::DVec3;

/// Normal equations `Σ w aᵀa x = Σ w aᵀb` for up to three right sides at once.
#[derive(Clone)]
pub(crate) struct Normal {
    entries: Vec<Triplet<usize, usize, f64>>,
    right: Vec<DVec3>,
}

impl Normal {
    /// Without rows.
    pub(crate) fn new(unknowns: usize) -> Self {
        Self { entries: Vec::new(), right: vec![DVec3::ZERO; unknowns] }
    }

    /// Adds the row `Σ a x = b` with a weight; a row names an unknown at most once.
    pub(crate) fn add(&mut self, row: &[(usize, f64)], value: DVec3, weight: f64) {
        for &(i, a) in row {
            self.right[i] += weight * a * value;
            let lower = row.iter().filter(|entry| entry.0 <= i);
            self.entries.extend(lower.map(|&(j, b)| Triplet::new(i, j, weight * a * b)));
        }
    }

    /// The same for one right side.
    pub(crate) fn add_scalar(&mut self, row: &[(usize, f64)], value: f64, weight: f64) {
        self.add(row, DVec3::new(value, 0.0, 0.0), weight);
    }

    /// The unknowns.
    ///
    /// # Errors
    /// The solver's words, if the rows do not determine them.
    pub(crate) fn solve(&self) -> Result<Vec<DVec3>, String> {
        let n = self.right.len();
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &self.entries)
            .map_err(|e| format!("{e:?}"))?;
        let llt = matrix.sp_cholesky(Side::Lower).map_err(|e| format!("{e:?}"))?;
        let x = llt.solve(&Mat::from_fn(n, 3, |i, k| self.right[i][k]));
        let found: Vec<DVec3> = (0..n).map(|i| DVec3::new(x[(i, 0)], x[(i, 1)], x[(i, 2)])).collect();
        match found.iter().all(|p| p.is_finite()) {
            true => Ok(found),
            false => Err("the solution is not finite".to_owned()),
        }
    }

    /// The unknowns of a system with one right side.
    ///
    /// # Errors
    /// As [`Normal::solve`].
    pub(crate) fn solve_scalar(&self) -> Result<Vec<f64>, String> {
        Ok(self.solve()?.into_iter().map(|p| p.x).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_squares_line_through_three_points_is_found() {
        let mut normal = Normal::new(2);
        for (x, y) in [(0.0, 1.0), (1.0, 2.0), (2.0, 6.0)] {
            normal.add_scalar(&[(1, x), (0, 1.0)], y, 2.0);
        }
        let found = normal.solve_scalar().unwrap();
        assert!((found[0] - 0.5).abs() < 1e-12 && (found[1] - 2.5).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn what_no_row_names_is_an_error() {
        let mut normal = Normal::new(2);
        normal.add_scalar(&[(0, 1.0)], 1.0, 1.0);
        assert!(normal.solve().is_err());
    }
}
