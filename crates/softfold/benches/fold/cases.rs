//! What is folded: the arc, the S and the sculpture, each on meshes of several sizes of the same sheet.

use softfold_fold::{Between, Goal, Level, Pyramid, SheetMaterial, upright};
use softfold_geometry::{Crease, CreaseId, CreasePattern, DVec2, DVec3, FlatMesh, PlanarCurve, Role, Source};
use softfold_mesh::{MeshOptions, mesh};
use softfold_soften::{Along, CreaseSoftness, Segments, soften};
use std::cell::OnceCell;
use std::f64::consts::{PI, TAU};

/// Vertices with the strips per band that go with them.
pub(crate) const SIZES: [(usize, u32); 5] = [(600, 2), (2_000, 4), (10_000, 6), (50_000, 12), (200_000, 16)];
/// A mesh between each of them and the one before, which is made where the pyramid asks for it.
const BETWEEN: [(usize, u32); 5] = [(300, 1), (1_100, 3), (4_500, 5), (22_000, 8), (100_000, 14)];
/// Shapes this near are the same.
pub(crate) const NEAR_MM: f64 = 1.0;
/// Tries end when the vertices differ from the number asked for by no more than this share; else the nearest counts. Fold
/// lines set a least number, which the coarsest mesh of the S comes near to.
const NEAR: f64 = 0.03;
/// Looks for the edge length that gives the number of vertices.
const TRIES: u32 = 12;
/// Points by which curves are given.
const POINTS: usize = 400;

/// A sheet to fold: its own mesh, and coarser ones.
pub(crate) struct Case {
    pub(crate) name: String,
    coarse: Coarse,
    pub(crate) mesh: FlatMesh,
    pub(crate) goals: Vec<Box<dyn Goal>>,
    pub(crate) start: Vec<DVec3>,
    /// What its own goals come from, where that is all.
    pub(crate) elastic: Option<SheetMaterial>,
}

/// Coarser meshes of a sheet.
enum Coarse {
    Drawn { levels: Vec<Level>, sheet: Box<Sheet>, between: Vec<OnceCell<Level>> },
    Project(softfold::pyramid::Meshes<'static>),
}

impl Case {
    /// Gives `fold` the pyramid of the sheet.
    ///
    /// Meshes are made before the first fold or in it, and then kept.
    pub(crate) fn with_pyramid<T>(&self, fold: impl FnOnce(&Pyramid<'_>) -> T) -> T {
        match &self.coarse {
            Coarse::Drawn { levels, sheet, between } => {
                let mesh = |k: usize| Some(between[k].get_or_init(|| sheet.level(BETWEEN[k])));
                let between = Some(Between { mesh: &mesh, near_mm: NEAR_MM });
                fold(&Pyramid { levels, between, carry: &softfold_mesh::transfer })
            }
            Coarse::Project(meshes) => {
                let between = |k: usize| meshes.between(k);
                fold(&meshes.pyramid(&between))
            }
        }
    }
}

/// A drawn sheet with its softness: radius in mm, fold angles in degrees.
#[derive(Clone)]
pub(crate) struct Sheet {
    pub(crate) name: &'static str,
    outline: PlanarCurve,
    creases: Vec<(PlanarCurve, f64)>,
    radius_mm: f64,
    area_mm2: f64,
}

fn curve(point: impl Fn(f64) -> DVec2) -> PlanarCurve {
    let points: Vec<DVec2> = (0..=POINTS).map(|k| point(k as f64 / POINTS as f64)).collect();
    PlanarCurve::polyline(&points).expect("a curve")
}

impl Sheet {
    /// A square of 1600 mm with a crease of radius 1000 mm about a point 1100 mm below its middle, folded by 90°.
    pub(crate) fn arc() -> Self {
        let corners = [(-800., -800.), (800., -800.), (800., 800.), (-800., 800.), (-800., -800.)];
        let outline = PlanarCurve::polyline(&corners.map(DVec2::from)).expect("a square");
        let half = (800.0_f64 / 1000.0).asin();
        let arc = |t: f64| {
            let x = match t {
                0.0 => -800.0,
                1.0 => 800.0,
                _ => 1000.0 * (half * (2.0 * t - 1.0)).sin(),
            };
            DVec2::new(x, (1e6 - x * x).sqrt() - 1100.0)
        };
        let creases = vec![(curve(arc), 90.0)];
        Self { name: "arc", outline, creases, radius_mm: 50.0, area_mm2: 1600.0 * 1600.0 }
    }

    /// An ellipse of 800 × 650 mm with two creases y = ±220 + 100 sin(0.9 π x / 800) mm, folded by 70° and −70°.
    pub(crate) fn s() -> Self {
        let outline = curve(|t| match t {
            1.0 => DVec2::new(800.0, 0.0),
            _ => DVec2::new(800.0 * (TAU * t).cos(), 650.0 * (TAU * t).sin()),
        });
        let y = |x: f64, offset: f64| offset + 100.0 * (0.9 * PI * x / 800.0).sin();
        let inside = |x: f64, offset: f64| (x / 800.0).powi(2) + (y(x, offset) / 650.0).powi(2) < 1.0;
        let crease = |offset: f64| {
            let [left, right] = [-1.0, 1.0].map(|side| {
                let (mut low, mut high) = (0.0, 800.0);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if inside(side * middle, offset) { low = middle } else { high = middle }
                }
                side * low
            });
            // The ends lie on the chords that stand for the ellipse.
            let on_outline = |p: DVec2| outline.point(outline.nearest(p).0);
            curve(|t| {
                let x = left + t * (right - left);
                let p = DVec2::new(x, y(x, offset));
                if t == 0.0 || t == 1.0 { on_outline(p) } else { p }
            })
        };
        let creases = vec![(crease(220.0), 70.0), (crease(-220.0), -70.0)];
        Self { name: "S", outline, creases, radius_mm: 40.0, area_mm2: PI * 800.0 * 650.0 }
    }

    /// Its mesh of about so many vertices, bands in so many strips.
    fn mesh(&self, vertices: usize, segments: u32) -> FlatMesh {
        let crease = |(i, (curve, angle_deg)): (usize, &(PlanarCurve, f64))| Crease {
            id: CreaseId::new(i),
            name: format!("crease-{i}"),
            role: if *angle_deg > 0.0 { Role::Valley } else { Role::Mountain },
            curve: curve.clone(),
            fold_angle_rad: Some(angle_deg.to_radians()),
            source: Source::default(),
        };
        let pattern = CreasePattern {
            name: self.name.to_owned(),
            outline: self.outline.clone(),
            holes: Vec::new(),
            slits: Vec::new(),
            creases: self.creases.iter().enumerate().map(crease).collect(),
        };
        let softness: Vec<CreaseSoftness> = self
            .creases
            .iter()
            .map(|(_, angle_deg)| CreaseSoftness {
                radius_mm: Along::Constant(self.radius_mm),
                fold_angle_rad: Along::Constant(angle_deg.to_radians()),
                segments: Segments::Count(segments),
            })
            .collect();
        let soft = soften(&pattern, &softness).expect("bands");
        let mut target_edge_mm = (self.area_mm2 / vertices as f64 * 2.0 / 3f64.sqrt()).sqrt();
        let off = |mesh: &FlatMesh| (mesh.vertices.len() as f64 / vertices as f64).ln().abs();
        let mut nearest: Option<FlatMesh> = None;
        for _ in 0..TRIES {
            let options = MeshOptions { target_edge_mm, ..MeshOptions::default() };
            let made = mesh(&soft, &options).expect("a mesh").mesh;
            target_edge_mm *= (made.vertices.len() as f64 / vertices as f64).sqrt();
            if nearest.as_ref().is_none_or(|n| off(&made) < off(n)) {
                nearest = Some(made);
            }
            if nearest.as_ref().is_some_and(|n| off(n) < NEAR) {
                break;
            }
        }
        nearest.expect("a mesh")
    }

    fn level(&self, (vertices, segments): (usize, u32)) -> Level {
        let mesh = self.mesh(vertices, segments);
        Level { goals: elastic().goals(&mesh), mesh }
    }

    /// The sheet on a mesh of `SIZES[size]`, with all smaller ones.
    pub(crate) fn case(&self, size: usize) -> Case {
        let levels = SIZES[..size].iter().map(|&size| self.level(size)).collect();
        let between = SIZES.iter().map(|_| OnceCell::new()).collect();
        let coarse = Coarse::Drawn { levels, sheet: Box::new(self.clone()), between };
        let Level { mesh, goals } = self.level(SIZES[size]);
        let start = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        Case {
            name: format!("{} {}", self.name, SIZES[size].0),
            coarse,
            mesh,
            goals,
            start,
            elastic: Some(elastic()),
        }
    }
}

/// 10 mm thick, Poisson's ratio 0.3, fold lines ten times as stiff; Young's modulus only scales the energy.
fn elastic() -> SheetMaterial {
    SheetMaterial {
        youngs_modulus_mpa: 1000.0,
        poisson_ratio: 0.3,
        thickness_mm: 10.0,
        fold_line_factor: 10.0,
    }
}

/// The demonstration: the mesh, goals and pyramid that `softfold run` has.
pub(crate) fn sculpture() -> Case {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/sculpture/project.toml");
    // Lives as long as the process: the pyramid borrows both.
    let loaded: &'static softfold::Loaded =
        Box::leak(Box::new(softfold::Loaded::read(path.as_ref()).expect("the project")));
    let results =
        softfold::run(loaded, softfold::Stage::Mesh, &mut softfold::progress::Quiet).expect("a mesh");
    let pattern: &'static CreasePattern = Box::leak(Box::new(results.pattern.expect("a pattern")));
    let mesh = results.mesh.expect("a mesh").meshed.mesh;
    let goals = softfold::goals::goals(loaded, &mesh, pattern).expect("goals");
    let coarse = Coarse::Project(softfold::pyramid::Meshes::new(loaded, pattern, &mesh, &|_| 1.0));
    let start = upright(&mesh);
    Case { name: "sculpture".to_owned(), coarse, mesh, goals, start, elastic: None }
}
