//! The diagram of the three norths: true, grid and magnetic, with the angles between them.
//!
//! The lines lean by their angles where those can be told apart, and by as much as can be where they are smaller: the
//! figures count, and a note says so. Norths whose figures are the same share a line.

use glam::Vec2;

use crate::composer::Composer;
use crate::drawing::{Drawing, polygon};
use crate::nice::format_number;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{INK, SOFT_INK};
use crate::text::{TextStyle, TypesetLine};

/// The length of a line, in design pixels.
const LENGTH: f32 = 64.0;
/// The most lean of a line that needs no more to be apart from others, degrees.
const MOST_LEAN: f32 = 32.0;
/// The angles between neighboring lines that are tried until nothing is over anything else, degrees.
const APART: [f32; 8] = [12.0, 16.0, 20.0, 24.0, 28.0, 32.0, 38.0, 44.0];
/// Half of the star's width, and the gaps from a line's tip to what stands beyond it, in design pixels.
const STAR: f32 = 6.5;
const GAP: f32 = 3.0;

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
    for north in arranged(norths, foot, composer) {
        let (PixelSegment { from, to }, width) = (north.line, sheet.px(1.4).max(1.0));
        drawing.line(north.line, width, INK);
        if north.is_magnetic
            && let Some(along) = (to - from).try_normalize()
        {
            let back = to - along * sheet.px(10.0) + along.perp() * sheet.px(4.5);
            drawing.line(PixelSegment { from: to, to: back }, width, INK);
        }
        if let Some(star) = north.star.and_then(|center| star(center, sheet.px(STAR))) {
            drawing.fill(star, INK);
        }
        if let Some((name, area)) = &north.name {
            drawing.write(name, Vec2::new(area.min.x, area.max.y).round(), INK);
        }
    }
    let style = composer.style(13.0, TextStyle::REGULAR);
    let x = (foot.x + length * 0.7).max(drawing.bounds().max.x + sheet.px(12.0));
    let mut baseline = foot.y - length * 0.82;
    for text in notes(norths) {
        let line = composer.line(&text, style);
        drawing.write(&line, Vec2::new(x, baseline).round(), SOFT_INK);
        drawing.record_text(&text, line.missing, line.shortened);
        baseline += style.size_px * 1.36;
    }
    drawing
}

/// A line of the diagram: one north, or several that are the same.
struct NorthLine {
    /// In minutes clockwise from true north.
    minutes: i64,
    is_true: bool,
    is_magnetic: bool,
    names: Vec<&'static str>,
}

/// A line of the diagram in its place.
struct ArrangedNorth {
    line: PixelSegment,
    is_magnetic: bool,
    /// The middle of the star of true north.
    star: Option<Vec2>,
    /// The name and the box of its letters, whose lower border is the baseline.
    name: Option<(TypesetLine, PixelBox)>,
}

impl ArrangedNorth {
    /// The boxes of star and name.
    fn boxes(&self, star: f32) -> impl Iterator<Item = PixelBox> {
        let star = self.star.map(|center| PixelBox::around(center, Vec2::splat(star)));
        star.into_iter().chain(self.name.as_ref().map(|(_, area)| *area))
    }
}

/// The lines in the order of their angles.
fn lines(norths: &ThreeNorths) -> Vec<NorthLine> {
    let mut lines = vec![NorthLine { minutes: 0, is_true: true, is_magnetic: false, names: Vec::new() }];
    for (name, angle) in [("GN", norths.grid_deg), ("MN", norths.magnetic_deg.map(|(east, _)| east))] {
        let Some(angle) = angle.filter(|angle| angle.is_finite()) else { continue };
        let (minutes, is_magnetic) = (whole_minutes(angle), name == "MN");
        match lines.iter_mut().find(|line| line.minutes == minutes) {
            Some(line) => {
                line.names.push(name);
                line.is_magnetic |= is_magnetic;
            }
            None => lines.push(NorthLine { minutes, is_true: false, is_magnetic, names: vec![name] }),
        }
    }
    lines.sort_by_key(|line| line.minutes);
    lines
}

/// The lines from `foot`, so far apart that no letter, star or line is over another.
fn arranged(norths: &ThreeNorths, foot: Vec2, composer: &mut Composer) -> Vec<ArrangedNorth> {
    let lines = lines(norths);
    let mut found = Vec::new();
    for apart in APART {
        found = leaning(&lines, &leans(&lines, apart), foot, composer);
        if is_clear(&found, composer) {
            break;
        }
    }
    found
}

/// The leans of lines in the order of their angles, degrees clockwise; neighbors at least `apart`.
fn leans(lines: &[NorthLine], apart: f32) -> Vec<f32> {
    let middle = lines.iter().position(|line| line.is_true).unwrap_or_default();
    let west = side_leans(lines[..middle].iter().rev(), apart);
    let east = side_leans(lines[middle + 1..].iter(), apart);
    west.into_iter().rev().map(|lean| -lean).chain([0.0]).chain(east).collect()
}

/// The leans of lines on one side of true north, the nearest first.
fn side_leans<'a>(lines: impl Iterator<Item = &'a NorthLine>, apart: f32) -> Vec<f32> {
    let leans = lines.scan(0.0f32, |before, line| {
        *before = (line.minutes.abs() as f32 / 60.0).min(MOST_LEAN).max(*before + apart);
        Some(*before)
    });
    leans.collect()
}

fn leaning(lines: &[NorthLine], leans: &[f32], foot: Vec2, composer: &mut Composer) -> Vec<ArrangedNorth> {
    let (sheet, style) = (composer.sheet, composer.style(13.0, TextStyle::MEDIUM));
    let (gap, star) = (sheet.px(GAP), sheet.px(STAR));
    let arrange = |(line, lean): (&NorthLine, &f32)| {
        let along = Vec2::new(libm::sinf(lean.to_radians()), -libm::cosf(lean.to_radians()));
        let tip = foot + along * sheet.px(LENGTH);
        let center = tip + along * (star + gap * 0.5);
        let beyond = if line.is_true { center + along * star } else { tip };
        let name = (!line.names.is_empty()).then(|| {
            let name = composer.line(&line.names.join(", "), style);
            let half = Vec2::new(name.advance, name.style.cap_px()) * 0.5;
            let area = PixelBox::around(beyond + along * (along.abs().dot(half) + gap), half);
            (name, area)
        });
        ArrangedNorth {
            line: PixelSegment { from: foot, to: tip },
            is_magnetic: line.is_magnetic,
            star: line.is_true.then_some(center),
            name,
        }
    };
    lines.iter().zip(leans).map(arrange).collect()
}

/// Whether no star or name is over another, or over a line that is not its own.
fn is_clear(norths: &[ArrangedNorth], composer: &Composer) -> bool {
    let (star, space) = (composer.sheet.px(STAR), composer.sheet.px(1.5));
    norths.iter().enumerate().all(|(index, north)| {
        north.boxes(star).all(|own| {
            let own = own.grown(space);
            let mut others = norths.iter().enumerate().filter(|(other, _)| *other != index);
            others.all(|(_, other)| {
                !own.meets(&other.line) && other.boxes(star).all(|area| !area.grown(space).overlaps(&own))
            })
        })
    })
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

/// An angle in minutes, as it is written.
fn whole_minutes(east_deg: f64) -> i64 {
    libm::round(east_deg * 60.0) as i64
}

/// An angle in degrees and minutes, with its side.
fn signed(east_deg: f64) -> String {
    let minutes = whole_minutes(east_deg);
    let side = match minutes {
        0 => "",
        ..0 => " W",
        _ => " E",
    };
    let minutes = minutes.abs();
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

    fn norths(grid_deg: f64, magnetic_deg: f64) -> ThreeNorths {
        ThreeNorths {
            grid_deg: Some(grid_deg),
            magnetic_deg: Some((magnetic_deg, 0.3)),
            magnetic_note: String::new(),
        }
    }

    #[test]
    fn whatever_the_angles_no_letter_is_over_another_or_over_a_line() {
        let angles = [-170.0, -66.0, -9.0, -1.7, -0.02, 0.0, 0.004, 0.5, 4.3, 11.5, 12.0, 44.0, 65.9, 179.0];
        for size in [(1920, 1080), (480, 270), (1754, 1240), (1240, 1754), (4961, 3508)] {
            let mut composer = Composer::new(size.0, size.1);
            for (grid, magnetic) in angles.iter().flat_map(|&grid| angles.map(|magnetic| (grid, magnetic))) {
                let found = arranged(&norths(grid, magnetic), Vec2::splat(400.0), &mut composer);
                assert!(is_clear(&found, &composer), "GN {grid}, MN {magnetic} on {size:?}");
            }
        }
    }

    #[test]
    fn norths_that_are_the_same_share_a_line_and_the_others_keep_their_order() {
        let names = |grid: f64, magnetic: f64| -> Vec<String> {
            lines(&norths(grid, magnetic))
                .iter()
                .map(|line| format!("{}{}", if line.is_true { "★" } else { "" }, line.names.join(", ")))
                .collect()
        };
        assert_eq!(names(0.0, 4.33), ["★GN", "MN"]);
        assert_eq!(names(-0.004, -6.0), ["MN", "★GN"]);
        assert_eq!(names(65.9, 22.0), ["★", "MN", "GN"]);
        assert_eq!(names(2.0, 2.001), ["★", "GN, MN"]);
        assert_eq!(names(-3.0, 5.0), ["GN", "★", "MN"]);
        let leans = |grid: f64, magnetic: f64| leans(&lines(&norths(grid, magnetic)), 16.0);
        assert_eq!(leans(65.9, 22.0), [0.0, 22.0, 38.0]);
        assert_eq!(leans(-1.0, 0.5), [-16.0, 0.0, 16.0]);
        assert_eq!(leans(-20.0, -30.0), [-36.0, -20.0, 0.0]);
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
