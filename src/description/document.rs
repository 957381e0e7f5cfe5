//! The scene file's tables, one struct each: the reference of what a scene file may say. The tables of features stand in
//! [`crate::description::features`].
//!
//! A scene file is TOML in UTF-8. Lengths and heights are meters, angles degrees, compass directions
//! clockwise from north, coordinates `[easting, northing]` or `[longitude, latitude]`, and file names
//! relative to the file they stand in, unless a key says otherwise. Keys that are not listed here are errors. Every
//! number is finite; the range of each is stated, with `(` where the end itself is not allowed.
//!
//! Three more keys say how a scene file is put together: `include`, at the top, names files whose tables come before
//! its own ([`crate::description::include`]); `[styles.NAME]` holds keys that features share, and `style = "NAME"` in
//! a feature's table takes them ([`crate::description::features`]).
//!
//! The documentation of each field begins with its key and ends with its default: editors are shown just that
//! ([`crate::description::schema`]).
//!
//! ```toml
//! title = "The hill"
//! crs = "EPSG:32616"
//!
//! [terrain]
//! dem = "hill.tif"
//!
//! [style]
//! ramp = "atlas"
//! contours = { interval = 20 }
//!
//! [[road]]
//! file = "roads.geojson"
//! where = { highway = ["primary", "secondary"] }
//! width = "lanes * 3.5 ?? 8"
//!
//! [[camera]]
//! name = "south"
//! eye = [500000, 4649000]
//! eye_height = 300
//! look_at = [500000, 4650000]
//! ```
//!
//! The structs keep optional values optional: defaults are stated here and applied where the scene is built,
//! so that what the user wrote and what was assumed can be told apart. Values that may turn out wrong only
//! then (a file that is not there, a point off the terrain) are [`Spanned`]; [`Document::error`] makes a
//! message that points at one.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;

use crate::description::diagnostic::Diagnostic;
use crate::description::features::{
    AreaTable, BridgeTable, BuildingTable, FenceTable, LakeTable, ModelPlacement, RiverTable, RoadTable,
    ScatterTable,
};
use crate::description::source_text::SourceText;
use crate::description::words::{HeightEncodingWord, LabelKind, RampName};

/// A whole scene file.
#[derive(Clone, Debug)]
pub struct Document {
    /// The text it was read from; what messages point into.
    pub source: Arc<SourceText>,
    /// `title`: the picture's title. Default: none.
    pub title: Option<String>,
    /// `subtitle`: a second line under the title. Default: none.
    pub subtitle: Option<String>,
    /// `crs`: the scene's coordinate system, `EPSG:n` or a proj string, in meters. Default: the DEM's own, or
    /// the UTM zone of its center where it is in degrees.
    pub crs: Option<Spanned<String>>,
    /// `points_crs`: the coordinate system that inline points are written in, unless a feature says
    /// otherwise. Default: the scene's.
    pub points_crs: Option<Spanned<String>>,
    /// `[terrain]`, needed: the ground.
    pub terrain: TerrainTable,
    /// `[style]`: how the ground looks.
    pub style: StyleTable,
    /// `[[road]]`: in drawing order; at most 10 000, as of every repeated table.
    pub roads: Vec<RoadTable>,
    /// `[[bridge]]`: bridges that belong to no road of the scene.
    pub bridges: Vec<BridgeTable>,
    /// `[[river]]`: in drawing order.
    pub rivers: Vec<RiverTable>,
    /// `[[lake]]`: still water, level and cut out of the ground or filled up to it.
    pub lakes: Vec<LakeTable>,
    /// `[[area]]`: what covers the ground, in drawing order.
    pub areas: Vec<AreaTable>,
    /// `[[building]]`: footprints raised to a height.
    pub buildings: Vec<BuildingTable>,
    /// `[[fence]]`: what stands or runs along a line.
    pub fences: Vec<FenceTable>,
    /// `[[model]]`: what stands on the ground.
    pub models: Vec<ModelPlacement>,
    /// `[[scatter]]`: models strewn over areas.
    pub scatters: Vec<ScatterTable>,
    /// `[[label]]`: names and heights on the picture.
    pub labels: Vec<LabelTable>,
    /// `[[camera]]`: views; the first is the default. Without any, one is made that sees the
    /// whole ground in pictures of 4:3 and wider.
    pub cameras: Vec<CameraTable>,
    /// `[furniture]`: title, north arrow, scale bar and legend.
    pub furniture: FurnitureTable,
}

impl Document {
    /// `message` about a value, pointing at its place.
    pub fn error<T>(&self, value: &Spanned<T>, message: impl Into<String>) -> Diagnostic {
        self.error_at(value.span(), message)
    }

    /// `message` about the bytes `span` of the scene file.
    pub fn error_at(&self, span: Range<usize>, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(&self.source, span, message)
    }
}

/// `[terrain]`: the elevation model.
#[derive(Clone, Debug)]
pub struct TerrainTable {
    /// `dem`, needed: the elevation file, or a list of up to 256 that are tiles of one raster; the first tile with a
    /// value wins.
    pub dem: Spanned<Vec<String>>,
    /// `crs`: the DEM's coordinate system where the file names none or a wrong one. Default: what it names.
    pub crs: Option<Spanned<String>>,
    /// `height_scale`: meters per unit of a sample's value, in (0, 10⁶]; needed for gray PNG, 1 by default for RAW,
    /// not looked at for others.
    pub height_scale: Option<Spanned<f64>>,
    /// `height_offset`: height in meters of sample value 0 of a gray PNG or RAW, in [−10⁷, 10⁷]. Default 0.
    pub height_offset: Option<Spanned<f64>>,
    /// `height_encoding`: what the colors of a PNG mean, `"terrain-rgb"` or `"terrarium"`; needed for color PNG.
    pub height_encoding: Option<Spanned<HeightEncodingWord>>,
    /// `raw`: that the file is RAW and how it is laid out, such as `"1201x1201:i16be"`.
    pub raw: Option<Spanned<String>>,
    /// `vertical_datum`: what heights are counted from, such as `"NAVD88"`; printed, never computed with. Default:
    /// what the file says, if anything.
    pub vertical_datum: Option<Spanned<String>>,
    /// `fill_voids`: whether samples without data that others enclose are filled by a membrane. Default: no.
    pub fill_voids: Option<Spanned<bool>>,
    /// `cell`: distance in meters between samples of a file without georeference, in (0, 10⁶]; its south-west
    /// sample then stands at (0, 0).
    pub cell: Option<Spanned<f64>>,
    /// `vertical_exaggeration`: how many times heights are stretched when drawn, in (0, 1000]. Default 1.
    pub vertical_exaggeration: Option<Spanned<f64>>,
    /// `tolerance_px`: how many pixels the drawn ground may be off, in (0, 1000]. Default 1.
    pub tolerance_px: Option<Spanned<f64>>,
}

/// `[style]`: how the ground looks.
#[derive(Clone, Debug, Default)]
pub struct StyleTable {
    /// `ramp`: `"atlas"`, `"desert"`, `"gray"`, or from 2 to 256 stops `[[height, "#rrggbb"], ...]`. Default
    /// `"atlas"`.
    pub ramp: Option<Spanned<RampChoice>>,
    /// `[style.contours]`: contour lines. Default: none.
    pub contours: Option<ContourTable>,
    /// `[style.light]`: where the light comes from.
    pub light: LightTable,
    /// `haze`: distance in meters at which 63 % of what is seen is haze, in [0, 10⁹]; 0 for clear air.
    /// Default: eight times the longest side of the terrain, its drawn height included.
    pub haze: Option<Spanned<f64>>,
}

/// A ramp by name or by its stops.
#[derive(Clone, Debug, PartialEq)]
pub enum RampChoice {
    /// A built-in ramp, stretched from the lowest to the highest ground.
    Named(RampName),
    /// At least two heights in meters, growing, and their colors.
    Stops(Vec<(f64, Color)>),
}

/// A color as written: sRGB red, green, blue and straight alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color(pub [u8; 4]);

impl Color {
    /// The color that `#rgb`, `#rrggbb` or `#rrggbbaa` names; without alpha it is opaque.
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?.chars().map(|digit| digit.to_digit(16));
        let digits: Vec<u8> =
            digits.take(9).map(|digit| digit.map(|digit| digit as u8)).collect::<Option<_>>()?;
        match digits[..] {
            [r, g, b] => Some(Self([r * 17, g * 17, b * 17, 255])),
            [_, _, _, _, _, _] | [_, _, _, _, _, _, _, _] => {
                let mut channels = [255; 4];
                for (channel, pair) in channels.iter_mut().zip(digits.chunks(2)) {
                    *channel = pair[0] * 16 + pair[1];
                }
                Some(Self(channels))
            }
            _ => None,
        }
    }
}

/// `[style.contours]`.
#[derive(Clone, Debug)]
pub struct ContourTable {
    /// `interval`, needed: height in meters between lines, in [0.01, 10⁵].
    pub interval: Spanned<f64>,
    /// `major_every`: every how many lines one is drawn heavier, from 1 to 1000. Default 5.
    pub major_every: Option<Spanned<u32>>,
    /// `color`: `#rgb`, `#rrggbb` or `#rrggbbaa`. Default: a translucent brown.
    pub color: Option<Spanned<Color>>,
}

/// `[style.light]`.
#[derive(Clone, Debug, Default)]
pub struct LightTable {
    /// `azimuth`: where the sun stands, in [−360, 360]. Default 315 (north-west).
    pub azimuth: Option<Spanned<f64>>,
    /// `altitude`: how high it stands above the horizon, in (0, 90]. Default 45.
    pub altitude: Option<Spanned<f64>>,
}

/// `[[label]]`.
#[derive(Clone, Debug)]
pub struct LabelTable {
    /// `text`, needed: what it says; `{height}` becomes the ground's elevation in whole meters.
    pub text: Spanned<String>,
    /// `at`, needed: the place it names.
    pub at: Spanned<[f64; 2]>,
    /// `crs`: the coordinate system of `at`. Default: the scene's `points_crs`.
    pub crs: Option<Spanned<String>>,
    /// `height`: how far above the ground the leader line starts, in [0, 10⁷]. Default 0.
    pub height: Option<Spanned<f64>>,
    /// `kind`: `"summit"`, `"place"`, `"water"` or `"point"`. Default `"place"`.
    pub kind: Option<Spanned<LabelKind>>,
}

/// `[[camera]]`.
#[derive(Clone, Debug)]
pub struct CameraTable {
    /// `name`, needed: how `--camera` calls it; no two alike.
    pub name: Spanned<String>,
    /// `eye`, needed: where the eye is.
    pub eye: Spanned<[f64; 2]>,
    /// `eye_height`: how high the eye is above the ground, in [0, 10⁷]. Default 2.
    pub eye_height: Option<Spanned<f64>>,
    /// `eye_elevation`, instead of `eye_height`: the eye's elevation, in [−10⁷, 10⁷].
    pub eye_elevation: Option<Spanned<f64>>,
    /// `look_at`, needed: what it looks at, on the ground.
    pub look_at: Spanned<[f64; 2]>,
    /// `look_at_height`: how high above the ground it looks, in [−10⁷, 10⁷]. Default 0.
    pub look_at_height: Option<Spanned<f64>>,
    /// `crs`: the coordinate system of `eye` and `look_at`. Default: the scene's `points_crs`.
    pub crs: Option<Spanned<String>>,
    /// `field_of_view`: vertical, in [1, 170]. Default 40.
    pub field_of_view: Option<Spanned<f64>>,
}

/// `[furniture]`: what frames the picture; `true` or `false`, all shown unless turned off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FurnitureTable {
    /// `title`: title and subtitle.
    pub title: bool,
    /// `north_arrow`: the north arrow.
    pub north_arrow: bool,
    /// `scale_bar`: the scale bar.
    pub scale_bar: bool,
    /// `legend`: the elevation legend.
    pub legend: bool,
}

impl Default for FurnitureTable {
    fn default() -> Self {
        Self { title: true, north_arrow: true, scale_bar: true, legend: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_have_three_six_or_eight_digits() {
        assert_eq!(Color::parse("#fa0"), Some(Color([255, 170, 0, 255])));
        assert_eq!(Color::parse("#102030"), Some(Color([16, 32, 48, 255])));
        assert_eq!(Color::parse("#10203040"), Some(Color([16, 32, 48, 64])));
        for bad in ["", "#", "102030", "#1020", "#12345", "#ggg", "#1020304050", "#１２３"] {
            assert_eq!(Color::parse(bad), None, "{bad}");
        }
    }
}
