//! One lattice fitted to the folded vertices, at any smoothing.

use crate::SurfaceError;
use crate::bending::bending;
use crate::lattice::Lattice;
use crate::samples::targets;
use crate::system::{Pattern, Symmetric};
use glam::DVec3;
use softfold_geometry::{Deviation, FoldedSheet, UniformBicubic};
use softfold_kernel::opensubdiv::{self, Stencils};

/// The least-squares problem of one lattice, ready to be solved for several bending weights.
pub(crate) struct Fitting<'a> {
    sheet: &'a FoldedSheet,
    pub(crate) lattice: Lattice,
    pattern: Pattern,
    data: Symmetric,
    bending: Symmetric,
    right: Vec<DVec3>,
}

/// A solution and how far it is from the folded vertices.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    pub(crate) lattice: Lattice,
    pub(crate) spline: UniformBicubic,
    pub(crate) deviation: Deviation,
}

impl<'a> Fitting<'a> {
    /// Sets up `Σ Aᵢ |S(uᵢ) − pᵢ|²` over the targets: a row of OpenSubdiv's limit stencils each.
    ///
    /// # Errors
    /// OpenSubdiv's or the solver's refusal.
    pub(crate) fn new(sheet: &'a FoldedSheet, lattice: Lattice) -> Result<Self, SurfaceError> {
        let targets = targets(sheet);
        let samples: Vec<_> = targets.iter().map(|t| lattice.sample(t.uv)).collect();
        let stencils = opensubdiv::limit_stencils(&lattice.connections(), &samples)?;
        let mut data = Symmetric::zero(&lattice);
        let mut right = vec![DVec3::ZERO; lattice.vertices()];
        for (i, target) in targets.iter().enumerate() {
            let row = row(&stencils, i);
            data.add_row(&row, target.weight_mm2);
            row.iter().for_each(|&(pole, w)| right[pole as usize] += target.weight_mm2 * w * target.position);
        }
        let pattern = Pattern::new(&lattice).map_err(|cause| unsolved(&lattice, cause))?;
        Ok(Self { sheet, lattice, pattern, data, bending: bending(&lattice), right })
    }

    /// The surface that minimises data term plus `bending_weight_mm4` times the bending term.
    ///
    /// # Errors
    /// The equations cannot be solved.
    pub(crate) fn solve(&self, bending_weight_mm4: f64) -> Result<Solution, SurfaceError> {
        let poles = self
            .pattern
            .solve(&self.data, bending_weight_mm4, &self.bending, &self.right)
            .map_err(|cause| unsolved(&self.lattice, cause))?;
        let spline = self.lattice.spline(poles);
        spline.check().map_err(|e| unsolved(&self.lattice, e.fault))?;
        let deviation = deviation(&spline, self.sheet);
        Ok(Solution { lattice: self.lattice, spline, deviation })
    }
}

/// Distance of each folded vertex to the surface's point of the same (u, v): never less than the distance to the
/// surface itself. The root mean square counts every vertex alike.
pub(crate) fn deviation(spline: &UniformBicubic, sheet: &FoldedSheet) -> Deviation {
    let mut worst = Deviation::default();
    let mut squares = 0.0;
    for (&uv, &p) in sheet.mesh.vertices.iter().zip(&sheet.positions) {
        let distance = spline.at(uv).position.distance(p);
        squares += distance * distance;
        if distance > worst.max_mm {
            worst = Deviation { max_mm: distance, at: uv, ..worst };
        }
    }
    Deviation { rms_mm: (squares / sheet.positions.len().max(1) as f64).sqrt(), ..worst }
}

fn row(stencils: &Stencils, i: usize) -> Vec<(u32, f64)> {
    let range = stencils.offsets[i] as usize..stencils.offsets[i + 1] as usize;
    range.map(|k| (stencils.indices[k], stencils.weights[k])).collect()
}

fn unsolved(lattice: &Lattice, cause: String) -> SurfaceError {
    SurfaceError::Factorisation { spacing_mm: lattice.spacing_mm, cause }
}
