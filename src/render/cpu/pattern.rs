//! The sample positions in a pixel.
//!
//! The patterns are the standard multisample patterns of Direct3D 11 (`D3D11_STANDARD_MULTISAMPLE_PATTERN`), as used by
//! graphics hardware: no two samples share a row or a column, so that near-horizontal and near-vertical edges get as
//! many steps as there are samples.

/// A set of a pixel's samples: bit `s` is sample `s`.
pub type SampleMask = u8;

/// `N` sample positions, at most 8. The first sample is the one nearest to the pixel's center; the mean of all is the
/// center.
#[derive(Debug)]
pub struct SamplePattern<const N: usize> {
    /// Offsets from the pixel's center in sixteenths of a pixel, X right and Y down.
    pub sixteenths: [[i32; 2]; N],
}

/// The center alone.
pub const ONE: SamplePattern<1> = SamplePattern { sixteenths: [[0, 0]] };

/// The rotated grid of four.
pub const FOUR: SamplePattern<4> = SamplePattern { sixteenths: [[-2, -6], [6, -2], [-6, 2], [2, 6]] };

/// Eight samples in as many rows and columns.
pub const EIGHT: SamplePattern<8> =
    SamplePattern { sixteenths: [[1, -3], [-1, 3], [5, 1], [-3, -5], [-5, 5], [-7, -1], [3, 7], [7, -7]] };

impl<const N: usize> SamplePattern<N> {
    pub const FULL: SampleMask = ((1u16 << N) - 1) as SampleMask;

    pub fn offset(&self, sample: usize) -> [f32; 2] {
        self.sixteenths[sample].map(|sixteenths| sixteenths as f32 / 16.0)
    }

    /// The mean offset of the samples in `mask` from the pixel's center, in pixels; zero for none. A triangle is
    /// convex, so that the mean of the samples it covers lies inside it: attributes taken there never reach beyond its
    /// border.
    pub fn centroid(&self, mask: SampleMask) -> [f32; 2] {
        if mask == Self::FULL || mask == 0 {
            return [0.0; 2];
        }
        let mut sum = [0; 2];
        for (sample, offset) in self.sixteenths.iter().enumerate() {
            if mask & (1 << sample) != 0 {
                sum = [sum[0] + offset[0], sum[1] + offset[1]];
            }
        }
        sum.map(|sixteenths| sixteenths as f32 / (16 * mask.count_ones()) as f32)
    }

    /// The picture position of the mean of the samples in `mask` of pixel `(x, y)`.
    pub fn centroid_in(&self, x: u32, y: u32, mask: SampleMask) -> [f32; 2] {
        let [right, down] = self.centroid(mask);
        [x as f32 + 0.5 + right, y as f32 + 0.5 + down]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_sound<const N: usize>(pattern: &SamplePattern<N>) {
        let all = pattern.sixteenths;
        assert_eq!(all.iter().fold([0, 0], |sum, at| [sum[0] + at[0], sum[1] + at[1]]), [0, 0]);
        let distance = |at: &[i32; 2]| at[0] * at[0] + at[1] * at[1];
        assert!(all.iter().all(|at| distance(at) >= distance(&all[0])));
        for axis in 0..2 {
            let mut lines = all.map(|at| at[axis]).to_vec();
            lines.sort_unstable();
            lines.dedup();
            assert_eq!(lines.len(), N);
        }
    }

    #[test]
    fn patterns_are_centered_spread_out_and_start_at_the_center() {
        assert_sound(&ONE);
        assert_sound(&FOUR);
        assert_sound(&EIGHT);
        assert_eq!(
            (SamplePattern::<1>::FULL, SamplePattern::<4>::FULL, SamplePattern::<8>::FULL),
            (1, 15, 255)
        );
    }

    #[test]
    fn the_centroid_of_one_sample_is_that_sample() {
        assert_eq!(EIGHT.centroid(0b1000), EIGHT.offset(3));
        assert_eq!(EIGHT.centroid(255), [0.0, 0.0]);
    }
}
