//! The scale bar: a nice length, and the distance at which it is true, lower left.
//!
//! A perspective picture has no single scale. The bar states its distance from the eye, and is correct to half a pixel
//! there for lines across the view. A picture by parallel rays has one, which is stated as a map's: `1:25 000 at 96 dpi`.
//!
//! ```text
//!  0        2.5        5 km
//!  ██████▒▒▒▒▒▒██████▒▒▒▒▒▒
//!  at 12.4 km from the eye
//! ```

use glam::Vec2;

use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::nice::{NiceNumber, format_distance, format_number, format_trimmed, grouped};
use crate::pixel_box::PixelBox;
use crate::sheet::{INK, PAPER, SOFT_INK, Sheet};
use crate::text::{CAP_HEIGHT, DESCENT, TextStyle, TypesetLine};
use sandtable_view::camera::Camera;

/// Longest bar, in design pixels. Nice lengths are at most 2.5 times apart, so that bars are at least 104 long.
const LONGEST: f32 = 260.0;
/// Parts of the bar, alternating black and white; even, so that the middle is an edge.
const PARTS: i64 = 4;

/// The scale of a picture at one distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleBar {
    /// Pixels that one meter across the view spans there.
    pub pixels_per_meter: f32,
    /// The part of the picture where the scale is true; printed under the bar.
    pub holds: ScaleExtent,
}

/// The part of a picture where a scale is true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScaleExtent {
    /// At a distance from the eye, in meters.
    Distance(f32),
    /// Everywhere.
    Everywhere(MapScale),
}

/// The scale of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapScale {
    /// `n` of 1:n.
    pub denominator: f64,
    /// Pixels per inch of the print on which it is true.
    pub dpi: f32,
}

impl ScaleExtent {
    fn is_sound(&self) -> bool {
        match *self {
            Self::Distance(distance_m) => distance_m.is_finite() && distance_m > 0.0,
            Self::Everywhere(MapScale { denominator, dpi }) => {
                denominator.is_finite() && denominator > 0.0 && dpi.is_finite() && dpi > 0.0
            }
        }
    }

    /// The note under the bar.
    fn note(&self) -> String {
        match *self {
            Self::Distance(distance_m) => format!("at {} from the eye", format_distance(distance_m.into())),
            Self::Everywhere(MapScale { denominator, dpi }) => {
                let dpi = format_trimmed(f64::from(dpi), 1);
                format!("1:{} at {dpi} dpi", grouped(&format_number(denominator, 0)))
            }
        }
    }
}

impl ScaleBar {
    /// The scale of `camera` at `distance_m` meters along its viewing direction.
    pub fn at_distance(camera: &Camera, distance_m: f32) -> Self {
        let holds = ScaleExtent::Distance(distance_m);
        Self { pixels_per_meter: camera.pixels_per_meter(distance_m), holds }
    }

    /// The scale of all of the picture of `camera`; `None` in perspective.
    pub fn of_map(camera: &Camera) -> Option<Self> {
        let dpi = camera.parallel_frame()?.dpi;
        let scale = MapScale { denominator: camera.scale_denominator()?, dpi };
        Some(Self { pixels_per_meter: camera.pixels_per_meter(1.0), holds: ScaleExtent::Everywhere(scale) })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct NiceBar {
    /// Its length in meters.
    length: NiceNumber,
    /// Its drawn length, in whole pixels.
    length_px: f32,
}

/// The longest nice bar of at most `longest_px`; `None` where the scale is not a positive number or the bar would be
/// shorter than a millimeter or longer than a hundred thousand kilometers.
fn measure(bar: &ScaleBar, longest_px: f32) -> Option<NiceBar> {
    let scale = f64::from(bar.pixels_per_meter);
    let is_sound = scale > 0.0 && bar.holds.is_sound();
    let length = NiceNumber::at_most(f64::from(longest_px) / scale).filter(|_| is_sound)?;
    let is_sensible = (1e-3..=1e8).contains(&length.value());
    let length_px = libm::round(length.value() * scale) as f32;
    (is_sensible && length_px > 0.0).then_some(NiceBar { length, length_px })
}

/// The scale bar on its panel with the upper left corner at the origin, and `grid` under its note; `None` where the scale
/// is unusable.
pub(crate) fn compose(bar: &ScaleBar, grid: Option<&str>, composer: &mut Composer) -> Option<Drawing> {
    let measure = measure(bar, composer.sheet.px(LONGEST))?;
    let style = composer.style(14.0, TextStyle::REGULAR);
    let mut notes = vec![composer.line(&bar.holds.note(), style)];
    notes.extend(grid.map(|grid| composer.line(grid, style)));
    Some(lay_out(&measure, &notes, composer))
}

/// The scale bar of a map, which has one scale everywhere; otherwise as [`compose`], no longer than `longest_px`.
pub(crate) fn compose_on_map(
    pixels_per_meter: f32,
    longest_px: f32,
    composer: &mut Composer,
) -> Option<Drawing> {
    let measure = measure(&ScaleBar { pixels_per_meter, holds: ScaleExtent::Distance(1.0) }, longest_px)?;
    Some(lay_out(&measure, &[], composer))
}

fn lay_out(measure: &NiceBar, notes: &[TypesetLine], composer: &mut Composer) -> Drawing {
    let style = composer.style(16.0, TextStyle::REGULAR);
    let figures = figures(&measure.length).map(|text| composer.line(&text, style));
    let unit = composer.line(&format!(" {}", unit(&measure.length).0), style);
    let sheet = composer.sheet;
    let padding = sheet.padding();
    let left = padding.max((padding * 0.6 + figures[0].advance * 0.5).round());
    let baseline = padding + style.cap_px().round();
    let top = baseline + (style.size_px * 0.42).round();
    let bar = PixelBox::at(Vec2::new(left, top), Vec2::new(measure.length_px, sheet.whole_px(8.0)));
    let mut corner = Vec2::new(bar.max.x + figures[2].advance * 0.5 + unit.advance, bar.max.y + padding);
    let mut drawing = Drawing::default();
    draw_bar(&mut drawing, bar, &sheet);
    let mut figures_right = 0.0;
    for (part, figure) in [0.0, 0.5, 1.0].into_iter().zip(&figures) {
        let x = (bar.min.x + bar.size().x * part - figure.advance * 0.5).round();
        drawing.write(figure, Vec2::new(x, baseline), INK);
        figures_right = x + figure.advance;
    }
    drawing.write(&unit, Vec2::new(figures_right, baseline), INK);
    for (number, note) in notes.iter().enumerate() {
        let size_px = note.style.size_px;
        let below = CAP_HEIGHT + 0.55 + 1.3 * number as f32;
        let at = Vec2::new(left, (bar.max.y + size_px * below).round());
        drawing.write(note, at, SOFT_INK);
        let bottom = at.y + padding - (size_px * DESCENT * 0.3).round();
        corner = Vec2::new(corner.x.max(at.x + note.advance), bottom);
    }
    drawing.on_panel(Vec2::new((corner.x + padding).ceil(), corner.y), &sheet)
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

fn figures(length: &NiceNumber) -> [String; 3] {
    let full = length.value() / unit(length).1;
    let is_integer = |value: f64| (value - libm::round(value)).abs() < 1e-6;
    let figure = |value: f64| {
        let decimals = (0..=4).find(|&n| is_integer(value * [1.0, 10.0, 1e2, 1e3, 1e4][n]));
        format_number(value, decimals.unwrap_or(4))
    };
    ["0".to_owned(), figure(full * 0.5), figure(full)]
}

/// The unit of a length, and its meters.
fn unit(length: &NiceNumber) -> (&'static str, f64) {
    if length.value() >= 1000.0 { ("km", 1000.0) } else { ("m", 1.0) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::{prop_assert, proptest};

    use super::*;

    fn bar(pixels_per_meter: f32) -> ScaleBar {
        ScaleBar { pixels_per_meter, holds: ScaleExtent::Distance(12_400.0) }
    }

    #[test]
    fn a_bar_is_round_and_as_long_as_it_says() {
        let measure = measure(&bar(0.05), 260.0).expect("a scale");
        assert_eq!((measure.length.value(), measure.length_px), (5000.0, 250.0));
        assert_eq!(figures(&measure.length), ["0", "2.5", "5"]);
    }

    #[test]
    fn figures_are_exact_in_meters_and_kilometers() {
        let figures_and_unit = |meters: f64| {
            let length = NiceNumber::at_most(meters).expect("positive");
            (figures(&length)[1].clone(), figures(&length)[2].clone(), unit(&length).0)
        };
        assert_eq!(figures_and_unit(1000.0), ("0.5".to_owned(), "1".to_owned(), "km"));
        assert_eq!(figures_and_unit(500.0), ("250".to_owned(), "500".to_owned(), "m"));
        assert_eq!(figures_and_unit(5.0), ("2.5".to_owned(), "5".to_owned(), "m"));
        assert_eq!(figures_and_unit(0.5), ("0.25".to_owned(), "0.5".to_owned(), "m"));
        assert_eq!(figures_and_unit(20_000.0), ("10".to_owned(), "20".to_owned(), "km"));
    }

    #[test]
    fn a_map_states_its_scale_and_the_resolution_at_which_it_is_true() {
        let note = |denominator, dpi| ScaleExtent::Everywhere(MapScale { denominator, dpi }).note();
        assert_eq!(note(25_000.000_3, 96.0), "1:25 000 at 96 dpi");
        assert_eq!(note(500.0, 72.5), "1:500 at 72.5 dpi");
    }

    #[test]
    fn a_scale_that_is_no_scale_has_no_bar() {
        for scale in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e30, 1e-30] {
            assert_eq!(measure(&bar(scale), 260.0), None, "{scale}");
        }
        for distance_m in [0.0, -5.0, f32::NAN, f32::INFINITY] {
            assert_eq!(
                measure(
                    &ScaleBar { pixels_per_meter: 0.05, holds: ScaleExtent::Distance(distance_m) },
                    260.0
                ),
                None
            );
        }
    }

    #[test]
    fn the_black_of_the_bar_is_drawn_as_long_as_measured() {
        let drawing = compose(&bar(0.0437), None, &mut Composer::new(1920, 1080)).expect("a bar");
        let expected = measure(&bar(0.0437), 260.0).expect("a scale").length_px;
        let black = drawing.marks.iter().find(|mark| mark.color == INK).expect("the bar comes first");
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
