//! Texture shading: a fractional Laplacian of the heights. Ridges and spurs are high in it and drainage low, at all scales and
//! whatever the direction of light (Brown 2010; Brown 2014).
//!
//! The operator multiplies each wave of the ground by a power of its frequency, `(1 / wavelength)^α`, which a Fourier transform
//! would do exactly. A pyramid (Burt and Adelson 1983) does it nearly: each level is the ground smoothed and halved, a band is
//! the difference of two levels, and waves twice as long lie in the next band, which is weighted 2^−α times as much.
//!
//! ```text
//!   ground P₀ ──smooth, halve──► P₁ ──► P₂ ──► … ──► one cell
//!      │ − finer(P₁)              │ − finer(P₂)
//!      ▼                          ▼
//!   band B₀                    band B₁                  texture = Σ finerⁿ(Bₙ) / (cell · 2ⁿ)^α
//! ```
//!
//! Both ways go by the cubic B-spline, 1 4 6 4 1: narrower kernels leave grids in the sum. Waves of 8 to 256 cells follow the
//! power law within 2 %, of 5 cells within 10 %; those of 4 cells and less, most of which are noise, have a fifth less and more.
//! Unlike a transform, it needs no ground beyond the border, no power of two and no second copy of the ground.

use glam::Vec2;
use rayon::prelude::*;

/// α, the order: 0 is the ground itself and 1 has the long forms drown in its grain. Of ground as rough as most is,
/// `wavelength^0.8` high waves, all scales show alike.
pub const ORDER: f32 = 0.8;

/// How many times as much the finest band weighs: it stands in for those finer than the posts, of which smooth waves would have
/// a part. All of it is 1 + 1 / (2^(2 − α) − 1) = 1.77; with four fifths of the addition, waves of 5 to 16 cells err least.
const FINEST_WEIGHT: f32 = 1.617;

/// Values of a regular grid, row by row from the south-west.
struct TextureLevel {
    columns: usize,
    rows: usize,
    /// Meters between values eastward and northward.
    cell: Vec2,
    values: Vec<f32>,
}

/// Whether a level has half the columns and half the rows of the finer one.
#[derive(Clone, Copy)]
struct TextureHalving {
    columns: bool,
    rows: bool,
}

/// The texture of ground of `heights`, row by row of `columns`, whose posts lie `cell` meters apart, and none of which is NaN:
/// meters per meter to the power of [`ORDER`], around 0. A wave of `length_m` and one meter of height has one of `5.57 / length_m^α`.
/// Spread over all threads; the same for any number of them.
///
/// # Panics
/// Where the rows are not whole.
pub fn texture(heights: Vec<f32>, columns: usize, cell: Vec2) -> Vec<f32> {
    assert!(columns > 0 && heights.len().is_multiple_of(columns), "{} of {columns}", heights.len());
    let rows = heights.len() / columns;
    let mut levels = vec![TextureLevel { columns, rows, cell, values: heights }];
    let mut halvings = Vec::new();
    while let Some(halving) = levels.last().and_then(TextureLevel::halving) {
        halvings.push(halving);
        levels.extend(levels.last().map(|level| level.halved(halving)));
    }
    let Some(mut coarser) = levels.pop() else { return Vec::new() };
    // The texture of a level, less the level itself as the finer band subtracts it: so one field is made finer, not two.
    let mut finer_weight = levels.last().map_or(1.0, |finer| finer.band_weight(levels.len() == 1));
    let rest = if levels.is_empty() { 0.0 } else { -finer_weight };
    coarser.values.par_iter_mut().for_each(|value| *value *= rest);
    while let (Some(mut level), Some(halving)) = (levels.pop(), halvings.pop()) {
        let own_weight = finer_weight;
        finer_weight = levels.last().map_or(0.0, |finer| finer.band_weight(levels.len() == 1));
        let (columns, factor) = (level.columns, own_weight - finer_weight);
        level.values.par_chunks_exact_mut(columns).enumerate().for_each(|(row, values)| {
            let finer = coarser.finer_row(row, columns, halving);
            values.iter_mut().zip(finer).for_each(|(value, finer)| *value = *value * factor + finer);
        });
        coarser = level;
    }
    coarser.values
}

impl TextureLevel {
    /// How the next level is made: of cells longer than wide, the shorter side is doubled alone until both are about as
    /// long. `None` after a few values a side, which hold no form any more.
    fn halving(&self) -> Option<TextureHalving> {
        let longest = self.cell.min_element() * 1.5;
        let halving = TextureHalving {
            columns: self.columns > 2 && self.cell.x < longest,
            rows: self.rows > 2 && self.cell.y < longest,
        };
        (halving.columns || halving.rows).then_some(halving)
    }

    /// What the band of this level and the next is multiplied by.
    fn band_weight(&self, is_finest: bool) -> f32 {
        let more = if is_finest { FINEST_WEIGHT } else { 1.0 };
        more * libm::powf(self.cell.min_element(), -ORDER)
    }

    fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.columns..][..self.columns]
    }

    /// Every second value, smoothed; the last one may lie past the border.
    fn halved(&self, halving: TextureHalving) -> Self {
        let half = |is_halved: bool, count: usize| if is_halved { count / 2 + 1 } else { count };
        let [columns, rows] = [half(halving.columns, self.columns), half(halving.rows, self.rows)];
        let factor = |is_halved: bool| if is_halved { 2.0 } else { 1.0 };
        let mut values = vec![0.0; columns * rows];
        values.par_chunks_exact_mut(columns).enumerate().for_each(|(row, values)| {
            let smooth = if halving.rows { self.smooth_row(2 * row) } else { self.row(row).to_vec() };
            for (column, value) in values.iter_mut().enumerate() {
                *value = if halving.columns { smoothed(&smooth, 2 * column) } else { smooth[column] };
            }
        });
        let cell = self.cell * Vec2::new(factor(halving.columns), factor(halving.rows));
        Self { columns, rows, cell, values }
    }

    /// A row smoothed northward.
    fn smooth_row(&self, at: usize) -> Vec<f32> {
        let rows = around(at, self.rows).map(|row| self.row(row));
        (0..self.columns).map(|column| spline(rows.map(|row| row[column]))).collect()
    }

    /// The values along a row of the finer level of `count` columns, by the spline through this one's values as weights.
    fn finer_row(&self, row: usize, count: usize, halving: TextureHalving) -> Vec<f32> {
        let line: Vec<f32> = if halving.rows {
            let rows = beside(row / 2, self.rows).map(|row| self.row(row));
            (0..self.columns).map(|column| finer_value(row, rows.map(|row| row[column]))).collect()
        } else {
            self.row(row).to_vec()
        };
        if !halving.columns {
            return line;
        }
        let beside = |column: usize| beside(column / 2, self.columns).map(|column| line[column]);
        (0..count).map(|column| finer_value(column, beside(column))).collect()
    }
}

/// Five indices around `at` that are below `count`: past the border, the border's own is repeated.
fn around(at: usize, count: usize) -> [usize; 5] {
    [at.saturating_sub(2), at.saturating_sub(1), at, at + 1, at + 2].map(|index| index.min(count - 1))
}

/// Three indices around `at` that are below `count`.
fn beside(at: usize, count: usize) -> [usize; 3] {
    [at.saturating_sub(1), at, at + 1].map(|index| index.min(count - 1))
}

fn smoothed(values: &[f32], at: usize) -> f32 {
    spline(around(at, values.len()).map(|index| values[index]))
}

/// The cubic B-spline of twice the distance between values.
fn spline([before_2, before, own, after, after_2]: [f32; 5]) -> f32 {
    (before_2 + after_2 + 4.0 * (before + after) + 6.0 * own) * (1.0 / 16.0)
}

/// The spline at index `at` of a finer level: at a weight where that is even, else half way to the next.
fn finer_value(at: usize, [before, own, after]: [f32; 3]) -> f32 {
    if at.is_multiple_of(2) { (before + after + 6.0 * own) * 0.125 } else { (own + after) * 0.5 }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const SIDE: usize = 640;

    /// A cosine of one meter that runs in the direction of an angle, with its wavelength in posts.
    fn wave(length: f64, angle: f64, columns: usize) -> Vec<f32> {
        let (east, north) = (libm::cos(angle), libm::sin(angle));
        let height = |index: usize| {
            let along = (index % columns) as f64 * east + (index / columns) as f64 * north;
            libm::cos(TAU * along / length + 0.3) as f32
        };
        (0..columns * SIDE).map(height).collect()
    }

    /// The factor by which texture multiplies a wave, and what is left of it beside that, as a share; away from the border.
    fn response(length: f64, angle: f64, cell: Vec2) -> (f64, f64) {
        let heights = wave(length, angle, SIDE);
        let texture = texture(heights.clone(), SIDE, cell);
        let is_inner = |index: &usize| {
            [index % SIDE, index / SIDE].iter().all(|at| (SIDE / 4..SIDE * 3 / 4).contains(at))
        };
        let sum = |value: &dyn Fn(usize) -> f64| (0..SIDE * SIDE).filter(is_inner).map(value).sum::<f64>();
        let own = sum(&|index| f64::from(heights[index]).powi(2));
        let factor = sum(&|index| f64::from(heights[index]) * f64::from(texture[index])) / own;
        let left = sum(&|index| (f64::from(texture[index]) - factor * f64::from(heights[index])).powi(2));
        (factor, (left / own).sqrt() / factor)
    }

    #[test]
    fn waves_are_multiplied_by_a_power_of_their_frequency() {
        for angle in [0.0, 0.7, 1.2, -0.5] {
            let (of_32, _) = response(32.0, angle, Vec2::ONE);
            for (length, off) in [(5.3, 0.10), (8.0, 0.03), (11.0, 0.03), (16.0, 0.03), (64.0, 0.03)] {
                let (factor, left) = response(length, angle, Vec2::ONE);
                let expected = libm::pow(32.0 / length, f64::from(ORDER));
                assert!((factor / of_32 / expected - 1.0).abs() < off, "{length} at {angle}: {factor}");
                assert!(left < 0.06, "{length} at {angle}: {left} is another wave");
            }
        }
    }

    #[test]
    fn many_waves_at_once_have_the_texture_of_a_fourier_transform() {
        // Height in meters, length in posts and direction of each: a transform multiplies them one by one.
        let waves =
            [(1.0, 40.0, 0.3), (0.6, 23.0, 1.1), (0.5, 17.0, 2.3), (0.3, 11.0, -0.4), (0.2, 90.0, 0.9)];
        let order = f64::from(ORDER);
        let sum = |factor: &dyn Fn(f64) -> f64| {
            let mut sum = vec![0.0; SIDE * SIDE];
            for (height, length, angle) in waves {
                let by = height * factor(length);
                let wave = wave(length, angle, SIDE);
                sum.iter_mut().zip(wave).for_each(|(sum, value)| *sum += by * f64::from(value));
            }
            sum
        };
        let ground = sum(&|_| 1.0).iter().map(|&height| height as f32).collect();
        let expected = sum(&|length| 5.57 / libm::pow(length, order));
        let texture = texture(ground, SIDE, Vec2::ONE);
        let (mut off, mut all) = (0.0, 0.0);
        for index in 0..SIDE * SIDE {
            if [index % SIDE, index / SIDE].iter().all(|at| (SIDE / 4..SIDE * 3 / 4).contains(at)) {
                off += (f64::from(texture[index]) - expected[index]).powi(2);
                all += expected[index].powi(2);
            }
        }
        let off = (off / all).sqrt();
        assert!(off < 0.02, "{off} of the texture is off");
    }

    #[test]
    fn meters_between_posts_count_not_posts() {
        let (fine, _) = response(64.0, 0.0, Vec2::splat(5.0));
        let (coarse, _) = response(16.0, 0.0, Vec2::splat(20.0));
        assert!((fine / coarse - 1.0).abs() < 0.03, "{fine} {coarse}");
        let (square, _) = response(32.0, 0.0, Vec2::splat(10.0));
        // The additional weight of the finest band is that of the shorter side alone.
        for (cell, off) in [(Vec2::new(10.0, 40.0), 0.03), (Vec2::new(10.0, 10.0 / 3.0), 0.08)] {
            let (long, _) = response(32.0, 0.0, cell);
            assert!((long / square - 1.0).abs() < off, "{cell}: {long} {square}");
        }
    }

    #[test]
    fn level_ground_and_single_posts_have_no_texture() {
        for (columns, rows) in [(1, 1), (1, 7), (2, 2), (9, 1), (33, 18)] {
            let values = texture(vec![1234.5; columns * rows], columns, Vec2::new(3.0, 5.0));
            assert_eq!(values.len(), columns * rows);
            assert!(values.iter().all(|value| value.abs() < 1e-3), "{columns} × {rows}: {values:?}");
        }
    }

    #[test]
    fn ridges_are_high_and_valleys_low_on_both_sides() {
        let ground: Vec<f32> = wave(40.0, 0.6, SIDE).iter().map(|height| height.powi(3) * 80.0).collect();
        let texture = texture(ground.clone(), SIDE, Vec2::splat(10.0));
        // At the border, which is taken to go on level, half of a ridge may look like a slope.
        let is_inner =
            |index: usize| [index % SIDE, index / SIDE].iter().all(|at| (20..SIDE - 20).contains(at));
        let pairs = ground.iter().zip(&texture).enumerate().filter(|(index, _)| is_inner(*index));
        let mut steep = pairs.filter(|(_, (height, _))| height.abs() > 40.0);
        assert!(steep.all(|(_, (height, texture))| height * texture > 0.0));
    }

    #[test]
    fn one_and_many_threads_make_the_same_bits() {
        let ground = wave(17.0, 0.4, 333);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| texture(ground.clone(), 333, Vec2::splat(2.0)))
        };
        let one = with(1);
        assert!([2, 5].iter().all(|&threads| with(threads) == one));
    }
}
