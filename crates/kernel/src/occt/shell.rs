use super::shape::{Shape, run};
use super::surface::BsplineSurface;
use crate::bridge::occt as ffi;
use crate::check;
use crate::error::Result;

/// A face of a shell: a surface over the rectangle that its border runs around.
#[derive(Debug, Clone, PartialEq)]
pub struct ShellFace {
    /// The surface.
    pub surface: BsplineSurface,
    /// Edges around it, counter-clockwise in its parameters, and whether the border runs as the edge does.
    pub border: Vec<(usize, bool)>,
}

/// What an edge is to one of its faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellUse {
    /// The face.
    pub face: usize,
    /// Its parameters at the edge's start.
    pub start: [f64; 2],
    /// Unit direction of the edge in them, along u or v.
    pub direction: [f64; 2],
}

/// An edge of a shell: a side, or a part of a side, of one or two faces, as long in the parameters of one as of the other.
#[derive(Debug, Clone, PartialEq)]
pub struct ShellEdge {
    /// Start and end, numbers of vertices.
    pub vertices: [usize; 2],
    /// Length in parameters.
    pub length: f64,
    /// Its faces; the edge is exactly on the first.
    pub uses: Vec<ShellUse>,
}

/// Faces that share edges, as one shell, and how far apart, mm, the faces are where they meet.
///
/// # Errors
/// Surfaces whose knots and poles do not fit together, numbers out of range, and a shell that OpenCascade finds invalid.
pub fn shell(vertices: &[[f64; 3]], edges: &[ShellEdge], faces: &[ShellFace]) -> Result<(Shape, f64)> {
    const OPERATION: &str = "occt::shell";
    check::finite(OPERATION, "vertex", vertices)?;
    check_numbers(OPERATION, vertices.len(), edges, faces)?;
    let flat = ffi::FlatShell {
        surfaces: faces.iter().map(|f| f.surface.checked(OPERATION)).collect::<Result<_>>()?,
        vertices: vertices.as_flattened().to_vec(),
        edge_vertices: edges.iter().flat_map(|e| e.vertices.map(|v| v as u32)).collect(),
        edge_lengths: edges.iter().map(|e| e.length).collect(),
        edge_uses: edges.iter().map(|e| e.uses.len() as u32).collect(),
        use_faces: edges.iter().flat_map(|e| e.uses.iter().map(|u| u.face as u32)).collect(),
        use_lines: edges.iter().flat_map(|e| e.uses.iter().flat_map(line)).collect(),
        border_sizes: faces.iter().map(|f| f.border.len() as u32).collect(),
        border_edges: faces.iter().flat_map(|f| f.border.iter().map(|b| b.0 as u32)).collect(),
        border_forward: faces.iter().flat_map(|f| f.border.iter().map(|b| u8::from(b.1))).collect(),
    };
    let sewn = run(OPERATION, || ffi::shell(&flat))?;
    Ok((Shape::wrap(OPERATION, sewn.shape)?, sewn.gap))
}

fn line(u: &ShellUse) -> [f64; 4] {
    [u.start[0], u.start[1], u.direction[0], u.direction[1]]
}

fn check_numbers(
    operation: &'static str,
    vertices: usize,
    edges: &[ShellEdge],
    faces: &[ShellFace],
) -> Result<()> {
    check::require(operation, !faces.is_empty(), || "a shell without faces".into())?;
    let good = |e: &ShellEdge| {
        let used = !e.uses.is_empty() && e.uses.iter().all(|u| u.face < faces.len());
        let axis = |d: [f64; 2]| d[0].abs() + d[1].abs() == 1.0 && d[0] * d[1] == 0.0;
        used && e.length > 0.0
            && e.vertices.iter().all(|v| *v < vertices)
            && e.uses.iter().all(|u| axis(u.direction))
    };
    let bad = edges.iter().position(|e| !good(e));
    check::require(operation, bad.is_none(), || {
        format!("edge {} {:?} has no place", bad.unwrap_or(0), edges[bad.unwrap_or(0)])
    })?;
    let bad = faces.iter().position(|f| f.border.len() < 2 || f.border.iter().any(|b| b.0 >= edges.len()));
    check::require(operation, bad.is_none(), || format!("face {} has no border", bad.unwrap_or(0)))
}
