//! The paper's own six steps, for comparison: random points; those near creases and outline removed; points along
//! creases and outline at the mean distance of neighbours; constrained Delaunay triangulation; relaxation; edges by what they lie on.
//!
//! Source: Koschitz, Foschi, Maleczek, *Algorithmic Design and Fabrication of Soft Curved-Folding*. It gives no threshold and no count:
//! the count here is that of equilateral triangles of the target's edge length, the threshold half the target. Where it
//! classifies edges by what lies near, ours come from their constraints. Nothing bounds the angles.

use crate::boundary::Boundaries;
use crate::draft::Draft;
use crate::graph::{GraphBuilder, boundary_polygons};
use crate::inside::Inside;
use crate::rng::SplitMix64;
use crate::size::SizeField;
use crate::{MeshError, MeshOptions, Meshed, VERTEX_DENSITY, check_vertices, finished, relax};
use glam::DVec2;
use rstar::primitives::Line;
use rstar::{PointDistance, RTree};
use softfold_geometry::{Site, SoftPattern, polygon};

/// Random points nearer to a curve are removed, share of the target.
const NEAR: f64 = 0.5;
/// How many nearest points count as neighbours: as many as a vertex of a triangulation has on average.
const NEIGHBOURS: usize = 6;

/// Meshes a soft pattern by the paper's steps.
pub(crate) fn mesh(soft: &SoftPattern, options: &MeshOptions) -> Result<Meshed, MeshError> {
    let mut free = random_points(soft, options);
    let curves = curves(soft);
    let near_mm = NEAR * options.target_edge_mm;
    free.retain(|p| is_clear(&curves, *p, near_mm));
    let spacing_mm = mean_neighbour_mm(&free).unwrap_or(options.target_edge_mm);
    let on_curves = MeshOptions { target_edge_mm: spacing_mm, band_aspect: f64::MAX, ..options.clone() };
    let boundaries = Boundaries::new(soft, &on_curves, spacing_mm);
    let sizes = SizeField::uniform(&on_curves);
    let mut planar = GraphBuilder::new(soft, &on_curves, &boundaries, &sizes).build();
    let graph = &mut planar.graph;
    let held = graph.points.len();
    // Random points were thrown at the curves; chords may leave some outside.
    let inside = Inside::new(&boundary_polygons(&graph.points, &graph.constraints, soft.loops.len()));
    graph.points.extend(free.into_iter().filter(|p| inside.contains(*p)));
    check_vertices(graph.points.len() as f64, options)?;
    planar.sites.resize(graph.points.len(), Site::Interior);
    let restless = vec![true; graph.points.len()];
    let mut draft = Draft::new(planar, options)?;
    relax::relax(&mut draft, held, options.relaxation_rounds, relax::Weight::Area, restless);
    finished(soft, draft)
}

/// Points spread evenly over the sheet, as many as equilateral triangles of the target's edge length would have.
fn random_points(soft: &SoftPattern, options: &MeshOptions) -> Vec<DVec2> {
    let loops: Vec<Vec<DVec2>> = soft.loops.iter().map(|l| l.flatten(soft.tolerance.join_mm)).collect();
    let inside = Inside::new(&loops);
    let all: Vec<DVec2> = loops.into_iter().flatten().collect();
    let (lo, hi) = polygon::bounds(&all);
    let size = hi - lo;
    // Over the box, so that the points of a sheet do not depend on where its holes are.
    let count = (VERTEX_DENSITY * size.x * size.y / options.target_edge_mm.powi(2)).ceil() as usize;
    let mut rng = SplitMix64(options.seed);
    let point = |_| lo + size * DVec2::new(rng.unit(), rng.unit());
    (0..count).map(point).filter(|p| inside.contains(*p)).collect()
}

/// The sides of all curves that the mesh holds.
fn curves(soft: &SoftPattern) -> RTree<Line<[f64; 2]>> {
    let chord_mm = soft.tolerance.join_mm;
    let loops = soft.loops.iter().map(|c| c.flatten(chord_mm));
    let rings = loops.chain(soft.junctions.iter().map(|j| j.polygon.clone()));
    let slits = soft.slits.iter().map(|c| c.flatten(chord_mm));
    let open = slits.chain(soft.bands.iter().flat_map(|b| &b.fold_lines).map(|l| l.points.clone()));
    let side = |a: DVec2, b: DVec2| Line::new(a.to_array(), b.to_array());
    let mut sides: Vec<_> =
        rings.flat_map(|r| polygon::edges(&r).map(|(a, b)| side(a, b)).collect::<Vec<_>>()).collect();
    sides.extend(open.flat_map(|l| l.windows(2).map(|w| side(w[0], w[1])).collect::<Vec<_>>()));
    RTree::bulk_load(sides)
}

fn is_clear(curves: &RTree<Line<[f64; 2]>>, p: DVec2, near_mm: f64) -> bool {
    let nearest = curves.nearest_neighbor(p.to_array());
    nearest.is_none_or(|line| line.distance_2(&p.to_array()) >= near_mm * near_mm)
}

/// Mean distance of points to their nearest neighbours, mm; none of too few points.
fn mean_neighbour_mm(points: &[DVec2]) -> Option<f64> {
    let tree = RTree::bulk_load(points.iter().map(|p| p.to_array()).collect::<Vec<_>>());
    let around = |p: &DVec2| {
        let nearest = tree.nearest_neighbor_iter(p.to_array()).skip(1).take(NEIGHBOURS);
        nearest.map(|q| p.distance(DVec2::from(*q))).sum::<f64>()
    };
    let all = points.len() * NEIGHBOURS;
    (points.len() > NEIGHBOURS).then(|| points.iter().map(around).sum::<f64>() / all as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The k-th nearest of points of density ρ is Γ(k + ½)/(Γ(k) √(π ρ)) away on average.
    #[test]
    fn the_mean_distance_of_random_points_is_the_known_one() {
        let mut rng = SplitMix64(7);
        let points: Vec<DVec2> = (0..40_000).map(|_| 200.0 * DVec2::new(rng.unit(), rng.unit())).collect();
        // Γ(k + ½)/Γ(k)/√π, k = 1..6.
        let shares = [0.5, 0.75, 0.9375, 1.093_75, 1.230_468_75, 1.353_515_625];
        let wanted: f64 = shares.iter().sum::<f64>() / 6.0;
        let found = mean_neighbour_mm(&points).unwrap();
        // Points at the border have farther neighbours: about one in a hundred, by a fifth.
        assert!((found / wanted - 1.0).abs() < 0.01, "{found} {wanted}");
        assert_eq!(mean_neighbour_mm(&points[..6]), None);
    }
}
