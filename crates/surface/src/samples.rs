//! What the surface is fitted to: the folded vertices, and at the bands points between them, lifted off the edges.

use glam::{DVec2, DVec3};
use softfold_geometry::{CreaseId, Edge, EdgeClass, FoldedSheet, TriangleId, VertexId};

/// Weight of a lifted point against a vertex of the same area. Vertices are what was computed and come first; the
/// lifted points need no more than to be heard.
const LIFTED_WEIGHT: f64 = 1.0 / 3.0;

/// A point that the surface should pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Target {
    pub(crate) uv: DVec2,
    pub(crate) position: DVec3,
    /// Its weight: its share of the sheet's area, mm².
    pub(crate) weight_mm2: f64,
    /// A point of (u, v) near by in a triangle beside it: it tells the face where several meet.
    pub(crate) beside: DVec2,
}

/// How far from a vertex or edge to the middle of a triangle the point beside it is: near, and yet clear of the bow of a
/// curved crease over the triangle's side.
const BESIDE: f64 = 0.1;

/// The vertices, then the lifted midpoints of the edges at fold lines.
///
/// Where a band begins its curvature jumps. A smooth surface through the vertices alone answers with a bulge in the
/// flat facets beside the band and a bend too tight inside; the normals at the edges' ends tell both apart.
pub(crate) fn targets(sheet: &FoldedSheet) -> Vec<Target> {
    let lines = fold_lines(sheet);
    let normals = normals(sheet, &lines);
    let mut targets = vertex_targets(sheet);
    for edge in &sheet.mesh.edges {
        if edge.vertices.iter().any(|v| !lines[v.index()].is_empty()) {
            targets.extend(lifted(sheet, &normals, edge));
        }
    }
    targets
}

/// Each vertex with a third of the flat triangles around it.
fn vertex_targets(sheet: &FoldedSheet) -> Vec<Target> {
    let mut weights_mm2 = vec![0.0; sheet.positions.len()];
    for (t, corners) in sheet.mesh.triangles.iter().enumerate() {
        let third = sheet.mesh.triangle_area_mm2(TriangleId::new(t)) / 3.0;
        corners.iter().for_each(|v| weights_mm2[v.index()] += third);
    }
    let mut besides = sheet.mesh.vertices.clone();
    for (t, corners) in sheet.mesh.triangles.iter().enumerate() {
        let middle = middle(sheet, TriangleId::new(t));
        corners.iter().for_each(|v| besides[v.index()] = sheet.mesh.vertices[v.index()].lerp(middle, BESIDE));
    }
    let places = sheet.mesh.vertices.iter().zip(&sheet.positions).zip(besides);
    let target = |(((&uv, &position), beside), weight_mm2)| Target { uv, position, weight_mm2, beside };
    places.zip(weights_mm2).map(target).collect()
}

fn middle(sheet: &FoldedSheet, triangle: TriangleId) -> DVec2 {
    sheet.mesh.corners(triangle).into_iter().sum::<DVec2>() / 3.0
}

/// The middle of the cubic that leaves both ends of an edge in their tangent planes; on a circle it is the arc's middle
/// up to the fourth power of the angle. None where a normal is missing.
fn lifted(sheet: &FoldedSheet, normals: &[Option<DVec3>], edge: &Edge) -> Option<Target> {
    let [a, b] = edge.vertices;
    let (na, nb) = (normals[a.index()]?, normals[b.index()]?);
    let (pa, pb) = (sheet.position(a), sheet.position(b));
    let d = pb - pa;
    let position = 0.5 * (pa + pb) + 0.125 * (d.dot(nb) * nb - d.dot(na) * na);
    let uv = 0.5 * (sheet.mesh.vertices[a.index()] + sheet.mesh.vertices[b.index()]);
    let area_mm2: f64 = edge.triangles.iter().flatten().map(|&t| sheet.mesh.triangle_area_mm2(t)).sum();
    let within = edge.triangles[0].map_or(uv, |t| uv.lerp(middle(sheet, t), BESIDE));
    Some(Target { uv, position, weight_mm2: LIFTED_WEIGHT * area_mm2 / 3.0, beside: within })
}

/// Unit normals of the smooth surface at the vertices: the mean over the triangles around, but on the border lines of a
/// band, where the arc begins, over those outside of it; none on a sharp crease.
fn normals(sheet: &FoldedSheet, lines: &[FoldLines]) -> Vec<Option<DVec3>> {
    // Per vertex: sums outside and inside of bands. No triangle leaves a zero.
    let mut sums = vec![[DVec3::ZERO; 2]; sheet.positions.len()];
    for corners in &sheet.mesh.triangles {
        let [a, b, c] = corners.map(|v| sheet.position(v));
        let side = usize::from(spans_lines(corners, lines));
        corners.iter().for_each(|v| sums[v.index()][side] += (b - a).cross(c - a));
    }
    let normal = |([outside, inside], lines): ([DVec3; 2], &FoldLines)| match (outside, inside) {
        (_, DVec3::ZERO) if !lines.is_empty() => None,
        (DVec3::ZERO, _) => inside.try_normalize(),
        _ => outside.try_normalize(),
    };
    sums.into_iter().zip(lines).map(normal).collect()
}

/// Crease and number of the lines with a turn through a vertex.
type FoldLines = Vec<(CreaseId, u32)>;

fn fold_lines(sheet: &FoldedSheet) -> Vec<FoldLines> {
    let mut lines = vec![FoldLines::new(); sheet.positions.len()];
    for edge in &sheet.mesh.edges {
        if let EdgeClass::Fold { crease, line, turn_rad } = edge.class
            && turn_rad != 0.0
        {
            edge.vertices.iter().for_each(|v| lines[v.index()].push((crease, line)));
        }
    }
    lines
}

/// Whether all corners lie on fold lines of one crease, and not on the same.
fn spans_lines(corners: &[VertexId; 3], lines: &[FoldLines]) -> bool {
    let [a, b, c] = corners.map(|v| &lines[v.index()]);
    a.iter().any(|&(crease, line)| {
        let of_crease = |others: &FoldLines| others.iter().any(|l| l.0 == crease);
        let elsewhere = |l: &(CreaseId, u32)| l.0 == crease && l.1 != line;
        of_crease(b) && of_crease(c) && b.iter().chain(c).any(elsewhere)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{BandSheet, grid};

    #[test]
    fn lifted_points_lie_on_the_bend_that_the_strips_stand_for() {
        let band = BandSheet::right_angle(30.0, 5, 0.3);
        let sheet = band.sheet(13.0);
        let targets = targets(&sheet);
        let lifted = &targets[sheet.positions.len()..];
        assert!(lifted.len() > sheet.positions.len() / 2, "{}", lifted.len());
        let chord_error = 30.0 * (1.0 - (std::f64::consts::PI / 20.0).cos());
        for target in lifted {
            let off = band.distance_to_bend(target.position);
            assert!(off < 0.03 * chord_error, "{} {off}", target.uv);
        }
    }

    #[test]
    fn vertices_share_the_area() {
        let sheet = BandSheet::right_angle(30.0, 5, 0.3).sheet(13.0);
        let sum: f64 = targets(&sheet)[..sheet.positions.len()].iter().map(|t| t.weight_mm2).sum();
        assert!((sum / sheet.mesh.area_mm2() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_is_lifted_at_a_sharp_crease_or_without_folds() {
        let roof = |p: DVec2| DVec3::new(p.x, p.y, (p.x - 20.0).abs());
        for turn in [1.5, 0.0] {
            let sheet = grid(
                &[0., 10., 20., 30., 40.],
                &[0., 10., 20.],
                |p| p,
                roof,
                |c| if c == 2 { turn } else { 0.0 },
            );
            assert_eq!(targets(&sheet).len(), 15);
        }
    }
}
