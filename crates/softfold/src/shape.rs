//! The shape of the sheet's surface, place by place: what surface.ply, its pictures and its figures show.

use crate::compare::refined;
use crate::project::Project;
use crate::report::json;
use crate::stages::placement;
use softfold_geometry::{
    DVec2, DVec3, Extreme, FlatMesh, PlanarCurve, SheetSurface, SurfacePoint, TriMesh, polygon,
};
use softfold_surface::{
    BendShares, DOUBLE_BEND, LocalShape, Ruling, RulingOptions, SurfaceAnalysis, bend_shares, rulings,
};

/// Longest edge of the triangles that show the surface, in lattice spacings and as share of the sheet; the larger counts.
const EDGE_SPACINGS: f64 = 1.0;
const EDGE_SHARE: f64 = 0.004;
/// Most triangles of them.
const MOST_TRIANGLES: usize = 300_000;
/// Distance of rulings, share of the sheet, and the step along them in lattice spacings.
const RULING_SPACING: f64 = 0.016;
const RULING_STEP: f64 = 0.5;
/// A place is plane where its radius is larger than so many sheets.
const FLATTEST: f64 = 10.0;
/// Chord error of the outline that rulings end at, mm.
const CHORD_MM: f64 = 0.05;

/// The surface at many places, and its rulings.
#[derive(Clone, Debug)]
pub struct SheetShape {
    /// Places on the flat sheet, mm.
    pub places: Vec<DVec2>,
    /// Triangles between them.
    pub triangles: Vec<[u32; 3]>,
    /// The shape at each place.
    pub shapes: Vec<LocalShape>,
    /// Lines along which the sheet is straight.
    pub rulings: Vec<Ruling>,
    /// What counts as one.
    pub options: RulingOptions,
    /// How much of the sheet bends which way.
    pub shares: BendShares,
    /// Where the skins of the board lie along the normal, mm: the lower and the upper one.
    pub skins_mm: [f64; 2],
    /// Smallest radius that the material allows, mm.
    pub limit_mm: Option<f64>,
}

/// The shape of a surface of one or more faces over the flat mesh that it was made from. Triangles are halved until they are
/// as fine as the surface's lattice; rulings end at the edges of their face.
pub fn of(project: &Project, mesh: &FlatMesh, surfaces: &[SheetSurface], spacing_mm: f64) -> SheetShape {
    let flat = TriMesh {
        positions: mesh.vertices.iter().map(|p| p.extend(0.0)).collect(),
        triangles: mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect(),
    };
    let (low, high) = polygon::bounds(&mesh.vertices);
    let size_mm = (high - low).max_element();
    let fine = refined(&flat, (EDGE_SPACINGS * spacing_mm).max(EDGE_SHARE * size_mm), MOST_TRIANGLES);
    let options = RulingOptions {
        spacing_mm: RULING_SPACING * size_mm,
        step_mm: RULING_STEP * spacing_mm,
        most_double_bend: DOUBLE_BEND,
        flattest_radius_mm: FLATTEST * size_mm,
    };
    let places: Vec<DVec2> = fine.positions.iter().map(|p| p.truncate()).collect();
    let faces: Vec<Face<'_>> = surfaces.iter().map(Face::of).collect();
    let shapes: Vec<LocalShape> = places.iter().map(|p| shape(&faces, *p)).collect();
    let weights = corner_areas(&fine);
    let shares = bend_shares(shapes.iter().zip(weights), &options);
    let seeds = seeds(low, high, options.spacing_mm);
    let of_face =
        |face: &Face<'_>| rulings(&|p| face.inside(p).then(|| face.surface.spline.at(p)), &seeds, &options);
    let rulings = faces.iter().flat_map(of_face).collect();
    let skins_mm = placement(project).offsets_mm(project.board.thickness_mm);
    let limit_mm = radius_limit_mm(project);
    SheetShape { places, triangles: fine.triangles, shapes, rulings, options, shares, skins_mm, limit_mm }
}

/// A face with its trim as polygons.
struct Face<'a> {
    surface: &'a SheetSurface,
    loops: Vec<Vec<DVec2>>,
}

impl<'a> Face<'a> {
    fn of(surface: &'a SheetSurface) -> Self {
        Self { surface, loops: surface.trim.iter().map(|c: &PlanarCurve| c.flatten(CHORD_MM)).collect() }
    }

    /// Inside the outline and outside of the holes.
    fn inside(&self, p: DVec2) -> bool {
        self.loops.iter().filter(|l| polygon::contains(l, p)).count() % 2 == 1
    }

    fn distance_mm(&self, p: DVec2) -> f64 {
        let sides = self.loops.iter().flat_map(|l| polygon::edges(l));
        sides.map(|(a, b)| polygon::segment_distance(p, a, b)).fold(f64::INFINITY, f64::min)
    }
}

/// The shape at a place, of the face that it lies in or is nearest to; where the surface has no tangent plane, which no
/// fitted sheet has, that of its plane.
fn shape(faces: &[Face<'_>], at: DVec2) -> LocalShape {
    let nearest = || faces.iter().min_by(|a, b| a.distance_mm(at).total_cmp(&b.distance_mm(at)));
    let only = if let [face] = faces { Some(face) } else { None };
    let face = only.or_else(|| faces.iter().find(|f| f.inside(at)).or_else(nearest));
    let point = face.map_or_else(SurfacePoint::default, |f| f.surface.spline.at(at));
    LocalShape::of(&point).unwrap_or(LocalShape {
        position: point.position,
        normal: DVec3::Z,
        curvatures: [0.0; 2],
        directions: [DVec3::X, DVec3::Y],
        flat_directions: [DVec2::X, DVec2::Y],
        strains: [-1.0; 2],
        strain_direction: DVec2::X,
    })
}

/// A third of the area of the triangles around each vertex, mm².
fn corner_areas(mesh: &TriMesh) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = mesh.corners(*t);
        let third = (b - a).cross(c - a).length() / 6.0;
        t.iter().for_each(|v| areas[*v as usize] += third);
    }
    areas
}

/// A lattice over a rectangle.
fn seeds(low: DVec2, high: DVec2, step_mm: f64) -> Vec<DVec2> {
    let count = ((high - low) / step_mm).ceil();
    let (columns, rows) = (count.x as usize, count.y as usize);
    let at = |i: usize, j: usize| low + step_mm * DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
    (0..columns).flat_map(|i| (0..rows).map(move |j| at(i, j))).collect()
}

/// The smallest radius that a skin may have, mm: what the material says, or where its outer fibre reaches the strain that
/// it bears, t/(2 r_mid) = t/(2 (r_skin + t/2)) at the inner skin.
pub fn radius_limit_mm(project: &Project) -> Option<f64> {
    let material = &project.material;
    let by_strain = material.strain_limit.map(|e| 0.5 * project.board.thickness_mm * (1.0 / e - 1.0));
    [material.min_radius_mm, by_strain].into_iter().flatten().reduce(f64::max)
}

impl SheetShape {
    /// Positions in space, mm.
    pub fn positions(&self) -> Vec<DVec3> {
        self.shapes.iter().map(|s| s.position).collect()
    }

    /// The smaller of both skins' radii at each place, mm.
    pub fn skin_radii_mm(&self) -> Vec<f64> {
        let [lower, upper] = self.skins_mm;
        self.shapes.iter().map(|s| s.skin_radius_mm(lower).min(s.skin_radius_mm(upper))).collect()
    }

    /// The principal strain of larger size at each place.
    pub fn strains(&self) -> Vec<f64> {
        let larger = |[a, b]: [f64; 2]| if a.abs() > b.abs() { a } else { b };
        self.shapes.iter().map(|s| larger(s.strains)).collect()
    }

    /// The most extreme of a figure, here or elsewhere.
    fn extreme(
        &self,
        elsewhere: Extreme,
        figure: impl Fn(&LocalShape) -> f64,
        better: impl Fn(f64, f64) -> bool,
    ) -> Extreme {
        let here = self.shapes.iter().zip(&self.places).map(|(s, at)| Extreme { value: figure(s), at: *at });
        here.fold(elsewhere, |old, new| if better(new.value, old.value) { new } else { old })
    }

    /// The figures of the report; extremes are the larger ones of these places and of another look at the surface.
    pub fn figures(&self, extremes: &SurfaceAnalysis) -> json::SurfaceShape {
        let least = |values: Vec<f64>| {
            let least = (0..values.len()).reduce(|a, b| if values[b] < values[a] { b } else { a });
            least.map(|i| Extreme { value: values[i], at: self.places[i] }).unwrap_or_default()
        };
        let [lower, upper] =
            self.skins_mm.map(|d| least(self.shapes.iter().map(|s| s.skin_radius_mm(d)).collect()));
        let bow = |k: usize| self.rulings.iter().map(|r| r.bow[k]).fold(0.0, f64::max);
        let finite = |e: Extreme| e.value.is_finite().then_some(e.value);
        let radius = self.extreme(extremes.min_radius_mm, |s| s.radius_mm(), |new, old| new < old);
        let gauss = self.extreme(
            extremes.gaussian_curvature_per_mm2,
            |s| s.gaussian_per_mm2(),
            |new, old| new.abs() > old.abs(),
        );
        let [min, max] = extremes.principal_strain;
        let min = self.extreme(min, |s| s.strains[0], |new, old| new < old);
        let max = self.extreme(max, |s| s.strains[1], |new, old| new > old);
        json::SurfaceShape {
            min_radius_mm: finite(radius),
            min_radius_at: radius.at.to_array(),
            gaussian_curvature_per_mm2: gauss.value,
            gaussian_curvature_at: gauss.at.to_array(),
            principal_strain_min: min.value,
            principal_strain_min_at: min.at.to_array(),
            principal_strain_max: max.value,
            principal_strain_max_at: max.at.to_array(),
            lower_skin_radius_mm: finite(lower),
            lower_skin_radius_at: lower.at.to_array(),
            upper_skin_radius_mm: finite(upper),
            upper_skin_radius_at: upper.at.to_array(),
            radius_limit_mm: self.limit_mm,
            plane_share: self.shares.plane,
            developable_share: self.shares.one_way,
            doubly_bent_share: self.shares.both_ways,
            developable_to: self.options.most_double_bend,
            plane_beyond_radius_mm: self.options.flattest_radius_mm,
            rulings: self.rulings.len(),
            ruling_bow_flat: bow(0),
            ruling_bow_space: bow(1),
        }
    }
}
