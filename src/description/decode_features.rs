//! The tables of features, key by key: which there are, what each may hold, and which exclude each other.

use toml::Spanned;

use crate::description::bounds::{Bounds, ELEVATION};
use crate::description::decode::{DIRECTION, any_crs, number, plain_text};
use crate::description::expression::{ComputedWord, Expression, Quantity};
use crate::description::features::{
    AreaTable, BridgeTable, BuildingTable, FeatureSource, FenceTable, LakeTable, ModelPlacement, RiverTable,
    RoadTable, ScatterTable,
};
use crate::description::reader::TableReader;
use crate::description::selection::Selection;
use crate::description::words::{Clamp, ProfileMode, Water, Word};

/// Widths of roads and rivers in meters.
const WIDTH: Bounds = Bounds::Above(0.0, 10_000.0);
/// Widths of strips beside something, in meters.
const STRIP: Bounds = Bounds::Within(0.0, 1000.0);
/// Sizes of what stands on the ground, in meters.
const SIZE: Bounds = Bounds::Above(0.0, 1000.0);
/// Distances between things, in meters.
const DISTANCE: Bounds = Bounds::Above(0.0, 10_000.0);
/// Meters out for each meter of height of a batter.
const BATTER: Bounds = Bounds::Within(0.0, 20.0);
/// Angles from level to upright, in degrees.
const SLOPE: Bounds = Bounds::Within(0.0, 90.0);
/// Meters per unit of a model.
const SCALE: Bounds = Bounds::Above(0.0, 1e6);

/// What may be scattered without a file.
const BUILT_IN: [&str; 4] = ["conifer", "broadleaf", "shrub", "rock"];

pub(super) fn road(reader: &mut TableReader<'_, '_>) -> Option<RoadTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 2);
    let width = quantity(reader, "width", WIDTH);
    let widths = widths(reader, source.as_ref());
    let surface = choice(reader, "surface");
    let shoulder = quantity(reader, "shoulder", STRIP);
    let markings = choice(reader, "markings");
    let join = reader.get("join", |item| item.word());
    let miter_limit = number(reader, "miter_limit", Bounds::Within(1.0, 10.0));
    let profile = reader.get("profile", |item| item.word());
    let earthworks =
        ["max_grade", "crown", "fill_slope", "cut_slope", "max_fill", "max_cut"].map(|key| reader.has(key));
    let max_grade = quantity(reader, "max_grade", Bounds::Above(0.0, 100.0));
    let crown = number(reader, "crown", Bounds::Within(0.0, 20.0));
    let fill_slope = number(reader, "fill_slope", BATTER);
    let cut_slope = number(reader, "cut_slope", BATTER);
    let max_fill = number(reader, "max_fill", DISTANCE);
    let max_cut = number(reader, "max_cut", DISTANCE);
    if profile.as_ref().map_or(ProfileMode::Drape, |profile| *profile.get_ref()) == ProfileMode::Drape {
        for span in earthworks.into_iter().flatten() {
            let message = "this says nothing for a road that follows the ground";
            reader.error(span, message, "add `profile = \"conform\"`, or remove it");
        }
    }
    let bridge = expression(reader, "bridge");
    let tunnel = expression(reader, "tunnel");
    let level = quantity(reader, "level", Bounds::Within(-20.0, 20.0));
    Some(RoadTable {
        name,
        source: source?,
        width,
        widths,
        surface,
        shoulder,
        markings,
        join,
        miter_limit,
        profile,
        max_grade,
        crown,
        fill_slope,
        cut_slope,
        max_fill,
        max_cut,
        bridge,
        tunnel,
        level,
    })
}

pub(super) fn bridge(reader: &mut TableReader<'_, '_>) -> Option<BridgeTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 2);
    let width = quantity(reader, "width", WIDTH);
    let surface = choice(reader, "surface");
    let deck = quantity(reader, "deck", ELEVATION);
    let pier_spacing = number(reader, "pier_spacing", Bounds::Within(1.0, 10_000.0));
    Some(BridgeTable { name, source: source?, width, surface, deck, pier_spacing })
}

pub(super) fn river(reader: &mut TableReader<'_, '_>) -> Option<RiverTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 2);
    let width = quantity(reader, "width", WIDTH);
    let mouth = reader.has("mouth_width");
    let mouth_width = quantity(reader, "mouth_width", WIDTH);
    let widths = widths(reader, source.as_ref());
    if let (Some(mouth), Some(_)) = (mouth, &widths) {
        reader.error(mouth, "the `widths` say how wide the mouth is", "keep `mouth_width` or `widths`");
    }
    let bank = quantity(reader, "bank", STRIP);
    let water = reader.get("water", |item| item.word());
    let has_cut = reader.has("max_cut");
    let max_cut = number(reader, "max_cut", DISTANCE);
    let drapes = water.as_ref().is_some_and(|water| *water.get_ref() == Water::Drape);
    if let Some(span) = has_cut.filter(|_| drapes) {
        let message = "this says nothing for water that follows the ground";
        reader.error(span, message, "take `water = \"drape\"` away, or remove it");
    }
    Some(RiverTable { name, source: source?, width, mouth_width, widths, bank, water, max_cut })
}

pub(super) fn lake(reader: &mut TableReader<'_, '_>) -> Option<LakeTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 3);
    let level = quantity(reader, "level", ELEVATION);
    let rule = reader.has("level_rule");
    let level_rule = reader.get("level_rule", |item| item.word());
    if let (Some(_), Some(rule)) = (&level, rule) {
        reader.error(rule, "the level is stated already", "keep `level` or `level_rule`");
    }
    Some(LakeTable { name, source: source?, level, level_rule })
}

pub(super) fn area(reader: &mut TableReader<'_, '_>) -> Option<AreaTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 3);
    let cover = reader.require("cover", |item| item.choice());
    let color = reader.get("color", |item| item.color());
    let border = reader.get("border", |item| item.word());
    let border_width = number(reader, "border_width", SIZE);
    Some(AreaTable { name, source: source?, cover: Some(cover?), color, border, border_width })
}

pub(super) fn building(reader: &mut TableReader<'_, '_>) -> Option<BuildingTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 3);
    let height = quantity(reader, "height", SIZE);
    let base = reader.get("base", |item| item.word());
    let roof = choice(reader, "roof");
    let roof_height = quantity(reader, "roof_height", STRIP);
    let wall_color = reader.get("wall_color", |item| item.color());
    let roof_color = reader.get("roof_color", |item| item.color());
    Some(BuildingTable { name, source: source?, height, base, roof, roof_height, wall_color, roof_color })
}

pub(super) fn fence(reader: &mut TableReader<'_, '_>) -> Option<FenceTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 2);
    let kind = choice(reader, "kind");
    let height = quantity(reader, "height", SIZE);
    let width = quantity(reader, "width", SIZE);
    let spacing = quantity(reader, "spacing", Bounds::Within(0.1, 10_000.0));
    let sag = number(reader, "sag", Bounds::Within(0.0, 0.2));
    Some(FenceTable { name, source: source?, kind, height, width, spacing, sag })
}

pub(super) fn model(reader: &mut TableReader<'_, '_>) -> Option<ModelPlacement> {
    let name = plain_text(reader, "name");
    let file = reader.require("file", |item| item.file());
    let given = [reader.has("at"), reader.has("instances")];
    let at = reader.get("at", |item| item.point());
    let crs = any_crs(reader, "crs");
    let instances = reader.table("instances", |reader| source(reader, 1)).flatten();
    let is_many = given[1].is_some();
    match given {
        [Some(_), Some(instances)] => {
            reader.error(instances, "[[model]] has both `at` and `instances`", "keep one of them");
        }
        [None, None] => {
            let help = "add a line `at = ...` below it";
            reader.error_if_unexplained(&["at", "instances"], "[[model]] needs the key `at`".into(), help);
        }
        _ => {}
    }
    let by_point = [reader.has("variants"), reader.has("variant")];
    let variants = reader.get("variants", |item| item.files_by_word());
    let variant = expression(reader, "variant");
    match (by_point, is_many) {
        ([Some(span), _] | [None, Some(span)], false) => {
            let message = "this chooses among models for many points, but the model stands at one place";
            reader.error(span, message, "use `[model.instances]`, or remove it");
        }
        ([Some(span), None], _) => {
            reader.error(
                span,
                "nothing says which of the `variants` stands where",
                "add `variant = \"property\"`",
            );
        }
        ([None, Some(span)], _) => {
            let help = "add `variants = { value = \"file\", ... }`";
            reader.error(span, "there are no `variants` to choose from", help);
        }
        _ => {}
    }
    let heading = quantity(reader, "heading", DIRECTION);
    let scale = quantity(reader, "scale", SCALE);
    let clamp = reader.get("clamp", |item| item.word());
    let has_height = reader.has("height");
    let height = quantity(reader, "height", ELEVATION);
    match (clamp.as_ref().map_or(Clamp::Ground, |clamp| *clamp.get_ref()), has_height, &clamp) {
        (Clamp::Ground, Some(span), _) => {
            let help = "add `clamp = \"relative\"` or `clamp = \"absolute\"`, or remove it";
            reader.error(span, "`height` says nothing for a model that stands on the ground", help);
        }
        (Clamp::Relative | Clamp::Absolute, None, Some(clamp)) => {
            reader.error(clamp.span(), "this needs a `height`", "add `height = ...` in meters");
        }
        _ => {}
    }
    let on_ground = ["anchor", "tilt", "sink"].map(|key| reader.has(key));
    if clamp.as_ref().is_some_and(|clamp| *clamp.get_ref() == Clamp::Absolute) {
        for span in on_ground.into_iter().flatten() {
            let message = "this says nothing for a model at a stated elevation";
            reader.error(span, message, "remove it, or take another `clamp`");
        }
    }
    let anchor = reader.get("anchor", |item| item.word());
    let tilt = number(reader, "tilt", SLOPE);
    let sink = number(reader, "sink", STRIP);
    let footing = reader.get("footing", |item| item.word());
    if at.is_none() && instances.is_none() {
        return None;
    }
    Some(ModelPlacement {
        name,
        file: file?,
        at,
        crs,
        instances,
        variants,
        variant,
        heading,
        scale,
        clamp,
        height,
        anchor,
        tilt,
        sink,
        footing,
    })
}

pub(super) fn scatter(reader: &mut TableReader<'_, '_>) -> Option<ScatterTable> {
    let name = plain_text(reader, "name");
    let source = source(reader, 3);
    let of = reader.require("of", |item| item.files(&BUILT_IN));
    let density = quantity(reader, "density", Bounds::Above(0.0, 1e5));
    let spacing = quantity(reader, "spacing", Bounds::Within(0.0, 10_000.0));
    let scale = reader.get("scale", |item| item.range(SCALE));
    let slope = reader.get("slope", |item| item.range(SLOPE));
    let elevation = reader.get("elevation", |item| item.range(ELEVATION));
    let seed = reader.get("seed", |item| item.whole(0..=u32::MAX));
    Some(ScatterTable {
        name,
        source: source?,
        of: Some(of?),
        density,
        spacing,
        scale,
        slope,
        elevation,
        seed,
    })
}

/// The key `widths`: one for each inline point, instead of `width`.
fn widths(reader: &mut TableReader<'_, '_>, source: Option<&FeatureSource>) -> Option<Spanned<Vec<f64>>> {
    let width = reader.has("width");
    let widths = reader.get("widths", |item| item.numbers(WIDTH))?;
    let points = source?.points.as_ref().map_or(0, |points| points.get_ref().len());
    if let Some(width) = width {
        reader.error(width, "there are `widths` already", "keep `width` or `widths`");
    } else if widths.get_ref().len() != points {
        let message = format!("there are {} `widths` for {points} inline points", widths.get_ref().len());
        reader.error(widths.span(), message, "give each inline point one width");
    }
    Some(widths)
}

fn quantity(
    reader: &mut TableReader<'_, '_>,
    key: &'static str,
    bounds: Bounds,
) -> Option<Spanned<Quantity>> {
    reader.get(key, |item| item.quantity(bounds))
}

fn choice<W: Word>(reader: &mut TableReader<'_, '_>, key: &'static str) -> Option<Spanned<ComputedWord<W>>> {
    reader.get(key, |item| item.choice())
}

fn expression(reader: &mut TableReader<'_, '_>, key: &'static str) -> Option<Spanned<Expression>> {
    reader.get(key, |mut item| item.expression())
}

/// The five keys that say where a feature's coordinates come from: `points` or `file`, not both; a layer and a
/// filter only for a file.
fn source(reader: &mut TableReader<'_, '_>, least_points: usize) -> Option<FeatureSource> {
    let given = [reader.has("points"), reader.has("file")];
    let choosing = [
        (reader.has("layer"), "`layer` names a layer of a file, but the points are given here"),
        (reader.has("where"), "`where` chooses features of a file, but the points are given here"),
    ];
    let points = reader.get("points", |item| item.points(least_points));
    let file = reader.get("file", |item| item.file());
    let layer = reader.get("layer", |item| item.filled_text());
    let selection = reader.get("where", |item| item.filter());
    let crs = any_crs(reader, "crs");
    let title = reader.title();
    match given {
        [Some(_), Some(file)] => {
            reader.error(file, format!("{title} has both `points` and `file`"), "keep one of them");
        }
        [Some(_), None] => {
            for (place, message) in choosing {
                place.into_iter().for_each(|place| reader.error(place, message, "remove it"));
            }
        }
        [None, None] => {
            let help = "add `points = [[x, y], ...]` or `file = \"name.geojson\"`";
            reader.error_if_unexplained(
                &["points", "file"],
                format!("{title} has neither `points` nor `file`"),
                help,
            );
        }
        _ => {}
    }
    let (filter, condition) = match selection.map(|selection| (selection.span(), selection.into_inner())) {
        Some((span, Selection::Matching(filter))) => (Some(Spanned::new(span, filter)), None),
        Some((span, Selection::Holding(condition))) => (None, Some(Spanned::new(span, condition))),
        None => (None, None),
    };
    Some(FeatureSource { points, file, layer, filter, condition, crs })
}
