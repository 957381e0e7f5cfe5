//! A map as a sheet: the map in its frame, and beside it, on paper, title, legend and scale.
//!
//! ```text
//! ┌──────────────────────────────────┐
//! │ Title                            │   Furniture stands beside the map and not on it: every place of the map
//! │ subtitle                         │   may be of interest.
//! │ ┌─────────────────────┐   N      │
//! │ │                     │   ▲      │
//! │ │         map         │  tints   │
//! │ │                     │  legend  │
//! │ └─────────────────────┘  ├──┼──┤ │
//! └──────────────────────────────────┘
//! ```

use glam::Vec2;

use crate::canvas::{paint, paste};
use crate::composer::Composer;
use crate::drawing::{Drawing, polyline};
use crate::legend::{self, Legend};
use crate::north::{self, CaptionPlace, NorthArrow, NorthKind};
use crate::pixel_box::PixelBox;
use crate::report::AnnotationReport;
use crate::scale_bar;
use crate::sheet::{FRAME, HALO, INK, PAPER, SOFT_INK, Sheet};
use crate::text::TextStyle;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// Width of the column beside the map, in design pixels.
const COLUMN: f32 = 268.0;
/// Least height of the column, in design pixels: that of the furniture.
const COLUMN_HEIGHT: f32 = 560.0;
/// Sizes of title and subtitle, in design pixels of type.
const HEAD: [f32; 2] = [30.0, 17.0];
/// From the top to the title's baseline, on to the subtitle's, and on below it, each in ems of its line.
const LEADING: [f32; 3] = [0.95, 1.75, 0.6];
/// The red of the observer: no ground and no water has it.
const SIGNAL: Srgba = Srgba::opaque(0xc8, 0x1e, 0x2a);
/// Sides of the polygon that approximates a full circle: no corner shows on a sheet.
const CIRCLE_SIDES: usize = 720;

/// The furniture beside the map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFurniture {
    /// The title.
    pub title: String,
    /// The line below it.
    pub subtitle: String,
    /// Colors of the map other than heights, with their meaning, from the top.
    pub tints: Vec<(Srgba, String)>,
    /// The meaning of the ground's colors.
    pub legend: Legend,
    /// Pixels that one meter spans on the map.
    pub pixels_per_meter: f32,
    /// True north on the map, X right and Y up; `None` where it is not known, and the grid's is up.
    pub true_north: Option<Vec2>,
}

/// The observer with range and sector; all lengths in pixels of the map, Y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverOverlay {
    /// The place on the map.
    pub at_px: Vec2,
    /// The range; `None` without limit.
    pub range_px: Option<f32>,
    /// The azimuth at which the sector begins and its clockwise width, degrees; `None` all around.
    pub sector_deg: Option<(f32, f32)>,
}

/// Draws the observer, the range and the sector on a map, clipped to it.
pub fn draw_observer(map: &mut Pixels, overlay: &ObserverOverlay, sheet_px: (u32, u32)) {
    let sheet = Sheet::new(sheet_px.0, sheet_px.1);
    let far = Vec2::new(map.width() as f32, map.height() as f32).length() * 2.0;
    let reach = overlay.range_px.unwrap_or(far).min(far);
    let at = |degrees: f32| {
        let (sin, cos) = (libm::sinf(degrees.to_radians()), libm::cosf(degrees.to_radians()));
        overlay.at_px + Vec2::new(sin, -cos) * reach
    };
    let (start, width) = overlay.sector_deg.unwrap_or((0.0, 360.0));
    let sides = (CIRCLE_SIDES as f32 * width / 360.0).ceil().max(1.0) as usize;
    let arc = (0..=sides).map(|side| at(start + width * side as f32 / sides as f32));
    let apex = overlay.sector_deg.map(|_| overlay.at_px);
    let outline: Vec<Vec2> = apex.into_iter().chain(arc).chain(apex).collect();
    let mut drawing = Drawing::default();
    let is_limited = overlay.range_px.is_some() || overlay.sector_deg.is_some();
    if let Some(path) = polyline(&outline).filter(|_| is_limited) {
        drawing.stroke(&path, sheet.px(4.5), HALO);
        drawing.stroke(&path, sheet.px(2.0), SIGNAL);
    }
    draw_observer_symbol(&mut drawing, overlay.at_px, &sheet);
    paint(map, [&drawing]);
}

/// A dot in a ring: exact in its middle, and visible from afar.
fn draw_observer_symbol(drawing: &mut Drawing, at: Vec2, sheet: &Sheet) {
    for (radius, color) in [(10.0, PAPER), (8.0, SIGNAL), (4.4, PAPER), (2.6, INK)] {
        drawing.disc(at, sheet.px(radius), color);
    }
}

/// The size of the sheet for a map of this size.
pub fn sheet_size(map: (u32, u32)) -> (u32, u32) {
    // The sheet's design sizes follow the map, which is most of it.
    let sheet = Sheet::new(map.0, map.1);
    let margin = sheet.margin();
    let column = sheet.px(COLUMN);
    let width = map.0 as f32 + column + 3.0 * margin;
    let height = (map.1 as f32).max(sheet.px(COLUMN_HEIGHT)) + head_px(&sheet) + 2.5 * margin;
    (width.ceil() as u32, height.ceil() as u32)
}

/// Height of title and subtitle: type shrinks more slowly than the sheet.
fn head_px(sheet: &Sheet) -> f32 {
    let [title, subtitle] = HEAD.map(|size| sheet.type_px(size));
    title * LEADING[0] + subtitle * (LEADING[1] + LEADING[2])
}

/// The sheet with the map on it, and a report of texts that could not be written as given.
pub fn compose(map: &Pixels, furniture: &MapFurniture) -> (Pixels, AnnotationReport) {
    let (width, height) = sheet_size((map.width(), map.height()));
    let mut composer = Composer::new(map.width(), map.height());
    let margin = composer.sheet.margin().round();
    let corner = Vec2::new(margin, (margin * 1.5 + head_px(&composer.sheet)).round());
    let frame = PixelBox::at(corner, Vec2::new(map.width() as f32, map.height() as f32));
    let mut pixels = Pixels::filled(width, height, PAPER);
    paste(&mut pixels, map, corner);
    let mut drawing = Drawing::default();
    drawing.frame(frame.grown(1.0), 1.0, INK);
    let head = PixelBox {
        min: Vec2::new(margin, composer.sheet.margin()),
        max: Vec2::new(width as f32 - margin, corner.y),
    };
    draw_head(&mut drawing, furniture, head, &mut composer);
    let column = PixelBox {
        min: Vec2::new(frame.max.x + margin, frame.min.y),
        max: Vec2::new(width as f32 - margin, height as f32 - margin),
    };
    draw_column(&mut drawing, furniture, column, &mut composer);
    paint(&mut pixels, [&drawing]);
    let mut report = AnnotationReport::default();
    report.add_texts(&drawing.texts);
    (pixels, report)
}

fn draw_head(drawing: &mut Drawing, furniture: &MapFurniture, area: PixelBox, composer: &mut Composer) {
    let mut baseline = area.min.y;
    for (text, style, color, lead) in [
        (&furniture.title, composer.style(HEAD[0], TextStyle::MEDIUM), INK, LEADING[0]),
        (&furniture.subtitle, composer.style(HEAD[1], TextStyle::REGULAR), SOFT_INK, LEADING[1]),
    ] {
        baseline = (baseline + style.size_px * lead).round();
        if let Some(line) = composer.fitted(text, style, area.size().x) {
            drawing.record_text(text, line.missing, line.shortened);
            drawing.write(&line, Vec2::new(area.min.x, baseline), color);
        }
    }
}

/// Draws the column beside the map, from the top; pieces that do not fit are left out.
fn draw_column(drawing: &mut Drawing, furniture: &MapFurniture, column: PixelBox, composer: &mut Composer) {
    let north = furniture.true_north.unwrap_or(Vec2::Y);
    let kind = if furniture.true_north.is_some() { NorthKind::True } else { NorthKind::Grid };
    let arrow = NorthArrow { direction: Vec2::new(north.x, -north.y), foreshortening: 1.0, kind };
    let width = column.size().x;
    let parts = [
        north::compose(&arrow, CaptionPlace::Beside, composer),
        Some(tints(&furniture.tints, width, composer)),
        legend::compose(&furniture.legend, column.size().y, composer),
        scale_bar::compose_on_map(furniture.pixels_per_meter, width * 0.72, composer),
    ];
    let mut top = column.min.y;
    for part in parts.into_iter().flatten() {
        let bounds = part.bounds();
        if top + bounds.size().y <= column.max.y {
            drawing.append(part.moved((Vec2::new(column.min.x, top) - bounds.min).round()));
            top = (top + bounds.size().y + composer.sheet.px(22.0)).round();
        }
    }
}

/// Swatches with their meaning, and the observer's symbol.
fn tints(entries: &[(Srgba, String)], width: f32, composer: &mut Composer) -> Drawing {
    let (sheet, style) = (composer.sheet, composer.style(16.0, TextStyle::REGULAR));
    let (swatch, lead) = (Vec2::new(sheet.whole_px(30.0), sheet.whole_px(20.0)), sheet.whole_px(32.0));
    let mut drawing = Drawing::default();
    let text_left = swatch.x + sheet.whole_px(12.0);
    for (index, (color, text)) in entries.iter().enumerate() {
        let top = lead * index as f32;
        let area = PixelBox::at(Vec2::new(0.0, top), swatch);
        drawing.rect(area, *color);
        drawing.frame(area, sheet.hairline().round(), FRAME);
        if let Some(line) = composer.fitted(text, style, width - text_left) {
            drawing.record_text(text, line.missing, line.shortened);
            let baseline = (top + (swatch.y + style.cap_px()) * 0.5).round();
            drawing.write(&line, Vec2::new(text_left, baseline), INK);
        }
    }
    let symbol = Vec2::new(swatch.x * 0.5, lead * entries.len() as f32 + swatch.y * 0.5);
    draw_observer_symbol(&mut drawing, symbol, &sheet);
    let line = composer.line("Observer", style);
    drawing.write(&line, Vec2::new(text_left, (symbol.y + style.cap_px() * 0.5).round()), INK);
    drawing
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::ground::ColorRamp;

    fn furniture() -> MapFurniture {
        MapFurniture {
            title: "What can be seen".into(),
            subtitle: "from 2 m above the ground".into(),
            tints: vec![(SIGNAL, "In sight".into()), (INK, "Hidden".into())],
            legend: Legend {
                ramp: ColorRamp::new(vec![(0.0, INK), (100.0, PAPER)]).expect("rising"),
                low_m: 0.0,
                high_m: 100.0,
                vertical_exaggeration: 1.0,
                model_enlargement: None,
                has_inferred_cover: false,
                has_voids: false,
                contour_interval: None,
                vertical_datum: None,
            },
            pixels_per_meter: 0.1,
            true_north: Some(Vec2::new(0.1, 1.0)),
        }
    }

    #[test]
    fn the_map_stands_on_the_sheet_pixel_for_pixel() {
        let green = Srgba::opaque(0, 200, 0);
        for size in [(900, 700), (400, 1200), (1200, 90)] {
            let map = Pixels::filled(size.0, size.1, green);
            let (sheet, report) = compose(&map, &furniture());
            let kept = sheet.data().iter().filter(|&&color| color == green).count();
            assert_eq!(kept, (size.0 * size.1) as usize, "{size:?}");
            assert_eq!(report, AnnotationReport::default());
        }
    }

    #[test]
    fn an_outlook_far_off_the_map_leaves_it_as_it_is() {
        let mut map = Pixels::filled(60, 40, INK);
        let far =
            ObserverOverlay { at_px: Vec2::splat(1e5), range_px: Some(50.0), sector_deg: Some((10.0, 90.0)) };
        draw_observer(&mut map, &far, (300, 300));
        assert_eq!(map, Pixels::filled(60, 40, INK));
        draw_observer(&mut map, &ObserverOverlay { at_px: Vec2::new(30.0, 20.0), ..far }, (300, 300));
        assert_ne!(map, Pixels::filled(60, 40, INK));
    }
}
