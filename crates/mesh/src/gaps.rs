//! Where lines come close to each other or are short, edges must be short too, or angles collapse: the local feature
//! size of J. Ruppert, *A Delaunay refinement algorithm for quality 2-dimensional mesh generation* (1995), as sources
//! of the sizing field.

use crate::size::{Source, source};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};
use softfold_geometry::polygon;

/// A piece of a curve between two points that the mesh must have.
pub(crate) struct Piece {
    /// Points along it; a closed one repeats its first.
    pub(crate) points: Vec<DVec2>,
    /// Pieces of one group keep their distance by other means.
    pub(crate) group: usize,
    /// Edges that it needs at least.
    pub(crate) least_edges: f64,
}

/// Longest edge over the gap beside it: with points of both sides set off against each other, angles of 55°.
const MOST_ASPECT: f64 = 1.4;
/// Shortest edges asked for here, share of the target: pieces of lines that all but touch would ask for millions.
const SHORTEST: f64 = 1.0 / 64.0;
/// The same where two lines leave one point: the angle between them is the pattern's, not ours to mend.
const SHORTEST_IN_CORNER: f64 = 0.125;
/// Edges next to a short piece are longer by no more than this factor.
const BESIDE_SHORT: f64 = 1.5;
/// Lines that part from one point more steeply than this (distance over way from that point; 30°) need no care.
const PARTING: f64 = 0.5;
/// Ends of pieces nearer than this share of the target are one point.
const TOUCHING: f64 = 2e-3;

type Side = GeomWithData<Line<[f64; 2]>, (usize, f64)>;

struct Gaps<'a> {
    pieces: &'a [Piece],
    lengths: Vec<f64>,
    sides: RTree<Side>,
    target_mm: f64,
}

/// A place on a piece.
#[derive(Clone, Copy)]
struct Place {
    piece: usize,
    along_mm: f64,
    at: DVec2,
}

/// Edge lengths that short pieces and close pieces ask for.
pub(crate) fn sources(pieces: &[Piece], target_mm: f64) -> Vec<Source> {
    let lengths = pieces.iter().map(|p| polygon::length_mm(&p.points)).collect();
    let sides = RTree::bulk_load(sides(pieces));
    let gaps = Gaps { pieces, lengths, sides, target_mm };
    let mut sources = Vec::new();
    for piece in 0..pieces.len() {
        gaps.short(piece, &mut sources);
        gaps.close(piece, &mut sources);
    }
    sources
}

fn sides(pieces: &[Piece]) -> Vec<Side> {
    let mut sides = Vec::new();
    for (piece, p) in pieces.iter().enumerate() {
        let mut along_mm = 0.0;
        for w in p.points.windows(2) {
            sides.push(GeomWithData::new(Line::new(w[0].to_array(), w[1].to_array()), (piece, along_mm)));
            along_mm += w[0].distance(w[1]);
        }
    }
    sides
}

impl Gaps<'_> {
    /// A short piece gets neighbours that are not much longer.
    fn short(&self, piece: usize, sources: &mut Vec<Source>) {
        let Piece { points, least_edges, .. } = &self.pieces[piece];
        let factor = if *least_edges > 1.0 { 1.0 } else { BESIDE_SHORT };
        let size = factor * self.lengths[piece] / least_edges;
        if size < self.target_mm {
            let size = size.max(SHORTEST * self.target_mm);
            sources.extend(points.iter().map(|&p| source(p, size)));
        }
    }

    /// Where another piece is near.
    fn close(&self, piece: usize, sources: &mut Vec<Source>) {
        let mut along_mm = 0.0;
        for w in self.pieces[piece].points.windows(2) {
            self.side(piece, along_mm, [w[0], w[1]], sources);
            along_mm += w[0].distance(w[1]);
        }
    }

    /// Halves a side until its gap is known well enough, or is known to be wide all along.
    fn side(&self, piece: usize, along_mm: f64, side: [DVec2; 2], sources: &mut Vec<Source>) {
        let mut open = vec![(along_mm, side)];
        while let Some((along_mm, [a, b])) = open.pop() {
            let half_mm = 0.5 * a.distance(b);
            let place = Place { piece, along_mm: along_mm + half_mm, at: 0.5 * (a + b) };
            let wide_mm = self.target_mm / MOST_ASPECT + half_mm;
            let Some((gap_mm, floor)) = self.gap(place, wide_mm) else { continue };
            let floor_mm = floor * self.target_mm;
            let size_mm = (MOST_ASPECT * gap_mm).max(floor_mm);
            if half_mm <= 0.5 * size_mm.min(self.target_mm) {
                sources.push(source(place.at, size_mm));
            } else {
                open.push((place.along_mm, [place.at, b]));
                open.push((along_mm, [a, place.at]));
            }
        }
    }

    /// Distance to the nearest piece that does not merely part from this one, up to `wide_mm`, and the shortest edges
    /// to ask for, share of the target.
    fn gap(&self, from: Place, wide_mm: f64) -> Option<(f64, f64)> {
        let near = self.sides.nearest_neighbor_iter_with_distance_2([from.at.x, from.at.y]);
        for (side, d2) in near.take_while(|(_, d2)| *d2 < wide_mm * wide_mm) {
            let (gap_mm, (other, _)) = (d2.sqrt(), side.data);
            if other != from.piece && self.pieces[other].group == self.pieces[from.piece].group {
                continue;
            }
            match self.parting_mm(from, side) {
                None => return Some((gap_mm, SHORTEST)),
                Some(way) if way > self.touching_mm() && gap_mm < PARTING * way => {
                    return Some((gap_mm, SHORTEST_IN_CORNER));
                }
                Some(_) => {}
            }
        }
        None
    }

    /// Way back to the point that two pieces have in common, or along the piece if they are the same.
    fn parting_mm(&self, from: Place, side: &Side) -> Option<f64> {
        let (other, along_mm) = side.data;
        let mine = &self.pieces[from.piece].points;
        if other == from.piece {
            let Line { from: a, to: b } = side.geom();
            let (a, b) = (DVec2::from(*a), DVec2::from(*b));
            let t = ((from.at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let way = (along_mm + t * a.distance(b) - from.along_mm).abs();
            let closed = mine.first() == mine.last();
            return Some(if closed { way.min(self.lengths[other] - way) } else { way });
        }
        let touching = self.touching_mm();
        let ends = |points: &[DVec2]| [points[0], points[points.len() - 1]];
        let others = ends(&self.pieces[other].points);
        let shared = |p: &DVec2| others.iter().any(|o| o.distance(*p) <= touching);
        ends(mine).iter().filter(|p| shared(p)).map(|p| p.distance(from.at)).reduce(f64::min)
    }

    fn touching_mm(&self) -> f64 {
        TOUCHING * self.target_mm
    }
}
