//! Numbers and counts in messages.

use std::fmt::Display;

/// `value` with `decimals` digits after the point, without a sign before what rounds to 0.
///
/// ```
/// use sandtable_base::message::numbers::fixed;
/// assert_eq!((fixed(-0.004, 2), fixed(-0.006, 2)), ("0.00".to_owned(), "-0.01".to_owned()));
/// ```
pub fn fixed(value: impl Into<f64>, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.into());
    let unsigned =
        text.strip_prefix('-').filter(|digits| digits.bytes().all(|byte| matches!(byte, b'0' | b'.')));
    unsigned.map(str::to_owned).unwrap_or(text)
}

/// `value` with at most `decimals` digits after the point and without needless zeros, as [`fixed`] rounds it.
///
/// ```
/// use sandtable_base::message::numbers::trimmed;
/// assert_eq!((trimmed(12.50, 3), trimmed(100.0, 0)), ("12.5".to_owned(), "100".to_owned()));
/// ```
pub fn trimmed(value: impl Into<f64>, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A count with its noun.
///
/// ```
/// use sandtable_base::message::numbers::counted;
/// assert_eq!((counted(1, "shelf", "shelves"), counted(2, "shelf", "shelves")), ("1 shelf".into(), "2 shelves".into()));
/// ```
pub fn counted<N: Display + PartialEq + From<u8>>(count: N, one: &str, several: &str) -> String {
    let noun = if count == N::from(1) { one } else { several };
    format!("{count} {noun}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_rounds_to_zero_has_a_sign() {
        for (value, decimals, text) in [
            (-0.0, 0, "0"),
            (-0.0, 2, "0.00"),
            (-0.4, 0, "0"),
            (-0.6, 0, "-1"),
            (-10.0, 1, "-10.0"),
            (0.25, 1, "0.2"),
        ] {
            assert_eq!(fixed(value, decimals), text);
        }
        assert_eq!((fixed(f64::NAN, 1), fixed(f64::NEG_INFINITY, 1)), ("NaN".into(), "-inf".into()));
        assert_eq!(fixed(-0.001f32, 2), "0.00");
    }

    #[test]
    fn only_zeros_after_the_point_are_needless() {
        let texts = [1.5, -84.25, 0.0, -1e-12, 100.0].map(|number| trimmed(number, 9));
        assert_eq!(texts, ["1.5", "-84.25", "0", "0", "100"]);
        assert_eq!((trimmed(1234.0, 0), trimmed(-0.0, 0)), ("1234".into(), "0".into()));
        assert_eq!((trimmed(f64::NAN, 3), trimmed(f64::INFINITY, 3)), ("NaN".into(), "inf".into()));
    }

    #[test]
    fn only_one_is_singular() {
        assert_eq!(counted(0usize, "river", "rivers"), "0 rivers");
        assert_eq!(counted(1u64, "river", "rivers"), "1 river");
        assert_eq!(counted(21u32, "river", "rivers"), "21 rivers");
    }
}
