//! Fits the control points of a cage: in the flat sheet so that the limit's border is the outline, in space so that the
//! limit passes the folded vertices.

use super::flat::FlatCage;
use super::places::{Places, places, row};
use super::quads::Sides;
use super::sparse::Normal;
use crate::SurfaceError;
use crate::samples::{Target, targets};
use glam::{DVec2, DVec3};
use softfold_geometry::{Deviation, FoldedSheet, PlanarCurve};
use softfold_kernel::opensubdiv::{self, Sample, Stencils};
use std::collections::BTreeMap;

/// Weight by which border control points stay where they are along the outline.
const STAY: f64 = 1e-3;
/// Steps that bring the limit's border onto the outline: the outline is nearly straight over a cell.
const BORDER_ROUNDS: usize = 4;

/// The least-squares problem of one cage.
pub(crate) struct Lifting<'a> {
    sheet: &'a FoldedSheet,
    cage: &'a FlatCage,
    /// Control points of the flat limit, (u, v) in mm.
    pub(crate) flat: Vec<DVec2>,
    targets: Vec<Target>,
    places: Places,
    bends: Vec<Bend>,
}

/// A second difference of control points that should be what the local affine map makes of the flat one.
struct Bend {
    row: Vec<(usize, f64)>,
    value: DVec3,
    weight: f64,
}

/// Control points in space and how far their limit is from the folded vertices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lifted {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) deviation: Deviation,
}

impl<'a> Lifting<'a> {
    /// # Errors
    /// OpenSubdiv's or the solver's refusal.
    pub(crate) fn new(
        sheet: &'a FoldedSheet,
        cage: &'a FlatCage,
        sides: &Sides,
        loops: &[PlanarCurve],
    ) -> Result<Self, SurfaceError> {
        let flat = flat_controls(cage, loops)?;
        let targets = targets(sheet);
        let points: Vec<DVec2> = targets.iter().map(|t| t.uv).collect();
        let places = places(&cage.quads, sides, &flat, &points)?;
        let mut made = Self { sheet, cage, flat, targets, places, bends: Vec::new() };
        made.bends = made.bends_of(&made.maps());
        Ok(made)
    }

    /// The control points that minimise data term plus `bending_weight_mm4` times the bending term.
    ///
    /// # Errors
    /// The equations cannot be solved.
    pub(crate) fn solve(&self, bending_weight_mm4: f64) -> Result<Lifted, SurfaceError> {
        let mut normal = Normal::new(self.flat.len());
        let stencils = &self.places.stencils;
        for (i, target) in self.targets.iter().enumerate() {
            normal.add(&row(stencils, i, &stencils.weights), target.position, target.weight_mm2);
        }
        for bend in &self.bends {
            normal.add(&bend.row, bend.value, bending_weight_mm4 * bend.weight);
        }
        let positions = normal.solve().map_err(|cause| self.unsolved(cause))?;
        let deviation = self.deviation(&positions);
        Ok(Lifted { positions, deviation })
    }

    /// Largest distance by which the limit of the flat cage misses a point of the sheet, mm.
    pub(crate) fn missed_mm(&self) -> f64 {
        self.places.missed_mm.iter().copied().fold(0.0, f64::max)
    }

    fn unsolved(&self, cause: String) -> SurfaceError {
        let spacing_mm = (self.sheet.mesh.area_mm2() / self.cage.quads.quads.len().max(1) as f64).sqrt();
        SurfaceError::Factorisation { spacing_mm, cause }
    }

    /// Distance of each folded vertex to the surface's point of the same (u, v).
    fn deviation(&self, positions: &[DVec3]) -> Deviation {
        let (mut worst, mut squares) = (Deviation::default(), 0.0);
        let stencils = &self.places.stencils;
        for (i, target) in self.targets[..self.sheet.positions.len()].iter().enumerate() {
            let at: DVec3 =
                row(stencils, i, &stencils.weights).into_iter().map(|(v, w)| w * positions[v]).sum();
            let distance = at.distance(target.position);
            squares += distance * distance;
            if distance > worst.max_mm {
                worst = Deviation { max_mm: distance, at: target.uv, ..worst };
            }
        }
        Deviation { rms_mm: (squares / self.sheet.positions.len().max(1) as f64).sqrt(), ..worst }
    }

    /// For each vertex of the cage the affine map from the flat sheet to space that fits the folded vertices around best:
    /// weighted by their share in the limit near it.
    fn maps(&self) -> Vec<[DVec3; 2]> {
        // Sums of dx dxᵀ and of dp dxᵀ over targets, by the first moments of each vertex.
        let n = self.flat.len();
        let (mut mass, mut x, mut p) = (vec![0.0; n], vec![DVec2::ZERO; n], vec![DVec3::ZERO; n]);
        let stencils = &self.places.stencils;
        let each = |f: &mut dyn FnMut(usize, f64, &Target)| {
            for (i, t) in self.targets.iter().enumerate() {
                for (v, w) in row(stencils, i, &stencils.weights).into_iter().filter(|e| e.1 > 0.0) {
                    f(v, w * t.weight_mm2, t);
                }
            }
        };
        each(&mut |v, w, t| {
            mass[v] += w;
            x[v] += w * t.uv;
            p[v] += w * t.position;
        });
        let mut moments = vec![([0.0; 3], [DVec3::ZERO; 2]); n];
        each(&mut |v, w, t| {
            let (dx, dp) = (t.uv - x[v] / mass[v], t.position - p[v] / mass[v]);
            let (xx, px) = &mut moments[v];
            *xx = [xx[0] + w * dx.x * dx.x, xx[1] + w * dx.x * dx.y, xx[2] + w * dx.y * dx.y];
            *px = [px[0] + w * dx.x * dp, px[1] + w * dx.y * dp];
        });
        let map = |([a, b, c], [pu, pv]): ([f64; 3], [DVec3; 2])| {
            let det = a * c - b * b;
            // Too few points around: no bend is known there.
            let none = [DVec3::ZERO; 2];
            if det > 1e-9 * (a + c).powi(2) {
                [(c * pu - b * pv) / det, (a * pv - b * pu) / det]
            } else {
                none
            }
        };
        moments.into_iter().map(map).collect()
    }

    fn bends_of(&self, maps: &[[DVec3; 2]]) -> Vec<Bend> {
        let rows = second_differences(self.cage, &self.flat);
        let bend = |(middle, row, weight): (usize, Vec<(usize, f64)>, f64)| {
            let flat: DVec2 = row.iter().map(|&(v, w)| w * self.flat[v]).sum();
            let value = flat.x * maps[middle][0] + flat.y * maps[middle][1];
            Bend { row, value, weight }
        };
        rows.into_iter().map(bend).collect()
    }
}

/// Flat control points: inside the cage's own vertices, so that thin cells beside wide ones never fold over; on the border
/// shifted across the outline until the limit's border is on it at its vertices.
fn flat_controls(cage: &FlatCage, loops: &[PlanarCurve]) -> Result<Vec<DVec2>, SurfaceError> {
    let mut flat = cage.quads.points.clone();
    let border: Vec<u32> = cage.borders.concat();
    let number: BTreeMap<u32, usize> = border.iter().enumerate().map(|(k, v)| (*v, k)).collect();
    let stencils = border_stencils(cage, &border)?;
    for _ in 0..BORDER_ROUNDS {
        let mut normal = Normal::new(2 * border.len());
        for (k, &v) in border.iter().enumerate() {
            let limit = row(&stencils, k, &stencils.weights);
            let at: DVec2 = limit.iter().map(|&(w, a)| a * flat[w]).sum();
            let (foot, across) = foot(loops, at);
            // Only vertices of the border have a share in its limit.
            let shares = limit.iter().filter_map(|(w, a)| Some((*number.get(&(*w as u32))?, *a)));
            let shift: Vec<(usize, f64)> =
                shares.flat_map(|(j, a)| [(2 * j, a * across.x), (2 * j + 1, a * across.y)]).collect();
            normal.add_scalar(&shift, across.dot(foot - at), 1.0);
            let stay = cage.quads.points[v as usize] - flat[v as usize];
            normal.add_scalar(&[(2 * k, 1.0)], stay.x, STAY);
            normal.add_scalar(&[(2 * k + 1, 1.0)], stay.y, STAY);
        }
        let by =
            normal.solve_scalar().map_err(|cause| SurfaceError::Factorisation { spacing_mm: 0.0, cause })?;
        border
            .iter()
            .enumerate()
            .for_each(|(k, &v)| flat[v as usize] += DVec2::new(by[2 * k], by[2 * k + 1]));
    }
    Ok(flat)
}

/// The nearest point of the border's curves, and the unit vector across them there.
fn foot(loops: &[PlanarCurve], p: DVec2) -> (DVec2, DVec2) {
    let near = loops.iter().map(|c| (c, c.nearest(p)));
    match near.min_by(|a, b| a.1.1.total_cmp(&b.1.1)) {
        Some((curve, (s_mm, _))) => (curve.point(s_mm), curve.tangent(s_mm).perp()),
        None => (p, DVec2::ZERO),
    }
}

/// Limits of border vertices.
fn border_stencils(cage: &FlatCage, border: &[u32]) -> Result<Stencils, SurfaceError> {
    let quads = &cage.quads;
    let mut samples = BTreeMap::new();
    for (q, quad) in quads.quads.iter().enumerate() {
        for (k, &v) in quad.iter().enumerate() {
            let (s, t) = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)][k];
            samples.entry(v).or_insert(Sample { quad: q as u32, s, t });
        }
    }
    let samples: Vec<Sample> = border.iter().filter_map(|v| samples.get(v).copied()).collect();
    let connections = opensubdiv::Cage { vertex_count: quads.points.len(), quads: quads.quads.clone() };
    Ok(opensubdiv::limit_stencils(&connections, &samples)?)
}

/// Middle vertex, row over the vertices, weight in 1/mm².
type PlateRow = (usize, Vec<(usize, f64)>, f64);

/// Rows of the thin plate's energy over the cage.
///
/// Along edges that go straight on: `|p₋ − 2p + p₊|²/h⁴` times the area of a cell; twice the twist of each quad. Around an
/// irregular vertex the sum over its neighbours.
fn second_differences(cage: &FlatCage, flat: &[DVec2]) -> Vec<PlateRow> {
    let quads = &cage.quads;
    let mut rows = Vec::new();
    let mut areas = vec![0.0; flat.len()];
    let mut next: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); flat.len()];
    for quad in &quads.quads {
        let [a, b, c, d] = quad.map(|v| flat[v as usize]);
        let area = (0.5 * (c - a).perp_dot(d - b)).abs().max(f64::MIN_POSITIVE);
        quad.iter().for_each(|&v| areas[v as usize] += 0.25 * area);
        let twist = quad.iter().zip([1.0, -1.0, 1.0, -1.0]).map(|(&v, w)| (v as usize, w)).collect();
        rows.push((quad[0] as usize, twist, 2.0 / area));
        for k in 0..4 {
            next[quad[k] as usize].insert(quad[(k + 1) % 4], quad[(k + 3) % 4]);
        }
    }
    for (v, next) in next.iter().enumerate() {
        for [a, b] in straight_pairs(next) {
            let h2 = flat[a as usize].distance(flat[v]) * flat[b as usize].distance(flat[v]);
            rows.push((v, vec![(a as usize, 1.0), (v, -2.0), (b as usize, 1.0)], areas[v] / (h2 * h2)));
        }
    }
    rows
}

/// Neighbours of a vertex that lie opposite to each other; `next` leads around counter-clockwise. At a border vertex of
/// two quads the two along the border; at an irregular vertex all that are half way around.
fn straight_pairs(next: &BTreeMap<u32, u32>) -> Vec<[u32; 2]> {
    let closed = next.values().all(|n| next.contains_key(n));
    match (closed, next.len()) {
        (true, n) => {
            let opposite = |a: u32| (0..n / 2).try_fold(a, |at, _| next.get(&at).copied());
            next.keys()
                .filter_map(|&a| Some([a, opposite(a)?]))
                .filter(|[a, b]| a < b || n % 2 == 1)
                .collect()
        }
        (false, 2) => {
            let ends = next.iter().map(|(a, b)| [*a, *b]).collect::<Vec<_>>();
            let first = ends.iter().find(|e| !next.values().any(|v| *v == e[0])).map(|e| e[0]);
            let last = ends.iter().find(|e| !next.contains_key(&e[1])).map(|e| e[1]);
            first.zip(last).map(|(a, b)| vec![[a, b]]).unwrap_or_default()
        }
        _ => Vec::new(),
    }
}
