//! Whether a body stands as it is put on the ground.

use crate::error::{During, MoldError, Setting};
use glam::{DVec2, DVec3};
use softfold_geometry::polygon;
use softfold_kernel::cgal;

/// How a body rests on the horizontal plane through its lowest point.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// Whether the barycenter lies over the inside of the contact hull.
    pub stable: bool,
    /// Distance in plan from the barycenter to the nearest edge of the hull, mm; negative outside.
    pub margin_mm: f64,
    /// How far the body can be tilted about that edge before it falls, degrees; negative if it falls by itself.
    pub tipping_angle_deg: f64,
    /// The barycenter, mm.
    pub barycenter_mm: DVec3,
    /// Convex hull of the contact points in plan, counter-clockwise; one or two points if that is all there is.
    pub hull: Vec<DVec2>,
    /// How many of the given points touch the ground.
    pub contact_points: usize,
    /// Height of the ground, mm: the lowest point.
    pub ground_z_mm: f64,
    /// Height of the highest point above the ground, mm.
    pub height_mm: f64,
}

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.80665;

impl Stability {
    /// The horizontal push at the highest point that tips a body of this mass over the nearest edge, N: there its moment
    /// about the edge is that of the weight. None needed, 0, if it falls by itself; infinite without height.
    pub fn tipping_push_n(&self, mass_kg: f64) -> f64 {
        mass_kg * GRAVITY * self.margin_mm.max(0.0) / self.height_mm
    }
}

/// How the body of these points rests as it is posed: contact is what lies within `contact_mm` of the lowest point.
///
/// A body that touches along a line or at a point is not stable; its margin is minus the distance to that line or point.
///
/// # Errors
/// No points, coordinates that are not finite, a contact tolerance that is not positive.
pub fn stability(points: &[DVec3], barycenter: DVec3, contact_mm: f64) -> Result<Stability, MoldError> {
    Setting::of("stability", "contact_mm", "contact tolerance (mm)").positive(contact_mm)?;
    let ground_z_mm = points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let top_z_mm = points.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let contact: Vec<[f64; 2]> =
        points.iter().filter(|p| p.z <= ground_z_mm + contact_mm).map(|p| [p.x, p.y]).collect();
    let corners = cgal::convex_hull(&contact).during(|| "the contact hull".into())?;
    let hull: Vec<DVec2> = corners.iter().map(|&i| DVec2::from(contact[i as usize])).collect();
    let margin_mm = margin_mm(&hull, barycenter.truncate());
    Ok(Stability {
        stable: margin_mm > 0.0,
        margin_mm,
        tipping_angle_deg: margin_mm.atan2(barycenter.z - ground_z_mm).to_degrees(),
        barycenter_mm: barycenter,
        hull,
        contact_points: contact.len(),
        ground_z_mm,
        height_mm: top_z_mm - ground_z_mm,
    })
}

/// Signed distance to the border of a convex polygon, positive inside.
fn margin_mm(hull: &[DVec2], p: DVec2) -> f64 {
    let nearest = polygon::edges(hull).map(|(a, b)| polygon::segment_distance(p, a, b));
    let distance = nearest.fold(f64::INFINITY, f64::min);
    let inside = hull.len() > 2 && polygon::edges(hull).all(|(a, b)| (b - a).perp_dot(p - a) > 0.0);
    if inside { distance } else { -distance }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of 200 x 100 mm: four feet and a top at 70 mm that reaches farther than they do.
    fn table() -> Vec<DVec3> {
        let at =
            |x: f64, y: f64, z: f64| [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| DVec3::new(x, y, z));
        [at(100.0, 50.0, 0.0), at(150.0, 90.0, 70.0)].concat()
    }

    fn rest(barycenter: DVec3) -> Stability {
        stability(&table(), barycenter, 0.5).unwrap()
    }

    #[test]
    fn a_centred_table_stands_with_half_its_width() {
        let s = rest(DVec3::new(0.0, 0.0, 50.0));
        assert!(s.stable && s.margin_mm == 50.0 && s.contact_points == 4 && s.hull.len() == 4);
        assert!((s.tipping_angle_deg - 45.0).abs() < 1e-12);
    }

    #[test]
    fn a_push_at_the_top_has_the_moment_of_the_weight() {
        let s = rest(DVec3::new(0.0, 0.0, 50.0));
        // 50 mm from the barycenter to the edge, 70 mm up to the top.
        assert_eq!(s.height_mm, 70.0);
        assert!((s.tipping_push_n(2.0) - 2.0 * 9.80665 * 50.0 / 70.0).abs() < 1e-12);
        assert_eq!(rest(DVec3::new(0.0, -60.0, 50.0)).tipping_push_n(2.0), 0.0, "it falls by itself");
    }

    #[test]
    fn one_millimetre_before_tipping_it_stands() {
        let s = rest(DVec3::new(99.5, 0.0, 60.0));
        assert!(s.stable && (s.margin_mm - 0.5).abs() < 1e-12, "{s:?}");
        assert!(s.tipping_angle_deg > 0.0 && s.tipping_angle_deg < 0.5);
    }

    #[test]
    fn one_millimetre_past_tipping_it_falls() {
        let s = rest(DVec3::new(0.0, -50.5, 60.0));
        assert!(!s.stable && (s.margin_mm + 0.5).abs() < 1e-12 && s.tipping_angle_deg < 0.0, "{s:?}");
    }

    #[test]
    fn outside_a_corner_the_margin_is_the_distance_to_it() {
        let s = rest(DVec3::new(103.0, 54.0, 60.0));
        assert!(!s.stable && (s.margin_mm + 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_short_leg_leaves_three_feet() {
        let mut points = table();
        points[2].z = 2.0;
        let s = stability(&points, DVec3::new(-10.0, -10.0, 40.0), 0.5).unwrap();
        assert!(s.stable && s.hull.len() == 3 && s.contact_points == 3);
        // The edge of the hull is the diagonal through the origin: (-10, -10) is |(-10, -10)·(1, 2)|/√5 from it.
        assert!((s.margin_mm - 30.0 / 5f64.sqrt()).abs() < 1e-12, "{}", s.margin_mm);
        assert!(!stability(&points, DVec3::new(1.0, 1.0, 40.0), 0.5).unwrap().stable);
        assert!(stability(&points, DVec3::new(1.0, 1.0, 40.0), 3.0).unwrap().stable, "a coarser contact");
    }

    #[test]
    fn a_body_on_a_line_or_a_point_is_not_stable() {
        let edge = [DVec3::ZERO, DVec3::X * 100.0, DVec3::new(50.0, 0.0, 80.0)];
        let s = stability(&edge, DVec3::new(50.0, 0.0, 20.0), 0.5).unwrap();
        assert!(!s.stable && s.margin_mm == 0.0 && s.hull.len() == 2);
        let cone = [DVec3::ZERO, DVec3::new(50.0, 0.0, 80.0)];
        let s = stability(&cone, DVec3::new(3.0, 4.0, 20.0), 0.5).unwrap();
        assert!(!s.stable && s.margin_mm == -5.0 && s.hull.len() == 1);
    }

    #[test]
    fn height_of_the_ground_and_place_do_not_matter() {
        let shift = DVec3::new(1e4, -2e4, -3e3);
        let points: Vec<_> = table().iter().map(|p| *p + shift).collect();
        let s = stability(&points, DVec3::new(20.0, 10.0, 30.0) + shift, 0.5).unwrap();
        assert!((s.margin_mm - 40.0).abs() < 1e-9 && s.ground_z_mm == -3e3);
    }

    #[test]
    fn nothing_and_a_tolerance_of_none_are_refused() {
        assert!(matches!(stability(&[], DVec3::ZERO, 0.5), Err(MoldError::Kernel { .. })));
        assert!(matches!(
            stability(&table(), DVec3::ZERO, 0.0),
            Err(MoldError::Option { key: "contact_mm", .. })
        ));
    }
}
