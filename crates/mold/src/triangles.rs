//! The board as triangles: the same board by another way, and whether it passes through itself.

use crate::board::Board;
use crate::error::{During, MoldError};
use crate::samples::TrimIndex;
use crate::skin::Skin;
use crate::split::solid_between;
use crate::top::{FlatPatch, Patch, flat_triangles};
use glam::{DVec2, DVec3};
use softfold_geometry::{SheetSurface, TriMesh};
use softfold_kernel::{MeshView, cgal};

/// Chord error of the triangles, mm: a bend of 30 mm loses 1e-3 of its volume to it, a board with such bends less.
const CHORD_MM: f64 = 0.05;
/// Halvings of the range that the largest thickness is known to lie in.
const HALVINGS: usize = 9;

/// Both skins of a board over one triangulation of its sheet, with the walls between them.
pub(crate) struct BoardTriangles {
    flat: FlatPatch,
}

impl BoardTriangles {
    /// The triangulation of a sheet.
    pub(crate) fn of(sheet: &SheetSurface, index: &TrimIndex) -> Result<Self, MoldError> {
        Ok(Self { flat: flat_triangles(sheet, index, CHORD_MM)? })
    }

    /// The closed mesh between two skins, `skin(0, uv)` the lower and `skin(1, uv)` the upper.
    pub(crate) fn solid(&self, skin: impl Fn(usize, DVec2) -> DVec3) -> TriMesh {
        let at = |k: usize| self.flat.points.iter().map(|uv| skin(k, *uv)).collect::<Vec<_>>();
        let lower = at(0);
        let top = Patch { positions: at(1), triangles: self.flat.triangles.clone() };
        solid_between(&top, lower)
    }

    /// Two places of the sheet, farther apart than the board is thick, at which the mesh passes through itself. Nearer
    /// places meet past a centre of curvature only.
    pub(crate) fn crossing(
        &self,
        solid: &TriMesh,
        thickness_mm: f64,
    ) -> Result<Option<[DVec2; 2]>, MoldError> {
        let positions: Vec<[f64; 3]> = solid.positions.iter().map(|p| p.to_array()).collect();
        let view = MeshView { positions: &positions, triangles: &solid.triangles };
        let pairs = cgal::self_intersections(view).during(|| "the board as triangles".into())?;
        let place = |t: u32| {
            let corners =
                solid.triangles[t as usize].map(|i| self.flat.points[i as usize % self.flat.points.len()]);
            corners.iter().sum::<DVec2>() / 3.0
        };
        let mut places = pairs.into_iter().map(|pair| pair.map(place));
        Ok(places.find(|[a, b]| a.distance(*b) > thickness_mm))
    }

    /// Refuses a board that passes through itself, with the largest thickness that does not: `offsets_mm` are those of its
    /// skins.
    pub(crate) fn refuse_crossing(
        &self,
        sheet: &SheetSurface,
        solid: &TriMesh,
        offsets_mm: [f64; 2],
    ) -> Result<(), MoldError> {
        let thickness_mm = offsets_mm[1] - offsets_mm[0];
        let Some(at) = self.crossing(solid, thickness_mm)? else { return Ok(()) };
        let [mut fine, mut crossing] = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let share = 0.5 * (fine + crossing);
            let skin = |k: usize, uv: DVec2| {
                let p = sheet.spline.at(uv);
                p.position + share * offsets_mm[k] * p.normal()
            };
            let crosses = self.crossing(&self.solid(skin), thickness_mm)?.is_some();
            if crosses { crossing = share } else { fine = share }
        }
        Err(MoldError::Crosses { at, thickness_mm, largest_thickness_mm: fine * thickness_mm })
    }
}

/// The board's skins over a mesh of its sheet, and walls between them: the closed mesh of a mesh that is made thick.
pub fn solid_of_skins(board: &Board, places: &[DVec2], triangles: &[[u32; 3]]) -> TriMesh {
    let on = |skin: &Skin| places.iter().map(|uv| skin.at(*uv)).collect::<Vec<_>>();
    solid_between(&Patch { positions: on(&board.upper), triangles: triangles.to_vec() }, on(&board.lower))
}

/// Volume of a closed mesh by CGAL, mm³.
///
/// # Errors
/// A mesh that is not closed, which is a defect of ours.
pub(crate) fn volume_mm3(solid: &TriMesh) -> Result<f64, MoldError> {
    let positions: Vec<[f64; 3]> = solid.positions.iter().map(|p| p.to_array()).collect();
    let view = MeshView { positions: &positions, triangles: &solid.triangles };
    let found = cgal::closed_check(view).during(|| "the board as triangles".into())?;
    if found.closed && found.manifold {
        return Ok(found.volume_mm3);
    }
    let faults = vec![format!("closed: {}, manifold: {}", found.closed, found.manifold)];
    Err(MoldError::Invalid { what: "the board as triangles".into(), faults })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::{BoardOptions, Placement, make_board};
    use crate::shapes;
    use std::f64::consts::PI;

    /// A hairpin: two walls beside each other, joined by half a turn of a radius of 8 mm above; the walls lean towards each
    /// other by `lean` mm at their feet, 60 mm below.
    fn hairpin(lean: f64) -> SheetSurface {
        let (r, foot) = (8.0, 60.0);
        let half = 0.5 * PI * r;
        shapes::sheet_of_spacing(shapes::rectangle(2.0 * (half + foot), 40.0), 1.5, move |p| {
            let a = (p.x / r).clamp(-0.5 * PI, 0.5 * PI);
            let straight = (p.x.abs() - half).max(0.0);
            let x = a.sin() * r - p.x.signum() * lean * (straight / foot);
            DVec3::new(x, p.y, r * a.cos() - straight)
        })
    }

    fn made(sheet: &SheetSurface, thickness_mm: f64) -> Result<crate::Board, MoldError> {
        make_board(sheet, &BoardOptions { thickness_mm, placement: Placement::Mid, ..Default::default() })
    }

    #[test]
    fn the_triangles_have_the_volume_of_the_board() {
        for sheet in [
            shapes::corrugation(shapes::ellipse(150.0, 90.0)),
            shapes::cylinder(shapes::rectangle(120.0, 80.0)),
            hairpin(0.0),
        ] {
            let board = made(&sheet, 8.0).unwrap();
            let share = board.mesh_volume_mm3 / board.volume_mm3 - 1.0;
            assert!(share.abs() < 1e-3, "{share:e}");
        }
    }

    #[test]
    fn a_board_that_meets_itself_far_from_any_bend_is_refused_with_the_thickness_that_works() {
        // The walls' middles are 16 − 2·5 = 6 mm from each other at their feet, and all but parallel.
        let sheet = hairpin(5.0);
        let refused = made(&sheet, 8.0);
        let Err(MoldError::Crosses { at: [a, b], thickness_mm, largest_thickness_mm }) = refused else {
            panic!("{refused:?}")
        };
        assert_eq!(thickness_mm, 8.0);
        assert!((largest_thickness_mm - 6.0).abs() < 0.05, "{largest_thickness_mm}");
        assert!((a.x + b.x).abs() < 10.0 && a.x.abs() > 25.0, "one on either wall: {a} {b}");
        assert!(made(&sheet, largest_thickness_mm).is_ok());
        assert!(made(&sheet, 1.01 * largest_thickness_mm).is_err());
    }

    #[test]
    fn a_sheet_that_passes_through_itself_leaves_no_thickness() {
        let refused = made(&hairpin(12.0), 3.0);
        let Err(error @ MoldError::Crosses { largest_thickness_mm, .. }) = refused else {
            panic!("{refused:?}")
        };
        assert!(largest_thickness_mm < 0.01, "{largest_thickness_mm}");
        assert_eq!(error.place(), ("board", "thickness_mm"));
        assert!(error.to_string().contains("no board of it is thin enough"), "{error}");
    }
}
