//! Numbers on contour lines, one above the other up a slope, and the ticks of hollows.
//!
//! A number stands in a break of its line, its top uphill; where that would be upside down, another place along the line
//! is taken or none. Numbers come after all names: a reader misses a name sooner.

use glam::Vec2;

use crate::annotation::{ContourMarks, LineLabel, LinePlacement, NumberedContour};
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::label_style::LineStyle;
use crate::line_label::{LetterTop, PreparedLine};
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::place::{LabelPlacer, LabelRequest};
use crate::report::SheetBox;
use sandtable_description::words::LabelKind;
use sandtable_draw::pixels::Pixels;

/// Rings narrower and lower than this carry no number, in pixels.
const LEAST_RING_PX: f32 = 20.0;
/// Numbers drawn on a picture; more would be a table.
const MOST_NUMBERS: usize = 80;
/// Lines tried, the longest first.
const MOST_LINES: usize = 400;
/// Numbers of neighboring lines within this distance stand in one ladder, in design pixels, and how far aside counts as
/// much as nothing in reach.
const LADDER_PX: f32 = 170.0;
const ASIDE_PX: f32 = 40.0;
/// Numbers of one line stand no nearer to each other, in design pixels.
const APART_PX: f32 = 420.0;

/// Draws ticks, and numbers where the placer has a free place.
pub fn draw_contours(
    marks: &ContourMarks,
    placer: &mut LabelPlacer<'_>,
    ground: &Pixels,
    composer: &mut Composer,
    boxes: &mut Vec<SheetBox>,
) -> Drawing {
    let mut drawing = Drawing::default();
    let sheet = composer.sheet;
    for &[from, to] in &marks.ticks {
        let area = PixelBox { min: from.min(to), max: from.max(to) }.grown(sheet.px(1.5));
        if !placer.is_clear(&area) {
            continue;
        }
        drawing.line(PixelSegment { from, to }, sheet.px(1.2).max(1.0), marks.color);
    }
    let style = LineStyle::contour(marks.color, composer);
    let mut placed: Vec<PlacedNumber> = Vec::new();
    for contour in by_length(&marks.numbered) {
        if placed.len() == MOST_NUMBERS {
            break;
        }
        let label = line_label(contour);
        let Some(line) = PreparedLine::with_style(&label, style, composer) else { continue };
        for occurrence in 0..line.count() {
            let tops: Vec<LetterTop> = line.tops(occurrence).collect();
            let mut order: Vec<(f32, usize)> = (tops.iter().enumerate())
                .filter(|(_, top)| !is_near_own(top, contour.level, &placed, sheet.px(APART_PX)))
                .map(|(index, top)| {
                    let ladder =
                        off_ladder(top, contour.level, &placed, sheet.px(LADDER_PX), sheet.px(ASIDE_PX));
                    (ladder + index as f32 / tops.len() as f32, index)
                })
                .collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            let candidates = line.request(occurrence).candidates;
            let candidates = order.iter().map(|(_, index)| candidates[*index].clone()).collect();
            let request = LabelRequest { candidates, reserved: None };
            if let Some(chosen) = placer.place(std::slice::from_ref(&request))[0] {
                let choice = order[chosen].1;
                boxes.extend(SheetBox::of(&contour.text, &request.candidates[chosen]));
                line.draw_in_break(occurrence, choice, ground, &mut drawing);
                placed.push(PlacedNumber { level: contour.level, top: tops[choice] });
            }
        }
    }
    drawing
}

struct PlacedNumber {
    level: i64,
    top: LetterTop,
}

/// The lines that may carry numbers, the longest first; rings that are small are none of them.
fn by_length(contours: &[NumberedContour]) -> Vec<&NumberedContour> {
    let length =
        |line: &NumberedContour| line.path_px.windows(2).map(|leg| leg[0].distance(leg[1])).sum::<f32>();
    let mut lines: Vec<(f32, &NumberedContour)> =
        contours.iter().filter(|line| !is_small_ring(line)).map(|line| (length(line), line)).collect();
    lines.sort_by(|a, b| b.0.total_cmp(&a.0));
    lines.into_iter().take(MOST_LINES).map(|(_, line)| line).collect()
}

fn is_small_ring(line: &NumberedContour) -> bool {
    let is_ring = line.path_px.first() == line.path_px.last();
    let bounds = line
        .path_px
        .iter()
        .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(min, max), at| (min.min(*at), max.max(*at)));
    is_ring && (bounds.1 - bounds.0).min_element() < LEAST_RING_PX
}

fn line_label(contour: &NumberedContour) -> LineLabel {
    LineLabel {
        text: contour.text.clone(),
        path_px: vec![contour.path_px.clone()],
        half_width_px: 0.0,
        placement: LinePlacement::Uphill,
        kind: LabelKind::Road,
        ink: None,
        rank: 0.0,
        size: 1.0,
        shield: None,
        fallback: None,
    }
}

fn is_near_own(top: &LetterTop, level: i64, placed: &[PlacedNumber], apart: f32) -> bool {
    placed.iter().any(|other| other.level == level && other.top.at.distance(top.at) < apart)
}

/// How far a place is aside of the numbers of the next lines up and down, 0..=1; 0.6 where none is in reach.
fn off_ladder(top: &LetterTop, level: i64, placed: &[PlacedNumber], reach: f32, aside: f32) -> f32 {
    let near = placed.iter().filter(|other| (other.level - level).abs() == 1);
    let off = near.filter_map(|other| {
        let way = other.top.at - top.at;
        (way.length() < reach).then(|| (way.perp_dot(top.up).abs() / aside).min(1.0))
    });
    off.fold(0.6, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::LabelField;
    use sandtable_draw::color::Srgba;

    const BROWN: Srgba = Srgba([112, 74, 40, 150]);

    /// Level lines across the picture, each 60 px above the one below it, uphill upward.
    fn slope(lines: i64) -> ContourMarks {
        let line = |level: i64| NumberedContour {
            text: format!("{}", level * 50),
            level,
            path_px: (0..=96).map(|n| Vec2::new(n as f32 * 20.0, 900.0 - 60.0 * level as f32)).collect(),
        };
        ContourMarks { numbered: (1..=lines).map(line).collect(), ticks: Vec::new(), color: BROWN }
    }

    fn drawn(marks: &ContourMarks) -> Drawing {
        let mut composer = Composer::new(1920, 1080);
        let ground = Pixels::filled(1920, 1080, Srgba::opaque(150, 180, 130));
        let bounds = PixelBox { min: Vec2::ZERO, max: Vec2::new(1920.0, 1080.0) };
        let field = LabelField { bounds, taken: Vec::new(), leader_gap: 5.0 };
        draw_contours(marks, &mut LabelPlacer::new(&field), &ground, &mut composer, &mut Vec::new())
    }

    /// The boxes of the numbers: every second mark is a patch.
    fn numbers(drawing: &Drawing) -> Vec<PixelBox> {
        drawing.marks.iter().step_by(2).map(|mark| crate::drawing::box_of(&mark.path)).collect()
    }

    #[test]
    fn numbers_of_a_slope_stand_in_ladders_and_upright() {
        let boxes = numbers(&drawn(&slope(6)));
        assert!(boxes.len() >= 6, "{}", boxes.len());
        for one in &boxes {
            let neighbors = boxes.iter().filter(|other| {
                let way = other.center() - one.center();
                (50.0..70.0).contains(&way.y.abs()) && way.x.abs() < 40.0
            });
            assert!(neighbors.count() > 0, "{one:?} is in no ladder");
            assert!(one.size().x > one.size().y);
        }
    }

    #[test]
    fn a_line_whose_uphill_side_is_below_it_carries_no_number_upside_down() {
        let mut marks = slope(3);
        marks.numbered.iter_mut().for_each(|line| line.path_px.reverse());
        assert!(drawn(&marks).marks.is_empty());
    }

    #[test]
    fn small_rings_carry_no_number_and_large_ones_do() {
        let ring = |radius: f32| {
            let at = |n: i32| {
                Vec2::new(900.0, 500.0)
                    + Vec2::from_angle(n as f32 * 0.1 * std::f32::consts::PI / 5.0) * radius
            };
            let mut path_px: Vec<Vec2> = (0..100).map(at).collect();
            path_px.push(path_px[0]);
            ContourMarks {
                numbered: vec![NumberedContour { text: "5".to_owned(), level: 1, path_px }],
                ticks: Vec::new(),
                color: BROWN,
            }
        };
        assert!(drawn(&ring(9.0)).marks.is_empty());
        assert!(!drawn(&ring(120.0)).marks.is_empty());
    }
}
