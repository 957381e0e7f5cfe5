//! Values that come from a feature's properties: a small language in which every
//! evaluation ends.
//!
//! ```toml
//! where    = "highway in ('primary', 'secondary') and not tunnel"
//! width    = "width ?? lanes * 3.25 ?? 6"
//! height   = "clamp(height ?? `building:levels` * 3, 2.5, 120)"
//! surface  = "if(surface = 'gravel' or tracktype, 'gravel', 'asphalt')"
//! cover    = "match(landuse, 'forest', 'forest', 'farmland', 'field', 'meadow')"
//! ```
//!
//! The grammar, loosest first; `{x}` is any number of x, `[x]` one or none:
//!
//! ```text
//! expression  conjunction { "or" conjunction }
//! conjunction negation { "and" negation }
//! negation    "not" negation | comparison
//! comparison  fallback [ ("=" | "!=" | "<" | "<=" | ">" | ">=") fallback | ["not"] "in" "(" list ")" ]
//! fallback    sum { "??" sum }
//! sum         product { ("+" | "-") product }
//! product     factor { ("*" | "/") factor }
//! factor      "-" factor | primary
//! primary     number | 'text' | true | false | name | `any name` | "any name" | call | "(" expression ")"
//! call        function "(" list ")"
//! list        expression { "," expression }
//! name        a letter or "_", then letters, digits, "_" and ":"
//! ```
//!
//! A quotation mark is doubled where it stands in what it quotes: `'Queen''s Road'`.
//!
//! | function | gives |
//! |---|---|
//! | `if(c, a, b)` | `a` where `c` holds, else `b` |
//! | `match(x, 'a', p, 'b', q, r)` | `p` where `x = 'a'`, `q` where `x = 'b'`, else `r`; nothing without an `r` |
//! | `min(a, b, …)`, `max(a, b, …)` | the least, the greatest |
//! | `clamp(x, low, high)` | `x`, but not below `low` nor above `high` |
//! | `round(x)` | the nearest whole number; halves away from zero |
//! | `number(x)` | the number that a text writes |
//! | `has(x)` | true where `x` has a value, else false |
//! | `property('name')` | the property of that name, whatever characters are in it |
//!
//! **Missing values propagate.** A missing property, a text where a number is needed, and a division by zero have no
//! value, nor has a computation or comparison with one of them. `a ?? b` is `b` where `a` has no usable value: a number
//! where one is needed, one of the key's words where the key takes words.
//!
//! **Truth.** A value *holds* where it is true, a number other than 0, or a text other than ``, `no`, `false` and `0`; a
//! missing value does not hold. `and`, `or`, `not`, `if` and `where` test whether a value holds, so `not bridge` is
//! true of a road without the property, and `lanes < 2` does not hold for a road without `lanes`.
//!
//! **Texts as numbers.** Where a number is needed, or the other operand of a comparison is one, a text converts to a
//! number, with a unit of meters (`"4.5 m"`) or feet (`"12 ft"`, `"12'6\""`). Two texts are equal where their letters
//! are, and are ordered as numbers where both convert, else by letters. `true` equals a value that holds, `false` one
//! that does not.
//!
//! Parsing is bounded by [`EXPRESSION_BYTES`](sandtable_base::limits::EXPRESSION_BYTES) and
//! [`EXPRESSION_DEPTH`](sandtable_base::limits::EXPRESSION_DEPTH); evaluation takes time in proportion to the text.

mod evaluate;
mod parser;
mod syntax;
mod token;

use std::collections::BTreeSet;
use std::ops::Range;

use crate::expression::evaluate::{Evaluation, any};
use crate::expression::syntax::ExpressionNode;
use crate::scalar::Scalar;

/// Looks up a feature's property by name; `None` where the feature does not have it.
pub type PropertyLookup<'a> = &'a dyn Fn(&str) -> Option<Scalar>;

/// A computation over a feature's properties.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    root: ExpressionNode,
}

/// Why a text is not an expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}{}", column.map_or_else(String::new, |column| format!(" at column {column}")))]
pub struct ExpressionError {
    /// The fault.
    pub message: String,
    /// The remedy.
    pub help: String,
    /// The wrong bytes of the text.
    pub at: Range<usize>,
    /// The column where that starts, from 1; `None` where a diagnostic marks the place.
    pub column: Option<usize>,
}

impl Expression {
    /// The expression that `text` writes.
    ///
    /// # Errors
    /// See [`ExpressionError`].
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        Self::parse_among(text, &[])
    }

    /// As [`Self::parse`], for an expression whose result is one of `words`. A word of the list without quotes is an
    /// error, and so is a literal result that is not in the list.
    ///
    /// # Errors
    /// See [`ExpressionError`].
    pub fn parse_among(text: &str, words: &[&str]) -> Result<Self, ExpressionError> {
        parser::parse(text, words).map(|root| Self { root })
    }

    /// Whether `text` can only be an expression and not a word: it contains other characters than letters, digits, `_`
    /// and `-`. An unknown word is thus reported as misspelled and not read as a property.
    pub fn computes(text: &str) -> bool {
        !text.chars().all(|letter| letter.is_alphanumeric() || "_-".contains(letter))
    }

    /// The properties that it reads, in alphabetical order, each once.
    pub fn properties(&self) -> Vec<&str> {
        let mut names = BTreeSet::new();
        self.root.add_properties(&mut names);
        names.into_iter().collect()
    }

    /// Its value for a feature; `None` where a property that it needs is missing or of another kind.
    pub fn value(&self, properties: PropertyLookup<'_>) -> Option<Scalar> {
        self.value_for(properties, &any)
    }

    /// As [`Self::value`], but values that are not `usable` count as missing, both for `??` and for the result.
    pub fn value_for(
        &self,
        properties: PropertyLookup<'_>,
        usable: &dyn Fn(&Scalar) -> bool,
    ) -> Option<Scalar> {
        Evaluation { properties }.value(&self.root, usable).filter(usable)
    }

    /// Whether it holds for a feature: its value is true, a number that is not 0, or a text that is neither empty nor
    /// `no`, `false` or `0`.
    pub fn holds(&self, properties: PropertyLookup<'_>) -> bool {
        self.value(properties).is_some_and(|value| value.holds())
    }
}

#[cfg(test)]
mod tests;
