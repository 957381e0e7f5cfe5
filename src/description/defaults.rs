//! What is taken where the scene file says nothing: every number that is a default, in one place.
//!
//! The tables' documentation states the same numbers, for people who write scene files; a test holds the two to each
//! other. Words have theirs where they are defined ([`crate::description::words`], `#[default]`). What a default
//! depends on, as a river's bank on its width, only the tables say.

/// `[terrain] vertical_exaggeration`.
pub const VERTICAL_EXAGGERATION: f64 = 1.0;
/// `[terrain] tolerance_px`: an error of a pixel is what an eye can just see.
pub const TOLERANCE_PX: f64 = 1.0;
/// `[style.contours] major_every`.
pub const CONTOUR_MAJOR_EVERY: u32 = 5;
/// `[style.light] azimuth`: from the north-west, as on maps since Lehmann; lit from below right, hills look like holes.
pub const LIGHT_AZIMUTH_DEG: f64 = 315.0;
/// `[style.light] altitude`.
pub const LIGHT_ALTITUDE_DEG: f64 = 45.0;
/// `[[camera]] eye_height`: a standing person's eye, rounded up.
pub const EYE_HEIGHT_M: f64 = 2.0;
/// `[[camera]] field_of_view`: vertical; about that of a normal lens held upright.
pub const FIELD_OF_VIEW_DEG: f64 = 40.0;
/// `[[label]] height`.
pub const LABEL_HEIGHT_M: f64 = 0.0;

/// `[[road]] width`: two lanes of a country road.
pub const ROAD_WIDTH_M: f64 = 6.0;
/// `[[road]] shoulder`.
pub const ROAD_SHOULDER_M: f64 = 0.0;
/// `[[road]] miter_limit`, in half widths.
pub const MITER_LIMIT: f64 = 2.0;
/// `[[road]] max_grade` in percent: what country roads in hills are built to.
pub const MAX_GRADE_PERCENT: f64 = 8.0;
/// `[[road]] crown` in percent.
pub const CROWN_PERCENT: f64 = 0.0;
/// `[[road]] fill_slope`: meters out for each meter down; loose earth stands at 1 : 1.5.
pub const FILL_SLOPE: f64 = 1.5;
/// `[[road]] cut_slope`: meters out for each meter up; grown ground stands steeper than filled.
pub const CUT_SLOPE: f64 = 1.0;
/// `[[bridge]] width`: a road with its footways.
pub const BRIDGE_WIDTH_M: f64 = 8.0;
/// `[[bridge]] pier_spacing`: what a beam of plain concrete spans.
pub const PIER_SPACING_M: f64 = 25.0;

/// `[[river]] width`.
pub const RIVER_WIDTH_M: f64 = 8.0;
/// `[[area]] border_width`.
pub const BORDER_WIDTH_M: f64 = 4.0;
/// `[[building]] height` where the properties say neither height nor levels: a house of one floor with its roof.
pub const BUILDING_HEIGHT_M: f64 = 6.0;
/// The height of one of a building's `levels`.
pub const LEVEL_HEIGHT_M: f64 = 3.0;
/// The pitch of a roof whose height is not said.
pub const ROOF_PITCH_DEG: f64 = 30.0;
/// `[[fence]] sag`, as a part of the span.
pub const SAG: f64 = 0.03;

/// `[[model]] heading`: north.
pub const HEADING_DEG: f64 = 0.0;
/// `[[model]] scale`: meters per unit.
pub const MODEL_SCALE: f64 = 1.0;
/// `[[model]] tilt`: upright.
pub const TILT_DEG: f64 = 0.0;
/// `[[model]] sink`.
pub const SINK_M: f64 = 0.0;
/// `[[scatter]] density`: to the hectare; an open wood.
pub const DENSITY_PER_HA: f64 = 100.0;
/// `[[scatter]] scale`, from and to: nature grows unevenly.
pub const SCATTER_SCALE: [f64; 2] = [0.8, 1.2];
/// `[[scatter]] slope`, from and to: anywhere.
pub const SCATTER_SLOPE_DEG: [f64; 2] = [0.0, 90.0];
/// `[[scatter]] seed`.
pub const SEED: u32 = 0;
