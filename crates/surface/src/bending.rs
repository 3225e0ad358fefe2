//! The smoothing term: a thin plate's energy of the poles.

use crate::lattice::Lattice;
use crate::system::Symmetric;

/// `∫ |S_uu|² + 2 |S_uv|² + |S_vv|²` over the lattice, a pure number, by second differences of the poles: one
/// term per pole with both neighbours, one per square of four.
///
/// Only surfaces affine in (u, v) have none: a flat sheet is not biased, and past the data the poles go on straight.
/// There are no terms across the border, so nothing is asked of the surface there (a free edge).
pub(crate) fn bending(lattice: &Lattice) -> Symmetric {
    let [nu, nv] = lattice.count;
    let mut sum = Symmetric::zero(lattice);
    // Second derivative = difference / h², area of a cell = h².
    let weight = lattice.spacing_mm.powi(-2);
    let at = |i: usize, j: usize| (i * nv + j) as u32;
    for i in 0..nu {
        for j in 0..nv {
            if i + 2 < nu {
                sum.add_row(&[(at(i, j), 1.0), (at(i + 1, j), -2.0), (at(i + 2, j), 1.0)], weight);
            }
            if j + 2 < nv {
                sum.add_row(&[(at(i, j), 1.0), (at(i, j + 1), -2.0), (at(i, j + 2), 1.0)], weight);
            }
            if i + 1 < nu && j + 1 < nv {
                let twist =
                    [(at(i, j), 1.0), (at(i, j + 1), -1.0), (at(i + 1, j), -1.0), (at(i + 1, j + 1), 1.0)];
                sum.add_row(&twist, 2.0 * weight);
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};

    fn energy(f: impl Fn(DVec2) -> DVec3) -> DVec3 {
        let lattice = Lattice { origin: DVec2::new(-3.0, 1.0), spacing_mm: 0.5, count: [9, 7] };
        let at = |k: usize| lattice.origin + 0.5 * DVec2::new((k / 7) as f64, (k % 7) as f64);
        let poles: Vec<_> = (0..63).map(|k| f(at(k))).collect();
        bending(&lattice).quadratic(&poles)
    }

    #[test]
    fn only_affine_surfaces_are_free() {
        assert!(energy(|p| DVec3::new(p.x, 2.0 * p.y + 5.0, 3.0 * p.x - p.y)).abs().max_element() < 1e-10);
        assert!(energy(|p| DVec3::new(p.x * p.x, p.x * p.y, p.y * p.y)).min_element() > 1.0);
    }

    #[test]
    fn it_is_the_integral_of_squared_second_derivatives() {
        // One term per inner knot, or per square for the twist, each with an area of h² = 1/4.
        let e = energy(|p| DVec3::new(0.5 * p.x * p.x, 0.5 * p.y * p.y, p.x * p.y));
        let wanted = DVec3::new(7.0 * 7.0, 9.0 * 5.0, 2.0 * 8.0 * 6.0) / 4.0;
        assert!(e.distance(wanted) < 1e-9, "{e} {wanted}");
    }
}
