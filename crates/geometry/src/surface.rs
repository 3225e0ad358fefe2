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
#[derive(Clone, Copy, Debug, PartialEq)]
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
}
