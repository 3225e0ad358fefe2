//! The surface of a folded sheet: spacing and smoothing are found where the first choice does not do.

use crate::analyse::loops;
use crate::fitting::{Firmness, Fitting, Problem, Solution};
use crate::lattice::Lattice;
use crate::layout::Cut;
use crate::scale::{MIDDLE, NARROW_SHARE, strip_width_mm};
use crate::{Cage, SurfaceError};
use glam::DVec2;
use softfold_geometry::{FoldedSheet, PlanarCurve, SheetSurface, polygon};

/// Largest distance of the folded vertices that is aimed at, mm: a tenth of what a mill or a printer of molds holds.
const TOLERANCE_MM: f64 = 0.05;
/// Measured on bends by 90° of radius 30 in 3 to 6 strips, at several slants: vertices within [`TOLERANCE_MM`] at the
/// first or second spacing, smallest radius 10 to 13 % below the bend's. Less gains nothing; much less leaves the
/// spacing that is coarser than the strips ill-determined.
const BENDING_WEIGHT: f64 = 5e-4;
/// Cells past the outline: room for offsets, and a border that the data does not feel.
const MARGIN_CELLS: u32 = 3;
/// The border ring of the cage is no uniform bicubic, so that the sheet must end one cell before it.
const LEAST_MARGIN_CELLS: u32 = 1;
/// Beyond this the lattice is nothing but margin.
const MOST_MARGIN_CELLS: u32 = 100;
/// First spacing, in strip widths: coarser than the strips, so that the fit still averages over them.
const FIRST_SPACING: f64 = 1.25;
/// Ratio of a spacing to the one before it; the error falls with the second to fourth power.
const REFINEMENT: f64 = 0.7;
/// How much less smoothing is tried with several faces.
const LIGHTER: f64 = 0.01;
/// A spacing below this share of the least one is out of reach.
const FAR_BELOW: f64 = 0.5;
/// Least spacing, in strip widths: two cells a strip follow any vertex; finer ones follow nothing that is there.
const LEAST_SPACING: f64 = 0.5;
/// Ratio of a bending weight to the one before it, once the spacing is least.
const RELAXATION: f64 = 0.1;
/// How often the bending weight is lowered: below 1e-3 of its value the surface passes through the vertices anyway.
const MOST_RELAXATIONS: usize = 3;
/// Largest distance between two faces along the crease that they share, mm: half of 1e-6 mm, within which the faces shall be
/// one; the other half is for the edge's own curve.
pub(crate) const GAP_MM: f64 = 5e-7;
/// Most poles of a lattice: about 1 GB of memory and some seconds a solve, measured.
const MOST_POLES: usize = 250_000;
/// Most poles of several faces together, whose search solves twice as often: what more would follow are the tips of creases.
const MOST_POLES_OF_FACES: f64 = 100_000.0;

/// Options of [`fit`].
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Spacing of the lattice, mm; none lets it be found.
    pub spacing_mm: Option<f64>,
    /// Largest distance to the folded vertices that is aimed at, mm.
    pub tolerance_mm: f64,
    /// Least spacing that is tried, mm; none for half the width of the mesh's strips.
    pub min_spacing_mm: Option<f64>,
    /// Weight of the thin plate's energy against the squared distances, in units of the fourth power of the strip width
    /// (or of the spacing, where that is larger). Waves shorter than about `2π ⁴√weight` of that length are smoothed.
    pub bending_weight: f64,
    /// Cells of the lattice past the outline's box, 1 to 100.
    pub margin_cells: u32,
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        Self {
            spacing_mm: None,
            tolerance_mm: TOLERANCE_MM,
            min_spacing_mm: None,
            bending_weight: BENDING_WEIGHT,
            margin_cells: MARGIN_CELLS,
        }
    }
}

/// A fitted surface and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The surface. Its deviation is the distance of each folded vertex to the surface's point of the same (u, v),
    /// which is never less than that to the surface; the root mean square counts every vertex alike.
    pub surface: SheetSurface,
    /// Its control cage, whose Catmull-Clark limit it is.
    pub cage: Cage,
    /// Spacing of the lattice, mm.
    pub spacing_mm: f64,
    /// Bending weight that was used.
    pub bending_weight: f64,
    /// Whether the deviation is within the tolerance.
    pub tolerance_met: bool,
    /// Why the search ended, in words.
    pub why: String,
}

/// Fits a surface to a folded sheet; `trim` is its outline (counter-clockwise), then its holes (clockwise).
///
/// Minimises `Σ Aᵢ |S(uᵢ) − pᵢ|² + λ ∫ |S_uu|² + 2 |S_uv|² + |S_vv|²` over the poles, A the vertex's share of area;
/// beside the vertices count, with less weight, the middles of the edges at fold lines, lifted onto the arc that the
/// strips stand for. The lattice begins a little coarser than the strips and is refined until every vertex is within the
/// tolerance, or it is as fine as it may be; then the bending weight is lowered. A tolerance that cannot be met is no
/// error: the closest surface is returned and says so.
///
/// The surface has continuous curvature and a soft band has not: where its arc begins the surface rounds the jump over
/// about a spacing and bends 10 to 13 % tighter than the arc further in.
///
/// # Errors
/// Options that make no sense, a sheet without triangles or against its contract, a trim that does not close, and what
/// the solver or OpenSubdiv refuse.
pub fn fit(
    sheet: &FoldedSheet,
    trim: &[PlanarCurve],
    options: &SurfaceOptions,
) -> Result<Fitted, SurfaceError> {
    let found = Search::run(sheet, trim, &[], options)?.1;
    found.into_fitted(trim, options.tolerance_mm).ok_or(SurfaceError::NoTrim)
}

impl SurfaceOptions {
    pub(crate) fn check(&self) -> Result<(), SurfaceError> {
        let lengths = [
            ("spacing_mm", self.spacing_mm, "or leave it out"),
            ("tolerance_mm", Some(self.tolerance_mm), "0.05 for example"),
            ("min_spacing_mm", self.min_spacing_mm, "or leave it out"),
            ("bending_weight", Some(self.bending_weight), "0.001 for example"),
        ];
        for (key, value, mend) in lengths {
            value.map_or(Ok(()), |value| SurfaceError::require_positive(key, value, mend))?;
        }
        let (given, least, most) = (self.margin_cells, LEAST_MARGIN_CELLS, MOST_MARGIN_CELLS);
        match (least..=most).contains(&given) {
            true => Ok(()),
            false => Err(SurfaceError::Margin { given, least, most }),
        }
    }
}

pub(crate) struct Search<'a> {
    problem: &'a Problem,
    options: &'a SurfaceOptions,
    strip_mm: f64,
    /// Width of the strips that the first spacing is told from.
    first_strip_mm: f64,
    bounds: (DVec2, DVec2),
}

/// A solution with the words that go with it.
pub(crate) struct Found {
    pub(crate) solution: Solution,
    pub(crate) bending_weight: f64,
    pub(crate) why: String,
}

impl Search<'_> {
    /// Finds the lattice for a sheet.
    ///
    /// # Errors
    /// As [`fit`].
    pub(crate) fn run(
        sheet: &FoldedSheet,
        trim: &[PlanarCurve],
        cuts: &[Cut],
        options: &SurfaceOptions,
    ) -> Result<(Problem, Found), SurfaceError> {
        options.check()?;
        sheet.check()?;
        let strip_mm = strip_width_mm(&sheet.mesh, NARROW_SHARE).ok_or(SurfaceError::Empty)?;
        let problem = Problem::new(sheet, trim, cuts)?;
        // Where soft becomes sharp most strips are narrower than any lattice should begin with.
        let share = if problem.layout.faces.len() > 1 { MIDDLE } else { NARROW_SHARE };
        let first_strip_mm = strip_width_mm(&sheet.mesh, share).ok_or(SurfaceError::Empty)?;
        let bounds = polygon::bounds(&[sheet.mesh.vertices.clone(), loops(trim)?.concat()].concat());
        let search = Search { problem: &problem, options, strip_mm, first_strip_mm, bounds };
        let found = match options.spacing_mm {
            Some(spacing_mm) => search.given(spacing_mm)?,
            None => search.refine()?,
        };
        Ok((problem, found))
    }

    fn lattice(&self, spacing_mm: f64) -> Lattice {
        Lattice::over(self.bounds, spacing_mm, self.options.margin_cells)
    }

    /// One lattice, as the user wants it.
    fn given(&self, spacing_mm: f64) -> Result<Found, SurfaceError> {
        let lattice = self.lattice(spacing_mm);
        if lattice.vertices() > MOST_POLES {
            let (poles, least_mm) = (lattice.vertices(), self.least_for_memory_mm(MOST_POLES as f64));
            return Err(SurfaceError::TooManyPoles { spacing_mm, poles, limit: MOST_POLES, least_mm });
        }
        let solution =
            self.solve(&self.fitting(spacing_mm)?, self.options.bending_weight, Firmness::Loose)?;
        Ok(self.found(solution, self.options.bending_weight, "spacing as given"))
    }

    fn refine(&self) -> Result<Found, SurfaceError> {
        let (floor_mm, floor) = self.floor();
        let mut spacing_mm = (FIRST_SPACING * self.first_strip_mm).max(floor_mm);
        let mut before = None;
        loop {
            let fitting = self.fitting(spacing_mm)?;
            let solution = self.solve(&fitting, self.options.bending_weight, Firmness::Loose)?;
            if self.meets(&solution) {
                return Ok(self.found(solution, self.options.bending_weight, "spacing found"));
            }
            if let Some(found) = self.lighter(&fitting)? {
                return Ok(found);
            }
            let now = (spacing_mm, solution.deviation.max_mm / self.options.tolerance_mm);
            if spacing_mm <= floor_mm {
                return self.relax(&fitting, solution, floor);
            }
            if before.is_some_and(|before| self.is_out_of_reach(before, now, floor_mm)) {
                return self.relax(&fitting, solution, "finer spacings would not do");
            }
            before = Some(now);
            spacing_mm = (REFINEMENT * spacing_mm).max(floor_mm);
        }
    }

    /// With several faces the smoothing may be what keeps the surface off the ends of creases and slits, where the sheet bends
    /// as tightly as it likes: they are tried with less of it.
    fn lighter(&self, fitting: &Fitting<'_>) -> Result<Option<Found>, SurfaceError> {
        if !self.is_several() {
            return Ok(None);
        }
        let weight = LIGHTER * self.options.bending_weight;
        let solution = self.solve(fitting, weight, Firmness::Loose)?;
        let how = || format!("spacing found, bending weight lowered to {weight:.1e}");
        Ok(self.meets(&solution).then(|| self.found(solution, weight, &how())))
    }

    /// On the finest lattice several faces are held together firmly, if that is all that is left to do.
    fn firmer(
        &self,
        fitting: &Fitting<'_>,
        first: &Solution,
        floor: &str,
    ) -> Result<Option<Found>, SurfaceError> {
        if !self.is_several() || first.deviation.max_mm > self.options.tolerance_mm {
            return Ok(None);
        }
        let weight = self.options.bending_weight;
        let solution = self.solve(fitting, weight, Firmness::Firm)?;
        let how = format!("{floor}, faces held together firmly");
        Ok(self.meets(&solution).then(|| self.found(solution, weight, &how)))
    }

    /// Whether the distance to the vertices falls too slowly, as power of the spacing, for any spacing not far below the least to do: then it
    /// comes from a place that no lattice follows, the tip of a crease for example. Told of several faces alone.
    fn is_out_of_reach(&self, before: (f64, f64), now: (f64, f64), floor_mm: f64) -> bool {
        if now.1 <= 1.0 {
            return false;
        }
        let order = (before.1 / now.1).ln() / (before.0 / now.0).ln();
        let needed_mm = now.0 * now.1.powf(-1.0 / order.max(f64::MIN_POSITIVE));
        self.is_several() && needed_mm < FAR_BELOW * floor_mm
    }

    fn is_several(&self) -> bool {
        self.problem.layout.faces.len() > 1
    }

    /// Lowers the bending weight on the finest lattice.
    fn relax(&self, fitting: &Fitting<'_>, first: Solution, floor: &str) -> Result<Found, SurfaceError> {
        if let Some(found) = self.firmer(fitting, &first, floor)? {
            return Ok(found);
        }
        let (mut best, mut best_weight) = (first, self.options.bending_weight);
        if best.deviation.max_mm <= self.options.tolerance_mm {
            // What is left are faces that part: a lighter surface would only ripple.
            return Ok(self.found(best, best_weight, floor));
        }
        let mut weight = best_weight;
        for _ in 0..MOST_RELAXATIONS {
            weight *= RELAXATION;
            let solution = self.solve(fitting, weight, Firmness::Loose)?;
            if self.off(&solution) < self.off(&best) {
                (best, best_weight) = (solution, weight);
            }
            if self.meets(&best) {
                break;
            }
        }
        Ok(self.found(best, best_weight, &format!("{floor}, bending weight lowered to {best_weight:.1e}")))
    }

    fn fitting(&self, spacing_mm: f64) -> Result<Fitting<'_>, SurfaceError> {
        Fitting::new(self.problem, self.lattice(spacing_mm), self.options.margin_cells)
    }

    fn solve(
        &self,
        fitting: &Fitting<'_>,
        bending_weight: f64,
        firmness: Firmness,
    ) -> Result<Solution, SurfaceError> {
        let length_mm = self.strip_mm.max(fitting.lattice.spacing_mm);
        fitting.solve(bending_weight * length_mm.powi(self.problem.smoothness.power()), firmness, GAP_MM)
    }

    fn meets(&self, solution: &Solution) -> bool {
        solution.deviation.max_mm <= self.options.tolerance_mm && solution.gap_mm.value <= GAP_MM
    }

    /// How far a solution is off, as share of what is allowed.
    fn off(&self, solution: &Solution) -> f64 {
        (solution.deviation.max_mm / self.options.tolerance_mm).max(solution.gap_mm.value / GAP_MM)
    }

    /// The least spacing that is tried, mm, and what makes it so.
    fn floor(&self) -> (f64, &'static str) {
        let (wanted, reason) = match self.options.min_spacing_mm {
            Some(given) => (given, "least spacing (surface.min_spacing_mm) reached"),
            None => (LEAST_SPACING * self.strip_mm, "least spacing (half a strip of the mesh) reached"),
        };
        match self.least_for_memory_mm(self.most_poles()) {
            least if least > wanted => (least, "least spacing (most poles that are tried) reached"),
            _ => (wanted, reason),
        }
    }

    /// Most poles of the whole lattice: several faces have lattices that overlap.
    fn most_poles(&self) -> f64 {
        if !self.is_several() {
            return MOST_POLES as f64;
        }
        let area = |(lo, hi): (DVec2, DVec2)| (hi - lo).element_product();
        let layout = &self.problem.layout;
        let faces: f64 = (0..layout.faces.len()).map(|f| area(layout.bounds(f))).sum();
        MOST_POLES_OF_FACES / (faces / area(self.bounds)).max(1.0)
    }

    /// The least spacing whose lattice has no more than `most` poles, mm: `(w/h + c)(l/h + c) = most` with c the margins, the
    /// vertex past the last cell and the rounding up.
    fn least_for_memory_mm(&self, most: f64) -> f64 {
        let size = self.bounds.1 - self.bounds.0;
        let c = 2.0 * f64::from(self.options.margin_cells) + 2.0;
        let (half, rest) = (0.5 * c * (size.x + size.y), most - c * c);
        (half + (half * half + rest * size.x * size.y).sqrt()) / rest
    }

    fn found(&self, solution: Solution, bending_weight: f64, how: &str) -> Found {
        let (d, gap, tolerance) = (solution.deviation, solution.gap_mm, self.options.tolerance_mm);
        let mut verdict = match d.max_mm <= tolerance {
            true => format!("within {tolerance} mm"),
            false => format!(
                "{:.3} mm off at ({:.1}, {:.1}), more than the {tolerance} mm of surface.tolerance_mm",
                d.max_mm, d.at.x, d.at.y
            ),
        };
        if gap.value > GAP_MM {
            let (gap, at) = (gap.value, gap.at);
            verdict += &format!("; faces part by {gap:.1e} mm along a crease at ({:.1}, {:.1})", at.x, at.y);
        }
        Found { solution, bending_weight, why: format!("{how}: {verdict}") }
    }
}

impl Found {
    /// The only face as a surface; none if there are several.
    fn into_fitted(self, trim: &[PlanarCurve], tolerance_mm: f64) -> Option<Fitted> {
        let Solution { spacing_mm, mut faces, deviation, .. } = self.solution;
        let (lattice, spline) = faces.pop()?;
        Some(Fitted {
            cage: lattice.cage(spline.poles.clone()),
            surface: SheetSurface { spline, trim: trim.to_vec(), deviation },
            spacing_mm,
            bending_weight: self.bending_weight,
            tolerance_met: deviation.max_mm <= tolerance_mm,
            why: self.why,
        })
    }
}
