//! Slits open: every vertex on one gets a copy for each fan of triangles that slits and boundary leave around it.

use crate::cdt::{Constraint, PlanarGraph};
use crate::rings::Rings;
use glam::DVec2;
use softfold_geometry::{Site, VertexId};
use std::collections::{BTreeMap, BTreeSet};

/// Triangles with vertices of their own on both lips of slits.
pub(crate) struct Opened {
    pub(crate) vertices: Vec<DVec2>,
    pub(crate) sites: Vec<Site>,
    pub(crate) triangles: Vec<[VertexId; 3]>,
    /// The point of the graph that each vertex is, or is a copy of.
    pub(crate) origins: Vec<VertexId>,
}

/// Cuts the triangles apart along the slits of the graph. Copies follow the vertices of the graph.
pub(crate) fn open(graph: &PlanarGraph, sites: Vec<Site>, triangles: Vec<[VertexId; 3]>) -> Opened {
    let origins = (0..graph.points.len()).map(VertexId::new).collect();
    let mut opened = Opened { vertices: graph.points.clone(), sites, triangles, origins };
    let is_slit = |c: &&([VertexId; 2], Constraint)| matches!(c.1, Constraint::Slit { .. });
    let walls: BTreeSet<[VertexId; 2]> =
        graph.constraints.iter().filter(is_slit).flat_map(|&([a, b], _)| [[a, b], [b, a]]).collect();
    let cut: BTreeSet<VertexId> = walls.iter().map(|e| e[0]).collect();
    let rings = Rings::new(graph.points.len(), &opened.triangles);
    let fans: Vec<(VertexId, Vec<Vec<u32>>)> =
        cut.into_iter().map(|v| (v, fans(v, rings.of(v.index()), &opened.triangles, &walls))).collect();
    for (vertex, fans) in fans {
        for fan in fans.iter().skip(1) {
            opened.copy(vertex, fan);
        }
    }
    opened
}

impl Opened {
    /// Gives the triangles of a fan a vertex of their own.
    fn copy(&mut self, vertex: VertexId, fan: &[u32]) {
        let new = VertexId::new(self.vertices.len());
        self.vertices.push(self.vertices[vertex.index()]);
        self.sites.push(self.sites[vertex.index()]);
        self.origins.push(vertex);
        for &t in fan {
            self.triangles[t as usize].iter_mut().filter(|v| **v == vertex).for_each(|v| *v = new);
        }
    }
}

/// The triangles around a vertex in fans that walls and the boundary separate, each counter-clockwise. First comes the
/// fan at whose end the boundary arrives at the vertex: on the outline the vertex itself stays before its copies.
fn fans(
    vertex: VertexId,
    ring: &[u32],
    triangles: &[[VertexId; 3]],
    walls: &BTreeSet<[VertexId; 2]>,
) -> Vec<Vec<u32>> {
    // A triangle of the ring by its first side, the one that leaves the vertex; and that side's far end.
    let far = |t: u32| {
        let corners = triangles[t as usize];
        let k = (0..3).find(|&k| corners[k] == vertex).unwrap_or(0);
        [corners[(k + 1) % 3], corners[(k + 2) % 3]]
    };
    let leaving: BTreeMap<VertexId, u32> = ring.iter().map(|&t| (far(t)[0], t)).collect();
    let arriving: BTreeSet<VertexId> = ring.iter().map(|&t| far(t)[1]).collect();
    let is_wall = |v: VertexId| walls.contains(&[vertex, v]);
    let starts = leaving.iter().filter(|(v, _)| is_wall(**v) || !arriving.contains(*v)).map(|(_, t)| *t);
    let mut fans = Vec::new();
    for start in starts {
        let mut fan = vec![start];
        let mut end = far(start)[1];
        while let (false, Some(&next)) = (is_wall(end), leaving.get(&end)) {
            if next == start {
                break;
            }
            fan.push(next);
            end = far(next)[1];
        }
        fans.push((leaving.contains_key(&end), fan));
    }
    // On the boundary the last side of the first fan has no triangle beyond.
    fans.sort_by_key(|(goes_on, _)| *goes_on);
    fans.into_iter().map(|(_, fan)| fan).collect()
}
