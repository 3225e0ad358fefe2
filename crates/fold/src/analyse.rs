//! What folding did to the sheet: strain, turns, bend radius, developability.

use glam::{DMat2, DVec2, DVec3};
use softfold_geometry::{CreaseId, EdgeClass, EdgeId, Extreme, FoldedSheet, Site, TriangleId};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Figures of a folded sheet. Strains are relative (0.01 = 1 %).
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Largest |L/L₀ − 1| of an edge.
    pub max_edge_strain: Extreme,
    /// Smallest and largest A/A₀ − 1 of a triangle.
    pub area_error: [Extreme; 2],
    /// Smallest and largest principal strain of a triangle.
    pub principal_strain: [Extreme; 2],
    /// Largest |turn − rest| on fold lines, rad.
    pub max_turn_error_rad: Extreme,
    /// The same by crease.
    pub turn_error_by_crease_rad: BTreeMap<CreaseId, f64>,
    /// Smallest bend radius, mm.
    pub min_bend_radius_mm: Extreme,
    /// Largest |2π − Σ angles| at an inner vertex, rad.
    pub max_angle_defect_rad: Extreme,
    /// Area error of each vertex (area-weighted mean of its triangles), for pictures.
    pub vertex_area_error: Vec<f64>,
    /// Bend radius at each vertex, mm, for pictures; infinite where flat.
    pub vertex_bend_radius_mm: Vec<f64>,
}

/// Measures a folded sheet.
pub fn analyse(sheet: &FoldedSheet) -> Verdict {
    let area = per_triangle(sheet, |t| area_ratio(sheet, t) - 1.0);
    let strains = per_triangle(sheet, |t| principal_strains(sheet, t));
    let radius = vertex_bend_radii(sheet);
    let (max_turn_error_rad, turn_error_by_crease_rad) = turn_errors(sheet);
    Verdict {
        max_edge_strain: max_edge_strain(sheet),
        area_error: [least(sheet, &area), greatest(sheet, &area)],
        principal_strain: [
            least(sheet, &strains.iter().map(|s| s[0]).collect::<Vec<_>>()),
            greatest(sheet, &strains.iter().map(|s| s[1]).collect::<Vec<_>>()),
        ],
        max_turn_error_rad,
        turn_error_by_crease_rad,
        min_bend_radius_mm: min_radius(sheet, &radius),
        max_angle_defect_rad: max_angle_defect(sheet),
        vertex_area_error: to_vertices(sheet, &area),
        vertex_bend_radius_mm: radius,
    }
}

fn per_triangle<T>(sheet: &FoldedSheet, f: impl Fn(TriangleId) -> T) -> Vec<T> {
    (0..sheet.mesh.triangles.len()).map(|t| f(TriangleId::new(t))).collect()
}

fn centroid(sheet: &FoldedSheet, t: TriangleId) -> DVec2 {
    sheet.mesh.corners(t).into_iter().sum::<DVec2>() / 3.0
}

fn extreme(sheet: &FoldedSheet, values: &[f64], better: impl Fn(f64, f64) -> bool) -> Extreme {
    let mut best = Extreme { value: values.first().copied().unwrap_or(0.0), at: DVec2::ZERO };
    for (t, &value) in values.iter().enumerate() {
        if t == 0 || better(value, best.value) {
            best = Extreme { value, at: centroid(sheet, TriangleId::new(t)) };
        }
    }
    best
}

fn least(sheet: &FoldedSheet, values: &[f64]) -> Extreme {
    extreme(sheet, values, |a, b| a < b)
}

fn greatest(sheet: &FoldedSheet, values: &[f64]) -> Extreme {
    extreme(sheet, values, |a, b| a > b)
}

fn area_ratio(sheet: &FoldedSheet, t: TriangleId) -> f64 {
    let [a, b, c] = sheet.corners(t);
    0.5 * (b - a).cross(c - a).length() / sheet.mesh.triangle_area_mm2(t)
}

/// Singular values of the map from the flat triangle to the folded one, minus 1; the smaller first.
fn principal_strains(sheet: &FoldedSheet, t: TriangleId) -> [f64; 2] {
    let [p, q, r] = sheet.mesh.corners(t);
    let [a, b, c] = sheet.corners(t);
    let inverse = DMat2::from_cols(q - p, r - p).inverse();
    let column = |k: usize| inverse.col(k).x * (b - a) + inverse.col(k).y * (c - a);
    let (u, v): (DVec3, DVec3) = (column(0), column(1));
    // Eigenvalues of the metric.
    let (e, f, g) = (u.dot(u), u.dot(v), v.dot(v));
    let (mean, root) = (0.5 * (e + g), (0.25 * (e - g).powi(2) + f * f).sqrt());
    [(mean - root).max(0.0).sqrt() - 1.0, (mean + root).sqrt() - 1.0]
}

fn max_edge_strain(sheet: &FoldedSheet) -> Extreme {
    let mut best = Extreme::default();
    for (i, e) in sheet.mesh.edges.iter().enumerate() {
        let [a, b] = e.vertices;
        let rest = sheet.mesh.edge_length_mm(EdgeId::new(i));
        let strain = (sheet.position(a).distance(sheet.position(b)) / rest - 1.0).abs();
        if strain > best.value {
            best = Extreme {
                value: strain,
                at: 0.5 * (sheet.mesh.vertices[a.index()] + sheet.mesh.vertices[b.index()]),
            };
        }
    }
    best
}

fn turn_errors(sheet: &FoldedSheet) -> (Extreme, BTreeMap<CreaseId, f64>) {
    let mut best = Extreme::default();
    let mut by_crease = BTreeMap::new();
    for e in &sheet.mesh.edges {
        let (EdgeClass::Fold { crease, turn_rad, .. }, Some(turn)) = (e.class, sheet.turn_rad(e)) else {
            continue;
        };
        let error = (turn - turn_rad).abs();
        let worst: &mut f64 = by_crease.entry(crease).or_default();
        *worst = worst.max(error);
        if error > best.value {
            let [a, b] = e.vertices.map(|v| sheet.mesh.vertices[v.index()]);
            best = Extreme { value: error, at: 0.5 * (a + b) };
        }
    }
    (best, by_crease)
}

/// Radius at each vertex from the summed curvature tensors `θ L e⊥ e⊥ᵀ` of the edges in its one-ring (Cohen-Steiner &
/// Morvan 2003) over the ring's area: spokes count whole, edges of the ring by half, because half of their two
/// triangles lies in it.
fn vertex_bend_radii(sheet: &FoldedSheet) -> Vec<f64> {
    let n = sheet.positions.len();
    let mut tensor = vec![DMat2::ZERO; n];
    let mut area = vec![0.0; n];
    for t in 0..sheet.mesh.triangles.len() {
        let id = TriangleId::new(t);
        sheet.mesh.triangles[t].iter().for_each(|v| area[v.index()] += sheet.mesh.triangle_area_mm2(id));
    }
    for e in &sheet.mesh.edges {
        let Some(turn) = sheet.turn_rad(e) else { continue };
        let [a, b] = e.vertices;
        let along = sheet.mesh.vertices[b.index()] - sheet.mesh.vertices[a.index()];
        let across = along.perp().normalize_or_zero();
        let bend = turn * along.length() * DMat2::from_cols(across * across.x, across * across.y);
        // Ring edges count half to each end; spokes lie wholly in both rings.
        [a, b].iter().for_each(|v| tensor[v.index()] += bend);
        for t in e.triangles.iter().flatten() {
            tensor[sheet.mesh.opposite(*t, e.vertices).index()] += 0.5 * bend;
        }
    }
    (0..n).map(|i| radius_of(tensor[i], area[i])).collect()
}

fn radius_of(tensor: DMat2, area: f64) -> f64 {
    let (e, f, g) = (tensor.col(0).x, tensor.col(0).y, tensor.col(1).y);
    let (mean, root) = (0.5 * (e + g), (0.25 * (e - g).powi(2) + f * f).sqrt());
    let curvature = (mean.abs() + root) / area.max(f64::MIN_POSITIVE);
    1.0 / curvature
}

fn min_radius(sheet: &FoldedSheet, radii: &[f64]) -> Extreme {
    // Border rings are one-sided: they see half of the bend.
    let inner = (0..radii.len()).filter(|&i| !matches!(sheet.mesh.sites[i], Site::Boundary { .. }));
    let best = inner.min_by(|&a, &b| radii[a].total_cmp(&radii[b]));
    best.map_or(Extreme { value: f64::INFINITY, at: DVec2::ZERO }, |i| Extreme {
        value: radii[i],
        at: sheet.mesh.vertices[i],
    })
}

fn max_angle_defect(sheet: &FoldedSheet) -> Extreme {
    let mut sums = vec![0.0; sheet.positions.len()];
    for t in &sheet.mesh.triangles {
        for k in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|d| sheet.position(t[(k + d) % 3]));
            sums[t[k].index()] += (b - a).angle_between(c - a);
        }
    }
    let mut best = Extreme::default();
    for (i, sum) in sums.into_iter().enumerate() {
        let defect = (TAU - sum).abs();
        if !matches!(sheet.mesh.sites[i], Site::Boundary { .. }) && defect > best.value {
            best = Extreme { value: defect, at: sheet.mesh.vertices[i] };
        }
    }
    best
}

fn to_vertices(sheet: &FoldedSheet, values: &[f64]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); sheet.positions.len()];
    for (t, corners) in sheet.mesh.triangles.iter().enumerate() {
        let area = sheet.mesh.triangle_area_mm2(TriangleId::new(t));
        for v in corners {
            sums[v.index()].0 += area * values[t];
            sums[v.index()].1 += area;
        }
    }
    sums.into_iter().map(|(s, a)| if a > 0.0 { s / a } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;
    use softfold_geometry::SolveRecord;

    /// The strip with `f` from (u, v) to space.
    fn shaped(f: impl Fn(DVec2) -> DVec3) -> FoldedSheet {
        let mesh = strip(40, 10, 1.0);
        let positions = mesh.vertices.iter().map(|p| f(*p)).collect();
        FoldedSheet { mesh, positions, solve: SolveRecord::default() }
    }

    #[test]
    fn a_stretched_sheet_has_its_strains() {
        let v = analyse(&shaped(|p| DVec3::new(1.02 * p.x, 0.99 * p.y, 0.0)));
        assert!(
            (v.principal_strain[0].value + 0.01).abs() < 1e-12
                && (v.principal_strain[1].value - 0.02).abs() < 1e-12
        );
        assert!((v.area_error[0].value - (1.02 * 0.99 - 1.0)).abs() < 1e-12);
        assert!((v.max_edge_strain.value - 0.02).abs() < 1e-12);
        assert!(v.max_angle_defect_rad.value < 1e-12 && v.min_bend_radius_mm.value > 1e9);
    }

    #[test]
    fn a_cylinder_has_its_radius_and_no_defect() {
        let r = 25.0;
        let v = analyse(&shaped(|p| DVec3::new(r * (p.x / r).sin(), p.y, r * (1.0 - (p.x / r).cos()))));
        assert!((v.min_bend_radius_mm.value / r - 1.0).abs() < 0.03, "{}", v.min_bend_radius_mm.value);
        assert!(v.max_angle_defect_rad.value < 1e-9);
    }

    #[test]
    fn a_sphere_has_a_defect() {
        let r = 30.0;
        let v = analyse(&shaped(|p| {
            DVec3::new(p.x, p.y, (r * r - (p.x - 20.0).powi(2) - (p.y - 5.0).powi(2)).sqrt())
        }));
        // Gaussian curvature over a vertex's share of area, 1 mm².
        assert!(v.max_angle_defect_rad.value > 0.5 / (r * r));
    }
}
