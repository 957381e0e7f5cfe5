//! The hash by which textures and strokes are scattered: the same on every machine.

/// 32 bits of which each depends on all of those given: `lowbias32` of Wellons 2018, "Prospecting for hash functions", shortened
/// by its last product.
#[inline(always)]
pub fn lowbias32(mut bits: u32) -> u32 {
    bits = (bits ^ (bits >> 15)).wrapping_mul(0x2c1b_3c6d);
    bits = (bits ^ (bits >> 12)).wrapping_mul(0x297a_2d39);
    bits ^ (bits >> 15)
}
