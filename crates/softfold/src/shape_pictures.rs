//! The surface's shape in colours: surface.ply and the pictures of the report.

use crate::RunError;
use crate::export::ply::{self, Scalar};
use crate::export::svg::{Size, Style, Svg};
use crate::report::html::Picture;
use crate::report::picture::{
    Colours, INK, Legend, PLAIN, Scale, Scene, SceneLine, SceneMesh, View, fitting_size, render,
};
use crate::report::words::with_unit;
use crate::shape::SheetShape;
use softfold_geometry::{DVec2, DVec3, PlanarCurve, SoftPattern};
use softfold_surface::LocalShape;

/// Width of a picture, px, and the heights allowed.
const WIDTH_PX: u32 = 620;
const HEIGHTS_PX: std::ops::RangeInclusive<u32> = 320..=980;
/// Ends of the colours of radii where the material says no limit, mm: tighter than any soft fold, flatter than any eye sees.
const RADII_MM: [f64; 2] = [20.0, 5000.0];
/// The strongest colour stands for this percentile: a few extremes do not pale the rest.
const STRONGEST: f64 = 0.98;
/// Chord error of drawn curves, mm.
const CHORD_MM: f64 = 0.2;
/// Margin around the plan, share of its larger side.
const MARGIN: f64 = 0.03;

/// A figure at every place, with its colours.
struct Map {
    name: &'static str,
    scale: Scale,
    legend: Legend,
    values: Vec<f64>,
}

/// The surface as a mesh: colours by the tighter skin's radius, and at every vertex curvatures `k1` and `k2` (1/mm),
/// `gaussian` (1/mm²), `radius`, `radius_lower` and `radius_upper` of the skins (mm), `double_bend` (|K|/k₁²),
/// `strain_min` and `strain_max`, the flat place `flat_u` and `flat_v` (mm; programs take plain `u` and `v` for a texture and
/// drop the colours), and the unit vector `ruling_x`, `ruling_y`, `ruling_z` of the
/// smaller curvature.
pub fn surface_ply(title: &str, shape: &SheetShape) -> Vec<u8> {
    let of = |f: &dyn Fn(&LocalShape) -> f64| -> Vec<f64> { shape.shapes.iter().map(f).collect() };
    let [lower, upper] = shape.skins_mm;
    let columns: Vec<(&str, Vec<f64>)> = vec![
        ("flat_u", shape.places.iter().map(|p| p.x).collect()),
        ("flat_v", shape.places.iter().map(|p| p.y).collect()),
        ("k1", of(&|s| s.curvatures[0])),
        ("k2", of(&|s| s.curvatures[1])),
        ("gaussian", of(&LocalShape::gaussian_per_mm2)),
        ("radius", of(&LocalShape::radius_mm)),
        ("radius_lower", of(&|s| s.skin_radius_mm(lower))),
        ("radius_upper", of(&|s| s.skin_radius_mm(upper))),
        ("double_bend", of(&LocalShape::double_bend)),
        ("strain_min", of(&|s| s.strains[0])),
        ("strain_max", of(&|s| s.strains[1])),
        ("ruling_x", of(&|s| s.ruling().1.x)),
        ("ruling_y", of(&|s| s.ruling().1.y)),
        ("ruling_z", of(&|s| s.ruling().1.z)),
    ];
    let scalars: Vec<Scalar<'_>> = columns.iter().map(|(name, values)| Scalar { name, values }).collect();
    let radii = radii(shape);
    let colours = radii.scale.colours(&radii.values);
    ply::coloured(title, &shape.positions(), &shape.triangles, &colours, &scalars)
}

/// Radii, Gaussian curvature and strain in space and on the flat sheet, and the rulings in space.
///
/// # Errors
/// A picture that cannot be encoded: a defect.
pub fn pictures(shape: &SheetShape, trim: &[PlanarCurve]) -> Result<Vec<Picture>, RunError> {
    let space = shape.positions();
    let flat: Vec<DVec3> = shape.places.iter().map(|p| p.extend(0.0)).collect();
    let outline = |lift: &dyn Fn(DVec2) -> DVec3| -> Vec<SceneLine> {
        let line = |c: &PlanarCurve| c.flatten(CHORD_MM).into_iter().map(lift).collect();
        trim.iter().map(|c| SceneLine { points: line(c), colour: INK, width_px: 1.4 }).collect()
    };
    let plan = outline(&|p| p.extend(0.0));
    let mut all = Vec::new();
    for map in [radii(shape), gaussian(shape), strain(shape)] {
        let colours = Colours::PerVertex(map.scale.colours(&map.values));
        let legend = Some(map.legend);
        for (view, positions, lines) in [(in_space(), &space, vec![]), (from_above(), &flat, plan.clone())] {
            let scene = scene(shape, positions, colours.clone(), lines);
            all.push(shot(&scene, &view, map.name, legend.clone())?);
        }
    }
    let lines =
        shape.rulings.iter().map(|r| SceneLine { points: r.space.clone(), colour: INK, width_px: 0.8 });
    let scene = scene(shape, &space, Colours::Uniform(PLAIN), lines.collect());
    all.push(shot(&scene, &in_space(), "rulings", None)?);
    Ok(all)
}

fn in_space() -> View {
    View::new("from the front left", 310.0, 20.0)
}

fn from_above() -> View {
    View::new("on the flat sheet", 0.0, 90.0)
}

fn scene(shape: &SheetShape, positions: &[DVec3], colours: Colours, lines: Vec<SceneLine>) -> Scene {
    let mesh = SceneMesh { positions: positions.to_vec(), triangles: shape.triangles.clone(), colours };
    Scene { meshes: vec![mesh], lines, ground_mm: None }
}

fn shot(scene: &Scene, view: &View, what: &str, legend: Option<Legend>) -> Result<Picture, RunError> {
    let size = fitting_size(scene, view, WIDTH_PX, HEIGHTS_PX);
    let png = render(scene, view, size).map_err(|e| RunError::Defect(e.to_string()))?;
    Ok(Picture { title: format!("{what}, {}", view.name), png, legend })
}

/// The tighter skin's radius, from the material's limit on where there is one.
fn radii(shape: &SheetShape) -> Map {
    let [least, most] = RADII_MM;
    let least = shape.limit_mm.filter(|l| *l > 0.0 && *l < most).unwrap_or(least);
    let scale = Scale::logarithmic(least, most);
    let low = match shape.limit_mm {
        Some(_) => format!("{} (limit)", with_unit(least, "mm")),
        None => with_unit(least, "mm"),
    };
    let legend = scale.legend("radius of the tighter skin", [low, with_unit(most, "mm")]);
    Map { name: "radius", scale, legend, values: shape.skin_radii_mm() }
}

fn gaussian(shape: &SheetShape) -> Map {
    let values: Vec<f64> = shape.shapes.iter().map(|s| 1e6 * s.gaussian_per_mm2()).collect();
    signed("Gaussian curvature", values, 1e-6, |v| with_unit(v, "1/m²"))
}

fn strain(shape: &SheetShape) -> Map {
    signed("principal strain", shape.strains(), 1e-6, |v| format!("{:+.3} %", 100.0 * v))
}

/// A diverging map up to [`STRONGEST`] of the sizes, no less than `nothing`.
fn signed(name: &'static str, values: Vec<f64>, nothing: f64, word: impl Fn(f64) -> String) -> Map {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let place = (STRONGEST * sizes.len().saturating_sub(1) as f64) as usize;
    let limit = sizes.get(place).copied().unwrap_or(0.0).max(nothing);
    let scale = Scale::diverging(limit);
    let legend = scale.legend(name, [word(-limit), word(limit)]);
    Map { name, scale, legend, values }
}

/// Rulings over the flat sheet with its fold lines; the darker, the less the sheet bends along them.
pub fn rulings_svg(shape: &SheetShape, soft: &SoftPattern) -> String {
    let corners: Vec<DVec2> = soft.loops.iter().flat_map(|c| c.flatten(CHORD_MM)).collect();
    let mut svg = Svg::around(&corners, MARGIN);
    svg.curves(&soft.loops, Style::line("#26282d", 1.6).fill("#f3efe6"));
    svg.begin_group("fold lines");
    let folds = soft.bands.iter().flat_map(|b| &b.fold_lines);
    folds.for_each(|l| svg.polyline(&l.points, Style::line("#d9b8a0", 0.6)));
    svg.end_group();
    svg.begin_group("rulings");
    for r in &shape.rulings {
        let share = (r.double_bend / shape.options.most_double_bend).clamp(0.0, 1.0);
        // From the ink of true developables to a light blue of those that just count.
        let mix = |dark: f64, light: f64| (dark + share.sqrt() * (light - dark)).round() as u8;
        let colour = format!("#{:02x}{:02x}{:02x}", mix(20.0, 150.0), mix(45.0, 180.0), mix(90.0, 215.0));
        svg.polyline(&r.flat, Style::line(&colour, 0.9));
    }
    svg.end_group();
    svg.finish(Size::Fluid)
}
