//! The hash by which things are scattered and told apart: the same on every machine.

/// 64 bits of which each depends on all of those given; 0 stays 0. The last step of SplitMix64 (Steele, Lea and Flood 2014, "Fast
/// Splittable Pseudorandom Number Generators").
#[inline(always)]
pub fn split_mix64(number: u64) -> u64 {
    let number = (number ^ (number >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    number ^ (number >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_generator_that_is_published() {
        // The first of Java's SplittableRandom with the seed 0.
        assert_eq!(split_mix64(0x9e37_79b9_7f4a_7c15), 0xe220_a839_7b1d_cdaf);
    }
}
