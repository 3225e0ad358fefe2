//! How the sheet lies on its mold: seen from above without undercuts, in the least rectangle, on the ground.

use crate::cap::best_direction;
use crate::error::{During, MoldError};
use crate::samples::{LatticeSample, TrimIndex, border};
use glam::{DMat3, DQuat, DVec2, DVec3};
use softfold_geometry::{RigidTransform, SheetSurface, polygon};
use softfold_kernel::cgal;
use std::collections::BTreeMap;

/// Places per lattice cell and direction at which normals and heights are looked at. A fold turns by a few degrees
/// from one place to the next.
const SAMPLES_PER_CELL: f64 = 4.0;

/// Which way is up for the mold.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum PoseChoice {
    /// Found: the largest least draft, then the least bounding rectangle with its long side along X.
    #[default]
    Found,
    /// This rotation is kept; only the place is found.
    Rotation(DMat3),
}

/// How the sheet lies on the mold. The mold's lowest point has z = 0 and its bounding rectangle starts at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct MoldPose {
    /// The motion from the sheet's coordinates to the mold's.
    pub mold_from_sheet: RigidTransform,
    /// The smallest angle between the sheet's surface and the vertical, degrees; negative where it hangs over.
    pub least_draft_deg: f64,
    /// Where the sheet hangs over, worst first: the mold there cannot be stripped along z, nor seen from above.
    pub undercuts: Vec<Undercut>,
}

/// A connected piece of the sheet whose normal points sideways or down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Undercut {
    /// The worst place, (u, v) in mm.
    pub at: DVec2,
    /// Angle between surface and vertical there, degrees; zero or negative.
    pub draft_deg: f64,
    /// Its area on the flat sheet, mm².
    pub area_mm2: f64,
}

/// The sheet's border and inside, looked at once.
pub(crate) struct Look {
    pub(crate) positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    lattice: Vec<LatticeSample>,
    lattice_step_mm: f64,
    border_uv: Vec<DVec2>,
    u_direction: DVec3,
}

/// Finds the pose of a mold of this thickness (along z).
///
/// # Errors
/// A trim that leaves the surface.
pub fn find_pose(
    sheet: &SheetSurface,
    choice: &PoseChoice,
    thickness_mm: f64,
) -> Result<MoldPose, MoldError> {
    let look = Look::at(sheet)?;
    let rotation = match choice {
        PoseChoice::Rotation(rotation) => *rotation,
        PoseChoice::Found => {
            let (up, _) = best_direction(&look.normals);
            least_rectangle(&look, DMat3::from_quat(DQuat::from_rotation_arc(up, DVec3::Z)))?
        }
    };
    Ok(look.pose(rotation, thickness_mm))
}

impl Look {
    pub(crate) fn at(sheet: &SheetSurface) -> Result<Self, MoldError> {
        let lattice_step_mm = sheet.spline.spacing_mm / SAMPLES_PER_CELL;
        let lattice = TrimIndex::new(sheet)?.lattice(lattice_step_mm);
        let border_uv = border(sheet, lattice_step_mm);
        let uv = lattice.iter().map(|s| s.uv).chain(border_uv.iter().copied());
        let points: Vec<_> = uv.map(|uv| sheet.spline.at(uv)).collect();
        Ok(Self {
            positions: points.iter().map(|p| p.position).collect(),
            normals: points.iter().map(|p| p.normal()).collect(),
            lattice,
            lattice_step_mm,
            border_uv,
            u_direction: points.iter().map(|p| p.first[0]).sum(),
        })
    }

    /// The pose with this rotation: placed at the origin, undercuts told.
    pub(crate) fn pose(&self, rotation: DMat3, thickness_mm: f64) -> MoldPose {
        let turned = self.positions.iter().map(|p| rotation * *p);
        let lower = turned.fold(DVec3::INFINITY, DVec3::min);
        let translation = DVec3::Z * thickness_mm - lower;
        let up = rotation.transpose() * DVec3::Z;
        let cosines: Vec<f64> = self.normals.iter().map(|n| n.dot(up)).collect();
        let least = cosines.iter().copied().fold(1.0, f64::min);
        MoldPose {
            mold_from_sheet: RigidTransform { rotation, translation },
            least_draft_deg: draft_deg(least),
            undercuts: self.undercuts(&cosines),
        }
    }

    /// Connected pieces of the lattice that hang over, then places on the border that have none beside them.
    fn undercuts(&self, cosines: &[f64]) -> Vec<Undercut> {
        let (inside, border) = cosines.split_at(self.lattice.len());
        let under = self.lattice.iter().zip(inside).filter(|(_, c)| **c <= 0.0);
        let open: BTreeMap<[usize; 2], (DVec2, f64)> = under.map(|(s, &c)| (s.index, (s.uv, c))).collect();
        let cell_mm2 = self.lattice_step_mm * self.lattice_step_mm;
        let mut found = pieces(open, cell_mm2);
        let worst = self.border_uv.iter().zip(border).min_by(|a, b| a.1.total_cmp(b.1));
        if let (true, Some((&at, &c))) = (found.is_empty(), worst.filter(|w| *w.1 <= 0.0)) {
            found.push(Undercut { at, draft_deg: draft_deg(c), area_mm2: 0.0 });
        }
        found.sort_by(|a, b| a.draft_deg.total_cmp(&b.draft_deg));
        found
    }
}

fn draft_deg(cosine: f64) -> f64 {
    cosine.clamp(-1.0, 1.0).asin().to_degrees()
}

/// Splits marked lattice places into connected pieces.
fn pieces(mut open: BTreeMap<[usize; 2], (DVec2, f64)>, cell_mm2: f64) -> Vec<Undercut> {
    let mut found = Vec::new();
    while let Some((start, (at, cosine))) = open.pop_first() {
        let mut piece = Undercut { at, draft_deg: draft_deg(cosine), area_mm2: cell_mm2 };
        let mut todo = vec![start];
        while let Some([i, j]) = todo.pop() {
            for next in [[i + 1, j], [i.wrapping_sub(1), j], [i, j + 1], [i, j.wrapping_sub(1)]] {
                let Some((at, cosine)) = open.remove(&next) else { continue };
                todo.push(next);
                piece.area_mm2 += cell_mm2;
                if draft_deg(cosine) < piece.draft_deg {
                    (piece.at, piece.draft_deg) = (at, draft_deg(cosine));
                }
            }
        }
        found.push(piece);
    }
    found
}

/// Turns about z until the bounding rectangle in plan is least, its long side along X and the sheet's u direction
/// towards +X. The least rectangle has a side along an edge of the convex hull (Freeman and Shapira, 1975).
fn least_rectangle(look: &Look, upright: DMat3) -> Result<DMat3, MoldError> {
    let plan: Vec<[f64; 2]> = look.positions.iter().map(|p| (upright * *p).truncate().to_array()).collect();
    let corners = cgal::convex_hull(&plan).during(|| "the mold's outline in plan".into())?;
    let hull: Vec<DVec2> = corners.iter().map(|&i| DVec2::from(plan[i as usize])).collect();
    let sized = polygon::edges(&hull).map(|(a, b)| {
        let along = (b - a).normalize_or_zero();
        let turned: Vec<_> = hull.iter().map(|p| DVec2::new(along.dot(*p), along.perp_dot(*p))).collect();
        let (lower, upper) = polygon::bounds(&turned);
        (along, upper - lower)
    });
    let least = sized.min_by(|a, b| a.1.element_product().total_cmp(&b.1.element_product()));
    let Some((mut along, size)) = least else { return Ok(upright) };
    if size.y > size.x {
        along = along.perp();
    }
    if along.dot((upright * look.u_direction).truncate()) < 0.0 {
        along = -along;
    }
    Ok(DMat3::from_rotation_z(-along.to_angle()) * upright)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn a_tilted_flat_sheet_is_laid_flat_with_its_long_side_along_x() {
        let tilt = DMat3::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 0.9);
        let sheet = shapes::sheet(shapes::rectangle(120.0, 260.0), |p| tilt * p.extend(7.0));
        let pose = find_pose(&sheet, &PoseChoice::Found, 50.0).unwrap();
        assert!((pose.least_draft_deg - 90.0).abs() < 1e-5 && pose.undercuts.is_empty());
        let corner = |u: f64, v: f64| pose.mold_from_sheet.point(sheet.spline.at(DVec2::new(u, v)).position);
        let corners = [corner(-60., -130.), corner(60., 130.), corner(-60., 130.), corner(60., -130.)];
        let upper = corners.into_iter().fold(DVec3::ZERO, DVec3::max);
        assert!(upper.distance(DVec3::new(260.0, 120.0, 50.0)) < 1e-6, "{upper}");
        assert!(corners.iter().all(|c| c.min_element() > -1e-6));
    }

    #[test]
    fn half_a_turn_of_a_cylinder_has_its_draft() {
        // 100° of arc: normals fan out by 50° to each side.
        let width = 100f64.to_radians() * shapes::CYLINDER_RADIUS_MM;
        let pose =
            find_pose(&shapes::cylinder(shapes::rectangle(width, 90.0)), &PoseChoice::Found, 50.0).unwrap();
        assert!((pose.least_draft_deg - 40.0).abs() < 0.05, "{}", pose.least_draft_deg);
        assert!(pose.undercuts.is_empty());
    }

    #[test]
    fn a_cylinder_past_the_vertical_has_two_undercuts() {
        let width = 220f64.to_radians() * shapes::CYLINDER_RADIUS_MM;
        let sheet = shapes::cylinder(shapes::rectangle(width, 90.0));
        let pose = find_pose(&sheet, &PoseChoice::Rotation(DMat3::IDENTITY), 50.0).unwrap();
        assert_eq!(pose.undercuts.len(), 2);
        assert!((pose.least_draft_deg + 20.0).abs() < 0.1);
        let strip = 20f64.to_radians() * shapes::CYLINDER_RADIUS_MM * 90.0;
        for u in &pose.undercuts {
            assert!((u.area_mm2 / strip - 1.0).abs() < 0.1, "{u:?}");
            assert!((u.at.x.abs() - 0.5 * width).abs() < 3.0);
        }
    }

    #[test]
    fn the_lowest_point_of_the_mold_is_on_the_ground() {
        let sheet = shapes::corrugation(shapes::ellipse(200.0, 120.0));
        let pose = find_pose(&sheet, &PoseChoice::Rotation(DMat3::IDENTITY), 50.0).unwrap();
        let lowest = sheet.spline.at(DVec2::new(-75.0, 0.0)).position;
        assert!((pose.mold_from_sheet.point(lowest).z - 50.0).abs() < 0.1);
    }
}
