//! CPU time of this thread, memory of this process, and how far a shape is from another.

use softfold_geometry::{DMat3, DVec3};

/// CPU seconds of this thread so far: what others do on the machine does not count.
pub(crate) fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let nanoseconds: f64 = text.split_whitespace().next().expect("a number").parse().expect("a number");
    nanoseconds * 1e-9
}

/// Most memory that this process has had, GB.
pub(crate) fn peak_gb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = text.lines().find_map(|l| l.strip_prefix("VmHWM:")).expect("a line");
    line.split_whitespace().next().expect("a number").parse::<f64>().expect("a number") / 1e6
}

/// Steps of Higham's iteration to the nearest rotation.
const POLAR_STEPS: u32 = 60;

/// Root mean square distance of corresponding points after the best rotation and shift of `points`, mm.
pub(crate) fn rms_mm(points: &[DVec3], targets: &[DVec3]) -> f64 {
    let mean = |p: &[DVec3]| p.iter().sum::<DVec3>() / p.len() as f64;
    let (from, to) = (mean(points), mean(targets));
    let pairs = || points.iter().zip(targets).map(|(p, t)| (*p - from, *t - to));
    let covariance =
        pairs().fold(DMat3::ZERO, |sum, (p, t)| sum + DMat3::from_cols(t * p.x, t * p.y, t * p.z));
    // A flat sheet has no third direction: give it a little of one.
    let scale = covariance.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut rotation = covariance * (1.0 / scale) + DMat3::IDENTITY * 1e-12;
    for _ in 0..POLAR_STEPS {
        rotation = (rotation + rotation.inverse().transpose()) * 0.5;
    }
    let sum: f64 = pairs().map(|(p, t)| (rotation * p).distance_squared(t)).sum();
    (sum / points.len() as f64).sqrt()
}
