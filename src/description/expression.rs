//! Values that come from a feature's properties.

use crate::description::bounds::Bounds;
use crate::description::features::Scalar;
use crate::description::words::Word;

/// Gives the value of a feature's property by its name; `None` where the feature has none.
pub type Properties<'a> = &'a dyn Fn(&str) -> Option<Scalar>;

/// A computation over a feature's properties.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    property: String,
}

/// Why a text is no expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ExpressionError {
    /// What is wrong and where.
    pub message: String,
    /// What to do.
    pub help: String,
}

impl Expression {
    /// The expression that `text` writes.
    ///
    /// # Errors
    /// See [`ExpressionError`].
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        if text.chars().all(|letter| letter.is_alphanumeric() || letter == '_' || letter == ':') {
            return Ok(Self { property: text.to_owned() });
        }
        let message = format!("\"{text}\" is not the name of a property");
        Err(ExpressionError { message, help: "write a property's name".into() })
    }

    /// Whether `text` can only be meant as an expression, not as a word: it holds more than a name.
    pub fn computes(text: &str) -> bool {
        !text.chars().all(|letter| letter.is_alphanumeric() || "_-".contains(letter))
    }

    /// Its value for a feature; `None` where a property that it needs is missing or of another kind.
    pub fn value(&self, properties: Properties<'_>) -> Option<Scalar> {
        properties(&self.property)
    }

    /// Whether it holds for a feature: its value is true, a number that is not 0, or a text that is neither empty nor
    /// `no`, `false` or `0`.
    pub fn holds(&self, properties: Properties<'_>) -> bool {
        match self.value(properties) {
            None => false,
            Some(Scalar::Bool(value)) => value,
            Some(Scalar::Number(value)) => value != 0.0,
            Some(Scalar::Text(text)) => !["", "no", "false", "0"].contains(&text.as_str()),
        }
    }
}

/// A number, the same for all features or computed for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity(Given<f64>);

#[derive(Clone, Debug, PartialEq)]
enum Given<T> {
    Fixed(T),
    OfFeatures(Expression, Bounds),
}

impl Quantity {
    /// The same number for all.
    pub fn fixed(number: f64) -> Self {
        Self(Given::Fixed(number))
    }

    /// What `expression` gives, where that lies within `bounds`.
    pub fn of_features(expression: Expression, bounds: Bounds) -> Self {
        Self(Given::OfFeatures(expression, bounds))
    }

    /// The number for a feature; `None` where its properties give none within the key's bounds. A text that is a number,
    /// or a number of metres (`"4.5 m"`), is that number.
    pub fn number(&self, properties: Properties<'_>) -> Option<f64> {
        match &self.0 {
            Given::Fixed(number) => Some(*number),
            Given::OfFeatures(expression, bounds) => expression
                .value(properties)
                .as_ref()
                .and_then(as_number)
                .filter(|&number| bounds.hold(number)),
        }
    }
}

/// A word, the same for all features or computed for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice<W> {
    /// The same for all.
    Fixed(W),
    /// What an expression gives.
    OfFeatures(Expression),
}

impl<W: Word> Choice<W> {
    /// What `expression` gives.
    pub fn of_features(expression: Expression) -> Self {
        Self::OfFeatures(expression)
    }

    /// The word for a feature; `None` where its properties give none of `W`'s words.
    pub fn word(&self, properties: Properties<'_>) -> Option<W> {
        match self {
            Self::Fixed(word) => Some(*word),
            Self::OfFeatures(expression) => match expression.value(properties)? {
                Scalar::Text(text) => W::ALL.iter().find(|(word, _)| *word == text).map(|(_, value)| *value),
                Scalar::Bool(_) | Scalar::Number(_) => None,
            },
        }
    }
}

/// The number that a value is, metres where it says so.
pub fn as_number(value: &Scalar) -> Option<f64> {
    match value {
        Scalar::Number(number) => Some(*number),
        Scalar::Text(text) => {
            text.trim().trim_end_matches('m').trim_end().parse().ok().filter(|n: &f64| n.is_finite())
        }
        Scalar::Bool(_) => None,
    }
}
