//! The title block: title and subtitle on a light panel, upper left.

use glam::Vec2;

use crate::annotate::drawing::Drawing;
use crate::annotate::paragraph::{Paragraph, broken};
use crate::annotate::pixel_box::PixelBox;
use crate::annotate::report::AnnotationReport;
use crate::annotate::sheet::{INK, SOFT_INK, Sheet};
use crate::annotate::text::{CAP_HEIGHT, TextLine, TextStyle, Typesetter, write};

/// The block is no wider than this share of the picture: the rest is left to the view and the north arrow.
const WIDEST_SHARE: f32 = 0.62;
/// Nor higher than this share; it is given up only by the last of [`MOST_LINES`].
const HIGHEST_SHARE: f32 = 0.21;
/// Lines of the title and of the subtitle, from the most generous to the least.
const MOST_LINES: [(usize, usize); 4] = [(2, 2), (2, 1), (2, 0), (1, 0)];

/// The title block with its upper left corner at the origin; `None` where there is nothing to say or no room
/// to say it.
///
/// On small pictures the subtitle gives way to the title: first its second line, then the whole of it.
pub fn compose(
    title: Option<&str>,
    subtitle: Option<&str>,
    sheet: &Sheet,
    setter: &mut Typesetter,
    report: &mut AnnotationReport,
) -> Option<Drawing> {
    let widest = sheet.size.x * WIDEST_SHARE - sheet.padding() * 2.0;
    let texts = [title, subtitle].map(Option::unwrap_or_default);
    let size = title_px(texts[0], widest, sheet, setter);
    let faces = [
        TextStyle::upright(size, TextStyle::MEDIUM),
        TextStyle::upright(sheet.type_px(18.0), TextStyle::REGULAR),
    ];
    for (title_lines, subtitle_lines) in MOST_LINES {
        let title = broken(setter, texts[0], faces[0], widest, title_lines);
        // A subtitle without a title may use the title's room.
        let subtitle_lines = if title.lines.is_empty() { title_lines } else { subtitle_lines };
        let subtitle = broken(setter, texts[1], faces[1], widest, subtitle_lines);
        let drawing = lay_out(&title, &subtitle, sheet)?;
        if title_lines == 1 || drawing.bounds().size().y <= sheet.size.y * HIGHEST_SHARE {
            report.set(texts[0], title.missing(), title.shortened);
            report.set(texts[1], subtitle.missing(), subtitle.shortened);
            return Some(drawing);
        }
    }
    None
}

/// The size of the title's type: a little smaller than usual where that saves a second line.
fn title_px(title: &str, widest: f32, sheet: &Sheet, setter: &mut Typesetter) -> f32 {
    /// Smaller than this, in design pixels, it would no longer look like a title.
    const SMALLEST: f32 = 25.0;
    let usual = sheet.type_px(30.0);
    let advance = setter.line(title, TextStyle::upright(usual, TextStyle::MEDIUM)).advance;
    let fitting = (usual * widest / advance.max(1.0)).min(usual) * 0.99;
    if fitting >= sheet.type_px(SMALLEST) { fitting } else { usual }
}

fn lay_out(title: &Paragraph, subtitle: &Paragraph, sheet: &Sheet) -> Option<Drawing> {
    let all: Vec<&TextLine> = title.lines.iter().chain(&subtitle.lines).collect();
    let (first, last) = (all.first()?, all.last()?);
    let padding = sheet.padding();
    let mut baseline = padding + (first.style.size_px * CAP_HEIGHT).round();
    let mut baselines = vec![baseline];
    for pair in all.windows(2) {
        // Within a paragraph lines are set solid; the subtitle keeps a little more distance.
        let leading = if pair[0].style == pair[1].style { 1.18 } else { 1.5 };
        baseline += (pair[1].style.size_px * leading).round();
        baselines.push(baseline);
    }
    let placed: Vec<(&TextLine, Vec2)> =
        all.iter().zip(&baselines).map(|(line, y)| (*line, Vec2::new(padding, *y))).collect();
    let width = title.width().max(subtitle.width());
    // Panels end a padding below the baseline, not below the descenders: the eye reads the baseline as edge.
    let height = baseline + padding + (last.style.size_px * 0.06).round();
    let mut drawing = Drawing::default();
    let area = PixelBox::at(Vec2::ZERO, Vec2::new((width + padding * 2.0).ceil(), height));
    drawing.panel(area, sheet.hairline());
    let (title_part, subtitle_part) = placed.split_at(title.lines.len());
    write(&mut drawing, title_part, INK);
    write(&mut drawing, subtitle_part, SOFT_INK);
    Some(drawing)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(title: Option<&str>, subtitle: Option<&str>) -> (Option<Drawing>, AnnotationReport) {
        let mut report = AnnotationReport::default();
        let sheet = Sheet::new(1920, 1080);
        let drawing = compose(title, subtitle, &sheet, &mut Typesetter::new(), &mut report);
        (drawing, report)
    }

    #[test]
    fn nothing_to_say_draws_nothing() {
        assert!(block(None, None).0.is_none());
        assert!(block(Some("  \n"), Some("")).0.is_none());
    }

    #[test]
    fn the_block_holds_its_letters() {
        let drawing = block(Some("Cross Mountain, jgpqy"), Some("Ångström")).0.expect("a title");
        let panel = drawing.marks().first().map(|mark| crate::annotate::drawing::box_of(&mark.path));
        assert_eq!(panel, Some(drawing.bounds()));
    }

    #[test]
    fn a_very_long_title_is_broken_and_then_cut() {
        let (drawing, report) = block(Some(&"Great Smoky Mountains ".repeat(60)), None);
        assert!(drawing.expect("a title").bounds().size().x <= 1920.0 * WIDEST_SHARE + 1.0);
        assert_eq!(report.shortened.len(), 1);
    }

    #[test]
    fn on_a_small_picture_the_subtitle_gives_way_and_the_report_says_so() {
        let (sheet, mut report) = (Sheet::new(480, 270), AnnotationReport::default());
        let (title, subtitle) = ("Cross Mountain and the Coal Creek Valley", "Anderson County ".repeat(9));
        let mut setter = Typesetter::new();
        let drawing = compose(Some(title), Some(&subtitle), &sheet, &mut setter, &mut report);
        assert!(drawing.expect("a title").bounds().size().y <= 270.0 * HIGHEST_SHARE);
        assert_eq!(report.shortened, [subtitle]);
    }
}
