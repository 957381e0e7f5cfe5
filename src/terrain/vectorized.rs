//! Work that is compiled for several sets of instructions, of which the widest that the processor has is chosen at run time.
//!
//! A program for x86-64 may otherwise use the vectors of the first of these processors alone (SSE2, two f64); most have four
//! (AVX2). The results are the same to the last bit: no set of instructions rounds otherwise, and products and sums are not
//! fused unless the code says so.

use fearless_simd::{Level, dispatch};

/// What `work` returns. It must be inlined to be compiled again: it, and what its loops call, is `#[inline(always)]`.
///
/// Choosing costs some nanoseconds.
#[inline(always)]
pub(in crate::terrain) fn vectorized<T>(work: impl FnOnce() -> T) -> T {
    dispatch!(Level::new(), _simd => work())
}
