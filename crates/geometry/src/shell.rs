//! The sheet surface in several faces: one on each side of what is sharp or slit.

use crate::{CheckError, CurveError, Deviation, Extreme, PlanarCurve, Segment, SheetSurface, UniformBicubic};

/// What an edge of a [`SheetShell`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShellEdgeKind {
    /// On the outline or a hole: one face ends there.
    Border,
    /// One lip of a slit: one face ends there.
    Slit,
    /// A sharp crease: two faces meet at an angle.
    Crease,
    /// Where a sharp crease or a slit ends inside the sheet, its faces go on to the next edge as one smooth surface: two
    /// faces meet whose surfaces are the same there.
    Smooth,
}

/// An edge in (u, v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellEdge {
    /// A line or a cubic.
    pub segment: Segment,
    /// What it is.
    pub kind: ShellEdgeKind,
    /// The corners at its start and end; the two lips of a slit have corners of their own.
    pub corners: [usize; 2],
}

/// An edge as a face's loop runs along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeUse {
    /// Number of the edge.
    pub edge: usize,
    /// Whether the loop runs against the edge's own direction.
    pub reversed: bool,
}

/// A face: a surface over (u, v) and the loops that bound it.
#[derive(Clone, Debug, PartialEq)]
pub struct ShellFace {
    /// The surface.
    pub spline: UniformBicubic,
    /// The outer loop (counter-clockwise), then inner ones (clockwise).
    pub loops: Vec<Vec<EdgeUse>>,
}

/// The folded sheet's surface as faces that share edges.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetShell {
    /// The faces; together they cover the sheet once.
    pub faces: Vec<ShellFace>,
    /// The edges: creases and smooth ones are used by two faces, one each way, the others by one.
    pub edges: Vec<ShellEdge>,
    /// How many corners there are.
    pub corners: usize,
    /// Distance to the folded vertices, those on creases seen from both faces.
    pub deviation: Deviation,
    /// Largest distance between two faces along an edge that they share, mm.
    pub gap_mm: Extreme,
}

impl SheetShell {
    /// One face with its trim as closed curves.
    ///
    /// # Errors
    /// A loop that does not join: against the contract.
    pub fn face_surface(&self, face: usize) -> Result<SheetSurface, CurveError> {
        let ShellFace { spline, loops } = &self.faces[face];
        let curve = |uses: &Vec<EdgeUse>| PlanarCurve::new(uses.iter().map(|u| self.segment(*u)).collect());
        let trim = loops.iter().map(curve).collect::<Result<_, _>>()?;
        Ok(SheetSurface { spline: spline.clone(), trim, deviation: self.deviation })
    }

    /// The segment of an edge in the direction of a loop.
    pub fn segment(&self, used: EdgeUse) -> Segment {
        let segment = &self.edges[used.edge].segment;
        if used.reversed { segment.reversed() } else { *segment }
    }

    /// Number of edges of a kind.
    pub fn count(&self, kind: ShellEdgeKind) -> usize {
        self.edges.iter().filter(|e| e.kind == kind).count()
    }

    /// The contract of this type: loops join, every edge is used as often as its kind says, faces have good surfaces.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), CheckError> {
        let fault = |f: String| Err(CheckError::new("SheetShell", f));
        let mut uses = vec![[0_usize; 2]; self.edges.len()];
        for (f, face) in self.faces.iter().enumerate() {
            face.spline.check()?;
            for of_loop in &face.loops {
                for (k, used) in of_loop.iter().enumerate() {
                    let next = of_loop[(k + 1) % of_loop.len()];
                    uses[used.edge][usize::from(used.reversed)] += 1;
                    if self.end(*used) != self.start(next) {
                        return fault(format!(
                            "edges {} and {} of face {f} do not join",
                            used.edge, next.edge
                        ));
                    }
                }
            }
        }
        let wanted = |kind| match kind {
            ShellEdgeKind::Border | ShellEdgeKind::Slit => [1, 0],
            ShellEdgeKind::Crease | ShellEdgeKind::Smooth => [1, 1],
        };
        match self.edges.iter().zip(&uses).position(|(e, n)| *n != wanted(e.kind)) {
            Some(i) => fault(format!("edge {i} is used {:?} times", uses[i])),
            None => Ok(()),
        }
    }

    fn start(&self, used: EdgeUse) -> usize {
        self.edges[used.edge].corners[usize::from(used.reversed)]
    }

    fn end(&self, used: EdgeUse) -> usize {
        self.edges[used.edge].corners[usize::from(!used.reversed)]
    }
}
