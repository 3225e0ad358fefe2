//! Rectangles of regular quads: the large faces of the surface.

use super::turned::{Neighbours, Turned};

/// Starts that are tried for the next rectangle.
const STARTS: usize = 48;

/// `columns[i][j]`: i to the right, j up, all turned the same way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rectangle {
    pub(crate) columns: Vec<Vec<Turned>>,
}

/// Cuts the quads with `free` into rectangles, the largest found first; `joins` tells whether the patch of a quad goes
/// on over its side into the next.
pub(crate) fn rectangles(
    around: &Neighbours,
    mut free: Vec<bool>,
    joins: &dyn Fn(Turned, usize, Turned) -> bool,
) -> Vec<Rectangle> {
    let mut found = Vec::new();
    loop {
        let open: Vec<usize> = (0..free.len()).filter(|q| free[*q]).collect();
        let stride = open.len().div_ceil(STARTS).max(1);
        let grown = open.iter().step_by(stride).map(|&q| grow(around, &free, joins, q));
        let size = |r: &Rectangle| r.columns.len() * r.columns[0].len();
        // The first of the largest.
        let Some(best) = grown.reduce(|a, b| if size(&b) > size(&a) { b } else { a }) else { return found };
        best.columns.iter().flatten().for_each(|t| free[t.quad] = false);
        found.push(best);
    }
}

fn grow(
    around: &Neighbours,
    free: &[bool],
    joins: &dyn Fn(Turned, usize, Turned) -> bool,
    start: usize,
) -> Rectangle {
    let mut own = Rectangle { columns: vec![vec![Turned { quad: start, turn: 0 }]] };
    let mut open = [true; 4];
    while open.contains(&true) {
        for side in 0..4 {
            if open[side] {
                match next_row(around, free, joins, &own, side) {
                    Some(row) => own.add(side, row),
                    None => open[side] = false,
                }
            }
        }
    }
    own
}

/// The quads beyond a side, if all of them are free and join, and the rectangle does not come round to itself.
fn next_row(
    around: &Neighbours,
    free: &[bool],
    joins: &dyn Fn(Turned, usize, Turned) -> bool,
    own: &Rectangle,
    side: usize,
) -> Option<Vec<Turned>> {
    let edge = own.edge(side);
    let row: Vec<Turned> = edge
        .iter()
        .map(|&from| around.step(from, side).filter(|&to| free[to.quad] && joins(from, side, to)))
        .collect::<Option<_>>()?;
    let along = (side + 1) % 4;
    let along = if along == 3 || along == 0 { (along + 2) % 4 } else { along };
    let in_row = row.windows(2).all(|w| around.step(w[0], along) == Some(w[1]) && joins(w[0], along, w[1]));
    let is_own = |t: Turned| {
        own.columns.iter().flatten().any(|o| o.quad == t.quad) || row.iter().any(|o| o.quad == t.quad)
    };
    let comes_round = row.iter().any(|&t| {
        around.step(t, side).is_some_and(is_own) || own.columns.iter().flatten().any(|o| o.quad == t.quad)
    });
    let distinct = (1..row.len()).all(|i| row[..i].iter().all(|t| t.quad != row[i].quad));
    (in_row && distinct && !comes_round).then_some(row)
}

impl Rectangle {
    /// The quads at a side, from left to right or upwards.
    fn edge(&self, side: usize) -> Vec<Turned> {
        let last = self.columns.len() - 1;
        let top = self.columns[0].len() - 1;
        match side {
            0 => self.columns.iter().map(|c| c[0]).collect(),
            1 => self.columns[last].clone(),
            2 => self.columns.iter().map(|c| c[top]).collect(),
            _ => self.columns[0].clone(),
        }
    }

    fn add(&mut self, side: usize, row: Vec<Turned>) {
        match side {
            0 => self.columns.iter_mut().zip(row).for_each(|(c, t)| c.insert(0, t)),
            1 => self.columns.push(row),
            2 => self.columns.iter_mut().zip(row).for_each(|(c, t)| c.push(t)),
            _ => self.columns.insert(0, row),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::quads::Quads;
    use super::*;
    use glam::DVec2;

    #[test]
    fn a_grid_with_a_missing_corner_is_two_rectangles() {
        let points = (0..16).map(|k| DVec2::new(f64::from(k % 4), f64::from(k / 4))).collect();
        let quad = |k: u32| {
            let (i, j) = (k % 3, k / 3);
            let a = 4 * j + i;
            [a, a + 1, a + 5, a + 4]
        };
        let quads = Quads { points, quads: (0..8).map(quad).collect() };
        let around = Neighbours::new(&quads, &quads.sides().unwrap());
        let found = rectangles(&around, vec![true; 8], &|_, _, _| true);
        let sizes: Vec<_> = found.iter().map(|r| (r.columns.len(), r.columns[0].len())).collect();
        assert_eq!(sizes.iter().map(|s| s.0 * s.1).collect::<Vec<_>>(), [6, 2], "{sizes:?}");
    }
}
