//! What many distances come to.

use serde::{Deserialize, Serialize};
use softfold_geometry::DVec3;

/// Bars of a histogram, about.
const BARS: f64 = 40.0;
/// The histogram shows distances up to this many times the 99th percentile; what lies beyond is counted.
const SHOWN: f64 = 1.5;

/// Distances of points from a surface, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// How many points count.
    pub points: usize,
    /// `vertices`, or `spread` for points spread evenly over the area.
    pub sampling: String,
    /// Points that were left out because they are too far away.
    pub left_out: usize,
    /// Points that lie past the other's border: their nearest point is on it, to the side.
    pub past_border: usize,
    /// Largest distance.
    pub max_mm: f64,
    /// The point where it is, after the alignment, in the frame of the second.
    pub max_at_mm: [f64; 3],
    /// Root mean square.
    pub rms_mm: f64,
    /// Mean distance without sign.
    pub mean_mm: f64,
    /// Half of the points are nearer than this; percentiles of the distances without sign, between points linear.
    pub p50_mm: f64,
    /// 90 % are nearer.
    pub p90_mm: f64,
    /// 99 % are nearer.
    pub p99_mm: f64,
    /// With sign: positive on the side that the other's normals point to; none where its triangles do not agree on one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signed: Option<Signed>,
    /// How often which distance occurs.
    pub histogram: Histogram,
}

/// Distances with their sign, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Signed {
    /// Least.
    pub min_mm: f64,
    /// Largest.
    pub max_mm: f64,
    /// Mean.
    pub mean_mm: f64,
    /// Standard deviation about the mean.
    pub deviation_mm: f64,
}

/// Counts of distances, with sign where there is one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// Where the first bar begins, mm.
    pub from_mm: f64,
    /// Width of a bar, mm.
    pub width_mm: f64,
    /// Points per bar.
    pub counts: Vec<usize>,
    /// Points below the first.
    pub below: usize,
    /// Points above the last.
    pub above: usize,
}

impl Figures {
    /// The figures of distances at points, `signed` or not; none without points.
    pub(super) fn of(points: &[DVec3], distances: &[f64], signed: bool) -> Option<Self> {
        let mut sizes: Vec<f64> = distances.iter().map(|d| d.abs()).collect();
        let at = (0..sizes.len()).reduce(|best, i| if sizes[i] > sizes[best] { i } else { best })?;
        let count = sizes.len() as f64;
        let mean = |f: &dyn Fn(f64) -> f64| distances.iter().map(|d| f(*d)).sum::<f64>() / count;
        let (max_mm, middle) = (sizes[at], mean(&|d| d));
        sizes.sort_by(f64::total_cmp);
        let percentiles = [0.5, 0.9, 0.99].map(|p| percentile(&sizes, p));
        let ends = distances.iter().fold([f64::MAX, f64::MIN], |[l, h], d| [l.min(*d), h.max(*d)]);
        let with_sign = Signed {
            min_mm: ends[0],
            max_mm: ends[1],
            mean_mm: middle,
            deviation_mm: mean(&|d| (d - middle).powi(2)).sqrt(),
        };
        Some(Self {
            points: distances.len(),
            max_mm,
            max_at_mm: points[at].to_array(),
            rms_mm: mean(&|d| d * d).sqrt(),
            mean_mm: mean(&f64::abs),
            p50_mm: percentiles[0],
            p90_mm: percentiles[1],
            p99_mm: percentiles[2],
            signed: signed.then_some(with_sign),
            histogram: Histogram::of(distances, ends, SHOWN * percentiles[2]),
            ..Self::default()
        })
    }
}

/// A percentile of sorted values, linear between them.
fn percentile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    below + (place - place.floor()) * (above - below)
}

impl Histogram {
    /// Bars of a round width from multiples of it, over the values or `shown` to either side of zero.
    fn of(values: &[f64], [low, high]: [f64; 2], shown: f64) -> Self {
        let (low, high) = (low.max(-shown), high.min(shown));
        let width_mm = round_up((high - low) / BARS);
        if width_mm.is_nan() || width_mm <= 0.0 {
            return Self { from_mm: low, width_mm: 0.0, counts: vec![values.len()], below: 0, above: 0 };
        }
        let first = (low / width_mm).floor();
        let bars = ((high / width_mm).floor() - first) as usize + 1;
        let (mut counts, mut below, mut above) = (vec![0; bars], 0, 0);
        for v in values {
            let bar = (v / width_mm).floor() - first;
            match bar {
                b if b < 0.0 => below += 1,
                b if b >= bars as f64 => above += 1,
                b => counts[b as usize] += 1,
            }
        }
        Self { from_mm: first * width_mm, width_mm, counts, below, above }
    }
}

/// The next of 1, 2 and 5 times a power of ten; NaN of what is not positive.
fn round_up(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|r| *r >= value).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(values: &[f64]) -> Figures {
        let points: Vec<DVec3> = (0..values.len()).map(|i| DVec3::splat(i as f64)).collect();
        Figures::of(&points, values, true).unwrap()
    }

    #[test]
    fn an_even_distribution_has_its_closed_form_figures() {
        // From −2 to 8 in equal steps: sizes are even from 0 to 2 twice as dense as from 2 to 8.
        let n = 100_001;
        let values: Vec<f64> = (0..n).map(|i| -2.0 + 10.0 * i as f64 / (n - 1) as f64).collect();
        let f = figures(&values);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-3, "{a} {b}");
        near(f.p50_mm, 3.0);
        near(f.p90_mm, 7.0);
        near(f.p99_mm, 7.9);
        near(f.rms_mm, ((8.0_f64.powi(3) + 2.0_f64.powi(3)) / 30.0).sqrt());
        near(f.mean_mm, (32.0 + 2.0) / 10.0);
        let s = f.signed.unwrap();
        near(s.mean_mm, 3.0);
        near(s.deviation_mm, 10.0 / 12.0_f64.sqrt());
        assert_eq!((f.max_mm, f.max_at_mm), (8.0, [100_000.0; 3]));
        let h = &f.histogram;
        assert_eq!(h.counts.iter().sum::<usize>() + h.below + h.above, n);
        assert!((20..=60).contains(&h.counts.len()), "{h:?}");
    }

    #[test]
    fn percentiles_are_linear_between_values_as_in_numpy() {
        assert!((percentile(&[1.0, 2.0, 3.0, 4.0], 0.9) - 3.7).abs() < 1e-12);
        assert_eq!(percentile(&[5.0], 0.99), 5.0);
    }

    #[test]
    fn equal_distances_and_none_at_all_are_no_trouble() {
        let f = figures(&[0.0; 10]);
        assert_eq!((f.max_mm, f.histogram.counts.clone()), (0.0, vec![10]));
        assert_eq!(figures(&[3.0; 4]).p99_mm, 3.0);
        assert!(Figures::of(&[], &[], true).is_none());
    }

    #[test]
    fn outliers_are_counted_and_do_not_squeeze_the_bars() {
        let mut values: Vec<f64> = (0..1000).map(|i| (i as f64 / 500.0) - 1.0).collect();
        values.push(4000.0);
        let h = figures(&values).histogram;
        assert_eq!((h.below, h.above), (0, 1));
        assert!(h.width_mm < 0.2);
    }
}
