//! The number that a property means, where people write it by hand: `12,5`, `ca. 12`, `12 metres`, `39'4"`, `12;14`.
//!
//! OpenStreetMap prescribes a number of meters, or feet and inches, and holds all of these. An expression of a scene file
//! takes only what is prescribed ([`Scalar::number`]); here a property is read that no expression asked for, and what is
//! no more than a manner of writing is understood. Of several numbers, as in `12;14` or `2-3`, the greatest counts: that is
//! how far up the thing reaches.

use sandtable_description::scalar::Scalar;

/// A number, and whether it was written as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeantNumber {
    /// The number; of a length in meters.
    pub number: f64,
    /// Whether it is the greatest of several.
    pub is_greatest: bool,
}

/// What a number counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Meters, unless a unit follows.
    Length,
    /// Stories, or what else has no unit.
    Count,
}

/// Units of length, each with its meters.
const LENGTHS: [(&str, f64); 24] = [
    ("m", 1.0),
    ("m.", 1.0),
    ("mt", 1.0),
    ("mts", 1.0),
    ("mtr", 1.0),
    ("mtrs", 1.0),
    ("meter", 1.0),
    ("meters", 1.0),
    ("metre", 1.0),
    ("metres", 1.0),
    ("metro", 1.0),
    ("metros", 1.0),
    ("mètres", 1.0),
    ("м", 1.0),
    ("cm", 0.01),
    ("mm", 0.001),
    ("yd", 0.9144),
    ("'", FOOT_M),
    ("ft", FOOT_M),
    ("ft.", FOOT_M),
    ("feet", FOOT_M),
    ("foot", FOOT_M),
    ("in", INCH_M),
    ("\"", INCH_M),
];

/// Words for stories.
const STORIES: [(&str, f64); 11] = [
    ("level", 1.0),
    ("levels", 1.0),
    ("floor", 1.0),
    ("floors", 1.0),
    ("story", 1.0),
    ("stories", 1.0),
    ("storey", 1.0),
    ("storeys", 1.0),
    ("fl", 1.0),
    ("lvl", 1.0),
    ("etages", 1.0),
];

const FOOT_M: f64 = 0.3048;
const INCH_M: f64 = 0.0254;

/// What says that a number is not exact; longer words before those that they begin with.
const ABOUT: [&str; 20] = [
    "approximately",
    "approx.",
    "approx",
    "around",
    "about",
    "circa",
    "environ",
    "etwa",
    "env.",
    "cca.",
    "cca",
    "ca.",
    "ca",
    "c.",
    "est.",
    "~",
    "≈",
    "±",
    ">",
    "<",
];

/// Longer texts are prose.
const MOST_LETTERS: usize = 64;

/// The number that a property's value means; `None` where it means none, or more than one in ways that are not understood.
pub fn meant(value: &Scalar, meaning: Meaning) -> Option<MeantNumber> {
    let text = match value {
        Scalar::Number(number) => return one(Some(*number).filter(|number| number.is_finite())?),
        Scalar::Bool(_) => return None,
        Scalar::Text(text) => plain(text)?,
    };
    let units = match meaning {
        Meaning::Length => &LENGTHS[..],
        Meaning::Count => &STORIES[..],
    };
    let parts: Vec<&str> = text.split([';', '|']).map(str::trim).filter(|part| !part.is_empty()).collect();
    let mut numbers = Vec::new();
    for part in parts {
        match single(part, units) {
            Some(number) => numbers.push(number),
            None => numbers.extend(range(part, units)?),
        }
    }
    let number = numbers.iter().copied().reduce(f64::max)?;
    Some(MeantNumber { number, is_greatest: numbers.iter().any(|&other| other != number) })
}

fn one(number: f64) -> Option<MeantNumber> {
    Some(MeantNumber { number, is_greatest: false })
}

/// The text in small letters, with plain signs for typographic ones; `None` where it is too long for a number.
fn plain(text: &str) -> Option<String> {
    let text = text.trim();
    if text.chars().count() > MOST_LETTERS {
        return None;
    }
    let sign = |letter: char| match letter {
        '\u{2212}' | '\u{2013}' | '\u{2014}' => '-',
        '\u{2019}' | '\u{2032}' | '\u{b4}' => '\'',
        '\u{201c}' | '\u{201d}' | '\u{2033}' => '"',
        letter if letter.is_whitespace() => ' ',
        letter => letter,
    };
    let text: String = text.to_lowercase().chars().map(sign).collect();
    Some(text.replace("''", "\""))
}

/// The two numbers of `2-3` or `10 to 12 m`. The unit of the second counts for both.
fn range(text: &str, units: &[(&str, f64)]) -> Option<[f64; 2]> {
    let (low, high) = text
        .split_once(" to ")
        .or_else(|| text.split_once(" bis "))
        .or_else(|| text.split_once("..."))
        .or_else(|| text.split_once('-'))
        .or_else(|| text.split_once('/'))?;
    let high = measured(high, units)?;
    let low = measured(low, units)?;
    let factor = low.factor.or(high.factor).unwrap_or(1.0);
    let ends = [low.number * factor, high.number * high.factor.unwrap_or(1.0)];
    (0.0 <= ends[0] && ends[0] <= ends[1]).then_some(ends)
}

/// The number of a text that holds one.
fn single(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let Measured { number, factor } = measured(text, units)?;
    Some(number * factor.unwrap_or(1.0)).filter(|number| number.is_finite())
}

/// A number with the meters of its unit, where it has one.
struct Measured {
    number: f64,
    factor: Option<f64>,
}

fn measured(text: &str, units: &[(&str, f64)]) -> Option<Measured> {
    let mut text = text.trim();
    while let Some(rest) = ABOUT.iter().find_map(|word| text.strip_prefix(word)) {
        text = rest.trim_start();
    }
    let text = text.trim_end_matches(['?', '+', '°', ' ']);
    let (number, rest) = leading_number(text)?;
    let factor = |unit: &str| units.iter().find(|(known, _)| *known == unit).map(|(_, factor)| *factor);
    if rest.is_empty() {
        return Some(Measured { number, factor: None });
    }
    if let Some(factor) = factor(rest) {
        return Some(Measured { number, factor: Some(factor) });
    }
    // Feet and inches.
    let feet = ["feet", "foot", "ft.", "ft", "'"].iter().find_map(|unit| rest.strip_prefix(unit))?;
    factor("ft")?;
    let (inches, unit) = leading_number(feet.trim_start())?;
    let is_sound = (0.0..12.0).contains(&inches) && ["", "\"", "in", "in.", "inch", "inches"].contains(&unit);
    is_sound.then_some(Measured { number: number + inches / 12.0, factor: Some(FOOT_M) })
}

/// The number that a text begins with and what follows it. A comma before one, two or more than three digits is a decimal
/// one; before three it may part thousands, and the number is not understood.
fn leading_number(text: &str) -> Option<(f64, &str)> {
    let signed = text.strip_prefix(['-', '+']).unwrap_or(text);
    let length = signed.find(|letter: char| !(letter.is_ascii_digit() || ".,".contains(letter)));
    let (digits, rest) = signed.split_at(length.unwrap_or(signed.len()));
    let digits = match digits.split_once(',') {
        None => digits.to_owned(),
        Some((whole, decimals)) => {
            let is_decimal = decimals.len() != 3 && !decimals.is_empty();
            let is_plain =
                [whole, decimals].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit()));
            (is_decimal && is_plain).then(|| format!("{whole}.{decimals}"))?
        }
    };
    let number: f64 = digits.parse().ok()?;
    Some((if text.starts_with('-') { -number } else { number }, rest.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, meaning: Meaning) -> Option<(f64, bool)> {
        let meant = meant(&Scalar::Text(text.into()), meaning)?;
        Some(((meant.number * 1e6).round() / 1e6, meant.is_greatest))
    }

    #[test]
    fn lengths_are_read_as_people_write_them() {
        for (text, meters) in [
            ("12", 12.0),
            ("12,5", 12.5),
            (" 12.5 m", 12.5),
            ("12m", 12.0),
            ("12 metres", 12.0),
            ("12,25 Meter", 12.25),
            ("~12", 12.0),
            ("~ 12 m", 12.0),
            ("ca. 12", 12.0),
            ("ca 12,5m", 12.5),
            ("approx 12", 12.0),
            ("12?", 12.0),
            ("1200 cm", 12.0),
            ("40'", 12.192),
            ("39'4\"", 11.9888),
            ("39\u{2032}4\u{2033}", 11.9888),
            ("39'4", 11.9888),
            ("39 ft 4 in", 11.9888),
            ("12 ft", 3.6576),
            ("0,5", 0.5),
            ("-5", -5.0),
            ("12;12", 12.0),
        ] {
            assert_eq!(read(text, Meaning::Length), Some((meters, false)), "{text}");
        }
    }

    #[test]
    fn of_several_numbers_the_greatest_counts() {
        for (text, meters) in [
            ("12;14", 14.0),
            ("12.0 ; 14", 14.0),
            ("12,5;11", 12.5),
            ("10-12 m", 12.0),
            ("10\u{2013}12", 12.0),
            ("33-39 ft", 11.8872),
            ("10 to 12", 12.0),
        ] {
            assert_eq!(read(text, Meaning::Length), Some((meters, true)), "{text}");
        }
        assert_eq!(read("3;4", Meaning::Count), Some((4.0, true)));
        assert_eq!(read("2-3", Meaning::Count), Some((3.0, true)));
        assert_eq!(read("2/3", Meaning::Count), Some((3.0, true)));
        assert_eq!(read("3,5 floors", Meaning::Count), Some((3.5, false)));
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in [
            "",
            "tall",
            "m",
            "1,234",
            "1.234,5",
            "12 apples",
            "12;tall",
            "3-",
            "14-12",
            "12 14",
            "inf",
            "nan",
            "1e999",
            "10'12\"",
            "12 m wide",
            "2020-01-31",
            "'",
            "12''13''",
        ] {
            assert_eq!(read(text, Meaning::Length), None, "{text}");
        }
        assert_eq!(read("3 m", Meaning::Count), None, "a length is no number of stories");
        assert_eq!(read("3'", Meaning::Count), None);
        assert_eq!(read("3+1", Meaning::Count), None);
        assert_eq!(meant(&Scalar::Bool(true), Meaning::Length), None);
        assert_eq!(meant(&Scalar::Number(f64::NAN), Meaning::Length), None);
        assert_eq!(read(&"1".repeat(100), Meaning::Length), None);
    }
}
