//! Polygons and polylines as point lists. A polygon's first point is not repeated at its end.

use glam::DVec2;

/// Signed area, positive counter-clockwise, mm².
pub fn signed_area_mm2(polygon: &[DVec2]) -> f64 {
    let Some(&origin) = polygon.first() else { return 0.0 };
    // Relative to a corner: no cancellation far from the origin.
    edges(polygon).map(|(a, b)| 0.5 * (a - origin).perp_dot(b - origin)).sum()
}

/// Whether `p` lies inside (even-odd rule; points on the border may go either way).
pub fn contains(polygon: &[DVec2], p: DVec2) -> bool {
    edges(polygon)
        .filter(|&(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
        .count()
        % 2
        == 1
}

/// The sides, the closing one last.
pub fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// Distance from `p` to the segment `a`–`b`.
pub fn segment_distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let d = b - a;
    let t =
        if d.length_squared() > 0.0 { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + t * d)
}

/// Sine of the angle below which two segments are parallel: rounding of coordinates decides where they would cross.
const PARALLEL: f64 = 1e-12;

/// Parameters (t on `a0`–`a1`, s on `b0`–`b1`), both in 0..=1, where two segments cross; none if parallel.
pub fn segment_crossing(a0: DVec2, a1: DVec2, b0: DVec2, b1: DVec2) -> Option<(f64, f64)> {
    let (da, db) = (a1 - a0, b1 - b0);
    let den = da.perp_dot(db);
    if den.abs() <= PARALLEL * da.length() * db.length() {
        return None;
    }
    let t = (b0 - a0).perp_dot(db) / den;
    let s = (b0 - a0).perp_dot(da) / den;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some((t, s))
}

/// Lower and upper corner of the points' box; zeros if there are none.
pub fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    let Some(&first) = points.first() else { return (DVec2::ZERO, DVec2::ZERO) };
    points.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)))
}

/// Length of a polyline, mm.
pub fn length_mm(points: &[DVec2]) -> f64 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec2> {
        [(1e6, 0.), (1e6 + 2., 0.), (1e6 + 2., 2.), (1e6, 2.)].map(DVec2::from).to_vec()
    }

    #[test]
    fn area_is_exact_far_from_the_origin() {
        assert_eq!(signed_area_mm2(&square()), 4.0);
        assert_eq!(signed_area_mm2(&square().into_iter().rev().collect::<Vec<_>>()), -4.0);
    }

    #[test]
    fn inside_and_outside() {
        assert!(contains(&square(), DVec2::new(1e6 + 1.0, 1.0)));
        assert!(!contains(&square(), DVec2::new(1e6 - 1.0, 1.0)));
        assert!(!contains(&square(), DVec2::new(1e6 + 1.0, 3.0)));
    }

    #[test]
    fn lines_in_one_direction_do_not_cross_where_rounding_would_have_them() {
        let at = |x, y| DVec2::new(x, y);
        let [a0, joint] =
            [at(131.14383730850773, 158.08547334117318), at(132.29166666666666, 158.74819237268767)];
        let b0 = at(136.87206645309584, 161.39276500783987); // beyond the joint on the same line, to 1e-14
        assert_eq!(segment_crossing(a0, joint, b0, joint), None);
    }

    #[test]
    fn crossing_gives_both_parameters() {
        let x = segment_crossing(DVec2::ZERO, DVec2::new(4., 0.), DVec2::new(1., -1.), DVec2::new(1., 3.));
        assert_eq!(x, Some((0.25, 0.25)));
        assert_eq!(segment_crossing(DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE), None);
    }

    #[test]
    fn distance_to_a_segment_uses_its_ends() {
        assert_eq!(segment_distance(DVec2::new(5., 0.), DVec2::ZERO, DVec2::new(2., 0.)), 3.0);
        assert_eq!(segment_distance(DVec2::new(1., 2.), DVec2::ZERO, DVec2::new(2., 0.)), 2.0);
    }
}
