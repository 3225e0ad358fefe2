//! Heights of a patch over the plan.

use crate::top::Patch;
use glam::DVec2;
use softfold_geometry::polygon;

/// Triangles per bucket that the raster aims at.
const PER_BUCKET: f64 = 4.0;
/// A point belongs to a triangle if its barycentric coordinates are above this: rounding on a shared edge must not
/// leave a gap.
const ON_EDGE: f64 = -1e-9;

/// Finds the height of the sheet above a point of the plan.
pub(crate) struct HeightField<'a> {
    patch: &'a Patch,
    lower: DVec2,
    bucket_mm: f64,
    count: [usize; 2],
    buckets: Vec<Vec<u32>>,
}

impl<'a> HeightField<'a> {
    /// Sorts the triangles of a patch into buckets.
    pub(crate) fn new(patch: &'a Patch) -> Self {
        let plan: Vec<_> = patch.positions.iter().map(|p| p.truncate()).collect();
        let (lower, upper) = polygon::bounds(&plan);
        let size = upper - lower;
        let per_triangle = size.element_product() / patch.triangles.len().max(1) as f64;
        let bucket_mm = (PER_BUCKET * per_triangle).sqrt().max(f64::MIN_POSITIVE);
        let count = [size.x, size.y].map(|s| (s / bucket_mm) as usize + 1);
        let mut field =
            Self { patch, lower, bucket_mm, count, buckets: vec![Vec::new(); count[0] * count[1]] };
        for (t, triangle) in patch.triangles.iter().enumerate() {
            let (a, b) = polygon::bounds(&triangle.map(|i| plan[i as usize]));
            let ([i0, j0], [i1, j1]) = (field.bucket(a), field.bucket(b));
            for i in i0..=i1 {
                for j in j0..=j1 {
                    field.buckets[i * count[1] + j].push(t as u32);
                }
            }
        }
        field
    }

    /// The sheet's vertices in plan.
    pub(crate) fn plan(&self) -> Vec<DVec2> {
        self.patch.positions.iter().map(|p| p.truncate()).collect()
    }

    fn bucket(&self, p: DVec2) -> [usize; 2] {
        let local = ((p - self.lower) / self.bucket_mm).max(DVec2::ZERO);
        [(local.x as usize).min(self.count[0] - 1), (local.y as usize).min(self.count[1] - 1)]
    }

    /// Height of the sheet above `p`; the lowest where it hangs over itself, none beside it.
    pub(crate) fn at(&self, p: DVec2) -> Option<f64> {
        let [i, j] = self.bucket(p);
        let candidates = &self.buckets[i * self.count[1] + j];
        let heights = candidates.iter().filter_map(|&t| self.height_in(t, p));
        heights.reduce(f64::min)
    }

    fn height_in(&self, triangle: u32, p: DVec2) -> Option<f64> {
        let [a, b, c] = self.patch.triangles[triangle as usize].map(|i| self.patch.positions[i as usize]);
        let (ab, ac, ap) = ((b - a).truncate(), (c - a).truncate(), p - a.truncate());
        let area = ab.perp_dot(ac);
        let (wb, wc) = (ap.perp_dot(ac) / area, ab.perp_dot(ap) / area);
        let wa = 1.0 - wb - wc;
        (wa >= ON_EDGE && wb >= ON_EDGE && wc >= ON_EDGE).then_some(wa * a.z + wb * b.z + wc * c.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_tilted_plane_has_its_heights_and_its_border() {
        let n = 20;
        let at = |k: usize| DVec2::new((k % (n + 1)) as f64, (k / (n + 1)) as f64);
        let z = |p: DVec2| 3.0 * p.x - p.y + 7.0;
        let positions: Vec<DVec3> = (0..(n + 1) * (n + 1)).map(|k| at(k).extend(z(at(k)))).collect();
        let cell = |k: usize| {
            let a = (k / n * (n + 1) + k % n) as u32;
            let m = n as u32 + 1;
            [[a, a + 1, a + m + 1], [a, a + m + 1, a + m]]
        };
        let patch = Patch { positions, triangles: (0..n * n).flat_map(cell).collect() };
        let field = HeightField::new(&patch);
        for p in [DVec2::new(0.0, 0.0), DVec2::new(3.0, 3.0), DVec2::new(7.31, 12.9), DVec2::new(20.0, 20.0)]
        {
            assert!((field.at(p).unwrap() - z(p)).abs() < 1e-9, "{p}");
        }
        assert_eq!(field.at(DVec2::new(20.1, 3.0)), None);
        assert_eq!(field.at(DVec2::new(-4.0, 3.0)), None);
    }
}
