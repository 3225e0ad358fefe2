//! Points of the sheet on a curve in space: a rail.

use super::{Attract, Nearest, Target, TargetError, outer};
use glam::{DMat3, DVec3};
use polycool::Poly;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// Points pulled to the nearest place of a curve: `E = ½ k Σ |p − q(p)|²`, strength k in N/mm per point; Kangaroo's
/// *OnCurve*. Along the curve they slide freely.
pub type OnCurve = Attract<SpaceCurve>;

/// A polyline, or cubic Bézier curves one after the other.
#[derive(Clone, Debug)]
pub struct SpaceCurve {
    pieces: RTree<Piece>,
}

/// One piece of a curve. A straight one is kept as it is: its nearest place needs no roots.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Piece {
    Segment([DVec3; 2]),
    Cubic([DVec3; 4]),
}

/// Error of a root of the quintic, share of the piece.
const ROOT_ERROR: f64 = 1e-14;

impl SpaceCurve {
    /// The polyline through `points`, mm; a closed one repeats its first point.
    ///
    /// # Errors
    /// [`TargetError`] for fewer than two points or one that is not finite.
    pub fn polyline(points: &[DVec3]) -> Result<Self, TargetError> {
        let pieces = points.windows(2).map(|w| Piece::Segment([w[0], w[1]])).collect();
        Self::of(pieces, points, TargetError::Empty { least: 2, what: "points of the polyline" })
    }

    /// Cubic Bézier curves by their control points, mm. Each should begin where the one before it ends.
    ///
    /// # Errors
    /// [`TargetError`] for none or a control point that is not finite.
    pub fn beziers(curves: &[[DVec3; 4]]) -> Result<Self, TargetError> {
        let pieces = curves.iter().map(|&c| Piece::Cubic(c)).collect();
        let empty = TargetError::Empty { least: 1, what: "cubic curve" };
        Self::of(pieces, curves.as_flattened(), empty)
    }

    fn of(pieces: Vec<Piece>, points: &[DVec3], empty: TargetError) -> Result<Self, TargetError> {
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(TargetError::NotFinite(i));
        }
        if pieces.is_empty() {
            return Err(empty);
        }
        Ok(Self { pieces: RTree::bulk_load(pieces) })
    }
}

impl Target for SpaceCurve {
    const KIND: &'static str = "OnCurve";

    fn nearest(&self, point: DVec3) -> Nearest {
        let piece = self.pieces.nearest_neighbor(point.to_array());
        match piece {
            Some(piece) if point.is_finite() => piece.nearest(point),
            _ => Nearest { place: DVec3::NAN, hessian: DMat3::ZERO, convex: DMat3::ZERO },
        }
    }
}

impl Piece {
    fn controls(&self) -> &[DVec3] {
        match self {
            Piece::Segment(p) => p,
            Piece::Cubic(p) => p,
        }
    }

    /// Position with first and second derivative by the parameter.
    fn at(&self, t: f64) -> [DVec3; 3] {
        match self {
            Piece::Segment([a, b]) => [a.lerp(*b, t), *b - *a, DVec3::ZERO],
            Piece::Cubic(controls) => {
                let [c0, c1, c2, c3] = monomials(controls);
                [
                    c0 + t * (c1 + t * (c2 + t * c3)),
                    c1 + t * (2.0 * c2 + 3.0 * t * c3),
                    2.0 * c2 + 6.0 * t * c3,
                ]
            }
        }
    }

    /// Parameter of the place nearest to `point`.
    fn parameter(&self, point: DVec3) -> f64 {
        match self {
            Piece::Segment([a, b]) => {
                let d = *b - *a;
                ((point - *a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
            }
            Piece::Cubic(controls) => {
                let slope = distance_slope(controls, point);
                let distance = |t: f64| self.at(t)[0].distance_squared(point);
                let inner = slope.roots_between(0.0, 1.0, ROOT_ERROR);
                let all = [0.0, 1.0].into_iter().chain(inner);
                all.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0.0)
            }
        }
    }

    fn nearest(&self, point: DVec3) -> Nearest {
        let t = self.parameter(point);
        let [place, first, second] = self.at(t);
        let speed = first.length_squared();
        let inside = t > 0.0 && t < 1.0 && speed > 0.0;
        if !inside {
            return Nearest { place, hessian: DMat3::IDENTITY, convex: DMat3::IDENTITY };
        }
        // q = c(t(p)) with (p − c)·c' = 0, hence dt = c'·dp / (|c'|² − (p − c)·c''); the denominator vanishes at the
        // centre of curvature.
        let towards = (point - place).dot(second);
        let along = outer(first, first);
        let hessian = DMat3::IDENTITY - along / (speed - towards).max(f64::MIN_POSITIVE);
        let convex = DMat3::IDENTITY - along / (speed - towards.min(0.0));
        Nearest { place, hessian, convex }
    }
}

/// Coefficients of 1, t, t², t³.
fn monomials([p0, p1, p2, p3]: &[DVec3; 4]) -> [DVec3; 4] {
    [*p0, 3.0 * (*p1 - *p0), 3.0 * (*p0 - 2.0 * *p1 + *p2), *p3 - *p0 + 3.0 * (*p1 - *p2)]
}

/// `(c(t) − p)·c'(t)`: half the derivative of the squared distance, a quintic.
fn distance_slope(controls: &[DVec3; 4], point: DVec3) -> Poly<6> {
    let mut c = monomials(controls);
    c[0] -= point;
    let mut coefficients = [0.0; 6];
    for i in 0..4 {
        for j in 1..4 {
            coefficients[i + j - 1] += j as f64 * c[i].dot(c[j]);
        }
    }
    Poly::new(coefficients)
}

impl RTreeObject for Piece {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        // A Bézier curve lies in the hull of its control points.
        AABB::from_points(self.controls().iter().map(|p| p.to_array()).collect::<Vec<_>>().iter())
    }
}

impl PointDistance for Piece {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from(*point);
        self.at(self.parameter(point))[0].distance_squared(point)
    }
}

impl PartialEq for SpaceCurve {
    fn eq(&self, other: &Self) -> bool {
        self.pieces.iter().eq(other.pieces.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave() -> [[DVec3; 4]; 2] {
        let p = |x, y, z| DVec3::new(x, y, z);
        [
            [p(-3., 0., 0.), p(-2., 4., 1.), p(0., -3., 2.), p(1., 1., 1.)],
            [p(1., 1., 1.), p(2., 5., 0.), p(4., 0., -2.), p(6., 1., 0.)],
        ]
    }

    /// Many samples of a curve stand for it.
    fn sampled(curves: &[[DVec3; 4]], point: DVec3) -> f64 {
        let places = |c: &[DVec3; 4]| {
            let piece = Piece::Cubic(*c);
            (0..=20_000)
                .map(move |i| piece.at(f64::from(i) / 2e4)[0].distance(point))
                .fold(f64::MAX, f64::min)
        };
        curves.iter().map(places).fold(f64::MAX, f64::min)
    }

    #[test]
    fn the_nearest_place_of_a_cubic_is_no_farther_than_any_sample() {
        let curve = SpaceCurve::beziers(&wave()).unwrap();
        for i in 0..200 {
            let k = f64::from(i);
            let point = 6.0 * DVec3::new((1.7 * k).sin(), (2.3 * k).sin(), (3.1 * k).sin());
            let found = curve.nearest(point).place.distance(point);
            let sampled = sampled(&wave(), point);
            assert!(found <= sampled + 1e-12 && found > sampled - 1e-4, "{i}: {found} {sampled}");
        }
    }

    #[test]
    fn the_nearest_place_of_a_straight_cubic_is_that_of_its_segment() {
        let (a, b) = (DVec3::new(1., 2., 3.), DVec3::new(-4., 0., 7.));
        let straight = SpaceCurve::beziers(&[[a, a.lerp(b, 1.0 / 3.0), a.lerp(b, 2.0 / 3.0), b]]).unwrap();
        let line = SpaceCurve::polyline(&[a, b]).unwrap();
        for point in [DVec3::ZERO, DVec3::new(9., 9., -9.), DVec3::new(-5., 0., 8.)] {
            let (s, l) = (straight.nearest(point), line.nearest(point));
            assert!(s.place.distance(l.place) < 1e-12, "{point}");
        }
    }

    #[test]
    fn a_curve_that_has_no_place_is_refused() {
        let empty = SpaceCurve::polyline(&[DVec3::ZERO]).unwrap_err();
        assert!(matches!(empty, TargetError::Empty { least: 2, .. }));
        let nan = SpaceCurve::polyline(&[DVec3::ZERO, DVec3::NAN]).unwrap_err();
        assert_eq!(nan, TargetError::NotFinite(1));
        assert!(SpaceCurve::beziers(&[]).is_err());
    }

    #[test]
    fn a_point_of_no_place_gives_no_number_and_no_panic() {
        let curve = SpaceCurve::beziers(&wave()).unwrap();
        assert!(!curve.nearest(DVec3::new(0.0, f64::NAN, 0.0)).place.is_finite());
    }
}
