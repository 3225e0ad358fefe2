//! Points inside the regions: a lattice where edges are as long as the target throughout, and blue noise after the sizing
//! field between it and the points on curves.

use crate::background::Background;
use crate::lattice;
use crate::order;
use crate::rng::SplitMix64;
use crate::size::SizeField;
use glam::DVec2;
use std::f64::consts::TAU;

/// Distance kept between points, share of the local size. Points that grow like this have an edge length on average
/// that is larger by about its inverse.
const SPACING: f64 = 0.86;
/// Directions tried around each point.
const TRIES: u32 = 12;
/// What rounding may take from the distance of a point to the one that it grew from.
const ROUNDING: f64 = 1.0 - 1e-9;

/// Adds points inside the polygons, none nearer to another than the local spacing: R. Bridson, *Fast Poisson disk
/// sampling in arbitrary dimensions* (2007), with a spacing that varies and the given points as seeds. As M. Roberts
/// proposes (*An improved version of Bridson's algorithm*, 2019), candidates lie just beyond the spacing, in even
/// directions from a random one on: points lie closer and more evenly than those spread over a ring, and no point is
/// tried twice. Stops beyond `most` points. New points come along a Hilbert curve; the answer says of every point
/// whether it may be out of place: those inside the lattice are not.
pub(crate) fn scatter(
    points: &mut Vec<DVec2>,
    polygons: &[Vec<DVec2>],
    sizes: &SizeField,
    seed: u64,
    most: usize,
) -> Vec<bool> {
    if polygons.iter().all(Vec::is_empty) {
        return vec![true; points.len()];
    }
    let given = points.len();
    let mut grid = Background::new(polygons, sizes);
    points.iter().for_each(|p| grid.insert(*p));
    let mut rng = SplitMix64(seed);
    let mut whole = vec![false; given];
    whole.extend(lattice::fill(points, &mut grid, &mut rng));
    let turn = DVec2::from_angle(TAU / f64::from(TRIES));
    let (mut near, mut next) = (Vec::new(), 0);
    while next < points.len() && points.len() <= most {
        let around = points[next];
        next += 1;
        if whole.get(next - 1) == Some(&true) {
            continue;
        }
        let spacing = SPACING * grid.size_mm(around);
        // Where edges get longer on the way, the spacing there counts.
        let farthest = (spacing * (1.0 + SPACING * sizes.fastest())).min(SPACING * sizes.target_mm());
        grid.near(points, around, 2.0 * farthest, &mut near);
        let mut direction = DVec2::from_angle(TAU * rng.unit());
        for _ in 0..TRIES {
            direction = turn.rotate(direction);
            let distance = match farthest > spacing {
                true => (SPACING * grid.size_mm(around + spacing * direction)).clamp(spacing, farthest),
                false => spacing,
            };
            let p = around + distance * direction;
            let least = (distance * ROUNDING).powi(2);
            if near.iter().all(|q| q.distance_squared(p) >= least) && grid.is_sheet(p) {
                grid.insert(p);
                points.push(p);
                near.push(p);
            }
        }
    }
    let grown = points.split_off(given);
    let mut restless = vec![true; given];
    for i in order::along_hilbert(&grown).into_iter().map(|i| i as usize) {
        points.push(grown[i]);
        restless.push(whole.get(given + i) != Some(&true));
    }
    restless
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshOptions;
    use crate::size::source;

    #[test]
    fn points_keep_their_distance_and_leave_no_gap() {
        let side = 200.0;
        let square = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(DVec2::from).to_vec();
        let options = MeshOptions { target_edge_mm: 10.0, ..MeshOptions::default() };
        let sizes = SizeField::from_sources(vec![source(DVec2::new(50.0, 120.0), 1.0)], &options);
        let mut points = square.clone();
        scatter(&mut points, &[square], &sizes, 7, 100_000);
        assert!((500..650).contains(&points.len()), "{}", points.len());
        for (i, p) in points.iter().enumerate().skip(4) {
            let nearest = points.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, q)| p.distance(*q));
            let share = nearest.fold(f64::MAX, f64::min) / sizes.at(*p);
            assert!((0.5..1.3).contains(&share), "{p}: {share}");
        }
        let probe = |k: u32| DVec2::new(f64::from(k % 40) + 0.5, f64::from(k / 40) + 0.5) * side / 40.0;
        for q in (0..1600).map(probe) {
            let nearest = points.iter().map(|p| p.distance(q)).fold(f64::MAX, f64::min);
            assert!(nearest < 1.3 * sizes.at(q), "a gap at {q}: {nearest}");
        }
    }
}
