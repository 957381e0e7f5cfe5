//! An expression as a tree, and how it is written.

use std::fmt;

use crate::description::expression::token::{continues_name, starts_name};
use crate::description::scalar::Scalar;

/// Names that mean something in the language, so that a property of that name needs quotes.
pub(super) const RESERVED: [&str; 6] = ["and", "or", "not", "in", "true", "false"];

/// A part of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ExpressionNode {
    /// A value written out; numbers are not negative.
    Literal(Scalar),
    /// A feature's property.
    Property(String),
    /// `-x`.
    Negative(Box<ExpressionNode>),
    /// `not x`.
    Not(Box<ExpressionNode>),
    /// Two parts and what joins them.
    Binary(Binary, Box<ExpressionNode>, Box<ExpressionNode>),
    /// `x in (…)`; at least one.
    In(Box<ExpressionNode>, Vec<ExpressionNode>),
    /// A function and its arguments, as many as it takes.
    Call(Function, Vec<ExpressionNode>),
}

/// What joins two parts.
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

/// A function.
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

/// Every function with its name, the fewest and the most arguments, and how a call is written.
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

/// How tightly something binds, from the loosest to what is never taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Strength {
    Or,
    And,
    Not,
    Comparison,
    Fallback,
    Sum,
    Product,
    Negative,
    Whole,
}

impl Binary {
    /// How it is written.
    pub fn written(self) -> &'static str {
        match self {
            Self::Or => "or",
            Self::And => "and",
            Self::Equal => "=",
            Self::Unequal => "!=",
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
            Self::Fallback => "??",
            Self::Plus => "+",
            Self::Minus => "-",
            Self::Times => "*",
            Self::Over => "/",
        }
    }

    fn strength(self) -> Strength {
        match self {
            Self::Or => Strength::Or,
            Self::And => Strength::And,
            Self::Equal | Self::Unequal => Strength::Comparison,
            Self::Less | Self::LessOrEqual | Self::Greater | Self::GreaterOrEqual => Strength::Comparison,
            Self::Fallback => Strength::Fallback,
            Self::Plus | Self::Minus => Strength::Sum,
            Self::Times | Self::Over => Strength::Product,
        }
    }
}

impl ExpressionNode {
    /// Calls `see` with it and all its parts.
    pub fn visit<'n>(&'n self, see: &mut dyn FnMut(&'n ExpressionNode)) {
        see(self);
        match self {
            Self::Literal(_) | Self::Property(_) => {}
            Self::Negative(of) | Self::Not(of) => of.visit(see),
            Self::Binary(_, left, right) => {
                left.visit(see);
                right.visit(see);
            }
            Self::In(of, list) => {
                of.visit(see);
                list.iter().for_each(|part| part.visit(see));
            }
            Self::Call(_, list) => list.iter().for_each(|part| part.visit(see)),
        }
    }

    /// The texts written out where one of them can be the result.
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

    fn strength(&self) -> Strength {
        match self {
            Self::Literal(_) | Self::Property(_) | Self::Call(..) => Strength::Whole,
            Self::Negative(_) => Strength::Negative,
            Self::Not(_) => Strength::Not,
            Self::In(..) => Strength::Comparison,
            Self::Binary(binary, ..) => binary.strength(),
        }
    }

    /// Writes it, in brackets where it binds less than `least`.
    fn write(&self, least: Strength, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.strength() < least { write!(out, "({self})") } else { write!(out, "{self}") }
    }
}

/// What a `match` compares with and gives, and what it gives else; of its arguments after the first.
pub(super) fn arms(
    parts: &[ExpressionNode],
) -> (impl Iterator<Item = (&ExpressionNode, &ExpressionNode)>, Option<&ExpressionNode>) {
    let pairs = parts[1..].chunks_exact(2);
    let otherwise = pairs.remainder().first();
    (pairs.map(|pair| (&pair[0], &pair[1])), otherwise)
}

impl fmt::Display for ExpressionNode {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Literal(Scalar::Bool(value)) => write!(out, "{value}"),
            Self::Literal(Scalar::Number(number)) => write!(out, "{number}"),
            Self::Literal(Scalar::Text(text)) => write!(out, "'{}'", text.replace('\'', "''")),
            Self::Property(name) if is_bare(name) => out.write_str(name),
            Self::Property(name) => write!(out, "`{}`", name.replace('`', "``")),
            Self::Negative(of) => {
                out.write_str("-")?;
                of.write(Strength::Negative, out)
            }
            Self::Not(of) => {
                out.write_str("not ")?;
                of.write(Strength::Not, out)
            }
            Self::Binary(binary, left, right) => {
                let (left_least, right_least) = sides(binary.strength());
                left.write(left_least, out)?;
                write!(out, " {} ", binary.written())?;
                right.write(right_least, out)
            }
            Self::In(of, list) => {
                of.write(Strength::Fallback, out)?;
                write!(out, " in {}", List(list))
            }
            Self::Call(function, list) => write!(out, "{}{}", name_of(*function), List(list)),
        }
    }
}

/// How tightly what stands on either side must bind: the same again on the left, where operators are taken in order,
/// but comparisons do not go on.
fn sides(strength: Strength) -> (Strength, Strength) {
    match strength {
        Strength::Or => (Strength::Or, Strength::And),
        Strength::And => (Strength::And, Strength::Not),
        Strength::Not | Strength::Comparison => (Strength::Fallback, Strength::Fallback),
        Strength::Fallback => (Strength::Fallback, Strength::Sum),
        Strength::Sum => (Strength::Sum, Strength::Product),
        Strength::Product => (Strength::Product, Strength::Negative),
        Strength::Negative | Strength::Whole => (Strength::Negative, Strength::Whole),
    }
}

/// Whether a property can be named without quotes.
fn is_bare(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(starts_name) && letters.all(continues_name) && !RESERVED.contains(&name)
}

/// A function's name.
pub(super) fn name_of(function: Function) -> &'static str {
    FUNCTIONS.iter().find(|known| known.1 == function).map_or("", |known| known.0)
}

/// `(a, b)`.
struct List<'n>(&'n [ExpressionNode]);

impl fmt::Display for List<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("(")?;
        for (index, node) in self.0.iter().enumerate() {
            write!(out, "{}{node}", if index > 0 { ", " } else { "" })?;
        }
        out.write_str(")")
    }
}
