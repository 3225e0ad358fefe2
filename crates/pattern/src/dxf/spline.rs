//! B-splines to cubics: by blossoming, which is exact for degrees 1 to 3 without weights, else by Hermite cubics
//! within a tolerance.
//!
//! Source: L. Ramshaw, "Blossoms are polar forms", 1989: the Bézier points of the span from a to b are the blossom's
//! values at (a, …, a, b, …, b). It is what inserting every knot to full multiplicity computes, point by point.

use super::curve::{self, Chain, Piece};
use super::entities::{Drawn, Remark};
use super::fields::Fields;
use super::through;
use crate::PatternError;
use glam::{DVec3, DVec4};

/// Largest distance of a cubic from the curve that it approximates, as a share of the size of its control polygon.
pub(super) const APPROXIMATION: f64 = 1e-7;
/// Largest degree that is read: what CAD kernels write at most, twice over would be 22; time grows with its square.
const MAX_DEGREE: usize = 15;
/// A span is halved so often at most: 1024 cubics.
const MAX_HALVINGS: u32 = 10;
/// Cubics of one approximated spline at most.
const MAX_PIECES: usize = 100_000;
/// Flag: the curve closes on itself.
const CLOSED: i64 = 1;

/// The curve of a SPLINE.
///
/// # Errors
/// Numbers that do not make a spline.
pub(super) fn drawn(fields: &Fields<'_>) -> Result<Drawn, PatternError> {
    let controls = fields.points(10)?;
    if controls.is_empty() {
        return through_points(fields);
    }
    let (spline, remark) = Spline::read(fields, &controls)?;
    let mut chains = Vec::new();
    let (pieces, close) = spline.pieces(fields)?;
    for piece in pieces {
        curve::push(&mut chains, piece);
    }
    let approximated = match (spline.is_exact(), close) {
        (true, _) => None,
        (false, true) => Some(Remark::Approximated),
        (false, false) => Some(Remark::Coarse),
    };
    Ok(Drawn { chains, remark: approximated.or(remark) })
}

fn through_points(fields: &Fields<'_>) -> Result<Drawn, PatternError> {
    let points = fields.points(11)?;
    let closed = fields.integer_or(70, 0)? & CLOSED != 0;
    let chain: Chain = through::curve(&points, [fields.point_if(12)?, fields.point_if(13)?], closed);
    Ok(Drawn { chains: vec![chain], remark: Some(Remark::ThroughPoints) })
}

/// A B-spline in homogeneous coordinates: (w x, w y, w z, w).
struct Spline {
    degree: usize,
    knots: Vec<f64>,
    controls: Vec<DVec4>,
    rational: bool,
    size: f64,
}

impl Spline {
    fn read(fields: &Fields<'_>, points: &[DVec3]) -> Result<(Self, Option<Remark>), PatternError> {
        let fault = |what: String| Err(fields.fault(what, None));
        let degree = match usize::try_from(fields.integer_or(71, 3)?) {
            Ok(degree @ 1..=MAX_DEGREE) => degree,
            _ => return fault(format!("the degree of the spline is not one of 1 to {MAX_DEGREE}")),
        };
        if points.len() <= degree {
            return fault(format!("a spline of degree {degree} has {} control points", points.len()));
        }
        let (knots, remark) = match fields.reals(40)? {
            none if none.is_empty() => (uniform(points.len(), degree), Some(Remark::NoKnots)),
            knots => (knots, None),
        };
        if knots.len() != points.len() + degree + 1 {
            let (n, k) = (points.len(), knots.len());
            return fault(format!("{k} knots do not fit {n} control points of degree {degree}"));
        }
        if !knots.is_sorted() || knots[degree] >= knots[points.len()] {
            return fault("the knots of the spline do not rise".to_owned());
        }
        let weights = match fields.reals(41)? {
            none if none.is_empty() => vec![1.0; points.len()],
            weights => weights,
        };
        if weights.len() != points.len() || weights.iter().any(|w| *w <= 0.0) {
            return fault("the spline does not have one positive weight for each control point".to_owned());
        }
        let controls = points.iter().zip(&weights).map(|(p, w)| (*p * *w).extend(*w)).collect();
        let rational = weights.iter().any(|w| *w != weights[0]);
        Ok((Self { degree, knots, controls, rational, size: size(points) }, remark))
    }

    fn is_exact(&self) -> bool {
        self.degree <= 3 && !self.rational
    }

    /// Every span that is not empty as cubics; and whether all are as close as they should be.
    fn pieces(&self, fields: &Fields<'_>) -> Result<(Vec<Piece>, bool), PatternError> {
        let mut pieces = Vec::new();
        let mut close = true;
        for span in self.degree..self.controls.len() {
            let [a, b] = [self.knots[span], self.knots[span + 1]];
            if a < b {
                let bezier = self.bezier(span, a, b);
                close &= self.append(&bezier, &mut pieces);
            }
            if pieces.len() > MAX_PIECES {
                let what = format!("the spline needs more than {MAX_PIECES} cubics");
                return Err(fields.fault(what, None));
            }
        }
        Ok((pieces, close))
    }

    fn bezier(&self, span: usize, a: f64, b: f64) -> Vec<DVec4> {
        let degree = self.degree;
        (0..=degree)
            .map(|k| {
                let argument = |r: usize| if r <= degree - k { a } else { b };
                self.blossom(span, argument)
            })
            .collect()
    }

    /// The polar form of a span, whose r-th argument (from 1) is given: de Boor's scheme.
    fn blossom(&self, span: usize, argument: impl Fn(usize) -> f64) -> DVec4 {
        let p = self.degree;
        let mut points = self.controls[span - p..=span].to_vec();
        for r in 1..=p {
            for j in (r..=p).rev() {
                let i = span - p + j;
                let [low, high] = [self.knots[i], self.knots[i + p + 1 - r]];
                let share = (argument(r) - low) / (high - low);
                points[j] = points[j - 1].lerp(points[j], share);
            }
        }
        points[p]
    }

    /// Adds a span; whether it is close enough.
    fn append(&self, bezier: &[DVec4], pieces: &mut Vec<Piece>) -> bool {
        let at = |i: usize| project(bezier[i]);
        match (self.degree, self.rational) {
            (1, false) => pieces.push(Piece::Line([at(0), at(1)])),
            (2, false) => {
                let third = |end: usize| at(end).lerp(at(1), 2.0 / 3.0);
                pieces.push(Piece::Cubic([at(0), third(0), third(2), at(2)]));
            }
            (3, false) => pieces.push(Piece::Cubic([at(0), at(1), at(2), at(3)])),
            _ => return self.approximate(bezier, [0.0, 1.0], MAX_HALVINGS, pieces),
        }
        true
    }

    /// The cubic with the curve's ends and derivatives there, halved where it is too far off; whether all are
    /// close enough.
    fn approximate(
        &self,
        bezier: &[DVec4],
        [from, to]: [f64; 2],
        halvings: u32,
        pieces: &mut Vec<Piece>,
    ) -> bool {
        const CHECKED: [f64; 3] = [0.25, 0.5, 0.75];
        let third = (to - from) / 3.0;
        let [(a, da), (b, db)] = [from, to].map(|t| eval(bezier, t));
        let cubic = [a, a + da * third, b - db * third, b];
        let off = |s: &f64| eval(bezier, from + (to - from) * s).0.distance(cubic_at(&cubic, *s));
        let fits = CHECKED.iter().all(|s| off(s) <= APPROXIMATION * self.size);
        if fits || halvings == 0 || pieces.len() > MAX_PIECES {
            pieces.push(Piece::Cubic(cubic));
            return fits;
        }
        let middle = 0.5 * (from + to);
        let first = self.approximate(bezier, [from, middle], halvings - 1, pieces);
        self.approximate(bezier, [middle, to], halvings - 1, pieces) && first
    }
}

/// Knots that lead the curve through its first and last control point, evenly spaced.
fn uniform(points: usize, degree: usize) -> Vec<f64> {
    let last = points - degree;
    (0..=points + degree).map(|i| i.saturating_sub(degree).min(last) as f64).collect()
}

fn size(points: &[DVec3]) -> f64 {
    let fold = |f: fn(DVec3, DVec3) -> DVec3| points.iter().copied().reduce(f).unwrap_or_default();
    (fold(DVec3::max) - fold(DVec3::min)).length()
}

fn project(p: DVec4) -> DVec3 {
    p.truncate() / p.w
}

/// Point and derivative of a rational Bézier curve, by de Casteljau's scheme.
fn eval(bezier: &[DVec4], t: f64) -> (DVec3, DVec3) {
    let degree = bezier.len() - 1;
    let mut points = [DVec4::ZERO; MAX_DEGREE + 1];
    points[..=degree].copy_from_slice(bezier);
    for left in (2..=degree).rev() {
        for i in 0..left {
            points[i] = points[i].lerp(points[i + 1], t);
        }
    }
    let slope = (points[1] - points[0]) * degree as f64;
    let at = points[0].lerp(points[1], t);
    let point = project(at);
    (point, (slope.truncate() - point * slope.w) / at.w)
}

fn cubic_at([a, b, c, d]: &[DVec3; 4], t: f64) -> DVec3 {
    let s = 1.0 - t;
    s * s * s * *a + 3.0 * s * s * t * *b + 3.0 * s * t * t * *c + t * t * t * *d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dxf::tags::{Tag, Value};
    use crate::error::Origin;
    use proptest::prelude::*;

    /// Reads a spline from its numbers.
    fn read(degree: i64, knots: &[f64], points: &[[f64; 2]], weights: &[f64]) -> Result<Drawn, PatternError> {
        let real = |code: i32, v: f64| Tag { code, value: Value::Real(v), line: None };
        let mut tags = vec![Tag { code: 71, value: Value::Integer(degree), line: None }];
        tags.extend(knots.iter().map(|k| real(40, *k)));
        tags.extend(weights.iter().map(|w| real(41, *w)));
        tags.extend(points.iter().flat_map(|[x, y]| [real(10, *x), real(20, *y)]));
        drawn(&Fields { tags: &tags, origin: &Origin::default() })
    }

    /// Points of a chain of cubics, evenly in each piece's parameter.
    fn samples(drawn: &Drawn) -> Vec<DVec3> {
        let of = |piece: &Piece| match *piece {
            Piece::Line([a, b]) => vec![a, a.lerp(b, 0.5), b],
            Piece::Cubic(cubic) => (0..=8).map(|k| cubic_at(&cubic, f64::from(k) / 8.0)).collect(),
        };
        drawn.chains.iter().flatten().flat_map(of).collect()
    }

    #[test]
    fn a_clamped_span_is_its_own_bezier_curve() {
        let points = [[0.0, 0.0], [1.0, 2.0], [3.0, 2.0], [4.0, 0.0]];
        let got = read(3, &[0., 0., 0., 0., 1., 1., 1., 1.], &points, &[]).unwrap();
        let cubic = points.map(|[x, y]| DVec3::new(x, y, 0.0));
        assert_eq!(got, Drawn { chains: vec![vec![Piece::Cubic(cubic)]], remark: None });
    }

    #[test]
    fn a_uniform_spline_without_clamped_ends_has_the_known_bezier_points() {
        // The span of a uniform cubic B-spline: (p0 + 4 p1 + p2)/6, (2 p1 + p2)/3, …
        let points = [[6.0, 0.0], [0.0, 6.0], [12.0, 6.0], [18.0, -6.0]];
        let got = read(3, &[0., 1., 2., 3., 4., 5., 6., 7.], &points, &[]).unwrap();
        let [Piece::Cubic(c)] = got.chains[0][..] else { panic!("{got:?}") };
        for (got, (x, y)) in c.iter().zip([(3.0, 5.0), (4.0, 6.0), (8.0, 6.0), (11.0, 4.0)]) {
            assert!((*got - DVec3::new(x, y, 0.0)).length() < 1e-14, "{got}");
        }
    }

    #[test]
    fn a_rational_circle_is_round() {
        let h = 0.5_f64.sqrt();
        let r = 500.0;
        let points =
            [[1., 0.], [1., 1.], [0., 1.], [-1., 1.], [-1., 0.], [-1., -1.], [0., -1.], [1., -1.], [1., 0.]]
                .map(|p| p.map(|x| x * r));
        let knots = [0., 0., 0., 1., 1., 2., 2., 3., 3., 4., 4., 4.];
        let got = read(2, &knots, &points, &[1., h, 1., h, 1., h, 1., h, 1.]).unwrap();
        assert_eq!((got.chains.len(), got.remark), (1, Some(Remark::Approximated)));
        let worst = samples(&got).iter().map(|p| (p.length() - r).abs()).fold(0.0, f64::max);
        assert!(worst < 3.0 * r * APPROXIMATION, "{worst}");
        assert!(got.chains[0].len() < 200);
    }

    #[test]
    fn weights_that_leave_no_smooth_curve_are_told() {
        let points = [[0., 0.], [1., 5.], [2., -5.], [3., 0.]];
        let clamped = [0., 0., 0., 0., 1., 1., 1., 1.];
        assert_eq!(
            read(3, &clamped, &points, &[1e12, 1.0, 1.0, 1e-12]).unwrap().remark,
            Some(Remark::Coarse)
        );
    }

    #[test]
    fn a_knot_of_full_multiplicity_breaks_the_curve() {
        let points = [[0., 0.], [1., 0.], [1., 1.], [2., 1.]];
        let got = read(1, &[0., 0., 1., 1., 2., 2.], &points, &[]).unwrap();
        assert_eq!(got.chains.len(), 2);
    }

    #[test]
    fn what_is_no_spline_is_refused() {
        let points = [[0., 0.], [1., 0.], [1., 1.], [2., 1.]];
        let clamped = [0., 0., 0., 0., 1., 1., 1., 1.];
        for (degree, knots, weights, part) in [
            (0, &clamped[..], &[][..], "degree"),
            (99, &clamped, &[], "degree"),
            (5, &clamped, &[], "4 control points"),
            (3, &clamped[1..], &[], "7 knots"),
            (3, &[0., 0., 0., 1., 0., 1., 1., 1.], &[], "rise"),
            (3, &[0.; 8], &[], "rise"),
            (3, &clamped, &[1.0; 3], "weight"),
            (3, &clamped, &[1.0, 1.0, 0.0, 1.0], "weight"),
        ] {
            let error = read(degree, knots, &points, weights).unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
        }
        assert_eq!(read(3, &[], &points, &[]).unwrap().remark, Some(Remark::NoKnots));
    }

    /// De Boor's basis functions by their recursion: another way to the same curve.
    fn basis(i: usize, p: usize, knots: &[f64], t: f64) -> f64 {
        if p == 0 {
            return f64::from(u8::from(knots[i] <= t && t < knots[i + 1]));
        }
        let part = |top: f64, bottom: f64| if bottom > 0.0 { top / bottom } else { 0.0 };
        part(t - knots[i], knots[i + p] - knots[i]) * basis(i, p - 1, knots, t)
            + part(knots[i + p + 1] - t, knots[i + p + 1] - knots[i + 1]) * basis(i + 1, p - 1, knots, t)
    }

    proptest! {
        #[test]
        fn spans_are_sums_of_basis_functions(
            degree in 1_usize..7,
            steps in prop::collection::vec(0.1..2.0, 20),
            coordinates in prop::collection::vec((-50.0..50.0, -50.0..50.0, 0.5..2.0), 8..12),
        ) {
            let n = coordinates.len();
            let mut knots = vec![0.0];
            steps.iter().take(n + degree).for_each(|s: &f64| knots.push(knots[knots.len() - 1] + s));
            let controls: Vec<DVec4> =
                coordinates.iter().map(|&(x, y, w)| DVec4::new(x * w, y * w, 0.0, w)).collect();
            let spline = Spline { degree, knots, controls, rational: true, size: 100.0 };
            for span in degree..n {
                let [a, b] = [spline.knots[span], spline.knots[span + 1]];
                let bezier = spline.bezier(span, a, b);
                for k in 0..8 {
                    let share = (f64::from(k) + 0.5) / 8.0;
                    let t = a + (b - a) * share;
                    let sum: DVec4 =
                        (0..n).map(|i| basis(i, degree, &spline.knots, t) * spline.controls[i]).sum();
                    prop_assert!(eval(&bezier, share).0.distance(project(sum)) < 1e-9);
                }
            }
        }

        #[test]
        fn approximations_stay_within_their_tolerance(
            points in prop::collection::vec((-50.0..50.0, -50.0..50.0, 0.5..2.0), 6),
        ) {
            let bezier: Vec<DVec4> =
                points.iter().map(|&(x, y, w)| DVec4::new(x * w, y * w, 0.0, w)).collect();
            let spline =
                Spline { degree: 5, knots: Vec::new(), controls: Vec::new(), rational: true, size: 100.0 };
            let mut pieces = Vec::new();
            prop_assert!(spline.approximate(&bezier, [0.0, 1.0], MAX_HALVINGS, &mut pieces));
            // Cubics of halved intervals: each is as far off as it is at its finest, wherever it is looked at.
            let (mut from, mut worst) = (0.0, 0.0_f64);
            for piece in &pieces {
                let Piece::Cubic(cubic) = *piece else { panic!("cubic") };
                let step = (0..=MAX_HALVINGS)
                    .map(|h| 0.5_f64.powi(h as i32))
                    .find(|step| from + step <= 1.0 && eval(&bezier, from + step).0.distance(cubic[3]) < 1e-9);
                let step = step.unwrap();
                for k in 0..=16 {
                    let s = f64::from(k) / 16.0;
                    worst = worst.max(eval(&bezier, from + s * step).0.distance(cubic_at(&cubic, s)));
                }
                from += step;
            }
            prop_assert!((from - 1.0).abs() < 1e-12);
            prop_assert!(worst < 1.5 * APPROXIMATION * 100.0, "{worst}");
        }
    }
}
