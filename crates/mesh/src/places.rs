//! Places along a curve that follow the sizing field.

use crate::size::SizeField;
use glam::DVec2;

/// Fewest steps of the numerical integral of 1/size over one gap.
const INTEGRAL_STEPS: usize = 256;
/// Steps on long gaps: so many for every edge of the target's length.
const STEPS_PER_TARGET: f64 = 1.0;
/// Most steps: more than 2 per edge of the longest curves that [`crate::MeshError::TooMany`] lets pass.
const MOST_STEPS: f64 = 1e6;
/// A gap shorter than this many edges is one edge; safely below the 1.5 from which rounding makes it two.
const ONE_EDGE: f64 = 1.4;

/// Places strictly between `from` and `to` at equal shares of ∫ ds/size, along `point`; `least` pieces or more.
pub(crate) fn graded(
    point: impl Fn(f64) -> DVec2,
    from: f64,
    to: f64,
    least: usize,
    sizes: &SizeField,
) -> Vec<f64> {
    let half = 0.5 * (to - from);
    if least <= 1 && 2.0 * half < ONE_EDGE * (sizes.at(point(from + half)) - sizes.fastest() * half) {
        return Vec::new();
    }
    let steps = (STEPS_PER_TARGET * (to - from) / sizes.target_mm()).min(MOST_STEPS) as usize;
    let steps = steps.max(INTEGRAL_STEPS);
    let step = (to - from) / steps as f64;
    let densities = (0..steps).map(|k| step / sizes.at(point(from + (k as f64 + 0.5) * step)));
    let integral = running_sum(densities);
    let pieces = (integral[steps].round() as usize).max(least);
    shares(&integral, pieces).into_iter().map(|share| from + share * step).collect()
}

/// Sums up to each step, from 0 on.
pub(crate) fn running_sum(densities: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut integral = vec![0.0];
    for d in densities {
        integral.push(integral[integral.len() - 1] + d);
    }
    integral
}

/// Where a running sum reaches a share of the whole, in steps.
pub(crate) fn share(integral: &[f64], share: f64) -> f64 {
    reached(integral, integral[integral.len() - 1] * share)
}

/// Where a running sum reaches each of the inner borders of so many equal shares, in steps.
fn shares(integral: &[f64], pieces: usize) -> Vec<f64> {
    let whole = integral[integral.len() - 1];
    (1..pieces).map(|k| reached(integral, whole * k as f64 / pieces as f64)).collect()
}

/// Where an ascending sum reaches a value, in steps.
fn reached(integral: &[f64], wanted: f64) -> f64 {
    let last = integral.len() - 1;
    let i = integral.partition_point(|&v| v <= wanted).clamp(1, last);
    let t = (wanted - integral[i - 1]) / (integral[i] - integral[i - 1]);
    i as f64 - 1.0 + t
}
