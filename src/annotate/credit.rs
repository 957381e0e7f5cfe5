//! The credit line: where the data come from, small along the lower border.

use glam::Vec2;

use crate::annotate::drawing::Drawing;
use crate::annotate::paragraph::{fitted, written_lines};
use crate::annotate::report::AnnotationReport;
use crate::annotate::sheet::{INK, Sheet};
use crate::annotate::text::{TextStyle, Typesetter, halos, write};

/// A credit cut shorter than this, in ems, names nobody and is left out.
const SHORTEST_EM: f32 = 10.0;

/// The line with its baseline starting at the origin, no wider than `most_px`; `None` where there is nothing
/// to say or no room to say it.
pub fn compose(
    credit: &str,
    most_px: f32,
    sheet: &Sheet,
    setter: &mut Typesetter,
    report: &mut AnnotationReport,
) -> Option<Drawing> {
    let text = written_lines(credit, usize::MAX).0.join(" · ");
    let face = TextStyle::upright(sheet.type_px(13.0), TextStyle::MEDIUM);
    let line = fitted(setter, &text, face, most_px)
        .filter(|line| !line.shortened || line.advance >= face.size_px * SHORTEST_EM)?;
    let mut drawing = Drawing::default();
    halos(&mut drawing, &[(&line, Vec2::ZERO)], sheet.px(1.7).max(1.2));
    write(&mut drawing, &[(&line, Vec2::ZERO)], INK);
    if drawing.marks().is_empty() {
        return None;
    }
    report.set(credit, line.missing, line.shortened);
    Some(drawing)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(credit: &str, most_px: f32) -> (Option<Drawing>, AnnotationReport) {
        let mut report = AnnotationReport::default();
        let sheet = Sheet::new(1920, 1080);
        (compose(credit, most_px, &sheet, &mut Typesetter::new(), &mut report), report)
    }

    #[test]
    fn a_credit_is_one_line_however_it_was_written() {
        let (one, two) = (line("USGS 3DEP", 900.0).0, line("USGS\n3DEP", 900.0).0);
        let height = |drawing: Option<Drawing>| drawing.expect("a line").bounds().size().y;
        assert!((height(one) - height(two)).abs() < 0.1);
    }

    #[test]
    fn a_credit_without_room_or_words_is_left_out_and_a_long_one_cut() {
        assert!(line("USGS 3DEP, National Map, public domain", 60.0).0.is_none());
        assert!(line(" ", 900.0).0.is_none());
        assert_eq!(line("USGS 3DEP, National Map, public domain", 200.0).1.shortened.len(), 1);
    }
}
