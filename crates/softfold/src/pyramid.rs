//! Coarse meshes of the same sheet, through which folding goes to its own mesh.

use crate::goals::goals;
use crate::{Loaded, softness};
use softfold_fold::{Level, schedule};
use softfold_geometry::{CreaseId, CreasePattern, SoftPattern};
use softfold_mesh::mesh;
use softfold_soften::{CreaseSoftness, Segments, soften};

/// Meshes of fewer vertices are folded alone: a pyramid would save nothing.
const LEAST_VERTICES: usize = 2_000;
/// How much longer the edges of the next coarser mesh are.
const COARSER: f64 = 2.2;
/// A coarser mesh is worth having if it has at most this share of the vertices of the finer one.
const FEWER: f64 = 0.5;
/// Strips per band at least, as long as there are as many.
const LEAST_SEGMENTS: u32 = 2;

/// Coarse meshes of a softened sheet whose own mesh has so many vertices, with their goals; the coarsest first. Creases
/// fold by a share of their angles.
///
/// Bands have half as many strips on each coarser mesh. Where the bands do not fit that way, or the goals find no place,
/// the pyramid ends: it saves time, and nothing depends on it.
pub fn levels(
    loaded: &Loaded,
    pattern: &CreasePattern,
    vertices: usize,
    share: &dyn Fn(CreaseId) -> f64,
) -> Vec<Level> {
    let (mut levels, mut finer, mut edge_mm) = (Vec::new(), vertices, loaded.project.mesh.target_edge_mm);
    let Ok(mut softness) = softness::of_all(loaded, pattern, &mut Vec::new()) else { return levels };
    while finer >= LEAST_VERTICES {
        edge_mm *= COARSER;
        let Ok(soft) = soften(pattern, &softness) else { break };
        coarsen(&mut softness, &soft);
        let Some(level) = level(loaded, pattern, &softness, edge_mm, share) else { break };
        let vertices = level.mesh.vertices.len();
        if vertices as f64 > FEWER * finer as f64 {
            break;
        }
        finer = vertices;
        levels.push(level);
    }
    levels.reverse();
    levels
}

/// Half as many strips as the bands have.
fn coarsen(softness: &mut [CreaseSoftness], soft: &SoftPattern) {
    for (s, band) in softness.iter_mut().zip(&soft.bands) {
        let half = band.segments.div_ceil(2).max(LEAST_SEGMENTS).min(band.segments);
        s.segments = Segments::Count(half);
    }
}

fn level(
    loaded: &Loaded,
    pattern: &CreasePattern,
    softness: &[CreaseSoftness],
    target_edge_mm: f64,
    share: &dyn Fn(CreaseId) -> f64,
) -> Option<Level> {
    let soft = soften(pattern, softness).ok()?;
    let options = softfold_mesh::MeshOptions { target_edge_mm, ..loaded.project.mesh.options() };
    let mesh = schedule::with_share(&mesh(&soft, &options).ok()?.mesh, share);
    let goals = goals(loaded, &mesh, pattern).ok()?;
    Some(Level { mesh, goals })
}
