//! Boundaries that do not close: which they are, and what is said of them.

use super::cluster::Groups;
use super::contour::contours;
use super::model::{Drawing, Graph, Half};
use super::told::Told;
use crate::PatternError;
use crate::error::{Place, issue};
use softfold_geometry::{DVec2, Severity, polygon};
use std::collections::{BTreeMap, BTreeSet};

/// Free ends that are paired to gaps at most; the rest of a drawing in pieces is not told.
const MAX_ENDS: usize = 200;

/// The widest part of the chosen edges that is on no closed contour.
pub(super) fn widest(graph: &Graph, chosen: &[bool]) -> Option<Vec<usize>> {
    let bridges = contours(graph, chosen).bridges;
    let mut groups = Groups::new(graph.points.len());
    for &e in &bridges {
        groups.unite(graph.edges[e].nodes[0] as usize, graph.edges[e].nodes[1] as usize);
    }
    let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &e in &bridges {
        parts.entry(groups.root(graph.edges[e].nodes[0] as usize)).or_default().push(e);
    }
    let extent = |edges: &[usize]| {
        let controls = edges.iter().flat_map(|&e| graph.edges[e].segment.control_points());
        let (low, high) = polygon::bounds(&controls.collect::<Vec<DVec2>>());
        (high - low).max_element()
    };
    parts.into_values().max_by(|a, b| extent(a).total_cmp(&extent(b)).then(b.cmp(a)))
}

/// A free end of the boundary.
struct End {
    half: Half,
    at: DVec2,
    /// Order in the file: subpath and position along it.
    order: (u32, f64),
}

/// Errors for the gaps of an open boundary, the nearest ends paired; the first of them.
pub(super) fn refuse(
    drawing: &Drawing<'_>,
    graph: &Graph,
    chosen: &[bool],
    told: &mut Told<'_>,
) -> PatternError {
    let ends = free_ends(drawing, graph, chosen);
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for a in 0..ends.len() {
        pairs.extend((a + 1..ends.len()).map(|b| (ends[a].at.distance(ends[b].at), a, b)));
    }
    pairs.sort_by(|p, q| p.0.total_cmp(&q.0).then((p.1, p.2).cmp(&(q.1, q.2))));
    let mut paired = BTreeSet::new();
    let mut errors = Vec::new();
    for (gap, a, b) in pairs {
        if !paired.contains(&a) && !paired.contains(&b) {
            paired.extend([a, b]);
            errors.push(gap_error(drawing, graph, gap, [&ends[a], &ends[b]]));
        }
    }
    errors.iter().for_each(|e| told.refuse(e.clone()));
    errors.into_iter().next().unwrap_or_else(|| {
        let what = "the outline is open";
        PatternError::Outline(issue(Severity::Error, what, "close the path"))
    })
}

fn free_ends(drawing: &Drawing<'_>, graph: &Graph, chosen: &[bool]) -> Vec<End> {
    let mut ends = Vec::new();
    for halves in graph.leaving() {
        let mut of_role = halves.into_iter().filter(|h| chosen[h.edge()]);
        let (Some(half), None) = (of_role.next(), of_role.next()) else { continue };
        let Some(source) = drawing.primary(&graph.edges[half.edge()]) else { continue };
        let order = (source.subpath, source.range[half.side()]);
        ends.push(End { half, at: graph.point(half), order });
    }
    ends.sort_by(|a, b| a.order.0.cmp(&b.order.0).then(a.order.1.total_cmp(&b.order.1)));
    ends.truncate(MAX_ENDS);
    ends
}

fn gap_error(drawing: &Drawing<'_>, graph: &Graph, gap: f64, [a, b]: [&End; 2]) -> PatternError {
    let origin = |e: &End| drawing.origin(&graph.edges[e.half.edge()]);
    let what = format!(
        "the outline is open: it starts at ({:.3}, {:.3}) in {} and ends at ({:.3}, {:.3}) in {}, a gap of {gap:.3} mm",
        a.at.x,
        a.at.y,
        origin(a),
        b.at.x,
        b.at.y,
        origin(b),
    );
    let mend = "close the path, or make these two ends meet";
    PatternError::Outline(issue(Severity::Error, what, mend).of(&origin(b)).at(b.at))
}
