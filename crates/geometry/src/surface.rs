//! The sheet surface: a uniform bicubic B-spline over the flat sheet, trimmed by its outline.

use crate::{CheckError, PlanarCurve};
use glam::{DVec2, DVec3};

/// Degree in both directions.
pub const DEGREE: usize = 3;

/// A uniform bicubic B-spline surface whose parameters are the sheet's (u, v). Pole (i, j) belongs
/// to the flat point `origin + spacing·(i, j)`; linear precision holds: with poles at those flat
/// points the surface is the identity. Knots are uniform, `u_k = origin.x + spacing·(k − 2)`.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformBicubic {
    /// Flat position of pole (0, 0).
    pub origin: DVec2,
    /// Lattice spacing, mm.
    pub spacing_mm: f64,
    /// Poles along u and v.
    pub count: [usize; 2],
    /// Poles, u outer and v inner: pole (i, j) is `poles[i * count[1] + j]`.
    pub poles: Vec<DVec3>,
}

/// Position and derivatives of the surface at one (u, v).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// Position, mm.
    pub position: DVec3,
    /// First derivatives by u and v.
    pub first: [DVec3; 2],
    /// Second derivatives uu, uv, vv, 1/mm.
    pub second: [DVec3; 3],
}

/// How far a surface is from the mesh that it was fitted to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Largest distance, mm.
    pub max_mm: f64,
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Where the largest is, (u, v) in mm.
    pub at: DVec2,
}

/// The folded sheet's surface and its trim.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetSurface {
    /// The surface.
    pub spline: UniformBicubic,
    /// Outline (counter-clockwise), then holes (clockwise), in (u, v).
    pub trim: Vec<PlanarCurve>,
    /// Distance to the folded vertices.
    pub deviation: Deviation,
}

impl SurfacePoint {
    /// Unit normal, on the side that the flat sheet shows to the onlooker.
    pub fn normal(&self) -> DVec3 {
        self.first[0].cross(self.first[1]).normalize_or_zero()
    }

    /// Principal curvatures, 1/mm, the larger in size first; positive where the surface bends towards
    /// its normal (a valley).
    pub fn principal_curvatures(&self) -> [f64; 2] {
        let [a, b] = self.first;
        let n = self.normal();
        let (e, f, g) = (a.dot(a), a.dot(b), b.dot(b));
        let [l, m, o] = self.second.map(|s| s.dot(n));
        let det = e * g - f * f;
        let gauss = (l * o - m * m) / det;
        let mean = (e * o - 2.0 * f * m + g * l) / (2.0 * det);
        let root = (mean * mean - gauss).max(0.0).sqrt();
        let larger = mean + root.copysign(mean);
        [larger, 2.0 * mean - larger]
    }
}

impl UniformBicubic {
    /// Lower and upper corner of the parameter domain.
    pub fn domain(&self) -> (DVec2, DVec2) {
        let n = DVec2::new(self.count[0] as f64, self.count[1] as f64);
        (self.origin + self.spacing_mm, self.origin + self.spacing_mm * (n - 2.0))
    }

    /// The full knot vectors in u and v, `count + 4` each, multiplicity 1.
    pub fn knots(&self) -> [Vec<f64>; 2] {
        [0, 1].map(|d| {
            (0..self.count[d] + DEGREE + 1)
                .map(|k| self.origin[d] + self.spacing_mm * (k as f64 - 2.0))
                .collect()
        })
    }

    /// The surface at (u, v); outside the domain the border patch is continued.
    pub fn at(&self, uv: DVec2) -> SurfacePoint {
        let local = (uv - self.origin) / self.spacing_mm;
        let cell = [0, 1].map(|d| (local[d].floor() as isize).clamp(1, self.count[d] as isize - 3) as usize);
        let bases = [0, 1].map(|d| basis(local[d] - cell[d] as f64));
        let sum = |du: usize, dv: usize| {
            let mut s = DVec3::ZERO;
            for a in 0..4 {
                for b in 0..4 {
                    let pole = self.poles[(cell[0] + a - 1) * self.count[1] + cell[1] + b - 1];
                    s += bases[0][du][a] * bases[1][dv][b] * pole;
                }
            }
            s / self.spacing_mm.powi((du + dv) as i32)
        };
        SurfacePoint {
            position: sum(0, 0),
            first: [sum(1, 0), sum(0, 1)],
            second: [sum(2, 0), sum(1, 1), sum(0, 2)],
        }
    }

    /// The surface through `values` at the knots of its domain: `(count[0] − 2)·(count[1] − 2)` of them, v inner, the
    /// first at `origin + spacing`. Both directions are solved one after the other, `(1, 4, 1)/6` between poles and
    /// values; the third difference of the poles vanishes at each end, so parabolas come out exactly everywhere.
    ///
    /// # Errors
    /// Fewer than five poles one way, or another number of values than the lattice has.
    pub fn interpolating(
        origin: DVec2,
        spacing_mm: f64,
        count: [usize; 2],
        values: &[DVec3],
    ) -> Result<Self, CheckError> {
        if count.iter().any(|&n| n < 5) || values.len() != (count[0] - 2) * (count[1] - 2) {
            let fault = format!("{} values do not fill a lattice of {count:?} poles (least 5)", values.len());
            return Err(CheckError::new("UniformBicubic", fault));
        }
        let inner = count[1] - 2;
        let rows: Vec<_> = values.chunks(inner).flat_map(interpolating_poles).collect();
        let mut poles = vec![DVec3::ZERO; count[0] * count[1]];
        for j in 0..count[1] {
            let column: Vec<_> = (0..count[0] - 2).map(|i| rows[i * count[1] + j]).collect();
            for (i, pole) in interpolating_poles(&column).into_iter().enumerate() {
                poles[i * count[1] + j] = pole;
            }
        }
        Ok(Self { origin, spacing_mm, count, poles })
    }

    /// The same surface over the same domain with half the spacing (exact knot insertion).
    pub fn refined(&self) -> Self {
        let rows: Vec<_> = self.poles.chunks(self.count[1]).map(halved).collect();
        let count = self.count.map(|n| 2 * n - 3);
        let mut poles = vec![DVec3::ZERO; count[0] * count[1]];
        for j in 0..count[1] {
            let column: Vec<_> = rows.iter().map(|row| row[j]).collect();
            for (i, pole) in halved(&column).into_iter().enumerate() {
                poles[i * count[1] + j] = pole;
            }
        }
        let spacing_mm = 0.5 * self.spacing_mm;
        Self { origin: self.origin + spacing_mm, spacing_mm, count, poles }
    }

    /// The contract of this type.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), CheckError> {
        let fault = |f: &str| Err(CheckError::new("UniformBicubic", f));
        if self.count.iter().any(|&n| n < 4) || self.poles.len() != self.count[0] * self.count[1] {
            return fault("needs four poles or more each way, and all of them");
        }
        if self.poles.iter().any(|p| !p.is_finite()) {
            return fault("a pole is not finite");
        }
        Ok(())
    }
}

/// Cubic B-spline basis on one cell and its first two derivatives, t in 0..=1.
fn basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [
            s * s * s / 6.0,
            (3.0 * t * t * (t - 2.0) + 4.0) / 6.0,
            (3.0 * s * s * (s - 2.0) + 4.0) / 6.0,
            t * t * t / 6.0,
        ],
        [-s * s / 2.0, t * (3.0 * t - 4.0) / 2.0, -s * (3.0 * s - 4.0) / 2.0, t * t / 2.0],
        [s, 3.0 * t - 2.0, 3.0 * s - 2.0, t],
    ]
}

/// Poles of the uniform cubic through `values` at its inner knots, two more than values.
///
/// With `p₀ − 3p₁ + 3p₂ − p₃ = 0` the first two equations `p₀ + 4p₁ + p₂ = 6f₁` and `p₁ + 4p₂ + p₃ = 6f₂` leave
/// `p₁ − p₂ = f₁ − f₂`, and likewise at the other end: the system stays tridiagonal.
fn interpolating_poles(values: &[DVec3]) -> Vec<DVec3> {
    let n = values.len();
    // Forward sweep: p[i] = right[i] - upper[i] * p[i + 1].
    let (mut upper, mut right) = (vec![-1.0; n], vec![values[0] - values[1]; n]);
    for i in 1..n - 1 {
        let pivot = 4.0 - upper[i - 1];
        upper[i] = 1.0 / pivot;
        right[i] = (6.0 * values[i] - right[i - 1]) / pivot;
    }
    let mut poles = vec![DVec3::ZERO; n + 2];
    poles[n] = (values[n - 1] - values[n - 2] + right[n - 2]) / (1.0 + upper[n - 2]);
    for i in (0..n - 1).rev() {
        poles[i + 1] = right[i] - upper[i] * poles[i + 2];
    }
    poles[0] = 3.0 * (poles[1] - poles[2]) + poles[3];
    poles[n + 1] = 3.0 * (poles[n] - poles[n - 1]) + poles[n - 2];
    poles
}

/// Poles of the same uniform cubic with half the knot distance, over the same domain.
fn halved(poles: &[DVec3]) -> Vec<DVec3> {
    let edge = |i: usize| 0.5 * (poles[i] + poles[i + 1]);
    let vertex = |i: usize| (poles[i - 1] + 6.0 * poles[i] + poles[i + 1]) / 8.0;
    (1..2 * poles.len() - 2).map(|k| if k % 2 == 1 { edge(k / 2) } else { vertex(k / 2) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(f: impl Fn(DVec2) -> DVec3) -> UniformBicubic {
        let (origin, spacing_mm, count) = (DVec2::new(-3.0, 2.0), 0.5, [12, 9]);
        let poles = (0..count[0] * count[1])
            .map(|k| f(origin + spacing_mm * DVec2::new((k / count[1]) as f64, (k % count[1]) as f64)))
            .collect();
        UniformBicubic { origin, spacing_mm, count, poles }
    }

    #[test]
    fn linear_precision() {
        let s = lattice(|p| DVec3::new(p.x, p.y, 2.0 * p.x - p.y));
        s.check().unwrap();
        for uv in [DVec2::new(-2.1, 3.0), DVec2::new(1.37, 4.99), s.domain().0, s.domain().1] {
            let p = s.at(uv);
            assert!(p.position.distance(DVec3::new(uv.x, uv.y, 2.0 * uv.x - uv.y)) < 1e-12);
            assert!(p.first[0].distance(DVec3::new(1., 0., 2.)) < 1e-12);
            assert!(p.second.iter().all(|s| s.length() < 1e-11));
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let s = lattice(|p| DVec3::new(p.x.sin(), p.y.cos(), p.x * p.y * p.y));
        let (uv, e) = (DVec2::new(-0.77, 3.41), 1e-5);
        let d = |step: DVec2| (s.at(uv + step).position - s.at(uv - step).position) / (2.0 * e);
        let p = s.at(uv);
        assert!(p.first[0].distance(d(DVec2::new(e, 0.0))) < 1e-8);
        assert!(p.first[1].distance(d(DVec2::new(0.0, e))) < 1e-8);
        let d2 = (s.at(uv + DVec2::new(e, 0.)).first[1] - s.at(uv - DVec2::new(e, 0.)).first[1]) / (2.0 * e);
        assert!(p.second[1].distance(d2) < 1e-7);
    }

    #[test]
    fn a_parabola_has_its_curvature() {
        // Poles on z = x²/20 give a curve with z'' = 1/10 exactly.
        let s = lattice(|p| DVec3::new(p.x, p.y, p.x * p.x / 20.0));
        let p = s.at(DVec2::new(0.0, 4.0));
        let [k1, k2] = p.principal_curvatures();
        assert!((k1 - 0.1).abs() < 1e-12 && k2.abs() < 1e-12, "{k1} {k2}");
        assert!(p.normal().distance(DVec3::Z) < 1e-12);
    }

    #[test]
    fn interpolation_goes_through_its_values_and_keeps_parabolas() {
        let f = |p: DVec2| DVec3::new(p.x, p.y - p.x * p.x, p.x * p.y + 0.3 * p.y * p.y);
        let (origin, spacing_mm, count) = (DVec2::new(1.0, -2.0), 0.5, [9, 5]);
        let knots =
            (0..7 * 3).map(|k| origin + spacing_mm * DVec2::new((1 + k / 3) as f64, (1 + k % 3) as f64));
        let values: Vec<_> = knots.map(f).collect();
        let s = UniformBicubic::interpolating(origin, spacing_mm, count, &values).unwrap();
        s.check().unwrap();
        for uv in [DVec2::new(1.5, -1.5), DVec2::new(2.71, -1.03), s.domain().1] {
            assert!(s.at(uv).position.distance(f(uv)) < 1e-12, "{uv}");
        }
        assert!(UniformBicubic::interpolating(origin, spacing_mm, [9, 6], &values).is_err());
    }

    #[test]
    fn interpolation_is_of_fourth_order_inside() {
        let f = |p: DVec2| DVec3::new(p.x, p.y, p.x.sin() * p.y.cos());
        let error = |n: usize| {
            let h = 6.0 / n as f64;
            let knots =
                (0..(n + 1) * (n + 1)).map(|k| h * DVec2::new((k / (n + 1)) as f64, (k % (n + 1)) as f64));
            let values: Vec<_> = knots.map(f).collect();
            let s = UniformBicubic::interpolating(DVec2::splat(-h), h, [n + 3; 2], &values).unwrap();
            let probes = (0..50).map(|k| DVec2::new(2.0 + 0.037 * k as f64, 3.9 - 0.031 * k as f64));
            probes.map(|p| s.at(p).position.distance(f(p))).fold(0.0, f64::max)
        };
        let rate = (error(20) / error(40)).log2();
        assert!(rate > 3.7, "{rate}");
    }

    #[test]
    fn refining_changes_no_point() {
        let s = lattice(|p| DVec3::new(p.x.sin(), p.y.cos(), p.x * p.y * p.y));
        let r = s.refined();
        r.check().unwrap();
        assert_eq!(r.domain(), s.domain());
        for uv in [s.domain().0, DVec2::new(-1.13, 4.21), s.domain().1] {
            assert!(r.at(uv).position.distance(s.at(uv).position) < 1e-12);
            assert!(r.at(uv).second[1].distance(s.at(uv).second[1]) < 1e-10);
        }
    }
}
