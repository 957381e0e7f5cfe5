//! The classes of what a picture shows, for its legend.
//!
//! A class is in the legend where the picture's feature buffer shows enough of it. Its color there is the mean of its
//! pixels, light and shade together: what a reader looks for is what is drawn.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::print_ink::PrintInk;
use sandtable_analysis::outcome::Hatching;
use sandtable_annotate::class_legend::{LegendEntry, LegendSwatch};
use sandtable_base::message::capitalized::capitalized;
use sandtable_description::words::{Cover, StylePreset};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_draw::print_pattern::PrintPattern;
use sandtable_render::picture::Rendering;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;

/// Every such row and column of the picture is counted: a class of any use shows on several.
const STEP: usize = 2;
/// A class that shows on fewer of the counted pixels is left out.
const LEAST_PIXELS: u32 = 8;
/// Names of models at most; others are one class.
const MOST_MODELS: usize = 4;

/// A class, in the order of the legend.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ShownClass {
    /// A paved road, by rank: 0 the highest.
    Paved(u8),
    Gravel,
    Track,
    Bridge,
    River,
    Lake,
    Cover(Cover),
    Building,
    Boundary,
    Trench,
    /// A fence, wall or line of another kind.
    Line,
    /// A model by its name.
    Model(String),
    OtherModels,
    Trees,
}

/// What the pixels of a class add up to.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSum {
    count: u32,
    light: Vec3,
    /// The same over pixels with nothing but the class around them, which edges do not tint.
    inner_count: u32,
    inner_light: Vec3,
}

/// The classes that `picture` shows of `scene`.
pub fn legend_entries(scene: &SceneModel, picture: &Rendering) -> Vec<LegendEntry> {
    let classes = classes(scene);
    let (ids, by_feature) = numbered(&classes);
    let mut sums = vec![PixelSum::default(); ids.len()];
    let (width, height) = (picture.pixels.width() as usize, picture.pixels.height() as usize);
    let class_at = |at: usize| by_feature.get(picture.features[at].index()?).copied().flatten();
    for row in (1..height.saturating_sub(1)).step_by(STEP) {
        for column in (1..width.saturating_sub(1)).step_by(STEP) {
            let at = row * width + column;
            let Some(class) = class_at(at) else { continue };
            let light = picture.pixels.data()[at].linear();
            let sum = &mut sums[class];
            sum.count += 1;
            sum.light += light;
            if [at - 1, at + 1, at - width, at + width].iter().all(|&beside| class_at(beside) == Some(class))
            {
                sum.inner_count += 1;
                sum.inner_light += light;
            }
        }
    }
    let is_print = scene.preset == Some(StylePreset::Print);
    let hides_covers = is_print && has_hatching(scene);
    let shown = ids.into_iter().zip(sums).filter(|(class, sum)| {
        sum.count >= LEAST_PIXELS && !(hides_covers && matches!(class, ShownClass::Cover(_)))
    });
    shown
        .map(|(class, sum)| match class.ink().filter(|_| is_print) {
            Some(ink) => class.printed_entry(ink),
            None => class.entry(sum.mean()),
        })
        .collect()
}

impl PixelSum {
    fn mean(&self) -> Srgba {
        let (light, count) = match self.inner_count >= LEAST_PIXELS / 2 {
            true => (self.inner_light, self.inner_count),
            false => (self.light, self.count),
        };
        Srgba::from_linear(light / count.max(1) as f32)
    }
}

/// Each class once, in order, and for each feature the index of its class.
fn numbered(classes: &[Option<ShownClass>]) -> (Vec<ShownClass>, Vec<Option<usize>>) {
    let mut ids: BTreeMap<&ShownClass, usize> = classes.iter().flatten().map(|class| (class, 0)).collect();
    ids.values_mut().enumerate().for_each(|(number, id)| *id = number);
    let by_feature = classes.iter().map(|class| ids.get(class.as_ref()?).copied()).collect();
    (ids.into_keys().cloned().collect(), by_feature)
}

/// The class of every feature.
fn classes(scene: &SceneModel) -> Vec<Option<ShownClass>> {
    let surfaces = surfaces(scene);
    let widths: BTreeMap<FeatureId, f64> =
        scene.symbols.iter().map(|symbol| (symbol.feature, symbol.least_px)).collect();
    let names = model_names(scene);
    let class = |(index, feature): (usize, &sandtable_scene::feature::SceneFeature)| {
        let id = FeatureId::of_index(index);
        let surface = surfaces.get(&id).copied();
        Some(match feature.kind {
            FeatureKind::Lake => ShownClass::Lake,
            FeatureKind::River => ShownClass::River,
            FeatureKind::Road => match surface {
                Some(RibbonSurface::Gravel) => ShownClass::Gravel,
                Some(RibbonSurface::Track) => ShownClass::Track,
                _ => ShownClass::Paved(rank(widths.get(&id).copied().unwrap_or_default())),
            },
            FeatureKind::Bridge => ShownClass::Bridge,
            FeatureKind::Tunnel => return None,
            FeatureKind::Area => match surface? {
                RibbonSurface::Cover(cover) | RibbonSurface::CoverEdge(cover) => ShownClass::Cover(cover),
                _ => return None,
            },
            FeatureKind::Building => ShownClass::Building,
            FeatureKind::Fence => match surface {
                Some(RibbonSurface::Boundary) => ShownClass::Boundary,
                Some(RibbonSurface::Trench) => ShownClass::Trench,
                _ => ShownClass::Line,
            },
            FeatureKind::Model => match names.contains(&class_name(&feature.name)) {
                true => ShownClass::Model(class_name(&feature.name)),
                false => ShownClass::OtherModels,
            },
            FeatureKind::Scattered => ShownClass::Trees,
            FeatureKind::Graphic | FeatureKind::Sight | FeatureKind::Analysis => return None,
        })
    };
    scene.features.iter().enumerate().map(class).collect()
}

/// The print inks of features. Covers have none where an analysis is hatched: two patterns on the same ground cannot be read.
pub fn feature_inks(scene: &SceneModel) -> Vec<Option<PrintInk>> {
    let hides_covers = has_hatching(scene);
    let ink = |class: ShownClass| match class {
        ShownClass::Cover(_) if hides_covers => None,
        class => class.ink(),
    };
    classes(scene).into_iter().map(|class| class.and_then(ink)).collect()
}

/// Whether the classes of an analysis are told by hatching.
fn has_hatching(scene: &SceneModel) -> bool {
    let rasters = scene.analyses.iter().filter_map(|analysis| analysis.hatched_raster());
    rasters.flat_map(|raster| &raster.classes).any(|class| class.look.hatching != Hatching::None)
}

/// What the ribbon of each feature is made of, leaving out what lies beside it.
fn surfaces(scene: &SceneModel) -> BTreeMap<FeatureId, RibbonSurface> {
    let ribbons = scene.ribbons.iter().map(|ribbon| (ribbon.feature, ribbon.surface));
    let symbols = scene.symbols.iter().map(|symbol| (symbol.feature, symbol.surface));
    let is_beside = |surface: &RibbonSurface| {
        let beside =
            [RibbonSurface::Shoulder, RibbonSurface::Bank, RibbonSurface::ShoreLine, RibbonSurface::Border];
        surface.is_junction() || beside.contains(surface)
    };
    ribbons.chain(symbols).filter(|(_, surface)| !is_beside(surface)).collect()
}

/// The rank of a paved road by the least width of its symbol.
fn rank(least_px: f64) -> u8 {
    [5.0, 3.5, 2.5].iter().position(|&least| least_px >= least).unwrap_or(3) as u8
}

/// A model's name without what tells it from others of its class: a number at its end, and what follows a comma or a
/// preposition.
fn class_name(name: &str) -> String {
    let head = name.split([',', '(']).next().unwrap_or_default();
    let words =
        head.split_whitespace().take_while(|word| !["on", "in", "at", "over", "by", "of"].contains(word));
    let words: Vec<&str> = words.collect();
    let is_number = |word: &&&str| word.chars().all(|letter| letter.is_ascii_digit() || letter == '#');
    let count = words.len() - usize::from(words.last().filter(is_number).is_some());
    capitalized(&words[..count].join(" "))
}

/// The names of the model classes with most members.
fn model_names(scene: &SceneModel) -> Vec<String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for feature in scene.features.iter().filter(|feature| feature.kind == FeatureKind::Model) {
        *counts.entry(class_name(&feature.name)).or_default() += 1;
    }
    counts.remove("");
    let mut names: Vec<(String, usize)> = counts.into_iter().collect();
    names.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    names.into_iter().take(MOST_MODELS).map(|(name, _)| name).collect()
}

impl ShownClass {
    fn ink(&self) -> Option<PrintInk> {
        Some(match self {
            Self::Paved(_) | Self::Gravel | Self::Bridge => PrintInk::Cased,
            Self::Track | Self::Trench | Self::Line | Self::Boundary => PrintInk::Black,
            Self::River | Self::Lake => PrintInk::Outlined(PrintPattern::Lines),
            Self::Cover(cover) => PrintInk::Pattern(match cover {
                Cover::Forest => PrintPattern::Dots,
                Cover::Scrub | Cover::Heath | Cover::Sand | Cover::Scree | Cover::Quarry => {
                    PrintPattern::Stipple
                }
                Cover::Field => PrintPattern::Furrows,
                Cover::Orchard | Cover::Vineyard => PrintPattern::Crosses,
                Cover::Wetland => PrintPattern::Dashes,
                Cover::BuiltUp | Cover::DenseBuiltUp => PrintPattern::Hatching,
                Cover::Industry | Cover::Restricted => PrintPattern::CrossHatching,
                Cover::Meadow | Cover::Rock | Cover::Glacier | Cover::Paved => return None,
            }),
            Self::Building | Self::Model(_) | Self::OtherModels => PrintInk::Solid,
            Self::Trees => return None,
        })
    }

    fn entry(self, color: Srgba) -> LegendEntry {
        let dark = |share: f32| Srgba::from_linear(color.linear() * share);
        let line = |width: f32, cased: bool| LegendSwatch::Line {
            fill: color,
            casing: cased.then(|| dark(0.4)),
            width,
        };
        let area = LegendSwatch::Area { fill: color, edge: dark(0.45) };
        let block = LegendSwatch::Block(color);
        let (name, swatch) = match self {
            Self::Paved(0) => ("Main road".to_owned(), line(7.0, true)),
            Self::Paved(1) => ("Road".to_owned(), line(5.6, true)),
            Self::Paved(2) => ("Minor road".to_owned(), line(4.4, true)),
            Self::Paved(_) => ("Lane".to_owned(), line(3.4, true)),
            Self::Gravel => ("Gravel road".to_owned(), line(4.0, true)),
            Self::Track => ("Track".to_owned(), line(2.6, false)),
            Self::Bridge => ("Bridge".to_owned(), block),
            Self::River => ("River or stream".to_owned(), line(3.6, false)),
            Self::Lake => ("Lake".to_owned(), area),
            Self::Cover(cover) => (cover_name(cover), area),
            Self::Building => ("Building".to_owned(), block),
            Self::Boundary => ("Boundary".to_owned(), line(2.6, false)),
            Self::Trench => ("Trench".to_owned(), line(4.0, false)),
            Self::Line => ("Wall, fence or line".to_owned(), line(2.4, false)),
            Self::Model(name) => (name, block),
            Self::OtherModels => ("Other models".to_owned(), block),
            Self::Trees => ("Scattered models".to_owned(), block),
        };
        LegendEntry { name, swatch }
    }
}

impl ShownClass {
    /// The entry on a sheet in black.
    fn printed_entry(self, ink: PrintInk) -> LegendEntry {
        let black = Srgba::opaque(0, 0, 0);
        let entry = self.entry(Srgba::WHITE);
        let swatch = match (entry.swatch, ink) {
            (LegendSwatch::Area { .. }, PrintInk::Pattern(pattern) | PrintInk::Outlined(pattern)) => {
                LegendSwatch::Pattern(pattern)
            }
            (LegendSwatch::Line { width, .. }, PrintInk::Black | PrintInk::Outlined(_)) => {
                LegendSwatch::Line { fill: black, casing: None, width: width * 0.6 }
            }
            (LegendSwatch::Line { width, .. }, _) => {
                LegendSwatch::Line { fill: Srgba::WHITE, casing: Some(black), width }
            }
            (LegendSwatch::Block(_), _) => LegendSwatch::Block(Srgba::opaque(120, 120, 120)),
            (swatch, _) => swatch,
        };
        LegendEntry { name: entry.name, swatch }
    }
}

fn cover_name(cover: Cover) -> String {
    let name = match cover {
        Cover::Forest => "Forest",
        Cover::Scrub => "Scrub",
        Cover::Meadow => "Meadow",
        Cover::Field => "Fields",
        Cover::Orchard => "Orchard",
        Cover::Vineyard => "Vineyard",
        Cover::Heath => "Heath",
        Cover::Wetland => "Marsh",
        Cover::Sand => "Sand",
        Cover::Rock => "Rock",
        Cover::Scree => "Scree",
        Cover::Glacier => "Glacier",
        Cover::Quarry => "Quarry",
        Cover::Paved => "Paved area",
        Cover::BuiltUp => "Built-up area",
        Cover::DenseBuiltUp => "Dense built-up area",
        Cover::Industry => "Industry",
        Cover::Restricted => "Restricted area",
    };
    name.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_models_lose_what_tells_one_from_another() {
        assert_eq!(class_name("watchtower on Cross Mountain"), "Watchtower");
        assert_eq!(class_name("fir 12"), "Fir");
        assert_eq!(class_name("camp at the lake fork, second tent"), "Camp");
        assert_eq!(class_name("7"), "");
        assert_eq!(class_name(""), "");
    }

    #[test]
    fn classes_are_numbered_in_the_order_of_the_legend() {
        let classes = [Some(ShownClass::Lake), None, Some(ShownClass::Paved(1)), Some(ShownClass::Lake)];
        let (ids, by_feature) = numbered(&classes);
        assert_eq!(ids, [ShownClass::Paved(1), ShownClass::Lake]);
        assert_eq!(by_feature, [Some(1), None, Some(0), Some(1)]);
    }

    #[test]
    fn the_color_of_a_class_is_that_of_its_inside_where_it_has_one() {
        let mut sum = PixelSum { count: 10, light: Vec3::splat(10.0), ..PixelSum::default() };
        assert_eq!(sum.mean(), Srgba::WHITE);
        (sum.inner_count, sum.inner_light) = (5, Vec3::ZERO);
        assert_eq!(sum.mean(), Srgba::opaque(0, 0, 0));
    }
}
