//! The ground: a shadow that is darker where the object is close, and a grid that fades away.

use super::Scene;
use super::camera::Camera;
use super::raster::Canvas;
use softfold_geometry::{DVec2, DVec3};

/// Cells of the shadow map along its longer side.
const MAP_CELLS: usize = 256;
/// The shadow map reaches this share of the object's size beyond it.
const MAP_BORDER: f64 = 0.25;
/// Passes and radius (in cells) of the blur; three box blurs look like a Gaussian.
const BLUR_PASSES: usize = 3;
const BLUR_CELLS: usize = 5;
/// Darkness straight under the object where it touches, and the share of the object's size over which it halves.
const SHADOW: f64 = 0.42;
const SHADOW_HEIGHT: f64 = 0.25;
const SHADOW_COLOUR: [f64; 3] = [46.0, 50.0, 62.0];
/// Spacing of the grid, mm; a scale for the eye, named in captions.
pub(crate) const GRID_MM: f64 = 100.0;
/// Half the width of a grid line, pixels of the canvas.
const GRID_HALF_PX: f64 = 1.0;
const GRID: f64 = 0.16;
const GRID_COLOUR: [f64; 3] = [90.0, 96.0, 110.0];
/// Grid lines closer than this on the canvas are left away, pixels.
const GRID_LEAST_PX: f64 = 8.0;

/// How dark the ground is, over a rectangle of it.
struct ShadowMap {
    lo: DVec2,
    cell_mm: f64,
    count: [usize; 2],
    dark: Vec<f64>,
    /// Centre and radius of the object's footprint.
    centre: DVec2,
    reach_mm: f64,
}

/// Draws the ground where nothing else is.
pub(super) fn draw(canvas: &mut Canvas, camera: &Camera, scene: &Scene, height_mm: f64) {
    let Some(map) = ShadowMap::new(scene, height_mm) else { return };
    let [width, height] = canvas.size;
    let grid = GRID_MM * camera.scale * camera.towards.z >= GRID_LEAST_PX;
    for row in 0..height {
        for column in 0..width {
            let index = row * width + column;
            if canvas.covered(index) {
                continue;
            }
            let Some(p) = camera.on_plane(column as f64 + 0.5, row as f64 + 0.5, height_mm) else { return };
            let p = p.truncate();
            let fade = map.fade(p);
            if fade <= 0.0 {
                continue;
            }
            if grid {
                canvas.mix(index, GRID_COLOUR, GRID * fade * grid_line(p, camera));
            }
            canvas.mix(index, SHADOW_COLOUR, SHADOW * map.at(p));
        }
    }
}

/// 1 on a line of the grid, 0 away from it. Lines keep their width on the picture.
fn grid_line(p: DVec2, camera: &Camera) -> f64 {
    let along = |k: usize| {
        // Pixels per millimetre across a line of constant coordinate k.
        let axis = if k == 0 { DVec3::X } else { DVec3::Y };
        let other = if k == 0 { DVec3::Y } else { DVec3::X };
        let on_canvas = |d: DVec3| DVec2::new(d.dot(camera.right), d.dot(camera.up));
        let across = on_canvas(axis).perp_dot(on_canvas(other).normalize_or_zero()).abs() * camera.scale;
        let distance = (p[k] / GRID_MM - (p[k] / GRID_MM).round()).abs() * GRID_MM * across;
        (GRID_HALF_PX + 0.5 - distance).clamp(0.0, 1.0)
    };
    along(0).max(along(1))
}

impl ShadowMap {
    fn new(scene: &Scene, ground_mm: f64) -> Option<Self> {
        let points: Vec<_> = scene.meshes.iter().flat_map(|m| &m.positions).map(|p| p.truncate()).collect();
        if points.is_empty() {
            return None;
        }
        let (lo, hi) = softfold_geometry::polygon::bounds(&points);
        let size = (hi - lo).max_element().max(1e-9);
        let (lo, hi) = (lo - size * MAP_BORDER, hi + size * MAP_BORDER);
        let cell_mm = (hi - lo).max_element() / MAP_CELLS as f64;
        let count = [0, 1].map(|k| ((hi - lo)[k] / cell_mm).ceil() as usize + 1);
        let dark = vec![0.0; count[0] * count[1]];
        let mut map = Self { lo, cell_mm, count, dark, centre: 0.5 * (lo + hi), reach_mm: 0.9 * size };
        map.cast(scene, ground_mm, SHADOW_HEIGHT * size);
        (0..BLUR_PASSES).for_each(|_| map.blur());
        Some(map)
    }

    /// Marks the cells that lie under triangles; darker under lower ones.
    fn cast(&mut self, scene: &Scene, ground_mm: f64, half_height_mm: f64) {
        for mesh in &scene.meshes {
            for t in &mesh.triangles {
                let corners = t.map(|v| mesh.positions[v as usize]);
                let height = (corners.iter().map(|c| c.z).sum::<f64>() / 3.0 - ground_mm).max(0.0);
                self.fill(
                    corners.map(|c| (c.truncate() - self.lo) / self.cell_mm),
                    half_height_mm / (half_height_mm + height),
                );
            }
        }
    }

    fn fill(&mut self, [a, b, c]: [DVec2; 3], dark: f64) {
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let area = (b - a).perp_dot(c - a);
        let range =
            |k: usize| lo[k].floor().max(0.0) as usize..(hi[k].ceil() as usize + 1).min(self.count[k]);
        let columns = range(0);
        for j in range(1) {
            for i in columns.clone() {
                let p = DVec2::new(i as f64, j as f64);
                let inside = |a: DVec2, b: DVec2| (b - a).perp_dot(p - a) * area >= 0.0;
                if inside(a, b) && inside(b, c) && inside(c, a) {
                    let cell = &mut self.dark[j * self.count[0] + i];
                    *cell = cell.max(dark);
                }
            }
        }
    }

    fn blur(&mut self) {
        let [w, h] = self.count;
        for j in 0..h {
            blur_line(&mut self.dark, j * w, 1, w);
        }
        for i in 0..w {
            blur_line(&mut self.dark, i, w, h);
        }
    }

    /// Darkness at a point of the ground, between cells linear.
    fn at(&self, p: DVec2) -> f64 {
        let q = (p - self.lo) / self.cell_mm;
        let (i, j) = (q.x.floor(), q.y.floor());
        let cell = |di: f64, dj: f64| {
            let (i, j) = (i + di, j + dj);
            let inside = i >= 0.0 && j >= 0.0 && i < self.count[0] as f64 && j < self.count[1] as f64;
            if inside { self.dark[j as usize * self.count[0] + i as usize] } else { 0.0 }
        };
        let (s, t) = (q.x - i, q.y - j);
        (cell(0., 0.) * (1.0 - s) + cell(1., 0.) * s) * (1.0 - t)
            + (cell(0., 1.) * (1.0 - s) + cell(1., 1.) * s) * t
    }

    /// 1 near the object, 0 far away.
    fn fade(&self, p: DVec2) -> f64 {
        let share = p.distance(self.centre) / self.reach_mm;
        let t = (1.5 - share).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// Box blur of every `step`-th value from `start`, `count` of them.
fn blur_line(values: &mut [f64], start: usize, step: usize, count: usize) {
    let line: Vec<f64> = (0..count).map(|k| values[start + k * step]).collect();
    let width = (2 * BLUR_CELLS + 1) as f64;
    let at = |k: isize| if k >= 0 && (k as usize) < count { line[k as usize] } else { 0.0 };
    let mut sum: f64 = (0..BLUR_CELLS as isize).map(at).sum();
    for k in 0..count {
        sum += at((k + BLUR_CELLS) as isize) - at(k as isize - BLUR_CELLS as isize - 1);
        values[start + k * step] = (sum / width).max(0.0);
    }
}
