//! The syntax tree of an expression, its operators and functions.

use std::collections::BTreeSet;

use crate::scalar::Scalar;

/// Keywords. A property of the same name needs quotes.
pub(super) const RESERVED: [&str; 6] = ["and", "or", "not", "in", "true", "false"];

/// A node of the tree.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ExpressionNode {
    /// A literal; numbers are not negative.
    Literal(Scalar),
    Property(String),
    /// `-x`.
    Negative(Box<ExpressionNode>),
    /// `not x`.
    Not(Box<ExpressionNode>),
    Binary(Binary, Box<ExpressionNode>, Box<ExpressionNode>),
    /// `x in (…)`; at least one.
    In(Box<ExpressionNode>, Vec<ExpressionNode>),
    /// A function and its arguments, as many as it takes.
    Call(Function, Vec<ExpressionNode>),
}

/// A binary operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Or,
    And,
    Equal,
    Unequal,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Fallback,
    Plus,
    Minus,
    Times,
    Over,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    If,
    Match,
    Min,
    Max,
    Clamp,
    Round,
    Number,
    Has,
}

/// Every function with its name, its fewest and most arguments, and an example of a call.
pub(super) const FUNCTIONS: [(&str, Function, usize, usize, &str); 8] = [
    ("if", Function::If, 3, 3, "if(condition, then, else)"),
    ("match", Function::Match, 3, usize::MAX, "match(x, 'a', 1, 'b', 2, else)"),
    ("min", Function::Min, 1, usize::MAX, "min(a, b)"),
    ("max", Function::Max, 1, usize::MAX, "max(a, b)"),
    ("clamp", Function::Clamp, 3, 3, "clamp(x, low, high)"),
    ("round", Function::Round, 1, 1, "round(x)"),
    ("number", Function::Number, 1, 1, "number(x)"),
    ("has", Function::Has, 1, 1, "has(x)"),
];

/// The operators and their spelling, by precedence, the loosest first.
pub(super) const OPERATORS: [&[(&str, Binary)]; 6] = [
    &[("or", Binary::Or)],
    &[("and", Binary::And)],
    &[
        ("=", Binary::Equal),
        ("!=", Binary::Unequal),
        ("<", Binary::Less),
        ("<=", Binary::LessOrEqual),
        (">", Binary::Greater),
        (">=", Binary::GreaterOrEqual),
    ],
    &[("??", Binary::Fallback)],
    &[("+", Binary::Plus), ("-", Binary::Minus)],
    &[("*", Binary::Times), ("/", Binary::Over)],
];

impl ExpressionNode {
    /// Adds the names of the properties in it to `names`.
    pub fn add_properties<'n>(&'n self, names: &mut BTreeSet<&'n str>) {
        match self {
            Self::Literal(_) => {}
            Self::Property(name) => drop(names.insert(name)),
            Self::Negative(of) | Self::Not(of) => of.add_properties(names),
            Self::Binary(_, left, right) => [left, right].iter().for_each(|part| part.add_properties(names)),
            Self::In(of, list) => {
                [of.as_ref()].into_iter().chain(list).for_each(|part| part.add_properties(names))
            }
            Self::Call(_, list) => list.iter().for_each(|part| part.add_properties(names)),
        }
    }

    /// The text literals that the expression can evaluate to.
    pub fn results(&self) -> Vec<&str> {
        match self {
            Self::Literal(Scalar::Text(text)) => vec![text],
            Self::Binary(Binary::Fallback, left, right) => [left.results(), right.results()].concat(),
            Self::Call(Function::If, parts) => [parts[1].results(), parts[2].results()].concat(),
            Self::Call(Function::Match, parts) => {
                let (pairs, otherwise) = arms(parts);
                pairs.map(|(_, then)| then).chain(otherwise).flat_map(Self::results).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// The cases of a `match`, each with its result, and the result where no case matches.
pub(super) fn arms(
    parts: &[ExpressionNode],
) -> (impl Iterator<Item = (&ExpressionNode, &ExpressionNode)>, Option<&ExpressionNode>) {
    let pairs = parts[1..].chunks_exact(2);
    let otherwise = pairs.remainder().first();
    (pairs.map(|pair| (&pair[0], &pair[1])), otherwise)
}
