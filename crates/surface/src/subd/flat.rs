//! The flat cage of a sheet: boundary-conforming quads with their rows along the bands.

use super::background::Background;
use super::frame::Frame;
use super::grid::{Cells, grid};
use super::labels::{border_angles, pieces};
use super::layer::{add_layers, is_smooth};
use super::quads::{Quads, Sides};
use super::quality::{CageQuality, quality};
use super::rails::{Rails, corners};
use super::{extract, smooth};
use crate::SurfaceError;
use glam::DVec2;
use softfold_geometry::{FlatMesh, PlanarCurve, SoftPattern};

/// Depth of the layers along the border, mm per mm of cell.
const LAYER_CELLS: u32 = 1;
/// Rounds of smoothing; it ends before where nothing moves any more.
const ROUNDS: usize = 400;

/// A flat cage and its figures.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FlatCage {
    pub(crate) quads: Quads,
    pub(crate) borders: Vec<Vec<u32>>,
    pub(crate) quality: CageQuality,
}

/// Lays a cage over a sheet, with cells of the given sizes.
///
/// # Errors
/// The map onto the grid cannot be solved, or its cells do not fit between the lines of the pattern.
pub(crate) fn flat_cage(mesh: &FlatMesh, soft: &SoftPattern, cells: Cells) -> Result<FlatCage, SurfaceError> {
    let unsolved = |cause| SurfaceError::Factorisation { spacing_mm: cells.cell_mm, cause };
    let ground = Background::new(mesh, soft);
    let frame = Frame::of_bands(&ground).map_err(unsolved)?;
    let first = pieces(&ground, &frame, cells.cell_mm);
    let frame = frame.with_border(&ground, &border_angles(&ground, &first)).map_err(unsolved)?;
    let pieces = pieces(&ground, &frame, cells.cell_mm);
    let grid = grid(&ground, &frame, &pieces, cells).map_err(unsolved)?;
    let mut quads = extract::quads(&ground, &grid);
    check(&quads, soft.loops.len(), cells)?;
    let corners = corners(&soft.loops);
    let hard =
        |p: DVec2| corners.iter().any(|c| !is_smooth(c.angle_rad) && c.at.distance(p) < 0.75 * cells.cell_mm);
    add_layers(&mut quads, LAYER_CELLS, &|p| !hard(p));
    let borders = check(&quads, soft.loops.len(), cells)?;
    let mut rails = Rails::new(&ground, &mut quads, &borders, cells.cell_mm);
    let irregular = irregular(&quads, &borders);
    smooth::smooth(&mut quads, &mut rails, ROUNDS, &irregular);
    onto_curves(&mut quads, &borders, soft);
    let quality = quality(&ground, &quads, &borders, cells.cell_mm);
    Ok(FlatCage { quads, borders, quality })
}

/// Inner vertices with other than four edges.
fn irregular(quads: &Quads, borders: &[Vec<u32>]) -> Vec<u32> {
    let mut valences = quads.valences();
    borders.iter().flatten().for_each(|&v| valences[v as usize] = 4);
    (0..valences.len() as u32).filter(|&v| valences[v as usize] != 4).collect()
}

/// Border vertices exactly onto their curves.
fn onto_curves(quads: &mut Quads, borders: &[Vec<u32>], soft: &SoftPattern) {
    for &v in borders.iter().flatten() {
        let p = quads.points[v as usize];
        let near = |c: &PlanarCurve| c.nearest(p);
        let nearest = soft.loops.iter().map(|c| (c, near(c))).min_by(|a, b| a.1.1.total_cmp(&b.1.1));
        if let Some((curve, (s_mm, _))) = nearest {
            quads.points[v as usize] = curve.point(s_mm);
        }
    }
}

/// One sheet with as many loops as the pattern has: V − E + F = 2 − loops.
fn check(quads: &Quads, loops: usize, cells: Cells) -> Result<Vec<Vec<u32>>, SurfaceError> {
    let folded =
        |at: DVec2, fault: &'static str| SurfaceError::CageFolds { cell_mm: cells.cell_mm, at, fault };
    if quads.quads.is_empty() {
        return Err(folded(DVec2::ZERO, "no cell fits into the sheet"));
    }
    let sides =
        quads.sides().map_err(|[a, _]| folded(quads.points[a as usize], "two quads lie on each other"))?;
    let borders = quads.borders(&sides);
    // A fault shows as a small border of its own.
    let first = borders.iter().min_by_key(|b| b.len()).map_or(DVec2::ZERO, |b| quads.points[b[0] as usize]);
    if borders.len() != loops {
        return Err(folded(first, "its borders are not those of the sheet"));
    }
    let euler = quads.points.len() as i64 - quads.edges().len() as i64 + quads.quads.len() as i64;
    if euler != 2 - loops as i64 {
        return Err(folded(first, "it is not one piece"));
    }
    Ok(borders)
}

impl FlatCage {
    /// The directed edges.
    ///
    /// # Errors
    /// A cage that is no mesh: it has been checked before.
    pub(crate) fn sides(&self, cells: Cells) -> Result<Sides, SurfaceError> {
        let at = |[a, _]: [u32; 2]| self.quads.points[a as usize];
        let fault = "two quads lie on each other";
        self.quads.sides().map_err(|e| SurfaceError::CageFolds { cell_mm: cells.cell_mm, at: at(e), fault })
    }
}
