//! Looking at a surface inside its trim: which (u, v) belong to the sheet, evenly spread over it and along its border.

use crate::MoldError;
use glam::DVec2;
use softfold_geometry::{PlanarCurve, SheetSurface, polygon};

/// Chord error of the polygon that decides what is inside, mm: half the finest thing a part's volume can tell.
const INSIDE_CHORD_MM: f64 = 0.01;
/// Rows that the border's edges are sorted into: a smooth outline of some hundred edges leaves a handful in each.
const ROWS: usize = 64;

/// The trim as polygons, with its edges in rows of equal height so that a point is tested against few of them.
pub(crate) struct TrimIndex {
    /// Outline, then holes, flattened.
    pub(crate) loops: Vec<Vec<DVec2>>,
    lower: DVec2,
    row_mm: f64,
    rows: Vec<Vec<[DVec2; 2]>>,
}

/// A (u, v) of a regular lattice over the sheet, with its place in the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LatticeSample {
    /// Column and row.
    pub(crate) index: [usize; 2],
    /// Place on the sheet.
    pub(crate) uv: DVec2,
}

impl TrimIndex {
    /// The trim of a sheet.
    ///
    /// # Errors
    /// No closed outline of positive area, or one that leaves the surface's domain.
    pub(crate) fn new(sheet: &SheetSurface) -> Result<Self, MoldError> {
        sheet.spline.check()?;
        let index = Self::of_trim(&sheet.trim)?;
        let (lower, upper) = polygon::bounds(&index.loops[0]);
        let (domain_lower, domain_upper) = sheet.spline.domain();
        let slack = DVec2::splat(INSIDE_CHORD_MM);
        if lower.cmplt(domain_lower - slack).any() || upper.cmpgt(domain_upper + slack).any() {
            return Err(MoldError::NoSheet { fault: "the outline leaves the surface's domain".into() });
        }
        Ok(index)
    }

    /// The trim by itself.
    ///
    /// # Errors
    /// No closed outline of positive area.
    pub(crate) fn of_trim(trim: &[PlanarCurve]) -> Result<Self, MoldError> {
        let nothing = |fault: &str| Err(MoldError::NoSheet { fault: fault.into() });
        if trim.is_empty() || trim.iter().any(|c| !c.is_closed()) {
            return nothing("no outline, or a curve that is not closed");
        }
        if trim.iter().map(|c| c.signed_area_mm2()).sum::<f64>() <= 0.0 {
            return nothing("its area is not positive");
        }
        let loops: Vec<_> = trim.iter().map(|c| c.flatten(INSIDE_CHORD_MM)).collect();
        let (lower, upper) = polygon::bounds(&loops[0]);
        Ok(Self::of_loops(loops, lower, upper))
    }

    fn of_loops(loops: Vec<Vec<DVec2>>, lower: DVec2, upper: DVec2) -> Self {
        let row_mm = (upper.y - lower.y) / ROWS as f64;
        let mut index = Self { loops: Vec::new(), lower, row_mm, rows: vec![Vec::new(); ROWS] };
        for (a, b) in loops.iter().flat_map(|l| polygon::edges(l)) {
            for row in index.row(a.y.min(b.y))..=index.row(a.y.max(b.y)) {
                index.rows[row].push([a, b]);
            }
        }
        Self { loops, ..index }
    }

    fn row(&self, v: f64) -> usize {
        (((v - self.lower.y) / self.row_mm).max(0.0) as usize).min(self.rows.len() - 1)
    }

    /// Whether `p` lies on the sheet (even-odd rule).
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        let crosses = |&&[a, b]: &&[DVec2; 2]| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.rows[self.row(p.y)].iter().filter(crosses).count() % 2 == 1
    }

    /// Whether the border passes within `distance_mm` of `p`.
    pub(crate) fn border_within(&self, p: DVec2, distance_mm: f64) -> bool {
        (self.row(p.y - distance_mm)..=self.row(p.y + distance_mm))
            .flat_map(|row| &self.rows[row])
            .any(|&[a, b]| polygon::segment_distance(p, a, b) < distance_mm)
    }

    /// The lattice points of spacing `step_mm` that lie on the sheet, in order.
    pub(crate) fn lattice(&self, step_mm: f64) -> Vec<LatticeSample> {
        let (lower, upper) = polygon::bounds(&self.loops[0]);
        let count = ((upper - lower) / step_mm).ceil();
        let mut samples = Vec::new();
        for i in 0..=count.x as usize {
            for j in 0..=count.y as usize {
                let uv = lower + (DVec2::new(i as f64, j as f64) + 0.5) * step_mm;
                if self.contains(uv) {
                    samples.push(LatticeSample { index: [i, j], uv });
                }
            }
        }
        samples
    }
}

/// Points along the trim's curves, no farther apart than `step_mm`, joints included.
pub(crate) fn border(sheet: &SheetSurface, step_mm: f64) -> Vec<DVec2> {
    sheet.trim.iter().flat_map(|curve| border_of(curve, step_mm)).collect()
}

/// Points along a closed curve, no farther apart than `step_mm`, joints included, the first not repeated.
pub(crate) fn border_of(curve: &PlanarCurve, step_mm: f64) -> Vec<DVec2> {
    let mut points = Vec::new();
    for piece in curve.joints_mm().windows(2) {
        let n = ((piece[1] - piece[0]) / step_mm).ceil().max(1.0) as usize;
        points.extend((0..n).map(|k| curve.point(piece[0] + (piece[1] - piece[0]) * k as f64 / n as f64)));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn inside_agrees_with_the_plain_test() {
        let sheet = shapes::corrugation(shapes::ellipse(150.0, 90.0));
        let index = TrimIndex::new(&sheet).unwrap();
        for k in 0..2000 {
            let p = DVec2::new(((k * 37) % 331) as f64 - 165.0, ((k * 91) % 211) as f64 - 105.0) * 1.013;
            assert_eq!(index.contains(p), polygon::contains(&index.loops[0], p), "{p}");
        }
    }

    #[test]
    fn the_lattice_covers_the_area() {
        let sheet = shapes::flat(shapes::ellipse(150.0, 90.0));
        let count = TrimIndex::new(&sheet).unwrap().lattice(1.0).len() as f64;
        assert!((count - std::f64::consts::PI * 150.0 * 90.0).abs() < 100.0, "{count}");
    }

    #[test]
    fn the_border_is_near_itself_only() {
        let index = TrimIndex::new(&shapes::flat(shapes::rectangle(300.0, 200.0))).unwrap();
        assert!(index.border_within(DVec2::new(148.0, 20.0), 2.1));
        assert!(!index.border_within(DVec2::new(147.0, 20.0), 2.1));
    }

    #[test]
    fn an_outline_outside_the_domain_is_refused() {
        let mut sheet = shapes::flat(shapes::rectangle(300.0, 200.0));
        sheet.trim = vec![shapes::rectangle(900.0, 200.0)];
        assert!(matches!(TrimIndex::new(&sheet), Err(MoldError::NoSheet { .. })));
    }
}
