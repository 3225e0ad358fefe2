//! The conforming cage on sheets of known shape.

use super::fit::fit_conforming;
use super::flat::{FlatCage, flat_cage};
use super::grid::Cells;
use crate::testing::{rectangle, scattered};
use crate::{SurfaceError, SurfaceOptions};
use glam::{DVec2, DVec3};
use softfold_geometry::{
    EdgeClass, FlatMesh, LoopId, PlanarCurve, Segment, Site, SoftPattern, Tolerance, VertexId,
};

fn soft(loops: Vec<PlanarCurve>) -> SoftPattern {
    let tolerance = Tolerance::for_size(500.0);
    SoftPattern { loops, slits: Vec::new(), bands: Vec::new(), junctions: Vec::new(), tolerance }
}

fn cells(cell_mm: f64) -> Cells {
    Cells { cell_mm, per_strip: 1 }
}

/// An ellipse by four cubics.
fn ellipse(axes: DVec2) -> PlanarCurve {
    let k = 0.5522847498;
    let quarter = |i: usize| {
        let turn = |x: f64, y: f64| (0..i).fold(DVec2::new(x, y), |p, _| p.perp()) * axes;
        Segment::Cubic { from: turn(1., 0.), c1: turn(1., k), c2: turn(k, 1.), to: turn(0., 1.) }
    };
    PlanarCurve::new((0..4).map(quarter).collect()).unwrap()
}

/// Triangles in rings between two curves around the origin (inner first), or from the origin out.
fn rings(inner: Option<&PlanarCurve>, outer: &PlanarCurve, around: usize, rows: usize) -> FlatMesh {
    let at = |curve: &PlanarCurve, k: usize| curve.point(curve.length_mm() * k as f64 / around as f64);
    let first = if inner.is_some() { 0 } else { 1 };
    let mut vertices: Vec<DVec2> = if inner.is_some() { Vec::new() } else { vec![DVec2::ZERO] };
    for row in first..=rows {
        let share = row as f64 / rows as f64;
        vertices
            .extend((0..around).map(|k| inner.map_or(DVec2::ZERO, |c| at(c, k)).lerp(at(outer, k), share)));
    }
    let id = |row: usize, k: usize| match row {
        0 if first == 1 => VertexId::new(0),
        _ => VertexId::new(first + (row - first) * around + k % around),
    };
    let mut triangles = Vec::new();
    for row in 0..rows {
        for k in 0..around {
            let [a, b, c, d] = [id(row, k), id(row + 1, k), id(row + 1, k + 1), id(row, k + 1)];
            triangles.push([a, b, c]);
            if a != d {
                triangles.push([a, c, d]);
            }
        }
    }
    let sites = vec![Site::Interior; vertices.len()];
    let outermost = vertices.len() - around;
    FlatMesh::new(vertices, sites, triangles, |[a, _], boundary| match (boundary, a.index() >= outermost) {
        (false, _) => EdgeClass::Facet,
        (true, true) => EdgeClass::Boundary { loop_id: LoopId(0) },
        (true, false) => EdgeClass::Boundary { loop_id: LoopId(1) },
    })
}

fn disk(cell_mm: f64) -> FlatCage {
    let outline = ellipse(DVec2::new(150.0, 100.0));
    flat_cage(&rings(None, &outline, 96, 16), &soft(vec![outline.clone()]), cells(cell_mm)).unwrap()
}

#[test]
fn a_rectangle_has_nothing_but_right_angles() {
    let size = DVec2::new(120.0, 80.0);
    let sheet = scattered(size, 10.0, |p| p.extend(0.0));
    let cage = flat_cage(&sheet.mesh, &soft(rectangle(size)), cells(10.0)).unwrap();
    assert_eq!((cage.quality.quads, cage.quality.inner_vertices), (96, 77));
    assert!(cage.quality.irregular.is_empty());
    assert!(cage.quality.min_angle_rad.to_degrees() > 89.9, "{:?}", cage.quality);
}

#[test]
fn an_ellipse_has_four_inner_vertices_of_valence_three_and_no_angle_below_45_degrees() {
    for cell_mm in [12.0, 8.0] {
        let q = disk(cell_mm).quality;
        assert_eq!(q.irregular.iter().map(|i| i.1).collect::<Vec<_>>(), [3; 4]);
        assert!(q.min_angle_rad.to_degrees() >= 45.0, "{cell_mm} {q:?}");
    }
}

#[test]
fn the_border_is_on_the_outline_and_so_is_that_of_the_limit() {
    let outline = ellipse(DVec2::new(150.0, 100.0));
    let cage = disk(10.0);
    for &v in cage.borders.iter().flatten() {
        assert!(outline.nearest(cage.quads.points[v as usize]).1 < 1e-9);
    }
}

#[test]
fn a_ring_with_a_hole_is_all_quads_with_two_borders() {
    let (outer, inner) = (ellipse(DVec2::splat(200.0)), ellipse(DVec2::splat(90.0)));
    let mesh = rings(Some(&inner), &outer, 96, 9);
    let cage = flat_cage(&mesh, &soft(vec![outer, inner.reversed()]), cells(12.0)).unwrap();
    assert_eq!(cage.borders.len(), 2);
    assert!(cage.quality.min_angle_rad.to_degrees() >= 45.0, "{:?}", cage.quality);
}

#[test]
fn a_corner_sharper_than_45_degrees_is_excused_with_its_place() {
    let corners = [(0., 0.), (300., 0.), (300., 100.), (119.2, 100.), (0., 0.)].map(DVec2::from);
    let outline = PlanarCurve::polyline(&corners).unwrap();
    let centre = DVec2::new(170.0, 50.0);
    let moved = PlanarCurve::polyline(&corners.map(|c| c - centre)).unwrap();
    let mut mesh = rings(None, &moved, 60, 10);
    // The corners of the sheet are vertices of its mesh.
    for c in corners {
        let near = |v: &usize| mesh.vertices[*v].distance(c - centre);
        let v = (0..mesh.vertices.len()).min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
        mesh.vertices[v] = c - centre;
    }
    mesh.vertices.iter_mut().for_each(|p| *p += centre);
    let cage = flat_cage(&mesh, &soft(vec![outline]), cells(10.0)).unwrap();
    let excused = &cage.quality.excused;
    assert!(!excused.is_empty() && excused.iter().all(|e| e.at.length() < 10.0), "{excused:?}");
    assert!(cage.quality.min_angle_rad.to_degrees() >= 45.0, "{:?}", cage.quality);
}

#[test]
fn a_sheet_narrower_than_a_cell_is_one_row_or_refused_with_a_mend() {
    let size = DVec2::new(120.0, 8.0);
    let sheet = scattered(size, 4.0, |p| p.extend(0.0));
    match flat_cage(&sheet.mesh, &soft(rectangle(size)), cells(60.0)) {
        Ok(cage) => assert!(cage.quality.min_angle_rad > 0.78),
        Err(e) => assert!(e.to_string().contains("surface.spacing_mm"), "{e}"),
    }
}

/// Rolled about v.
fn cylinder(radius: f64) -> impl Fn(DVec2) -> DVec3 {
    move |p| DVec3::new(radius * (p.x / radius).sin(), p.y, radius * (1.0 - (p.x / radius).cos()))
}

#[test]
fn the_limit_on_a_cylinder_converges_at_fourth_order() {
    let (size, radius) = (DVec2::new(160.0, 96.0), 60.0);
    let sheet = scattered(size, 2.0, cylinder(radius));
    let error = |spacing_mm: f64| {
        let options = SurfaceOptions {
            spacing_mm: Some(spacing_mm),
            bending_weight: 1e-9,
            ..SurfaceOptions::default()
        };
        let made = fit_conforming(&sheet, &soft(rectangle(size)), &options).unwrap();
        let mut worst: f64 = 0.0;
        for face in &made.surface.faces {
            for k in 0..400 {
                let share = DVec2::new(f64::from(k % 20) + 0.5, f64::from(k / 20) + 0.5) / 20.0;
                let n = DVec2::new(face.count[0] as f64, face.count[1] as f64) - 3.0;
                let (p, _, flat) = face.at(share.x * n.x, share.y * n.y);
                let inside = flat.x.min(size.x - flat.x).min(flat.y).min(size.y - flat.y) > 33.0;
                if inside {
                    worst = worst.max((DVec2::new(p.x, p.z - radius).length() - radius).abs());
                }
            }
        }
        worst
    };
    let errors = [16.0, 8.0, 4.0].map(error);
    for w in errors.windows(2) {
        assert!((w[0] / w[1]).log2() > 3.5, "{errors:?}");
    }
}

#[test]
fn faces_are_few_share_their_edges_and_are_smooth() {
    let outline = ellipse(DVec2::new(150.0, 100.0));
    let mesh = rings(None, &outline, 96, 16);
    let positions = mesh.vertices.iter().map(|p| cylinder(120.0)(*p)).collect();
    let sheet = softfold_geometry::FoldedSheet { mesh, positions, solve: Default::default() };
    let made = fit_conforming(&sheet, &soft(vec![outline]), &SurfaceOptions::default()).unwrap();
    assert!(made.tolerance_met, "{}", made.why);
    assert!(made.joins.regular.unwrap().angle_rad.to_degrees() < 0.1, "{:?}", made.joins);
    let open = made.surface.edges.iter().filter(|e| e.uses.len() == 1).count();
    assert!(made.surface.edges.iter().all(|e| (1..=2).contains(&e.uses.len())));
    assert!(open > 0 && made.surface.faces.len() < made.patches);
    let (shell, gap_mm) = made.surface.to_shell().unwrap();
    assert!(softfold_kernel::occt::check(&shell).unwrap().is_empty());
    assert!(gap_mm < 1e-3, "{gap_mm}");
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let sheet = scattered(DVec2::splat(40.0), 10.0, |p| p.extend(0.0));
    let options = SurfaceOptions { tolerance_mm: -1.0, ..SurfaceOptions::default() };
    let found = fit_conforming(&sheet, &soft(rectangle(DVec2::splat(40.0))), &options);
    assert!(matches!(found, Err(SurfaceError::NotPositive { key: "tolerance_mm", .. })));
}
