//! The scale of azimuths along the lower border of a panorama: ticks, degrees and the letters of the compass.

use glam::Vec2;

use crate::annotation::PanoramaMarks;
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{FRAME, INK, PANEL, SOFT_INK};
use crate::text::TextStyle;

/// The letters of the compass, one each 22.5°.
const LETTERS: [&str; 16] =
    ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];

/// Degrees between ticks, from the finest; each divides the next but for the last two, of which one is taken.
const STEPS_DEG: [u32; 6] = [1, 2, 5, 10, 30, 90];

/// The least distance of ticks, design pixels.
const TICK_PX: f32 = 7.0;
/// The least distance of numbers, of letters where there are all sixteen, and of a number from a letter, in ems of their type.
const NUMBER_EM: f32 = 3.9;
const LETTER_EM: f32 = 5.5;
const BESIDE_EM: f32 = 2.9;

/// The scale, along the lower border of the picture; empty where its azimuths are not numbers.
pub fn compose(marks: &PanoramaMarks, composer: &mut Composer) -> Drawing {
    let (sheet, mut drawing) = (composer.sheet, Drawing::default());
    let px_per_deg = sheet.size.x / marks.span_deg as f32;
    if !(px_per_deg.is_finite() && px_per_deg > 0.0 && marks.from_deg.is_finite()) {
        return drawing;
    }
    let [number, letter] =
        [(14.0, TextStyle::REGULAR), (17.0, TextStyle::BOLD)].map(|(size, cut)| composer.style(size, cut));
    let tick_px = sheet.whole_px(8.0);
    let height = (letter.size_px * 1.15 + tick_px + sheet.px(3.0)).round();
    let top = sheet.size.y - height;
    let strip = PixelBox { min: Vec2::new(0.0, top), max: sheet.size };
    drawing.rect(strip, PANEL);
    let edge = sheet.hairline().round();
    drawing.rect(PixelBox { min: strip.min, max: Vec2::new(sheet.size.x, top + edge) }, FRAME);
    let step = |least_px: f32| {
        let fits = |step: &&u32| **step as f32 * px_per_deg >= least_px;
        STEPS_DEG.iter().find(fits).copied().unwrap_or(90)
    };
    let (ticks, numbers) = (step(sheet.px(TICK_PX)), step(number.size_px * NUMBER_EM).max(5));
    let all_letters = 22.5 * px_per_deg >= letter.size_px * LETTER_EM;
    let beside_halves = (letter.size_px * BESIDE_EM / px_per_deg * 2.0).min(360.0) as i64;
    // Degrees from the left border, of each half degree on the picture: letters stand on halves.
    let first = (marks.from_deg * 2.0).ceil() as i64;
    let last = ((marks.from_deg + marks.span_deg) * 2.0 + 1e-9).floor() as i64;
    for half in first..=last {
        let x = (half as f64 * 0.5 - marks.from_deg) as f32 * px_per_deg;
        let turn = half.rem_euclid(720);
        let degrees = turn / 2;
        let is_whole = turn % 2 == 0;
        let point =
            (turn % 45 == 0).then_some((turn / 45) as usize).filter(|point| point % 2 == 0 || all_letters);
        let is_number = is_whole && degrees % i64::from(numbers) == 0;
        let is_tick = is_whole && degrees % i64::from(ticks) == 0;
        if !(is_tick || point.is_some()) {
            continue;
        }
        let share = if point.is_some() || is_number { 1.0 } else { 0.55 };
        let at = Vec2::new(x.clamp(0.5, sheet.size.x - 0.5), top);
        let to = at + Vec2::Y * (tick_px * share);
        drawing.line(PixelSegment { from: at, to }, edge, INK);
        let (text, style, ink) = match point {
            Some(point) => (LETTERS[point].to_owned(), letter, INK),
            None if is_number => (format!("{degrees}°"), number, SOFT_INK),
            None => continue,
        };
        let line = composer.line(&text, style);
        let left = (x - line.advance * 0.5).round();
        // Numbers give way to letters beside them.
        let near_letter = |other: i64| other % 45 == 0 && (other % 90 == 0 || all_letters);
        let gives_way = point.is_none() && (half - beside_halves..=half + beside_halves).any(near_letter);
        if left < 0.0 || left + line.advance > sheet.size.x || gives_way {
            continue;
        }
        let baseline = sheet.size.y - (height - tick_px - style.cap_px()) * 0.5;
        drawing.write(&line, Vec2::new(left, baseline.round()), ink);
        drawing.record_text(&text, line.missing, line.shortened);
    }
    drawing
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(from_deg: f64, span_deg: f64, width: u32) -> Vec<String> {
        let marks = PanoramaMarks { from_deg, span_deg, peaks: Vec::new() };
        let drawing = compose(&marks, &mut Composer::new(width, 600));
        let bounds = drawing.bounds();
        assert!(bounds.max.x <= width as f32 + 1.0 && bounds.min.x >= -1.0, "{bounds:?}");
        drawing.texts.into_iter().map(|text| text.text).collect()
    }

    #[test]
    fn odd_azimuths_draw_nothing() {
        let marks = PanoramaMarks { from_deg: f64::NAN, span_deg: 90.0, peaks: Vec::new() };
        assert_eq!(compose(&marks, &mut Composer::new(900, 600)), Drawing::default());
        assert!(written(0.0, 1e-9, 900).is_empty());
    }

    #[test]
    fn a_full_circle_has_its_letters_in_their_order_and_numbers_between() {
        let texts = written(180.0, 360.0, 4000);
        let letters: Vec<&str> =
            texts.iter().map(String::as_str).filter(|text| text.chars().all(char::is_alphabetic)).collect();
        let main: Vec<&str> = letters.iter().copied().filter(|text| text.len() < 3).collect();
        // South is at both borders, where its letter would leave the picture.
        assert_eq!(main, ["SW", "W", "NW", "N", "NE", "E", "SE"]);
        assert!(
            texts.iter().any(|text| text == "10°") && texts.iter().any(|text| text == "350°"),
            "{texts:?}"
        );
        assert!(!texts.iter().any(|text| text == "0°" || text == "90°"), "letters stand there: {texts:?}");
    }

    #[test]
    fn the_scale_lies_on_the_lower_border_and_keeps_within_the_picture() {
        for (from_deg, span_deg, width) in [(180.0, 360.0, 4000), (-30.0, 61.0, 1900), (359.5, 10.0, 300)] {
            written(from_deg, span_deg, width);
        }
    }
}
