//! What vertices of the flat cage slide on: outline and holes, and fold lines.

use super::background::Background;
use super::quads::Quads;
use glam::DVec2;
use softfold_geometry::{PlanarCurve, polygon};
use std::f64::consts::PI;

/// Turn of the outline from which on it has a corner that a vertex of the cage stands in, rad.
const CORNER_RAD: f64 = 20.0 * PI / 180.0;
/// Share of the cell within which a vertex counts as on a fold line: what the solution of the map leaves.
const ON_LINE: f64 = 0.02;
/// Step along a joint on which the directions before and after it are read, share of the curve.
const BESIDE: f64 = 1e-7;

/// A polyline with its arc lengths.
#[derive(Clone, Debug)]
pub(crate) struct Rail {
    points: Vec<DVec2>,
    s_mm: Vec<f64>,
    closed: bool,
}

/// How a vertex may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hold {
    /// As it likes.
    Free,
    /// Not at all.
    Fixed,
    /// Along a rail, now at this arc length.
    On {
        /// Which rail.
        rail: usize,
        /// Arc length, mm.
        s_mm: f64,
    },
}

impl Rail {
    /// A polyline; of a closed one the first point is not repeated.
    pub(crate) fn new(mut points: Vec<DVec2>, closed: bool) -> Self {
        if closed && let Some(&first) = points.first() {
            points.push(first);
        }
        let mut s_mm = vec![0.0];
        for w in points.windows(2) {
            s_mm.push(s_mm[s_mm.len() - 1] + w[0].distance(w[1]));
        }
        Self { points, s_mm, closed }
    }

    fn length_mm(&self) -> f64 {
        self.s_mm[self.s_mm.len() - 1]
    }

    pub(crate) fn at(&self, s_mm: f64) -> DVec2 {
        let s = match self.closed {
            true => s_mm.rem_euclid(self.length_mm()),
            false => s_mm.clamp(0.0, self.length_mm()),
        };
        let i = self.s_mm.partition_point(|l| *l <= s).clamp(1, self.points.len() - 1) - 1;
        let t = (s - self.s_mm[i]) / (self.s_mm[i + 1] - self.s_mm[i]).max(f64::MIN_POSITIVE);
        self.points[i].lerp(self.points[i + 1], t.clamp(0.0, 1.0))
    }

    /// Arc length of the nearest point, and its distance.
    pub(crate) fn nearest(&self, p: DVec2) -> (f64, f64) {
        let mut best = (0.0, f64::INFINITY);
        for (i, w) in self.points.windows(2).enumerate() {
            let distance = polygon::segment_distance(p, w[0], w[1]);
            if distance < best.1 {
                let d = w[1] - w[0];
                let t = ((p - w[0]).dot(d) / d.length_squared()).clamp(0.0, 1.0);
                best = (self.s_mm[i] + t * (self.s_mm[i + 1] - self.s_mm[i]), distance);
            }
        }
        best
    }
}

/// A corner of the outline or a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SheetCorner {
    pub(crate) at: DVec2,
    /// Inner angle, rad.
    pub(crate) angle_rad: f64,
}

/// Corners of all loops.
pub(crate) fn corners(loops: &[PlanarCurve]) -> Vec<SheetCorner> {
    let of_loop = |curve: &PlanarCurve| {
        let length = curve.length_mm();
        let joints = curve.joints_mm();
        let corner = |&s: &f64| {
            let turn = curve.tangent(s - BESIDE * length).angle_to(curve.tangent(s + BESIDE * length));
            (turn.abs() > CORNER_RAD).then(|| SheetCorner { at: curve.point(s), angle_rad: PI - turn })
        };
        joints[..joints.len() - 1].iter().filter_map(corner).collect::<Vec<_>>()
    };
    loops.iter().flat_map(of_loop).collect()
}

/// Rails and the holds of all vertices.
pub(crate) struct Rails {
    pub(crate) rails: Vec<Rail>,
    pub(crate) holds: Vec<Hold>,
}

impl Rails {
    /// Border vertices slide on their loop, those at its corners stay; vertices on fold lines slide on them.
    pub(crate) fn new(
        ground: &Background<'_>,
        quads: &mut Quads,
        borders: &[Vec<u32>],
        cell_mm: f64,
    ) -> Self {
        let loops = &ground.soft.loops;
        let chord_mm = ground.soft.tolerance.chord_mm;
        let mut rails: Vec<Rail> = loops.iter().map(|c| Rail::new(c.flatten(chord_mm), true)).collect();
        let mut holds = vec![Hold::Free; quads.points.len()];
        for border in borders {
            let middle =
                |r: &Rail| border.iter().map(|&v| r.nearest(quads.points[v as usize]).1).sum::<f64>();
            let rail = (0..loops.len()).min_by(|&a, &b| middle(&rails[a]).total_cmp(&middle(&rails[b])));
            let Some(rail) = rail else { continue };
            for &v in border {
                let s_mm = rails[rail].nearest(quads.points[v as usize]).0;
                holds[v as usize] = Hold::On { rail, s_mm };
            }
        }
        let lines = lines(ground);
        let on_line = ON_LINE * cell_mm;
        for (v, hold) in holds.iter_mut().enumerate() {
            let near = lines.iter().enumerate().map(|(k, l)| (k, l.nearest(quads.points[v])));
            let near = near.filter(|n| n.1.1 <= on_line).min_by(|a, b| a.1.1.total_cmp(&b.1.1));
            let Some((k, (s_mm, _))) = near else { continue };
            *hold = match hold {
                Hold::Free => Hold::On { rail: loops.len() + k, s_mm },
                // A line ends here on the border.
                _ => Hold::Fixed,
            };
        }
        rails.extend(lines);
        let mut made = Self { rails, holds };
        made.snap(quads, borders, &corners(loops));
        made
    }

    /// The border vertex nearest to each corner of the sheet goes there and stays.
    fn snap(&mut self, quads: &mut Quads, borders: &[Vec<u32>], corners: &[SheetCorner]) {
        let mut count = vec![0_usize; quads.points.len()];
        quads.quads.as_flattened().iter().for_each(|&v| count[v as usize] += 1);
        for corner in corners {
            let distance = |v: &u32| quads.points[*v as usize].distance(corner.at);
            let nearest =
                borders.iter().flatten().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            if let Some(v) = nearest {
                quads.points[v as usize] = corner.at;
                self.holds[v as usize] = Hold::Fixed;
            }
        }
    }
}

/// Fold lines along the mesh.
fn lines(ground: &Background<'_>) -> Vec<Rail> {
    let points = |c: &super::background::Chain| c.vertices.iter().map(|&v| ground.mesh.vertices[v]).collect();
    ground.chains.iter().map(|c| Rail::new(points(c), c.closed)).collect()
}
