//! Points of the sheet by (u, v), by arc length along a crease or the outline, or by region; never by vertex number.

use glam::{DVec2, DVec3};
use softfold_geometry::{
    Crease, CreasePattern, FlatMesh, LoopId, PlanarCurve, Site, TriangleId, VertexId, polygon,
};

/// A point of the sheet: corners of a triangle with barycentric weights that add up to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetPoint {
    vertices: [u32; 3],
    weights: [f64; 3],
}

/// An address that is not on the sheet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AddressError {
    /// The point lies outside.
    #[error("the point ({:.3}, {:.3}) mm is not on the sheet: it is {distance_mm:.3} mm off; move it inside the outline", at.x, at.y)]
    Outside {
        /// The point, (u, v).
        at: DVec2,
        /// Its distance from the nearest triangle, mm.
        distance_mm: f64,
    },
    /// The pattern has no crease of this name.
    #[error("the pattern has no crease '{name}'; it has {known}")]
    NoCrease {
        /// The name.
        name: String,
        /// Names that it has.
        known: String,
    },
    /// The arc length is beyond the curve's end.
    #[error(
        "{at_mm} mm along {what} is beyond its end: it is {length_mm:.3} mm long; give 0 to that, or `share`"
    )]
    Beyond {
        /// Which curve.
        what: String,
        /// The arc length, mm.
        at_mm: f64,
        /// The curve's length, mm.
        length_mm: f64,
    },
    /// No vertex lies in the region.
    #[error("no vertex of the mesh lies in the region around ({:.3}, {:.3}) mm; make it larger or the mesh finer", around.x, around.y)]
    Empty {
        /// Mean of its corners, (u, v).
        around: DVec2,
    },
}

/// How far along a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlongCurve {
    /// Arc length from its start, mm.
    Length(f64),
    /// Share of its length, 0 to 1.
    Share(f64),
}

impl AlongCurve {
    fn on(self, curve: &PlanarCurve, what: impl Fn() -> String) -> Result<DVec2, AddressError> {
        let length_mm = curve.length_mm();
        match self {
            AlongCurve::Share(share) => Ok(curve.point(share * length_mm)),
            // A length that was read off a drawing may be rounded up.
            AlongCurve::Length(at_mm) if at_mm <= length_mm * (1.0 + REACH) => {
                Ok(curve.point(at_mm.min(length_mm)))
            }
            AlongCurve::Length(at_mm) => Err(AddressError::Beyond { what: what(), at_mm, length_mm }),
        }
    }
}

/// Most names that a message lists.
const LISTED: usize = 12;

/// The place (u, v) on a crease as it is drawn, at an arc length or share from its start.
///
/// # Errors
/// [`AddressError::NoCrease`], [`AddressError::Beyond`].
pub fn on_crease(pattern: &CreasePattern, name: &str, at: AlongCurve) -> Result<DVec2, AddressError> {
    let Some(crease) = pattern.creases.iter().find(|c| c.name == name) else {
        return Err(AddressError::NoCrease { name: name.to_owned(), known: listed(&pattern.creases) });
    };
    at.on(&crease.curve, || format!("the crease '{name}'"))
}

/// The first names of creases, and how many more there are: for messages.
pub fn listed(creases: &[Crease]) -> String {
    let names: Vec<&str> = creases.iter().take(LISTED).map(|c| c.name.as_str()).collect();
    match creases.len().saturating_sub(LISTED) {
        0 if names.is_empty() => "none".to_owned(),
        0 => names.join(", "),
        more => format!("{} and {more} more", names.join(", ")),
    }
}

/// The place (u, v) on the outline.
///
/// # Errors
/// [`AddressError::Beyond`].
pub fn on_outline(pattern: &CreasePattern, at: AlongCurve) -> Result<DVec2, AddressError> {
    at.on(&pattern.outline, || "the outline".to_owned())
}

/// The vertices in a polygon of the flat sheet, its border included.
///
/// # Errors
/// [`AddressError::Empty`] if there are none.
pub fn in_region(mesh: &FlatMesh, corners: &[DVec2]) -> Result<Vec<VertexId>, AddressError> {
    let (lo, hi) = polygon::bounds(&mesh.vertices);
    let near_mm = BORDER * (hi - lo).max_element();
    let inside = |p: DVec2| {
        polygon::contains(corners, p)
            || polygon::edges(corners).any(|(a, b)| polygon::segment_distance(p, a, b) <= near_mm)
    };
    let found: Vec<VertexId> =
        (0..mesh.vertices.len()).map(VertexId::new).filter(|v| inside(mesh.vertices[v.index()])).collect();
    let around = corners.iter().sum::<DVec2>() / corners.len().max(1) as f64;
    if found.is_empty() { Err(AddressError::Empty { around }) } else { Ok(found) }
}

/// Vertices this near to a region's border are in it: rounding. Share of the sheet's size.
const BORDER: f64 = 1e-9;

impl SheetPoint {
    /// A point from its corners and weights.
    pub fn new(vertices: [u32; 3], weights: [f64; 3]) -> Self {
        Self { vertices, weights }
    }

    /// A vertex.
    pub fn vertex(vertex: VertexId) -> Self {
        Self::new([vertex.0; 3], [1.0, 0.0, 0.0])
    }

    /// The corners.
    pub fn vertices(&self) -> [u32; 3] {
        self.vertices
    }

    /// Corners with their weights, those without weight left out.
    pub fn corners(self) -> impl Iterator<Item = (u32, f64)> {
        self.vertices.into_iter().zip(self.weights).filter(|c| c.1 != 0.0)
    }

    /// Its place in space.
    pub fn position(&self, x: &[DVec3]) -> DVec3 {
        self.corners().map(|(v, w)| w * x[v as usize]).sum()
    }

    /// Calls `f(i, j, wᵢ wⱼ)` for each pair of corners with i ≥ j.
    pub(crate) fn add_pairs(&self, mut f: impl FnMut(u32, u32, f64)) {
        for (i, wi) in self.corners() {
            self.corners().filter(|&(j, _)| j <= i).for_each(|(j, wj)| f(i, j, wi * wj));
        }
    }
}

/// How far outside its triangle a point may fall to count as on it: points on a curved outline lie
/// outside the chords that stand for it. Share of the sheet's size.
const REACH: f64 = 2e-3;

/// The point of the sheet at (u, v).
///
/// # Errors
/// [`AddressError::Outside`] if it is off the sheet.
pub fn locate(mesh: &FlatMesh, at: DVec2) -> Result<SheetPoint, AddressError> {
    let (lo, hi) = polygon::bounds(&mesh.vertices);
    let outside = |t: usize| {
        let [a, b, c] = mesh.corners(TriangleId::new(t));
        if polygon::contains(&[a, b, c], at) {
            return 0.0;
        }
        [(a, b), (b, c), (c, a)]
            .map(|(p, q)| polygon::segment_distance(at, p, q))
            .into_iter()
            .fold(f64::MAX, f64::min)
    };
    let nearest = (0..mesh.triangles.len()).map(|t| (t, outside(t))).min_by(|a, b| a.1.total_cmp(&b.1));
    match nearest {
        Some((t, distance)) if distance <= REACH * (hi - lo).max_element() => Ok(clamped_point(mesh, t, at)),
        other => Err(AddressError::Outside { at, distance_mm: other.map_or(f64::INFINITY, |n| n.1) }),
    }
}

fn clamped_point(mesh: &FlatMesh, triangle: usize, at: DVec2) -> SheetPoint {
    let [a, b, c] = mesh.corners(TriangleId::new(triangle));
    let whole = (b - a).perp_dot(c - a);
    let raw = [(b - at).perp_dot(c - at), (c - at).perp_dot(a - at), (a - at).perp_dot(b - at)];
    let weights = raw.map(|w| (w / whole).max(0.0));
    let sum: f64 = weights.iter().sum();
    SheetPoint::new(mesh.triangles[triangle].map(|v| v.0), weights.map(|w| w / sum))
}

/// Vertices of a boundary curve between two fractions of its length, running forward and
/// wrapping at 1.
pub fn boundary_vertices(mesh: &FlatMesh, loop_id: LoopId, length_mm: f64, range: [f64; 2]) -> Vec<u32> {
    let span = (range[1] - range[0]).rem_euclid(1.0);
    let inside = |v: &VertexId| (arc_length(mesh, *v) / length_mm - range[0]).rem_euclid(1.0) <= span;
    mesh.loop_vertices(loop_id).into_iter().filter(inside).map(|v| v.0).collect()
}

fn arc_length(mesh: &FlatMesh, v: VertexId) -> f64 {
    match mesh.sites[v.index()] {
        Site::Boundary { s_mm, .. } => s_mm,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;

    #[test]
    fn a_located_point_reproduces_its_place() {
        let mesh = strip(5, 4, 10.0);
        let x: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        for at in [DVec2::new(13.7, 22.2), DVec2::new(0.0, 0.0), DVec2::new(50.0, 40.0)] {
            assert!(locate(&mesh, at).unwrap().position(&x).truncate().distance(at) < 1e-9);
        }
        assert!(matches!(locate(&mesh, DVec2::new(80.0, 0.0)), Err(AddressError::Outside { .. })));
    }

    fn pattern() -> CreasePattern {
        let corners = [(0., 0.), (50., 0.), (50., 40.), (0., 40.), (0., 0.)].map(DVec2::from);
        let line = PlanarCurve::polyline(&[DVec2::new(20.0, 0.0), DVec2::new(20.0, 40.0)]).unwrap();
        CreasePattern {
            name: "p".into(),
            outline: PlanarCurve::polyline(&corners).unwrap(),
            holes: Vec::new(),
            slits: Vec::new(),
            creases: vec![Crease {
                id: softfold_geometry::CreaseId(0),
                name: "ridge".into(),
                curve: line,
                role: softfold_geometry::Role::Valley,
                fold_angle_rad: None,
                source: softfold_geometry::Source::default(),
            }],
        }
    }

    #[test]
    fn arc_lengths_and_shares_name_places_on_creases_and_the_outline() {
        let p = pattern();
        let at = DVec2::new(20.0, 30.0);
        assert!(on_crease(&p, "ridge", AlongCurve::Length(30.0)).unwrap().distance(at) < 1e-9);
        assert!(on_crease(&p, "ridge", AlongCurve::Share(0.75)).unwrap().distance(at) < 1e-9);
        let corner = on_outline(&p, AlongCurve::Share(0.5)).unwrap();
        assert!(corner.distance(DVec2::new(50.0, 40.0)) < 1e-9);
        let fault = on_crease(&p, "rim", AlongCurve::Share(0.5)).unwrap_err();
        assert_eq!(fault.to_string(), "the pattern has no crease 'rim'; it has ridge");
        let fault = on_crease(&p, "ridge", AlongCurve::Length(41.0)).unwrap_err().to_string();
        assert!(fault.contains("the crease 'ridge'") && fault.contains("40.000 mm long"), "{fault}");
        assert!(on_outline(&p, AlongCurve::Length(181.0)).is_err());
    }

    #[test]
    fn a_region_has_its_border() {
        let mesh = strip(5, 4, 10.0);
        let square = |x0: f64, x1: f64| [(x0, 0.), (x1, 0.), (x1, 20.), (x0, 20.)].map(DVec2::from);
        assert_eq!(in_region(&mesh, &square(10.0, 30.0)).unwrap().len(), 9);
        assert_eq!(in_region(&mesh, &square(12.0, 28.0)).unwrap().len(), 3);
        assert!(matches!(in_region(&mesh, &square(12.0, 13.0)), Err(AddressError::Empty { .. })));
    }

    #[test]
    fn a_range_of_the_outline_wraps_at_its_start() {
        let mesh = strip(5, 4, 10.0);
        let range = [170.0 / 180.0, 10.0 / 180.0];
        assert_eq!(boundary_vertices(&mesh, LoopId(0), 180.0, range).len(), 3);
        assert!(boundary_vertices(&mesh, LoopId(3), 180.0, range).is_empty());
    }
}
