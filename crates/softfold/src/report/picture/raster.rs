//! The z-buffer: triangles with smooth shading, lines with a width.

use super::camera::{Camera, Projected};
use super::{Colours, SceneLine, SceneMesh};
use softfold_geometry::DVec3;

/// Triangles that meet at a flatter angle than this (35°) share their shading; steeper edges stay sharp.
const SMOOTH_COS: f64 = 0.82;
/// Light: where it stands, in the picture's axes (right, up, towards the onlooker).
const LIGHT: [f64; 3] = [-0.45, 0.65, 0.61];
/// Brightness of a surface that turns away from the light, and what full light adds. The range is narrow,
/// so colours that stand for figures can still be read off the legend.
const AMBIENT: f64 = 0.68;
const DIFFUSE: f64 = 0.35;
/// Brightness of the sheet's underside.
const UNDERSIDE: f64 = 0.90;
/// Lines lie this share of the scene nearer than they are, so that the surface under them does not hide them.
const LINE_LIFT: f64 = 0.004;

/// Colours and nearness of the pixels.
pub(super) struct Canvas {
    pub(super) size: [usize; 2],
    colours: Vec<[u8; 3]>,
    near: Vec<f32>,
}

/// A corner ready to be drawn.
#[derive(Clone, Copy)]
struct Corner {
    at: Projected,
    colour: [f64; 3],
}

impl Canvas {
    pub(super) fn new(size: [usize; 2], paper: [u8; 3]) -> Self {
        let count = size[0] * size[1];
        Self { size, colours: vec![paper; count], near: vec![f32::NEG_INFINITY; count] }
    }

    /// Whether something was drawn at a pixel.
    pub(super) fn covered(&self, index: usize) -> bool {
        self.near[index] > f32::NEG_INFINITY
    }

    /// Mixes a colour over a pixel.
    pub(super) fn mix(&mut self, index: usize, colour: [f64; 3], share: f64) {
        let old = self.colours[index];
        self.colours[index] = [0, 1, 2].map(|k| {
            let mixed = f64::from(old[k]) * (1.0 - share) + colour[k] * share;
            mixed.round().clamp(0.0, 255.0) as u8
        });
    }

    /// The picture with `n`×`n` pixels averaged into one, as RGB bytes.
    pub(super) fn reduced(&self, n: usize) -> Vec<u8> {
        let [w, h] = self.size.map(|s| s / n);
        let mut out = Vec::with_capacity(w * h * 3);
        for y in 0..h {
            for x in 0..w {
                out.extend(self.average(x * n, y * n, n));
            }
        }
        out
    }

    fn average(&self, x: usize, y: usize, n: usize) -> [u8; 3] {
        let mut sums = [0_u32; 3];
        for row in y..y + n {
            for pixel in &self.colours[row * self.size[0] + x..][..n] {
                (0..3).for_each(|k| sums[k] += u32::from(pixel[k]));
            }
        }
        let count = (n * n) as u32;
        sums.map(|s| ((s + count / 2) / count) as u8)
    }

    /// Pixels from `lo` to `hi`, cut to the canvas; none if they lie outside.
    fn span(&self, axis: usize, lo: f64, hi: f64) -> std::ops::Range<usize> {
        let end = self.size[axis] as f64;
        lo.floor().clamp(0.0, end) as usize..(hi.ceil() + 1.0).clamp(0.0, end) as usize
    }
}

/// Draws a mesh, shaded.
pub(super) fn draw_mesh(canvas: &mut Canvas, camera: &Camera, mesh: &SceneMesh) {
    let [l, u, t] = LIGHT;
    let light = (camera.right * l + camera.up * u + camera.towards * t).normalize_or_zero();
    let projected: Vec<_> = mesh.positions.iter().map(|&p| camera.project(p)).collect();
    let faces = face_normals(mesh);
    let around = faces_around(mesh);
    for (f, corners) in mesh.triangles.iter().enumerate() {
        let drawn = corners.map(|v| {
            let normal = corner_normal(&faces, &around[v as usize], f);
            let brightness = brightness(normal, camera.towards, light);
            let colour = colour_of(mesh, v).map(|c| f64::from(c) * brightness);
            Corner { at: projected[v as usize], colour }
        });
        draw_triangle(canvas, &drawn);
    }
}

fn colour_of(mesh: &SceneMesh, vertex: u32) -> [u8; 3] {
    match &mesh.colours {
        Colours::Uniform(c) => *c,
        Colours::PerVertex(all) => all.get(vertex as usize).copied().unwrap_or(super::PLAIN),
    }
}

/// Normals of the triangles, as long as their double area.
fn face_normals(mesh: &SceneMesh) -> Vec<DVec3> {
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a)
    };
    mesh.triangles.iter().map(normal).collect()
}

/// Triangles at each vertex.
fn faces_around(mesh: &SceneMesh) -> Vec<Vec<u32>> {
    let mut around = vec![Vec::new(); mesh.positions.len()];
    for (f, corners) in mesh.triangles.iter().enumerate() {
        corners.iter().for_each(|&v| around[v as usize].push(f as u32));
    }
    around
}

/// Mean of the normals around a vertex that are not far from this face's own.
fn corner_normal(faces: &[DVec3], around: &[u32], face: usize) -> DVec3 {
    let own = faces[face].normalize_or_zero();
    let near = |n: &DVec3| n.dot(own) >= SMOOTH_COS * n.length();
    around.iter().map(|&f| faces[f as usize]).filter(near).sum::<DVec3>().normalize_or_zero()
}

fn brightness(normal: DVec3, towards: DVec3, light: DVec3) -> f64 {
    let front = normal.dot(towards) >= 0.0;
    let seen = if front { normal } else { -normal };
    let side = if front { 1.0 } else { UNDERSIDE };
    side * (AMBIENT + DIFFUSE * seen.dot(light).max(0.0))
}

/// Fills a triangle: barycentric weights at pixel centres.
fn draw_triangle(canvas: &mut Canvas, [a, b, c]: &[Corner; 3]) {
    let (pa, pb, pc) = (a.at, b.at, c.at);
    let area = (pb.x - pa.x) * (pc.y - pa.y) - (pc.x - pa.x) * (pb.y - pa.y);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let rows = canvas.span(1, pa.y.min(pb.y).min(pc.y), pa.y.max(pb.y).max(pc.y));
    let columns = canvas.span(0, pa.x.min(pb.x).min(pc.x), pa.x.max(pb.x).max(pc.x));
    for row in rows {
        let y = row as f64 + 0.5;
        for column in columns.clone() {
            let x = column as f64 + 0.5;
            let wb = ((x - pa.x) * (pc.y - pa.y) - (pc.x - pa.x) * (y - pa.y)) / area;
            let wc = ((pb.x - pa.x) * (y - pa.y) - (x - pa.x) * (pb.y - pa.y)) / area;
            let wa = 1.0 - wb - wc;
            if wa < 0.0 || wb < 0.0 || wc < 0.0 {
                continue;
            }
            let near = (wa * pa.near + wb * pb.near + wc * pc.near) as f32;
            let index = row * canvas.size[0] + column;
            if near > canvas.near[index] {
                canvas.near[index] = near;
                canvas.colours[index] = [0, 1, 2].map(|k| {
                    (wa * a.colour[k] + wb * b.colour[k] + wc * c.colour[k]).round().clamp(0.0, 255.0) as u8
                });
            }
        }
    }
}

/// Draws a polyline; `scale` is the supersampling that its width is multiplied with.
pub(super) fn draw_line(canvas: &mut Canvas, camera: &Camera, line: &SceneLine, scale: f64) {
    let lift = LINE_LIFT * camera.extent_mm();
    let points: Vec<_> = line.points.iter().map(|&p| camera.project(p)).collect();
    for pair in points.windows(2) {
        draw_segment(canvas, [pair[0], pair[1]], 0.5 * line.width_px * scale, lift, line.colour);
    }
}

fn draw_segment(canvas: &mut Canvas, [a, b]: [Projected; 2], half: f64, lift: f64, colour: [u8; 3]) {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let length_squared = dx * dx + dy * dy;
    for row in canvas.span(1, a.y.min(b.y) - half, a.y.max(b.y) + half) {
        for column in canvas.span(0, a.x.min(b.x) - half, a.x.max(b.x) + half) {
            let (x, y) = (column as f64 + 0.5 - a.x, row as f64 + 0.5 - a.y);
            let t =
                if length_squared > 0.0 { ((x * dx + y * dy) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
            let (ex, ey) = (x - t * dx, y - t * dy);
            let near = a.near + t * (b.near - a.near) + lift;
            let index = row * canvas.size[0] + column;
            if ex * ex + ey * ey <= half * half && near as f32 > canvas.near[index] {
                canvas.colours[index] = colour;
            }
        }
    }
}
