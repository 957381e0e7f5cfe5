//! A property's value, or the result of an expression.

/// A property's value.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    /// True or false.
    Bool(bool),
    /// A number, whole or not.
    Number(f64),
    /// Text.
    Text(String),
}

/// Meters in a foot: the international one, exactly.
const METERS_PER_FOOT: f64 = 0.3048;

impl Scalar {
    /// Whether it is true, a number other than 0, or a text that does not say no.
    pub fn holds(&self) -> bool {
        match self {
            Self::Bool(value) => *value,
            Self::Number(number) => *number != 0.0,
            Self::Text(text) => !["", "no", "false", "0"].contains(&text.as_str()),
        }
    }

    /// The number that it is, never NaN or infinite; `None` where it is none. A text may be a number, a number of meters
    /// (`4.5 m`), or a number of feet and inches (`12 ft`, `12'6"`), which becomes meters.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number).filter(|number| number.is_finite()),
            Self::Text(text) => parse_length(text.trim()),
            Self::Bool(_) => None,
        }
    }
}

fn parse_length(text: &str) -> Option<f64> {
    let plain = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let feet = |text: &str| plain(text).map(|feet| feet * METERS_PER_FOOT);
    if let Some(meters) = text.strip_suffix('m') {
        return plain(meters);
    }
    if let Some(number) = text.strip_suffix("ft") {
        return feet(number);
    }
    match text.split_once('\'') {
        Some((whole, "")) => feet(whole),
        Some((whole, inches)) => {
            let inches = plain(inches.strip_suffix('"')?).filter(|inches| (0.0..12.0).contains(inches))?;
            plain(whole).map(|whole| (whole + inches / 12.0) * METERS_PER_FOOT)
        }
        None => plain(text),
    }
}
