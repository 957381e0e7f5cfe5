//! Volumes of earth moved.

use std::iter::Sum;
use std::ops::{AddAssign, Mul};

/// Earth moved, in cubic meters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Volumes {
    /// Taken away.
    pub cut_m3: f64,
    /// Put on.
    pub fill_m3: f64,
}

impl Volumes {
    /// The earth that an area takes to rise, or gives where the rise is negative. A rise of NaN counts as none.
    pub fn from_rise(rise_m: f64, area_m2: f64) -> Self {
        Self { cut_m3: (-rise_m).max(0.0) * area_m2, fill_m3: rise_m.max(0.0) * area_m2 }
    }
}

impl AddAssign for Volumes {
    fn add_assign(&mut self, other: Self) {
        self.cut_m3 += other.cut_m3;
        self.fill_m3 += other.fill_m3;
    }
}

impl Mul<f64> for Volumes {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { cut_m3: self.cut_m3 * factor, fill_m3: self.fill_m3 * factor }
    }
}

impl Sum for Volumes {
    fn sum<I: Iterator<Item = Self>>(volumes: I) -> Self {
        volumes.fold(Self::default(), |mut sum, volumes| {
            sum += volumes;
            sum
        })
    }
}
