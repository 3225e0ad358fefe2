//! Fold lines that run along a slit, or through its end, are led through its points: edges cannot lie on each other.

use crate::refine::Planar;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use softfold_geometry::{VertexId, polygon};
use std::collections::BTreeSet;

/// Cuts constraints at vertices that lie on them within a distance; of two pieces between the same vertices the one that
/// was there before stays.
pub(crate) fn cut_at(planar: &mut Planar<'_>, vertices: &BTreeSet<VertexId>, touch_mm: f64) {
    if vertices.is_empty() {
        return;
    }
    let points = &planar.graph.points;
    let place = |v: &VertexId| GeomWithData::new(points[v.index()].to_array(), *v);
    let tree = RTree::bulk_load(vertices.iter().map(place).collect());
    let through = |edge: [VertexId; 2]| {
        let [a, b] = edge.map(|v| points[v.index()]);
        let around = AABB::from_corners((a.min(b) - touch_mm).to_array(), (a.max(b) + touch_mm).to_array());
        let on = tree.locate_in_envelope(around).map(|p| p.data).filter_map(|v| {
            let p = points[v.index()];
            let share = (p - a).dot(b - a) / (b - a).length_squared();
            let is_on = 0.0 < share && share < 1.0 && polygon::segment_distance(p, a, b) <= touch_mm;
            (is_on && !edge.contains(&v)).then_some((share, v))
        });
        let mut on: Vec<(f64, VertexId)> = on.collect();
        on.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        on
    };
    let cuts: Vec<_> = planar.graph.constraints.iter().map(|(edge, _)| through(*edge)).collect();
    let kept = planar.graph.constraints.iter().zip(&cuts).filter(|(_, cuts)| cuts.is_empty());
    let mut known: BTreeSet<[VertexId; 2]> = kept.map(|((edge, _), _)| sorted(*edge)).collect();
    let old =
        std::mem::take(&mut planar.graph.constraints).into_iter().zip(std::mem::take(&mut planar.spans));
    for (((edge, what), span), cuts) in old.zip(cuts) {
        let (mut from, mut rest) = (edge[0], span);
        for &(share, v) in &cuts {
            let [before, after] = rest.split(span.from_mm + share * span.length_mm());
            if known.insert(sorted([from, v])) {
                planar.graph.constraints.push(([from, v], what));
                planar.spans.push(before);
            }
            (from, rest) = (v, after);
        }
        if cuts.is_empty() || known.insert(sorted([from, edge[1]])) {
            planar.graph.constraints.push(([from, edge[1]], what));
            planar.spans.push(rest);
        }
    }
    (0..planar.spans.len()).for_each(|c| planar.turn(c));
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}
