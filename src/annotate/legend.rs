//! The elevation legend: the ramp with nice heights beside it, and notes on heights and contours, lower right.

use std::f32::consts::SQRT_2;

use glam::Vec2;

use crate::composer::{Composer, widest};
use crate::drawing::Drawing;
use crate::nice::{Ticks, format_trimmed};
use crate::paragraph::written_lines;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{FRAME, INK, SOFT_INK, Sheet};
use crate::text::{CAP_HEIGHT, TextStyle, TypesetLine};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::ColorRamp;
use sandtable_draw::hatching::{PITCH_PX, WIDTH_PX};

/// Height of the ramp in design pixels.
const RAMP_HEIGHT: f32 = 190.0;
/// The greatest height of the ramp as a share of the picture's: it shrinks before it is left out.
const RAMP_SHARE: f32 = 0.24;
/// The least height of the ramp, in sizes of its figures, two of which stand beside it: notes are left out before it is lower.
const LEAST_RAMP_EM: f32 = 3.0;
/// Size of the figures and of notes in design pixels.
const FIGURE_SIZE: f32 = 15.0;
const NOTE_SIZE: f32 = 14.0;
/// From the ramp to the baseline of the first note, from note to note, and from the last to the foot of the swatch of places
/// without data, in sizes of notes.
const FIRST_NOTE_EM: f32 = CAP_HEIGHT + 0.85;
const NEXT_NOTE_EM: f32 = 1.3;
const VOIDS_EM: f32 = 1.9;
/// The widest note, in ems: longer ones are cut.
const WIDEST_NOTE_EM: f32 = 16.0;

/// The meaning of the ground's colors.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Color by height.
    pub ramp: ColorRamp,
    /// Lowest height shown, in meters.
    pub low_m: f32,
    /// Highest height shown, in meters; above `low_m`.
    pub high_m: f32,
    /// The factor by which the picture stretches heights; noted where it is not 1.
    pub vertical_exaggeration: f32,
    /// The greatest scale of a model that is drawn larger than it is, as a symbol.
    pub model_enlargement: Option<f32>,
    /// Whether woods, rock and other covers, and forms below the model's cells, are inferred: symbols of such ground.
    pub has_inferred_cover: bool,
    /// Whether the picture shows places without data, which are hatched.
    pub has_voids: bool,
    /// Height between contour lines in meters, where there are any.
    pub contour_interval: Option<f32>,
    /// A line that names the vertical datum, for instance `Heights: NAVD88`.
    pub vertical_datum: Option<String>,
}

/// The legend on its panel with the upper left corner at the origin; `None` where the range of heights is empty or not
/// finite.
///
/// Where it would be higher than `most_px`, the ramp is lower, and then the last notes are left out.
pub(crate) fn compose(legend: &Legend, most_px: f32, composer: &mut Composer) -> Option<Drawing> {
    if !(legend.low_m < legend.high_m && (legend.high_m - legend.low_m).is_finite()) {
        return None;
    }
    let sheet = composer.sheet;
    let padding = sheet.padding();
    let head = composer.line("Elevation (m)", composer.style(16.0, TextStyle::MEDIUM));
    let head_at = Vec2::new(padding, padding + head.style.cap_px().round());
    let top = head_at.y + (head.style.size_px * 0.72).round();
    let mut notes = notes(legend, composer);
    let beside_px = top
        + padding
        + if legend.has_voids { (sheet.type_px(NOTE_SIZE) * VOIDS_EM).ceil() + 1.0 } else { 0.0 };
    let height = fit_height(&mut notes, most_px - beside_px, &sheet);
    let ramp = PixelBox::at(Vec2::new(padding, top), Vec2::new(sheet.whole_px(20.0), height));
    let mut drawing = Drawing::default();
    draw_ramp(&mut drawing, legend, ramp, &sheet);
    let figures = figures(legend, height, composer);
    let figures_right = draw_figures(&mut drawing, legend, &figures, ramp, &sheet);
    drawing.write(&head, head_at, INK);
    let (mut bottom, mut notes_width) = (ramp.max.y, head.advance);
    for (number, (text, note)) in notes.into_iter().enumerate() {
        let leading = if number == 0 { FIRST_NOTE_EM } else { NEXT_NOTE_EM };
        bottom = (bottom + note.style.size_px * leading).round();
        notes_width = notes_width.max(note.advance);
        drawing.write(&note, Vec2::new(padding, bottom), SOFT_INK);
        drawing.record_text(&text, note.missing, note.shortened);
    }
    if legend.has_voids {
        let style = composer.style(NOTE_SIZE, TextStyle::REGULAR);
        let text = composer.line("No data", style);
        bottom = (bottom + style.size_px * 1.7).round();
        let swatch = PixelBox::at(
            Vec2::new(padding, bottom - style.size_px.round()),
            Vec2::new(ramp.size().x, (style.size_px * 1.2).round()),
        );
        hatch(&mut drawing, swatch, &sheet);
        let at = swatch.max.x + sheet.whole_px(10.0);
        notes_width = notes_width.max(at - padding + text.advance);
        drawing.write(&text, Vec2::new(at, bottom), SOFT_INK);
        bottom = swatch.max.y;
    }
    let right = (padding + notes_width).max(figures_right);
    let corner = Vec2::new((right + padding).ceil(), (bottom + padding).ceil());
    Some(drawing.on_panel(corner, &sheet))
}

/// The height of the ramp where `free_px` are free for it and for `notes` under it, the last of which are left out where it
/// would be too low.
fn fit_height(notes: &mut Vec<(String, TypesetLine)>, free_px: f32, sheet: &Sheet) -> f32 {
    let full = sheet.px(RAMP_HEIGHT).min(sheet.size.y * RAMP_SHARE).round().max(8.0);
    let least = (sheet.type_px(FIGURE_SIZE) * LEAST_RAMP_EM).round().min(full);
    let note_px = sheet.type_px(NOTE_SIZE);
    // Each baseline is rounded.
    let over = |count: usize| match count {
        0 => free_px,
        _ => {
            free_px
                - ((count - 1) as f32 * (note_px * NEXT_NOTE_EM).ceil() + (note_px * FIRST_NOTE_EM).ceil())
        }
    };
    let kept = (0..=notes.len()).rev().find(|&count| over(count) >= least).unwrap_or(0);
    notes.truncate(kept);
    full.min(over(kept).floor()).max(least)
}

fn figures(legend: &Legend, ramp_px: f32, composer: &mut Composer) -> Vec<(f64, TypesetLine)> {
    let style = composer.style(FIGURE_SIZE, TextStyle::REGULAR);
    let most = ((ramp_px / (style.size_px * 1.9)) as usize + 1).clamp(2, 7);
    composer.figures(&Ticks::new(legend.low_m.into(), legend.high_m.into(), most), style)
}

/// Notes below the ramp, each with its text as given.
fn notes(legend: &Legend, composer: &mut Composer) -> Vec<(String, TypesetLine)> {
    let style = composer.style(NOTE_SIZE, TextStyle::REGULAR);
    let mut texts = Vec::new();
    if let Some(interval) = legend.contour_interval.filter(|interval| interval.is_finite() && *interval > 0.0)
    {
        texts.push(format!("Contours every {} m", format_trimmed(interval.into(), 2)));
    }
    let exaggeration = legend.vertical_exaggeration;
    if exaggeration.is_finite() && exaggeration != 1.0 {
        texts.push(format!("Heights ×{}", format_trimmed(exaggeration.into(), 2)));
    }
    if let Some(enlargement) = legend.model_enlargement {
        texts.push(format!("Models up to ×{}", format_trimmed(enlargement.into(), 1)));
    }
    if legend.has_inferred_cover {
        texts.push("Ground cover inferred".to_owned());
    }
    if let Some(datum) = &legend.vertical_datum {
        texts.extend(written_lines(datum, 1).0);
    }
    let mut fitted = |text: String| {
        let line = composer.fitted(&text, style, style.size_px * WIDEST_NOTE_EM)?;
        Some((text, line))
    };
    texts.into_iter().filter_map(&mut fitted).collect()
}

/// Draws a swatch of the hatching of places without data, in a thin frame.
fn hatch(drawing: &mut Drawing, swatch: PixelBox, sheet: &Sheet) {
    let size = swatch.size();
    let pitch = PITCH_PX * SQRT_2;
    // Lines x + y = c through the swatch, cut to it.
    let mut sum = pitch / 2.0;
    while sum < size.x + size.y {
        let from = Vec2::new(sum.min(size.x), (sum - size.x).max(0.0));
        let to = Vec2::new((sum - size.y).max(0.0), sum.min(size.y));
        let line = PixelSegment { from: swatch.min + from, to: swatch.min + to };
        drawing.line(line, WIDTH_PX, SOFT_INK);
        sum += pitch;
    }
    drawing.frame(swatch, sheet.hairline().round(), FRAME);
}

/// Draws the ramp row by row, highest on top, in a thin frame.
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

/// Draws ticks and figures to the right of the ramp; returns the figures' right edge.
fn draw_figures(
    drawing: &mut Drawing,
    legend: &Legend,
    figures: &[(f64, TypesetLine)],
    ramp: PixelBox,
    sheet: &Sheet,
) -> f32 {
    let line = sheet.hairline().round();
    let right = ramp.max.x + sheet.whole_px(10.0) + widest(figures.iter().map(|(_, figure)| figure));
    for (height, figure) in figures {
        let y = (ramp.max.y - ramp.size().y * share(legend, *height) - line * 0.5)
            .round()
            .clamp(ramp.min.y, ramp.max.y - line);
        let tick = PixelBox::at(Vec2::new(ramp.max.x, y), Vec2::new(sheet.whole_px(5.0), line));
        drawing.rect(tick, INK);
        let baseline = (y + line * 0.5 + figure.style.cap_px() * 0.5).round();
        // Flush right, so that digits of the same place stand under each other.
        drawing.write(figure, Vec2::new(right - figure.advance, baseline), INK);
    }
    right
}

/// The position of a height on the ramp: 0 at its foot, 1 at its top.
fn share(legend: &Legend, height: f64) -> f32 {
    let (low, high) = (f64::from(legend.low_m), f64::from(legend.high_m));
    ((height - low) / (high - low)) as f32
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
            model_enlargement: None,
            has_inferred_cover: false,
            has_voids: false,
            contour_interval: Some(20.0),
            vertical_datum: Some("NAVD88".to_owned()),
        }
    }

    fn draw(legend: &Legend) -> Option<Drawing> {
        compose(legend, 560.0, &mut Composer::new(1920, 1080))
    }

    #[test]
    fn marks_stand_at_their_heights_share_of_the_ramp() {
        let figures = figures(&legend(), 190.0, &mut Composer::new(1920, 1080));
        let shares: Vec<f32> = figures.iter().map(|(height, _)| share(&legend(), *height)).collect();
        assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
        assert!((shares[0] - (400.0 - 321.0) / (1062.0 - 321.0)).abs() < 1e-5);
    }

    #[test]
    fn the_panel_holds_everything() {
        let drawing = draw(&legend()).expect("a range");
        let panel = drawing.marks.first().map(|mark| crate::drawing::box_of(&mark.path));
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
    fn places_without_data_have_a_swatch_and_a_taller_panel() {
        let plain = draw(&legend()).expect("a range");
        let hatched = draw(&Legend { has_voids: true, ..legend() }).expect("a range");
        assert!(hatched.bounds().max.y > plain.bounds().max.y + 10.0);
        assert!(hatched.marks.len() > plain.marks.len() + 3);
    }

    #[test]
    fn the_ramp_is_lower_and_notes_are_left_out_before_the_panel_is_too_high() {
        let all =
            Legend { model_enlargement: Some(60.0), has_inferred_cover: true, has_voids: true, ..legend() };
        let composed = |most_px: f32| {
            let drawing = compose(&all, most_px, &mut Composer::new(480, 270)).expect("a range");
            (drawing.bounds().size().y, drawing.texts.len())
        };
        let [(whole_px, whole), (lower_px, lower), (least_px, least)] = [400.0, 165.0, 110.0].map(composed);
        assert!(
            whole_px > 165.0 && lower_px <= 165.0 && least_px <= 110.0,
            "{whole_px} {lower_px} {least_px}"
        );
        assert_eq!((whole, lower), (5, 5));
        assert!((1..5).contains(&least), "{least}");
    }

    #[test]
    fn true_heights_without_contours_or_datum_need_no_notes() {
        let plain =
            Legend { vertical_exaggeration: 1.0, contour_interval: None, vertical_datum: None, ..legend() };
        let notes = |legend: &Legend| notes(legend, &mut Composer::new(1920, 1080)).len();
        let symbols = Legend { model_enlargement: Some(60.0), ..legend() };
        assert_eq!([&plain, &legend(), &symbols].map(notes), [0, 3, 4]);
    }
}
