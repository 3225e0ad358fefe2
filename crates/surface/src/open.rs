//! The folded sheet opened along sharp creases: each side has vertices of its own there.

use crate::layout::{Cut, CutKind};
use softfold_geometry::{EdgeClass, FlatMesh, FoldedSheet, LoopId, TriangleId, VertexId};
use std::collections::BTreeMap;

/// The sheet with the vertices on the creases of `cuts` once for each of the sides that meet there. Slits are open
/// already. Edges along the creases become boundaries.
pub(crate) fn opened(sheet: &FoldedSheet, cuts: &[Cut]) -> FoldedSheet {
    let sharp: Vec<bool> = sheet.mesh.edges.iter().map(|e| is_cut(e.class, cuts)).collect();
    if !sharp.contains(&true) {
        return sheet.clone();
    }
    let sides = Sides::new(sheet, &sharp);
    let mut old: Vec<VertexId> = (0..sheet.positions.len()).map(VertexId::new).collect();
    let mut names: BTreeMap<(VertexId, usize), VertexId> = BTreeMap::new();
    let mut triangles = sheet.mesh.triangles.clone();
    for (t, corners) in triangles.iter_mut().enumerate() {
        for (k, v) in corners.iter_mut().enumerate().filter(|(_, v)| sides.on_cut[v.index()]) {
            let side = sides.root(3 * t + k);
            let first = sides.first(*v) == side;
            *v = if first { *v } else { *names.entry((*v, side)).or_insert_with(|| another(&mut old, *v)) };
        }
    }
    let before: BTreeMap<[VertexId; 2], EdgeClass> =
        sheet.mesh.edges.iter().map(|e| (sorted(e.vertices), e.class)).collect();
    let class = |ends: [VertexId; 2], boundary: bool| {
        let was = before.get(&sorted(ends.map(|v| old[v.index()]))).copied();
        match (boundary, was) {
            (true, Some(class @ EdgeClass::Boundary { .. })) => class,
            (true, _) => EdgeClass::Boundary { loop_id: LoopId(0) },
            (false, class) => class.unwrap_or(EdgeClass::Facet),
        }
    };
    let of_old = |v: &VertexId| v.index();
    let mesh = FlatMesh::new(
        old.iter().map(|v| sheet.mesh.vertices[of_old(v)]).collect(),
        old.iter().map(|v| sheet.mesh.sites[of_old(v)]).collect(),
        triangles,
        class,
    );
    let positions = old.iter().map(|v| sheet.positions[of_old(v)]).collect();
    FoldedSheet { mesh, positions, solve: sheet.solve.clone() }
}

fn is_cut(class: EdgeClass, cuts: &[Cut]) -> bool {
    let EdgeClass::Fold { crease, line, .. } = class else { return false };
    cuts.iter().any(|cut| cut.kind == CutKind::Crease { crease, line })
}

fn another(old: &mut Vec<VertexId>, of: VertexId) -> VertexId {
    old.push(of);
    VertexId::new(old.len() - 1)
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// Corners of triangles at one vertex that are on one side: joined across the edges that are not sharp.
struct Sides {
    parent: Vec<usize>,
    on_cut: Vec<bool>,
    first: Vec<usize>,
}

impl Sides {
    fn new(sheet: &FoldedSheet, sharp: &[bool]) -> Self {
        let triangles = &sheet.mesh.triangles;
        let mut on_cut = vec![false; sheet.positions.len()];
        for (edge, _) in sheet.mesh.edges.iter().zip(sharp).filter(|(_, sharp)| **sharp) {
            edge.vertices.iter().for_each(|v| on_cut[v.index()] = true);
        }
        let mut sides = Self { parent: (0..3 * triangles.len()).collect(), on_cut, first: vec![] };
        let corner = |t: TriangleId, v: VertexId| triangles[t.index()].iter().position(|c| *c == v);
        for (edge, _) in sheet.mesh.edges.iter().zip(sharp).filter(|(_, sharp)| !**sharp) {
            let [Some(a), Some(b)] = edge.triangles else { continue };
            for v in edge.vertices {
                if let (Some(i), Some(j)) = (corner(a, v), corner(b, v)) {
                    sides.join(3 * a.index() + i, 3 * b.index() + j);
                }
            }
        }
        sides.first = vec![usize::MAX; sheet.positions.len()];
        for (k, v) in triangles.iter().flatten().enumerate() {
            sides.first[v.index()] = sides.first[v.index()].min(sides.root(k));
        }
        sides
    }

    fn root(&self, mut i: usize) -> usize {
        while self.parent[i] != i {
            i = self.parent[i];
        }
        i
    }

    /// The lower one leads, so that names do not depend on the order of joining.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    /// The side that keeps the vertex.
    fn first(&self, v: VertexId) -> usize {
        self.first[v.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{grid, rectangle};
    use glam::DVec2;
    use softfold_geometry::{CreaseId, PlanarCurve};

    #[test]
    fn a_crease_that_ends_inside_is_opened_up_to_its_tip() {
        let us: Vec<f64> = (0..=6).map(f64::from).collect();
        let mut sheet =
            grid(&us, &us, |p| p, |p| p.extend(0.0), |column| if column == 3 { 1.0 } else { 0.0 });
        // Above v = 4 the line is no fold.
        for e in &mut sheet.mesh.edges {
            let above = e.vertices.iter().any(|v| sheet.mesh.vertices[v.index()].y > 4.0);
            if above && matches!(e.class, EdgeClass::Fold { .. }) {
                e.class = EdgeClass::Facet;
            }
        }
        let curve = PlanarCurve::polyline(&[DVec2::new(3.0, 0.0), DVec2::new(3.0, 4.0)]).unwrap();
        let cut = Cut { curve, kind: CutKind::Crease { crease: CreaseId(0), line: 3 } };
        let open = opened(&sheet, &[cut]);
        open.check().unwrap();
        assert_eq!(open.positions.len(), sheet.positions.len() + 4, "all but the tip are there twice");
        assert_eq!(open.mesh.triangles.len(), sheet.mesh.triangles.len());
        assert!((open.mesh.area_mm2() - 36.0).abs() < 1e-12);
        let borders = open.mesh.edges.iter().filter(|e| e.triangles[1].is_none()).count();
        assert_eq!(borders, 24 + 8);
        assert_eq!(opened(&sheet, &[]), sheet, "nothing to open");
        assert_eq!(rectangle(DVec2::ONE).len(), 1);
    }
}
