//! What a board weighs and how its weight is spread: integrals over the sheet's (u, v), exact for its splines.
//!
//! OpenCascade's Gauss-Kronrod integration gives the same (tests compare them), but takes 46 s for the inertia of a board
//! of a hundred thousand spans, which takes half a second here, and minutes where symmetry makes a moment nothing.

use crate::integral::{over_trim, united};
use crate::skin::Skin;
use glam::{DMat3, DVec2, DVec3};
use softfold_geometry::{PlanarCurve, SheetSurface, TriMesh};

/// Area of a sheet's surface and the integrals of its curvatures over it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SheetIntegrals {
    /// Area inside the trim, mm².
    pub area_mm2: f64,
    /// Integral of the mean curvature, mm; positive where the surface bends towards its normal.
    pub mean_curvature_mm: f64,
    /// Integral of the curvature of Gauss.
    pub gauss_curvature: f64,
}

impl SheetIntegrals {
    /// The integrals of a sheet.
    pub fn of(sheet: &SheetSurface) -> Self {
        let [u, v] = sheet.spline.knots().map(|k| k[3..k.len() - 3].to_vec());
        let at = |uv: DVec2| {
            let p = sheet.spline.at(uv);
            let area = p.first[0].cross(p.first[1]).length();
            let [a, b] = p.principal_curvatures();
            // No curvature where the surface has no normal.
            if area > 0.0 { [area, area * 0.5 * (a + b), area * a * b] } else { [0.0; 3] }
        };
        let [area_mm2, mean_curvature_mm, gauss_curvature] = over_trim(&sheet.trim, [&u, &v], at);
        Self { area_mm2, mean_curvature_mm, gauss_curvature }
    }

    /// Volume between the offsets at two signed distances along the normal, mm³ (Steiner): the area at distance d is
    /// `A − 2 d ∫H + d² ∫K`.
    pub fn volume_between_mm3(&self, [from, to]: [f64; 2]) -> f64 {
        let power = |n: i32| to.powi(n) - from.powi(n);
        power(1) * self.area_mm2 - power(2) * self.mean_curvature_mm + power(3) / 3.0 * self.gauss_curvature
    }
}

/// Volume of a solid, its center, and its inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    pub(crate) volume_mm3: f64,
    pub(crate) center_mm: DVec3,
    /// Of the volume, about the center, mm⁵.
    pub(crate) inertia_mm5: DMat3,
}

/// Nodes and weights of Gauss and Legendre across the thickness: moments are of degree four there.
const ACROSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// The moments of the solid between two skins over the same trim, its sides ruled.
pub(crate) fn moments(lower: &Skin, upper: &Skin, trim: &[PlanarCurve]) -> Moments {
    let [u, v] = [0, 1].map(|d| united(&lower.knots[d], &upper.knots[d]));
    // About a point of the board, so that what is far from the origin does not cancel.
    let origin = trim.first().map_or(DVec3::ZERO, |curve| lower.at(curve.end(0)));
    let density = |uv: DVec2| {
        let ([low, low_u, low_v], [up, up_u, up_v]) = (lower.jet(uv), upper.jet(uv));
        let mut sum = [0.0; 10];
        for (w, weight) in ACROSS {
            let x = low.lerp(up, w) - origin;
            let volume = weight * low_u.lerp(up_u, w).cross(low_v.lerp(up_v, w)).dot(up - low);
            let all = [1.0, x.x, x.y, x.z, x.x * x.x, x.y * x.y, x.z * x.z, x.y * x.z, x.z * x.x, x.x * x.y];
            sum.iter_mut().zip(all).for_each(|(s, value)| *s += volume * value);
        }
        sum
    };
    let [volume_mm3, x, y, z, xx, yy, zz, yz, zx, xy] = over_trim(trim, [&u, &v], density);
    let second = DMat3::from_cols_array(&[xx, xy, zx, xy, yy, yz, zx, yz, zz]);
    Moments::about(origin, volume_mm3, DVec3::new(x, y, z), second)
}

impl Moments {
    /// From the integrals of 1, x and x xᵀ, x from an origin.
    fn about(origin: DVec3, volume_mm3: f64, first: DVec3, second: DMat3) -> Self {
        let center = first / volume_mm3;
        let about_center = second - volume_mm3 * outer(center);
        let trace = about_center.x_axis.x + about_center.y_axis.y + about_center.z_axis.z;
        let inertia_mm5 = DMat3::from_diagonal(DVec3::splat(trace)) - about_center;
        Self { volume_mm3, center_mm: origin + center, inertia_mm5 }
    }

    /// Of a closed mesh, exactly: tetrahedra from one of its corners.
    pub(crate) fn of_mesh(mesh: &TriMesh) -> Self {
        let origin = mesh.positions.first().copied().unwrap_or_default();
        let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for triangle in &mesh.triangles {
            let [a, b, c] = mesh.corners(*triangle).map(|p| p - origin);
            let part = a.dot(b.cross(c)) / 6.0;
            let sum = a + b + c;
            volume += part;
            first += part / 4.0 * sum;
            second += part / 20.0 * (outer(a) + outer(b) + outer(c) + outer(sum));
        }
        Self::about(origin, volume, first, second)
    }
}

/// The matrix of the products of a vector's components.
pub(crate) fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// How a mass is spread about its center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// The tensor in the axes of space, kg·mm²: `∫ y² + z²` and so on on its diagonal, `−∫ x y` beside it.
    pub tensor_kg_mm2: DMat3,
    /// Its principal moments, kg·mm², ascending.
    pub principal_kg_mm2: [f64; 3],
    /// Their axes: unit vectors, right-handed, the largest component of the first two positive. Where moments are equal any
    /// axes of their plane are principal.
    pub axes: [DVec3; 3],
}

impl Inertia {
    /// Of a tensor.
    pub(crate) fn of(tensor_kg_mm2: DMat3) -> Self {
        let (moments, axes) = principal(tensor_kg_mm2);
        Self { tensor_kg_mm2, principal_kg_mm2: moments, axes }
    }

    /// The same mass turned in space.
    pub fn turned(&self, rotation: DMat3) -> Self {
        Self::of(rotation * self.tensor_kg_mm2 * rotation.transpose())
    }
}

/// Sweeps of Jacobi's rotations: three or four reach rounding.
const SWEEPS: usize = 20;

/// Eigenvalues of a symmetric matrix, ascending, and their directions, by Jacobi's rotations.
fn principal(tensor: DMat3) -> ([f64; 3], [DVec3; 3]) {
    let (mut m, mut axes) = (tensor, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let turn = rotation(&m, p, q);
            m = turn.transpose() * m * turn;
            axes *= turn;
        }
    }
    let mut pairs = [0, 1, 2].map(|k| (m.col(k)[k], axes.col(k)));
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [a, b, _] = pairs.map(|pair| towards_positive(pair.1));
    (pairs.map(|pair| pair.0), [a, b, a.cross(b)])
}

/// The rotation of the axes p and q that takes the entry between them to zero.
fn rotation(m: &DMat3, p: usize, q: usize) -> DMat3 {
    let off = m.col(q)[p];
    let mut turn = DMat3::IDENTITY;
    if off != 0.0 {
        let angle = 0.5 * (2.0 * off).atan2(m.col(q)[q] - m.col(p)[p]);
        let (sin, cos) = angle.sin_cos();
        turn.col_mut(p)[p] = cos;
        turn.col_mut(p)[q] = -sin;
        turn.col_mut(q)[p] = sin;
        turn.col_mut(q)[q] = cos;
    }
    turn
}

fn towards_positive(v: DVec3) -> DVec3 {
    let largest = v.to_array().into_iter().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    v * largest.signum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::{BoardOptions, Placement, make_board};
    use crate::shapes;
    use crate::spline::face;
    use softfold_kernel::occt;

    /// Bends across the lattice and a hole.
    fn creased() -> SheetSurface {
        let fold = |p: DVec2| {
            let x = p.x + 0.3 * p.y;
            DVec3::new(p.x, p.y, 20.0 * (x / 37.0).sin() + 0.4 * ((p.y - 0.2 * p.x).powi(2) + 625.0).sqrt())
        };
        let mut sheet = shapes::sheet(shapes::ellipse(151.3, 92.7), fold);
        sheet.trim.push(shapes::ellipse(33.1, 17.9).reversed());
        sheet
    }

    fn board(sheet: &SheetSurface, thickness_mm: f64, placement: Placement) -> crate::Board {
        make_board(sheet, &BoardOptions { thickness_mm, placement, ..Default::default() }).unwrap()
    }

    fn near(a: DMat3, b: DMat3, share: f64) -> bool {
        let size = b.to_cols_array().iter().fold(0.0, |s: f64, v| s.max(v.abs()));
        a.abs_diff_eq(b, share * size)
    }

    #[test]
    fn areas_agree_with_opencascade() {
        let rectangle = shapes::rectangle(203.7, 81.3);
        for sheet in [
            creased(),
            shapes::sheet(rectangle.clone(), |p| DVec3::new(p.x, p.y, 0.004 * p.x * p.y)),
            shapes::corrugation(shapes::ellipse(150.0, 90.0)),
            shapes::cylinder(shapes::rectangle(200.0, 80.0)),
        ] {
            let occt = occt::area(&face(&sheet).unwrap()).unwrap();
            let share = SheetIntegrals::of(&sheet).area_mm2 / occt - 1.0;
            assert!(share.abs() < 1e-7, "{share:e}");
        }
    }

    #[test]
    fn a_flat_sheet_and_a_developable_one_keep_the_area_of_the_outline() {
        let ellipse = shapes::ellipse(150.0, 90.0);
        let exact = ellipse.signed_area_mm2();
        assert!((SheetIntegrals::of(&shapes::flat(ellipse.clone())).area_mm2 / exact - 1.0).abs() < 1e-12);
        // The spline through knots 10 mm apart is off in curvature, not in length, by h²/(12 r²).
        let cylinder = SheetIntegrals::of(&shapes::cylinder(ellipse));
        assert!((cylinder.area_mm2 / exact - 1.0).abs() < 1e-5);
        let mean = cylinder.mean_curvature_mm / cylinder.area_mm2;
        assert!((mean * 2.0 * shapes::CYLINDER_RADIUS_MM - 1.0).abs() < 1e-3, "{mean}");
        assert!(cylinder.gauss_curvature.abs() < 1e-9);
    }

    #[test]
    fn the_whole_curvature_of_a_cap_is_its_solid_angle() {
        // A cap of a sphere over a disc: ∫K is the solid angle of its normals, 2π (1 − cos φ).
        let (r, a) = (200.0_f64, 80.0);
        let cap = |p: DVec2| DVec3::new(p.x, p.y, r - (r * r - p.length_squared()).sqrt());
        let found = SheetIntegrals::of(&shapes::sheet(shapes::ellipse(a, a), cap));
        let cos = (1.0 - (a / r) * (a / r)).sqrt();
        let exact = std::f64::consts::TAU * (1.0 - cos);
        assert!((found.gauss_curvature / exact - 1.0).abs() < 1e-3, "{}", found.gauss_curvature / exact);
        assert!((found.area_mm2 / (exact * r * r) - 1.0).abs() < 1e-3);
        let shell = found.volume_between_mm3([-4.0, 6.0]);
        // The normal points at the center.
        let between = exact / 3.0 * ((r + 4.0).powi(3) - (r - 6.0).powi(3));
        assert!((shell / between - 1.0).abs() < 1e-3, "{}", shell / between);
    }

    #[test]
    fn boards_have_the_volume_of_their_offset() {
        for sheet in [creased(), shapes::corrugation(shapes::ellipse(150.0, 90.0))] {
            for (placement, offsets) in [
                (Placement::Mid, [-3.0, 3.0]),
                (Placement::Lower, [0.0, 6.0]),
                (Placement::Upper, [-6.0, 0.0]),
            ] {
                let exact = SheetIntegrals::of(&sheet).volume_between_mm3(offsets);
                let share = board(&sheet, 6.0, placement).volume_mm3 / exact - 1.0;
                assert!(share.abs() < 1e-4, "{placement:?} {share:e}");
            }
        }
    }

    #[test]
    fn opencascade_finds_the_same_volume_center_and_inertia() {
        // Without symmetry: where a moment is nothing, OpenCascade's integration seeks a share of that for minutes.
        let lopsided =
            |p: DVec2| DVec3::new(p.x, p.y + 1e-3 * p.x * p.x, 2e-3 * p.x * (p.x + 0.7 * p.y) + 0.1 * p.y);
        let corner =
            shapes::rectangle(110.0, 70.0).mapped(|p| p + DVec2::new(31.0, 17.0) + 0.2 * p.perp()).unwrap();
        let sheet = shapes::sheet(corner, lopsided);
        let board = board(&sheet, 6.0, Placement::Upper);
        let other = occt::inertia(&board.shape, 1e-6).unwrap();
        assert!((other.volume_mm3 / board.volume_mm3 - 1.0).abs() < 1e-6);
        assert!(DVec3::from(other.center).distance(board.barycenter_mm) < 1e-4);
        let rows = DMat3::from_cols_array_2d(&other.tensor_mm5) * 1700e-9;
        assert!(near(board.inertia.tensor_kg_mm2, rows, 1e-6), "{:?} {rows}", board.inertia);
    }

    #[test]
    fn a_box_has_its_closed_form_inertia() {
        let board = board(&shapes::flat(shapes::rectangle(120.0, 80.0)), 10.0, Placement::Upper);
        let m = board.mass_kg / 12.0;
        let exact =
            [m * (80.0 * 80.0 + 100.0), m * (120.0 * 120.0 + 100.0), m * (120.0 * 120.0 + 80.0 * 80.0)];
        (0..3).for_each(|k| assert!((board.inertia.principal_kg_mm2[k] / exact[k] - 1.0).abs() < 1e-9));
        let straight = [DVec3::X, DVec3::Y, DVec3::Z];
        (0..3).for_each(|k| assert!(board.inertia.axes[k].distance(straight[k]) < 1e-9));
        assert!(near(board.inertia.tensor_kg_mm2, DMat3::from_diagonal(exact.into()), 1e-9));
    }

    #[test]
    fn a_cylinder_band_has_its_closed_form_inertia() {
        // A quarter of a tube would do; this is 60° of one: polar sector integrals about the tube's axis, moved to the center.
        let fine = |r: f64, h: f64| {
            shapes::sheet_of_spacing(shapes::rectangle(120.0, 80.0), h, |p| {
                DVec3::new(r * (p.x / r).sin(), p.y, r * (1.0 - (p.x / r).cos()))
            })
        };
        let (r, length) = (shapes::CYLINDER_RADIUS_MM, 80.0);
        let board = board(&fine(r, 2.5), 10.0, Placement::Mid);
        let (o, i, half) = (r + 5.0, r - 5.0, 60.0 / r);
        let ring = |n: i32| (f64::powi(o, n) - f64::powi(i, n)) / f64::from(n);
        let volume = length * 2.0 * half * ring(2);
        // x is across, z along the middle of the band, from the axis.
        let z = length * 2.0 * half.sin() * ring(3) / volume;
        let (xx, zz) = (half - 0.5 * (2.0 * half).sin(), half + 0.5 * (2.0 * half).sin());
        let [xx, zz] = [xx, zz].map(|angle| length * angle * ring(4));
        let (zz, yy) = (zz - volume * z * z, volume * length * length / 12.0);
        let exact = DMat3::from_diagonal(1700e-9 * DVec3::new(yy + zz, xx + zz, xx + yy));
        assert!((board.volume_mm3 / volume - 1.0).abs() < 1e-6, "{:e}", board.volume_mm3 / volume - 1.0);
        assert!(board.barycenter_mm.distance(DVec3::Z * (r - z)) < 1e-4, "{}", board.barycenter_mm);
        assert!(near(board.inertia.tensor_kg_mm2, exact, 1e-6), "{} {exact}", board.inertia.tensor_kg_mm2);
    }

    #[test]
    fn principal_axes_turn_with_the_body() {
        let tensor = DMat3::from_diagonal(DVec3::new(3.0, 5.0, 7.0));
        let turn = DMat3::from_rotation_z(0.4) * DMat3::from_rotation_x(-1.1);
        let inertia = Inertia::of(tensor).turned(turn);
        for (k, moment) in [3.0, 5.0, 7.0].into_iter().enumerate() {
            assert!((inertia.principal_kg_mm2[k] - moment).abs() < 1e-12);
            let axis = inertia.axes[k];
            assert!((inertia.tensor_kg_mm2 * axis).distance(moment * axis) < 1e-12);
            assert!((axis.dot(turn.col(k)).abs() - 1.0).abs() < 1e-12);
        }
        assert!(
            (DMat3::from_cols_array_2d(&inertia.axes.map(|a| a.to_array())).determinant() - 1.0).abs()
                < 1e-12
        );
    }

    #[test]
    fn symmetric_boards_have_their_barycenter_in_the_middle() {
        let bump = |p: DVec2| DVec3::new(p.x, p.y, 12.0 * (p.x / 40.0).cos() * (p.y / 55.0).cos());
        let arch = shapes::cylinder(shapes::rectangle(160.0, 90.0));
        for sheet in [shapes::sheet(shapes::ellipse(110.0, 70.0), bump), arch] {
            let center = board(&sheet, 7.0, Placement::Mid).barycenter_mm;
            let off = center.truncate().length() / 220.0;
            assert!(off < 1e-6, "{off:e} of the size");
        }
    }
}
