//! Values per feature: constants, or expressions over a feature's properties.

use std::fmt::Debug;
use std::ops::Range;

use crate::bounds::Bounds;
use crate::expression::{Expression, PropertyLookup};
use crate::scalar::Scalar;
use crate::stated::Stated;
use sandtable_base::message::choice::Choice;

/// A type that the result of an expression converts to.
pub trait FromScalar: Clone + Debug + PartialEq {
    /// The bounds of a key's values.
    type Limits: Copy + Debug + PartialEq;

    /// Converts `scalar`; `None` where it does not convert or is not within `limits`.
    fn from_scalar(scalar: &Scalar, limits: Self::Limits) -> Option<Self>;
}

impl FromScalar for f64 {
    type Limits = Bounds;

    /// A text that is a number, or a number of meters (`"4.5 m"`) or feet (`"12 ft"`), is that number.
    fn from_scalar(scalar: &Scalar, limits: Bounds) -> Option<Self> {
        scalar.number().filter(|&number| limits.hold(number))
    }
}

/// A choice whose word an expression may compute.
pub trait FeatureWord: Choice + FromScalar<Limits = ()> {}

impl<W: Choice + FromScalar<Limits = ()>> FeatureWord for W {}

/// The value whose word `scalar` is; `None` where it is none of them.
pub fn word_of_scalar<W: Choice>(scalar: &Scalar) -> Option<W> {
    match scalar {
        Scalar::Text(text) => W::from_word(text),
        Scalar::Bool(_) | Scalar::Number(_) => None,
    }
}

/// A value that is the same for all features, or computed for each.
#[derive(Clone, Debug, PartialEq)]
pub enum FeatureValue<T: FromScalar> {
    /// The same for all.
    Fixed(T),
    /// The result of an expression, where it lies within limits.
    Computed {
        /// The expression.
        expression: Expression,
        /// The limits of the key.
        limits: T::Limits,
        /// The table and the key, such as `[[road]] width`.
        key: String,
    },
}

impl<T: FromScalar> FeatureValue<T> {
    /// The value for a feature; `None` where its properties give none within the limits.
    pub fn value(&self, properties: PropertyLookup<'_>) -> Option<T> {
        match self {
            Self::Fixed(value) => Some(value.clone()),
            Self::Computed { expression, limits, .. } => {
                let usable = |value: &Scalar| T::from_scalar(value, *limits).is_some();
                T::from_scalar(&expression.value_for(properties, &usable)?, *limits)
            }
        }
    }

    /// Whether its expression reads a property.
    pub fn reads(&self, property: &str) -> bool {
        match self {
            Self::Fixed(_) => false,
            Self::Computed { expression, .. } => expression.properties().contains(&property),
        }
    }

    /// The table and the key whose expression may give no value; `None` where the value is the same for all features.
    pub fn computed_key(&self) -> Option<&str> {
        match self {
            Self::Fixed(_) => None,
            Self::Computed { key, .. } => Some(key),
        }
    }
}

/// A value per feature with a default, for a key that is absent or whose expression has no value.
#[derive(Clone, Debug, PartialEq)]
pub struct DefaultedValue<T: FromScalar> {
    stated: Option<Stated<FeatureValue<T>>>,
    default: T,
}

impl<T: FromScalar> DefaultedValue<T> {
    /// `stated`; where it is `None` or has no value, `default`.
    pub fn new(stated: Option<Stated<FeatureValue<T>>>, default: T) -> Self {
        Self { stated, default }
    }

    /// The value in the scene file; `None` where the key is absent.
    pub fn stated(&self) -> Option<&FeatureValue<T>> {
        self.stated.as_deref()
    }

    /// The default.
    pub fn default(&self) -> &T {
        &self.default
    }

    /// The bytes of the value in the scene file; `None` where the key is absent.
    pub fn span(&self) -> Option<Range<usize>> {
        self.stated.as_ref().and_then(Stated::span)
    }

    /// The value for a feature.
    pub fn value(&self, properties: PropertyLookup<'_>) -> T {
        self.stated().and_then(|stated| stated.value(properties)).unwrap_or_else(|| self.default.clone())
    }
}
