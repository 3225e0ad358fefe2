//! Why no surface could be made.

use glam::DVec2;
use softfold_geometry::CheckError;
use softfold_kernel::KernelError;

/// Why a surface cannot be fitted or looked at. Options are named by their keys in the project file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// A length or weight that must be positive is not.
    #[error("surface.{key} is {value}: give a number above 0, {mend}")]
    NotPositive {
        /// Key in the project file.
        key: &'static str,
        /// What was given.
        value: f64,
        /// What a good value would be.
        mend: &'static str,
    },
    /// The lattice would not reach past the outline, or be nothing but margin.
    #[error(
        "surface.margin_cells is {given}: give {least} to {most}, the surface must reach past the outline"
    )]
    Margin {
        /// What was given.
        given: u32,
        /// The least that works.
        least: u32,
        /// The most that makes sense.
        most: u32,
    },
    /// The step of an analysis is no length.
    #[error("the surface cannot be looked at in steps of {step_mm} mm: give a number above 0, 1 for example")]
    Step {
        /// What was given, mm.
        step_mm: f64,
    },
    /// The lattice would be larger than memory and time allow.
    #[error(
        "surface.spacing_mm of {spacing_mm} needs {poles} poles, the limit is {limit}: give {least_mm:.3} or more"
    )]
    TooManyPoles {
        /// The spacing asked for, mm.
        spacing_mm: f64,
        /// Poles that it needs.
        poles: usize,
        /// Most poles of a lattice.
        limit: usize,
        /// A spacing that fits, mm.
        least_mm: f64,
    },
    /// Nothing to fit to.
    #[error("the folded sheet has no triangles: mesh the pattern first")]
    Empty,
    /// The sheet's outline is not given.
    #[error("the sheet has no outline to trim its surface with: give the closed outline first, then holes")]
    NoTrim,
    /// A trim curve does not close.
    #[error("trim curve {number} ends at ({:.3}, {:.3}) mm, not where it starts: close it", at.x, at.y)]
    OpenTrim {
        /// Number of the curve, 0 for the outline.
        number: usize,
        /// Its end, (u, v) in mm.
        at: DVec2,
    },
    /// The folded sheet breaks its contract.
    #[error(transparent)]
    Sheet(#[from] CheckError),
    /// The normal equations could not be solved.
    #[error(
        "the fit at a spacing of {spacing_mm:.3} mm could not be solved ({cause}): raise surface.bending_weight"
    )]
    Factorisation {
        /// Spacing of the lattice, mm.
        spacing_mm: f64,
        /// What the solver said.
        cause: String,
    },
    /// The quad cage is no mesh of the sheet.
    #[error(
        "no quad cage of {cell_mm:.1} mm cells fits the sheet: {fault} near ({:.1}, {:.1}) mm; give a smaller \
         surface.spacing_mm, or surface.form = \"lattice\"", at.x, at.y
    )]
    CageFolds {
        /// Length of a cell, mm.
        cell_mm: f64,
        /// Where, (u, v) in mm.
        at: DVec2,
        /// What is wrong.
        fault: &'static str,
    },
    /// OpenSubdiv refused the cage.
    #[error(transparent)]
    Kernel(#[from] KernelError),
}

impl SurfaceError {
    /// Refuses what is not above 0 (NaN and infinity too).
    pub(crate) fn require_positive(
        key: &'static str,
        value: f64,
        mend: &'static str,
    ) -> Result<(), SurfaceError> {
        match is_positive(value) {
            true => Ok(()),
            false => Err(Self::NotPositive { key, value, mend }),
        }
    }
}

/// Above 0 and finite.
pub(crate) fn is_positive(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}
