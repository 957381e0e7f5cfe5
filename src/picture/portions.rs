//! Many small meshes in portions: threads make the next portion while the calling thread keeps the last one.

use std::iter;
use std::mem;

use rayon::prelude::*;

/// Items of which threads make meshes before these are kept: enough that no thread waits, and few beside all lines of a
/// city.
const PORTION: usize = 1024;

/// What `keep` makes, on the calling thread, of what `make` makes of each item on any thread, in the items' order; an item of
/// which `make` makes `None` is left out.
pub(super) fn in_portions<I: Sync, T: Send, K>(
    items: &[I],
    make: impl Fn(&I) -> Option<T> + Sync,
    mut keep: impl FnMut(T) -> K,
) -> Vec<K> {
    let (mut kept, mut made) = (Vec::new(), Vec::new());
    // After the last portion one without items, beside which the last is kept.
    for portion in items.chunks(PORTION).chain(iter::once(&[][..])) {
        let last: Vec<T> = mem::take(&mut made);
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| made = portion.par_iter().filter_map(&make).collect());
            kept.extend(last.into_iter().map(&mut keep));
        });
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_come_out_in_their_order_and_those_without_a_mesh_are_left_out() {
        for count in [0, 1, PORTION, 3 * PORTION + 1] {
            let items: Vec<usize> = (0..count).collect();
            let mut calls = 0;
            let kept = in_portions(
                &items,
                |&item| (item % 3 != 1).then_some(item * 2),
                |made| {
                    calls += 1;
                    made + 1
                },
            );
            let expected: Vec<usize> =
                items.iter().filter(|item| *item % 3 != 1).map(|item| item * 2 + 1).collect();
            assert_eq!((kept, calls), (expected.clone(), expected.len()));
        }
    }
}
