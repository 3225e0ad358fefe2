//! Meshes of other people's patterns, from the collection beside the checkout: angles, area, fold lines and chords of every pattern that
//! can be read, sharp; and of those with curves also softened as widely as they can be.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop at the first surprise"
)]

#[path = "common/shared.rs"]
mod shared;

use shared::{files, say, shared};
use softfold_geometry::{Crease, CreasePattern, EdgeClass, Role, Segment, SoftPattern, polygon};
use softfold_mesh::{Constraint, MeshOptions, Meshed, mesh};
use softfold_pattern::{Format, ReadOptions, read};
use softfold_soften::{CreaseSoftness, Segments, soften};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// All endings of the collection.
const ENDINGS: [&str; 6] = ["cp", "dxf", "fold", "opx", "ori", "svg"];
/// Fold angle of creases of which a file says none, degrees.
const ANGLE_DEG: f64 = 60.0;
/// Edges of the target's length along the larger side of a sheet.
const EDGES: f64 = 40.0;
/// Radii tried, shares of the sheet's size, until one fits.
const RADII: [f64; 6] = [1e-2, 5e-3, 2.5e-3, 1.25e-3, 6e-4, 3e-4];
/// Smallest angle away from what the pattern makes sharp, degrees.
const LEAST_DEG: f64 = 20.0;
/// Median of the smallest angles with curves or dense polylines, degrees, and what rounding may take of it.
const MEDIAN_DEG: f64 = 45.0;
const ROUNDING_DEG: f64 = 1e-6;
/// The same with straight lines only: a grid of squares all as small as edges shall be has triangles of 45° less the
/// rounding of its file, and lines across it less than that.
const STRAIGHT_MEDIAN_DEG: f64 = 44.0;
/// A crease of so many segments follows a curve.
const DENSE: usize = 3;
/// Area of the mesh against that of the polygon of its boundary.
const AREA: f64 = 1e-9;
/// Medians that fall short, with what they are at least now, of patterns of straight lines: a grid of squares, 45° less the
/// rounding of its file, and a grid of narrow parallelograms with edges as long as the target.
const SHORT: [(&str, f64); 2] = [
    ("Pleating/BoxPleatTessellation.fold (sharp)", 44.99),
    ("Tessellations/miura_sharpangle.svg (sharp)", 38.0),
];

struct Row {
    text: String,
    fault: Option<String>,
}

fn softness(pattern: &CreasePattern, radius_mm: f64) -> Vec<CreaseSoftness> {
    let one = |c: &Crease| {
        let sign = if c.role == Role::Mountain { -1.0 } else { 1.0 };
        let angle = c.fold_angle_rad.unwrap_or_default();
        // What is folded flat cannot be softened: its angle is kept just below.
        let size = if angle == 0.0 { ANGLE_DEG.to_radians() } else { angle.abs().min(3.0) };
        CreaseSoftness::constant(radius_mm, sign * size, Segments::Count(3))
    };
    pattern.creases.iter().map(one).collect()
}

fn is_dense(pattern: &CreasePattern) -> bool {
    pattern.creases.iter().any(|c| c.curve.segments().len() >= DENSE)
}

fn has_curves(pattern: &CreasePattern) -> bool {
    let curved = |s: &Segment| !matches!(s, Segment::Line { .. });
    pattern.creases.iter().any(|c| c.curve.segments().iter().any(curved))
}

/// The pattern sharp, and softened with the first radius that fits.
fn softened(pattern: &CreasePattern) -> Vec<(&'static str, SoftPattern)> {
    let with = |share: f64| soften(pattern, &softness(pattern, share * pattern.size_mm())).ok();
    let sharp = with(0.0).map(|s| ("sharp", s));
    let soft = || RADII.into_iter().find_map(with).map(|s| ("soft", s));
    let soft = if has_curves(pattern) { soft() } else { None };
    sharp.into_iter().chain(soft).collect()
}

fn rows(path: &Path, folder: &Path) -> Vec<Row> {
    let name = path.strip_prefix(folder).unwrap_or(path).display().to_string();
    let bytes = std::fs::read(path).expect("a readable file");
    let format = path.extension().and_then(|e| Format::of_ending(&e.to_string_lossy())).expect("a pattern");
    let Ok(file) = read(&bytes, format, &name, &ReadOptions::default()) else { return vec![] };
    let target_edge_mm = file.pattern.size_mm() / EDGES;
    let options = MeshOptions { target_edge_mm, ..MeshOptions::default() };
    let follows = has_curves(&file.pattern) || is_dense(&file.pattern);
    let median_deg = if follows { MEDIAN_DEG - ROUNDING_DEG } else { STRAIGHT_MEDIAN_DEG };
    let one = |(kind, soft): (&str, SoftPattern)| {
        row(&format!("{name} ({kind})"), mesh(&soft, &options), &options, median_deg)
    };
    softened(&file.pattern).into_iter().map(one).collect()
}

fn row(
    name: &str,
    meshed: Result<Meshed, softfold_mesh::MeshError>,
    options: &MeshOptions,
    median_deg: f64,
) -> Row {
    let meshed = match meshed {
        Ok(meshed) => meshed,
        Err(error) => return Row { text: format!("{name}: {error}"), fault: Some(error.to_string()) },
    };
    let i = &meshed.inspection;
    let text = format!(
        "{:>7} {:>6.1} {:>6.1} {:>6} {:>5} {:>8.4} {name}",
        meshed.mesh.vertices.len(),
        i.free.min_angle_deg,
        i.free.median_min_angle_deg,
        i.excused,
        i.places.len(),
        i.fold_chord_mm.max(i.boundary_chord_mm),
    );
    Row { text, fault: fault(name, &meshed, options, median_deg) }
}

fn fault(name: &str, meshed: &Meshed, options: &MeshOptions, median_deg: f64) -> Option<String> {
    let Meshed { mesh, inspection: i, .. } = meshed;
    let known = SHORT.iter().find(|(end, _)| name.ends_with(end)).map_or(median_deg, |s| s.1);
    if i.small > 0 || i.free.min_angle_deg < LEAST_DEG {
        return Some(format!("{} small angles: {:.1?}", i.small, i.worst));
    }
    if i.free.median_min_angle_deg < known {
        return Some(format!("median {:.2}°", i.free.median_min_angle_deg));
    }
    let polygons = polygon_area_mm2(meshed);
    if (mesh.area_mm2() / polygons - 1.0).abs() > AREA {
        return Some(format!("area {} of {polygons}", mesh.area_mm2()));
    }
    if let Err(error) = mesh.check() {
        return Some(error.to_string());
    }
    let [made, wanted] = fold_lengths_mm(meshed);
    if (made - wanted).abs() > AREA * wanted {
        return Some(format!("{made} mm of {wanted} mm of fold lines are edges"));
    }
    let chord_mm = i.fold_chord_mm.max(i.boundary_chord_mm);
    (chord_mm > options.chord * options.target_edge_mm * (1.0 + 1e-9)).then(|| format!("chord {chord_mm} mm"))
}

/// Area of the polygon of outline and holes.
fn polygon_area_mm2(meshed: &Meshed) -> f64 {
    let at = |v: softfold_geometry::VertexId| meshed.graph.points[v.index()];
    let origin = meshed.graph.points[0];
    let boundary = meshed.graph.constraints.iter().filter(|c| matches!(c.1, Constraint::Boundary { .. }));
    boundary.map(|(e, _)| polygon::signed_area_mm2(&[origin, at(e[0]), at(e[1])])).sum()
}

/// Length of the edges on fold lines, and of the fold lines: equal where no triangle crosses one.
fn fold_lengths_mm(meshed: &Meshed) -> [f64; 2] {
    let Meshed { mesh, graph, .. } = meshed;
    let is_fold = |e: &&softfold_geometry::Edge| matches!(e.class, EdgeClass::Fold { .. });
    let made = mesh.edges.iter().filter(is_fold).map(|e| e.vertices.map(|v| mesh.vertices[v.index()]));
    let folds = graph.constraints.iter().filter(|c| matches!(c.1, Constraint::Fold { .. }));
    let wanted = folds.map(|c| c.0.map(|v| graph.points[v.index()]));
    [made.map(|[a, b]| a.distance(b)).sum(), wanted.map(|[a, b]| a.distance(b)).sum()]
}

#[test]
fn meshes_of_other_peoples_patterns_have_no_small_angles_of_their_own() {
    let test = "meshes_of_other_peoples_patterns_have_no_small_angles_of_their_own";
    let Some(folder) = shared(test, "patterns") else { return };
    let found: Vec<PathBuf> = files(&folder, &ENDINGS);
    assert!(!found.is_empty(), "no patterns in {}", folder.display());
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some((i, path)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, found.get(i)?)))
                {
                    let rows = rows(path, &folder);
                    done.lock().expect("no worker panicked").push((i, rows));
                }
            });
        }
    });
    let mut done = done.into_inner().expect("no worker panicked");
    done.sort_by_key(|d| d.0);
    let rows: Vec<Row> = done.into_iter().flat_map(|d| d.1).collect();
    say("\nvertices  least median excused places  chord/mm");
    rows.iter().for_each(|r| say(&r.text));
    let faults = rows.iter().filter_map(|r| Some(format!("{}\n    {}", r.text, r.fault.as_ref()?)));
    let faults: Vec<String> = faults.collect();
    assert!(faults.is_empty(), "{} of {} meshes:\n{}", faults.len(), rows.len(), faults.join("\n"));
}
