//! The sheet's plane of a frame that is not folded: which coordinates are (u, v), and which side is the front.

use super::frames::Frame;
use super::graph::Graph;
use super::json::told;
use softfold_geometry::{DVec2, DVec3, Issue, Severity, polygon};

/// Spread of a coordinate, as a share of the sheet's size, below which it is constant: single precision.
const CONSTANT: f64 = 1e-6;
/// Creators that write their screen's coordinates, y down, also where they write no faces.
const Y_DOWN: [&str; 1] = ["oriedita"];

/// Each vertex in (u, v), file units; none if the vertices lie in none of the coordinate planes.
///
/// The plane is seen from the positive end of the constant axis: (x, y), (x, −z) or (y, z). Where the file's
/// faces then run clockwise, or the file was made by a program whose y points down, v is turned round: FOLD's
/// faces run counter-clockwise on the front, which mountain and valley refer to.
pub(super) fn lay_out(
    graph: &Graph,
    frame: Frame<'_>,
    creator: Option<&str>,
    issues: &mut Vec<Issue>,
) -> Option<Vec<DVec2>> {
    let mut points = project(graph, frame, issues)?;
    let y_down = |c: &&str| Y_DOWN.iter().any(|d| c.to_lowercase().starts_with(d));
    let why = match (winding(graph, &points), creator.filter(y_down)) {
        (Winding::Clockwise, _) => "its faces run clockwise, so v points down in the file".to_owned(),
        (Winding::None, Some(creator)) => {
            format!("made by {}, whose y points down", crate::lines::short(creator))
        }
        (Winding::None, None) | (Winding::CounterClockwise, _) => return Some(points),
        (Winding::Both, _) => {
            let what = "some faces run clockwise; the vertices are taken as seen from the front";
            issues.push(told(Severity::Warning, &frame.entry("faces_vertices"), what, "correct the faces"));
            return Some(points);
        }
    };
    points.iter_mut().for_each(|p| p.y = -p.y);
    let what = format!("{why}: v is turned round");
    issues.push(told(Severity::Note, &frame.entry("vertices_coords"), what, ""));
    Some(points)
}

/// How the faces run.
enum Winding {
    None,
    CounterClockwise,
    Clockwise,
    Both,
}

fn winding(graph: &Graph, points: &[DVec2]) -> Winding {
    let area = |f: &Vec<usize>| polygon::signed_area_mm2(&f.iter().map(|&v| points[v]).collect::<Vec<_>>());
    let areas: Vec<f64> = graph.faces.iter().map(area).collect();
    let total: f64 = areas.iter().map(|a| a.abs()).sum();
    let against = |sign: f64| areas.iter().any(|a| a * sign < -CONSTANT * total);
    match (total > 0.0, against(1.0), against(-1.0)) {
        (false, ..) | (_, false, false) => Winding::None,
        (_, false, true) => Winding::CounterClockwise,
        (_, true, false) => Winding::Clockwise,
        (_, true, true) => Winding::Both,
    }
}

fn project(graph: &Graph, frame: Frame<'_>, issues: &mut Vec<Issue>) -> Option<Vec<DVec2>> {
    let (low, high) = bounds(&graph.vertices);
    let spread = high - low;
    let constant = |axis: usize| spread[axis] <= CONSTANT * spread.max_element();
    let (view, name): (fn(&DVec3) -> DVec2, &str) = if constant(2) {
        (|p| DVec2::new(p.x, p.y), "")
    } else if constant(1) {
        (|p| DVec2::new(p.x, -p.z), "y is constant: the sheet is read as (x, -z), seen from +y")
    } else if constant(0) {
        (|p| DVec2::new(p.y, p.z), "x is constant: the sheet is read as (y, z), seen from +x")
    } else {
        return None;
    };
    if !name.is_empty() {
        issues.push(told(Severity::Note, &frame.entry("vertices_coords"), name, ""));
    }
    Some(graph.vertices.iter().map(view).collect())
}

/// Lowest and highest coordinates; the origin for no points.
pub(super) fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let Some(&first) = points.first() else { return (DVec3::ZERO, DVec3::ZERO) };
    points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
}
