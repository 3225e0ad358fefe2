//! Vertices without the noise of their rounding: a polyline written with two decimals lies on its curve only to
//! half a hundredth, and a spline through all of its vertices would have the curvature of that noise.
//!
//! Whittaker's smoother ("On a new method of graduation", Proc. Edinburgh Math. Soc. 41, 1923), with divided
//! differences: the points x nearest to the vertices y whose third differences are small, Σ|x − y|² + λ∫|x‴|².
//! Third ones: arcs and inflections then stay where they are.

use softfold_geometry::DVec2;

/// Points in a third difference.
const STENCIL: usize = 4;
/// How much firmer the ends are held than the vertices between them.
const HELD: f64 = 1e9;
/// λ as a multiple of the sixth power of the mean step: from one that changes nothing, by steps of this factor.
const LEAST_WEIGHT: f64 = 1e-3;
const WEIGHT_STEP: f64 = 4.0;
/// Steps up to a weight that only lets pass what is longer than some hundred vertices.
const STEPS: usize = 24;

/// The points moved by at most `limit_mm` each, so that they run as smoothly as that allows; the ends stay. A ring
/// goes on from its last point to its first, and has no ends.
pub(crate) fn faired(points: &[DVec2], ring: bool, limit_mm: f64) -> Vec<DVec2> {
    let n = points.len();
    // A ring is unrolled: what lies a whole turn away has no influence.
    let row = if ring { points.repeat(3) } else { points.to_vec() };
    let middle = if ring { n..2 * n } else { 0..n };
    let mut best = points.to_vec();
    let Some(smoother) = Smoother::new(&row, !ring) else { return best };
    let mut weight = LEAST_WEIGHT;
    for _ in 0..STEPS {
        let moved = &smoother.smooth(&row, weight)[middle.clone()];
        if !moved.iter().zip(points).all(|(a, b)| a.distance(*b) <= limit_mm) {
            break;
        }
        best = moved.to_vec();
        weight *= WEIGHT_STEP;
    }
    if let (false, [first, .., last]) = (ring, &mut best[..]) {
        (*first, *last) = (points[0], points[n - 1]);
    }
    best
}

/// The smoother's equations, a band of [`STENCIL`] diagonals.
struct Smoother {
    /// Weights of the vertices.
    fidelity: Vec<f64>,
    /// Third differences over steps of mean length 1: the coefficients, times the root of their step.
    differences: Vec<[f64; STENCIL]>,
}

impl Smoother {
    /// None if there are too few points, or some coincide.
    fn new(points: &[DVec2], ends_held: bool) -> Option<Self> {
        let n = points.len();
        if n <= STENCIL {
            return None;
        }
        let mut knots = vec![0.0];
        knots.extend(points.windows(2).scan(0.0, |at, w| {
            *at += w[0].distance(w[1]);
            Some(*at)
        }));
        let mean = knots[n - 1] / (n - 1) as f64;
        knots.iter_mut().for_each(|k| *k /= mean);
        if !knots.windows(2).all(|w| w[1] > w[0]) {
            return None;
        }
        let mut fidelity = vec![1.0; n];
        if ends_held {
            (fidelity[0], fidelity[n - 1]) = (HELD, HELD);
        }
        Some(Self { fidelity, differences: knots.windows(STENCIL).map(third_difference).collect() })
    }

    fn smooth(&self, points: &[DVec2], weight: f64) -> Vec<DVec2> {
        let mut band: Vec<[f64; STENCIL]> = self.fidelity.iter().map(|&w| [w, 0.0, 0.0, 0.0]).collect();
        for (i, d) in self.differences.iter().enumerate() {
            for a in 0..STENCIL {
                for b in 0..=a {
                    band[i + a][a - b] += weight * d[a] * d[b];
                }
            }
        }
        let right = points.iter().zip(&self.fidelity).map(|(p, &w)| *p * w).collect();
        solve(band, right)
    }
}

/// Coefficients of the third derivative of the cubic through four knots, times the root of their mean step.
fn third_difference(knots: &[f64]) -> [f64; STENCIL] {
    const FACTORIAL: f64 = 6.0;
    let root = ((knots[3] - knots[0]) / 3.0).sqrt();
    std::array::from_fn(|i| {
        let steps = (0..STENCIL).filter(|&k| k != i).map(|k| knots[i] - knots[k]);
        FACTORIAL * root / steps.product::<f64>()
    })
}

/// Solves a symmetric system by LDLᵀ; `band[i][k]` is the entry of row i, k columns left of the diagonal.
fn solve(mut band: Vec<[f64; STENCIL]>, mut x: Vec<DVec2>) -> Vec<DVec2> {
    for i in 0..x.len() {
        let reach = i.min(STENCIL - 1);
        for k in (1..=reach).rev() {
            let j = i - k;
            let common = (k + 1..=reach).filter(|m| m - k < STENCIL);
            let sum: f64 = common.map(|m| band[i][m] * band[j][m - k] * band[i - m][0]).sum();
            band[i][k] = (band[i][k] - sum) / band[j][0];
        }
        let sum: f64 = (1..=reach).map(|k| band[i][k].powi(2) * band[i - k][0]).sum();
        band[i][0] -= sum;
        let before: DVec2 = (1..=reach).map(|k| x[i - k] * band[i][k]).sum();
        x[i] -= before;
    }
    for i in (0..x.len()).rev() {
        x[i] /= band[i][0];
        let after: DVec2 = (1..STENCIL).filter(|k| i + k < x.len()).map(|k| x[i + k] * band[i + k][k]).sum();
        x[i] -= after;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(p: DVec2) -> DVec2 {
        (p * 100.0).round() / 100.0
    }

    fn sine(n: u32) -> Vec<DVec2> {
        (0..=n)
            .map(|k| f64::from(k) / f64::from(n))
            .map(|t| DVec2::new(100.0 * t, 20.0 * (6.0 * t).sin()))
            .collect()
    }

    #[test]
    fn the_band_is_solved() {
        let points = sine(9);
        let smoother = Smoother::new(&points, false).unwrap();
        let x = smoother.smooth(&points, 0.7);
        // The residual of the normal equations, written out.
        for i in 0..points.len() {
            let mut sum = x[i];
            for (j, d) in smoother.differences.iter().enumerate() {
                let Some(a) = i.checked_sub(j).filter(|a| *a < STENCIL) else { continue };
                sum += 0.7 * d[a] * (0..STENCIL).map(|b| x[j + b] * d[b]).sum::<DVec2>();
            }
            assert!(sum.distance(points[i]) < 1e-9, "{i}: {sum} {}", points[i]);
        }
    }

    #[test]
    fn a_third_difference_of_a_cubic_is_its_third_derivative() {
        let knots = [0.0, 1.0, 1.5, 3.0];
        let d = third_difference(&knots);
        let sum: f64 = knots.iter().zip(d).map(|(t, c)| c * (2.0 * t.powi(3) - t * t + 5.0)).sum();
        assert!((sum - 12.0).abs() < 1e-9, "{sum}");
    }

    #[test]
    fn rounding_goes_and_the_curve_stays() {
        let (exact, drawn): (Vec<_>, Vec<_>) = sine(200).into_iter().map(|p| (p, rounded(p))).unzip();
        let faired = faired(&drawn, false, 0.0075);
        assert_eq!([faired[0], faired[200]], [drawn[0], drawn[200]]);
        let turn = |ps: &[DVec2], i: usize| (ps[i] - ps[i - 1]).angle_to(ps[i + 1] - ps[i]);
        let worst =
            |ps: &[DVec2]| (1..200).map(|i| (turn(ps, i) - turn(&exact, i)).abs()).fold(0.0, f64::max);
        assert!(worst(&drawn) > 0.01 && worst(&faired) < 0.003, "{} {}", worst(&drawn), worst(&faired));
        let off = faired.iter().zip(&exact).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(off < 0.008, "{off}");
    }

    #[test]
    fn no_point_moves_farther_than_allowed_and_doubled_points_are_left_alone() {
        let drawn: Vec<DVec2> = sine(50).into_iter().map(rounded).collect();
        for ring in [false, true] {
            let faired = faired(&drawn, ring, 0.01);
            assert!(faired.iter().zip(&drawn).all(|(a, b)| a.distance(*b) <= 0.01));
        }
        assert_eq!(faired(&[DVec2::ONE; 9], false, 1.0), [DVec2::ONE; 9]);
    }
}
