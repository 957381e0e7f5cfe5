//! The engagement bar over a symbol, field AO: what engages it or what it engages, on a color that tells how far it is.
//!
//! MIL-STD-2525D, 5.3.7.19.

use glam::Vec2;

use crate::code::SymbolCode;
use crate::drawing::{BLACK, PathStep, SymbolMark, SymbolPen};
use crate::frame::{FRAME_LINE, SymbolBox, fill};
use crate::symbol::MilitarySymbol;
use crate::texts::{ROW_PITCH, SymbolNote, SymbolText, TEXT_SIZE, TextPlace};

/// Between the symbol and the bar, the bar's height, the size of its letters, and its width for each of them.
const GAP: f32 = 6.0;
const HEIGHT: f32 = 25.0;
const LETTER_SIZE: f32 = 22.0;
const LETTER_WIDTH: f32 = 16.0;

/// The words of the stages of an engagement with the colors of the bar: a target, what is none, and what was engaged.
const STAGES: [(&str, [u8; 3]); 3] =
    [("target", [255, 0, 0]), ("non-target", [255, 255, 255]), ("expired", [255, 120, 0])];

/// What an engagement bar says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EngagementBar<'a> {
    /// The text in it, such as `A:PTRIOT-02`.
    pub text: &'a str,
    /// `target`, `non-target` or `expired`; without a stage the bar has the color of the frame.
    pub stage: Option<&'a str>,
}

impl<'a> EngagementBar<'a> {
    /// The bar that the fields of a symbol state, if they do.
    pub fn of(text: impl Fn(SymbolText) -> Option<&'a str>) -> Option<Self> {
        let bar = text(SymbolText::EngagementBar).filter(|bar| !bar.trim().is_empty())?;
        Some(Self { text: bar, stage: text(SymbolText::Engagement) })
    }
}

/// The upper edge of the first row of text beside a frame, where it has one.
fn top_of_texts(frame: SymbolBox, texts: &[SymbolNote]) -> f32 {
    let has_first = texts.iter().any(|note| matches!(note.place, TextPlace::Left(0) | TextPlace::Right(0)));
    let middle = (frame.min.y + frame.max.y) * 0.5;
    if has_first { middle - TEXT_SIZE * (2.0 * ROW_PITCH + 0.5) } else { f32::INFINITY }
}

impl MilitarySymbol {
    /// The symbol of a code with an engagement bar over it and over the lines of text at its sides, `bar`, in the color of its
    /// stage. A note names a stage that is none.
    pub fn with_engagement_bar(
        mut self,
        code: &SymbolCode,
        bar: EngagementBar<'_>,
        texts: &[SymbolNote],
    ) -> Self {
        let EngagementBar { text, stage } = bar;
        let word = stage.map(|stage| stage.trim().to_lowercase());
        let found = word.as_deref().and_then(|word| STAGES.iter().find(|row| row.0 == word));
        if let (Some(word), None) = (&word, found) {
            self.notes.push(format!(
                "the engagement is '{}': target, non-target and expired have colors",
                word.escape_debug()
            ));
        }
        let text = text.trim();
        let width = (self.bounds.max.x - self.bounds.min.x).max(text.chars().count() as f32 * LETTER_WIDTH);
        let bottom = self.bounds.min.y.min(top_of_texts(self.frame, texts)) - GAP;
        let bar = SymbolBox::new(100.0 - width * 0.5, bottom - HEIGHT, 100.0 + width * 0.5, bottom);
        let corners = [Vec2::new(bar.max.x, bar.min.y), bar.max, Vec2::new(bar.min.x, bar.max.y)];
        let steps = [PathStep::Move(bar.min)].into_iter().chain(corners.map(PathStep::Line));
        self.marks.push(SymbolMark::Shape {
            steps: steps.chain([PathStep::Close]).collect(),
            fill: Some(found.map_or_else(|| fill(code), |row| row.1)),
            stroke: Some(SymbolPen::black(FRAME_LINE)),
        });
        self.marks.push(SymbolMark::Text {
            text: text.to_owned(),
            center: (bar.min + bar.max) * 0.5,
            size: LETTER_SIZE,
            color: BLACK,
        });
        self.bounds = self.bounds.union(bar);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar<'a>(text: &'a str, stage: Option<&'a str>) -> EngagementBar<'a> {
        EngagementBar { text, stage }
    }

    #[test]
    fn a_bar_is_over_the_echelon_as_wide_as_its_text_needs_and_has_the_color_of_its_stage() {
        let code = SymbolCode::parse("10061000161211000000").expect("a battalion");
        let symbol = MilitarySymbol::new(&code).expect("a frame");
        let top = symbol.bounds.min.y;
        let engaged = symbol.clone().with_engagement_bar(&code, bar("A:PTRIOT-02", Some("Target")), &[]);
        // As milsymbol 3.0.4 has it.
        assert_eq!((engaged.bounds.min.y, engaged.bounds.min.x), (top - 31.0, 12.0));
        assert!(engaged.notes.is_empty());
        let fills = engaged.marks.iter().rev().find_map(|mark| match mark {
            SymbolMark::Shape { fill, .. } => *fill,
            SymbolMark::Text { .. } => None,
        });
        assert_eq!(fills, Some([255, 0, 0]));
        let odd = symbol.clone().with_engagement_bar(&code, bar("A", Some("maybe")), &[]);
        assert!(odd.notes[0].contains("'maybe'"), "{:?}", odd.notes);
        let texts = [SymbolNote { text: "051200Z".to_owned(), place: TextPlace::Left(0) }];
        let over_texts = symbol.with_engagement_bar(&code, bar("A", None), &texts);
        // Already the echelon is higher than the first row.
        assert_eq!(over_texts.bounds.min.y, top - 31.0);
        let code = SymbolCode::parse("10060100001101040000").expect("a fighter");
        let fighter = MilitarySymbol::new(&code).expect("a frame");
        let plain = fighter.clone().with_engagement_bar(&code, bar("A", None), &[]);
        let over_texts = fighter.with_engagement_bar(&code, bar("A", None), &texts);
        assert!(over_texts.bounds.min.y < plain.bounds.min.y - 10.0, "{:?}", over_texts.bounds);
    }
}
