//! Sparse normal equations over a lattice: symmetric, and a pole meets only poles three steps away or nearer.

use crate::lattice::Lattice;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Mat, Side};
use glam::DVec3;

/// How far the supports of two bicubic basis functions reach into each other, in cells.
const REACH: usize = 3;
/// Steps across v, −3 to 3.
const WIDTH: usize = 2 * REACH + 1;
/// Couplings of a pole to itself and the poles after it: the upper half of the 7 × 7 square.
const SLOTS: usize = REACH + 1 + REACH * WIDTH;

/// The lower triangle of a symmetric matrix over the poles of a lattice.
#[derive(Clone, Debug)]
pub(crate) struct Symmetric {
    rows_of_v: usize,
    columns: Vec<[f64; SLOTS]>,
}

/// The pattern of all matrices over one lattice, and what its factorisation needs to know of it.
pub(crate) struct Pattern {
    symbolic: SymbolicSparseColMat<usize>,
    order: SymbolicLlt<usize>,
    /// Column and slot of each stored value.
    slots: Vec<(u32, u8)>,
}

impl Symmetric {
    pub(crate) fn zero(lattice: &Lattice) -> Self {
        Self { rows_of_v: lattice.count[1], columns: vec![[0.0; SLOTS]; lattice.vertices()] }
    }

    /// Adds `weight · aᵀa` of a sparse row `a` of (pole, coefficient). Poles must lie within three steps of each other,
    /// as the support of any one point does.
    pub(crate) fn add_row(&mut self, row: &[(u32, f64)], weight: f64) {
        for &(low, a) in row {
            for &(high, b) in row.iter().filter(|entry| entry.0 >= low) {
                let slot = self.slot(low as usize, high as usize);
                debug_assert!(slot.is_some(), "poles {low} and {high} are too far apart");
                if let Some(slot) = slot {
                    self.columns[low as usize][slot] += weight * a * b;
                }
            }
        }
    }

    /// Where pole `high` stands in the column of pole `low`.
    fn slot(&self, low: usize, high: usize) -> Option<usize> {
        let n = self.rows_of_v;
        let across = (high / n).checked_sub(low / n)?;
        let along = (high % n + REACH).checked_sub(low % n)?;
        let slot = (across * WIDTH + along).checked_sub(REACH)?;
        (across <= REACH && along < WIDTH).then_some(slot)
    }

    /// `xᵀ self x`, coordinate by coordinate.
    #[cfg(test)]
    pub(crate) fn quadratic(&self, x: &[DVec3]) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for low in 0..x.len() {
            for high in low..x.len() {
                if let Some(slot) = self.slot(low, high) {
                    let twice = if low == high { 1.0 } else { 2.0 };
                    sum += twice * self.columns[low][slot] * x[low] * x[high];
                }
            }
        }
        sum
    }

    /// `self + factor · other`, value by value in the order of the pattern.
    fn values(&self, factor: f64, other: &Self, pattern: &Pattern) -> Vec<f64> {
        let value = |&(c, s): &(u32, u8)| {
            let (c, s) = (c as usize, s as usize);
            self.columns[c][s] + factor * other.columns[c][s]
        };
        pattern.slots.iter().map(value).collect()
    }
}

impl Pattern {
    /// The pattern over a lattice.
    ///
    /// # Errors
    /// The solver's words, if it runs out of memory.
    pub(crate) fn new(lattice: &Lattice) -> Result<Self, String> {
        let [nu, nv] = lattice.count;
        let (mut starts, mut rows, mut slots) = (vec![0], Vec::new(), Vec::new());
        for column in 0..nu * nv {
            for slot in 0..SLOTS {
                let (across, along) = ((slot + REACH) / WIDTH, (slot + REACH) % WIDTH);
                let (i, j) = (column / nv + across, column % nv + along);
                if i < nu && (REACH..nv + REACH).contains(&j) {
                    rows.push(i * nv + j - REACH);
                    slots.push((column as u32, slot as u8));
                }
            }
            starts.push(rows.len());
        }
        let symbolic = SymbolicSparseColMat::new_checked(nu * nv, nu * nv, starts, None, rows);
        let order = SymbolicLlt::try_new(symbolic.as_ref(), Side::Lower).map_err(|e| format!("{e:?}"))?;
        Ok(Self { symbolic, order, slots })
    }

    /// Solves `(data + factor · bending) x = right` by a sparse LLᵀ.
    ///
    /// # Errors
    /// The solver's words, if the matrix is not positive definite.
    pub(crate) fn solve(
        &self,
        data: &Symmetric,
        factor: f64,
        bending: &Symmetric,
        right: &[DVec3],
    ) -> Result<Vec<DVec3>, String> {
        let values = data.values(factor, bending, self);
        let matrix = SparseColMatRef::new(self.symbolic.as_ref(), &values);
        let llt = Llt::try_new_with_symbolic(self.order.clone(), matrix, Side::Lower)
            .map_err(|e| format!("{e:?}"))?;
        let x = llt.solve(&Mat::from_fn(right.len(), 3, |i, k| right[i][k]));
        Ok((0..right.len()).map(|i| DVec3::new(x[(i, 0)], x[(i, 1)], x[(i, 2)])).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn lattice() -> Lattice {
        Lattice { origin: DVec2::ZERO, spacing_mm: 1.0, count: [6, 5] }
    }

    /// A row over the 4 × 4 poles from (i, j) on, with coefficients of no pattern.
    fn row(i: u32, j: u32) -> Vec<(u32, f64)> {
        (0..16).map(|k| ((i + k / 4) * 5 + j + k % 4, f64::from((k * 7 + i + 2 * j) % 11) - 4.0)).collect()
    }

    #[test]
    fn solving_gives_back_what_the_product_was_made_of() {
        let lattice = lattice();
        let (mut data, mut ones) = (Symmetric::zero(&lattice), Symmetric::zero(&lattice));
        let known: Vec<_> = (0..30).map(|k| DVec3::new(k as f64, (k * k % 17) as f64, -1.5)).collect();
        let mut right: Vec<_> = known.iter().map(|x| 0.5 * *x).collect();
        for (i, j) in [(0, 0), (1, 1), (2, 0), (2, 1), (0, 1)] {
            data.add_row(&row(i, j), 0.25);
            let value: DVec3 = row(i, j).iter().map(|&(k, a)| a * known[k as usize]).sum();
            row(i, j).iter().for_each(|&(k, a)| right[k as usize] += 0.25 * a * value);
        }
        (0..30).for_each(|k| ones.add_row(&[(k, 1.0)], 1.0));
        let found = Pattern::new(&lattice).unwrap().solve(&data, 0.5, &ones, &right).unwrap();
        for (x, y) in found.iter().zip(&known) {
            assert!(x.distance(*y) < 1e-10, "{x} {y}");
        }
    }

    #[test]
    fn a_singular_system_is_an_error() {
        let zero = Symmetric::zero(&lattice());
        assert!(Pattern::new(&lattice()).unwrap().solve(&zero, 1.0, &zero, &[DVec3::ZERO; 30]).is_err());
    }
}
