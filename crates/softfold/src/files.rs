//! The files of a run: what there is, under which name, and what it is for.

use crate::export::dxf::{Drawing, Entity, Layer, colour};
use crate::export::{fold, obj, off, ply, stl, threemf};
use crate::output::Staging;
use crate::pictures::{area_scale, on_stock, pictures, strip};
use crate::project::{Export, ShapeFormat};
use crate::report::{html, json, mesh_plan::mesh_svg};
use crate::shape_pictures::surface_ply;
use crate::stages::{Loaded, Results};
use crate::{RunError, record};
use softfold_geometry::{DVec2, DVec3, FlatMesh, PlanarCurve, SoftPattern, TriMesh};
use softfold_kernel::occt::{self, IgesOptions, Material, NamedShape, Shape, StepOptions};
use softfold_kernel::{KernelError, openmesh};
use softfold_mold::{Contour, Mold, Part, Placed, ProfileSegment, WaffleBoard};
use std::path::Path;
use std::time::Instant;

/// Chord error of curves in DXF, mm: what routers and CAM programs ask for.
const DXF_CHORD_MM: f64 = 0.02;
/// A file that every run writes and that users are likely to have: better said before the run than after it.
pub const FIRST: &[&str] = &["pattern.svg"];
/// Colours of the STEP files (sRGB): plaster for sheet and board, blue for the mold.
const SHEET_COLOUR: [f32; 3] = [0.87, 0.84, 0.78];
const MOLD_COLOUR: [f32; 3] = [0.35, 0.52, 0.75];

/// Collects files in the staging folder with what they are for.
struct Writer<'a> {
    staging: &'a Staging,
    files: Vec<json::File>,
    name: String,
    export: &'a Export,
    /// The board's.
    material: Material<'a>,
}

/// An exact shape that goes into files of all formats that are asked for.
struct Exact<'a> {
    /// Path without the ending.
    path: &'a str,
    purpose: &'a str,
    name: &'a str,
    color_srgb: [f32; 3],
    material: Option<Material<'a>>,
    shape: &'a Shape,
}

/// Writes everything a run has made into `out` and gives the report. The folder is as it was if anything fails.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(loaded: &Loaded, results: &mut Results, out: &Path) -> Result<json::Report, RunError> {
    let start = Instant::now();
    let staging = Staging::beside(out)?;
    let of = &loaded.project.material;
    let mut writer = Writer {
        staging: &staging,
        files: Vec::new(),
        name: loaded.name(),
        export: &loaded.project.export,
        material: Material { name: &of.name, density_kg_m3: of.density_kg_m3 },
    };
    writer.patterns(results)?;
    writer.meshes(results)?;
    writer.surfaces(results)?;
    if let Some(mold) = &results.mold {
        writer.mold(mold, results.stock_mm)?;
    }
    results.seconds.push(("export", start.elapsed().as_secs_f64()));
    let report = writer.report(loaded, results)?;
    staging.publish()?;
    Ok(report)
}

fn defect(error: impl std::fmt::Display) -> RunError {
    RunError::Defect(error.to_string())
}

fn crease_names(results: &Results) -> Vec<String> {
    results.pattern.iter().flat_map(|p| &p.creases).map(|c| c.name.clone()).collect()
}

/// A place that cannot be written is the user's, the rest is ours.
fn unwritten(error: &KernelError) -> RunError {
    match error {
        KernelError::File { .. } => RunError::Input(format!("{error}; choose another --out")),
        other => defect(other),
    }
}

/// A file that does not come back as it was written would surprise somebody at a machine.
fn require_read_back(found: &[&Shape], file: &str, shape: &Shape) -> Result<(), RunError> {
    let wanted = occt::counts(shape).map_err(defect)?;
    let [found] = found else {
        return Err(RunError::Defect(format!("{file} reads back as {} parts", found.len())));
    };
    let found = occt::counts(found).map_err(defect)?;
    if (found.solids, found.faces) == (wanted.solids, wanted.faces) {
        return Ok(());
    }
    Err(RunError::Defect(format!("{file} reads back as {found:?}, not {wanted:?}")))
}

impl<'a> Exact<'a> {
    fn named(&self) -> NamedShape<'a> {
        let Self { name, color_srgb, material, shape, .. } = *self;
        NamedShape { name, color_srgb, material, shape }
    }
}

/// What the files say made them.
const SYSTEM: &str = concat!("softfold ", env!("CARGO_PKG_VERSION"));

impl Writer<'_> {
    fn add(&mut self, path: &str, purpose: &str, bytes: impl AsRef<[u8]>) -> Result<(), RunError> {
        self.staging.write(path, bytes)?;
        self.listed(path, purpose);
        Ok(())
    }

    fn listed(&mut self, path: &str, purpose: &str) {
        self.files.push(json::File { path: path.to_owned(), purpose: purpose.to_owned() });
    }

    /// Writes a shape in every format that is asked for, and reads it back.
    fn exact(&mut self, exact: &Exact<'_>) -> Result<(), RunError> {
        for format in [ShapeFormat::Step, ShapeFormat::Iges, ShapeFormat::Brep] {
            if self.export.wants(format) {
                let path = format!("{}.{}", exact.path, format.ending());
                let file = self.staging.path(&path)?;
                match format {
                    ShapeFormat::Step => self.step(exact, &file)?,
                    ShapeFormat::Iges => self.iges(exact, &file)?,
                    ShapeFormat::Brep => self.brep(exact, &file)?,
                }
                self.listed(&path, exact.purpose);
            }
        }
        Ok(())
    }

    fn step(&self, exact: &Exact<'_>, file: &Path) -> Result<(), RunError> {
        let options = StepOptions {
            schema: self.export.step_schema.step(),
            product: exact.name.to_owned(),
            system: SYSTEM.to_owned(),
            ..StepOptions::default()
        };
        occt::write_step(file, &[exact.named()], &options).map_err(|e| unwritten(&e))?;
        let parts = occt::read_step(file).map_err(defect)?;
        if parts.iter().any(|p| p.name != exact.name) {
            return Err(RunError::Defect(format!(
                "{}: the STEP file reads back under another name",
                exact.name
            )));
        }
        let shapes: Vec<&Shape> = parts.iter().map(|p| &p.shape).collect();
        require_read_back(&shapes, &file.display().to_string(), exact.shape)
    }

    fn iges(&self, exact: &Exact<'_>, file: &Path) -> Result<(), RunError> {
        let product = exact.name.to_owned();
        let options = IgesOptions { product, system: SYSTEM.to_owned(), ..IgesOptions::default() };
        occt::write_iges(file, &[exact.named()], &options).map_err(|e| unwritten(&e))?;
        let parts = occt::read_iges(file).map_err(defect)?;
        let shapes: Vec<&Shape> = parts.iter().map(|p| &p.shape).collect();
        require_read_back(&shapes, &file.display().to_string(), exact.shape)
    }

    fn brep(&self, exact: &Exact<'_>, file: &Path) -> Result<(), RunError> {
        occt::write_brep(file, exact.shape).map_err(|e| unwritten(&e))?;
        let shape = occt::read_brep(file).map_err(defect)?;
        require_read_back(&[&shape], &file.display().to_string(), exact.shape)
    }

    fn patterns(&mut self, results: &Results) -> Result<(), RunError> {
        if let Some(pattern) = &results.pattern {
            self.add("pattern.svg", "the pattern as it was read", softfold_pattern::write_svg(pattern))?;
            if let Some(soft) = &results.soft {
                let drawing = softfold_soften::write_svg(pattern, soft);
                self.add("soft.svg", "the pattern with its bands, fold lines and turns", drawing)?;
                let blank = blank(soft).to_dxf().map_err(defect)?;
                self.add("blank.dxf", "the flat sheet: outline to cut, fold lines to mark", blank)?;
            }
        }
        Ok(())
    }

    fn meshes(&mut self, results: &Results) -> Result<(), RunError> {
        let Some(m) = &results.mesh else { return Ok(()) };
        let mesh = &m.meshed.mesh;
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| v.0)).collect();
        let flat: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        self.flat_mesh(results, mesh, &flat, &triangles)?;
        let Some(f) = &results.fold else { return Ok(()) };
        self.add("folded.obj", "the folded mesh", obj::mesh(&self.name, &f.sheet.positions, &triangles))?;
        let creases = crease_names(results);
        let text =
            fold::folded(&f.sheet, fold::Titles { title: &self.name, creases: &creases }).map_err(defect)?;
        self.add("folded.fold", "flat and folded mesh with creases and angles", text)?;
        if !f.states.is_empty() {
            let states = f.states.iter().map(|s| (s.name.as_str(), &s.sheet));
            let text = fold::states(mesh, states, fold::Titles { title: &self.name, creases: &creases });
            self.add("states.fold", "all states of folding, a frame each", text.map_err(defect)?)?;
            self.add("states.png", "all states of folding side by side", strip(&f.states)?.png)?;
        }
        let Some(a) = &results.analyse else { return Ok(()) };
        let v = &a.verdict;
        let colours = area_scale(v).0.colours(&v.vertex_area_error);
        let scalars = [
            ply::Scalar { name: "area_error", values: &v.vertex_area_error },
            ply::Scalar { name: "bend_radius", values: &v.vertex_bend_radius_mm },
        ];
        let bytes = ply::coloured(&self.name, &f.sheet.positions, &triangles, &colours, &scalars);
        self.add("folded.ply", "the folded mesh coloured by area error", bytes)
    }

    fn flat_mesh(
        &mut self,
        results: &Results,
        mesh: &FlatMesh,
        flat: &[DVec3],
        triangles: &[[u32; 3]],
    ) -> Result<(), RunError> {
        self.add(
            "flat.obj",
            "the flat mesh with its fold lines and boundaries",
            obj::flat(&self.name, mesh),
        )?;
        self.add("flat.ply", "the flat mesh with the class of every edge", ply::flat(&self.name, mesh))?;
        self.add("flat.off", "the flat mesh, triangles alone", off::mesh(flat, triangles))?;
        let solid = TriMesh { positions: flat.to_vec(), triangles: triangles.to_vec() };
        self.add("flat.stl", "the flat mesh, triangles alone", stl::binary(&self.name, &solid))?;
        let titles = fold::Titles { title: &self.name, creases: &crease_names(results) };
        let text = fold::flat(mesh, titles).map_err(defect)?;
        self.add("flat.fold", "the flat mesh with creases and turns", text)?;
        self.add("mesh.svg", "the flat mesh coloured by what its edges are", mesh_svg(mesh))
    }

    fn surfaces(&mut self, results: &Results) -> Result<(), RunError> {
        if let Some(s) = &results.surface {
            let cages: Vec<_> = s.cages().iter().map(|c| (&c.positions[..], &c.quads[..])).collect();
            let text = obj::cages(&self.name, &cages);
            self.add("cage.obj", "the quad cage of every face, for subdivision modelling", text)?;
            let shown = surface_ply(&self.name, &s.shape);
            self.add("surface.ply", "the surface with curvatures, radii, strains and rulings", shown)?;
            self.exact(&Exact {
                path: "sheet",
                purpose: "the folded sheet's surface",
                name: "sheet",
                color_srgb: SHEET_COLOUR,
                material: None,
                shape: s.exported(),
            })?;
        }
        let Some(board) = &results.board else { return Ok(()) };
        self.exact(&Exact {
            path: "board",
            purpose: "the board as a solid",
            name: "board",
            color_srgb: SHEET_COLOUR,
            material: Some(self.material),
            shape: &board.shape,
        })
    }

    fn mold(&mut self, mold: &Mold, stock_mm: [f64; 2]) -> Result<(), RunError> {
        self.exact(&Exact {
            path: "mold",
            purpose: "the mold as a solid",
            name: "mold",
            color_srgb: MOLD_COLOUR,
            material: None,
            shape: &mold.shape,
        })?;
        for part in &mold.parts {
            self.part(part)?;
        }
        let waffle = waffle(mold, stock_mm).to_dxf().map_err(defect)?;
        self.add("waffle.dxf", "the boards below the mold, nested on their sheets", waffle)
    }

    fn part(&mut self, part: &Part) -> Result<(), RunError> {
        let name = &part.name;
        let stl = format!("parts/{name}.stl");
        self.add(&stl, "a printed part", stl::binary(name, &part.solid))?;
        let back = openmesh::read(&self.staging.path(&stl)?).map_err(defect)?;
        if back.triangles.len() != part.solid.triangles.len() {
            return Err(RunError::Defect(format!(
                "{name}: the STL file reads back with {} triangles",
                back.triangles.len()
            )));
        }
        let package =
            threemf::package(name, &[threemf::Object { name, mesh: &part.solid }]).map_err(defect)?;
        self.add(&format!("parts/{name}.3mf"), "a printed part, named, in mm", package)?;
        let Some(shape) = &part.shape else { return Ok(()) };
        self.exact(&Exact {
            path: &format!("parts/{name}"),
            purpose: "a part as exact solid, without grooves and marks",
            name,
            color_srgb: MOLD_COLOUR,
            material: None,
            shape,
        })
    }

    /// The report is last: it lists all files, itself included.
    fn report(&mut self, loaded: &Loaded, results: &Results) -> Result<json::Report, RunError> {
        self.listed("report.json", "all figures");
        self.listed("report.html", "figures and pictures on one page");
        let mut report = record::report(loaded, results);
        report.files = std::mem::take(&mut self.files);
        self.staging.write("report.html", html::html(&report, &pictures(results)?))?;
        self.staging.write("report.json", report.to_json().map_err(defect)?)?;
        Ok(report)
    }
}

/// Layers of the blank.
const CUT: &str = "CUT_THROUGH";
const FOLD: &str = "FOLD_LINES";
/// Layers of the boards besides [`CUT`].
const ENGRAVE: &str = "ENGRAVE";
const SHEET: &str = "SHEET";

fn blank(soft: &SoftPattern) -> Drawing {
    let outline = |c: &PlanarCurve| Entity::lines(CUT, true, &c.flatten(DXF_CHORD_MM));
    let folds = soft.bands.iter().flat_map(|b| &b.fold_lines).map(|l| Entity::lines(FOLD, false, &l.points));
    Drawing {
        layers: vec![Layer::new(CUT, colour::RED), Layer::new(FOLD, colour::BLUE)],
        entities: soft.loops.iter().map(outline).chain(folds).collect(),
    }
}

/// Space between two stock sheets on the drawing, mm.
const SHEET_GAP_MM: f64 = 200.0;

fn waffle(mold: &Mold, stock_mm: [f64; 2]) -> Drawing {
    let mut entities = Vec::new();
    let [length, width] = stock_mm;
    for (i, sheet) in mold.waffle.nest.sheets.iter().enumerate() {
        let corner = DVec2::new(0.0, i as f64 * (width + SHEET_GAP_MM));
        let frame =
            [(0.0, 0.0), (length, 0.0), (length, width), (0.0, width)].map(|p| corner + DVec2::from(p));
        entities.push(Entity::lines(SHEET, true, &frame));
        for placed in &sheet.placed {
            draw_board(&mut entities, &mold.waffle.boards[placed.board], placed, corner);
        }
    }
    let layers = vec![
        Layer::new(CUT, colour::RED),
        Layer::new(ENGRAVE, colour::GREEN),
        Layer::new(SHEET, colour::GREY),
    ];
    Drawing { layers, entities }
}

fn draw_board(entities: &mut Vec<Entity>, board: &WaffleBoard, placed: &Placed, corner: DVec2) {
    let on_sheet = on_stock(board, placed);
    let at = |p: DVec2| on_sheet(p) + corner;
    for contour in &board.profile {
        entities.push(Entity::Polyline {
            layer: CUT.to_owned(),
            closed: true,
            vertices: bulged(contour, &at),
        });
    }
    for stroke in &board.engrave {
        let points: Vec<DVec2> = stroke.iter().map(|p| at(*p)).collect();
        entities.push(Entity::lines(ENGRAVE, false, &points));
    }
}

/// Vertices with bulges: the tangent of a quarter of the arc's angle.
fn bulged(contour: &Contour, at: &impl Fn(DVec2) -> DVec2) -> Vec<[f64; 3]> {
    let vertex = |s: &ProfileSegment| {
        let p = at(s.from());
        let bulge = match *s {
            ProfileSegment::Line { .. } => 0.0,
            ProfileSegment::Arc { from, to, center, ccw } => {
                let (a, b) = (from - center, to - center);
                let turn = if ccw { a.angle_to(b) } else { b.angle_to(a) }.rem_euclid(std::f64::consts::TAU);
                (0.25 * turn).tan() * if ccw { 1.0 } else { -1.0 }
            }
        };
        [p.x, p.y, bulge]
    };
    contour.segments.iter().map(vertex).collect()
}
