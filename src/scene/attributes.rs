//! The properties of a feature, for the expressions of the scene file.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use crate::feature_origin::FeatureOrigin;
use sandtable_description::expression::Expression;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::feature_value::{DefaultedValue, FeatureValue, FromScalar};
use sandtable_description::scalar::Scalar;
use sandtable_geom::crs::Crs;
use sandtable_vector::feature::{Geometry, VectorLayer};

/// Longer texts name nothing; they are cut here.
const MOST_LETTERS: usize = 1000;

/// The property that names of summits have besides those of their file.
pub const PROMINENCE: &str = "prominence";

/// The properties of one feature; none for a feature that the scene file itself states.
#[derive(Clone, Debug, Default)]
pub struct Attributes {
    feature: Option<(Arc<VectorLayer>, usize)>,
    /// What `prominence` is where the feature has no such property, in meters.
    prominence_m: Option<f64>,
}

/// The number of features for which a key's expression gave no value, by key and default.
pub type DefaultCounts = BTreeMap<(String, String), usize>;

impl Attributes {
    /// The properties of the layer's feature at an index.
    pub fn new(layer: Arc<VectorLayer>, feature: usize) -> Self {
        Self { feature: Some((layer, feature)), prominence_m: None }
    }

    /// The same with the prominence of the summit that the feature names, in meters, as its property `prominence`, unless its
    /// file states one.
    pub fn with_prominence(self, prominence_m: Option<f64>) -> Self {
        Self { prominence_m, ..self }
    }

    /// A property's value; `None` where it is absent, null, a list or a table.
    pub fn get(&self, property: &str) -> Option<Scalar> {
        let (layer, feature) = self.feature.as_ref()?;
        let Some(value) = layer.features[*feature].properties.get(property) else {
            return self.prominence_m.filter(|_| property == PROMINENCE).map(Scalar::Number);
        };
        match value {
            serde_json::Value::Bool(value) => Some(Scalar::Bool(*value)),
            serde_json::Value::Number(value) => value.as_f64().map(Scalar::Number),
            serde_json::Value::String(value) => Some(Scalar::Text(value.clone())),
            _ => None,
        }
    }

    /// The system of its file; `None` where the scene file itself states the feature.
    pub fn crs(&self) -> Option<&Crs> {
        self.feature.as_ref().map(|(layer, _)| &layer.crs)
    }

    /// Its property `name` as text; `None` where it is absent or of another kind.
    pub fn text(&self, name: &str) -> Option<&str> {
        let (layer, feature) = self.feature.as_ref()?;
        layer.features[*feature].properties.get(name)?.as_str()
    }

    /// The feature's shape as its file has it; `None` where the scene file itself states the feature.
    pub fn geometry(&self) -> Option<&Geometry> {
        let (layer, feature) = self.feature.as_ref()?;
        Some(&layer.features[*feature].geometry)
    }

    /// The vertices whose elevation its file states, in the file's system, with that elevation in meters.
    pub fn elevations_m(&self) -> impl Iterator<Item = (DVec2, f64)> + '_ {
        let feature = self.feature.as_ref().map(|(layer, feature)| &layer.features[*feature]);
        let elevated = feature.and_then(|feature| Some((feature, feature.elevations.as_ref()?)));
        let pairs = elevated.into_iter().flat_map(|(feature, elevations)| {
            feature.geometry.vertices().copied().zip(elevations.iter().copied())
        });
        pairs.filter(|(_, elevation)| elevation.is_finite())
    }

    /// The feature's name: the one given in the scene file, else its property `name`, else empty.
    pub fn name(&self, given: Option<&str>) -> String {
        match (given, self.get("name")) {
            (Some(given), _) => given.to_owned(),
            (None, Some(Scalar::Text(name))) => name,
            _ => String::new(),
        }
    }

    /// The origin of the feature, which `source` states.
    pub fn origin(&self, source: &FeatureSource) -> FeatureOrigin {
        FeatureOrigin { span: source.span(), number: self.feature.as_ref().map(|(_, feature)| feature + 1) }
    }

    /// The value of a key; `None` where the key is not stated, or the properties give no value in its range.
    pub fn value<T: FromScalar>(&self, key: Option<&FeatureValue<T>>) -> Option<T> {
        key?.value(&|name| self.get(name))
    }

    /// The value of a key, or its default.
    pub fn value_or_default<T: FromScalar>(&self, key: &DefaultedValue<T>) -> T {
        key.value(&|name| self.get(name))
    }

    /// The number of a key, or its default; counts where an expression gives none.
    pub fn number(&self, key: &DefaultedValue<f64>, counts: &mut DefaultCounts) -> f64 {
        self.number_or(key.stated(), *key.default(), counts)
    }

    /// The number of a key, or `default`; counts where an expression gives none.
    pub fn number_or(
        &self,
        key: Option<&FeatureValue<f64>>,
        default: f64,
        counts: &mut DefaultCounts,
    ) -> f64 {
        self.value(key).unwrap_or_else(|| {
            count_default(key, &default.to_string(), counts);
            default
        })
    }

    /// The result of an expression; `None` where it gives none.
    pub fn evaluated(&self, expression: &Expression) -> Option<Scalar> {
        expression.value(&|name| self.get(name))
    }

    /// Whether a property is present and not negative.
    pub fn affirm(&self, property: &str) -> bool {
        self.get(property).is_some_and(|value| value.holds())
    }

    /// Whether an expression holds for the feature.
    pub fn holds(&self, expression: &Expression) -> bool {
        expression.holds(&|name| self.get(name))
    }
}

/// Counts that the expression of a key gave no value; nothing where the key is not stated.
pub fn count_default<T: FromScalar>(
    key: Option<&FeatureValue<T>>,
    default: &str,
    counts: &mut DefaultCounts,
) {
    if let Some(key) = key.and_then(FeatureValue::computed_key) {
        *counts.entry((key.to_owned(), default.to_owned())).or_default() += 1;
    }
}

/// A sentence for each key and default counted.
pub fn notes(counts: &DefaultCounts) -> impl Iterator<Item = String> + '_ {
    counts.iter().map(|((key, default), count)| {
        let features = if *count == 1 { "1 feature gives" } else { &format!("{count} features give") };
        format!("{key}: {features} no value in its range; {default} was taken")
    })
}

/// A value as text; `None` for text without a letter.
pub fn written(value: &Scalar) -> Option<String> {
    let text = match value {
        Scalar::Bool(value) => value.to_string(),
        Scalar::Number(number) => number.to_string(),
        Scalar::Text(text) => text.trim().chars().take(MOST_LETTERS).collect(),
    };
    (!text.is_empty()).then_some(text)
}
