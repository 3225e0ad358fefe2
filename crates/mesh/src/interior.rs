//! Points inside the regions: blue noise after the sizing field, grown from the points on curves.

use crate::inside::Inside;
use crate::rng::SplitMix64;
use crate::size::SizeField;
use glam::DVec2;
use rstar::RTree;

/// Distance kept between points, share of the local size. Maximal Poisson sampling at 0.75 of the
/// edge length gives that edge length on average.
const SPACING: f64 = 0.75;
/// Neighbours tried around a point before it counts as surrounded (Bridson's 30 fill more evenly, at twice the time; the
/// relaxation that follows evens out the rest).
const TRIES: u32 = 16;

/// Adds points inside the polygons, none nearer to another than the local spacing: Bridson, *Fast Poisson disk
/// sampling in arbitrary dimensions* (2007), with a spacing that varies and the given points as seeds. Stops beyond
/// `most` points.
pub(crate) fn scatter(
    points: &mut Vec<DVec2>,
    polygons: &[Vec<DVec2>],
    sizes: &SizeField,
    seed: u64,
    most: usize,
) {
    let inside = Inside::new(polygons);
    let mut tree = RTree::bulk_load(points.iter().map(|p| [p.x, p.y]).collect());
    let mut rng = SplitMix64(seed);
    let mut active = points.clone();
    while !active.is_empty() && points.len() <= most {
        let chosen = (rng.unit() * active.len() as f64) as usize;
        let around = active[chosen];
        let reach = SPACING * sizes.at(around);
        let fits = |p: &DVec2, tree: &RTree<[f64; 2]>| {
            inside.contains(*p) && is_free(tree, *p, SPACING * sizes.at(*p))
        };
        let found = (0..TRIES).map(|_| near(around, reach, &mut rng)).find(|p| fits(p, &tree));
        match found {
            Some(p) => {
                tree.insert([p.x, p.y]);
                points.push(p);
                active.push(p);
            }
            None => drop(active.swap_remove(chosen)),
        }
    }
}

/// A point between one and two spacings away, evenly spread over the ring.
fn near(center: DVec2, spacing: f64, rng: &mut SplitMix64) -> DVec2 {
    let direction = DVec2::from_angle(rng.unit() * std::f64::consts::TAU);
    center + spacing * (1.0 + 3.0 * rng.unit()).sqrt() * direction
}

fn is_free(tree: &RTree<[f64; 2]>, p: DVec2, spacing: f64) -> bool {
    tree.nearest_neighbor([p.x, p.y]).is_none_or(|n| p.distance(DVec2::from(*n)) >= spacing)
}
