//! Quick answers to "is this point on the sheet".

use glam::DVec2;
use softfold_geometry::polygon;

/// Polygon sides sorted into horizontal slabs, so that a query looks at few of them.
pub(crate) struct Inside {
    low: f64,
    slab_mm: f64,
    slabs: Vec<Vec<(DVec2, DVec2)>>,
}

impl Inside {
    pub(crate) fn new(polygons: &[Vec<DVec2>]) -> Self {
        let all: Vec<DVec2> = polygons.iter().flatten().copied().collect();
        let (lo, hi) = polygon::bounds(&all);
        let count = all.len().max(1);
        let slab_mm = ((hi.y - lo.y) / count as f64).max(f64::MIN_POSITIVE);
        let mut inside = Self { low: lo.y, slab_mm, slabs: vec![Vec::new(); count + 1] };
        for (a, b) in polygons.iter().flat_map(|p| polygon::edges(p)) {
            for k in inside.slab(a.y.min(b.y))..=inside.slab(a.y.max(b.y)) {
                inside.slabs[k].push((a, b));
            }
        }
        inside
    }

    fn slab(&self, y: f64) -> usize {
        (((y - self.low) / self.slab_mm).max(0.0) as usize).min(self.slabs.len() - 1)
    }

    /// Even-odd rule over all polygons: inside the outline and in no hole.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        let crosses = |&&(a, b): &&(DVec2, DVec2)| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.slabs[self.slab(p.y)].iter().filter(crosses).count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::SplitMix64;

    #[test]
    fn agrees_with_the_plain_test_on_random_points() {
        let polygon: Vec<DVec2> = (0..97)
            .map(|k| {
                let a = k as f64 / 97.0 * std::f64::consts::TAU;
                DVec2::from_angle(a) * (10.0 + 4.0 * (5.0 * a).sin())
            })
            .collect();
        let inside = Inside::new(std::slice::from_ref(&polygon));
        let mut rng = SplitMix64(3);
        for _ in 0..2000 {
            let p = DVec2::new(30.0 * rng.unit() - 15.0, 30.0 * rng.unit() - 15.0);
            assert_eq!(inside.contains(p), softfold_geometry::polygon::contains(&polygon, p));
        }
    }
}
