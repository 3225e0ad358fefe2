use super::shape::Shape;
use super::surface::{BsplineSurface, TrimCurve, check_curve};
use crate::bridge::occt as ffi;
use crate::check;
use crate::error::Result;

/// Faces over (u, v) that share edges and corners.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ShellTopology {
    /// Each edge: its curve, the same in the (u, v) of all faces that have it, and its corners at start and end.
    pub edges: Vec<(TrimCurve, [usize; 2])>,
    /// How many corners the edges may name.
    pub corners: usize,
    /// The loops of each face: edges with whether the loop runs against their direction. The first runs counter-clockwise,
    /// the others clockwise around holes; each edge begins at the corner where the one before ends.
    pub faces: Vec<Vec<Vec<(usize, bool)>>>,
}

/// The shell of the faces of `topology`, one on each of `surfaces`. Faces that have an edge in common share it: its 3D
/// curve is its image on the first of them, and its tolerance what the others are off.
///
/// # Errors
/// Surfaces whose knots and poles do not fit together; topology that names what is not there; edges that leave the domain
/// of their surfaces; a shell that OpenCascade does not find valid.
pub fn sheet_shell(surfaces: &[BsplineSurface], topology: &ShellTopology) -> Result<Shape> {
    const OPERATION: &str = "occt::sheet_shell";
    let flat = topology.checked(OPERATION, surfaces)?;
    let surfaces = surfaces.iter().map(|s| s.checked(OPERATION)).collect::<Result<Vec<_>>>()?;
    Shape::made_by(OPERATION, || ffi::sheet_shell(&surfaces, &flat))
}

impl ShellTopology {
    fn checked(&self, operation: &'static str, surfaces: &[BsplineSurface]) -> Result<ffi::FlatSheetShell> {
        let count = self.faces.len();
        check::require(operation, count > 0 && count == surfaces.len(), || {
            format!("{} surfaces for {count} faces", surfaces.len())
        })?;
        check::addressable(operation, "edges", 2 * self.edges.len())?;
        check::addressable(operation, "corners", self.corners)?;
        for (e, (_, corners)) in self.edges.iter().enumerate() {
            check::require(operation, corners.iter().all(|c| *c < self.corners), || {
                format!("edge {e} names a corner of {corners:?}, but there are {}", self.corners)
            })?;
        }
        let mut flat = self.flat_edges();
        for (f, loops) in self.faces.iter().enumerate() {
            flat.face_sizes.push(loops.len() as u32);
            for uses in loops {
                self.check_loop(operation, f, uses, &surfaces[f])?;
                flat.loop_sizes.push(uses.len() as u32);
                flat.uses.extend(uses.iter().map(|&(edge, reversed)| 2 * edge as u32 + u32::from(reversed)));
            }
        }
        Ok(flat)
    }

    fn flat_edges(&self) -> ffi::FlatSheetShell {
        let poles: Vec<Vec<[f64; 2]>> = self.edges.iter().map(|(curve, _)| curve.poles()).collect();
        ffi::FlatSheetShell {
            edge_sizes: poles.iter().map(|p| p.len() as u32).collect(),
            poles: poles.concat().as_flattened().to_vec(),
            edge_corners: self.edges.iter().flat_map(|(_, c)| c.map(|c| c as u32)).collect(),
            corner_count: self.corners as u32,
            face_sizes: Vec::new(),
            loop_sizes: Vec::new(),
            uses: Vec::new(),
        }
    }

    fn check_loop(
        &self,
        operation: &'static str,
        face: usize,
        uses: &[(usize, bool)],
        surface: &BsplineSurface,
    ) -> Result<()> {
        check::require(operation, !uses.is_empty(), || format!("face {face} has an empty loop"))?;
        for (k, &(edge, reversed)) in uses.iter().enumerate() {
            let Some((curve, corners)) = self.edges.get(edge) else {
                return check::require(operation, false, || {
                    format!("face {face} names edge {edge}, which is not there")
                });
            };
            check_curve(operation, &format!("edge {edge}"), &curve.poles(), &[surface], 0.0)?;
            let (next, backwards) = uses[(k + 1) % uses.len()];
            let end = corners[usize::from(!reversed)];
            let start = self.edges.get(next).map(|(_, c)| c[usize::from(backwards)]);
            check::require(operation, start == Some(end), || {
                format!("edges {edge} and {next} of face {face} do not join")
            })?;
        }
        Ok(())
    }
}
