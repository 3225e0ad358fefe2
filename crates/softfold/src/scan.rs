//! `softfold scan`: a mesh file of a scanned sheet or any other surface, read, cleaned and made smaller.

use crate::RunError;
use crate::export::{obj, off, ply, stl};
use softfold_geometry::{DVec3, TriMesh};
use softfold_kernel::{KernelError, MeshBuffers, cgal, openmesh};
use std::path::Path;

/// Vertices closer than this are one where nothing is said, share of the mesh's size: what single precision resolves.
const MERGE: f64 = 1e-6;
/// Points per side of the grid on every triangle at which distances are measured.
const GRID: usize = 3;
/// Tries to hold the bound; each aims lower by what the last one missed it by.
const TRIES: u32 = 4;

/// What shall be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanOptions {
    /// Vertices closer than this are merged, mm; none: a millionth of the size.
    pub merge_mm: Option<f64>,
    /// Pieces with less than this share of the largest one's area are dropped.
    pub least_share: f64,
    /// Decimate with no larger error than this, mm.
    pub decimate_mm: Option<f64>,
}

impl ScanOptions {
    /// Share below which pieces are dropped where nothing is said.
    pub const LEAST_SHARE: f64 = 0.01;
}

/// A mesh and what was done to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// An oriented manifold mesh, mm.
    pub mesh: MeshBuffers,
    /// Vertices and triangles of the file.
    pub read: [usize; 2],
    /// How many vertices were merged.
    pub merged_vertices: u32,
    /// How many triangles were dropped: degenerate, double, or a third one at an edge.
    pub removed_triangles: u32,
    /// How many triangles were turned over.
    pub flipped_triangles: u32,
    /// How many connected pieces there were, how many of them were dropped, and their triangles.
    pub pieces: [u32; 3],
    /// If it was decimated: triangles before, and the largest distance measured either way, mm.
    pub decimated: Option<(usize, f64)>,
    /// Whether it closes a volume, and how large that is, mm³.
    pub volume_mm3: Option<f64>,
}

/// Reads, cleans and, if asked, decimates a mesh file.
///
/// The error of the decimation is measured afterwards through CGAL's tree, from a grid of points on every triangle of
/// either mesh to the other, and is held by that measure.
///
/// # Errors
/// A file that gives no mesh, an option out of its range.
pub fn scan(path: &Path, options: &ScanOptions) -> Result<Scan, RunError> {
    options.check()?;
    let file = openmesh::read(path).map_err(|e| unreadable(&e))?;
    let merge_mm = options.merge_mm.unwrap_or(MERGE * size_mm(&file));
    let refused =
        |e: KernelError| RunError::in_file(path, None, format!("{e}; look at the file in a mesh viewer"));
    let cleaned = openmesh::clean(file.view(), merge_mm).map_err(refused)?;
    let kept = openmesh::without_strays(cleaned.mesh.view(), options.least_share).map_err(refused)?;
    let mut scan = Scan {
        read: [file.positions.len(), file.triangles.len()],
        merged_vertices: cleaned.merged_vertices,
        removed_triangles: cleaned.removed_triangles,
        flipped_triangles: cleaned.flipped_triangles,
        pieces: [kept.pieces, kept.dropped_pieces, kept.dropped_triangles],
        decimated: None,
        volume_mm3: None,
        mesh: kept.mesh,
    };
    if let Some(bound_mm) = options.decimate_mm {
        let (mesh, error_mm) = decimated(&scan.mesh, bound_mm).map_err(refused)?;
        scan.decimated = Some((scan.mesh.triangles.len(), error_mm));
        scan.mesh = mesh;
    }
    let check = cgal::closed_check(scan.mesh.view()).map_err(refused)?;
    scan.volume_mm3 = (check.closed && check.manifold).then_some(check.volume_mm3);
    Ok(scan)
}

impl ScanOptions {
    fn check(&self) -> Result<(), RunError> {
        let lengths =
            [("--merge-mm", self.merge_mm, 0.0), ("--decimate-mm", self.decimate_mm, f64::MIN_POSITIVE)];
        for (name, value, least) in lengths {
            if let Some(v) = value.filter(|v| !(v.is_finite() && *v >= least)) {
                let wanted = if least > 0.0 { "a positive length" } else { "a length that is not negative" };
                return Err(RunError::Input(format!("{name} is {v}; give {wanted} in mm")));
            }
        }
        match (0.0..=1.0).contains(&self.least_share) {
            true => Ok(()),
            false => Err(RunError::Input(format!(
                "--least-share is {}; give a number from 0 to 1",
                self.least_share
            ))),
        }
    }
}

/// A kernel's word about a file has its path already.
fn unreadable(error: &KernelError) -> RunError {
    match error {
        KernelError::File { .. } => RunError::Input(error.to_string()),
        other => RunError::Defect(other.to_string()),
    }
}

fn size_mm(mesh: &MeshBuffers) -> f64 {
    let extent = |axis: usize| {
        let values = || mesh.positions.iter().map(|p| p[axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    (0..3).map(extent).fold(0.0, f64::max)
}

/// Fewer triangles, and the largest distance measured; the mesh as it was where nothing less holds the bound.
fn decimated(mesh: &MeshBuffers, bound_mm: f64) -> Result<(MeshBuffers, f64), KernelError> {
    let mut aim_mm = bound_mm;
    for _ in 0..TRIES {
        let fewer = openmesh::decimate(mesh.view(), aim_mm)?;
        let error_mm = farthest(mesh, &fewer)?.max(farthest(&fewer, mesh)?);
        if error_mm <= bound_mm {
            return Ok((fewer, error_mm));
        }
        aim_mm *= 0.9 * bound_mm / error_mm;
    }
    Ok((mesh.clone(), 0.0))
}

/// Largest distance from a grid of points on every triangle of `from` to `to`, mm.
fn farthest(from: &MeshBuffers, to: &MeshBuffers) -> Result<f64, KernelError> {
    let mut points = from.positions.clone();
    for t in &from.triangles {
        let [a, b, c] = t.map(|i| DVec3::from(from.positions[i as usize]));
        for i in 0..=GRID {
            for j in 0..=GRID - i {
                let (u, v) = (i as f64 / GRID as f64, j as f64 / GRID as f64);
                points.push((a + u * (b - a) + v * (c - a)).to_array());
            }
        }
    }
    Ok(cgal::distances_to_mesh(&points, to.view())?.into_iter().fold(0.0, f64::max))
}

impl Scan {
    /// The mesh as the file that `path` ends on.
    ///
    /// # Errors
    /// An ending that is none of a mesh.
    pub fn file(&self, path: &Path) -> Result<Vec<u8>, RunError> {
        let positions: Vec<DVec3> = self.mesh.positions.iter().map(|p| DVec3::from(*p)).collect();
        let triangles = &self.mesh.triangles;
        let title = path.file_stem().map_or_else(|| "scan".to_owned(), |s| s.to_string_lossy().into_owned());
        let ending =
            path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).unwrap_or_default();
        match ending.as_str() {
            "ply" => Ok(ply::mesh(&title, &positions, triangles)),
            "obj" => Ok(obj::mesh(&title, &positions, triangles).into_bytes()),
            "off" => Ok(off::mesh(&positions, triangles).into_bytes()),
            "stl" => Ok(stl::binary(&title, &TriMesh { positions, triangles: triangles.clone() })),
            _ => Err(RunError::in_file(path, None, "has no ending of a mesh; give ply, obj, stl or off")),
        }
    }

    /// What was done, in a few lines.
    pub fn words(&self) -> String {
        let [vertices, triangles] = self.read;
        let [pieces, dropped, lost] = self.pieces;
        let mut text = format!(
            "read     {vertices} vertices, {triangles} triangles\ncleaned  {} vertices merged, {} triangles removed, {} turned over\n\
             pieces   {pieces}, of which {dropped} stray with {lost} triangles are gone\n",
            self.merged_vertices, self.removed_triangles, self.flipped_triangles
        );
        if let Some((before, error_mm)) = self.decimated {
            text += &format!(
                "fewer    {before} -> {} triangles, at most {error_mm:.4} mm off\n",
                self.mesh.triangles.len()
            );
        }
        let volume = self.volume_mm3.map_or_else(|| "open".to_owned(), |v| format!("closed, {v:.1} mm3"));
        text + &format!(
            "now      {} vertices, {} triangles, {volume}",
            self.mesh.positions.len(),
            self.mesh.triangles.len()
        )
    }
}
