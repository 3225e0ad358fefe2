//! `softfold compare`: how far one shape is from another, wherever they lie.
//!
//! [`source`] reads both, [`align`] brings them together from a [`coarse`] pose, [`figures`] says how far the points of
//! the first are from the surface of the second, [`files`] writes that down. Distances are exact: CGAL's tree finds the
//! triangle, and the distance is to its nearest point.

mod align;
mod body;
mod coarse;
mod figures;
mod files;
mod pose;
mod rigid;
mod source;
mod words;

pub use align::Alignment;
pub(crate) use body::refined;
pub use figures::{Figures, Histogram, Signed};
pub use files::{Comparison as Record, SCHEMA, write};
pub use pose::pose;
pub use source::{ReadOptions, Source, What};

use crate::RunError;
use body::Body;
use softfold_geometry::{DVec3, RigidTransform, TriMesh};
use softfold_kernel::KernelError;
use std::path::Path;

/// Whether and how the first is moved onto the second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Align {
    /// As they lie if runs of softfold wrote both, else moved
    #[default]
    Auto,
    /// As they lie, or as --pose puts the first
    None,
    /// Moved rigidly onto the second
    Rigid,
}

/// Which points of a shape are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Points {
    /// The vertices of a mesh of small triangles, else [`SPREAD`] points spread over the area.
    #[default]
    Auto,
    /// The vertices.
    Vertices,
    /// So many points spread over the area.
    Spread(usize),
}

/// What shall be done.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareOptions {
    /// How files are read.
    pub reading: ReadOptions,
    /// Whether the first is moved.
    pub align: Align,
    /// Where it is moved first.
    pub pose: Option<RigidTransform>,
    /// Which points are measured.
    pub points: Points,
    /// Measure the points of the second against the first too.
    pub both: bool,
    /// Points farther off than this are left out, mm.
    pub leave_out_mm: Option<f64>,
    /// Largest distance allowed, mm.
    pub limit_mm: Option<f64>,
}

impl CompareOptions {
    /// Chord error of CAD faces where nothing is said, mm: what the surface may be off the folded mesh. A fifth of it takes
    /// OpenCascade fifteen times as long.
    pub const CHORD_MM: f64 = 0.05;
}

/// Points spread over a shape where nothing is said.
pub const SPREAD: usize = 20_000;
/// A mesh with an edge longer than this share of its size has large triangles.
const LARGE: f64 = 0.08;
/// Longest edge of the mesh that is coloured, share of the size, where triangles are large, and most triangles of it.
const SHOWN: f64 = 0.01;
const MOST_SHOWN: usize = 400_000;
/// A nearest point on a border counts as past it where it is more to the side than above: cosine to the normal.
const SIDEWAYS: f64 = 0.5;
/// Distances below this share of the size are nothing.
const NOTHING: f64 = 1e-6;

/// What came out.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The measured shape and the one it is measured against.
    pub sources: [Source; 2],
    /// Where the first was moved, if it was.
    pub motion: Option<RigidTransform>,
    /// How that was found.
    pub alignment: Option<Alignment>,
    /// Distances of the first's points from the second.
    pub forth: Figures,
    /// Distances of the second's points from the first, if asked for.
    pub back: Option<Figures>,
    /// Largest distance allowed, mm.
    pub limit_mm: Option<f64>,
    /// What a user should know.
    pub remarks: Vec<String>,
    /// The first in the frame of the second, fine enough to be coloured.
    pub shown: TriMesh,
    /// Distances at its vertices, mm; with sign if [`Figures::signed`] is there.
    pub shown_mm: Vec<f64>,
}

impl Comparison {
    /// Whether the largest distance, either way, is within the limit; true without a limit.
    pub fn passes(&self) -> bool {
        self.limit_mm.is_none_or(|limit| self.max_mm() <= limit)
    }

    /// The largest distance, either way, mm.
    pub fn max_mm(&self) -> f64 {
        self.back.iter().map(|f| f.max_mm).fold(self.forth.max_mm, f64::max)
    }
}

/// Compares what two paths name.
///
/// # Errors
/// Options out of range; files that give no shape; no point left to be measured.
pub fn compare(a: &Path, b: &Path, options: &CompareOptions) -> Result<Comparison, RunError> {
    options.check()?;
    let (source_a, mesh_a) = source::read(a, &options.reading)?;
    let (source_b, mesh_b) = source::read(b, &options.reading)?;
    let body_a = Body::new(mesh_a).map_err(|e| degenerate(&source_a.path, &e))?;
    let body_b = Body::new(mesh_b).map_err(|e| degenerate(&source_b.path, &e))?;
    let sources =
        [(source_a, &body_a), (source_b, &body_b)].map(|(s, b)| Source { oriented: b.oriented, ..s });
    let (motion, alignment) = placed(&sources, &body_a, &body_b, options)?;
    let mut mesh = body_a.mesh;
    motion.iter().for_each(|m| mesh.positions.iter_mut().for_each(|p| *p = m.point(*p)));
    let forth = measured(&mesh, &sources[0], &body_b, options)?;
    let back = match options.both {
        true => {
            let moved = Body::new(mesh.clone()).map_err(defect)?;
            Some(measured(&body_b.mesh, &sources[1], &moved, options)?)
        }
        false => None,
    };
    let shown = shown(mesh);
    let shown_mm = distances(&shown.positions, &body_b)?.0;
    let limit_mm = options.limit_mm;
    let mut comparison = Comparison {
        sources,
        motion,
        alignment,
        forth,
        back,
        limit_mm,
        remarks: Vec::new(),
        shown,
        shown_mm,
    };
    comparison.remarks = words::remarks(&comparison, body_b.size_mm());
    Ok(comparison)
}

impl CompareOptions {
    fn check(&self) -> Result<(), RunError> {
        let lengths = [
            ("--unit-mm", self.reading.unit_mm),
            ("--chord-mm", Some(self.reading.chord_mm)),
            ("--leave-out-mm", self.leave_out_mm),
            ("--limit-mm", self.limit_mm),
        ];
        for (name, value) in lengths {
            if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(RunError::Input(format!("{name} is {v}; give a positive length in mm")));
            }
        }
        Ok(())
    }
}

fn defect(error: impl std::fmt::Display) -> RunError {
    RunError::Defect(error.to_string())
}

fn degenerate(path: &Path, error: &KernelError) -> RunError {
    RunError::in_file(path, None, format!("{error}; look at the file in a mesh viewer"))
}

/// Where the first goes, and how that was found.
type Placed = (Option<RigidTransform>, Option<Alignment>);

fn placed(sources: &[Source; 2], a: &Body, b: &Body, options: &CompareOptions) -> Result<Placed, RunError> {
    let move_it = match options.align {
        Align::Auto => !sources.iter().all(|s| s.of_a_run),
        Align::None => false,
        Align::Rigid => true,
    };
    if !move_it {
        return Ok((options.pose, None));
    }
    let alignment = align::align(a, b, options.pose).map_err(defect)?;
    Ok((Some(alignment.motion), Some(alignment)))
}

/// The figures of one shape's points against another body.
fn measured(
    mesh: &TriMesh,
    source: &Source,
    body: &Body,
    options: &CompareOptions,
) -> Result<Figures, RunError> {
    let count = match options.points {
        Points::Spread(count) => Some(count),
        Points::Vertices => None,
        Points::Auto => (source.chord_mm.is_some() || has_large_triangles(mesh)).then_some(SPREAD),
    };
    let points = count.map_or_else(|| mesh.positions.clone(), |n| body::spread(mesh, n));
    let (distances, past) = distances(&points, body)?;
    let near = |d: f64| options.leave_out_mm.is_none_or(|most| d.abs() <= most);
    let kept: Vec<usize> = (0..points.len()).filter(|&i| near(distances[i])).collect();
    let pick = |i: &usize| (points[*i], distances[*i]);
    let (points_kept, distances_kept): (Vec<DVec3>, Vec<f64>) = kept.iter().map(pick).unzip();
    let figures = Figures::of(&points_kept, &distances_kept, body.oriented).ok_or_else(|| {
        let nearest = distances.iter().map(|d| d.abs()).fold(f64::MAX, f64::min);
        RunError::in_file(
            &source.path,
            None,
            format!("no point is within --leave-out-mm; the nearest is {nearest:.3} mm away"),
        )
    })?;
    Ok(Figures {
        sampling: if count.is_some() { "spread" } else { "vertices" }.to_owned(),
        left_out: points.len() - kept.len(),
        past_border: kept.iter().filter(|i| past[**i]).count(),
        ..figures
    })
}

fn has_large_triangles(mesh: &TriMesh) -> bool {
    let most = LARGE * body::size_mm(mesh);
    let longest = |t: &[u32; 3]| {
        let [a, b, c] = mesh.corners(*t);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    };
    mesh.triangles.iter().any(|t| longest(t) > most)
}

/// Distances of points from a body, with sign if it has sides, and whether they lie past its border.
fn distances(points: &[DVec3], body: &Body) -> Result<(Vec<f64>, Vec<bool>), RunError> {
    let nothing = NOTHING * body.size_mm();
    let one = |(p, t): (&DVec3, &body::Touch)| {
        let away = *p - t.foot;
        let (size, above) = (away.length(), away.dot(t.normal));
        let signed = if body.oriented && above < 0.0 { -size } else { size };
        (signed, t.border && size > nothing && above.abs() < SIDEWAYS * size)
    };
    Ok(points.iter().zip(&body.touch(points).map_err(defect)?).map(one).unzip())
}

/// The mesh, finer where its triangles are too large to be coloured by their corners.
fn shown(mesh: TriMesh) -> TriMesh {
    match has_large_triangles(&mesh) {
        true => body::refined(&mesh, SHOWN * body::size_mm(&mesh), MOST_SHOWN),
        false => mesh,
    }
}
