//! What the surface does to the sheet: its smallest radius, its strain and its area.

use crate::SurfaceError;
use crate::error::is_positive;
use crate::layout::tolerance;
use glam::{DVec2, DVec3};
use softfold_geometry::{Extreme, PlanarCurve, SheetSurface, SurfacePoint, polygon};

/// The surface inside its trim, seen at a lattice of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAnalysis {
    /// Smallest radius of curvature in any direction, mm; infinite for a plane.
    pub min_radius_mm: Extreme,
    /// Smallest and largest principal strain against the flat sheet: the singular values of (S_u, S_v) less 1.
    pub principal_strain: [Extreme; 2],
    /// Gaussian curvature of largest size, 1/mm²; 0 for a developable surface.
    pub gaussian_curvature_per_mm2: Extreme,
    /// Area in space, mm².
    pub area_mm2: f64,
}

/// Looks at a surface along rows of v, `step_mm` apart and with points no farther apart than that, ends on the trim
/// included.
///
/// The area is the mean stretch of area times the exact area inside the trim, so that the steps of the lattice along a
/// slanting outline do not count.
///
/// # Errors
/// A step that is not positive; no outline, or a curve that is not closed.
pub fn analyse(surface: &SheetSurface, step_mm: f64) -> Result<SurfaceAnalysis, SurfaceError> {
    if !is_positive(step_mm) {
        return Err(SurfaceError::Step { step_mm });
    }
    let loops = loops(&surface.trim)?;
    surface.spline.check()?;
    let mut sums = Sums::default();
    for run in runs(&loops, step_mm) {
        sums.add_run(surface, &run, step_mm);
    }
    let flat_mm2: f64 = surface.trim.iter().map(PlanarCurve::signed_area_mm2).sum();
    sums.finish(flat_mm2).ok_or(SurfaceError::NoTrim)
}

/// The trim as polygons.
///
/// # Errors
/// None, or one that is not closed.
pub(crate) fn loops(trim: &[PlanarCurve]) -> Result<Vec<Vec<DVec2>>, SurfaceError> {
    let chord_mm = tolerance(trim)?.chord_mm;
    Ok(trim.iter().map(|c| c.flatten(chord_mm)).collect())
}

/// A piece of a row inside the trim: from `u[0]` to `u[1]` at `v`.
struct Run {
    u: [f64; 2],
    v: f64,
}

/// The runs of all rows, bottom up, left to right (even-odd rule).
fn runs(loops: &[Vec<DVec2>], step_mm: f64) -> Vec<Run> {
    let (lo, hi) = polygon::bounds(&loops.concat());
    let rows = ((hi.y - lo.y) / step_mm).ceil().max(1.0) as usize;
    let row_mm = (hi.y - lo.y) / rows as f64;
    let heights: Vec<f64> = (0..rows).map(|row| lo.y + (row as f64 + 0.5) * row_mm).collect();
    let mut crossings = vec![Vec::new(); rows];
    for (a, b) in loops.iter().flat_map(|l| polygon::edges(l)) {
        let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
        let first = heights.partition_point(|&v| v < low.y);
        let end = heights.partition_point(|&v| v < high.y);
        for row in first..end {
            crossings[row].push(low.x + (heights[row] - low.y) / (high.y - low.y) * (high.x - low.x));
        }
    }
    crossings.iter_mut().for_each(|us| us.sort_by(f64::total_cmp));
    let of_row = |(us, &v): (&Vec<f64>, &f64)| -> Vec<Run> {
        us.chunks_exact(2).map(|u| Run { u: [u[0], u[1]], v }).collect()
    };
    crossings.iter().zip(&heights).flat_map(of_row).collect()
}

/// Extremes and sums so far.
#[derive(Default)]
struct Sums {
    curvature: Option<Extreme>,
    gaussian: Option<Extreme>,
    strain: [Option<Extreme>; 2],
    flat_mm2: f64,
    area_mm2: f64,
}

impl Sums {
    /// The ends and the middles of equal pieces of a run; only the latter carry area.
    fn add_run(&mut self, surface: &SheetSurface, run: &Run, step_mm: f64) {
        let length = run.u[1] - run.u[0];
        let n = (length / step_mm).ceil().max(1.0) as usize;
        let piece = length / n as f64;
        run.u.iter().for_each(|&u| self.add(surface, DVec2::new(u, run.v), 0.0));
        for k in 0..n {
            self.add(surface, DVec2::new(run.u[0] + (k as f64 + 0.5) * piece, run.v), piece);
        }
    }

    fn add(&mut self, surface: &SheetSurface, at: DVec2, weight: f64) {
        let point = surface.spline.at(at);
        let [k1, k2] = point.principal_curvatures();
        keep(&mut self.curvature, Extreme { value: k1.abs(), at }, |new, old| new > old);
        keep(&mut self.gaussian, Extreme { value: k1 * k2, at }, |new, old| new.abs() > old.abs());
        let [low, high] = principal_strain(&point);
        keep(&mut self.strain[0], Extreme { value: low, at }, |new, old| new < old);
        keep(&mut self.strain[1], Extreme { value: high, at }, |new, old| new > old);
        self.flat_mm2 += weight;
        self.area_mm2 += weight * point.first[0].cross(point.first[1]).length();
    }

    fn finish(self, flat_mm2: f64) -> Option<SurfaceAnalysis> {
        let curvature = self.curvature?;
        Some(SurfaceAnalysis {
            min_radius_mm: Extreme { value: curvature.value.recip(), at: curvature.at },
            principal_strain: [self.strain[0]?, self.strain[1]?],
            gaussian_curvature_per_mm2: self.gaussian?,
            area_mm2: flat_mm2 * self.area_mm2 / self.flat_mm2,
        })
    }
}

fn keep(best: &mut Option<Extreme>, new: Extreme, better: impl Fn(f64, f64) -> bool) {
    if best.is_none_or(|old| better(new.value, old.value)) {
        *best = Some(new);
    }
}

/// Singular values of (S_u, S_v) less 1, from the metric.
fn principal_strain(point: &SurfacePoint) -> [f64; 2] {
    let [a, b]: [DVec3; 2] = point.first;
    let (e, f, g) = (a.dot(a), a.dot(b), b.dot(b));
    let (mean, root) = (0.5 * (e + g), (0.5 * (e - g)).hypot(f));
    [(mean - root).max(0.0).sqrt() - 1.0, (mean + root).sqrt() - 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::rectangle;
    use softfold_geometry::{Deviation, UniformBicubic};

    /// The surface through `f` at the knots over -20..140, trimmed by `trim`.
    fn surface(trim: Vec<PlanarCurve>, f: impl Fn(DVec2) -> DVec3) -> SheetSurface {
        let (h, n) = (2.0, 81);
        let knots = (0..n * n).map(|k| DVec2::splat(-20.0) + h * DVec2::new((k / n) as f64, (k % n) as f64));
        let values: Vec<_> = knots.map(f).collect();
        let spline = UniformBicubic::interpolating(DVec2::splat(-22.0), h, [n + 2; 2], &values).unwrap();
        SheetSurface { spline, trim, deviation: Deviation::default() }
    }

    fn triangle(corners: [(f64, f64); 3]) -> PlanarCurve {
        let [a, b, c] = corners.map(DVec2::from);
        PlanarCurve::polyline(&[a, b, c, a]).unwrap()
    }

    #[test]
    fn a_plane_with_a_hole_has_its_exact_area_and_no_radius() {
        let trim = vec![
            triangle([(0., 0.), (113., 7.), (31., 97.)]),
            triangle([(40., 20.), (50., 50.), (60., 25.)]),
        ];
        let flat: f64 = trim.iter().map(PlanarCurve::signed_area_mm2).sum();
        let s = surface(trim, |p| DVec3::new(p.x, p.y, 0.75 * p.x));
        let a = analyse(&s, 3.0).unwrap();
        assert!((a.area_mm2 - 1.25 * flat).abs() < 1e-8 * flat, "{}", a.area_mm2);
        assert!(a.min_radius_mm.value > 1e9);
        assert!(
            (a.principal_strain[1].value - 0.25).abs() < 1e-12 && a.principal_strain[0].value.abs() < 1e-12
        );
    }

    #[test]
    fn a_cylinder_has_its_radius_and_no_strain() {
        let s = surface(rectangle(DVec2::new(100.0, 60.0)), |p| {
            DVec3::new(50.0 * (p.x / 50.0).sin(), p.y, 50.0 * (1.0 - (p.x / 50.0).cos()))
        });
        let a = analyse(&s, 2.0).unwrap();
        assert!((a.min_radius_mm.value - 50.0).abs() < 0.02, "{:?}", a.min_radius_mm);
        assert!(a.principal_strain.iter().all(|e| e.value.abs() < 1e-6), "{:?}", a.principal_strain);
        assert!(a.gaussian_curvature_per_mm2.value.abs() < 1e-12);
        assert!((a.area_mm2 - 6000.0).abs() < 1e-3);
    }

    #[test]
    fn extremes_are_found_where_they_are() {
        // Stretch along u grows with u; the saddle is tightest at the origin, K = -k².
        let s = surface(rectangle(DVec2::splat(100.0)), |p| DVec3::new(p.x + 1e-4 * p.x * p.x, p.y, 0.0));
        let [low, high] = analyse(&s, 1.0).unwrap().principal_strain;
        assert!(
            low.value.abs() < 1e-12 && (high.value - 0.02).abs() < 1e-9 && high.at.x == 100.0,
            "{high:?}"
        );
        let s = surface(rectangle(DVec2::splat(100.0)), |p| p.extend(0.02 * p.x * p.y));
        let a = analyse(&s, 0.5).unwrap();
        assert!(
            (a.gaussian_curvature_per_mm2.value + 4e-4).abs() < 1e-6,
            "{:?}",
            a.gaussian_curvature_per_mm2
        );
        assert!(a.min_radius_mm.at.length() < 1.0 && (a.min_radius_mm.value - 50.0).abs() < 0.1);
    }

    #[test]
    fn bad_steps_and_trims_are_refused() {
        let s = surface(rectangle(DVec2::splat(10.0)), |p| p.extend(0.0));
        assert_eq!(analyse(&s, 0.0), Err(SurfaceError::Step { step_mm: 0.0 }));
        assert!(analyse(&s, f64::NAN).is_err());
        let untrimmed = SheetSurface { trim: Vec::new(), ..s };
        assert_eq!(analyse(&untrimmed, 1.0), Err(SurfaceError::NoTrim));
    }
}
