//! What a surface does at one point: how it bends, along what, and how it stretches the flat sheet there.

use glam::{DVec2, DVec3};
use softfold_geometry::SurfacePoint;

/// The shape of a surface at a point. Flat directions are unit vectors of the sheet's (u, v); all directions may as well
/// be turned about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalShape {
    /// Where it is in space, mm.
    pub position: DVec3,
    /// Unit normal, on the side that the flat sheet shows to the onlooker.
    pub normal: DVec3,
    /// Principal curvatures, 1/mm, the larger in size first; positive where the surface bends towards its normal.
    pub curvatures: [f64; 2],
    /// Their directions in space, unit vectors at right angles; any pair where both curvatures are equal.
    pub directions: [DVec3; 2],
    /// The same on the flat sheet; at right angles as far as the sheet is not strained.
    pub flat_directions: [DVec2; 2],
    /// Principal strains of the map from the flat sheet, the smaller first: singular values of (S_u, S_v) less 1.
    pub strains: [f64; 2],
    /// Flat direction of the larger; that of the smaller is at right angles.
    pub strain_direction: DVec2,
}

impl LocalShape {
    /// The shape at a point of a surface over the flat sheet. None where (S_u, S_v) has no plane.
    pub fn of(point: &SurfacePoint) -> Option<Self> {
        let [a, b] = point.first;
        let normal = a.cross(b).try_normalize()?;
        let x = a.try_normalize()?;
        let y = normal.cross(x);
        // The second form in the orthonormal frame (x, y): S_u = a₁ x and S_v = b₁ x + b₂ y.
        let (a1, b1, b2) = (a.dot(x), b.dot(x), b.dot(y));
        let [uu, uv, vv] = point.second.map(|s| s.dot(normal));
        let xx = uu / (a1 * a1);
        let xy = (uv - b1 * a1 * xx) / (a1 * b2);
        let yy = (vv - 2.0 * b1 * b2 * xy - b1 * b1 * xx) / (b2 * b2);
        let ([larger, smaller], turn) = principal(xx, xy, yy);
        let along = turn.x * x + turn.y * y;
        let directions = [along, normal.cross(along)];
        let flat = |d: DVec3| {
            let v = d.dot(y) / b2;
            DVec2::new((d.dot(x) - b1 * v) / a1, v).normalize_or_zero()
        };
        let ([most, least], strain_direction) = principal(a.dot(a), a.dot(b), b.dot(b));
        Some(Self {
            position: point.position,
            normal,
            curvatures: [larger, smaller],
            directions,
            flat_directions: directions.map(flat),
            strains: [least.max(0.0).sqrt() - 1.0, most.sqrt() - 1.0],
            strain_direction,
        })
    }

    /// Gaussian curvature, 1/mm²; 0 where the surface is developable.
    pub fn gaussian_per_mm2(&self) -> f64 {
        self.curvatures[0] * self.curvatures[1]
    }

    /// How far it is from developable: |K|/k₁², from 0 (bent one way) to 1 (a sphere, a minimal surface). 0 where it is
    /// plane.
    pub fn double_bend(&self) -> f64 {
        let [k1, k2] = self.curvatures;
        if k1 == 0.0 { 0.0 } else { (k2 / k1).abs() }
    }

    /// Smallest radius of curvature, mm; infinite where it is plane.
    pub fn radius_mm(&self) -> f64 {
        self.curvatures[0].abs().recip()
    }

    /// Smallest radius of the skin `offset_mm` along the normal, `|1/k − offset|` for either curvature; 0 where that skin
    /// has passed its own centre of curvature.
    pub fn skin_radius_mm(&self, offset_mm: f64) -> f64 {
        let radius = |k: f64| (1.0 - offset_mm * k).max(0.0) / k.abs();
        self.curvatures.iter().filter(|k| **k != 0.0).map(|k| radius(*k)).fold(f64::INFINITY, f64::min)
    }

    /// Where the surface is developable, the way along which it is straight.
    pub fn ruling(&self) -> (DVec2, DVec3) {
        (self.flat_directions[1], self.directions[1])
    }
}

/// Eigenvalues of a symmetric matrix `(xx, xy; xy, yy)`, the larger in size first, and the first's unit vector.
fn principal(xx: f64, xy: f64, yy: f64) -> ([f64; 2], DVec2) {
    let (mean, half) = (0.5 * (xx + yy) + 0.0, 0.5 * (xx - yy)); // no −0: its sign would count
    let root = half.hypot(xy);
    let turn = 0.5 * xy.atan2(half);
    let larger = mean + root.copysign(mean);
    // The smaller from the determinant: a difference of two like numbers would lose its digits.
    let smaller = if larger == 0.0 { 0.0 } else { (xx * yy - xy * xy) / larger };
    let first = if mean < 0.0 { turn + std::f64::consts::FRAC_PI_2 } else { turn };
    ([larger, smaller], DVec2::from_angle(first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Developable, through};

    fn shape(s: &softfold_geometry::UniformBicubic, at: DVec2) -> LocalShape {
        LocalShape::of(&s.at(at)).unwrap()
    }

    /// Angle between two lines, degrees.
    fn between(a: DVec2, b: DVec2) -> f64 {
        a.perp_dot(b).abs().atan2(a.dot(b).abs()).to_degrees()
    }

    #[test]
    fn a_slanting_cylinder_has_its_radius_its_rulings_and_both_skins() {
        let (radius, slant) = (50.0, DVec2::from_angle(0.4));
        // Bent about lines along `slant`, towards its normal.
        let s = through(1.0, |p| {
            let (along, across) = (p.dot(slant), p.perp_dot(slant));
            DVec3::new(along, -radius * (across / radius).sin(), radius * (1.0 - (across / radius).cos()))
        });
        for at in [DVec2::new(10.0, 20.0), DVec2::new(61.3, 40.7)] {
            let l = shape(&s, at);
            assert!((l.radius_mm() - radius).abs() < 0.01 && l.curvatures[0] > 0.0, "{l:?}");
            assert!(between(l.ruling().0, slant) < 1e-3, "{l:?}");
            assert!(l.directions[1].cross(DVec3::X).length() < 1e-5);
            assert!(l.double_bend() < 1e-5 && l.strains.iter().all(|e| e.abs() < 1e-6), "{l:?}");
            assert!(
                (l.skin_radius_mm(5.0) - 45.0).abs() < 0.01 && (l.skin_radius_mm(-5.0) - 55.0).abs() < 0.01
            );
            assert_eq!(l.skin_radius_mm(51.0), 0.0);
        }
    }

    #[test]
    fn a_cone_bends_by_its_distance_from_the_apex_along_circles() {
        // TRUTH: half angle w; a flat point at (ρ, φ) about the apex goes to the angle φ / sin w about the axis.
        let w = 0.9_f64;
        let apex = DVec2::new(-60.0, -45.0);
        let s = through(1.0, |p| {
            let q = p - apex;
            let (rho, turn) = (q.length(), q.to_angle() / w.sin());
            DVec3::new(rho * w.sin() * turn.cos(), rho * w.sin() * turn.sin(), rho * w.cos())
        });
        for at in [DVec2::new(10.0, 20.0), DVec2::new(70.0, 31.0)] {
            let (l, q) = (shape(&s, at), at - apex);
            let wanted = 1.0 / (q.length() * w.tan());
            assert!((l.curvatures[0].abs() / wanted - 1.0).abs() < 1e-4, "{l:?} {wanted}");
            assert!(between(l.ruling().0, q) < 2e-3, "{}", between(l.ruling().0, q));
            assert!(l.double_bend() < 1e-4);
        }
    }

    #[test]
    fn a_sphere_and_a_saddle_bend_both_ways() {
        let r = 200.0_f64;
        let sphere = through(2.0, |p| {
            let q = p - DVec2::splat(50.0);
            q.extend(-(r * r - q.length_squared()).sqrt())
        });
        let l = shape(&sphere, DVec2::new(50.0, 50.0));
        assert!((l.double_bend() - 1.0).abs() < 1e-3 && (l.gaussian_per_mm2() * r * r - 1.0).abs() < 1e-3);
        let saddle =
            shape(&through(2.0, |p| p.extend(0.01 * (p.x - 50.0) * (p.y - 50.0))), DVec2::splat(50.0));
        assert!((saddle.gaussian_per_mm2() + 1e-4).abs() < 1e-8, "{saddle:?}");
        // Bent along the diagonals.
        assert!((between(saddle.flat_directions[0], DVec2::X) - 45.0).abs() < 1e-6);
    }

    #[test]
    fn strains_are_singular_values_with_their_direction() {
        // Stretched by 3 % along 30°, pressed by 2 % across.
        let axis = DVec2::from_angle(30.0_f64.to_radians());
        let s = through(2.0, |p| {
            (1.03 * p.dot(axis) * axis + 0.98 * p.dot(axis.perp()) * axis.perp()).extend(7.0)
        });
        let l = shape(&s, DVec2::new(31.0, 12.0));
        assert!((l.strains[0] + 0.02).abs() < 1e-12 && (l.strains[1] - 0.03).abs() < 1e-12, "{l:?}");
        assert!(between(l.strain_direction, axis) < 1e-9);
        assert_eq!(l.skin_radius_mm(3.0).min(1e9), 1e9);
    }

    /// TRUTH, relations 2, 5 and 9: along a circular crease of constant fold angle and constant ruling angle b, the left
    /// side bends by k_g tan a / sin² b across rulings that make b with the crease everywhere.
    #[test]
    fn a_tangent_developable_has_the_rulings_and_the_curvature_of_its_crease() {
        for b_deg in [90.0, 70.0, 115.0] {
            let side = Developable {
                crease_radius_mm: 300.0,
                half_fold_rad: 0.6,
                ruling_rad: f64::to_radians(b_deg),
            };
            let s = side.surface(1.0);
            for (t, v) in [(0.05, 0.0), (0.0, 15.0), (-0.06, 30.0)] {
                let s_mm = t * side.crease_radius_mm;
                let (at, ruling) = side.flat(s_mm, v);
                let l = shape(&s, at);
                let off = between(l.ruling().0, ruling);
                assert!(off < 0.02, "b {b_deg}: {off}° at {at}");
                assert!(
                    l.double_bend() < 2e-4 && l.strains.iter().all(|e| e.abs() < 1e-5),
                    "b {b_deg}: {l:?}"
                );
                assert!(l.ruling().1.cross(side.space(s_mm).1).length() < 4e-4);
                let wanted = side.curvature(v);
                assert!(
                    (l.curvatures[0].abs() / wanted - 1.0).abs() < 1e-3,
                    "b {b_deg}, v {v}: {} {wanted}",
                    l.curvatures[0]
                );
            }
        }
    }
}
