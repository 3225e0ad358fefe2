//! The board: the sheet with its thickness.

use crate::error::{During, MoldError, Setting};
use crate::ground::{self, GroundTrim};
use crate::measure::{Inertia, SheetIntegrals, moments};
use crate::samples::{LatticeSample, TrimIndex, border, border_of};
use crate::skin::{Skin, SkinInput, skin_of, skins};
use crate::spline::trim_loops;
use crate::triangles::{BoardTriangles, volume_mm3};
use glam::{DVec2, DVec3};
use softfold_geometry::{PlanarCurve, SheetSurface, SurfacePoint, UniformBicubic};
use softfold_kernel::occt::{self, Shape};

/// Largest distance of a skin from the true offset, mm: less than half of what the sheet itself may be off.
const OFFSET_ERROR_MM: f64 = 0.02;
/// Places per lattice cell and direction at which skins and curvatures are looked at.
const SAMPLES_PER_CELL: f64 = 3.0;
/// A skin must stay this share of the radius away from the centre of curvature: nearer than that its own radius is
/// below any tool and the offset's normals turn over with the rounding of the surface.
const CENTRE_CLEARANCE: f64 = 1e-3;
/// Step along the border, as share of that inside.
const BORDER_STEP: f64 = 0.125;
/// kg/m³ to kg/mm³.
const PER_CUBIC_MM: f64 = 1e-9;

/// Where the sheet's surface lies in the board's thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Placement {
    /// In the middle: skins at ± half the thickness.
    #[default]
    Mid,
    /// The sheet is the lower skin; the board grows along the normal.
    Lower,
    /// The sheet is the upper skin; the board grows against the normal.
    Upper,
}

/// What a board is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardOptions {
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Where the sheet's surface lies in it.
    pub placement: Placement,
}

impl Default for BoardOptions {
    /// Fiber cement of 8 mm.
    fn default() -> Self {
        Self { thickness_mm: 8.0, density_kg_m3: 1700.0, placement: Placement::Mid }
    }
}

impl BoardOptions {
    /// Whether the options make sense, whatever the sheet.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<(), MoldError> {
        Setting::of("board", "thickness_mm", "board thickness (mm)").positive(self.thickness_mm)?;
        Setting::of("material", "density_kg_m3", "board density (kg/m3)").not_negative(self.density_kg_m3)
    }
}

/// The smallest radius of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinRadius {
    /// Radius, mm; infinite on a flat skin.
    pub radius_mm: f64,
    /// Place on the sheet, (u, v) in mm.
    pub at: DVec2,
}

/// The sheet with its thickness. "Lower" is the side against the sheet's normal, "upper" the side along it.
#[derive(Debug)]
pub struct Board {
    /// The solid: both skins and ruled side walls.
    pub shape: Shape,
    /// Lower skin over the sheet's (u, v).
    pub lower: Skin,
    /// Upper skin over the sheet's (u, v).
    pub upper: Skin,
    /// Outline and holes of both skins in (u, v).
    pub trim: Vec<PlanarCurve>,
    /// Thickness, mm.
    pub thickness_mm: f64,
    /// Volume of the solid, mm³.
    pub volume_mm3: f64,
    /// Area of the sheet's surface inside its trim, mm².
    pub area_mid_mm2: f64,
    /// Volume between the true offsets of the sheet, mm³: its area and curvatures integrated. The skins' is near to it.
    pub offset_volume_mm3: f64,
    /// The same board once more: volume of its triangles, by CGAL, mm³.
    pub mesh_volume_mm3: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass, mm.
    pub barycenter_mm: DVec3,
    /// Inertia about the centre of mass.
    pub inertia: Inertia,
    /// How it was cut at the ground, if it was.
    pub trimmed: Option<GroundTrim>,
    /// Smallest radius of the lower and the upper skin, from the curvature of the sheet and the exact offset.
    pub min_radius_mm: [SkinRadius; 2],
    /// Largest distance found between a skin and the exact offset, mm.
    pub offset_error_mm: f64,
}

/// Makes the board of a sheet.
///
/// Skins are `S + d·n` by least squares, with as few knots as keep them within 0.02 mm of the exact offset wherever they
/// were looked at (`offset_error_mm` tells what was reached).
///
/// # Errors
/// Options that are not positive, a trim that leaves the surface, skins that pass a centre of curvature, a solid that
/// OpenCascade does not find valid.
pub fn make_board(sheet: &SheetSurface, options: &BoardOptions) -> Result<Board, MoldError> {
    options.check()?;
    let index = TrimIndex::new(sheet)?;
    let places = places(sheet, &index);
    let offsets = options.placement.offsets_mm(options.thickness_mm);
    let curved = curvatures(&sheet.spline, &places);
    refuse_folding_over(&curved, options)?;
    let ([lower, upper], offset_error_mm) = skins_of(sheet, &index, offsets, &places)?;
    let triangles = BoardTriangles::of(sheet, &index)?;
    let solid = triangles.solid(|k, uv| [&lower, &upper][k].at(uv));
    triangles.refuse_crossing(sheet, &solid, offsets)?;
    let shape = occt::board_solid(&lower.bspline(), &upper.bspline(), &trim_loops(&sheet.trim))
        .during(|| "the board".into())?;
    require_valid(&shape, "the board")?;
    let found = moments(&lower, &upper, &sheet.trim);
    let of_sheet = SheetIntegrals::of(sheet);
    let density_kg_mm3 = options.density_kg_m3 * PER_CUBIC_MM;
    Ok(Board {
        shape,
        lower,
        upper,
        trim: sheet.trim.clone(),
        thickness_mm: options.thickness_mm,
        volume_mm3: found.volume_mm3,
        area_mid_mm2: of_sheet.area_mm2,
        offset_volume_mm3: of_sheet.volume_between_mm3(offsets),
        mesh_volume_mm3: volume_mm3(&solid)?,
        mass_kg: found.volume_mm3 * density_kg_mm3,
        barycenter_mm: found.center_mm,
        inertia: Inertia::of(density_kg_mm3 * found.inertia_mm5),
        trimmed: None,
        min_radius_mm: offsets.map(|d| smallest_radius(&curved, d)),
        offset_error_mm,
    })
}

impl Board {
    /// Points of both skins, no farther apart than `step_mm` on the flat sheet, and eight times as many along the border,
    /// on which most pieces stand: what can touch the ground. Of a board that is cut at the ground, points all over it.
    ///
    /// # Errors
    /// A trim that does not close; triangles of a cut board that cannot be made.
    pub fn points(&self, step_mm: f64) -> Result<Vec<DVec3>, MoldError> {
        if self.trimmed.is_some() {
            return ground::points(&self.shape);
        }
        let index = TrimIndex::of_trim(&self.trim)?;
        let along = self.trim.iter().flat_map(|curve| border_of(curve, BORDER_STEP * step_mm));
        let uv: Vec<DVec2> =
            along.chain(index.lattice(step_mm).iter().map(|s: &LatticeSample| s.uv)).collect();
        let skins = [&self.lower, &self.upper];
        Ok(skins.iter().flat_map(|skin| uv.iter().map(|&p| skin.at(p))).collect())
    }
}

impl Placement {
    /// Signed distances of the lower and the upper skin from the sheet.
    pub fn offsets_mm(self, thickness_mm: f64) -> [f64; 2] {
        match self {
            Placement::Mid => [-0.5 * thickness_mm, 0.5 * thickness_mm],
            Placement::Lower => [0.0, thickness_mm],
            Placement::Upper => [-thickness_mm, 0.0],
        }
    }
}

/// Fails with the faults that OpenCascade finds in a shape.
pub(crate) fn require_valid(shape: &Shape, what: &str) -> Result<(), MoldError> {
    let faults = occt::check(shape).during(|| what.to_string())?;
    if faults.is_empty() { Ok(()) } else { Err(MoldError::Invalid { what: what.into(), faults }) }
}

/// Where curvature and offset are looked at: all over the sheet and along its border.
fn places(sheet: &SheetSurface, index: &TrimIndex) -> Vec<DVec2> {
    let step_mm = sheet.spline.spacing_mm / SAMPLES_PER_CELL;
    let mut places = border(sheet, step_mm);
    places.extend(index.lattice(step_mm).iter().map(|s| s.uv));
    places
}

/// Principal curvatures at each place.
fn curvatures(surface: &UniformBicubic, places: &[DVec2]) -> Vec<(DVec2, [f64; 2])> {
    places.iter().map(|&uv| (uv, surface.at(uv).principal_curvatures())).collect()
}

/// A skin at distance d has principal radii 1/k − d: it folds over where d·k reaches 1.
fn refuse_folding_over(curved: &[(DVec2, [f64; 2])], options: &BoardOptions) -> Result<(), MoldError> {
    let per_thickness = options.placement.offsets_mm(1.0);
    let worst = |offset: f64| {
        let all = curved.iter().flat_map(|&(uv, k)| k.map(|k| (uv, k)));
        all.max_by(|a, b| (a.1 * offset).total_cmp(&(b.1 * offset))).map(|(uv, k)| (uv, k, offset))
    };
    let found =
        per_thickness.into_iter().filter_map(worst).max_by(|a, b| (a.1 * a.2).total_cmp(&(b.1 * b.2)));
    let Some((at, curvature, offset)) = found else { return Ok(()) };
    let largest_thickness_mm = (1.0 - CENTRE_CLEARANCE) / (curvature * offset);
    if curvature * offset <= 0.0 || options.thickness_mm <= largest_thickness_mm {
        return Ok(());
    }
    let offset_mm = offset * options.thickness_mm;
    Err(MoldError::OffsetTooThick { at, offset_mm, radius_mm: 1.0 / curvature.abs(), largest_thickness_mm })
}

fn smallest_radius(curved: &[(DVec2, [f64; 2])], offset_mm: f64) -> SkinRadius {
    let radius = |k: f64| if k == 0.0 { f64::INFINITY } else { (1.0 / k - offset_mm).abs() };
    let flat = SkinRadius { radius_mm: f64::INFINITY, at: DVec2::ZERO };
    let all = curved.iter().map(|&(at, [a, b])| SkinRadius { radius_mm: radius(a).min(radius(b)), at });
    all.fold(flat, |best, r| if r.radius_mm < best.radius_mm { r } else { best })
}

/// Both skins and the largest distance of them from the exact offset; where that is the sheet itself, exactly the sheet.
fn skins_of(
    sheet: &SheetSurface,
    index: &TrimIndex,
    offsets_mm: [f64; 2],
    places: &[DVec2],
) -> Result<([Skin; 2], f64), MoldError> {
    let exact: Vec<SurfacePoint> = places.iter().map(|&uv| sheet.spline.at(uv)).collect();
    let input = SkinInput { sheet, index, offsets_mm, tolerance_mm: OFFSET_ERROR_MM };
    let error = |skins: &[Skin; 2]| {
        let off = |(skin, d): (&Skin, f64)| offset_error_mm(skin, d, places, &exact);
        skins.iter().zip(offsets_mm).map(off).fold(0.0, f64::max)
    };
    let fault = "no spline through its offset could be found".to_owned();
    let refused = || MoldError::Invalid { what: "the board's skin".into(), faults: vec![fault] };
    let (mut skins, error_mm) = skins(&input, error).ok_or_else(refused)?;
    skins
        .iter_mut()
        .zip(offsets_mm)
        .filter(|(_, d)| *d == 0.0)
        .for_each(|(s, _)| *s = skin_of(&sheet.spline));
    Ok((skins, error_mm))
}

/// Largest distance of a skin from the exact offset.
fn offset_error_mm(skin: &Skin, offset_mm: f64, places: &[DVec2], exact: &[SurfacePoint]) -> f64 {
    let off = |(uv, p): (&DVec2, &SurfacePoint)| skin.at(*uv).distance(p.position + offset_mm * p.normal());
    places.iter().zip(exact).map(off).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use std::f64::consts::PI;

    fn options(thickness_mm: f64, placement: Placement) -> BoardOptions {
        BoardOptions { thickness_mm, placement, ..Default::default() }
    }

    #[test]
    fn a_flat_board_is_area_times_thickness() {
        let sheet = shapes::flat(shapes::ellipse(150.0, 90.0));
        let area = sheet.trim[0].signed_area_mm2();
        let board = make_board(&sheet, &options(8.0, Placement::Mid)).unwrap();
        assert!((board.volume_mm3 / (8.0 * area) - 1.0).abs() < 1e-8);
        assert!((board.area_mid_mm2 / area - 1.0).abs() < 1e-8);
        assert!((board.mass_kg - 8.0 * area * 1700e-9).abs() < 1e-7);
        assert!(board.barycenter_mm.length() < 1e-6);
        assert_eq!(board.min_radius_mm.map(|r| r.radius_mm > 1e9), [true; 2]);
    }

    #[test]
    fn a_board_of_no_thickness_is_refused_at_its_line() {
        for (value, place) in [(f64::NAN, ("board", "thickness_mm")), (0.0, ("board", "thickness_mm"))] {
            assert_eq!(options(value, Placement::Mid).check().unwrap_err().place(), place);
        }
        let weightless = BoardOptions { density_kg_m3: f64::INFINITY, ..Default::default() };
        assert_eq!(weightless.check().unwrap_err().place(), ("material", "density_kg_m3"));
        BoardOptions::default().check().unwrap();
    }

    #[test]
    fn a_cylinder_board_has_its_closed_form_volume() {
        // A strip of arc length 120 and length 80 on radius 150: θ·L·(r_o² − r_i²)/2.
        let sheet = shapes::cylinder(shapes::rectangle(120.0, 80.0));
        let r = shapes::CYLINDER_RADIUS_MM;
        for (placement, inner, outer) in [
            (Placement::Mid, r - 5.0, r + 5.0),
            (Placement::Lower, r - 10.0, r),
            (Placement::Upper, r, r + 10.0),
        ] {
            let board = make_board(&sheet, &options(10.0, placement)).unwrap();
            let exact = 120.0 / r * 80.0 * (outer * outer - inner * inner) / 2.0;
            assert!(
                (board.volume_mm3 / exact - 1.0).abs() < 1e-5,
                "{placement:?} {}",
                board.volume_mm3 / exact
            );
            // The normal points at the axis: the upper skin is the inner one. The spline through knots 10 mm apart is
            // off in curvature by h²/(12 r²), 0.06 mm of radius.
            assert!((board.min_radius_mm[0].radius_mm - outer).abs() < 0.1, "{:?}", board.min_radius_mm);
            assert!((board.min_radius_mm[1].radius_mm - inner).abs() < 0.1);
            assert!(board.offset_error_mm < OFFSET_ERROR_MM);
        }
    }

    #[test]
    fn a_cylinder_board_has_its_barycenter() {
        let sheet = shapes::cylinder(shapes::rectangle(120.0, 80.0));
        let board = make_board(&sheet, &options(10.0, Placement::Mid)).unwrap();
        let (r, half) = (shapes::CYLINDER_RADIUS_MM, 60.0 / shapes::CYLINDER_RADIUS_MM);
        let (o, i) = (r + 5.0, r - 5.0);
        let from_axis = 2.0 * half.sin() / (3.0 * half) * (o.powi(3) - i.powi(3)) / (o * o - i * i);
        assert!(board.barycenter_mm.distance(DVec3::Z * (r - from_axis)) < 1e-3, "{}", board.barycenter_mm);
    }

    #[test]
    fn a_skin_past_the_centre_is_refused_with_the_thickness_that_works() {
        let sheet = shapes::cylinder(shapes::rectangle(120.0, 80.0));
        let refused = make_board(&sheet, &options(310.0, Placement::Mid));
        let Err(MoldError::OffsetTooThick { radius_mm, largest_thickness_mm, .. }) = refused else {
            panic!("{refused:?}")
        };
        assert!((radius_mm - 150.0).abs() < 0.1 && (largest_thickness_mm - 299.7).abs() < 0.2);
        assert!(
            make_board(&sheet, &options(200.0, Placement::Upper)).is_ok(),
            "away from the centre all is free"
        );
    }

    #[test]
    fn a_narrow_fold_is_refined_until_the_offset_holds() {
        // A fold of radius 30 on a lattice of 10 mm.
        let r = 30.0;
        let fold = |p: DVec2| {
            let a = (p.x / r).clamp(-0.6, 0.6);
            let straight = p.x - a * r;
            DVec3::new(r * a.sin() + straight * a.cos(), p.y, r * (1.0 - a.cos()) + straight * a.sin())
        };
        let board =
            make_board(&shapes::sheet(shapes::rectangle(160.0, 60.0), fold), &options(12.0, Placement::Mid));
        let board = board.unwrap();
        assert!(board.offset_error_mm <= OFFSET_ERROR_MM, "{}", board.offset_error_mm);
    }

    #[test]
    fn a_board_on_the_ground_stands_on_its_lower_skin() {
        let sheet = shapes::cylinder(shapes::ellipse(80.0, 50.0));
        let board = make_board(&sheet, &options(8.0, Placement::Mid)).unwrap();
        let rest = crate::stability(&board.points(2.0).unwrap(), board.barycenter_mm, 0.2).unwrap();
        assert!((rest.ground_z_mm + 4.0).abs() < OFFSET_ERROR_MM && rest.stable, "{rest:?}");
        // Contact reaches x = sqrt(2 R·0.2) = 7.8 mm to each side on the lower skin's radius 154.
        assert!((rest.margin_mm - 7.8).abs() < 2.0, "{}", rest.margin_mm);
        assert!((board.area_mid_mm2 / (PI * 80.0 * 50.0) - 1.0).abs() < 1e-3);
    }
}
