//! Every region of the softened sheet: the planar subdivision by boundary curves, fold lines, free ends and
//! junction regions. Boundary curves count by their true shape, fold lines as the polylines that they are.

mod graph;

use crate::path::Path;
use graph::{Edge, Graph, Loop};
use softfold_geometry::{
    CheckError, CreaseId, DVec2, FoldLine, LineEnd, LoopId, PlanarCurve, SoftPattern, polygon,
};
use std::collections::BTreeMap;

/// What a region of the sheet is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RegionKind {
    /// Between bands, sharp creases and the boundary.
    Face,
    /// A strip of a band.
    Strip {
        /// The crease.
        crease: CreaseId,
        /// Number of the soft stretch or sharp stretch along the crease, from 0.
        stretch: u32,
        /// Between the fold lines of this rank and the next.
        rank: u32,
    },
    /// The region of a junction, by its number.
    Junction(usize),
}

/// A region of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetRegion {
    /// What it is.
    pub kind: RegionKind,
    /// Area, mm²; exact but for rounding.
    pub area_mm2: f64,
}

/// What is on one side of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SideOf {
    /// Whatever the rest of the region's edges say.
    Any,
    Known(RegionKind),
    /// Not on the sheet.
    Outside,
}

/// All regions of the sheet, each once: faces, then strips, then junction regions. Their areas add up to that
/// of the sheet. Strips that end freely are closed straight between the ends of their fold lines.
///
/// # Errors
/// Fold lines that do not bound what their ranks say: a defect of the pattern.
pub fn regions(soft: &SoftPattern) -> Result<Vec<SheetRegion>, CheckError> {
    let mut builder = Builder::new(soft);
    for (i, band) in soft.bands.iter().enumerate() {
        builder.band(CreaseId::new(i), band.segments, &band.fold_lines);
    }
    for (j, junction) in soft.junctions.iter().enumerate() {
        builder.junction(j, junction.point, &junction.polygon);
    }
    builder.slit_ends();
    builder.boundary();
    collected(&builder.graph.loops())
}

/// Regions of the loops: loops that run clockwise are inner edges of the region around them.
fn collected(loops: &[Loop]) -> Result<Vec<SheetRegion>, CheckError> {
    let mut faces: Vec<(&Loop, f64)> = Vec::new();
    let mut known: BTreeMap<RegionKind, f64> = BTreeMap::new();
    let mut inner = Vec::new();
    for l in loops {
        match kind_of(l)? {
            SideOf::Outside => {}
            SideOf::Known(kind) => *known.entry(kind).or_default() += l.area_mm2,
            SideOf::Any if l.area_mm2 > 0.0 => faces.push((l, l.area_mm2)),
            SideOf::Any => inner.push(l),
        }
    }
    for l in inner {
        // What is around is larger than what is in it: the loop's own faces, whose edge it is, are not.
        let least_mm2 = -l.area_mm2 * (1.0 + SAME_AREA);
        let around =
            |f: &&mut (&Loop, f64)| f.0.area_mm2 > least_mm2 && polygon::contains(&f.0.points, l.points[0]);
        let smaller = |a: &&mut (&Loop, f64), b: &&mut (&Loop, f64)| a.0.area_mm2.total_cmp(&b.0.area_mm2);
        match faces.iter_mut().filter(around).min_by(smaller) {
            Some(face) => face.1 += l.area_mm2,
            None => return fault(format!("a loop at ({}, {}) is in no face", l.points[0].x, l.points[0].y)),
        }
    }
    let faces = faces.into_iter().map(|(_, area_mm2)| SheetRegion { kind: RegionKind::Face, area_mm2 });
    Ok(faces.chain(known.into_iter().map(|(kind, area_mm2)| SheetRegion { kind, area_mm2 })).collect())
}

fn kind_of(l: &Loop) -> Result<SideOf, CheckError> {
    let mut kind = SideOf::Any;
    for side in l.sides.iter().filter(|s| **s != SideOf::Any) {
        match kind {
            SideOf::Any => kind = *side,
            _ if kind == *side => {}
            _ => {
                let at = l.points[0];
                return fault(format!("{kind:?} and {side:?} are one region at ({}, {})", at.x, at.y));
            }
        }
    }
    Ok(kind)
}

fn fault<T>(what: String) -> Result<T, CheckError> {
    Err(CheckError::new("SoftPattern", what))
}

/// Areas that differ by this share are the same: rounding.
const SAME_AREA: f64 = 1e-9;

/// Collects the edges of the subdivision.
struct Builder<'a> {
    soft: &'a SoftPattern,
    graph: Graph,
    /// By boundary curve: arc lengths of nodes.
    splits: BTreeMap<LoopId, Vec<(f64, usize)>>,
    origin: DVec2,
}

impl<'a> Builder<'a> {
    fn new(soft: &'a SoftPattern) -> Self {
        let origin = soft.loops.first().map_or(DVec2::ZERO, |l| l.end(0));
        let graph = Graph::new(2.0 * soft.tolerance.point_mm);
        Self { soft, graph, splits: BTreeMap::new(), origin }
    }

    fn curves(&self) -> impl Iterator<Item = (LoopId, &'a PlanarCurve)> + use<'a> {
        let soft = self.soft;
        soft.loops.iter().chain(&soft.slits).enumerate().map(|(i, c)| (LoopId::new(i), c))
    }

    /// The fold lines of a band and its free ends.
    fn band(&mut self, crease: CreaseId, segments: u32, lines: &[FoldLine]) {
        let mut stretch = 0;
        for (i, line) in lines.iter().enumerate() {
            if i > 0 && line.rank.is_none_or(|k| k == 0) {
                stretch += 1;
            }
            let strip = |rank| SideOf::Known(RegionKind::Strip { crease, stretch, rank });
            let right = line.rank.and_then(|k| k.checked_sub(1)).map_or(SideOf::Any, strip);
            let left = line.rank.filter(|k| *k < segments).map_or(SideOf::Any, strip);
            self.fold_line(line, [left, right]);
            let next = lines.get(i + 1).filter(|n| n.rank.is_some_and(|k| k > 0));
            for (side, next) in next.into_iter().flat_map(|n| [(0, n), (1, n)]) {
                self.cap([line, next], side);
            }
        }
    }

    fn fold_line(&mut self, line: &FoldLine, sides: [SideOf; 2]) {
        let nodes = [0, 1].map(|side| {
            let node = self.graph.node(end_of(line, side));
            if let LineEnd::Boundary(on) = line.ends[side] {
                self.splits.entry(on.loop_id).or_default().push((on.s_mm, node));
            }
            node
        });
        self.straight(nodes, &line.points, sides);
    }

    /// Closes a strip that ends freely.
    fn cap(&mut self, lines: [&FoldLine; 2], side: usize) {
        if lines.iter().any(|l| l.ends[side] == LineEnd::Free) {
            let ends = lines.map(|l| end_of(l, side));
            let nodes = ends.map(|p| self.graph.node(p));
            if nodes[0] != nodes[1] {
                self.straight(nodes, &ends, [SideOf::Any; 2]);
            }
        }
    }

    /// The sides of a junction region, and where it touches the boundary.
    fn junction(&mut self, j: usize, point: DVec2, corners: &[DVec2]) {
        if corners.is_empty() || corners.contains(&point) {
            let node = self.graph.node(point);
            self.split_boundary(point, node, None);
        }
        for (a, b) in polygon::edges(corners) {
            let nodes = [a, b].map(|p| self.graph.node(p));
            self.straight(nodes, &[a, b], [SideOf::Known(RegionKind::Junction(j)), SideOf::Any]);
        }
    }

    /// The ends of slits, which may lie on other boundary curves.
    fn slit_ends(&mut self) {
        let first = self.soft.loops.len();
        for (i, slit) in self.soft.slits.iter().enumerate() {
            let id = LoopId::new(first + i);
            for (side, s_mm) in [(0, 0.0), (1, slit.length_mm())] {
                let node = self.graph.node(slit.end(side));
                self.splits.entry(id).or_default().push((s_mm, node));
                self.split_boundary(slit.end(side), node, Some(id));
            }
        }
    }

    /// Makes a node one of all boundary curves that it lies on.
    fn split_boundary(&mut self, point: DVec2, node: usize, except: Option<LoopId>) {
        for (id, curve) in self.curves().filter(|(id, _)| Some(*id) != except) {
            let (s_mm, distance) = curve.nearest(point);
            if distance <= self.soft.tolerance.join_mm {
                self.splits.entry(id).or_default().push((s_mm, node));
            }
        }
    }

    /// The boundary curves between their nodes.
    fn boundary(&mut self) {
        for (id, curve) in self.curves() {
            let mut splits = self.splits.remove(&id).unwrap_or_default();
            splits.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.merge_ends(curve, &mut splits);
            if splits.is_empty() {
                splits.push((0.0, self.graph.node(curve.end(0))));
            }
            if curve.is_closed() {
                let (first, last) = (splits[0], splits[splits.len() - 1]);
                if first.1 == last.1 && splits.len() > 1 {
                    splits.pop();
                }
                splits.push((first.0 + curve.length_mm(), first.1));
            }
            let is_loop = id.index() < self.soft.loops.len();
            let sides = [SideOf::Any, if is_loop { SideOf::Outside } else { SideOf::Any }];
            for w in splits.windows(2) {
                self.curved(curve, [w[0], w[1]], sides);
            }
        }
    }

    /// Ends that lie on a boundary curve within tolerance only, and so close that their order on it is not
    /// known, become one.
    fn merge_ends(&mut self, curve: &PlanarCurve, splits: &mut Vec<(f64, usize)>) {
        let mut i = 1;
        while i < splits.len() {
            let (a, b) = (splits[i - 1], splits[i]);
            let off = |s: (f64, usize)| curve.point(s.0).distance(self.graph.nodes[s.1]);
            if a.1 != b.1 && b.0 - a.0 > off(a) + off(b) + self.graph.same_mm {
                i += 1;
                continue;
            }
            splits.remove(i);
            if a.1 != b.1 {
                self.graph.merge(a.1, b.1);
                let others = self.splits.values_mut().flatten().chain(splits.iter_mut());
                others.filter(|s| s.1 == b.1).for_each(|s| s.1 = a.1);
            }
        }
    }

    fn straight(&mut self, nodes: [usize; 2], points: &[DVec2], sides: [SideOf; 2]) {
        let seen = |w: &[DVec2]| 0.5 * (w[0] - self.origin).perp_dot(w[1] - self.origin);
        let swept_mm2 = points.windows(2).map(seen).sum();
        let n = points.len();
        let leaving = [points[1] - points[0], points[n - 2] - points[n - 1]];
        self.graph.edges.push(Edge { nodes, leaving, swept_mm2, points: points.to_vec(), sides });
    }

    fn curved(&mut self, curve: &PlanarCurve, [a, b]: [(f64, usize); 2], sides: [SideOf; 2]) {
        let (mut swept_mm2, mut points) = (0.0, Vec::new());
        for (path, t) in pieces_between(curve, [a.0, b.0]) {
            swept_mm2 += path.swept_mm2(t, self.origin);
            let n = path.pieces(self.soft.tolerance.join_mm, MOST_PIECES);
            points.extend((0..n).map(|k| path.point(t[0] + (t[1] - t[0]) * k as f64 / n as f64)));
        }
        points.push(self.graph.nodes[b.1]);
        if let Some(first) = points.first_mut() {
            *first = self.graph.nodes[a.1];
        }
        let step = TANGENT_STEP * (b.0 - a.0);
        let leaving = [curve.tangent(a.0 + step), -curve.tangent(b.0 - step)];
        self.graph.edges.push(Edge { nodes: [a.1, b.1], leaving, swept_mm2, points, sides });
    }
}

/// Most pieces of a segment that stand for it when points are looked for in a region.
const MOST_PIECES: usize = 256;
/// A piece's tangents are taken this share inside its ends: at a corner, those of the piece itself.
const TANGENT_STEP: f64 = 1e-6;

fn end_of(line: &FoldLine, side: usize) -> DVec2 {
    if side == 0 { line.points[0] } else { line.points[line.points.len() - 1] }
}

/// The segments of a curve between two arc lengths, with their parameters; beyond the length of a closed
/// curve it goes on from its start.
fn pieces_between(curve: &PlanarCurve, [a, b]: [f64; 2]) -> Vec<(Path, [f64; 2])> {
    let (length, joints) = (curve.length_mm(), curve.joints_mm());
    let mut pieces = Vec::new();
    for lap in [0.0, length] {
        for (i, segment) in curve.segments().iter().enumerate() {
            let [low, high] = [(a - lap).max(joints[i]), (b - lap).min(joints[i + 1])];
            if low < high {
                let path = Path::from(segment);
                let parameter = |s: f64| match s {
                    s if s <= joints[i] => 0.0,
                    s if s >= joints[i + 1] => 1.0,
                    s => path.parameter(s - joints[i]),
                };
                pieces.push((path, [low, high].map(parameter)));
            }
        }
    }
    pieces
}
