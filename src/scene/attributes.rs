//! What a vector file says of a feature, for the expressions of the scene file.

use std::collections::BTreeMap;
use std::sync::Arc;

use toml::Spanned;

use crate::description::expression::{self, ComputedWord, Expression, Quantity};
use crate::description::features::Scalar;
use crate::description::words::Word;
use crate::vector::feature::VectorLayer;

/// The properties of one feature; none where it stands in the scene file itself.
#[derive(Clone, Debug, Default)]
pub struct Attributes {
    of: Option<(Arc<VectorLayer>, usize)>,
}

/// How often a key's expression gave nothing and its default was taken, by key and default.
pub type Defaulted = BTreeMap<(&'static str, String), usize>;

impl Attributes {
    /// Those of the feature with this place in the layer.
    pub fn new(layer: Arc<VectorLayer>, feature: usize) -> Self {
        Self { of: Some((layer, feature)) }
    }

    /// A property's value; `None` where there is none, or it is null, a list or a table.
    pub fn get(&self, property: &str) -> Option<Scalar> {
        let (layer, feature) = self.of.as_ref()?;
        match layer.features[*feature].properties.get(property)? {
            serde_json::Value::Bool(value) => Some(Scalar::Bool(*value)),
            serde_json::Value::Number(value) => value.as_f64().map(Scalar::Number),
            serde_json::Value::String(value) => Some(Scalar::Text(value.clone())),
            _ => None,
        }
    }

    /// The feature's name: the one given in the scene file, else its property `name`, else nothing.
    pub fn name(&self, given: Option<&str>) -> String {
        match (given, self.get("name")) {
            (Some(given), _) => given.to_owned(),
            (None, Some(Scalar::Text(name))) => name,
            _ => String::new(),
        }
    }

    /// The number that the scene file states; `None` where it states none, or the properties give none in its range.
    pub fn number(&self, stated: Option<&Spanned<Quantity>>) -> Option<f64> {
        stated?.get_ref().number(&|name| self.get(name))
    }

    /// As [`Self::number`], with a default; `key` is told where an expression gives nothing.
    pub fn number_or(
        &self,
        (key, stated): (&'static str, Option<&Spanned<Quantity>>),
        default: f64,
        defaulted: &mut Defaulted,
    ) -> f64 {
        self.number(stated).unwrap_or_else(|| {
            if stated.is_some() {
                *defaulted.entry((key, default.to_string())).or_default() += 1;
            }
            default
        })
    }

    /// The word that the scene file states; `None` where it states none, or the properties give none.
    pub fn word<W: Word>(&self, stated: Option<&Spanned<ComputedWord<W>>>) -> Option<W> {
        stated?.get_ref().word(&|name| self.get(name))
    }

    /// Whether a property is there and does not say no: true, a number other than 0, or such a text.
    pub fn affirm(&self, property: &str) -> bool {
        self.get(property).is_some_and(|value| expression::holds(&value))
    }

    /// Whether an expression holds for the feature.
    pub fn holds(&self, expression: &Expression) -> bool {
        expression.holds(&|name| self.get(name))
    }
}

/// What [`Defaulted`] counted, a sentence a key.
pub fn notes(defaulted: &Defaulted) -> impl Iterator<Item = String> + '_ {
    defaulted.iter().map(|((key, default), count)| {
        let features = if *count == 1 { "1 feature gives" } else { &format!("{count} features give") };
        format!("{key}: {features} no value in its range; {default} was taken")
    })
}
