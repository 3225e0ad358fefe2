//! Rulings: the lines along which a sheet that bends one way only is straight.

use crate::LocalShape;
use glam::{DVec2, DVec3};
use softfold_geometry::SurfacePoint;
use std::collections::BTreeMap;

/// Where rulings are looked for, and what counts as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RulingOptions {
    /// Least distance between rulings where they begin, mm.
    pub spacing_mm: f64,
    /// Step along them, mm.
    pub step_mm: f64,
    /// Largest |K|/k₁² of a place that counts as developable; 0.2 is a bend five times as wide as the other.
    pub most_double_bend: f64,
    /// Places whose smallest radius is larger than this are plane: every line in them is straight, and none is a ruling.
    pub flattest_radius_mm: f64,
}

/// Largest |K|/k₁² where nothing is said: an elastic sheet that is free to stretch a little bends a little the other way too.
pub const DOUBLE_BEND: f64 = 0.2;
/// A line that leaves the one between its ends by more than this share of its length is no ruling, however little the sheet
/// bends along it: the band of a curved crease has no rulings.
const MOST_BOW: f64 = 0.02;
/// Shortest ruling, in their least distances: shorter ones tell nothing.
const SHORTEST: f64 = 1.5;
/// Halvings of a last step, so that a line ends at the border.
const HALVINGS: u32 = 5;
/// Lines that turn by more than this within a step do not follow rulings; cosine of 20°.
const LEAST_COS: f64 = 0.94;
/// More steps than this each way are a line that goes round in circles.
const MOST_STEPS: usize = 20_000;

/// What a place of the sheet does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bend {
    /// Nothing.
    Plane,
    /// It bends one way: it has a ruling.
    OneWay,
    /// It bends both ways, and is stretched or pressed there.
    BothWays,
}

/// A ruling, from one end to the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Ruling {
    /// Its points on the flat sheet, mm.
    pub flat: Vec<DVec2>,
    /// The same points in space, mm.
    pub space: Vec<DVec3>,
    /// Mean of |K|/k₁² along it: 0 on a true developable.
    pub double_bend: f64,
    /// Farthest point from the straight line between its ends over their distance, on the flat sheet and in space: 0 for
    /// both on a true developable.
    pub bow: [f64; 2],
}

impl RulingOptions {
    /// What a place does.
    pub fn bend(&self, shape: &LocalShape) -> Bend {
        if shape.radius_mm() > self.flattest_radius_mm {
            Bend::Plane
        } else if shape.double_bend() <= self.most_double_bend {
            Bend::OneWay
        } else {
            Bend::BothWays
        }
    }
}

/// Rulings through places of a surface, in their order, none nearer to an earlier one than the spacing. `at` is the
/// surface, or none outside of it.
///
/// A line follows the direction of the smaller curvature (by the midpoint rule) as long as the sheet is developable; it
/// is traced, not drawn straight, so that its bow tells how far it is a ruling.
pub fn rulings(
    at: &impl Fn(DVec2) -> Option<SurfacePoint>,
    seeds: &[DVec2],
    options: &RulingOptions,
) -> Vec<Ruling> {
    let mut near = Near { cell_mm: options.spacing_mm, points: BTreeMap::new() };
    let mut found = Vec::new();
    let field = Field { at, options };
    for seed in seeds.iter().filter(|s| s.is_finite()) {
        if near.any(*seed) {
            continue;
        }
        let Some(ruling) = field.ruling(*seed) else { continue };
        ruling.flat.iter().for_each(|p| near.add(*p));
        found.push(ruling);
    }
    found
}

/// Points in cells as wide as the distance that is asked for.
struct Near {
    cell_mm: f64,
    points: BTreeMap<[i64; 2], Vec<DVec2>>,
}

impl Near {
    fn cell(&self, p: DVec2) -> [i64; 2] {
        (p / self.cell_mm).floor().to_array().map(|x| x as i64)
    }

    fn add(&mut self, p: DVec2) {
        self.points.entry(self.cell(p)).or_default().push(p);
    }

    fn any(&self, p: DVec2) -> bool {
        let [i, j] = self.cell(p);
        let cells = (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| [i, j]));
        cells.filter_map(|c| self.points.get(&c)).flatten().any(|q| q.distance(p) < self.cell_mm)
    }
}

/// Directions of rulings.
struct Field<'a, F> {
    at: &'a F,
    options: &'a RulingOptions,
}

/// A place on a ruling.
#[derive(Clone, Copy)]
struct Place {
    flat: DVec2,
    shape: LocalShape,
    along: DVec2,
}

impl<F: Fn(DVec2) -> Option<SurfacePoint>> Field<'_, F> {
    /// The place, if it has a ruling that goes on from `before` without a sharp turn.
    fn place(&self, flat: DVec2, before: Option<DVec2>) -> Option<Place> {
        let shape = LocalShape::of(&(self.at)(flat)?)?;
        let (own, _) = shape.ruling();
        let along = before.map_or(own, |b| own * own.dot(b).signum());
        let goes_on = before.is_none_or(|b| along.dot(b) >= LEAST_COS);
        (goes_on && self.options.bend(&shape) == Bend::OneWay).then_some(Place { flat, shape, along })
    }

    /// One step by the midpoint rule.
    fn next(&self, from: &Place, step_mm: f64) -> Option<Place> {
        let middle = self.place(from.flat + 0.5 * step_mm * from.along, Some(from.along))?;
        self.place(from.flat + step_mm * middle.along, Some(middle.along))
    }

    /// All places one way; the last step is shortened until it fits.
    fn way(&self, from: Place) -> Vec<Place> {
        let mut places = vec![from];
        let (mut step_mm, mut halvings) = (self.options.step_mm, 0);
        while halvings <= HALVINGS && places.len() < MOST_STEPS {
            match places.last().and_then(|p| self.next(p, step_mm)) {
                Some(place) => places.push(place),
                None => (step_mm, halvings) = (0.5 * step_mm, halvings + 1),
            }
        }
        places
    }

    /// None where it would be short or bent.
    fn ruling(&self, seed: DVec2) -> Option<Ruling> {
        let start = self.place(seed, None)?;
        let mut places = self.way(Place { along: -start.along, ..start });
        places.reverse();
        places.extend(self.way(start).into_iter().skip(1));
        let flat: Vec<DVec2> = places.iter().map(|p| p.flat).collect();
        let space: Vec<DVec3> = places.iter().map(|p| p.shape.position).collect();
        let lifted: Vec<DVec3> = flat.iter().map(|p| p.extend(0.0)).collect();
        let sum: f64 = places.iter().map(|p| p.shape.double_bend()).sum();
        let double_bend = sum / places.len() as f64;
        let bow = [bow(&lifted)?, bow(&space)?];
        let long = flat[0].distance(flat[flat.len() - 1]) >= SHORTEST * self.options.spacing_mm;
        let straight = bow.iter().all(|b| *b <= MOST_BOW);
        (long && straight).then_some(Ruling { flat, space, double_bend, bow })
    }
}

/// Farthest point from the line between the ends over their distance.
fn bow(points: &[DVec3]) -> Option<f64> {
    let (a, b) = (*points.first()?, *points.last()?);
    let along = (b - a).try_normalize()?;
    let off = |p: &DVec3| (*p - a).cross(along).length();
    Some(points.iter().map(off).fold(0.0, f64::max) / a.distance(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Developable, through};
    use softfold_geometry::UniformBicubic;

    const OPTIONS: RulingOptions = RulingOptions {
        spacing_mm: 10.0,
        step_mm: 1.0,
        most_double_bend: DOUBLE_BEND,
        flattest_radius_mm: 2e4,
    };

    /// Rulings of a surface over 0..100, through a lattice of places.
    fn of(s: &UniformBicubic) -> Vec<Ruling> {
        let inside = |p: DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::splat(100.0)).all();
        let at = |p: DVec2| inside(p).then(|| s.at(p));
        let seeds: Vec<DVec2> = (0..100)
            .map(|k| DVec2::new(5.0 + 10.0 * f64::from(k / 10), 5.0 + 10.0 * f64::from(k % 10)))
            .collect();
        rulings(&at, &seeds, &OPTIONS)
    }

    #[test]
    fn rulings_of_a_slanting_cylinder_are_parallel_straight_and_run_to_the_border() {
        let slant = DVec2::from_angle(0.4);
        let s = through(1.0, |p| {
            let (along, across) = (p.dot(slant), p.perp_dot(slant) / 80.0);
            DVec3::new(along, -80.0 * across.sin(), 80.0 * (1.0 - across.cos()))
        });
        let found = of(&s);
        // 131 mm across: so many at least 10 mm apart, less the corners.
        assert!((7..=13).contains(&found.len()), "{}", found.len());
        for r in &found {
            let (first, last) = (r.flat[0], r.flat[r.flat.len() - 1]);
            assert!((last - first).normalize().perp_dot(slant).abs() < 1e-4, "{first} {last}");
            assert!(r.bow.iter().all(|b| *b < 1e-4) && r.double_bend < 1e-4, "{:?}", r.bow);
            let to_border = |p: DVec2| p.min_element().min(100.0 - p.max_element());
            assert!(to_border(first) < 0.05 && to_border(last) < 0.05, "{first} {last}");
        }
    }

    #[test]
    fn rulings_of_a_cone_meet_in_its_apex() {
        let (w, apex) = (0.9_f64, DVec2::new(-60.0, -45.0));
        let s = through(1.0, |p| {
            let q = p - apex;
            let (rho, turn) = (q.length(), q.to_angle() / w.sin());
            DVec3::new(rho * w.sin() * turn.cos(), rho * w.sin() * turn.sin(), rho * w.cos())
        });
        let found = of(&s);
        assert!(found.len() >= 6, "{}", found.len());
        for r in &found {
            let (first, last) = (r.flat[0], r.flat[r.flat.len() - 1]);
            let off_mm = (last - first).normalize().perp_dot(apex - first).abs();
            assert!(off_mm < 0.1, "{off_mm}");
            let along = (r.space[r.space.len() - 1] - r.space[0]).normalize();
            assert!(r.space[0].cross(along).length() < 0.2, "the apex is the origin");
        }
    }

    #[test]
    fn rulings_of_a_tangent_developable_make_its_angle_with_the_crease() {
        let side =
            Developable { crease_radius_mm: 300.0, half_fold_rad: 0.6, ruling_rad: 70_f64.to_radians() };
        let s = side.surface(1.0);
        let center = DVec2::new(50.0, side.crease_radius_mm);
        let found = of(&s);
        assert!(found.len() >= 6);
        for r in &found {
            // Through the crease circle at b: as far from its centre as r cos b.
            let (first, last) = (r.flat[0], r.flat[r.flat.len() - 1]);
            let along = (last - first).normalize();
            let from_center_mm = along.perp_dot(center - first).abs();
            let b = (from_center_mm / side.crease_radius_mm).acos().to_degrees();
            assert!((b - 70.0).abs() < 0.03, "{b}");
            assert!(r.bow.iter().all(|b| *b < 1e-4), "{:?}", r.bow);
        }
    }

    #[test]
    fn the_band_of_a_curved_crease_has_no_rulings() {
        // A torus of radii 10 and 200: it bends along by a twentieth only, but its lines are circles.
        let s = through(1.0, |p| {
            let q = p - DVec2::new(50.0, 250.0);
            let across = (q.length() - 200.0) / 10.0;
            let r = 200.0 + 10.0 * across.clamp(-1.2, 1.2).sin();
            let along = q.normalize() * r;
            along.extend(10.0 * across.clamp(-1.2, 1.2).cos())
        });
        let at = |p: DVec2| ((p - DVec2::new(50.0, 250.0)).length() - 200.0).abs().lt(&8.0).then(|| s.at(p));
        let seeds: Vec<DVec2> = (0..20).map(|k| DVec2::new(5.0 * f64::from(k), 52.0)).collect();
        assert!(rulings(&at, &seeds, &OPTIONS).is_empty());
    }

    #[test]
    fn spheres_and_planes_have_no_rulings_and_a_half_and_half_has_them_on_its_half() {
        assert!(of(&through(2.0, |p| p.extend(-(p - 50.0).length_squared() / 400.0))).is_empty());
        assert!(of(&through(2.0, |p| p.extend(0.3 * p.x))).is_empty());
        // Plane up to x = 50, then bent about y.
        let found = of(&through(1.0, |p| p.extend((p.x - 50.0).max(0.0).powi(3) / 3e4)));
        assert!(!found.is_empty());
        assert!(found.iter().flat_map(|r| &r.flat).all(|p| p.x > 49.0));
    }
}
