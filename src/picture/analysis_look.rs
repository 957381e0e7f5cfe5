//! How analyses look: the classes of their rasters, and the colors of their features.
//!
//! A class is told by its tint and, in black on white, by its hatching. Relief shows through both.

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::graphic_colors::{HIDDEN_LINE, SEEN_LINE};
use sandtable_analysis::outcome::{
    FeatureRole, Hatching, OutcomeFeature, OutcomeRaster, PropertyValue, ValueClass,
};
use sandtable_base::message::numbers::trimmed;
use sandtable_draw::color::Srgba;
use sandtable_scene::analyses::SceneAnalysis;

/// Values of a raster without classes that are looked at for its classes.
const MOST_SAMPLES: usize = 1 << 16;

/// The classes of a raster that has none of its own.
const CLASSES: usize = 7;

/// From this ratio of the largest to the middle value classes are powers of ten.
const LOGARITHMIC: f32 = 1e4;

/// The share of light that the tint of such a class stops, of 255.
const TINT_ALPHA: u8 = 125;

/// Their tints from low to high, of equal steps to the eye (viridis, van der Walt and Smith 2015).
const RAMP: [[u8; 3]; CLASSES] = [
    [68, 1, 84],
    [68, 57, 131],
    [49, 104, 142],
    [33, 145, 140],
    [53, 183, 121],
    [144, 215, 67],
    [253, 231, 37],
];

/// The tints of classes on both sides of 0, from far below to far above; what is near 0 is pale.
const SIDES: [[u8; 4]; 6] = [
    [33, 102, 172, 165],
    [67, 147, 195, 125],
    [146, 197, 222, 50],
    [244, 165, 130, 50],
    [214, 96, 77, 125],
    [178, 24, 43, 165],
];

/// Values are told by their side of 0 where the smaller side reaches at least this share as far as the larger one.
const TWO_SIDED: f32 = 0.2;

/// Square meters in a square kilometer.
const KM2: f32 = 1e6;

/// The share of light that the tint of a class by powers of ten stops, of 255.
const WATER_ALPHA: u8 = 215;

/// The tints of classes by powers of ten, the lowest of which is none: more water is darker.
const WATERS: [[u8; 3]; CLASSES] = [
    [255, 255, 255],
    [190, 215, 240],
    [140, 185, 230],
    [90, 150, 215],
    [50, 110, 195],
    [25, 75, 165],
    [10, 40, 120],
];

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

/// The classes by which a picture shows a raster: its own, or steps of round numbers.
pub fn shown_classes(raster: &OutcomeRaster) -> Cow<'_, [ValueClass]> {
    match raster.classes.is_empty() {
        true => Cow::Owned(round_classes(raster)),
        false => Cow::Borrowed(&raster.classes),
    }
}

/// The class of a value; `None` below the first, and of no data.
pub fn class_of(classes: &[ValueClass], value: f32) -> Option<usize> {
    // Not a number is below every class.
    classes.partition_point(|class| class.from <= value).checked_sub(1).filter(|_| !value.is_nan())
}

/// The classes that the raster of an analysis holds and that pictures show by a tint or hatching, as legends list them.
pub fn legend_classes(analysis: &SceneAnalysis) -> Vec<ValueClass> {
    let (tinted, hatched) = (analysis.tinted_raster(), analysis.hatched_raster());
    let Some(raster) = tinted.or(hatched) else { return Vec::new() };
    let classes = shown_classes(raster);
    let mut is_held = vec![false; classes.len()];
    for index in 0..raster.values.len() {
        if let Some(class) = class_of(&classes, raster.values.value(index)) {
            is_held[class] = true;
        }
    }
    let is_shown = |class: &&ValueClass| {
        tinted.is_some() && class.look.tint[3] > 0
            || hatched.is_some() && class.look.hatching != Hatching::None
    };
    let held = classes.iter().zip(is_held).filter(|(_, is_held)| *is_held).map(|(class, _)| class);
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

/// The color of the hatching over a tint.
pub fn hatch_color([red, green, blue, _]: [u8; 4]) -> Srgba {
    Srgba::from_linear(Srgba::opaque(red, green, blue).linear() * HATCH_LIGHT)
}

/// Classes of round numbers over the range of the values, by powers of ten where a few are far above all others.
fn round_classes(raster: &OutcomeRaster) -> Vec<ValueClass> {
    let stride = raster.values.len().div_ceil(MOST_SAMPLES).max(1);
    let values = (0..raster.values.len()).step_by(stride).map(|index| raster.values.value(index));
    let mut values: Vec<f32> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f32::total_cmp);
    let at = |share: f64| values.get(((values.len() as f64 - 1.0) * share) as usize).copied();
    let (Some(low), Some(middle), Some(high)) = (at(0.02), at(0.5), at(0.98)) else { return Vec::new() };
    if low < 0.0 && (-low).min(high) >= TWO_SIDED * (-low).max(high) {
        return sides((-low).max(high), raster.unit);
    }
    let greatest = (0..raster.values.len()).map(|index| raster.values.value(index)).fold(high, f32::max);
    let (froms, tints) = match middle > 0.0 && greatest / middle > LOGARITHMIC {
        true => (powers(middle, greatest), WATERS),
        false => (steps(low, high), RAMP),
    };
    let is_large = raster.unit == "m²" && froms.iter().any(|from| *from >= KM2 / 10.0);
    let (unit, scale) = if is_large { ("km²", 1.0 / KM2) } else { (raster.unit, 1.0) };
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let written = |from: f32| short(from * scale);
    let class = |(index, &from): (usize, &f32)| {
        let label = match froms.get(index + 1) {
            Some(&to) => format!("{} to {}{unit}", written(from), written(to)),
            None => format!("{}{unit} and more", written(from)),
        };
        let place = index * (CLASSES - 1) / (froms.len() - 1).max(1);
        let [red, green, blue] = tints[place];
        let alpha = match tints == WATERS {
            true if index == 0 => 0,
            true => WATER_ALPHA,
            false => TINT_ALPHA,
        };
        let tint = if alpha == 0 { [0; 4] } else { [red, green, blue, alpha] };
        ValueClass::new(if index == 0 { f32::NEG_INFINITY } else { from }, label, tint, Hatching::None)
    };
    froms.iter().enumerate().map(class).collect()
}

/// Classes on both sides of 0 that part most values within `reach` of it.
fn sides(reach: f32, unit: &str) -> Vec<ValueClass> {
    let step = round_step(f64::from(reach) / 3.0) as f32;
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let class = |(index, tint): (usize, [u8; 4])| {
        let (from, to) = (step * (index as f32 - 3.0), step * (index as f32 - 2.0));
        match index {
            0 => {
                ValueClass::new(f32::NEG_INFINITY, format!("below {}{unit}", short(to)), tint, Hatching::None)
            }
            5 => ValueClass::new(from, format!("{}{unit} and more", short(from)), tint, Hatching::None),
            _ => {
                let label = format!("{} to {}{unit}", short(from), short(to));
                ValueClass::new(from, label, tint, Hatching::None)
            }
        }
    };
    SIDES.into_iter().enumerate().map(class).collect()
}

/// 1, 2 or 5 times a power of ten, at least `rough`.
fn round_step(rough: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(rough).floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
    step.unwrap_or(10.0 * power)
}

/// Round numbers from below `low` to `high`, at most [`CLASSES`] of them.
fn steps(low: f32, high: f32) -> Vec<f32> {
    let (low, high) = (f64::from(low), f64::from(high));
    let rough = ((high - low) / (CLASSES as f64 - 1.0)).max(low.abs().max(1.0) * 1e-6);
    let step = round_step(rough);
    let first = (low / step).floor();
    let count = ((high / step).floor() - first) as usize + 1;
    (0..count.clamp(1, CLASSES)).map(|index| ((first + index as f64) * step) as f32).collect()
}

/// The powers of ten from above `middle` to `greatest`, the last [`CLASSES`] of them.
fn powers(middle: f32, greatest: f32) -> Vec<f32> {
    let from = libm::log10(f64::from(middle)).ceil() as i32;
    let to = libm::log10(f64::from(greatest)).floor() as i32;
    let first = from.max(to - CLASSES as i32 + 1);
    (first..=to.max(first)).map(|power| libm::pow(10.0, f64::from(power)) as f32).collect()
}

/// A number with three decimals at most.
fn short(number: f32) -> String {
    trimmed(number, 3)
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
        FeatureRole::FormLine => {
            if is_valley(feature) {
                STREAM
            } else {
                RIDGE
            }
        }
        FeatureRole::Site => SITE,
        FeatureRole::Link => {
            if is_seen(feature) {
                SEEN_LINE
            } else {
                HIDDEN_LINE
            }
        }
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
        FeatureRole::FormLine => {
            if is_valley(feature) {
                "valley line"
            } else {
                "ridge line"
            }
        }
        FeatureRole::Site => "site",
        FeatureRole::Link => {
            if is_seen(feature) {
                "in sight"
            } else {
                "out of sight"
            }
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_analysis::outcome::PostValues;

    fn raster(values: Vec<f32>) -> OutcomeRaster {
        OutcomeRaster { name: "test", unit: "m", values: PostValues::Numbers(values), classes: Vec::new() }
    }

    #[test]
    fn values_without_classes_have_round_steps_that_hold_each_of_them() {
        let raster = raster((0..=1000).map(|value| value as f32 * 0.37).chain([f32::NAN]).collect());
        let classes = shown_classes(&raster);
        let froms: Vec<f32> = classes.iter().skip(1).map(|class| class.from).collect();
        assert_eq!(froms, [100.0, 200.0, 300.0]);
        assert_eq!(classes[1].label, "100 to 200 m");
        assert_eq!(class_of(&classes, -5.0), Some(0));
        assert_eq!(class_of(&classes, 250.0), Some(2));
        assert_eq!(class_of(&classes, f32::NAN), None);
    }

    #[test]
    fn values_on_both_sides_of_0_are_told_by_their_side() {
        let raster = raster((-100..=100).map(|value| value as f32 * 0.6).collect());
        let classes = shown_classes(&raster);
        let froms: Vec<f32> = classes.iter().skip(1).map(|class| class.from).collect();
        assert_eq!(froms, [-40.0, -20.0, 0.0, 20.0, 40.0]);
        assert_eq!(
            [0, 1, 5].map(|index| &*classes[index].label),
            ["below -40 m", "-40 to -20 m", "40 m and more"]
        );
        assert_eq!(class_of(&classes, -999.0), Some(0));
    }

    #[test]
    fn a_few_values_far_above_the_others_have_classes_by_powers_of_ten() {
        let raster = raster((0..900).map(|_| 30.0).chain([1e3, 1e5, 3e7]).collect());
        let classes = shown_classes(&raster);
        let froms: Vec<f32> = classes.iter().skip(1).map(|class| class.from).collect();
        assert_eq!(froms, [1e3, 1e4, 1e5, 1e6, 1e7]);
        assert_eq!(classes[0].look.tint, [0; 4]);
    }

    #[test]
    fn a_raster_without_data_or_of_one_value_has_classes_all_the_same() {
        assert!(shown_classes(&raster(vec![f32::NAN; 4])).is_empty());
        assert_eq!(shown_classes(&raster(vec![4.0; 4])).len(), 1);
    }
}
