//! The polysurface for OpenCascade.

use super::faces::BsplineFace;
use super::sew::Polysurface;
use glam::DVec2;
use softfold_kernel::KernelError;
use softfold_kernel::occt::{self, BsplineSurface, Shape, ShellEdge, ShellFace, ShellUse};

impl Polysurface {
    /// The surface as one shell whose faces share their edges, and how far apart, mm, faces are where they meet.
    ///
    /// # Errors
    /// What OpenCascade finds invalid.
    pub fn to_shell(&self) -> Result<(Shape, f64), KernelError> {
        let vertices: Vec<[f64; 3]> = self.vertices.iter().map(|p| p.to_array()).collect();
        let edge_use = |u: &super::sew::EdgeUse| ShellUse {
            face: u.face,
            start: u.start.to_array(),
            direction: axis(u.direction).to_array(),
        };
        let edges: Vec<ShellEdge> = self
            .edges
            .iter()
            .map(|e| ShellEdge {
                vertices: e.vertices,
                length: e.length,
                uses: e.uses.iter().map(edge_use).collect(),
            })
            .collect();
        let border = |f: usize| {
            self.borders[f].iter().map(|&(e, k)| (e, self.edges[e].uses[k].forward)).collect::<Vec<_>>()
        };
        let faces: Vec<ShellFace> = (0..self.faces.len())
            .map(|f| ShellFace { surface: surface(&self.faces[f]), border: border(f) })
            .collect();
        occt::shell(&vertices, &edges, &faces)
    }
}

/// A direction along u or v, exactly.
fn axis(d: DVec2) -> DVec2 {
    d.round()
}

fn surface(face: &BsplineFace) -> BsplineSurface {
    let knots = |count: usize| (0..count + 4).map(|k| (k as f64 - 3.0) * face.step).collect::<Vec<_>>();
    let [knots_u, knots_v] = face.count.map(knots);
    BsplineSurface {
        poles: face.poles.iter().map(|p| p.to_array()).collect(),
        pole_count: face.count,
        multiplicities_u: vec![1; knots_u.len()],
        multiplicities_v: vec![1; knots_v.len()],
        knots_u,
        knots_v,
    }
}
