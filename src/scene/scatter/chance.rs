//! Pseudorandom numbers by place: the same place and seed give the same numbers, whatever was drawn before.
//!
//! SplitMix64 (Steele, Lea and Flood 2014), started from a mix of the seed and the square's coordinates.

use sandtable_base::split_mix::split_mix64;

/// A stream of numbers.
#[derive(Clone, Debug)]
pub struct Chance(u64);

impl Chance {
    /// The stream of a square under a seed.
    pub fn of(seed: u64, (column, row): (i64, i64)) -> Self {
        let start = split_mix64(seed ^ split_mix64(column as u64))
            .wrapping_add((row as u64).wrapping_mul(0xd6e8_feb8_6659_fd93));
        Self(split_mix64(start))
    }

    /// The stream that a number of another one starts.
    pub fn from_number(number: u64) -> Self {
        Self(number)
    }

    /// The next number.
    pub fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        split_mix64(self.0)
    }

    /// The next number in 0..1.
    pub fn part(&mut self) -> f64 {
        (self.number() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next number below `count`, which is not 0.
    pub fn below(&mut self, count: usize) -> usize {
        // The high half of a product; for counts this small, as even as can be told.
        ((u128::from(self.number()) * count as u128) >> 64) as usize
    }
}

/// A seed that differs where the texts do (FNV-1a, 64 bits).
pub fn seed_of<'a>(seed: u32, texts: impl Iterator<Item = &'a str>) -> u64 {
    let bytes = texts.flat_map(|text| text.bytes().chain([0]));
    bytes.fold(0xcbf2_9ce4_8422_2325 ^ u64::from(seed).rotate_left(32), |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighboring_squares_have_nothing_in_common() {
        let mut sums = [0.0; 3];
        let count = 10_000_u32;
        for index in 0..count {
            let square = (i64::from(index % 100) - 50, i64::from(index / 100) - 50);
            let mut here = Chance::of(7, square);
            let mut beside = Chance::of(7, (square.0 + 1, square.1));
            let (a, b) = (here.part(), beside.part());
            sums = [sums[0] + a, sums[1] + (a - 0.5) * (b - 0.5), sums[2] + (a - 0.5) * (here.part() - 0.5)];
        }
        let mean = sums.map(|sum| sum / f64::from(count));
        assert!((mean[0] - 0.5).abs() < 0.01 && mean[1].abs() < 0.003 && mean[2].abs() < 0.003, "{mean:?}");
    }

    #[test]
    fn every_choice_comes_equally_often() {
        let mut counts = [0; 3];
        let mut chance = Chance::of(1, (0, 0));
        (0..30_000).for_each(|_| counts[chance.below(3)] += 1);
        assert!(counts.iter().all(|&count| (9_700..10_300).contains(&count)), "{counts:?}");
    }
}
