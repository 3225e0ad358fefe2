//! The conforming surface of a folded sheet: cells are halved until the folded vertices are near enough.

use super::faces::faces;
use super::flat::{FlatCage, flat_cage};
use super::grid::Cells;
use super::joins::{Joins, joins};
use super::lift::{Lifted, Lifting};
use super::quality::CageQuality;
use super::sew::{Polysurface, sewn};
use crate::scale::{NARROW_SHARE, strip_width_mm};
use crate::{Cage, SurfaceError, SurfaceOptions};
use glam::DVec2;
use softfold_geometry::{Deviation, FoldedSheet, SoftPattern};

/// Cells that are tried, in strip widths, with cells per strip.
const LADDER: [(f64, u32); 5] = [(2.5, 1), (1.75, 1), (1.25, 1), (1.0, 2), (0.7, 2)];
/// Numbers of cells that are tried before, where strips are so narrow that these are coarser: bands that taper away must not
/// rule the whole cage.
const COARSE: [f64; 4] = [4_000.0, 10_000.0, 25_000.0, MOST_VERTICES];
/// Most vertices of a cage: some hundred MB and some ten seconds of solving.
const MOST_VERTICES: f64 = 60_000.0;
/// Ratio of a bending weight to the one before it, once the cells are least.
const RELAXATION: f64 = 0.1;
/// How often the bending weight is lowered.
const MOST_RELAXATIONS: usize = 3;

/// A surface by subdivision of a cage that conforms to the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Conforming {
    /// The control cage.
    pub cage: Cage,
    /// Where its vertices are on the flat sheet, (u, v) in mm; on the border exactly on the outline.
    pub flat: Vec<DVec2>,
    /// What its flat form is worth.
    pub quality: CageQuality,
    /// Length of a cell away from the bands, mm.
    pub cell_mm: f64,
    /// Cells across each strip of a band.
    pub cells_per_strip: u32,
    /// Distance of each folded vertex to the surface's point of the same (u, v).
    pub deviation: Deviation,
    /// Largest distance of the outline from the border of the flat limit, mm.
    pub border_mm: f64,
    /// Bending weight that was used.
    pub bending_weight: f64,
    /// Whether the deviation is within the tolerance.
    pub tolerance_met: bool,
    /// Why the search ended, in words.
    pub why: String,
    /// The surface as B-spline faces.
    pub surface: Polysurface,
    /// Patches before merging.
    pub patches: usize,
    /// How smooth it is from face to face.
    pub joins: Joins,
}

/// Lays a cage over the sheet and fits its limit to the folded vertices; of the options, margins are not looked at.
///
/// # Errors
/// Options that make no sense, sheets without triangles or too narrow for cells, and what the solver or OpenSubdiv refuse.
pub fn fit_conforming(
    sheet: &FoldedSheet,
    soft: &SoftPattern,
    options: &SurfaceOptions,
) -> Result<Conforming, SurfaceError> {
    options.check()?;
    sheet.check()?;
    let strip_mm = strip_width_mm(&sheet.mesh, NARROW_SHARE).ok_or(SurfaceError::Empty)?;
    let mut refused = None;
    let mut best: Option<Fit> = None;
    for cells in ladder(strip_mm, sheet, options) {
        match fit_one(sheet, soft, options, cells, strip_mm) {
            Ok(fit) => {
                let met = fit.off_mm() <= options.tolerance_mm;
                if best.as_ref().is_none_or(|b| fit.lifted.deviation.max_mm < b.off_mm()) {
                    best = Some(fit);
                }
                if met {
                    break;
                }
            }
            Err(error @ SurfaceError::CageFolds { .. }) => refused = refused.or(Some(error)),
            Err(error) => return Err(error),
        }
    }
    match best {
        Some(fit) => fit.finish(options),
        None => Err(refused.unwrap_or(SurfaceError::Empty)),
    }
}

/// The cells to try, coarse to fine.
fn ladder(strip_mm: f64, sheet: &FoldedSheet, options: &SurfaceOptions) -> Vec<Cells> {
    if let Some(cell_mm) = options.spacing_mm {
        return vec![Cells { cell_mm, per_strip: (strip_mm / cell_mm).round().max(1.0) as u32 }];
    }
    let area = sheet.mesh.area_mm2();
    let fits = |c: &Cells| area / (c.cell_mm * c.cell_mm) <= MOST_VERTICES;
    let steps = LADDER.map(|(cell, per_strip)| Cells { cell_mm: cell * strip_mm, per_strip });
    let first_mm = LADDER[0].0 * strip_mm;
    let coarse = COARSE.map(|n| Cells { cell_mm: (area / n).sqrt(), per_strip: 1 });
    coarse.into_iter().filter(|c| c.cell_mm > first_mm).chain(steps.into_iter().filter(fits)).collect()
}

/// One cage, fitted.
struct Fit {
    cells: Cells,
    cage: FlatCage,
    flat: Vec<DVec2>,
    lifted: Lifted,
    border_mm: f64,
    bending_weight: f64,
}

fn fit_one(
    sheet: &FoldedSheet,
    soft: &SoftPattern,
    options: &SurfaceOptions,
    cells: Cells,
    strip_mm: f64,
) -> Result<Fit, SurfaceError> {
    let cage = flat_cage(&sheet.mesh, soft, cells)?;
    let sides = cage.sides(cells)?;
    let lifting = Lifting::new(sheet, &cage, &sides, &soft.loops)?;
    let length_mm = strip_mm.max(cells.cell_mm / f64::from(cells.per_strip));
    let mut weight = options.bending_weight;
    let mut lifted = lifting.solve(weight * length_mm.powi(4))?;
    for _ in 0..MOST_RELAXATIONS {
        if lifted.deviation.max_mm <= options.tolerance_mm {
            break;
        }
        let other = lifting.solve(RELAXATION * weight * length_mm.powi(4))?;
        if other.deviation.max_mm < lifted.deviation.max_mm {
            (lifted, weight) = (other, RELAXATION * weight);
        }
    }
    let border_mm = lifting.missed_mm();
    let flat = lifting.flat;
    Ok(Fit { cells, cage, flat, lifted, border_mm, bending_weight: weight })
}

impl Fit {
    /// The larger of the distances in space and at the outline, mm.
    fn off_mm(&self) -> f64 {
        self.lifted.deviation.max_mm.max(self.border_mm)
    }

    fn finish(self, options: &SurfaceOptions) -> Result<Conforming, SurfaceError> {
        let Self { cells, cage, flat, lifted, border_mm, bending_weight } = self;
        let sides = cage.sides(cells)?;
        let made = faces(&cage.quads, &sides, &lifted.positions, &flat)?;
        let surface = sewn(&cage.quads, made.faces);
        let (d, tolerance) = (lifted.deviation, options.tolerance_mm);
        let tolerance_met = d.max_mm.max(border_mm) <= tolerance;
        let why = match tolerance_met {
            true => format!("cells of {:.1} mm: within {tolerance} mm", cells.cell_mm),
            false if d.max_mm <= tolerance => format!(
                "cells of {:.1} mm: the border is {border_mm:.3} mm off the outline, more than the {tolerance} mm of \
                 surface.tolerance_mm",
                cells.cell_mm
            ),
            false => format!(
                "cells of {:.1} mm: {:.3} mm off at ({:.1}, {:.1}), more than the {tolerance} mm of \
                 surface.tolerance_mm",
                cells.cell_mm, d.max_mm, d.at.x, d.at.y
            ),
        };
        Ok(Conforming {
            cage: Cage { positions: lifted.positions, quads: cage.quads.quads },
            flat: cage.quads.points,
            quality: cage.quality,
            cell_mm: cells.cell_mm,
            cells_per_strip: cells.per_strip,
            deviation: d,
            border_mm,
            bending_weight,
            tolerance_met,
            why,
            joins: joins(&surface),
            surface,
            patches: made.patches,
        })
    }
}
