//! Starts of an alignment: principal axes on principal axes, every way that is a rotation, and more where axes are vague.

use super::body;
use super::rigid;
use softfold_geometry::{DMat3, DVec3, RigidTransform, TriMesh};

/// Axes whose second moments are nearer to each other than this ratio may be swapped or turned: a part of a sheet has
/// other axes than the whole, and a square sheet has none of its own.
const VAGUE: f64 = 0.5;
/// Turns about the axis of a vague pair, degrees; half turns are there anyway.
const TURNS_DEG: [f64; 6] = [0.0, 30.0, 60.0, 90.0, 120.0, 150.0];
/// Sizes that differ by less than this share leave no room to shift.
const ROOM: f64 = 0.1;
/// Shifts of the barycenter along the two longest axes, share of the size: a part with something else beside it has neither
/// the barycenter nor the box of a part.
const AWAY: f64 = 0.25;

/// What a mesh looks like from afar.
struct Frame {
    /// Principal axes, the longest first.
    axes: DMat3,
    /// Second moments along them.
    moments: [f64; 3],
    /// Middle of the box along the axes, in space.
    middle: DVec3,
    /// Size of that box.
    size: DVec3,
    /// Barycenter.
    center: DVec3,
}

impl Frame {
    fn of(mesh: &TriMesh) -> Self {
        let (_, center, second) = body::moments(mesh);
        let (moments, axes) = rigid::principal(second).unwrap_or(([1.0; 3], DMat3::IDENTITY));
        let inside = |p: &DVec3| axes.transpose() * *p;
        let ends = mesh.positions.iter().map(inside);
        let (low, high) = ends.fold((DVec3::MAX, DVec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
        Self { axes, moments, middle: axes * (0.5 * (low + high)), size: high - low, center }
    }
}

/// Poses that bring `moving` roughly onto `fixed`, the plainest first.
pub(super) fn starts(moving: &TriMesh, fixed: &TriMesh) -> Vec<RigidTransform> {
    let (from, to) = (Frame::of(moving), Frame::of(fixed));
    let (away, room) = (away(&to), shifts(&from, &to));
    let mut poses = Vec::new();
    for turn in turns(&from, &to) {
        let rotation = to.axes * turn * from.axes.transpose();
        let [center, middle] = [to.center - rotation * from.center, to.middle - rotation * from.middle];
        let shifted =
            |to_there: DVec3, s: &DVec3| RigidTransform { rotation, translation: to_there + to.axes * *s };
        poses.extend(away.iter().map(|s| shifted(center, s)));
        poses.extend(room.iter().map(|s| shifted(middle, s)));
    }
    poses
}

/// Rotations of the axes: the four that keep each on its own; with one vague pair also those turned about the third; all
/// that map axes to axes and some between where no axis is clear.
fn turns(from: &Frame, to: &Frame) -> Vec<DMat3> {
    let vague = |k: usize| [from, to].iter().any(|f| f.moments[k + 1] > VAGUE * f.moments[k]);
    let turned = |turns: &[DMat3], axis: DVec3, angles: &[f64]| -> Vec<DMat3> {
        let by = |deg: &f64| DMat3::from_axis_angle(axis, deg.to_radians());
        angles.iter().flat_map(|d| turns.iter().map(move |t| by(d) * *t)).collect()
    };
    let all = signed_permutations();
    match [vague(0), vague(1)] {
        [false, false] => all[..4].to_vec(),
        [true, false] => turned(&all[..4], DVec3::Z, &TURNS_DEG),
        [false, true] => turned(&all[..4], DVec3::X, &TURNS_DEG),
        // Right angles are there already.
        [true, true] => turned(&turned(&all, DVec3::Z, &TURNS_DEG[..3]), DVec3::X, &TURNS_DEG[..3]),
    }
}

/// The 24 rotations that map axes to axes; those that keep each axis on itself first.
fn signed_permutations() -> Vec<DMat3> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
    let axis = [DVec3::X, DVec3::Y, DVec3::Z];
    let signed = |order: [usize; 3], signs: u32| {
        let column = |k: usize| if signs >> k & 1 == 0 { axis[order[k]] } else { -axis[order[k]] };
        DMat3::from_cols(column(0), column(1), column(2))
    };
    let all = ORDERS.iter().flat_map(|o| (0..8).map(move |s| (*o, s))).map(|(o, s)| signed(o, s));
    all.filter(|m| m.determinant() > 0.0).collect()
}

/// Shifts of the barycenter along the two longest axes: none first.
fn away(to: &Frame) -> Vec<DVec3> {
    let [x, y] = [0, 1].map(|k| AWAY * to.size[k]);
    vec![DVec3::ZERO, x * DVec3::X, -x * DVec3::X, y * DVec3::Y, -y * DVec3::Y]
}

/// Shifts of the boxes' middles along the axes of `to`: none, and both ends of the room along every axis that has some.
fn shifts(from: &Frame, to: &Frame) -> Vec<DVec3> {
    let room = |k: usize| {
        let room = 0.5 * (to.size[k] - from.size[k]);
        if room.abs() > ROOM * to.size[k] { vec![0.0, room, -room] } else { vec![0.0] }
    };
    let [x, y, z] = [0, 1, 2].map(room);
    x.iter()
        .flat_map(|x| y.iter().map(move |y| (x, y)))
        .flat_map(|(x, y)| z.iter().map(move |z| DVec3::new(*x, *y, *z)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_24_rotations_of_the_cube_and_the_identity_is_first() {
        let all = signed_permutations();
        assert_eq!(all.len(), 24);
        assert_eq!(all[0], DMat3::IDENTITY);
        assert!((1..24).all(|i| (0..i).all(|j| all[i] != all[j])));
    }

    #[test]
    fn a_clear_body_has_few_starts_and_a_vague_one_more() {
        let box_of = |size: DVec3| {
            let corners =
                (0..8).map(|k| size * DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64));
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
            TriMesh { positions: corners.collect(), triangles }
        };
        let clear = box_of(DVec3::new(100.0, 40.0, 10.0));
        assert_eq!(starts(&clear, &clear).len(), 4 * 6);
        let cube = box_of(DVec3::splat(10.0));
        assert_eq!(starts(&cube, &cube).len(), 24 * 9 * 6);
        // A part of it has room along the length.
        let part = box_of(DVec3::new(60.0, 40.0, 10.0));
        assert!(starts(&part, &clear).len() > starts(&clear, &clear).len());
    }
}
