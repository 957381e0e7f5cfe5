//! What the features of a layer are called: places, districts, parks and peaks whose name may be the scene's title.

use std::sync::Arc;

use glam::DVec2;
use serde_json::Value;

use crate::rules::{LabelRule, NAMES};
use sandtable_description::expression::Expression;
use sandtable_description::scalar::Scalar;
use sandtable_scene::attributes::Attributes;
use sandtable_vector::feature::{Feature, Polygon, VectorLayer};

/// The place of a name that may be the title of a scene.
pub(super) struct NamedPlace {
    pub name: String,
    /// The lower, the more important.
    pub rank: f64,
    pub at: DVec2,
}

/// A district with a name.
pub(super) struct NamedDistrict {
    pub name: String,
    /// OpenStreetMap's `admin_level`: the higher, the smaller the district.
    pub level: f64,
    pub polygons: Vec<Polygon>,
}

/// An area with a name.
#[derive(Clone)]
pub(super) struct NamedArea {
    pub name: String,
    pub polygons: Vec<Polygon>,
}

/// As many names tell whether a file is named after a place of its features.
const MOST_NAMES: usize = 4096;

/// The name of a feature; `None` where it has none.
fn name_of(feature: &Feature) -> Option<&str> {
    let names = NAMES.iter().filter_map(|key| feature.properties.get(*key)?.as_str());
    names.map(str::trim).find(|name| !name.is_empty())
}

/// Names of features of any kind, up to [`MOST_NAMES`].
pub(super) fn names(layer: &VectorLayer) -> Vec<String> {
    layer.features.iter().filter_map(name_of).take(MOST_NAMES).map(str::to_owned).collect()
}

fn named_area(feature: &Feature) -> Option<NamedArea> {
    let (name, polygons) = (name_of(feature)?, feature.polygons());
    (!polygons.is_empty()).then(|| NamedArea { name: name.to_owned(), polygons: polygons.to_vec() })
}

/// Parks and reserves by the tags of OpenStreetMap.
pub(super) fn parks(layer: &VectorLayer) -> Vec<NamedArea> {
    const TAGS: [(&str, &[&str]); 3] = [
        ("boundary", &["national_park", "protected_area"]),
        ("leisure", &["park", "nature_reserve"]),
        ("fclass", &["park", "nature_reserve", "national_park"]),
    ];
    let is_park = |feature: &&Feature| {
        TAGS.iter().any(|(key, words)| {
            let word = feature.properties.get(*key).and_then(Value::as_str);
            word.is_some_and(|word| words.contains(&word))
        })
    };
    layer.features.iter().filter(is_park).filter_map(named_area).collect()
}

/// The area of a layer that holds nothing else.
pub(super) fn only_area(layer: &VectorLayer) -> Option<NamedArea> {
    match &layer.features[..] {
        [only] => named_area(only),
        _ => None,
    }
}

/// The place that a rule of labels names; `None` without a name, a rank or a place.
pub(super) fn named_place(layer: &Arc<VectorLayer>, index: usize, label: &LabelRule) -> Option<NamedPlace> {
    let attributes = Attributes::new(Arc::clone(layer), index);
    let evaluated = |text: &str| attributes.evaluated(&Expression::parse(text).ok()?);
    let name = match evaluated(label.name)? {
        Scalar::Text(name) => name.trim().to_owned(),
        Scalar::Bool(_) | Scalar::Number(_) => return None,
    };
    let at = *layer.features[index].geometry.vertices().next()?;
    let rank = evaluated(label.rank)?.number()?;
    (!name.is_empty()).then_some(NamedPlace { name, rank, at })
}

/// The districts of a layer, by the tags of OpenStreetMap.
pub(super) fn districts(layer: &VectorLayer) -> Vec<NamedDistrict> {
    let district = |feature: &Feature| {
        let text = |property: &str| feature.properties.get(property).and_then(Value::as_str).map(str::trim);
        let name = text("name").filter(|name| !name.is_empty())?;
        let level = feature.properties.get("admin_level")?;
        let level =
            level.as_f64().or_else(|| level.as_str()?.trim().parse().ok()).filter(|at| at.is_finite())?;
        let polygons = feature.polygons();
        let is_district = text("boundary") == Some("administrative") && !polygons.is_empty();
        is_district.then(|| NamedDistrict { name: name.to_owned(), level, polygons: polygons.to_vec() })
    };
    layer.features.iter().filter_map(district).collect()
}
