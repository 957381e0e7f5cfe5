//! Tactical graphics and layers of sight in the legend.

use std::collections::BTreeSet;

use sandtable_analysis::outcome::{Hatching, ValueClass};
use sandtable_annotate::class_legend::{LegendEntry, LegendSwatch};
use sandtable_base::message::capitalized::capitalized;
use sandtable_description::words::{GraphicSide, RangeExtent, StylePreset, ViewshedTint};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_draw::print_pattern::PrintPattern;
use sandtable_picture::analysis_look::{hatch_color, legend_classes, legend_lines, printed};
use sandtable_picture::graphic_colors::{HIDDEN, HIDDEN_LINE, SEEN, SEEN_LINE, graphic_color, side_color};
use sandtable_render::picture::Rendering;
use sandtable_scene::analyses::SceneAnalysis;
use sandtable_scene::scene_model::SceneModel;
use sandtable_symbology::graphic::kind::GraphicTint;

/// The swatches of an overlay's own lines and areas: one of many colors does not fill the legend.
const MOST_SWATCHES: usize = 4;

/// The width of a graphic's line in design pixels.
const LINE: f32 = 2.6;

/// The ground that a tint is shown over, and the share of light of the line round its swatch.
const GROUND: Srgba = Srgba::opaque(200, 205, 190);
const EDGE: f32 = 0.45;

/// The sides, obstacles and tints that `picture` shows of `scene`, in order.
pub fn overlay_entries(scene: &SceneModel, picture: &Rendering) -> Vec<LegendEntry> {
    if !scene.has_overlay() {
        return Vec::new();
    }
    let shown: BTreeSet<FeatureId> = picture.features.iter().copied().collect();
    let mut entries = Vec::new();
    let mut seen = BTreeSet::new();
    let mut weather = BTreeSet::new();
    // An overlay's lines and areas by its name, a swatch for each color.
    let mut plain: Vec<(&str, LegendEntry)> = Vec::new();
    for graphic in scene.graphics.iter().filter(|graphic| shown.contains(&graphic.feature)) {
        if let Some(style) = &graphic.style {
            let name = style.overlay.as_str();
            let entry = match (style.stroke, style.fill) {
                (Some(color), None) => line(name, color),
                (_, Some(color)) => area(name.to_owned(), color),
                (None, None) => continue,
            };
            let is_known = plain.iter().any(|(known, other)| *known == name && *other == entry);
            let is_many = plain.iter().filter(|(known, _)| *known == name).count() >= MOST_SWATCHES;
            if !is_known && !is_many {
                plain.push((name, entry));
            }
            continue;
        }
        match graphic.kind.tint {
            GraphicTint::Obstacle => seen.insert(None),
            GraphicTint::Own => seen.insert(Some(graphic.side)),
            // Weather and the sea have a color for every kind.
            tint => weather.insert((graphic.kind.name, graphic_color(graphic.side, tint).0)),
        };
    }
    for class in seen.into_iter().rev() {
        let color = graphic_color(
            class.unwrap_or_default(),
            if class.is_some() { GraphicTint::Own } else { GraphicTint::Obstacle },
        );
        entries.push(line(class.map_or("Obstacle", side_name), color));
    }
    entries.extend(weather.into_iter().map(|(name, color)| line(name, Srgba(color))));
    entries.extend(plain.into_iter().map(|(_, entry)| entry));
    for layer in &scene.sight.viewsheds {
        let named = |text: &str| match layer.name.as_str() {
            "" => text.to_owned(),
            name => format!("{text}: {name}"),
        };
        if layer.tint != ViewshedTint::Hidden {
            entries.push(area(named("In sight"), SEEN));
        }
        if layer.tint != ViewshedTint::Seen {
            entries.push(area(named("Hidden"), HIDDEN));
        }
    }
    if !scene.sight.sights.is_empty() {
        entries.push(line("Line of sight over seen ground", SEEN_LINE));
        entries.push(line("Line of sight over hidden ground", HIDDEN_LINE));
    }
    for range in &scene.sight.ranges {
        let name = if range.name.is_empty() { "Range" } else { &range.name };
        let extent = if range.fill == RangeExtent::Seen { " (in sight)" } else { "" };
        entries.push(line(&format!("{name}{extent}"), side_color(range.side)));
    }
    entries.extend(scene.analyses.iter().flat_map(|analysis| analysis_entries(analysis, scene)));
    entries
}

/// The classes that a raster holds and that are tinted or hatched, and what the lines of an analysis are.
fn analysis_entries(analysis: &SceneAnalysis, scene: &SceneModel) -> Vec<LegendEntry> {
    let mut entries = Vec::new();
    let shows = |of: &SceneAnalysis| of.hatched_raster().or(of.tinted_raster()).is_some();
    let is_alone = scene.analyses.iter().filter(|other| shows(other)).count() == 1;
    let classes = legend_classes(analysis);
    entries.extend(classes.iter().map(|class| class_entry(class, analysis, is_alone, scene.preset)));
    let nouns = legend_lines(analysis);
    let is_one = nouns.len() == 1 && analysis.outcome.raster.is_none();
    let is_only = scene.analyses.len() == 1;
    let name = |noun: &str| match (is_one, is_only) {
        (true, _) => analysis.name.clone(),
        (false, true) => capitalized(noun),
        (false, false) => format!("{}: {noun}", analysis.name),
    };
    entries.extend(nouns.into_iter().map(|(noun, color)| line(&name(noun), printed(scene, color))));
    entries
}

fn class_entry(
    class: &ValueClass,
    analysis: &SceneAnalysis,
    is_alone: bool,
    preset: Option<StylePreset>,
) -> LegendEntry {
    let tint = Srgba(class.look.tint);
    let share = if analysis.tinted_raster().is_some() { tint.alpha() } else { 0.0 };
    let fill = GROUND.linear().lerp(tint.linear(), share);
    let name = match is_alone {
        true => capitalized(&class.label),
        false => format!("{}: {}", analysis.name, class.label),
    };
    let pattern = match class.look.hatching {
        _ if analysis.hatched_raster().is_none() => None,
        Hatching::None => None,
        Hatching::Single => Some(PrintPattern::Hatching),
        Hatching::Crossed => Some(PrintPattern::CrossHatching),
        Hatching::Dots => Some(PrintPattern::Stipple),
        Hatching::Level => Some(PrintPattern::Lines),
    };
    let swatch = match pattern.filter(|_| preset == Some(StylePreset::Print)) {
        Some(pattern) => LegendSwatch::Pattern(pattern),
        None => {
            let ink = hatch_color(class.look.tint);
            LegendSwatch::Tint { fill: Srgba::from_linear(fill), ink, pattern }
        }
    };
    LegendEntry { name, swatch }
}

fn side_name(side: GraphicSide) -> &'static str {
    match side {
        GraphicSide::Friend => "Friendly",
        GraphicSide::Hostile => "Enemy",
        GraphicSide::Neutral => "Neutral",
        GraphicSide::Unknown => "Unknown",
    }
}

fn line(name: &str, color: Srgba) -> LegendEntry {
    LegendEntry {
        name: name.to_owned(),
        swatch: LegendSwatch::Line { fill: color, casing: None, width: LINE },
    }
}

/// A tint over the ground.
fn area(name: String, tint: Srgba) -> LegendEntry {
    let share = f32::from(tint.0[3]) / 255.0;
    let fill = GROUND.linear().lerp(tint.linear(), share);
    LegendEntry {
        name,
        swatch: LegendSwatch::Area { fill: Srgba::from_linear(fill), edge: Srgba::from_linear(fill * EDGE) },
    }
}
