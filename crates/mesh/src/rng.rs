//! A random sequence that is the same everywhere: SplitMix64 (Steele, Lea, Flood 2014).

/// The generator's state.
pub(crate) struct SplitMix64(pub(crate) u64);

impl SplitMix64 {
    /// Next number in 0..1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_the_published_one() {
        // First output of SplitMix64 from seed 1234567: 6457827717110365317.
        let expected = (6_457_827_717_110_365_317_u64 >> 11) as f64 / (1_u64 << 53) as f64;
        assert_eq!(SplitMix64(1_234_567).unit(), expected);
    }
}
