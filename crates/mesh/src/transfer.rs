//! Values at the vertices of one mesh carried to those of another mesh of the same sheet.

use crate::locate::Locator;
use crate::rings::Rings;
use glam::{DVec2, DVec3};
use softfold_geometry::{FlatMesh, TriangleId, VertexId};
use std::collections::BTreeSet;

/// Values linear over each triangle of `from`, at the vertices of `to`; exact for linear fields. The lips of slits keep
/// their own values. A vertex that is not on the sheet of `from` gets the value of the nearest vertex.
///
/// # Panics
/// If `values` has fewer entries than `from` has vertices.
pub fn transfer(from: &FlatMesh, values: &[DVec3], to: &FlatMesh) -> Vec<DVec3> {
    let locator = Locator::new(from);
    let linear = |v: usize, place: Option<Place>| match place {
        Some(place) => interpolated(from, values, place),
        None => nearest_value(from, values, to.vertices[v]),
    };
    places(&locator, to).into_iter().enumerate().map(|(v, place)| linear(v, place)).collect()
}

/// Values of quadratics fitted around each vertex of `to` by moving least squares; exact for quadratic fields, and smooth
/// where [`transfer`] has kinks. Where the vertices of `from` do not fix a quadratic it is [`transfer`]'s value.
///
/// Vertices are gathered from triangle to neighbouring triangle: the lips of a slit keep apart but around its free tips.
///
/// # Panics
/// If `values` has fewer entries than `from` has vertices.
pub fn transfer_smooth(from: &FlatMesh, values: &[DVec3], to: &FlatMesh) -> Vec<DVec3> {
    let locator = Locator::new(from);
    let smooth = |v: usize, place: Option<Place>| {
        let Some(place) = place else { return nearest_value(from, values, to.vertices[v]) };
        let patch = patch(from, &locator, place.0);
        fitted(from, values, &patch, to.vertices[v]).unwrap_or_else(|| interpolated(from, values, place))
    };
    places(&locator, to).into_iter().enumerate().map(|(v, place)| smooth(v, place)).collect()
}

type Place = (TriangleId, [f64; 3]);

/// Vertices that a quadratic is fitted to, at least: twice its coefficients.
const PATCH: usize = 2 * TERMS;
/// Coefficients of a quadratic in (u, v).
const TERMS: usize = 6;
/// Rings of triangles gathered at most.
const MOST_RINGS: usize = 4;
/// Weights vanish at so many times the farthest vertex of the patch, so that all count.
const REACH: f64 = 1.25;
/// Pivots smaller than this, where the largest are near 1: the vertices are on a line or a conic.
const SINGULAR: f64 = 1e-9;

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

/// Vertices around a triangle.
fn patch(from: &FlatMesh, locator: &Locator<'_>, middle: TriangleId) -> BTreeSet<VertexId> {
    let mut reached = BTreeSet::from([middle]);
    let mut rim = vec![middle];
    let mut vertices = BTreeSet::from(from.triangles[middle.index()]);
    for _ in 0..MOST_RINGS {
        let beyond: Vec<TriangleId> = rim.iter().flat_map(|t| locator.neighbours(*t)).flatten().collect();
        rim = beyond.into_iter().filter(|t| reached.insert(*t)).collect();
        vertices.extend(rim.iter().flat_map(|t| from.triangles[t.index()]));
        if vertices.len() >= PATCH {
            break;
        }
    }
    vertices
}

/// The value at a point of the quadratic that fits best around it.
fn fitted(from: &FlatMesh, values: &[DVec3], patch: &BTreeSet<VertexId>, p: DVec2) -> Option<DVec3> {
    let apart = |v: &VertexId| from.vertices[v.index()].distance(p);
    let reach = REACH * patch.iter().map(apart).fold(0.0, f64::max);
    let mut matrix = [[0.0; TERMS]; TERMS];
    let mut right = [DVec3::ZERO; TERMS];
    let mut total = 0.0;
    for v in patch {
        let d = (from.vertices[v.index()] - p) / reach;
        let weight = (1.0 - d.length_squared()).max(0.0).powi(2);
        let terms = [1.0, d.x, d.y, d.x * d.x, d.x * d.y, d.y * d.y];
        total += weight;
        for i in 0..TERMS {
            right[i] += weight * terms[i] * values[v.index()];
            for j in 0..TERMS {
                matrix[i][j] += weight * terms[i] * terms[j];
            }
        }
    }
    constant_term(matrix, right, SINGULAR * total)
}

/// First unknown of a symmetric system, by elimination from the last; none if it is singular.
fn constant_term(
    mut matrix: [[f64; TERMS]; TERMS],
    mut right: [DVec3; TERMS],
    least_pivot: f64,
) -> Option<DVec3> {
    for k in (1..TERMS).rev() {
        if matrix[k][k] <= least_pivot {
            return None;
        }
        for i in 0..k {
            let factor = matrix[i][k] / matrix[k][k];
            (0..k).for_each(|j| matrix[i][j] -= factor * matrix[k][j]);
            right[i] -= factor * right[k];
        }
    }
    (matrix[0][0] > least_pivot).then(|| right[0] / matrix[0][0])
}
