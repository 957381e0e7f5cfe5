//! How analyses look: the classes of their rasters, and the colors of their features.
//!
//! A class is told by its tint and, in black on white, by its hatching. Relief shows through both.

use std::collections::BTreeMap;

use crate::graphic_colors::{HIDDEN_LINE, SEEN_LINE};
use sandtable_analysis::outcome::{FeatureRole, Hatching, OutcomeFeature, PropertyValue, ValueClass};
use sandtable_description::words::StylePreset;
use sandtable_draw::color::Srgba;
use sandtable_scene::analyses::SceneAnalysis;
use sandtable_scene::scene_model::SceneModel;

/// The share of light that the hatching of a tint has.
const HATCH_LIGHT: f32 = 0.22;

/// Places, and what has no color of its own.
const PLACE: Srgba = Srgba::opaque(30, 30, 30);
/// Ways of one analysis after the other, in turn.
const WAYS: [Srgba; 4] = [
    Srgba::opaque(142, 16, 120),
    Srgba::opaque(0, 96, 110),
    Srgba::opaque(176, 74, 0),
    Srgba::opaque(70, 40, 160),
];
const ISOLINE: Srgba = Srgba::opaque(122, 82, 40);
const STREAM: Srgba = Srgba::opaque(16, 84, 180);
const RIDGE: Srgba = Srgba::opaque(140, 70, 20);
const SITE: Srgba = Srgba::opaque(0, 104, 40);

/// The classes that the raster of an analysis holds and that pictures show by a tint or hatching, as legends list them.
pub fn legend_classes(analysis: &SceneAnalysis) -> Vec<ValueClass> {
    let (tinted, hatched) = (analysis.tinted_raster(), analysis.hatched_raster());
    let Some(raster) = tinted.or(hatched) else { return Vec::new() };
    let is_held = raster.held_classes();
    let is_shown = |class: &&ValueClass| {
        tinted.is_some() && class.look.tint[3] > 0
            || hatched.is_some() && class.look.hatching != Hatching::None
    };
    let held = raster.classes.iter().zip(is_held).filter(|(_, is_held)| *is_held).map(|(class, _)| class);
    let mut listed: Vec<ValueClass> = Vec::new();
    for class in held.filter(is_shown) {
        // North is at both ends of aspects.
        if !listed.iter().any(|other| other.label == class.label && other.look == class.look) {
            listed.push(class.clone());
        }
    }
    listed
}

/// What the lines of an analysis are, with their colors, as legends list them: marks of places tell what they are by their
/// names.
pub fn legend_lines(analysis: &SceneAnalysis) -> BTreeMap<&'static str, Srgba> {
    let mut nouns: BTreeMap<&str, Srgba> = BTreeMap::new();
    for feature in analysis.shown_features() {
        nouns.entry(feature_noun(feature)).or_insert_with(|| feature_color(analysis, feature));
    }
    nouns.retain(|noun, _| !matches!(*noun, "place" | "post" | "outline"));
    nouns
}

/// The color of lines on a picture: black on one in black on white.
pub fn printed(scene: &SceneModel, color: Srgba) -> Srgba {
    if is_print(scene) { Srgba::opaque(0, 0, 0) } else { color }
}

/// Whether pictures are black on white, where classes are told by their hatching alone.
pub(super) fn is_print(scene: &SceneModel) -> bool {
    scene.preset == Some(StylePreset::Print)
}

/// The color of the hatching over a tint.
pub fn hatch_color([red, green, blue, _]: [u8; 4]) -> Srgba {
    Srgba::from_linear(Srgba::opaque(red, green, blue).linear() * HATCH_LIGHT)
}

/// The color of the lines of a feature of an analysis.
pub fn feature_color(analysis: &SceneAnalysis, feature: &OutcomeFeature) -> Srgba {
    if let Some(color) = analysis.color {
        return color;
    }
    match feature.role {
        FeatureRole::Place | FeatureRole::Post | FeatureRole::Outline => PLACE,
        FeatureRole::Route | FeatureRole::Corridor | FeatureRole::Haul => WAYS[analysis.number % WAYS.len()],
        FeatureRole::Isoline => ISOLINE,
        FeatureRole::Stream => STREAM,
        FeatureRole::FormLine if is_valley(feature) => STREAM,
        FeatureRole::FormLine => RIDGE,
        FeatureRole::Site => SITE,
        FeatureRole::Link if is_seen(feature) => SEEN_LINE,
        FeatureRole::Link => HIDDEN_LINE,
    }
}

/// The name of what a feature's lines are.
pub fn feature_noun(feature: &OutcomeFeature) -> &'static str {
    match feature.role {
        FeatureRole::Place => "place",
        FeatureRole::Post => "post",
        FeatureRole::Outline => "outline",
        FeatureRole::Route => "route",
        FeatureRole::Corridor => "avenue",
        FeatureRole::Haul => "haul",
        FeatureRole::Isoline => "line of equal value",
        FeatureRole::Stream => "stream",
        FeatureRole::FormLine if is_valley(feature) => "valley line",
        FeatureRole::FormLine => "ridge line",
        FeatureRole::Site => "site",
        FeatureRole::Link if is_seen(feature) => "in sight",
        FeatureRole::Link => "out of sight",
    }
}

/// Whether a form line is of a valley.
fn is_valley(feature: &OutcomeFeature) -> bool {
    matches!(property(feature, "form"), Some(PropertyValue::Text(form)) if form == "valley")
}

/// Whether a link is one of sight.
pub(super) fn is_seen(feature: &OutcomeFeature) -> bool {
    matches!(property(feature, "seen"), Some(PropertyValue::Truth(true)))
}

/// A property of a feature; `None` where it has none of this name.
pub(super) fn property<'a>(feature: &'a OutcomeFeature, name: &str) -> Option<&'a PropertyValue> {
    feature.properties.iter().find(|(own, _)| *own == name).map(|(_, value)| value)
}
