//! Shaded pictures of sheets and solids: an orthographic z-buffer, twice supersampled, as PNG.

mod camera;
mod colour;
mod ground;
mod raster;

pub use colour::{Legend, Scale};

use crate::export::ExportError;
use camera::Camera;
use raster::Canvas;
use softfold_geometry::DVec3;

/// Pixels that make one pixel of the picture, each way.
const SUPERSAMPLING: usize = 2;
/// Paper behind everything.
pub(crate) const PAPER: [u8; 3] = [252, 252, 250];
/// Colour of things that show no figure: bare plaster.
pub const PLAIN: [u8; 3] = [222, 214, 200];
/// Colour of outlines and fold lines.
pub const INK: [u8; 3] = [40, 42, 48];

/// Colours of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Colours {
    /// One for all.
    Uniform([u8; 3]),
    /// One a vertex; as many as positions.
    PerVertex(Vec<[u8; 3]>),
}

/// A mesh of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMesh {
    /// Vertex positions, mm; z is up.
    pub positions: Vec<DVec3>,
    /// Corner indices; both sides are shown.
    pub triangles: Vec<[u32; 3]>,
    /// Its colours.
    pub colours: Colours,
}

/// A polyline of the scene, hidden where something lies before it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLine {
    /// Its points, mm.
    pub points: Vec<DVec3>,
    /// Its colour.
    pub colour: [u8; 3],
    /// Its width on the picture, px.
    pub width_px: f64,
}

/// What is shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Surfaces.
    pub meshes: Vec<SceneMesh>,
    /// Lines on them.
    pub lines: Vec<SceneLine>,
    /// Height of the ground, mm; with it come a grid of 100 mm and a shadow.
    pub ground_mm: Option<f64>,
}

/// From where it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Where the onlooker stands, degrees: 0 in front (at −y), 90 at the right (at +x), 180 behind.
    pub azimuth_deg: f64,
    /// How far above the horizon, degrees; 90 looks straight down with y up.
    pub elevation_deg: f64,
    /// Name of the view, for captions.
    pub name: String,
}

impl View {
    /// A view.
    pub fn new(name: impl Into<String>, azimuth_deg: f64, elevation_deg: f64) -> Self {
        Self { azimuth_deg, elevation_deg, name: name.into() }
    }

    /// The four views of the report.
    pub fn standard() -> Vec<Self> {
        vec![
            Self::new("from the front", 0.0, 12.0),
            Self::new("from the front left", 310.0, 20.0),
            Self::new("from the back right", 150.0, 20.0),
            Self::new("from above", 0.0, 90.0),
        ]
    }
}

/// The scene as PNG, `size` pixels wide and high. The scene fills the picture.
///
/// # Errors
/// A picture without pixels.
pub fn render(scene: &Scene, view: &View, size: [u32; 2]) -> Result<Vec<u8>, ExportError> {
    let fine = size.map(|s| s as usize * SUPERSAMPLING);
    let camera = Camera::fit(scene, view, fine);
    let mut canvas = Canvas::new(fine, PAPER);
    for mesh in &scene.meshes {
        raster::draw_mesh(&mut canvas, &camera, mesh);
    }
    if let Some(height_mm) = scene.ground_mm {
        ground::draw(&mut canvas, &camera, scene, height_mm);
    }
    for line in &scene.lines {
        raster::draw_line(&mut canvas, &camera, line, SUPERSAMPLING as f64);
    }
    encode(&canvas.reduced(SUPERSAMPLING), size)
}

/// The picture size for a scene: `width` pixels wide, and as high as the scene asks for within `heights`.
pub fn fitting_size(
    scene: &Scene,
    view: &View,
    width: u32,
    heights: std::ops::RangeInclusive<u32>,
) -> [u32; 2] {
    let [seen_wide, seen_high] = Camera::fit(scene, view, [1, 1]).seen_mm;
    let height = f64::from(width) * (seen_high / seen_wide);
    [width, (height.round() as u32).clamp(*heights.start(), *heights.end())]
}

fn encode(pixels: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u8>, ExportError> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(z: f64, scale: f64, colour: [u8; 3]) -> SceneMesh {
        let positions =
            [(-1., -1.), (1., -1.), (0., 1.)].map(|(x, y)| DVec3::new(x * scale, y * scale, z)).to_vec();
        SceneMesh { positions, triangles: vec![[0, 1, 2]], colours: Colours::Uniform(colour) }
    }

    fn above() -> View {
        View::new("above", 0.0, 90.0)
    }

    fn pixels(png: &[u8]) -> Vec<[u8; 3]> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut buffer).unwrap();
        buffer.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
    }

    fn red([r, g, b]: [u8; 3]) -> bool {
        r > 120 && g < 60 && b < 60
    }

    #[test]
    fn a_red_triangle_covers_its_pixels() {
        let scene = Scene { meshes: vec![triangle(0.0, 1.0, [255, 0, 0])], ..Scene::default() };
        let p = pixels(&render(&scene, &above(), [100, 100]).unwrap());
        assert!(red(p[50 * 100 + 50]), "centre");
        assert!(red(p[90 * 100 + 10]), "lower left corner");
        assert_eq!(p[10 * 100 + 10], PAPER, "upper left corner");
        let share = p.iter().filter(|c| red(**c)).count() as f64 / p.len() as f64;
        // Half the square that fills the picture but its margin.
        let side = 1.0 - 2.0 * camera::MARGIN;
        assert!((share - 0.5 * side * side).abs() < 0.02, "{share}");
    }

    #[test]
    fn what_is_higher_hides_what_is_lower() {
        for order in [[0, 1], [1, 0]] {
            let two = [triangle(0.0, 1.0, [0, 0, 255]), triangle(0.5, 0.5, [255, 0, 0])];
            let scene = Scene { meshes: order.map(|i| two[i].clone()).to_vec(), ..Scene::default() };
            let p = pixels(&render(&scene, &above(), [80, 80]).unwrap());
            assert!(red(p[42 * 80 + 40]), "{order:?}");
            let seen_from_below = View::new("below", 0.0, -90.0);
            let p = pixels(&render(&scene, &seen_from_below, [80, 80]).unwrap());
            assert!(!red(p[40 * 80 + 40]), "{order:?}");
        }
    }

    #[test]
    fn a_line_behind_a_surface_is_hidden() {
        let line = |z: f64| SceneLine {
            points: vec![DVec3::new(0.0, -0.8, z), DVec3::new(0.0, 0.5, z)],
            colour: [0, 0, 0],
            width_px: 3.0,
        };
        let dark = |z: f64| {
            let scene =
                Scene { meshes: vec![triangle(0.0, 1.0, [255; 3])], lines: vec![line(z)], ground_mm: None };
            pixels(&render(&scene, &above(), [60, 60]).unwrap()).iter().filter(|p| p[0] < 40).count()
        };
        assert_eq!(dark(-0.5), 0);
        assert!(dark(0.0) > 60 && dark(0.5) > 60);
    }

    #[test]
    fn the_picture_is_as_high_as_the_scene_asks() {
        let mut mesh = triangle(0.0, 10.0, [0; 3]);
        mesh.positions.iter_mut().for_each(|p| p.y *= 0.5);
        let scene = Scene { meshes: vec![mesh], ..Scene::default() };
        assert_eq!(fitting_size(&scene, &above(), 800, 100..=1100), [800, 400]);
        assert_eq!(fitting_size(&scene, &above(), 800, 500..=1100), [800, 500]);
    }

    #[test]
    fn same_scene_same_bytes_and_an_empty_scene_is_paper() {
        let scene =
            Scene { meshes: vec![triangle(30.0, 400.0, [255, 0, 0])], lines: vec![], ground_mm: Some(0.0) };
        let view = View::new("v", 35.0, 28.0);
        assert_eq!(render(&scene, &view, [70, 50]).unwrap(), render(&scene, &view, [70, 50]).unwrap());
        let empty = pixels(&render(&Scene::default(), &view, [9, 9]).unwrap());
        assert!(empty.iter().all(|p| *p == PAPER));
        assert!(render(&scene, &view, [0, 9]).is_err());
    }
}
