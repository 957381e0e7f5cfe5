//! The title block: title and subtitle on a light panel, upper left.

use glam::Vec2;

use crate::annotate::drawing::Drawing;
use crate::annotate::paragraph::{Paragraph, broken};
use crate::annotate::pixel_box::PixelBox;
use crate::annotate::report::Report;
use crate::annotate::sheet::{INK, SOFT_INK, Sheet};
use crate::annotate::text::{CAP_HEIGHT, Face, Line, Typesetter, write};

/// The block is no wider than this share of the picture: the rest is left to the view and the north arrow.
const WIDEST_SHARE: f32 = 0.55;
/// Lines of the title, and of the subtitle.
const MOST_LINES: usize = 2;

/// The title block with its upper left corner at the origin; `None` where there is nothing to say or no room
/// to say it.
pub fn compose(
    title: Option<&str>,
    subtitle: Option<&str>,
    sheet: &Sheet,
    setter: &mut Typesetter,
    report: &mut Report,
) -> Option<Drawing> {
    let padding = sheet.padding();
    let widest = sheet.size.x * WIDEST_SHARE - padding * 2.0;
    let mut set = |text: Option<&str>, size: f32, weight: f32| {
        let face = Face::upright(sheet.type_px(size), weight);
        broken(setter, text.unwrap_or(""), face, widest, MOST_LINES)
    };
    let title_lines = set(title, 30.0, Face::MEDIUM);
    let subtitle_lines = set(subtitle, 18.0, Face::REGULAR);
    for (text, lines) in [(title, &title_lines), (subtitle, &subtitle_lines)] {
        report.set(text.unwrap_or(""), lines.missing(), lines.shortened && !lines.lines.is_empty());
    }
    lay_out(&title_lines, &subtitle_lines, sheet)
}

fn lay_out(title: &Paragraph, subtitle: &Paragraph, sheet: &Sheet) -> Option<Drawing> {
    let all: Vec<&Line> = title.lines.iter().chain(&subtitle.lines).collect();
    let (first, last) = (all.first()?, all.last()?);
    let padding = sheet.padding();
    let mut baseline = padding + (first.face.size_px * CAP_HEIGHT).round();
    let mut baselines = vec![baseline];
    for pair in all.windows(2) {
        // Within a paragraph lines are set solid; the subtitle keeps a little more distance.
        let leading = if pair[0].face == pair[1].face { 1.18 } else { 1.5 };
        baseline += (pair[1].face.size_px * leading).round();
        baselines.push(baseline);
    }
    let placed: Vec<(&Line, Vec2)> =
        all.iter().zip(&baselines).map(|(line, y)| (*line, Vec2::new(padding, *y))).collect();
    let width = title.width().max(subtitle.width());
    // Panels end a padding below the baseline, not below the descenders: the eye reads the baseline as edge.
    let height = baseline + padding + (last.face.size_px * 0.06).round();
    let mut drawing = Drawing::default();
    let area = PixelBox::at(Vec2::ZERO, Vec2::new((width + padding * 2.0).ceil(), height));
    drawing.panel(area, sheet.hairline());
    let (title_part, subtitle_part) = placed.split_at(title.lines.len());
    write(&mut drawing, title_part, INK, 0.0);
    write(&mut drawing, subtitle_part, SOFT_INK, 0.0);
    Some(drawing)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(title: Option<&str>, subtitle: Option<&str>) -> (Option<Drawing>, Report) {
        let mut report = Report::default();
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
}
