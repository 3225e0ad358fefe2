//! Where points of the flat sheet are on the limit surface of the flat cage.

use super::quads::{Quads, Sides};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use softfold_kernel::KernelError;
use softfold_kernel::opensubdiv::{self, Sample, Stencils};

/// Newton steps: few are needed where the limit differs from the straight quads by little; thin cells are crossed one by one.
const STEPS: usize = 30;
/// Steps in a straight quad.
const FLAT_STEPS: usize = 12;
/// A point that is nearer than this has been found, share of the cage's size: rounding.
const FOUND: f64 = 1e-13;
/// Border cells may miss a point by this share of the mean edge.
const OUTSIDE: f64 = 0.75;

/// Places on the limit with its stencils there.
pub(crate) struct Places {
    pub(crate) stencils: Stencils,
    /// How far the limit's point is from the wanted one, mm: 0 but for points that the limit's border leaves out.
    pub(crate) missed_mm: Vec<f64>,
}

/// One row of stencils.
pub(crate) fn row(stencils: &Stencils, i: usize, weights: &[f64]) -> Vec<(usize, f64)> {
    let range = stencils.offsets[i] as usize..stencils.offsets[i + 1] as usize;
    range.map(|k| (stencils.indices[k] as usize, weights[k])).collect()
}

/// Finds the points on the limit of the cage with the control points `flat`; `quads` are straight quads near the limit.
///
/// # Errors
/// OpenSubdiv's refusal.
pub(crate) fn places(
    quads: &Quads,
    sides: &Sides,
    flat: &[DVec2],
    points: &[DVec2],
) -> Result<Places, KernelError> {
    let cage = opensubdiv::Cage { vertex_count: flat.len(), quads: quads.quads.clone() };
    let mut samples = first_guesses(quads, points);
    let size = points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let (mut best, mut missed) = (samples.clone(), vec![f64::INFINITY; points.len()]);
    let mut open: Vec<usize> = (0..points.len()).collect();
    for _ in 0..STEPS {
        let now: Vec<Sample> = open.iter().map(|&i| samples[i]).collect();
        let stencils = opensubdiv::limit_stencils(&cage, &now)?;
        let mut still = Vec::new();
        for (k, &i) in open.iter().enumerate() {
            let sum = |weights: &[f64]| -> DVec2 {
                row(&stencils, k, weights).into_iter().map(|(v, w)| w * flat[v]).sum()
            };
            let off = points[i] - sum(&stencils.weights);
            if off.length() < missed[i] {
                (missed[i], best[i]) = (off.length(), samples[i]);
            }
            let next =
                stepped(quads, sides, samples[i], off, [sum(&stencils.weights_s), sum(&stencils.weights_t)]);
            // Found, or held fast at the border.
            if off.length() > FOUND * size && next != samples[i] {
                samples[i] = next;
                still.push(i);
            }
        }
        open = still;
        if open.is_empty() {
            break;
        }
    }
    Ok(Places { stencils: opensubdiv::limit_stencils(&cage, &best)?, missed_mm: missed })
}

/// A Newton step, into the neighbouring quad if it leads there.
fn stepped(quads: &Quads, sides: &Sides, from: Sample, off: DVec2, [ds, dt]: [DVec2; 2]) -> Sample {
    let det = ds.perp_dot(dt);
    if det.abs() <= f64::MIN_POSITIVE {
        return from;
    }
    let by = DVec2::new(off.perp_dot(dt), ds.perp_dot(off)) / det;
    let st = DVec2::new(from.s, from.t) + by.clamp(DVec2::splat(-1.0), DVec2::ONE);
    let beyond = [-st.y, st.x - 1.0, st.y - 1.0, -st.x];
    let side = (0..4).max_by(|&a, &b| beyond[a].total_cmp(&beyond[b])).unwrap_or(0);
    let inside = st.clamp(DVec2::ZERO, DVec2::ONE);
    let here = Sample { quad: from.quad, s: inside.x, t: inside.y };
    if beyond[side] <= 0.0 {
        return here;
    }
    let quad = quads.quads[from.quad as usize];
    let (a, b) = (quad[side], quad[(side + 1) % 4]);
    let Some(&next) = sides.get(&[b, a]) else { return here };
    let entry = quads.quads[next].iter().position(|v| *v == b).unwrap_or(0);
    let along = [inside.x, inside.y, 1.0 - inside.x, 1.0 - inside.y][side];
    let (along, depth) = (1.0 - along, beyond[side].min(1.0));
    let [s, t] =
        [[along, depth], [1.0 - depth, along], [1.0 - along, 1.0 - depth], [depth, 1.0 - along]][entry];
    Sample { quad: next as u32, s, t }
}

/// The straight quad of each point, and the place in it.
fn first_guesses(quads: &Quads, points: &[DVec2]) -> Vec<Sample> {
    let corners = |q: usize| quads.quads[q].map(|v| quads.points[v as usize]);
    let to_box = |q: usize| {
        let c = corners(q);
        let (lo, hi) = (c.iter().fold(c[0], |l, p| l.min(*p)), c.iter().fold(c[0], |h, p| h.max(*p)));
        GeomWithData::new(Rectangle::from_corners(lo.to_array(), hi.to_array()), q)
    };
    let tree = RTree::bulk_load((0..quads.quads.len()).map(to_box).collect());
    let edges = quads.edges();
    let length: f64 =
        edges.iter().map(|[a, b]| quads.points[*a as usize].distance(quads.points[*b as usize])).sum();
    let reach = OUTSIDE * length / edges.len().max(1) as f64;
    let guess = |p: &DVec2| {
        let around = |by: f64| {
            let envelope = AABB::from_corners((*p - by).to_array(), (*p + by).to_array());
            let near = tree.locate_in_envelope_intersecting(envelope).map(|b| b.data);
            let placed = near.map(|q| (q, in_quad(corners(q), *p)));
            placed.min_by(|a, b| a.1.1.total_cmp(&b.1.1).then(a.0.cmp(&b.0)))
        };
        let found = around(0.0).filter(|f| f.1.1 < 1e-6 * reach).or_else(|| around(reach));
        let (q, (st, _)) = found.unwrap_or_else(|| nearest(quads, *p));
        Sample { quad: q as u32, s: st.x, t: st.y }
    };
    points.iter().map(guess).collect()
}

fn nearest(quads: &Quads, p: DVec2) -> (usize, (DVec2, f64)) {
    let placed = |q: usize| (q, in_quad(quads.quads[q].map(|v| quads.points[v as usize]), p));
    let all = (0..quads.quads.len()).map(placed);
    all.min_by(|a, b| a.1.1.total_cmp(&b.1.1)).unwrap_or((0, (DVec2::splat(0.5), f64::INFINITY)))
}

/// The place in a straight quad that is nearest to a point, nearly, and its distance.
fn in_quad([a, b, c, d]: [DVec2; 4], p: DVec2) -> (DVec2, f64) {
    let mut st = DVec2::splat(0.5);
    let at = |st: DVec2| a.lerp(b, st.x).lerp(d.lerp(c, st.x), st.y);
    for _ in 0..FLAT_STEPS {
        let off = p - at(st);
        let (ds, dt) = ((b - a).lerp(c - d, st.y), (d - a).lerp(c - b, st.x));
        let det = ds.perp_dot(dt);
        if det.abs() <= f64::MIN_POSITIVE {
            break;
        }
        st = (st + DVec2::new(off.perp_dot(dt), ds.perp_dot(off)) / det).clamp(DVec2::ZERO, DVec2::ONE);
    }
    (st, at(st).distance(p))
}
