//! Quads seen from any of their four sides, and the walk from one to the next.

use super::quads::Quads;

/// A quad whose corner `turn` comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Turned {
    pub(crate) quad: usize,
    pub(crate) turn: usize,
}

/// Beyond each side of each quad: the quad there and which of its sides it is.
pub(crate) struct Neighbours(Vec<[Option<(usize, usize)>; 4]>);

impl Neighbours {
    pub(crate) fn new(quads: &Quads, sides: &super::quads::Sides) -> Self {
        let beyond = |quad: &[u32; 4], k: usize| {
            let (a, b) = (quad[k], quad[(k + 1) % 4]);
            let &other = sides.get(&[b, a])?;
            Some((other, quads.quads[other].iter().position(|v| *v == b)?))
        };
        Self(quads.quads.iter().map(|q| [0, 1, 2, 3].map(|k| beyond(q, k))).collect())
    }

    /// Beyond a side: 0 below, 1 at the right, 2 above, 3 at the left; turned the same way.
    pub(crate) fn step(&self, from: Turned, side: usize) -> Option<Turned> {
        let (quad, entry) = self.0[from.quad][(side + from.turn) % 4]?;
        Some(Turned { quad, turn: (entry + 8 - side - 2) % 4 })
    }
}

impl Turned {
    /// A point of the turned square in the quad's own coordinates; both run to `unit`.
    pub(crate) fn own(self, (mut x, mut y): (u32, u32), unit: u32) -> (u32, u32) {
        for _ in 0..self.turn {
            (x, y) = (unit - y, x);
        }
        (x, y)
    }

    /// Control points of a patch, rows by t, as the turned square has them.
    pub(crate) fn patch(self, points: &[u32; 16]) -> [u32; 16] {
        let mut points = *points;
        for _ in 0..self.turn {
            let before = points;
            (0..16).for_each(|k| points[k] = before[4 * (k % 4) + 3 - k / 4]);
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn steps_there_and_back_end_where_they_began() {
        let points = (0..6).map(|k| DVec2::new(f64::from(k % 3), f64::from(k / 3))).collect();
        let quads = Quads { points, quads: vec![[0, 1, 4, 3], [5, 4, 1, 2]] };
        let around = Neighbours::new(&quads, &quads.sides().unwrap());
        for turn in 0..4 {
            let from = Turned { quad: 0, turn };
            let steps: Vec<_> = (0..4).filter_map(|side| Some((side, around.step(from, side)?))).collect();
            assert_eq!(steps.len(), 1);
            let (side, there) = steps[0];
            assert_eq!(there.quad, 1);
            assert_eq!(around.step(there, (side + 2) % 4), Some(from));
        }
    }

    #[test]
    fn a_turned_patch_begins_with_its_first_corner() {
        let points: [u32; 16] = std::array::from_fn(|k| k as u32);
        let first = |turn| Turned { quad: 0, turn }.patch(&points)[0];
        assert_eq!([0, 1, 2, 3].map(first), [0, 3, 15, 12]);
        let corner = |turn| Turned { quad: 0, turn }.own((0, 0), 8);
        assert_eq!([0, 1, 2, 3].map(corner), [(0, 0), (8, 0), (8, 8), (0, 8)]);
    }
}
