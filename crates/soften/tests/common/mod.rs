//! Sheets, curves and softnesses for the tests.

#![allow(clippy::unwrap_used, dead_code, unreachable_pub)] // helpers of tests fail by panicking; not all use all

use softfold_geometry::polygon as polygon_of;
use softfold_geometry::{
    Band, Crease, CreaseId, CreasePattern, DVec2, JunctionRegion, PlanarCurve, Role, Segment, SoftPattern,
    Source,
};
use softfold_soften::{Along, CreaseSoftness, Segments};
use std::collections::BTreeMap;
use std::f64::consts::PI;

pub fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

pub fn polygon(points: &[(f64, f64)]) -> PlanarCurve {
    let mut points: Vec<DVec2> = points.iter().map(|&p| p.into()).collect();
    points.push(points[0]);
    PlanarCurve::polyline(&points).unwrap()
}

pub fn line(a: (f64, f64), b: (f64, f64)) -> PlanarCurve {
    PlanarCurve::polyline(&[a.into(), b.into()]).unwrap()
}

/// A circular arc as cubics of at most 7.5°: radial error below 1e-9 of the radius.
pub fn arc(center: DVec2, radius: f64, from: f64, to: f64) -> PlanarCurve {
    let n = ((to - from).abs() / 0.13).ceil() as usize;
    let step = (to - from) / n as f64;
    let k = 4.0 / 3.0 * (step / 4.0).tan() * radius;
    let at = |a: f64| center + radius * DVec2::from_angle(a);
    let cubic = |i: usize| {
        let (a, b) = (from + step * i as f64, from + step * (i + 1) as f64);
        Segment::Cubic {
            from: at(a),
            c1: at(a) + k * DVec2::from_angle(a).perp(),
            c2: at(b) - k * DVec2::from_angle(b).perp(),
            to: at(b),
        }
    };
    PlanarCurve::new((0..n).map(cubic).collect()).unwrap()
}

pub fn pattern(outline: PlanarCurve, holes: Vec<PlanarCurve>, creases: Vec<PlanarCurve>) -> CreasePattern {
    let crease = |(i, curve): (usize, PlanarCurve)| Crease {
        id: CreaseId::new(i),
        name: format!("c{i}"),
        role: Role::Valley,
        curve,
        fold_angle_rad: None,
        source: Source { element: format!("c{i}"), line: Some(10 + i as u32) },
    };
    let creases = creases.into_iter().enumerate().map(crease).collect();
    CreasePattern { name: "p".into(), outline, holes, slits: Vec::new(), creases }
}

/// 1000 × 600 mm.
pub fn sheet() -> PlanarCurve {
    polygon(&[(0., 0.), (1000., 0.), (1000., 600.), (0., 600.)])
}

pub fn soft(radius_mm: f64, degrees: f64, n: u32) -> CreaseSoftness {
    CreaseSoftness::constant(radius_mm, degrees.to_radians(), Segments::Count(n))
}

/// The radius whose band of `n` strips has this half width.
pub fn radius_of(half_width: f64, degrees: f64, n: u32) -> f64 {
    half_width / (f64::from(n) * (degrees.to_radians() / (2.0 * f64::from(n))).sin())
}

/// An arc of radius 700 about (500, −300), from the left side of the sheet to the right one or a little
/// inside its ends, exactly on the boundary.
pub fn arc_crease() -> PlanarCurve {
    let (c, r) = (v(500.0, -300.0), 700.0);
    let a = (500.0_f64 / r).acos();
    arc(c, r, PI - a, a)
}

/// Radius along the crease, pairs of place and value.
pub fn tapered(radii: &[(f64, f64)], degrees: f64, n: u32) -> CreaseSoftness {
    CreaseSoftness { radius_mm: Along::Places(radii.to_vec()), ..soft(0.0, degrees, n) }
}

/// Straight creases from one point.
pub fn star(center: DVec2, length: f64, degrees: &[f64]) -> Vec<PlanarCurve> {
    let end = |d: &f64| center + length * DVec2::from_angle(d.to_radians());
    degrees.iter().map(|d| PlanarCurve::polyline(&[center, end(d)]).unwrap()).collect()
}

/// Checks that at every station that all lines of a stretch share, their turns add up to the fold angle, and
/// that the outer ones lie `n` strips apart.
pub fn assert_turns_and_widths(band: &Band) {
    for stretch in band.fold_lines.chunk_by(|_, next| next.rank.is_some_and(|k| k > 0)) {
        let mut sums: BTreeMap<u64, (usize, f64, f64, f64)> = BTreeMap::new();
        for line in stretch {
            for (i, s) in line.s_mm.iter().enumerate() {
                let sum = sums.entry(s.to_bits()).or_insert((0, 0.0, f64::MAX, f64::MIN));
                let o = line.offsets_mm[i];
                *sum = (sum.0 + 1, sum.1 + line.turns_rad[i], sum.2.min(o), sum.3.max(o));
            }
        }
        let shared = sums.iter().filter(|(_, sum)| sum.0 == stretch.len());
        let mut count = 0;
        for (s, (_, turn, low, high)) in shared {
            let at = band.at(f64::from_bits(*s)).unwrap();
            assert!((turn - at.fold_angle_rad).abs() < 1e-12);
            let width = if stretch.len() == 1 {
                0.0
            } else {
                f64::from(band.segments) * at.strip_width_mm(band.segments)
            };
            assert!((high - low - width).abs() < 1e-12 * (1.0 + width));
            count += 1;
        }
        assert!(count > 0);
    }
}

/// Checks, pair by pair, that no fold line or side of a junction region crosses another, but for ends that they
/// share and neighbours on one line.
pub fn assert_nothing_crosses(s: &SoftPattern) {
    let lines = s.bands.iter().flat_map(|b| &b.fold_lines).map(|l| l.points.clone());
    let regions = s.junctions.iter().filter(|j| !j.polygon.is_empty());
    let closed = |j: &JunctionRegion| j.polygon.iter().chain(j.polygon.first()).copied().collect();
    let all: Vec<Vec<DVec2>> = lines.chain(regions.map(closed)).collect();
    for (i, a) in all.iter().enumerate() {
        for b in &all[i..] {
            let [(al, ah), (bl, bh)] = [a, b].map(|l| polygon_of::bounds(l));
            if ah.cmplt(bl).any() || bh.cmplt(al).any() {
                continue;
            }
            for x in a.windows(2) {
                for y in b.windows(2).filter(|y| !y.iter().any(|p| x.contains(p))) {
                    let crossing = polygon_of::segment_crossing(x[0], x[1], y[0], y[1]);
                    assert!(crossing.is_none(), "{x:?} crosses {y:?}");
                }
            }
        }
    }
}

/// A cubic from one point to another that swings to the left and back, by so much at most.
pub fn bent(a: DVec2, b: DVec2, by: f64) -> PlanarCurve {
    let out = 4.0 / 3.0 * by * (b - a).normalize().perp();
    PlanarCurve::new(vec![Segment::Cubic {
        from: a,
        c1: a.lerp(b, 0.3) + out,
        c2: a.lerp(b, 0.7) + out,
        to: b,
    }])
    .unwrap()
}
