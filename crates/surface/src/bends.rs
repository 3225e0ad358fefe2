//! How much of a sheet is plane, bends one way, or both.

use crate::LocalShape;
use crate::rulings::{Bend, RulingOptions};

/// Shares of an area; together 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BendShares {
    /// Plane.
    pub plane: f64,
    /// Bent one way: developable, with rulings.
    pub one_way: f64,
    /// Bent both ways.
    pub both_ways: f64,
}

/// The shares of an area, from the shapes of its places and the weights that they stand for. Nothing but zeros without
/// weight.
pub fn bend_shares<'a>(
    places: impl IntoIterator<Item = (&'a LocalShape, f64)>,
    options: &RulingOptions,
) -> BendShares {
    let mut sums = BendShares::default();
    let mut total = 0.0;
    for (shape, weight) in places {
        total += weight;
        match options.bend(shape) {
            Bend::Plane => sums.plane += weight,
            Bend::OneWay => sums.one_way += weight,
            Bend::BothWays => sums.both_ways += weight,
        }
    }
    if total <= 0.0 {
        return BendShares::default();
    }
    BendShares { plane: sums.plane / total, one_way: sums.one_way / total, both_ways: sums.both_ways / total }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::through;
    use glam::DVec2;

    #[test]
    fn a_sheet_of_three_parts_has_their_shares() {
        // Plane up to u = 20, a cylinder up to 60, and from there a bowl, after a step of 4 mm.
        let s = through(1.0, |p| {
            let (along, across) = ((p.x - 20.0).max(0.0), p.y - 50.0);
            let bowl = ((p.x - 60.0) / 4.0).clamp(0.0, 1.0);
            p.extend((along * along + bowl * across * across) / 400.0)
        });
        let places = (0..10_000).map(|k| DVec2::new(f64::from(k / 100) + 0.5, f64::from(k % 100) + 0.5));
        let shapes: Vec<_> = places.filter_map(|p| LocalShape::of(&s.at(p))).collect();
        let options =
            RulingOptions { spacing_mm: 10.0, step_mm: 1.0, most_double_bend: 0.05, flattest_radius_mm: 1e4 };
        let shares = bend_shares(shapes.iter().map(|s| (s, 1.0)), &options);
        assert!((shares.plane - 0.2).abs() < 0.03, "{shares:?}");
        assert!((shares.one_way - 0.4).abs() < 0.06 && (shares.both_ways - 0.4).abs() < 0.06, "{shares:?}");
        assert!((shares.plane + shares.one_way + shares.both_ways - 1.0).abs() < 1e-12);
        assert_eq!(bend_shares([], &options), BendShares::default());
    }
}
