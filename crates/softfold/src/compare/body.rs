//! A triangle mesh that distances are asked of: its sides, its edges, and points spread over it.

use softfold_geometry::{DMat3, DVec3, TriMesh};
use softfold_kernel::cgal::{DistanceTree, Foot};
use softfold_kernel::{KernelError, MeshBuffers, MeshView};

/// A mesh with its tree and what its edges and corners look like.
pub(super) struct Body {
    pub(super) mesh: TriMesh,
    tree: DistanceTree,
    edges: Vec<([u32; 2], Edge)>,
    corners: Vec<Corner>,
    /// Whether neighbours agree on their sides, so that distances have a sign.
    pub(super) oriented: bool,
}

#[derive(Clone, Copy, Default)]
struct Edge {
    normal: DVec3,
    /// How many triangles run along it, and against it.
    uses: [u32; 2],
}

#[derive(Clone, Copy, Default)]
struct Corner {
    normal: DVec3,
    border: bool,
}

/// The point of a body that is nearest to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub(super) foot: DVec3,
    /// Unit normal there; on edges and at corners that of the angles around (Bærentzen and Aanæs 2005), whose side is
    /// right wherever the point is.
    pub(super) normal: DVec3,
    /// Whether it lies where the body ends.
    pub(super) border: bool,
}

impl Body {
    /// # Errors
    /// A mesh without a triangle of any area.
    pub(super) fn new(mesh: TriMesh) -> Result<Self, KernelError> {
        let positions: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let tree = DistanceTree::new(MeshView { positions: &positions, triangles: &mesh.triangles })?;
        let edges = edges(&mesh);
        let oriented = edges.iter().all(|(_, e)| e.uses.iter().all(|&n| n <= 1));
        let mut corners = corner_normals(&mesh);
        for (ends, _) in edges.iter().filter(|(_, e)| e.is_border()) {
            ends.iter().for_each(|&v| corners[v as usize].border = true);
        }
        Ok(Self { mesh, tree, edges, corners, oriented })
    }

    /// The nearest points of the body.
    ///
    /// # Errors
    /// Points that are not finite.
    pub(super) fn touch(&self, points: &[DVec3]) -> Result<Vec<Touch>, KernelError> {
        let flat: Vec<[f64; 3]> = points.iter().map(|p| p.to_array()).collect();
        Ok(self.tree.nearest(&flat)?.iter().map(|f| self.at(f)).collect())
    }

    fn at(&self, foot: &Foot) -> Touch {
        let t = self.mesh.triangles[foot.triangle as usize];
        let inside: Vec<u32> = (0..3).filter(|&k| foot.weights[k] != 0.0).map(|k| t[k]).collect();
        let (normal, border) = match inside[..] {
            [v] => (self.corners[v as usize].normal, self.corners[v as usize].border),
            [a, b] => {
                let edge = self.edge(a, b);
                (edge.normal, edge.is_border())
            }
            _ => (area_vector(&self.mesh, t), false),
        };
        Touch { foot: DVec3::from(foot.position), normal: normal.normalize_or_zero(), border }
    }

    fn edge(&self, a: u32, b: u32) -> Edge {
        let key = [a.min(b), a.max(b)];
        self.edges.binary_search_by_key(&key, |e| e.0).map_or_else(|_| Edge::default(), |i| self.edges[i].1)
    }

    /// The diagonal of its box, mm.
    pub(super) fn size_mm(&self) -> f64 {
        size_mm(&self.mesh)
    }
}

impl Edge {
    fn is_border(&self) -> bool {
        self.uses[0] + self.uses[1] == 1
    }
}

/// The diagonal of a mesh's box, mm.
pub(super) fn size_mm(mesh: &TriMesh) -> f64 {
    let (low, high) = mesh.bounds();
    low.distance(high)
}

fn area_vector(mesh: &TriMesh, t: [u32; 3]) -> DVec3 {
    let [a, b, c] = mesh.corners(t);
    0.5 * (b - a).cross(c - a)
}

fn sides(t: [u32; 3]) -> [[u32; 2]; 3] {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
}

/// All edges by their corners, ascending.
fn edges(mesh: &TriMesh) -> Vec<([u32; 2], Edge)> {
    let with_triangle = |t: &[u32; 3]| {
        let normal = area_vector(mesh, *t).normalize_or_zero();
        sides(*t).map(|[a, b]| {
            let uses = if a < b { [1, 0] } else { [0, 1] };
            ([a.min(b), a.max(b)], Edge { normal, uses })
        })
    };
    let mut all: Vec<_> = mesh.triangles.iter().flat_map(with_triangle).collect();
    all.sort_by_key(|e| e.0);
    all.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1.normal += next.1.normal;
            (0..2).for_each(|k| kept.1.uses[k] += next.1.uses[k]);
        }
        same
    });
    all
}

/// Normals of the corners: those of their triangles, weighted by the angles there.
fn corner_normals(mesh: &TriMesh) -> Vec<Corner> {
    let mut corners = vec![Corner::default(); mesh.positions.len()];
    for &t in &mesh.triangles {
        let normal = area_vector(mesh, t).normalize_or_zero();
        for k in 0..3 {
            let [p, q, r] = [0, 1, 2].map(|j| mesh.positions[t[(k + j) % 3] as usize]);
            corners[t[k] as usize].normal += (q - p).angle_between(r - p) * normal;
        }
    }
    corners
}

/// The mesh with corners at the same place made one, without triangles of no area and without unused corners.
pub(super) fn welded(mesh: &MeshBuffers) -> TriMesh {
    // `+ 0.0` makes −0 and 0 one.
    let place = |i: u32| mesh.positions[i as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    order.sort_unstable();
    order.dedup();
    order.sort_by_key(|&i| place(i)); // stable: the first of equals leads
    let mut leader = vec![u32::MAX; mesh.positions.len()];
    for group in order.chunk_by(|&a, &b| place(a) == place(b)) {
        group.iter().for_each(|&i| leader[i as usize] = group[0]);
    }
    let mut leaders: Vec<u32> = order.iter().map(|&i| leader[i as usize]).collect();
    leaders.sort_unstable();
    leaders.dedup();
    let number = |i: u32| leaders.binary_search(&leader[i as usize]).map_or(0, |k| k as u32);
    let flat = |t: &[u32; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    TriMesh {
        positions: leaders.iter().map(|&i| DVec3::from(mesh.positions[i as usize])).collect(),
        triangles: mesh.triangles.iter().map(|t| t.map(number)).filter(|t| !flat(t)).collect(),
    }
}

/// Points spread evenly over the area: the same number on every part of the same size.
pub(super) fn spread(mesh: &TriMesh, count: usize) -> Vec<DVec3> {
    let areas: Vec<f64> = mesh.triangles.iter().map(|t| area_vector(mesh, *t).length()).collect();
    let pitch = areas.iter().sum::<f64>() / count as f64;
    let mut points = Vec::with_capacity(count);
    let mut passed = 0.0;
    for (t, area) in mesh.triangles.iter().zip(&areas) {
        passed += area;
        while points.len() < count && (points.len() as f64 + 0.5) * pitch <= passed {
            points.push(within(mesh.corners(*t), points.len()));
        }
    }
    points
}

/// The `k`-th point of a sequence that covers triangles evenly: the additive one of the plastic number, folded.
fn within([a, b, c]: [DVec3; 3], k: usize) -> DVec3 {
    let k = k as f64;
    let (u, v) = ((0.5 + 0.754_877_666_246_693 * k).fract(), (0.5 + 0.569_840_290_998_053 * k).fract());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    a + u * (b - a) + v * (c - a)
}

/// Area, barycenter and second moments about it (`∫ (x − c)(x − c)ᵀ dA` over the area) of a surface, exactly.
pub(super) fn moments(mesh: &TriMesh) -> (f64, DVec3, DMat3) {
    let pieces = || mesh.triangles.iter().map(|t| (mesh.corners(*t), area_vector(mesh, *t).length()));
    let area: f64 = pieces().map(|p| p.1).sum();
    let center = pieces().map(|([a, b, c], w)| w * (a + b + c) / 3.0).sum::<DVec3>() / area;
    let outer = |p: DVec3| DMat3::from_cols(p * p.x, p * p.y, p * p.z);
    let second = |(corners, w): ([DVec3; 3], f64)| {
        let q = corners.map(|p| p - center);
        (outer(q[0]) + outer(q[1]) + outer(q[2]) + outer(q[0] + q[1] + q[2])) * (w / 12.0)
    };
    let sum = pieces().map(second).fold(DMat3::ZERO, |a, b| a + b);
    (area, center, sum * area.recip())
}

/// The same surface with no edge longer than `edge_mm`: long ones are halved, again and again, while that leaves fewer
/// than `most` triangles.
pub(crate) fn refined(mesh: &TriMesh, edge_mm: f64, most: usize) -> TriMesh {
    let mut mesh = mesh.clone();
    while let Some(finer) = halved(&mesh, edge_mm).filter(|m| m.triangles.len() <= most) {
        mesh = finer;
    }
    mesh
}

/// Every long edge halved once; none if there is no long edge.
fn halved(mesh: &TriMesh, edge_mm: f64) -> Option<TriMesh> {
    let long = |[a, b]: [u32; 2]| mesh.positions[a as usize].distance(mesh.positions[b as usize]) > edge_mm;
    let mut split: Vec<[u32; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|t| sides(*t))
        .filter(|e| long(*e))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    split.sort_unstable();
    split.dedup();
    if split.is_empty() {
        return None;
    }
    let first = mesh.positions.len() as u32;
    let middle = |[a, b]: [u32; 2]| split.binary_search(&[a.min(b), a.max(b)]).ok().map(|k| first + k as u32);
    let at = |[a, b]: &[u32; 2]| 0.5 * (mesh.positions[*a as usize] + mesh.positions[*b as usize]);
    let positions = mesh.positions.iter().copied().chain(split.iter().map(at)).collect();
    let triangles = mesh.triangles.iter().flat_map(|t| pieces(*t, sides(*t).map(middle))).collect();
    Some(TriMesh { positions, triangles })
}

/// A triangle cut at the middles of those sides that have one.
fn pieces(t: [u32; 3], middles: [Option<u32>; 3]) -> Vec<[u32; 3]> {
    // Turned so that the sides that are cut come first.
    let turn = |k: usize| ([0, 1, 2].map(|i| t[(k + i) % 3]), [0, 1, 2].map(|i| middles[(k + i) % 3]));
    let first = (0..3).max_by_key(|&k| {
        let (_, m) = turn(k);
        m.iter().take_while(|x| x.is_some()).count()
    });
    let ([a, b, c], middles) = turn(first.unwrap_or(0));
    match middles {
        [Some(p), Some(q), Some(r)] => vec![[a, p, r], [p, b, q], [r, q, c], [p, q, r]],
        [Some(p), Some(q), None] => vec![[p, b, q], [a, p, q], [a, q, c]],
        [Some(p), ..] => vec![[a, p, c], [p, b, c]],
        _ => vec![t],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of side 2 about the origin, of two triangles, and as a soup.
    fn square() -> MeshBuffers {
        let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, -0.0], [-1.0, 1.0, 0.0]];
        let positions = [0, 1, 2, 0, 2, 3].map(|i: usize| corners[i]).to_vec();
        MeshBuffers { positions, triangles: vec![[0, 1, 2], [3, 4, 5]] }
    }

    #[test]
    fn a_soup_becomes_a_mesh_with_a_border_and_sides() {
        let mesh = welded(&square());
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 2));
        let body = Body::new(mesh).unwrap();
        assert!(body.oriented);
        let touch = |x: f64, y: f64, z: f64| body.touch(&[DVec3::new(x, y, z)]).unwrap()[0];
        assert!(!touch(0.2, 0.2, 1.0).border && touch(0.2, 0.2, 1.0).normal == DVec3::Z);
        assert!(touch(3.0, 0.0, 0.5).border && touch(3.0, 3.0, 0.0).border);
        assert_eq!(touch(3.0, 0.25, 0.5).foot, DVec3::new(1.0, 0.25, 0.0));
    }

    #[test]
    fn sides_that_disagree_leave_no_sign() {
        let mut mesh = welded(&square());
        mesh.triangles[1].swap(0, 1);
        assert!(!Body::new(mesh).unwrap().oriented);
    }

    #[test]
    fn moments_are_those_of_the_square_and_samples_have_them_too() {
        let mesh = welded(&square());
        let (area, center, second) = moments(&mesh);
        assert!((area - 4.0).abs() < 1e-15 && center.length() < 1e-15);
        assert!((second.x_axis.x - 1.0 / 3.0).abs() < 1e-15 && second.x_axis.y.abs() < 1e-15);
        let points = spread(&mesh, 4000);
        assert_eq!(points.len(), 4000);
        let mean = |f: &dyn Fn(&DVec3) -> f64| points.iter().map(f).sum::<f64>() / 4000.0;
        // A third of what chance would give, 0.58/√4000 = 0.009.
        assert!((mean(&|p| p.x * p.x) - 1.0 / 3.0).abs() < 3e-3 && mean(&|p| p.x).abs() < 3e-3);
        assert!(mean(&|p| p.x * p.y).abs() < 3e-3);
    }

    #[test]
    fn refining_keeps_the_surface_and_leaves_no_long_edge() {
        let mesh = refined(&welded(&square()), 0.3, 100_000);
        assert!((mesh.area_mm2() - 4.0).abs() < 1e-12);
        let body = Body::new(mesh.clone()).unwrap();
        assert!(body.oriented);
        let longest = |t: &[u32; 3]| {
            sides(*t).map(|[a, b]| mesh.positions[a as usize].distance(mesh.positions[b as usize]))
        };
        assert!(mesh.triangles.iter().flat_map(longest).all(|l| l <= 0.3));
        // Every inner edge is shared: what is border lies on the outline.
        for ([a, b], _) in body.edges.iter().filter(|(_, e)| e.is_border()) {
            let middle = 0.5 * (mesh.positions[*a as usize] + mesh.positions[*b as usize]);
            assert!((middle.abs().max_element() - 1.0).abs() < 1e-12, "{middle}");
        }
        assert_eq!(refined(&mesh, 0.01, 10), mesh);
    }
}
