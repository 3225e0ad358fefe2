//! Which curves of a pattern cross each other or themselves, other than where they end.

use rstar::primitives::{GeomWithData, Line};
use rstar::{RTree, RTreeObject};
use softfold_geometry::{DVec2, PlanarCurve};
use std::collections::BTreeSet;

/// A chord with the number of its curve.
type Chord = GeomWithData<Line<[f64; 2]>, usize>;

/// How finely curves are looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fineness {
    /// Distance of the chords that stand for a curve from it, mm.
    pub(crate) chord_mm: f64,
    /// Crossings this near to an end of either curve are where they meet, mm.
    pub(crate) end_mm: f64,
}

/// Pairs of curves that cross, of which the first is one of those `asked` for; a curve that crosses itself is a pair
/// of its own.
pub(crate) fn crossing(
    curves: &[&PlanarCurve],
    asked: &BTreeSet<usize>,
    fineness: Fineness,
) -> BTreeSet<(usize, usize)> {
    let chords = |i: usize| -> Vec<Chord> {
        let points = curves[i].flatten(fineness.chord_mm);
        let line = |w: &[DVec2]| GeomWithData::new(Line::new(w[0].to_array(), w[1].to_array()), i);
        points.windows(2).map(line).collect()
    };
    let tree = RTree::bulk_load((0..curves.len()).flat_map(chords).collect());
    let at_end = |i: usize, p: DVec2| {
        let curve = curves[i];
        !curve.is_closed() && [0, 1].iter().any(|&side| curve.end(side).distance(p) <= fineness.end_mm)
    };
    let mut pairs = BTreeSet::new();
    for chord in tree.iter().filter(|c| asked.contains(&c.data)) {
        for other in tree.locate_in_envelope_intersecting(chord.envelope()) {
            let pair = (chord.data, other.data);
            let met = || meeting(chord.geom(), other.geom());
            if !pairs.contains(&pair) && met().is_some_and(|p| !at_end(pair.0, p) && !at_end(pair.1, p)) {
                pairs.insert(pair);
            }
        }
    }
    pairs
}

/// Where two chords cross, each with an end on either side of the other.
fn meeting(a: &Line<[f64; 2]>, b: &Line<[f64; 2]>) -> Option<DVec2> {
    let [a0, a1, b0, b1] = [a.from, a.to, b.from, b.to].map(DVec2::from);
    let sides = |p: DVec2, q: DVec2, [r, s]: [DVec2; 2]| [(q - p).perp_dot(r - p), (q - p).perp_dot(s - p)];
    let ([l, r], [m, n]) = (sides(a0, a1, [b0, b1]), sides(b0, b1, [a0, a1]));
    (l * r < 0.0 && m * n < 0.0).then(|| a0.lerp(a1, m / (m - n)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINE: Fineness = Fineness { chord_mm: 1e-3, end_mm: 1e-3 };

    fn curve(points: &[[f64; 2]]) -> PlanarCurve {
        PlanarCurve::polyline(&points.iter().map(|&p| p.into()).collect::<Vec<_>>()).unwrap()
    }

    fn pairs(curves: &[PlanarCurve]) -> Vec<(usize, usize)> {
        let all = (0..curves.len()).collect();
        crossing(&curves.iter().collect::<Vec<_>>(), &all, FINE).into_iter().collect()
    }

    #[test]
    fn curves_that_cross_are_found_and_those_that_meet_are_not() {
        let line = curve(&[[0.0, 0.0], [10.0, 0.0]]);
        assert_eq!(pairs(&[line.clone(), curve(&[[5.0, -1.0], [5.0, 1.0]])]), [(0, 1), (1, 0)]);
        assert_eq!(pairs(&[line.clone(), curve(&[[5.0, -1e-9], [5.0, 1.0]])]), []);
        assert_eq!(pairs(&[line, curve(&[[10.0, 0.0], [5.0, 1.0]])]), []);
    }

    #[test]
    fn a_curve_that_crosses_itself_is_found() {
        assert_eq!(pairs(&[curve(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]])]), [(0, 0)]);
        assert_eq!(pairs(&[curve(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [3.0, 1.0]])]), []);
    }
}
