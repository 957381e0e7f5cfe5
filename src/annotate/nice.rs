//! Nice numbers: 1, 2 and 5 times a power of ten (Heckbert 1990), and text for numbers.
//!
//! A nice number is kept as digit and exponent, and its multiples are rounded once: 3 × 0.1 is printed as 0.3, and two
//! runs never differ in a last digit.

use sandtable_base::message::numbers::{fixed, trimmed};

/// A digit 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NiceNumber {
    digit: i64,
    exponent: i32,
}

/// Exponents beyond this are refused: no distance or height is as large or as small.
const MOST_EXPONENT: i32 = 12;

impl NiceNumber {
    /// The largest nice number not above `value`.
    ///
    /// `None` where `value` is not positive, not finite, or beyond 10^±12.
    pub fn at_most(value: f64) -> Option<Self> {
        Self::near(value, [1, 0, -1], [5, 2, 1]).find(|nice| nice.value() <= value)
    }

    /// The smallest nice number not below `value`; `None` as for [`NiceNumber::at_most`].
    pub fn at_least(value: f64) -> Option<Self> {
        Self::near(value, [-1, 0, 1], [1, 2, 5]).find(|nice| nice.value() >= value)
    }

    /// The nice numbers around `value`, in the order of `offsets` of its exponent, then of `digits`; none for a value
    /// that is refused. The logarithm may be off by one next to a power of ten: neighbors are included.
    fn near(value: f64, offsets: [i32; 3], digits: [i64; 3]) -> impl Iterator<Item = Self> {
        let exponent = libm::floor(libm::log10(value));
        let is_sound = value > 0.0 && exponent.abs() <= f64::from(MOST_EXPONENT);
        let exponents = is_sound.then_some(offsets).into_iter().flatten();
        exponents
            .flat_map(move |offset| digits.map(|digit| Self { digit, exponent: exponent as i32 + offset }))
    }

    /// The number.
    pub fn value(&self) -> f64 {
        self.times(1)
    }

    /// The number times `count`, rounded once.
    pub fn times(&self, count: i64) -> f64 {
        let digits = (self.digit * count) as f64;
        let power = (0..self.exponent.abs()).fold(1.0, |power, _| power * 10.0);
        if self.exponent < 0 { digits / power } else { digits * power }
    }

    /// The decimals that its multiples need.
    pub fn decimals(&self) -> usize {
        usize::try_from(-self.exponent).unwrap_or(0)
    }
}

/// Evenly spaced nice values on an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ticks {
    /// The values, rising.
    pub values: Vec<f64>,
    /// The decimals that they need.
    pub decimals: usize,
}

impl Ticks {
    /// The ticks within `low..=high`, at most `most` of them.
    ///
    /// Empty where the range is empty or not finite, or `most` is 0.
    pub fn new(low: f64, high: f64, most: usize) -> Self {
        Self::checked(low, high, most).unwrap_or_default()
    }

    fn checked(low: f64, high: f64, most: usize) -> Option<Self> {
        /// More ticks than this on one axis cannot be told apart.
        const ENOUGH: usize = 100;
        let most = most.min(ENOUGH);
        let mut step = NiceNumber::at_least((high - low) / most.max(1) as f64)?;
        if most == 0 || !(low.abs() / step.value()).is_finite() || low.abs().max(high.abs()) > 1e12 {
            return None;
        }
        loop {
            let first = libm::ceil(low / step.value()) as i64;
            let last = libm::floor(high / step.value()) as i64;
            if last - first < most as i64 {
                let values = (first..=last).map(|count| step.times(count)).collect();
                return Some(Self { values, decimals: step.decimals() });
            }
            step = NiceNumber::at_least(step.value() * 1.5)?;
        }
    }
}

/// `value` with `decimals` digits after the point and a true minus sign.
pub fn format_number(value: f64, decimals: usize) -> String {
    fixed(value, decimals).replace('-', "−")
}

/// The digits of a number with those before the point in groups of three: `4 650 000.5`.
pub fn grouped(digits: &str) -> String {
    let whole = digits.find('.').unwrap_or(digits.len());
    let mut text = String::new();
    for (index, character) in digits.char_indices() {
        let before = digits[..index].ends_with(|other: char| other.is_ascii_digit());
        if index < whole && before && (whole - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(character);
    }
    text
}

/// `value` with up to `decimals` digits after the point, without trailing zeros.
pub fn format_trimmed(value: f64, decimals: usize) -> String {
    trimmed(value, decimals).replace('-', "−")
}

/// A distance with its unit: `340 m`, `12.4 km`, `152 km`.
pub fn format_distance(meters: f64) -> String {
    if meters < 10.0 {
        format!("{} m", format_trimmed(meters, 2))
    } else if meters < 999.5 {
        format!("{} m", format_number(meters, 0))
    } else {
        format!("{} km", format_number(meters / 1000.0, if meters < 99_950.0 { 1 } else { 0 }))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::{prop_assert, proptest};

    use super::*;

    fn at_most(value: f64) -> f64 {
        NiceNumber::at_most(value).expect("a positive number").value()
    }

    #[test]
    fn round_numbers_are_one_two_or_five_times_a_power_of_ten() {
        assert_eq!(at_most(1.0), 1.0);
        assert_eq!(at_most(0.99), 0.5);
        assert_eq!(at_most(1999.0), 1000.0);
        assert_eq!(at_most(2000.0), 2000.0);
        assert_eq!(at_most(999_999.9), 500_000.0);
        assert_eq!(at_most(0.03), 0.02);
        assert_eq!(NiceNumber::at_least(0.03).map(|nice| nice.value()), Some(0.05));
        assert_eq!(NiceNumber::at_least(1000.0).map(|nice| nice.value()), Some(1000.0));
    }

    #[test]
    fn what_is_not_a_positive_finite_number_has_no_round_one() {
        for value in [0.0, -3.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
            assert_eq!(NiceNumber::at_most(value), None, "{value}");
            assert_eq!(NiceNumber::at_least(value), None, "{value}");
        }
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let ticks = |low, high, most| {
            let Ticks { values, decimals } = Ticks::new(low, high, most);
            (values, decimals)
        };
        assert_eq!(ticks(321.0, 1062.0, 5), (vec![400.0, 600.0, 800.0, 1000.0], 0));
        assert_eq!(ticks(-0.11, 0.31, 6), (vec![-0.1, 0.0, 0.1, 0.2, 0.3], 1));
        assert_eq!(ticks(5.0, 5.0, 5).0, Vec::<f64>::new());
        assert_eq!(ticks(f64::NAN, 5.0, 5).0, Vec::<f64>::new());
        assert_eq!(ticks(0.0, 10.0, 0).0, Vec::<f64>::new());
    }

    #[test]
    fn numbers_carry_a_true_minus_sign_and_never_a_minus_zero() {
        assert_eq!(format_number(-12.0, 0), "−12");
        assert_eq!(format_number(-0.01, 1), "0.0");
        assert_eq!(format_trimmed(1.5, 2), "1.5");
        assert_eq!(format_trimmed(20.0, 2), "20");
    }

    #[test]
    fn distances_read_as_people_say_them() {
        assert_eq!(format_distance(2.5), "2.5 m");
        assert_eq!(format_distance(340.2), "340 m");
        assert_eq!(format_distance(12_400.0), "12.4 km");
        assert_eq!(format_distance(152_300.0), "152 km");
    }

    proptest! {
        #[test]
        fn the_round_number_below_is_never_far_below(value in 1e-9..1e9f64) {
            let nice = at_most(value);
            prop_assert!(nice <= value && value < nice * 2.5 * (1.0 + 1e-12));
        }

        #[test]
        fn ticks_stay_in_range_and_in_number(low in -1e5..1e5f64, span in 1e-3..1e5f64, most in 1..12usize) {
            let marks = Ticks::new(low, low + span, most).values;
            prop_assert!(marks.len() <= most);
            prop_assert!(marks.iter().all(|mark| (low..=low + span).contains(mark)
                || (mark - low).abs().min((mark - low - span).abs()) < 1e-9 * (1.0 + low.abs() + span)));
        }
    }
}
