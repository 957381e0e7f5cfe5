//! The diagram of the three norths: true, grid and magnetic, with the angles between them.
//!
//! The lines lean by their angles where those can be told apart, and by as much as can be where they are smaller: the
//! figures count, and a note says so.

use glam::Vec2;

use crate::composer::Composer;
use crate::drawing::{Drawing, polygon};
use crate::nice::format_number;
use crate::pixel_box::PixelSegment;
use crate::sheet::{INK, SOFT_INK};
use crate::text::TextStyle;

/// The length of a line, in design pixels.
const LENGTH: f32 = 64.0;
/// The least and the most lean of a line, degrees.
const LEANS: [f32; 2] = [9.0, 32.0];

/// The norths at the middle of a picture; angles in degrees clockwise from true north.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ThreeNorths {
    /// The direction of grid north.
    pub grid_deg: Option<f64>,
    /// The direction of a compass needle, and its standard error.
    pub magnetic_deg: Option<(f64, f64)>,
    /// The date of the declination, or the reason why it is missing.
    pub magnetic_note: String,
}

/// The diagram with its upper left corner near the origin.
pub(crate) fn compose(norths: &ThreeNorths, composer: &mut Composer) -> Drawing {
    let sheet = composer.sheet;
    let length = sheet.px(LENGTH);
    let foot = Vec2::new(length * 0.75, length + sheet.px(26.0));
    let mut drawing = Drawing::default();
    let letters = composer.style(13.0, TextStyle::MEDIUM);
    let lines =
        [("★", Some(0.0)), ("GN", norths.grid_deg), ("MN", norths.magnetic_deg.map(|(east, _)| east))];
    let apart = lines[1].1.zip(lines[2].1).map_or(180.0, |(grid, magnetic)| (grid - magnetic).abs());
    for (number, (name, angle)) in lines.into_iter().enumerate() {
        let Some(angle) = angle else { continue };
        let mut lean = (angle as f32).abs().clamp(LEANS[0], LEANS[1]) * (angle as f32).signum();
        if angle == 0.0 {
            lean = 0.0;
        } else if number == 2 && apart < 5.0 && norths.grid_deg.is_some_and(|grid| grid * angle > 0.0) {
            // Two lines that lean alike are set apart, in their order.
            let is_more = norths.grid_deg.is_some_and(|grid| angle.abs() > grid.abs());
            lean *= if is_more { 2.0 } else { 0.5 };
        }
        let direction = Vec2::new(libm::sinf(lean.to_radians()), -libm::cosf(lean.to_radians()));
        let tip = foot + direction * length;
        drawing.line(PixelSegment { from: foot, to: tip }, sheet.px(1.4).max(1.0), INK);
        let text = tip + direction * sheet.px(8.0);
        if number == 0 {
            if let Some(star) = star(text, sheet.px(6.5)) {
                drawing.fill(star, INK);
            }
        } else {
            if number == 2 {
                let back = tip - direction * sheet.px(10.0) + direction.perp() * sheet.px(4.5);
                drawing.line(PixelSegment { from: tip, to: back }, sheet.px(1.4).max(1.0), INK);
            }
            let line = composer.line(name, letters);
            let aside = line.advance * (0.5 - 0.4 * direction.x.signum());
            drawing.write(&line, (text - Vec2::X * aside).round(), INK);
        }
    }
    let style = composer.style(13.0, TextStyle::REGULAR);
    let x = length * 1.45;
    let mut baseline = foot.y - length * 0.82;
    for text in notes(norths) {
        let line = composer.line(&text, style);
        drawing.write(&line, Vec2::new(x, baseline).round(), SOFT_INK);
        drawing.record_text(&text, line.missing, line.shortened);
        baseline += style.size_px * 1.36;
    }
    drawing
}

fn star(center: Vec2, radius: f32) -> Option<tiny_skia::Path> {
    let corners: Vec<Vec2> = (0..10)
        .map(|corner| {
            let (turn, reach) = (corner as f32 * 36.0f32.to_radians(), [1.0, 0.42][corner % 2] * radius);
            center + Vec2::new(libm::sinf(turn), -libm::cosf(turn)) * reach
        })
        .collect();
    polygon(&corners)
}

fn notes(norths: &ThreeNorths) -> Vec<String> {
    let grid = norths.grid_deg.map(|grid| format!("GN {}", signed(grid)));
    let magnetic =
        norths.magnetic_deg.map(|(east, error)| format!("MN {} ±{}°", signed(east), format_number(error, 1)));
    let both = norths
        .grid_deg
        .zip(norths.magnetic_deg)
        .map(|(grid, (east, _))| format!("GN to MN {}", signed(east - grid)));
    let drawn = "Angles not to scale".to_owned();
    let note = Some(norths.magnetic_note.clone()).filter(|note| !note.is_empty());
    grid.into_iter().chain(magnetic).chain(both).chain(note).chain([drawn]).collect()
}

/// An angle in degrees and minutes, with its side.
fn signed(east_deg: f64) -> String {
    let minutes = libm::round(east_deg.abs() * 60.0) as u64;
    let side = match minutes {
        0 => "",
        _ if east_deg < 0.0 => " W",
        _ => " E",
    };
    format!("{}°{:02}′{side}", minutes / 60, minutes % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_have_minutes_and_a_side() {
        assert_eq!(signed(-6.01), "6°01′ W");
        assert_eq!(signed(1.6666), "1°40′ E");
        assert_eq!(signed(0.001), "0°00′");
    }

    #[test]
    fn the_angle_from_grid_to_magnetic_is_their_difference_and_a_missing_one_is_noted() {
        let mut norths = ThreeNorths {
            grid_deg: Some(1.5),
            magnetic_deg: Some((-6.0, 0.36)),
            magnetic_note: "WMM2025, 2026-06-21".into(),
        };
        assert!(notes(&norths).contains(&"GN to MN 7°30′ W".to_owned()));
        let marks = |norths: &ThreeNorths| compose(norths, &mut Composer::new(1920, 1080)).marks.len();
        let all = marks(&norths);
        norths.magnetic_deg = None;
        assert!(marks(&norths) < all && notes(&norths).contains(&norths.magnetic_note));
    }
}
