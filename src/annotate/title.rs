//! The title block: title and subtitle on a light panel, upper left.

use glam::Vec2;

use crate::composer::{Composer, widest};
use crate::drawing::Drawing;
use crate::paragraph::Paragraph;
use crate::sheet::{INK, SOFT_INK, Sheet};
use crate::text::TextStyle;

/// The greatest width of the block, as a share of the picture's: the rest is left to the view and the north arrow.
const WIDEST_SHARE: f32 = 0.62;
/// The greatest height of the block, as a share of the picture's; only the last of [`MOST_LINES`] may exceed it.
const HIGHEST_SHARE: f32 = 0.21;
/// Lines of the title and of the subtitle, from the most generous to the least.
const MOST_LINES: [(usize, usize); 4] = [(2, 2), (2, 1), (2, 0), (1, 0)];

/// The title block with its upper left corner at the origin; `None` where both texts are empty or do not fit. On small
/// pictures the subtitle is dropped: first its second line, then all of it.
pub fn compose(title: Option<&str>, subtitle: Option<&str>, composer: &mut Composer) -> Option<Drawing> {
    let sheet = composer.sheet;
    let widest = sheet.size.x * WIDEST_SHARE - sheet.padding() * 2.0;
    let [title, subtitle] = [title, subtitle].map(Option::unwrap_or_default);
    let title_style = title_style(title, widest, composer);
    let subtitle_style = composer.style(18.0, TextStyle::REGULAR);
    for (title_lines, subtitle_lines) in MOST_LINES {
        let heading = composer.broken(title, title_style, widest, title_lines);
        // A subtitle without a title may use the title's lines.
        let subtitle_lines = if heading.lines.is_empty() { title_lines } else { subtitle_lines };
        let note = composer.broken(subtitle, subtitle_style, widest, subtitle_lines);
        let mut drawing = lay_out(&heading, &note, &sheet)?;
        if title_lines == 1 || drawing.bounds().size().y <= sheet.size.y * HIGHEST_SHARE {
            drawing.record_text(title, heading.missing(), heading.shortened);
            drawing.record_text(subtitle, note.missing(), note.shortened);
            return Some(drawing);
        }
    }
    None
}

/// The style of the title: a little smaller than usual where that saves a second line.
fn title_style(title: &str, widest: f32, composer: &mut Composer) -> TextStyle {
    /// Smaller type, in design pixels, would not look like a title.
    const SMALLEST: f32 = 25.0;
    let usual = composer.style(30.0, TextStyle::MEDIUM);
    let advance = composer.line(title, usual).advance;
    let fitting = (usual.size_px * widest / advance.max(1.0)).min(usual.size_px) * 0.99;
    let is_legible = fitting >= composer.sheet.type_px(SMALLEST);
    TextStyle { size_px: if is_legible { fitting } else { usual.size_px }, ..usual }
}

fn lay_out(title: &Paragraph, subtitle: &Paragraph, sheet: &Sheet) -> Option<Drawing> {
    let lines = || title.lines.iter().chain(&subtitle.lines);
    let (first, last) = (lines().next()?, lines().last()?);
    let padding = sheet.padding();
    let mut baseline = padding + first.style.cap_px().round();
    let mut drawing = Drawing::default();
    let mut above = first;
    for (index, line) in lines().enumerate() {
        if index > 0 {
            // Lines of a paragraph are set close; the subtitle keeps more distance.
            let leading = if above.style == line.style { 1.18 } else { 1.5 };
            baseline += (line.style.size_px * leading).round();
        }
        let color = if index < title.lines.len() { INK } else { SOFT_INK };
        drawing.write(line, Vec2::new(padding, baseline), color);
        above = line;
    }
    let width = widest(lines());
    // Panels end a padding below the baseline, not below the descenders: the baseline reads as the edge.
    let height = baseline + padding + (last.style.size_px * 0.06).round();
    Some(drawing.on_panel(Vec2::new((width + padding * 2.0).ceil(), height), sheet))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(title: Option<&str>, subtitle: Option<&str>) -> Option<Drawing> {
        compose(title, subtitle, &mut Composer::new(1920, 1080))
    }

    fn shortened(drawing: &Drawing) -> Vec<&str> {
        drawing.texts.iter().filter(|text| text.shortened).map(|text| text.text.as_str()).collect()
    }

    #[test]
    fn nothing_to_say_draws_nothing() {
        assert!(block(None, None).is_none());
        assert!(block(Some("  \n"), Some("")).is_none());
    }

    #[test]
    fn the_block_holds_its_letters() {
        let drawing = block(Some("Cross Mountain, jgpqy"), Some("Ångström")).expect("a title");
        let panel = drawing.marks.first().map(|mark| crate::drawing::box_of(&mark.path));
        assert_eq!(panel, Some(drawing.bounds()));
    }

    #[test]
    fn a_very_long_title_is_broken_and_then_cut() {
        let drawing = block(Some(&"Great Smoky Mountains ".repeat(60)), None).expect("a title");
        assert!(drawing.bounds().size().x <= 1920.0 * WIDEST_SHARE + 1.0);
        assert_eq!(shortened(&drawing).len(), 1);
    }

    #[test]
    fn on_a_small_picture_the_subtitle_is_dropped_and_recorded_as_shortened() {
        let (title, subtitle) = ("Cross Mountain and the Coal Creek Valley", "Anderson County ".repeat(9));
        let drawing = compose(Some(title), Some(&subtitle), &mut Composer::new(480, 270)).expect("a title");
        assert!(drawing.bounds().size().y <= 270.0 * HIGHEST_SHARE);
        assert_eq!(shortened(&drawing), [subtitle.as_str()]);
    }
}
