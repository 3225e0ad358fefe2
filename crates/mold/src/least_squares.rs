//! Least-squares cubic splines through many curves over one parameter, and the knots that they need.

use crate::skin::basis;
use glam::DVec3;

/// Times that knots are placed anew, each as the error of the ones before asks.
const PLACEMENTS: usize = 10;
/// The error falls with this power of the distance of the knots, as jumps of third derivatives let it.
const ORDER: f64 = 3.0;
/// A distance of knots changes at most by these factors at a time.
const CHANGE: [f64; 2] = [0.7, 1.5];
/// What is aimed at, as share of what is allowed.
const AIM: f64 = 0.93;
/// What a piece takes over of its neighbours' errors: least squares carry them into it.
const CARRIED: f64 = 0.5;

/// Curves side by side: at each parameter a row of places.
pub(crate) struct Stack {
    params: Vec<f64>,
    /// Rows of `columns` places.
    values: Vec<DVec3>,
    columns: usize,
    /// Whether an error there counts.
    counts: Vec<bool>,
}

impl Stack {
    /// Two fields over a lattice (u outer, v inner) as curves along `axis`, those of the first field first.
    pub(crate) fn of(params: &[Vec<f64>; 2], fields: &[Vec<DVec3>; 2], inside: &[bool], axis: usize) -> Self {
        let [rows, across] = [params[axis].len(), params[1 - axis].len()];
        let place = |row: usize, k: usize| if axis == 0 { row * across + k } else { k * rows + row };
        let all = || (0..rows).flat_map(|row| (0..2 * across).map(move |c| (row, c)));
        let values = all().map(|(row, c)| fields[c / across][place(row, c % across)]).collect();
        let counts = all().map(|(row, c)| inside[place(row, c % across)]).collect();
        Self { params: params[axis].clone(), values, columns: 2 * across, counts }
    }

    pub(crate) fn params(&self) -> &[f64] {
        &self.params
    }

    /// Poles of the splines with these knots that are nearest to the curves; none if knots stand too close for the
    /// parameters.
    pub(crate) fn fit(&self, knots: &[f64]) -> Option<Poles> {
        let rows: Vec<(usize, [f64; 4])> = self.params.iter().map(|t| basis(knots, *t)).collect();
        let factor = Banded::normal(&rows, knots.len() + 2)?;
        let mut poles = vec![DVec3::ZERO; (knots.len() + 2) * self.columns];
        for ((first, weights), row) in rows.iter().zip(self.values.chunks(self.columns)) {
            for (k, w) in weights.iter().enumerate() {
                let at = (first + k) * self.columns;
                poles[at..at + self.columns].iter_mut().zip(row).for_each(|(p, v)| *p += *w * *v);
            }
        }
        factor.solve(&mut poles, self.columns);
        Some(Poles { values: poles, columns: self.columns })
    }

    /// At each parameter the largest distance that counts between the curves and their splines.
    fn errors(&self, knots: &[f64]) -> Option<Vec<f64>> {
        let poles = self.fit(knots)?;
        let error = |(i, t): (usize, &f64)| {
            let (first, weights) = basis(knots, *t);
            let off = |c: usize| {
                let at = |k: usize| weights[k] * poles.values[(first + k) * self.columns + c];
                (at(0) + at(1) + at(2) + at(3)).distance_squared(self.values[i * self.columns + c])
            };
            let counted = (0..self.columns).filter(|c| self.counts[i * self.columns + c]);
            counted.map(off).fold(0.0, f64::max).sqrt()
        };
        Some(self.params.iter().enumerate().map(error).collect())
    }
}

/// Poles side by side: for each pole of the splines a row.
pub(crate) struct Poles {
    values: Vec<DVec3>,
    columns: usize,
}

impl Poles {
    /// As curves the other way, over the parameters of the columns: two fields, the first field's columns first.
    pub(crate) fn turned(&self, params: &[f64]) -> Stack {
        let (across, rows) = (params.len(), self.values.len() / self.columns);
        let all = (0..across).flat_map(|j| (0..2 * rows).map(move |c| (j, c)));
        let values: Vec<DVec3> =
            all.map(|(j, c)| self.values[(c % rows) * self.columns + (c / rows) * across + j]).collect();
        Stack { params: params.to_vec(), columns: 2 * rows, counts: vec![true; values.len()], values }
    }

    /// The poles of both fields, the columns outer.
    pub(crate) fn halves(&self) -> [Vec<DVec3>; 2] {
        let (half, rows) = (self.columns / 2, self.values.len() / self.columns);
        [0, 1].map(|field| {
            let all = (0..half).flat_map(|i| (0..rows).map(move |j| (i, j)));
            all.map(|(i, j)| self.values[j * self.columns + field * half + i]).collect()
        })
    }
}

/// Knots over the curves' parameters with which their least-squares splines are within `aim_mm`, as few as were found; the
/// nearest that were found if none are.
pub(crate) fn knots_within(curves: &Stack, aim_mm: f64, [least_mm, most_mm]: [f64; 2]) -> Option<Vec<f64>> {
    let mut density = vec![2.0 / most_mm; curves.params.len()];
    let mut best: Option<(Vec<f64>, f64)> = None;
    for _ in 0..PLACEMENTS {
        let knots = place(&curves.params, &density);
        let errors = curves.errors(&knots)?;
        let worst = errors.iter().copied().fold(0.0, f64::max);
        let better = |b: &(Vec<f64>, f64)| match (worst <= aim_mm, b.1 <= aim_mm) {
            (true, true) => knots.len() < b.0.len(),
            (true, false) => true,
            (false, true) => false,
            (false, false) => worst < b.1,
        };
        density = asked(&curves.params, &knots, &errors, aim_mm);
        density.iter_mut().for_each(|d| *d = d.clamp(1.0 / most_mm, 1.0 / least_mm));
        if best.as_ref().is_none_or(better) {
            best = Some((knots, worst));
        }
    }
    best.map(|b| b.0)
}

/// Knots per mm at each parameter, as the error of each piece asks.
fn asked(params: &[f64], knots: &[f64], errors: &[f64], aim_mm: f64) -> Vec<f64> {
    let mut own = vec![0.0; knots.len() - 1];
    for (t, error) in params.iter().zip(errors) {
        let piece = knots.partition_point(|k| k <= t).clamp(1, own.len()) - 1;
        own[piece] = f64::max(own[piece], *error);
    }
    let neighbour = |i: usize| own.get(i).copied().unwrap_or(0.0);
    let wanted = |i: usize| {
        let carried = CARRIED * neighbour(i.wrapping_sub(1)).max(neighbour(i + 1));
        let factor = (own[i].max(carried) / (AIM * aim_mm)).powf(1.0 / ORDER).clamp(CHANGE[0], CHANGE[1]);
        factor / (knots[i + 1] - knots[i])
    };
    let middles: Vec<f64> = knots.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    let densities: Vec<f64> = (0..own.len()).map(wanted).collect();
    params.iter().map(|t| interpolated(&middles, &densities, *t)).collect()
}

/// Knots at equal shares of the integral of their density.
fn place(params: &[f64], density: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for i in 1..params.len() {
        sums.push(sums[i - 1] + 0.5 * (density[i] + density[i - 1]) * (params[i] - params[i - 1]));
    }
    let whole = sums[sums.len() - 1];
    let pieces = whole.ceil().max(2.0);
    let mut knots: Vec<f64> =
        (0..=pieces as usize).map(|k| interpolated(&sums, params, whole * k as f64 / pieces)).collect();
    let last = knots.len() - 1;
    (knots[0], knots[last]) = (params[0], params[params.len() - 1]);
    knots
}

/// Between the values at ascending places, constant past the ends.
fn interpolated(places: &[f64], values: &[f64], t: f64) -> f64 {
    let next = places.partition_point(|p| *p <= t);
    if next == 0 || next == places.len() {
        return values[next.min(places.len() - 1)];
    }
    let share = (t - places[next - 1]) / (places[next] - places[next - 1]);
    values[next - 1] + share * (values[next] - values[next - 1])
}

/// The Cholesky factor of a matrix with three diagonals below its own, row by row: the fourth entry is the diagonal's.
struct Banded(Vec<[f64; 4]>);

impl Banded {
    /// Of the normal equations of rows with four weights each from a first column on; none if they do not determine all.
    fn normal(rows: &[(usize, [f64; 4])], size: usize) -> Option<Self> {
        let mut band = vec![[0.0; 4]; size];
        for (first, weights) in rows {
            for a in 0..4 {
                for b in 0..=a {
                    band[first + a][3 - (a - b)] += weights[a] * weights[b];
                }
            }
        }
        for i in 0..size {
            for k in 0..4 {
                // Column i + k − 3 of row i, less what the columns before it have in common with that row.
                let Some(column) = (i + k).checked_sub(3) else { continue };
                let mut sum = band[i][k];
                for m in 0..k {
                    let of_column = m + 3 - k;
                    sum -= if (i + m).checked_sub(3).is_some() {
                        band[i][m] * band[column][of_column]
                    } else {
                        0.0
                    };
                }
                band[i][k] = if k < 3 { sum / band[column][3] } else { (sum > 0.0).then(|| sum.sqrt())? };
            }
        }
        Some(Self(band))
    }

    /// Solves for rows of `columns` right-hand sides, in place.
    fn solve(&self, values: &mut [DVec3], columns: usize) {
        let size = self.0.len();
        let less = |values: &mut [DVec3], row: usize, other: usize, by: f64| {
            for c in 0..columns {
                let taken = by * values[other * columns + c];
                values[row * columns + c] -= taken;
            }
        };
        let divide = |values: &mut [DVec3], row: usize| {
            values[row * columns..(row + 1) * columns].iter_mut().for_each(|v| *v /= self.0[row][3]);
        };
        for row in 0..size {
            for k in 3 - row.min(3)..3 {
                less(values, row, row + k - 3, self.0[row][k]);
            }
            divide(values, row);
        }
        for row in (0..size).rev() {
            for below in row + 1..(row + 4).min(size) {
                less(values, row, below, self.0[below][3 - (below - row)]);
            }
            divide(values, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(f: impl Fn(f64) -> DVec3) -> Stack {
        let params: Vec<f64> = (0..=200).map(|k| 0.5 * k as f64).collect();
        let values: Vec<DVec3> = params.iter().flat_map(|t| [f(*t), -f(*t)]).collect();
        Stack { params, counts: vec![true; values.len()], values, columns: 2 }
    }

    #[test]
    fn a_cubic_comes_back_whatever_the_knots() {
        let stack = curve(|t| DVec3::new(t, 1e-3 * t * t, 2e-5 * (t - 40.0).powi(3)));
        let errors = stack.errors(&[0.0, 3.0, 50.0, 52.0, 100.0]).unwrap();
        assert!(errors.iter().all(|e| *e < 1e-10), "{errors:?}");
    }

    #[test]
    fn knots_too_close_for_the_places_are_told() {
        let stack = curve(DVec3::splat);
        assert!(stack.fit(&[0.0, 10.01, 10.02, 10.03, 10.04, 10.05, 100.0]).is_none());
    }

    #[test]
    fn the_residual_of_least_squares_is_normal_to_the_splines() {
        let stack = curve(|t| DVec3::new((0.3 * t).sin(), t, (0.2 * t).cos()));
        let knots = [0.0, 20.0, 35.0, 70.0, 100.0];
        let poles = stack.fit(&knots).unwrap();
        let mut moments = vec![0.0; knots.len() + 2];
        for (i, t) in stack.params.iter().enumerate() {
            let (first, weights) = basis(&knots, *t);
            let at: f64 = (0..4).map(|k| weights[k] * poles.values[(first + k) * 2].x).sum();
            (0..4).for_each(|k| moments[first + k] += weights[k] * (at - stack.values[2 * i].x));
        }
        assert!(moments.iter().all(|m| m.abs() < 1e-11), "{moments:?}");
    }

    #[test]
    fn knots_stand_where_the_curve_bends() {
        let stack = curve(|t| DVec3::new(t, 0.0, 10.0 * ((t - 70.0) / 5.0).tanh()));
        let knots = knots_within(&stack, 1e-3, [1.25, 30.0]).unwrap();
        assert!(stack.errors(&knots).unwrap().iter().all(|e| *e <= 1e-3));
        let near = knots.iter().filter(|k| (**k - 70.0).abs() < 15.0).count();
        assert!(2 * near > knots.len() && knots.len() < 40, "{knots:?}");
    }
}
