//! What is triangulated and meshed.

use crate::common::{pattern, rectangle, star, straight_band};
use glam::DVec2;
use softfold_geometry::{CreaseId, LoopId, SoftPattern, VertexId};
use softfold_mesh::{Constraint, MeshOptions, PlanarGraph};

const SIDE_MM: f64 = 1000.0;
/// Constrained polylines across the square.
const LINES: usize = 10;

/// A square of random points, in random order, with an outline and polylines that are constraints.
pub(crate) fn graph(size: usize) -> PlanarGraph {
    let mut random = SplitMix64(1);
    let pieces = (size as f64).sqrt() as usize;
    let at = |k: usize| SIDE_MM * k as f64 / pieces as f64;
    let mut graph = PlanarGraph { points: vec![], constraints: vec![] };
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|c| SIDE_MM * DVec2::from(c));
    let outline = Constraint::Boundary { loop_id: LoopId(0) };
    for (i, a) in corners.into_iter().enumerate() {
        let along = (corners[(i + 1) % 4] - a) / SIDE_MM;
        graph.points.extend((0..pieces).map(|k| a + at(k) * along));
    }
    let around = 4 * pieces;
    let next = |k: usize| [k, (k + 1) % around].map(VertexId::new);
    graph.constraints.extend((0..around).map(|k| (next(k), outline)));
    for line in 0..LINES {
        let x = SIDE_MM * (line as f64 + 0.5) / LINES as f64;
        let first = graph.points.len();
        let fold = Constraint::Fold { crease: CreaseId::new(line), line: 0, turn_rad: 0.1 };
        graph.points.extend((0..pieces).map(|k| DVec2::new(x, at(k) + 0.5 * at(1))));
        graph.constraints.extend((first + 1..first + pieces).map(|k| ([k - 1, k].map(VertexId::new), fold)));
    }
    while graph.points.len() < size {
        graph.points.push(SIDE_MM * DVec2::new(random.unit(), random.unit()));
    }
    shuffle(&mut graph, &mut random);
    graph
}

fn shuffle(graph: &mut PlanarGraph, random: &mut SplitMix64) {
    let mut order: Vec<usize> = (0..graph.points.len()).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, (random.unit() * (i + 1) as f64) as usize);
    }
    let points = graph.points.clone();
    let mut numbers = vec![VertexId(0); points.len()];
    for (new, &old) in order.iter().enumerate() {
        graph.points[new] = points[old];
        numbers[old] = VertexId::new(new);
    }
    graph.constraints.iter_mut().for_each(|(edge, _)| *edge = edge.map(|v| numbers[v.index()]));
}

/// What kind of sheet is meshed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// Edges of one length.
    Even,
    /// Bands much narrower than the target: short edges that grow away from them.
    Graded,
    /// Soft and sharp creases that meet in one point.
    Star,
}

impl Kind {
    pub(crate) const ALL: [Self; 3] = [Self::Even, Self::Graded, Self::Star];
}

/// A sheet that is meshed with about so many vertices.
pub(crate) fn sheet(size: usize, kind: Kind) -> (SoftPattern, MeshOptions) {
    let [width, height] = [300.0, 200.0];
    // Found by trying; vertices are as many as the inverse square of the edge length.
    let (at_100k, strip) = match kind {
        Kind::Even => (0.85, 1.0),
        Kind::Graded => (1.3, 0.15),
        Kind::Star => (1.0, 0.0),
    };
    let target = at_100k * (100_000.0 / size as f64).sqrt();
    let options = MeshOptions { target_edge_mm: target, ..MeshOptions::default() };
    if let Kind::Star = kind {
        return (star(width, &[(15.0, 0.0), (100.0, 20.0), (190.0, 0.0), (280.0, 20.0)]), options);
    }
    let radius = 0.5 * strip * target / 0.1_f64.sin();
    let bands = [100.0, 200.0].iter().zip(0..).map(|(&u, id)| straight_band(id, u, width, height, radius));
    let soft = pattern(vec![rectangle(width, height)], bands.collect());
    (soft, options)
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct SplitMix64(u64);

impl SplitMix64 {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
