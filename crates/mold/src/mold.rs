//! The mold: a solid under the sheet, cut into parts that fit a printer, on a waffle of boards.

use crate::error::{During, MoldError, Setting};
use crate::grid::{CELL, Cell, Grid, Limits, Piece, better, choose, join_slivers};
use crate::height::HeightField;
use crate::marks::MarkOptions;
use crate::parts::{Common, Job, Part, make_parts};
use crate::plan;
use crate::pose::{Look, MoldPose, PoseChoice, find_pose};
use crate::samples::TrimIndex;
use crate::spline::{face, moved};
use crate::split::CutPatch;
use crate::top::{Patch, triangulate};
use crate::waffle::{Groove, Waffle, WaffleOptions, design};
use glam::{DMat3, DVec2, DVec3};
use softfold_geometry::SheetSurface;
use softfold_kernel::occt::{self, Shape};

/// The plan that the grid is chosen for is looked at this often per lattice cell.
const PLAN_STEPS_PER_CELL: f64 = 2.0;

/// Sides of the grid's squares, mm: below, more walls than parts; above, 100 m, no printer.
const CELLS_MM: [f64; 2] = [1.0, 1e5];
/// More steps of the grid's origin than this each way try places that differ by less than a saw cut.
const MOST_STEPS: usize = 50;
/// A rotation's columns may be off from unit and square by this: rounding of a matrix that was written down.
const ROTATION_ERROR: f64 = 1e-6;

/// How the mold is made.
#[derive(Clone, Debug, PartialEq)]
pub struct MoldOptions {
    /// Which way is up.
    pub pose: PoseChoice,
    /// Thickness along z, mm.
    pub thickness_mm: f64,
    /// Side of the grid's squares, mm.
    pub cell_mm: f64,
    /// Room of the printer, mm.
    pub printer_mm: [f64; 3],
    /// The grid's origin is searched on a lattice of so many steps each way over one square; 1 starts it at the lower
    /// left corner of the mold.
    pub origin_steps: usize,
    /// Turns about z, degrees, that are tried against the grid; the first is kept unless another gives fewer parts.
    pub turns_deg: Vec<f64>,
    /// Smaller parts are slivers, mm³: joined to a neighbour if the printer takes it, told otherwise.
    pub sliver_mm3: f64,
    /// Largest distance between the sheet and its triangles, mm.
    pub chord_mm: f64,
    /// Largest distance by which vertices of printed parts are moved to have fewer triangles, mm; 0 keeps all.
    pub decimate_mm: f64,
    /// Names and dots on the underside, if any.
    pub marks: Option<MarkOptions>,
    /// The waffle, if any.
    pub waffle: Option<WaffleOptions>,
    /// Threads to make parts on; the result does not depend on it.
    pub threads: usize,
}

impl Default for MoldOptions {
    /// 50 mm thick, squares of 221 mm for a printer of 256 mm; slivers are below 5 % of a whole part. Chords and
    /// decimation together stay below 0.05 mm, a quarter of a usual layer.
    fn default() -> Self {
        Self {
            pose: PoseChoice::Found,
            thickness_mm: 50.0,
            cell_mm: 221.0,
            printer_mm: [256.0; 3],
            origin_steps: 20,
            turns_deg: vec![0.0],
            sliver_mm3: 122_000.0,
            chord_mm: 0.04,
            decimate_mm: 0.01,
            marks: Some(MarkOptions::default()),
            waffle: Some(WaffleOptions::default()),
            threads: 2,
        }
    }
}

/// The mold, in its own coordinates: its lowest point at z = 0, its bounding rectangle in plan from the origin.
#[derive(Debug)]
pub struct Mold {
    /// How the sheet lies on it.
    pub pose: MoldPose,
    /// The exact solid: the sheet's face swept down by the thickness.
    pub shape: Shape,
    /// What OpenCascade finds wrong with it; not empty only with undercuts.
    pub faults: Vec<String>,
    /// Volume of the solid, mm³: its plan's area, integrated along the trim, times the thickness.
    pub volume_mm3: f64,
    /// Outline, then holes, in plan.
    pub plan: Vec<Vec<DVec2>>,
    /// The grid.
    pub grid: Grid,
    /// The printable parts, by row and column.
    pub parts: Vec<Part>,
    /// Names of the parts that are slivers and could not be joined.
    pub slivers: Vec<String>,
    /// The boards below.
    pub waffle: Waffle,
}

/// Makes the mold of a sheet.
///
/// Undercuts are told in the pose and are no error; parts that suffer from them are told as not valid. Whatever fails in
/// one part is told there and does not end the others.
///
/// # Errors
/// Options that make no sense, a trim that leaves the surface, a part that does not fit the printer, a waffle board that
/// does not fit the stock, a library that cannot do the whole solid.
pub fn make_mold(sheet: &SheetSurface, options: &MoldOptions) -> Result<Mold, MoldError> {
    make_mold_watched(sheet, options, &mut |_| {})
}

/// [`make_mold`] that tells `watch`, on the caller's thread, which share of the parts is made: after each, so that the
/// last word is 1.
///
/// # Errors
/// As [`make_mold`].
pub fn make_mold_watched(
    sheet: &SheetSurface,
    options: &MoldOptions,
    watch: &mut dyn FnMut(f64),
) -> Result<Mold, MoldError> {
    options.check()?;
    let lying = triangulate(sheet, &TrimIndex::new(sheet)?, options.chord_mm)?;
    let (pose, grid) = pose_and_grid(sheet, &lying, options)?;
    grid.require_sane()?;
    let placed = moved(sheet, &pose.mold_from_sheet);
    let top = face(&placed).during(|| "the mold's upper face".into())?;
    let shape = occt::prism(&top, [0.0, 0.0, -options.thickness_mm]).during(|| "the mold".into())?;
    let faults = occt::check(&shape).during(|| "the mold".into())?;
    let volume_mm3 = options.thickness_mm * plan::area_mm2(&placed);
    let patch = lying.moved(&pose.mold_from_sheet);
    let (waffle, grooves) = carried(&patch, options)?;
    let jobs = jobs(patch, &grid, options);
    let common = Common { grid: &grid, grooves: &grooves, options };
    let parts = make_parts(&jobs, &top, &common, options.threads, watch)?;
    let slivers = parts.iter().filter(|p| p.plain_volume_mm3 < options.sliver_mm3);
    let slivers = slivers.map(|p| p.name.clone()).collect();
    let plan = plan::loops(&placed, placed.spline.spacing_mm / PLAN_STEPS_PER_CELL);
    Ok(Mold { pose, shape, faults, volume_mm3, plan, grid, parts, slivers, waffle })
}

impl MoldOptions {
    /// Whether the options make sense, those of waffle, stock and marks included, whatever the sheet.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<(), MoldError> {
        let thickness = Setting::of("mold", "thickness_mm", "mold thickness (mm)");
        thickness.positive(self.thickness_mm)?;
        CELL.positive(self.cell_mm)?;
        let cells = CELLS_MM[0]..=CELLS_MM[1];
        CELL.require(cells.contains(&self.cell_mm), self.cell_mm, "it must be between 1 mm and 100 m")?;
        let printer = Setting::of("mold", "printer_mm", "printer room (mm)");
        self.printer_mm.iter().try_for_each(|&side| printer.positive(side))?;
        let fits = self.thickness_mm <= self.printer_mm[2];
        thickness.require(
            fits,
            self.thickness_mm,
            "it must be less than the height of the printer's room",
        )?;
        let steps = Setting::inner("origin steps");
        let known = (1..=MOST_STEPS).contains(&self.origin_steps);
        steps.require(known, self.origin_steps as f64, "it must be between 1 and 50")?;
        let turn = Setting::inner("turn against the grid (degrees)");
        self.turns_deg.iter().try_for_each(|&t| turn.finite(t))?;
        Setting::inner("sliver volume (mm3)").not_negative(self.sliver_mm3)?;
        Setting::inner("chord error of the mold (mm)").positive(self.chord_mm)?;
        Setting::inner("decimation error (mm)").not_negative(self.decimate_mm)?;
        self.check_pose()?;
        self.marks.iter().try_for_each(MarkOptions::check)?;
        self.waffle.iter().try_for_each(WaffleOptions::check)
    }

    fn check_pose(&self) -> Result<(), MoldError> {
        let PoseChoice::Rotation(rotation) = self.pose else { return Ok(()) };
        let off = (rotation.transpose() * rotation - DMat3::IDENTITY).to_cols_array();
        let turns = rotation.is_finite() && off.iter().all(|e| e.abs() < ROTATION_ERROR);
        let determinant = rotation.determinant();
        let pose = Setting::inner("determinant of the mold's rotation");
        pose.require(turns && determinant > 0.0, determinant, "the matrix must be a rotation")
    }

    fn limits(&self) -> Limits {
        let sliver_mm2 = self.sliver_mm3 / self.thickness_mm;
        let Self { cell_mm, printer_mm, thickness_mm, .. } = *self;
        Limits { cell_mm, sliver_mm2, printer_mm, thickness_mm }
    }
}

/// The pose and the grid that suit each other best. `lying` is the sheet's triangles in its own coordinates.
fn pose_and_grid(
    sheet: &SheetSurface,
    lying: &Patch,
    options: &MoldOptions,
) -> Result<(MoldPose, Grid), MoldError> {
    let upright = find_pose(sheet, &options.pose, options.thickness_mm)?;
    let look = Look::at(sheet)?;
    let step_mm = sheet.spline.spacing_mm / PLAN_STEPS_PER_CELL;
    let mut best = None;
    for &turned_deg in options.turns_deg.iter().chain(options.turns_deg.is_empty().then_some(&0.0)) {
        let turn = DMat3::from_rotation_z(turned_deg.to_radians());
        let pose = look.pose(turn * upright.mold_from_sheet.rotation, options.thickness_mm);
        let loops = plan::loops(&moved(sheet, &pose.mold_from_sheet), step_mm);
        let (grid, score) =
            choose(&loops, &lying.moved(&pose.mold_from_sheet), &options.limits(), options.origin_steps);
        if best.as_ref().is_none_or(|(_, _, b)| better(&score, b)) {
            best = Some((pose, Grid { turned_deg, ..grid }, score));
        }
    }
    let nothing = || MoldError::NoSheet { fault: "no turn to try against the grid".into() };
    best.map(|(pose, grid, _)| (pose, grid)).ok_or_else(nothing)
}

fn carried(patch: &Patch, options: &MoldOptions) -> Result<(Waffle, Vec<Groove>), MoldError> {
    match &options.waffle {
        Some(waffle) => design(&HeightField::new(patch), options.thickness_mm, waffle),
        None => Ok((Waffle::default(), Vec::new())),
    }
}

/// The patch in the grid's squares, slivers joined to their neighbours.
fn jobs(patch: Patch, grid: &Grid, options: &MoldOptions) -> Vec<Job> {
    let cut = CutPatch::new(patch, grid.origin_mm, grid.cell_mm, [grid.columns, grid.rows]);
    let pieces: Vec<Piece> =
        (0..cut.cells.len()).map(|k| measured(cut.cells[k].0, &cut.piece(&[k]), options)).collect();
    let job = |members: Vec<usize>| Job {
        cell: pieces[members[0]].cell,
        squares: members.iter().map(|&m| pieces[m].cell).collect(),
        patch: cut.piece(&members),
    };
    join_slivers(&pieces, &options.limits()).into_iter().map(job).collect()
}

fn measured([column, row]: [usize; 2], patch: &Patch, options: &MoldOptions) -> Piece {
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (lower, upper) = patch.positions.iter().fold(empty, |(a, b), p| (a.min(*p), b.max(*p)));
    let lower = lower - DVec3::Z * options.thickness_mm;
    Piece { cell: Cell { column, row }, area_mm2: patch.plan_area_mm2(), lower, upper }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::MoldError;
    use crate::nest::StockOptions;
    use crate::shapes;

    fn small() -> MoldOptions {
        MoldOptions {
            thickness_mm: 20.0,
            cell_mm: 100.0,
            printer_mm: [130.0; 3],
            sliver_mm3: 10_000.0,
            chord_mm: 0.05,
            waffle: Some(WaffleOptions {
                pitch_mm: 110.0,
                sink_mm: 6.0,
                cover_mm: 8.0,
                ..Default::default()
            }),
            ..Default::default()
        }
    }

    fn require_sound(mold: &Mold) {
        assert!(mold.faults.is_empty(), "{:?}", mold.faults);
        for part in &mold.parts {
            part.check().unwrap();
            assert!(
                part.valid && part.volume_mm3 < part.plain_volume_mm3,
                "{}: {:?}",
                part.name,
                part.faults
            );
            assert!((part.plain_volume_mm3 / part.exact_volume_mm3 - 1.0).abs() < 5e-4, "{}", part.name);
        }
        let sum: f64 = mold.parts.iter().map(|p| p.exact_volume_mm3).sum();
        assert!((sum / mold.volume_mm3 - 1.0).abs() < 1e-6, "{}", sum / mold.volume_mm3 - 1.0);
    }

    #[test]
    fn a_corrugated_mold_is_cut_engraved_and_carried() {
        let sheet = shapes::corrugation(shapes::ellipse(240.0, 150.0));
        let mold = make_mold(&sheet, &small()).unwrap();
        require_sound(&mold);
        let inner: Vec<_> = mold.parts.iter().filter(|p| p.inner).collect();
        assert!(!inner.is_empty());
        for part in inner {
            assert!(
                (part.exact_volume_mm3 / 2e5 - 1.0).abs() < 1e-6,
                "{} {}",
                part.name,
                part.exact_volume_mm3
            );
            assert!((part.plain_volume_mm3 / 2e5 - 1.0).abs() < 1e-9);
        }
        assert!(mold.pose.undercuts.is_empty() && mold.slivers.is_empty());
        let waffle = &mold.waffle;
        assert!(waffle.boards.len() + waffle.dropped.len() > 4 && waffle.boards.len() > 1);
        assert!(waffle.boards.iter().all(|b| !b.slots_mm.is_empty()), "every board crosses another");
    }

    #[test]
    fn threads_change_nothing() {
        let sheet = shapes::cylinder(shapes::ellipse(150.0, 90.0));
        let one = make_mold(&sheet, &MoldOptions { threads: 1, ..small() }).unwrap();
        let three = make_mold(&sheet, &MoldOptions { threads: 3, ..small() }).unwrap();
        assert_eq!(one.parts.len(), three.parts.len());
        for (a, b) in one.parts.iter().zip(&three.parts) {
            assert_eq!((&a.name, &a.solid, a.exact_volume_mm3), (&b.name, &b.solid, b.exact_volume_mm3));
        }
        assert_eq!(one.waffle, three.waffle);
    }

    #[test]
    fn a_flat_mold_has_its_area_times_thickness() {
        let mut sheet = shapes::flat(shapes::rectangle(260.0, 160.0));
        sheet.trim.push(shapes::ellipse(40.0, 30.0).reversed());
        let area: f64 = sheet.trim.iter().map(|c| c.signed_area_mm2()).sum();
        let mold = make_mold(&sheet, &small()).unwrap();
        require_sound(&mold);
        assert!((mold.volume_mm3 / (20.0 * area) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_part_too_high_for_the_printer_is_an_error_with_its_name() {
        let steep = |p: DVec2| DVec3::new(p.x, p.y, if p.x > 0.0 { 2.0 * p.x } else { 0.0 });
        let sheet = shapes::sheet(shapes::rectangle(180.0, 80.0), steep);
        let pose = PoseChoice::Rotation(DMat3::IDENTITY);
        // 90 mm of slope in squares of 100 mm: one part holds 45 mm of it or more, 110 mm high with its thickness.
        let options = MoldOptions { pose, waffle: None, printer_mm: [130.0, 130.0, 100.0], ..small() };
        let refused = make_mold(&sheet, &options);
        let Err(MoldError::PartTooLarge { size_mm, smaller_mm, .. }) = &refused else {
            panic!("{refused:?}")
        };
        assert!(size_mm.z > 100.0 && *smaller_mm < 90.0, "{refused:?}");
        assert!(refused.unwrap_err().to_string().starts_with("part A"));
    }

    #[test]
    fn the_grid_gives_way_to_the_printers_height() {
        // The same slope of one: cut in the middle into even parts, one is 110 mm high.
        let steep = |p: DVec2| DVec3::new(p.x, p.y, p.x.max(0.0));
        let sheet = shapes::sheet(shapes::rectangle(180.0, 80.0), steep);
        let pose = PoseChoice::Rotation(DMat3::IDENTITY);
        let options =
            MoldOptions { pose, waffle: None, marks: None, printer_mm: [130.0, 130.0, 102.0], ..small() };
        let mold = make_mold(&sheet, &options).unwrap();
        assert_eq!(mold.parts.len(), 2);
        assert!(mold.parts.iter().all(|p| p.valid && p.size_mm.z <= 102.0));
    }

    #[test]
    fn the_watch_sees_every_part() {
        let sheet = shapes::cylinder(shapes::ellipse(150.0, 90.0));
        let mut seen = Vec::new();
        let options = MoldOptions { threads: 2, ..small() };
        let mold = make_mold_watched(&sheet, &options, &mut |share| seen.push(share)).unwrap();
        let n = mold.parts.len();
        assert_eq!(seen, (1..=n).map(|k| k as f64 / n as f64).collect::<Vec<_>>());
    }

    #[test]
    fn options_that_make_no_sense_are_refused_at_their_line() {
        let m = MoldOptions::default;
        let waffle = |w: WaffleOptions| MoldOptions { waffle: Some(w), ..m() };
        let w = WaffleOptions::default;
        let stock = |size_mm| waffle(WaffleOptions { stock: StockOptions { size_mm, ..w().stock }, ..w() });
        let mark =
            |text_mm| MoldOptions { marks: Some(MarkOptions { text_mm, ..Default::default() }), ..m() };
        let turned = PoseChoice::Rotation(2.0 * DMat3::IDENTITY);
        let refused = [
            (MoldOptions { cell_mm: 1e-20, ..m() }, ("mold", "cell_mm")),
            (MoldOptions { cell_mm: 1e20, ..m() }, ("mold", "cell_mm")),
            (MoldOptions { thickness_mm: 300.0, ..m() }, ("mold", "thickness_mm")),
            (MoldOptions { origin_steps: 0, ..m() }, ("", "")),
            (MoldOptions { origin_steps: usize::MAX, ..m() }, ("", "")),
            (MoldOptions { turns_deg: vec![f64::NAN], ..m() }, ("", "")),
            (MoldOptions { pose: turned, ..m() }, ("", "")),
            (waffle(WaffleOptions { cutter_mm: 16.0, ..w() }), ("waffle", "cutter_mm")),
            (waffle(WaffleOptions { pitch_mm: 15.0, ..w() }), ("waffle", "pitch_mm")),
            (stock([15.0, 1220.0]), ("waffle", "stock_mm")),
        ];
        for (options, place) in refused {
            assert_eq!(options.check().unwrap_err().place(), place, "{options:?}");
        }
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            let refused = [
                (MoldOptions { thickness_mm: bad, ..m() }, ("mold", "thickness_mm")),
                (MoldOptions { cell_mm: bad, ..m() }, ("mold", "cell_mm")),
                (MoldOptions { printer_mm: [256.0, bad, 256.0], ..m() }, ("mold", "printer_mm")),
                (MoldOptions { sliver_mm3: bad, ..m() }, ("", "")),
                (MoldOptions { chord_mm: bad, ..m() }, ("", "")),
                (MoldOptions { decimate_mm: bad, ..m() }, ("", "")),
                (mark(bad), ("", "")),
                (waffle(WaffleOptions { board_mm: bad, ..w() }), ("waffle", "board_mm")),
                (waffle(WaffleOptions { pitch_mm: bad, ..w() }), ("waffle", "pitch_mm")),
                (waffle(WaffleOptions { clearance_mm: bad, ..w() }), ("waffle", "clearance_mm")),
                (waffle(WaffleOptions { cutter_mm: bad, ..w() }), ("waffle", "cutter_mm")),
                (waffle(WaffleOptions { least_length_mm: bad, ..w() }), ("", "")),
                (stock([2440.0, bad]), ("waffle", "stock_mm")),
            ];
            for (options, place) in refused {
                assert_eq!(options.check().unwrap_err().place(), place, "{options:?}");
            }
        }
        for bad in [f64::NAN, f64::INFINITY] {
            let skew = waffle(WaffleOptions { angle_deg: bad, ..w() });
            assert_eq!(skew.check().unwrap_err().place(), ("waffle", "angle_deg"));
        }
        m().check().unwrap();
    }

    #[test]
    fn undercuts_are_told_and_the_other_parts_made() {
        let width = 210f64.to_radians() * shapes::CYLINDER_RADIUS_MM;
        let sheet = shapes::cylinder(shapes::rectangle(width, 90.0));
        let pose = PoseChoice::Rotation(DMat3::IDENTITY);
        let options = MoldOptions { pose, waffle: None, printer_mm: [300.0; 3], ..small() };
        let mold = make_mold(&sheet, &options).unwrap();
        assert_eq!(mold.pose.undercuts.len(), 2);
        assert!(mold.parts.iter().any(|p| p.valid));
    }

    #[test]
    fn a_whole_mold_holds_all_its_truths() {
        let mold =
            make_mold(&shapes::corrugation(shapes::ellipse(800.0, 400.0)), &MoldOptions::default()).unwrap();
        require_sound(&mold);
        let whole = 221.0 * 221.0 * 50.0;
        let inner: Vec<_> = mold.parts.iter().filter(|p| p.inner).collect();
        assert!(inner.len() > 8);
        assert!(inner.iter().all(|p| (p.exact_volume_mm3 / whole - 1.0).abs() < 1e-8));
        assert!(mold.parts.iter().all(|p| p.marked && p.pieces == 1));
        assert_eq!(mold.waffle.nest.sheets.len(), 1);
    }
}
