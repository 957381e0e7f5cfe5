//! The numbers a key allows.

use std::fmt;

/// The numbers a key allows; never NaN or infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// Greater than the first, up to the second.
    Above(f64, f64),
    /// From the first to the second.
    Within(f64, f64),
}

impl Bounds {
    /// Whether it allows `number`; never NaN or an infinity.
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
                write!(out, "greater than {} and at most {}", Short(*low), Short(*high))
            }
            Self::Within(low, high) => write!(out, "from {} to {}", Short(*low), Short(*high)),
        }
    }
}

/// A number as people write it: without a tail of zeros.
pub(super) struct Short(pub(super) f64);

impl fmt::Display for Short {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size.is_finite() && (size >= 1e7 || (size > 0.0 && size < 1e-6)) {
            write!(out, "{:e}", self.0)
        } else {
            write!(out, "{}", self.0)
        }
    }
}

/// Heights in meters: from below any sea to above any camera's orbit.
pub const ELEVATION: Bounds = Bounds::Within(-1e7, 1e7);
