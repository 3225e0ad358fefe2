//! The quad lattice over the flat sheet: Catmull-Clark cage and poles of the uniform bicubic in one.

use glam::{DVec2, DVec3};
use softfold_geometry::UniformBicubic;
use softfold_kernel::opensubdiv::{self, Sample};

/// A quad mesh in space, the control cage of a subdivision surface. Quads run counter-clockwise seen from the side that
/// the flat sheet shows to the onlooker. Its border is a sharp crease: the limit of the outermost ring of quads is not
/// part of the fitted surface, which begins one quad inside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cage {
    /// Vertices, mm; the poles of the fitted surface, in its order.
    pub positions: Vec<DVec3>,
    /// Four vertices each.
    pub quads: Vec<[u32; 4]>,
}

/// Where the vertices of the lattice stand in (u, v): vertex (i, j) at `origin + spacing·(i, j)`, number
/// `i * count[1] + j`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    pub(crate) origin: DVec2,
    pub(crate) spacing_mm: f64,
    pub(crate) count: [usize; 2],
}

impl Lattice {
    /// Squares of `spacing_mm` over the box `lo..hi`, centred on it, with `margin` further cells on every side.
    pub(crate) fn over((lo, hi): (DVec2, DVec2), spacing_mm: f64, margin: u32) -> Self {
        let cells = ((hi - lo) / spacing_mm).ceil().max(DVec2::ONE) + 2.0 * f64::from(margin);
        let origin = 0.5 * (lo + hi) - 0.5 * spacing_mm * cells;
        Self { origin, spacing_mm, count: [cells.x, cells.y].map(|n| (n as usize).saturating_add(1)) }
    }

    pub(crate) fn vertices(&self) -> usize {
        self.count[0].saturating_mul(self.count[1])
    }

    fn quads(&self) -> Vec<[u32; 4]> {
        let at = |i, j| (i * self.count[1] + j) as u32;
        let quad = |i, j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        (0..self.count[0] - 1).flat_map(|i| (0..self.count[1] - 1).map(move |j| quad(i, j))).collect()
    }

    /// The cage as OpenSubdiv wants it.
    pub(crate) fn connections(&self) -> opensubdiv::Cage {
        opensubdiv::Cage { vertex_count: self.vertices(), quads: self.quads() }
    }

    /// The cell of a flat point, never in the border ring: there the limit is not the uniform bicubic.
    pub(crate) fn cell(&self, uv: DVec2) -> [usize; 2] {
        let local = (uv - self.origin) / self.spacing_mm;
        [0, 1].map(|d| (local[d].floor() as isize).clamp(1, self.count[d] as isize - 3) as usize)
    }

    /// The sixteen poles that act in a cell.
    pub(crate) fn poles_of(&self, cell: [usize; 2]) -> impl Iterator<Item = usize> + use<> {
        let (rows, [i, j]) = (self.count[1], cell);
        (0..16).map(move |k| (i + k / 4 - 1) * rows + j + k % 4 - 1)
    }

    /// The place of a flat point on the cage.
    pub(crate) fn sample(&self, uv: DVec2) -> Sample {
        let (local, cell) = ((uv - self.origin) / self.spacing_mm, self.cell(uv));
        let within = [0, 1].map(|d| (local[d] - cell[d] as f64).clamp(0.0, 1.0));
        let quad = cell[0] * (self.count[1] - 1) + cell[1];
        Sample { quad: quad as u32, s: within[0], t: within[1] }
    }

    pub(crate) fn cage(&self, positions: Vec<DVec3>) -> Cage {
        Cage { positions, quads: self.quads() }
    }

    pub(crate) fn spline(&self, poles: Vec<DVec3>) -> UniformBicubic {
        UniformBicubic { origin: self.origin, spacing_mm: self.spacing_mm, count: self.count, poles }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lattice_reaches_its_margin_past_the_box_on_every_side() {
        let (lo, hi) = (DVec2::new(-3.0, 10.0), DVec2::new(97.0, 51.0));
        let lattice = Lattice::over((lo, hi), 7.0, 3);
        let end =
            lattice.origin + 7.0 * DVec2::new((lattice.count[0] - 1) as f64, (lattice.count[1] - 1) as f64);
        for d in 0..2 {
            let (below, above) = (lo[d] - lattice.origin[d], end[d] - hi[d]);
            assert!((21.0..24.51).contains(&below) && (below - above).abs() < 1e-9, "{below} {above}");
        }
    }

    #[test]
    fn stencils_are_the_basis_of_the_spline() {
        let lattice = Lattice::over((DVec2::new(5.0, -2.0), DVec2::new(47.0, 31.0)), 6.0, 2);
        let pole = |k: usize| DVec3::new((k as f64).sin(), (k as f64 * 1.7).cos(), (k % 13) as f64);
        let spline = lattice.spline((0..lattice.vertices()).map(pole).collect());
        let points: Vec<_> =
            (0..200).map(|k| DVec2::new(5.0 + 0.21 * k as f64, 31.0 - 0.165 * k as f64)).collect();
        let samples: Vec<_> = points.iter().map(|&p| lattice.sample(p)).collect();
        let rows = opensubdiv::limit_stencils(&lattice.connections(), &samples).unwrap();
        for (r, &uv) in points.iter().enumerate() {
            let row = rows.offsets[r] as usize..rows.offsets[r + 1] as usize;
            let sum = |weights: &[f64]| -> DVec3 {
                row.clone().map(|k| weights[k] * spline.poles[rows.indices[k] as usize]).sum()
            };
            let at = spline.at(uv);
            assert!(sum(&rows.weights).distance(at.position) < 1e-10, "{uv}");
            assert!(sum(&rows.weights_s).distance(6.0 * at.first[0]) < 1e-10, "{uv}");
            assert!(sum(&rows.weights_t).distance(6.0 * at.first[1]) < 1e-10, "{uv}");
        }
    }
}
