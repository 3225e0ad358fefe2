//! Which contour is the outline: the drawn one, one completed by creases, the outermost lines, or the convex hull.

use super::contour::{self, contours, simple_loops};
use super::hull;
use super::model::{Drawing, Edge, Graph, Half};
use super::open;
use super::region::{by_area, depths};
use super::told::Told;
use super::{segment, split};
use crate::error::{Origin, Place, issue, list};
use crate::{Outline, PatternError, ReadOptions};
use softfold_geometry::{DVec2, Issue, Role, Severity, Tolerance, polygon};
use std::collections::BTreeSet;

/// Share of the drawn boundary that must lie on a contour that creases complete.
const BOUNDARY_SHARE: f64 = 0.9;

/// Sheets listed in an issue.
const LISTED: usize = 8;

/// The outline of the sheet that is read.
pub(super) struct Found {
    /// Its contour, counter-clockwise.
    pub(super) outline: Vec<Half>,
    /// Contours of the other sheets.
    pub(super) others: Vec<Vec<Half>>,
    /// Whether the outline is the drawn one.
    pub(super) drawn: bool,
}

/// Finds the outline; edges that become outline for want of a drawn one are made boundary.
///
/// # Errors
/// No outline, an open one, one that crosses itself, or a sheet that is not there.
pub(super) fn find(
    drawing: &Drawing<'_>,
    graph: &mut Graph,
    options: &ReadOptions,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Found, PatternError> {
    let sheets = match options.outline {
        Outline::Drawn => drawn(drawing, graph, tolerance, told)?,
        Outline::Lines => lines(drawing, graph, tolerance, told)?,
        Outline::Hull => hull(drawing, graph, tolerance, told)?,
    };
    let drawn = sheets.iter().flatten().all(|h| !graph.edges[h.edge()].rim);
    let mut others = sheets;
    let number = choose(drawing, graph, &others, options, told)?;
    let contour = others.remove(number);
    let outline = without_lobes(drawing, graph, &contour, tolerance, told)?;
    Ok(Found { outline, others, drawn })
}

/// The contours of chosen edges that are inside no other, by falling area.
fn outermost(graph: &Graph, chosen: &[bool], tolerance: &Tolerance) -> Vec<Vec<Half>> {
    let loops = by_area(graph, contours(graph, chosen).outer);
    let depths = depths(graph, &loops, tolerance);
    loops.into_iter().zip(depths).filter(|(_, d)| *d == 0).map(|(l, _)| l).collect()
}

fn chosen(graph: &Graph, what: impl Fn(&Edge) -> bool) -> Vec<bool> {
    graph.edges.iter().map(what).collect()
}

fn drawn(
    drawing: &Drawing<'_>,
    graph: &mut Graph,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Vec<Vec<Half>>, PatternError> {
    // Packaging files draw the outline as a cut.
    for role in [Role::Boundary, Role::Cut] {
        let of_role = chosen(graph, |e| e.role == role);
        if !of_role.contains(&true) {
            continue;
        }
        let sheets = outermost(graph, &of_role, tolerance);
        let open = open::widest(graph, &of_role);
        let widest = sheets.iter().map(|l| extent(graph, l.iter().map(|h| h.edge()))).fold(0.0, f64::max);
        match open {
            Some(open) if extent(graph, open.iter().copied()) > widest => {
                if let Some(sheets) = completed(drawing, graph, &open, tolerance, told) {
                    return Ok(sheets);
                }
                if role == Role::Boundary {
                    return Err(open::refuse(drawing, graph, &of_role, told));
                }
            }
            _ => return Ok(sheets),
        }
    }
    guessed(drawing, graph, tolerance, told)
}

/// The larger side of the box around edges.
fn extent(graph: &Graph, edges: impl Iterator<Item = usize>) -> f64 {
    let controls = edges.flat_map(|e| graph.edges[e].segment.control_points());
    let (low, high) = polygon::bounds(&controls.collect::<Vec<DVec2>>());
    (high - low).max_element()
}

/// The outermost lines as outline if the open boundary lies on them.
fn completed(
    drawing: &Drawing<'_>,
    graph: &mut Graph,
    open: &[usize],
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Option<Vec<Vec<Half>>> {
    let sheets = outermost(graph, &vec![true; graph.edges.len()], tolerance);
    let on: BTreeSet<usize> = sheets.iter().flatten().map(|h| h.edge()).collect();
    let length = |e: &usize| segment::length(&graph.edges[*e].segment);
    let whole: f64 = open.iter().map(length).sum();
    let shared: f64 = open.iter().filter(|e| on.contains(e)).map(length).sum();
    if shared < BOUNDARY_SHARE * whole {
        return None;
    }
    let coloured = make_rim(drawing, graph, &sheets);
    let what = format!("the drawn outline is open; these lines close it: {}", list(&coloured));
    told.push(warning(what, "draw the whole outline in the outline's colour", graph, &sheets));
    Some(sheets)
}

/// Makes all edges of the contours boundary; the elements that were drawn as something else.
fn make_rim(drawing: &Drawing<'_>, graph: &mut Graph, sheets: &[Vec<Half>]) -> Vec<Origin> {
    let mut strokes = BTreeSet::new();
    for half in sheets.iter().flatten() {
        let edge = &mut graph.edges[half.edge()];
        if edge.role != Role::Boundary {
            strokes.extend(edge.sources.iter().map(|s| drawing.subpaths[s.subpath as usize].stroke));
            (edge.role, edge.fold_angle_rad, edge.rim) = (Role::Boundary, None, true);
        }
    }
    strokes.into_iter().map(|s| drawing.strokes[s].origin.clone()).collect()
}

/// A warning about contours, placed at their first node.
fn warning(what: String, mend: &str, graph: &Graph, sheets: &[Vec<Half>]) -> Issue {
    let found = issue(Severity::Warning, what, mend);
    match sheets.first().and_then(|l| l.first()) {
        Some(half) => found.at(graph.point(*half)),
        None => found,
    }
}

/// Without a drawn outline: the outermost lines, if they are convex and leave a crease inside.
fn guessed(
    drawing: &Drawing<'_>,
    graph: &mut Graph,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Vec<Vec<Half>>, PatternError> {
    let sheets = outermost(graph, &vec![true; graph.edges.len()], tolerance);
    let hull = hull::of(graph, tolerance);
    let on: BTreeSet<usize> = sheets.iter().flatten().map(|h| h.edge()).collect();
    let inner = (0..graph.edges.len()).any(|e| super::model::folds(graph.edges[e].role) && !on.contains(&e));
    if let ([only], true) = (&sheets[..], inner)
        && hull::is_near(graph, only, &hull, tolerance)
    {
        let coloured = make_rim(drawing, graph, &sheets);
        let what = format!("the outline is drawn in crease colours: {}", list(&coloured));
        let mend = "draw the outline as boundary: black (#000000), or B in FOLD";
        told.push(warning(what, mend, graph, &sheets));
        return Ok(sheets);
    }
    let mut mend = "draw a closed outline with a black stroke (#000000)".to_owned();
    let hull_area = polygon::signed_area_mm2(&hull);
    if hull_area > 0.0 {
        mend += &format!(", or take the convex hull by outline = \"hull\" ({hull_area:.1} mm²)");
    }
    if let Some(largest) = sheets.first() {
        let area = contour::area(graph, largest);
        mend += &format!(", or the outermost lines by outline = \"lines\" ({area:.1} mm²)");
    }
    Err(PatternError::Outline(issue(Severity::Error, "the pattern has no outline", mend)))
}

fn lines(
    drawing: &Drawing<'_>,
    graph: &mut Graph,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Vec<Vec<Half>>, PatternError> {
    let sheets = outermost(graph, &vec![true; graph.edges.len()], tolerance);
    if sheets.is_empty() {
        let what = "the outermost lines enclose nothing";
        let mend = "close the outermost lines, or take the convex hull by outline = \"hull\"";
        return Err(PatternError::Outline(issue(Severity::Error, what, mend)));
    }
    let coloured = make_rim(drawing, graph, &sheets);
    let named = if coloured.is_empty() { String::new() } else { format!(": {}", list(&coloured)) };
    let what = format!("as asked, the outermost lines are the outline{named}");
    told.push(warning(what, "", graph, &sheets));
    Ok(sheets)
}

fn hull(
    drawing: &Drawing<'_>,
    graph: &mut Graph,
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Vec<Vec<Half>>, PatternError> {
    let hull = hull::of(graph, tolerance);
    if hull.len() < 3 {
        let what = "the lines have no hull: they all lie on one straight line";
        return Err(PatternError::Outline(issue(Severity::Error, what, "draw a closed outline")));
    }
    let mut edges = std::mem::take(&mut graph.edges);
    edges.extend(hull::edges(&hull));
    *graph = split::split(drawing, edges, tolerance)?.0;
    let rim = chosen(graph, |e| e.rim);
    let sheets = outermost(graph, &rim, tolerance);
    if sheets.is_empty() {
        let what = "the hull of the lines encloses nothing";
        return Err(PatternError::Outline(issue(Severity::Error, what, "draw a closed outline")));
    }
    told.push(warning(
        "as asked, the convex hull of all lines is the outline".to_owned(),
        "",
        graph,
        &sheets,
    ));
    Ok(sheets)
}

/// Number of the sheet that is read.
fn choose(
    drawing: &Drawing<'_>,
    graph: &Graph,
    sheets: &[Vec<Half>],
    options: &ReadOptions,
    told: &mut Told<'_>,
) -> Result<usize, PatternError> {
    let count = sheets.len();
    match options.sheet {
        Some(wanted) if wanted == 0 || wanted > count => {
            let others = listed(drawing, graph, sheets, 0);
            let what = format!("the drawing holds {count} sheets, no number {wanted}: {others}");
            let mend = format!("choose a sheet from 1 to {count}");
            Err(PatternError::Outline(issue(Severity::Error, what, mend)))
        }
        Some(wanted) => Ok(wanted - 1),
        None => {
            if count > 1 {
                let others = listed(drawing, graph, sheets, 1);
                let what =
                    format!("the drawing holds {count} sheets; the largest is read, left out are: {others}");
                let found = issue(Severity::Warning, what, "choose another by its number, or delete them");
                told.push(found.at(graph.point(sheets[0][0])));
            }
            Ok(0)
        }
    }
}

/// The sheets from a number on in words, a few of them.
fn listed(drawing: &Drawing<'_>, graph: &Graph, sheets: &[Vec<Half>], from: usize) -> String {
    let describe = |(i, l): (usize, &Vec<Half>)| {
        let (low, high) = bounds(graph, l);
        let (middle, area) = (0.5 * (low + high), contour::area(graph, l));
        let origin = contour_origin(drawing, graph, l);
        format!("{} {origin} of {area:.1} mm² around ({:.3}, {:.3})", i + 1, middle.x, middle.y)
    };
    let mut all: Vec<String> = sheets.iter().enumerate().skip(from).take(LISTED).map(describe).collect();
    let more = sheets.len().saturating_sub(from + LISTED);
    if more > 0 {
        all.push(format!("and {more} more"));
    }
    all.join(", ")
}

fn bounds(graph: &Graph, contour: &[Half]) -> (DVec2, DVec2) {
    let controls = contour.iter().flat_map(|h| graph.edges[h.edge()].segment.control_points());
    polygon::bounds(&controls.collect::<Vec<DVec2>>())
}

/// The first element of a contour in the order of the file.
pub(super) fn contour_origin(drawing: &Drawing<'_>, graph: &Graph, contour: &[Half]) -> Origin {
    let sources = contour.iter().flat_map(|h| &graph.edges[h.edge()].sources);
    let first = sources.min_by(|a, b| a.order(b));
    first.map(|s| drawing.stroke(s).origin.clone()).unwrap_or_default()
}

/// The contour as one simple loop: tiny lobes fall away, larger ones are refused.
fn without_lobes(
    drawing: &Drawing<'_>,
    graph: &Graph,
    contour: &[Half],
    tolerance: &Tolerance,
    told: &mut Told<'_>,
) -> Result<Vec<Half>, PatternError> {
    let mut loops = by_area(graph, simple_loops(graph, contour));
    let main = loops.remove(0);
    for lobe in loops {
        let area = contour::area(graph, &lobe).abs();
        let origin = contour_origin(drawing, graph, &lobe);
        let at = graph.point(lobe[0]);
        if area > tolerance.refuse_mm.powi(2) {
            let what = "the boundary crosses itself";
            let found = issue(Severity::Error, what, "redraw it without the crossing");
            return Err(PatternError::Outline(found.of(&origin).at(at)));
        }
        let what = format!("the boundary makes a loop of {area:.6} mm²; it is left out");
        told.push(issue(Severity::Warning, what, "redraw it without the loop").of(&origin).at(at));
    }
    Ok(main)
}
