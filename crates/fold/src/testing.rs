//! Small meshes for the tests of this crate.

use glam::{DVec2, DVec3};
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

/// Six volumes below this are none, mm³: of places in one plane only the sign of rounding is left.
const NO_VOLUME_MM3: f64 = 1e-9;

/// How many edges pierce a triangle to which they do not belong, by looking at all.
pub(crate) fn crossings(mesh: &FlatMesh, x: &[DVec3]) -> usize {
    let place = |v: VertexId| x[v.index()];
    let pierces = |ends: [VertexId; 2], corners: [VertexId; 3]| {
        let ([p, q], [a, b, c]) = (ends.map(place), corners.map(place));
        let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
        let ends = [volume(a, b, c, p), volume(a, b, c, q)];
        let around = [(a, b), (b, c), (c, a)].map(|(u, v)| volume(p, q, u, v));
        let one_side = |v: &[f64]| v.iter().all(|v| *v > 0.0) || v.iter().all(|v| *v < 0.0);
        ends.iter().all(|v| v.abs() > NO_VOLUME_MM3) && !one_side(&ends) && one_side(&around)
    };
    let apart = |e: &[VertexId; 2], t: &[VertexId; 3]| !t.contains(&e[0]) && !t.contains(&e[1]);
    let of_edge =
        |e: [VertexId; 2]| mesh.triangles.iter().filter(|t| apart(&e, t) && pierces(e, **t)).count();
    mesh.edges.iter().map(|e| of_edge(e.vertices)).sum()
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

/// The same sheet with its points shaken along the boundary and inside, and each square cut along either diagonal, as chance has
/// it: triangles of very different shapes, however small `h` is.
pub(crate) fn irregular(columns: usize, rows: usize, h: f64, seed: u64) -> FlatMesh {
    /// How far a point is shaken, share of h; a square stays convex up to a quarter.
    const SHAKE: f64 = 0.24;
    let mut chance = Chance(seed);
    let (w, l) = (columns as f64 * h, rows as f64 * h);
    let grid = strip(columns, rows, h);
    let shaken = |p: &DVec2| {
        let by = SHAKE * h * DVec2::new(chance.next(), chance.next());
        let free = DVec2::new(f64::from(p.x > 0.0 && p.x < w), f64::from(p.y > 0.0 && p.y < l));
        *p + by * free
    };
    let vertices: Vec<DVec2> = grid.vertices.iter().map(shaken).collect();
    let at = |i: usize, j: usize| VertexId::new(i * (rows + 1) + j);
    let triangles = (0..columns)
        .flat_map(|i| (0..rows).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if chance.next() < 0.0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        })
        .collect();
    let sites = vertices.iter().map(|p| site(*p, w, l)).collect();
    FlatMesh::new(vertices, sites, triangles, |_, boundary| match boundary {
        true => EdgeClass::Boundary { loop_id: LoopId(0) },
        false => EdgeClass::Facet,
    })
}

/// Numbers from −1 to 1 that look random and are the same for the same seed (a 64-bit linear congruence, Knuth's constants).
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
