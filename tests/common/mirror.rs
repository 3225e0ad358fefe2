//! Closed forms of curved folds: a cylinder or a cone, cut by a plane and one part of it mirrored.
//!
//! What is mirrored meets the rest in a planar crease; rulings go straight on across it in the flat sheet, and both sides
//! keep the surface's curvature (Fuchs & Tabachnikov 1999; the reflection construction of Mitani).

#![allow(dead_code, reason = "each test binary uses its part")]

use softfold_geometry::{DVec2, DVec3};

/// A developable surface by ruling and place on it, cut by the plane through `origin` with unit `normal`.
pub(crate) struct Mirror {
    pub(crate) name: &'static str,
    pub(crate) surface: Surface,
    pub(crate) origin: DVec3,
    pub(crate) normal: DVec3,
    /// First and last ruling: mm across the cylinder, angle of the flat cone.
    pub(crate) rulings: [f64; 2],
    /// How far the sheet reaches to both sides of the crease along the rulings, mm.
    pub(crate) reach_mm: [f64; 2],
}

pub(crate) enum Surface {
    /// Axis z.
    Cylinder { radius_mm: f64 },
    /// Axis z, apex at the origin.
    Cone { half_angle_rad: f64 },
}

impl Surface {
    /// Of a ruling: where on it, in space, the place 0 lies, and its direction.
    pub(crate) fn ruling(&self, r: f64) -> [DVec3; 2] {
        match *self {
            Surface::Cylinder { radius_mm } => {
                let (s, c) = (r / radius_mm).sin_cos();
                [radius_mm * DVec3::new(c, s, 0.0), DVec3::Z]
            }
            Surface::Cone { half_angle_rad } => {
                let (sw, cw) = half_angle_rad.sin_cos();
                let (s, c) = (r / sw).sin_cos();
                [DVec3::ZERO, DVec3::new(sw * c, sw * s, cw)]
            }
        }
    }

    pub(crate) fn flat(&self, r: f64, along: f64) -> DVec2 {
        match *self {
            Surface::Cylinder { .. } => DVec2::new(r, along),
            Surface::Cone { .. } => along * DVec2::from_angle(r),
        }
    }

    /// Ruling and place on it of a point of the flat sheet.
    pub(crate) fn unrolled(&self, p: DVec2) -> [f64; 2] {
        match *self {
            Surface::Cylinder { .. } => [p.x, p.y],
            Surface::Cone { .. } => [p.to_angle(), p.length()],
        }
    }

    pub(crate) fn normal(&self, r: f64) -> DVec3 {
        match *self {
            Surface::Cylinder { radius_mm } => DVec3::new((r / radius_mm).cos(), (r / radius_mm).sin(), 0.0),
            Surface::Cone { half_angle_rad } => {
                let (sw, cw) = half_angle_rad.sin_cos();
                DVec3::new(cw * (r / sw).cos(), cw * (r / sw).sin(), -sw)
            }
        }
    }

    /// How far the surface turns between two rulings, rad.
    pub(crate) fn turn_rad(&self, between: f64) -> f64 {
        match *self {
            Surface::Cylinder { radius_mm } => between / radius_mm,
            Surface::Cone { half_angle_rad } => between / half_angle_rad.tan(),
        }
    }
}

impl Mirror {
    /// Place along a ruling where the plane cuts it, mm.
    pub(crate) fn crease(&self, r: f64) -> f64 {
        let [start, direction] = self.surface.ruling(r);
        (self.origin - start).dot(self.normal) / direction.dot(self.normal)
    }

    pub(crate) fn place(&self, r: f64, along: f64) -> DVec3 {
        let [start, direction] = self.surface.ruling(r);
        let p = start + along * direction;
        match along > self.crease(r) {
            true => p - 2.0 * (p - self.origin).dot(self.normal) * self.normal,
            false => p,
        }
    }

    /// Half the fold angle: between the plane and the surface.
    pub(crate) fn half_angle_rad(&self, r: f64) -> f64 {
        self.surface.normal(r).dot(self.normal).abs().acos()
    }

    pub(crate) fn ruling(&self, share: f64) -> f64 {
        self.rulings[0] + share * (self.rulings[1] - self.rulings[0])
    }
}

/// A cylinder and two cones.
pub(crate) fn mirrors() -> [Mirror; 3] {
    let slope = 2.0_f64;
    let tilt = DVec3::new(0.25, 0.0, 1.0).normalize();
    let half_angle_rad = 50f64.to_radians();
    [
        Mirror {
            name: "cylinder, sine crease",
            surface: Surface::Cylinder { radius_mm: 100.0 },
            origin: DVec3::ZERO,
            normal: DVec3::new(-slope, 0.0, 1.0).normalize(),
            rulings: [-70.0, 60.0],
            reach_mm: [50.0, 60.0],
        },
        Mirror {
            name: "cone, arc crease",
            surface: Surface::Cone { half_angle_rad },
            origin: DVec3::Z * 100.0,
            normal: DVec3::Z,
            rulings: [0.0, 1.4],
            reach_mm: [50.0, 60.0],
        },
        Mirror {
            name: "cone, tilted plane",
            surface: Surface::Cone { half_angle_rad },
            origin: DVec3::Z * 100.0,
            normal: tilt,
            rulings: [-0.6, 0.8],
            reach_mm: [40.0, 50.0],
        },
    ]
}
