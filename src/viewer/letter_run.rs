//! The letters of a name along a line: where they find room, and how they are painted.
//!
//! A name that is shown holds its place on the ground and the space between its letters, until they do not fit any more.

use egui::epaint::TextShape;
use egui::{Color32, Painter, Pos2, Rect, Shape, vec2};

use crate::line_piece::{LinePicture, NamePoint, along_at, pieces, point_at};
use crate::name_lines::{LineName, NameSide};
use sandtable_annotate::fonts::is_joined;
use sandtable_annotate::letter_course::{CourseLetter, LIMITS, LetterCourse, LetterLimits, SetLetter};

/// The limits of a name that is shown: what is shown stays until it is bad for good.
const HELD_LIMITS: LetterLimits = LetterLimits { most_turn: 0.65, most_bend: 2.4, most_lean: -0.4 };
/// Places tried along a piece for a name that is not shown.
const TRIED: usize = 7;
/// A name that is not shown needs this room around it, in points.
const NEW_MARGIN: f32 = 4.0;
/// The distance of a name beside its line, in heights of its letters.
const LIFT: f32 = 0.75;
/// How far the letters of an area's name are spread, as a share of its axis, and at the most in widths of the name.
const SPREAD: [f32; 2] = [0.6, 2.2];
/// The share by which the name of an area may be longer or shorter than its axis would have it before its letters move.
const SPREAD_SLACK: f32 = 0.3;
/// The share of the way to where they should be that they then move in a frame.
const SPREAD_EASE: f32 = 0.15;
/// Where letters are painted for their halo, in points.
const HALO: [(f32, f32); 4] = [(-1.1, -0.6), (1.1, 0.6), (0.6, -1.1), (-0.6, 1.1)];

/// A letter, or a word whose letters touch each other, on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct LineLetter {
    /// What is painted.
    pub text: String,
    /// The middle of its letters, points.
    pub center: Pos2,
    /// Clockwise from level, radians.
    pub angle: f32,
}

/// The place that a name keeps from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldPlace {
    /// Which of its lines.
    pub line: usize,
    /// Where along it on the ground, meters.
    pub station_m: f32,
    /// Whether it reads against the line.
    pub is_reversed: bool,
    /// How long it is, points; as wide as its letters where they are not spread.
    pub width: f32,
    /// Whether its letters are still moving apart or together.
    pub is_easing: bool,
}

/// The letters of a name at its held place or at another, with that place.
pub fn place(
    name: &LineName,
    held: Option<HeldPlace>,
    picture: &LinePicture<'_>,
    taken: &[Rect],
) -> Option<(HeldPlace, Vec<LineLetter>)> {
    let is_whole = is_joined(&name.text);
    let letters: Vec<String> =
        if is_whole { vec![name.text.clone()] } else { name.text.chars().map(String::from).collect() };
    let (widths, height) = (picture.widths)(&letters, &name.font);
    let own: f32 = widths.iter().sum();
    let is_free = |letters: &[LineLetter], margin: f32| {
        letters.iter().all(|letter| {
            let own = letter_box(letter, name.font.size).expand(margin);
            picture.rect.contains_rect(own) && !taken.iter().any(|other| other.intersects(own))
        })
    };
    let lift = if name.side == NameSide::Above { height * LIFT } else { 0.0 };
    for (number, line) in name.lines.iter().enumerate() {
        if held.is_some_and(|held| held.line != number) {
            continue;
        }
        for piece in pieces(line, picture) {
            let length = piece.last().map_or(0.0, |last| last.along);
            if length < own {
                continue;
            }
            let (width, is_easing) = match name.side {
                NameSide::Spread if !is_whole => spread_width(own, length, held.map(|held| held.width)),
                _ => (own, false),
            };
            let places: Vec<f32> = match held {
                _ if name.side == NameSide::Level => vec![length * 0.5],
                // Where the piece has become too short on a side, the name moves along it.
                Some(held) => {
                    let along = along_at(&piece, held.station_m);
                    along.map(|along| along.min(length - width * 0.5).max(width * 0.5)).into_iter().collect()
                }
                None => (0..TRIED).map(|tried| length * place_share(tried)).collect(),
            };
            let gap = (width - own) / letters.len().max(1) as f32;
            let run = LetterRun {
                letters: &letters,
                widths: &widths.iter().map(|width| width + gap).collect::<Vec<_>>(),
                lift,
                limits: if held.is_some() { HELD_LIMITS } else { LIMITS },
                was_reversed: held.is_some_and(|held| held.is_reversed),
            };
            for along in places {
                let Some((is_reversed, set)) = run.set(&piece, along) else { continue };
                let margin = if held.is_some() { -1.0 } else { NEW_MARGIN };
                let ends = [along - width * 0.5, along, along + width * 0.5];
                let is_seen = || ends.into_iter().all(|at| (picture.is_seen)(point_at(&piece, at).1));
                if is_free(&set, margin) && is_seen() {
                    let station_m = point_at(&piece, along).2;
                    return Some((HeldPlace { line: number, station_m, is_reversed, width, is_easing }, set));
                }
            }
        }
    }
    None
}

/// The length of an area's name along a piece of an axis, at least that of its letters and at most the piece's, and whether
/// it is on its way from the held one to another.
fn spread_width(own: f32, length: f32, held: Option<f32>) -> (f32, bool) {
    let wanted = (length * SPREAD[0]).min(own * SPREAD[1]).max(own);
    let Some(held) = held else { return (wanted, false) };
    let is_off = (wanted - held).abs() > SPREAD_SLACK * held;
    let width = if is_off { held + (wanted - held) * SPREAD_EASE } else { held };
    (width.min(length).max(own), is_off)
}

/// The share of a piece at which the middle of a name is tried: the middle first, then outward.
fn place_share(tried: usize) -> f32 {
    let step = tried.div_ceil(2) as f32 / (TRIED as f32 + 1.0);
    if tried.is_multiple_of(2) { 0.5 + step } else { 0.5 - step }
}

/// Letters that are set along a line.
struct LetterRun<'a> {
    letters: &'a [String],
    widths: &'a [f32],
    /// How far above the line, points.
    lift: f32,
    limits: LetterLimits,
    was_reversed: bool,
}

impl LetterRun<'_> {
    /// The letters with their middle at a length along a piece, so that they are read from the left; `None` where they
    /// reach past its ends or bend too much.
    fn set(&self, piece: &[NamePoint], middle: f32) -> Option<(bool, Vec<LineLetter>)> {
        let width: f32 = self.widths.iter().sum();
        let (start, end) = (middle - width * 0.5, middle + width * 0.5);
        // Rounding may put an end just past that of the piece.
        if start < -0.01 || end > piece[piece.len() - 1].along + 0.01 {
            return None;
        }
        let chord = point_at(piece, end).0 - point_at(piece, start).0;
        // What runs almost upward keeps its direction.
        let slack = if self.was_reversed { 0.15 } else { -0.15 } * width;
        let is_reversed = chord.x < slack;
        let mut from = -width * 0.5;
        let middles = self.widths.iter().map(|width| {
            let middle = from + width * 0.5;
            from += width;
            CourseLetter { middle, reach: (width * 0.5).max(2.0) }
        });
        let course = LetterCourse { station: middle, is_reversed, baseline: self.lift, limits: self.limits };
        let (set, _) = course.set(|along| point_at(piece, along).0.as_dvec2(), middles)?;
        let letter = |(text, set): (&String, &SetLetter)| LineLetter {
            text: text.clone(),
            center: Pos2::new(set.at.x, set.at.y),
            angle: set.along.to_angle(),
        };
        Some((is_reversed, self.letters.iter().zip(&set).map(letter).collect()))
    }
}

/// The box of a letter, whichever way it is turned.
pub fn letter_box(letter: &LineLetter, size: f32) -> Rect {
    Rect::from_center_size(letter.center, vec2(size * 0.9 * letter.text.chars().count() as f32, size * 0.9))
}

/// Paints a name's letters.
pub fn paint(painter: &Painter, name: &LineName, letters: &[LineLetter], opacity: f32) {
    let halo = Color32::from_rgb(250, 248, 240).gamma_multiply(opacity * 0.8);
    let ink = name.ink.gamma_multiply(opacity);
    let letter = |letter: &LineLetter, offset: (f32, f32), color: Color32| {
        let galley = painter.layout_no_wrap(letter.text.clone(), name.font.clone(), color);
        let half = galley.size() * 0.5;
        let (sin, cos) = letter.angle.sin_cos();
        let corner = vec2(half.x * cos - half.y * sin, half.x * sin + half.y * cos);
        let at = letter.center - corner + vec2(offset.0, offset.1);
        painter.add(Shape::Text(TextShape::new(at, galley, color).with_angle(letter.angle)));
    };
    for offset in HALO {
        letters.iter().for_each(|set| letter(set, offset, halo));
    }
    letters.iter().for_each(|set| letter(set, (0.0, 0.0), ink));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line_piece::tests::piece;

    fn run<'a>(letters: &'a [String], widths: &'a [f32]) -> LetterRun<'a> {
        LetterRun { letters, widths, lift: 6.0, limits: LIMITS, was_reversed: false }
    }

    #[test]
    fn letters_are_read_from_the_left_whichever_way_the_line_runs() {
        let (letters, widths) = (["a", "b", "c"].map(String::from), [10.0; 3]);
        for (points, reversed) in
            [([(0.0, 50.0), (100.0, 60.0)], false), ([(100.0, 60.0), (0.0, 50.0)], true)]
        {
            let (is_reversed, set) = run(&letters, &widths).set(&piece(&points), 50.0).expect("straight");
            assert_eq!(is_reversed, reversed);
            assert!(set[0].center.x < set[1].center.x && set[1].center.x < set[2].center.x, "{set:?}");
            assert!(set.iter().all(|letter| letter.angle.abs() < 0.2), "{set:?}");
            assert!(set.iter().all(|letter| letter.center.y < 55.0), "above the line: {set:?}");
        }
    }

    #[test]
    fn a_sharp_bend_and_a_short_line_take_no_name() {
        let (letters, widths) = (["a", "b", "c", "d"].map(String::from), [10.0; 4]);
        let bent = piece(&[(0.0, 0.0), (50.0, 0.0), (50.0, 60.0)]);
        assert!(run(&letters, &widths).set(&bent, 50.0).is_none());
        assert!(run(&letters, &widths).set(&bent, 22.0).is_some(), "beside the bend");
        assert!(run(&letters, &widths).set(&bent, 10.0).is_none(), "past its end");
    }

    #[test]
    fn spread_letters_stay_while_their_axis_changes_little_and_follow_it_slowly() {
        let (first, _) = spread_width(50.0, 100.0, None);
        assert!((first - 60.0).abs() < 1e-4, "{first}");
        let mut width = first;
        for step in 0..20u8 {
            // As when the camera comes nearer, and a vertex of the axis leaves the picture.
            let length = 100.0 + f32::from(step) * 0.8 - if step > 10 { 10.0 } else { 0.0 };
            let (next, is_easing) = spread_width(50.0, length, Some(width));
            assert_eq!((next, is_easing), (width, false), "at {length}");
            width = next;
        }
        let mut steps = Vec::new();
        while let (next, true) = spread_width(50.0, 260.0, Some(width)) {
            steps.push(next - width);
            width = next;
        }
        assert!(
            (1..60).contains(&steps.len()) && steps.iter().all(|&step| step > 0.0 && step < 8.0),
            "{steps:?}"
        );
        assert_eq!(spread_width(50.0, 60.0, Some(90.0)).0, 60.0, "never past the ends of its axis");
    }
}
