//! The pictures of the report.

use crate::RunError;
use crate::report::html::{Picture, Pictures};
use crate::report::picture::{
    Colours, INK, PLAIN, Scale, Scene, SceneLine, SceneMesh, View, fitting_size, render,
};
use crate::report::plans::{self, PlanBoard, PlanPart, StockSheet};
use crate::shape_pictures;
use crate::stages::{AnalyseResult, FoldResult, Results};
use crate::states::State;
use softfold_fold::Verdict;
use softfold_geometry::{DVec2, DVec3, EdgeClass, FoldedSheet, polygon};
use softfold_mold::{Mold, Placed, WaffleBoard};
use softfold_surface::subd::Conforming;

/// Width of a view, px.
const WIDTH_PX: u32 = 620;
/// Heights allowed, px.
const HEIGHTS_PX: std::ops::RangeInclusive<u32> = 320..=980;
/// Chord error of drawn curves, mm.
const CHORD_MM: f64 = 0.2;

/// All pictures of a run.
///
/// # Errors
/// A picture that cannot be encoded: a defect.
pub fn pictures(results: &Results) -> Result<Pictures, RunError> {
    let mut pictures = Pictures::default();
    if let Some(pattern) = &results.pattern {
        pictures.flat_pattern_svg = plans::pattern_svg(pattern);
    }
    if let Some(soft) = &results.soft {
        pictures.soft_pattern_svg = plans::soft_pattern_svg(soft);
    }
    if let (Some(fold), Some(analyse)) = (&results.fold, &results.analyse) {
        pictures.views = views(fold, analyse)?;
    }
    if let (Some(soft), Some(s)) = (&results.soft, &results.surface) {
        pictures.surface = shape_pictures::pictures(&s.shape, &soft.loops)?;
        pictures.rulings_svg = shape_pictures::rulings_svg(&s.shape, soft);
    }
    if let Some(subd) = results.surface.as_ref().and_then(|s| s.subd.as_ref()) {
        pictures.views.extend(cage_views(&subd.made)?);
    }
    if let (Some(rest), Some(fold)) = (&results.stability, &results.fold) {
        let plan: Vec<DVec2> =
            fold.sheet.positions.iter().map(|p| rest.rest_from_pose.point(*p).truncate()).collect();
        let s = &rest.stability;
        pictures.stability_svg = plans::stability_svg(&s.hull, s.barycenter_mm.truncate(), &hull(&plan)?);
    }
    if let Some(mold) = &results.mold {
        pictures.parts_svg = parts_plan(mold);
        pictures.boards_svg = boards_plan(mold, results.stock_mm);
    }
    Ok(pictures)
}

fn hull(points: &[DVec2]) -> Result<Vec<DVec2>, RunError> {
    let flat: Vec<[f64; 2]> = points.iter().map(|p| p.to_array()).collect();
    let corners = softfold_kernel::cgal::convex_hull(&flat).map_err(|e| RunError::Defect(e.to_string()))?;
    Ok(corners.into_iter().map(|i| points[i as usize]).collect())
}

fn views(fold: &FoldResult, analyse: &AnalyseResult) -> Result<Vec<Picture>, RunError> {
    let verdict = &analyse.verdict;
    let (area, limit) = area_scale(verdict);
    let ends = [format!("{:+.2} %", -100.0 * limit), format!("{:+.2} %", 100.0 * limit)];
    let area_legend = area.legend("area error", ends);
    let radius = Scale::logarithmic(RADIUS_SCALE_MM[0], RADIUS_SCALE_MM[1]);
    let ends = RADIUS_SCALE_MM.map(|r| format!("{r:.0} mm"));
    let radius_legend = radius.legend("bend radius", ends);
    let mut views = Vec::new();
    for view in View::standard() {
        views.push(shot(&fold.sheet, &view, None, "folded sheet")?);
    }
    for view in View::standard() {
        let colours = area.colours(&verdict.vertex_area_error);
        views.push(Picture {
            legend: Some(area_legend.clone()),
            ..shot(&fold.sheet, &view, Some(colours), "area error")?
        });
    }
    for view in View::standard() {
        let colours = radius.colours(&verdict.vertex_bend_radius_mm);
        views.push(Picture {
            legend: Some(radius_legend.clone()),
            ..shot(&fold.sheet, &view, Some(colours), "bend radius")?
        });
    }
    if !fold.states.is_empty() {
        views.push(strip(&fold.states)?);
    }
    Ok(views)
}

/// Space between two states of the strip, as share of the widest.
const STATE_GAP: f64 = 0.15;
/// Width of one state of the strip, px, and the widest strip.
const STATE_WIDTH_PX: u32 = 280;
const STRIP_WIDTH_PX: u32 = 2800;

/// All states side by side at one scale, seen from the front left.
///
/// # Errors
/// A picture that cannot be encoded: a defect.
pub(crate) fn strip(states: &[State]) -> Result<Picture, RunError> {
    let view = View::new("from the front left", 310.0, 20.0);
    let (sin, cos) = view.azimuth_deg.to_radians().sin_cos();
    let right = DVec3::new(cos, sin, 0.0);
    let span = |s: &State| {
        let along = s.sheet.positions.iter().map(|p| p.dot(right));
        along.fold([f64::MAX, f64::MIN], |[lo, hi], a| [lo.min(a), hi.max(a)])
    };
    let spans: Vec<[f64; 2]> = states.iter().map(span).collect();
    let pitch = (1.0 + STATE_GAP) * spans.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
    let mut scene = Scene::default();
    for (k, (state, [lo, hi])) in states.iter().zip(spans).enumerate() {
        let shift = (k as f64 * pitch - 0.5 * (lo + hi)) * right;
        let positions = state.sheet.positions.iter().map(|p| *p + shift).collect();
        let sheet = FoldedSheet { positions, ..state.sheet.clone() };
        scene.lines.extend(lines(&sheet));
        scene.meshes.push(scene_mesh(&sheet, Colours::Uniform(PLAIN)));
    }
    let width = (states.len() as u32 * STATE_WIDTH_PX).clamp(WIDTH_PX, STRIP_WIDTH_PX);
    let size = fitting_size(&scene, &view, width, 100..=*HEIGHTS_PX.end());
    let png = render(&scene, &view, size).map_err(|e| RunError::Defect(e.to_string()))?;
    let names: Vec<&str> = states.iter().map(|s| s.name.as_str()).collect();
    Ok(Picture {
        title: format!("states of folding: {}; {}", names.join(", "), view.name),
        png,
        legend: None,
    })
}

/// The cage in the flat sheet and in space.
fn cage_views(made: &Conforming) -> Result<Vec<Picture>, RunError> {
    let flat: Vec<DVec3> = made.flat.iter().map(|p| p.extend(0.0)).collect();
    let above = View::new("flat", 0.0, 90.0);
    let mut views = vec![cage_view(&flat, &made.cage.quads, &above)?];
    for view in View::standard() {
        views.push(cage_view(&made.cage.positions, &made.cage.quads, &view)?);
    }
    Ok(views)
}

fn cage_view(positions: &[DVec3], quads: &[[u32; 4]], view: &View) -> Result<Picture, RunError> {
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = SceneMesh { positions: positions.to_vec(), triangles, colours: Colours::Uniform(PLAIN) };
    let line = |q: &[u32; 4]| SceneLine {
        points: [0, 1, 2, 3, 0].map(|k| positions[q[k] as usize]).to_vec(),
        colour: INK,
        width_px: 0.6,
    };
    let scene = Scene { meshes: vec![mesh], lines: quads.iter().map(line).collect(), ground_mm: None };
    let size = fitting_size(&scene, view, WIDTH_PX, HEIGHTS_PX);
    let png = render(&scene, view, size).map_err(|e| RunError::Defect(e.to_string()))?;
    Ok(Picture { title: format!("cage, {}", view.name), png, legend: None })
}

fn scene_mesh(sheet: &FoldedSheet, colours: Colours) -> SceneMesh {
    let triangles = sheet.mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect();
    SceneMesh { positions: sheet.positions.clone(), triangles, colours }
}

/// Colours of area errors, and the error of the strongest: the largest of the sheet, but no less than rounding.
pub(crate) fn area_scale(verdict: &Verdict) -> (Scale, f64) {
    /// A sheet that keeps its area to this is shown as white.
    const NOTHING: f64 = 1e-6;
    let limit = verdict.area_error.iter().map(|e| e.value.abs()).fold(NOTHING, f64::max);
    (Scale::diverging(limit), limit)
}

/// Ends of the colour scale of bend radii, mm: tighter than any soft fold, flatter than any eye sees.
const RADIUS_SCALE_MM: [f64; 2] = [20.0, 5000.0];

fn shot(
    sheet: &FoldedSheet,
    view: &View,
    colours: Option<Vec<[u8; 3]>>,
    what: &str,
) -> Result<Picture, RunError> {
    let mesh = scene_mesh(sheet, colours.map_or(Colours::Uniform(PLAIN), Colours::PerVertex));
    let scene = Scene { meshes: vec![mesh], lines: lines(sheet), ground_mm: Some(0.0) };
    let size = fitting_size(&scene, view, WIDTH_PX, HEIGHTS_PX);
    let png = render(&scene, view, size).map_err(|e| RunError::Defect(e.to_string()))?;
    Ok(Picture { title: format!("{what}, {}", view.name), png, legend: None })
}

fn lines(sheet: &FoldedSheet) -> Vec<SceneLine> {
    let line = |e: &softfold_geometry::Edge| {
        let width_px = match e.class {
            EdgeClass::Boundary { .. } => 1.8,
            EdgeClass::Fold { .. } => 0.7,
            EdgeClass::Facet | EdgeClass::Free => return None,
        };
        let points: Vec<DVec3> = e.vertices.iter().map(|v| sheet.position(*v)).collect();
        Some(SceneLine { points, colour: INK, width_px })
    };
    sheet.mesh.edges.iter().filter_map(line).collect()
}

fn parts_plan(mold: &Mold) -> String {
    let part = |p: &softfold_mold::Part| {
        let [x0, y0, x1, y1] = p.footprint_mm;
        let outline = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(DVec2::from).to_vec();
        PlanPart { name: p.name.clone(), outline }
    };
    let board = |b: &WaffleBoard| {
        let end = |x: f64| b.placement.point(DVec3::new(x, 0.0, 0.0)).truncate();
        PlanBoard { name: b.name.clone(), ends: [end(0.0), end(b.size_mm.x)] }
    };
    let parts: Vec<_> = mold.parts.iter().map(part).collect();
    let boards: Vec<_> = mold.waffle.boards.iter().map(board).collect();
    plans::parts_svg(&parts, &mold.plan, &boards)
}

fn boards_plan(mold: &Mold, stock_mm: [f64; 2]) -> String {
    let waffle = &mold.waffle;
    let sheet = |s: &softfold_mold::Sheet| StockSheet {
        size_mm: DVec2::from(stock_mm),
        cuts: s.placed.iter().map(|p| cut(&waffle.boards[p.board], p)).collect(),
    };
    plans::boards_svg(&waffle.nest.sheets.iter().map(sheet).collect::<Vec<_>>())
}

fn cut(board: &WaffleBoard, placed: &Placed) -> (String, Vec<DVec2>) {
    let outline = board.profile.first().map(|c| c.flatten(CHORD_MM)).unwrap_or_default();
    (board.name.clone(), outline.into_iter().map(on_stock(board, placed)).collect())
}

/// Where points of a board's profile lie on its stock sheet.
pub(crate) fn on_stock(board: &WaffleBoard, placed: &Placed) -> impl Fn(DVec2) -> DVec2 {
    let corners: Vec<DVec2> = board.profile.iter().flat_map(|c| c.flatten(CHORD_MM)).collect();
    let (lo, hi) = polygon::bounds(&corners);
    let (corner, turned) = (placed.position_mm, placed.rotated);
    move |p| {
        let q = p - lo;
        corner + if turned { DVec2::new(hi.y - lo.y - q.y, q.x) } else { q }
    }
}
