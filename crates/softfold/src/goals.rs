//! From what holds, pulls and carries the sheet in the project to goals on the mesh.

use crate::RunError;
use crate::project::{
    Anchor as AnchorEntry, Band, Bending, OnCrease, OnOutline, Place, Plane, Scan, Spot, line_of_entry,
};
use crate::stages::Loaded;
use softfold_fold::{
    AlongCurve, Anchor, Area, ClampLength, CoPlanar, EARTH_GRAVITY, FaceBending, Floor, Glue, Goal, Load,
    OnCurve, OnMesh, OnPlane, SelfCollide, SelfCollideOptions, SheetMaterial, SheetPoint, SpaceCurve,
    SphereCollide, TriangleMesh, Weights, boundary_vertices, in_region, locate, on_crease, on_outline,
};
use softfold_geometry::{CreasePattern, DVec2, DVec3, FlatMesh, LoopId};
use softfold_kernel::openmesh;
use std::path::Path;

/// How far from the outline a point may be given that stands for a place on it, share of the outline's length.
const REACH: f64 = 5e-3;

/// The sheet that goals act on.
#[derive(Clone, Copy)]
struct Sheet<'a> {
    mesh: &'a FlatMesh,
    pattern: &'a CreasePattern,
}

/// An entry of an array of tables, for messages.
struct Entry<'a> {
    loaded: &'a Loaded,
    sheet: Sheet<'a>,
    array: &'static str,
    index: usize,
    name: &'a str,
}

/// Arc length or share, of which a checked project gives one.
fn along(length_mm: Option<f64>, share: Option<f64>) -> AlongCurve {
    length_mm.map(AlongCurve::Length).unwrap_or(AlongCurve::Share(share.unwrap_or_default()))
}

impl Entry<'_> {
    fn fault(&self, message: impl std::fmt::Display) -> RunError {
        let line = line_of_entry(&self.loaded.text, self.array, self.index);
        RunError::in_file(&self.loaded.path, line, format!("[[{}]] '{}': {message}", self.array, self.name))
    }

    /// (u, v) of a place.
    fn uv(&self, place: &Place) -> Result<DVec2, RunError> {
        let pattern = self.sheet.pattern;
        let found = match place {
            Place::Uv(uv) => Ok(DVec2::from(*uv)),
            Place::Crease(OnCrease { crease, at_mm, share }) => {
                on_crease(pattern, crease, along(*at_mm, *share))
            }
            Place::Outline(OnOutline { outline_mm, outline_share }) => {
                on_outline(pattern, along(*outline_mm, *outline_share))
            }
        };
        found.map_err(|e| self.fault(e))
    }

    fn point(&self, place: &Place) -> Result<SheetPoint, RunError> {
        locate(self.sheet.mesh, self.uv(place)?).map_err(|e| self.fault(e))
    }

    fn points(&self, spots: &[Spot]) -> Result<Vec<SheetPoint>, RunError> {
        let mut points = Vec::new();
        for spot in spots {
            match spot {
                Spot::Place(place) => points.push(self.point(place)?),
                Spot::Region(r) => {
                    points.extend(self.region(&r.region)?.into_iter().map(SheetPoint::vertex));
                }
            }
        }
        Ok(points)
    }

    fn region(&self, corners: &[[f64; 2]]) -> Result<Vec<softfold_geometry::VertexId>, RunError> {
        let corners: Vec<DVec2> = corners.iter().map(|p| DVec2::from(*p)).collect();
        in_region(self.sheet.mesh, &corners).map_err(|e| self.fault(e))
    }

    /// Share of the outline's length at the place nearest to one.
    fn on_outline(&self, place: &Place) -> Result<f64, RunError> {
        let outline = &self.sheet.pattern.outline;
        let at = self.uv(place)?;
        let (s_mm, distance_mm) = outline.nearest(at);
        let length_mm = outline.length_mm();
        if distance_mm > REACH * length_mm {
            let near = outline.point(s_mm);
            return Err(self.fault(format!(
                "the point ({:.3}, {:.3}) mm is {distance_mm:.1} mm off the outline; the nearest place on it is ({:.3}, {:.3}) mm",
                at.x, at.y, near.x, near.y
            )));
        }
        Ok(s_mm / length_mm)
    }
}

/// Everything that acts on the sheet: its own elasticity, then what the project says, kind after kind.
///
/// # Errors
/// Places that are not on the sheet or its outline.
pub fn goals(
    loaded: &Loaded,
    mesh: &FlatMesh,
    pattern: &CreasePattern,
) -> Result<Vec<Box<dyn Goal>>, RunError> {
    let fold = &loaded.project.fold;
    let sheet = Sheet { mesh, pattern };
    let mut goals = elastic(loaded, mesh);
    for (index, a) in fold.anchors.iter().enumerate() {
        goals.push(anchor(&Entry { loaded, sheet, array: "fold.anchors", index, name: &a.name }, a)?);
    }
    for (index, b) in fold.bands.iter().enumerate() {
        goals.push(band(&Entry { loaded, sheet, array: "fold.bands", index, name: &b.name }, b)?);
    }
    for (index, p) in fold.planes.iter().enumerate() {
        goals.push(plane(&Entry { loaded, sheet, array: "fold.planes", index, name: &p.name }, p)?);
    }
    goals.extend(more(loaded, sheet)?);
    Ok(goals)
}

/// Glues, coplanar points, rails, floors, loads, weight, areas, balls, and the sheet against itself.
fn more(loaded: &Loaded, sheet: Sheet<'_>) -> Result<Vec<Box<dyn Goal>>, RunError> {
    let mesh = sheet.mesh;
    let fold = &loaded.project.fold;
    let mut goals: Vec<Box<dyn Goal>> = Vec::new();
    for (index, g) in fold.glues.iter().enumerate() {
        let entry = Entry { loaded, sheet, array: "fold.glues", index, name: &g.name };
        let points = [entry.point(&g.from)?, entry.point(&g.to)?];
        goals.push(Box::new(Glue { name: g.name.clone(), points, stiffness: g.stiffness }));
    }
    for (index, c) in fold.coplanar.iter().enumerate() {
        let entry = Entry { loaded, sheet, array: "fold.coplanar", index, name: &c.name };
        let points = entry.points(&c.at)?;
        goals.push(Box::new(CoPlanar { name: c.name.clone(), points, stiffness: c.stiffness }));
    }
    for (index, r) in fold.rails.iter().enumerate() {
        let entry = Entry { loaded, sheet, array: "fold.rails", index, name: &r.name };
        let through: Vec<DVec3> = r.through.iter().map(|p| DVec3::from(*p)).collect();
        let target = SpaceCurve::polyline(&through).map_err(|e| entry.fault(e))?;
        let points = entry.points(&r.at)?;
        goals.push(Box::new(OnCurve { name: r.name.clone(), points, target, stiffness: r.stiffness }));
    }
    for (index, s) in fold.scans.iter().enumerate() {
        goals.push(scan(&Entry { loaded, sheet, array: "fold.scans", index, name: &s.name }, s)?);
    }
    for f in &fold.floors {
        goals.push(Box::new(Floor {
            name: f.name.clone(),
            vertices: (0..mesh.vertices.len() as u32).collect(),
            origin: f.origin.into(),
            normal: DVec3::from(f.normal).normalize_or(DVec3::Z),
            stiffness: f.stiffness,
        }));
    }
    for (index, l) in fold.loads.iter().enumerate() {
        let entry = Entry { loaded, sheet, array: "fold.loads", index, name: &l.name };
        goals.push(Box::new(Load::at(&l.name, entry.point(&l.at)?, l.force_n.into())));
    }
    if fold.self_weight {
        let (density, thickness) = (loaded.project.material.density_kg_m3, loaded.project.board.thickness_mm);
        goals.push(Box::new(Load::self_weight(mesh, density, thickness, EARTH_GRAVITY)));
    }
    goals.extend(fold.area_stiffness.map(|k| Box::new(Area::of_mesh(mesh, k)) as Box<dyn Goal>));
    if let Some(c) = &fold.collide {
        goals.push(Box::new(SphereCollide::of_mesh(mesh, c.diameter_mm, c.stiffness)));
    }
    if fold.self_collision.on {
        goals.push(Box::new(SelfCollide::of_mesh(mesh, self_collision(loaded))));
    }
    Ok(goals)
}

fn scan(entry: &Entry<'_>, s: &Scan) -> Result<Box<dyn Goal>, RunError> {
    let path = entry.loaded.path.parent().unwrap_or(Path::new("")).join(&s.file);
    let mend = "give a triangle mesh in mm as OBJ, PLY, STL or OFF, relative to the project file";
    let mesh = openmesh::read(&path).map_err(|e| entry.fault(format!("{e}; {mend}")))?;
    let corners: Vec<DVec3> = mesh.positions.iter().map(|p| DVec3::from(*p)).collect();
    let target = TriangleMesh::new(&corners, &mesh.triangles).map_err(|e| entry.fault(e))?;
    let points = entry.points(&s.at)?;
    Ok(Box::new(OnMesh { name: s.name.clone(), points, target, stiffness: s.stiffness }))
}

fn self_collision(loaded: &Loaded) -> SelfCollideOptions {
    let wanted = &loaded.project.fold.self_collision;
    let thickness_mm = wanted.thickness_mm.unwrap_or(loaded.project.board.thickness_mm);
    let stiffness = wanted.stiffness.unwrap_or_else(|| material(loaded).bending_stiffness());
    let usual = SelfCollideOptions::of_thickness(thickness_mm, stiffness);
    SelfCollideOptions { reach_mm: wanted.reach_mm.unwrap_or(usual.reach_mm), ..usual }
}

/// The sheet's own elasticity: by weights if the project gives them, else by its material.
fn elastic(loaded: &Loaded, mesh: &FlatMesh) -> Vec<Box<dyn Goal>> {
    if let Some(w) = &loaded.project.fold.weights {
        let weights = Weights { stretching: w.stretching, bending: w.bending, folding: w.folding };
        return weights.goals(mesh);
    }
    let faces = match loaded.project.material.bending {
        Bending::Hinges => FaceBending::Hinges,
        Bending::Plate => FaceBending::Plate,
    };
    material(loaded).goals_by(mesh, faces)
}

fn material(loaded: &Loaded) -> SheetMaterial {
    let material = &loaded.project.material;
    SheetMaterial {
        youngs_modulus_mpa: material.youngs_modulus_mpa,
        poisson_ratio: material.poisson_ratio,
        thickness_mm: loaded.project.board.thickness_mm,
        fold_line_factor: material.fold_line_factor,
    }
}

fn anchor(entry: &Entry<'_>, a: &AnchorEntry) -> Result<Box<dyn Goal>, RunError> {
    let (point, name) = (entry.point(&a.at)?, a.name.clone());
    Ok(Box::new(Anchor { name, point, target: a.target.into(), stiffness: a.stiffness.into() }))
}

fn band(entry: &Entry<'_>, b: &Band) -> Result<Box<dyn Goal>, RunError> {
    let ends = [entry.point(&b.from)?, entry.point(&b.to)?];
    Ok(Box::new(ClampLength { name: b.name.clone(), ends, rest_mm: b.rest_mm, stiffness: b.stiffness }))
}

fn plane(entry: &Entry<'_>, p: &Plane) -> Result<Box<dyn Goal>, RunError> {
    let vertices = match (&p.outline_from, &p.outline_to, &p.region) {
        (Some(from), Some(to), _) => {
            let range = [entry.on_outline(from)?, entry.on_outline(to)?];
            boundary_vertices(entry.sheet.mesh, LoopId(0), entry.sheet.pattern.outline.length_mm(), range)
        }
        (_, _, region) => {
            let region = region.as_deref().unwrap_or_default();
            entry.region(region)?.into_iter().map(|v| v.0).collect()
        }
    };
    if vertices.is_empty() {
        return Err(entry.fault("no vertex of the mesh lies between its two points; move them apart"));
    }
    Ok(Box::new(OnPlane {
        name: p.name.clone(),
        vertices,
        origin: p.origin.into(),
        normal: DVec3::from(p.normal).normalize_or(DVec3::Z),
        stiffness: p.stiffness,
    }))
}
