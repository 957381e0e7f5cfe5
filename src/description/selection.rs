//! The key `where`: selects features of a file by the values of their properties or by an expression.

use std::collections::BTreeMap;

use toml::de::DeValue;

use crate::bounds::Bounds;
use crate::expression::Expression;
use crate::scalar::Scalar;
use crate::value::{KeyValue, type_name};
use sandtable_base::message::suggest::quoted;

/// A selection of features of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// Those of which every property listed has one of the values listed for it.
    Matching(BTreeMap<String, Vec<Scalar>>),
    /// Those for which the expression holds.
    Holding(Expression),
}

impl KeyValue<'_, '_> {
    /// A table of properties and their values, or an expression.
    pub fn selection(mut self) -> Option<Selection> {
        let help = "write { property = value } or \"property = 'value' and ...\"";
        match self.value.get_ref() {
            DeValue::Table(table) if table.is_empty() => {
                self.wrong(format!("`{}` names no property", self.key), help)
            }
            DeValue::Table(table) => {
                let values = |values: KeyValue<'_, '_>| values.one_or_more("values", |value| value.scalar());
                self.each_entry(table, values).map(Selection::Matching)
            }
            DeValue::String(_) => self.expression().map(Selection::Holding),
            _ => self.wrong_type("a table or an expression", help),
        }
    }

    fn scalar(mut self) -> Option<Scalar> {
        match self.value.get_ref() {
            DeValue::Boolean(value) => Some(Scalar::Bool(*value)),
            DeValue::String(text) => Some(Scalar::Text(text.to_string())),
            DeValue::Integer(_) | DeValue::Float(_) => self.number(Bounds::FINITE).map(Scalar::Number),
            other => {
                let message = format!("`{}` cannot equal {}", quoted(self.key), type_name(other));
                self.wrong(message, "write text, a number, true or false, or a list of those")
            }
        }
    }
}
