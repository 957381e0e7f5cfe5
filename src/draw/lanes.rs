//! Work on several pixels at once, which is compiled to vectors.
//!
//! What is to be compiled to vectors is a loop over arrays of as many numbers as there are pixels, without a branch, and inlined.
//! Every pixel has the value that it has alone, to the last bit.

use sandtable_base::vectorized::vectorized;

/// How many pixels are worked on at once: two vectors of the processors that have the shortest, one of most others.
pub(crate) const LANES: usize = 8;

/// What `work` makes of each of `items`; `filler` takes the places of those that are missing at the end. `work` is
/// `#[inline(always)]`, with all that it calls.
#[inline(always)]
pub(crate) fn in_lanes<T: Copy, R: Copy>(
    items: &[T],
    filler: T,
    work: impl Fn(&[T; LANES]) -> [R; LANES],
) -> Vec<R> {
    let mut made = Vec::with_capacity(items.len().next_multiple_of(LANES));
    vectorized(
        #[inline(always)]
        || {
            let (whole, rest) = items.as_chunks::<LANES>();
            for lanes in whole {
                made.extend_from_slice(&work(lanes));
            }
            if !rest.is_empty() {
                let mut lanes = [filler; LANES];
                lanes[..rest.len()].copy_from_slice(rest);
                made.extend_from_slice(&work(&lanes)[..rest.len()]);
            }
        },
    );
    made
}

/// A number of each item. Arrays' own `map` is not always inlined.
#[inline(always)]
pub(crate) fn of_each<T, const N: usize>(items: &[T; N], number: impl Fn(&T) -> f32) -> [f32; N] {
    let mut numbers = [0.0; N];
    for (slot, item) in numbers.iter_mut().zip(items) {
        *slot = number(item);
    }
    numbers
}

/// A number clamped to 0..=1; 0 where it is none. Comparisons are compiled to shorter vectors than `clamp`.
#[inline(always)]
pub(crate) fn unit(value: f32) -> f32 {
    let low = if value > 0.0 { value } else { 0.0 };
    if low < 1.0 { low } else { 1.0 }
}

/// The smooth step from 0 to 1 at a part of its way.
#[inline(always)]
pub(crate) fn smooth(part: f32) -> f32 {
    part * part * (3.0 - 2.0 * part)
}

/// What lies at `share` of the way between two numbers.
#[inline(always)]
pub(crate) fn mix(from: f32, to: f32, share: f32) -> f32 {
    from + (to - from) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_item_is_worked_on_once_and_in_order() {
        for count in [0, 1, 7, 8, 9, 40] {
            let items: Vec<u32> = (0..count).collect();
            let made = in_lanes(
                &items,
                99,
                #[inline(always)]
                |lanes| lanes.map(|item| item + 1),
            );
            assert!(made.into_iter().eq(1..=count));
        }
    }

    #[test]
    fn numbers_are_clamped_and_what_is_none_is_0() {
        let clamped = [-1.0, 0.0, 0.3, 1.0, 7.0, f32::NAN, f32::INFINITY].map(unit);
        assert_eq!(clamped, [0.0, 0.0, 0.3, 1.0, 1.0, 0.0, 1.0]);
    }
}
