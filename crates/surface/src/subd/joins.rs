//! How smooth the surface is where faces meet.

use super::sew::{EdgeUse, Polysurface, SharedEdge};
use glam::DVec2;

/// Places along an edge where normals are compared; the ends are corners of several faces and left to those.
const SAMPLES: usize = 6;
/// Angle that counts as smooth, rad: 0.1°.
const SMOOTH_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// Angle between the faces at an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoinAngle {
    /// Largest along the edge, rad.
    pub angle_rad: f64,
    /// Where, (u, v) in mm.
    pub at: DVec2,
}

/// Angles of all edges with two faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joins {
    /// The largest between faces away from irregular vertices.
    pub regular: Option<JoinAngle>,
    /// The largest at edges of patches around irregular vertices.
    pub irregular: Option<JoinAngle>,
    /// All edges above 0.1°.
    pub rough: Vec<JoinAngle>,
}

pub(crate) fn joins(surface: &Polysurface) -> Joins {
    let mut found = Joins::default();
    for edge in &surface.edges {
        let [a, b] = edge.uses[..] else { continue };
        let angle = angle(surface, edge, a, b);
        let regular = surface.faces[a.face].regular && surface.faces[b.face].regular;
        let worst = if regular { &mut found.regular } else { &mut found.irregular };
        if worst.is_none_or(|w| angle.angle_rad > w.angle_rad) {
            *worst = Some(angle);
        }
        if angle.angle_rad > SMOOTH_RAD {
            found.rough.push(angle);
        }
    }
    found
}

fn angle(surface: &Polysurface, edge: &SharedEdge, a: EdgeUse, b: EdgeUse) -> JoinAngle {
    let at = |k: usize| {
        let s = edge.length * (k as f64 + 0.5) / SAMPLES as f64;
        let seen = |u: EdgeUse| {
            let p = u.start + s * u.direction;
            let (_, [du, dv], flat) = surface.faces[u.face].at(p.x, p.y);
            (du.cross(dv).normalize_or_zero(), flat)
        };
        let ((m, flat), (n, _)) = (seen(a), seen(b));
        JoinAngle { angle_rad: m.cross(n).length().atan2(m.dot(n)), at: flat }
    };
    (0..SAMPLES).map(at).fold(at(0), |w, j| if j.angle_rad > w.angle_rad { j } else { w })
}
