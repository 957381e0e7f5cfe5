//! A name along a line: the line is smoothed, and each letter is turned with it.
//!
//! ```text
//!               r F o r
//!           a e         k        letters stand on the smoothed line moved upward by its half width and a gap,
//!        C l   ╭──────╮          each turned by the line's direction under it
//!      ───────╯        ╰────
//! ```
//!
//! The name reads from left to right wherever it is, upward on an upright line. Where the line turns faster than letters
//! can follow, the next place along it is tried; of the places near a wished one the straightest is taken first.

use glam::Vec2;
use tiny_skia::{PathBuilder, Transform};

use crate::annotation::{LineLabel, LinePlacement};
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::halo::Halo;
use crate::label_style::LineStyle;
use crate::letter_course::{CourseLetter, LIMITS, LetterCourse, SetLetter};
use crate::paragraph::written_lines;
use crate::pixel_box::PixelBox;
use crate::place::{LabelCandidate, LabelRequest, TextAlignment};
use crate::sheet::Sheet;
use crate::shield;
use crate::text::{CAP_HEIGHT, DESCENT, TypesetLetters};
use sandtable_draw::pixels::Pixels;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::rect::Rect;
use sandtable_geom::smooth::smoothed;

/// A repeated name stands once in so much of the picture's width. Smaller, and names crowd the map; larger, and a reader
/// loses the river that he follows.
const REPEAT_SHARE: f32 = 0.4;
/// A name is repeated at most so often.
const MOST_REPEATS: usize = 6;
/// Bends narrower than this many ems are smoothed away before letters are set.
const SMOOTH_EMS: f64 = 1.2;
/// The vertices of a smoothed line.
const MOST_VERTICES: usize = 4000;
/// Longer paths are not followed: vertices of a line label.
const MOST_GIVEN: usize = 100_000;
/// Places tried for one occurrence of a name, and their distance in ems.
const MOST_TRIES: usize = 25;
const TRY_EMS: f32 = 0.9;
/// The gap between the line's edge and the letters, in ems.
const GAP_EMS: f32 = 0.22;
/// The share of its line over which a spread name reaches, and the most space between its letters in ems.
const SPREAD_SHARE: f32 = 0.7;
const MOST_SPREAD_EMS: f32 = 1.6;

/// A name along a line with its letters set.
pub struct PreparedLine<'a> {
    pub label: &'a LineLabel,
    pub missing: usize,
    style: LineStyle,
    letters: TypesetLetters,
    /// The places wished, the best first.
    occurrences: Vec<Vec<LineCandidate>>,
}

/// A way to set a name.
struct LineCandidate {
    letters: Vec<SetLetter>,
    boxes: LabelCandidate,
}

/// A place of letters, and the direction of their tops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LetterTop {
    pub at: Vec2,
    pub up: Vec2,
}

impl<'a> PreparedLine<'a> {
    /// The name with the places where it may stand; `None` where it has no letters.
    pub fn new(label: &'a LineLabel, composer: &mut Composer) -> Option<Self> {
        let style = LineStyle::new(label, composer);
        Self::with_style(label, style, composer)
    }

    /// As [`PreparedLine::new`], in a style of its own.
    pub fn with_style(label: &'a LineLabel, style: LineStyle, composer: &mut Composer) -> Option<Self> {
        let text = written_lines(&label.text, usize::MAX).0.join(" ");
        let mut letters = composer.letters(&text, style.text);
        if letters.letters.iter().all(|letter| letter.outline.is_none()) || !letters.advance.is_finite() {
            return None;
        }
        let bounds = composer.sheet.bounds();
        let pieces = smooth_pieces(&label.path_px, &bounds, style.text.size_px);
        let (space, interval) = (composer.sheet.px(1.0), composer.sheet.size.x * REPEAT_SHARE);
        let is_spread = label.placement == LinePlacement::Spread && !letters.is_joined;
        // Letters are spaced for one piece: the first along which they can stand.
        let groups: Vec<&[Polyline]> = if is_spread { pieces.chunks(1).collect() } else { vec![&pieces[..]] };
        let mut occurrences = Vec::new();
        for group in groups {
            let mut spaced = letters.clone();
            if is_spread {
                spread(&mut spaced, group[0].length() as f32, style.text.size_px);
            }
            let setter = LineSetter { label, style: &style, letters: &spaced, space };
            occurrences = setter.occurrences(group, interval);
            if !occurrences.is_empty() {
                letters = spaced;
                break;
            }
        }
        Some(Self { label, missing: letters.missing, style, letters, occurrences })
    }

    /// The number of times that the name may be repeated along its line.
    pub fn count(&self) -> usize {
        self.occurrences.len()
    }

    /// The possible places of one repetition of the name: the position of its middle letter, and the direction of that
    /// letter's top.
    pub fn tops(&self, occurrence: usize) -> impl Iterator<Item = LetterTop> {
        self.occurrences[occurrence].iter().map(|one| {
            let middle = one.letters[one.letters.len() / 2];
            LetterTop { at: middle.at, up: Vec2::new(middle.along.y, -middle.along.x) }
        })
    }

    /// The placement request for one repetition of the name.
    pub fn request(&self, occurrence: usize) -> LabelRequest {
        let candidates = self.occurrences[occurrence].iter().map(|one| one.boxes.clone()).collect();
        LabelRequest { candidates, reserved: None }
    }

    /// The area of the sheet that one repetition of the name covers.
    pub fn candidate(&self, occurrence: usize, choice: usize) -> &LabelCandidate {
        &self.occurrences[occurrence][choice].boxes
    }

    pub fn draw(
        &self,
        occurrence: usize,
        choice: usize,
        ground: &Pixels,
        sheet: &Sheet,
        drawing: &mut Drawing,
    ) {
        let area = self.occurrences[occurrence][choice].boxes.text;
        if let Some(shield) = self.label.shield {
            shield::draw(shield, area, sheet, drawing);
        }
        let halo = Halo::over(ground, &area, self.style.ink, self.style.halo);
        self.draw_on(halo, occurrence, choice, drawing);
    }

    /// As [`PreparedLine::draw`], on a patch of the ground's tone that breaks the line.
    pub fn draw_in_break(&self, occurrence: usize, choice: usize, ground: &Pixels, drawing: &mut Drawing) {
        let area = self.occurrences[occurrence][choice].boxes.text;
        let halo = Halo::patch(ground, &area, self.style.ink, self.style.halo);
        self.draw_on(halo, occurrence, choice, drawing);
    }

    fn draw_on(&self, halo: Halo, occurrence: usize, choice: usize, drawing: &mut Drawing) {
        let mut outline = PathBuilder::new();
        let chosen = &self.occurrences[occurrence][choice];
        for (letter, place) in self.letters.letters.iter().zip(&chosen.letters) {
            let (along, at) = (place.along, place.at);
            let turn = Transform::from_row(along.x, along.y, -along.y, along.x, at.x, at.y);
            if let Some(path) = letter.outline.clone().and_then(|path| path.transform(turn)) {
                outline.push_path(&path);
            }
        }
        if let Some(path) = outline.finish() {
            drawing.fill_haloed(path, self.style.ink, halo);
        }
    }
}

/// The parts of `path` on the picture, smoothed for letters of `size_px`, the longest first.
fn smooth_pieces(path: &[Vec<Vec2>], bounds: &PixelBox, size_px: f32) -> Vec<Polyline> {
    let rect = Rect { min: bounds.min.as_dvec2(), max: bounds.max.as_dvec2() };
    let size = f64::from(size_px);
    let lines = path.iter().filter_map(|piece| {
        Polyline::new(piece.iter().take(MOST_GIVEN).map(|at| at.as_dvec2()), size * 0.05)
    });
    let clipped = lines.flat_map(|line| line.clip(&rect));
    let long = clipped.filter(|line| line.length() > size);
    let mut pieces: Vec<Polyline> =
        long.map(|line| smoothed(&line, size * 0.2, size * SMOOTH_EMS, MOST_VERTICES)).collect();
    pieces.sort_by(|a, b| b.length().total_cmp(&a.length()));
    pieces
}

/// Spaces the letters so that they reach over most of `length`.
fn spread(letters: &mut TypesetLetters, length: f32, size_px: f32) {
    let gaps = letters.letters.len().saturating_sub(1).max(1) as f32;
    let space = ((length * SPREAD_SHARE - letters.advance) / gaps).clamp(0.0, MOST_SPREAD_EMS * size_px);
    for (number, letter) in letters.letters.iter_mut().enumerate() {
        letter.middle += number as f32 * space;
    }
    letters.advance += space * gaps;
}

/// Sets the letters of a name at stations of lines.
struct LineSetter<'a> {
    label: &'a LineLabel,
    style: &'a LineStyle,
    letters: &'a TypesetLetters,
    /// Space kept around the halo.
    space: f32,
}

/// Where on a piece the middle of a name is wished, and how far it may be moved from there.
struct WishedStation {
    station: f32,
    slack: f32,
}

impl LineSetter<'_> {
    fn occurrences(&self, pieces: &[Polyline], interval: f32) -> Vec<Vec<LineCandidate>> {
        let mut occurrences = Vec::new();
        for piece in pieces {
            for wished in self.wished_stations(piece.length() as f32, interval) {
                let candidates = self.candidates(piece, &wished);
                if !candidates.is_empty() {
                    occurrences.push(candidates);
                }
                let most = match self.label.placement {
                    LinePlacement::Once | LinePlacement::Spread => 1,
                    LinePlacement::Repeated | LinePlacement::Ends | LinePlacement::Uphill => MOST_REPEATS,
                };
                if occurrences.len() == most {
                    return occurrences;
                }
            }
        }
        occurrences
    }

    /// The stations on a piece of `length`, the middle one first; none where the name is longer.
    fn wished_stations(&self, length: f32, interval: f32) -> Vec<WishedStation> {
        let half = (self.letters.advance + self.style.text.size_px * 0.4) * 0.5;
        let slack = length * 0.5 - half;
        if slack < 0.0 {
            return Vec::new();
        }
        match self.label.placement {
            LinePlacement::Once | LinePlacement::Spread => {
                vec![WishedStation { station: length * 0.5, slack }]
            }
            LinePlacement::Ends => {
                let slack = slack.min(half);
                let mut ends = vec![half + slack];
                if length > 6.0 * half {
                    ends.push(length - half - slack);
                }
                ends.into_iter().map(|station| WishedStation { station, slack }).collect()
            }
            LinePlacement::Repeated | LinePlacement::Uphill => {
                let count = ((length / interval) as usize).clamp(1, MOST_REPEATS);
                let share = length / count as f32;
                // A name keeps out of the outer fifths of its share, so that two never come close.
                let slack = if count == 1 { slack } else { (share * 0.3).min(slack) };
                let mut order: Vec<usize> = (0..count).collect();
                order.sort_by_key(|&number| (2 * number + 1).abs_diff(count));
                let at = |number: usize| (number as f32 + 0.5) * share;
                order.into_iter().map(|number| WishedStation { station: at(number), slack }).collect()
            }
        }
    }

    /// The ways to set the name near a station, the straightest and nearest first.
    fn candidates(&self, piece: &Polyline, wished: &WishedStation) -> Vec<LineCandidate> {
        let step = self.style.text.size_px * TRY_EMS;
        let tries = ((wished.slack / step) as usize).min(MOST_TRIES / 2) as i32;
        let step = if tries == 0 { 0.0 } else { (wished.slack / tries as f32).max(step).min(3.0 * step) };
        let mut weighed: Vec<(f32, LineCandidate)> = Vec::new();
        for number in -tries..=tries {
            let shift = number as f32 * step;
            for (rank, baseline) in self.baselines().into_iter().enumerate() {
                let Some((letters, bend)) = self.set(piece, wished.station + shift, baseline) else {
                    continue;
                };
                let off = shift.abs() / (wished.slack + step).max(1.0);
                weighed.push((bend + 0.5 * off + 0.7 * rank as f32, self.candidate(letters)));
            }
        }
        weighed.sort_by(|a, b| a.0.total_cmp(&b.0));
        weighed.into_iter().map(|(_, candidate)| candidate).collect()
    }

    /// The heights of the baseline above the line, in pixels, the best first.
    fn baselines(&self) -> Vec<f32> {
        let (size, half) = (self.style.text.size_px, self.label.half_width_px.max(0.0));
        let cap = CAP_HEIGHT * size;
        let is_beside = matches!(self.label.placement, LinePlacement::Repeated | LinePlacement::Once)
            && self.label.shield.is_none();
        // Inside a line that holds the letters with some margin.
        if !is_beside || half * 2.0 > cap * 1.7 {
            return vec![-cap * 0.5];
        }
        let gap = half + size * GAP_EMS;
        vec![gap, -gap - cap]
    }

    /// The letters with their middle at `station`, and how much the name bends in radians; `None` where it turns too fast.
    fn set(&self, piece: &Polyline, station: f32, baseline: f32) -> Option<(Vec<SetLetter>, f32)> {
        let at = |station: f32| piece.at(station.into());
        let half = self.letters.advance * 0.5;
        if self.label.shield.is_some() {
            let start = (at(station).as_vec2() - Vec2::new(half, baseline)).round();
            let level = |letter: f32| SetLetter { at: start + Vec2::new(letter, 0.0), along: Vec2::X };
            return Some((self.letters.letters.iter().map(|letter| level(letter.middle)).collect(), 0.0));
        }
        let chord = at(station + half) - at(station - half);
        let is_upright = chord.x.abs() < chord.y.abs() * 0.1;
        let is_reversed = if is_upright { chord.y > 0.0 } else { chord.x < 0.0 };
        if is_reversed && self.label.placement == LinePlacement::Uphill {
            return None;
        }
        let least = self.style.text.size_px * 0.6;
        let letters = self.letters.letters.iter();
        let letters = letters.map(|letter| CourseLetter {
            middle: letter.middle - half,
            reach: 0.5 * letter.advance.max(least),
        });
        let course = LetterCourse { station, is_reversed, baseline, limits: LIMITS };
        course.set(at, letters)
    }

    /// Level letters with the box of their shield.
    fn shield(&self, letters: Vec<SetLetter>) -> LineCandidate {
        let (cap, half) = (CAP_HEIGHT * self.style.text.size_px, self.letters.advance * 0.5);
        let first = letters.first().zip(self.letters.letters.first());
        let start = first.map_or(Vec2::ZERO, |(set, letter)| set.at - Vec2::new(letter.middle, 0.0));
        let [beside, above] = shield::PADDING.map(|padding| padding * self.space);
        let text = PixelBox::around(
            start + Vec2::new(half, -cap * 0.5),
            Vec2::new(half + beside, cap * 0.5 + above),
        );
        let alignment = TextAlignment::Center;
        let boxes = LabelCandidate { text, letters: Vec::new(), symbol: None, leader: None, alignment };
        LineCandidate { letters, boxes }
    }

    fn candidate(&self, letters: Vec<SetLetter>) -> LineCandidate {
        let size = self.style.text.size_px;
        if self.label.shield.is_some() {
            return self.shield(letters);
        }
        let around = self.style.halo + self.space;
        let shown = letters.iter().zip(&self.letters.letters).filter(|(_, letter)| letter.outline.is_some());
        let boxes: Vec<PixelBox> = shown
            .map(|(place, letter)| {
                let half = letter.advance * 0.5;
                // From the descender to an accent over a capital.
                let corners = [(-half, DESCENT), (half, DESCENT), (half, -0.85), (-half, -0.85)];
                let corner =
                    |(x, ems): (f32, f32)| place.at + place.along * x + place.along.perp() * (ems * size);
                let points = corners.map(corner).map(|point| PixelBox { min: point, max: point });
                points.into_iter().fold(PixelBox::EMPTY, PixelBox::union).grown(around)
            })
            .collect();
        let text = boxes.iter().copied().fold(PixelBox::EMPTY, PixelBox::union);
        let alignment = TextAlignment::Center;
        LineCandidate {
            letters,
            boxes: LabelCandidate { text, letters: boxes, symbol: None, leader: None, alignment },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sheet::INK;
    use sandtable_description::words::{LabelKind, RoadShield};

    fn label(path: Vec<Vec2>) -> LineLabel {
        LineLabel {
            text: "Clear Fork".to_owned(),
            path_px: vec![path],
            half_width_px: 2.0,
            placement: LinePlacement::Repeated,
            kind: LabelKind::Water,
            ink: None,
            rank: 0.0,
            size: 1.0,
            shield: None,
            fallback: None,
        }
    }

    fn prepared(label: &LineLabel) -> PreparedLine<'_> {
        PreparedLine::new(label, &mut Composer::new(1920, 1080)).expect("letters")
    }

    fn arc(center: Vec2, radius: f32, from_deg: f32, to_deg: f32) -> Vec<Vec2> {
        let at = |n: i32| (from_deg + (to_deg - from_deg) * n as f32 / 200.0).to_radians();
        (0..=200).map(|n| center + Vec2::from_angle(at(n)) * radius).collect()
    }

    #[test]
    fn letters_turn_with_the_line_and_are_never_upside_down() {
        for turn in 0..36 {
            let turn = turn as f32 * 10.0;
            for path in [
                arc(Vec2::new(960.0, 540.0), 300.0, turn, turn + 120.0),
                arc(Vec2::new(960.0, 540.0), 300.0, turn + 120.0, turn),
            ] {
                let label = label(path);
                let line = prepared(&label);
                assert_eq!(line.count(), 1, "{turn}");
                for one in &line.occurrences[0] {
                    let (first, last) = (one.letters[0], one.letters[one.letters.len() - 1]);
                    assert!(one.letters.iter().all(|letter| letter.along.x > LIMITS.most_lean), "{turn}");
                    let chord = last.at - first.at;
                    assert!(
                        chord.x > 0.0 || chord.x.abs() < 0.11 * chord.y.abs() && chord.y < 0.0,
                        "{turn}: {chord}"
                    );
                    for letter in &one.letters {
                        let radius = (letter.at - Vec2::new(960.0, 540.0)).normalize();
                        assert!(radius.dot(letter.along).abs() < 0.1, "{turn}: not along the arc");
                    }
                }
            }
        }
    }

    #[test]
    fn a_long_line_carries_its_name_every_two_fifths_of_the_width() {
        let label = label(vec![Vec2::new(0.0, 500.0), Vec2::new(1920.0, 520.0)]);
        let line = prepared(&label);
        assert_eq!(line.count(), 2);
        let middle = |number: usize| line.occurrences[number][0].boxes.text.center().x;
        assert!((middle(0) - middle(1)).abs() > 0.3 * 1920.0, "{} {}", middle(0), middle(1));
    }

    #[test]
    fn a_line_shorter_than_its_name_or_with_sharp_bends_has_no_place() {
        let short = label(vec![Vec2::new(500.0, 500.0), Vec2::new(540.0, 500.0)]);
        assert_eq!(prepared(&short).count(), 0);
        let ring = label(arc(Vec2::new(960.0, 540.0), 18.0, 0.0, 360.0));
        assert_eq!(prepared(&ring).count(), 0);
        let odd = label(vec![Vec2::NAN, Vec2::new(5.0, 5.0), Vec2::INFINITY]);
        assert_eq!(prepared(&odd).count(), 0);
    }

    #[test]
    fn a_name_stands_above_a_narrow_line_and_in_a_wide_one() {
        let path = vec![Vec2::new(300.0, 500.0), Vec2::new(900.0, 500.0)];
        let [narrow, wide] =
            [2.0, 40.0].map(|half_width_px| LineLabel { half_width_px, ..label(path.clone()) });
        let baseline = |label: &LineLabel| prepared(label).occurrences[0][0].letters[0].at.y;
        assert!(baseline(&narrow) < 498.0);
        assert!(baseline(&wide) > 502.0);
    }

    #[test]
    fn a_spread_name_fills_its_line_and_a_name_at_the_ends_stands_at_both() {
        let path = vec![Vec2::new(300.0, 500.0), Vec2::new(680.0, 500.0)];
        let spread = LineLabel { placement: LinePlacement::Spread, ..label(path.clone()) };
        let width = prepared(&spread).occurrences[0][0].boxes.text.size().x;
        assert!((width - 266.0).abs() < 30.0, "{width}");
        let path = vec![Vec2::new(300.0, 500.0), Vec2::new(900.0, 500.0)];
        let ends = LineLabel { placement: LinePlacement::Ends, text: "PL RED".to_owned(), ..label(path) };
        let line = prepared(&ends);
        assert_eq!(line.count(), 2);
        let middles = [0, 1].map(|number| line.occurrences[number][0].boxes.text.center().x);
        assert!(middles[0] < 400.0 && middles[1] > 800.0, "{middles:?}");
    }

    #[test]
    fn a_shield_is_level_on_its_line_however_steep_and_holds_its_number() {
        let steep = vec![Vec2::new(900.0, 100.0), Vec2::new(1000.0, 900.0)];
        let number = LineLabel {
            text: "A 63".to_owned(),
            shield: Some(RoadShield::Motorway),
            kind: LabelKind::Road,
            ..label(steep)
        };
        let line = prepared(&number);
        let mut drawing = Drawing::default();
        line.draw(0, 0, &Pixels::filled(64, 64, INK), &Composer::new(1920, 1080).sheet, &mut drawing);
        let [candidate, ..] = &line.occurrences[0][..] else { panic!("a place") };
        assert!(candidate.letters.iter().all(|letter| letter.along == Vec2::X));
        assert!(candidate.boxes.text.grown(0.01).holds(&drawing.bounds()), "{:?}", drawing.bounds());
        let middle = candidate.boxes.text.center();
        let on_line = 900.0 + (middle.y - 100.0) / 8.0;
        assert!((middle.x - on_line).abs() < 1.5, "{middle} beside the line");
    }

    #[test]
    fn the_boxes_of_letters_hold_what_is_drawn() {
        let label = label(arc(Vec2::new(960.0, 540.0), 200.0, 200.0, 330.0));
        let line = prepared(&label);
        let mut drawing = Drawing::default();
        line.draw(0, 0, &Pixels::filled(64, 64, INK), &Composer::new(64, 64).sheet, &mut drawing);
        let bounds = drawing.bounds();
        assert!(line.occurrences[0][0].boxes.text.holds(&bounds), "{bounds:?}");
    }
}
