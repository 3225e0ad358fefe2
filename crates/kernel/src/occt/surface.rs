use super::shape::{Shape, run};
use crate::bridge::occt as ffi;
use crate::buffers::tuples;
use crate::check;
use crate::error::{KernelError, Result};

/// A bicubic, non-rational B-spline surface over (u, v).
///
/// Its domain reaches from the fourth to the fourth last knot, counted with multiplicity, so a uniform knot vector with
/// multiplicity 1 throughout is as good as a clamped one. Operations clamp such a surface to its domain by knot
/// insertion, which does not change it, because many CAD programs take clamped surfaces only.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BsplineSurface {
    /// Poles in mm, rows of `pole_count[1]`: u outer, v inner.
    pub poles: Vec<[f64; 3]>,
    /// How many poles along u and v; at least 4 each.
    pub pole_count: [usize; 2],
    /// Distinct knots along u, ascending.
    pub knots_u: Vec<f64>,
    /// Distinct knots along v, ascending.
    pub knots_v: Vec<f64>,
    /// How often each knot of `knots_u` counts: 1 to 4 at the ends, 1 to 3 between; together `pole_count[0]` + 4.
    pub multiplicities_u: Vec<u32>,
    /// The same along v.
    pub multiplicities_v: Vec<u32>,
}

/// A piece of a trim loop in the (u, v) of its surface.
#[derive(Debug, Clone, PartialEq)]
pub enum TrimCurve {
    /// A straight line.
    Line {
        /// Where it begins.
        from: [f64; 2],
        /// Where it ends.
        to: [f64; 2],
    },
    /// A Bezier curve.
    Bezier {
        /// Its poles: 2 to 26.
        poles: Vec<[f64; 2]>,
    },
}

/// The part of a surface inside of `loops`: the first runs counter-clockwise around it, the others clockwise around
/// holes. Each curve begins where the one before ends, the first where the last ends.
///
/// # Errors
/// A surface whose knots and poles do not fit together; loops that do not join, leave the domain, run the wrong way, or
/// make an invalid face by meeting themselves or each other.
pub fn trimmed_face(surface: &BsplineSurface, loops: &[Vec<TrimCurve>]) -> Result<Shape> {
    const OPERATION: &str = "occt::trimmed_face";
    let flat = surface.checked(OPERATION)?;
    let loops = flat_loops(OPERATION, loops, &[surface])?;
    Shape::made_by(OPERATION, || ffi::trimmed_face(&flat, &loops))
}

/// The solid between two surfaces over one (u, v): both faces trimmed by the same loops (see [`trimmed_face`]) and ruled
/// sides between their edges, which they share. Outward oriented, whichever surface lies above.
///
/// # Errors
/// As for [`trimmed_face`]; and surfaces that meet inside of the loops, as far as a grid of 41 × 41 points over the
/// outline's bounds tells.
pub fn board_solid(
    lower: &BsplineSurface,
    upper: &BsplineSurface,
    loops: &[Vec<TrimCurve>],
) -> Result<Shape> {
    const OPERATION: &str = "occt::board_solid";
    let (flat_lower, flat_upper) = (lower.checked(OPERATION)?, upper.checked(OPERATION)?);
    let loops = flat_loops(OPERATION, loops, &[lower, upper])?;
    Shape::made_by(OPERATION, || ffi::board_solid(&flat_lower, &flat_upper, &loops))
}

/// Points of the surface, mm.
///
/// # Errors
/// A surface whose knots and poles do not fit together; places outside of its domain.
pub fn surface_at(surface: &BsplineSurface, uv: &[[f64; 2]]) -> Result<Vec<[f64; 3]>> {
    const OPERATION: &str = "occt::surface_at";
    let flat = surface.checked(OPERATION)?;
    check::finite(OPERATION, "place", uv)?;
    inside_domain(OPERATION, uv, surface)?;
    let points = run(OPERATION, || ffi::surface_at(&flat, uv.as_flattened()))?;
    Ok(tuples(&points))
}

/// Cubic along u and v.
const DEGREE: u32 = 3;
/// OpenCascade's Bezier curves have degrees up to 25.
const MOST_BEZIER_POLES: usize = 26;
/// Ends of trim curves are the same if they differ by less than this part of the surface's domain.
const JOIN_TOLERANCE: f64 = 1e-9;

impl BsplineSurface {
    /// Least and greatest u, then v.
    ///
    /// # Errors
    /// Knots and poles that do not fit together.
    pub fn domain(&self) -> Result<[[f64; 2]; 2]> {
        self.checked("occt::BsplineSurface::domain")?;
        Ok(self.domain_of_checked())
    }

    fn domain_of_checked(&self) -> [[f64; 2]; 2] {
        [domain(&self.knots_u, &self.multiplicities_u), domain(&self.knots_v, &self.multiplicities_v)]
    }

    pub(super) fn checked(&self, operation: &'static str) -> Result<ffi::FlatSurface> {
        let [count_u, count_v] = self.pole_count;
        check::require(operation, count_u.checked_mul(count_v) == Some(self.poles.len()), || {
            format!("{} poles are not {count_u} × {count_v}", self.poles.len())
        })?;
        check::addressable(operation, "poles", self.poles.len())?;
        check::finite(operation, "pole", &self.poles)?;
        check_knots(operation, "u", count_u, &self.knots_u, &self.multiplicities_u)?;
        check_knots(operation, "v", count_v, &self.knots_v, &self.multiplicities_v)?;
        Ok(ffi::FlatSurface {
            poles: self.poles.as_flattened().to_vec(),
            pole_count_u: count_u as u32,
            pole_count_v: count_v as u32,
            knots_u: self.knots_u.clone(),
            knots_v: self.knots_v.clone(),
            multiplicities_u: self.multiplicities_u.clone(),
            multiplicities_v: self.multiplicities_v.clone(),
        })
    }
}

fn check_knots(
    operation: &'static str,
    axis: &str,
    poles: usize,
    knots: &[f64],
    multiplicities: &[u32],
) -> Result<()> {
    check::require(operation, poles > DEGREE as usize, || format!("{poles} poles along {axis}; at least 4"))?;
    check::require(operation, knots.len() == multiplicities.len() && knots.len() > 1, || {
        format!("{} knots and {} multiplicities along {axis}", knots.len(), multiplicities.len())
    })?;
    let ascending = knots.windows(2).all(|w| w[0] < w[1]) && knots.iter().all(|k| k.is_finite());
    check::require(operation, ascending, || format!("knots along {axis} do not ascend"))?;
    let last = knots.len() - 1;
    let most = |i: usize| if i == 0 || i == last { DEGREE + 1 } else { DEGREE };
    let wrong = multiplicities.iter().enumerate().position(|(i, &m)| m == 0 || m > most(i));
    check::require(operation, wrong.is_none(), || {
        let i = wrong.unwrap_or(0);
        format!("multiplicity {} of knot {i} along {axis} must be 1 to {}", multiplicities[i], most(i))
    })?;
    let sum: usize = multiplicities.iter().map(|&m| m as usize).sum();
    check::require(operation, sum == poles + DEGREE as usize + 1, || {
        format!("multiplicities along {axis} add up to {sum}, but {poles} poles need {}", poles + 4)
    })
}

/// The fourth and the fourth last knot, counted with multiplicity.
fn domain(knots: &[f64], multiplicities: &[u32]) -> [f64; 2] {
    let repeat = |(&knot, &count): (&f64, &u32)| std::iter::repeat_n(knot, count as usize);
    let counted: Vec<f64> = knots.iter().zip(multiplicities).flat_map(repeat).collect();
    [counted[DEGREE as usize], counted[counted.len() - 1 - DEGREE as usize]]
}

fn inside_domain(operation: &'static str, uv: &[[f64; 2]], surface: &BsplineSurface) -> Result<()> {
    let domain = surface.domain_of_checked();
    let slack = join_tolerance(surface);
    let inside = |p: &[f64; 2]| (0..2).all(|k| p[k] >= domain[k][0] - slack && p[k] <= domain[k][1] + slack);
    match uv.iter().find(|p| !inside(p)) {
        None => Ok(()),
        Some(p) => Err(KernelError::input(operation, format!("{p:?} is outside of the domain {domain:?}"))),
    }
}

fn join_tolerance(surface: &BsplineSurface) -> f64 {
    let [u, v] = surface.domain_of_checked();
    JOIN_TOLERANCE * (u[1] - u[0]).max(v[1] - v[0])
}

fn flat_loops(
    operation: &'static str,
    loops: &[Vec<TrimCurve>],
    surfaces: &[&BsplineSurface],
) -> Result<ffi::FlatLoops> {
    check::require(operation, !loops.is_empty(), || "no trim loop".into())?;
    let mut flat = ffi::FlatLoops { poles: vec![], curve_sizes: vec![], loop_sizes: vec![] };
    for (l, curves) in loops.iter().enumerate() {
        let curves = checked_loop(operation, l, curves, surfaces)?;
        flat.loop_sizes.push(curves.len() as u32);
        for poles in curves {
            flat.curve_sizes.push(poles.len() as u32);
            flat.poles.extend(poles.as_flattened());
        }
    }
    Ok(flat)
}

/// The poles of every curve of loop `l`, each beginning exactly where the one before ends.
fn checked_loop(
    operation: &'static str,
    l: usize,
    curves: &[TrimCurve],
    surfaces: &[&BsplineSurface],
) -> Result<Vec<Vec<[f64; 2]>>> {
    check::require(operation, !curves.is_empty(), || format!("trim loop {l} is empty"))?;
    let mut poles: Vec<Vec<[f64; 2]>> = curves.iter().map(TrimCurve::poles).collect();
    let tolerance = surfaces.iter().map(|surface| join_tolerance(surface)).fold(f64::MAX, f64::min);
    for (c, curve) in poles.iter().enumerate() {
        check_curve(operation, &format!("curve {c} of trim loop {l}"), curve, surfaces, tolerance)?;
    }
    if let [single] = poles.as_slice() {
        poles = halves(single); // an edge needs two different ends
    }
    join(operation, l, &mut poles, tolerance)?;
    check_turn(operation, l, &poles)?;
    Ok(poles)
}

pub(super) fn check_curve(
    operation: &'static str,
    name: &str,
    poles: &[[f64; 2]],
    surfaces: &[&BsplineSurface],
    tolerance: f64,
) -> Result<()> {
    let count = poles.len();
    check::require(operation, (2..=MOST_BEZIER_POLES).contains(&count), || {
        format!("{name} has {count} poles; 2 to {MOST_BEZIER_POLES}")
    })?;
    check::finite(operation, &format!("{name}: pole"), poles)?;
    for surface in surfaces {
        inside_domain(operation, poles, surface)?;
    }
    let spread = poles.iter().map(|p| distance(*p, poles[0])).fold(0.0, f64::max);
    check::require(operation, spread > tolerance, || format!("{name} has no length at {:?}", poles[0]))
}

/// Checks that each curve ends where the next begins, and makes it exact.
fn join(operation: &'static str, l: usize, poles: &mut [Vec<[f64; 2]>], tolerance: f64) -> Result<()> {
    for c in 0..poles.len() {
        let next = (c + 1) % poles.len();
        let start = poles[next][0];
        if let Some(end) = poles[c].last_mut() {
            check::require(operation, distance(*end, start) <= tolerance, || {
                format!("trim loop {l}: curve {c} ends at {end:?}, but curve {next} begins at {start:?}")
            })?;
            *end = start;
        }
    }
    Ok(())
}

/// The outer loop must run counter-clockwise, the others clockwise.
fn check_turn(operation: &'static str, l: usize, poles: &[Vec<[f64; 2]>]) -> Result<()> {
    let area: f64 = poles.iter().map(|curve| swept_area(curve)).sum();
    let holds = if l == 0 { area > 0.0 } else { area < 0.0 };
    check::require(operation, holds, || {
        let wanted = if l == 0 { "counter-clockwise" } else { "clockwise, being a hole" };
        format!("trim loop {l} must run {wanted}; its signed area is {area}")
    })
}

/// Area between the origin and a curve, for its sign: chords of a few points stand for the curve.
fn swept_area(poles: &[[f64; 2]]) -> f64 {
    const CHORDS: u32 = 16;
    let steps = if poles.len() == 2 { 1 } else { CHORDS };
    let points: Vec<_> = (0..=steps).map(|i| bezier_at(poles, f64::from(i) / f64::from(steps))).collect();
    points.windows(2).map(|w| 0.5 * (w[0][0] * w[1][1] - w[0][1] * w[1][0])).sum()
}

fn bezier_at(poles: &[[f64; 2]], t: f64) -> [f64; 2] {
    let mut level = poles.to_vec();
    while level.len() > 1 {
        level = casteljau(&level, t);
    }
    level[0]
}

fn casteljau(level: &[[f64; 2]], t: f64) -> Vec<[f64; 2]> {
    level.windows(2).map(|w| [0, 1].map(|k| (1.0 - t) * w[0][k] + t * w[1][k])).collect()
}

/// De Casteljau at the middle.
fn halves(poles: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut level = poles.to_vec();
    let (mut first, mut second) = (vec![level[0]], vec![level[level.len() - 1]]);
    while level.len() > 1 {
        level = casteljau(&level, 0.5);
        first.push(level[0]);
        second.push(level[level.len() - 1]);
    }
    second.reverse();
    vec![first, second]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl TrimCurve {
    pub(super) fn poles(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Line { from, to } => vec![*from, *to],
            Self::Bezier { poles } => poles.clone(),
        }
    }
}
