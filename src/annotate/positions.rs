//! The candidate positions of a label around its place, the best first.
//!
//! Eight positions beside the place, in the order of Imhof (1962): to the upper right, right, above, and so on.
//!
//! ```text
//!    4 3 1
//!    5 ● 2
//!    8 7 6
//! ```
//!
//! Where all are taken, the text stands at the end of a leader line:
//!
//! ```text
//!        Name              Name              Name
//!       1062 m            1062 m            1062 m          ▲ Name      Name ▲
//!          │              │                       │           1062 m  1062 m
//!          ▲              ▲                       ▲
//!       centered       to the right          to the left          beside it
//! ```
//!
//! The leader is lengthened or shortened and the text shifted along it. A label that is wished above its place has its
//! leader first. Names of waters stand on the water itself first.

use glam::Vec2;

use crate::pixel_box::{PixelBox, PixelSegment};
use crate::place::{LabelCandidate, TextAlignment};

/// The measures from which the candidates of a label are made, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelMetrics {
    pub anchor: Vec2,
    /// From the place to the preferred end of its leader line; upward.
    pub reach: Vec2,
    /// The box of the text for each [`TextAlignment`], around any origin; candidates move it by whole pixels.
    pub texts: [PixelBox; 3],
    /// Half the size of the symbol.
    pub symbol: Vec2,
    /// The gap between text and leader line, and text and symbol.
    pub gap: f32,
    pub longest: f32,
    /// Whether the text is preferred at the end of a leader line.
    pub leads_first: bool,
    /// Whether the first position is on the place itself, without symbol and leader line.
    pub may_lie_on_place: bool,
}

/// Lengths of the leader to try, as multiples of the preferred one.
const LENGTHS: [f32; 7] = [1.0, 0.55, 1.5, 2.1, 2.8, 3.7, 5.0];
/// Where along the text's lower edge the leader meets it.
const MEETINGS: [(f32, TextAlignment); 3] =
    [(0.5, TextAlignment::Center), (0.14, TextAlignment::Left), (0.86, TextAlignment::Right)];

/// The eight positions: right is 1, down is 1.
const BESIDE: [(f32, f32); 8] =
    [(1.0, -1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, -1.0), (-1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0)];

impl LabelMetrics {
    pub fn positions(&self) -> Vec<LabelCandidate> {
        let on_place = self.may_lie_on_place.then(|| self.on_place());
        let above = LENGTHS
            .iter()
            .filter(|&&length| self.reach.length() * length <= self.longest)
            .flat_map(|&length| MEETINGS.map(|meeting| self.above(self.reach * length, meeting)));
        let beside = BESIDE.iter().map(|&side| self.beside(side));
        let mut positions: Vec<_> = on_place.into_iter().collect();
        if self.leads_first {
            positions.extend(above.chain(beside));
        } else {
            positions.extend(beside.chain(above));
        }
        positions
    }

    pub fn symbol_box(&self) -> PixelBox {
        PixelBox::around(self.anchor, self.symbol)
    }

    fn on_place(&self) -> LabelCandidate {
        let alignment = TextAlignment::Center;
        let text = moved_center(self.texts[alignment as usize], self.anchor);
        LabelCandidate { text, letters: Vec::new(), symbol: None, leader: None, alignment }
    }

    fn above(&self, reach: Vec2, (meeting, alignment): (f32, TextAlignment)) -> LabelCandidate {
        let area = self.texts[alignment as usize];
        let end = self.anchor + reach;
        let foot = Vec2::new(area.min.x + area.size().x * meeting, area.max.y + self.gap);
        let text = area.moved((end - foot).round());
        let from = self.anchor + reach.normalize_or_zero() * self.symbol.y;
        // The text is moved by whole pixels; the line ends where the text is then.
        let to = Vec2::new(end.x, text.max.y + self.gap);
        let leader = Some(PixelSegment { from, to });
        LabelCandidate { text, letters: Vec::new(), symbol: Some(self.symbol_box()), leader, alignment }
    }

    fn beside(&self, (right, down): (f32, f32)) -> LabelCandidate {
        let alignment = match right {
            1.0 => TextAlignment::Left,
            -1.0 => TextAlignment::Right,
            _ => TextAlignment::Center,
        };
        let (area, symbol) = (self.texts[alignment as usize], self.symbol_box());
        let half = area.size() * 0.5;
        // In a corner the text stands closer than the symbol's own corner.
        let upward =
            if right == 0.0 { self.symbol.y + self.gap + half.y } else { half.y - self.symbol.y * 0.2 };
        let away = Vec2::new(right * (self.symbol.x + self.gap + half.x), down * upward);
        let mut text = moved_center(area, self.anchor + away);
        // Rounding to whole pixels must not move the text over the symbol.
        if text.overlaps(&symbol) {
            let side = if right == 0.0 { Vec2::new(0.0, down) } else { Vec2::new(right, 0.0) };
            text = text.moved(side);
        }
        LabelCandidate { text, letters: Vec::new(), symbol: Some(symbol), leader: None, alignment }
    }
}

/// `area` moved by whole pixels so that its center comes to `center`.
fn moved_center(area: PixelBox, center: Vec2) -> PixelBox {
    area.moved((center - area.center()).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metrics() -> LabelMetrics {
        let text = PixelBox { min: Vec2::new(-1.5, -20.0), max: Vec2::new(80.5, 12.0) };
        LabelMetrics {
            anchor: Vec2::new(400.3, 300.7),
            reach: Vec2::new(4.0, -50.0),
            texts: [text.moved(Vec2::new(3.0, 0.0)), text, text.moved(Vec2::new(-3.0, 0.0))],
            symbol: Vec2::splat(6.0),
            gap: 3.0,
            longest: 200.0,
            leads_first: true,
            may_lie_on_place: false,
        }
    }

    #[test]
    fn a_label_stands_at_the_upper_right_first_and_has_a_leader_last() {
        let positions = LabelMetrics { leads_first: false, ..metrics() }.positions();
        let away = positions[0].text.center() - metrics().anchor;
        assert!(away.x > 40.0 && away.y < -5.0, "{away}");
        let first_led = positions.iter().position(|candidate| candidate.leader.is_some());
        assert_eq!(first_led, Some(8));
    }

    #[test]
    fn the_first_candidate_is_centered_over_the_leaders_wished_end() {
        let first = &metrics().positions()[0];
        let end = metrics().anchor + metrics().reach;
        assert!((first.text.center().x - end.x).abs() <= 0.5);
        assert!((first.text.max.y + 3.0 - end.y).abs() <= 0.5);
    }

    #[test]
    fn no_candidate_covers_its_own_symbol_or_leader() {
        for (number, candidate) in metrics().positions().iter().enumerate() {
            let symbol = candidate.symbol.expect("drawn with a symbol");
            assert!(!candidate.text.overlaps(&symbol), "{number}: {candidate:?}");
            assert!(candidate.leader.is_none_or(|line| !candidate.text.meets(&line)), "{number}");
        }
    }

    #[test]
    fn texts_move_by_whole_pixels() {
        for position in metrics().positions() {
            let by = position.text.min - metrics().texts[position.alignment as usize].min;
            assert!((by - by.round()).length() < 1e-3, "{by}");
        }
    }

    #[test]
    fn lines_stand_flush_toward_what_they_name() {
        for position in metrics().positions() {
            let off = position.text.center().x - metrics().anchor.x - 4.0;
            match position.alignment {
                TextAlignment::Left => assert!(off > 10.0),
                TextAlignment::Right => assert!(off < -10.0),
                TextAlignment::Center => assert!(off.abs() < 25.0),
            }
        }
    }

    #[test]
    fn leaders_are_no_longer_than_allowed() {
        let longest = metrics()
            .positions()
            .iter()
            .filter_map(|candidate| candidate.leader)
            .map(|line| (line.to - line.from).length())
            .fold(0.0, f32::max);
        assert!(longest > 100.0 && longest <= 201.0, "{longest}");
    }

    #[test]
    fn a_water_name_stands_on_the_water_first() {
        let first = &LabelMetrics { may_lie_on_place: true, ..metrics() }.positions()[0];
        assert!((first.text.center() - metrics().anchor).abs().max_element() <= 0.5);
        assert_eq!((first.symbol, first.leader), (None, None));
    }
}
