//! Grounds that are nothing but numbers, the same everywhere.

/// A fractal ground of `n` × `n` posts 10 m apart, heights in metres, row by row; `n` is a power of two and one.
///
/// Midpoint displacement whose deviations shrink with the 0.9th power of the distance, so that every size is as
/// rough per post as every other.
pub fn fractal(n: usize) -> Vec<f32> {
    let mut field = vec![0f32; n * n];
    let mut step = (n - 1) / 2;
    while step > 0 {
        let reach = 0.45 * libm::powf(step as f32, 0.9);
        for (first_x, first_y) in [(step, step), (step, 0), (0, step)] {
            for y in (first_y..n).step_by(2 * step) {
                for x in (first_x..n).step_by(2 * step) {
                    let around = [(-1, -1), (1, 1), (-1, 1), (1, -1)];
                    let beside = [(-1, 0), (1, 0), (0, -1), (0, 1)];
                    let corners = if first_x == first_y { around } else { beside };
                    field[y * n + x] = mean(&field, n, (x, y), step, corners) + reach * noise(x, y);
                }
            }
        }
        step /= 2;
    }
    field
}

fn mean(field: &[f32], n: usize, at: (usize, usize), step: usize, corners: [(isize, isize); 4]) -> f32 {
    let inside = |(dx, dy): (isize, isize)| {
        let x = at.0.checked_add_signed(dx * step as isize).filter(|&x| x < n)?;
        let y = at.1.checked_add_signed(dy * step as isize).filter(|&y| y < n)?;
        Some(field[y * n + x])
    };
    let heights: Vec<f32> = corners.into_iter().filter_map(inside).collect();
    heights.iter().sum::<f32>() / heights.len() as f32
}

/// A number between -1 and 1 that belongs to a post.
fn noise(x: usize, y: usize) -> f32 {
    let mut bits = (x as u64) << 32 ^ y as u64 ^ 0x9e37_79b9_7f4a_7c15;
    for _ in 0..2 {
        bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
    }
    (bits >> 40) as f32 / (1u64 << 23) as f32 - 1.0
}
