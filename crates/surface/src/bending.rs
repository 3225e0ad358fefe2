//! The smoothing term: an energy of the poles.

use crate::poles::Poles;
use crate::system::Symmetric;
use std::collections::BTreeSet;

/// What a surface is smooth by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Smoothness {
    /// `∫ |S_uu|² + 2 |S_uv|² + |S_vv|²`, a pure number: a thin plate's energy. Only surfaces affine in (u, v) have none.
    Curvature,
    /// `∫ |S_uuu|² + 3 |S_uuv|² + 3 |S_uvv|² + |S_vvv|²`, 1/mm²: that of the change of curvature. Quadratic surfaces have none, so
    /// that between vertices far apart, and at the edges of the data, the surface stays as curved as it is.
    ChangeOfCurvature,
}

/// A product of differences: along u of the first order, along v of the second, and how often it counts.
type Term = ([usize; 2], f64);

impl Smoothness {
    fn terms(self) -> &'static [Term] {
        match self {
            Self::Curvature => &[([2, 0], 1.0), ([0, 2], 1.0), ([1, 1], 2.0)],
            Self::ChangeOfCurvature => &[([3, 0], 1.0), ([0, 3], 1.0), ([2, 1], 3.0), ([1, 2], 3.0)],
        }
    }

    /// Power of a length that makes it comparable to an area times a squared distance.
    pub(crate) fn power(self) -> i32 {
        2 * self.order() as i32
    }

    fn order(self) -> usize {
        match self {
            Self::Curvature => 2,
            Self::ChangeOfCurvature => 3,
        }
    }
}

/// Alternating binomials: the difference of an order.
const DIFFERENCES: [&[f64]; 4] = [&[1.0], &[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]];

/// The energy over the lattices of all faces, by differences of the poles: one term for each place where the poles of a
/// difference are there, each with the area of a cell.
///
/// Past the data the poles go on as the data ends. There are no terms across the border, so nothing is asked of the surface
/// there (a free edge).
pub(crate) fn bending(poles: &Poles, spacing_mm: f64, smoothness: Smoothness) -> Symmetric {
    let mut sum = Symmetric::zero(poles.count);
    // What faces share has its terms once.
    let mut seen = poles.are_shared().then(BTreeSet::new);
    // Derivative = difference / hⁿ, area of a cell = h².
    let weight = spacing_mm.powi(2 - smoothness.power());
    for face in 0..poles.faces() {
        let [nu, nv] = poles.count_of(face);
        for &([du, dv], share) in smoothness.terms() {
            for (i, j) in
                (0..nu.saturating_sub(du)).flat_map(|i| (0..nv.saturating_sub(dv)).map(move |j| (i, j)))
            {
                let row = difference(poles, face, [i, j], [du, dv]);
                let names = || row.iter().map(|r| r.0).collect::<Vec<u32>>();
                if seen.as_mut().is_none_or(|seen| seen.insert(names())) {
                    sum.add_row(&row, share * weight);
                }
            }
        }
    }
    sum
}

fn difference(poles: &Poles, face: usize, [i, j]: [usize; 2], [du, dv]: [usize; 2]) -> Vec<(u32, f64)> {
    let along = |k: usize| DIFFERENCES[dv].iter().enumerate().map(move |(l, b)| (k, l, *b));
    let all =
        DIFFERENCES[du].iter().enumerate().flat_map(|(k, a)| along(k).map(move |(k, l, b)| (k, l, a * b)));
    all.map(|(k, l, w)| (poles.unknown(face, i + k, j + l), w)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Lattice;
    use crate::layout::Layout;
    use crate::testing::rectangle;
    use glam::{DVec2, DVec3};

    fn energy(f: impl Fn(DVec2) -> DVec3, smoothness: Smoothness) -> DVec3 {
        let lattice = Lattice { origin: DVec2::new(-3.0, 1.0), spacing_mm: 0.5, count: [9, 7] };
        let at = |k: usize| lattice.origin + 0.5 * DVec2::new((k / 7) as f64, (k % 7) as f64);
        let poles: Vec<_> = (0..63).map(|k| f(at(k))).collect();
        let layout = Layout::new(&rectangle(DVec2::ONE), &[]).unwrap();
        bending(&Poles::new(lattice, &layout, 1), lattice.spacing_mm, smoothness).quadratic(&poles)
    }

    #[test]
    fn affine_surfaces_are_free_and_quadratic_ones_of_the_change_of_curvature() {
        let affine = |p: DVec2| DVec3::new(p.x, 2.0 * p.y + 5.0, 3.0 * p.x - p.y);
        assert!(energy(affine, Smoothness::Curvature).abs().max_element() < 1e-10);
        let quadratic = |p: DVec2| DVec3::new(p.x * p.x, p.x * p.y, p.y * p.y);
        assert!(energy(quadratic, Smoothness::Curvature).min_element() > 1.0);
        assert!(energy(quadratic, Smoothness::ChangeOfCurvature).abs().max_element() < 1e-8);
    }

    #[test]
    fn change_of_curvature_is_the_integral_of_squared_third_derivatives() {
        let e = energy(
            |p| DVec3::new(p.x.powi(3) / 6.0, p.x * p.x * p.y / 2.0, p.y.powi(3) / 6.0),
            Smoothness::ChangeOfCurvature,
        );
        // Places along u less the order, times those along v, each with an area of h² = 1/4; the mixed term three times.
        let wanted = DVec3::new(6.0 * 7.0, 3.0 * 7.0 * 6.0, 9.0 * 4.0) / 4.0;
        assert!(e.distance(wanted) < 1e-8, "{e} {wanted}");
    }

    #[test]
    fn it_is_the_integral_of_squared_second_derivatives() {
        // One term per inner knot, or per square for the twist, each with an area of h² = 1/4.
        let e = energy(|p| DVec3::new(0.5 * p.x * p.x, 0.5 * p.y * p.y, p.x * p.y), Smoothness::Curvature);
        let wanted = DVec3::new(7.0 * 7.0, 9.0 * 5.0, 2.0 * 8.0 * 6.0) / 4.0;
        assert!(e.distance(wanted) < 1e-9, "{e} {wanted}");
    }
}
