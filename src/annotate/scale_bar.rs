//! The scale bar: a round length at the distance where it is true, lower left.
//!
//! A perspective picture has no one scale. The bar says for which distance from the eye it was made, and is
//! right to half a pixel there for lines across the view.
//!
//! ```text
//!  0        2.5        5 km
//!  ██████▒▒▒▒▒▒██████▒▒▒▒▒▒
//!  at 12.4 km from the eye
//! ```

use glam::Vec2;

use crate::annotate::drawing::Drawing;
use crate::annotate::nice::{NiceNumber, format_distance, format_number};
use crate::annotate::pixel_box::PixelBox;
use crate::annotate::sheet::{INK, PAPER, SOFT_INK, Sheet};
use crate::annotate::text::{CAP_HEIGHT, DESCENT, TextLine, TextStyle, Typesetter, write};
use crate::view::camera::Camera;

/// Longest bar, in design pixels. Round lengths are at most 2.5 times apart, so bars are at least 104.
const LONGEST: f32 = 260.0;
/// Parts of the bar, by turns black and white; even, so that the middle is an edge.
const PARTS: i64 = 4;

/// How large things are at one distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleBar {
    /// Pixels that one meter across the view spans there.
    pub pixels_per_meter: f32,
    /// The distance from the eye for which that holds, in meters; printed under the bar.
    pub distance_m: f32,
}

impl ScaleBar {
    /// How large `camera` shows things `distance_m` meters along its viewing direction.
    pub fn at_distance(camera: &Camera, distance_m: f32) -> Self {
        Self { pixels_per_meter: camera.pixels_per_meter(distance_m), distance_m }
    }
}

/// A bar of round length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundBar {
    /// The length it stands for.
    pub length: NiceNumber,
    /// How long it is drawn, in whole pixels.
    pub length_px: f32,
}

/// The longest round bar of at most `longest_px`; `None` where the scale is not a positive number or the
/// bar would stand for less than a millimeter or more than a hundred thousand kilometers.
pub fn measure(bar: &ScaleBar, longest_px: f32) -> Option<RoundBar> {
    let scale = f64::from(bar.pixels_per_meter);
    let sound = scale > 0.0 && bar.distance_m.is_finite() && bar.distance_m > 0.0;
    let length = NiceNumber::at_most(f64::from(longest_px) / scale).filter(|_| sound)?;
    let sensible = (1e-3..=1e8).contains(&length.value());
    let length_px = libm::round(length.value() * scale) as f32;
    (sensible && length_px > 0.0).then_some(RoundBar { length, length_px })
}

/// The scale bar on its panel with the upper left corner at the origin; `None` where [`measure`] has none.
pub fn compose(bar: &ScaleBar, sheet: &Sheet, setter: &mut Typesetter) -> Option<Drawing> {
    let measure = measure(bar, sheet.px(LONGEST))?;
    let note = TextStyle::upright(sheet.type_px(14.0), TextStyle::REGULAR);
    let where_true = setter.line(&format!("at {} from the eye", format_distance(f64::from(bar.distance_m))), note);
    Some(labeled(&measure, Some(&where_true), sheet, setter))
}

/// The scale bar of a map, which has one scale all over; otherwise as [`compose`], no longer than `longest_px`.
pub fn compose_on_map(
    pixels_per_meter: f32,
    longest_px: f32,
    sheet: &Sheet,
    setter: &mut Typesetter,
) -> Option<Drawing> {
    // every distance will do
    let measure = measure(&ScaleBar { pixels_per_meter, distance_m: 1.0 }, longest_px)?;
    Some(labeled(&measure, None, sheet, setter))
}

fn labeled(measure: &RoundBar, note: Option<&TextLine>, sheet: &Sheet, setter: &mut Typesetter) -> Drawing {
    let face = TextStyle::upright(sheet.type_px(16.0), TextStyle::REGULAR);
    let figures = figures(&measure.length).map(|text| setter.line(&text, face));
    let unit = setter.line(&format!(" {}", unit(&measure.length).0), face);
    lay_out(measure, &figures, &unit, note, sheet)
}

fn lay_out(
    measure: &RoundBar,
    figures: &[TextLine; 3],
    unit: &TextLine,
    note: Option<&TextLine>,
    sheet: &Sheet,
) -> Drawing {
    let padding = sheet.padding();
    let size = figures[0].style.size_px;
    let left = padding.max((padding * 0.6 + figures[0].advance * 0.5).round());
    let baseline = padding + (size * CAP_HEIGHT).round();
    let top = baseline + (size * 0.42).round();
    let bar = PixelBox::at(Vec2::new(left, top), Vec2::new(measure.length_px, sheet.whole_px(8.0)));
    let note = note
        .map(|note| (note, Vec2::new(left, (bar.max.y + note.style.size_px * (CAP_HEIGHT + 0.55)).round())));
    let figures_right = bar.max.x + figures[2].advance * 0.5 + unit.advance;
    let right = note.map_or(figures_right, |(line, at)| figures_right.max(at.x + line.advance));
    let bottom = note.map_or(bar.max.y + padding, |(line, at)| {
        at.y + padding - (line.style.size_px * DESCENT * 0.3).round()
    });
    let mut drawing = Drawing::default();
    drawing.panel(
        PixelBox { min: Vec2::ZERO, max: Vec2::new((right + padding).ceil(), bottom) },
        sheet.hairline(),
    );
    draw_bar(&mut drawing, bar, sheet);
    let middle = |part: f32, line: &TextLine| bar.min.x + bar.size().x * part - line.advance * 0.5;
    let at: Vec<(&TextLine, Vec2)> = [0.0, 0.5, 1.0]
        .iter()
        .zip(figures)
        .map(|(&part, line)| (line, Vec2::new(middle(part, line).round(), baseline)))
        .collect();
    write(&mut drawing, &at, INK);
    let unit_x = at[2].1.x + figures[2].advance;
    write(&mut drawing, &[(unit, Vec2::new(unit_x, baseline))], INK);
    if let Some(note) = note {
        write(&mut drawing, &[note], SOFT_INK);
    }
    drawing
}

/// Black and white parts inside a black frame; every edge on a whole pixel.
fn draw_bar(drawing: &mut Drawing, bar: PixelBox, sheet: &Sheet) {
    drawing.rect(bar, INK);
    let line = sheet.hairline().round();
    let edge = |part: i64| bar.min.x + (bar.size().x * part as f32 / PARTS as f32).round();
    for part in (1..PARTS).step_by(2) {
        let end = if part + 1 == PARTS { bar.max.x - line } else { edge(part + 1) };
        let white =
            PixelBox { min: Vec2::new(edge(part), bar.min.y + line), max: Vec2::new(end, bar.max.y - line) };
        drawing.rect(white, PAPER);
    }
}

/// The figures at the start, the middle and the end.
fn figures(length: &NiceNumber) -> [String; 3] {
    let (_, meters_per_unit) = unit(length);
    let full = length.value() / meters_per_unit;
    let half = full * 0.5;
    let decimals = |value: f64| (0..=4).find(|&n| is_whole(value * [1.0, 10.0, 1e2, 1e3, 1e4][n]));
    ["0".to_owned(), format_number(half, decimals(half).unwrap_or(4)), format_number(full, decimals(full).unwrap_or(4))]
}

fn is_whole(value: f64) -> bool {
    (value - libm::round(value)).abs() < 1e-6
}

fn unit(length: &NiceNumber) -> (&'static str, f64) {
    if length.value() >= 1000.0 { ("km", 1000.0) } else { ("m", 1.0) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::{prop_assert, proptest};

    use super::*;

    fn bar(pixels_per_meter: f32) -> ScaleBar {
        ScaleBar { pixels_per_meter, distance_m: 12_400.0 }
    }

    #[test]
    fn a_bar_is_round_and_as_long_as_it_says() {
        let measure = measure(&bar(0.05), 260.0).expect("a scale");
        assert_eq!((measure.length.value(), measure.length_px), (5000.0, 250.0));
        assert_eq!(figures(&measure.length), ["0", "2.5", "5"]);
    }

    #[test]
    fn figures_are_exact_in_meters_and_kilometers() {
        let said = |meters: f64| {
            let length = NiceNumber::at_most(meters).expect("positive");
            (figures(&length)[1].clone(), figures(&length)[2].clone(), unit(&length).0)
        };
        assert_eq!(said(1000.0), ("0.5".to_owned(), "1".to_owned(), "km"));
        assert_eq!(said(500.0), ("250".to_owned(), "500".to_owned(), "m"));
        assert_eq!(said(5.0), ("2.5".to_owned(), "5".to_owned(), "m"));
        assert_eq!(said(0.5), ("0.25".to_owned(), "0.5".to_owned(), "m"));
        assert_eq!(said(20_000.0), ("10".to_owned(), "20".to_owned(), "km"));
    }

    #[test]
    fn a_scale_that_is_no_scale_has_no_bar() {
        for scale in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e30, 1e-30] {
            assert_eq!(measure(&bar(scale), 260.0), None, "{scale}");
        }
        for distance_m in [0.0, -5.0, f32::NAN, f32::INFINITY] {
            assert_eq!(measure(&ScaleBar { pixels_per_meter: 0.05, distance_m }, 260.0), None);
        }
    }

    #[test]
    fn the_black_of_the_bar_is_drawn_as_long_as_measured() {
        let sheet = Sheet::new(1920, 1080);
        let drawing = compose(&bar(0.0437), &sheet, &mut Typesetter::new()).expect("a bar");
        let expected = measure(&bar(0.0437), 260.0).expect("a scale").length_px;
        let black = drawing.marks().iter().find(|mark| mark.color == INK).expect("the bar comes first");
        assert_eq!(black.path.bounds().width(), expected);
    }

    proptest! {
        #[test]
        fn the_drawn_length_is_true_to_half_a_pixel(scale in 1e-5..1e4f32, longest in 50.0..600.0f32) {
            let measure = measure(&bar(scale), longest).expect("a scale");
            let exact = measure.length.value() * f64::from(scale);
            prop_assert!((f64::from(measure.length_px) - exact).abs() <= 0.5);
            prop_assert!(exact <= f64::from(longest) + 1e-3 && exact > f64::from(longest) / 2.5 - 1.0);
        }
    }
}
