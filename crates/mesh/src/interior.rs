//! Points inside the regions: blue noise by dart throwing, after the sizing field.

use crate::inside::Inside;
use crate::rng::SplitMix64;
use crate::size::SizeField;
use glam::DVec2;
use rstar::RTree;
use softfold_geometry::polygon;

/// Distance kept between points, share of the local size. Maximal Poisson sampling at 0.75 of the
/// edge length gives that edge length on average.
const SPACING: f64 = 0.75;
/// Failed darts in a row, as a multiple of the points there are, after which the sheet counts as full.
const PATIENCE: usize = 12;
/// Darts that may fail before a small sheet counts as full.
const LEAST_PATIENCE: usize = 4000;

/// Adds points inside the polygons, none nearer to another than the local spacing.
pub(crate) fn scatter(points: &mut Vec<DVec2>, polygons: &[Vec<DVec2>], sizes: &SizeField, seed: u64) {
    let inside = Inside::new(polygons);
    let (lo, hi) = polygon::bounds(points);
    let mut tree = RTree::bulk_load(points.iter().map(|p| [p.x, p.y]).collect());
    let mut rng = SplitMix64(seed);
    let mut failed = 0;
    while failed < LEAST_PATIENCE.max(PATIENCE * points.len()) {
        let p = lo + (hi - lo) * DVec2::new(rng.unit(), rng.unit());
        if inside.contains(p) && is_free(&tree, p, SPACING * sizes.at(p)) {
            tree.insert([p.x, p.y]);
            points.push(p);
            failed = 0;
        } else {
            failed += 1;
        }
    }
}

fn is_free(tree: &RTree<[f64; 2]>, p: DVec2, spacing: f64) -> bool {
    tree.nearest_neighbor([p.x, p.y]).is_none_or(|n| p.distance(DVec2::from(*n)) >= spacing)
}
