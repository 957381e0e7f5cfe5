//! The grain of natural ground in close views: grass, soil and rock are not as smooth as paint.
//!
//! Sums of value noise (Perlin 1985, on a square lattice) of three wavelengths in meters make the ground lighter and
//! darker. Each fades before a wave is a few pixels wide, so that nothing sparkles, and all are gone where a picture shows
//! a country: there relief and tints speak alone. Steep ground, which is bare, is coarser than level ground.
//!
//! Lattice points are hashed as integers (Jarzynski and Olano 2020, `pcg2d`), so that both renderers and all machines have
//! the same grain.

use glam::{UVec2, Vec2};

use crate::floor::floor_each;
use crate::shown::shown;

/// Wavelengths in meters with their shares of the contrast.
pub(crate) const WAVES: [(f32, f32); 3] = [(1.7, 0.3), (6.1, 0.35), (23.0, 0.35)];

/// A wave shows in full where it is this many pixels wide, and not at all where it is half as wide.
pub(crate) const WIDE_PX: f32 = 8.0;

/// By how much the light of level ground differs from its mean at the most; ±4 of lightness L*.
pub(crate) const LEVEL: f32 = 0.10;
/// The same for ground as steep as 45°; ±7 of lightness.
pub(crate) const STEEP: f32 = 0.20;

/// The factor on the color of natural ground at world X and Y, over a pixel `pixel_m` meters wide; `rise` is the slope in
/// meters per meter. Its mean is 1.
pub fn ground_grain(at: Vec2, pixel_m: f32, rise: f32) -> f32 {
    1.0 + (LEVEL + (STEEP - LEVEL) * rise.clamp(0.0, 1.0)) * noise_of(&WAVES, at, pixel_m)
}

/// A sum of noise of wavelengths in meters with their shares, each as far as a pixel `pixel_m` meters wide shows it.
pub(crate) fn noise_of(waves: &[(f32, f32)], at: Vec2, pixel_m: f32) -> f32 {
    let mut sum = 0.0;
    for &(wave_m, share) in waves {
        let shown = shown(wave_m, WIDE_PX, pixel_m);
        if shown > 0.0 {
            sum += share * shown * noise(at / wave_m);
        }
    }
    sum
}

/// Value noise, -1..=1.
pub(crate) fn noise(at: Vec2) -> f32 {
    let cell = floor_each(at);
    let part = at - cell;
    let smooth = part * part * (Vec2::splat(3.0) - 2.0 * part);
    let corner = cell.as_ivec2().as_uvec2();
    let value =
        |east: u32, north: u32| hash(UVec2::new(corner.x.wrapping_add(east), corner.y.wrapping_add(north)));
    let blend = |from: f32, to: f32, part: f32| from + (to - from) * part;
    let south = blend(value(0, 0), value(1, 0), smooth.x);
    let north = blend(value(0, 1), value(1, 1), smooth.x);
    blend(south, north, smooth.y)
}

/// A number from -1 to 1 for a lattice point.
fn hash(at: UVec2) -> f32 {
    // 24 bits are exact in an f32.
    (mixed(at) >> 8) as f32 / 8_388_608.0 - 1.0
}

/// A number that depends on all bits of a lattice point.
fn mixed(at: UVec2) -> u32 {
    const FACTOR: u32 = 1_664_525;
    let step = |value: u32| value.wrapping_mul(FACTOR).wrapping_add(1_013_904_223);
    let (mut x, mut y) = (step(at.x), step(at.y));
    x = x.wrapping_add(y.wrapping_mul(FACTOR));
    y = y.wrapping_add(x.wrapping_mul(FACTOR));
    x ^= x >> 16;
    y ^= y >> 16;
    x = x.wrapping_add(y.wrapping_mul(FACTOR));
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> impl Iterator<Item = Vec2> {
        (0..10_000).map(|index| Vec2::new((index % 100) as f32 * 0.83 - 40.0, (index / 100) as f32 * 0.79))
    }

    #[test]
    fn the_mean_is_one_and_steep_ground_is_coarser() {
        let spread = |rise: f32| {
            let all: Vec<f32> = places().map(|at| ground_grain(at, 0.05, rise)).collect();
            let mean = all.iter().sum::<f32>() / all.len() as f32;
            assert!((mean - 1.0).abs() < 0.02, "{mean}");
            all.iter().map(|value| (value - mean).powi(2)).sum::<f32>()
        };
        assert!(spread(1.0) > 3.0 * spread(0.0));
    }

    #[test]
    fn it_fades_before_waves_are_a_few_pixels_wide() {
        assert!(places().all(|at| ground_grain(at, 6.0, 1.0) == 1.0));
        let most = |pixel_m: f32| {
            places().map(|at| (ground_grain(at, pixel_m, 0.0) - 1.0).abs()).fold(0.0, f32::max)
        };
        assert!(most(4.0) < most(2.0) && most(2.0) < most(0.1));
    }

    #[test]
    fn neighbors_differ_little() {
        let step = Vec2::new(0.01, 0.01);
        assert!(
            places()
                .all(|at| (ground_grain(at, 0.01, 0.0) - ground_grain(at + step, 0.01, 0.0)).abs() < 0.01)
        );
    }
}
