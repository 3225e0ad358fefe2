//! Values at the vertices of one mesh carried to those of another mesh of the same sheet.

use crate::locate::Locator;
use crate::rings::Rings;
use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, TriangleId};

/// Values linear over each triangle of `from`, at the vertices of `to`; exact for linear fields. The lips of slits keep
/// their own values. A vertex that is not on the sheet of `from` gets the value of the nearest vertex.
///
/// # Panics
/// If `values` has fewer entries than `from` has vertices.
pub fn transfer(from: &FlatMesh, values: &[DVec3], to: &FlatMesh) -> Vec<DVec3> {
    let locator = Locator::new(from);
    let value = |(v, place): (usize, Option<Place>)| match place {
        Some(place) => interpolated(from, values, place),
        None => nearest_value(from, values, to.vertices[v]),
    };
    places(&locator, to).into_iter().enumerate().map(value).collect()
}

type Place = (TriangleId, [f64; 3]);

/// Where each vertex of a mesh is: reached from the middle of its triangles, so that it stays on its side of slits.
fn places(locator: &Locator<'_>, to: &FlatMesh) -> Vec<Option<Place>> {
    let rings = Rings::new(to.vertices.len(), &to.triangles);
    let place = |v: usize| {
        let ring = rings.of(v);
        let sum: DVec2 = ring.iter().flat_map(|t| to.corners(TriangleId(*t))).sum();
        let at = to.vertices[v];
        let middle = if ring.is_empty() { at } else { sum / (3 * ring.len()) as f64 };
        locator.walk(middle, at).or_else(|| locator.locate(at))
    };
    (0..to.vertices.len()).map(place).collect()
}

fn interpolated(from: &FlatMesh, values: &[DVec3], (t, weights): Place) -> DVec3 {
    from.triangles[t.index()].iter().zip(weights).map(|(v, w)| w * values[v.index()]).sum()
}

fn nearest_value(from: &FlatMesh, values: &[DVec3], p: DVec2) -> DVec3 {
    let apart = |v: &usize| from.vertices[*v].distance_squared(p);
    let nearest = (0..from.vertices.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
    nearest.map_or(DVec3::ZERO, |v| values[v])
}
