//! Exact coverage: the samples of pixels that a triangle covers.
//!
//! Corners are snapped to a sub-pixel grid; everything after that is integer arithmetic. An edge function gives the
//! side of an edge on which a sample lies (Pineda 1988). A sample on an edge belongs to the triangle for which the edge
//! is a top or a left one: two triangles that share an edge cover every sample along it exactly once.
//!
//! Blocks of 8×8 pixels are skipped or taken in full where the extremes of the edge functions allow it.

use crate::cpu::pattern::{SampleMask, SamplePattern};

/// Corners are snapped to `2^-SUBPIXEL_BITS` pixels. Fine enough that the outline of a draped surface leaves its ground
/// triangle's by no more than the depth tolerance covers, a few pixels from the horizon; coarse enough that edge
/// functions over 32,768 pixels (the largest picture and its guard band) stay below 2^61.
pub const SUBPIXEL_BITS: u32 = 14;

const BLOCK: u32 = 8;

const ONE_PIXEL: i64 = 1 << SUBPIXEL_BITS;

/// A corner in units of `2^-SUBPIXEL_BITS` pixels from the picture's upper left corner.
pub type SubpixelPoint = [i32; 2];

/// The pixels `from[0]..to[0]` × `from[1]..to[1]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelWindow {
    pub from: [u32; 2],
    pub to: [u32; 2],
}

impl PixelWindow {
    pub const EMPTY: Self = Self { from: [0; 2], to: [0; 2] };

    pub fn intersection(self, other: Self) -> Self {
        let from = [self.from[0].max(other.from[0]), self.from[1].max(other.from[1])];
        Self { from, to: [self.to[0].min(other.to[0]), self.to[1].min(other.to[1])] }
    }

    pub fn is_empty(&self) -> bool {
        self.from[0] >= self.to[0] || self.from[1] >= self.to[1]
    }

    /// The pixels of a picture of `size` that the triangle of `corners` may touch.
    pub fn around(corners: &[SubpixelPoint; 3], size: [u32; 2]) -> Self {
        SubpixelBox::around(corners).pixels(size)
    }
}

/// The places from `low` to `high`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SubpixelBox {
    pub low: SubpixelPoint,
    pub high: SubpixelPoint,
}

impl SubpixelBox {
    pub fn around(corners: &[SubpixelPoint]) -> Self {
        let none = Self { low: [i32::MAX; 2], high: [i32::MIN; 2] };
        corners.iter().fold(none, |Self { low, high }, &[x, y]| Self {
            low: [low[0].min(x), low[1].min(y)],
            high: [high[0].max(x), high[1].max(y)],
        })
    }

    /// The pixels of a picture of `size` that it touches.
    pub fn pixels(&self, size: [u32; 2]) -> PixelWindow {
        let pixel = |at: i32, axis: usize| (at >> SUBPIXEL_BITS).clamp(0, size[axis] as i32) as u32;
        let from = [0, 1].map(|axis| pixel(self.low[axis], axis));
        PixelWindow { from, to: [0, 1].map(|axis| (pixel(self.high[axis], axis) + 1).min(size[axis])) }
    }

    /// Whether it lies within a pixel, between its samples, which are in `places` of a pixel: so it is with most triangles of
    /// what is far away.
    pub fn is_between(&self, places: &[SubpixelPoint]) -> bool {
        let Self { low, high } = *self;
        let corner = low.map(|at| at >> SUBPIXEL_BITS << SUBPIXEL_BITS);
        let is_in_pixel = high.map(|at| at >> SUBPIXEL_BITS << SUBPIXEL_BITS) == corner;
        let holds = |axis: usize, at: i32| (low[axis]..=high[axis]).contains(&(corner[axis] + at));
        is_in_pixel && !places.iter().any(|&[x, y]| holds(0, x) && holds(1, y))
    }
}

/// Where samples lie in a pixel.
pub fn sample_places<const N: usize>(pattern: &SamplePattern<N>) -> Vec<SubpixelPoint> {
    const ONE: i32 = 1 << SUBPIXEL_BITS;
    pattern.sixteenths.iter().map(|offset| offset.map(|part| ONE / 2 + part * (ONE / 16))).collect()
}

/// The sub-pixel position nearest to a pixel coordinate, clamped to ±32,768 pixels.
pub fn snapped(pixel: f64) -> i32 {
    // The bias makes every position positive, where truncation rounds down: cheaper than `round`.
    const BIAS: i64 = 1 << 31;
    let pixel = pixel.clamp(-32_768.0, 32_768.0);
    ((pixel * ONE_PIXEL as f64 + BIAS as f64 + 0.5) as i64 - BIAS) as i32
}

/// Twice the triangle's area in square sub-pixels; positive where the corners run clockwise as seen.
pub fn doubled_area([a, b, c]: &[SubpixelPoint; 3]) -> i64 {
    let side =
        |from: &SubpixelPoint, to: &SubpixelPoint, axis: usize| i64::from(to[axis]) - i64::from(from[axis]);
    side(a, b, 0) * side(a, c, 1) - side(a, c, 0) * side(a, b, 1)
}

/// One edge: not negative at the samples on its inner side.
#[derive(Clone, Copy)]
struct EdgeFunction<const N: usize> {
    /// The value at the center of the window's first pixel.
    origin: i64,
    /// The change over one pixel to the right and one down.
    step: [i64; 2],
    /// The change from a pixel's center to its samples.
    samples: [i64; N],
    least: i64,
    most: i64,
}

impl<const N: usize> EdgeFunction<N> {
    fn new(from: SubpixelPoint, to: SubpixelPoint, first: [u32; 2], pattern: &SamplePattern<N>) -> Self {
        let along = [0, 1].map(|axis| i64::from(to[axis]) - i64::from(from[axis]));
        let value = |offset: [i64; 2]| along[0] * offset[1] - along[1] * offset[0];
        let center = first.map(|pixel| i64::from(pixel) * ONE_PIXEL + ONE_PIXEL / 2);
        let is_top_left = along[1] < 0 || (along[1] == 0 && along[0] > 0);
        let samples = pattern.sixteenths.map(|at| value(at.map(|part| i64::from(part) * (ONE_PIXEL / 16))));
        Self {
            origin: value([0, 1].map(|axis| center[axis] - i64::from(from[axis]))) - i64::from(!is_top_left),
            step: [-along[1] * ONE_PIXEL, along[0] * ONE_PIXEL],
            samples,
            least: samples.iter().copied().fold(i64::MAX, i64::min),
            most: samples.iter().copied().fold(i64::MIN, i64::max),
        }
    }

    fn at(&self, column: u32, row: u32) -> i64 {
        self.origin + self.step[0] * i64::from(column) + self.step[1] * i64::from(row)
    }

    /// The least and the greatest value at any sample of a block of pixels.
    fn extremes(&self, columns: [u32; 2], rows: [u32; 2]) -> (i64, i64) {
        let start = self.at(columns[0], rows[0]);
        let across = self.step[0] * i64::from(columns[1] - 1 - columns[0]);
        let down = self.step[1] * i64::from(rows[1] - 1 - rows[0]);
        (start + across.min(0) + down.min(0) + self.least, start + across.max(0) + down.max(0) + self.most)
    }
}

/// Calls `visit(column, row, mask)` for every pixel in `window` of which the triangle covers samples. The corners run
/// clockwise as seen, that is, with a positive [`doubled_area`]. Each pixel is visited at most once, and never with an
/// empty mask; blocks come row by row.
pub fn cover<const N: usize>(
    corners: &[SubpixelPoint; 3],
    pattern: &SamplePattern<N>,
    window: PixelWindow,
    mut visit: impl FnMut(u32, u32, SampleMask),
) {
    if window.is_empty() {
        return;
    }
    let [a, b, c] = *corners;
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| EdgeFunction::new(from, to, window.from, pattern));
    let [width, height] = [0, 1].map(|axis| window.to[axis] - window.from[axis]);
    for top in (0..height).step_by(BLOCK as usize) {
        let rows = [top, (top + BLOCK).min(height)];
        for left in (0..width).step_by(BLOCK as usize) {
            let columns = [left, (left + BLOCK).min(width)];
            let extremes = edges.each_ref().map(|edge| edge.extremes(columns, rows));
            if extremes.iter().any(|&(_, greatest)| greatest < 0) {
                continue;
            }
            let is_full = extremes.iter().all(|&(least, _)| least >= 0);
            for row in rows[0]..rows[1] {
                for column in columns[0]..columns[1] {
                    let mask = if is_full { SamplePattern::<N>::FULL } else { covered(&edges, column, row) };
                    if mask != 0 {
                        visit(window.from[0] + column, window.from[1] + row, mask);
                    }
                }
            }
        }
    }
}

/// The samples of one pixel on the inner side of all edges.
fn covered<const N: usize>(edges: &[EdgeFunction<N>; 3], column: u32, row: u32) -> SampleMask {
    let mut mask = SamplePattern::<N>::FULL;
    for edge in edges {
        let center = edge.at(column, row);
        if center + edge.most < 0 {
            return 0;
        }
        if center + edge.least < 0 {
            // By its sign, without a branch.
            let sign = |value: i64| value as u64 >> 63;
            let outside = edge.samples.iter().enumerate();
            let outside = outside.fold(0, |bits, (sample, offset)| bits | (sign(center + offset) << sample));
            mask &= !(outside as SampleMask);
        }
    }
    mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::pattern::{EIGHT, FOUR, ONE};
    use sandtable_base::split_mix::split_mix64;

    const SIDE: u32 = 40;
    const ALL: PixelWindow = PixelWindow { from: [0, 0], to: [SIDE, SIDE] };

    /// A small generator of even numbers (Steele and others, "Fast Splittable Pseudorandom Number
    /// Generators", 2014).
    fn random(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        split_mix64(*state)
    }

    #[test]
    fn what_lies_between_the_samples_covers_none_of_them() {
        let (places, mut state) = (sample_places(&EIGHT), 7);
        let (mut passed_over, mut covering) = (0, 0);
        for _ in 0..4000 {
            let size = 1 + (random(&mut state) % (1 << SUBPIXEL_BITS)) as i32;
            let [left, top] = [(); 2].map(|()| (random(&mut state) % (20 << SUBPIXEL_BITS)) as i32);
            // Half of the corners lie at samples.
            let mut corner = || {
                let place = places[(random(&mut state) >> 8) as usize % places.len()];
                let within = |at: i32, random: u64| at + (random >> 8) as i32 % size;
                let free = [within(left, random(&mut state)), within(top, random(&mut state))];
                let pixel = [left, top].map(|at| at >> SUBPIXEL_BITS << SUBPIXEL_BITS);
                if random(&mut state) & 256 == 0 { free } else { [pixel[0] + place[0], pixel[1] + place[1]] }
            };
            let corners = [corner(), corner(), corner()];
            if doubled_area(&corners) == 0 {
                continue;
            }
            let covered = counts(&[corners], &EIGHT).into_iter().flatten().sum::<u32>();
            if SubpixelBox::around(&corners).is_between(&places) {
                passed_over += 1;
                assert_eq!(covered, 0, "{corners:?}");
            } else {
                covering += u32::from(covered > 0);
            }
        }
        assert!(passed_over > 100 && covering > 100, "{passed_over}, {covering}");
    }

    /// How often each sample is covered by the triangles, either way round.
    fn counts<const N: usize>(triangles: &[[SubpixelPoint; 3]], pattern: &SamplePattern<N>) -> Vec<[u32; N]> {
        let mut counts = vec![[0; N]; (SIDE * SIDE) as usize];
        for &[a, b, c] in triangles {
            let corners = if doubled_area(&[a, b, c]) > 0 { [a, b, c] } else { [a, c, b] };
            cover(
                &corners,
                pattern,
                PixelWindow::around(&corners, [SIDE; 2]).intersection(ALL),
                |x, y, mask| {
                    for (sample, count) in counts[(y * SIDE + x) as usize].iter_mut().enumerate() {
                        *count += u32::from(mask >> sample & 1);
                    }
                },
            );
        }
        counts
    }

    /// A mesh over the whole square whose inner corners are shaken but never fold a triangle.
    fn shaken_mesh(seed: u64) -> Vec<[SubpixelPoint; 3]> {
        const CELLS: i32 = 7;
        let mut state = seed;
        let side = SIDE as i32 * ONE_PIXEL as i32;
        let corners: Vec<SubpixelPoint> = (0..=CELLS)
            .flat_map(|row| (0..=CELLS).map(move |column| [column, row]))
            .map(|at| {
                at.map(|step| {
                    let place = i64::from(step) * i64::from(side) / i64::from(CELLS);
                    let shake = (random(&mut state) % (2 * ONE_PIXEL as u64)) as i64 - ONE_PIXEL;
                    let inner = step > 0 && step < CELLS;
                    // Every other shake is to whole sixteenths, where samples lie on edges exactly.
                    let fine = if shake % 2 == 0 { shake & !1023 } else { shake };
                    (place + if inner { fine } else { 0 }) as i32
                })
            })
            .collect();
        let corner = |column: i32, row: i32| corners[(row * (CELLS + 1) + column) as usize];
        (0..CELLS)
            .flat_map(|row| (0..CELLS).map(move |column| (column, row)))
            .flat_map(|(column, row)| {
                let [a, b] = [corner(column, row), corner(column + 1, row)];
                let [c, d] = [corner(column, row + 1), corner(column + 1, row + 1)];
                [[a, b, c], [b, d, c]]
            })
            .collect()
    }

    #[test]
    fn every_sample_of_a_mesh_is_covered_exactly_once() {
        for seed in 0..40 {
            let mesh = shaken_mesh(seed);
            assert!(counts(&mesh, &EIGHT).iter().flatten().all(|&count| count == 1), "seed {seed}");
            assert!(counts(&mesh, &FOUR).iter().flatten().all(|&count| count == 1), "seed {seed}");
            assert!(counts(&mesh, &ONE).iter().flatten().all(|&count| count == 1), "seed {seed}");
        }
    }

    #[test]
    fn a_fan_through_pixel_centers_is_covered_exactly_once() {
        let at = |x: i32, y: i32| [x * ONE_PIXEL as i32 / 2, y * ONE_PIXEL as i32 / 2];
        let (hub, side) = (at(21, 33), SIDE as i32 * 2);
        let rim = [(0, 0), (41, 0), (side, 0), (side, 33), (side, side), (21, side), (0, side), (0, 33)];
        let fan: Vec<_> = (0..8)
            .map(|i| [hub, at(rim[i].0, rim[i].1), at(rim[(i + 1) % 8].0, rim[(i + 1) % 8].1)])
            .collect();
        assert!(counts(&fan, &ONE).iter().flatten().all(|&count| count == 1));
        assert!(counts(&fan, &EIGHT).iter().flatten().all(|&count| count == 1));
    }

    #[test]
    fn coverage_is_the_exact_area_within_what_eight_samples_can_tell() {
        let mut state = 7;
        let mut error_sum = 0.0;
        for _ in 0..60 {
            let corners: [SubpixelPoint; 3] = std::array::from_fn(|_| {
                std::array::from_fn(|_| (random(&mut state) % (u64::from(SIDE) << SUBPIXEL_BITS)) as i32)
            });
            let covered: u32 = counts(&[corners], &EIGHT).iter().flatten().sum();
            let exact = doubled_area(&corners).abs() as f64 / 2.0 / (ONE_PIXEL * ONE_PIXEL) as f64;
            let error = f64::from(covered) / 8.0 - exact;
            assert!(error.abs() < 4.0, "{error} px of {exact}");
            error_sum += error;
        }
        assert!((error_sum / 60.0).abs() < 0.3, "biased by {}", error_sum / 60.0);
    }

    #[test]
    fn a_triangle_as_large_as_the_guard_band_covers_every_pixel() {
        let far = 24_000 << SUBPIXEL_BITS;
        let corners = [[-(8000 << SUBPIXEL_BITS), -(8000 << SUBPIXEL_BITS)], [far, 0], [0, far]];
        let mut pixels = 0;
        cover(&corners, &EIGHT, ALL, |_, _, mask| pixels += u32::from(mask == 255));
        assert_eq!(pixels, SIDE * SIDE);
    }

    #[test]
    fn a_sliver_without_area_covers_nothing() {
        let at = |x: i32, y: i32| [x << SUBPIXEL_BITS, y << SUBPIXEL_BITS];
        let corners = [at(1, 1), at(10, 10), at(30, 30)];
        assert_eq!(doubled_area(&corners), 0);
        cover(&corners, &EIGHT, ALL, |x, y, _| panic!("pixel ({x}, {y}) of nothing"));
    }

    #[test]
    fn snapping_rounds_to_the_nearest_on_both_sides_of_zero() {
        assert_eq!([snapped(1.0), snapped(-1.0), snapped(0.0)], [1 << 14, -(1 << 14), 0]);
        assert_eq!(snapped(-0.6 / 16384.0), -1);
        assert_eq!(snapped(0.4 / 16384.0), 0);
    }
}
