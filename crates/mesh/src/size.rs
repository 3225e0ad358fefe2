//! The sizing field: small triangles at bands, growing away from them.

use crate::MeshOptions;
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use softfold_geometry::{Band, SoftPattern};

/// Wished edge length over the sheet.
pub(crate) struct SizeField {
    target_mm: f64,
    grading: f64,
    /// Points of the outer fold lines with the edge length of their band.
    sources: RTree<GeomWithData<[f64; 2], f64>>,
}

/// Shortest edges along a band, share of the target: narrower strips get longer triangles, or a hair-thin band would ask
/// for millions of them.
const SHORTEST: f64 = 0.25;

/// Edge length along a band: the strip's width times the aspect, between a quarter of the target and the target.
pub(crate) fn band_edge_mm(band: &Band, options: &MeshOptions) -> f64 {
    match band.fold_lines.len() {
        0 | 1 => options.target_edge_mm,
        _ => {
            let shortest = SHORTEST * options.target_edge_mm;
            (options.band_aspect * band.strip_width_mm).clamp(shortest, options.target_edge_mm)
        }
    }
}

impl SizeField {
    pub(crate) fn new(soft: &SoftPattern, options: &MeshOptions) -> Self {
        let mut sources = Vec::new();
        for band in &soft.bands {
            let edge_mm = band_edge_mm(band, options);
            for line in band.fold_lines.first().into_iter().chain(band.fold_lines.last()) {
                sources.extend(line.points.iter().map(|p| GeomWithData::new([p.x, p.y], edge_mm)));
            }
        }
        Self {
            target_mm: options.target_edge_mm,
            grading: options.grading,
            sources: RTree::bulk_load(sources),
        }
    }

    /// Wished edge length at a point, mm.
    pub(crate) fn at(&self, p: DVec2) -> f64 {
        match self.sources.nearest_neighbor([p.x, p.y]) {
            Some(s) => {
                let distance = p.distance(DVec2::from(*s.geom()));
                (s.data + self.grading * distance).min(self.target_mm)
            }
            None => self.target_mm,
        }
    }
}
