//! The range of numbers that a key allows.

use std::fmt;

/// A range of numbers; no range holds NaN or an infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// Greater than the first number, at most the second.
    Above(f64, f64),
    /// From the first number to the second.
    Within(f64, f64),
}

impl Bounds {
    /// Heights in meters: from below any sea to above the orbit of any camera.
    pub const ELEVATION: Self = Self::Within(-1e7, 1e7);
    /// Compass directions in degrees.
    pub const DIRECTION: Self = Self::Within(-360.0, 360.0);
    /// Every finite number.
    pub const FINITE: Self = Self::Within(f64::MIN, f64::MAX);

    /// Whether `number` lies in the range.
    pub fn hold(self, number: f64) -> bool {
        match self {
            Self::Above(low, high) => number > low && number <= high,
            Self::Within(low, high) => number >= low && number <= high,
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Above(low, high) => {
                write!(out, "greater than {} and at most {}", ShortNumber(*low), ShortNumber(*high))
            }
            Self::Within(low, high) => write!(out, "from {} to {}", ShortNumber(*low), ShortNumber(*high)),
        }
    }
}

/// Shows a number without trailing zeros, with an exponent where it is very large or very small.
pub(super) struct ShortNumber(pub(super) f64);

impl fmt::Display for ShortNumber {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size.is_finite() && (size >= 1e7 || (size > 0.0 && size < 1e-6)) {
            write!(out, "{:e}", self.0)
        } else {
            write!(out, "{}", self.0)
        }
    }
}
