//! The elevation legend: the ramp with round heights beside it and what else a reader must know, lower right.

use glam::Vec2;

use crate::annotate::drawing::Drawing;
use crate::annotate::nice::{format_number, format_trimmed, ticks};
use crate::annotate::paragraph::{fitted, written_lines};
use crate::annotate::pixel_box::PixelBox;
use crate::annotate::report::AnnotationReport;
use crate::annotate::sheet::{FRAME, INK, SOFT_INK, Sheet};
use crate::annotate::text::{CAP_HEIGHT, TextLine, TextStyle, Typesetter, write};
use crate::draw::color::Srgba;
use crate::draw::ground::ColorRamp;

/// Height of the ramp in design pixels.
const RAMP_HEIGHT: f32 = 190.0;
/// The ramp takes no more than this share of the picture's height: it shrinks before it is left out.
const RAMP_SHARE: f32 = 0.24;
/// Widest note, in ems: longer ones are cut.
const WIDEST_NOTE_EM: f32 = 16.0;

/// What the colors of the ground mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Color by height.
    pub ramp: ColorRamp,
    /// Lowest height shown, in meters.
    pub low_m: f32,
    /// Highest height shown, in meters; above `low_m`.
    pub high_m: f32,
    /// How many times heights are stretched in the picture; said where it is not 1.
    pub vertical_exaggeration: f32,
    /// Height between contour lines in meters, where there are any.
    pub contour_interval: Option<f32>,
    /// A line that says what heights count from, for instance `Heights: NAVD88`.
    pub vertical_datum: Option<String>,
}

/// The legend on its panel with the upper left corner at the origin; `None` where the range of heights is
/// empty or not finite.
pub fn compose(
    legend: &Legend,
    sheet: &Sheet,
    setter: &mut Typesetter,
    report: &mut AnnotationReport,
) -> Option<Drawing> {
    if !(legend.low_m < legend.high_m && (legend.high_m - legend.low_m).is_finite()) {
        return None;
    }
    let face = TextStyle::upright(sheet.type_px(15.0), TextStyle::REGULAR);
    let head = setter.line("Elevation (m)", TextStyle::upright(sheet.type_px(16.0), TextStyle::MEDIUM));
    let height = sheet.px(RAMP_HEIGHT).min(sheet.size.y * RAMP_SHARE).round().max(8.0);
    let marks = marks(legend, height, face, setter);
    let notes = notes(legend, face, sheet, setter, report);
    Some(lay_out(legend, height, &head, &marks, &notes, sheet))
}

/// A round height: where on the ramp, from 0 at its foot to 1 at its top, and its figure.
struct HeightMark {
    share: f32,
    figure: TextLine,
}

fn marks(legend: &Legend, ramp_px: f32, face: TextStyle, setter: &mut Typesetter) -> Vec<HeightMark> {
    let most = ((ramp_px / (face.size_px * 1.9)) as usize + 1).clamp(2, 7);
    let (low, high) = (f64::from(legend.low_m), f64::from(legend.high_m));
    let (heights, decimals) = ticks(low, high, most);
    let mark = |height: f64| HeightMark {
        share: ((height - low) / (high - low)) as f32,
        figure: setter.line(&format_number(height, decimals), face),
    };
    heights.into_iter().map(mark).collect()
}

fn notes(
    legend: &Legend,
    face: TextStyle,
    sheet: &Sheet,
    setter: &mut Typesetter,
    report: &mut AnnotationReport,
) -> Vec<TextLine> {
    let face = TextStyle { size_px: sheet.type_px(14.0), ..face };
    let mut texts = Vec::new();
    if let Some(interval) = legend.contour_interval.filter(|interval| interval.is_finite() && *interval > 0.0)
    {
        texts.push(format!("Contours every {} m", format_trimmed(f64::from(interval), 2)));
    }
    if legend.vertical_exaggeration.is_finite() && legend.vertical_exaggeration != 1.0 {
        texts.push(format!("Heights ×{}", format_trimmed(f64::from(legend.vertical_exaggeration), 2)));
    }
    if let Some(datum) = &legend.vertical_datum {
        texts.extend(written_lines(datum, 1).0);
    }
    let mut lines = Vec::new();
    for text in texts {
        let Some(line) = fitted(setter, &text, face, face.size_px * WIDEST_NOTE_EM) else { continue };
        report.set(&text, line.missing, line.shortened);
        lines.push(line);
    }
    lines
}

fn lay_out(
    legend: &Legend,
    height: f32,
    head: &TextLine,
    marks: &[HeightMark],
    notes: &[TextLine],
    sheet: &Sheet,
) -> Drawing {
    let padding = sheet.padding();
    let head_at = Vec2::new(padding, padding + (head.style.size_px * CAP_HEIGHT).round());
    let top = head_at.y + (head.style.size_px * 0.72).round();
    let ramp = PixelBox::at(Vec2::new(padding, top), Vec2::new(sheet.whole_px(20.0), height));
    let mut content = Drawing::default();
    draw_ramp(&mut content, legend, ramp, sheet);
    let figures_right = draw_marks(&mut content, marks, ramp, sheet);
    let mut bottom = ramp.max.y;
    let mut placed = vec![];
    for (number, note) in notes.iter().enumerate() {
        let leading = if number == 0 { CAP_HEIGHT + 0.85 } else { 1.3 };
        bottom = (bottom + note.style.size_px * leading).round();
        placed.push((note, Vec2::new(padding, bottom)));
    }
    write(&mut content, &[(head, head_at)], INK);
    write(&mut content, &placed, SOFT_INK);
    let widest = notes.iter().map(|note| note.advance).fold(head.advance, f32::max);
    let right = (padding + widest).max(figures_right);
    let mut drawing = Drawing::default();
    let corner = Vec2::new((right + padding).ceil(), (bottom + padding).ceil());
    drawing.panel(PixelBox { min: Vec2::ZERO, max: corner }, sheet.hairline());
    drawing.append(&content, Vec2::ZERO);
    drawing
}

/// The ramp row by row, highest on top, in a thin frame.
fn draw_ramp(drawing: &mut Drawing, legend: &Legend, ramp: PixelBox, sheet: &Sheet) {
    let rows = ramp.size().y as u32;
    for row in 0..rows {
        let share = 1.0 - (row as f32 + 0.5) / rows as f32;
        let height = legend.low_m + (legend.high_m - legend.low_m) * share;
        let color = Srgba::from_linear(legend.ramp.linear_at(height));
        let corner = Vec2::new(ramp.min.x, ramp.min.y + row as f32);
        drawing.rect(PixelBox::at(corner, Vec2::new(ramp.size().x, 1.0)), color);
    }
    drawing.frame(ramp, sheet.hairline().round(), FRAME);
}

/// Ticks and figures to the right of the ramp; returns how far right they reach.
fn draw_marks(drawing: &mut Drawing, marks: &[HeightMark], ramp: PixelBox, sheet: &Sheet) -> f32 {
    let line = sheet.hairline().round();
    let figures_left = ramp.max.x + sheet.whole_px(10.0);
    let widest = marks.iter().map(|mark| mark.figure.advance).fold(0.0, f32::max);
    for mark in marks {
        let y = (ramp.max.y - ramp.size().y * mark.share - line * 0.5)
            .round()
            .clamp(ramp.min.y, ramp.max.y - line);
        let tick = PixelBox::at(Vec2::new(ramp.max.x, y), Vec2::new(sheet.whole_px(5.0), line));
        drawing.rect(tick, INK);
        let baseline = (y + line * 0.5 + mark.figure.style.size_px * CAP_HEIGHT * 0.5).round();
        // Figures stand flush right, so that digits of the same worth stand under each other.
        let at = Vec2::new(figures_left + widest - mark.figure.advance, baseline);
        write(drawing, &[(&mark.figure, at)], INK);
    }
    figures_left + widest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn legend() -> Legend {
        let stops = vec![(300.0, Srgba::opaque(80, 130, 80)), (1100.0, Srgba::opaque(240, 235, 220))];
        Legend {
            ramp: ColorRamp::new(stops).expect("rising"),
            low_m: 321.0,
            high_m: 1062.0,
            vertical_exaggeration: 1.5,
            contour_interval: Some(20.0),
            vertical_datum: Some("NAVD88".to_owned()),
        }
    }

    fn draw(legend: &Legend) -> Option<Drawing> {
        compose(legend, &Sheet::new(1920, 1080), &mut Typesetter::new(), &mut AnnotationReport::default())
    }

    #[test]
    fn marks_stand_at_their_heights_share_of_the_ramp() {
        let face = TextStyle::upright(15.0, 0.0);
        for mark in marks(&legend(), 190.0, face, &mut Typesetter::new()) {
            assert!((0.0..=1.0).contains(&mark.share));
        }
        let first = &marks(&legend(), 190.0, face, &mut Typesetter::new())[0];
        assert!((first.share - (400.0 - 321.0) / (1062.0 - 321.0)).abs() < 1e-5);
    }

    #[test]
    fn the_panel_holds_everything() {
        let drawing = draw(&legend()).expect("a range");
        let panel = drawing.marks().first().map(|mark| crate::annotate::drawing::box_of(&mark.path));
        assert_eq!(panel, Some(drawing.bounds()));
    }

    #[test]
    fn a_range_that_is_none_has_no_legend() {
        for (low_m, high_m) in
            [(5.0, 5.0), (9.0, 1.0), (f32::NAN, 9.0), (0.0, f32::INFINITY), (f32::MIN, f32::MAX)]
        {
            assert!(draw(&Legend { low_m, high_m, ..legend() }).is_none(), "{low_m}..{high_m}");
        }
    }

    #[test]
    fn true_heights_without_contours_or_datum_need_no_notes() {
        let plain =
            Legend { vertical_exaggeration: 1.0, contour_interval: None, vertical_datum: None, ..legend() };
        let notes = |legend: &Legend| {
            let (mut setter, mut report) = (Typesetter::new(), AnnotationReport::default());
            notes(legend, TextStyle::upright(15.0, 0.0), &Sheet::new(1920, 1080), &mut setter, &mut report)
                .len()
        };
        assert_eq!((notes(&plain), notes(&legend())), (0, 3));
    }
}
