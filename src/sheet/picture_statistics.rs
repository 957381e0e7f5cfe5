//! Statistics of a picture before furniture covers it, for scripts: how much of it is ground, and how light.

use rayon::prelude::*;

use sandtable_draw::color::{Srgba, lightness};
use sandtable_draw::list::FeatureId;
use sandtable_render::picture::Rendering;

/// Measures of a picture without its annotations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureStatistics {
    /// The share of pixels that show the ground or any feature on it, 0..=1.
    pub filled: f64,
    /// The share of pixels that show bare ground, without the walls of its block, 0..=1.
    pub ground: f64,
    /// The lightness of bare ground; `None` where none is seen.
    pub ground_lightness: Option<Lightness>,
}

/// The distribution of lightness, CIE L* (1976), 0 for black to 100 for white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lightness {
    /// The mean.
    pub mean: f64,
    /// The standard deviation.
    pub sd: f64,
    /// The 2nd percentile.
    pub p2: f64,
    /// The 98th percentile.
    pub p98: f64,
}

/// Steps of lightness that are told apart: a hundredth of L*.
const STEPS: usize = 10_001;

/// The pixels that a thread measures in one go, with a histogram of their own.
const PORTION: usize = 1 << 16;

impl PictureStatistics {
    /// Measures a picture.
    pub fn new(picture: &Rendering) -> Self {
        let count = picture.features.len().max(1) as f64;
        let filled = picture.features.par_iter().filter(|&&feature| feature != FeatureId::NONE).count();
        let of_ground = |(colors, features): (&[Srgba], &[FeatureId])| {
            let mut histogram = vec![0u64; STEPS];
            let pixels = colors.iter().zip(features);
            for (color, _) in pixels.filter(|&(_, &feature)| feature == FeatureId::GROUND) {
                histogram[(lightness(color.linear()) * 100.0).round() as usize] += 1;
            }
            histogram
        };
        let sum = |mut histogram: Vec<u64>, other: Vec<u64>| {
            histogram.iter_mut().zip(other).for_each(|(count, more)| *count += more);
            histogram
        };
        let portions = picture.pixels.data().par_chunks(PORTION).zip(picture.features.par_chunks(PORTION));
        let histogram = portions.map(of_ground).reduce_with(sum).unwrap_or_default();
        let ground: u64 = histogram.iter().sum();
        Self {
            filled: filled as f64 / count,
            ground: ground as f64 / count,
            ground_lightness: (ground > 0).then(|| Lightness::new(&histogram, ground as f64)),
        }
    }
}

impl Lightness {
    /// The distribution of a histogram in hundredths of L* that counts `count` pixels.
    fn new(histogram: &[u64], count: f64) -> Self {
        let moment = |power: i32| {
            let sum: f64 =
                (0..).zip(histogram).map(|(step, &n)| (f64::from(step) / 100.0).powi(power) * n as f64).sum();
            sum / count
        };
        let mean = moment(1);
        let percentile = |share: f64| {
            let mut left = share * count;
            let step = histogram.iter().position(|&n| {
                left -= n as f64;
                left <= 0.0
            });
            step.unwrap_or(STEPS - 1) as f64 / 100.0
        };
        Self {
            mean,
            sd: (moment(2) - mean * mean).max(0.0).sqrt(),
            p2: percentile(0.02),
            p98: percentile(0.98),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::pixels::Pixels;

    #[test]
    fn bare_ground_is_measured_and_all_that_is_drawn_fills_the_picture() {
        let grays = [255, 255, 119, 119, 0, 0, 0, 0];
        let features = [0, 0, 1, 1, 1, 1, 7, 7].map(FeatureId);
        let data = grays.map(|gray| Srgba::opaque(gray, gray, gray)).to_vec();
        let picture = Rendering {
            pixels: Pixels::from_data(4, 2, data).expect("eight pixels"),
            depth_m: vec![1.0; 8],
            features: features.to_vec(),
        };
        let found = PictureStatistics::new(&picture);
        assert_eq!((found.filled, found.ground), (0.75, 0.5));
        let lightness = found.ground_lightness.expect("there is ground");
        assert!((lightness.mean - 25.0).abs() < 0.1 && (lightness.sd - 25.0).abs() < 0.1, "{lightness:?}");
        assert!(lightness.p2 == 0.0 && (lightness.p98 - 50.0).abs() < 0.1, "{lightness:?}");
    }
}
