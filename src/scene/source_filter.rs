//! The filter of a vector layer for the selection of a source.

use sandtable_description::expression::Expression;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::scalar::Scalar;
use sandtable_description::selection::Selection;
use sandtable_vector::filter::{Condition, Filter};

/// A filter that no feature matches, so that it explains which values the properties of an expression have.
pub(super) fn values_of(condition: &Expression) -> Filter {
    let properties = condition.properties().into_iter();
    let none = |property: &str| Condition { property: property.to_owned(), any_of: Vec::new() };
    Filter { conditions: properties.map(none).collect() }
}

/// The filter of a source that names values of properties; that of others holds for every feature.
pub(super) fn filter_of(source: &FeatureSource) -> Filter {
    let value = |scalar: &Scalar| match scalar {
        Scalar::Bool(value) => serde_json::Value::from(*value),
        Scalar::Number(value) => serde_json::Value::from(*value),
        Scalar::Text(value) => serde_json::Value::from(value.as_str()),
    };
    let condition = |(property, wanted): (&String, &Vec<Scalar>)| Condition {
        property: property.clone(),
        any_of: wanted.iter().map(value).collect(),
    };
    let conditions = match source.selection.as_deref() {
        Some(Selection::Matching(wanted)) => wanted.iter().map(condition).collect(),
        _ => Vec::new(),
    };
    Filter { conditions }
}
