//! Rows in the other order: rasters begin in the north, lattices in the south.

use rayon::prelude::*;

/// Rows in the reverse order, as heights; on all threads.
pub(crate) fn turned<T: Copy + Sync>(
    values: &[T],
    columns: usize,
    height: impl Fn(T) -> f32 + Sync,
) -> Vec<f32> {
    let mut heights = vec![0.0; values.len()];
    let rows = heights.par_chunks_mut(columns).zip(values.par_chunks(columns).rev());
    rows.for_each(|(to, from)| to.iter_mut().zip(from).for_each(|(to, &from)| *to = height(from)));
    heights
}

/// Puts rows into the reverse order, where they are; on all threads.
pub(crate) fn turn_rows(values: &mut [f32], columns: usize) {
    let (first, last) = values.split_at_mut(values.len() / columns / 2 * columns);
    let rows = first.par_chunks_exact_mut(columns).zip(last.par_rchunks_exact_mut(columns));
    rows.for_each(|(first, last)| first.swap_with_slice(last));
}
