//! The look of the ground: ramp and contours.

use glam::{DVec2, Vec3};

use crate::ramps::{TintedGround, named};
use sandtable_base::message::choice::Choice;
use sandtable_base::message::suggest::quoted;
use sandtable_description::color::{Color, RampChoice};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::words::{GridName, RampName, SheetLayout, StylePreset, TableTop};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::{ColorRamp, Contours};
use sandtable_geom::crs::Crs;
use sandtable_geom::declination::CalendarDay;

/// A translucent brown.
const CONTOUR_COLOR: Srgba = Srgba([112, 74, 40, 150]);

/// The source of the ground's colors.
#[derive(Clone, Debug, PartialEq)]
pub enum RampSource {
    /// A built-in ramp, which spans the heights of the ground.
    Named(RampName),
    /// The same, halfway to white: what is drawn over it stands out.
    Pale(RampName),
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
            Self::Own(ramp) => ramp.clone(),
        }
    }
}

/// A ramp halfway to white.
fn paler(ramp: &ColorRamp) -> ColorRamp {
    let pale = |&(height, light): &(f32, Vec3)| (height, Srgba::from_linear(light.lerp(Vec3::ONE, 0.5)));
    ColorRamp::new(ramp.stops().iter().map(pale).collect()).unwrap_or_else(|| ramp.clone())
}

/// The tints of a preset.
fn preset_ramp(preset: StylePreset) -> RampSource {
    match preset {
        StylePreset::Military => RampSource::Pale(RampName::Atlas),
        StylePreset::Relief | StylePreset::Print => RampSource::Named(RampName::Gray),
        _ => RampSource::Named(RampName::Atlas),
    }
}

/// Contour lines between the lowest and the highest ground where a preset draws them.
const PRESET_LINES: f64 = 16.0;

/// The document's contour lines, or those of its preset on ground of these heights.
pub fn contours(document: &Document, (low_m, high_m): (f32, f32)) -> Option<Contours> {
    let has_lines = matches!(
        document.style.preset,
        Some(StylePreset::Topographic | StylePreset::Military | StylePreset::Print)
    );
    if document.style.contours.is_none() && has_lines {
        let interval_m = round_interval(f64::from(high_m - low_m) / PRESET_LINES)?;
        let color = match document.style.preset {
            Some(StylePreset::Print) => Srgba([0, 0, 0, 150]),
            _ => CONTOUR_COLOR,
        };
        return Some(Contours { interval_m, major_every: 5, color, width_px: 1.0 });
    }
    document.style.contours.as_ref().map(|contours| Contours {
        interval_m: contours.interval as f32,
        major_every: contours.major_every,
        color: contours.color.map_or(CONTOUR_COLOR, |color| Srgba(color.0)),
        width_px: 1.0,
    })
}

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
    /// Whether the ground is a base map by its preset, or by its own symbols and graphics: its shade is lighter then.
    pub is_base_map: bool,
}

impl Surroundings {
    /// The surroundings of a document.
    pub fn new(document: &Document) -> Self {
        let style = &document.style;
        let is_clear = matches!(
            style.preset,
            Some(StylePreset::Topographic | StylePreset::Military | StylePreset::Print | StylePreset::Night)
        );
        let is_natural = style.preset == Some(StylePreset::Satellite);
        Self {
            haze_m: style.haze.map(|distance_m| distance_m as f32).or(is_clear.then_some(0.0)),
            table: *style.table,
            land_cover: style.land_cover.stated().copied().unwrap_or(is_natural || *style.land_cover),
            is_base_map: matches!(style.preset, Some(StylePreset::Military | StylePreset::Print))
                || !(document.graphics.is_empty() && document.symbols.is_empty()),
        }
    }
}

/// The grid of a document, as stated or by its preset.
pub fn grid(document: &Document) -> GridName {
    let is_military = document.style.preset == Some(StylePreset::Military);
    document.furniture.grid.unwrap_or(if is_military { GridName::Mgrs } else { GridName::None })
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
    fn intervals_of_presets_are_round() {
        let round = |least: f64| round_interval(least);
        assert_eq!([43.0, 50.0, 0.7, 101.0].map(round), [Some(50.0), Some(50.0), Some(1.0), Some(200.0)]);
        assert_eq!([0.0, f64::NAN, 1e9].map(round), [None, None, None]);
    }
}
