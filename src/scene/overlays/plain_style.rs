//! Lines, areas and points of an overlay in the style that its file gives them (simplestyle 1.1).

use glam::DVec2;

use super::{number, text};
use crate::attributes::Attributes;
use crate::scene_graphic::{GraphicStyle, SceneGraphic};
use sandtable_description::color::Color;
use sandtable_description::words::{GraphicSide, GraphicStatus};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_symbology::graphic::fields::GraphicFields;
use sandtable_symbology::graphic::kind::MOST_POINTS;
use sandtable_symbology::graphic::plain::{PLAIN_AREA, PLAIN_LINE, PLAIN_POINT};
use sandtable_vector::overlay_schema as schema;

/// The color of what states none.
const GRAY: Srgba = Srgba::opaque(0x55, 0x55, 0x55);
/// The width of a line that states none, and the bounds of stated ones, pixels.
const WIDTH_PX: f64 = 2.0;
const WIDTHS_PX: [f64; 2] = [0.75, 20.0];
/// The opacity of an area that states a color alone: the relief shows through it.
const FILL_OPACITY: f64 = 0.35;
/// The greatest opacity of an area: an overlay does not hide the ground that it lies on.
const MOST_FILL_OPACITY: f64 = 0.7;

/// A shape in its style.
///
/// # Errors
/// It has too many points.
pub(super) fn drawn(
    attributes: &Attributes,
    (mut points, holes): (Vec<DVec2>, Vec<Vec<DVec2>>),
    is_area: bool,
    overlay: &str,
) -> Result<SceneGraphic, String> {
    if is_area && points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    points.dedup();
    let kind = match points.len() {
        1 => &PLAIN_POINT,
        _ if is_area => &PLAIN_AREA,
        _ => &PLAIN_LINE,
    };
    if points.len() > MOST_POINTS * 50 {
        return Err(format!("a {} of {} points is too long for an overlay", kind.word, points.len()));
    }
    let label = text(attributes, schema::LABEL).or_else(|| text(attributes, schema::NAME));
    let fields = GraphicFields { designation: label.unwrap_or_default(), ..GraphicFields::default() };
    let is_dashed = text(attributes, schema::STROKE_DASHES).is_some_and(|dashes| dashes != "none");
    let width_px = number(attributes, schema::STROKE_WIDTH).filter(|width| *width > 0.0);
    let line = color(attributes, schema::STROKE);
    let marker = color(attributes, schema::MARKER_COLOR);
    let stroke = match (kind.points[1] == 1, line, marker) {
        (true, _, Some(Some(color))) | (_, Some(Some(color)), _) => {
            Some(faded(color, number(attributes, schema::STROKE_OPACITY).unwrap_or(1.0)))
        }
        (false, Some(None), _) => None,
        _ => Some(GRAY),
    };
    let opacity = number(attributes, schema::FILL_OPACITY);
    let fill = match color(attributes, schema::FILL) {
        Some(Some(color)) if is_area => {
            Some(faded(color, opacity.unwrap_or(FILL_OPACITY).min(MOST_FILL_OPACITY)))
        }
        None if is_area && opacity.is_some_and(|opacity| opacity > 0.0) => {
            let opacity = opacity.unwrap_or(FILL_OPACITY).min(MOST_FILL_OPACITY);
            Some(faded(stroke.unwrap_or(GRAY), opacity))
        }
        _ => None,
    };
    if is_area && stroke.is_none() && fill.is_none() {
        return Err("an area has neither a line nor a color".to_owned());
    }
    let style = GraphicStyle {
        stroke,
        width_px: width_px.unwrap_or(WIDTH_PX).clamp(WIDTHS_PX[0], WIDTHS_PX[1]),
        is_dashed,
        fill,
        holes,
        overlay: overlay.to_owned(),
    };
    Ok(SceneGraphic {
        kind,
        points,
        width_m: None,
        fields,
        side: GraphicSide::Unknown,
        status: GraphicStatus::Present,
        elevations_m: None,
        style: Some(style),
        feature: FeatureId::NONE,
    })
}

/// A stated color; `Some(None)` where it is stated that there is none.
fn color(attributes: &Attributes, key: &str) -> Option<Option<Srgba>> {
    let text = text(attributes, key)?;
    if text.eq_ignore_ascii_case("none") {
        return Some(None);
    }
    let hex = if text.starts_with('#') { text } else { format!("#{text}") };
    Color::parse(&hex).map(|Color(rgba)| Some(Srgba(rgba)))
}

fn faded(Srgba([red, green, blue, alpha]): Srgba, opacity: f64) -> Srgba {
    Srgba([red, green, blue, (f64::from(alpha) * opacity.clamp(0.0, 1.0)).round() as u8])
}
