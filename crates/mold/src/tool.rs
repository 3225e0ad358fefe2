//! One solid of all that is cut out of the underside of a part: grooves and marks.

use crate::error::{During, MoldError};
use crate::split::solid_down_to;
use crate::top::Patch;
use glam::{DVec2, DVec3};
use softfold_geometry::{TriMesh, polygon};
use softfold_kernel::cgal;

/// Corners are moved to multiples of this, mm: points that are meant to be one, or to lie on one line, then make no
/// triangles thinner than `f64` can tell. Far below what a printer can do.
const SNAP_MM: f64 = 1.0 / 1024.0;
/// A crossing of snapped lines belongs to regions this near, mm.
const BELONGS_MM: f64 = 4.0 * SNAP_MM;

/// A convex piece of the plan that is cut out from below up to a plane.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Region {
    /// Corners, counter-clockwise.
    pub(crate) corners: Vec<DVec2>,
    /// A point of the plan and the plane's height there, mm.
    pub(crate) at: DVec2,
    pub(crate) height_mm: f64,
    /// The plane's gradient.
    pub(crate) slope: DVec2,
}

impl Region {
    /// A rectangle around the segment from `a` to `b`, `half_mm` to each side and `beyond_mm` past both ends.
    pub(crate) fn around(a: DVec2, b: DVec2, half_mm: f64, beyond_mm: f64) -> Vec<DVec2> {
        let along = (b - a).normalize_or_zero();
        let across = along.perp() * half_mm;
        let (a, b) = (a - along * beyond_mm, b + along * beyond_mm);
        vec![a - across, b - across, b + across, a + across]
    }

    fn top_mm(&self, p: DVec2) -> f64 {
        self.height_mm + self.slope.dot(p - self.at)
    }

    fn contains(&self, p: DVec2, slack_mm: f64) -> bool {
        polygon::edges(&self.corners).all(|(a, b)| (b - a).perp_dot(p - a) >= -slack_mm * (b - a).length())
    }

    fn snapped(&self) -> Self {
        let corners = self.corners.iter().map(|c| (*c / SNAP_MM).round() * SNAP_MM).collect();
        Self { corners, ..self.clone() }
    }
}

/// The union of the regions from `floor_mm` up to their planes, as one closed mesh; where regions overlap the higher
/// plane counts, vertex by vertex.
///
/// The union is made in the plan, by a constrained triangulation of all sides, so that it is exact and needs no boolean.
pub(crate) fn tool(regions: &[Region], floor_mm: f64) -> Result<TriMesh, MoldError> {
    let regions: Vec<Region> = regions.iter().map(Region::snapped).collect();
    let points: Vec<[f64; 2]> = regions.iter().flat_map(|r| r.corners.iter().map(|c| c.to_array())).collect();
    let mut sides = Vec::new();
    for region in &regions {
        let (first, n) = (sides.len() as u32, region.corners.len() as u32); // a side a corner
        sides.extend((0..n).map(|k| [first + k, first + (k + 1) % n]));
    }
    let plan =
        cgal::constrained_delaunay(&points, &sides).during(|| "the plan of grooves and marks".into())?;
    let points: Vec<DVec2> = plan.points.iter().map(|&p| DVec2::from(p)).collect();
    let is_cut = |t: &&[u32; 3]| {
        let center = t.map(|i| points[i as usize]).iter().sum::<DVec2>() / 3.0;
        regions.iter().any(|r| r.contains(center, 0.0))
    };
    let triangles: Vec<[u32; 3]> = plan.triangles.iter().filter(is_cut).copied().collect();
    let positions = points.iter().map(|&p| p.extend(top_mm(&regions, p, floor_mm))).collect();
    let top = Patch { positions, triangles }.compact();
    Ok(solid_down_to(&top, |p| DVec3::new(p.x, p.y, floor_mm)))
}

/// The highest plane over a point; 1 mm above the floor where no region is (such points bear no triangle).
fn top_mm(regions: &[Region], p: DVec2, floor_mm: f64) -> f64 {
    let near = regions.iter().filter(|r| r.contains(p, BELONGS_MM));
    near.map(|r| r.top_mm(p)).fold(floor_mm + 1.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(corners: Vec<DVec2>, height_mm: f64) -> Region {
        Region { corners, at: DVec2::ZERO, height_mm, slope: DVec2::ZERO }
    }

    fn bar(a: (f64, f64), b: (f64, f64), half_mm: f64) -> Vec<DVec2> {
        Region::around(a.into(), b.into(), half_mm, 0.0)
    }

    fn closed_volume(mesh: &TriMesh) -> f64 {
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let view = softfold_kernel::MeshView { positions: &positions, triangles: &mesh.triangles };
        let c = cgal::closed_check(view).unwrap();
        assert!(c.closed && c.manifold && c.outward, "{c:?}");
        c.volume_mm3
    }

    #[test]
    fn a_cross_is_its_union() {
        let regions =
            [flat(bar((0., 0.), (100., 0.), 5.0), 3.0), flat(bar((50., -40.), (50., 40.), 5.0), 3.0)];
        let v = closed_volume(&tool(&regions, -7.0).unwrap());
        assert!((v - 10.0 * (1000.0 + 800.0 - 100.0)).abs() < 1e-6, "{v}");
    }

    #[test]
    fn a_slope_is_followed() {
        let mut ramp = flat(bar((0., 0.), (100., 0.), 5.0), 0.0);
        ramp.slope = DVec2::new(0.5, 0.0);
        let v = closed_volume(&tool(&[ramp], -10.0).unwrap());
        assert!((v - 1000.0 * (10.0 + 25.0)).abs() < 1e-6, "{v}");
    }

    #[test]
    fn bars_at_all_angles_make_a_closed_tool() {
        let spoke = |k: usize| {
            let d = DVec2::from_angle(k as f64 * 0.7);
            flat(Region::around(d * 2.0, d * 40.0, 1.0, 1.0), k as f64 * 0.1)
        };
        let regions: Vec<_> = (0..9).map(spoke).collect();
        assert!(closed_volume(&tool(&regions, -10.0).unwrap()) > 9.0 * 2.0 * 30.0 * 10.0);
    }
}
