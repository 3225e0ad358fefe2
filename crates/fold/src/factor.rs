//! The factorised Hessian: supernodal LLᵀ whose symbolic part is made once and whose memory is kept.

use crate::FoldError;
use crate::hessian::Hessian;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side, Spec};
use glam::DVec3;

/// A factor of a [`Hessian`], with the room to factorise it again with other values.
pub(crate) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    memory: MemBuffer,
    /// Numeric factorisations so far, failed ones too.
    pub(crate) factorisations: u32,
}

impl Factor {
    /// Room for the factors of matrices with this pattern; the columns are eliminated as they stand.
    ///
    /// # Errors
    /// [`FoldError::Factorisation`] if memory does not suffice.
    pub(crate) fn new(hessian: &Hessian) -> Result<Self, FoldError> {
        // With columns as they stand faer wants the upper triangle here, and the lower one when it factorises.
        let upper = hessian.symbolic().transpose().to_col_major().map_err(failure)?;
        let symbolic = factorize_symbolic_cholesky(
            upper.as_ref(),
            Side::Upper,
            SymmetricOrdering::Identity,
            CholeskySymbolicParams::default(),
        )
        .map_err(failure)?;
        let numeric = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let solving = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let memory = MemBuffer::try_new(numeric.or(solving)).map_err(failure)?;
        let values = vec![0.0; symbolic.len_val()];
        Ok(Self { symbolic, values, memory, factorisations: 0 })
    }

    /// Factorises the matrix; false if it is not positive definite.
    pub(crate) fn factorise(&mut self, hessian: &Hessian) -> bool {
        self.factorisations += 1;
        let stack = MemStack::new(&mut self.memory);
        let regularization = LltRegularization::default();
        self.symbolic
            .factorize_numeric_llt(
                &mut self.values,
                hessian.matrix(),
                Side::Lower,
                regularization,
                Par::Seq,
                stack,
                Spec::default(),
            )
            .is_ok()
    }

    /// Solves `H d = rhs` with the last factor; one vector per vertex, in the order of the mesh.
    pub(crate) fn solve(&mut self, hessian: &Hessian, rhs: &[DVec3]) -> Vec<DVec3> {
        let mut columns = hessian.permuted(rhs);
        let n = columns.len();
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut columns, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        hessian.unpermuted(&columns)
    }
}

fn failure(e: impl std::fmt::Debug) -> FoldError {
    FoldError::Factorisation(format!("{e:?}"))
}
