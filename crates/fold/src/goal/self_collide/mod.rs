//! The sheet does not pass through itself and keeps its thickness.
//!
//! A barrier on the distance of every point from every triangle and of every edge from every other (Li et al.,
//! *Incremental Potential Contact*, ACM TOG 39(4), 2020), shifted by the thickness (Li, Kaufman & Jiang, *Codimensional
//! Incremental Potential Contact*, ACM TOG 40(4), 2021). It begins to push at the contact distance `D = thickness +
//! reach`, is infinite at the thickness, and [`Goal::largest_step`] keeps steps from leaping over it.
//!
//! Neighbours. The sheet is near itself wherever it is one piece. A sheet that bends evenly by half a turn over the
//! length f along it has its ends `2f/π` apart, and bending by less leaves them further apart. So of two places that are
//! f apart on the flat sheet the contact distance is `min(D, 2f/π)`, and the least distance is less by the same factor.
//! Bending up to half a turn thus meets no barrier at any radius, the flat sheet least of all, and yet nothing but
//! elements that share a vertex is left out. Distances on the flat sheet are straight: places on both sides of a notch
//! count as nearer than the way around it, lips of a slit as one.
//!
//! Where this leaves the sources: the barrier's stiffness is given and constant, `Curvature::Convex` is Gauss-Newton's
//! form, and there is no friction.

mod accd;
mod broad;
mod closest;
mod pair;
#[cfg(test)]
mod tests;
mod tree;
mod way;
mod window;

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part};
use broad::{Candidates, Sheet};
use glam::{DVec2, DVec3};
use pair::{Gap, Pair};
use softfold_geometry::{FlatMesh, FoldedSheet};
use std::sync::{Arc, Mutex, PoisonError};

/// `E = κ Σ b(y)`, N·mm, with `b = −(y − 1)² ln y` and y the share of the way between thickness and contact, in squared
/// distances; nothing from the contact distance on.
pub struct SelfCollide {
    options: SelfCollideOptions,
    sheet: Sheet,
    /// What was found last: it only saves time.
    found: Mutex<Option<Arc<Candidates>>>,
}

/// How the sheet keeps off itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfCollideOptions {
    /// Distance that is never reached: the sheet's thickness, mm, above 0.
    pub thickness_mm: f64,
    /// How far beyond the thickness the push begins, mm, above 0.
    pub reach_mm: f64,
    /// κ, N·mm.
    pub stiffness: f64,
}

impl SelfCollideOptions {
    /// Reach as share of the thickness where nothing is said: layers rest between one and one and a quarter thicknesses
    /// apart.
    pub const REACH_SHARE: f64 = 0.25;

    /// For a thickness, mm, with the usual reach.
    pub fn of_thickness(thickness_mm: f64, stiffness: f64) -> Self {
        Self { thickness_mm, reach_mm: Self::REACH_SHARE * thickness_mm, stiffness }
    }

    fn gap(&self) -> Gap {
        Gap::new(self.thickness_mm, self.thickness_mm + self.reach_mm)
    }
}

/// Most margin of [`Goal::contacts`] that is heeded, as share of the contact distance; of neighbours less: [`Gap::within_mm`].
const SPARE: f64 = 0.25;
/// Share of a step that is looked at next if a step is too long to be searched at once.
const SHORTER: f64 = 0.25;
/// Share of a step that is searched however long that takes.
const SHORTEST: f64 = 1e-3;

/// Two places of the sheet and how near they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Their distance in space, mm.
    pub distance_mm: f64,
    /// Vertices of the sheet at both, (u, v), mm.
    pub at: [DVec2; 2],
}

/// The smallest distance of the sheet from itself where it is below `within_mm`, among places that face each other: as far
/// apart on the flat sheet as the usual contact distance at `thickness_mm` asks, and nearer in space than the ends of half
/// a turn of that length (see the top of `self_collide`).
pub fn self_clearance(sheet: &FoldedSheet, thickness_mm: f64, within_mm: f64) -> Option<Clearance> {
    let contact_mm = SelfCollideOptions::of_thickness(thickness_mm, 0.0).gap().contact_mm;
    let pairs = Sheet::new(&sheet.mesh, Gap::new(0.0, within_mm.max(contact_mm)));
    let found = pairs.candidates(&sheet.positions, &[], 0.0, true)?;
    let x = &sheet.positions;
    let clearance = |p: &Pair| Clearance {
        distance_mm: p.distance_mm(x),
        at: [pairs.flat(p.corners[0]), pairs.flat(p.corners[p.first_corners()])],
    };
    let apart = found.all().filter(|p| p.gap.contact_mm >= contact_mm).map(clearance);
    apart.filter(|c| c.distance_mm < within_mm).min_by(|a, b| a.distance_mm.total_cmp(&b.distance_mm))
}

impl SelfCollide {
    /// For a mesh.
    pub fn of_mesh(mesh: &FlatMesh, options: SelfCollideOptions) -> Self {
        Self { options, sheet: Sheet::new(mesh, options.gap()), found: Mutex::new(None) }
    }

    /// The pairs that matter at `x`: those of the last search if they hold there.
    fn found(&self, x: &[DVec3]) -> Arc<Candidates> {
        let mut last = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = last.as_ref().filter(|f| f.hold_at(x)) {
            return found.clone();
        }
        let found = Arc::new(self.search(x, &[], true).unwrap_or_else(|| Candidates::none(x)));
        *last = Some(found.clone());
        found
    }

    fn search(&self, x: &[DVec3], step: &[DVec3], patient: bool) -> Option<Candidates> {
        self.sheet.candidates(x, step, SPARE, patient)
    }

    /// Calls `f` for every pair that may be in contact at `x`, in order.
    fn each(&self, x: &[DVec3], f: impl FnMut(&Pair)) {
        self.found(x).all().for_each(f);
    }
}

impl Goal for SelfCollide {
    fn name(&self) -> &str {
        "self-collision"
    }

    fn kind(&self) -> &'static str {
        "SelfCollide"
    }

    fn part(&self) -> Part {
        Part::Contact
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        Vec::new()
    }

    fn contacts(&self, x: &[DVec3], margin: f64) -> Vec<[u32; 2]> {
        let margin = margin.min(SPARE);
        let found = self.found(x);
        let touching = found.all().filter(|p| p.distance_mm(x) < p.gap.within_mm(margin));
        let mut pairs: Vec<[u32; 2]> = touching.flat_map(couples).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        if x.iter().any(|p| !p.is_finite()) {
            return f64::NAN; // boxes would not see such a vertex
        }
        let mut sum = 0.0;
        self.each(x, |pair| sum += pair.energy(x));
        self.options.stiffness * sum
    }

    fn add_gradient(&self, x: &[DVec3], out: &mut Gradient<'_>) {
        self.each(x, |pair| {
            if let Some(push) = pair.push(x) {
                let terms = pair.corners.into_iter().zip(push.gradient);
                terms.for_each(|(v, g)| out.add(v, self.options.stiffness * g));
            }
        });
    }

    fn add_hessian(&self, x: &[DVec3], curvature: Curvature, out: &mut HessianSink<'_>) {
        self.each(x, |pair| {
            let Some(blocks) = pair.hessian(x, curvature) else { return };
            for (i, row) in blocks.iter().enumerate() {
                for (j, block) in row.iter().enumerate() {
                    if pair.corners[i] >= pair.corners[j] {
                        out.add(pair.corners[i], pair.corners[j], self.options.stiffness * *block);
                    }
                }
            }
        });
    }

    fn add_moves(&self, x: &[DVec3], out: &mut Moves<'_>) {
        self.each(x, |pair| {
            let Some(push) = pair.push(x) else { return };
            for ((v, g), w) in pair.corners.into_iter().zip(push.gradient).zip(push.weights) {
                if w > 0.0 {
                    out.add(v, self.options.stiffness * w, -g / w);
                }
            }
        });
    }

    fn residual(&self, x: &[DVec3]) -> f64 {
        let mut deepest = 0.0;
        self.each(x, |pair| deepest = f64::max(deepest, pair.gap.contact_mm - pair.distance_mm(x)));
        deepest
    }

    fn largest_step(&self, x: &[DVec3], step: &[DVec3]) -> f64 {
        if step.iter().all(|d| *d == DVec3::ZERO) || x.iter().chain(step).any(|p| !p.is_finite()) {
            return 1.0; // the energy of what is not finite says enough
        }
        let mut share = 1.0;
        loop {
            let part: Vec<DVec3> = step.iter().map(|d| share * *d).collect();
            let Some(found) = self.search(x, &part, share <= SHORTEST) else {
                share *= SHORTER;
                continue;
            };
            let admitted = found.all().fold(1.0, |most, pair| accd::admissible(pair, x, &part, most));
            *self.found.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(found));
            return share * admitted;
        }
    }
}

/// The pairs among a pair's corners.
fn couples(pair: &Pair) -> [[u32; 2]; 6] {
    let c = pair.corners;
    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| [c[i].min(c[j]), c[i].max(c[j])])
}
