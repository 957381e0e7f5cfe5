//! The keys of a camera that is a panorama: how far round it reaches, and what does not go together.

use crate::reader::TableReader;

/// The least part of the horizon that a panorama shows, degrees: a narrower one is a view in perspective.
pub const LEAST_PANORAMA_DEG: f64 = 10.0;

/// How far round a panorama reaches from one azimuth to another, degrees: the whole circle where they are the same or one is
/// missing.
pub fn panorama_span_deg(from_deg: Option<f64>, to_deg: Option<f64>) -> f64 {
    let turn = from_deg.zip(to_deg).map_or(0.0, |(from, to)| (to - from).rem_euclid(360.0));
    if turn == 0.0 { 360.0 } else { turn }
}

/// Reports keys of a panorama that do not go together.
pub(super) fn check_panorama(reader: &mut TableReader<'_, '_>, [from, to]: [Option<f64>; 2]) {
    let keys =
        ["look_at", "look_at_height", "azimuth", "pitch", "shows", "field_of_view", "scale", "dpi", "paper"];
    let help = "state `from` and `to` for a part of the circle; its height is fitted to the skyline";
    reader.without_effect(&keys, "on a panorama", help);
    check_eye_height(reader);
    if reader.key_span("eye").is_none() {
        let span = reader.key_span("projection").unwrap_or_default();
        reader.error(span, "a panorama needs an `eye`", "state the place that it is seen from");
    }
    if let (None, Some(span)) = (reader.key_span("from"), reader.key_span("to")) {
        reader.error(
            span,
            "the camera has `to` without `from`",
            "state both, or `from` alone for the whole circle",
        );
    }
    let span_deg = panorama_span_deg(from, to);
    if let Some(span) = reader.key_span("to").filter(|_| span_deg < LEAST_PANORAMA_DEG) {
        let message = format!(
            "the panorama reaches over {span_deg}° of the horizon, and {LEAST_PANORAMA_DEG}° is the least"
        );
        let help = "move `to` clockwise, or take a camera in perspective with a small `field_of_view`";
        reader.error(span, message, help);
    }
}

/// Reports an eye with two heights.
pub(super) fn check_eye_height(reader: &mut TableReader<'_, '_>) {
    if let (Some(_), Some(span)) = (reader.key_span("eye_height"), reader.value_span("eye_elevation")) {
        let help = "keep `eye_height` to measure from the ground, or `eye_elevation` to measure from the sea";
        reader.error(span, "the eye has both a height and an elevation", help);
    }
}
