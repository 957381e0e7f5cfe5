//! The Morton (1966) order of rectangles: neighbors along this curve through the plane lie near each other.

use rayon::prelude::*;

use crate::rect::Rect;

/// Returns the place of each rectangle's center along the curve, counted from 0.
pub fn ranks(rects: &[Rect]) -> Vec<u32> {
    let extent = rects.iter().filter(|rect| !rect.is_empty());
    let extent = extent.fold(Rect::EMPTY, |all, rect| all.with(rect.min).with(rect.max));
    let codes = rects.iter().zip(0..).map(|(rect, index)| (code(rect, &extent), index));
    let mut order: Vec<(u64, u32)> = codes.collect();
    order.par_sort_unstable();
    let mut ranks = vec![0; rects.len()];
    for ((_, index), rank) in order.into_iter().zip(0..) {
        ranks[index as usize] = rank;
    }
    ranks
}

/// The distance along the curve through `extent` at a rectangle's center; 0 for a center that is not a number.
fn code(rect: &Rect, extent: &Rect) -> u64 {
    let part = (rect.center() - extent.min) / extent.size();
    let step = |part: f64| (part * f64::from(u32::MAX)) as u32;
    spread(step(part.x)) | spread(step(part.y)) << 1
}

/// The bits of a number with a gap after each.
fn spread(number: u32) -> u64 {
    let mut bits = u64::from(number);
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn the_curve_visits_the_quarters_of_a_square_one_after_another() {
        let square = |x: f64, y: f64| Rect { min: DVec2::new(x, y), max: DVec2::new(x + 1.0, y + 1.0) };
        let squares: Vec<Rect> =
            (0..16).map(|index| square(f64::from(index % 4), f64::from(index / 4))).collect();
        let quarters: Vec<u32> = ranks(&squares).iter().map(|rank| rank / 4).collect();
        assert_eq!(quarters, [0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 3, 3]);
    }
}
