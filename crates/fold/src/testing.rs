//! Small meshes for the tests of this crate.

use glam::DVec2;
use softfold_geometry::{CreaseId, EdgeClass, FlatMesh, LoopId, Site, VertexId};

/// A grid of `columns` × `rows` squares of side `h`, each cut in two; the outline runs
/// counter-clockwise from (0, 0).
pub(crate) fn strip(columns: usize, rows: usize, h: f64) -> FlatMesh {
    folded_strip(columns, rows, h, |_| 0.0)
}

/// The same with fold lines along the inner columns: `turn(column)` in rad, 0 for none.
pub(crate) fn folded_strip(columns: usize, rows: usize, h: f64, turn: impl Fn(usize) -> f64) -> FlatMesh {
    let at = |i: usize, j: usize| VertexId::new(i * (rows + 1) + j);
    let vertices: Vec<DVec2> =
        (0..=columns).flat_map(|i| (0..=rows).map(move |j| DVec2::new(i as f64 * h, j as f64 * h))).collect();
    let triangles = (0..columns)
        .flat_map(|i| (0..rows).map(move |j| (i, j)))
        .flat_map(|(i, j)| match (i + j) % 2 {
            0 => [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]],
            _ => [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]],
        })
        .collect();
    let (w, l) = (columns as f64 * h, rows as f64 * h);
    let sites = vertices.iter().map(|p| site(*p, w, l)).collect();
    let x: Vec<f64> = vertices.iter().map(|p| p.x).collect();
    FlatMesh::new(vertices, sites, triangles, |[a, b], boundary| {
        let column = (x[a.index()] / h).round() as usize;
        if boundary {
            EdgeClass::Boundary { loop_id: LoopId(0) }
        } else if x[a.index()] == x[b.index()] && turn(column) != 0.0 {
            EdgeClass::Fold { crease: CreaseId(0), line: column as u32, turn_rad: turn(column) }
        } else {
            EdgeClass::Facet
        }
    })
}

fn site(p: DVec2, w: f64, l: f64) -> Site {
    let s_mm = if p.y == 0.0 {
        p.x
    } else if p.x == w {
        w + p.y
    } else if p.y == l {
        w + l + (w - p.x)
    } else if p.x == 0.0 {
        2.0 * w + l + (l - p.y)
    } else {
        return Site::Interior;
    };
    Site::Boundary { loop_id: LoopId(0), s_mm }
}
