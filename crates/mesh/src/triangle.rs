//! Shapes of triangles by cheap measures that order them like their smallest angles.

use glam::DVec2;

/// Side of a triangle that is shortest, by its first corner.
pub(crate) fn shortest(p: [DVec2; 3]) -> usize {
    let length = |k: usize| p[k].distance_squared(p[(k + 1) % 3]);
    (0..3).min_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0)
}

/// Tangent of the smallest angle: at most √3; not positive if the triangle is turned over.
pub(crate) fn least_tangent([a, b, c]: [DVec2; 3]) -> f64 {
    let (u, v) = (b - a, c - a);
    let lengths = [u.length_squared(), v.length_squared(), (v - u).length_squared()];
    let least = lengths[0].min(lengths[1]).min(lengths[2]);
    // Both times the product of the two sides at the smallest angle: twice the area, and the cosine rule.
    u.perp_dot(v) / (0.5 * (lengths[0] + lengths[1] + lengths[2]) - least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::SplitMix64;

    #[test]
    fn the_smallest_angle_is_that_of_the_three() {
        let mut random = SplitMix64(5);
        for _ in 0..2000 {
            let mut point = || DVec2::new(random.unit(), random.unit());
            let p = [point(), point(), point()];
            let corner = |k: usize| (p[(k + 1) % 3] - p[k]).angle_to(p[(k + 2) % 3] - p[k]);
            let wanted = (0..3).map(corner).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap();
            assert!((least_tangent(p).atan() - wanted).abs() < 1e-9, "{p:?}");
        }
    }
}
