//! What the properties of a building say of its heights and its roof: Simple 3D Buildings, as OpenStreetMap writes them.
//!
//! | property | what it says |
//! |---|---|
//! | `height`, `min_height` | from the ground to the ridge, and to where the building begins |
//! | `building:levels`, `building:min_level`, `roof:levels` | stories in place of these, 3 m each |
//! | `roof:shape`, `roof:height`, `roof:angle` | the roof; shapes that are not drawn become the nearest that is |
//! | `roof:orientation`, `roof:direction` | where the ridge runs, or to which side the roof falls |

use crate::attributes::{Attributes, DefaultCounts};
use crate::meant_number::Meaning;
use crate::tag_notes::{NumberLimits, TagNotes, TagOutcome};
use sandtable_base::message::choice::Choice;
use sandtable_description::features::BuildingTable;
use sandtable_description::scalar::Scalar;
use sandtable_description::words::RoofShape;
use sandtable_geom::azimuth::heading;
use sandtable_structure::building::STORY_M;
use sandtable_structure::roof_rectangle::RoofTurn;
use sandtable_structure::unit_roof::UnitRoof;

/// The tallest that a property may say, meters; as `height` in a scene file.
const TALLEST_M: f64 = 1000.0;
/// The height of a building whose properties say neither height nor levels, in meters: one floor with its roof.
const HOUSE_M: f64 = 6.0;
/// Rise over run of a roof of 30 degrees.
const PITCH: f64 = 0.577_350_269;
/// Rise over run of one slope, of 15 degrees: it spans the whole depth.
const SKILLION_PITCH: f64 = 0.267_949_192;
/// The most of a building's height that is roof where nobody says how much, so that wide halls keep their walls.
const MOST_ROOF: f64 = 0.5;
/// The steepest that a property may say, degrees.
const STEEPEST_DEG: f64 = 85.0;

/// The extent of a building above its base, meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildingHeights {
    /// Where it begins, 0 for nearly all.
    pub low_m: f64,
    /// Where it ends.
    pub top_m: f64,
    /// Whether it is to begin above its end, and begins at 0.
    pub is_raised_whole: bool,
}

/// The heights of a building: those of its table, else those of its properties.
pub fn heights(
    building: &BuildingTable,
    attributes: &Attributes,
    notes: &mut TagNotes,
    default_counts: &mut DefaultCounts,
) -> BuildingHeights {
    let top_m = attributes.value(building.height.as_ref()).unwrap_or_else(|| {
        let known = tagged_height(attributes, notes).unwrap_or(HOUSE_M);
        attributes.number_or(building.height.as_ref(), known, default_counts)
    });
    let low_m = notes
        .number(attributes, &["min_height"], Meaning::Length, NumberLimits::from_zero(TALLEST_M))
        .or_else(|| stories(attributes, &["building:min_level"], notes).map(|levels| levels * STORY_M))
        .unwrap_or(0.0);
    let is_raised_whole = low_m >= top_m;
    BuildingHeights { low_m: if is_raised_whole { 0.0 } else { low_m }, top_m, is_raised_whole }
}

fn tagged_height(attributes: &Attributes, notes: &mut TagNotes) -> Option<f64> {
    let limits = NumberLimits::above_zero(TALLEST_M);
    notes.number(attributes, &["height"], Meaning::Length, limits).or_else(|| {
        let names = ["building:levels", "levels"];
        let has_roof_levels = attributes.get("roof:levels").is_some();
        let limits = NumberLimits { includes_low: has_roof_levels, ..NumberLimits::above_zero(MOST_STORIES) };
        let body = notes.number(attributes, &names, Meaning::Count, limits)?;
        // What is wrong with it is counted with the roof.
        let roof = stories(attributes, &["roof:levels"], &mut TagNotes::default()).unwrap_or(0.0);
        Some((body + roof) * STORY_M).filter(|&height| height > 0.0)
    })
}

/// The most stories of a building.
const MOST_STORIES: f64 = TALLEST_M / STORY_M;

fn stories(attributes: &Attributes, names: &[&'static str], notes: &mut TagNotes) -> Option<f64> {
    notes.number(attributes, names, Meaning::Count, NumberLimits::from_zero(MOST_STORIES))
}

/// The roof that a building is to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoofWish {
    /// Its shape.
    pub shape: RoofShape,
    /// How it is turned.
    pub turn: RoofTurn,
    /// How much of the height is roof; `None` where it follows from the pitch.
    height_m: Option<f64>,
    /// Rise over run, where that is stated.
    pitch: Option<f64>,
}

impl RoofWish {
    /// The roof of a building's table, else of its properties.
    pub fn new(building: &BuildingTable, attributes: &Attributes, notes: &mut TagNotes) -> Self {
        let shape = attributes.value(building.roof.as_ref());
        let shape = shape.or_else(|| tagged_shape(attributes, notes)).unwrap_or_default();
        let height_m = attributes.value(building.roof_height.as_ref()).or_else(|| {
            let limits = NumberLimits::from_zero(TALLEST_M);
            let tagged = notes.number(attributes, &["roof:height"], Meaning::Length, limits);
            tagged.or_else(|| {
                let levels = stories(attributes, &["roof:levels"], notes).filter(|&levels| levels > 0.0);
                levels.map(|levels| levels * STORY_M)
            })
        });
        let mut angle = || {
            let limits = NumberLimits::above_zero(STEEPEST_DEG);
            notes.number(attributes, &["roof:angle"], Meaning::Count, limits)
        };
        let pitch = if height_m.is_none() { angle().map(|deg| libm::tan(deg.to_radians())) } else { None };
        let turn = match attributes.value(building.roof_direction.as_ref()) {
            Some(azimuth_deg) => RoofTurn::Facing(heading(azimuth_deg)),
            None => tagged_turn(attributes, notes),
        };
        Self { shape, turn, height_m, pitch }
    }

    /// How much of a building's height is roof, meters.
    pub fn height_m(&self, made: &UnitRoof, building_m: f64) -> f64 {
        if made.run_m <= 0.0 {
            return 0.0;
        }
        let usual = match made.shape {
            RoofShape::Skillion => SKILLION_PITCH,
            RoofShape::Dome => 1.0,
            _ => PITCH,
        };
        match (self.height_m, self.pitch) {
            (Some(roof_m), _) => roof_m.min(building_m),
            (None, Some(pitch)) => (made.run_m * pitch).min(building_m),
            (None, None) => (made.run_m * usual).min(building_m * MOST_ROOF),
        }
    }
}

/// The shape that the property `roof:shape` names; one that is not drawn is counted.
fn tagged_shape(attributes: &Attributes, notes: &mut TagNotes) -> Option<RoofShape> {
    let value = attributes.get("roof:shape")?;
    let Scalar::Text(text) = &value else {
        notes.add("roof:shape", TagOutcome::NotUnderstood, &value);
        return None;
    };
    let name = text.trim().to_lowercase().replace('_', "-");
    if let Some(shape) = RoofShape::from_word(&name) {
        return Some(shape);
    }
    let (shape, is_drawn) = match name.as_str() {
        "" => return None,
        "gable" | "pitched" => (RoofShape::Gabled, true),
        "hip" => (RoofShape::Hipped, true),
        "pyramid" | "cone" | "conical" => (RoofShape::Pyramidal, true),
        "shed" | "lean-to" | "monopitch" | "monopitched" | "pent" => (RoofShape::Skillion, true),
        "barrel" | "barrel-vault" => (RoofShape::Round, true),
        "onion" => (RoofShape::Dome, false),
        "gabled-height-moved"
        | "gabled-row"
        | "crosspitched"
        | "cross-gabled"
        | "gablet"
        | "zakopane"
        | "hipped-and-gabled"
        | "sawtooth"
        | "butterfly" => (RoofShape::Gabled, false),
        "side-hipped" | "side-half-hipped" => (RoofShape::Hipped, false),
        "double-saltbox" | "quadruple-saltbox" | "triple-saltbox" => (RoofShape::Saltbox, false),
        _ => {
            notes.add("roof:shape", TagOutcome::Replaced("flat"), &value);
            return None;
        }
    };
    if !is_drawn {
        notes.add("roof:shape", TagOutcome::Replaced(shape.word()), &value);
    }
    Some(shape)
}

/// How the roof is turned by the properties `roof:direction` and `roof:orientation`.
fn tagged_turn(attributes: &Attributes, notes: &mut TagNotes) -> RoofTurn {
    if let Some(value) = attributes.get("roof:direction") {
        match azimuth_deg(&value) {
            Some(azimuth_deg) => return RoofTurn::Facing(heading(azimuth_deg)),
            None => notes.add("roof:direction", TagOutcome::NotUnderstood, &value),
        }
    }
    match attributes.get("roof:orientation") {
        None => RoofTurn::Along,
        Some(Scalar::Text(text)) if text.trim().eq_ignore_ascii_case("along") => RoofTurn::Along,
        Some(Scalar::Text(text)) if text.trim().eq_ignore_ascii_case("across") => RoofTurn::Across,
        Some(value) => {
            notes.add("roof:orientation", TagOutcome::NotUnderstood, &value);
            RoofTurn::Along
        }
    }
}

/// The degrees of a direction that is stated in them, or as a point of the compass.
fn azimuth_deg(value: &Scalar) -> Option<f64> {
    const POINTS: [&str; 16] =
        ["n", "nne", "ne", "ene", "e", "ese", "se", "sse", "s", "ssw", "sw", "wsw", "w", "wnw", "nw", "nnw"];
    const NAMES: [(&str, &str); 4] = [("north", "n"), ("east", "e"), ("south", "s"), ("west", "w")];
    let text = match value {
        Scalar::Number(number) => return Some(*number).filter(|degrees| degrees.abs() <= 360.0),
        Scalar::Text(text) => text.trim().to_lowercase(),
        Scalar::Bool(_) => return None,
    };
    let short =
        NAMES.iter().fold(text.replace(['-', ' '], ""), |text, (name, short)| text.replace(name, short));
    if let Some(point) = POINTS.iter().position(|point| *point == short) {
        return Some(point as f64 * 22.5);
    }
    let degrees = text.trim_end_matches(['°', ' ']).replace(',', ".");
    degrees.parse().ok().filter(|degrees: &f64| degrees.abs() <= 360.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn directions_are_degrees_or_points_of_the_compass() {
        let read = |text: &str| azimuth_deg(&Scalar::Text(text.into()));
        for (text, degrees) in [
            ("90", 90.0),
            ("90°", 90.0),
            ("N", 0.0),
            ("SSW", 202.5),
            ("north", 0.0),
            ("North-West", 315.0),
            ("112,5", 112.5),
        ] {
            assert_eq!(read(text), Some(degrees), "{text}");
        }
        for text in ["", "forward", "400", "nan", "inf", "NXE"] {
            assert_eq!(read(text), None, "{text}");
        }
        let east = heading(90.0);
        assert!((east - DVec2::X).length() < 1e-12);
    }
}
