//! Catmull-Clark limit surfaces of quad cages, by OpenSubdiv.
//!
//! The border of a cage is a sharp crease and its corners (vertices of one quad) are sharp too: the limit surface
//! reaches to the border, and every quad of a regular lattice, at its border too, is one bicubic B-spline patch.

use crate::bridge::opensubdiv as ffi;
use crate::buffers::tuples;
use crate::check;
use crate::error::{Library, Result};

/// Halvings of a quad at an extraordinary vertex that limit stencils are exact to.
const MOST_ISOLATION: u32 = 6;

/// A quad mesh by its connections alone.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Cage {
    /// How many vertices `quads` may name.
    pub vertex_count: usize,
    /// Four vertices each, counter-clockwise; neighbours must agree in orientation.
    pub quads: Vec<[u32; 4]>,
}

/// A place on the limit surface. In quad `[a, b, c, d]`, a is (0, 0), b (1, 0), c (1, 1) and d (0, 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The quad.
    pub quad: u32,
    /// From a to b, 0 to 1.
    pub s: f64,
    /// From a to d, 0 to 1.
    pub t: f64,
}

/// Sparse rows over the vertices of a cage: row `i` is `offsets[i]..offsets[i + 1]` of the other arrays. The limit
/// point of a sample is the sum of its weights times the vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stencils {
    /// Where rows begin; one longer than there are rows.
    pub offsets: Vec<u32>,
    /// Vertices of the cage.
    pub indices: Vec<u32>,
    /// Weights of the limit point; a row adds up to 1.
    pub weights: Vec<f64>,
    /// Weights of the derivative by s; a row adds up to 0.
    pub weights_s: Vec<f64>,
    /// Weights of the derivative by t; a row adds up to 0.
    pub weights_t: Vec<f64>,
}

/// Points that are weighted sums of cage vertices, in sparse rows like [`Stencils`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LocalPoints {
    /// Where rows begin; one longer than there are points.
    pub offsets: Vec<u32>,
    /// Vertices of the cage.
    pub indices: Vec<u32>,
    /// Their weights; a row adds up to 1.
    pub weights: Vec<f64>,
}

/// The limit surface as uniform bicubic B-spline patches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BsplinePatches {
    /// Sixteen control points per patch in four rows, t outer and s inner. Below `vertex_count` they are vertices of
    /// the cage; above, `local_points` beginning at `vertex_count`.
    pub control_points: Vec<[u32; 16]>,
    /// The quad each patch lies in.
    pub quads: Vec<u32>,
    /// The square of that quad each patch covers: least s, least t, side. `[0, 0, 1]` away from extraordinary vertices.
    pub domains: Vec<[f64; 3]>,
    /// Control points that are no vertices of the cage: past its border and around extraordinary vertices.
    pub local_points: LocalPoints,
}

/// Weights of limit points and their first derivatives; one row per sample, in the order of `samples`.
///
/// Exact in regular regions; around an extraordinary vertex exact down to 1/64 of a quad, and a Gregory patch below.
///
/// # Errors
/// A cage that is empty, names vertices out of range or is no oriented manifold; samples outside of quads.
pub fn limit_stencils(cage: &Cage, samples: &[Sample]) -> Result<Stencils> {
    const OPERATION: &str = "opensubdiv::limit_stencils";
    check_cage(OPERATION, cage)?;
    check_samples(OPERATION, cage, samples)?;
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by_key(|&i| samples[i].quad);
    let quads: Vec<u32> = order.iter().map(|&i| samples[i].quad).collect();
    let st: Vec<[f64; 2]> = order.iter().map(|&i| [samples[i].s, samples[i].t]).collect();
    let grouped =
        ffi::limit_stencils(cage.vertex_count as u32, cage.quads.as_flattened(), &quads, st.as_flattened())
            .map_err(Library::OpenSubdiv.failure(OPERATION))?;
    Ok(in_order_of_samples(&grouped, &order))
}

/// The limit surface as B-spline patches; around extraordinary vertices a quad is split into ever smaller patches,
/// the last of which approximate.
///
/// # Errors
/// A cage that is empty, names vertices out of range or is no oriented manifold.
pub fn bspline_patches(cage: &Cage) -> Result<BsplinePatches> {
    bspline_patches_isolated(cage, MOST_ISOLATION)
}

/// As [`bspline_patches`], with quads at extraordinary vertices halved `isolation` times, 1 to 6, before the rest of them
/// is one patch: fewer patches, and a coarser approximation in that rest.
///
/// # Errors
/// As [`bspline_patches`]; an isolation out of range.
pub fn bspline_patches_isolated(cage: &Cage, isolation: u32) -> Result<BsplinePatches> {
    const OPERATION: &str = "opensubdiv::bspline_patches";
    check_cage(OPERATION, cage)?;
    check::require(OPERATION, (1..=MOST_ISOLATION).contains(&isolation), || {
        format!("isolation {isolation}; 1 to {MOST_ISOLATION}")
    })?;
    let flat = ffi::bspline_patches(cage.vertex_count as u32, cage.quads.as_flattened(), isolation)
        .map_err(Library::OpenSubdiv.failure(OPERATION))?;
    Ok(BsplinePatches {
        control_points: tuples(&flat.control_points),
        quads: flat.quads,
        domains: tuples(&flat.domains),
        local_points: LocalPoints {
            offsets: flat.local_points.offsets,
            indices: flat.local_points.indices,
            weights: flat.local_points.weights,
        },
    })
}

fn check_cage(operation: &'static str, cage: &Cage) -> Result<()> {
    check::require(operation, !cage.quads.is_empty(), || "the cage has no quads".into())?;
    check::addressable(operation, "vertices", cage.vertex_count)?;
    check::addressable(operation, "quads", cage.quads.len())?;
    check::indices(operation, "quad", &cage.quads, cage.vertex_count)?;
    let degenerate = |q: &[u32; 4]| (0..4).any(|i| (0..i).any(|j| q[i] == q[j]));
    let found = cage.quads.iter().position(degenerate);
    check::require(operation, found.is_none(), || format!("quad {} names a vertex twice", found.unwrap_or(0)))
}

fn check_samples(operation: &'static str, cage: &Cage, samples: &[Sample]) -> Result<()> {
    let inside = |x: f64| (0.0..=1.0).contains(&x);
    let fits = |p: &Sample| (p.quad as usize) < cage.quads.len() && inside(p.s) && inside(p.t);
    let found = samples.iter().position(|sample| !fits(sample));
    check::require(operation, found.is_none(), || {
        let i = found.unwrap_or(0);
        format!("sample {i} {:?} is outside of the {} quads", samples[i], cage.quads.len())
    })
}

/// Row `k` of `grouped` belongs to sample `order[k]`.
fn in_order_of_samples(grouped: &ffi::FlatStencils, order: &[usize]) -> Stencils {
    let mut row_of_sample = vec![0; order.len()];
    for (row, &sample) in order.iter().enumerate() {
        row_of_sample[sample] = row;
    }
    let mut stencils = Stencils { offsets: vec![0], ..Stencils::default() };
    for row in row_of_sample {
        let range = grouped.offsets[row] as usize..grouped.offsets[row + 1] as usize;
        stencils.indices.extend(&grouped.indices[range.clone()]);
        stencils.weights.extend(&grouped.weights[range.clone()]);
        stencils.weights_s.extend(&grouped.weights_s[range.clone()]);
        stencils.weights_t.extend(&grouped.weights_t[range]);
        stencils.offsets.push(stencils.indices.len() as u32);
    }
    stencils
}
