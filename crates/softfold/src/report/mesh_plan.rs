//! The flat mesh as a picture: what every edge is, and which triangles are slim.

use crate::export::svg::{Anchor, Size, Style, Svg};
use softfold_geometry::{DVec2, EdgeClass, FlatMesh, TriangleId};

/// Margin around the sheet, and height of the letters, shares of its larger side.
const MARGIN: f64 = 0.03;
const LABEL: f64 = 0.014;

/// Smallest angles below which a triangle is filled, degrees, with the colours; the first that fits.
const SLIM: [(f64, &str); 3] = [(10.0, "#d7301f"), (20.0, "#fc8d59"), (30.0, "#fee8c8")];

/// Kinds of edges in the order in which they are drawn: name, colour, width in px.
const KINDS: [(&str, &str, f64); 5] = [
    ("facet", "#6b7785", 0.45),
    ("free", "#2a9d3a", 0.7),
    ("valley fold", "#2b5fd9", 0.9),
    ("mountain fold", "#c2185b", 0.9),
    ("boundary", "#111111", 1.4),
];

/// The flat mesh in mm, edges coloured by their class and slim triangles filled, with a legend below.
pub fn mesh_svg(mesh: &FlatMesh) -> String {
    let (lo, hi) = softfold_geometry::polygon::bounds(&mesh.vertices);
    let size = (hi - lo).max_element();
    let border = DVec2::splat(MARGIN * size);
    let rows = SLIM.len().max(KINDS.len()) as f64;
    let legend = DVec2::new(0.0, (2.0 * rows + 1.0) * LABEL * size);
    let mut svg = Svg::new(lo - border - legend, hi + border);
    fill_slim(&mut svg, mesh);
    for (kind, (name, colour, width)) in KINDS.into_iter().enumerate() {
        let edges = mesh.edges.iter().filter(|e| kind_of(&e.class) == kind);
        let ends: Vec<[DVec2; 2]> = edges.map(|e| e.vertices.map(|v| mesh.vertices[v.index()])).collect();
        svg.begin_group(name);
        svg.chains(ends.iter().map(|e| e.as_slice()), false, Style::line(colour, width));
        svg.end_group();
    }
    explain(&mut svg, DVec2::new(lo.x, lo.y - 0.5 * border.y), LABEL * size);
    svg.finish(Size::Millimetres)
}

fn kind_of(class: &EdgeClass) -> usize {
    match *class {
        EdgeClass::Facet => 0,
        EdgeClass::Free => 1,
        EdgeClass::Fold { turn_rad, .. } if turn_rad >= 0.0 => 2,
        EdgeClass::Fold { .. } => 3,
        EdgeClass::Boundary { .. } => 4,
    }
}

fn fill_slim(svg: &mut Svg, mesh: &FlatMesh) {
    let mut filled: [Vec<[DVec2; 3]>; SLIM.len()] = Default::default();
    for t in (0..mesh.triangles.len()).map(TriangleId::new) {
        let least = mesh.angles_rad(t).into_iter().fold(f64::MAX, f64::min).to_degrees();
        if let Some(of) = SLIM.iter().position(|(below, _)| least < *below) {
            filled[of].push(mesh.corners(t));
        }
    }
    for ((below, colour), triangles) in SLIM.into_iter().zip(&filled) {
        svg.begin_group(&format!("smallest angle below {below} degrees"));
        svg.chains(triangles.iter().map(|t| t.as_slice()), true, Style::filled(colour));
        svg.end_group();
    }
}

/// The legend, downwards from `at`.
fn explain(svg: &mut Svg, at: DVec2, size: f64) {
    let ink = "#111111";
    let row = |column: f64, i: usize| at + size * DVec2::new(24.0 * column, -2.0 * (i as f64 + 1.0));
    for (i, (name, colour, width)) in KINDS.into_iter().enumerate() {
        let p = row(0.0, i);
        svg.polyline(&[p, p + DVec2::new(3.0 * size, 0.0)], Style::line(colour, 2.0 * width));
        svg.label(p + size * DVec2::new(4.0, -0.35), size, Anchor::Start, ink, name);
    }
    for (i, (below, colour)) in SLIM.into_iter().enumerate() {
        let p = row(1.0, i);
        let box_ = [(0., -0.5), (3., -0.5), (3., 0.5), (0., 0.5)].map(|q| p + size * DVec2::from(q));
        svg.polygon(&box_, Style::filled(colour));
        let text = format!("smallest angle below {below}\u{b0}");
        svg.label(p + size * DVec2::new(4.0, -0.35), size, Anchor::Start, ink, &text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use softfold_geometry::{CreaseId, LoopId, Site, VertexId};

    #[test]
    fn every_kind_of_edge_is_drawn_once_and_slim_triangles_are_filled() {
        let points = [(0., 0.), (100., 0.), (100., 5.), (0., 100.)].map(DVec2::from).to_vec();
        let triangles = vec![[0, 1, 2].map(VertexId), [0, 2, 3].map(VertexId)];
        let mesh = FlatMesh::new(points, vec![Site::Interior; 4], triangles, |_, boundary| match boundary {
            true => EdgeClass::Boundary { loop_id: LoopId(0) },
            false => EdgeClass::Fold { crease: CreaseId(0), line: 0, turn_rad: -0.5 },
        });
        let svg = mesh_svg(&mesh);
        let group = |name: &str| {
            let from = svg.find(&format!(">{name}<")).unwrap();
            svg[from..].split("</g>").next().unwrap().to_owned()
        };
        assert_eq!(group("boundary").matches('M').count(), 4);
        assert_eq!(group("mountain fold").matches('M').count(), 1);
        assert_eq!(group("valley fold").matches('M').count(), 0);
        assert_eq!(group("smallest angle below 10 degrees").matches('Z').count(), 1);
    }
}
