//! The samples that a stated no-data value means.
//!
//! Writers state the value as text, often with six digits, and store it in the samples with all of theirs: `-3.40282e+38`
//! beside samples of −3.4028234663852886e38. Others compute it in another precision: `-9999.9` beside 64-bit samples of
//! −9999.900390625, which is the nearest 32-bit number. So a stated value means a span of values, as wide as the digits
//! leave open, but no height of any ground:
//!
//! ```text
//! |value| below 10⁶          the value, and the nearest 32-bit number
//! from 10⁶ to below 10⁹      half a unit of the last digit, of at least six digits
//! from 10⁹ on                half a unit of the last digit, or of the sixth of the samples: a hundred-thousandth
//! beyond 32-bit numbers      also the greatest of these
//! ```

use crate::raster::SampleFloat;

/// Values from here on are written with six digits by many programs, and no height comes as near.
const ROUNDED: f64 = 1e6;

/// Values from here on are no height in any unit.
const FAR: f64 = 1e9;

/// The digits that C's `%g` prints.
const LEAST_DIGITS: i32 = 6;

/// The part by which far values may differ: samples may have six digits as well.
const FAR_SHARE: f64 = 1e-5;

/// The samples that a stated no-data value means; both ends belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoDataSpan {
    low: f64,
    high: f64,
}

impl NoDataSpan {
    /// The span that holds no value.
    pub const NONE: Self = Self { low: f64::NAN, high: f64::NAN };

    /// The span that a stated value means; none for NaN, which is no data in any case. The greatest 64-bit number is infinite
    /// where it was rounded up when it was written.
    ///
    /// ```
    /// use sandtable_raster::nodata_span::NoDataSpan;
    /// let stated = NoDataSpan::around(-3.40282e38);
    /// assert!(stated.contains(f64::from(f32::MIN)) && !stated.contains(-9999.0));
    /// ```
    pub fn around(stated: f64) -> Self {
        if stated.is_nan() {
            return Self::NONE;
        }
        let size = stated.abs().min(f64::MAX);
        let apart = match size {
            FAR.. => half_of_last_digit(size, 1).max(size * FAR_SHARE),
            ROUNDED.. => half_of_last_digit(size, LEAST_DIGITS),
            _ => 0.0,
        };
        let narrow = f64::from(size as f32).min(f32::MAX.into());
        let (least, most) = ((size - apart).min(narrow), (size + apart).max(narrow));
        if stated < 0.0 { Self { low: -most, high: -least } } else { Self { low: least, high: most } }
    }

    /// This span and `value`.
    pub fn with(self, value: f64) -> Self {
        Self { low: self.low.min(value), high: self.high.max(value) }
    }

    /// Whether a sample of this value is no data.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }

    /// Both ends as samples of a type; NaN, which nothing reaches, of the empty span.
    #[inline]
    pub fn ends<T: SampleFloat>(self) -> (T, T) {
        (T::from_f64(self.low), T::from_f64(self.high))
    }
}

/// Half a unit of the last digit that a positive number needs to be written, counted as at least so many digits.
fn half_of_last_digit(size: f64, least_digits: i32) -> f64 {
    let written = format!("{size:e}");
    let (digits, power) = written.split_once('e').unwrap_or((&written, "0"));
    let count = digits.bytes().filter(u8::is_ascii_digit).count() as i32;
    let power: i32 = power.parse().unwrap_or(0);
    // Parsed, so that it is the nearest number to the decimal one.
    format!("5e{}", power - count.max(least_digits)).parse().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_with_fewer_digits_means_what_it_was_rounded_from() {
        let greatest = f64::from(f32::MAX);
        for written in ["3.40282e+38", "3.4028e38", "3.4e+38", "3.402823e+38", "3.4028234663852886e+38"] {
            for sign in [1.0, -1.0] {
                let span = NoDataSpan::around(sign * written.parse::<f64>().expect("a number"));
                assert!(span.contains(sign * greatest) && !span.contains(-sign * greatest), "{written}");
                // What ArcGIS writes for the same.
                assert!(span.contains(sign * 3.402_823_060_737_096_5e38), "{written}");
                assert!(!span.contains(sign * 1e38) && !span.contains(sign * 9999.0), "{written}");
            }
        }
        for (stated, sample) in [
            (-2.147_48e9, -2_147_483_648.0),
            (4.294_97e9, 4_294_967_295.0),
            (-1e7, -9_999_999.0),
            (1.677_72e7, 16_777_215.0),
            (1.267_65e30, 1.267_650_600_228_229_4e30),
            (-1.797_69e308, f64::MIN),
            (-1.797_693_134_862_315_7e308, f64::from(f32::MIN)),
            (1.7e38, 1.701_41e38),
            (f64::NEG_INFINITY, f64::MIN),
            (f64::NEG_INFINITY, f64::from(f32::MIN)),
        ] {
            assert!(NoDataSpan::around(stated).contains(sample), "{stated}");
        }
    }

    #[test]
    fn heights_beside_a_value_are_heights() {
        for (stated, height) in [
            (-9999.0, -9999.4),
            (-9999.0, -9998.0),
            (-9999.9, -9999.0),
            (0.0, 0.3),
            (0.0, -0.001),
            (9999.0, 9999.1),
            (-32768.0, -32767.0),
            (1e6, 999_990.0),
            (-99_999.0, -99_999.5),
        ] {
            let span = NoDataSpan::around(stated);
            assert!(span.contains(stated) && !span.contains(height), "{stated}");
        }
    }

    #[test]
    fn a_value_and_its_nearest_32_bit_number_are_one() {
        assert!(NoDataSpan::around(-9999.9).contains((-9999.9_f32).into()));
        assert!(NoDataSpan::around(0.1).contains(0.1_f32.into()));
        assert_eq!(NoDataSpan::around(-9999.9).ends::<f32>(), (-9999.9, -9999.9));
        assert!(!NoDataSpan::around(f64::NAN).contains(0.0) && !NoDataSpan::NONE.contains(f64::NAN));
        let (low, high) = NoDataSpan::NONE.ends::<f32>();
        assert!(low.is_nan() && high.is_nan());
    }
}
