//! The smallest cap of the sphere around a set of directions.

use glam::DVec3;

/// A direction lies in a cap if its cosine is this close: a few roundings of a dot product.
const COVERED: f64 = 1e-14;
/// Steps of the search on the sphere, from an octant down to where cosines no longer change, rad.
const FIRST_STEP: f64 = 0.5;
const LAST_STEP: f64 = 1e-9;
/// Directions around a point on the sphere that the search tries.
const COMPASS: usize = 8;

/// The direction `d` for which the smallest `n·d` over all unit vectors `n` is greatest, and that cosine.
///
/// If all fit into an open hemisphere this is the axis of their smallest enclosing cap, found exactly by exchanging a
/// basis of at most three of them (an LP-type problem, as Welzl's enclosing ball). Otherwise no direction sees them all;
/// the best one near their mean is searched numerically, and the cosine is zero or negative.
pub(crate) fn best_direction(normals: &[DVec3]) -> (DVec3, f64) {
    if let Some(cap) = enclosing_cap(normals) {
        return cap;
    }
    let mean = normals.iter().sum::<DVec3>().try_normalize().unwrap_or(DVec3::Z);
    climb(normals, mean)
}

/// The smallest cosine and which vector has it.
fn worst(normals: &[DVec3], d: DVec3) -> (usize, f64) {
    let cosines = normals.iter().map(|n| n.dot(d)).enumerate();
    cosines.fold((0, f64::INFINITY), |best, c| if c.1 < best.1 { c } else { best })
}

fn enclosing_cap(normals: &[DVec3]) -> Option<(DVec3, f64)> {
    let mut basis = vec![*normals.first()?];
    let mut cap = (basis[0], 1.0);
    // Each exchange widens the cap, so no basis returns; the bound only guards against rounding.
    for _ in 0..=normals.len() {
        let (outside, cosine) = worst(normals, cap.0);
        if cosine >= cap.1 - COVERED {
            return Some((cap.0, cosine));
        }
        basis.push(normals[outside]);
        (basis, cap) = smallest_of(&basis)?;
    }
    Some((cap.0, worst(normals, cap.0).1)).filter(|c| c.1 > 0.0)
}

/// The basis and cap of at most four directions; none if they do not fit into an open hemisphere.
fn smallest_of(directions: &[DVec3]) -> Option<(Vec<DVec3>, (DVec3, f64))> {
    let mut best: Option<(Vec<DVec3>, (DVec3, f64))> = None;
    for subset in 1u32..1 << directions.len() {
        let chosen: Vec<_> =
            (0..directions.len()).filter(|i| subset >> i & 1 == 1).map(|i| directions[i]).collect();
        let Some(axis) = axis_through(&chosen) else { continue };
        let cosine = chosen.iter().map(|n| n.dot(axis)).fold(f64::INFINITY, f64::min);
        let covers = directions.iter().all(|n| n.dot(axis) >= cosine - COVERED);
        if covers && cosine > 0.0 && best.as_ref().is_none_or(|b| cosine > b.1.1) {
            best = Some((chosen, (axis, cosine)));
        }
    }
    best
}

/// The direction at the same angle to one, two or three directions, on their side.
fn axis_through(directions: &[DVec3]) -> Option<DVec3> {
    match *directions {
        [a] => Some(a),
        [a, b] => (a + b).try_normalize(),
        [a, b, c] => {
            let axis = (b - a).cross(c - a).try_normalize()?;
            Some(if axis.dot(a) < 0.0 { -axis } else { axis })
        }
        _ => None,
    }
}

/// Walks uphill on the sphere by ever smaller steps.
fn climb(normals: &[DVec3], start: DVec3) -> (DVec3, f64) {
    let mut best = (start, worst(normals, start).1);
    let mut step = FIRST_STEP;
    while step > LAST_STEP {
        let (e, f) = best.0.any_orthonormal_pair();
        let tries = (0..COMPASS).map(|k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / COMPASS as f64).sin_cos();
            let d = (best.0 + step * (cos * e + sin * f)).normalize();
            (d, worst(normals, d).1)
        });
        let found = tries.fold(best, |b, t| if t.1 > b.1 { t } else { b });
        if found.1 > best.1 {
            best = found;
        } else {
            step *= 0.5;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tilted(polar: f64, azimuth: f64) -> DVec3 {
        let (s, c) = polar.sin_cos();
        DVec3::new(s * azimuth.cos(), s * azimuth.sin(), c)
    }

    #[test]
    fn one_direction_is_its_own_cap() {
        assert_eq!(best_direction(&[DVec3::Y; 5]), (DVec3::Y, 1.0));
    }

    #[test]
    fn a_ring_has_its_axis() {
        let ring: Vec<_> = (0..17).map(|k| tilted(0.7, k as f64 * 0.37)).collect();
        let (d, cosine) = best_direction(&ring);
        assert!(d.distance(DVec3::Z) < 1e-9 && (cosine - 0.7f64.cos()).abs() < 1e-12);
    }

    #[test]
    fn opposite_directions_have_no_cap() {
        let (_, cosine) = best_direction(&[DVec3::X, -DVec3::X, DVec3::Z]);
        assert!(cosine <= 1e-9 && cosine > -1e-6, "{cosine}");
    }

    #[test]
    fn beyond_the_hemisphere_the_search_finds_the_best_tilt() {
        // A fan of 200° about y: seen from its middle, both ends are 10° under.
        let fan: Vec<_> = (-100..=100).map(|a| tilted((a as f64).to_radians(), 0.0)).collect();
        let (d, cosine) = best_direction(&fan);
        // Tilting towards y lifts both ends: square to the fan all of it is level.
        assert!(cosine > -1e-6 && cosine <= 0.0, "{d} {cosine}");
    }

    proptest! {
        #[test]
        fn no_nearby_direction_is_better(
            polar in proptest::collection::vec(0.0..1.2f64, 1..60),
            turn in 0.0..6.0f64,
        ) {
            let normals: Vec<_> =
                polar.iter().enumerate().map(|(k, &p)| tilted(p, turn + 2.4 * k as f64)).collect();
            let (d, cosine) = best_direction(&normals);
            prop_assert!((worst(&normals, d).1 - cosine).abs() < 1e-12);
            for step in [0.3, 1e-2, 1e-4] {
                let (e, f) = d.any_orthonormal_pair();
                for k in 0..24 {
                    let (sin, cos) = (k as f64 * std::f64::consts::TAU / 24.0).sin_cos();
                    let other = (d + step * (cos * e + sin * f)).normalize();
                    prop_assert!(worst(&normals, other).1 <= cosine + 1e-12);
                }
            }
        }
    }
}
