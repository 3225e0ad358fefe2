//! Coarse meshes of the same sheet, through which folding goes to its own mesh.

use crate::goals::goals;
use crate::{Loaded, softness};
use softfold_fold::{Between, Level, Pyramid, schedule};
use softfold_geometry::{CreaseId, CreasePattern, FlatMesh, SoftPattern, polygon};
use softfold_mesh::mesh;
use softfold_soften::{CreaseSoftness, Segments, soften};
use std::cell::OnceCell;

/// Meshes of fewer vertices are folded alone: a pyramid would save nothing.
const LEAST_VERTICES: usize = 2_000;
/// How much longer the edges of the next coarser mesh are.
const COARSER: f64 = 2.2;
/// A coarser mesh is worth having if it has at most this share of the vertices of the finer one.
const FEWER: f64 = 0.5;
/// Strips per band at least, as long as there are as many.
const LEAST_SEGMENTS: u32 = 2;
/// What is carried to a mesh is near its shape there within this share of the sheet's diagonal: one millimetre on two metres, a
/// quarter of what a folded shape is held to against closed forms.
const NEAR_SHARE: f64 = 5e-4;

/// Coarse meshes of a softened sheet with their goals, and those between them that are made when folding asks for them.
pub struct Meshes<'a> {
    loaded: &'a Loaded,
    pattern: &'a CreasePattern,
    /// Creases fold by this share of their angles.
    share: &'a dyn Fn(CreaseId) -> f64,
    levels: Vec<Level>,
    /// How each of them is made, the coarsest first, and the mesh asked for.
    recipes: Vec<Recipe>,
    between: Vec<OnceCell<Option<Level>>>,
    near_mm: f64,
}

/// How fine a mesh is.
#[derive(Clone)]
struct Recipe {
    softness: Vec<CreaseSoftness>,
    /// Strips of each band.
    segments: Vec<u32>,
    edge_mm: f64,
}

impl<'a> Meshes<'a> {
    /// The coarse meshes for a sheet's own mesh. Bands have half as many strips on each coarser mesh. Where the bands do
    /// not fit that way, or the goals find no place, the pyramid ends: it saves time, and nothing depends on it.
    pub fn new(
        loaded: &'a Loaded,
        pattern: &'a CreasePattern,
        own: &FlatMesh,
        share: &'a dyn Fn(CreaseId) -> f64,
    ) -> Self {
        let (lo, hi) = polygon::bounds(&own.vertices);
        let near_mm = NEAR_SHARE * lo.distance(hi);
        let (levels, recipes, between) = (Vec::new(), Vec::new(), Vec::new());
        let mut meshes = Self { loaded, pattern, share, levels, recipes, between, near_mm };
        meshes.coarsen(own.vertices.len());
        meshes.levels.reverse();
        meshes.recipes.reverse();
        meshes.between = meshes.recipes.iter().map(|_| OnceCell::new()).collect();
        meshes
    }

    /// For the solver; `between` is [`Meshes::between`].
    pub fn pyramid<'m>(&'m self, between: &'m dyn Fn(usize) -> Option<&'m Level>) -> Pyramid<'m> {
        let between = Some(Between { mesh: between, near_mm: self.near_mm });
        Pyramid { levels: &self.levels, between, carry: &softfold_mesh::transfer }
    }

    /// The mesh between coarse mesh `k − 1` and the next finer one, made at the first call; none where it cannot be made.
    pub fn between(&self, k: usize) -> Option<&Level> {
        let (coarse, fine) = (self.recipes.get(k.checked_sub(1)?)?, self.recipes.get(k)?);
        self.between.get(k)?.get_or_init(|| self.level(&coarse.halfway(fine))).as_ref()
    }

    /// Makes ever coarser meshes.
    fn coarsen(&mut self, vertices: usize) {
        let mut finer = vertices;
        let Some(mut recipe) = Recipe::own(self.loaded, self.pattern) else { return };
        self.recipes.push(recipe.clone());
        while finer >= LEAST_VERTICES {
            recipe = recipe.coarser();
            let Some(level) = self.level(&recipe) else { break };
            let vertices = level.mesh.vertices.len();
            if vertices as f64 > FEWER * finer as f64 {
                break;
            }
            finer = vertices;
            self.recipes.push(recipe.clone());
            self.levels.push(level);
        }
    }

    fn level(&self, recipe: &Recipe) -> Option<Level> {
        let soft = soften(self.pattern, &recipe.softness()).ok()?;
        let options = softfold_mesh::MeshOptions {
            target_edge_mm: recipe.edge_mm,
            ..self.loaded.project.mesh.options()
        };
        let mesh = schedule::with_share(&mesh(&soft, &options).ok()?.mesh, self.share);
        let goals = goals(self.loaded, &mesh, self.pattern).ok()?;
        Some(Level { mesh, goals })
    }
}

impl Recipe {
    /// The one of the mesh asked for.
    fn own(loaded: &Loaded, pattern: &CreasePattern) -> Option<Self> {
        let softness = softness::of_all(loaded, pattern, &mut Vec::new()).ok()?;
        let soft: SoftPattern = soften(pattern, &softness).ok()?;
        let segments = soft.bands.iter().map(|band| band.segments).collect();
        Some(Self { softness, segments, edge_mm: loaded.project.mesh.target_edge_mm })
    }

    /// Longer edges, and half as many strips.
    fn coarser(&self) -> Self {
        let half = |n: &u32| n.div_ceil(2).max(LEAST_SEGMENTS).min(*n);
        let segments = self.segments.iter().map(half).collect();
        Self { segments, edge_mm: COARSER * self.edge_mm, ..self.clone() }
    }

    /// The geometric means of edges and strips.
    fn halfway(&self, finer: &Self) -> Self {
        let mean = |(a, b): (&u32, &u32)| (f64::from(*a) * f64::from(*b)).sqrt().round() as u32;
        let segments = self.segments.iter().zip(&finer.segments).map(mean).collect();
        Self { segments, edge_mm: (self.edge_mm * finer.edge_mm).sqrt(), ..self.clone() }
    }

    /// How soft the creases are, with as many strips as the recipe says.
    fn softness(&self) -> Vec<CreaseSoftness> {
        let mut softness = self.softness.clone();
        for (s, n) in softness.iter_mut().zip(&self.segments) {
            s.segments = Segments::Count(*n);
        }
        softness
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Stage, progress::Quiet, run};

    #[test]
    fn a_mesh_between_is_made_once_and_lies_between() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/sculpture/project.toml");
        let loaded = Loaded::read(path.as_ref()).unwrap();
        let results = run(&loaded, Stage::Mesh, &mut Quiet).unwrap();
        let (pattern, own) = (results.pattern.unwrap(), results.mesh.unwrap().meshed.mesh);
        let meshes = Meshes::new(&loaded, &pattern, &own, &|_| 1.0);
        let coarse: Vec<usize> = meshes.levels.iter().map(|l| l.mesh.vertices.len()).collect();
        assert_eq!(meshes.recipes.len(), coarse.len() + 1);
        let (k, last) = (coarse.len(), *coarse.last().unwrap());
        let between = meshes.between(k).unwrap();
        let vertices = between.mesh.vertices.len();
        assert!(last < vertices && vertices < own.vertices.len(), "{last} {vertices} {}", own.vertices.len());
        assert!(std::ptr::eq(between, meshes.between(k).unwrap()));
        assert!(meshes.between(0).is_none() && meshes.between(k + 1).is_none());
    }
}
