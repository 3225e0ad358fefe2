//! A mesh in the making: points and constraints, the triangles between them, and what the pattern makes sharp. All are
//! kept in step through every change, which sees to the triangles around it only.

use crate::cdt::{canonical, triangulate};
use crate::net::Net;
use crate::planar::Planar;
use crate::sharp::Sharp;
use crate::{MeshError, MeshOptions};
use glam::DVec2;
use softfold_geometry::{Site, VertexId};

/// Points, constraints and their constrained Delaunay triangulation.
pub(crate) struct Draft<'a> {
    pub(crate) planar: Planar<'a>,
    pub(crate) net: Net,
    pub(crate) sharp: Sharp,
    /// How far edges may be from their curves, mm.
    pub(crate) chord_mm: f64,
}

impl<'a> Draft<'a> {
    /// Triangulates; whichever library does it, the net is the same.
    pub(crate) fn new(planar: Planar<'a>, options: &MeshOptions) -> Result<Self, MeshError> {
        let graph = &planar.graph;
        let mut net = Net::of_graph(graph, &triangulate(graph, options.backend)?.triangles);
        if net.flip_all(&graph.points) {
            net = Net::of_graph(graph, &canonical(graph.points.len(), &net.triangles()));
        }
        let sharp = Sharp::new(&planar, options.target_edge_mm);
        Ok(Self { planar, net, sharp, chord_mm: options.chord * options.target_edge_mm })
    }

    pub(crate) fn points(&self) -> &[DVec2] {
        &self.planar.graph.points
    }

    /// Places of the corners of a triangle.
    pub(crate) fn places(&self, t: usize) -> [DVec2; 3] {
        self.net.places(&self.planar.graph.points, t)
    }

    /// Whether the pattern itself makes a triangle sharp.
    pub(crate) fn is_excused(&self, t: usize) -> bool {
        self.sharp.excuse(&self.planar, &self.net, t).is_some()
    }

    /// Puts a point into a triangle; whether it is there. Writes the triangles that are new.
    pub(crate) fn put(&mut self, t: usize, at: DVec2, changed: &mut Vec<u32>) -> bool {
        self.planar.graph.points.push(at);
        if !self.net.insert(&self.planar.graph.points, t, changed) {
            self.planar.graph.points.pop();
            return false;
        }
        self.planar.sites.push(Site::Interior);
        self.sharp.add_free();
        true
    }

    /// Splits the constraint on a side where its curve is at a length. Writes the triangles that are new.
    pub(crate) fn split(&mut self, [t, k]: [usize; 2], at_mm: f64, changed: &mut Vec<u32>) {
        let constraint = self.net.walls[t][k];
        let [from, to] = self.planar.graph.constraints[constraint as usize].0;
        let other = self.planar.spans.len() as u32;
        self.planar.split(constraint as usize, at_mm);
        self.sharp.add_split([constraint, other], to);
        let forward = self.net.corners[t][k] == from.0;
        let walls = if forward { [constraint, other] } else { [other, constraint] };
        self.net.split(&self.planar.graph.points, [t, k], walls, changed);
    }

    /// Flips what is no longer Delaunay around a vertex that moved.
    pub(crate) fn moved(&mut self, v: u32, changed: &mut Vec<u32>) {
        self.net.flip_around(&self.planar.graph.points, &[v], changed);
    }

    /// Triangles in an order that is theirs alone.
    pub(crate) fn triangles(&self) -> Vec<[VertexId; 3]> {
        canonical(self.points().len(), &self.net.triangles())
    }
}
