//! Printable parts: exact solids by OpenCascade, engraved closed meshes by CGAL and OpenMesh.

use crate::error::{During, MoldError};
use crate::grid::{Cell, Grid, fits_within};
use crate::height::HeightField;
use crate::marks;
use crate::mold::MoldOptions;
use crate::split::{piece_count, thicken};
use crate::tool::{Region, tool};
use crate::top::Patch;
use crate::waffle::Groove;
use glam::{DVec2, DVec3};
use softfold_geometry::{TriMesh, polygon};
use softfold_kernel::occt::{self, Shape};
use softfold_kernel::{BooleanOperation, MeshBuffers, MeshView, cgal, openmesh};
use std::sync::mpsc;

/// Asked of the integration of a part's volume: asked for 1e-7 it was seen to end 3e-5 away.
const VOLUME_ACCURACY: f64 = 1e-8;
/// The cutting box reaches this far above and below the sheet, and the tools below the mold, mm: any room will do.
const ROOM_MM: f64 = 10.0;
/// Grooves are cut into a part as far as this beyond its sides, mm, so that no tool ends in the plane of a cut.
const BEYOND_MM: f64 = 5.0;
/// Share by which an inner part's plan may differ from the whole square: rounding of a sum of many triangles.
const WHOLE: f64 = 1e-9;
/// A part fits the printer if it is larger by no more than this, mm: far more than rounding, far less than a layer.
const PRINTER_SLACK_MM: f64 = 1e-3;
/// Mesh and exact solid must agree in volume to this share before marks and grooves.
const VOLUME_SHARE: f64 = 5e-4;
/// Vertices nearer than this are one, mm: the largest that leaves a closed mesh is taken. The first is far below what
/// prints, the last what single precision tells apart at two metres.
const MERGES_MM: [f64; 3] = [1e-3, 3e-4, 1.2e-4];

/// One part of the mold that is printed as it is, in the mold's coordinates.
#[derive(Debug)]
pub struct Part {
    /// Row letter and column number: `A1`.
    pub name: String,
    /// Its square; of joined ones that of the largest piece.
    pub cell: Cell,
    /// The square or squares in plan: x from, y from, x to, y to, mm.
    pub footprint_mm: [f64; 4],
    /// The exact solid, without grooves and marks; none if it could not be made (see `faults`).
    pub shape: Option<Shape>,
    /// What is printed: closed, with grooves and marks.
    pub solid: TriMesh,
    /// Volume of `solid`, mm³.
    pub volume_mm3: f64,
    /// Volume of `shape`, mm³; zero without one.
    pub exact_volume_mm3: f64,
    /// Volume of the mesh before grooves and marks, mm³.
    pub plain_volume_mm3: f64,
    /// Box of `solid`, mm.
    pub size_mm: DVec3,
    /// Whether it fills its square.
    pub inner: bool,
    /// Whether the name found room on the underside.
    pub marked: bool,
    /// How many pieces it consists of: more than one where the outline enters a square twice.
    pub pieces: usize,
    /// Whether both solids are valid and agree.
    pub valid: bool,
    /// What is wrong otherwise.
    pub faults: Vec<String>,
}

/// What is needed to make one part.
pub(crate) struct Job {
    pub(crate) cell: Cell,
    pub(crate) squares: Vec<Cell>,
    pub(crate) patch: Patch,
}

/// What all parts have in common.
pub(crate) struct Common<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) grooves: &'a [Groove],
    pub(crate) options: &'a MoldOptions,
}

/// Makes all parts on `threads` threads, each with its own copy of the sheet's face; the result does not depend on how
/// many there are. After each part `watch` is told the share that is made, on the caller's thread.
///
/// # Errors
/// A face that cannot be copied, or a part that does not fit the printer.
pub(crate) fn make_parts(
    jobs: &[Job],
    face: &Shape,
    common: &Common<'_>,
    threads: usize,
    watch: &mut dyn FnMut(f64),
) -> Result<Vec<Part>, MoldError> {
    jobs.iter().try_for_each(|job| common.require_fit(job))?;
    let workers = threads.clamp(1, jobs.len().max(1));
    let copies: Vec<Shape> = (0..workers)
        .map(|_| face.try_clone().during(|| "a copy of the sheet's face".into()))
        .collect::<Result<_, _>>()?;
    // A thread that nobody listens to any more stops.
    let share = |k: usize, face: Shape, made: mpsc::Sender<(usize, Part)>| {
        let parts = (k..jobs.len()).step_by(workers).map(|i| (i, common.part(&jobs[i], &face)));
        for part in parts {
            if made.send(part).is_err() {
                break;
            }
        }
    };
    // A panic in a thread goes on in the caller when the scope ends.
    let mut made: Vec<(usize, Part)> = std::thread::scope(|scope| {
        let (sender, made) = mpsc::channel();
        for (k, face) in copies.into_iter().enumerate() {
            let (share, sender) = (&share, sender.clone());
            scope.spawn(move || share(k, face, sender));
        }
        drop(sender);
        let told = made.into_iter().enumerate().map(|(before, part)| {
            watch((before + 1) as f64 / jobs.len() as f64);
            part
        });
        told.collect()
    });
    made.sort_by_key(|(i, _)| *i);
    Ok(made.into_iter().map(|(_, part)| part).collect())
}

impl Common<'_> {
    fn part(&self, job: &Job, face: &Shape) -> Part {
        let name = job.cell.name();
        let mut faults = Vec::new();
        let [lower, upper] = self.footprint(job);
        let exact = self.exact(job, face, &mut faults);
        let plain = thicken(&job.patch, self.options.thickness_mm);
        let plain_volume_mm3 = plain.volume_mm3();
        let (solid, marked) = self.printable(&name, job, plain, &mut faults);
        let exact_volume_mm3 = exact.as_ref().map_or(0.0, |e| e.1);
        if (plain_volume_mm3 - exact_volume_mm3).abs() > VOLUME_SHARE * exact_volume_mm3 && exact.is_some() {
            faults.push(format!(
                "the mesh has {plain_volume_mm3:.0} mm3 and the exact solid {exact_volume_mm3:.0} mm3"
            ));
        }
        let (a, b) = solid.bounds();
        let square_mm2 = self.grid.cell_mm * self.grid.cell_mm;
        Part {
            name,
            cell: job.cell,
            footprint_mm: [lower.x, lower.y, upper.x, upper.y],
            shape: exact.map(|e| e.0),
            volume_mm3: solid.volume_mm3(),
            exact_volume_mm3,
            plain_volume_mm3,
            size_mm: b - a,
            inner: (job.patch.plan_area_mm2() - square_mm2).abs() <= WHOLE * square_mm2
                && job.squares.len() == 1,
            marked,
            pieces: piece_count(&job.patch),
            valid: faults.is_empty(),
            faults,
            solid,
        }
    }

    fn require_fit(&self, job: &Job) -> Result<(), MoldError> {
        let printer_mm = self.options.printer_mm;
        let positions = || job.patch.positions.iter().copied();
        let (lower, upper) =
            (positions().fold(DVec3::INFINITY, DVec3::min), positions().fold(-DVec3::INFINITY, DVec3::max));
        let size_mm = upper - lower + DVec3::Z * self.options.thickness_mm;
        if fits_within(size_mm, printer_mm, PRINTER_SLACK_MM) {
            return Ok(());
        }
        let (name, cell_mm) = (job.cell.name(), self.grid.cell_mm);
        // A part's rise shrinks about as its square does; its thickness stays.
        let rise = (printer_mm[2] - self.options.thickness_mm).max(0.0) / (upper.z - lower.z);
        let flat = printer_mm[0].min(printer_mm[1]) / size_mm.x.max(size_mm.y);
        Err(MoldError::PartTooLarge {
            name,
            size_mm,
            printer_mm,
            cell_mm,
            smaller_mm: cell_mm * rise.min(flat),
        })
    }

    fn footprint(&self, job: &Job) -> [DVec2; 2] {
        let squares = job.squares.iter().map(|c| self.grid.square_mm(*c));
        let empty = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        squares.fold(empty, |[lower, upper], [a, b]| [lower.min(a), upper.max(b)])
    }

    /// The exact solid and its volume: the sheet's face inside the squares, swept down.
    fn exact(&self, job: &Job, face: &Shape, faults: &mut Vec<String>) -> Option<(Shape, f64)> {
        let made = self.exact_shape(job, face).and_then(|shape| {
            let volume = occt::mass_properties(&shape, VOLUME_ACCURACY)?.volume_mm3;
            Ok((occt::check(&shape)?, shape, volume))
        });
        match made {
            Ok((found, shape, volume)) => {
                faults.extend(found.into_iter().map(|f| format!("exact solid: {f}")));
                Some((shape, volume))
            }
            Err(error) => {
                faults.push(format!("exact solid: {error}"));
                None
            }
        }
    }

    fn exact_shape(&self, job: &Job, face: &Shape) -> softfold_kernel::Result<Shape> {
        let [a, b] = self.footprint(job);
        let square = [[a.x, a.y], [b.x, a.y], [b.x, b.y], [a.x, b.y]];
        let heights = || job.patch.positions.iter().map(|p| p.z);
        let lowest = heights().fold(f64::INFINITY, f64::min) - ROOM_MM;
        let highest = heights().fold(f64::NEG_INFINITY, f64::max) + ROOM_MM;
        let cutter = occt::extruded_polygon(&square, lowest, highest)?;
        let piece = occt::boolean(face, &cutter, BooleanOperation::Intersection)?;
        occt::prism(&piece, [0.0, 0.0, -self.options.thickness_mm])
    }

    /// The mesh that is printed, and whether it bears its name. What fails is told, and the step before it kept: if not
    /// both grooves and name can be cut, the grooves alone are.
    fn printable(&self, name: &str, job: &Job, plain: TriMesh, faults: &mut Vec<String>) -> (TriMesh, bool) {
        let grooves = self.groove_regions(job);
        let marks = self.mark_regions(name, job);
        let lowest = plain.bounds().0.z - ROOM_MM;
        let (mut mesh, mut marked) = (buffers(&plain), false);
        for (with_marks, regions) in
            [(!marks.is_empty(), [grooves.clone(), marks].concat()), (false, grooves)]
        {
            if regions.is_empty() {
                break;
            }
            match engraved(&plain, &regions, lowest) {
                Ok(cut) => {
                    (mesh, marked) = (cut, with_marks);
                    break;
                }
                Err(error) if with_marks => faults.push(format!("printable mesh, grooves and name: {error}")),
                Err(error) => faults.push(format!("printable mesh, grooves: {error}")),
            }
        }
        match finished(&mesh, self.options.decimate_mm) {
            Ok(fine) => mesh = fine,
            Err(error) => faults.push(format!("printable mesh, finish: {error}")),
        }
        let positions = mesh.positions.into_iter().map(DVec3::from).collect();
        (TriMesh { positions, triangles: mesh.triangles }, marked)
    }

    fn groove_regions(&self, job: &Job) -> Vec<Region> {
        let (center, half) = middle_and_half(&job.patch);
        self.grooves.iter().flat_map(|g| g.regions(center, half, BEYOND_MM)).collect()
    }

    fn mark_regions(&self, name: &str, job: &Job) -> Vec<Region> {
        let Some(options) = &self.options.marks else { return Vec::new() };
        let (center, half) = middle_and_half(&job.patch);
        let field = HeightField::new(&job.patch);
        let thickness_mm = self.options.thickness_mm;
        marks::regions(name, &field, center, half.max_element(), self.grooves, thickness_mm, options)
    }
}

fn middle_and_half(patch: &Patch) -> (DVec2, DVec2) {
    let plan: Vec<DVec2> = patch.positions.iter().map(|p| p.truncate()).collect();
    let (lower, upper) = polygon::bounds(&plan);
    (0.5 * (lower + upper), 0.5 * (upper - lower))
}

fn engraved(plain: &TriMesh, regions: &[Region], lowest_mm: f64) -> Result<MeshBuffers, String> {
    let tool = buffers(&tool(regions, lowest_mm).map_err(|e| e.to_string())?);
    let cut = cgal::boolean(buffers(plain).view(), tool.view(), BooleanOperation::Difference);
    cut.map(|mesh| canonical(&mesh)).map_err(|e| e.to_string())
}

/// The same mesh with vertices in the order of their coordinates and triangles in the order of their corners: CGAL's
/// corefinement numbers them by addresses in memory, which change from run to run.
fn canonical(mesh: &MeshBuffers) -> MeshBuffers {
    let point = |i: u32| mesh.positions[i as usize];
    let by_place = |&a: &u32, &b: &u32| {
        let (a, b) = (point(a), point(b));
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
    };
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.sort_by(by_place);
    let mut renamed = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        renamed[old as usize] = new as u32;
    }
    let turned = |t: &[u32; 3]| {
        let mut t = t.map(|i| renamed[i as usize]);
        let least = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        t.rotate_left(least);
        t
    };
    let mut triangles: Vec<_> = mesh.triangles.iter().map(turned).collect();
    triangles.sort_unstable();
    MeshBuffers { positions: order.iter().map(|&i| point(i)).collect(), triangles }
}

/// As it is written to files, with fewer triangles if that leaves a sound mesh, and checked.
fn finished(mesh: &MeshBuffers, decimate_mm: f64) -> Result<MeshBuffers, String> {
    let mut said = String::new();
    for merge_mm in MERGES_MM {
        let clean = as_written(mesh, merge_mm)?;
        match require_closed(&clean) {
            Ok(()) => return Ok(with_fewer_triangles(&clean, decimate_mm, merge_mm)?.unwrap_or(clean)),
            Err(fault) => said = fault,
        }
    }
    Err(said)
}

fn with_fewer_triangles(
    mesh: &MeshBuffers,
    decimate_mm: f64,
    merge_mm: f64,
) -> Result<Option<MeshBuffers>, String> {
    if decimate_mm == 0.0 {
        return Ok(None);
    }
    let fewer = openmesh::decimate(mesh.view(), decimate_mm).map_err(|e| e.to_string())?;
    let fewer = as_written(&fewer, merge_mm)?;
    let crossing = cgal::self_intersections(fewer.view()).map_err(|e| e.to_string())?;
    Ok((crossing.is_empty() && require_closed(&fewer).is_ok()).then_some(fewer))
}

/// Vertices that are one in the single precision of STL files are one here, so that a file is as closed as the mesh.
fn as_written(mesh: &MeshBuffers, merge_mm: f64) -> Result<MeshBuffers, String> {
    let clean =
        |m: &MeshBuffers| openmesh::clean(m.view(), merge_mm).map(|c| c.mesh).map_err(|e| e.to_string());
    let mut single = clean(mesh)?;
    single.positions.iter_mut().flatten().for_each(|c| *c = f64::from(*c as f32));
    clean(&single)
}

fn require_closed(mesh: &MeshBuffers) -> Result<(), String> {
    let found = cgal::closed_check(mesh.view()).map_err(|e| e.to_string())?;
    if found.closed && found.manifold && found.outward {
        return Ok(());
    }
    Err(format!("closed: {}, manifold: {}, outward: {}", found.closed, found.manifold, found.outward))
}

/// The same mesh in the kernel's arrays.
pub(crate) fn buffers(mesh: &TriMesh) -> MeshBuffers {
    let positions = mesh.positions.iter().map(|p| p.to_array()).collect();
    MeshBuffers { positions, triangles: mesh.triangles.clone() }
}

impl Part {
    /// Whether the printable mesh is closed, manifold and outward, as CGAL sees it.
    ///
    /// # Errors
    /// What is wrong, with the part's name.
    pub fn check(&self) -> Result<(), MoldError> {
        let mesh = buffers(&self.solid);
        let view = MeshView { positions: &mesh.positions, triangles: &mesh.triangles };
        let found = cgal::closed_check(view).during(|| format!("part {}", self.name))?;
        if found.closed && found.manifold && found.outward && self.faults.is_empty() {
            return Ok(());
        }
        Err(MoldError::Invalid { what: format!("part {}", self.name), faults: self.faults.clone() })
    }
}
