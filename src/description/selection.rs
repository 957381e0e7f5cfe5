//! The key `where`: which features of a file are meant, by a table of values or by an expression.

use std::collections::BTreeMap;

use toml::de::DeValue;

use crate::description::bounds::Bounds;
use crate::description::expression::Expression;
use crate::description::features::{Match, Scalar};
use crate::description::item::{KeyValue, MAX_LIST, kind_of};
use crate::description::sketch::KeyShape;
use crate::description::suggest::quoted;

/// Which features of a file are meant.
pub(super) enum Selection {
    /// Those with these values.
    Matching(BTreeMap<String, Match>),
    /// Those for which this holds.
    Holding(Expression),
}

impl KeyValue<'_, '_> {
    /// A filter: properties and the values they may have, or an expression.
    pub fn filter(mut self) -> Option<Selection> {
        if self.sketched(|| KeyShape::Filter(MAX_LIST)) {
            return None;
        }
        let help = "write { property = value } or \"property = 'value' and ...\"";
        let table = match self.value.get_ref() {
            DeValue::Table(table) => table,
            DeValue::String(_) => return self.expression().map(Selection::Holding),
            _ => {
                self.wrong_kind("a table or an expression", help);
                return None;
            }
        };
        if table.is_empty() {
            self.wrong(format!("`{}` names no property", self.key), help);
            return None;
        }
        let matches: Vec<_> = table
            .iter()
            .map(|(property, wanted)| {
                let item =
                    KeyValue { report: self.report, key: property.get_ref(), value: wanted, asked: None };
                Some((property.get_ref().to_string(), item.wanted()?))
            })
            .collect();
        matches.into_iter().collect::<Option<_>>().map(Selection::Matching)
    }

    fn wanted(mut self) -> Option<Match> {
        match self.value.get_ref() {
            DeValue::Array(list) if (1..=MAX_LIST).contains(&list.len()) => {
                let values: Vec<_> = list.iter().map(|value| self.element(value).scalar()).collect();
                values.into_iter().collect::<Option<_>>().map(Match::AnyOf)
            }
            DeValue::Array(list) => {
                let message = format!("`{}` lists {} values", quoted(self.key), list.len());
                self.wrong(message, format!("list from 1 to {MAX_LIST}"));
                None
            }
            _ => self.scalar().map(Match::Is),
        }
    }

    fn scalar(mut self) -> Option<Scalar> {
        match self.value.get_ref() {
            DeValue::Boolean(value) => Some(Scalar::Bool(*value)),
            DeValue::String(text) => Some(Scalar::Text(text.to_string())),
            DeValue::Integer(_) | DeValue::Float(_) => {
                self.number(Bounds::Within(f64::MIN, f64::MAX)).map(Scalar::Number)
            }
            _ => {
                let message =
                    format!("`{}` cannot equal {}", quoted(self.key), kind_of(self.value.get_ref()));
                self.wrong(message, "write text, a number, true or false, or a list of those");
                None
            }
        }
    }
}
