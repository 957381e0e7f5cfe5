//! Texts of things that are drawn on the ground, each where it belongs: an echelon in the gap of a boundary, a name in an
//! area, a number beside the end of a line.
//!
//! They come after furniture and before labels, in their order. One that would lie on another is tried a little farther
//! away, and then left out and reported.

use glam::Vec2;

use crate::annotation::OverlayText;
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::fonts::FontCut;
use crate::halo::Halo;
use crate::paragraph::written_lines;
use crate::pixel_box::PixelBox;
use crate::report::{AnnotationReport, LabelOutcome};
use crate::sheet::INK;
use crate::text::TypesetLine;

/// More texts are not tried.
const MOST_TEXTS: usize = 4096;
/// Lines of a text that are drawn.
const MOST_LINES: usize = 6;
/// The type of a text in design pixels; that of the graphics it belongs to.
const TYPE_PX: f32 = 14.5;
/// From baseline to baseline in type sizes.
const LEADING: f32 = 1.14;
/// How far halos reach round letters, in design pixels.
const HALO_PX: f32 = 2.0;
/// The greatest width of a line, as a share of the picture's.
const WIDEST_SHARE: f32 = 0.25;
/// Where a text is tried besides its own place, in heights of it: along its side, or up and down.
const TRIED: [f32; 5] = [0.0, 0.55, -0.55, 1.1, -1.1];

/// Draws texts that are visible and free of `taken`, which their boxes are added to; reports the outcome of each.
pub fn draw_fixed(
    texts: &[OverlayText],
    taken: &mut Vec<PixelBox>,
    composer: &mut Composer,
    report: &mut AnnotationReport,
) -> Drawing {
    let mut drawing = Drawing::default();
    for text in texts.iter().take(MOST_TEXTS) {
        let outcome = match FixedBlock::new(text, composer) {
            None => LabelOutcome::Empty,
            Some(_) if !text.visible => LabelOutcome::Hidden,
            Some(block) => block.place(text, taken, composer, &mut drawing),
        };
        outcome.report(&text.text, report);
    }
    report.add_texts(&drawing.texts);
    drawing
}

/// A text, set.
struct FixedBlock {
    /// The lines with the starts of their baselines, about the block's center.
    lines: Vec<(TypesetLine, Vec2)>,
    /// Its box about its center, halo and all.
    area: PixelBox,
    halo: f32,
}

impl FixedBlock {
    /// `None` for a text without letters.
    fn new(text: &OverlayText, composer: &mut Composer) -> Option<Self> {
        let sheet = composer.sheet;
        let style = composer.style(TYPE_PX, FontCut::Bold);
        let halo = sheet.px(HALO_PX).max(1.3);
        let widest = sheet.size.x * WIDEST_SHARE;
        let (written, _) = written_lines(&text.text, MOST_LINES);
        let set: Vec<TypesetLine> =
            written.iter().filter_map(|line| composer.fitted(line, style, widest)).collect();
        let leading = (style.size_px * LEADING).round();
        let mut lines: Vec<(TypesetLine, Vec2)> = Vec::new();
        for (number, line) in set.into_iter().enumerate() {
            let at = Vec2::new((-line.advance / 2.0).round(), number as f32 * leading);
            lines.push((line, at));
        }
        let bounds = |lines: &[(TypesetLine, Vec2)]| {
            let boxes = lines.iter().map(|(line, at)| line.bounds(halo).moved(*at));
            boxes.fold(PixelBox::EMPTY, PixelBox::union)
        };
        let center = bounds(&lines).center().round();
        lines.iter_mut().for_each(|(_, at)| *at -= center);
        let area = bounds(&lines);
        let is_sound = area.size().is_finite() && area.size().cmpgt(Vec2::ZERO).all();
        is_sound.then_some(Self { lines, area, halo })
    }

    fn place(
        &self,
        text: &OverlayText,
        taken: &mut Vec<PixelBox>,
        composer: &Composer,
        drawing: &mut Drawing,
    ) -> LabelOutcome {
        let bounds = composer.sheet.bounds();
        if !text.at_px.is_finite() || !bounds.contains(text.at_px) {
            return LabelOutcome::Outside;
        }
        let toward = text.toward_px.normalize_or_zero();
        let half = self.area.size() / 2.0;
        // As far as the box reaches back toward the place.
        let beside = text.at_px + toward * toward.abs().dot(half);
        let way = if toward == Vec2::ZERO { Vec2::Y } else { toward };
        let step = self.area.size().y;
        let mut is_inside = false;
        for share in TRIED.into_iter().filter(|&share| toward == Vec2::ZERO || share >= 0.0) {
            let by = (beside + way * (share * step)).round();
            let area = self.area.moved(by);
            if !bounds.holds(&area) {
                continue;
            }
            is_inside = true;
            if taken.iter().any(|other| other.overlaps(&area)) {
                continue;
            }
            let lines: Vec<(&TypesetLine, Vec2)> =
                self.lines.iter().map(|(line, at)| (line, *at + by)).collect();
            drawing.draw_halo(&lines, Halo::paper(self.halo));
            let ink = text.ink.unwrap_or(INK);
            lines.iter().for_each(|(line, at)| drawing.write(line, *at, ink));
            let missing = self.lines.iter().map(|(line, _)| line.missing).sum();
            drawing.record_text(&text.text, missing, self.lines.iter().any(|(line, _)| line.shortened));
            taken.push(area);
            return LabelOutcome::Placed(None);
        }
        if is_inside { LabelOutcome::CrowdedOut } else { LabelOutcome::Outside }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(x: f32, y: f32, toward: Vec2) -> OverlayText {
        let at_px = Vec2::new(x, y);
        OverlayText { text: "PL RED".into(), at_px, toward_px: toward, ink: None, visible: true }
    }

    #[test]
    fn a_text_is_centered_on_its_place_or_lies_on_its_side_of_it() {
        let mut composer = Composer::new(1920, 1080);
        let block = FixedBlock::new(&text(0.0, 0.0, Vec2::ZERO), &mut composer).expect("letters");
        assert!(block.area.center().abs().max_element() <= 1.0, "{:?}", block.area);
        for toward in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::new(0.6, -0.8)] {
            let mut taken = Vec::new();
            let mut report = AnnotationReport::default();
            draw_fixed(&[text(500.0, 500.0, toward)], &mut taken, &mut composer, &mut report);
            let offset = taken[0].center() - Vec2::splat(500.0);
            assert!(offset.normalize().dot(toward) > 0.7, "{toward} {offset}");
            assert!(!taken[0].grown(-2.0).contains(Vec2::splat(500.0)), "{toward} {:?}", taken[0]);
        }
    }

    #[test]
    fn texts_never_overlap_and_what_finds_no_place_is_reported() {
        let mut composer = Composer::new(640, 360);
        let crowd: Vec<OverlayText> = (0..9).map(|_| text(300.0, 180.0, Vec2::ZERO)).collect();
        let (mut taken, mut report) = (Vec::new(), AnnotationReport::default());
        draw_fixed(&crowd, &mut taken, &mut composer, &mut report);
        assert_eq!(report.placed.len() + report.crowded_out.len(), 9);
        assert!(report.placed.len() >= 3 && report.crowded_out.len() >= 4, "{report:?}");
        for (index, one) in taken.iter().enumerate() {
            assert!(taken[index + 1..].iter().all(|other| !one.overlaps(other)));
        }
    }
}
