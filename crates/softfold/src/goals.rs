//! From the project's anchors, bands and planes to goals on the mesh.

use crate::RunError;
use crate::project::{Anchor as AnchorEntry, Band, Plane, line_of_entry};
use crate::stages::Loaded;
use softfold_fold::{
    Anchor, ClampLength, Goal, OnPlane, SheetMaterial, SheetPoint, boundary_vertices, locate,
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

/// Everything that acts on the sheet: its own elasticity, then anchors, bands and planes in the project's order.
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
