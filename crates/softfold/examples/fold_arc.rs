//! A sheet with one curved crease, folded from code: no project file, no pipeline. Writes `fold_arc.obj`, or the path given.
//!
//! `cargo run --example fold_arc`

use softfold::export::obj;
use softfold_fold::{FaceBending, SheetMaterial, Solver, analyse, fold, upright};
use softfold_geometry::{Crease, CreaseId, CreasePattern, DVec2, PlanarCurve, Role, Segment, Source};
use softfold_mesh::{MeshOptions, mesh};
use softfold_soften::{CreaseSoftness, Segments, soften};
use std::error::Error;
use std::path::Path;

/// An arc from side to side of a sheet of 300 × 200 mm.
fn pattern() -> Result<CreasePattern, Box<dyn Error>> {
    let corners = [(0.0, 0.0), (300.0, 0.0), (300.0, 200.0), (0.0, 200.0), (0.0, 0.0)].map(DVec2::from);
    let (from, to, half_angle) = (DVec2::new(0.0, 80.0), DVec2::new(300.0, 80.0), 35f64.to_radians());
    let radius = 0.5 * from.distance(to) / half_angle.sin();
    let reach = 4.0 / 3.0 * (0.5 * half_angle).tan() * radius * DVec2::from_angle(half_angle);
    let arc = Segment::Cubic { from, c1: from + reach, c2: to + reach * DVec2::new(-1.0, 1.0), to };
    let crease = Crease {
        id: CreaseId(0),
        name: "arc".to_owned(),
        role: Role::Valley,
        curve: PlanarCurve::new(vec![arc])?,
        fold_angle_rad: None,
        source: Source::default(),
    };
    let outline = PlanarCurve::polyline(&corners)?;
    Ok(CreasePattern { name: "arc".to_owned(), outline, holes: vec![], slits: vec![], creases: vec![crease] })
}

/// Softens the crease, meshes the sheet, folds it and writes it.
pub(crate) fn run(path: &Path) -> Result<(), Box<dyn Error>> {
    let softness = CreaseSoftness::constant(10.0, 80f64.to_radians(), Segments::Count(4));
    let soft = soften(&pattern()?, &[softness])?;
    let flat = mesh(&soft, &MeshOptions { target_edge_mm: 12.0, ..MeshOptions::default() })?.mesh;
    let paper = SheetMaterial {
        youngs_modulus_mpa: 3000.0,
        poisson_ratio: 0.3,
        thickness_mm: 1.0,
        fold_line_factor: 10.0,
    };
    let goals = paper.goals_by(&flat, FaceBending::Plate);
    let sheet = fold(&flat, &goals, &upright(&flat), &Solver::default(), &mut |_| ())?;
    let triangles: Vec<[u32; 3]> = flat.triangles.iter().map(|t| t.map(|v| v.0)).collect();
    let turn_error_deg = analyse(&sheet).max_turn_error_rad.value.to_degrees();
    let title = format!("arc, {}; folds within {turn_error_deg:.1} degrees", sheet.solve.stop);
    std::fs::write(path, obj::mesh(&title, &sheet.positions, &triangles))?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(Path::new(&std::env::args().nth(1).unwrap_or_else(|| "fold_arc.obj".to_owned())))
}
