//! Large vectors whose memory goes back to the system as soon as they are dropped.
//!
//! The allocator of most Linux systems, glibc's, maps a large block by itself and unmaps it when it is freed. But each such
//! block that is freed raises the size from which it does so, up to 32 MiB: after the first lattice of 2049 × 2049 values, all
//! further ones are cut from a heap that is not given back, and parts of several heaps, one a thread, lie idle while the next
//! step needs as much again. A capacity beyond that size keeps the block by itself. Pages that are never written take address
//! space and no memory.

use bytemuck::{Zeroable, zeroed_vec};

/// The size in bytes from which glibc always maps a block by itself, and a little more.
const ALWAYS_MAPPED: usize = (32 << 20) + (64 << 10);

/// Vectors below this size in bytes are left to the allocator: what heaps keep of them is used again.
const LEAST: usize = 4 << 20;

/// The capacity of a vector of `count` values whose memory is given back when it is dropped.
fn returned_capacity<T>(count: usize) -> usize {
    let size = size_of::<T>().max(1);
    if count.saturating_mul(size) < LEAST { count } else { count.max(ALWAYS_MAPPED.div_ceil(size)) }
}

/// `count` zeros, or values that are stored as zeros, such as `false`, in memory that is given back; it is taken page by page
/// as it is written.
pub fn returned_zeros<T: Zeroable>(count: usize) -> Vec<T> {
    let mut zeros = zeroed_vec(returned_capacity::<T>(count));
    zeros.truncate(count);
    zeros
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_as_many_as_wanted_and_large_ones_have_a_block_of_their_own() {
        for count in [0, 1, 1 << 20, 2049 * 2049, 9_000_000] {
            let zeros = returned_zeros::<f32>(count);
            assert!(zeros.len() == count && zeros.iter().all(|&zero| zero == 0.0));
            let bytes = zeros.capacity() * 4;
            assert!(!(LEAST..ALWAYS_MAPPED).contains(&bytes), "{count}: {bytes}");
        }
        assert_eq!(returned_capacity::<bool>(100), 100);
    }
}
