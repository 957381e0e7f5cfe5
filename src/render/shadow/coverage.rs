//! The texels whose centers a triangle covers: the picture's rules of coverage for one sample, for triangles of a few
//! texels.
//!
//! Edge functions run along rows by addition, without the blocks and sample masks of
//! [`cover`](crate::cpu::raster::cover): setting those up would cost more than most triangles here.

use crate::cpu::raster::{PixelWindow, SUBPIXEL_BITS, SubpixelPoint};

/// Calls `visit(column, row)` for every texel in `window` whose center the triangle covers. The corners have a positive
/// [`doubled_area`](crate::cpu::raster::doubled_area).
pub fn cover_centers(corners: &[SubpixelPoint; 3], window: PixelWindow, mut visit: impl FnMut(u32, u32)) {
    let [a, b, c] = *corners;
    let mut edges = [edge(a, b, window.from), edge(b, c, window.from), edge(c, a, window.from)];
    let mut row = window.from[1];
    while row < window.to[1] {
        let [mut first, mut second, mut third] = [edges[0][0], edges[1][0], edges[2][0]];
        let mut column = window.from[0];
        while column < window.to[0] {
            // Negative where one of them is.
            if first | second | third >= 0 {
                visit(column, row);
            }
            first += edges[0][1];
            second += edges[1][1];
            third += edges[2][1];
            column += 1;
        }
        for edge in &mut edges {
            edge[0] += edge[2];
        }
        row += 1;
    }
}

/// An edge's function at the center of a texel, and its change over one texel to the right and one down; negative on
/// the outer side.
fn edge(from: SubpixelPoint, to: SubpixelPoint, first: [u32; 2]) -> [i64; 3] {
    let [along_x, along_y] = [i64::from(to[0]) - i64::from(from[0]), i64::from(to[1]) - i64::from(from[1])];
    let center = |texel: u32| (i64::from(texel) << SUBPIXEL_BITS) + (1 << (SUBPIXEL_BITS - 1));
    let [x, y] = [center(first[0]) - i64::from(from[0]), center(first[1]) - i64::from(from[1])];
    let is_top_left = along_y < 0 || (along_y == 0 && along_x > 0);
    let value = along_x * y - along_y * x - i64::from(!is_top_left);
    [value, -along_y << SUBPIXEL_BITS, along_x << SUBPIXEL_BITS]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::pattern::ONE;
    use crate::cpu::raster::{cover, doubled_area};

    #[test]
    fn the_same_texels_are_covered_as_in_a_picture_of_one_sample() {
        let window = PixelWindow { from: [3, 2], to: [36, 33] };
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Half of the corners lie at texels' centers.
            let part = if state & 1 == 0 { 1 << (SUBPIXEL_BITS - 1) } else { (state >> 3) as i32 & 0x3fff };
            ((state >> 20) as i32 % 50 - 5) * (1 << SUBPIXEL_BITS) + part
        };
        for _ in 0..300 {
            let mut corners = [[random(), random()], [random(), random()], [random(), random()]];
            if doubled_area(&corners) < 0 {
                corners.swap(1, 2);
            }
            if doubled_area(&corners) == 0 {
                continue;
            }
            let (mut ours, mut theirs) = (Vec::new(), Vec::new());
            cover_centers(&corners, window, |x, y| ours.push((y, x)));
            cover(&corners, &ONE, window, |x, y, _| theirs.push((y, x)));
            theirs.sort_unstable();
            assert_eq!(ours, theirs, "{corners:?}");
        }
    }
}
