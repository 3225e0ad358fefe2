//! Orders that keep neighbours together in memory.

use glam::DVec2;

/// Levels of the curve: it tells points apart that are 2⁻³² of the whole width from each other.
const LEVELS: u8 = 32;

/// Numbers of points in their order along a Hilbert curve through their bounds; points in one cell by their number.
pub(crate) fn along_hilbert(points: &[DVec2]) -> Vec<u32> {
    let lo = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let hi = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let scale = f64::from(u32::MAX) / (hi - lo).max_element();
    let cell = |x: f64| (x * scale) as u32;
    let key = |p: &DVec2| fast_hilbert::xy2h(cell(p.x - lo.x), cell(p.y - lo.y), LEVELS);
    let mut keys: Vec<(u64, u32)> = points.iter().enumerate().map(|(i, p)| (key(p), i as u32)).collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, i)| i).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_on_a_grid() {
        let points: Vec<DVec2> =
            (0..1024).map(|i| DVec2::new(f64::from(i % 32), f64::from(i / 32))).collect();
        let order = along_hilbert(&points);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(i, &v)| i == v as usize), "a permutation");
        for w in order.windows(2) {
            assert_eq!(points[w[0] as usize].distance(points[w[1] as usize]), 1.0);
        }
    }

    #[test]
    fn points_that_coincide_or_lie_on_a_line_keep_their_order() {
        assert_eq!(along_hilbert(&[DVec2::ONE; 4]), [0, 1, 2, 3]);
        let line: Vec<DVec2> = (0..8).map(|i| DVec2::new(f64::from(i), 2.0)).collect();
        assert_eq!(along_hilbert(&line), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!(along_hilbert(&[]).is_empty());
    }
}
