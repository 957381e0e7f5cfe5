//! Values that come from a feature's properties: a small language, total, without loops and without surprises.
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
//! **What is missing stays missing.** A property that a feature does not have, a text where a number is needed, a
//! division by zero: all have no value, and so has every computation and comparison with one of them. `a ?? b` is `b`
//! where `a` has no value that can be used in its place: no number where one is needed, no word that the key knows.
//!
//! **To hold** is to be true, a number other than 0, or a text other than ``, `no`, `false` and `0`; what has no value
//! does not hold. `and`, `or`, `not`, `if` and `where` ask whether a thing holds, so `not bridge` is true of a road
//! without the property, and `lanes < 2` holds for no road of which the lanes are unknown.
//!
//! **Texts as numbers.** Many files write numbers as texts. Where a number is needed, or the other side of a comparison
//! is one, a text that is a number is that number, meters (`"4.5 m"`) or feet (`"12 ft"`, `"12'6\""`) where it says so.
//! Two texts are equal letter by letter, and ordered as numbers where both are numbers, else letter by letter. `true`
//! equals what holds, `false` what does not.
//!
//! Reading is bounded: a text has at most [`MAX_TEXT_BYTES`], nesting at most [`MAX_DEPTH`]; evaluating takes time in
//! proportion to the text.

mod evaluate;
mod parser;
mod syntax;
mod token;

use std::collections::BTreeSet;
use std::ops::Range;

use crate::description::expression::evaluate::{Evaluation, any};
use crate::description::expression::syntax::ExpressionNode;
use crate::description::scalar::Scalar;

/// The longest text of an expression: a screen full. Far above what anybody can read, and it bounds the work.
pub const MAX_TEXT_BYTES: usize = 4096;
/// The deepest nesting, of brackets as of chains of operators: it bounds the stack, and nobody reads deeper.
pub const MAX_DEPTH: usize = 200;

/// Gives the value of a feature's property by its name; `None` where the feature has none.
pub type PropertyLookup<'a> = &'a dyn Fn(&str) -> Option<Scalar>;

/// A computation over a feature's properties.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    root: ExpressionNode,
}

/// Why a text is no expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message} at column {column}")]
pub struct ExpressionError {
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: String,
    /// The bytes of the text that it is about.
    pub at: Range<usize>,
    /// Where that starts: the first character of the text is column 1.
    pub column: usize,
}

impl Expression {
    /// The expression that `text` writes.
    ///
    /// # Errors
    /// See [`ExpressionError`].
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        Self::parse_among(text, &[])
    }

    /// As [`Self::parse`], for an expression that gives one of `words`: a bare name that is one of them is taken for a
    /// text without its quotes, and so is a text that is none of them where the result is written out.
    ///
    /// # Errors
    /// See [`ExpressionError`].
    pub fn parse_among(text: &str, words: &[&str]) -> Result<Self, ExpressionError> {
        parser::parse(text, words).map(|root| Self { root })
    }

    /// Whether `text` can only be meant as an expression, not as a word: it holds more than letters, digits, `_` and
    /// `-`. A word that a key does not know is thus told as one misspelled, and not taken for a property.
    pub fn computes(text: &str) -> bool {
        !text.chars().all(|letter| letter.is_alphanumeric() || "_-".contains(letter))
    }

    /// The properties that it looks at, in alphabetical order, each once.
    pub fn properties(&self) -> Vec<&str> {
        let mut names = BTreeSet::new();
        self.root.add_properties(&mut names);
        names.into_iter().collect()
    }

    /// Its value for a feature; `None` where a property that it needs is missing or of another kind.
    pub fn value(&self, properties: PropertyLookup<'_>) -> Option<Scalar> {
        self.value_for(properties, &any)
    }

    /// As [`Self::value`], where only what `usable` says can be used: a fallback is taken for anything else.
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
