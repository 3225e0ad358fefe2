//! Points at small angles move to where the smallest angle around them is largest: free ones anywhere, those on curves
//! along their curve.

use crate::draft::Draft;
use crate::grow::left_of_line;
use crate::tracks::Span;
use crate::triangle::least_tangent;
use glam::DVec2;
use softfold_geometry::VertexId;
use std::f64::consts::FRAC_1_SQRT_2;

/// Directions tried around a free point.
const DIRECTIONS: [DVec2; 8] = {
    let d = FRAC_1_SQRT_2;
    let [x, y] = [DVec2::X, DVec2::Y];
    [
        x,
        DVec2::new(d, d),
        y,
        DVec2::new(-d, d),
        DVec2::NEG_X,
        DVec2::new(-d, -d),
        DVec2::NEG_Y,
        DVec2::new(d, -d),
    ]
};
/// First step, share of the mean distance to the neighbours, how often it is halved, and steps in all.
const FIRST_STEP: f64 = 0.25;
const HALVINGS: u32 = 4;
const STEPS: u32 = 24;
/// What a step must be worth, rad.
const LEAST_GAIN: f64 = 1e-5;
/// A point on a curve keeps this share of both its edges.
const LEAST_LEFT: f64 = 0.3;
/// No move makes a piece shorter than this share of the distance at which curves all but touch: round by round the other
/// share alone would make some as short as nothing.
const LEAST_PIECE: f64 = 0.5;
/// Triangles that the pattern itself makes sharp do not count, but keep this share of the tangent of their smallest angle.
const KEPT_SHARP: f64 = 0.5;
/// Angles from this on are nobody's fault, degrees.
const FINE_DEG: f64 = 30.0;

/// What points move for.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Aim {
    /// The smallest angle around each.
    Least,
    /// The mean of the smallest angles of the triangles around it.
    Mean {
        /// No angle gets smaller than this by it, degrees.
        kept_deg: f64,
    },
}

/// Room to work in.
#[derive(Default)]
pub(crate) struct Settling {
    around: Vec<u32>,
    changed: Vec<u32>,
    ring: Ring,
}

/// The triangles around a vertex, by the sides across from it.
#[derive(Default)]
struct Ring {
    sides: Vec<[DVec2; 2]>,
    /// Those of triangles that the pattern itself makes sharp.
    sharp: Vec<[DVec2; 2]>,
}

impl Settling {
    /// Moves the corners of triangles with smaller angles than that; how many moved.
    pub(crate) fn round(&mut self, draft: &mut Draft<'_>, below_deg: f64, aim: Aim) -> usize {
        let small = below_deg.to_radians().tan();
        let mut asked = vec![false; draft.points().len()];
        for t in 0..draft.net.corners.len() {
            let tangent = least_tangent(draft.places(t));
            if tangent < small && !is_sharp(draft, t, tangent) {
                draft.net.corners[t].iter().for_each(|v| asked[*v as usize] = true);
            }
        }
        let asked = (0..asked.len() as u32).filter(|v| asked[*v as usize]);
        asked.filter(|&v| self.vertex(draft, VertexId(v), aim)).count()
    }

    /// Moves a vertex; whether it did.
    fn vertex(&mut self, draft: &mut Draft<'_>, v: VertexId, aim: Aim) -> bool {
        let is_free = draft.sharp.at(v).is_empty();
        let pair = if is_free { None } else { draft.sharp.slide(&draft.planar, v) };
        if !is_free && pair.is_none() {
            return false;
        }
        self.look_around(draft, v);
        let before = draft.points()[v.index()];
        let moved = match pair {
            Some(pair) => Slide::new(draft, pair).slid(draft, v, &self.ring, aim),
            None => float(draft, v, &self.ring, aim),
        };
        if moved && before != draft.points()[v.index()] {
            draft.moved(v.0, &mut self.changed);
            self.changed.clear();
            return true;
        }
        false
    }

    fn look_around(&mut self, draft: &Draft<'_>, v: VertexId) {
        draft.net.around(v.index(), &mut self.around);
        self.ring.sides.clear();
        self.ring.sharp.clear();
        for &t in &self.around {
            let corners = draft.net.corners[t as usize];
            let k = corners.iter().position(|c| *c == v.0).unwrap_or(0);
            let [a, b] = [1, 2].map(|i| draft.points()[corners[(k + i) % 3] as usize]);
            let tangent = least_tangent([draft.points()[v.index()], a, b]);
            if is_sharp(draft, t as usize, tangent) { &mut self.ring.sharp } else { &mut self.ring.sides }
                .push([a, b]);
        }
    }
}

/// Whether the pattern itself makes a triangle of this least tangent sharp.
fn is_sharp(draft: &Draft<'_>, t: usize, tangent: f64) -> bool {
    tangent < FINE_DEG.to_radians().tan() && draft.is_excused(t)
}

/// What is around a vertex.
#[derive(Clone, Copy)]
struct Angles {
    /// Tangent of the smallest angle.
    least: f64,
    /// Mean of the smallest angles of the triangles, rad.
    mean_rad: f64,
    /// Tangent of the smallest angle of those that the pattern makes sharp.
    sharp: f64,
}

impl Ring {
    /// The angles around a vertex if it were at a place.
    fn angles(&self, place: DVec2) -> Angles {
        let (mut least, mut sum) = (f64::MAX, 0.0);
        for [a, b] in &self.sides {
            let tangent = least_tangent([place, *a, *b]);
            least = least.min(tangent);
            sum += tangent.atan();
        }
        let sharp = self.sharp.iter().map(|[a, b]| least_tangent([place, *a, *b])).fold(f64::MAX, f64::min);
        Angles { least, mean_rad: sum / self.sides.len().max(1) as f64, sharp }
    }

    /// What a place is worth to a vertex, rad.
    fn worth(&self, now: &Angles, place: DVec2, aim: Aim) -> f64 {
        let Angles { least, mean_rad, sharp } = self.angles(place);
        match aim {
            _ if sharp < KEPT_SHARP * now.sharp => f64::MIN,
            _ if least <= 0.0 => f64::MIN,
            Aim::Least => least.atan(),
            Aim::Mean { kept_deg } if least < now.least.min(kept_deg.to_radians().tan()) => f64::MIN,
            Aim::Mean { .. } => mean_rad,
        }
    }

    /// Whether no triangle turns over with the vertex at a place.
    fn holds(&self, place: DVec2) -> bool {
        self.sides.iter().chain(&self.sharp).all(|[a, b]| left_of_line(*a, *b, place) > 0.0)
    }
}

/// Moves a vertex that is on no curve; whether it did.
fn float(draft: &mut Draft<'_>, v: VertexId, ring: &Ring, aim: Aim) -> bool {
    let start = draft.points()[v.index()];
    let all = || ring.sides.iter().chain(&ring.sharp);
    let far: f64 = all().flatten().map(|p| p.distance(start)).sum();
    let step = FIRST_STEP * far / (2 * all().count().max(1)) as f64;
    let now = ring.angles(start);
    let around = |p: DVec2, step: f64| DIRECTIONS.map(|d| p + step * d);
    let best = climb(start, step, around, |p| ring.worth(&now, p, aim));
    let moves = best != start && ring.holds(best);
    if moves {
        draft.planar.graph.points[v.index()] = best;
    }
    moves
}

/// A move along a curve.
struct Slide {
    /// The pieces before and after the vertex.
    pair: [u32; 2],
    spans: [Span; 2],
    /// Their other ends.
    others: [DVec2; 2],
    /// No piece gets shorter than this, mm.
    least_mm: f64,
    chord_mm: f64,
}

impl Slide {
    fn new(draft: &Draft<'_>, pair: [u32; 2]) -> Self {
        let constraints = pair.map(|c| draft.planar.graph.constraints[c as usize].0);
        Self {
            pair,
            spans: pair.map(|c| draft.planar.spans[c as usize]),
            others: [constraints[0][0], constraints[1][1]].map(|w| draft.points()[w.index()]),
            least_mm: LEAST_PIECE * draft.sharp.near_mm,
            chord_mm: draft.chord_mm,
        }
    }

    /// Moves a vertex; whether it did.
    fn slid(&self, draft: &mut Draft<'_>, v: VertexId, ring: &Ring, aim: Aim) -> bool {
        let [before, after] = self.spans;
        let kept = |span: Span| (LEAST_LEFT * span.length_mm()).max(self.least_mm.min(span.length_mm()));
        let (least, most) = (before.from_mm + kept(before), after.to_mm - kept(after));
        let track = &draft.planar.tracks[before.track as usize];
        let now = ring.angles(draft.points()[v.index()]);
        let start_worth = ring.worth(&now, draft.points()[v.index()], aim);
        let value = |s: f64| {
            let p = track.about(s);
            let worth = ring.worth(&now, p, aim);
            if worth > start_worth && self.bends(draft, s, p) { f64::MIN } else { worth }
        };
        let step = FIRST_STEP * 0.5 * (after.to_mm - before.from_mm);
        let around = |s: f64, step: f64| [(s - step).max(least), (s + step).min(most)];
        let best = climb(before.to_mm, step, around, value);
        let place = track.point(best);
        if best == before.to_mm || !ring.holds(place) {
            return false;
        }
        let planar = &mut draft.planar;
        planar.graph.points[v.index()] = place;
        planar.spans[self.pair[0] as usize].to_mm = best;
        planar.spans[self.pair[1] as usize].from_mm = best;
        self.pair.iter().for_each(|&c| planar.turn(c as usize));
        planar.sites[v.index()] =
            planar.site(before.track, best, &planar.graph.constraints[self.pair[0] as usize].1);
        true
    }

    /// Whether an edge would be too far from its curve.
    fn bends(&self, draft: &Draft<'_>, s_mm: f64, p: DVec2) -> bool {
        let [before, after] = self.spans;
        let track = &draft.planar.tracks[before.track as usize];
        let spans = [Span { to_mm: s_mm, ..before }, Span { from_mm: s_mm, ..after }];
        let bent = |(span, ends): (&Span, [DVec2; 2])| track.chord_error_mm(span, ends).0 > self.chord_mm;
        spans.iter().zip([[self.others[0], p], [p, self.others[1]]]).any(bent)
    }
}

/// The best place that is found from a start in shrinking steps.
fn climb<P: Copy, const N: usize>(
    start: P,
    first_step: f64,
    around: impl Fn(P, f64) -> [P; N],
    worth: impl Fn(P) -> f64,
) -> P {
    let (mut place, mut best, mut step, mut halvings) = (start, worth(start), first_step, 0);
    for _ in 0..STEPS {
        let tried = around(place, step).map(|p| (worth(p), p));
        match tried.into_iter().reduce(|a, b| if b.0 > a.0 { b } else { a }) {
            Some((better, p)) if better > best + LEAST_GAIN => (best, place) = (better, p),
            _ if halvings == HALVINGS => break,
            _ => {
                step *= 0.5;
                halvings += 1;
            }
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_point_near_a_side_of_its_hexagon_moves_to_the_middle() {
        let corner = |k: u32| DVec2::from_angle(f64::from(k) * TAU / 6.0);
        let ring = Ring { sides: (0..6).map(|k| [corner(k), corner(k + 1)]).collect(), sharp: vec![] };
        let start = DVec2::new(0.0, -0.8);
        let now = ring.angles(start);
        for aim in [Aim::Least, Aim::Mean { kept_deg: 32.0 }] {
            let around = |p: DVec2, step: f64| DIRECTIONS.map(|d| p + step * d);
            let best = climb(start, 0.25, around, |p| ring.worth(&now, p, aim));
            assert!(best.length() < 0.15, "{best}");
        }
        assert!(ring.holds(start) && !ring.holds(DVec2::new(0.0, -0.9)));
    }
}
