//! Evaluates an expression for a feature.
//!
//! Each node is evaluated with a predicate for usable values, by which `??` decides: in `width ?? 6` a width of
//! `"narrow"` is not a number, so the result is 6, whereas in `name ?? ref` any text is usable.

use std::cmp::Ordering;

use crate::expression::PropertyLookup;
use crate::expression::syntax::{Binary, ExpressionNode, Function, arms};
use crate::scalar::Scalar;

/// Whether a value is usable where the expression occurs.
type Usable<'u> = &'u dyn Fn(&Scalar) -> bool;

pub(super) struct Evaluation<'p> {
    pub properties: PropertyLookup<'p>,
}

/// Every value is usable.
pub(super) fn any(_: &Scalar) -> bool {
    true
}

/// Only numbers are usable.
fn numeric(value: &Scalar) -> bool {
    value.number().is_some()
}

impl Evaluation<'_> {
    /// The value of `node`. Only the operands of `??` are tested with `usable`, within branches of `if` and `match`
    /// too.
    pub fn value(&self, node: &ExpressionNode, usable: Usable<'_>) -> Option<Scalar> {
        match node {
            ExpressionNode::Literal(value) => Some(value.clone()),
            ExpressionNode::Property(name) => (self.properties)(name),
            ExpressionNode::Negative(of) => self.number(of).and_then(|number| finite(-number)),
            ExpressionNode::Not(of) => Some(Scalar::Bool(!self.holds(of))),
            ExpressionNode::Binary(binary, left, right) => self.binary(*binary, (left, right), usable),
            ExpressionNode::In(of, list) => {
                let of = self.value(of, &any)?;
                let found = |part| self.value(part, &any).is_some_and(|part| equal(&of, &part));
                Some(Scalar::Bool(list.iter().any(found)))
            }
            ExpressionNode::Call(function, parts) => self.call(*function, parts, usable),
        }
    }

    fn holds(&self, node: &ExpressionNode) -> bool {
        self.value(node, &any).is_some_and(|value| value.holds())
    }

    fn number(&self, node: &ExpressionNode) -> Option<f64> {
        self.value(node, &numeric).and_then(|value| value.number())
    }

    fn binary(
        &self,
        binary: Binary,
        (left, right): (&ExpressionNode, &ExpressionNode),
        usable: Usable<'_>,
    ) -> Option<Scalar> {
        let numbers = || Some((self.number(left)?, self.number(right)?));
        let compared = |wanted: fn(Ordering) -> bool| {
            let (left, right) = (self.value(left, &any)?, self.value(right, &any)?);
            order(&left, &right).map(|order| Scalar::Bool(wanted(order)))
        };
        let equals = || Some(equal(&self.value(left, &any)?, &self.value(right, &any)?));
        match binary {
            Binary::Or => Some(Scalar::Bool(self.holds(left) || self.holds(right))),
            Binary::And => Some(Scalar::Bool(self.holds(left) && self.holds(right))),
            Binary::Equal => equals().map(Scalar::Bool),
            Binary::Unequal => equals().map(|equal| Scalar::Bool(!equal)),
            Binary::Less => compared(Ordering::is_lt),
            Binary::LessOrEqual => compared(Ordering::is_le),
            Binary::Greater => compared(Ordering::is_gt),
            Binary::GreaterOrEqual => compared(Ordering::is_ge),
            Binary::Fallback => self.value(left, usable).filter(usable).or_else(|| self.value(right, usable)),
            Binary::Plus => numbers().and_then(|(left, right)| finite(left + right)),
            Binary::Minus => numbers().and_then(|(left, right)| finite(left - right)),
            Binary::Times => numbers().and_then(|(left, right)| finite(left * right)),
            Binary::Over => numbers().and_then(|(left, right)| finite(left / right)),
        }
    }

    fn call(&self, function: Function, parts: &[ExpressionNode], usable: Usable<'_>) -> Option<Scalar> {
        match function {
            Function::If if self.holds(&parts[0]) => self.value(&parts[1], usable),
            Function::If => self.value(&parts[2], usable),
            Function::Match => self.matched(parts, usable),
            Function::Min => self.folded(parts, f64::min),
            Function::Max => self.folded(parts, f64::max),
            Function::Clamp => {
                let (low, high) = (self.number(&parts[1])?, self.number(&parts[2])?);
                self.number(&parts[0]).and_then(|number| finite(number.max(low).min(high)))
            }
            Function::Round => self.number(&parts[0]).and_then(|number| finite(number.round())),
            Function::Number => self.number(&parts[0]).and_then(finite),
            Function::Has => Some(Scalar::Bool(self.value(&parts[0], &any).is_some())),
        }
    }

    fn matched(&self, parts: &[ExpressionNode], usable: Usable<'_>) -> Option<Scalar> {
        let (mut pairs, otherwise) = arms(parts);
        let of = self.value(&parts[0], &any);
        let is = |case: &ExpressionNode| {
            of.as_ref().is_some_and(|of| self.value(case, &any).is_some_and(|case| equal(of, &case)))
        };
        let chosen = pairs.find(|(case, _)| is(case)).map(|(_, then)| then).or(otherwise)?;
        self.value(chosen, usable)
    }

    fn folded(&self, parts: &[ExpressionNode], fold: fn(f64, f64) -> f64) -> Option<Scalar> {
        let numbers: Option<Vec<f64>> = parts.iter().map(|part| self.number(part)).collect();
        numbers?.into_iter().reduce(fold).and_then(finite)
    }
}

/// `number`; `None` after a division by zero or an overflow.
fn finite(number: f64) -> Option<Scalar> {
    // −0 becomes 0.
    number.is_finite().then_some(Scalar::Number(number + 0.0))
}

fn equal(left: &Scalar, right: &Scalar) -> bool {
    match (left, right) {
        (Scalar::Text(left), Scalar::Text(right)) => left == right,
        (Scalar::Bool(wanted), other) | (other, Scalar::Bool(wanted)) => other.holds() == *wanted,
        _ => left.number().zip(right.number()).is_some_and(|(left, right)| left == right),
    }
}

/// The order of two values; `None` where they are not comparable.
fn order(left: &Scalar, right: &Scalar) -> Option<Ordering> {
    match (left.number().zip(right.number()), left, right) {
        (Some((left, right)), ..) => left.partial_cmp(&right),
        (None, Scalar::Text(left), Scalar::Text(right)) => Some(left.cmp(right)),
        _ => None,
    }
}
