//! The scene file's tables, one struct each. Lengths are metres, angles degrees, unless a key says otherwise.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

/// A whole scene file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// The picture's title.
    pub title: Option<String>,
    /// A second line under the title.
    pub subtitle: Option<String>,
    /// The scene's coordinate system, metric: `EPSG:n` or a proj string. Default: the DEM's own, or the UTM
    /// zone of its centre where it is in degrees.
    pub crs: Option<Spanned<String>>,
    /// The coordinate system that inline points are written in, unless a feature says otherwise. Default:
    /// the scene's.
    pub points_crs: Option<Spanned<String>>,
    /// The ground.
    pub terrain: Terrain,
    /// How it looks.
    #[serde(default)]
    pub style: Style,
    /// Roads, in drawing order.
    #[serde(default, rename = "road")]
    pub roads: Vec<Road>,
    /// Rivers, in drawing order.
    #[serde(default, rename = "river")]
    pub rivers: Vec<River>,
    /// Lakes.
    #[serde(default, rename = "lake")]
    pub lakes: Vec<Lake>,
    /// Models set on the ground.
    #[serde(default, rename = "model")]
    pub models: Vec<ModelPlacement>,
    /// Names and heights on the picture.
    #[serde(default, rename = "label")]
    pub labels: Vec<Label>,
    /// Views; the first is the default.
    #[serde(default, rename = "camera")]
    pub cameras: Vec<CameraTable>,
    /// Title, north arrow, scale bar and legend.
    #[serde(default)]
    pub furniture: Furniture,
}

/// `[terrain]`: the elevation model.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terrain {
    /// The elevation file, relative to the scene file.
    pub dem: Spanned<String>,
    /// The DEM's coordinate system where the file names none or a wrong one.
    pub crs: Option<Spanned<String>>,
    /// Metres per unit of a 16-bit PNG's sample value; needed for PNG, refused for others.
    pub height_scale: Option<Spanned<f64>>,
    /// Height in metres of sample value 0 of a 16-bit PNG. Default 0.
    pub height_offset: Option<Spanned<f64>>,
    /// Distance in metres between samples of a file without georeference; its south-west sample then stands
    /// at (0, 0).
    pub cell: Option<Spanned<f64>>,
    /// How many times heights are stretched when drawn. Default 1.
    pub vertical_exaggeration: Option<Spanned<f64>>,
    /// How many pixels the drawn ground may be off. Default 1.
    pub tolerance_px: Option<Spanned<f64>>,
}

/// `[style]`: how the ground looks.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// A named ramp (`atlas`, `desert`, `grey`) or a list of `[height, "#rrggbb"]` stops. Default `atlas`.
    pub ramp: Option<Spanned<RampChoice>>,
    /// Contour lines. Absent: none.
    pub contours: Option<ContourTable>,
    /// Where the light comes from.
    #[serde(default)]
    pub light: Light,
    /// Distance in metres at which 63 % of what is seen is haze; 0 for clear air. Default: eight times
    /// the longer side of the terrain.
    pub haze: Option<Spanned<f64>>,
}

/// A ramp by name or by its stops.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum RampChoice {
    /// A built-in ramp, stretched from the lowest to the highest ground.
    Named(String),
    /// Heights in metres and colours.
    Stops(Vec<(f64, String)>),
}

/// `[style.contours]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContourTable {
    /// Height between lines.
    pub interval: Spanned<f64>,
    /// Every how many lines one is drawn heavier. Default 5.
    pub major_every: Option<Spanned<u32>>,
    /// Colour, `#rrggbb` or `#rrggbbaa`. Default a translucent brown.
    pub color: Option<Spanned<String>>,
}

/// `[style.light]`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Light {
    /// Where the sun stands, clockwise from north. Default 315 (north-west).
    pub azimuth: Option<Spanned<f64>>,
    /// How high it stands above the horizon, above 0 to 90. Default 45.
    pub altitude: Option<Spanned<f64>>,
}

/// Where a feature's coordinates come from: inline `points`, or `file` with an optional filter.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Source {
    /// Inline coordinates.
    pub points: Option<Spanned<Vec<[f64; 2]>>>,
    /// A vector file, relative to the scene file.
    pub file: Option<Spanned<String>>,
    /// Only features whose properties match: a value, or a list of which one must be equal.
    #[serde(rename = "where")]
    pub filter: Option<Spanned<BTreeMap<String, Match>>>,
    /// The coordinate system of `points` or of a file that names none or a wrong one.
    pub crs: Option<Spanned<String>>,
}

/// What a property must equal.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Match {
    /// One of several values.
    AnyOf(Vec<Scalar>),
    /// One value.
    Is(Scalar),
}

/// A property's value.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Scalar {
    /// True or false.
    Bool(bool),
    /// A number, whole or not.
    Number(f64),
    /// Text.
    Text(String),
}

/// `[[road]]`.
#[derive(Clone, Debug, Deserialize)]
pub struct Road {
    /// For messages and the feature list.
    pub name: Option<String>,
    /// The centreline.
    #[serde(flatten)]
    pub source: Source,
    /// Carriageway width. Default 6.
    pub width: Option<Spanned<f64>>,
    /// `asphalt`, `gravel` or `track`. Default `asphalt`.
    pub surface: Option<Spanned<String>>,
}

/// `[[river]]`.
#[derive(Clone, Debug, Deserialize)]
pub struct River {
    /// For messages and the feature list.
    pub name: Option<String>,
    /// The centreline.
    #[serde(flatten)]
    pub source: Source,
    /// Width of the water. Default 8.
    pub width: Option<Spanned<f64>>,
}

/// `[[lake]]`.
#[derive(Clone, Debug, Deserialize)]
pub struct Lake {
    /// For messages and the feature list.
    pub name: Option<String>,
    /// The shore.
    #[serde(flatten)]
    pub source: Source,
    /// The water's level. Default: the lowest ground along the shore.
    pub level: Option<Spanned<f64>>,
}

/// `[[model]]`.
#[derive(Clone, Debug, Deserialize)]
pub struct ModelPlacement {
    /// For messages and the feature list.
    pub name: Option<String>,
    /// The model file, relative to the scene file.
    pub file: Spanned<String>,
    /// Where its origin stands.
    pub at: Spanned<[f64; 2]>,
    /// The coordinate system of `at`.
    pub crs: Option<Spanned<String>>,
    /// Which way its front points, clockwise from north. Default 0.
    pub heading: Option<Spanned<f64>>,
    /// Metres per unit of the model file. Default 1.
    pub scale: Option<Spanned<f64>>,
    /// `ground`: its lowest point on the ground; `relative`: `height` above the ground; `absolute`: at
    /// elevation `height`. Default `ground`.
    pub clamp: Option<Spanned<String>>,
    /// For `relative` and `absolute`.
    pub height: Option<Spanned<f64>>,
}

/// `[[label]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Label {
    /// What it says; `{height}` becomes the ground's elevation in whole metres.
    pub text: Spanned<String>,
    /// The place it names.
    pub at: Spanned<[f64; 2]>,
    /// The coordinate system of `at`.
    pub crs: Option<Spanned<String>>,
    /// How far above the ground the leader line starts. Default 0.
    pub height: Option<Spanned<f64>>,
    /// `summit`, `place`, `water` or `point`. Default `place`.
    pub kind: Option<Spanned<String>>,
}

/// `[[camera]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    /// How `--camera` calls it.
    pub name: Spanned<String>,
    /// Where the eye is.
    pub eye: Spanned<[f64; 2]>,
    /// How high the eye is above the ground. Default 2; give this or `eye_elevation`.
    pub eye_height: Option<Spanned<f64>>,
    /// The eye's elevation.
    pub eye_elevation: Option<Spanned<f64>>,
    /// What it looks at, on the ground.
    pub look_at: Spanned<[f64; 2]>,
    /// How high above the ground it looks. Default 0.
    pub look_at_height: Option<Spanned<f64>>,
    /// The coordinate system of `eye` and `look_at`.
    pub crs: Option<Spanned<String>>,
    /// Vertical field of view. Default 40.
    pub field_of_view: Option<Spanned<f64>>,
}

/// `[furniture]`: what frames the picture; all shown unless turned off.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Furniture {
    /// Title and subtitle.
    pub title: bool,
    /// The north arrow.
    pub north_arrow: bool,
    /// The scale bar.
    pub scale_bar: bool,
    /// The elevation legend.
    pub legend: bool,
}

impl Default for Furniture {
    fn default() -> Self {
        Self { title: true, north_arrow: true, scale_bar: true, legend: true }
    }
}
