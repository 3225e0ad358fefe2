//! Meshing: soft pattern in, flat mesh with classified edges out.
//!
//! The paper's steps: points along creases and outline, points inside, constrained Delaunay triangulation,
//! relaxation with crease and outline points held. Bands are meshed in rows along their strips, so no
//! triangle crosses a fold line; edges know their fold line from the constraint they came from.

mod backend;
mod background;
mod boundary;
mod cdt;
mod classes;
mod crosscheck;
mod draft;
mod edges;
mod gaps;
mod graph;
mod grid;
mod grow;
mod inside;
mod interior;
mod lattice;
mod locate;
mod net;
mod noding;
mod order;
mod overlap;
mod paper;
mod places;
mod planar;
mod quality;
mod refine;
mod relax;
mod rings;
mod rng;
mod rows;
mod settle;
mod shared;
mod sharp;
mod size;
mod split;
mod stretch;
mod tracks;
mod transfer;
mod triangle;

pub use backend::{Arranged, Triangulate};
pub use cdt::{Backend, Constraint, PlanarGraph, Triangulated, triangulate};
pub use crosscheck::{Crosscheck, CrossingCheck, crosscheck, crosscheck_crossing};
pub use locate::Locator;
pub use noding::{Noded, noded};
pub use quality::{Inspection, Quality, SharpPlace, Sharpness, quality};
pub use tracks::Curve;
pub use transfer::transfer;

use boundary::Boundaries;
use draft::Draft;
use glam::DVec2;
use graph::GraphBuilder;
use planar::Planar;
use softfold_geometry::{CheckError, FlatMesh, Site, SoftPattern};
use stretch::stretches;

/// How points are placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Rows along bands, edges that grow away from them, small angles mended.
    #[default]
    Graded,
    /// The paper's steps as they are: random points, removed near curves, relaxed.
    Paper,
}

/// Options of the mesher.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOptions {
    /// How points are placed.
    pub method: Method,
    /// Edge length wished for away from bands, mm.
    pub target_edge_mm: f64,
    /// Length of a triangle along a band over its strip's width.
    pub band_aspect: f64,
    /// The same at most, in strips that are narrow beside the target: there rows are as long as a quarter of the
    /// target, up to so many times the width. Rows of neighbouring lines are set off by half their length, so the
    /// smallest angle inside such strips is `atan(2 / aspect)`: 48° for 1.8; 24° for 4.5, with half the
    /// vertices. Longer rows are split again by the refinement.
    pub narrow_aspect: f64,
    /// Largest distance of a curve from its edges, share of the target.
    pub chord: f64,
    /// Growth of the edge length per mm of distance from a band.
    pub grading: f64,
    /// Rounds of relaxation.
    pub relaxation_rounds: u32,
    /// Seed of the points inside.
    pub seed: u64,
    /// Which triangulation.
    pub backend: Backend,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self {
            method: Method::Graded,
            target_edge_mm: 20.0,
            band_aspect: 1.4,
            narrow_aspect: 1.8,
            chord: 0.05,
            grading: 0.25,
            relaxation_rounds: 6,
            seed: 1,
            backend: Backend::Spade,
        }
    }
}

/// A mesh with the planar graph it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Meshed {
    /// The classified mesh, open along slits. Its first vertices are the points of the graph, further ones the
    /// other lips of slits.
    pub mesh: FlatMesh,
    /// Points and constraints, for the cross-check; slits are not open yet.
    pub graph: PlanarGraph,
    /// Angles, sharp places of the pattern, and chords.
    pub inspection: Inspection,
}

/// Why a mesh cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// An option is out of its range.
    #[error("mesh.{name} is {value}; it must be {range}")]
    Option {
        /// Name in the project file.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// Two constraints cross away from their ends.
    #[error("{} crosses {} near ({:.3}, {:.3}) mm; move the creases apart or make the radius smaller", describe(.first), describe(.second), at.x, at.y)]
    Crossing {
        /// One constraint.
        first: Constraint,
        /// The other.
        second: Constraint,
        /// Where.
        at: DVec2,
    },
    /// The mesh would be larger than memory allows.
    #[error(
        "mesh.target_edge_mm = {target_edge_mm} and the bands ask for about {vertices:.0} vertices, more than {limit}; make it \
         larger, or give bands fewer segments or a larger radius (0 keeps a crease sharp)"
    )]
    TooMany {
        /// The option.
        target_edge_mm: f64,
        /// Vertices expected.
        vertices: f64,
        /// Most that are made.
        limit: u32,
    },
    /// The triangulation refused its input.
    #[error("triangulation: {0}")]
    Triangulation(String),
    /// The C++ side refused.
    #[error(transparent)]
    Kernel(#[from] softfold_kernel::KernelError),
    /// The result breaks its contract: a defect.
    #[error(transparent)]
    Check(#[from] CheckError),
}

fn describe(constraint: &Constraint) -> String {
    match constraint {
        Constraint::Fold { crease, line, .. } => format!("fold line {line} of crease {crease}"),
        Constraint::Boundary { loop_id } if loop_id.0 == 0 => "the outline".to_owned(),
        Constraint::Boundary { loop_id } => format!("hole {loop_id}"),
        Constraint::Slit { slit } => format!("slit {slit}"),
        Constraint::Junction { junction } => format!("the region of junction {junction}"),
    }
}

/// More vertices than this are refused: the solver would need hundreds of gigabytes.
const MOST_VERTICES: u32 = 4_000_000;
/// Vertices per unit of area over squared edge length: equilateral triangles have 2/√3.
const VERTEX_DENSITY: f64 = 1.1547;

/// Meshes a soft pattern.
///
/// Both lips of a slit are boundary edges, of the loop that follows those of the pattern in order of slits; its
/// vertices are doubled but for free tips. Edges inside the region of a junction and on its border are free.
///
/// # Errors
/// [`MeshError`]: options out of range, constraints that cross, too many vertices.
pub fn mesh(soft: &SoftPattern, options: &MeshOptions) -> Result<Meshed, MeshError> {
    check_options(soft, options)?;
    if options.method == Method::Paper {
        return paper::mesh(soft, options);
    }
    let boundaries = Boundaries::new(soft, options, shortest_row_mm(soft, options));
    let sizes = size::SizeField::new(soft, options, &graph::pieces(soft, &boundaries));
    let mut planar = GraphBuilder::new(soft, options, &boundaries, &sizes).build();
    let graph = &mut planar.graph;
    if let Some(i) = graph.points.iter().position(|p| !p.is_finite()) {
        return Err(CheckError::new("SoftPattern", format!("point {i} of its curves is not finite")).into());
    }
    let held = graph.points.len();
    let polygons = graph::boundary_polygons(&graph.points, &graph.constraints, soft.loops.len());
    let restless =
        interior::scatter(&mut graph.points, &polygons, &sizes, options.seed, MOST_VERTICES as usize);
    check_vertices(graph.points.len() as f64, options)?;
    planar.sites.resize(graph.points.len(), Site::Interior);
    let weight = if sizes.is_steep() { relax::Weight::Same } else { relax::Weight::Area };
    let mut draft = Draft::new(planar, options)?;
    relax::relax(&mut draft, held, options.relaxation_rounds, weight, restless);
    refine::refine(&mut draft, shortest_row_mm(soft, options));
    finished(soft, draft)
}

/// Inspected, opened along slits and classified.
fn finished(soft: &SoftPattern, draft: Draft<'_>) -> Result<Meshed, MeshError> {
    let inspection = quality::inspect(&draft);
    let triangles = draft.triangles();
    let Planar { graph, sites, .. } = draft.planar;
    let opened = split::open(&graph, sites, triangles);
    let mesh = classes::classified(&graph, opened, soft.loops.len());
    mesh.check()?;
    Ok(Meshed { mesh, graph, inspection })
}

/// Length of the shortest rows at their widest, mm; the target's without bands.
fn shortest_row_mm(soft: &SoftPattern, options: &MeshOptions) -> f64 {
    let stretches = soft.bands.iter().flat_map(stretches);
    stretches.map(|s| s.widest_edge_mm(options)).fold(options.target_edge_mm, f64::min)
}

fn check_options(soft: &SoftPattern, options: &MeshOptions) -> Result<(), MeshError> {
    let positive = |name, value: f64| match value.is_finite() && value > 0.0 {
        true => Ok(()),
        false => Err(MeshError::Option { name, value, range: "a positive number" }),
    };
    positive("target_edge_mm", options.target_edge_mm)?;
    positive("band_aspect", options.band_aspect)?;
    positive("narrow_aspect", options.narrow_aspect)?;
    positive("chord", options.chord)?;
    positive("grading", options.grading)?;
    let rows: f64 = soft.bands.iter().flat_map(stretches).map(|s| s.vertices(options)).sum();
    let lines =
        soft.loops.iter().chain(&soft.slits).map(|c| c.length_mm() / options.target_edge_mm).sum::<f64>();
    check_vertices(VERTEX_DENSITY * soft.area_mm2() / options.target_edge_mm.powi(2) + rows + lines, options)
}

fn check_vertices(vertices: f64, options: &MeshOptions) -> Result<(), MeshError> {
    let limit = MOST_VERTICES;
    match vertices > f64::from(limit) {
        true => Err(MeshError::TooMany { target_edge_mm: options.target_edge_mm, vertices, limit }),
        false => Ok(()),
    }
}
