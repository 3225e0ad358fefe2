//! The sum of all goals.

use crate::goal::{Curvature, Goal, Gradient, HessianSink, Moves, Scales};
#[cfg(test)]
use crate::hessian::coupled_rows;
use crate::hessian::{BlockSink, Hessian};
use glam::DVec3;

/// Share of the forces at the start below which forces count as none.
const FLOOR_SHARE: f64 = 1e-3;

/// All goals over one mesh, as one function to minimise.
pub struct Objective<'a> {
    vertices: usize,
    goals: &'a [Box<dyn Goal>],
}

/// A gradient with the scale against which it is small.
pub struct GradientSum {
    /// ∂E/∂x per vertex, N.
    pub sum: Vec<DVec3>,
    magnitude: Vec<f64>,
}

impl GradientSum {
    /// `‖Σ terms‖ / ‖Σ |terms|‖`: unbalanced force over the forces that are at work, the residual measure
    /// of structural mechanics; where less than `floor` (N) is at work, over that. 0 where nothing is.
    pub fn relative(&self, floor: f64) -> f64 {
        let scale = self.scale().max(floor);
        if scale == 0.0 { 0.0 } else { norm_squared(&self.sum).sqrt() / scale }
    }

    /// Norm of the forces at work, N.
    pub fn scale(&self) -> f64 {
        self.magnitude.iter().map(|m| m * m).sum::<f64>().sqrt()
    }
}

/// Sum of the squared lengths.
pub(crate) fn norm_squared(v: &[DVec3]) -> f64 {
    v.iter().map(|p| p.length_squared()).sum()
}

impl<'a> Objective<'a> {
    /// The goals over a mesh of `vertices` vertices.
    pub fn new(vertices: usize, goals: &'a [Box<dyn Goal>]) -> Self {
        Self { vertices, goals }
    }

    /// Energy with the parts scaled.
    pub fn energy(&self, x: &[DVec3], scales: Scales) -> f64 {
        self.goals.iter().map(|g| scales.of(g.part()) * g.energy(x)).sum()
    }

    /// Forces below this are none, N: a thousandth of what is at work at the start. A sheet that comes to rest without
    /// any strain has only rounding left, which must not be measured against itself.
    pub fn force_floor(&self, start: &[DVec3]) -> f64 {
        FLOOR_SHARE * self.gradient(start, Scales::FULL).scale()
    }

    /// Energy of each goal by name.
    pub fn energies(&self, x: &[DVec3]) -> Vec<(String, f64)> {
        self.goals.iter().map(|g| (g.name().to_owned(), g.energy(x))).collect()
    }

    /// Gradient with the parts scaled.
    pub fn gradient(&self, x: &[DVec3], scales: Scales) -> GradientSum {
        let mut sum = vec![DVec3::ZERO; self.vertices];
        let mut magnitude = vec![0.0; self.vertices];
        for g in self.goals {
            let scale = scales.of(g.part());
            g.add_gradient(x, &mut Gradient { sum: &mut sum, magnitude: &mut magnitude, scale });
        }
        GradientSum { sum, magnitude }
    }

    /// The goals' couplings wherever the vertices are.
    pub(crate) fn couplings(&self) -> impl Iterator<Item = Vec<u32>> {
        self.goals.iter().flat_map(|g| g.couplings())
    }

    /// The goals' couplings and the contacts at `x`, or nearly so by `margin`.
    pub(crate) fn couplings_at(&self, x: &[DVec3], margin: f64) -> Vec<Vec<u32>> {
        let contacts = self.contacts(x, margin).into_iter().map(|pair| pair.to_vec());
        self.couplings().chain(contacts).collect()
    }

    /// Number of vertices.
    pub(crate) fn vertices(&self) -> usize {
        self.vertices
    }

    /// Pairs of vertices in contact at `x`, or nearly so by `margin`: see [`Goal::contacts`].
    pub fn contacts(&self, x: &[DVec3], margin: f64) -> Vec<[u32; 2]> {
        self.goals.iter().flat_map(|g| g.contacts(x, margin)).collect()
    }

    /// The largest share of a step, at most 1, that no barrier forbids: see [`Goal::largest_step`].
    pub fn largest_step(&self, x: &[DVec3], step: &[DVec3]) -> f64 {
        self.goals.iter().fold(1.0, |most, g| most.min(g.largest_step(x, step)))
    }

    /// Fills a Hessian.
    pub fn fill_hessian(&self, x: &[DVec3], curvature: Curvature, scales: Scales, matrix: &mut Hessian) {
        matrix.clear();
        self.add_blocks(x, curvature, scales, matrix);
    }

    /// Adds the Hessian's blocks to `matrix`.
    pub(crate) fn add_blocks(
        &self,
        x: &[DVec3],
        curvature: Curvature,
        scales: Scales,
        matrix: &mut dyn BlockSink,
    ) {
        for g in self.goals {
            let scale = scales.of(g.part());
            g.add_hessian(x, curvature, &mut HessianSink { matrix, scale });
        }
    }

    /// The moves of eq. 4: `Σ w G` and `Σ w` per vertex.
    pub fn moves(&self, x: &[DVec3]) -> (Vec<DVec3>, Vec<f64>) {
        let mut weighted = vec![DVec3::ZERO; self.vertices];
        let mut weights = vec![0.0; self.vertices];
        for g in self.goals {
            g.add_moves(x, &mut Moves { weighted: &mut weighted, weights: &mut weights });
        }
        (weighted, weights)
    }

    #[cfg(test)]
    pub(crate) fn hessian(&self, x: &[DVec3], curvature: Curvature, scales: Scales) -> Hessian {
        let rows = coupled_rows(self.vertices, &self.couplings_at(x, 0.0));
        let mut matrix = Hessian::new(&rows, (0..self.vertices as u32).collect());
        self.fill_hessian(x, curvature, scales, &mut matrix);
        matrix
    }
}
