//! The look of the ground: ramp and contours.

use glam::{DVec2, Vec3};

use crate::ramps::{TintedGround, named};
use sandtable_base::message::choice::Choice;
use sandtable_base::message::suggest::quoted;
use sandtable_description::color::{Color, RampChoice};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::words::{ContourLook, GridName, RampName, SheetLayout, StylePreset, TableTop};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::{ColorRamp, Contours};
use sandtable_geom::crs::Crs;
use sandtable_geom::declination::CalendarDay;

/// A translucent brown.
const CONTOUR_COLOR: Srgba = Srgba([112, 74, 40, 150]);
/// The edges of layers of tints.
const LAYER_EDGE: Srgba = Srgba([84, 70, 48, 110]);
/// Illuminated lines away from the light and toward it.
const SHADED_CONTOUR: Srgba = Srgba([38, 42, 58, 215]);
const LIT_CONTOUR: Srgba = Srgba([255, 253, 240, 255]);

/// The source of the ground's colors.
#[derive(Clone, Debug, PartialEq)]
pub enum RampSource {
    /// A built-in ramp, which spans the heights of the ground.
    Named(RampName),
    /// The same, halfway to white: what is drawn over it stands out.
    Pale(RampName),
    /// The same in layers between round heights, each of one tint.
    Layers(RampName),
    /// Tints of its own, which span the heights of the ground.
    Stretched(&'static [(f32, [u8; 3])]),
    /// A ramp with heights of its own.
    Own(ColorRamp),
}

impl RampSource {
    /// The document's ramp.
    ///
    /// # Errors
    /// Stops that do not rise.
    pub fn new(document: &Document) -> Result<Self, Diagnostic> {
        let choice = &document.style.ramp;
        match &**choice {
            RampChoice::Named(name) => {
                let preset = document.style.preset.filter(|_| choice.stated().is_none());
                Ok(preset.map_or(Self::Named(*name), preset_ramp))
            }
            RampChoice::Stops(stops) => {
                let stop = |&(height, Color(channels)): &(f64, Color)| (height as f32, Srgba(channels));
                let ramp = ColorRamp::new(stops.iter().map(stop).collect());
                let failed = || document.error(choice, "the ramp's heights do not rise");
                ramp.map(Self::Own).ok_or_else(failed)
            }
        }
    }

    /// The colors of `ground`.
    pub fn over(&self, ground: &TintedGround) -> ColorRamp {
        match self {
            Self::Named(name) => named(*name, ground),
            Self::Pale(name) => paler(&named(*name, ground)),
            Self::Layers(name) => layered(&named(*name, ground), ground.range_m),
            Self::Stretched(tints) => {
                stretched(tints, ground.range_m).unwrap_or_else(|| named(RampName::Atlas, ground))
            }
            Self::Own(ramp) => ramp.clone(),
        }
    }
}

/// A ramp halfway to white.
fn paler(ramp: &ColorRamp) -> ColorRamp {
    let pale = |&(height, light): &(f32, Vec3)| (height, Srgba::from_linear(light.lerp(Vec3::ONE, 0.5)));
    ColorRamp::new(ramp.stops().iter().map(pale).collect()).unwrap_or_else(|| ramp.clone())
}

/// Layers of a ramp between the lowest and the highest ground.
const LAYERS: f64 = 8.0;

/// A ramp in layers between round heights, each of the tint in its middle.
fn layered(ramp: &ColorRamp, (low_m, high_m): (f32, f32)) -> ColorRamp {
    let interval_m = round_interval(f64::from(high_m - low_m) / LAYERS).unwrap_or(high_m - low_m);
    // As narrow as an edge can be between heights of 32 bits.
    let edge_m = (interval_m * 1e-3).max(high_m.abs() * 1e-5);
    let first = (low_m / interval_m).floor();
    let layers = (0..=LAYERS as u32 + 1).map(|layer| (first + layer as f32) * interval_m);
    let stops = layers.flat_map(|from_m| {
        let tint = Srgba::from_linear(ramp.linear_at(from_m + interval_m * 0.5));
        [(from_m, tint), (from_m + interval_m - edge_m, tint)]
    });
    ColorRamp::new(stops.collect()).unwrap_or_else(|| ramp.clone())
}

/// Tints from the lowest to the highest ground; `None` where the range is not finite.
fn stretched(tints: &[(f32, [u8; 3])], (low_m, high_m): (f32, f32)) -> Option<ColorRamp> {
    let stop = |&(share, [red, green, blue]): &(f32, [u8; 3])| {
        (low_m + share * (high_m - low_m).max(1.0), Srgba::opaque(red, green, blue))
    };
    let mut stops: Vec<_> = tints.iter().map(stop).collect();
    // Heights may be so large that their rounding leaves the first tint alone.
    stops.dedup_by(|next, last| next.0 <= last.0);
    ColorRamp::new(stops)
}

/// The tints of Swiss maps: gray green valleys, and heights that are lighter and warmer, as air clears above haze (Imhof 1965).
const SWISS_TINTS: [(f32, [u8; 3]); 4] =
    [(0.0, [190, 204, 186]), (0.35, [212, 216, 186]), (0.7, [238, 230, 202]), (1.0, [252, 247, 234])];
/// The pale clay of models.
const CLAY: [(f32, [u8; 3]); 1] = [(0.0, [214, 204, 190])];

/// The tints of a preset.
fn preset_ramp(preset: StylePreset) -> RampSource {
    match preset {
        StylePreset::Military => RampSource::Pale(RampName::Atlas),
        StylePreset::Relief | StylePreset::Print => RampSource::Named(RampName::Gray),
        StylePreset::Atlas => RampSource::Layers(RampName::Atlas),
        StylePreset::Swiss => RampSource::Stretched(&SWISS_TINTS),
        StylePreset::Clay => RampSource::Stretched(&CLAY),
        StylePreset::Topographic | StylePreset::Satellite | StylePreset::Night => {
            RampSource::Named(RampName::Atlas)
        }
    }
}

/// Contour lines between the lowest and the highest ground where a preset draws them.
const PRESET_LINES: f64 = 16.0;

/// The document's contour lines, or those of its preset on ground of these heights.
pub fn contours(document: &Document, (low_m, high_m): (f32, f32)) -> Option<Contours> {
    let has_lines = matches!(
        document.style.preset,
        Some(StylePreset::Topographic | StylePreset::Military | StylePreset::Print | StylePreset::Swiss)
    );
    if document.style.contours.is_none() && document.style.preset == Some(StylePreset::Atlas) {
        let interval_m = round_interval(f64::from(high_m - low_m) / LAYERS)?;
        return Some(Contours { interval_m, major_every: 1, color: LAYER_EDGE, width_px: 0.6, lit: None });
    }
    if document.style.contours.is_none() && has_lines {
        let interval_m = round_interval(f64::from(high_m - low_m) / PRESET_LINES)?;
        let color = match document.style.preset {
            Some(StylePreset::Print) => Srgba([0, 0, 0, 150]),
            _ => CONTOUR_COLOR,
        };
        return Some(Contours { interval_m, major_every: 5, color, width_px: 1.0, lit: None });
    }
    document.style.contours.as_ref().map(|contours| {
        let (usual, lit) = match contours.look {
            ContourLook::Plain => (CONTOUR_COLOR, None),
            ContourLook::Illuminated => (SHADED_CONTOUR, Some(LIT_CONTOUR)),
        };
        Contours {
            interval_m: contours.interval as f32,
            major_every: contours.major_every,
            color: contours.color.map_or(usual, |color| Srgba(color.0)),
            width_px: 1.0,
            lit,
        }
    })
}

/// The rock that is drawn by hachures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RockDrawing {
    /// The rise per meter from which ground is rock.
    pub least_rise: f32,
}

/// The document's rock drawing.
pub fn rock(document: &Document) -> Option<RockDrawing> {
    let style = &document.style;
    let usual = (style.preset == Some(StylePreset::Swiss)).then_some(PRESET_ROCK_DEG);
    let slope_deg = style.rock.as_ref().map(|rock| rock.slope).or(usual)?;
    Some(RockDrawing { least_rise: libm::tan(slope_deg.to_radians()) as f32 })
}

/// The slope of rock where a preset draws it: the default of `[style.rock]`.
const PRESET_ROCK_DEG: f64 = 38.0;

/// The least of 1, 2 and 5 times a power of ten that is not below `least`; `None` where there is none.
fn round_interval(least: f64) -> Option<f32> {
    let power = libm::pow(10.0, libm::floor(libm::log10(least)));
    let found =
        [1.0, 2.0, 5.0, 10.0].into_iter().map(|digit| digit * power).find(|value| *value >= least * 0.999)?;
    (0.01..=100_000.0).contains(&found).then_some(found as f32)
}

/// Distance of haze, what the block stands on, and what the ground's colors are for, as stated or by the preset.
pub struct Surroundings {
    /// Meters, 0 for clear air; `None` fits it to the view.
    pub haze_m: Option<f32>,
    /// What the block stands on.
    pub table: TableTop,
    /// Whether the ground's natural cover shows.
    pub land_cover: bool,
    /// Whether the ground's shade is light, by its preset, or by its own symbols and graphics, which are to stand out.
    pub is_lightly_shaded: bool,
}

impl Surroundings {
    /// The surroundings of a document.
    pub fn new(document: &Document) -> Self {
        let style = &document.style;
        let is_clear = matches!(
            style.preset,
            Some(
                StylePreset::Topographic
                    | StylePreset::Military
                    | StylePreset::Print
                    | StylePreset::Night
                    | StylePreset::Swiss
                    | StylePreset::Atlas
                    | StylePreset::Clay
            )
        );
        let is_natural = style.preset == Some(StylePreset::Satellite);
        Self {
            haze_m: style.haze.map(|distance_m| distance_m as f32).or(is_clear.then_some(0.0)),
            table: *style.table,
            land_cover: style.land_cover.stated().copied().unwrap_or(is_natural || *style.land_cover),
            is_lightly_shaded: matches!(
                style.preset,
                Some(
                    StylePreset::Military
                        | StylePreset::Print
                        | StylePreset::Atlas
                        | StylePreset::Swiss
                        | StylePreset::Clay
                )
            ) || !(document.graphics.is_empty() && document.symbols.is_empty()),
        }
    }
}

/// The grid of a document, as stated or by its preset.
pub fn grid(document: &Document) -> GridName {
    document.furniture.grid.unwrap_or(match document.style.preset {
        Some(StylePreset::Military) => GridName::Mgrs,
        Some(StylePreset::Atlas) => GridName::Geographic,
        _ => GridName::None,
    })
}

/// A note on what the sheet lacks because the place of `middle`, the scene's middle in map coordinates, on Earth is unknown;
/// `None` where it lacks nothing.
pub fn missing_place_note(document: &Document, crs: &Crs, middle: DVec2) -> Option<String> {
    let grid = grid(document);
    let of_earth = matches!(grid, GridName::Utm | GridName::Mgrs | GridName::Geographic)
        .then(|| format!("the {} grid", grid.word()));
    let norths = (document.furniture.layout == SheetLayout::Military).then(|| "the three norths".to_owned());
    let missing: Vec<String> = of_earth.into_iter().chain(norths).collect();
    let error = crs.transform(&Crs::wgs84(), middle).err().filter(|_| !missing.is_empty())?;
    let missing = missing.join(" and ");
    Some(format!(
        "{missing} are not drawn, because the scene has no place on Earth: {error}; state `[terrain] crs`"
    ))
}

/// The day that the document's furniture names.
///
/// # Errors
/// The text is not a day.
pub fn sheet_day(document: &Document) -> Result<Option<CalendarDay>, Diagnostic> {
    let day = document.furniture.date.as_ref().map(|date| {
        let message = format!("'{}' is not a day", quoted(date));
        CalendarDay::parse(date)
            .ok_or_else(|| document.error(date, message).with_help("write it as in \"2026-06-21\""))
    });
    day.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tints_span_the_heights_however_large_these_are() {
        let heights = |range| stretched(&SWISS_TINTS, range).map(|ramp| ramp.height_range());
        assert_eq!(heights((400.0, 4400.0)), Some((400.0, 4400.0)));
        assert_eq!(heights((7.0, 7.0)), Some((7.0, 8.0)));
        assert_eq!(heights((1e9, 1e9)), Some((1e9, 1e9)));
        assert_eq!(heights((0.0, f32::INFINITY)), None);
    }

    #[test]
    fn layers_have_one_tint_each_and_change_at_round_heights() {
        let ramp =
            ColorRamp::new(vec![(130.0, Srgba::opaque(0, 0, 0)), (930.0, Srgba::WHITE)]).expect("rises");
        let layers = layered(&ramp, (130.0, 930.0));
        assert_eq!(layers.linear_at(301.0), layers.linear_at(398.0));
        assert!(layers.linear_at(401.0).x > layers.linear_at(398.0).x);
        assert_eq!(layered(&ramp, (130.0, 130.0)).stops().len(), ramp.stops().len());
    }

    #[test]
    fn intervals_of_presets_are_round() {
        let round = |least: f64| round_interval(least);
        assert_eq!([43.0, 50.0, 0.7, 101.0].map(round), [Some(50.0), Some(50.0), Some(1.0), Some(200.0)]);
        assert_eq!([0.0, f64::NAN, 1e9].map(round), [None, None, None]);
    }
}
