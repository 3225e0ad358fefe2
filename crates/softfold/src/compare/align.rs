//! Where one body fits onto another: a coarse pose by principal axes, then iterated closest points.
//!
//! The smaller of the two is moved onto the larger, so that a scan of a part of the sheet fits whichever way round it is
//! given. Pairs are weighted by Tukey's function of their distance over its median: what has no partner soon has no
//! weight. Far poses take best rigid motions of whole pairs (Besl and McKay 1992, by [`rigid::kabsch`]); near ones
//! Gauss-Newton steps on the distance along its own direction (Chen and Medioni 1992), which end exactly where copies
//! coincide and hold open sheets by their borders too.

use super::body::{self, Body, Touch};
use super::coarse;
use super::rigid::{self, Row};
use softfold_geometry::{DVec3, RigidTransform};
use softfold_kernel::KernelError;

/// Points of the final steps.
const POINTS: usize = 8000;
/// Points of the search among starts, first, second and last round.
const SEARCH_POINTS: [usize; 3] = [100, 300, 1000];
/// Starts that are left after the first and the second round.
const LEFT: [usize; 2] = [32, 6];
/// Steps of whole pairs in the first and the second round, the latter from a given pose too; exact steps in the last round.
const FIRST_STEPS: usize = 4;
const PAIR_STEPS: usize = 20;
const SEARCH_STEPS: usize = 25;
/// Most steps of the final round; copies take about ten.
const MOST_STEPS: usize = 200;
/// Share of the points that count in the choice among starts: the worst may have no partner.
const KEPT: f64 = 0.7;
/// Tukey's constant: 95 % efficient where distances are normally distributed, in units of the standard deviation.
const TUKEY: f64 = 4.685;
/// Standard deviation over the median of its size.
const SIGMA_OF_MEDIAN: f64 = 1.4826;
/// Distances below this share of the size are rounding.
const ROUNDING: f64 = 1e-12;
/// Distances below this share of the size have no direction of their own: the surface's normal stands for it.
const NO_DIRECTION: f64 = 1e-9;
/// Shortest step, share of the size: the end.
const REST: f64 = 1e-14;
/// Longest last step of an alignment that has come to rest, share of the size.
const AT_REST: f64 = 1e-7;
/// Halvings of a step that makes things worse.
const HALVINGS: u32 = 8;
/// A fit whose kept points are farther off than this share of the size is looked at in the mirror.
const POOR: f64 = 2e-3;
/// The mirror image fits if it is off by less than this share of what the scan itself is off.
const MIRROR_BETTER: f64 = 0.2;

/// How a body was brought onto another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// The motion of the first body.
    pub motion: RigidTransform,
    /// Root mean square distance of the pairs that count, mm.
    pub rms_mm: f64,
    /// Share of the pairs that do not count because they are too far apart.
    pub trimmed: f64,
    /// Steps of the final round.
    pub iterations: usize,
    /// Whether it came to rest.
    pub converged: bool,
    /// How many of the six motions nothing holds: a part of a cylinder slides along itself.
    pub free_motions: u8,
    /// Starts that were tried; 0 for a given pose.
    pub starts: usize,
    /// Whether the fit is poor and the first body's mirror image fits much better.
    pub mirror_fits: bool,
}

/// Brings `a` onto `b`, from a given pose or from one that is found.
///
/// # Errors
/// Numbers that are not finite.
pub(super) fn align(a: &Body, b: &Body, pose: Option<RigidTransform>) -> Result<Alignment, KernelError> {
    let turned = body::moments(&a.mesh).0 > body::moments(&b.mesh).0;
    let (moving, fixed) = if turned { (b, a) } else { (a, b) };
    let start = pose.map(|p| if turned { p.inverse() } else { p });
    let mut found = fit(moving, fixed, start)?;
    found.mirror_fits = pose.is_none() && mirror_fits(moving, fixed, &found)?;
    if turned {
        found.motion = found.motion.inverse();
    }
    Ok(found)
}

fn fit(moving: &Body, fixed: &Body, pose: Option<RigidTransform>) -> Result<Alignment, KernelError> {
    let points = body::spread(&moving.mesh, POINTS);
    let task = Task { points: &points, fixed, size_mm: moving.size_mm().max(fixed.size_mm()) };
    let (start, starts) = match pose {
        Some(pose) => (task.by_pairs(pose, PAIR_STEPS)?, 0),
        None => search(moving, fixed, task.size_mm)?,
    };
    Ok(Alignment { starts, ..task.settle(start, MOST_STEPS)? })
}

/// The best of all starts, round by round with more points and steps; the first of equals.
fn search(moving: &Body, fixed: &Body, size_mm: f64) -> Result<(RigidTransform, usize), KernelError> {
    let mut poses = coarse::starts(&moving.mesh, &fixed.mesh);
    let starts = poses.len();
    for (round, count) in SEARCH_POINTS.into_iter().enumerate() {
        let points = body::spread(&moving.mesh, count);
        let task = Task { points: &points, fixed, size_mm };
        let mut rated = Vec::with_capacity(poses.len());
        for pose in poses {
            let pose = match round {
                0 => task.by_pairs(pose, FIRST_STEPS)?,
                1 => task.by_pairs(pose, PAIR_STEPS)?,
                _ => task.settle(pose, SEARCH_STEPS)?.motion,
            };
            rated.push((task.kept_rms_mm(&pose)?, pose));
        }
        rated.sort_by(|x, y| x.0.total_cmp(&y.0)); // stable
        rated.truncate(LEFT.get(round).copied().unwrap_or(1));
        poses = rated.into_iter().map(|r| r.1).collect();
    }
    Ok((poses.first().copied().unwrap_or(RigidTransform::IDENTITY), starts))
}

/// Whether a poor fit is one because the body is the other's mirror image.
fn mirror_fits(moving: &Body, fixed: &Body, found: &Alignment) -> Result<bool, KernelError> {
    let size_mm = fixed.size_mm();
    let off = |body: &Body, motion: &RigidTransform| {
        let points = body::spread(&body.mesh, SEARCH_POINTS[2]);
        Task { points: &points, fixed, size_mm }.kept_rms_mm(motion)
    };
    let own = off(moving, &found.motion)?;
    if own <= POOR * size_mm {
        return Ok(false);
    }
    let mut mesh = moving.mesh.clone();
    mesh.positions.iter_mut().for_each(|p| p.x = -p.x);
    let mirrored = Body::new(mesh)?;
    let (pose, _) = search(&mirrored, fixed, size_mm)?;
    Ok(off(&mirrored, &pose)? < MIRROR_BETTER * own)
}

/// Points that shall lie on a body.
struct Task<'a> {
    points: &'a [DVec3],
    fixed: &'a Body,
    size_mm: f64,
}

/// Points and their feet in one pose.
struct Pairs {
    points: Vec<DVec3>,
    touches: Vec<Touch>,
    distances: Vec<f64>,
}

impl Task<'_> {
    fn pairs(&self, pose: &RigidTransform) -> Result<Pairs, KernelError> {
        let points: Vec<DVec3> = self.points.iter().map(|p| pose.point(*p)).collect();
        let touches = self.fixed.touch(&points)?;
        let distances = points.iter().zip(&touches).map(|(p, t)| p.distance(t.foot)).collect();
        Ok(Pairs { points, touches, distances })
    }

    /// Root mean square of the nearest [`KEPT`] of the distances, mm.
    fn kept_rms_mm(&self, pose: &RigidTransform) -> Result<f64, KernelError> {
        let mut distances = self.pairs(pose)?.distances;
        distances.sort_by(f64::total_cmp);
        distances.truncate((KEPT * distances.len() as f64).ceil() as usize);
        Ok((distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt())
    }

    /// Where weights end, mm, from the distances' median.
    fn reach_mm(&self, pairs: &Pairs) -> f64 {
        let mut sorted = pairs.distances.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[sorted.len() / 2];
        TUKEY * (SIGMA_OF_MEDIAN * median).max(ROUNDING * self.size_mm)
    }

    /// Steps of whole pairs.
    fn by_pairs(&self, mut pose: RigidTransform, steps: usize) -> Result<RigidTransform, KernelError> {
        for _ in 0..steps {
            let pairs = self.pairs(&pose)?;
            let reach_mm = self.reach_mm(&pairs);
            let of =
                |i: usize| (pairs.points[i], pairs.touches[i].foot, weight(pairs.distances[i], reach_mm));
            let weighted: Vec<_> = (0..pairs.points.len()).map(of).collect();
            match rigid::kabsch(&weighted) {
                Some(motion) => pose = rigid::after(&motion, &pose),
                None => break,
            }
        }
        Ok(pose)
    }

    /// Exact steps until rest.
    fn settle(&self, start: RigidTransform, most: usize) -> Result<Alignment, KernelError> {
        let (mut pose, mut pairs) = (start, self.pairs(&start)?);
        let (mut iterations, mut last_mm, mut free) = (0, f64::INFINITY, 0);
        while iterations < most && last_mm > REST * self.size_mm {
            let reach_mm = self.reach_mm(&pairs);
            let Some(step) = rigid::step(&self.rows(&pairs, reach_mm)) else { break };
            free = step.free;
            iterations += 1;
            let Some((next, next_pairs, share)) = self.improved(&pose, &step, &pairs, reach_mm)? else {
                break;
            };
            last_mm = share * step.length_mm(self.size_mm);
            (pose, pairs) = (next, next_pairs);
        }
        let reach_mm = self.reach_mm(&pairs);
        let near: Vec<f64> = pairs.distances.iter().copied().filter(|d| *d < reach_mm).collect();
        let square = near.iter().map(|d| d * d).sum::<f64>() / near.len().max(1) as f64;
        Ok(Alignment {
            motion: pose,
            rms_mm: square.sqrt(),
            trimmed: 1.0 - near.len() as f64 / pairs.distances.len() as f64,
            iterations,
            converged: last_mm <= AT_REST * self.size_mm || iterations < most,
            free_motions: free,
            starts: 0,
            mirror_fits: false,
        })
    }

    /// The step, halved until the robust sum of squares falls; none if it does not.
    #[allow(clippy::type_complexity)] // pose, its pairs, and how much of the step was taken
    fn improved(
        &self,
        pose: &RigidTransform,
        step: &rigid::Step,
        pairs: &Pairs,
        reach_mm: f64,
    ) -> Result<Option<(RigidTransform, Pairs, f64)>, KernelError> {
        let before = robust_sum(&pairs.distances, reach_mm);
        for halving in 0..HALVINGS {
            let share = 0.5_f64.powi(halving as i32);
            let next = rigid::after(&step.motion(share), pose);
            let next_pairs = self.pairs(&next)?;
            if robust_sum(&next_pairs.distances, reach_mm) < before {
                return Ok(Some((next, next_pairs, share)));
            }
        }
        Ok(None)
    }

    /// One equation a pair: the distance shall vanish along its own direction.
    fn rows(&self, pairs: &Pairs, reach_mm: f64) -> Vec<Row> {
        let row = |i: usize| {
            let (p, t, d) = (pairs.points[i], &pairs.touches[i], pairs.distances[i]);
            let least = if t.border { ROUNDING } else { NO_DIRECTION } * self.size_mm;
            let along = if d > least { (p - t.foot) / d } else { t.normal };
            let by = (t.foot - p).dot(along);
            Row { at: p, along, by, weight: weight(d, reach_mm) }
        };
        (0..pairs.points.len()).map(row).filter(|r| r.weight > 0.0).collect()
    }
}

/// Tukey's weight.
fn weight(distance: f64, reach: f64) -> f64 {
    let t = distance / reach;
    if t < 1.0 { (1.0 - t * t).powi(2) } else { 0.0 }
}

/// Tukey's sum: squares near zero, constant past the reach.
fn robust_sum(distances: &[f64], reach: f64) -> f64 {
    let rho = |d: &f64| {
        let t = (d / reach).min(1.0);
        // 1 − (1 − t²)³ without the loss of digits where t is small.
        t * t * (3.0 - 3.0 * t * t + t.powi(4))
    };
    distances.iter().map(rho).sum()
}
