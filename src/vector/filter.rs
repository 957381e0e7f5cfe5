//! Selects features by their properties.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::feature::{Feature, VectorLayer};

/// Conditions on a feature's properties. All must hold; an empty filter matches every feature.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Filter {
    /// In any order.
    pub conditions: Vec<Condition>,
}

/// A condition on one property.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// The property's name.
    pub property: String,
    /// The values that it may have. Numbers are compared as numbers, integers with floats; the number 2 and the text
    /// "2" differ.
    pub any_of: Vec<Value>,
}

impl Filter {
    /// Returns whether all conditions hold; a condition on an absent property does not.
    pub fn matches(&self, feature: &Feature) -> bool {
        self.conditions.iter().all(|condition| {
            feature.properties.get(&condition.property).is_some_and(|value| condition.holds(value))
        })
    }

    /// Returns the features that match, each with its index in [`VectorLayer::features`].
    pub fn select<'a>(&'a self, layer: &'a VectorLayer) -> impl Iterator<Item = (usize, &'a Feature)> + 'a {
        layer.features.iter().enumerate().filter(|(_, feature)| self.matches(feature))
    }

    /// Explains why no feature matches: the existing values of each property whose condition never holds.
    ///
    /// Returns `None` where a feature matches, or where each condition holds for some feature but never all together.
    pub fn explain_no_match(&self, layer: &VectorLayer) -> Option<String> {
        if self.select(layer).next().is_some() {
            return None;
        }
        let reasons: Vec<String> =
            self.conditions.iter().filter_map(|condition| condition.explain_no_match(layer)).collect();
        (!reasons.is_empty()).then(|| reasons.join("; "))
    }
}

impl Condition {
    fn holds(&self, value: &Value) -> bool {
        self.any_of.iter().any(|wanted| match (wanted, value) {
            (Value::Number(wanted), Value::Number(value)) => wanted.as_f64() == value.as_f64(),
            _ => wanted == value,
        })
    }

    fn explain_no_match(&self, layer: &VectorLayer) -> Option<String> {
        /// As many as fit on a line.
        const MAX_SHOWN: usize = 12;
        let property = &self.property;
        let values = layer.features.iter().filter_map(|feature| feature.properties.get(property));
        let mut distinct = BTreeSet::new();
        for value in values.filter(|value| !value.is_null()) {
            if self.holds(value) {
                return None;
            }
            if distinct.len() <= MAX_SHOWN {
                distinct.insert(value.to_string().chars().take(40).collect::<String>());
            }
        }
        if distinct.is_empty() {
            return Some(format!("no feature has the property '{property}'"));
        }
        let more = if distinct.len() > MAX_SHOWN { ", ..." } else { "" };
        let shown: Vec<String> = distinct.into_iter().take(MAX_SHOWN).collect();
        Some(format!("'{property}' is {}{more}", shown.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feature::Geometry;
    use sandtable_geom::crs::Crs;
    use serde_json::json;

    fn layer(properties: &[Value]) -> VectorLayer {
        let feature = |properties: &Value| Feature {
            geometry: Geometry::Points(Vec::new()),
            elevations: None,
            properties: properties.as_object().expect("an object").clone().into_iter().collect(),
        };
        VectorLayer {
            features: properties.iter().map(feature).collect(),
            crs: Crs::wgs84(),
            notes: Vec::new(),
            faults: Vec::new(),
        }
    }

    fn filter(conditions: &[(&str, &[Value])]) -> Filter {
        let condition = |(property, any_of): &(&str, &[Value])| Condition {
            property: (*property).into(),
            any_of: any_of.to_vec(),
        };
        Filter { conditions: conditions.iter().map(condition).collect() }
    }

    #[test]
    fn all_conditions_must_hold_each_by_one_of_its_values() {
        let roads = layer(&[
            json!({"highway": "primary", "lanes": 2}),
            json!({"highway": "secondary", "lanes": 2.0}),
            json!({"highway": "primary", "lanes": 4}),
            json!({"highway": "track", "lanes": 2}),
            json!({"lanes": 2}),
        ]);
        let wanted =
            filter(&[("highway", &[json!("primary"), json!("secondary")]), ("lanes", &[json!(2.0)])]);
        let chosen: Vec<_> = wanted.select(&roads).collect();
        assert_eq!(chosen, [(0, &roads.features[0]), (1, &roads.features[1])]);
    }

    #[test]
    fn an_empty_filter_chooses_everything() {
        assert_eq!(Filter::default().select(&layer(&[json!({}), json!({"a": 1})])).count(), 2);
    }

    #[test]
    fn text_is_not_a_number_and_the_explanation_shows_it() {
        let roads = layer(&[json!({"lanes": "2"}), json!({"lanes": "4"}), json!({"lanes": null})]);
        let wanted = filter(&[("lanes", &[json!(2)]), ("highway", &[json!("primary")])]);
        assert_eq!(
            wanted.explain_no_match(&roads).as_deref(),
            Some("'lanes' is \"2\", \"4\"; no feature has the property 'highway'")
        );
        assert_eq!(filter(&[("lanes", &[json!("2")])]).explain_no_match(&roads), None);
    }
}
