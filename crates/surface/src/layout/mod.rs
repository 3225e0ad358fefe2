//! How sharp creases and slits divide the flat sheet into faces: a planar subdivision whose edges are exact curves.

mod extend;
mod plane;

use crate::SurfaceError;
use glam::DVec2;
use plane::{Loop, Plane};
use softfold_geometry::{
    CreaseId, EdgeUse, PlanarCurve, Segment, ShellEdge, ShellEdgeKind, Tolerance, polygon,
};

/// What a [`Cut`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutKind {
    /// A sharp stretch of a crease; the mesh knows it as a fold line.
    Crease {
        /// The crease.
        crease: CreaseId,
        /// Number of the line in its band.
        line: u32,
    },
    /// A slit; the mesh is open there.
    Slit,
}

/// A curve along which the sheet is not smooth.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Where; open, or closed inside the sheet. Ends that meet other curves lie on them within the join tolerance.
    pub curve: PlanarCurve,
    /// What it is.
    pub kind: CutKind,
}

/// A curve of the subdivision before it is divided.
#[derive(Clone, Debug)]
struct Line {
    curve: PlanarCurve,
    kind: ShellEdgeKind,
    /// Number of its cut.
    cut: Option<usize>,
}

/// The faces of the flat sheet.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Edges, each a single segment.
    pub(crate) edges: Vec<ShellEdge>,
    /// Faces by their loops.
    pub(crate) faces: Vec<Vec<Vec<EdgeUse>>>,
    /// How many corners there are.
    pub(crate) corners: usize,
    /// Faces on the left and right of each edge; borders have none on the right.
    pub(crate) sides: Vec<[Option<usize>; 2]>,
    /// Cuts, by number, that end where no face ends: the surface cannot follow them.
    pub(crate) lost: Vec<usize>,
    outlines: Vec<FaceOutline>,
}

/// Polygons of a face's loops, and the box around the control points of the outer one.
#[derive(Clone, Debug)]
struct FaceOutline {
    loops: Vec<Vec<DVec2>>,
    bounds: (DVec2, DVec2),
}

impl Layout {
    /// Divides the sheet inside of `trim` along `cuts`. Cuts that end inside a face are lengthened straight on, to the
    /// next curve, by an edge across which the surface stays smooth.
    ///
    /// # Errors
    /// A trim that does not close or bounds nothing.
    pub(crate) fn new(trim: &[PlanarCurve], cuts: &[Cut]) -> Result<Self, SurfaceError> {
        let tolerance = tolerance(trim)?;
        let mut lines: Vec<Line> = trim.iter().map(|c| Line::border(c.clone())).collect();
        lines.extend(cuts.iter().enumerate().map(|(i, cut)| Line::of_cut(i, cut)));
        extend::lengthen(&mut lines, &tolerance);
        let mut lost = Vec::new();
        let mut plane = Plane::new(&lines, &tolerance)?;
        loop {
            let loops = plane.loops();
            let faces = plane.faces(&loops, tolerance.chord_mm)?;
            let within = plane.within_one_face(&loops, &faces);
            if within.is_empty() {
                lost.sort_unstable();
                lost.dedup();
                return Ok(Self::of(&plane, &loops, &faces, lost, tolerance.chord_mm));
            }
            lost.extend(within.iter().filter_map(|&e| plane.edges[e].cut));
            plane.remove(&within);
        }
    }

    fn of(plane: &Plane, loops: &[Loop], faces: &[Vec<usize>], lost: Vec<usize>, chord_mm: f64) -> Self {
        let shell = plane.shell_edges(loops);
        let used = |l: &usize| -> Vec<EdgeUse> { loops[*l].halves.iter().map(|h| shell.uses[h]).collect() };
        let faces: Vec<Vec<Vec<EdgeUse>>> = faces.iter().map(|of| of.iter().map(used).collect()).collect();
        let mut sides = vec![[None; 2]; shell.edges.len()];
        for (f, used) in faces.iter().enumerate().flat_map(|(f, ls)| ls.iter().flatten().map(move |u| (f, u)))
        {
            sides[used.edge][usize::from(used.reversed)] = Some(f);
        }
        let mut layout =
            Self { edges: shell.edges, faces, corners: shell.corners, sides, lost, outlines: vec![] };
        layout.outlines = (0..layout.faces.len()).map(|f| layout.outline(f, chord_mm)).collect();
        layout
    }

    fn outline(&self, face: usize, chord_mm: f64) -> FaceOutline {
        let loops: Vec<_> = self.faces[face].iter().map(|uses| self.flatten(uses, chord_mm)).collect();
        // With control points, which lie outside of the curves: kernels want them in the surface's domain too.
        let segments = self.faces[face][0].iter().map(|u| self.edges[u.edge].segment);
        let bounds = polygon::bounds(&segments.flat_map(|s| s.control_points()).collect::<Vec<_>>());
        FaceOutline { loops, bounds }
    }

    /// A loop as a polygon.
    fn flatten(&self, uses: &[EdgeUse], chord_mm: f64) -> Vec<DVec2> {
        uses.iter().flat_map(|u| plane::flat(&self.segment(*u), chord_mm)).collect()
    }

    /// The segment of an edge in the direction of a loop.
    fn segment(&self, used: EdgeUse) -> Segment {
        let segment = self.edges[used.edge].segment;
        if used.reversed { segment.reversed() } else { segment }
    }

    /// The box around the control points of a face.
    pub(crate) fn bounds(&self, face: usize) -> (DVec2, DVec2) {
        self.outlines[face].bounds
    }

    /// The face that a point lies in; of points outside of all, the one whose outline is nearest.
    pub(crate) fn face_of(&self, p: DVec2) -> usize {
        let contains = |o: &FaceOutline| {
            p.cmpge(o.bounds.0).all() && p.cmple(o.bounds.1).all() && {
                o.loops.iter().filter(|l| polygon::contains(l, p)).count() % 2 == 1
            }
        };
        self.outlines.iter().position(contains).unwrap_or_else(|| {
            let distance = |o: &FaceOutline| {
                let edges = o.loops.iter().flat_map(|l| polygon::edges(l));
                edges.map(|(a, b)| polygon::segment_distance(p, a, b)).fold(f64::INFINITY, f64::min)
            };
            let all = self.outlines.iter().map(distance).enumerate();
            all.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(f, _)| f)
        })
    }
}

impl Line {
    fn border(curve: PlanarCurve) -> Self {
        Self { curve, kind: ShellEdgeKind::Border, cut: None }
    }

    fn of_cut(number: usize, cut: &Cut) -> Self {
        let kind = match cut.kind {
            CutKind::Crease { .. } => ShellEdgeKind::Crease,
            CutKind::Slit => ShellEdgeKind::Slit,
        };
        Self { curve: cut.curve.clone(), kind, cut: Some(number) }
    }
}

/// Tolerances of the sheet inside of a trim.
///
/// # Errors
/// No trim, or one that is not closed.
pub(crate) fn tolerance(trim: &[PlanarCurve]) -> Result<Tolerance, SurfaceError> {
    if let Some((number, curve)) = trim.iter().enumerate().find(|(_, c)| !c.is_closed()) {
        return Err(SurfaceError::OpenTrim { number, at: curve.end(1) });
    }
    let Some(outline) = trim.first() else { return Err(SurfaceError::NoTrim) };
    // A closed curve is at most half its length across.
    Ok(Tolerance::for_size(0.5 * outline.length_mm()))
}

#[cfg(test)]
mod tests;
