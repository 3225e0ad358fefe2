//! The flat mesh as the carrier of fields: neighbours, border loops, fold lines as chains, and angles about the holes.

use glam::DVec2;
use softfold_geometry::{CreaseId, EdgeClass, FlatMesh, LoopId, SoftPattern, TriangleId, polygon};
use std::collections::BTreeMap;

/// A fold line of the mesh.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    pub(crate) crease: CreaseId,
    /// Its number in the band's fold lines.
    pub(crate) line: usize,
    /// Vertices along the crease's direction; of a closed one each once.
    pub(crate) vertices: Vec<usize>,
    pub(crate) closed: bool,
}

/// The mesh with what fields on it need to know.
pub(crate) struct Background<'a> {
    pub(crate) mesh: &'a FlatMesh,
    pub(crate) soft: &'a SoftPattern,
    /// Beyond the side opposite to each corner.
    pub(crate) neighbours: Vec<[Option<usize>; 3]>,
    /// Border vertices, the sheet at the left: outline first, then holes.
    pub(crate) loops: Vec<Vec<usize>>,
    pub(crate) chains: Vec<Chain>,
    /// A point inside each hole.
    pub(crate) hole_centres: Vec<DVec2>,
}

impl<'a> Background<'a> {
    pub(crate) fn new(mesh: &'a FlatMesh, soft: &'a SoftPattern) -> Self {
        let loops = loops(mesh, soft.loops.len());
        let inside = |l: &Vec<usize>| inner_point(&l.iter().map(|&v| mesh.vertices[v]).collect::<Vec<_>>());
        let hole_centres = loops.iter().skip(1).map(inside).collect();
        Self { mesh, soft, neighbours: neighbours(mesh), loops, chains: chains(mesh, soft), hole_centres }
    }

    pub(crate) fn corners(&self, triangle: usize) -> [usize; 3] {
        self.mesh.triangles[triangle].map(|v| v.index())
    }

    pub(crate) fn points(&self, triangle: usize) -> [DVec2; 3] {
        self.mesh.corners(TriangleId::new(triangle))
    }

    /// Gradients of the three hat functions of a triangle, 1/mm, and its area, mm².
    pub(crate) fn gradients(&self, triangle: usize) -> ([DVec2; 3], f64) {
        let p = self.points(triangle);
        let double = (p[1] - p[0]).perp_dot(p[2] - p[0]);
        ([0, 1, 2].map(|k| (p[(k + 2) % 3] - p[(k + 1) % 3]).perp() / double), 0.5 * double)
    }

    /// Angle by which the ray from the centre of a hole turns on the way from one point to another near it, rad.
    pub(crate) fn swept(&self, hole: usize, from: DVec2, to: DVec2) -> f64 {
        let c = self.hole_centres[hole];
        (from - c).angle_to(to - c)
    }

    /// Angle of a point about a hole, rad; it jumps behind the hole.
    pub(crate) fn angle(&self, hole: usize, p: DVec2) -> f64 {
        (p - self.hole_centres[hole]).to_angle()
    }

    /// Angles about a hole along a row of vertices, without jumps.
    pub(crate) fn angles_along(&self, hole: usize, vertices: &[usize]) -> Vec<f64> {
        let at = |v: usize| self.mesh.vertices[v];
        let mut angle = vertices.first().map_or(0.0, |&v| self.angle(hole, at(v)));
        let mut angles = vec![angle];
        for w in vertices.windows(2) {
            angle += self.swept(hole, at(w[0]), at(w[1]));
            angles.push(angle);
        }
        angles
    }
}

fn neighbours(mesh: &FlatMesh) -> Vec<[Option<usize>; 3]> {
    let mut neighbours = vec![[None; 3]; mesh.triangles.len()];
    for e in &mesh.edges {
        let [Some(a), Some(b)] = e.triangles else { continue };
        for (t, other) in [(a, b), (b, a)] {
            let tip = mesh.opposite(t, e.vertices);
            let side = mesh.triangles[t.index()].iter().position(|v| *v == tip).unwrap_or(0);
            neighbours[t.index()][side] = Some(other.index());
        }
    }
    neighbours
}

fn loops(mesh: &FlatMesh, count: usize) -> Vec<Vec<usize>> {
    let mut next = BTreeMap::new();
    let mut starts = vec![None; count];
    for e in &mesh.edges {
        let EdgeClass::Boundary { loop_id } = e.class else { continue };
        let [a, b] = e.vertices.map(|v| v.index());
        next.insert(a, b);
        if let Some(start @ None) = starts.get_mut(LoopId::index(loop_id)) {
            *start = Some(a);
        }
    }
    let around = |start: usize| {
        let mut found = vec![start];
        while let Some(&v) = next.get(&found[found.len() - 1]) {
            if v == start || found.len() > next.len() {
                break;
            }
            found.push(v);
        }
        found
    };
    starts.into_iter().flatten().map(around).collect()
}

/// Fold lines as chains, in order of crease and line.
fn chains(mesh: &FlatMesh, soft: &SoftPattern) -> Vec<Chain> {
    let mut lines: BTreeMap<(CreaseId, u32), BTreeMap<usize, Vec<usize>>> = BTreeMap::new();
    for e in &mesh.edges {
        let EdgeClass::Fold { crease, line, .. } = e.class else { continue };
        let [a, b] = e.vertices.map(|v| v.index());
        let of_line = lines.entry((crease, line)).or_default();
        of_line.entry(a).or_default().push(b);
        of_line.entry(b).or_default().push(a);
    }
    let mut chains = Vec::new();
    for ((crease, line), mut links) in lines {
        while let Some((vertices, closed)) = take_path(&mut links) {
            let mut chain = Chain { crease, line: line as usize, vertices, closed };
            direct(mesh, soft, &mut chain);
            chains.push(chain);
        }
    }
    chains
}

/// One path out of a graph, from an end if there is one.
fn take_path(links: &mut BTreeMap<usize, Vec<usize>>) -> Option<(Vec<usize>, bool)> {
    let end = links.iter().find(|(_, n)| n.len() == 1).map(|(v, _)| *v);
    let start = end.or_else(|| links.iter().find(|(_, n)| !n.is_empty()).map(|(v, _)| *v))?;
    let mut path = vec![start];
    loop {
        let here = path[path.len() - 1];
        let Some(next) = links.get_mut(&here).and_then(Vec::pop) else { break };
        if let Some(back) = links.get_mut(&next) {
            back.retain(|v| *v != here);
        }
        if next == start {
            return Some((path, true));
        }
        path.push(next);
    }
    links.retain(|_, n| !n.is_empty());
    Some((path, false))
}

/// Turns a chain into the direction of its crease.
fn direct(mesh: &FlatMesh, soft: &SoftPattern, chain: &mut Chain) {
    let band = soft.bands.iter().find(|b| b.crease == chain.crease);
    let Some(line) = band.and_then(|b| b.fold_lines.get(chain.line)) else { return };
    let [a, b] = [chain.vertices[0], chain.vertices[1]].map(|v| mesh.vertices[v]);
    let middle = 0.5 * (a + b);
    let beside = |w: &[DVec2]| polygon::segment_distance(middle, w[0], w[1]);
    let nearest = line.points.windows(2).min_by(|x, y| beside(x).total_cmp(&beside(y)));
    if nearest.is_some_and(|w| (w[1] - w[0]).dot(b - a) < 0.0) {
        chain.vertices.reverse();
    }
}

/// A point inside a polygon: the middle of the widest run at half its height.
fn inner_point(polygon: &[DVec2]) -> DVec2 {
    let (lo, hi) = polygon::bounds(polygon);
    let height = 0.5 * (lo.y + hi.y);
    let cross = |(a, b): (DVec2, DVec2)| {
        ((a.y > height) != (b.y > height)).then(|| a.x + (height - a.y) / (b.y - a.y) * (b.x - a.x))
    };
    let mut us: Vec<f64> = polygon::edges(polygon).filter_map(cross).collect();
    us.sort_by(f64::total_cmp);
    let widest = us.chunks_exact(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    DVec2::new(widest.map_or(0.5 * (lo.x + hi.x), |r| 0.5 * (r[0] + r[1])), height)
}
