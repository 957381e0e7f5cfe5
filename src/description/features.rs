//! The scene file's tables of features: roads, bridges, water, land cover, buildings, fences and models.
//!
//! A number or word that may differ from feature to feature is stated as such or as an expression over the feature's
//! properties ([`crate::expression`]). Where the properties give no value within its range the default is
//! taken, and the scene's notes say how often.
//!
//! Every table of features may have the key `style` ([`crate::styles`]).

use std::collections::BTreeMap;

use crate::bounds::Bounds::{self, Above, Within};
use crate::color::Color;
use crate::declaration::{KeyDeclaration, Presence};
use crate::expression::Expression;
use crate::feature_source::FeatureSource;
use crate::feature_value::{DefaultedValue, FeatureValue};
use crate::key;
use crate::reader::TableReader;
use crate::stated::Stated;
use crate::table::Table;
use crate::table_key;
use crate::words::{
    Anchor, BaseRule, Border, Clamp, CoastInside, Cover, FenceKind, Footing, Join, LevelRule, Markings,
    ProfileMode, RoadSurface, RoofShape, Water,
};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

/// Widths of roads and rivers, and distances between things.
const WIDTH: Bounds = Within(0.01, 10_000.0);
/// Widths of strips beside something, and depths.
const STRIP: Bounds = Within(0.0, 1000.0);
/// Sizes of what stands on the ground.
const SIZE: Bounds = Above(0.0, 1000.0);
/// Meters out for each meter of height of a batter.
const BATTER: Bounds = Within(0.0, 20.0);
/// Angles from level to upright in degrees.
const SLOPE: Bounds = Within(0.0, 90.0);
/// Meters per unit of a model.
const SCALE: Bounds = Above(0.0, 1e6);
/// Least numbers of points of a source.
const LINE: usize = 2;
const RING: usize = 3;

/// Models that need no file.
const BUILT_IN: [&str; 8] = ["conifer", "broadleaf", "shrub", "rock", "walnut", "beech", "poplar", "pine"];

table! {
    /// `[[road]]`.
    struct RoadTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The centerline.
        source: FeatureSource = table_key::source::<LINE>(), inline;
        /// Width of the carriageway.
        width: DefaultedValue<f64> = key::feature_number(WIDTH, "m"), default 6, unless ["widths"];
        /// With `points`: the width of the carriageway at each point; counts before `width`.
        widths: Option<Stated<Vec<f64>>> = key::numbers(WIDTH, "m"), otherwise "by `width`",
            unless ["points", "file", "width"];
        /// The paving.
        surface: DefaultedValue<RoadSurface> = key::feature_word::<RoadSurface>(), default "asphalt";
        /// Width of the unpaved strip on either side.
        shoulder: DefaultedValue<f64> = key::feature_number(STRIP, "m"), default 0;
        /// The lines on asphalt.
        markings: DefaultedValue<Markings> = key::feature_word::<Markings>(), default "dashed";
        /// How segments meet.
        join: Join = key::word::<Join>(), default "miter";
        /// Length of a miter in half widths above which it is cut off.
        miter_limit: f64 = key::number(Within(1.0, 10.0), ""), default 2;
        /// Which of road and ground follows the other.
        profile: ProfileMode = key::word::<ProfileMode>(), default "drape";
        /// Of a conforming road: the steepest rise along it; 8 is what country roads in hills are built to.
        max_grade: DefaultedValue<f64> = key::feature_number(Above(0.0, 100.0), "%"), default 8;
        /// Of a conforming road: the fall across from the centerline to either side.
        crown: f64 = key::number(Within(0.0, 20.0), "%"), default 0;
        /// Of a conforming road: meters out for each meter down on an embankment's batter; loose earth lies at 1 : 1.5.
        fill_slope: f64 = key::number(BATTER, "m/m"), default 1.5;
        /// Of a conforming road: meters out for each meter up on a cutting's batter; grown ground is steeper than filled.
        cut_slope: f64 = key::number(BATTER, "m/m"), default 1;
        /// Of a conforming road: the height of the highest embankment; a bridge stands where more is needed.
        max_fill: Option<f64> = key::number(WIDTH, "m"), otherwise "any height";
        /// Of a conforming road: the depth of the deepest cutting; a tunnel runs where more is needed.
        max_cut: Option<f64> = key::number(WIDTH, "m"), otherwise "any depth";
        /// Whether a line is a bridge.
        bridge: Option<Expression> = key::expression(), otherwise "whether its property `bridge` is there and not `no`";
        /// Whether a line is a tunnel.
        tunnel: Option<Expression> = key::expression(), otherwise "whether its property `tunnel` is there and not `no`";
        /// What passes over what; roads of different levels do not meet.
        level: Option<FeatureValue<f64>> = key::feature_number(Within(-20.0, 20.0), ""),
            otherwise "the property `layer`, else 1 for a bridge, -1 for a tunnel and 0 for the rest";
    }
    check(reader) {
        check_widths(reader, source.as_ref(), widths.as_ref().and_then(Option::as_ref));
        if profile == Some(ProfileMode::Drape) {
            let keys = ["max_grade", "crown", "fill_slope", "cut_slope", "max_fill", "max_cut"];
            reader.without_effect(&keys, "on a draped road", "set `profile = \"conform\"`, or remove it");
        }
    }

    /// `[[bridge]]`: a bridge along a line.
    struct BridgeTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The centerline, from abutment to abutment.
        source: FeatureSource = table_key::source::<LINE>(), inline;
        /// Width between the parapets: a road with its footways.
        width: DefaultedValue<f64> = key::feature_number(WIDTH, "m"), default 8;
        /// The paving of the deck.
        surface: DefaultedValue<RoadSurface> = key::feature_word::<RoadSurface>(), default "asphalt";
        /// Elevation of the deck.
        deck: Option<FeatureValue<f64>> = key::feature_number(Bounds::ELEVATION, "m"),
            otherwise "straight from the ground at one end to that at the other";
        /// Widest span between piers; 25 is what a beam of plain concrete spans. Without it high bridges have wider spans.
        pier_spacing: Stated<f64> = key::number(Within(1.0, 10_000.0), "m"), default 25;
    }

    /// `[[river]]`.
    struct RiverTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The centerline.
        source: FeatureSource = table_key::source::<LINE>(), inline;
        /// Width of the water.
        width: DefaultedValue<f64> = key::feature_number(WIDTH, "m"), default 8, unless ["widths"];
        /// Width of the water at its lower end; between the ends the width grows evenly.
        mouth_width: Option<FeatureValue<f64>> = key::feature_number(WIDTH, "m"), otherwise "as `width`";
        /// With `points`: the width of the water at each point; counts before `width`.
        widths: Option<Stated<Vec<f64>>> = key::numbers(WIDTH, "m"), otherwise "by `width`",
            unless ["points", "file", "width"];
        /// Width of the bank on either side: a strip beside the water, over which the ground comes back to its own height
        /// beyond the bed.
        bank: DefaultedValue<f64> = key::feature_number(STRIP, "m"), default 0;
        /// Where the water lies.
        water: Water = key::word::<Water>(), default "falls";
        /// Of water that falls: the greatest depth that the ground is cut. Where more is needed, the line does not follow
        /// the valley of the elevation model, the ground stays as it is, and the report lists the place. 10 is the relative
        /// error that the makers of global elevation models promise (Farr et al. 2007).
        max_cut: f64 = key::number(WIDTH, "m"), default 10;
        /// Whether a line runs in a culvert: analyses of water let it pass below what lies on it.
        culvert: Option<Expression> = key::expression(),
            otherwise "whether one of its properties `tunnel` and `culvert` is there and not `no`";
    }
    check(reader) {
        check_widths(reader, source.as_ref(), widths.as_ref().and_then(Option::as_ref));
        reader.exclude("mouth_width", "widths");
        if water == Some(Water::Drape) {
            reader.without_effect(&["max_cut"], "on draped water", "set `water = \"falls\"`, or remove it");
        }
    }

    /// `[[coast]]`: lines with the land on their left, as OpenStreetMap's `natural=coastline` has them, or polygons of sea or
    /// land.
    ///
    /// Ground in the sea lies at `sea_level` of `[terrain]`, else at 0 m; land that would be drawn as sea, or lies beside it, half
    /// a meter above it. Ground below a stated level keeps its depths.
    struct CoastTable {
        /// The coast: lines, of which those that share an end are one, or polygons. Inline points are a line.
        source: FeatureSource = table_key::source::<LINE>(), inline;
        /// Of polygons: what lies inside of them.
        inside: CoastInside = key::word::<CoastInside>(), default "sea", unless ["points"];
    }
    check(reader) {
        if source.as_ref().is_some_and(|source| source.points.is_some()) {
            reader.without_effect(&["inside"], "on a line", "remove it: land lies on the left of inline points");
        }
    }

    /// `[[lake]]`.
    struct LakeTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The shore.
        source: FeatureSource = table_key::source::<RING>(), inline;
        /// Elevation of the water.
        level: Option<FeatureValue<f64>> = key::feature_number(Bounds::ELEVATION, "m"), otherwise "by `level_rule`",
            unless ["level_rule"];
        /// Instead of `level`: which height of the ground along the shore is the level.
        level_rule: LevelRule = key::word::<LevelRule>(), default "lowest", unless ["level"];
    }
    check(reader) {
        if matches!(level, Some(Some(_))) {
            reader.exclude("level_rule", "level");
        }
    }

    /// `[[area]]`: what covers the ground.
    struct AreaTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The outline.
        source: FeatureSource = table_key::source::<RING>(), inline;
        /// What covers the area; of a raster of land cover "(cover)", the cover of each patch.
        cover: FeatureValue<Cover> = key::feature_word::<Cover>(), required;
        /// Color that multiplies the texture; its alpha lets the ground through.
        color: Option<Color> = key::color(), otherwise "the cover's own";
        /// The line along the outline.
        border: Option<Border> = key::word::<Border>(), otherwise "`solid` where the area is restricted, else `none`";
        /// Width of that line; hatching grows with it.
        border_width: f64 = key::number(SIZE, "m"), default 4;
    }

    /// `[[building]]`: footprints raised to a height.
    struct BuildingTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The footprints.
        source: FeatureSource = table_key::source::<RING>(), inline;
        /// Height from the base to the ridge.
        height: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"),
            otherwise "the property `height`, else 3 m for each of `building:levels` (or `levels`) and `roof:levels`, else 6 m";
        /// The height of the ground under the footprint at which the building stands.
        base: Option<BaseRule> = key::word::<BaseRule>(),
            otherwise "`lowest`; of CityJSON `own`, unless most heights lie more than 5 m off the ground";
        /// Of CityJSON: the level of detail that is drawn, such as `"1.2"`.
        lod: Option<Stated<String>> = key::filled_text(), otherwise "the highest of each object", unless ["points"];
        /// The shape of the roof.
        roof: Option<FeatureValue<RoofShape>> = key::feature_word::<RoofShape>(), otherwise "the property `roof:shape`, else `flat`";
        /// How much of the height is roof.
        roof_height: Option<FeatureValue<f64>> = key::feature_number(STRIP, "m"),
            otherwise "the property `roof:height`, else 3 m for each of `roof:levels`, else by `roof:angle`, else by a pitch of 30°";
        /// Direction of the compass to which a slope of the roof falls.
        roof_direction: Option<FeatureValue<f64>> = key::feature_number(Bounds::DIRECTION, "°"),
            otherwise "the property `roof:direction`, else by `roof:orientation`, else across the longer sides";
        /// Color of the walls.
        wall_color: Option<Color> = key::color(),
            otherwise "the property `building:colour`, else one of a few plasters, chosen by the place";
        /// Color of the roof.
        roof_color: Option<Color> = key::color(), otherwise "the property `roof:colour`, else one of a few, chosen by the place";
    }

    /// `[[fence]]`: what stands or runs along a line.
    struct FenceTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The line.
        source: FeatureSource = table_key::source::<LINE>(), inline;
        /// What stands along the line.
        kind: Option<FeatureValue<FenceKind>> = key::feature_word::<FenceKind>(),
            otherwise "by the properties `barrier`, `power` and `boundary` as OpenStreetMap has them, else `fence`";
        /// Height above the ground, or depth of a trench.
        height: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"),
            otherwise "the property `height`, else 1.2 for a fence, 2 for a wall, 1.8 for a hedge, 30 for a power line, \
                       1.5 for a trench, 1.2 for obstacles";
        /// Width of posts, across a wall, a hedge, a trench or a boundary's dashes, between the outermost wires, or of a
        /// whole belt of obstacles.
        width: Option<FeatureValue<f64>> = key::feature_number(SIZE, "m"),
            otherwise "0.12 for a fence, 0.4 for a wall, 1.2 for a hedge, 10 for a power line, 1.5 for a trench, \
                       9 for obstacles, 2 for a boundary";
        /// Distance between posts, pylons, obstacles or dashes, and between the bumps of a hedge, the shades of a wall and
        /// the lumps of a parapet.
        spacing: Option<Stated<FeatureValue<f64>>> = key::feature_number(Within(0.1, 10_000.0), "m"),
            otherwise "3 for a fence, 4 for a wall, 1.2 for a hedge, 300 for a power line, 1.5 for a trench, \
                       3 for obstacles, 18 for a boundary";
        /// Of a power line: how deep the wire hangs in a span, as a part of the span.
        sag: f64 = key::number(Within(0.0, 0.2), ""), default 0.03;
    }

    /// `[[model]]`: a model file, once or many times.
    struct ModelPlacement {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "the property `name`";
        /// The model file, its address, or the bare name of a built-in model: `conifer`, `broadleaf`, `walnut`, `beech`, `poplar`, `pine`, `shrub` or `rock`.
        file: Stated<String> = key::file(), required;
        /// Place of its origin.
        at: Option<Stated<Position>> = key::point(), otherwise "by `instances`", unless ["instances"];
        /// With `at`: its coordinate system.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`", unless ["instances"];
        /// Instead of `at`: one model at each point of a source; expressions see the point's properties.
        instances: Option<FeatureSource> = table_key::source_table::<1>(), otherwise "by `at`", unless ["at"];
        /// With `instances`: other models, named as in `file`, by the value of `variant`.
        variants: Option<Stated<BTreeMap<String, String>>> = key::named_files(), otherwise "none";
        /// With `variants`: which of them stands at a point; `file` where it is none of them.
        variant: Option<Expression> = key::expression(), otherwise "none";
        /// Direction of its front.
        heading: DefaultedValue<f64> = key::feature_number(Bounds::DIRECTION, "°"), default 0;
        /// Meters per unit of the model file.
        scale: DefaultedValue<f64> = key::feature_number(SCALE, "m"), default 1;
        /// How its height is found.
        clamp: Clamp = key::word::<Clamp>(), default "ground";
        /// With `clamp = "relative"` or `"absolute"`, which need it: height above the ground, or elevation.
        height: Option<FeatureValue<f64>> = key::feature_number(Bounds::ELEVATION, "m"), otherwise "none";
        /// The height of the ground that it stands on.
        anchor: Anchor = key::word::<Anchor>(), default "origin";
        /// How far it may lean with the slope of the ground; 90 for always.
        tilt: f64 = key::number(SLOPE, "°"), default 0;
        /// How deep it stands in the ground.
        sink: f64 = key::number(STRIP, "m"), default 0;
        /// What fills the gap to the ground.
        footing: Stated<Footing> = key::word::<Footing>(), default "none";
    }
    check(reader) {
        reader.exclude("instances", "at");
        reader.need_either("at", "instances", "add a line `at = [x, y]`, or a table [model.instances]");
        check_variants(reader);
        match (clamp, reader.value_span("clamp")) {
            (Some(Clamp::Ground), _) => {
                let help = "add `clamp = \"relative\"` or `clamp = \"absolute\"`, or remove it";
                reader.without_effect(&["height"], "on a model that stands on the ground", help);
            }
            (Some(_), Some(span)) if reader.key_span("height").is_none() => {
                reader.error(span, "this needs a `height`", "add `height = ...` in meters");
            }
            _ => {}
        }
        if clamp == Some(Clamp::Absolute) {
            let help = "remove it, or take another `clamp`";
            reader.without_effect(&["anchor", "tilt", "sink"], "on a model at a stated elevation", help);
        }
    }

    /// `[[scatter]]`: models strewn over areas.
    struct ScatterTable {
        /// Name for messages and the feature list.
        name: Option<String> = key::text(), otherwise "none";
        /// The areas.
        source: FeatureSource = table_key::source::<RING>(), inline;
        /// Models, named as in `file` of `[[model]]`; one or up to 256, equally often. `broadleaf` and `conifer` are trees of
        /// several forms.
        models as "of": Stated<Vec<String>> = key::files(&BUILT_IN), required;
        /// How many stand on a hectare; 100 is an open wood.
        density: DefaultedValue<f64> = key::feature_number(Above(0.0, 1e5), "per ha"), default 100;
        /// How near to each other they may stand; where it leaves too little ground for the density, fewer stand.
        spacing: Option<FeatureValue<f64>> = key::feature_number(Within(0.0, 10_000.0), "m"),
            otherwise "half the side of the square that each has to itself";
        /// Meters per unit of the model, from and to: nature grows unevenly.
        scale: [f64; 2] = key::number_range(SCALE, "m"), default [0.8, 1.2];
        /// The slopes of the ground on which they stand, from and to.
        slope: [f64; 2] = key::number_range(SLOPE, "°"), default [0, 90];
        /// The elevations of the ground at which they stand, from and to.
        elevation: Option<[f64; 2]> = key::number_range(Bounds::ELEVATION, "m"), otherwise "anywhere";
        /// Another number strews otherwise.
        seed: u32 = key::integer(0, u32::MAX), default 0;
    }
}

/// Notes `widths` that are not one for each inline point.
fn check_widths(
    reader: &mut TableReader<'_, '_>,
    source: Option<&FeatureSource>,
    widths: Option<&Stated<Vec<f64>>>,
) {
    let Some(widths) = widths else { return };
    let points = source.and_then(|source| source.points.as_ref()).map_or(0, |points| points.len());
    if widths.len() != points {
        let message = format!("there are {} `widths` for {points} inline points", widths.len());
        reader.error(widths.span().unwrap_or_default(), message, "give each inline point one width");
    }
}

/// Notes `variants` and `variant` that have no effect.
fn check_variants(reader: &mut TableReader<'_, '_>) {
    let (variants, variant) = (reader.key_span("variants"), reader.key_span("variant"));
    if reader.key_span("instances").is_none() {
        let key = if variants.is_some() { "variants" } else { "variant" };
        reader.without_effect(&[key], "on a model at one place", "use `[model.instances]`, or remove it");
    } else if variant.is_none() {
        let reason = "without a `variant`, which chooses among them at each point";
        reader.without_effect(&["variants"], reason, "add `variant = \"property\"`");
    } else if variants.is_none() {
        let reason = "without `variants` to choose from";
        reader.without_effect(&["variant"], reason, "add `variants = { value = \"file\", ... }`");
    }
}
