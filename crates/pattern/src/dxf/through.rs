//! The cubic spline through given points: C2, parametrised by chord length, as CAD programs draw it.

use super::curve::{Chain, Piece};
use glam::DVec3;

/// The curve through the points: with the given directions at its ends, else without curvature there; closed
/// curves are smooth all round. Points that repeat the one before count once; a single one gives no curve.
pub(super) fn curve(points: &[DVec3], directions: [Option<DVec3>; 2], closed: bool) -> Chain {
    let mut points = points.to_vec();
    points.dedup();
    if closed && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    if points.len() < 2 {
        return Chain::new();
    }
    // A loop of two points has no smooth curve but the line there and back.
    let round = closed && points.len() > 3;
    let steps: Vec<f64> = points.windows(2).map(|w| w[0].distance(w[1])).collect();
    let slopes = if round { slopes_round(&points, &steps) } else { slopes_open(&points, &steps, directions) };
    let cubic = |i: usize| {
        let third = steps[i] / 3.0;
        let [a, b] = [points[i], points[i + 1]];
        Piece::Cubic([a, a + slopes[i] * third, b - slopes[i + 1] * third, b])
    };
    (0..steps.len()).map(cubic).collect()
}

/// One row of a tridiagonal system for the slopes: factors of the one before, its own, the one after; right side.
struct Row {
    before: f64,
    own: f64,
    after: f64,
    right: DVec3,
}

/// The second derivative is steady where two pieces meet.
fn steady([a, b, c]: [DVec3; 3], [before, after]: [f64; 2]) -> Row {
    let right = 3.0 * ((b - a) / (before * before) + (c - b) / (after * after));
    Row { before: 1.0 / before, own: 2.0 * (1.0 / before + 1.0 / after), after: 1.0 / after, right }
}

fn slopes_open(points: &[DVec3], steps: &[f64], directions: [Option<DVec3>; 2]) -> Vec<DVec3> {
    let last = steps.len();
    let end = |direction: Option<DVec3>, step: usize| match direction.and_then(DVec3::try_normalize) {
        Some(direction) => Row { before: 0.0, own: 1.0, after: 0.0, right: direction },
        None => {
            let slope = (points[step + 1] - points[step]) / steps[step];
            Row { before: 1.0, own: 2.0, after: 1.0, right: 3.0 * slope }
        }
    };
    let mut rows = vec![end(directions[0], 0)];
    let inner = 1..last;
    rows.extend(inner.map(|i| steady([points[i - 1], points[i], points[i + 1]], [steps[i - 1], steps[i]])));
    rows.push(end(directions[1], last - 1));
    solve(&rows)
}

/// Slopes of a closed curve (first point repeated at the end): a cyclic system, by two solutions of the open one
/// (Sherman and Morrison).
fn slopes_round(points: &[DVec3], steps: &[f64]) -> Vec<DVec3> {
    let n = steps.len();
    let mut rows: Vec<Row> = (0..n)
        .map(|i| {
            let before = (i + n - 1) % n;
            steady([points[before], points[i], points[i + 1]], [steps[before], steps[i]])
        })
        .collect();
    // The corner that joins first and last: it is the same at both places.
    let corner = rows[0].before;
    let shift = rows[0].own;
    rows[0].own += shift;
    rows[n - 1].own += corner * corner / shift;
    let plain = solve(&rows);
    for (i, row) in rows.iter_mut().enumerate() {
        row.right = match i {
            0 => DVec3::splat(-shift),
            i if i == n - 1 => DVec3::splat(corner),
            _ => DVec3::ZERO,
        };
    }
    let wave: Vec<f64> = solve(&rows).iter().map(|w| w.x).collect();
    let ratio = -corner / shift;
    let factor = (plain[0] + ratio * plain[n - 1]) / (1.0 + wave[0] + ratio * wave[n - 1]);
    let mut slopes: Vec<DVec3> = plain.iter().zip(&wave).map(|(p, w)| *p - factor * *w).collect();
    slopes.push(slopes[0]);
    slopes
}

/// Thomas' scheme; the rows are diagonally dominant.
fn solve(rows: &[Row]) -> Vec<DVec3> {
    let mut swept: Vec<(f64, DVec3)> = Vec::with_capacity(rows.len());
    for row in rows {
        let (after, right) = swept.last().copied().unwrap_or_default();
        let own = row.own - row.before * after;
        swept.push((row.after / own, (row.right - row.before * right) / own));
    }
    let mut solution: Vec<DVec3> = Vec::with_capacity(rows.len());
    for (after, right) in swept.iter().rev() {
        let next = solution.last().copied().unwrap_or_default();
        solution.push(*right - *after * next);
    }
    solution.reverse();
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> DVec3 {
        DVec3::new(x, y, 0.0)
    }

    /// First and second derivative by chord length at start and end of a piece.
    fn derivatives(piece: &Piece) -> [[DVec3; 2]; 2] {
        let Piece::Cubic([a, b, c, d]) = *piece else { panic!("cubic") };
        let h = a.distance(d);
        let second = |p: DVec3, q: DVec3, r: DVec3| 6.0 * (p - 2.0 * q + r) / (h * h);
        [[3.0 * (b - a) / h, second(a, b, c)], [3.0 * (d - c) / h, second(b, c, d)]]
    }

    fn assert_smooth(before: &Piece, after: &Piece) {
        let [[_, end], [start, _]] = [derivatives(before), derivatives(after)];
        assert!(end[0].distance(start[0]) < 1e-12 && end[1].distance(start[1]) < 1e-12);
    }

    #[test]
    fn an_open_curve_is_smooth_and_straight_at_its_ends() {
        let points = [(0., 0.), (1., 2.), (4., 3.), (4., 3.), (5., -1.), (9., 0.)].map(|(x, y)| point(x, y));
        let chain = curve(&points, [None, None], false);
        assert_eq!(chain.len(), 4, "a repeated point counts once");
        chain.windows(2).for_each(|w| assert_smooth(&w[0], &w[1]));
        assert!(derivatives(&chain[0])[0][1].length() < 1e-12);
        assert!(derivatives(&chain[3])[1][1].length() < 1e-12);
        for (piece, at) in chain.iter().zip([points[0], points[1], points[2], points[4]]) {
            assert_eq!(piece.points()[0], at);
        }
    }

    #[test]
    fn directions_at_the_ends_are_kept() {
        let points = [(0., 0.), (1., 2.), (4., 3.)].map(|(x, y)| point(x, y));
        let chain = curve(&points, [Some(DVec3::X * 7.0), Some(DVec3::NEG_Y)], false);
        assert!(derivatives(&chain[0])[0][0].distance(DVec3::X) < 1e-12);
        assert!(derivatives(&chain[1])[1][0].distance(DVec3::NEG_Y) < 1e-12);
        assert_smooth(&chain[0], &chain[1]);
    }

    #[test]
    fn a_closed_curve_is_smooth_all_round_and_near_the_circle_of_its_points() {
        let on =
            |k: usize| DVec3::from((glam::DVec2::from_angle(k as f64 * std::f64::consts::TAU / 16.0), 0.0));
        let points: Vec<DVec3> = (0..16).map(on).collect();
        let chain = curve(&points, [None, None], true);
        assert_eq!(chain.len(), 16);
        (0..16).for_each(|i| assert_smooth(&chain[i], &chain[(i + 1) % 16]));
        for piece in &chain {
            let Piece::Cubic([a, b, c, d]) = *piece else { panic!("cubic") };
            let middle = (a + 3.0 * b + 3.0 * c + d) / 8.0;
            assert!((middle.length() - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn few_points_give_lines_or_nothing() {
        assert!(curve(&[], [None, None], true).is_empty());
        assert!(curve(&[DVec3::X, DVec3::X], [None, None], false).is_empty());
        let line = curve(&[DVec3::ZERO, DVec3::X], [None, None], false);
        let Piece::Cubic([_, b, c, _]) = line[0] else { panic!("cubic") };
        assert!(b.distance(DVec3::X / 3.0) < 1e-15 && c.distance(DVec3::X * (2.0 / 3.0)) < 1e-15);
        assert_eq!(curve(&[DVec3::ZERO, DVec3::X], [None, None], true).len(), 2, "there and back");
    }
}
