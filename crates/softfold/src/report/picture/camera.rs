//! Orthographic camera that fits the scene into the picture.

use super::{Scene, View};
use softfold_geometry::DVec3;

/// Share of the picture left free on each side.
pub(super) const MARGIN: f64 = 0.05;

/// A point on the canvas: pixels from the upper left, and nearness to the onlooker, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) near: f64,
}

/// Axes of the picture and its scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    pub(super) right: DVec3,
    pub(super) up: DVec3,
    /// Towards the onlooker.
    pub(super) towards: DVec3,
    /// Pixels a millimetre.
    pub(super) scale: f64,
    /// Canvas position of the space's origin.
    offset: [f64; 2],
    /// Width and height of what is seen, mm.
    pub(super) seen_mm: [f64; 2],
}

impl Camera {
    pub(super) fn fit(scene: &Scene, view: &View, size: [usize; 2]) -> Self {
        let (sin_az, cos_az) = view.azimuth_deg.to_radians().sin_cos();
        let (sin_el, cos_el) = view.elevation_deg.to_radians().sin_cos();
        let right = DVec3::new(cos_az, sin_az, 0.0);
        let towards = DVec3::new(sin_az * cos_el, -cos_az * cos_el, sin_el);
        let mut camera = Self {
            right,
            up: towards.cross(right),
            towards,
            scale: 1.0,
            offset: [0.0; 2],
            seen_mm: [1.0; 2],
        };
        camera.frame(scene, size.map(|s| s as f64));
        camera
    }

    /// Chooses scale and offset.
    fn frame(&mut self, scene: &Scene, size: [f64; 2]) {
        let points =
            scene.meshes.iter().flat_map(|m| &m.positions).chain(scene.lines.iter().flat_map(|l| &l.points));
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in points {
            for (k, c) in [p.dot(self.right), p.dot(self.up)].into_iter().enumerate() {
                (lo[k], hi[k]) = (lo[k].min(c), hi[k].max(c));
            }
        }
        if lo[0] > hi[0] {
            return;
        }
        let seen = [hi[0] - lo[0], hi[1] - lo[1]].map(|s| s.max(1e-9));
        let room = 1.0 - 2.0 * MARGIN;
        self.scale = (size[0] * room / seen[0]).min(size[1] * room / seen[1]);
        self.seen_mm = seen;
        self.offset = [
            0.5 * size[0] - self.scale * 0.5 * (lo[0] + hi[0]),
            0.5 * size[1] + self.scale * 0.5 * (lo[1] + hi[1]),
        ];
    }

    /// The larger side of what is seen, mm.
    pub(super) fn extent_mm(&self) -> f64 {
        self.seen_mm[0].max(self.seen_mm[1])
    }

    pub(super) fn project(&self, p: DVec3) -> Projected {
        Projected {
            x: self.offset[0] + self.scale * p.dot(self.right),
            y: self.offset[1] - self.scale * p.dot(self.up),
            near: p.dot(self.towards),
        }
    }

    /// The point of the plane z = `height_mm` that is seen at a pixel; none if the camera looks along it.
    pub(super) fn on_plane(&self, x: f64, y: f64, height_mm: f64) -> Option<DVec3> {
        /// Looking flatter than this, the ground is a line.
        const LEAST_SLOPE: f64 = 0.02;
        if self.towards.z < LEAST_SLOPE {
            return None;
        }
        let across = (x - self.offset[0]) / self.scale;
        let above = (self.offset[1] - y) / self.scale;
        let p = self.right * across + self.up * above;
        Some(p + self.towards * ((height_mm - p.z) / self.towards.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_of_the_ground_comes_back() {
        let positions = vec![DVec3::ZERO, DVec3::new(300., 100., 50.), DVec3::new(-20., 400., 10.)];
        let mesh = super::super::SceneMesh {
            positions,
            triangles: vec![[0, 1, 2]],
            colours: super::super::Colours::Uniform([0; 3]),
        };
        let scene = Scene { meshes: vec![mesh], ..Scene::default() };
        let camera = Camera::fit(&scene, &View::new("v", 35.0, 28.0), [400, 300]);
        let p = DVec3::new(40.0, 77.0, -5.0);
        let seen = camera.project(p);
        assert!(camera.on_plane(seen.x, seen.y, -5.0).unwrap().distance(p) < 1e-9);
    }
}
