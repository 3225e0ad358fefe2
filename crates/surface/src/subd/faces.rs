//! The limit surface as B-spline faces: merged where it is regular, single patches around irregular vertices.

use super::merge::{Rectangle, rectangles};
use super::quads::{Quads, Sides};
use super::turned::{Neighbours, Turned};
use glam::{DVec2, DVec3};
use softfold_kernel::KernelError;
use softfold_kernel::opensubdiv::{self, BsplinePatches};

/// Parts of a quad's side that corners of patches are counted in.
pub(crate) const UNIT: u32 = 1 << 12;
/// How often quads at an irregular vertex are halved before the rest is one patch: the rest is an eighth of a cell.
const ISOLATION: u32 = 3;

/// A uniform bicubic face. Its parameters run from 0 to `size` over [`UNIT`], in quads.
#[derive(Clone, Debug, PartialEq)]
pub struct BsplineFace {
    /// Poles, u outer and v inner, mm.
    pub poles: Vec<DVec3>,
    /// The same of the flat sheet, (u, v) in mm.
    pub flat: Vec<DVec2>,
    /// Poles along u and v.
    pub count: [usize; 2],
    /// Distance of knots, in quads: 1, or less around irregular vertices.
    pub step: f64,
    /// Whether it is bordered by regular quads alone.
    pub regular: bool,
    pub(crate) cells: Rectangle,
    /// Lower corner in its only quad, and size over all quads, in [`UNIT`]s.
    pub(crate) origin: (u32, u32),
    pub(crate) size: (u32, u32),
}

/// The faces and how many patches they were before merging.
pub(crate) struct Faces {
    pub(crate) faces: Vec<BsplineFace>,
    pub(crate) patches: usize,
}

/// Converts a cage with its control points in space and in the flat sheet.
///
/// # Errors
/// OpenSubdiv's refusal.
pub(crate) fn faces(
    quads: &Quads,
    sides: &Sides,
    positions: &[DVec3],
    flat: &[DVec2],
) -> Result<Faces, KernelError> {
    let cage = opensubdiv::Cage { vertex_count: positions.len(), quads: quads.quads.clone() };
    let patches = opensubdiv::bspline_patches_isolated(&cage, ISOLATION)?;
    let points = Points::new(&patches, positions, flat);
    let whole = whole_patches(&patches, quads.quads.len());
    let around = Neighbours::new(quads, sides);
    let joins = |from: Turned, side: usize, to: Turned| joined(&patches, &whole, from, side, to);
    let free = whole.iter().map(Option::is_some).collect();
    let mut faces: Vec<BsplineFace> =
        rectangles(&around, free, &joins).into_iter().map(|r| points.merged(&patches, &whole, r)).collect();
    for (p, domain) in patches.domains.iter().enumerate() {
        if whole[patches.quads[p] as usize].is_none() {
            faces.push(points.single(&patches, p, domain));
        }
    }
    Ok(Faces { faces, patches: patches.quads.len() })
}

/// The patch of each quad that is one patch.
fn whole_patches(patches: &BsplinePatches, quads: usize) -> Vec<Option<usize>> {
    let mut whole = vec![None; quads];
    for (p, domain) in patches.domains.iter().enumerate() {
        if domain[2] == 1.0 {
            whole[patches.quads[p] as usize] = Some(p);
        }
    }
    whole
}

/// Whether two quads have twelve control points in common, in their places.
fn joined(patches: &BsplinePatches, whole: &[Option<usize>], from: Turned, side: usize, to: Turned) -> bool {
    let points = |t: Turned| Some(t.patch(&patches.control_points[whole[t.quad]?]));
    let (Some(a), Some(b)) = (points(from), points(to)) else { return false };
    (0..4).all(|k| {
        (0..3).all(|l| match side {
            0 => a[4 * l + k] == b[4 * (l + 1) + k],
            1 => a[4 * k + l + 1] == b[4 * k + l],
            2 => a[4 * (l + 1) + k] == b[4 * l + k],
            _ => a[4 * k + l] == b[4 * k + l + 1],
        })
    })
}

/// Control points of the patches, local ones included.
struct Points {
    space: Vec<DVec3>,
    flat: Vec<DVec2>,
}

impl Points {
    fn new(patches: &BsplinePatches, positions: &[DVec3], flat: &[DVec2]) -> Self {
        let local = &patches.local_points;
        let (mut space, mut in_sheet) = (positions.to_vec(), flat.to_vec());
        for w in local.offsets.windows(2) {
            let range = w[0] as usize..w[1] as usize;
            let entries = || range.clone().map(|k| (local.indices[k] as usize, local.weights[k]));
            space.push(entries().map(|(v, w)| w * positions[v]).sum());
            in_sheet.push(entries().map(|(v, w)| w * flat[v]).sum());
        }
        Self { space, flat: in_sheet }
    }

    fn merged(&self, patches: &BsplinePatches, whole: &[Option<usize>], cells: Rectangle) -> BsplineFace {
        let (m, n) = (cells.columns.len(), cells.columns[0].len());
        let mut ids = Vec::new();
        for i in 0..m + 3 {
            for j in 0..n + 3 {
                let (column, row) = (i.min(m - 1), j.min(n - 1));
                let cell = cells.columns[column][row];
                let points = cell.patch(&patches.control_points[whole[cell.quad].unwrap_or(0)]);
                ids.push(points[4 * (j - row) + i - column]);
            }
        }
        let size = (m as u32 * UNIT, n as u32 * UNIT);
        self.face(
            &ids,
            [m + 3, n + 3],
            BsplineFace { step: 1.0, regular: true, cells, size, ..BsplineFace::empty() },
        )
    }

    fn single(&self, patches: &BsplinePatches, p: usize, domain: &[f64; 3]) -> BsplineFace {
        let quad = patches.quads[p] as usize;
        let points = &patches.control_points[p];
        let ids: Vec<u32> = (0..16).map(|k| points[4 * (k % 4) + k / 4]).collect();
        let [s, t, size] = domain.map(|x| (x * f64::from(UNIT)).round() as u32);
        let cells = Rectangle { columns: vec![vec![Turned { quad, turn: 0 }]] };
        let face = BsplineFace {
            step: domain[2],
            cells,
            origin: (s, t),
            size: (size, size),
            ..BsplineFace::empty()
        };
        self.face(&ids, [4, 4], face)
    }

    fn face(&self, ids: &[u32], count: [usize; 2], face: BsplineFace) -> BsplineFace {
        let poles = ids.iter().map(|&k| self.space[k as usize]).collect();
        let flat = ids.iter().map(|&k| self.flat[k as usize]).collect();
        BsplineFace { poles, flat, count, ..face }
    }
}

impl BsplineFace {
    fn empty() -> Self {
        Self {
            poles: Vec::new(),
            flat: Vec::new(),
            count: [0; 2],
            step: 1.0,
            regular: false,
            cells: Rectangle { columns: Vec::new() },
            origin: (0, 0),
            size: (0, 0),
        }
    }

    /// Position, derivatives by both parameters, and the flat point, at parameters in quads.
    pub(crate) fn at(&self, u: f64, v: f64) -> (DVec3, [DVec3; 2], DVec2) {
        let (i, bu, du) = basis(u / self.step, self.count[0]);
        let (j, bv, dv) = basis(v / self.step, self.count[1]);
        let (mut p, mut pu, mut pv, mut flat) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec2::ZERO);
        for k in 0..4 {
            for l in 0..4 {
                let at = (i + k) * self.count[1] + j + l;
                p += bu[k] * bv[l] * self.poles[at];
                pu += du[k] * bv[l] * self.poles[at];
                pv += bu[k] * dv[l] * self.poles[at];
                flat += bu[k] * bv[l] * self.flat[at];
            }
        }
        (p, [pu / self.step, pv / self.step], flat)
    }
}

/// First pole, uniform cubic basis and its derivatives at a parameter in knots.
fn basis(x: f64, count: usize) -> (usize, [f64; 4], [f64; 4]) {
    let i = (x.floor().max(0.0) as usize).min(count - 4);
    let t = x - i as f64;
    let s = 1.0 - t;
    let b = [s * s * s, 3.0 * t * t * t - 6.0 * t * t + 4.0, 3.0 * s * s * s - 6.0 * s * s + 4.0, t * t * t];
    let d = [-0.5 * s * s, 1.5 * t * t - 2.0 * t, -(1.5 * s * s - 2.0 * s), 0.5 * t * t];
    (i, b.map(|x| x / 6.0), d)
}
