//! From what holds, pulls and carries the sheet in the project to goals on the mesh.

use crate::RunError;
use crate::project::{Anchor as AnchorEntry, Band, Plane, line_of_entry};
use crate::stages::Loaded;
use softfold_fold::{
    Anchor, Area, ClampLength, CoPlanar, EARTH_GRAVITY, Floor, Glue, Goal, Load, OnCurve, OnPlane,
    SheetMaterial, SheetPoint, SpaceCurve, SphereCollide, boundary_vertices, locate,
};
use softfold_geometry::{DVec2, DVec3, FlatMesh, LoopId, PlanarCurve};

/// How far from the outline a point may be given that stands for a place on it, share of the outline's length.
const REACH: f64 = 5e-3;

/// An entry of an array of tables, for messages.
struct Entry<'a> {
    loaded: &'a Loaded,
    array: &'static str,
    index: usize,
    name: &'a str,
}

impl Entry<'_> {
    fn fault(&self, message: impl std::fmt::Display) -> RunError {
        let line = line_of_entry(&self.loaded.text, self.array, self.index);
        RunError::in_file(&self.loaded.path, line, format!("[[{}]] '{}': {message}", self.array, self.name))
    }

    fn point(&self, mesh: &FlatMesh, uv: [f64; 2]) -> Result<SheetPoint, RunError> {
        locate(mesh, DVec2::from(uv)).map_err(|e| self.fault(e))
    }

    fn points(&self, mesh: &FlatMesh, uvs: &[[f64; 2]]) -> Result<Vec<SheetPoint>, RunError> {
        uvs.iter().map(|uv| self.point(mesh, *uv)).collect()
    }

    /// Share of the outline's length at the place nearest to `uv`.
    fn on_outline(&self, outline: &PlanarCurve, uv: [f64; 2]) -> Result<f64, RunError> {
        let (s_mm, distance_mm) = outline.nearest(DVec2::from(uv));
        let (length_mm, [u, v]) = (outline.length_mm(), uv);
        if distance_mm > REACH * length_mm {
            let near = outline.point(s_mm);
            return Err(self.fault(format!(
                "the point ({u:.3}, {v:.3}) mm is {distance_mm:.1} mm off the outline; the nearest place on it is ({:.3}, {:.3}) mm",
                near.x, near.y
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
    outline: &PlanarCurve,
) -> Result<Vec<Box<dyn Goal>>, RunError> {
    let fold = &loaded.project.fold;
    let mut goals = elastic(loaded).goals(mesh);
    for (index, a) in fold.anchors.iter().enumerate() {
        goals.push(anchor(&Entry { loaded, array: "fold.anchors", index, name: &a.name }, a, mesh)?);
    }
    for (index, b) in fold.bands.iter().enumerate() {
        goals.push(band(&Entry { loaded, array: "fold.bands", index, name: &b.name }, b, mesh)?);
    }
    for (index, p) in fold.planes.iter().enumerate() {
        goals.push(plane(&Entry { loaded, array: "fold.planes", index, name: &p.name }, p, mesh, outline)?);
    }
    goals.extend(more(loaded, mesh)?);
    Ok(goals)
}

/// Glues, coplanar points, rails, floors, loads, weight, areas and balls.
fn more(loaded: &Loaded, mesh: &FlatMesh) -> Result<Vec<Box<dyn Goal>>, RunError> {
    let fold = &loaded.project.fold;
    let mut goals: Vec<Box<dyn Goal>> = Vec::new();
    for (index, g) in fold.glues.iter().enumerate() {
        let entry = Entry { loaded, array: "fold.glues", index, name: &g.name };
        let points = [entry.point(mesh, g.from)?, entry.point(mesh, g.to)?];
        goals.push(Box::new(Glue { name: g.name.clone(), points, stiffness: g.stiffness }));
    }
    for (index, c) in fold.coplanar.iter().enumerate() {
        let entry = Entry { loaded, array: "fold.coplanar", index, name: &c.name };
        let points = entry.points(mesh, &c.at)?;
        goals.push(Box::new(CoPlanar { name: c.name.clone(), points, stiffness: c.stiffness }));
    }
    for (index, r) in fold.rails.iter().enumerate() {
        let entry = Entry { loaded, array: "fold.rails", index, name: &r.name };
        let through: Vec<DVec3> = r.through.iter().map(|p| DVec3::from(*p)).collect();
        let target = SpaceCurve::polyline(&through).map_err(|e| entry.fault(e))?;
        let points = entry.points(mesh, &r.at)?;
        goals.push(Box::new(OnCurve { name: r.name.clone(), points, target, stiffness: r.stiffness }));
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
        let entry = Entry { loaded, array: "fold.loads", index, name: &l.name };
        goals.push(Box::new(Load::at(&l.name, entry.point(mesh, l.at)?, l.force_n.into())));
    }
    if fold.self_weight {
        let (density, thickness) = (loaded.project.material.density_kg_m3, loaded.project.board.thickness_mm);
        goals.push(Box::new(Load::self_weight(mesh, density, thickness, EARTH_GRAVITY)));
    }
    goals.extend(fold.area_stiffness.map(|k| Box::new(Area::of_mesh(mesh, k)) as Box<dyn Goal>));
    if let Some(c) = &fold.collide {
        goals.push(Box::new(SphereCollide::of_mesh(mesh, c.diameter_mm, c.stiffness)));
    }
    Ok(goals)
}

fn elastic(loaded: &Loaded) -> SheetMaterial {
    let material = &loaded.project.material;
    SheetMaterial {
        youngs_modulus_mpa: material.youngs_modulus_mpa,
        poisson_ratio: material.poisson_ratio,
        thickness_mm: loaded.project.board.thickness_mm,
        fold_line_factor: material.fold_line_factor,
    }
}

fn anchor(entry: &Entry<'_>, a: &AnchorEntry, mesh: &FlatMesh) -> Result<Box<dyn Goal>, RunError> {
    let (point, name) = (entry.point(mesh, a.at)?, a.name.clone());
    Ok(Box::new(Anchor { name, point, target: a.target.into(), stiffness: a.stiffness.into() }))
}

fn band(entry: &Entry<'_>, b: &Band, mesh: &FlatMesh) -> Result<Box<dyn Goal>, RunError> {
    let ends = [entry.point(mesh, b.from)?, entry.point(mesh, b.to)?];
    Ok(Box::new(ClampLength { name: b.name.clone(), ends, rest_mm: b.rest_mm, stiffness: b.stiffness }))
}

fn plane(
    entry: &Entry<'_>,
    p: &Plane,
    mesh: &FlatMesh,
    outline: &PlanarCurve,
) -> Result<Box<dyn Goal>, RunError> {
    let range = [entry.on_outline(outline, p.outline_from)?, entry.on_outline(outline, p.outline_to)?];
    let vertices = boundary_vertices(mesh, LoopId(0), outline.length_mm(), range);
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
