//! Area of a trimmed surface, by an integral along its trim.

use crate::plan::{GAUSS, along_trim};
use glam::DVec3;
use softfold_geometry::{SheetSurface, UniformBicubic};

/// Pieces of the trim per lattice cell.
const PIECES_PER_CELL: f64 = 4.0;

/// Area of the surface inside its trim, mm²: by Green's theorem `∮ F dv` along the trim with `F(u, v)` the integral of
/// `|S_u × S_v|` along the lattice's row from its lower end to u, cell by cell. Both by Gauss and Legendre with five
/// nodes a piece: from one knot to the next the integrand is smooth.
pub(crate) fn area_mm2(sheet: &SheetSurface) -> f64 {
    let pieces_mm = sheet.spline.spacing_mm / PIECES_PER_CELL;
    along_trim(&sheet.trim, pieces_mm, |p, tangent| {
        if tangent.y == 0.0 { 0.0 } else { tangent.y * Row::new(&sheet.spline, p.y).area_to(p.x) }
    })
}

/// The surface at one v: a cubic curve in u, and its derivative by v.
struct Row {
    lower: f64,
    spacing_mm: f64,
    poles: Vec<DVec3>,
    across: Vec<DVec3>,
}

impl Row {
    fn new(surface: &UniformBicubic, v: f64) -> Self {
        let h = surface.spacing_mm;
        let lower = surface.domain().0;
        let place = (v - lower.y) / h;
        let cell = place.floor().clamp(0.0, (surface.count[1] - 4) as f64);
        let (values, slopes) = basis(place - cell);
        let first = cell as usize;
        let (poles, across) = surface
            .poles
            .chunks(surface.count[1])
            .map(|column| {
                let near = &column[first..first + 4];
                let sum = |weights: [f64; 4]| weights.iter().zip(near).map(|(w, p)| *w * *p).sum::<DVec3>();
                (sum(values), sum(slopes) / h)
            })
            .unzip();
        Self { lower: lower.x, spacing_mm: h, poles, across }
    }

    /// Area of a strip of unit height from the lower end to u.
    fn area_to(&self, u: f64) -> f64 {
        let place = (u - self.lower) / self.spacing_mm;
        let last = place.floor().clamp(0.0, (self.poles.len() - 4) as f64);
        let whole: f64 = (0..last as usize).map(|cell| self.area_in(cell, 1.0)).sum();
        (whole + self.area_in(last as usize, place - last)) * self.spacing_mm
    }

    /// The same over a share of one cell, in cells.
    fn area_in(&self, cell: usize, share: f64) -> f64 {
        let at = |(node, weight): (f64, f64)| {
            let (values, slopes) = basis(0.5 * share * (1.0 + node));
            let sum = |weights: [f64; 4], of: &[DVec3]| -> DVec3 {
                weights.iter().zip(&of[cell..cell + 4]).map(|(w, p)| *w * *p).sum()
            };
            let along = sum(slopes, &self.poles) / self.spacing_mm;
            0.5 * share * weight * along.cross(sum(values, &self.across)).length()
        };
        GAUSS.into_iter().map(at).sum()
    }
}

/// The four uniform cubic B-splines that are not zero at `t` of a cell, and their derivatives by `t`.
fn basis(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    let inner = |x: f64| (3.0 * x * x * (x - 2.0) + 4.0) / 6.0;
    let slope = |x: f64| 0.5 * x * (3.0 * x - 4.0);
    ([s * s * s / 6.0, inner(t), inner(s), t * t * t / 6.0], [-0.5 * s * s, slope(t), -slope(s), 0.5 * t * t])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use crate::spline::face;
    use glam::DVec2;
    use softfold_kernel::occt;

    /// A corner of the sheet with straight sides across the lattice, holes that cut cells, and bends of 25 mm radius.
    fn creased() -> SheetSurface {
        let fold = |p: DVec2| {
            let x = p.x + 0.3 * p.y;
            DVec3::new(p.x, p.y, 20.0 * (x / 37.0).sin() + 0.4 * ((p.y - 0.2 * p.x).powi(2) + 625.0).sqrt())
        };
        let mut sheet = shapes::sheet(shapes::ellipse(151.3, 92.7), fold);
        sheet.trim.push(shapes::ellipse(33.1, 17.9).reversed());
        sheet
    }

    #[test]
    fn it_agrees_with_opencascade() {
        let rectangle = shapes::rectangle(203.7, 81.3);
        for sheet in [
            creased(),
            shapes::sheet(rectangle.clone(), |p| DVec3::new(p.x, p.y, 0.004 * p.x * p.y)),
            shapes::corrugation(shapes::ellipse(150.0, 90.0)),
            shapes::cylinder(shapes::rectangle(200.0, 80.0)),
        ] {
            let occt = occt::area(&face(&sheet).unwrap()).unwrap();
            let share = area_mm2(&sheet) / occt - 1.0;
            assert!(share.abs() < 1e-7, "{share:e}");
        }
    }

    #[test]
    fn a_flat_sheet_and_a_developable_one_keep_the_area_of_the_outline() {
        let ellipse = shapes::ellipse(150.0, 90.0);
        let exact = ellipse.signed_area_mm2();
        assert!((area_mm2(&shapes::flat(ellipse.clone())) / exact - 1.0).abs() < 1e-10);
        // The spline through knots 10 mm apart is off in curvature, not in length, by h²/(12 r²).
        assert!((area_mm2(&shapes::cylinder(ellipse)) / exact - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_row_is_the_surface() {
        let sheet = creased();
        let (p, h) = (DVec2::new(13.7, -41.2), 1e-3);
        let row = Row::new(&sheet.spline, p.y);
        let [su, sv] = sheet.spline.at(p).first;
        let found = (row.area_to(p.x + h) - row.area_to(p.x - h)) / (2.0 * h);
        assert!((found - su.cross(sv).length()).abs() < 1e-7);
    }
}
