//! The tables of features: what lies and stands on the ground, one struct each.
//!
//! A number that may differ from feature to feature is a [`Quantity`], a word that may a [`ComputedWord`]: written as such, or
//! as an expression over the feature's properties ([`crate::description::expression`]). Where the properties give no
//! value within its range the default is taken, and the scene's notes say how often.
//!
//! Every table of features may have the key `style`: the keys of that `[styles.NAME]` count as its own where it does not
//! state them itself. A style is judged where it is used; of two keys that exclude each other the table's own counts.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;

use crate::description::document::Color;
use crate::description::expression::{ComputedWord, Expression, Quantity};
use crate::description::words::{
    Anchor, BaseRule, Border, Clamp, Cover, FenceKind, Footing, Join, LevelRule, Markings, ProfileMode,
    RoadSurface, RoofShape, Water,
};

/// Where a feature's coordinates come from: inline `points`, or `file` with an optional filter; exactly one
/// of the two. These keys stand in the feature's own table.
#[derive(Clone, Debug, Default)]
pub struct FeatureSource {
    /// `points`: inline coordinates, at least two for a line and three for a lake, at most 100 000, each in
    /// ±10⁹. A lake's last point may repeat its first.
    pub points: Option<Spanned<Vec<[f64; 2]>>>,
    /// `file`: a vector file: GeoJSON, shapefile, GeoPackage, FlatGeobuf, GPX, KML or OpenStreetMap.
    pub file: Option<Spanned<String>>,
    /// `layer`, only with `file`: which layer of a file that holds several; needed there, unless it holds one.
    pub layer: Option<Spanned<String>>,
    /// `where`, only with `file`: only features whose properties match all of it, each by a value or by one
    /// of a list of up to 256 values; or a text, an expression that must hold. Default: all features.
    pub filter: Option<Spanned<BTreeMap<String, Match>>>,
    /// `where`, if it is a text: only features for which it holds.
    pub condition: Option<Spanned<Expression>>,
    /// `crs`: the coordinate system of `points`, or of a file that names none or a wrong one. Default: the
    /// scene's `points_crs`, or what the file names.
    pub crs: Option<Spanned<String>>,
}

impl FeatureSource {
    /// The place of the coordinates or of the file's name, for messages.
    pub fn span(&self) -> Range<usize> {
        let points = self.points.as_ref().map(Spanned::span);
        points.or_else(|| self.file.as_ref().map(Spanned::span)).unwrap_or(0..0)
    }
}

/// What a property must equal.
#[derive(Clone, Debug, PartialEq)]
pub enum Match {
    /// One of several values.
    AnyOf(Vec<Scalar>),
    /// One value.
    Is(Scalar),
}

impl Match {
    /// The values of which the property must equal one.
    pub fn values(&self) -> &[Scalar] {
        match self {
            Self::AnyOf(values) => values,
            Self::Is(value) => std::slice::from_ref(value),
        }
    }
}

/// A property's value.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    /// True or false.
    Bool(bool),
    /// A number, whole or not.
    Number(f64),
    /// Text.
    Text(String),
}

/// `[[road]]`.
#[derive(Clone, Debug, Default)]
pub struct RoadTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `layer`, `where` and `crs`: the centerline.
    pub source: FeatureSource,
    /// `width`: of the carriageway, in (0, 10 000]. Default 6.
    pub width: Option<Spanned<Quantity>>,
    /// `widths`, only with `points` and instead of `width`: the carriageway's width at each point, in (0, 10 000].
    pub widths: Option<Spanned<Vec<f64>>>,
    /// `surface`: `"asphalt"`, `"gravel"` or `"track"`. Default `"asphalt"`.
    pub surface: Option<Spanned<ComputedWord<RoadSurface>>>,
    /// `shoulder`: width of the unpaved strip on either side, in [0, 1000]. Default 0.
    pub shoulder: Option<Spanned<Quantity>>,
    /// `markings`: the lines on asphalt, `"dashed"` (edge lines and a dashed center line), `"solid"` (a solid center
    /// line), `"edges"` or `"none"`. Default `"dashed"`.
    pub markings: Option<Spanned<ComputedWord<Markings>>>,
    /// `join`: how segments meet, `"miter"`, `"bevel"` or `"round"`. Default `"miter"`.
    pub join: Option<Spanned<Join>>,
    /// `miter_limit`: how long a miter may be in half widths before it is cut off, in [1, 10]. Default 2.
    pub miter_limit: Option<Spanned<f64>>,
    /// `profile`: `"drape"`, the road follows the ground, or `"conform"`, the ground follows the road. Default
    /// `"drape"`.
    pub profile: Option<Spanned<ProfileMode>>,
    /// `max_grade`, only where it conforms: the steepest rise along it in percent, in (0, 100]. Default 8.
    pub max_grade: Option<Spanned<Quantity>>,
    /// `crown`, only where it conforms: the fall across from the centerline to either side in percent, in [0, 20].
    /// Default 0: flat across.
    pub crown: Option<Spanned<f64>>,
    /// `fill_slope`, only where it conforms: meters out for each meter down on an embankment's batter, in [0, 20].
    /// Default 1.5.
    pub fill_slope: Option<Spanned<f64>>,
    /// `cut_slope`, only where it conforms: meters out for each meter up on a cutting's batter, in [0, 20]. Default 1.
    pub cut_slope: Option<Spanned<f64>>,
    /// `max_fill`, only where it conforms: the height in meters of the highest embankment, in (0, 10 000]; a bridge
    /// stands where more is needed. Default: any.
    pub max_fill: Option<Spanned<f64>>,
    /// `max_cut`, only where it conforms: the depth in meters of the deepest cutting, in (0, 10 000]; a tunnel runs
    /// where more is needed. Default: any.
    pub max_cut: Option<Spanned<f64>>,
    /// `bridge`: whether a line is a bridge. Default: whether its property `bridge` is there and not `no`.
    pub bridge: Option<Spanned<Expression>>,
    /// `tunnel`: whether a line is a tunnel. Default: whether its property `tunnel` is there and not `no`.
    pub tunnel: Option<Spanned<Expression>>,
    /// `level`: what passes over what, in [−20, 20]; roads of different levels do not meet. Default: the property
    /// `layer`, else 1 for a bridge, −1 for a tunnel and 0 for the rest.
    pub level: Option<Spanned<Quantity>>,
}

/// `[[bridge]]`: a bridge along a line.
#[derive(Clone, Debug, Default)]
pub struct BridgeTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `layer`, `where` and `crs`: the centerline, from abutment to abutment.
    pub source: FeatureSource,
    /// `width`: between the parapets, in (0, 10 000]. Default 8.
    pub width: Option<Spanned<Quantity>>,
    /// `surface`: of the deck. Default `"asphalt"`.
    pub surface: Option<Spanned<ComputedWord<RoadSurface>>>,
    /// `deck`: the deck's elevation, in [−10⁷, 10⁷]. Default: straight from the ground at one end to that at the other.
    pub deck: Option<Spanned<Quantity>>,
    /// `pier_spacing`: the widest span between piers, in [1, 10 000]. Default 25.
    pub pier_spacing: Option<Spanned<f64>>,
}

/// `[[river]]`.
#[derive(Clone, Debug, Default)]
pub struct RiverTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `layer`, `where` and `crs`: the centerline.
    pub source: FeatureSource,
    /// `width`: of the water, in (0, 10 000]. Default 8.
    pub width: Option<Spanned<Quantity>>,
    /// `mouth_width`: of the water at its lower end, in (0, 10 000]; between the ends the width grows evenly. Default:
    /// as `width`.
    pub mouth_width: Option<Spanned<Quantity>>,
    /// `widths`, only with `points` and instead of `width`: the water's width at each point, in (0, 10 000].
    pub widths: Option<Spanned<Vec<f64>>>,
    /// `bank`: width of the bank on either side, in [0, 1000]: a strip beside the water, and the way over which the ground
    /// comes back to its own height beyond the bed. Default 0.
    pub bank: Option<Spanned<Quantity>>,
    /// `water`: `"falls"`, its level never rises downstream and the ground is cut to it, or `"drape"`, it lies on the
    /// ground as it is. Default `"falls"`.
    pub water: Option<Spanned<Water>>,
    /// `max_cut`, only where it falls: how deep in meters the ground may be cut, in (0, 10 000]. Where water that falls
    /// would need more, the line does not follow the model's valley: the ground there stays as it is, and the report tells
    /// of it. Default 10.
    pub max_cut: Option<Spanned<f64>>,
}

/// `[[lake]]`.
#[derive(Clone, Debug, Default)]
pub struct LakeTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `where` and `crs`: the shore.
    pub source: FeatureSource,
    /// `level`: the water's elevation, in [−10⁷, 10⁷]. Default: by `level_rule`.
    pub level: Option<Spanned<Quantity>>,
    /// `level_rule`, instead of `level`: the level is the `"lowest"`, the `"median"` or the `"mean"` height of the
    /// ground along the shore. Default `"lowest"`.
    pub level_rule: Option<Spanned<LevelRule>>,
}

/// `[[area]]`: what covers the ground.
#[derive(Clone, Debug, Default)]
pub struct AreaTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `layer`, `where` and `crs`: the outline.
    pub source: FeatureSource,
    /// `cover`, needed: what it is covered with, such as `"forest"`; see [`Cover`].
    pub cover: Option<Spanned<ComputedWord<Cover>>>,
    /// `color`: multiplied with the texture; its alpha lets the ground through. Default: the cover's own.
    pub color: Option<Spanned<Color>>,
    /// `border`: the line along its outline, `"none"`, `"solid"` or `"dashed"`. Default: `"solid"` where it is
    /// restricted, else `"none"`.
    pub border: Option<Spanned<Border>>,
    /// `border_width`: of that line, in (0, 1000]; hatching grows with it. Default 4.
    pub border_width: Option<Spanned<f64>>,
}

/// `[[building]]`: footprints raised to a height.
#[derive(Clone, Debug, Default)]
pub struct BuildingTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `layer`, `where` and `crs`: the footprints.
    pub source: FeatureSource,
    /// `height`: from its base to the ridge, in (0, 1000]. Default: the property `height`, else three meters for each
    /// of `building:levels` or `levels`, else 6.
    pub height: Option<Spanned<Quantity>>,
    /// `base`: which ground under the footprint it stands on, `"lowest"`, `"mean"`, `"highest"`, or `"pad"`: the ground
    /// is leveled to its mean. Default `"lowest"`.
    pub base: Option<Spanned<BaseRule>>,
    /// `roof`: `"flat"`, `"gabled"`, `"hipped"` or `"pyramidal"`. Default: the property `roof:shape`, else `"flat"`.
    pub roof: Option<Spanned<ComputedWord<RoofShape>>>,
    /// `roof_height`: how much of the height is roof, in [0, 1000]. Default: the property `roof:height`, else by a pitch
    /// of 30 degrees.
    pub roof_height: Option<Spanned<Quantity>>,
    /// `wall_color`. Default: the property `building:colour`, else one of a few plasters, chosen by where it stands.
    pub wall_color: Option<Spanned<Color>>,
    /// `roof_color`. Default: the property `roof:colour`, else one of a few, chosen by where it stands.
    pub roof_color: Option<Spanned<Color>>,
}

/// `[[fence]]`: what stands or runs along a line.
#[derive(Clone, Debug, Default)]
pub struct FenceTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `layer`, `where` and `crs`: the line.
    pub source: FeatureSource,
    /// `kind`: `"fence"`, `"wall"`, `"hedge"`, `"power-line"`, `"trench"`, `"obstacles"` or `"boundary"`. Default:
    /// by the properties `barrier`, `power` and `boundary` as OpenStreetMap has them, else `"fence"`.
    pub kind: Option<Spanned<ComputedWord<FenceKind>>>,
    /// `height`: above the ground, or a trench's depth, in (0, 1000]. Default: the property `height`, else 1.2 for a
    /// fence, 2 for a wall, 1.8 for a hedge, 30 for a power line, 1.5 for a trench, 1.2 for obstacles.
    pub height: Option<Spanned<Quantity>>,
    /// `width`: of posts, across a wall, a hedge, a trench or a boundary's dashes, between the outermost wires, or of a
    /// whole belt of obstacles, in (0, 1000]. Default: 0.12 for a fence, 0.4 for a wall, 1.2 for a hedge, 10 for a power
    /// line, 1.5 for a trench, 9 for obstacles, 2 for a boundary.
    pub width: Option<Spanned<Quantity>>,
    /// `spacing`: between posts, pylons, obstacles or dashes, and between the bumps of a hedge, the shades of a wall and
    /// the lumps of a parapet, in [0.1, 10 000]. Default: 3 for a fence, 4 for a wall, 1.2 for a hedge, 300 for a power
    /// line, 1.5 for a trench, 3 for obstacles, 18 for a boundary.
    pub spacing: Option<Spanned<Quantity>>,
    /// `sag`, of a power line: how deep the wire hangs in a span, as a part of the span, in [0, 0.2]. Default 0.03.
    pub sag: Option<Spanned<f64>>,
}

/// `[[model]]`: a model file, once or many times.
#[derive(Clone, Debug)]
pub struct ModelPlacement {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `file`, needed: the model file, or the bare name of a built-in model: `"conifer"`, `"broadleaf"`, `"shrub"` or
    /// `"rock"`.
    pub file: Spanned<String>,
    /// `at`, or `instances`: where its origin stands.
    pub at: Option<Spanned<[f64; 2]>>,
    /// `crs`, only with `at`: the coordinate system of `at`. Default: the scene's `points_crs`.
    pub crs: Option<Spanned<String>>,
    /// `[model.instances]`: one at each point of a source; expressions see the point's properties.
    pub instances: Option<FeatureSource>,
    /// `variants`, only with `instances`: other models, named as in `file`, by the value of `variant`; up to 256.
    pub variants: Option<Spanned<BTreeMap<String, String>>>,
    /// `variant`, only with `variants`: which of them stands at a point; `file` where it is none.
    pub variant: Option<Spanned<Expression>>,
    /// `heading`: which way its front points, in [−360, 360]. Default 0 (north).
    pub heading: Option<Spanned<Quantity>>,
    /// `scale`: meters per unit of the model file, in (0, 10⁶]. Default 1.
    pub scale: Option<Spanned<Quantity>>,
    /// `clamp`: `"ground"`, its lowest point on the ground, or the origin of a built-in model; `"relative"`, `height` above
    /// the ground;
    /// `"absolute"`, at elevation `height`. Default `"ground"`.
    pub clamp: Option<Spanned<Clamp>>,
    /// `height`, in [−10⁷, 10⁷]: needed for `"relative"` and `"absolute"`, refused for `"ground"`.
    pub height: Option<Spanned<Quantity>>,
    /// `anchor`: which ground counts as the ground it stands on: under its `"origin"`, or the `"lowest"`, `"highest"` or
    /// `"mean"` under its footprint. Default `"origin"`.
    pub anchor: Option<Spanned<Anchor>>,
    /// `tilt`: how far it may lean with the slope of the ground, in [0, 90]; 90 for always. Default 0: upright.
    pub tilt: Option<Spanned<f64>>,
    /// `sink`: how deep it stands in the ground, in [0, 1000]. Default 0.
    pub sink: Option<Spanned<f64>>,
    /// `footing`: what fills the gap to the ground, `"none"`, `"plinth"` (a block down to the ground) or `"pad"` (the
    /// ground is leveled). Default `"none"`.
    pub footing: Option<Spanned<Footing>>,
}

/// `[[scatter]]`: models strewn over areas.
#[derive(Clone, Debug, Default)]
pub struct ScatterTable {
    /// `name`: for messages and the feature list. Default: none.
    pub name: Option<String>,
    /// `points`, `file`, `layer`, `where` and `crs`: the areas.
    pub source: FeatureSource,
    /// `of`, needed: models, named as in `file` of `[[model]]`; one or up to 256, equally often.
    pub of: Option<Spanned<Vec<String>>>,
    /// `density`: how many to the hectare, in (0, 10⁵]. Default 100.
    pub density: Option<Spanned<Quantity>>,
    /// `spacing`: how near to each other they may stand, in [0, 10 000]; where it leaves no room for the density, fewer stand.
    /// Default: half the side of the square that each has to itself.
    pub spacing: Option<Spanned<Quantity>>,
    /// `scale`: meters per unit of the model, from and to, each in (0, 10⁶]. Default `[0.8, 1.2]`.
    pub scale: Option<Spanned<[f64; 2]>>,
    /// `slope`: where the ground's slope in degrees lies from and to these, each in [0, 90]. Default `[0, 90]`.
    pub slope: Option<Spanned<[f64; 2]>>,
    /// `elevation`: where the ground's elevation lies from and to these, each in [−10⁷, 10⁷]. Default: anywhere.
    pub elevation: Option<Spanned<[f64; 2]>>,
    /// `seed`: another number strews otherwise, from 0 to 2³² − 1. Default 0.
    pub seed: Option<Spanned<u32>>,
}
