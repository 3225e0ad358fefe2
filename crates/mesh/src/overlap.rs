//! Fold lines that run along a slit, or through its end, are led through its points: edges cannot lie on each other.

use crate::planar::Planar;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cdt::{Constraint, PlanarGraph};
    use crate::tracks::{Span, Track};
    use glam::DVec2;
    use softfold_geometry::{CreaseId, FoldLine, LineEnd, Site};

    const SLIT: Constraint = Constraint::Slit { slit: 0 };
    const FOLD: Constraint = Constraint::Fold { crease: CreaseId(0), line: 0, turn_rad: 0.0 };

    /// A fold line of 10 mm from vertex 0 to vertex 1, which turns by 0 to 1 rad, after slits between further vertices.
    fn cut(points: &[(f64, f64)], slits: &[[u32; 2]]) -> Vec<([u32; 2], Constraint, Span)> {
        let points: Vec<DVec2> = points.iter().copied().map(DVec2::from).collect();
        let line = FoldLine {
            rank: None,
            points: points[..2].to_vec(),
            s_mm: vec![0.0, 10.0],
            offsets_mm: vec![0.0; 2],
            turns_rad: vec![0.0, 1.0],
            ends: [LineEnd::Free; 2],
        };
        let mut tracks = vec![Track::fold(CreaseId(0), 0, None, &line)];
        let mut constraints = vec![([VertexId(0), VertexId(1)], FOLD)];
        let mut spans = vec![Span { track: 0, from_mm: 0.0, to_mm: 10.0 }];
        for (i, edge) in slits.iter().enumerate() {
            let ends = edge.map(|v| points[v as usize]);
            tracks.push(Track::side(0, ends[0], ends[1]));
            spans.push(Span { track: i as u32 + 1, from_mm: 0.0, to_mm: ends[0].distance(ends[1]) });
            constraints.push((edge.map(VertexId), SLIT));
        }
        let vertices = slits.iter().flatten().copied().map(VertexId).collect();
        let sites = vec![Site::Interior; points.len()];
        let mut planar = Planar { graph: PlanarGraph { points, constraints }, sites, spans, tracks };
        cut_at(&mut planar, &vertices, 1e-6);
        let Planar { graph, spans, .. } = planar;
        graph.constraints.into_iter().zip(spans).map(|((e, what), s)| (e.map(|v| v.0), what, s)).collect()
    }

    fn piece(edge: [u32; 2], [from_mm, to_mm]: [f64; 2]) -> ([u32; 2], Constraint, Span) {
        let turn_rad = 0.5 * (from_mm + to_mm) / 10.0;
        let fold = Constraint::Fold { crease: CreaseId(0), line: 0, turn_rad };
        (edge, fold, Span { track: 0, from_mm, to_mm })
    }

    #[test]
    fn a_fold_line_along_a_slit_leaves_it_the_edge_between_its_points() {
        let pieces = cut(&[(0.0, 0.0), (10.0, 0.0), (7.0, 0.0), (4.0, 0.0)], &[[2, 3]]);
        let slit = ([2, 3], SLIT, Span { track: 1, from_mm: 0.0, to_mm: 3.0 });
        assert_eq!(pieces, [piece([0, 3], [0.0, 4.0]), piece([2, 1], [7.0, 10.0]), slit]);
    }

    #[test]
    fn a_fold_line_through_the_end_of_a_slit_has_its_point() {
        let pieces = cut(&[(0.0, 0.0), (10.0, 0.0), (4.0, 0.0), (4.0, 5.0)], &[[2, 3]]);
        assert_eq!(pieces[..2], [piece([0, 2], [0.0, 4.0]), piece([2, 1], [4.0, 10.0])]);
        assert_eq!(pieces.len(), 3);
    }

    #[test]
    fn a_point_beside_the_line_or_beyond_its_ends_leaves_it_whole() {
        let pieces = cut(&[(0.0, 0.0), (10.0, 0.0), (4.0, 1e-3), (12.0, 0.0)], &[[2, 3]]);
        assert_eq!(pieces[0], piece([0, 1], [0.0, 10.0]));
        assert_eq!(pieces.len(), 2);
        assert!(cut(&[(0.0, 0.0), (10.0, 0.0)], &[]).len() == 1);
    }
}
