//! Work that is compiled for several sets of instructions, of which the widest that the processor has is chosen at run time.
//!
//! A program for x86-64 may otherwise use the vectors of the first of these processors alone (SSE2, two f64); most have four
//! (AVX2). The results are the same to the last bit: no set of instructions rounds otherwise, and products and sums are not
//! fused unless the code says so.

use fearless_simd::{Level, dispatch};

/// Runs `work` and returns its result. The closure must be inlined to be compiled again: it, and what its loops call, is
/// `#[inline(always)]`.
///
/// Choosing costs some nanoseconds.
#[inline(always)]
pub fn vectorized<T>(work: impl FnOnce() -> T) -> T {
    dispatch!(Level::new(), _simd => work())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wider_vectors_give_the_same_bits_and_fuse_nothing() {
        // Of 1 + 2⁻³⁰, squared, a product that is fused with the sum keeps the last bit.
        let factors: Vec<f64> = (0..100).map(|step| 1.0 + f64::from(step + 1) * 0.5f64.powi(30)).collect();
        #[inline(always)]
        fn rest(factors: &[f64]) -> Vec<f64> {
            factors.iter().map(|&factor| factor * factor - 1.0 / factor).collect()
        }
        let plain = rest(std::hint::black_box(&factors));
        let wide = vectorized(
            #[inline(always)]
            || rest(&factors),
        );
        assert_eq!(
            plain.iter().map(|v| v.to_bits()).collect::<Vec<_>>(),
            wide.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        );
        let fused = factors.iter().map(|&factor| factor.mul_add(factor, -1.0 / factor));
        assert!(plain.iter().zip(fused).any(|(plain, fused)| *plain != fused), "the test tells them apart");
    }
}
