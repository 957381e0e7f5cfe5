//! Round numbers: 1, 2 and 5 times a power of ten, and text for them.
//!
//! A step is kept as digit and exponent, and its multiples are made with one rounding, so that 3 × 0.1 is
//! printed as 0.3 and two runs never differ in a last digit.

/// A digit 1, 2 or 5 times ten to a power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NiceNumber {
    digit: i64,
    exponent: i32,
}

/// Exponents beyond this are no distance or height anybody draws; they are refused.
const MOST_EXPONENT: i32 = 12;

impl NiceNumber {
    /// The largest round number not above `value`.
    ///
    /// `None` where `value` is not positive, not finite, or beyond 10^±12.
    pub fn at_most(value: f64) -> Option<Self> {
        let exponent = Self::exponent_of(value)?;
        // The logarithm may be off by one where `value` is next to a power of ten: one more is tried.
        [exponent + 1, exponent, exponent - 1]
            .into_iter()
            .flat_map(|exponent| [5, 2, 1].map(|digit| Self { digit, exponent }))
            .find(|nice| nice.value() <= value)
    }

    /// The smallest round number not below `value`; `None` as for [`Nice::at_most`].
    pub fn at_least(value: f64) -> Option<Self> {
        let exponent = Self::exponent_of(value)?;
        [exponent - 1, exponent, exponent + 1]
            .into_iter()
            .flat_map(|exponent| [1, 2, 5].map(|digit| Self { digit, exponent }))
            .find(|nice| nice.value() >= value)
    }

    fn exponent_of(value: f64) -> Option<i32> {
        let exponent = libm::floor(libm::log10(value));
        let sound = value > 0.0 && exponent.abs() <= f64::from(MOST_EXPONENT);
        sound.then_some(exponent as i32)
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

    /// How many decimals its multiples need.
    pub fn decimals(&self) -> usize {
        usize::try_from(-self.exponent).unwrap_or(0)
    }
}

/// Rising round values within `low..=high`, evenly spaced, no more than `most` of them, and their decimals.
///
/// Empty where the range is empty or not finite, or `most` is 0.
pub fn ticks(low: f64, high: f64, most: usize) -> (Vec<f64>, usize) {
    /// More marks than this on one ramp could not be told apart.
    const ENOUGH: usize = 100;
    let most = most.min(ENOUGH);
    let Some(mut step) = NiceNumber::at_least((high - low) / most.max(1) as f64) else { return (vec![], 0) };
    if most == 0 || !(low.abs() / step.value()).is_finite() || low.abs().max(high.abs()) > 1e12 {
        return (vec![], 0);
    }
    loop {
        let first = libm::ceil(low / step.value()) as i64;
        let last = libm::floor(high / step.value()) as i64;
        if last - first < most as i64 {
            return ((first..=last).map(|count| step.times(count)).collect(), step.decimals());
        }
        match NiceNumber::at_least(step.value() * 1.5) {
            Some(coarser) => step = coarser,
            None => return (vec![], 0),
        }
    }
}

/// `value` with `decimals` digits after the point and a true minus sign.
pub fn format_number(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let zero = digits.chars().all(|digit| matches!(digit, '0' | '.'));
    if value < 0.0 && !zero { format!("−{digits}") } else { digits }
}

/// `value` with up to `decimals` digits after the point, without trailing zeros.
pub fn format_trimmed(value: f64, decimals: usize) -> String {
    let text = format_number(value, decimals);
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A distance as a reader says it: `340 m`, `12.4 km`, `152 km`.
pub fn format_distance(meters: f64) -> String {
    if meters < 10.0 {
        format!("{} m", format_trimmed(meters, 2))
    } else if meters < 999.5 {
        format!("{} m", format_number(meters, 0))
    } else if meters < 99_950.0 {
        format!("{} km", format_number(meters / 1000.0, 1))
    } else {
        format!("{} km", format_number(meters / 1000.0, 0))
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
            let (marks, _) = ticks(low, low + span, most);
            prop_assert!(marks.len() <= most);
            prop_assert!(marks.iter().all(|mark| (low..=low + span).contains(mark)
                || (mark - low).abs().min((mark - low - span).abs()) < 1e-9 * (1.0 + low.abs() + span)));
        }
    }
}
