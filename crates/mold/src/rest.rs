//! How a body rests when it is put down: it tips from its pose onto the face of its convex hull below its barycenter.

use crate::board::Board;
use crate::error::{MoldError, Setting};
use crate::stability::{Stability, stability};
use glam::{DMat3, DQuat, DVec2, DVec3};
use softfold_geometry::RigidTransform;

/// A body that tips farther than this from its pose, degrees, does not rest in it: it falls over.
const LARGEST_TILT_DEG: f64 = 5.0;
/// Faces onto which a body may tip one after the other.
const MOST_FACES: usize = 64;
/// Exchanges of a support point in the search of one face; each lowers the plane, so they end by themselves but for
/// rounding.
const MOST_EXCHANGES: usize = 100_000;
/// Points below the plane by less than this share of the body's size lie on it: rounding.
const ON_PLANE: f64 = 1e-12;
/// Points above the lowest by no more than this share of the body's size are in one plane with it once the body is
/// turned: rounding of the face's normal, where its corners are near to a line.
const COPLANAR: f64 = 1e-9;
/// The search starts from a plane so far above the body, in sizes of the body.
const FAR: f64 = 1e6;

/// How a body rests.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// Whether it comes to rest within 5° of the given pose.
    pub rests: bool,
    /// How it stands at rest, in the given pose if it does not rest near it. What lies within the contact tolerance of
    /// the ground counts as touching it: its margin is that of a ground, or a body, that gives way by so much.
    pub stability: Stability,
    /// Distance in plan from the barycenter to the nearest edge of the face on which the body exactly rests, mm;
    /// negative outside. That face is the hull of the lowest points alone, all that lie in its plane but for rounding,
    /// so that it is never larger than the hull of `stability`.
    pub support_margin_mm: f64,
    /// By how much it tips from the given pose to its rest, degrees; if it does not rest, how far it was found tipping.
    pub tilt_deg: f64,
    /// From the given pose to the rest; nothing if it does not rest.
    pub rest_from_pose: RigidTransform,
}

/// How a board rests on the ground: both skins looked at every `step_mm`.
///
/// # Errors
/// As [`rest`] and [`Board::points`].
pub fn rest_of_board(board: &Board, step_mm: f64, contact_mm: f64) -> Result<Rest, MoldError> {
    Setting::inner("step of the contact points (mm)").positive(step_mm)?;
    rest(&board.points(step_mm)?, board.barycenter_mm, contact_mm)
}

/// How the body of these points rests on a horizontal plane, put down as it is posed. A body on three points is held by
/// the face of its convex hull below its barycenter; it tips there, and on from there if its barycenter is then past an
/// edge. If it tips by more than 5° in all, or no face is found, it does not rest and is judged as it is posed.
///
/// # Errors
/// As [`stability`].
pub fn rest(points: &[DVec3], barycenter: DVec3, contact_mm: f64) -> Result<Rest, MoldError> {
    let (turn, rests) = tipped(points, barycenter);
    let kept = if rests { turn } else { DMat3::IDENTITY };
    let points: Vec<DVec3> = points.iter().map(|p| kept * *p).collect();
    let barycenter = kept * barycenter;
    let coplanar_mm = (COPLANAR * size_mm(&points, barycenter)).max(f64::MIN_POSITIVE);
    Ok(Rest {
        rests,
        stability: stability(&points, barycenter, contact_mm)?,
        support_margin_mm: stability(&points, barycenter, coplanar_mm)?.margin_mm,
        tilt_deg: tilt_deg(turn),
        rest_from_pose: RigidTransform { rotation: kept, translation: DVec3::ZERO },
    })
}

/// The turn by which the body tips, and whether it comes to rest by it.
fn tipped(points: &[DVec3], barycenter: DVec3) -> (DMat3, bool) {
    let mut turn = DMat3::IDENTITY;
    for _ in 0..MOST_FACES {
        let turned: Vec<DVec3> = points.iter().map(|p| turn * *p).collect();
        let Some(up) = face_normal(&turned, turn * barycenter) else { return (turn, false) };
        let step = DMat3::from_quat(DQuat::from_rotation_arc(up, DVec3::Z));
        turn = step * turn;
        if tilt_deg(turn) > LARGEST_TILT_DEG {
            return (turn, false);
        }
        if up.z >= 1.0 - f64::EPSILON {
            return (turn, true);
        }
    }
    (turn, false)
}

/// The farthest point's distance from the barycenter.
fn size_mm(points: &[DVec3], barycenter: DVec3) -> f64 {
    points.iter().map(|p| p.distance(barycenter)).fold(0.0, f64::max)
}

fn tilt_deg(turn: DMat3) -> f64 {
    (turn * DVec3::Z).angle_between(DVec3::Z).to_degrees()
}

/// Upward normal of the lower face of the convex hull that a vertical line through `barycenter` meets: the highest plane
/// at the barycenter that no point lies below. A linear program in three unknowns, solved by the dual simplex method:
/// the support triangle exchanges a corner for the point farthest below its plane, and keeps the barycenter inside.
fn face_normal(points: &[DVec3], barycenter: DVec3) -> Option<DVec3> {
    let size = size_mm(points, barycenter);
    let far = |k: f64| {
        let around = DVec2::from_angle(k * std::f64::consts::TAU / 3.0) * FAR * size;
        barycenter + around.extend(FAR * FAR * size)
    };
    let mut support = [far(0.0), far(1.0), far(2.0)];
    for _ in 0..MOST_EXCHANGES {
        let normal = (support[1] - support[0]).cross(support[2] - support[0]);
        let up = (normal * normal.z.signum()).try_normalize()?;
        // Heights are told from the corner nearest to the body, so that the far ones bring no rounding.
        let base = support[1..].iter().fold(support[0], |a, &b| nearer(barycenter, a, b));
        let below = |p: &DVec3| (*p - base).dot(up);
        let lowest = points.iter().copied().min_by(|a, b| below(a).total_cmp(&below(b)))?;
        // A corner that is lower than its own plane is so by rounding, and would be exchanged by itself for ever.
        if below(&lowest) >= -ON_PLANE * size || support.contains(&lowest) {
            return Some(up);
        }
        let leaving = leaving_corner(&support, lowest, barycenter)?;
        support[leaving] = lowest;
    }
    None
}

fn nearer(to: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    if to.distance_squared(b) < to.distance_squared(a) { b } else { a }
}

/// The ratio test: the corner whose exchange keeps the barycenter's plan inside the triangle.
fn leaving_corner(support: &[DVec3; 3], entering: DVec3, barycenter: DVec3) -> Option<usize> {
    let (of_barycenter, of_entering) = (weights(support, barycenter)?, weights(support, entering)?);
    let ratio = |i: &usize| of_barycenter[*i] / of_entering[*i];
    (0..3).filter(|&i| of_entering[i] > 0.0).min_by(|a, b| ratio(a).total_cmp(&ratio(b)))
}

/// Barycentric weights in plan.
fn weights(corners: &[DVec3; 3], p: DVec3) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(|q| q.truncate());
    let p = p.truncate();
    let whole = (b - a).perp_dot(c - a);
    let part = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)];
    (whole != 0.0).then(|| part.map(|w| w / whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 200 x 100 x 300 mm on z = 0, tipped about x by an angle.
    fn tipped_box(degrees: f64) -> (Vec<DVec3>, DVec3) {
        let turn = DMat3::from_rotation_x(degrees.to_radians());
        let corner = |k: u32| {
            let sign = |bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
            turn * DVec3::new(100.0 * sign(1), 50.0 * sign(2), 150.0 + 150.0 * sign(4))
        };
        ((0..8).map(corner).collect(), turn * DVec3::new(0.0, 0.0, 150.0))
    }

    #[test]
    fn a_box_tipped_a_little_comes_to_rest_on_its_base() {
        for degrees in [-4.0, -0.3, 0.0, 1e-7, 2.0] {
            let (points, barycenter) = tipped_box(degrees);
            let rest = rest(&points, barycenter, 1e-6).unwrap();
            assert!((rest.tilt_deg - f64::abs(degrees)).abs() < 1e-6, "{degrees}: {}", rest.tilt_deg);
            assert_eq!(rest.stability.contact_points, 4, "{degrees}");
            assert!((rest.stability.margin_mm - 50.0).abs() < 1e-6);
            let tipping = (50.0_f64 / 150.0).atan().to_degrees();
            assert!((rest.stability.tipping_angle_deg - tipping).abs() < 1e-6);
        }
    }

    #[test]
    fn a_box_on_its_edge_is_judged_as_posed() {
        let (points, barycenter) = tipped_box(25.0);
        let rest = rest(&points, barycenter, 1e-6).unwrap();
        assert!(!rest.stability.stable && !rest.rests && rest.rest_from_pose == RigidTransform::IDENTITY);
        assert!((rest.tilt_deg - 65.0).abs() < 1e-6, "it falls on its side: {}", rest.tilt_deg);
        assert_eq!(rest.support_margin_mm, rest.stability.margin_mm, "an edge either way");
    }

    #[test]
    fn a_top_heavy_body_falls() {
        let (points, _) = tipped_box(0.0);
        let rest = rest(&points, DVec3::new(99.9, 60.0, 290.0), 1e-6).unwrap();
        assert!(!rest.stability.stable && !rest.rests);
    }

    #[test]
    fn the_support_is_the_exact_face_the_contact_what_is_near_it() {
        // A foot of 100 mm in a rim of 200 mm that is 0.3 mm higher.
        let square = |half: f64, z: f64| {
            [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| DVec3::new(half * x, half * y, z))
        };
        let points = [square(50.0, 0.0), square(100.0, 0.3), square(100.0, 80.0)].concat();
        for degrees in [0.0, 2e-2, 0.1] {
            let turn =
                DMat3::from_axis_angle(DVec3::new(1.0, 0.4, 0.0).normalize(), f64::to_radians(degrees));
            let turned: Vec<_> = points.iter().map(|p| turn * *p).collect();
            let rest = rest(&turned, turn * DVec3::new(10.0, 0.0, 30.0), 0.5).unwrap();
            assert!(rest.rests && rest.stability.contact_points == 8);
            assert!((rest.stability.margin_mm - 90.0).abs() < 1e-6, "{rest:?}");
            assert!((rest.support_margin_mm - 40.0).abs() < 1e-6, "{rest:?}");
        }
    }

    #[test]
    fn a_needle_of_a_face_ends_the_search() {
        // Three corners near to a line: rounding puts one of them below their own plane. This went round 100000 times
        // and found nothing.
        let (mut found, ways) = (0, 400);
        for k in 0..ways {
            let random = |i: u32| {
                let seed = (k as u32).wrapping_mul(747_796_405).wrapping_add(i.wrapping_mul(2_891_336_453));
                (f64::from(seed) * 0.618_033_988_749).fract() - 0.5
            };
            let along = 2000.0 * DVec3::new(random(1), random(2), 0.03 * random(3));
            let side = 1e-6 * along.cross(DVec3::Z).normalize();
            let at = 1000.0 * DVec3::new(random(4), random(5), random(6));
            let lower =
                [at - along, at + along, at + side + random(7) * along, at - side + random(8) * along];
            let upper = [at + 300.0 * DVec3::Z, at + 0.5 * random(9) * along + 300.0 * DVec3::Z];
            let barycenter = at + 0.1 * random(10) * side + 100.0 * DVec3::Z;
            found += usize::from(face_normal(&[&lower[..], &upper].concat(), barycenter).is_some());
        }
        assert_eq!(found, ways);
    }

    #[test]
    fn a_stool_with_one_short_leg_rests_on_three() {
        let mut points = vec![];
        for (x, y, z) in [(-1., -1., 0.), (1., -1., 0.), (1., 1., 0.), (-1., 1., 2.)] {
            points.extend([DVec3::new(100.0 * x, 100.0 * y, z), DVec3::new(100.0 * x, 100.0 * y, 400.0)]);
        }
        // The barycenter is nearer to the three even legs.
        let rest = rest(&points, DVec3::new(20.0, -20.0, 200.0), 0.5).unwrap();
        assert_eq!(rest.stability.contact_points, 3);
        assert!(rest.stability.stable && rest.tilt_deg < 1e-9);
        // Nearer to the short one it tips over to that.
        let other = super::rest(&points, DVec3::new(-20.0, 20.0, 200.0), 0.5).unwrap();
        assert!(rest.support_margin_mm > 0.0 && other.support_margin_mm > 0.0);
        assert!(other.stability.stable && other.tilt_deg > 0.1 && other.tilt_deg < 1.0, "{other:?}");
    }
}
