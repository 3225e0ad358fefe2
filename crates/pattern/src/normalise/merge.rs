//! Edges that lie on each other become one, which stands for all of them.

use super::model::{Drawing, Edge, Source};
use super::segment;
use softfold_geometry::{Segment, Tolerance};
use std::collections::BTreeMap;

/// Curves between the same nodes are the same if nowhere farther apart than so many join tolerances: the ends of
/// both may have moved by one.
const SAME_CURVE: f64 = 2.0;
/// Share of their lengths by which curves that lie on each other may differ, beside the tolerance.
const SAME_LENGTH: f64 = 1e-3;
/// Parameters at which curves are compared.
const COMPARED: [f64; 3] = [0.25, 0.5, 0.75];

/// The edges without repetition, in the order of their first members.
pub(super) fn merged(drawing: &Drawing<'_>, edges: Vec<Edge>, tolerance: &Tolerance) -> Vec<Edge> {
    let mut between: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (i, e) in edges.iter().enumerate() {
        let [a, b] = e.nodes;
        between.entry([a.min(b), a.max(b)]).or_default().push(i);
    }
    // What each edge is merged into.
    let mut into: Vec<usize> = (0..edges.len()).collect();
    for group in between.values().filter(|g| g.len() > 1) {
        find_twins(&edges, group, tolerance, &mut into);
    }
    let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, first) in into.iter().enumerate() {
        members.entry(*first).or_default().push(i);
    }
    members.values().map(|m| joined(drawing, &edges, m)).collect()
}

fn find_twins(edges: &[Edge], group: &[usize], tolerance: &Tolerance, into: &mut [usize]) {
    let mut by_length: Vec<(f64, usize)> =
        group.iter().map(|&i| (segment::length(&edges[i].segment), i)).collect();
    by_length.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (k, &(length, i)) in by_length.iter().enumerate() {
        let least = length * (1.0 - SAME_LENGTH) - SAME_CURVE * 2.0 * tolerance.join_mm;
        let near = by_length[..k].iter().rev().take_while(|n| n.0 >= least).map(|n| n.1);
        let twin = near.into_iter().find(|&n| same(&edges[i].segment, &edges[n].segment, tolerance));
        if let Some(twin) = twin {
            into[i] = into[twin];
        }
    }
    // The least number of a family stands for it.
    let mut least: BTreeMap<usize, usize> = BTreeMap::new();
    for &i in group {
        least.entry(into[i]).and_modify(|l| *l = i.min(*l)).or_insert(i);
    }
    group.iter().for_each(|&i| into[i] = least[&into[i]]);
}

/// Whether two segments with the same ends are the same curve.
fn same(a: &Segment, b: &Segment, tolerance: &Tolerance) -> bool {
    if let (Segment::Line { .. }, Segment::Line { .. }) = (a, b) {
        return true;
    }
    let near =
        |t| segment::distance(b, segment::at(a, t), tolerance.join_mm) <= SAME_CURVE * tolerance.join_mm;
    COMPARED.into_iter().all(near)
}

/// One edge for several; the curve is that of the first member of the role that won.
fn joined(drawing: &Drawing<'_>, edges: &[Edge], members: &[usize]) -> Edge {
    let member = |m: &usize| &edges[*m];
    if let [only] = members {
        return member(only).clone();
    }
    let rim = members.iter().any(|m| member(m).rim);
    let all: Vec<Source> = members.iter().flat_map(|m| member(m).sources.iter().copied()).collect();
    let (role, fold_angle_rad, _) = drawing.resolve(if rim { &[] } else { &all });
    let winner = members.iter().map(member).find(|e| e.role == role).unwrap_or(member(&members[0]));
    let along = |e: &Edge| -> Vec<Source> {
        let turned = !runs_along(e, winner);
        e.sources.iter().map(|s| if turned { s.reversed() } else { *s }).collect()
    };
    let mut sources: Vec<Source> = members.iter().flat_map(|m| along(member(m))).collect();
    sources.sort_by(Source::order);
    sources.dedup();
    Edge { role, fold_angle_rad, sources, rim, ..winner.clone() }
}

/// Whether two edges on each other run the same way.
fn runs_along(a: &Edge, b: &Edge) -> bool {
    if a.nodes[0] != a.nodes[1] {
        return a.nodes == b.nodes;
    }
    segment::leaving(&a.segment, 0).dot(segment::leaving(&b.segment, 0)) >= 0.0
}
