//! Colours that stand for figures.

use colorgrad::{BasisGradient, Gradient};

/// Colours of a legend's bar.
const LEGEND_STOPS: usize = 9;

/// A scale of figures and its colours.
#[derive(Clone, Debug)]
pub struct Scale {
    gradient: BasisGradient,
    lo: f64,
    hi: f64,
    logarithmic: bool,
    reversed: bool,
}

/// The bar beside a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// What the colours stand for, with the unit.
    pub title: String,
    /// Colours from low to high, evenly spaced.
    pub stops: Vec<[u8; 3]>,
    /// The lowest figure, as text.
    pub min: String,
    /// The highest figure, as text.
    pub max: String,
}

impl Scale {
    /// Signed figures: blue below zero, white at it, red above (ColorBrewer RdBu); `limit` is the figure
    /// of the strongest colours.
    pub fn diverging(limit: f64) -> Self {
        let gradient = colorgrad::preset::rd_bu();
        Self { gradient, lo: -limit.abs(), hi: limit.abs(), logarithmic: false, reversed: true }
    }

    /// Figures from `lo` (dark) to `hi` (light), in viridis.
    pub fn sequential(lo: f64, hi: f64) -> Self {
        Self { gradient: colorgrad::preset::viridis(), lo, hi, logarithmic: false, reversed: false }
    }

    /// Positive figures over several orders of size, such as bend radii; the lowest stand out.
    pub fn logarithmic(lo: f64, hi: f64) -> Self {
        Self { logarithmic: true, ..Self::sequential(lo, hi) }
    }

    /// Colour of a figure; those beyond the ends have the ends' colours.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        self.at(self.share(value))
    }

    /// Colours of many figures.
    pub fn colours(&self, values: &[f64]) -> Vec<[u8; 3]> {
        values.iter().map(|&v| self.colour(v)).collect()
    }

    /// The legend of this scale; `ends` are its lowest and highest figure as text.
    pub fn legend(&self, title: impl Into<String>, ends: [String; 2]) -> Legend {
        let stops = (0..LEGEND_STOPS).map(|k| self.at(k as f64 / (LEGEND_STOPS - 1) as f64)).collect();
        let [min, max] = ends;
        Legend { title: title.into(), stops, min, max }
    }

    fn share(&self, value: f64) -> f64 {
        let map = |x: f64| if self.logarithmic { x.max(f64::MIN_POSITIVE).ln() } else { x };
        let (lo, hi) = (map(self.lo), map(self.hi));
        let share = (map(value) - lo) / (hi - lo);
        if share.is_nan() { 0.5 } else { share.clamp(0.0, 1.0) }
    }

    fn at(&self, share: f64) -> [u8; 3] {
        let share = if self.reversed { 1.0 - share } else { share };
        let [r, g, b, _] = self.gradient.at(share as f32).to_rgba8();
        [r, g, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blue_white_red() {
        let s = Scale::diverging(0.01);
        let [low, zero, high] = [-0.01, 0.0, 0.02].map(|v| s.colour(v));
        assert!(
            low[2] > low[0] && high[0] > high[2] && zero.iter().all(|c| *c > 225),
            "{low:?} {zero:?} {high:?}"
        );
        assert_eq!(s.colour(0.01), high);
    }

    #[test]
    fn a_logarithmic_scale_has_its_middle_at_the_geometric_mean() {
        let s = Scale::logarithmic(10.0, 1000.0);
        assert_eq!(s.colour(100.0), Scale::sequential(0.0, 1.0).colour(0.5));
        assert_eq!(s.colour(f64::INFINITY), s.colour(1e4));
        assert_eq!(s.colour(-3.0), s.colour(10.0));
    }

    #[test]
    fn the_legend_runs_from_low_to_high() {
        let s = Scale::sequential(0.0, 2.0);
        let legend = s.legend("radius, mm", ["0".into(), "2".into()]);
        assert_eq!(legend.stops.first(), Some(&s.colour(0.0)));
        assert_eq!(legend.stops.last(), Some(&s.colour(2.0)));
    }
}
